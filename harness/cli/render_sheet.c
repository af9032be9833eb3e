/* treeline render --sheet: a labelled contact sheet, the reference and each method at several
 * distances. */
#include "base/file.h"
#include "base/plural.h"
#include "cell/cell.h"
#include "cli/render.h"
#include "report/plot.h"
#include "scene/camera.h"
#include "truth/metrics.h"
#include "truth/reference.h"
#include "wall/gnuplot.h"
#include "wall/image.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MARGIN_PX = 14, GAP_PX = 10, TITLE_PX = 34, NAME_PX = 24, CAPTION_PX = 20 };
static const double drawing_seconds = 60;

struct sheet {
    struct arena *arena;
    const struct render_request *request;
    const struct scene *scene;
    struct cell cells[RENDER_METHODS_MAX];
    size_t columns, rows; /* row 0: the reference */
    double distances_m[RENDER_DISTANCES_MAX];
    struct view views[RENDER_DISTANCES_MAX];
    struct frame *references[RENDER_DISTANCES_MAX];
    struct image *image; /* linear */
    FILE *labels;        /* gnuplot's script, into text */
    char *text;
    size_t text_size;
    size_t labels_count, row;
};

static int left_px(const struct sheet *sheet, size_t column)
{
    return MARGIN_PX + (int)column * (sheet->scene->width_px + GAP_PX);
}

static int top_px(const struct sheet *sheet, size_t row)
{
    return TITLE_PX + NAME_PX + (int)row * (sheet->scene->height_px + NAME_PX + CAPTION_PX);
}

static void put_label(struct sheet *sheet, int x_px, int y_px, const char *font, const char *text)
{
    fprintf(sheet->labels, "set label %zu ", ++sheet->labels_count);
    plot_text(sheet->labels, text);
    fprintf(sheet->labels, " at screen %.6f, screen %.6f left noenhanced font \"sans%s\"\n",
            (double)x_px / sheet->image->width_px, 1 - (double)y_px / sheet->image->height_px,
            font);
}

static void put_name(struct sheet *sheet, size_t row, const char *name)
{
    put_label(sheet, MARGIN_PX, top_px(sheet, row) - NAME_PX / 2 + 2, " Bold,11", name);
}

static void put_caption(struct sheet *sheet, size_t row, size_t column, const char *text)
{
    put_label(sheet, left_px(sheet, column),
              top_px(sheet, row) + sheet->scene->height_px + CAPTION_PX / 2, ",10", text);
}

static void paste(struct sheet *sheet, size_t row, size_t column, const struct frame *frame)
{
    struct image *image = sheet->image;
    for (int y = 0; y < frame->height_px; y++)
        for (int x = 0; x < frame->width_px; x++) {
            size_t at = (size_t)(top_px(sheet, row) + y) * (size_t)image->width_px +
                        (size_t)(left_px(sheet, column) + x);
            memcpy(image->values + 3 * at,
                   frame->rgba + 4 * ((size_t)y * (size_t)frame->width_px + (size_t)x),
                   3 * sizeof(float));
        }
}

/* Eye and target of the view that the sheet starts from, in scene.json's coordinates. */
static void own_camera(const struct sheet *sheet, double eye_m[3], double target_m[3])
{
    const struct cli_shot *shot = &sheet->request->shot;
    const struct scene *scene = sheet->scene;
    float eye[3], target[3];
    camera_at(scene, shot->time, eye, target);
    for (int k = 0; k < 3; k++) {
        eye_m[k] = shot->has_eye ? shot->eye_m[k] : scene->origin_m[k] + (double)eye[k];
        target_m[k] = shot->has_eye ? shot->target_m[k] : scene->origin_m[k] + (double)target[k];
    }
}

