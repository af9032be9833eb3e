/* One tile of the reference: camera rays in packets of 16, shading as scene/effects.h has it, then
 * the sun and sky rays that the hits ask for, gathered into full packets.
 *
 * What a pixel sees begins at the near plane, as in every method. Which side of a surface the eye
 * is on is decided by the triangle. A sun or sky ray starts on the side of the triangle that it
 * leaves through: a leaf is thin, so light from behind is not blocked by the leaf itself; bark and
 * terrain are solid, so a direction behind the triangle is blocked by the surface itself, even
 * where the smooth normal still faces it. */
#include "truth/reference_parts.h"
#include "truth/sampler.h"

#include <math.h>
#include <string.h>

#define PI_F 3.14159265358979f
#define TILE_PIXELS (TILE_SIDE * TILE_SIDE)
#define QUEUE_RAYS 256

/* Rays whose light counts if nothing is in their way. */
struct ray_queue {
    float origin[3][QUEUE_RAYS], direction[3][QUEUE_RAYS];
    float light[3][QUEUE_RAYS];
    uint32_t slot[QUEUE_RAYS];
    int count;
};

struct tile_work {
    struct embree_packet packet, blocked;
    /* Of each lane of the packet: pixel of the picture, replicate and sample, and where its light
     * is added up. */
    uint32_t pixel[EMBREE_LANES], replicate[EMBREE_LANES], index[EMBREE_LANES], slot[EMBREE_LANES];
    int lanes;
    struct ray_queue sun, sky;
    float sums[TILE_PIXELS * REFERENCE_REPLICATES][4];
};

struct tile_work *tile_work_create(struct arena *arena)
{
    return ARENA_NEW(arena, struct tile_work);
}

static void queue_trace(const struct picture *picture, struct tile_work *work,
                        struct ray_queue *queue)
{
    struct embree_packet *packet = &work->blocked;
    for (int first = 0; first < queue->count; first += EMBREE_LANES) {
        int left = queue->count - first, count = left < EMBREE_LANES ? left : EMBREE_LANES;
        for (int axis = 0; axis < 3; axis++) {
            memcpy(packet->origin[axis], queue->origin[axis] + first, sizeof packet->origin[axis]);
            memcpy(packet->direction[axis], queue->direction[axis] + first,
                   sizeof packet->direction[axis]);
        }
        for (int i = 0; i < EMBREE_LANES; i++) {
            packet->near[i] = 0;
            packet->far[i] = INFINITY;
        }
        uint32_t blocked = embree_occluded(picture->traced.embree, packet, count);
        for (int i = 0; i < count; i++) {
            if (blocked >> i & 1)
                continue;
            float *sum = work->sums[queue->slot[first + i]];
            for (int channel = 0; channel < 3; channel++)
                sum[channel] += queue->light[channel][first + i];
        }
    }
    queue->count = 0;
}

/* A point that is seen. Directions are unit; geometric and normal are on the eye's side. */
struct sight {
    const struct surface *surface;
    float point[3], geometric[3], normal[3], albedo[3];
    float distance_m, offset_m;
};

/* Leaves the surface at a distance that exceeds the error of the hit point: a few units in the last
 * place of the largest number that went into it. */
static void queue_push(struct ray_queue *queue, const struct sight *sight, const float direction[3],
                       const float light[3], uint32_t slot)
{
    float side = glm_vec3_dot((float *)sight->geometric, (float *)direction);
    if (side <= 0 && !sight->surface->leaf)
        return;
    float offset = copysignf(sight->offset_m, side);
    int at = queue->count++;
    for (int axis = 0; axis < 3; axis++) {
        queue->origin[axis][at] = sight->point[axis] + offset * sight->geometric[axis];
        queue->direction[axis][at] = direction[axis];
        queue->light[axis][at] = light[axis];
    }
    queue->slot[at] = slot;
}

