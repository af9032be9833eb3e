/* Unions of triangles on a grid of samples. Sources in cover.h. */
#include "bake/cover.h"

#include <math.h>
#include <string.h>

/* SIDE: samples along each extent. Opposite sides see the same, so that SIDES is odd. */
enum { SIDE = 160, SIDES = 5, LANES = 8, BYTES = SIDE * SIDE };

struct cover {
    const struct mesh *mesh;
    const struct detail *detail;
    float right[3][LANES], up[3][LANES]; /* samples a metre, x y z of the sides; then zeros */
    float middle[2];
    double sample_m2;
    uint32_t bark; /* what the stencil holds; stout 0: nothing yet */
    uint16_t stout;
    uint8_t *stencil, *hits; /* SIDES x SIDE x SIDE */
    size_t stencil_count, hits_count;
};

static inline float least(float a, float b)
{
    return a < b ? a : b;
}

static inline float most(float a, float b)
{
    return a > b ? a : b;
}

/* Returns how many samples were not yet marked. */
static size_t mark_triangle(uint8_t *hits, const float corners[3][2])
{
    int begin[2], end[2];
    for (int axis = 0; axis < 2; axis++) {
        float low = least(least(corners[0][axis], corners[1][axis]), corners[2][axis]);
        float high = most(most(corners[0][axis], corners[1][axis]), corners[2][axis]);
        low = least(most(low, 0), SIDE);
        begin[axis] = (int)low + (low > (float)(int)low); /* above 0 a cast rounds down */
        end[axis] = (int)(least(most(high, -1), SIDE - 1) + 1);
        if (begin[axis] >= end[axis])
            return 0;
    }
    float area = (corners[1][0] - corners[0][0]) * (corners[2][1] - corners[0][1]) -
                 (corners[2][0] - corners[0][0]) * (corners[1][1] - corners[0][1]);
    float sign = area < 0 ? -1.0f : 1.0f;
    size_t count = 0;
    for (int y = begin[1]; y < end[1]; y++)
        for (int x = begin[0]; x < end[0]; x++) {
            bool inside = true;
            for (int i = 0; i < 3; i++) {
                const float *a = corners[i], *b = corners[(i + 1) % 3];
                inside &= sign * ((b[0] - a[0]) * ((float)y - a[1]) -
                                  (b[1] - a[1]) * ((float)x - a[0])) >=
                          0;
            }
            count += inside && !hits[y * SIDE + x];
            hits[y * SIDE + x] |= inside;
        }
    return count;
}

/* Whether whole numbers of 0..SIDE-1 lie between the least and the most of three. */
static inline int meets_samples(float a, float b, float c)
{
    float low = most(least(least(a, b), c), 0), high = least(most(most(a, b), c), SIDE - 1);
    int first = (int)least(low, SIDE);
    return (float)first + (float)((float)first < low) <= high;
}

/* The sides side by side: most triangles of needles meet no sample, and that is found in all at
 * once. */
static void mark_sides(struct cover *cover, const float world[3][3])
{
    float x[3][LANES], y[3][LANES];
    int meets[LANES];
    for (int i = 0; i < 3; i++) {
        const float *p = world[i];
        for (int s = 0; s < LANES; s++) {
            x[i][s] = cover->middle[0] + cover->right[0][s] * p[0] + cover->right[2][s] * p[2];
            y[i][s] = cover->middle[1] + cover->up[0][s] * p[0] + cover->up[1][s] * p[1] +
                      cover->up[2][s] * p[2];
        }
    }
    for (int s = 0; s < LANES; s++)
        meets[s] =
            meets_samples(x[0][s], x[1][s], x[2][s]) & meets_samples(y[0][s], y[1][s], y[2][s]);
    for (int s = 0; s < SIDES; s++) {
        if (!meets[s])
            continue;
        const float corners[3][2] = {{x[0][s], y[0][s]}, {x[1][s], y[1][s]}, {x[2][s], y[2][s]}};
        cover->hits_count += mark_triangle(cover->hits + s * BYTES, corners);
    }
}

