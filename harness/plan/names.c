/* One cell and its name: values from text, a method's swept options, names that can be pasted back.
 */
#include "plan/names.h"

#include "base/hash.h"
#include "truth/frame.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum status text_split(struct arena *arena, const char *what, const char *text, char ***items,
                       size_t *count, struct error *error)
{
    size_t n = 1;
    for (const char *c = text; *c; c++)
        n += *c == ',';
    *items = ARENA_ARRAY(arena, char *, n);
    *count = n;
    char *rest = arena_strdup(arena, text);
    for (size_t i = 0; i < n; i++) {
        char *item = strsep(&rest, ",");
        if (!*item)
            return error_set(error, STATUS_INVALID, "%s: '%s' has an empty item", what, text);
        (*items)[i] = item;
    }
    return STATUS_OK;
}

static bool whole_number(const char *text, uint64_t limit, uint64_t *value)
{
    char *end;
    if (*text < '0' || *text > '9')
        return false;
    errno = 0;
    unsigned long long number = strtoull(text, &end, 10);
    *value = number;
    return !errno && !*end && number <= limit;
}

enum status trees_parse(const char *text, size_t *trees, struct error *error)
{
    uint64_t value = 0;
    if (!whole_number(text, CELL_TREES_MAX, &value))
        return error_set(error, STATUS_INVALID, "trees: '%s' is not a whole number in 0..%d", text,
                         CELL_TREES_MAX);
    *trees = (size_t)value;
    return STATUS_OK;
}

enum status seed_parse(const char *text, uint64_t *seed, struct error *error)
{
    if (!whole_number(text, UINT64_MAX, seed))
        return error_set(error, STATUS_INVALID, "seed: '%s' is not a whole number in 0..2^64-1",
                         text);
    return STATUS_OK;
}

enum status size_parse(const char *text, int *width_px, int *height_px, struct error *error)
{
    uint64_t width = 0, height = 0;
    char part[16] = "";
    const char *cross = strchr(text, 'x');
    if (cross && cross - text < (int)sizeof part)
        memcpy(part, text, (size_t)(cross - text));
    if (!cross || !whole_number(part, CELL_SIDE_MAX_PX, &width) || !width ||
        !whole_number(cross + 1, CELL_SIDE_MAX_PX, &height) || !height)
        return error_set(error, STATUS_INVALID,
                         "size: '%s' is not WIDTHxHEIGHT in pixels, each in 1..%d", text,
                         CELL_SIDE_MAX_PX);
    *width_px = (int)width;
    *height_px = (int)height;
    return STATUS_OK;
}

enum status lod_parse(const char *text, enum lod *lod, struct error *error)
{
    if (!lod_from_word(text, lod))
        return error_set(error, STATUS_INVALID,
                         "lod: '%s' is not one of low|intermediate|high|auto", text);
    return STATUS_OK;
}

enum status target_parse(const char *text, enum target_format *format, struct error *error)
{
    if (!target_format_from_word(text, format))
        return error_set(error, STATUS_INVALID, "target: '%s' is not one of rgba8|rgba16f|rgba32f",
                         text);
    return STATUS_OK;
}

/* The options as the table prints them, only what differs from the defaults. */
static enum status options_canonical(struct arena *arena, struct cell *cell, struct error *error)
{
    const struct method *method = cell->method;
    if (!method->options) {
        if (cell->options && *cell->options)
            return error_set(error, STATUS_INVALID, "%s: '%s': this method has no options",
                             cell->method_name, cell->options);
        cell->options = "";
        return STATUS_OK;
    }
    void *values = arena_alloc(arena, 1, method->options_size);
    options_default(method->options, values);
    enum status status = options_parse(method->options, cell->options, values, error);
    if (status)
        return error_context(error, "%s", cell->method_name);
    size_t length = options_print(method->options, values, NULL, 0);
    char *text = arena_alloc(arena, length + 1, 1);
    options_print(method->options, values, text, length + 1);
    cell->options = text;
    return STATUS_OK;
}

/* Fills what is missing (trees SIZE_MAX, width_px 0) from the scene's summary, makes the options
 * canonical, and gives the cell its name. A picture above FRAME_PIXELS_MAX is refused. */
