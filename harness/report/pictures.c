/* The pictures of the page: reference, method, FLIP map, for every view; thumbnails inline, full
 * size as files. */
#include "report/book.h"

#include "base/file.h"
#include "truth/flip.h"
#include "truth/frame.h"
#include "truth/frame_image.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

/* Bytes of thumbnails that a page may hold, and what a pixel of a foliage PNG takes in base64. */
static const double page_bytes = 14e6, bytes_per_pixel = 2.6;

static struct image *image_create(struct arena *arena, int width_px, int height_px, int channels)
{
    struct image *image = ARENA_NEW(arena, struct image);
    *image =
        (struct image){.width_px = width_px, .height_px = height_px, .channels_count = channels};
    image->values =
        ARENA_ARRAY(arena, float, (size_t)width_px *(size_t)height_px *(size_t)channels);
    return image;
}

/* Without the coverage, which is no opacity. */
static struct image *image_of_frame(struct arena *arena, const struct frame *frame)
{
    struct image *image = image_create(arena, frame->width_px, frame->height_px, 3);
    size_t pixels = (size_t)frame->width_px * (size_t)frame->height_px;
    for (size_t i = 0; i < pixels; i++)
        memcpy(image->values + 3 * i, frame->rgba + 4 * i, 3 * sizeof(float));
    return image;
}

/* Averages along one axis; each source value counts by how much of it lies inside the target's. */
static void shrink_axis(const float *source, size_t stride, int count, float *target,
                        size_t target_stride, int target_count)
{
    double step = (double)count / target_count;
    for (int t = 0; t < target_count; t++) {
        double start = t * step, end = start + step, sum = 0;
        for (int s = (int)start; s < count && s < end; s++)
            sum += (fmin(s + 1, end) - fmax(s, start)) * source[(size_t)s * stride];
        target[(size_t)t * target_stride] = (float)(sum / step);
    }
}

/* Box filter in linear light; never enlarges. */
static struct image *image_shrunk(struct arena *arena, const struct image *image, int width_px)
{
    int channels = image->channels_count;
    width_px = width_px < image->width_px ? width_px : image->width_px;
    int height_px = (int)lround((double)image->height_px * width_px / image->width_px);
    height_px = height_px < 1 ? 1 : height_px;
    struct image *rows = image_create(arena, width_px, image->height_px, channels);
    struct image *small = image_create(arena, width_px, height_px, channels);
    size_t stride = (size_t)channels, wide = stride * (size_t)image->width_px;
    size_t narrow = stride * (size_t)width_px;
    for (int y = 0; y < image->height_px; y++)
        for (size_t c = 0; c < stride; c++)
            shrink_axis(image->values + (size_t)y * wide + c, stride, image->width_px,
                        rows->values + (size_t)y * narrow + c, stride, width_px);
    for (size_t x = 0; x < narrow; x++)
        shrink_axis(rows->values + x, narrow, image->height_px, small->values + x, narrow,
                    height_px);
    return small;
}

static void put_base64(FILE *out, const uint8_t *bytes, size_t size)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        size_t left = size - i;
        unsigned bits = (unsigned)bytes[i] << 16;
        bits |= left > 1 ? (unsigned)bytes[i + 1] << 8 : 0;
        bits |= left > 2 ? bytes[i + 2] : 0;
        char four[4] = {digits[bits >> 18], digits[bits >> 12 & 63],
                        left > 1 ? digits[bits >> 6 & 63] : '=',
                        left > 2 ? digits[bits & 63] : '='};
        fwrite(four, 1, 4, out);
    }
}

struct shot {
    struct gallery *gallery;
    struct arena *scratch;
    const char *name; /* file name without folder and ending */
    const char *alt;
    bool is_map;
    FILE *out;
};

static void put_missing(struct gallery *gallery, const char *why, FILE *out)
{
    gallery->missing++;
    fputs("<p class=\"missing\">", out);
    html_put(out, why);
    fputs("</p>", out);
}

/* The thumbnail, linked to the full-size file. */
static void put_image(const struct shot *shot, struct image *image)
{
    struct gallery *gallery = shot->gallery;
    struct error error = {0};
    struct image *small = image_shrunk(shot->scratch, image, gallery->thumbnail_px);
    if (shot->is_map) { /* coloured after shrinking: a mean of colours is no colour of the scale */
        image = map_to_image(shot->scratch, image->values, image->width_px, image->height_px, 1);
        small = map_to_image(shot->scratch, small->values, small->width_px, small->height_px, 1);
    }
    uint8_t *bytes;
    size_t size;
    const char *path =
        arena_printf(shot->scratch, "%s/pictures/%s.png", gallery->out_folder, shot->name);
    enum status status = image_write(path, image, 8, !shot->is_map, &error);
    if (status == STATUS_OK)
        status = image_png(shot->scratch, small, !shot->is_map, &bytes, &size, &error);
    if (status != STATUS_OK) {
        put_missing(gallery, error.text, shot->out);
        return;
    }
    fputs("<a href=\"pictures/", shot->out);
    html_put(shot->out, shot->name);
    fprintf(shot->out, ".png\"><img width=\"%d\" height=\"%d\" alt=\"", small->width_px,
            small->height_px);
    html_put(shot->out, shot->alt);
    fputs("\" src=\"data:image/png;base64,", shot->out);
    put_base64(shot->out, bytes, size);
    fputs("\"></a>", shot->out);
}

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
        put_missing(gallery, error.text, out);
    } else {
        struct arena *scratch = arena_create(0);
        struct shot shot = {gallery, scratch, name, arena_printf(scratch, "reference, %s", what),
                            false,   out};
        put_image(&shot, image_of_frame(scratch, frame));
        arena_destroy(scratch);
        reference->frame = frame;
        reference->features = features_of(arena, frame);
    }
    fputs("</figure>\n", out);
    return reference;
}

