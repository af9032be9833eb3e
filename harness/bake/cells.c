/* The part of a hierarchy of cells that a picture shows. */
#include "bake/cells_parts.h"

#include <math.h>
#include <string.h>

/* Constants of a picture. */
struct look {
    const struct cells *cells;
    const struct view *view;
    float planes[6][4];
    float offset_m; /* the eye's depth */
    float focal_px;
    struct cells_limits limits;
};

enum { ALL_PLANES = 63 };

/* The planes that the sphere still crosses; -1: it is outside of one. */
static int planes_crossed(const struct look *look, int planes, const float center_m[3],
                          float radius_m)
{
    for (int p = 0; p < 6; p++) {
        if (!(planes >> p & 1))
            continue;
        const float *plane = look->planes[p];
        float inside_m =
            plane[0] * center_m[0] + plane[1] * center_m[1] + plane[2] * center_m[2] + plane[3];
        if (inside_m + radius_m < 0)
            return -1;
        if (inside_m > radius_m)
            planes &= ~(1 << p);
    }
    return planes;
}

static float depth_of(const struct look *look, const float at_m[3])
{
    const float *f = look->view->forward;
    return f[0] * at_m[0] + f[1] * at_m[1] + f[2] * at_m[2] - look->offset_m;
}

/* Whether the cell is small enough to stand for its trees. */
static bool is_small(const struct look *look, uint32_t number, const struct cells_node *node,
                     float depth_m)
{
    const struct cells_sums *sums = &look->cells->sums[number];
    float pixel_m = depth_m / look->focal_px, most_m = look->limits.most_px * pixel_m;
    /* a sphere's radius is a few times its spread; the exact test is dearer */
    if (node->radius_m > 2 * most_m || depth_m - node->radius_m < look->view->near_m)
        return false;
    if (sums->scale * look->cells->bounds[node->species].radius_m > look->limits.tree_px * pixel_m)
        return false;
    float most_m2 = most_m * most_m / 12; /* of a bar so long */
    return cells_spread_m2(sums, look->view->right) <= most_m2 &&
           cells_spread_m2(sums, look->view->up) <= most_m2;
}

/* The same little by little: the share of the cell that stands for its trees. */
static float small_share(const struct look *look, uint32_t number, const struct cells_node *node,
                         float depth_m)
{
    bool small = is_small(look, number, node, depth_m);
    if (!small || !(look->limits.octaves > 0))
        return small;
    const struct cells_sums *sums = &look->cells->sums[number];
    float pixel_m = depth_m / look->focal_px, most_m = look->limits.most_px * pixel_m;
    float tree_m = sums->scale * look->cells->bounds[node->species].radius_m;
    float sphere = node->radius_m / (2 * most_m), tree = tree_m / (look->limits.tree_px * pixel_m);
    float largest2 = fmaxf(sphere * sphere, tree * tree);
    largest2 = fmaxf(largest2, 12 / (most_m * most_m) *
                                   fmaxf(cells_spread_m2(sums, look->view->right),
                                         cells_spread_m2(sums, look->view->up)));
    return fminf(-0.5f * log2f(largest2) / look->limits.octaves, 1);
}

static void list_trees(const struct look *look, const struct cells_node *node, int planes,
                       float share, struct cells_list *list)
{
    for (uint32_t k = node->begin; k < node->end; k++) {
        const float *sphere = look->cells->spheres[k];
        if (list->shares)
            list->shares[list->count] = (uint8_t)(255 * share + 0.5f);
        list->entries[list->count] = look->cells->instances[k];
        list->depths_m[list->count] = depth_of(look, sphere);
        list->count += planes_crossed(look, planes, sphere, sphere[3]) >= 0;
    }
}

static void list_cell(const struct look *look, uint32_t number, const struct cells_node *node,
                      float share, struct cells_list *list)
{
    const struct cells_sums *sums = &look->cells->sums[number];
    float middle_m[3];
    memcpy(middle_m, sums->foot_m, sizeof middle_m);
    middle_m[1] += sums->scale * look->cells->bounds[node->species].center_y_m;
    if (list->shares)
        list->shares[list->count] = (uint8_t)(255 * share + 0.5f);
    list->entries[list->count] = (uint32_t)look->cells->trees_count + number;
    list->depths_m[list->count++] = depth_of(look, middle_m);
}