static enum status cell_complete(struct arena *arena, struct cell *cell,
                                 const struct scene_summary *summary, struct error *error)
{
    enum status status = options_canonical(arena, cell, error);
    if (status)
        return status;
    if (cell->trees == SIZE_MAX)
        cell->trees = summary->default_trees;
    if (!cell->width_px) {
        cell->width_px = summary->width_px;
        cell->height_px = summary->height_px;
    }
    if (cell->width_px > FRAME_PIXELS_MAX / cell->height_px)
        return error_set(error, STATUS_INVALID,
                         "size: '%dx%d' has %lld pixels; at most %d are allowed", cell->width_px,
                         cell->height_px, (long long)cell->width_px * cell->height_px,
                         FRAME_PIXELS_MAX);
    cell->name =
        arena_printf(arena, "%s/%s%s%s/trees=%zu/lod=%s/size=%dx%d/target=%s/seed=%llu",
                     cell->scene, cell->method_name, *cell->options ? ":" : "", cell->options,
                     cell->trees, lod_word(cell->lod), cell->width_px, cell->height_px,
                     target_format_word(cell->format), (unsigned long long)cell->seed);
    return STATUS_OK;
}

/* Sets one "key=value" part of a name; false when the key is none of a name's. */
static bool part_set(struct cell *cell, const char *part, enum status *status, struct error *error)
{
    const char *value = strchr(part, '=');
    if (!value)
        return false;
    value++;
    if (!strncmp(part, "trees=", 6))
        *status = trees_parse(value, &cell->trees, error);
    else if (!strncmp(part, "lod=", 4))
        *status = lod_parse(value, &cell->lod, error);
    else if (!strncmp(part, "size=", 5))
        *status = size_parse(value, &cell->width_px, &cell->height_px, error);
    else if (!strncmp(part, "target=", 7))
        *status = target_parse(value, &cell->format, error);
    else if (!strncmp(part, "seed=", 5))
        *status = seed_parse(value, &cell->seed, error);
    else
        return false;
    return true;
}

/* Which of a name's keys a "key=value" part begins with, as one bit; 0: none. */
static unsigned part_bit(const char *part)
{
    static const char *const keys[] = {"trees=", "lod=", "size=", "target=", "seed="};
    for (unsigned i = 0; i < sizeof keys / sizeof *keys; i++)
        if (!strncmp(part, keys[i], strlen(keys[i])))
            return 1u << i;
    return 0;
}

/* Where the scene ends in "SCENE/METHOD": behind ".json", else at the first slash. */
static char *scene_end(char *text)
{
    char *json = strstr(text, ".json/");
    return json ? json + strlen(".json") : strchr(text, '/');
}

enum status cell_set_scene(struct cell_set *set, const char *name,
                           const struct scene_summary **summary, struct error *error)
{
    struct known_scene *known = set->scenes;
    while (known && strcmp(known->name, name) != 0)
        known = known->next;
    if (!known) {
        known = ARENA_NEW(set->arena, struct known_scene);
        known->name = arena_strdup(set->arena, name);
        enum status status = scene_summary(set->arena, name, &known->summary, error);
        if (status)
            return status;
        known->next = set->scenes;
        set->scenes = known;
    }
    *summary = &known->summary;
    return STATUS_OK;
}

enum status cell_parse(struct arena *arena, const char *name, struct cell *cell,
                       struct error *error)
{
    return cell_set_parse(&(struct cell_set){.arena = arena}, name, cell, error);
}

enum status cell_set_parse(struct cell_set *set, const char *name, struct cell *cell,
                           struct error *error)
{
    struct arena *arena = set->arena;
    *cell = (struct cell){
        .trees = SIZE_MAX, .lod = LOD_AUTO, .format = TARGET_RGBA16F, .seed = CELL_SEED};
    char *text = arena_strdup(arena, name);
    enum status status = STATUS_OK;
    unsigned seen = 0;
    for (char *slash = strrchr(text, '/'); slash && part_set(cell, slash + 1, &status, error);
         slash = strrchr(text, '/')) {
        if (status)
            return error_context(error, "cell '%s'", name);
        if (seen & part_bit(slash + 1))
            return error_set(error, STATUS_INVALID, "cell '%s': '%.*s' stands twice", name,
                             (int)strcspn(slash + 1, "="), slash + 1);
        seen |= part_bit(slash + 1);
        *slash = 0;
    }
    char *slash = scene_end(text);
    if (!slash || slash == text || !slash[1])
        return error_set(error, STATUS_INVALID,
                         "cell '%s': a cell is SCENE/METHOD[:opt=val,...][/trees=N][/lod=L]"
                         "[/size=WxH][/target=F][/seed=S]",
                         name);
    *slash = 0;
    cell->scene = text;
    char *method = slash + 1;
    char *last = strrchr(method, '/');
    char *colon = strchr(last ? last : method, ':');
    if (colon)
        *colon = 0;
    cell->method_name = method;
    cell->options = colon ? colon + 1 : "";
    const struct scene_summary *summary;
    status = method_find(method, &cell->method, error);
    if (!status)
        status = cell_set_scene(set, cell->scene, &summary, error);
    if (!status)
        status = cell_complete(arena, cell, summary, error);
    return status ? error_context(error, "cell '%s'", name) : STATUS_OK;
}

