/* From a run's results to rows, groups of comparable cells, and the labels that tell cells apart.
 */
#include "report/book.h"

#include "base/hash.h"
#include "base/plural.h"
#include "stats/stats.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct metrics *same_value(const struct result_view *view)
{
    return &view->same.value;
}

static const struct metrics *full_value(const struct result_view *view)
{
    return &view->full.value;
}

static const struct metrics *same_floor(const struct result_view *view)
{
    return &view->same.floor;
}

/* One metric's mean over compared views; NaN values do not count. */
static double mean_over_views(const struct result *result,
                              const struct metrics *(*part)(const struct result_view *view),
                              const struct metric_info *info)
{
    double sum = 0;
    size_t count = 0;
    for (size_t i = 0; i < result->views_count; i++) {
        double value = metric_of(part(&result->views[i]), info);
        if (result->views[i].compared && !isnan(value)) {
            sum += value;
            count++;
        }
    }
    return count ? sum / (double)count : NAN;
}

static double mean_standard_error(const struct result *result, bool full)
{
    double sum = 0;
    size_t count = 0;
    for (size_t i = 0; i < result->views_count; i++) {
        const struct result_view *view = &result->views[i];
        double value = full ? view->full_standard_error : view->same_standard_error;
        if (view->compared && !isnan(value)) {
            sum += value;
            count++;
        }
    }
    return count ? sum / (double)count : NAN;
}

/* Medians over the successful repetitions of what a repetition measures once. */
static void fill_scalars(const struct run *run, struct row *row)
{
    double *kept = malloc((run->results_count + 1) * sizeof *kept);
    size_t count = 0;
    row->values[COLUMN_frames] = 0;
#define FILL(field, unit, better, doc)                                                             \
    count = 0;                                                                                     \
    for (size_t i = 0; kept && i < run->results_count; i++)                                        \
        if (run->results[i].status == STATUS_OK &&                                                 \
            strcmp(run->results[i].cell.name, row->seen->cell.name) == 0)                          \
            kept[count++] = run->results[i].field;                                                 \
    row->values[COLUMN_##field] = stats_median(kept, count);
    RESULT_COLUMNS(FILL)
#undef FILL
    for (size_t i = 0; i < run->results_count; i++)
        if (run->results[i].status == STATUS_OK &&
            strcmp(run->results[i].cell.name, row->seen->cell.name) == 0)
            row->values[COLUMN_frames] += (double)run->results[i].frames_count;
    free(kept);
}

static void fill_errors(struct row *row)
{
    const struct result *seen = row->seen;
    /* The columns of a part stand in the order of the table. */
    for (size_t k = 0; metric_table[k].field; k++) {
        const struct metric_info *info = &metric_table[k];
        row->values[COLUMN_same_rmse + k] = mean_over_views(seen, same_value, info);
        row->values[COLUMN_full_rmse + k] = mean_over_views(seen, full_value, info);
        row->values[COLUMN_floor_rmse + k] = mean_over_views(seen, same_floor, info);
    }
    row->values[COLUMN_same_standard_error] = mean_standard_error(seen, false);
    row->values[COLUMN_full_standard_error] = mean_standard_error(seen, true);
    if (seen->has_flicker) {
        row->values[COLUMN_flicker_mean] = seen->flicker.mean;
        row->values[COLUMN_flicker_peak] = seen->flicker.peak;
        row->values[COLUMN_flicker_floor] = seen->flicker.floor;
    }
    row->compared = !isnan(row->values[COLUMN_same_flip]);
}

static void fill_row(const struct run *run, struct row *row)
{
    for (size_t i = 0; i < COLUMNS_COUNT; i++)
        row->values[i] = NAN;
    row->values[COLUMN_repetitions] = (double)row->summary->repetitions;
    row->values[COLUMN_failures] = (double)row->summary->failures;
    if (!row->ok)
        return;
    fill_scalars(run, row);
    row->values[COLUMN_frame_seconds] = row->summary->frame_seconds.value;
    row->values[COLUMN_frame_seconds_low] = row->summary->frame_seconds.low;
    row->values[COLUMN_frame_seconds_high] = row->summary->frame_seconds.high;
    if (row->values[COLUMN_frame_seconds] > 0)
        row->values[COLUMN_fps] = 1 / row->values[COLUMN_frame_seconds];
    fill_errors(row);
}

/* What of a cell's name varies over the run and so belongs in its label. */
struct varying {
    bool lod, format;
};

/* lod: over the cells of the same method; target format: over all. */
static struct varying find_varying(const struct book *book, const struct row *row)
{
    struct varying varying = {false, false};
    const struct cell *cell = &row->seen->cell;
    for (size_t i = 0; i < book->rows_count; i++) {
        const struct cell *other = &book->rows[i].seen->cell;
        bool same_method = strcmp(cell->method_name, other->method_name) == 0;
        varying.lod = varying.lod || (same_method && cell->lod != other->lod);
        varying.format = varying.format || cell->format != other->format;
    }
    return varying;
}

static const char *base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash && slash[1] ? slash + 1 : path;
}

