/* What Embree can do at most: neighbouring rays at one poplar, from what they hit to the sun, and
 * from there into the hemisphere. */
#include "calibrate/bench.h"

#include "base/random.h"
#include "plant/plant.h"
#include "wall/embree.h"

#include <math.h>
#include <string.h>

enum { SIDE = 128, RAYS = SIDE * SIDE, TILE = 4 };

/* Rays in packets' order; count of them is whole packets or not. */
struct rays {
    size_t count;
    float (*origin)[3], (*direction)[3];
};

struct ray_bench {
    struct embree *embree;
    int threads;
    struct rays primary, shadow, ambient;
};

static struct rays rays_make(struct arena *arena, size_t count)
{
    struct rays rays = {count, arena_alloc(arena, count, sizeof *rays.origin),
                        arena_alloc(arena, count, sizeof *rays.direction)};
    return rays;
}

static int packet_load(const struct rays *rays, size_t first, struct embree_packet *packet)
{
    size_t left = rays->count - first;
    int count = left < EMBREE_LANES ? (int)left : EMBREE_LANES;
    for (int lane = 0; lane < count; lane++) {
        for (int axis = 0; axis < 3; axis++) {
            packet->origin[axis][lane] = rays->origin[first + (size_t)lane][axis];
            packet->direction[axis][lane] = rays->direction[first + (size_t)lane][axis];
        }
        packet->near[lane] = 0;
        packet->far[lane] = INFINITY;
    }
    return count;
}

static void pass(void *context, enum calibration_index index, int loops)
{
    const struct ray_bench *bench = context;
    bool primary = index == CALIBRATION_rays_primary;
    const struct rays *rays = primary                            ? &bench->primary
                              : index == CALIBRATION_rays_shadow ? &bench->shadow
                                                                 : &bench->ambient;
    size_t packets = (rays->count + EMBREE_LANES - 1) / EMBREE_LANES;
#pragma omp parallel for num_threads(bench->threads) schedule(dynamic, 16)
    for (size_t i = 0; i < packets * (size_t)loops; i++) {
        struct embree_packet packet;
        int count = packet_load(rays, i % packets * EMBREE_LANES, &packet);
        if (primary)
            embree_intersect(bench->embree, &packet, count, true);
        else
            embree_occluded(bench->embree, &packet, count);
    }
}

/* A picture of the crown from the side: parallel rays, tiles of 4 x 4. */
static void primary_aim(struct ray_bench *bench, const struct mesh *mesh)
{
    float middle_m[3];
    for (int axis = 0; axis < 3; axis++)
        middle_m[axis] = 0.5f * (mesh->minimum_m[axis] + mesh->maximum_m[axis]);
    for (size_t i = 0; i < RAYS; i++) {
        size_t tile = i / (TILE * TILE), in = i % (TILE * TILE);
        size_t x = tile % (SIDE / TILE) * TILE + in % TILE;
        size_t y = tile / (SIDE / TILE) * TILE + in / TILE;
        float *origin = bench->primary.origin[i];
        const float direction[3] = {0, 0, -1};
        /* The middle half of the height, all of the width. */
        origin[0] = middle_m[0] + mesh->radius_m * (2 * ((float)x + 0.5f) / SIDE - 1);
        origin[1] = middle_m[1] + 0.25f * (mesh->maximum_m[1] - mesh->minimum_m[1]) *
                                      (2 * ((float)y + 0.5f) / SIDE - 1);
        origin[2] = mesh->maximum_m[2] + mesh->radius_m;
        memcpy(bench->primary.direction[i], direction, sizeof direction);
    }
}