/* Rotates from the plant's space into the world's and makes unit; false for a zero vector. */
static bool turn_unit(const struct placement *placement, const float from[3], float to[3])
{
    float x = from[0] * placement->turn_cos + from[2] * placement->turn_sin;
    float z = from[2] * placement->turn_cos - from[0] * placement->turn_sin;
    float length = sqrtf(x * x + from[1] * from[1] + z * z);
    if (!(length > 0))
        return false;
    to[0] = x / length;
    to[1] = from[1] / length;
    to[2] = z / length;
    return true;
}

static void smooth_normal(const struct sight *sight, const struct placement *placement,
                          uint32_t triangle, float u, float v, float normal[3])
{
    const struct mesh *mesh = sight->surface->mesh;
    const uint32_t *corner = mesh->triangles[triangle];
    float mixed[3];
    for (int axis = 0; axis < 3; axis++)
        mixed[axis] = (1 - u - v) * mesh->normals[corner[0]][axis] +
                      u * mesh->normals[corner[1]][axis] + v * mesh->normals[corner[2]][axis];
    if (!turn_unit(placement, mixed, normal))
        memcpy(normal, sight->geometric, 3 * sizeof *normal);
}

static void varied_albedo(const struct surface *surface, uint32_t triangle, float u, float v,
                          float albedo[3])
{
    const struct mesh *mesh = surface->mesh;
    if (mesh->colors) {
        const uint32_t *corner = mesh->triangles[triangle];
        for (int i = 0; i < 3; i++)
            albedo[i] *= (1 - u - v) * mesh->colors[corner[0]][i] + u * mesh->colors[corner[1]][i] +
                         v * mesh->colors[corner[2]][i];
    }
    if (surface->texture) {
        float uv[2], rgba[4];
        mesh_uv(mesh, triangle, u, v, uv);
        texture_sample(surface->texture, uv, rgba);
        for (int i = 0; i < 3; i++)
            albedo[i] *= rgba[i];
    }
}

/* What the lane sees; the packet has hit something there. */
static void sight_find(const struct picture *picture, const struct embree_packet *packet, int lane,
                       struct sight *sight)
{
    const struct placement *placement = &picture->traced.placements[packet->instance[lane]];
    const struct surface *surface =
        &picture->traced.surfaces[placement->first_surface + packet->geometry[lane]];
    uint32_t triangle = surface->first_triangle + packet->primitive[lane];
    float u = packet->u[lane], v = packet->v[lane];
    float across[3] = {packet->normal[0][lane], packet->normal[1][lane], packet->normal[2][lane]};
    sight->surface = surface;
    sight->distance_m = packet->far[lane];
    float largest = sight->distance_m, toward = 0;
    if (!turn_unit(placement, across, sight->geometric)) /* a triangle without area */
        for (int axis = 0; axis < 3; axis++)
            sight->geometric[axis] = -packet->direction[axis][lane];
    for (int axis = 0; axis < 3; axis++) {
        float direction = packet->direction[axis][lane];
        sight->point[axis] = packet->origin[axis][lane] + sight->distance_m * direction;
        largest = fmaxf(largest, fabsf(sight->point[axis]));
        toward += direction * sight->geometric[axis];
    }
    sight->offset_m = 1e-6f + 0x1p-19f * largest;
    if (surface->flat)
        memcpy(sight->normal, sight->geometric, sizeof sight->normal);
    else
        smooth_normal(sight, placement, triangle, u, v, sight->normal);
    if (toward > 0)
        for (int axis = 0; axis < 3; axis++) {
            sight->geometric[axis] = -sight->geometric[axis];
            sight->normal[axis] = -sight->normal[axis];
        }
    memcpy(sight->albedo, surface->albedo, sizeof sight->albedo);
    if (surface->varied)
        varied_albedo(surface, triangle, u, v, sight->albedo);
}

