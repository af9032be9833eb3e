/* The pictures of the page: reference, method, FLIP map, for every view; thumbnails inline, full
 * size as files. */
#include "report/picture.h"

#include "base/file.h"
#include "truth/flip.h"
#include "truth/frame.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

/* Bytes of thumbnails that a page may hold, and what a pixel of a foliage PNG takes in base64. */
static const double page_bytes = 20e6, bytes_per_pixel = 2.6;

static const char *reference_path(struct arena *arena, const struct book *book, uint64_t key)
{
    return arena_printf(arena, "%s/references/%016" PRIx64 ".frame", book->run->folder, key);
}

/* A reference of the view at hand, made ready for FLIP once. */
struct shown_reference {
    uint64_t key;
    const struct frame *frame; /* NULL: could not be read */
    struct flip_features features;
};
enum { REFERENCES_MAX = 16 };
struct shown_references {
    struct shown_reference list[REFERENCES_MAX];
    size_t count;
};

static struct extent extent_of(const struct frame *frame)
{
    return (struct extent){frame->width_px, frame->height_px};
}

static struct flip_features features_of(struct arena *arena, const struct frame *frame)
{
    struct rgb_planes planes = rgb_planes_create(arena, extent_of(frame));
    size_t pixels = extent_count(extent_of(frame));
    for (size_t i = 0; i < pixels; i++)
        for (size_t c = 0; c < 3; c++)
            planes.channels[c][i] = fminf(fmaxf(frame->rgba[4 * i + c], 0), 1);
    return flip_features(arena, &planes, extent_of(frame));
}

/* Shows a reference unless it was; NULL when the view has too many. */
static const struct shown_reference *show_reference(struct gallery *gallery, struct arena *arena,
                                                    struct shown_references *shown, uint64_t key,
                                                    const char *what, const char *name, FILE *out)
{
    for (size_t i = 0; i < shown->count; i++)
        if (shown->list[i].key == key)
            return &shown->list[i];
    if (shown->count == REFERENCES_MAX)
        return NULL;
    struct shown_reference *reference = &shown->list[shown->count++];
    struct error error = {0};
    struct frame *frame = NULL;
    fputs("<figure class=\"card reference\"><figcaption><b>reference</b> ", out);
    html_put(out, what);
    fputs("</figcaption>", out);
    *reference = (struct shown_reference){.key = key};
    if (frame_load(arena, reference_path(arena, gallery->book, key), &frame, &error) != STATUS_OK ||
        frame_check(frame, &error) != STATUS_OK) {
        picture_missing(gallery, error.text, out);
    } else {
        struct arena *scratch = arena_create(0);
        struct picture picture = {gallery,
                                  scratch,
                                  PICTURE_DRAWN,
                                  name,
                                  arena_printf(scratch, "reference, %s", what),
                                  arena_printf(scratch, "data-key=\"%016" PRIx64 "\"", key)};
        picture_put(&picture, picture_of_frame(scratch, frame), out);
        arena_destroy(scratch);
        reference->frame = frame;
        reference->features = features_of(arena, frame);
    }
    fputs("</figure>\n", out);
    return reference;
}

/* What the script knows a picture of a cell by. */
static const char *attributes_of(struct arena *arena, const struct book *book,
                                 const struct row *row, size_t view_index, const char *kind)
{
    const struct result_view *view = &row->seen->views[view_index];
    return arena_printf(arena,
                        "data-row=\"%zu\" data-view=\"%zu\" data-kind=\"%s\" "
                        "data-same=\"%016" PRIx64 "\" data-full=\"%016" PRIx64 "\"",
                        (size_t)(row - book->rows), view_index, kind, view->same_key,
                        view->full_key);
}

static struct image *flip_image(struct arena *arena, const struct frame *frame,
                                const struct shown_reference *reference)
{
    struct flip_features features = features_of(arena, frame);
    struct image *map = picture_create(arena, frame->width_px, frame->height_px, 1);
    flip_map(&features, &reference->features, extent_of(frame), map->values);
    return map;
}

static struct image *coverage_image(struct arena *arena, const struct frame *frame,
                                    const struct frame *reference)
{
    struct image *map = picture_create(arena, frame->width_px, frame->height_px, 1);
    size_t pixels = extent_count(extent_of(frame));
    for (size_t i = 0; i < pixels; i++)
        map->values[i] = frame->rgba[4 * i + 3] - reference->rgba[4 * i + 3];
    return map;
}

