/* cameras.json, and a folder of pictures as a plant's mesh. */
#include "plant/images.h"

#include "base/file.h"
#include "base/hash.h"
#include "plant/import_steps.h"
#include "wall/json.h"

#include <math.h>
#include <string.h>

static const double REQUIRED = (double)NAN;

static void vector_required(struct json *object, const char *key, float values[3])
{
    if (!json_vector(object, key, values, 3, -1e6, 1e6))
        json_fail(object, key, "is missing; allowed: [x, y, z] in -1e6..1e6");
}

static void describe_box(struct json *root, struct images *images)
{
    vector_required(root, "minimum_m", images->minimum_m);
    vector_required(root, "maximum_m", images->maximum_m);
    for (int i = 0; i < 3; i++)
        if (!(images->maximum_m[i] - images->minimum_m[i] > 1e-6f)) {
            json_fail(root, "maximum_m", "value is %g along %c, minimum_m is %g; allowed: above it",
                      (double)images->maximum_m[i], "xyz"[i], (double)images -> minimum_m[i]);
            return;
        }
}

static void describe_depth(struct json *root, struct images_depth *depth)
{
    struct json *object = json_object(root, "depth");
    depth->along_ray = json_word(object, "kind", "forward|ray", 0) == 1;
    depth->unit_m = (float)json_number(object, "unit_m", 1, 1e-6, 1e6);
    depth->far_m = (float)json_number(object, "far_m", 0, 0, 1e9);
}

static float unit(float v[3])
{
    float length = sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int i = 0; i < 3 && length > 0; i++)
        v[i] /= length;
    return length;
}

static void cross(const float a[3], const float b[3], float to[3])
{
    to[0] = a[1] * b[2] - a[2] * b[1];
    to[1] = a[2] * b[0] - a[0] * b[2];
    to[2] = a[0] * b[1] - a[1] * b[0];
}

/* right and up from a direction and a guide that is not along it. */
static void describe_axes(struct json *object, struct depth_view *view)
{
    float guide[3] = {0, 1, 0};
    vector_required(object, "position_m", view->position_m);
    vector_required(object, "direction", view->forward);
    json_vector(object, "up", guide, 3, -1e6, 1e6);
    if (!(unit(view->forward) > 1e-6f)) {
        json_fail(object, "direction", "value is [0, 0, 0]; allowed: any other");
        return;
    }
    unit(guide);
    cross(view->forward, guide, view->right);
    if (!(unit(view->right) > 1e-4f)) {
        json_fail(object, "up", "is along direction; allowed: across it");
        return;
    }
    cross(view->right, view->forward, view->up);
}

static void describe_view(struct arena *arena, const char *folder, struct json *object,
                          struct images *images, size_t k)
{
    struct depth_view *view = &images->views[k];
    view->pinhole = json_word(object, "kind", "pinhole|orthographic", -1) == 0;
    describe_axes(object, view);
    const char *color = json_text(object, "color", NULL);
    const char *depth = json_text(object, "depth", color);
    if (!color)
        json_fail(object, "color", "is missing; allowed: the name of a picture");
    else {
        images->colors[k] = arena_printf(arena, "%s/%s", folder, color);
        images->depths[k] = arena_printf(arena, "%s/%s", folder, depth);
    }
    if (view->pinhole) {
        /* The width follows from the picture's, whose pixels are square: 0 until it is read. */
        double angle = json_number(object, "fov_y_deg", REQUIRED, 0.1, 170);
        view->half[1] = (float)tan(angle * 3.14159265358979 / 360);
    } else {
        float extent_m[2] = {0, 0};
        if (!json_vector(object, "extent_m", extent_m, 2, 1e-6, 1e6))
            json_fail(object, "extent_m", "is missing; allowed: [width, height] in 1e-6..1e6");
        view->half[0] = extent_m[0] / 2;
        view->half[1] = extent_m[1] / 2;
    }
}