/* share: of what is in the cell that larger ones do not stand for. */
static void look_through(const struct look *look, uint32_t number, int planes, float share,
                         struct cells_list *list)
{
    static const float least = 1.0f / 255;
    const struct cells_node *node = &look->cells->nodes[number];
    planes = planes_crossed(look, planes, node->center_m, node->radius_m);
    if (planes < 0)
        return;
    if (look->limits.most_px > 0) {
        float own = share * small_share(look, number, node, depth_of(look, node->center_m));
        if (own >= least)
            list_cell(look, number, node, own, list);
        share = own >= least ? share - own : share;
    }
    if (share < least)
        return;
    if (node->far) {
        look_through(look, number + 1, planes, share, list);
        look_through(look, node->far, planes, share, list);
    } else {
        list_trees(look, node, planes, share, list);
    }
}

/* The nodes so deep below one, and the leaves above. */
static void runs_fill(struct cells *cells, uint32_t number, int depth, size_t *count)
{
    const struct cells_node *node = &cells->nodes[number];
    if (depth > 0 && node->far) {
        runs_fill(cells, number + 1, depth - 1, count);
        runs_fill(cells, node->far, depth - 1, count);
    } else {
        cells->runs[(*count)++].node = number;
    }
}

/* Whichever thread looks through which run, each has its own place. */
static size_t look_all(struct cells *cells, const struct look *look, int threads)
{
    size_t runs_count = 0, count = 0;
    int depth = 0;
    while (cells->roots_count << (depth + 1) <= CELLS_RUNS)
        depth++;
    for (size_t k = 0; k < cells->roots_count; k++)
        runs_fill(cells, cells->roots[k], depth, &runs_count);
#pragma omp parallel for num_threads(threads) schedule(dynamic, 1)
    for (size_t k = 0; k < runs_count; k++) {
        struct cells_run *run = &cells->runs[k];
        size_t at = cells_place(cells, run->node);
        struct cells_list list = {0, cells->entries[0] + at, cells->depths_m[0] + at,
                                  look->limits.octaves > 0 ? cells->shares[0] + at : NULL};
        look_through(look, run->node, ALL_PLANES, 1, &list);
        run->count = list.count;
    }
    for (size_t k = 0; k < runs_count; k++) {
        const struct cells_run *run = &cells->runs[k];
        size_t at = cells_place(cells, run->node);
        memmove(cells->entries[0] + count, cells->entries[0] + at,
                run->count * sizeof *cells->entries[0]);
        memmove(cells->depths_m[0] + count, cells->depths_m[0] + at,
                run->count * sizeof *cells->depths_m[0]);
        if (look->limits.octaves > 0)
            memmove(cells->shares[0] + count, cells->shares[0] + at, run->count);
        count += run->count;
    }
    return count;
}

/* By depth, with their shares. */
static struct cells_list sorted_shares(struct cells *cells, size_t count)
{
    for (size_t k = 0; k < count; k++)
        cells->order[0][k] = (uint32_t)k;
    cull_sort(cells->depths_m[0], cells->order[0], cells->depths_m[1], cells->order[1], count,
              false);
    for (size_t k = 0; k < count; k++) {
        cells->entries[1][k] = cells->entries[0][cells->order[0][k]];
        cells->shares[1][k] = cells->shares[0][cells->order[0][k]];
    }
    return (struct cells_list){count, cells->entries[1], cells->depths_m[0], cells->shares[1]};
}

struct cells_list cells_view(struct cells *cells, const struct view *view,
                             const struct cells_limits *limits, int threads)
{
    const float *f = view->forward, *eye = view->eye_m;
    struct look look = {.cells = cells,
                        .view = view,
                        .offset_m = f[0] * eye[0] + f[1] * eye[1] + f[2] * eye[2],
                        .focal_px = cull_focal_px(view),
                        .limits = *limits};
    struct cells_list list = {0, cells->entries[0], cells->depths_m[0], NULL};
    if (!cells->roots_count)
        return list;
    cull_planes(view, look.planes);
    list.count = look_all(cells, &look, threads);
    if (limits->octaves > 0)
        return sorted_shares(cells, list.count);
    cull_sort(list.depths_m, list.entries, cells->depths_m[1], cells->entries[1], list.count,
              false);
    return list;
}