static void put_maps(struct gallery *gallery, struct arena *scratch, const struct row *row,
                     size_t view, const struct frame *frame,
                     const struct shown_reference *reference, const char *name, FILE *out)
{
    if (!reference || !reference->frame) {
        picture_missing(gallery, "no error maps without the reference", out);
        return;
    }
    struct extent extent = extent_of(frame), other = extent_of(reference->frame);
    if (extent.width_px != other.width_px || extent.height_px != other.height_px) {
        picture_missing(
            gallery,
            arena_printf(scratch, "no error maps: the picture is %d x %d, the reference %d x %d",
                         extent.width_px, extent.height_px, other.width_px, other.height_px),
            out);
        return;
    }
    const struct book *book = gallery->book;
    struct picture flip = {gallery,
                           scratch,
                           PICTURE_FLIP,
                           arena_printf(scratch, "%s-flip", name),
                           arena_printf(scratch, "FLIP map of %s", row->label),
                           attributes_of(scratch, book, row, view, "flip")};
    struct picture coverage = {gallery,
                               scratch,
                               PICTURE_COVERAGE,
                               arena_printf(scratch, "%s-coverage", name),
                               arena_printf(scratch, "coverage map of %s", row->label),
                               attributes_of(scratch, book, row, view, "coverage")};
    fputs("<span class=\"maps\">", out);
    picture_put(&flip, flip_image(scratch, frame, reference), out);
    picture_put(&coverage, coverage_image(scratch, frame, reference->frame), out);
    fputs("</span>", out);
}

static void put_cell(struct gallery *gallery, const struct row *row, size_t view_index,
                     const struct shown_reference *reference, FILE *out)
{
    const struct book *book = gallery->book;
    const struct result_view *view = &row->seen->views[view_index];
    struct arena *scratch = arena_create(0);
    struct error error = {0};
    struct frame *frame = NULL;
    fputs("<figure class=\"card\"><figcaption>", out);
    html_put_label(out, book, row);
    if (view->compared)
        fprintf(out, " <span class=\"soft\">FLIP %s</span>",
                number_plain(view->same.value.flip, 3).text);
    fputs("</figcaption>", out);
    const char *name = arena_printf(scratch, "%s-view%zu-cell%zu", book->groups[row->group].slug,
                                    view_index + 1, (size_t)(row - book->rows) + 1);
    const char *path =
        arena_printf(scratch, "%s/%s", book->run->folder, view->picture ? view->picture : "");
    if (!view->picture || !*view->picture) {
        picture_missing(gallery, "the run kept no picture of this view", out);
    } else if (frame_load(scratch, path, &frame, &error) != STATUS_OK ||
               frame_check(frame, &error) != STATUS_OK) {
        picture_missing(gallery, error.text, out);
    } else {
        struct picture picture = {
            gallery, scratch,    PICTURE_DRAWN,
            name,    row->label, attributes_of(scratch, book, row, view_index, "picture")};
        picture_put(&picture, picture_of_frame(scratch, frame), out);
        put_maps(gallery, scratch, row, view_index, frame, reference, name, out);
    }
    fputs("</figure>\n", out);
    arena_destroy(scratch);
}

/* A cell of the group, before this one, with the same picture against the same reference. */
static const struct row *twin_of(const struct book *book, const struct group *group, size_t place,
                                 size_t view)
{
    const struct row *row = &book->rows[group->rows[place]];
    for (size_t i = 0; i < place; i++) {
        const struct row *other = &book->rows[group->rows[i]];
        if (other->ok && other->seen->views_count > view &&
            other->seen->views[view].picture_hash == row->seen->views[view].picture_hash &&
            other->seen->views[view].same_key == row->seen->views[view].same_key)
            return other;
    }
    return NULL;
}

static bool is_shown(const struct gallery *gallery, const struct row *row)
{
    return row->ok && !row->is_floor && (!gallery->front_only || row->summary->on_front);
}

