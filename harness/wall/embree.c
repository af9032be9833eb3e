/* The only file that includes Embree; what the versions spell differently is in embree_api3.h and
 * embree_api4.h. */
#include "wall/embree.h"

#include "wall/embree_cones.h"

/* clang-format off */
#define TEXT(x) #x
#define API_HEADER(version) TEXT(wall/embree_api##version.h)
#define API_HEADER_OF(version) API_HEADER(version)
/* clang-format on */
#include API_HEADER_OF(EMBREE_VERSION)

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#define SAME_PLACE(mine, theirs)                                                                   \
    _Static_assert(offsetof(struct embree_packet, mine) == offsetof(struct RTCRayHit16, theirs),   \
                   #mine " lies where Embree has " #theirs)
SAME_PLACE(origin, ray.org_x);
SAME_PLACE(near, ray.tnear);
SAME_PLACE(direction, ray.dir_x);
SAME_PLACE(far, ray.tfar);
SAME_PLACE(flags, ray.flags);
SAME_PLACE(normal, hit.Ng_x);
SAME_PLACE(u, hit.u);
SAME_PLACE(v, hit.v);
SAME_PLACE(primitive, hit.primID);
SAME_PLACE(geometry, hit.geomID);
SAME_PLACE(instance, hit.instID);
_Static_assert(sizeof(struct embree_packet) >= sizeof(struct RTCRayHit16), "room for the packet");
_Static_assert(EMBREE_NONE == RTC_INVALID_GEOMETRY_ID, "the same mark for no hit");

struct mesh_scene {
    RTCScene scene;
    struct mesh_scene *next;
};

/* What the filter of a part needs; Embree keeps the pointer. */
struct filter {
    embree_opaque *opaque;
    const void *data;
};

struct embree {
    struct arena *arena;
    RTCDevice device;
    RTCScene top;
    struct mesh_scene *meshes; /* the newest first */
    uint32_t meshes_count;
    RTCScene *by_number; /* meshes_count, made by embree_add_instance */
    uint32_t by_number_count;
    size_t bytes;
};

static bool count_memory(void *user, ssize_t bytes, bool post)
{
    (void)post;
    struct embree *embree = user;
    __atomic_fetch_add(&embree->bytes, (size_t)bytes, __ATOMIC_RELAXED);
    return true;
}

static enum status device_status(struct embree *embree, const char *what, struct error *error)
{
    enum RTCError code = rtcGetDeviceError(embree->device);
    if (code == RTC_ERROR_NONE)
        return STATUS_OK;
    if (code == RTC_ERROR_OUT_OF_MEMORY)
        return error_set(error, STATUS_MEMORY, "Embree: %s: no memory left after %zu MiB", what,
                         embree->bytes >> 20);
    return error_set(error, STATUS_INTERNAL, "Embree: %s: error code %d", what, (int)code);
}

enum status embree_create(struct arena *arena, int threads, struct embree **embree,
                          struct error *error)
{
    struct embree *made = ARENA_NEW(arena, struct embree);
    made->arena = arena;
    char configuration[64];
    snprintf(configuration, sizeof configuration, "threads=%d,set_affinity=0", threads);
    made->device = rtcNewDevice(configuration);
    if (!made->device)
        return error_set(error, STATUS_UNAVAILABLE, "Embree: no device on this CPU, error code %d",
                         (int)rtcGetDeviceError(NULL));
    rtcSetDeviceMemoryMonitorFunction(made->device, count_memory, made);
    made->top = rtcNewScene(made->device);
    rtcSetSceneFlags(made->top, RTC_SCENE_FLAG_ROBUST);
    *embree = made;
    return device_status(made, "a new scene", error);
}

void embree_destroy(struct embree *embree)
{
    if (!embree)
        return;
    rtcReleaseScene(embree->top);
    for (struct mesh_scene *mesh = embree->meshes; mesh; mesh = mesh->next)
        rtcReleaseScene(mesh->scene);
    rtcReleaseDevice(embree->device);
}

static void filter_packet(const struct RTCFilterFunctionNArguments *args)
{
    const struct filter *filter = args->geometryUserPtr;
    /* RTCHitN: N each of Ng_x, Ng_y, Ng_z, u, v, primID, geomID, instID. */
    const float *values = (const float *)args->hit;
    for (unsigned i = 0; i < args->N; i++) {
        uint32_t primitive;
        memcpy(&primitive, values + 5 * args->N + i, sizeof primitive);
        if (args->valid[i] && !filter->opaque(filter->data, primitive, values[3 * args->N + i],
                                              values[4 * args->N + i]))
            args->valid[i] = 0;
    }
}

static void add_part(struct embree *embree, RTCScene scene, const struct embree_mesh *mesh,
                     const struct embree_part *part, RTCBuffer positions)
{
    RTCGeometry geometry = rtcNewGeometry(embree->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    if (positions)
        rtcSetGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, positions, 0,
                             3 * sizeof(float), mesh->vertices_count);
    void *triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                              3 * sizeof(uint32_t), part->triangles_count);
    if (triangles)
        memcpy(triangles, mesh->triangles + 3 * (size_t)part->first_triangle,
               3 * sizeof(uint32_t) * part->triangles_count);
    if (part->opaque) {
        struct filter *filter = ARENA_NEW(embree->arena, struct filter);
        *filter = (struct filter){part->opaque, part->data};
        rtcSetGeometryUserData(geometry, filter);
        rtcSetGeometryIntersectFilterFunction(geometry, filter_packet);
        rtcSetGeometryOccludedFilterFunction(geometry, filter_packet);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, (unsigned)(part - mesh->parts));
    rtcReleaseGeometry(geometry);
}

