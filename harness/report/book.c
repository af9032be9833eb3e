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
static void fill_scalars(struct arena *arena, struct row *row)
{
    const struct summary *summary = row->summary;
    size_t results_count = summary->repetitions + summary->failures, count;
    double *kept = ARENA_ARRAY(arena, double, results_count);
#define FILL(field, unit, better, doc)                                                             \
    count = 0;                                                                                     \
    for (size_t i = 0; i < results_count; i++)                                                     \
        if (summary->results[i]->status == STATUS_OK)                                              \
            kept[count++] = summary->results[i]->field;                                            \
    row->values[COLUMN_##field] = stats_median(kept, count);
    RESULT_COLUMNS(FILL)
#undef FILL
    row->values[COLUMN_frames] = 0;
    for (size_t i = 0; i < results_count; i++)
        if (summary->results[i]->status == STATUS_OK)
            row->values[COLUMN_frames] += (double)summary->results[i]->frames_count;
}

/* The mask's columns stand in the order of MASK_LIST. */
static void fill_masks(struct row *row)
{
    const struct result *seen = row->seen;
    for (size_t k = 0; mask_table[k].field; k++) {
        double sum = 0;
        size_t count = 0;
        for (size_t i = 0; i < seen->views_count; i++) {
            double value = mask_of(&seen->views[i].mask, &mask_table[k]);
            if (seen->views[i].masked && !isnan(value)) {
                sum += value;
                count++;
            }
        }
        row->values[COLUMN_mask_wrong + k] = count ? sum / (double)count : NAN;
    }
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
    fill_masks(row);
    row->compared = !isnan(row->values[COLUMN_same_flip]);
}

/* Work a second, and how much of the machine's limit that is. */
static void fill_rates(struct row *row)
{
    const struct limit *limit = &row->summary->limit;
    double seconds = row->values[COLUMN_frame_seconds];
    row->values[COLUMN_limit_fraction] = limit->fraction.value;
    row->values[COLUMN_limit_fraction_low] = limit->fraction.low;
    row->values[COLUMN_limit_fraction_high] = limit->fraction.high;
    if (!(seconds > 0))
        return;
    row->values[COLUMN_trees_per_second] = (double)row->trees / seconds;
    double rays = row->values[COLUMN_rays], occlusion = row->values[COLUMN_occlusion_rays];
    row->values[COLUMN_rays_per_second] = isnan(rays)        ? occlusion / seconds
                                          : isnan(occlusion) ? rays / seconds
                                                             : (rays + occlusion) / seconds;
    row->values[COLUMN_lookups_per_second] = row->values[COLUMN_lookups] / seconds;
    row->values[COLUMN_samples_per_second] = row->values[COLUMN_samples] / seconds;
    row->values[COLUMN_triangles_per_second] = row->values[COLUMN_triangles] / seconds;
    row->values[COLUMN_fragments_per_second] = row->values[COLUMN_fragments] / seconds;
}

static void fill_row(struct arena *arena, struct row *row)
{
    for (size_t i = 0; i < COLUMNS_COUNT; i++)
        row->values[i] = NAN;
    row->values[COLUMN_repetitions] = (double)row->summary->repetitions;
    row->values[COLUMN_failures] = (double)row->summary->failures;
    if (!row->ok)
        return;
    fill_scalars(arena, row);
    row->values[COLUMN_frame_seconds] = row->summary->frame_seconds.value;
    row->values[COLUMN_frame_seconds_low] = row->summary->frame_seconds.low;
    row->values[COLUMN_frame_seconds_high] = row->summary->frame_seconds.high;
    if (row->values[COLUMN_frame_seconds] > 0)
        row->values[COLUMN_fps] = 1 / row->values[COLUMN_frame_seconds];
    fill_rates(row);
    fill_errors(row);
}

static const char *base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash && slash[1] ? slash + 1 : path;
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

/* What of a cell's name varies and so belongs in its label: lod over the cells of one method, the
 * target format over all. */
struct varying {
    bool *lod; /* a method */
    bool format;
};

static struct varying find_varying(const struct book *book)
{
    struct varying varying = {.lod = ARENA_ARRAY(book->arena, bool, book->methods_count + 1)};
    const struct cell **first =
        ARENA_ARRAY(book->arena, const struct cell *, book->methods_count + 1);
    for (size_t i = 0; i < book->rows_count; i++) {
        const struct row *row = &book->rows[i];
        const struct cell *cell = &row->seen->cell;
        if (!first[row->method_index])
            first[row->method_index] = cell;
        varying.lod[row->method_index] |= first[row->method_index]->lod != cell->lod;
        varying.format |= book->rows[0].seen->cell.format != cell->format;
    }
    return varying;
}

static void label_row(struct arena *arena, struct row *row, const struct varying *varying)
{
    const struct cell *cell = &row->seen->cell;
    const char *comma = cell->options[0] ? ", " : "";
    char *options = arena_strdup(arena, cell->options);
    for (char *c = options; *c; c++)
        if (*c == ',')
            *c = ' ';
    const char *variant = options;
    if (varying->lod[row->method_index] && !row->is_floor) {
        variant = arena_printf(arena, "%s%slod=%s", variant, comma, lod_word(cell->lod));
        comma = ", ";
    }
    if (varying->format)
        variant = arena_printf(arena, "%s%s%s", variant, comma, target_format_word(cell->format));
    row->variant = variant;
    row->label = *variant ? arena_printf(arena, "%s %s", row->method, variant) : row->method;
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

/* The rows are sorted: those of a group follow each other. */
static void find_groups(struct book *book)
{
    struct arena *arena = book->arena;
    book->groups = ARENA_ARRAY(arena, struct group, book->rows_count + 1);
    size_t *places = ARENA_ARRAY(arena, size_t, book->rows_count + 1);
    for (size_t i = 0; i < book->rows_count; i++) {
        struct group group = group_of(&book->rows[i]);
        if (i == 0 || compare_groups(&book->groups[book->groups_count - 1], &group) != 0) {
            group.rows = places + i;
            book->groups[book->groups_count++] = group;
        }
        places[i] = i;
        book->groups[book->groups_count - 1].rows_count++;
        book->rows[i].group = book->groups_count - 1;
    }
}

static void name_groups(struct book *book)
{
    struct arena *arena = book->arena;
    book->families = ARENA_ARRAY(arena, const char *, book->groups_count + 1);
    for (size_t k = 0; k < book->groups_count; k++) {
        struct group *group = &book->groups[k];
        const char *family = family_title(book, group);
        group->family = index_of(book->families, &book->families_count, family);
        group->title =
            arena_printf(arena, "%s, %s tree%s", family,
                         number_plain((double)group->trees, 15).text, plural(group->trees));
        group->slug = slug_of(arena, family, group->trees);
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

static void make_rows(struct book *book)
{
    struct arena *arena = book->arena;
    struct summary *summaries = report_summaries(arena, book->run, &book->rows_count);
    book->rows = ARENA_ARRAY(arena, struct row, book->rows_count + 1);
    book->methods = ARENA_ARRAY(arena, const char *, book->rows_count + 1);
    for (size_t i = 0; i < book->rows_count; i++) {
        struct row *row = &book->rows[i];
        row->summary = &summaries[i];
        row->seen = summaries[i].first;
        row->ok = summaries[i].repetitions > 0;
        row->is_floor = report_is_floor(row->seen);
        row->trees = report_trees(row->seen);
        row->method = base_name(row->seen->cell.method_name);
        fill_row(arena, row);
        book->effects_differ =
            book->effects_differ ||
            (row->compared && !row->is_floor && row->seen->effects != row->seen->scene_effects);
        index_of(book->methods, &book->methods_count, row->method);
    }
    qsort(book->methods, book->methods_count, sizeof *book->methods, compare_texts);
    for (size_t i = 0; i < book->rows_count; i++)
        book->rows[i].method_index =
            index_of(book->methods, &book->methods_count, book->rows[i].method);
}

bool book_knows(const struct book *book, enum column_index column)
{
    for (size_t i = 0; i < book->rows_count; i++)
        if (!isnan(book->rows[i].values[column]))
            return true;
    return false;
}

/* The frame's time stands in any case: it tells what failed. */
static void choose_shown(struct book *book)
{
    book->shown = ARENA_ARRAY(book->arena, struct shown, shown_table_count);
    for (size_t i = 0; i < shown_table_count; i++)
        if (shown_table[i].column == COLUMN_frame_seconds ||
            book_knows(book, shown_table[i].column))
            book->shown[book->shown_count++] = shown_table[i];
}

struct book *book_make(struct arena *arena, const struct run *run)
{
    struct book *book = ARENA_NEW(arena, struct book);
    book->arena = arena;
    book->run = run;
    make_rows(book);
    struct varying varying = find_varying(book);
    for (size_t i = 0; i < book->rows_count; i++)
        label_row(arena, &book->rows[i], &varying);
    qsort(book->rows, book->rows_count, sizeof *book->rows, compare_rows);
    book->series = ARENA_ARRAY(arena, const char *, book->rows_count + 1);
    for (size_t i = 0; i < book->rows_count; i++)
        book->rows[i].series = index_of(book->series, &book->series_count, book->rows[i].label);
    find_groups(book);
    name_groups(book);
    book_find_laws(book);
    choose_shown(book);
    return book;
}

bool book_is_overview(const struct book *book, size_t group)
{
    return group + 1 == book->groups_count ||
           book->groups[group + 1].family != book->groups[group].family;
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