static void put_view(struct gallery *gallery, const struct group *group, size_t view, FILE *out)
{
    const struct book *book = gallery->book;
    struct arena *arena = arena_create(0);
    struct shown_references shown = {.count = 0};
    bool headed = false;
    for (size_t i = 0; i < group->rows_count; i++) {
        const struct row *row = &book->rows[group->rows[i]];
        if (!is_shown(gallery, row) || row->seen->views_count <= view)
            continue;
        const struct result_view *at = &row->seen->views[view];
        if (!headed)
            fprintf(
                out,
                "<h4>view %zu <span class=\"soft\">at %s of the path, %s m to the trees, the eye "
                "%s\u00b0 up, at azimuth %s\u00b0</span></h4>\n<div class=\"cards\">\n",
                view + 1, number_plain(at->time, 3).text, number_plain(at->distance_m, 3).text,
                number_plain(at->elevation_deg, 2).text, number_plain(at->azimuth_deg, 3).text);
        headed = true;
        const char *name =
            arena_printf(arena, "%s-view%zu-reference%zu", group->slug, view + 1, shown.count + 1);
        if (row->seen->effects != row->seen->scene_effects)
            show_reference(gallery, arena, &shown, at->full_key, "with all effects", name, out);
        name =
            arena_printf(arena, "%s-view%zu-reference%zu", group->slug, view + 1, shown.count + 1);
        const char *what = row->seen->effects == row->seen->scene_effects
                               ? "with all effects"
                               : arena_printf(arena, "with the effects of %s", row->method);
        const struct shown_reference *reference =
            show_reference(gallery, arena, &shown, at->same_key, what, name, out);
        const struct row *twin = twin_of(book, group, i, view);
        if (twin) {
            fprintf(out, "<p class=\"twin\" data-row=\"%zu\" data-view=\"%zu\" data-as=\"%zu\">",
                    group->rows[i], view, (size_t)(twin - book->rows));
            html_put(out, row->label);
            fputs(": the same picture as ", out);
            html_put(out, twin->label);
            fputs("</p>\n", out);
        } else {
            put_cell(gallery, row, view, reference, out);
        }
    }
    fputs(headed ? "</div>\n" : "", out);
    arena_destroy(arena);
}

/* How many views of the group's cells are shown, and (images) how many pictures that are, a map
 * counting a quarter. */
static size_t views_of(const struct gallery *gallery, const struct group *group, double *images)
{
    size_t views = 0;
    for (size_t i = 0; i < group->rows_count; i++) {
        const struct row *row = &gallery->book->rows[group->rows[i]];
        size_t count = row->seen->views_count;
        count = gallery->first_view_only && count > 1 ? 1 : count;
        if (!is_shown(gallery, row))
            continue;
        *images += 1.5 * (double)count;
        views = count > views ? count : views;
    }
    *images += 2 * (double)views;
    return views;
}

static double images_of(const struct gallery *gallery)
{
    double images = 1;
    const struct book *book = gallery->book;
    for (size_t g = 0; g < book->groups_count; g++)
        if (gallery_shows(gallery, &book->groups[g]))
            views_of(gallery, &book->groups[g], &images);
    return images;
}

bool gallery_shows(const struct gallery *gallery, const struct group *group)
{
    return !gallery->overview_only ||
           book_is_overview(gallery->book, (size_t)(group - gallery->book->groups));
}

void gallery_start(struct gallery *gallery, const struct book *book, const char *out_folder)
{
    *gallery = (struct gallery){.book = book, .out_folder = out_folder};
    /* Fewer pictures before smaller ones than this. */
    const double smallest_px = 160 * 120, images_max = page_bytes / bytes_per_pixel / smallest_px;
    gallery->overview_only = images_of(gallery) > images_max;
    gallery->first_view_only = images_of(gallery) > images_max;
    gallery->front_only = images_of(gallery) > images_max;
    double width = sqrt(page_bytes / bytes_per_pixel / images_of(gallery) * 4 / 3);
    gallery->thumbnail_px = (int)fmin(fmax(width, 120), 480) / 8 * 8;
}

void gallery_group(struct gallery *gallery, const struct group *group, FILE *out)
{
    double images = 0;
    size_t views = views_of(gallery, group, &images);
    for (size_t view = 0; view < views; view++)
        put_view(gallery, group, view, out);
    if (views == 0)
        fputs("<p class=\"soft\">No cell of this group has pictures.</p>\n", out);
}
