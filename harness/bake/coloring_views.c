/* Ray traced pictures with depth for voxel colouring. */
#include "bake/coloring_views.h"

#include "bake/views.h"
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
                      float (*color)[3], float *depth_m)
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
            if (hit)
                surface_albedo(&traced->surfaces[packet.geometry[lane]], &packet, lane,
                               color[first + lane]);
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
        float *depth_m = ARENA_ARRAY(arena, float, count);
#pragma omp parallel for schedule(dynamic, 8) num_threads(threads)
        for (int row = 0; row < pixels; row++)
            trace_row(traced, view, row, color + (size_t)row * width,
                      depth_m + (size_t)row * width);
        view->color = (const float(*)[3])color;
        view->depth_m = depth_m;
    }
}

enum status coloring_trace(struct arena *arena, struct plant *plant, size_t count, int pixels,
                           int threads, struct images *capture, struct error *error)
{
    const struct mesh *mesh = NULL;
    enum status status = plant_mesh(plant, &mesh, error);
    if (status != STATUS_OK)
        return status;
    struct species species = {.plant = plant, .scale_min = 1, .scale_max = 1};
    struct instance instance = {.scale = 1};
    struct scene scene = {
        .species_count = 1, .species = &species, .instances_count = 1, .instances = &instance};
    *capture = (struct images){.views_count = count,
                               .views = ARENA_ARRAY(arena, struct depth_view, count)};
    float extent_m = 0;
    for (int i = 0; i < 3; i++)
        extent_m = fmaxf(extent_m, mesh->maximum_m[i] - mesh->minimum_m[i]);
    for (int i = 0; i < 3; i++) {
        float side_m = mesh->maximum_m[i] - mesh->minimum_m[i];
        float spare_m = fmaxf(0.005f * fmaxf(side_m, 0.02f * extent_m), 1e-6f);
        capture->minimum_m[i] = mesh->minimum_m[i] - spare_m;
        capture->maximum_m[i] = mesh->maximum_m[i] + spare_m;
    }
    struct arena *scratch = arena_create(0);
    struct traced_scene traced = {0};
    status = traced_scene_build(scratch, &scene, threads, &traced, error);
    if (status == STATUS_OK)
        trace_views(arena, &traced, pixels, threads, capture);
    embree_destroy(traced.embree);
    arena_destroy(scratch);
    return status;
}

enum status coloring_of_plant(struct arena *arena, struct plant *plant, size_t count,
                              struct coloring_request *request, int threads,
                              struct coloring *coloring, struct error *error)
{
    struct arena *scratch = arena_create(0);
    struct images capture;
    enum status status =
        coloring_trace(scratch, plant, count, 2 * request->grid, threads, &capture, error);
    if (status == STATUS_OK) {
        memcpy(request->minimum_m, capture.minimum_m, sizeof capture.minimum_m);
        memcpy(request->maximum_m, capture.maximum_m, sizeof capture.maximum_m);
        coloring_build(arena, capture.views, count, request, coloring);
    }
    arena_destroy(scratch);
    return status;
}
