/* The pictures of a folder: read into views, written from views. */
#include "plant/images.h"

#include "base/file.h"
#include "wall/image.h"
#include "wall/json.h"

#include <math.h>
#include <string.h>

enum { PIXELS_MAX = 1 << 26 };

static int channel_of(const struct image *image, const char *name)
{
    for (int c = 0; image->names && c < image->channels_count; c++) {
        const char *dot = strrchr(image->names[c], '.'); /* Blender: ViewLayer.Depth.Z */
        if (strcmp(dot ? dot + 1 : image->names[c], name) == 0)
            return c;
    }
    return -1;
}

/* R, G, B by name, else the first three, else grey; alpha -1: none. */
static void color_channels(const struct image *image, int rgb[3], int *alpha)
{
    int count = image->channels_count;
    for (int i = 0; i < 3; i++) {
        rgb[i] = channel_of(image, (const char *const[]){"R", "G", "B"}[i]);
        if (rgb[i] < 0)
            rgb[i] = count >= 3 ? i : 0;
    }
    *alpha = channel_of(image, "A");
    if (*alpha < 0 && !image->names && (count == 2 || count == 4))
        *alpha = count - 1;
}

/* Metres along forward for each metre along the ray of a pixel. */
static float forward_share(const struct depth_view *view, int column, int row)
{
    float a[3], b[3], length2 = 0;
    depth_view_point(view, column, row, 0, a);
    depth_view_point(view, column, row, 1, b);
    for (int i = 0; i < 3; i++)
        length2 += (b[i] - a[i]) * (b[i] - a[i]);
    return 1 / sqrtf(length2);
}

/* Depths in metres along forward; INFINITY where the file says nothing is there. */
static enum status depth_take(struct arena *arena, const struct images *images, size_t k,
                              const struct image *image, struct error *error)
{
    struct depth_view *view = &images->views[k];
    const struct images_depth *how = &images->depth;
    int channel = channel_of(image, "Z");
    bool own = strcmp(images->colors[k], images->depths[k]) != 0;
    if (channel < 0 && !own)
        return error_set(error, STATUS_INVALID,
                         "%s: has no channel Z; allowed: one that has, or a depth of its own",
                         images->depths[k]);
    bool floats = path_ends_with(images->depths[k], ".exr");
    float far_m = how->far_m > 0 ? how->far_m : floats ? 1e9f : 0.99999f * how->unit_m;
    size_t pixels = (size_t)view->width_px * (size_t)view->height_px;
    float *depth_m = ARENA_ARRAY(arena, float, pixels);
    for (size_t i = 0; i < pixels; i++) {
        size_t at = i * (size_t)image->channels_count + (size_t)(channel < 0 ? 0 : channel);
        float depth = image->values[at] * how->unit_m;
        int column = (int)(i % (size_t)view->width_px), row = (int)(i / (size_t)view->width_px);
        if (how->along_ray && depth > 0 && depth < far_m)
            depth *= forward_share(view, column, row);
        depth_m[i] = depth > 0 && depth < far_m ? depth : INFINITY; /* NaN: nothing */
    }
    view->depth_m = depth_m;
    return STATUS_OK;
}

/* Colours; what is transparent has no depth. */
static void color_take(struct arena *arena, struct depth_view *view, const struct image *image)
{
    int rgb[3], alpha;
    color_channels(image, rgb, &alpha);
    size_t pixels = (size_t)view->width_px * (size_t)view->height_px;
    float(*color)[3] = arena_alloc(arena, pixels, sizeof *color);
    float *depth_m = ARENA_ARRAY(arena, float, pixels);
    memcpy(depth_m, view->depth_m, pixels * sizeof *depth_m);
    for (size_t i = 0; i < pixels; i++) {
        const float *values = image->values + i * (size_t)image->channels_count;
        for (int c = 0; c < 3; c++)
            color[i][c] = values[rgb[c]] >= 0 ? fminf(values[rgb[c]], 1) : 0; /* NaN: 0 */
        if (alpha >= 0 && !(values[alpha] >= 0.5f))
            depth_m[i] = INFINITY;
    }
    view->color = (const float(*)[3])color;
    view->depth_m = depth_m;
}