static void put_map(struct gallery *gallery, struct arena *scratch, const struct frame *frame,
                    const struct shown_reference *reference, const char *name, const char *label,
                    FILE *out)
{
    if (!reference || !reference->frame) {
        put_missing(gallery, "no FLIP map without the reference", out);
        return;
    }
    struct extent extent = extent_of(frame), other = extent_of(reference->frame);
    if (extent.width_px != other.width_px || extent.height_px != other.height_px) {
        put_missing(
            gallery,
            arena_printf(scratch, "no FLIP map: the picture is %d x %d, the reference %d x %d",
                         extent.width_px, extent.height_px, other.width_px, other.height_px),
            out);
        return;
    }
    struct flip_features features = features_of(scratch, frame);
    struct image *map = image_create(scratch, frame->width_px, frame->height_px, 1);
    flip_map(&features, &reference->features, extent, map->values);
    struct shot shot = {gallery,
                        scratch,
                        arena_printf(scratch, "%s-flip", name),
                        arena_printf(scratch, "FLIP map of %s", label),
                        true,
                        out};
    put_image(&shot, map);
}

static void put_cell(struct gallery *gallery, const struct row *row, size_t view_index,
                     const struct shown_reference *reference, FILE *out)
{
    const struct book *book = gallery->book;
    const struct result_view *view = &row->seen->views[view_index];
    struct arena *scratch = arena_create(0);
    struct error error = {0};
    struct frame *frame = NULL;
    fprintf(out,
            "<figure class=\"card\"><figcaption><svg class=\"mark\" viewBox=\"-1.5 -1.5 3 3\" "
            "aria-hidden=\"true\" style=\"color:var(--%s)\">%s</svg>",
            tint_variable(tint_method(book, row->method_index)),
            symbol_html(book, row->method_index));
    html_put(out, row->label);
    if (view->compared)
        fprintf(out, " <span class=\"soft\">FLIP %s</span>",
                number_plain(view->same.value.flip, 3).text);
    fputs("</figcaption>", out);
    const char *name = arena_printf(scratch, "%s-view%zu-cell%zu", book->groups[row->group].slug,
                                    view_index + 1, (size_t)(row - book->rows) + 1);
    const char *path =
        arena_printf(scratch, "%s/%s", book->run->folder, view->picture ? view->picture : "");
    if (!view->picture || !*view->picture) {
        put_missing(gallery, "the run kept no picture of this view", out);
    } else if (frame_load(scratch, path, &frame, &error) != STATUS_OK ||
               frame_check(frame, &error) != STATUS_OK) {
        put_missing(gallery, error.text, out);
    } else {
        struct shot shot = {gallery, scratch, name, row->label, false, out};
        put_image(&shot, image_of_frame(scratch, frame));
        put_map(gallery, scratch, frame, reference, name, row->label, out);
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

static void put_view(struct gallery *gallery, const struct group *group, size_t view, FILE *out)
{
    const struct book *book = gallery->book;
    struct arena *arena = arena_create(0);
    struct shown_references shown = {.count = 0};
    bool headed = false;
    for (size_t i = 0; i < group->rows_count; i++) {
        const struct row *row = &book->rows[group->rows[i]];
        if (!row->ok || row->seen->views_count <= view || row->is_floor)
            continue;
        const struct result_view *at = &row->seen->views[view];
        if (!headed)
            fprintf(out,
                    "<h4>view %zu <span class=\"soft\">at %s of the path, %s m to the trees"
                    "</span></h4>\n<div class=\"cards\">\n",
                    view + 1, number_plain(at->time, 3).text, number_plain(at->distance_m, 3).text);
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
            fputs("<p class=\"twin\">", out);
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

static size_t views_of(const struct book *book, const struct group *group)
{
    size_t views = 0;
    for (size_t i = 0; i < group->rows_count; i++) {
        const struct row *row = &book->rows[group->rows[i]];
        if (row->ok && !row->is_floor && row->seen->views_count > views)
            views = row->seen->views_count;
    }
    return views;
}

void gallery_start(struct gallery *gallery, const struct book *book, const char *out_folder)
{
    *gallery = (struct gallery){.book = book, .out_folder = out_folder};
    double images = 1;
    for (size_t g = 0; g < book->groups_count; g++)
        images +=
            (double)views_of(book, &book->groups[g]) * (2 + 2 * (double)book->groups[g].rows_count);
    double width = sqrt(page_bytes / bytes_per_pixel / images * 4 / 3);
    gallery->thumbnail_px = (int)fmin(fmax(width, 120), 400) / 8 * 8;
}

void gallery_group(struct gallery *gallery, const struct group *group, FILE *out)
{
    size_t views = views_of(gallery->book, group);
    for (size_t view = 0; view < views; view++)
        put_view(gallery, group, view, out);
    if (views == 0)
        fputs("<p class=\"soft\">No cell of this group has pictures.</p>\n", out);
}