/* The eye moves on the line through the view's target; it stays above the ground. */
static enum status place_views(struct sheet *sheet, struct error *error)
{
    const struct render_request *request = sheet->request;
    const struct scene *scene = sheet->scene;
    struct cli_shot shot = request->shot;
    double eye_m[3], own_m = 0;
    own_camera(sheet, eye_m, shot.target_m);
    for (int k = 0; k < 3; k++)
        own_m += (eye_m[k] - shot.target_m[k]) * (eye_m[k] - shot.target_m[k]);
    own_m = sqrt(own_m);
    if (!(own_m >= 1e-3))
        return error_set(error, STATUS_USAGE,
                         "--sheet: the eye is %g m from the target; at least 0.001 m give the "
                         "direction of the distances",
                         own_m);
    shot.has_eye = shot.has_target = true;
    sheet->columns = request->distances_count ? request->distances_count : 4;
    for (size_t i = 0; i < sheet->columns; i++) {
        double distance_m =
            request->distances_count ? request->distances_m[i] : own_m * 0.25 * (1 << i);
        for (int k = 0; k < 3; k++)
            shot.eye_m[k] = shot.target_m[k] + distance_m / own_m * (eye_m[k] - shot.target_m[k]);
        double ground_m =
            (double)terrain_height(&scene->terrain, (float)(shot.eye_m[0] - scene->origin_m[0]),
                                   (float)(shot.eye_m[2] - scene->origin_m[2]));
        shot.eye_m[1] = fmax(shot.eye_m[1], ground_m + (double)scene->camera.clearance_m);
        cli_shot_view(&shot, scene, &sheet->views[i]);
        sheet->distances_m[i] = distance_m;
    }
    return STATUS_OK;
}

static const char *distance_text(const struct sheet *sheet, size_t column)
{
    double distance_m = sheet->distances_m[column];
    return arena_printf(sheet->arena, distance_m < 1000 ? "%.3g m" : "%.0f m", distance_m);
}

static enum status draw_references(struct sheet *sheet, struct error *error)
{
    struct reference_options options = {.effects = sheet->scene->effects,
                                        .standard_error = 0.006f,
                                        .samples_max = 1024,
                                        .seed = sheet->cells[0].seed,
                                        .quiet = sheet->request->shot.quiet};
    put_name(sheet, 0, "reference, ray traced with all effects");
    enum status status = STATUS_OK;
    for (size_t i = 0; i < sheet->columns && !status; i++) {
        struct reference_stats stats;
        status = reference_cached(sheet->arena, sheet->scene, &sheet->views[i], &options,
                                  &sheet->references[i], &stats, error);
        if (status)
            break;
        paste(sheet, 0, i, sheet->references[i]);
        put_caption(sheet, 0, i, distance_text(sheet, i));
    }
    return status;
}

static enum status take(void *context, size_t index, const struct frame *frame, struct error *error)
{
    struct sheet *sheet = context;
    struct comparison comparison;
    struct arena *scratch = arena_create(0);
    enum status status =
        metrics_compare(scratch, frame, sheet->references[index], &comparison, NULL, error);
    arena_destroy(scratch);
    if (status)
        return status;
    paste(sheet, sheet->row, index, frame);
    put_caption(sheet, sheet->row, index,
                arena_printf(sheet->arena, "%s, FLIP %.3f", distance_text(sheet, index),
                             comparison.value.flip));
    return STATUS_OK;
}

static enum status draw_methods(struct sheet *sheet, struct error *error)
{
    enum status status = STATUS_OK;
    for (size_t m = 0; m + 1 < sheet->rows && !status; m++) {
        const struct cell *cell = &sheet->cells[m];
        sheet->row = m + 1;
        put_name(sheet, sheet->row,
                 arena_printf(sheet->arena, "%s %s", cell->method_name, cell->options));
        struct cell_taker taker = {take, sheet};
        status = cell_render_views(cell, sheet->views, sheet->columns, sheet->request->shot.backend,
                                   &taker, error);
    }
    return status;
}

/* gnuplot writes the letters; they stand where no picture does. */
static enum status put_letters(struct sheet *sheet, const char *folder, struct error *error)
{
    struct arena *arena = sheet->arena;
    struct image *image = sheet->image, *letters;
    fputs("plot 2 notitle\n", sheet->labels);
    fflush(sheet->labels);
    const char *script = arena_printf(arena, "%s/labels.gp", folder);
    const char *picture = arena_printf(arena, "%s/labels.png", folder);
    enum status status = file_write(script, sheet->text, sheet->text_size, error);
    if (!status)
        status = gnuplot_run(folder, "labels.gp", drawing_seconds, error);
    if (!status)
        status = image_read(arena, picture, true, &letters, error);
    unlink(script);
    unlink(picture);
    if (status)
        return status;
    if (letters->width_px != image->width_px || letters->height_px != image->height_px)
        return error_set(error, STATUS_IO, "gnuplot drew %d x %d letters for a sheet of %d x %d",
                         letters->width_px, letters->height_px, image->width_px, image->height_px);
    size_t pixels = (size_t)image->width_px * (size_t)image->height_px;
    size_t channels = (size_t)letters->channels_count;
    for (size_t i = 0; i < pixels; i++)
        for (size_t c = 0; c < 3 && isnan(image->values[3 * i + c]); c++)
            image->values[3 * i + c] = letters->values[channels * i + (channels < 3 ? 0 : c)];
    return STATUS_OK;
}

