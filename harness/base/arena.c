/* The arena: large zeroed blocks, handed out in 64-byte steps. */
#include "base/arena.h"

#include "base/status.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

enum { ALIGNMENT = 64, BLOCK_BYTES = 1 << 20 };

/* The address sanitizer's, where the program is built with it, else NULL: memory that was not
 * handed out may not be touched. */
void __asan_poison_memory_region(const volatile void *memory, size_t size) __attribute__((weak));
void __asan_unpoison_memory_region(const volatile void *memory, size_t size) __attribute__((weak));

/* Header at the start of each mapping; the payload follows, aligned. */
struct block {
    struct block *next;
    size_t mapped_bytes;
};

/* What is to be ended before the arena. */
struct ending {
    void (*end)(void *thing);
    void *thing;
    struct ending *next;
};

struct arena {
    struct block *blocks;
    struct ending *endings;
    char *free;        /* next free byte of the newest small block */
    size_t free_bytes; /* left in it */
    size_t budget_bytes, used_bytes;
};

static void poison(const void *memory, size_t bytes)
{
    if (__asan_poison_memory_region)
        __asan_poison_memory_region(memory, bytes);
}

static void unpoison(const void *memory, size_t bytes)
{
    if (__asan_unpoison_memory_region)
        __asan_unpoison_memory_region(memory, bytes);
}

static _Noreturn void over_budget(const struct arena *arena, size_t count, size_t size)
{
    if (arena && arena->budget_bytes)
        fprintf(
            stderr,
            "treeline: memory: %zu x %zu bytes more than %zu in use is over the budget of %zu\n",
            count, size, arena->used_bytes, arena->budget_bytes);
    else
        fprintf(stderr, "treeline: memory: the system has no %zu x %zu bytes more\n", count, size);
    fflush(NULL);
    _Exit(STATUS_MEMORY);
}

struct arena *arena_create(size_t budget_bytes)
{
    struct arena *arena = calloc(1, sizeof *arena);
    if (!arena)
        over_budget(NULL, 1, sizeof *arena);
    arena->budget_bytes = budget_bytes;
    return arena;
}

void arena_destroy(struct arena *arena)
{
    if (!arena)
        return;
    for (struct ending *ending = arena->endings; ending; ending = ending->next)
        ending->end(ending->thing);
    for (struct block *block = arena->blocks; block;) {
        struct block *next = block->next;
        unpoison(block, block->mapped_bytes);
        munmap(block, block->mapped_bytes);
        block = next;
    }
    free(arena);
}

/* Fresh pages from the system are zero already. */
static struct block *block_map(struct arena *arena, size_t payload_bytes)
{
    size_t bytes = payload_bytes + ALIGNMENT;
    struct block *block =
        mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (block == MAP_FAILED)
        over_budget(NULL, 1, bytes);
    block->mapped_bytes = bytes;
    block->next = arena->blocks;
    arena->blocks = block;
    poison((char *)block + ALIGNMENT, payload_bytes);
    return block;
}

void *arena_alloc(struct arena *arena, size_t count, size_t size)
{
    size_t bytes;
    if (__builtin_mul_overflow(count, size, &bytes) || bytes > SIZE_MAX / 4)
        over_budget(arena, count, size);
    size_t wanted = bytes;
    bytes = (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    if (bytes == 0)
        bytes = ALIGNMENT;
    if (arena->budget_bytes &&
        (bytes > arena->budget_bytes || arena->used_bytes > arena->budget_bytes - bytes))
        over_budget(arena, count, size);
    arena->used_bytes += bytes;
    bytes += __asan_poison_memory_region ? ALIGNMENT : 0; /* stays poisoned, as a fence */
    if (bytes > BLOCK_BYTES / 4) {
        char *alone = (char *)block_map(arena, bytes) + ALIGNMENT;
        unpoison(alone, wanted);
        return alone;
    }
    if (bytes > arena->free_bytes) {
        arena->free = (char *)block_map(arena, BLOCK_BYTES) + ALIGNMENT;
        arena->free_bytes = BLOCK_BYTES;
    }
    void *memory = arena->free;
    arena->free += bytes;
    arena->free_bytes -= bytes;
    unpoison(memory, wanted);
    return memory;
}

char *arena_strdup(struct arena *arena, const char *text)
{
    size_t size = strlen(text) + 1;
    return memcpy(arena_alloc(arena, size, 1), text, size);
}

char *arena_printf(struct arena *arena, const char *format, ...)
{
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    int length = vsnprintf(NULL, 0, format, arguments);
    va_end(arguments);
    char *text = arena_alloc(arena, (size_t)(length < 0 ? 0 : length) + 1, 1);
    vsnprintf(text, (size_t)(length < 0 ? 0 : length) + 1, format, again);
    va_end(again);
    return text;
}

size_t arena_used_bytes(const struct arena *arena)
{
    return arena->used_bytes;
}

void arena_at_end(struct arena *arena, void (*end)(void *thing), void *thing)
{
    struct ending *ending = ARENA_NEW(arena, struct ending);
    *ending = (struct ending){end, thing, arena->endings};
    arena->endings = ending;
}
