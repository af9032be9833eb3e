/* What the lanes of a packet of camera rays have hit: point, normals, albedo. */
#include "truth/reference_sight.h"

#include "plant/texture.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* What was hit; the loads of all lanes are under way before the first is used. */
static void sights_gather(const struct traced_scene *traced, const struct embree_packet *packet,
                          int lanes, struct sights *sights)
{
    for (int lane = 0; lane < lanes; lane++)
        if (packet->geometry[lane] != EMBREE_NONE)
            __builtin_prefetch(&traced->placements[packet->instance[lane]]);
    for (int lane = 0; lane < EMBREE_LANES; lane++) {
        sights->surface[lane] = NULL;
        sights->turn_cos[lane] = 1;
        sights->turn_sin[lane] = 0;
        sights->rise[lane] = 1;
        if (lane >= lanes || packet->geometry[lane] == EMBREE_NONE)
            continue;
        const struct placement *placement = &traced->placements[packet->instance[lane]];
        const struct surface *surface =
            &traced->surfaces[placement->first_surface + packet->geometry[lane]];
        sights->surface[lane] = surface;
        sights->turn_cos[lane] = placement->turn_cos;
        sights->turn_sin[lane] = placement->turn_sin;
        sights->rise[lane] = placement->rise;
        if (surface->tints)
            __builtin_prefetch(surface->tints[packet->primitive[lane]]);
        if (!surface->flat)
            __builtin_prefetch(
                surface->mesh->triangles[surface->first_triangle + packet->primitive[lane]]);
    }
}

/* Normals from the plant's space into the world's, unit, all lanes; a zero vector becomes minus
 * toward. */
static void turn_lanes(const struct sights *sights, const float from[3][EMBREE_LANES],
                       const float toward[3][EMBREE_LANES], float to[3][EMBREE_LANES])
{
    for (int i = 0; i < EMBREE_LANES; i++) {
        float x = from[0][i] * sights->turn_cos[i] + from[2][i] * sights->turn_sin[i];
        float y = from[1][i] * sights->rise[i];
        float z = from[2][i] * sights->turn_cos[i] - from[0][i] * sights->turn_sin[i];
        float square = x * x + y * y + z * z, inverse = 1 / sqrtf(square);
        bool known = square > 0 && inverse < FLT_MAX;
        to[0][i] = known ? x * inverse : -toward[0][i];
        to[1][i] = known ? y * inverse : -toward[1][i];
        to[2][i] = known ? z * inverse : -toward[2][i];
    }
}

/* Vertex normals, mixed and turned, in the lanes that need them. */
static void smooth_normals(const struct embree_packet *packet, struct sights *sights)
{
    float mixed[3][EMBREE_LANES], turned[3][EMBREE_LANES];
    bool any = false;
    memcpy(mixed, packet->normal, sizeof mixed);
    for (int lane = 0; lane < EMBREE_LANES; lane++) {
        const struct surface *surface = sights->surface[lane];
        if (!surface || surface->flat)
            continue;
        const struct mesh *mesh = surface->mesh;
        const uint32_t *corner = mesh->triangles[surface->first_triangle + packet->primitive[lane]];
        float u = packet->u[lane], v = packet->v[lane];
        any = true;
        for (int axis = 0; axis < 3; axis++)
            mixed[axis][lane] = (1 - u - v) * mesh->normals[corner[0]][axis] +
                                u * mesh->normals[corner[1]][axis] +
                                v * mesh->normals[corner[2]][axis];
    }
    if (!any) {
        memcpy(sights->normal, sights->geometric, sizeof sights->normal);
        return;
    }
    turn_lanes(sights, (const float(*)[EMBREE_LANES])mixed, packet->direction, turned);
    memcpy(sights->normal, turned, sizeof sights->normal);
}

void sights_find(const struct picture *picture, const struct embree_packet *packet, int lanes,
                 struct sights *sights)
{
    const float *sun = picture->view->sun_direction;
    sights_gather(&picture->traced, packet, lanes, sights);
    turn_lanes(sights, packet->normal, packet->direction, sights->geometric);
    smooth_normals(packet, sights);
    for (int i = 0; i < EMBREE_LANES; i++) {
        float toward = 0, largest = packet->far[i], facing = 0;
        for (int axis = 0; axis < 3; axis++) {
            float at = packet->origin[axis][i] + packet->far[i] * packet->direction[axis][i];
            float size = fabsf(at);
            sights->point[axis][i] = at;
            largest = size > largest ? size : largest;
            toward += packet->direction[axis][i] * sights->geometric[axis][i];
            facing += sights->normal[axis][i] * sun[axis];
        }
        /* A few units in the last place of the largest number that went into the point. */
        sights->offset_m[i] = 1e-6f + 0x1p-19f * largest;
        float turn = toward > 0 ? -1.0f : 1.0f;
        sights->sun_facing[i] = turn * facing;
        for (int axis = 0; axis < 3; axis++) {
            sights->geometric[axis][i] *= turn;
            sights->normal[axis][i] *= turn;
        }
    }
}

void surface_albedo(const struct surface *surface, const struct embree_packet *packet, int lane,
                    float albedo[3])
{
    uint32_t primitive = packet->primitive[lane];
    float u = packet->u[lane], v = packet->v[lane];
    const struct mesh *mesh = surface->mesh;
    memcpy(albedo, surface->tints ? surface->tints[primitive] : surface->albedo,
           3 * sizeof *albedo);
    if (!surface->varied)
        return;
    const uint32_t *corner = mesh->triangles[surface->first_triangle + primitive];
    if (mesh->colors && !surface->tints)
        for (int i = 0; i < 3; i++)
            albedo[i] *= (1 - u - v) * mesh->colors[corner[0]][i] + u * mesh->colors[corner[1]][i] +
                         v * mesh->colors[corner[2]][i];
    if (surface->texture) {
        float uv[2], rgba[4];
        mesh_uv(mesh, surface->first_triangle + primitive, u, v, uv);
        texture_sample(surface->texture, uv, rgba);
        for (int i = 0; i < 3; i++)
            albedo[i] *= rgba[i];
    }
}