/* stout: of bark, and then no leaves; 0: everything. */
static void mark_batches(struct cover *cover, size_t level, uint16_t stout)
{
    memset(cover->hits, 0, SIDES * BYTES);
    cover->hits_count = 0;
    const struct detail *detail = cover->detail;
    for (size_t b = 0; b < detail->batches_count; b++) {
        struct detail_range range = detail_stout(detail, b, level, stout);
        const uint32_t *corners = detail->indices + range.first_index;
        if (stout > 0 && detail->batches[b].kind != MATERIAL_BARK)
            continue;
        for (uint32_t i = 0; i + 2 < range.indices_count; i += 3) {
            float world[3][3];
            for (int k = 0; k < 3; k++)
                memcpy(world[k], detail->vertices[corners[i + (uint32_t)k]].position_m,
                       sizeof world[k]);
            mark_sides(cover, (const float(*)[3])world);
        }
    }
}

static double hits_m2(const struct cover *cover)
{
    return (double)cover->hits_count * cover->sample_m2 / SIDES;
}

struct cover *cover_create(struct arena *arena, const struct mesh *mesh,
                           const struct detail *detail)
{
    struct cover *cover = ARENA_NEW(arena, struct cover);
    cover->mesh = mesh;
    cover->detail = detail;
    cover->stencil = ARENA_ARRAY(arena, uint8_t, SIDES * BYTES);
    cover->hits = ARENA_ARRAY(arena, uint8_t, SIDES * BYTES);
    return cover;
}

void cover_look(struct cover *cover, float elevation_rad, float margin_m)
{
    const struct mesh *mesh = cover->mesh;
    float rise = sinf(elevation_rad), level = cosf(elevation_rad), radius = mesh->radius_m;
    float height = mesh->maximum_m[1] - mesh->minimum_m[1];
    float per_m[2], extents_m[2] = {2 * radius, level * height + rise * 2 * radius};
    float middle_m = 0.5f * (mesh->minimum_m[1] + mesh->maximum_m[1]);
    for (int axis = 0; axis < 2; axis++)
        per_m[axis] = SIDE / (1.02f * extents_m[axis] + 2 * margin_m + 1e-6f);
    cover->sample_m2 = 1 / (double)per_m[0] / (double)per_m[1];
    cover->middle[0] = SIDE / 2;
    cover->middle[1] = SIDE / 2 - per_m[1] * level * middle_m;
    for (int side = 0; side < SIDES; side++) {
        float turn = 0.4f + 6.2831853f / SIDES * (float)side, c = cosf(turn), s = sinf(turn);
        const float right[3] = {per_m[0] * c, 0, -per_m[0] * s};
        const float up[3] = {-per_m[1] * rise * s, per_m[1] * level, -per_m[1] * rise * c};
        for (int axis = 0; axis < 3; axis++) {
            cover->right[axis][side] = right[axis];
            cover->up[axis][side] = up[axis];
        }
    }
    cover->stout = 0;
}

double cover_plant(struct cover *cover)
{
    mark_batches(cover, 0, 0);
    return hits_m2(cover);
}

double cover_of_run(struct cover *cover, const struct cover_run *run)
{
    const struct prune *prune = run->prune;
    size_t length = (size_t)ceilf(run->kept);
    if (cover->bark != run->bark || cover->stout != run->stout) {
        mark_batches(cover, run->bark, run->stout);
        memcpy(cover->stencil, cover->hits, SIDES * BYTES);
        cover->stencil_count = cover->hits_count;
        cover->bark = run->bark;
        cover->stout = run->stout;
    }
    memcpy(cover->hits, cover->stencil, SIDES * BYTES);
    cover->hits_count = cover->stencil_count;
    for (size_t rank = 0; rank < length && rank < prune->count; rank++) {
        const struct prune_vertex *corners =
            prune->vertices + 3 * ((run->begin + rank) % prune->count);
        float size = run->growth, world[3][3];
        if (corners[0].normal[3] == 0 && corners[0].albedo[3] >= run->stout)
            continue;
        if (run->taper > 0)
            size *= fminf(fmaxf((run->kept - (float)rank - 0.5f) / (run->taper * run->kept), 0), 1);
        for (int i = 0; i < 3; i++)
            for (int axis = 0; axis < 3; axis++) {
                float center = corners[i].center_m[axis];
                world[i][axis] = center + size * (corners[i].position_m[axis] - center);
            }
        mark_sides(cover, (const float(*)[3])world);
    }
    return hits_m2(cover);
}
