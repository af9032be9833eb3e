/* A coloured volume as stacks of slices. */
#include "bake/slices_coloring.h"

#include "bake/coloring_views.h"
#include "bake/views.h"
#include "base/color.h"

#include <math.h>
#include <string.h>

/* A volume on its way into slices. */
struct layers {
    const struct slices_request *request;
    struct coloring coloring;
    uint32_t *source; /* of each cell: 1 + the voxel it takes after; 0: empty */
    struct slices *slices;
};

/* An axis of the grid, along it or against it. */
struct axis {
    int number;
    bool against;
};

static bool axis_of(const float v[3], struct axis *axis)
{
    for (int i = 0; i < 3; i++)
        if (fabsf(v[i]) > 0.9999f) {
            *axis = (struct axis){i, v[i] < 0};
            return true;
        }
    return false;
}

static enum status check(const struct slices_request *request, struct error *error)
{
    int n = request->count;
    struct axis axis;
    if (n < 2 || n > COLORING_GRID_MAX || request->width_px != n || request->height_px != n)
        return error_set(error, STATUS_INVALID,
                         "slices: %d of %d x %d texels; allowed from pictures: as many as texels "
                         "along each side, 2..%d",
                         n, request->width_px, request->height_px, COLORING_GRID_MAX);
    for (size_t k = 0; k < request->directions_count; k++) {
        const float *d = request->directions[k];
        if (!axis_of(d, &axis))
            return error_set(error, STATUS_INVALID,
                             "slices: direction %zu: (%g, %g, %g) is no axis; allowed from "
                             "pictures: along x, y or z",
                             k, (double)d[0], (double)d[1], (double)d[2]);
    }
    return STATUS_OK;
}

/* Every unseen cell takes after the nearest voxel, cell by cell from their faces on. */
static void fill_unseen(struct arena *scratch, struct layers *layers)
{
    const struct coloring *coloring = &layers->coloring;
    size_t n = (size_t)coloring->grid, cells = n * n * n, steps[3] = {1, n, n * n};
    layers->source = ARENA_ARRAY(scratch, uint32_t, cells);
    uint32_t *queue = ARENA_ARRAY(scratch, uint32_t, cells);
    size_t first = 0, last = 0;
    for (; last < coloring->voxels_count; last++) {
        queue[last] = coloring->voxels[last].cell;
        layers->source[queue[last]] = (uint32_t)last + 1;
    }
    for (; first < last; first++)
        for (int side = 0; side < 6; side++) {
            size_t at = queue[first], along = at / steps[side / 2] % n;
            if (along == (side % 2 ? n - 1 : 0))
                continue;
            size_t to = side % 2 ? at + steps[side / 2] : at - steps[side / 2];
            if (layers->source[to] || coloring->cells[to] != COLORING_UNSEEN)
                continue;
            layers->source[to] = layers->source[at];
            queue[last++] = (uint32_t)to;
        }
}

/* The cell of a texel of a stack: along right, up and toward. */
static size_t cell_at(const struct axis axes[3], size_t n, const size_t at[3])
{
    const size_t steps[3] = {1, n, n * n};
    size_t cell = 0;
    for (int k = 0; k < 3; k++)
        cell += steps[axes[k].number] * (axes[k].against ? n - 1 - at[k] : at[k]);
    return cell;
}

/* Smallest rectangle of a layer that holds all that is not empty. */
static struct slice bounds_of(const struct layers *layers, const struct axis axes[3], size_t layer)
{
    size_t n = (size_t)layers->coloring.grid, low[2] = {n, n}, high[2] = {0, 0};
    for (size_t row = 0; row < n; row++)
        for (size_t column = 0; column < n; column++) {
            if (!layers->source[cell_at(axes, n, (size_t[3]){column, row, layer})])
                continue;
            const size_t at[2] = {column, row};
            for (int i = 0; i < 2; i++) {
                low[i] = at[i] < low[i] ? at[i] : low[i];
                high[i] = at[i] + 1 > high[i] ? at[i] + 1 : high[i];
            }
        }
    if (high[0] == 0)
        return (struct slice){.first = layers->slices->texels_count};
    return (struct slice){.left = (int)low[0],
                          .bottom = (int)low[1],
                          .width = (int)(high[0] - low[0]),
                          .height = (int)(high[1] - low[1]),
                          .first = layers->slices->texels_count};
}

