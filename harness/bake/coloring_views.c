/* Ray traced pictures with depth for voxel colouring. */
#include "bake/coloring_views.h"

#include "bake/views.h"
#include "base/file.h"
#include "base/hash.h"
#include "truth/reference_parts.h"

#include <math.h>
#include <string.h>

void coloring_direction(size_t count, size_t index, float direction[3])
{
    const float golden = 1.6180339887f;
    float to[3] = {0, 0, 0};
    if (count == 6) {
        to[index / 2] = index % 2 ? -1 : 1;
    } else if (count == 12) { /* (0, +-1, +-golden) and its turns */
        to[(index / 4 + 1) % 3] = index % 2 ? -1 : 1;
        to[(index / 4 + 2) % 3] = index / 2 % 2 ? -golden : golden;
    } else {
        double y = 1 - (2 * (double)index + 1) / (double)count, across = sqrt(1 - y * y);
        double turn = 6.283185307179586 * (double)index / (1 + (double)golden);
        to[0] = (float)(across * sin(turn)), to[1] = (float)y, to[2] = (float)(across * cos(turn));
    }
    glm_vec3_normalize_to(to, direction);
}

/* An orthographic camera that frames the box from a direction. */
static struct depth_view frame_box(const struct images *capture, const float toward[3], int pixels)
{
    struct depth_view view = {.width_px = pixels, .height_px = pixels};
    views_plane(toward, view.right, view.up);
    float reach_m = 0;
    for (int i = 0; i < 3; i++) {
        float half_m = (capture->maximum_m[i] - capture->minimum_m[i]) / 2;
        view.half[0] += fabsf(view.right[i]) * half_m;
        view.half[1] += fabsf(view.up[i]) * half_m;
        reach_m += 2 * fabsf(toward[i]) * half_m; /* before the box, not on its face */
        view.forward[i] = -toward[i];
    }
    for (int i = 0; i < 3; i++)
        view.position_m[i] =
            (capture->minimum_m[i] + capture->maximum_m[i]) / 2 + reach_m * toward[i];
    return view;
}

static void trace_row(const struct traced_scene *traced, const struct depth_view *view, int row,
                      float (*color)[3], float *depth_m, float *leaf)
{
    struct embree_packet packet = {0};
    for (int first = 0; first < view->width_px; first += EMBREE_LANES) {
        int lanes = view->width_px - first < EMBREE_LANES ? view->width_px - first : EMBREE_LANES;
        for (int lane = 0; lane < lanes; lane++) {
            float origin[3];
            depth_view_point(view, first + lane, row, 0, origin);
            for (int i = 0; i < 3; i++) {
                packet.origin[i][lane] = origin[i];
                packet.direction[i][lane] = view->forward[i];
            }
            packet.near[lane] = 0;
            packet.far[lane] = INFINITY;
        }
        embree_intersect(traced->embree, &packet, lanes, true);
        for (int lane = 0; lane < lanes; lane++) {
            bool hit = packet.geometry[lane] != EMBREE_NONE;
            depth_m[first + lane] = hit ? packet.far[lane] : INFINITY;
            if (!hit)
                continue;
            const struct surface *surface = &traced->surfaces[packet.geometry[lane]];
            surface_albedo(surface, &packet, lane, color[first + lane]);
            leaf[first + lane] = surface->leaf;
        }
    }
}

static void trace_views(struct arena *arena, const struct traced_scene *traced, int pixels,
                        int threads, struct images *capture)
{
    for (size_t v = 0; v < capture->views_count; v++) {
        float toward[3];
        coloring_direction(capture->views_count, v, toward);
        struct depth_view *view = &capture->views[v];
        *view = frame_box(capture, toward, pixels);
        size_t count = (size_t)pixels * (size_t)pixels, width = (size_t)pixels;
        float(*color)[3] = arena_alloc(arena, count, sizeof *color);
        float *depth_m = ARENA_ARRAY(arena, float, count), *leaf = ARENA_ARRAY(arena, float, count);
#pragma omp parallel for schedule(dynamic, 8) num_threads(threads)
        for (int row = 0; row < pixels; row++)
            trace_row(traced, view, row, color + (size_t)row * width, depth_m + (size_t)row * width,
                      leaf + (size_t)row * width);
        view->color = (const float(*)[3])color;
        view->depth_m = depth_m;
        view->leaf = leaf;
    }
}

