/* Between the plan's files: lists as text, the sweep of a method's options, a cell's defaults and
 * name. */
#ifndef TREELINE_PLAN_NAMES_H
#define TREELINE_PLAN_NAMES_H

#include "plan/plan.h"

#define CELL_SEED 1
#define CELL_TREES_MAX 4000000
#define CELL_SIDE_MAX_PX 16384
#define CELLS_MAX 100000

/* A scene whose file was read. */
struct known_scene {
    const char *name;
    struct scene_summary summary;
    struct known_scene *next;
};

/* A growing array of cells, each name once. */
struct cell_set {
    struct arena *arena;
    struct known_scene *scenes; /* each file is read once */
    size_t count, capacity;
    size_t asked; /* cells added, those of a name that was there included */
    struct cell *cells;
    size_t slots_count;
    size_t *slots; /* open addressing: index + 1 of a cell, 0: free */
};

/* Splits "a,b,c" at the commas into the arena. Empty items are STATUS_INVALID, named after what. */
enum status text_split(struct arena *arena, const char *what, const char *text, char ***items,
                       size_t *count, struct error *error);

/* What is known of a scene, in the set's arena. */
enum status cell_set_scene(struct cell_set *set, const char *name,
                           const struct scene_summary **summary, struct error *error);
/* cell_parse with the set's scenes. */
enum status cell_set_parse(struct cell_set *set, const char *name, struct cell *cell,
                           struct error *error);

/* Adds a copy of the cell unless a cell of that name is there. STATUS_INVALID after CELLS_MAX. */
enum status cell_set_add(struct cell_set *set, const struct cell *cell, struct error *error);

/* "NAME:opt=1,2,opt=x" to cells that differ in method, method_name and options only; scene and the
 * rest are copied from pattern, then completed from the scene's summary and added. */
enum status method_expand(struct cell_set *set, const char *spec, const struct cell *pattern,
                          const struct scene_summary *summary, struct error *error);

/* One value of a list each, with the error that names it. */
enum status trees_parse(const char *text, size_t *trees, struct error *error);
enum status size_parse(const char *text, int *width_px, int *height_px, struct error *error);
enum status lod_parse(const char *text, enum lod *lod, struct error *error);
enum status target_parse(const char *text, enum target_format *format, struct error *error);
enum status seed_parse(const char *text, uint64_t *seed, struct error *error);

#endif