/* Cosine-weighted direction around the unit normal. Frame: Duff et al. 2017, JCGT 6(1). */
static void sky_direction(const float normal[3], const float point[2], float direction[3])
{
    float radius = sqrtf(point[0]), angle = 2 * PI_F * point[1];
    float x = radius * cosf(angle), y = radius * sinf(angle), z = sqrtf(1 - point[0]);
    float sign = copysignf(1, normal[2]), a = -1 / (sign + normal[2]);
    float b = normal[0] * normal[1] * a;
    float first[3] = {1 + sign * normal[0] * normal[0] * a, sign * b, -sign * normal[0]};
    float second[3] = {b, sign + normal[1] * normal[1] * a, -normal[1]};
    for (int axis = 0; axis < 3; axis++)
        direction[axis] = x * first[axis] + y * second[axis] + z * normal[axis];
}

static void light_sun(const struct picture *picture, struct tile_work *work,
                      const struct sight *sight, const float white[3], uint32_t slot)
{
    const float *sun = picture->view->sun_direction;
    float facing =
        sight->normal[0] * sun[0] + sight->normal[1] * sun[1] + sight->normal[2] * sun[2];
    if (sight->surface->leaf && picture->effects & EFFECT_TWO_SIDED)
        facing = fabsf(facing);
    if (!(facing > 0))
        return;
    float light[3];
    for (int i = 0; i < 3; i++)
        light[i] = white[i] * picture->sun[i] * facing;
    if (picture->effects & EFFECT_SUN_SHADOWS)
        queue_push(&work->sun, sight, sun, light, slot);
    else
        for (int i = 0; i < 3; i++)
            work->sums[slot][i] += light[i];
}

static void light_sky(const struct picture *picture, struct tile_work *work,
                      const struct sight *sight, const float white[3], int lane)
{
    uint32_t slot = work->slot[lane];
    float light[3];
    for (int i = 0; i < 3; i++)
        light[i] = white[i] * picture->ambient[i];
    if (picture->effects & EFFECT_SKY_OCCLUSION) {
        struct sampler sampler =
            sampler_create(picture->seed, work->pixel[lane], work->replicate[lane], SAMPLER_SKY);
        float point[2], direction[3];
        sampler_point(&sampler, work->index[lane], point);
        sky_direction(sight->normal, point, direction);
        queue_push(&work->sky, sight, direction, light, slot);
    } else {
        for (int i = 0; i < 3; i++)
            work->sums[slot][i] += light[i];
    }
}

static void shade_lane(const struct picture *picture, struct tile_work *work, int lane)
{
    const struct scene *scene = picture->traced.scene;
    const struct embree_packet *packet = &work->packet;
    float *sum = work->sums[work->slot[lane]];
    if (packet->geometry[lane] == EMBREE_NONE) {
        float direction[3] = {packet->direction[0][lane], packet->direction[1][lane],
                              packet->direction[2][lane]};
        float sky[3];
        sky_radiance(&scene->sky, direction, sky);
        for (int i = 0; i < 3; i++)
            sum[i] += sky[i];
        return;
    }
    struct sight sight;
    sight_find(picture, packet, lane, &sight);
    float clear = 1;
    if (picture->effects & EFFECT_FOG)
        clear = expf(-scene->fog.density_per_m * sight.distance_m);
    float white[3];
    for (int i = 0; i < 3; i++) {
        white[i] = clear * sight.albedo[i];
        sum[i] += (1 - clear) * scene->fog.color[i];
    }
    sum[3] += (float)sight.surface->plant;
    if (picture->sun[0] + picture->sun[1] + picture->sun[2] > 0)
        light_sun(picture, work, &sight, white, work->slot[lane]);
    if (picture->ambient[0] + picture->ambient[1] + picture->ambient[2] > 0)
        light_sky(picture, work, &sight, white, lane);
}

