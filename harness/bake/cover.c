/* Unions of triangles on a grid of samples. Sources in cover.h. */
#include "bake/cover.h"

#include <math.h>
#include <string.h>

/* SIDE: samples along the plant's larger extent. Seen from 20 degrees above, as trees are. */
enum { SIDE = 160, SIDES = 3, BYTES = SIDE * SIDE };

struct cover {
    const struct detail *detail;
    float right[SIDES][3], up[SIDES][3]; /* samples a metre */
    float middle[2];
    double sample_m2, plant_m2;
    uint32_t bark; /* what the stencil holds; stout 0: nothing yet */
    uint16_t stout;
    uint8_t *stencil, *hits; /* SIDES x SIDE x SIDE */
};

static void mark_triangle(uint8_t *hits, const float corners[3][2])
{
    float low[2], high[2];
    for (int axis = 0; axis < 2; axis++) {
        low[axis] = fminf(fminf(corners[0][axis], corners[1][axis]), corners[2][axis]);
        high[axis] = fmaxf(fmaxf(corners[0][axis], corners[1][axis]), corners[2][axis]);
        low[axis] = fminf(fmaxf(low[axis], 0), SIDE - 1);
        high[axis] = fminf(fmaxf(high[axis], -1), SIDE - 1);
    }
    float area = (corners[1][0] - corners[0][0]) * (corners[2][1] - corners[0][1]) -
                 (corners[2][0] - corners[0][0]) * (corners[1][1] - corners[0][1]);
    float sign = area < 0 ? -1.0f : 1.0f;
    for (int y = (int)ceilf(low[1]); y <= (int)floorf(high[1]); y++)
        for (int x = (int)ceilf(low[0]); x <= (int)floorf(high[0]); x++) {
            bool inside = true;
            for (int i = 0; i < 3; i++) {
                const float *a = corners[i], *b = corners[(i + 1) % 3];
                inside &= sign * ((b[0] - a[0]) * ((float)y - a[1]) -
                                  (b[1] - a[1]) * ((float)x - a[0])) >=
                          0;
            }
            if (inside)
                hits[y * SIDE + x] = 1;
        }
}

static void mark_sides(const struct cover *cover, uint8_t *hits, const float world[3][3])
{
    for (int side = 0; side < SIDES; side++) {
        float corners[3][2];
        const float *r = cover->right[side], *u = cover->up[side];
        for (int i = 0; i < 3; i++) {
            const float *p = world[i];
            corners[i][0] = cover->middle[0] + r[0] * p[0] + r[2] * p[2];
            corners[i][1] = cover->middle[1] + u[0] * p[0] + u[1] * p[1] + u[2] * p[2];
        }
        mark_triangle(hits + side * BYTES, (const float(*)[2])corners);
    }
}

/* stout: of bark, and then no leaves; 0: everything. */
static void mark_batches(const struct cover *cover, uint8_t *hits, size_t level, uint16_t stout)
{
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
            mark_sides(cover, hits, (const float(*)[3])world);
        }
    }
}

static double count_m2(const struct cover *cover)
{
    size_t count = 0;
    for (size_t i = 0; i < SIDES * BYTES; i++)
        count += cover->hits[i];
    return (double)count * cover->sample_m2 / SIDES;
}

struct cover *cover_create(struct arena *arena, const struct mesh *mesh,
                           const struct detail *detail)
{
    struct cover *cover = ARENA_NEW(arena, struct cover);
    float rise = sinf(0.35f), level = cosf(0.35f), radius = mesh->radius_m;
    float height = mesh->maximum_m[1] - mesh->minimum_m[1];
    /* a tenth of room all around: grown elements stand over the edge */
    float extent_m = 1.2f * fmaxf(2 * radius, level * height + rise * 2 * radius) + 1e-6f;
    float per_m = SIDE / extent_m, middle_m = 0.5f * (mesh->minimum_m[1] + mesh->maximum_m[1]);
    cover->detail = detail;
    cover->sample_m2 = 1 / (double)per_m / (double)per_m;
    cover->middle[0] = SIDE / 2;
    cover->middle[1] = SIDE / 2 - per_m * level * middle_m;
    for (int side = 0; side < SIDES; side++) {
        float turn = 0.4f + 2.0943951f * (float)side, c = cosf(turn), s = sinf(turn);
        memcpy(cover->right[side], (float[3]){per_m * c, 0, -per_m * s}, sizeof(float[3]));
        memcpy(cover->up[side], (float[3]){-per_m * rise * s, per_m * level, -per_m * rise * c},
               sizeof(float[3]));
    }
    cover->stencil = ARENA_ARRAY(arena, uint8_t, SIDES * BYTES);
    cover->hits = ARENA_ARRAY(arena, uint8_t, SIDES * BYTES);
    mark_batches(cover, cover->hits, 0, 0);
    cover->plant_m2 = count_m2(cover);
    return cover;
}

double cover_plant(const struct cover *cover)
{
    return cover->plant_m2;
}

double cover_of_run(struct cover *cover, const struct cover_run *run)
{
    const struct prune *prune = run->prune;
    size_t length = (size_t)ceilf(run->kept);
    if (cover->bark != run->bark || cover->stout != run->stout) {
        memset(cover->stencil, 0, SIDES * BYTES);
        mark_batches(cover, cover->stencil, run->bark, run->stout);
        cover->bark = run->bark;
        cover->stout = run->stout;
    }
    memcpy(cover->hits, cover->stencil, SIDES * BYTES);
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
        mark_sides(cover, cover->hits, (const float(*)[3])world);
    }
    return count_m2(cover);
}