static enum status view_load(struct arena *arena, struct images *images, size_t k, size_t *pixels,
                             struct error *error)
{
    struct depth_view *view = &images->views[k];
    struct arena *scratch = arena_create(0);
    struct image *color = NULL, *depth = NULL;
    enum status status = image_read(scratch, images->colors[k], true, &color, error);
    if (status == STATUS_OK)
        status = image_read(scratch, images->depths[k], false, &depth, error);
    if (status == STATUS_OK &&
        (color->width_px != depth->width_px || color->height_px != depth->height_px))
        status = error_set(error, STATUS_INVALID,
                           "%s: is %d x %d pixels, %s %d x %d; allowed: the same size",
                           images->depths[k], depth->width_px, depth->height_px, images->colors[k],
                           color->width_px, color->height_px);
    if (status == STATUS_OK) {
        view->width_px = color->width_px;
        view->height_px = color->height_px;
        *pixels += (size_t)color->width_px * (size_t)color->height_px;
        if (view->pinhole)
            view->half[0] = view->half[1] * (float)view->width_px / (float)view->height_px;
        if (*pixels > PIXELS_MAX)
            status =
                error_set(error, STATUS_INVALID,
                          "%s: the pictures up to this one have %zu pixels; allowed: %d in all",
                          images->colors[k], *pixels, PIXELS_MAX);
    }
    if (status == STATUS_OK)
        status = depth_take(arena, images, k, depth, error);
    if (status == STATUS_OK)
        color_take(arena, view, color);
    arena_destroy(scratch);
    return status;
}

enum status images_load(struct arena *arena, struct images *images, struct error *error)
{
    size_t pixels = 0;
    enum status status = STATUS_OK;
    for (size_t k = 0; k < images->views_count && status == STATUS_OK; k++)
        status = view_load(arena, images, k, &pixels, error);
    return status;
}

static enum status view_write(const char *folder, const struct depth_view *view, size_t k,
                              struct error *error)
{
    static const char *const rgba[] = {"R", "G", "B", "A"}, *const z[] = {"Z"};
    struct arena *scratch = arena_create(0);
    size_t pixels = (size_t)view->width_px * (size_t)view->height_px;
    struct image color = {view->width_px, view->height_px, 4,
                          ARENA_ARRAY(scratch, float, 4 * pixels), rgba};
    struct image depth = {view->width_px, view->height_px, 1, ARENA_ARRAY(scratch, float, pixels),
                          z};
    for (size_t i = 0; i < pixels; i++) {
        bool there = isfinite(view->depth_m[i]);
        depth.values[i] = there ? view->depth_m[i] : 0;
        if (there)
            memcpy(color.values + 4 * i, view->color[i], sizeof view->color[i]);
        color.values[4 * i + 3] = there;
    }
    enum status status = image_write(arena_printf(scratch, "%s/color-%02zu.exr", folder, k), &color,
                                     32, false, error);
    if (status == STATUS_OK)
        status = image_write(arena_printf(scratch, "%s/depth-%02zu.exr", folder, k), &depth, 32,
                             false, error);
    arena_destroy(scratch);
    return status;
}

static void put_vector(struct json_out *out, const char *key, const float *values, int count)
{
    json_open(out, key, '[');
    for (int i = 0; i < count; i++)
        json_put_number(out, NULL, (double)values[i]);
    json_close(out);
}

static void put_view(struct arena *arena, struct json_out *out, const struct depth_view *view,
                     size_t k)
{
    json_open(out, NULL, '{');
    json_put_text(out, "kind", view->pinhole ? "pinhole" : "orthographic");
    json_put_text(out, "color", arena_printf(arena, "color-%02zu.exr", k));
    json_put_text(out, "depth", arena_printf(arena, "depth-%02zu.exr", k));
    put_vector(out, "position_m", view->position_m, 3);
    put_vector(out, "direction", view->forward, 3);
    put_vector(out, "up", view->up, 3);
    if (view->pinhole)
        json_put_number(out, "fov_y_deg", 360 / 3.14159265358979 * atan((double)view->half[1]));
    else
        put_vector(out, "extent_m", (const float[2]){2 * view->half[0], 2 * view->half[1]}, 2);
    json_close(out);
}

enum status images_write(const char *folder, const struct images *images, struct error *error)
{
    struct arena *arena = arena_create(0);
    enum status status = file_make_folder(folder, error);
    for (size_t k = 0; k < images->views_count && status == STATUS_OK; k++)
        status = view_write(folder, &images->views[k], k, error);
    struct json_out *out = json_out(arena);
    json_open(out, NULL, '{');
    put_vector(out, "minimum_m", images->minimum_m, 3);
    put_vector(out, "maximum_m", images->maximum_m, 3);
    json_open(out, "views", '[');
    for (size_t k = 0; k < images->views_count; k++)
        put_view(arena, out, &images->views[k], k);
    json_close(out);
    json_close(out);
    const char *text = json_out_text(out);
    if (status == STATUS_OK)
        status =
            file_write(arena_printf(arena, "%s/cameras.json", folder), text, strlen(text), error);
    arena_destroy(arena);
    return status;
}