/* Triangles above which a mesh is kept in less memory and met more slowly: a terrain of 8192 x 8192
 * quads has 134 million, whose reference takes 11 GB in place of 19. */
enum { COMPACT_FROM = 1 << 24 };

static struct mesh_scene *scene_begin(struct embree *embree, size_t triangles)
{
    struct mesh_scene *made = ARENA_NEW(embree->arena, struct mesh_scene);
    const enum RTCSceneFlags compact = triangles > COMPACT_FROM ? RTC_SCENE_FLAG_COMPACT : 0;
    made->scene = rtcNewScene(embree->device);
    rtcSetSceneFlags(made->scene, RTC_SCENE_FLAG_ROBUST | compact);
    return made;
}

static enum status scene_end(struct embree *embree, struct mesh_scene *made, struct error *error)
{
    rtcCommitScene(made->scene);
    made->next = embree->meshes;
    embree->meshes = made;
    embree->meshes_count++;
    return device_status(embree, "building a mesh", error);
}

static void cone_bounds(const struct RTCBoundsFunctionArguments *args)
{
    const float *ends = (const float *)args->geometryUserPtr + 8 * (size_t)args->primID;
    float low[3], high[3];
    for (int i = 0; i < 3; i++) {
        /* Rounded outward by more than the additions' errors. */
        low[i] = fminf(ends[i] - ends[3], ends[4 + i] - ends[7]);
        high[i] = fmaxf(ends[i] + ends[3], ends[4 + i] + ends[7]);
        low[i] -= 0x1p-22f * fabsf(low[i]);
        high[i] += 0x1p-22f * fabsf(high[i]);
    }
    struct RTCBounds *bounds = args->bounds_o;
    bounds->lower_x = low[0], bounds->lower_y = low[1], bounds->lower_z = low[2];
    bounds->upper_x = high[0], bounds->upper_y = high[1], bounds->upper_z = high[2];
}

/* RTCRayN: N each of these; RTCHitN, behind it: N each of Ng_x, Ng_y, Ng_z, u, v, primID, geomID,
 * instID. */
enum { RAY_ORIGIN = 0, RAY_NEAR = 3, RAY_DIRECTION = 4, RAY_FAR = 8, RAY_VALUES = 12 };

/* Lane i of n rays against a cone. */
static bool cone_lane(const void *data, unsigned primitive, const float *rays, unsigned n,
                      unsigned i, float *distance, float normal[3])
{
    float origin[3], direction[3];
    for (unsigned axis = 0; axis < 3; axis++) {
        origin[axis] = rays[(RAY_ORIGIN + axis) * n + i];
        direction[axis] = rays[(RAY_DIRECTION + axis) * n + i];
    }
    return embree_cone_hit((const float *)data + 8 * (size_t)primitive, origin, direction,
                           rays[RAY_NEAR * n + i], rays[RAY_FAR * n + i], distance, normal);
}

static void cone_intersect(const struct RTCIntersectFunctionNArguments *args)
{
    unsigned n = args->N;
    float *rays = (float *)args->rayhit, *hits = rays + RAY_VALUES * n;
    const uint32_t numbers[3] = {args->primID, args->geomID, args->context->instID[0]};
    for (unsigned i = 0; i < n; i++) {
        float distance, normal[3];
        if (!args->valid[i] ||
            !cone_lane(args->geometryUserPtr, args->primID, rays, n, i, &distance, normal))
            continue;
        rays[RAY_FAR * n + i] = distance;
        for (unsigned k = 0; k < 3; k++) {
            hits[k * n + i] = normal[k];
            memcpy(hits + (5 + k) * n + i, &numbers[k], sizeof numbers[k]);
        }
        hits[3 * n + i] = hits[4 * n + i] = 0;
    }
}

static void cone_occluded(const struct RTCOccludedFunctionNArguments *args)
{
    unsigned n = args->N;
    float *rays = (float *)args->ray;
    for (unsigned i = 0; i < n; i++) {
        float distance, normal[3];
        if (args->valid[i] &&
            cone_lane(args->geometryUserPtr, args->primID, rays, n, i, &distance, normal))
            rays[RAY_FAR * n + i] = -INFINITY;
    }
}