/* The plant's box with a share of it to spare on each side. */
static void place_box(const struct mesh *mesh, float spare, struct images *capture)
{
    float extent_m = 0;
    for (int i = 0; i < 3; i++)
        extent_m = fmaxf(extent_m, mesh->maximum_m[i] - mesh->minimum_m[i]);
    for (int i = 0; i < 3; i++) {
        float side_m = mesh->maximum_m[i] - mesh->minimum_m[i];
        float spare_m = fmaxf(spare * fmaxf(side_m, 0.02f * extent_m), 1e-6f);
        capture->minimum_m[i] = mesh->minimum_m[i] - spare_m;
        capture->maximum_m[i] = mesh->maximum_m[i] + spare_m;
    }
}

enum status coloring_trace(struct arena *arena, struct plant *plant,
                           const struct coloring_shots *shots, int threads, struct images *capture,
                           struct error *error)
{
    const struct mesh *mesh = NULL;
    enum status status = plant_mesh(plant, &mesh, error);
    if (status != STATUS_OK)
        return status;
    struct species species = {.plant = plant, .scale_min = 1, .scale_max = 1};
    struct instance instance = {.scale = 1, .stretch = 1};
    struct scene scene = {
        .species_count = 1, .species = &species, .instances_count = 1, .instances = &instance};
    *capture = (struct images){.views_count = shots->count,
                               .views = ARENA_ARRAY(arena, struct depth_view, shots->count)};
    place_box(mesh, shots->spare, capture);
    struct arena *scratch = arena_create(0);
    struct traced_scene traced = {0};
    status = traced_scene_build(scratch, &scene, threads, &traced, error);
    if (status == STATUS_OK)
        trace_views(arena, &traced, shots->pixels, threads, capture);
    embree_destroy(traced.embree);
    arena_destroy(scratch);
    return status;
}

/* Changes whenever the same pictures are coloured otherwise. */
enum { COLORING_VERSION = 1 };

/* An entry of the cache: the struct (its pointers mean nothing there), its voxels, its cells. */
static bool cached(struct arena *arena, uint64_t key, int grid, struct coloring *coloring)
{
    size_t cells = (size_t)grid * (size_t)grid * (size_t)grid, size;
    void *data;
    if (!cache_get(arena, "coloring", key, &data, &size) || size < sizeof *coloring)
        return false;
    memcpy(coloring, data, sizeof *coloring);
    if (coloring->grid != grid || coloring->voxels_count > cells ||
        size != sizeof *coloring + coloring->voxels_count * sizeof *coloring->voxels +
                    cells * sizeof *coloring->cells)
        return false;
    coloring->voxels = (void *)((char *)data + sizeof *coloring);
    coloring->cells = (void *)(coloring->voxels + coloring->voxels_count);
    return true;
}

static void cache_coloring(uint64_t key, const struct coloring *coloring)
{
    struct arena *scratch = arena_create(0);
    size_t grid = (size_t)coloring->grid, cells = grid * grid * grid * sizeof *coloring->cells;
    size_t voxels = coloring->voxels_count * sizeof *coloring->voxels;
    char *bytes = arena_alloc(scratch, sizeof *coloring + voxels + cells, 1);
    memcpy(bytes, coloring, sizeof *coloring);
    memcpy(bytes + sizeof *coloring, coloring->voxels, voxels);
    memcpy(bytes + sizeof *coloring + voxels, coloring->cells, cells);
    cache_put("coloring", key, bytes, sizeof *coloring + voxels + cells);
    arena_destroy(scratch);
}

enum status coloring_of_plant(struct arena *arena, struct plant *plant,
                              const struct coloring_shots *shots,
                              const struct coloring_request *request, int threads,
                              struct coloring *coloring, struct error *error)
{
    uint64_t key;
    enum status status = plant_hash(plant, &key, error);
    if (status != STATUS_OK)
        return status;
    key =
        hash_u64(hash_u64(hash_u64(key, COLORING_VERSION), shots->count), (uint64_t)shots->pixels);
    key = hash_u64(hash_u64(hash_double(key, (double)shots->spare), (uint64_t)request->grid),
                   request->binary);
    key = hash_double(hash_double(key, (double)request->agreement), (double)request->see_through);
    if (cached(arena, key, request->grid, coloring))
        return STATUS_OK;
    struct arena *scratch = arena_create(0);
    struct images capture;
    status = coloring_trace(scratch, plant, shots, threads, &capture, error);
    if (status == STATUS_OK) {
        struct coloring_request in = *request;
        memcpy(in.minimum_m, capture.minimum_m, sizeof capture.minimum_m);
        memcpy(in.maximum_m, capture.maximum_m, sizeof capture.maximum_m);
        coloring_build(arena, capture.views, capture.views_count, &in, coloring);
        cache_coloring(key, coloring);
    }
    arena_destroy(scratch);
    return status;
}