static size_t *cell_set_slot(const struct cell_set *set, const char *name)
{
    size_t i = hash_text(0, name) & (set->slots_count - 1);
    while (set->slots[i] && strcmp(set->cells[set->slots[i] - 1].name, name) != 0)
        i = (i + 1) & (set->slots_count - 1);
    return &set->slots[i];
}

static void cell_set_grow(struct cell_set *set)
{
    struct cell *old = set->cells;
    set->capacity = set->capacity ? set->capacity * 2 : 64;
    set->cells = ARENA_ARRAY(set->arena, struct cell, set->capacity);
    if (set->count)
        memcpy(set->cells, old, set->count * sizeof *old);
    set->slots_count = set->capacity * 4;
    set->slots = ARENA_ARRAY(set->arena, size_t, set->slots_count);
    for (size_t i = 0; i < set->count; i++)
        *cell_set_slot(set, set->cells[i].name) = i + 1;
}

enum status cell_set_add(struct cell_set *set, const struct cell *cell, struct error *error)
{
    if (set->asked++ == CELLS_MAX)
        return error_set(error, STATUS_INVALID, "the plan asks for more than %d cells", CELLS_MAX);
    if (set->count == set->capacity)
        cell_set_grow(set);
    size_t *slot = cell_set_slot(set, cell->name);
    if (*slot)
        return STATUS_OK;
    set->cells[set->count++] = *cell;
    *slot = set->count;
    return STATUS_OK;
}

/* One swept option: its name and the values it takes. */
struct sweep {
    const char *name;
    size_t values_count, value; /* value: the one in turn */
    char **values;
};

/* "views=8,16,alpha=test" to sweeps: an item without '=' is one more value of the option before it.
 */
static enum status sweeps_parse(struct arena *arena, const char *spec, const char *options,
                                struct sweep **sweeps, size_t *count, struct error *error)
{
    char **items;
    size_t items_count;
    enum status status = text_split(arena, spec, options, &items, &items_count, error);
    if (status)
        return status;
    *sweeps = ARENA_ARRAY(arena, struct sweep, items_count);
    *count = 0;
    for (size_t i = 0; i < items_count; i++) {
        char *value = strchr(items[i], '=');
        if (!value && !*count)
            return error_set(error, STATUS_INVALID, "%s: '%s' is not option=value", spec, items[i]);
        if (value) {
            *value++ = 0;
            for (size_t k = 0; k < *count; k++)
                if (!strcmp((*sweeps)[k].name, items[i]))
                    return error_set(error, STATUS_INVALID,
                                     "%s: '%s' stands twice; values of one option are listed as "
                                     "%s=A,B",
                                     spec, items[i], items[i]);
            (*sweeps)[*count].name = items[i];
            (*sweeps)[*count].values = ARENA_ARRAY(arena, char *, items_count);
            ++*count;
        }
        struct sweep *sweep = &(*sweeps)[*count - 1];
        sweep->values[sweep->values_count++] = value ? value : items[i];
    }
    return STATUS_OK;
}

/* The next combination, the last option turning fastest; false after the last one. */
static bool sweeps_next(struct sweep *sweeps, size_t count)
{
    for (size_t i = count; i-- > 0;) {
        if (++sweeps[i].value < sweeps[i].values_count)
            return true;
        sweeps[i].value = 0;
    }
    return false;
}

enum status method_expand(struct cell_set *set, const char *spec, const struct cell *pattern,
                          const struct scene_summary *summary, struct error *error)
{
    struct arena *arena = set->arena;
    char *name = arena_strdup(arena, spec);
    char *last = strrchr(name, '/');
    char *colon = strchr(last ? last : name, ':');
    struct sweep *sweeps = NULL;
    size_t count = 0;
    enum status status = STATUS_OK;
    if (colon) {
        *colon = 0;
        if (colon[1])
            status = sweeps_parse(arena, spec, colon + 1, &sweeps, &count, error);
    }
    struct cell cell = *pattern;
    cell.method_name = name;
    if (!status)
        status = method_find(name, &cell.method, error);
    if (status)
        return status;
    do {
        char *options = arena_strdup(arena, "");
        for (size_t i = 0; i < count; i++)
            options = arena_printf(arena, "%s%s%s=%s", options, i ? "," : "", sweeps[i].name,
                                   sweeps[i].values[sweeps[i].value]);
        struct cell one = cell;
        one.options = options;
        status = cell_complete(arena, &one, summary, error);
        if (!status)
            status = cell_set_add(set, &one, error);
        if (status)
            return status;
    } while (sweeps_next(sweeps, count));
    return STATUS_OK;
}
