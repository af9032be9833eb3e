/* Memory that lives as long as a cell (or a command): zeroed, 64-byte aligned, never NULL, never
 * freed alone. */
#ifndef TREELINE_BASE_ARENA_H
#define TREELINE_BASE_ARENA_H

#include <stddef.h>
#include <stdint.h>

struct arena;

/* budget_bytes: 0 means no limit. When the budget or the system's memory is exhausted, the process
 * ends with STATUS_MEMORY after one line on stderr (a cell is a process, so a cell ends). */
struct arena *arena_create(size_t budget_bytes);
void arena_destroy(struct arena *arena); /* NULL is allowed */

/* count x size bytes, zeroed, 64-byte aligned; overflow counts as over budget; 0 bytes is valid. */
void *arena_alloc(struct arena *arena, size_t count, size_t size);
#define ARENA_NEW(arena, type) ((type *)arena_alloc((arena), 1, sizeof(type)))
#define ARENA_ARRAY(arena, type, count) ((type *)arena_alloc((arena), (count), sizeof(type)))

char *arena_strdup(struct arena *arena, const char *text);
char *arena_printf(struct arena *arena, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* When the arena is destroyed, end(thing) is called first, the newest first: for what a library of
 * others holds. */
void arena_at_end(struct arena *arena, void (*end)(void *thing), void *thing);

/* Bytes handed out so far (host_bytes of a result). */
size_t arena_used_bytes(const struct arena *arena);

#endif