enum status embree_add_cones(struct embree *embree, const struct embree_cones *sets,
                             size_t sets_count, struct error *error)
{
    struct mesh_scene *made = scene_begin(embree, 0);
    for (size_t i = 0; i < sets_count; i++) {
        size_t count = sets[i].cones_count;
        float *ends = ARENA_ARRAY(embree->arena, float, 8 * count);
        memcpy(ends, sets[i].ends, 8 * count * sizeof *ends);
        RTCGeometry geometry = rtcNewGeometry(embree->device, RTC_GEOMETRY_TYPE_USER);
        rtcSetGeometryUserPrimitiveCount(geometry, (unsigned)count);
        rtcSetGeometryUserData(geometry, ends);
        rtcSetGeometryBoundsFunction(geometry, cone_bounds, NULL);
        rtcSetGeometryIntersectFunction(geometry, cone_intersect);
        rtcSetGeometryOccludedFunction(geometry, cone_occluded);
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(made->scene, geometry, (unsigned)i);
        rtcReleaseGeometry(geometry);
    }
    return scene_end(embree, made, error);
}

enum status embree_add_mesh(struct embree *embree, const struct embree_mesh *mesh,
                            struct error *error)
{
    /* Embree reads 16 bytes at the last vertex of 12. */
    size_t bytes = mesh->vertices_count * 3 * sizeof(float);
    RTCBuffer positions = rtcNewBuffer(embree->device, bytes + 16);
    if (positions && bytes)
        memcpy(rtcGetBufferData(positions), mesh->positions, bytes);
    struct mesh_scene *made = scene_begin(embree, mesh->triangles_count);
    for (size_t i = 0; i < mesh->parts_count; i++)
        if (mesh->parts[i].triangles_count)
            add_part(embree, made->scene, mesh, &mesh->parts[i], positions);
    if (positions)
        rtcReleaseBuffer(positions);
    return scene_end(embree, made, error);
}

void embree_add_instance(struct embree *embree, uint32_t mesh, const float to_world[12])
{
    if (embree->by_number_count != embree->meshes_count) {
        embree->by_number = ARENA_ARRAY(embree->arena, RTCScene, embree->meshes_count);
        embree->by_number_count = embree->meshes_count;
        uint32_t number = embree->meshes_count;
        for (struct mesh_scene *at = embree->meshes; at; at = at->next)
            embree->by_number[--number] = at->scene;
    }
    RTCGeometry instance = rtcNewGeometry(embree->device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, embree->by_number[mesh]);
    rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, to_world);
    rtcCommitGeometry(instance);
    rtcAttachGeometry(embree->top, instance);
    rtcReleaseGeometry(instance);
}

enum status embree_commit(struct embree *embree, struct error *error)
{
    rtcCommitScene(embree->top);
    return device_status(embree, "building the instances", error);
}

/* Marks the lanes from count on as unused. Where a processor has no vectors of 16, Embree 3 does
 * not look at `valid`: it takes the lanes for a stream, of which it leaves out rays that end before
 * they begin, and Debian's ends the program where one of the others is no number. */
static void lanes_close(struct embree_packet *packet, int valid[EMBREE_LANES], int count)
{
    for (int i = 0; i < EMBREE_LANES; i++)
        valid[i] = i < count ? -1 : 0;
    for (int i = count; i < EMBREE_LANES; i++) {
        for (int axis = 0; axis < 3; axis++) {
            packet->origin[axis][i] = 0;
            packet->direction[axis][i] = 1;
        }
        packet->near[i] = 1;
        packet->far[i] = 0;
    }
}

void embree_intersect(const struct embree *embree, struct embree_packet *packet, int count,
                      bool coherent)
{
    alignas(64) int valid[EMBREE_LANES];
    lanes_close(packet, valid, count);
    for (int i = 0; i < EMBREE_LANES; i++) {
        packet->time[i] = 0;
        packet->mask[i] = UINT32_MAX;
        packet->flags[i] = 0;
        packet->geometry[i] = EMBREE_NONE;
        packet->instance[i] = EMBREE_NONE;
    }
    api_intersect16(valid, embree->top, (struct RTCRayHit16 *)packet, coherent);
}

uint32_t embree_occluded(const struct embree *embree, struct embree_packet *packet, int count)
{
    alignas(64) int valid[EMBREE_LANES];
    lanes_close(packet, valid, count);
    for (int i = 0; i < EMBREE_LANES; i++) {
        packet->time[i] = 0;
        packet->mask[i] = UINT32_MAX;
        packet->flags[i] = 0;
    }
    api_occluded16(valid, embree->top, (struct RTCRay16 *)packet);
    uint32_t blocked = 0;
    for (int i = 0; i < count; i++)
        blocked |= (uint32_t)(packet->far[i] < 0) << i;
    return blocked;
}

const char *embree_version(void)
{
    return "Embree " RTC_VERSION_STRING;
}
