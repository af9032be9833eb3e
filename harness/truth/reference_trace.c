/* One tile of the reference: camera rays in packets of 16, shading as scene/effects.h has it, then
 * the sun and sky rays that the hits ask for, gathered into full packets.
 *
 * What a pixel sees begins at the near plane, as in every method. Which side of a surface the eye
 * is on is decided by the triangle. A sun or sky ray starts on the side of the triangle that it
 * leaves through: a leaf is thin, so light from behind is not blocked by the leaf itself; bark and
 * terrain are solid, so a direction behind the triangle is blocked by the surface itself, even
 * where the smooth normal still faces it. */
#include "truth/reference_sight.h"
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
    float spread; /* how often neighbouring lanes met different instances, of the tile's packets so
                     far */
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

/* Leaves the surface at a distance that exceeds the error of the hit point. */
static void queue_push(struct ray_queue *queue, const struct sights *sights, int lane,
                       const float direction[3], const float light[3], uint32_t slot)
{
    float side = 0;
    for (int axis = 0; axis < 3; axis++)
        side += sights->geometric[axis][lane] * direction[axis];
    if (side <= 0 && !sights->surface[lane]->leaf)
        return;
    float offset = side > 0 ? sights->offset_m[lane] : -sights->offset_m[lane];
    int at = queue->count++;
    for (int axis = 0; axis < 3; axis++) {
        queue->origin[axis][at] =
            sights->point[axis][lane] + offset * sights->geometric[axis][lane];
        queue->direction[axis][at] = direction[axis];
        queue->light[axis][at] = light[axis];
    }
    queue->slot[at] = slot;
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

/* (N.H)^n of a lit needle times its weight. */
static float shine_of(const struct picture *picture, const struct tile_work *work,
                      const struct sights *sights, int lane)
{
    const struct surface *surface = sights->surface[lane];
    float half[3], square = 0, along = 0;
    for (int i = 0; i < 3; i++) {
        half[i] = picture->view->sun_direction[i] - work->packet.direction[i][lane];
        square += half[i] * half[i];
        along += half[i] * sights->normal[i][lane];
    }
    if (square < 1e-12f || !(along > 0))
        return 0;
    return surface->specular * powf(fminf(along / sqrtf(square), 1), surface->exponent);
}

/* D of scene/effects.h. */
static float sun_facing(const struct picture *picture, const struct sights *sights, int lane)
{
    float facing = sights->sun_facing[lane];
    if (picture->effects & EFFECT_TWO_SIDED && sights->surface[lane]->leaf)
        facing = fabsf(facing);
    return facing > 0 ? facing : 0;
}

/* albedo: times how clear the way to the eye is; of a mask, what is lit. */
static void light_sun(const struct picture *picture, struct tile_work *work,
                      const struct sights *sights, int lane, const float albedo[3], float clear)
{
    float facing = sun_facing(picture, sights, lane);
    if (!(facing > 0))
        return;
    float light[3], shine = 0;
    if (picture->effects & EFFECT_SPECULAR && sights->surface[lane]->specular > 0)
        shine = clear * shine_of(picture, work, sights, lane);
    for (int i = 0; i < 3; i++)
        light[i] = picture->masked ? albedo[i] : (albedo[i] * facing + shine) * picture->sun[i];
    if (picture->effects & EFFECT_SUN_SHADOWS)
        queue_push(&work->sun, sights, lane, picture->view->sun_direction, light, work->slot[lane]);
    else
        for (int i = 0; i < 3; i++)
            work->sums[work->slot[lane]][i] += light[i];
}

static void light_sky(const struct picture *picture, struct tile_work *work,
                      const struct sights *sights, int lane, const float white[3])
{
    float light[3];
    for (int i = 0; i < 3; i++)
        light[i] = white[i] * picture->ambient[i];
    if (picture->effects & EFFECT_SKY_OCCLUSION) {
        struct sampler sampler =
            sampler_create(picture->seed, work->pixel[lane], work->replicate[lane], SAMPLER_SKY);
        float normal[3] = {sights->normal[0][lane], sights->normal[1][lane],
                           sights->normal[2][lane]};
        float point[2], direction[3];
        sampler_point(&sampler, work->index[lane], point);
        sky_direction(normal, point, direction);
        queue_push(&work->sky, sights, lane, direction, light, work->slot[lane]);
    } else {
        for (int i = 0; i < 3; i++)
            work->sums[work->slot[lane]][i] += light[i];
    }
}

static void shade_sky(const struct picture *picture, struct tile_work *work, int lane)
{
    const struct embree_packet *packet = &work->packet;
    float direction[3] = {packet->direction[0][lane], packet->direction[1][lane],
                          packet->direction[2][lane]};
    float sky[3];
    sky_radiance(&picture->traced.scene->sky, direction, sky);
    for (int i = 0; i < 3; i++)
        work->sums[work->slot[lane]][i] += sky[i];
}

/* A surface of the shadow mask; the sky is nothing. */
static void mask_lane(const struct picture *picture, struct tile_work *work,
                      const struct sights *sights, int lane)
{
    static const float red[3] = {1, 0, 0};
    float *sum = work->sums[work->slot[lane]];
    sum[1] += 1;
    sum[3] += sights->surface[lane]->plant ? 1.0f : 0.0f;
    light_sun(picture, work, sights, lane, red, 0);
}

static void shade_lane(const struct picture *picture, struct tile_work *work,
                       const struct sights *sights, int lane)
{
    const struct fog *fog = &picture->traced.scene->fog;
    float *sum = work->sums[work->slot[lane]], white[3], clear = 1;
    surface_albedo(sights->surface[lane], &work->packet, lane, white);
    if (picture->effects & EFFECT_FOG) {
        clear = expf(-fog->density_per_m * work->packet.far[lane]);
        for (int i = 0; i < 3; i++) {
            white[i] *= clear;
            sum[i] += (1 - clear) * fog->color[i];
        }
    }
    sum[3] += sights->surface[lane]->plant ? 1.0f : 0.0f;
    if (picture->sun_shines)
        light_sun(picture, work, sights, lane, white, clear);
    if (picture->sky_shines)
        light_sky(picture, work, sights, lane, white);
}

/* Makes the directions unit and starts the rays at the near plane. */
static void packet_aim(const struct picture *picture, struct embree_packet *packet)
{
    const struct view *view = picture->view;
    for (int i = 0; i < EMBREE_LANES; i++) {
        float x = packet->direction[0][i], y = packet->direction[1][i], z = packet->direction[2][i];
        float length = sqrtf(x * x + y * y + z * z), inverse = 1 / length;
        packet->direction[0][i] = x * inverse;
        packet->direction[1][i] = y * inverse;
        packet->direction[2][i] = z * inverse;
        packet->near[i] = view->near_m * length;
        packet->far[i] = INFINITY;
        for (int axis = 0; axis < 3; axis++)
            packet->origin[axis][i] = view->eye_m[axis];
    }
}

/* Coherent traversal saves a quarter to a third of the time where a packet meets few trees, and
 * costs as much where every lane meets another one. What the tile's packets met before decides, and
 * not a clock, so that the same picture comes from every run. */
#define SPREAD_COHERENT 4.0f
#define SPREAD_AT_FIRST 15.0f

static void spread_update(struct tile_work *work)
{
    int changes = 0;
    for (int lane = 1; lane < work->lanes; lane++)
        changes += work->packet.instance[lane] != work->packet.instance[lane - 1];
    work->spread += 0.25f * ((float)changes - work->spread);
}

static void packet_trace(const struct picture *picture, struct tile_work *work,
                         struct ray_counts *counts)
{
    struct sights sights;
    packet_aim(picture, &work->packet);
    embree_intersect(picture->traced.embree, &work->packet, work->lanes,
                     work->spread < SPREAD_COHERENT);
    spread_update(work);
    sights_find(picture, &work->packet, work->lanes, &sights);
    counts->primary += work->lanes;
    counts->shadow -= work->sun.count;
    counts->occlusion -= work->sky.count;
    for (int lane = 0; lane < work->lanes; lane++)
        if (picture->masked && sights.surface[lane])
            mask_lane(picture, work, &sights, lane);
        else if (picture->masked)
            continue;
        else if (sights.surface[lane])
            shade_lane(picture, work, &sights, lane);
        else
            shade_sky(picture, work, lane);
    counts->shadow += work->sun.count;
    counts->occlusion += work->sky.count;
    work->lanes = 0;
    if (work->sun.count > QUEUE_RAYS - EMBREE_LANES)
        queue_trace(picture, work, &work->sun);
    if (work->sky.count > QUEUE_RAYS - EMBREE_LANES)
        queue_trace(picture, work, &work->sky);
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
            float across = (float)x + point[0], along = (float)y + point[1];
            for (int axis = 0; axis < 3; axis++)
                work->packet.direction[axis][work->lanes] = picture->corner[axis] +
                                                            across * picture->step_x[axis] +
                                                            along * picture->step_y[axis];
            if (++work->lanes == EMBREE_LANES)
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
    work->spread = SPREAD_AT_FIRST;
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
            bool first = samples->counts[pixel] == 0; /* a write, not a read of fresh memory */
            for (int i = 0; i < REFERENCE_REPLICATES * 4; i++)
                total[i] = first ? sums[i] : total[i] + sums[i];
            samples->counts[pixel] = samples->wanted[pixel];
        }
}