static float dot3(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The normal as it is seen from an eye: a leaf's other side is turned about, bark's is mirrored. */
static void normal_seen(const struct colored_voxel *voxel, const float eye[3], float normal[3])
{
    float along = dot3(voxel->normal, eye);
    for (int i = 0; i < 3; i++) {
        float turned =
            voxel->leaf >= 0.5f ? -voxel->normal[i] : voxel->normal[i] - 2 * along * eye[i];
        normal[i] = along < 0 ? turned : voxel->normal[i];
    }
}

/* Radiance over albedo. Normals that scatter (a mean of length below 1) spread the light: where
 * they look everywhere, 1/2 of a two-sided leaf's is left, 1/4 of what has one side. */
static float sun_share(const struct colored_voxel *voxel, const struct slices_light *light,
                       const float toward[3])
{
    float eye[3], normal[3];
    for (int i = 0; i < 3; i++)
        eye[i] = light->from_behind ? -toward[i] : toward[i];
    normal_seen(voxel, eye, normal);
    float scatter = fmaxf(1 - sqrtf(dot3(normal, normal)), 0);
    if (light->stretch > 0 && light->stretch != 1) { /* a normal of the same length, turned */
        float length = sqrtf(dot3(normal, normal));
        normal[1] /= light->stretch;
        float scale = length / fmaxf(sqrtf(dot3(normal, normal)), 1e-6f);
        for (int i = 0; i < 3; i++)
            normal[i] *= scale;
    }
    float along = dot3(normal, light->sun_direction);
    float leaf = light->two_sided ? fabsf(along) + scatter / 2 : fmaxf(along, 0) + scatter / 4;
    float bark = fmaxf(along, 0) + scatter / 4;
    return voxel->leaf * leaf + (1 - voxel->leaf) * bark;
}

static void put_texel(const struct layers *layers, const struct slices_stack *stack, size_t cell,
                      int layer, size_t texel)
{
    struct slices *slices = layers->slices;
    uint32_t source = layers->source[cell];
    if (!source)
        return;
    const struct colored_voxel *voxel = &layers->coloring.voxels[source - 1];
    bool seen = voxel->cell == cell;
    float slab_m = (stack->high_m[2] - stack->low_m[2]) / (float)slices->count, normal[3];
    float coverage = seen ? 1 - powf(1 - voxel->opacity, slab_m / voxel->chord_m) : 1;
    for (int i = 0; i < 3; i++)
        slices->color[texel][i] = color_byte(coverage * voxel->color[i] / slices->albedo_scale);
    slices->color[texel][3] = color_byte(fmaxf(coverage, 1.0f / 255));
    normal_seen(voxel, stack->toward, normal);
    for (int i = 0; i < 3; i++)
        slices->normal[texel][i] = (uint8_t)(128.5f + 127 * fminf(fmaxf(normal[i], -1), 1));
    slices->normal[texel][3] = color_byte(voxel->leaf);
    float depth =
        (dot3(voxel->position_m, stack->toward) - stack->low_m[2]) / slab_m - (float)layer;
    slices->depth[texel] = (uint16_t)(65535 * (seen ? fminf(fmaxf(depth, 0), 1) : 0.5f));
    for (size_t k = 0; k < layers->request->lights_count; k++) {
        const struct slices_light *light = &layers->request->lights[k];
        float share = sun_share(voxel, light, stack->toward);
        uint8_t *lit = slices->lit[k * slices->texels_count + texel];
        for (int i = 0; i < 3; i++)
            lit[i] = color_byte(coverage * voxel->color[i] / slices->lit_scale *
                                (light->ambient[i] + share * light->sun_radiance[i]));
        lit[3] = slices->color[texel][3];
    }
}

static void place_stack(const struct coloring *coloring, const float toward[3],
                        struct slices_stack *stack, struct axis axes[3])
{
    memcpy(stack->toward, toward, sizeof stack->toward);
    views_plane(stack->toward, stack->right, stack->up);
    const float *along[3] = {stack->right, stack->up, stack->toward};
    for (int k = 0; k < 3; k++) {
        axis_of(along[k], &axes[k]);
        int i = axes[k].number;
        float low_m = coloring->minimum_m[i];
        float high_m = low_m + coloring->voxel_m[i] * (float)coloring->grid;
        stack->low_m[k] = axes[k].against ? -high_m : low_m;
        stack->high_m[k] = axes[k].against ? -low_m : high_m;
    }
}

/* The brightest voxel's colour, and what the brightest light could make of it: the same for every
 * direction. */
static void set_scales(const struct layers *layers)
{
    struct slices *slices = layers->slices;
    slices->albedo_scale = slices->lit_scale = 1e-6f;
    for (size_t i = 0; i < layers->coloring.voxels_count; i++)
        for (int c = 0; c < 3; c++)
            slices->albedo_scale = fmaxf(slices->albedo_scale, layers->coloring.voxels[i].color[c]);
    for (size_t k = 0; k < layers->request->lights_count; k++) {
        const struct slices_light *light = &layers->request->lights[k];
        for (int c = 0; c < 3; c++)
            slices->lit_scale =
                fmaxf(slices->lit_scale,
                      slices->albedo_scale * (light->ambient[c] + light->sun_radiance[c]));
    }
}

static void fill_slices(struct arena *arena, struct arena *scratch, struct layers *layers)
{
    struct slices *slices = layers->slices;
    size_t stacks = slices->stacks_count, count = (size_t)slices->count;
    struct axis(*axes)[3] = arena_alloc(scratch, stacks, sizeof *axes);
    for (size_t k = 0; k < stacks; k++) {
        place_stack(&layers->coloring, layers->request->directions[k], &slices->stacks[k], axes[k]);
        for (size_t layer = 0; layer < count; layer++) {
            struct slice *slice = &slices->slices[k * count + layer];
            *slice = bounds_of(layers, axes[k], layer);
            slices->texels_count += (size_t)slice->width * (size_t)slice->height;
        }
    }
    slices->color = arena_alloc(arena, slices->texels_count, sizeof *slices->color);
    slices->normal = arena_alloc(arena, slices->texels_count, sizeof *slices->normal);
    slices->depth = arena_alloc(arena, slices->texels_count, sizeof *slices->depth);
    slices->lit =
        arena_alloc(arena, slices->lights_count * slices->texels_count, sizeof *slices->lit);
    for (size_t i = 0; i < stacks * count; i++) {
        const struct slice *slice = &slices->slices[i];
        size_t width = (size_t)slice->width, texels = width * (size_t)slice->height;
        for (size_t t = 0; t < texels; t++) {
            const size_t at[3] = {(size_t)slice->left + t % width,
                                  (size_t)slice->bottom + t / width, i % count};
            put_texel(layers, &slices->stacks[i / count], cell_at(axes[i / count], count, at),
                      (int)at[2], slice->first + t);
        }
    }
}

enum status slices_coloring(struct arena *arena, struct plant *plant,
                            const struct slices_request *request, int threads,
                            struct slices *slices, struct error *error)
{
    enum status status = check(request, error);
    if (status != STATUS_OK)
        return status;
    int grid = request->count;
    /* A ring of empty voxels around the plant, where there is room. */
    struct coloring_shots shots = {request->views, 2 * grid,
                                   grid >= 8 ? 1.01f / (float)(grid - 2) : 0.005f};
    struct coloring_request coloring_request = {
        .grid = grid, .binary = request->binary, .agreement = INFINITY, .see_through = 1};
    struct arena *scratch = arena_create(0);
    struct layers layers = {.request = request, .slices = slices};
    status = coloring_of_plant(scratch, plant, &shots, &coloring_request, threads, &layers.coloring,
                               error);
    if (status == STATUS_OK) {
        *slices = (struct slices){.stacks_count = request->directions_count,
                                  .width_px = grid,
                                  .height_px = grid,
                                  .count = grid,
                                  .lights_count = request->lights_count};
        slices->stacks = ARENA_ARRAY(arena, struct slices_stack, slices->stacks_count);
        slices->slices = ARENA_ARRAY(arena, struct slice, slices->stacks_count * (size_t)grid);
        set_scales(&layers);
        fill_unseen(scratch, &layers);
        fill_slices(arena, scratch, &layers);
    }
    arena_destroy(scratch);
    return status;
}