static void label_row(struct arena *arena, struct row *row, struct varying varying)
{
    const struct cell *cell = &row->seen->cell;
    const char *comma = cell->options[0] ? ", " : "";
    char *options = arena_strdup(arena, cell->options);
    for (char *c = options; *c; c++)
        if (*c == ',')
            *c = ' ';
    const char *variant = options;
    if (varying.lod && !row->is_floor) {
        variant = arena_printf(arena, "%s%slod=%s", variant, comma, lod_word(cell->lod));
        comma = ", ";
    }
    if (varying.format)
        variant = arena_printf(arena, "%s%s%s", variant, comma, target_format_word(cell->format));
    row->variant = variant;
    row->method = base_name(cell->method_name);
    row->label = *variant ? arena_printf(arena, "%s %s", row->method, variant) : row->method;
}

/* Index of the text in the list, put at its end when new. */
static size_t index_of(const char **list, size_t *count, const char *text)
{
    size_t i = 0;
    while (i < *count && strcmp(list[i], text) != 0)
        i++;
    if (i == *count)
        list[(*count)++] = text;
    return i;
}

static int compare_texts(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

static int compare_groups(const void *a, const void *b)
{
    const struct group *x = a, *y = b;
    int order = strcmp(x->scene, y->scene);
    if (!order)
        order = (x->width_px > y->width_px) - (x->width_px < y->width_px);
    if (!order)
        order = (x->height_px > y->height_px) - (x->height_px < y->height_px);
    if (!order)
        order = (x->seed > y->seed) - (x->seed < y->seed);
    return order ? order : (x->trees > y->trees) - (x->trees < y->trees);
}

/* "poplar-forest", or with size and seed where the run has several of them for the scene. */
static const char *family_title(const struct book *book, const struct group *group)
{
    bool sizes = false, seeds = false;
    for (size_t i = 0; i < book->groups_count; i++) {
        const struct group *other = &book->groups[i];
        if (strcmp(other->scene, group->scene) != 0)
            continue;
        sizes = sizes || other->width_px != group->width_px || other->height_px != group->height_px;
        seeds = seeds || other->seed != group->seed;
    }
    const char *title = base_name(group->scene);
    if (sizes)
        title = arena_printf(book->arena, "%s, %d x %d", title, group->width_px, group->height_px);
    if (seeds)
        title = arena_printf(book->arena, "%s, seed %llu", title, (unsigned long long)group->seed);
    return title;
}

static char *slug_of(struct arena *arena, const char *title, size_t trees)
{
    char *slug = arena_printf(arena, "%s-%zu", title, trees);
    for (char *c = slug; *c; c++) {
        bool fine = (*c >= 'a' && *c <= 'z') || (*c >= '0' && *c <= '9');
        bool capital = *c >= 'A' && *c <= 'Z';
        *c = fine ? *c : capital ? (char)(*c - 'A' + 'a') : '-';
    }
    return slug;
}

static struct group group_of(const struct row *row)
{
    const struct cell *cell = &row->seen->cell;
    return (struct group){.scene = cell->scene,
                          .trees = row->trees,
                          .width_px = cell->width_px,
                          .height_px = cell->height_px,
                          .seed = cell->seed};
}

static void make_groups(struct book *book)
{
    struct arena *arena = book->arena;
    book->groups = ARENA_ARRAY(arena, struct group, book->rows_count);
    for (size_t i = 0; i < book->rows_count; i++) {
        struct group group = group_of(&book->rows[i]);
        size_t k = 0;
        while (k < book->groups_count && compare_groups(&book->groups[k], &group) != 0)
            k++;
        if (k == book->groups_count)
            book->groups[book->groups_count++] = group;
    }
    qsort(book->groups, book->groups_count, sizeof *book->groups, compare_groups);
    book->families = ARENA_ARRAY(arena, const char *, book->groups_count);
    for (size_t k = 0; k < book->groups_count; k++) {
        struct group *group = &book->groups[k];
        const char *family = family_title(book, group);
        group->family = index_of(book->families, &book->families_count, family);
        group->title =
            arena_printf(arena, "%s, %s tree%s", family,
                         number_plain((double)group->trees, 15).text, plural(group->trees));
        group->slug = slug_of(arena, family, group->trees);
        group->rows = ARENA_ARRAY(arena, size_t, book->rows_count);
        for (size_t i = 0; i < book->rows_count; i++) {
            struct group other = group_of(&book->rows[i]);
            if (compare_groups(group, &other) == 0) {
                group->rows[group->rows_count++] = i;
                book->rows[i].group = k;
            }
        }
    }
}

static int compare_rows(const void *a, const void *b)
{
    const struct row *x = a, *y = b;
    struct group gx = group_of(x), gy = group_of(y);
    int order = compare_groups(&gx, &gy);
    if (!order)
        order = strcmp(x->label, y->label);
    return order ? order : strcmp(x->seen->cell.name, y->seen->cell.name);
}

struct book *book_make(struct arena *arena, const struct run *run)
{
    struct book *book = ARENA_NEW(arena, struct book);
    book->arena = arena;
    book->run = run;
    struct summary *summaries = report_summaries(arena, run, &book->rows_count);
    book->rows = ARENA_ARRAY(arena, struct row, book->rows_count);
    book->methods = ARENA_ARRAY(arena, const char *, book->rows_count);
    book->series = ARENA_ARRAY(arena, const char *, book->rows_count);
    for (size_t i = 0; i < book->rows_count; i++) {
        struct row *row = &book->rows[i];
        row->summary = &summaries[i];
        row->seen = summaries[i].first;
        row->ok = summaries[i].repetitions > 0;
        row->is_floor = report_is_floor(row->seen);
        row->trees = report_trees(row->seen);
        fill_row(run, row);
        book->effects_differ =
            book->effects_differ ||
            (row->compared && !row->is_floor && row->seen->effects != row->seen->scene_effects);
    }
    for (size_t i = 0; i < book->rows_count; i++)
        label_row(arena, &book->rows[i], find_varying(book, &book->rows[i]));
    qsort(book->rows, book->rows_count, sizeof *book->rows, compare_rows);
    for (size_t i = 0; i < book->rows_count; i++)
        index_of(book->methods, &book->methods_count, book->rows[i].method);
    qsort(book->methods, book->methods_count, sizeof *book->methods, compare_texts);
    for (size_t i = 0; i < book->rows_count; i++) {
        struct row *row = &book->rows[i];
        row->method_index = index_of(book->methods, &book->methods_count, row->method);
        row->series = index_of(book->series, &book->series_count, row->label);
    }
    make_groups(book);
    return book;
}

size_t book_front(const struct book *book, const struct group *group, size_t *front)
{
    size_t count = 0;
    for (size_t i = 0; i < group->rows_count; i++) {
        size_t place = count;
        const struct row *row = &book->rows[group->rows[i]];
        if (!row->summary->on_front)
            continue;
        for (; place > 0; place--) {
            const struct row *before = &book->rows[front[place - 1]];
            if (before->values[COLUMN_frame_seconds] <= row->values[COLUMN_frame_seconds])
                break;
            front[place] = front[place - 1];
        }
        front[place] = group->rows[i];
        count++;
    }
    return count;
}