enum status images_describe(struct arena *arena, const char *folder, struct images *images,
                            struct error *error)
{
    struct error local = {STATUS_OK, ""};
    error = error ? error : &local;
    *images = (struct images){0};
    struct json_doc *doc = json_load(arena, arena_printf(arena, "%s/cameras.json", folder), error);
    if (!doc)
        return error->status;
    struct json *root = json_root(doc);
    json_text(root, "doc", "");
    describe_box(root, images);
    describe_depth(root, &images->depth);
    size_t count = json_array(root, "views");
    if (count < 1 || count > COLORING_VIEWS_MAX) {
        json_fail(root, "views", "has %zu elements; allowed: 1..%d", count, COLORING_VIEWS_MAX);
        return json_end(doc);
    }
    images->views_count = count;
    images->views = ARENA_ARRAY(arena, struct depth_view, count);
    images->colors = ARENA_ARRAY(arena, const char *, count);
    images->depths = ARENA_ARRAY(arena, const char *, count);
    for (size_t k = 0; k < count; k++) {
        struct json *view = json_element(root, "views", k);
        if (view)
            describe_view(arena, folder, view, images, k);
    }
    return json_end(doc);
}

static enum status hash_file(struct arena *arena, const char *path, uint64_t *hash,
                             struct error *error)
{
    char *bytes = NULL;
    size_t size = 0;
    enum status status = file_read(arena, path, 0, &bytes, &size, error);
    if (status == STATUS_OK)
        *hash = hash_bytes(*hash, bytes, size);
    return status;
}

enum status images_hash(const char *folder, const struct coloring_request *request, uint64_t *hash,
                        struct error *error)
{
    struct arena *arena = arena_create(0);
    struct images images;
    enum status status = images_describe(arena, folder, &images, error);
    *hash = hash_u64(hash_text(0, "images 1"), (uint64_t)request->grid);
    *hash = hash_double(hash_u64(*hash, request->binary), (double)request->agreement);
    *hash = hash_double(*hash, (double)request->see_through);
    if (status == STATUS_OK)
        status = hash_file(arena, arena_printf(arena, "%s/cameras.json", folder), hash, error);
    for (size_t k = 0; k < images.views_count && status == STATUS_OK; k++) {
        struct arena *scratch = arena_create(0);
        status = hash_file(scratch, images.colors[k], hash, error);
        if (status == STATUS_OK && strcmp(images.colors[k], images.depths[k]) != 0)
            status = hash_file(scratch, images.depths[k], hash, error);
        arena_destroy(scratch);
    }
    arena_destroy(arena);
    return status;
}

static enum status build(struct arena *arena, const char *folder,
                         const struct coloring_request *request, struct mesh **mesh,
                         struct error *error)
{
    struct arena *scratch = arena_create(0);
    struct images images;
    enum status status = images_describe(scratch, folder, &images, error);
    if (status == STATUS_OK)
        status = images_load(scratch, &images, error);
    if (status == STATUS_OK) {
        struct coloring_request in = *request;
        memcpy(in.minimum_m, images.minimum_m, sizeof in.minimum_m);
        memcpy(in.maximum_m, images.maximum_m, sizeof in.maximum_m);
        struct coloring coloring;
        coloring_build(scratch, images.views, images.views_count, &in, &coloring);
        *mesh = coloring_mesh(arena, &coloring);
        if (!*mesh)
            status = error_set(error, STATUS_INVALID,
                               "%s: no voxel is coloured: %zu are carved, %zu seen through, %zu "
                               "unseen; allowed: pictures that show something inside the box",
                               folder, coloring.carved_count, coloring.clear_count,
                               coloring.unseen_count);
    }
    arena_destroy(scratch);
    return status;
}

enum status images_mesh(struct arena *arena, const char *folder,
                        const struct coloring_request *request, struct mesh **mesh,
                        struct error *error)
{
    uint64_t hash;
    enum status status = images_hash(folder, request, &hash, error);
    if (status != STATUS_OK)
        return status;
    void *bytes;
    size_t size;
    if (cache_get(arena, "images", hash, &bytes, &size)) {
        *mesh = import_decode(arena, bytes, size);
        if (*mesh && mesh_check(*mesh, NULL) == STATUS_OK)
            return STATUS_OK;
    }
    status = build(arena, folder, request, mesh, error);
    if (status != STATUS_OK)
        return status;
    if (mesh_check(*mesh, error) != STATUS_OK)
        return error_context(error, "%s", folder);
    struct arena *scratch = arena_create(0);
    bytes = import_encode(scratch, *mesh, &size);
    cache_put("images", hash, bytes, size);
    arena_destroy(scratch);
    return STATUS_OK;
}