/* Paper is NaN until the letters come. */
static enum status lay_out(struct sheet *sheet, struct error *error)
{
    int width_px = left_px(sheet, sheet->columns) - GAP_PX + MARGIN_PX;
    int height_px = top_px(sheet, sheet->rows) - NAME_PX + MARGIN_PX;
    if ((double)width_px * height_px * 3 > IMAGE_VALUES_MAX)
        return error_set(error, STATUS_USAGE,
                         "--sheet: %zu x %zu pictures make %d x %d pixels; allowed: %d values; "
                         "take a smaller --size",
                         sheet->columns, sheet->rows, width_px, height_px, IMAGE_VALUES_MAX);
    struct image *image = ARENA_NEW(sheet->arena, struct image);
    size_t values = 3 * (size_t)width_px * (size_t)height_px;
    *image = (struct image){width_px, height_px, 3, ARENA_ARRAY(sheet->arena, float, values), NULL};
    for (size_t i = 0; i < values; i++)
        image->values[i] = NAN;
    sheet->image = image;
    fprintf(sheet->labels,
            "set terminal pngcairo size %d,%d font \"sans,11\" background \"#ffffff\"\n"
            "set output \"labels.png\"\nunset border\nunset tics\nunset key\n"
            "set margins 0,0,0,0\nset xrange [0:1]\nset yrange [0:1]\n",
            width_px, height_px);
    put_label(sheet, MARGIN_PX, TITLE_PX / 2 + 2, " Bold,13",
              arena_printf(sheet->arena, "%s, %zu tree%s, by distance to the target",
                           sheet->scene->name, sheet->scene->instances_count,
                           plural(sheet->scene->instances_count)));
    return STATUS_OK;
}

static enum status load(struct sheet *sheet, struct error *error)
{
    const struct render_request *request = sheet->request;
    struct cli_shot shot = request->shot;
    struct scene *scene;
    shot.size = shot.size || shot.cell ? shot.size : "320x240";
    size_t count = request->methods_count ? request->methods_count : 1;
    for (size_t m = 0; m < count; m++) {
        if (request->methods_count)
            shot.method = request->methods[m];
        enum status status = cli_shot_cell(sheet->arena, &shot, true, &sheet->cells[m], error);
        if (status)
            return status;
    }
    sheet->rows = count + 1;
    const struct cell *cell = &sheet->cells[0];
    struct scene_request wanted = {cell->trees, cell->seed, cell->width_px, cell->height_px};
    enum status status = scene_load(sheet->arena, cell->scene, &wanted, &scene, error);
    sheet->scene = scene;
    return status;
}

enum status render_sheet(struct arena *arena, const struct render_request *request,
                         struct error *error)
{
    struct sheet *sheet = ARENA_NEW(arena, struct sheet);
    sheet->arena = arena;
    sheet->request = request;
    const char *out = request->shot.out ? request->shot.out : "sheet.png";
    char folder[] = "/tmp/treeline-sheet-XXXXXX";
    enum status status = load(sheet, error);
    if (status)
        return status;
    if (!mkdtemp(folder))
        return error_errno(error, STATUS_IO, "%s", folder);
    sheet->labels = open_memstream(&sheet->text, &sheet->text_size);
    status = place_views(sheet, error);
    if (!status)
        status = lay_out(sheet, error);
    if (!status)
        status = draw_references(sheet, error);
    if (!status)
        status = draw_methods(sheet, error);
    if (!status)
        status = put_letters(sheet, folder, error);
    if (!status)
        status = image_write(out, sheet->image, path_ends_with(out, ".exr") ? 16 : 8,
                             !path_ends_with(out, ".exr"), error);
    fclose(sheet->labels);
    free(sheet->text);
    rmdir(folder);
    if (!status && !request->shot.quiet)
        fprintf(stderr, "treeline: %s: %zu methods and the reference at %zu distances\n", out,
                sheet->rows - 1, sheet->columns);
    return status;
}