/* Uniform over the half of the sphere that is on normal's side. */
static void hemisphere_draw(struct random *random, const float normal[3], float direction[3])
{
    float z = 2 * random_float(random) - 1, angle = 6.2831853f * random_float(random);
    float radius = sqrtf(fmaxf(0, 1 - z * z));
    direction[0] = radius * cosf(angle);
    direction[1] = radius * sinf(angle);
    direction[2] = z;
    float side = 0;
    for (int axis = 0; axis < 3; axis++)
        side += direction[axis] * normal[axis];
    for (int axis = 0; axis < 3 && side < 0; axis++)
        direction[axis] = -direction[axis];
}

/* Shadow and ambient rays begin a millimetre in front of what the primary ones hit. */
static void secondary_aim(struct ray_bench *bench)
{
    const float sun[3] = {0.48f, 0.64f, 0.6f};
    struct random random = random_seed(1, 0);
    size_t hits = 0;
    for (size_t first = 0; first < RAYS; first += EMBREE_LANES) {
        struct embree_packet packet;
        int count = packet_load(&bench->primary, first, &packet);
        embree_intersect(bench->embree, &packet, count, true);
        for (int lane = 0; lane < count; lane++) {
            if (packet.geometry[lane] == EMBREE_NONE)
                continue;
            float normal[3] = {packet.normal[0][lane], packet.normal[1][lane],
                               packet.normal[2][lane]};
            for (int axis = 0; axis < 3; axis++) {
                normal[axis] *= packet.normal[2][lane] < 0 ? -1.0f : 1.0f;
                float at = packet.origin[axis][lane];
                at += packet.far[lane] * packet.direction[axis][lane];
                at -= 0.001f * packet.direction[axis][lane];
                bench->shadow.origin[hits][axis] = bench->ambient.origin[hits][axis] = at;
                bench->shadow.direction[hits][axis] = sun[axis];
            }
            hemisphere_draw(&random, normal, bench->ambient.direction[hits]);
            hits++;
        }
    }
    bench->shadow.count = bench->ambient.count = hits;
}

static enum status scene_make(struct arena *arena, struct ray_bench *bench, struct error *error)
{
    struct plant *plant;
    const struct mesh *mesh;
    enum status status = plant_generated(arena, "poplar", NULL, &plant, error);
    if (!status)
        status = plant_mesh(plant, &mesh, error);
    if (status)
        return status;
    const struct embree_part part = {.triangles_count = (uint32_t)mesh->triangles_count};
    const struct embree_mesh traced = {.positions = (const float *)mesh->positions,
                                       .vertices_count = mesh->vertices_count,
                                       .triangles = (const uint32_t *)mesh->triangles,
                                       .triangles_count = mesh->triangles_count,
                                       .parts = &part,
                                       .parts_count = 1};
    const float identity[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    status = embree_add_mesh(bench->embree, &traced, error);
    if (!status) {
        embree_add_instance(bench->embree, 0, identity);
        status = embree_commit(bench->embree, error);
    }
    if (!status)
        primary_aim(bench, mesh);
    return status;
}

enum status ray_bench_create(struct arena *arena, int threads, struct ray_bench **bench,
                             struct work works[CALIBRATION_COUNT], struct error *error)
{
    struct ray_bench *made = ARENA_NEW(arena, struct ray_bench);
    enum status status = embree_create(arena, threads, &made->embree, error);
    if (status)
        return status;
    *bench = made;
    made->threads = threads;
    made->primary = rays_make(arena, RAYS);
    made->shadow = rays_make(arena, RAYS);
    made->ambient = rays_make(arena, RAYS);
    status = scene_make(arena, made, error);
    if (status)
        return status;
    secondary_aim(made);
    works[CALIBRATION_rays_primary] = (struct work){pass, made, (double)made->primary.count, NAN};
    works[CALIBRATION_rays_shadow] = (struct work){pass, made, (double)made->shadow.count, NAN};
    works[CALIBRATION_rays_ambient] = (struct work){pass, made, (double)made->ambient.count, NAN};
    return STATUS_OK;
}

void ray_bench_destroy(struct ray_bench *bench)
{
    if (bench)
        embree_destroy(bench->embree);
}