static void packet_trace(const struct picture *picture, struct tile_work *work,
                         struct ray_counts *counts)
{
    embree_intersect(picture->traced.embree, &work->packet, work->lanes, false);
    counts->primary += work->lanes;
    counts->shadow -= work->sun.count;
    counts->occlusion -= work->sky.count;
    for (int lane = 0; lane < work->lanes; lane++)
        shade_lane(picture, work, lane);
    counts->shadow += work->sun.count;
    counts->occlusion += work->sky.count;
    work->lanes = 0;
    if (work->sun.count > QUEUE_RAYS - EMBREE_LANES)
        queue_trace(picture, work, &work->sun);
    if (work->sky.count > QUEUE_RAYS - EMBREE_LANES)
        queue_trace(picture, work, &work->sky);
}

static void ray_push(const struct picture *picture, struct tile_work *work, const float at_px[2])
{
    const struct view *view = picture->view;
    struct embree_packet *packet = &work->packet;
    float direction[3];
    view_ray(view, at_px[0], at_px[1], direction);
    int lane = work->lanes++;
    float depth = 0;
    for (int axis = 0; axis < 3; axis++) {
        packet->origin[axis][lane] = view->eye_m[axis];
        packet->direction[axis][lane] = direction[axis];
        depth += direction[axis] * view->forward[axis];
    }
    packet->near[lane] = view->near_m / depth;
    packet->far[lane] = INFINITY;
}

static void pixel_trace(const struct picture *picture, struct tile_work *work, int x, int y,
                        uint32_t local, const struct samples *samples, struct ray_counts *counts)
{
    uint32_t pixel = (uint32_t)(y * picture->width_px + x);
    uint32_t first = samples->counts[pixel] / REFERENCE_REPLICATES;
    uint32_t end = samples->wanted[pixel] / REFERENCE_REPLICATES;
    for (uint32_t replicate = 0; replicate < REFERENCE_REPLICATES; replicate++) {
        struct sampler sampler = sampler_create(picture->seed, pixel, replicate, SAMPLER_PIXEL);
        for (uint32_t index = first; index < end; index++) {
            float point[2];
            sampler_point(&sampler, index, point);
            work->pixel[work->lanes] = pixel;
            work->replicate[work->lanes] = replicate;
            work->index[work->lanes] = index;
            work->slot[work->lanes] = local * REFERENCE_REPLICATES + replicate;
            ray_push(picture, work, (float[2]){(float)x + point[0], (float)y + point[1]});
            if (work->lanes == EMBREE_LANES)
                packet_trace(picture, work, counts);
        }
    }
}

void tile_trace(const struct picture *picture, struct tile_work *work, int tile,
                struct samples *samples, struct ray_counts *counts)
{
    int columns = (picture->width_px + TILE_SIDE - 1) / TILE_SIDE;
    int left = tile % columns * TILE_SIDE, top = tile / columns * TILE_SIDE;
    int right = left + TILE_SIDE < picture->width_px ? left + TILE_SIDE : picture->width_px;
    int bottom = top + TILE_SIDE < picture->height_px ? top + TILE_SIDE : picture->height_px;
    memset(work->sums, 0, sizeof work->sums);
    for (int y = top; y < bottom; y++)
        for (int x = left; x < right; x++)
            pixel_trace(picture, work, x, y, (uint32_t)((y - top) * TILE_SIDE + x - left), samples,
                        counts);
    if (work->lanes)
        packet_trace(picture, work, counts);
    queue_trace(picture, work, &work->sun);
    queue_trace(picture, work, &work->sky);
    for (int y = top; y < bottom; y++)
        for (int x = left; x < right; x++) {
            size_t pixel = (size_t)y * (size_t)picture->width_px + (size_t)x;
            const float *sums =
                work->sums[((y - top) * TILE_SIDE + x - left) * REFERENCE_REPLICATES];
            float *total = samples->sums[pixel][0];
            for (int i = 0; i < REFERENCE_REPLICATES * 4; i++)
                total[i] += sums[i];
            samples->counts[pixel] = samples->wanted[pixel];
        }
}
