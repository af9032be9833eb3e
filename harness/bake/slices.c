/* Slices of a plant: the request, the cache. */
#include "bake/slices.h"

#include "bake/slices_bake.h"
#include "bake/slices_coloring.h"
#include "base/file.h"
#include "base/hash.h"
#include "plant/coloring.h"

#include <math.h>
#include <string.h>

/* Changes whenever the same request would bake other bytes. */
enum { SLICES_VERSION = 4, DIRECTIONS_MOST = 64 };

const float slices_axes[3][3] = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};

static enum status in_range(const char *name, long value, long low, long high, struct error *error)
{
    if (value >= low && value <= high)
        return STATUS_OK;
    return error_set(error, STATUS_INVALID, "slices: %s: %ld is outside %ld..%ld", name, value, low,
                     high);
}

static enum status check(const struct slices_request *request, struct error *error)
{
    enum status status =
        in_range("directions", (long)request->directions_count, 1, DIRECTIONS_MOST, error);
    if (status == STATUS_OK)
        status = in_range("width_px", request->width_px, 1, SLICES_MOST, error);
    if (status == STATUS_OK)
        status = in_range("height_px", request->height_px, 1, SLICES_MOST, error);
    if (status == STATUS_OK)
        status = in_range("count", request->count, 1, SLICES_MOST, error);
    if (status == STATUS_OK)
        status = in_range("samples", request->samples, 1, 8, error);
    if (status == STATUS_OK)
        status = in_range("lights", (long)request->lights_count, 0, SLICES_LIGHTS, error);
    if (status == STATUS_OK)
        status = in_range("views", (long)request->views, 0, COLORING_VIEWS_MAX, error);
    for (size_t i = 0; status == STATUS_OK && i < request->directions_count; i++) {
        const float *d = request->directions[i];
        float square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        if (!(fabsf(square - 1) < 1e-3f))
            return error_set(error, STATUS_INVALID,
                             "slices: direction %zu: (%g, %g, %g) is not of length 1", i,
                             (double)d[0], (double)d[1], (double)d[2]);
    }
    return status;
}

static uint64_t key_of(uint64_t key, const struct slices_request *request)
{
    const int values[] = {SLICES_VERSION,      request->width_px,   request->height_px,
                          request->count,      request->samples,    (int)request->cut,
                          (int)request->parts, (int)request->views, request->binary};
    key = hash_bytes(hash_text(key, "slices"), values, sizeof values);
    return hash_bytes(key, request->directions, request->directions_count * sizeof(float[3]));
}

/* An entry of the cache: the struct (its pointers mean nothing there), then its arrays, each from a
 * multiple of 64 bytes on. */
enum { ARRAYS = 6 };
struct packing {
    size_t sizes[ARRAYS], places[ARRAYS], total;
};

static struct packing pack(const struct slices *slices)
{
    struct packing packing = {
        .sizes = {
            sizeof *slices,
            slices->stacks_count * sizeof *slices->stacks,
            slices->stacks_count * (size_t)slices->count * sizeof *slices->slices,
            slices->texels_count * sizeof *slices->color,
            slices->texels_count * sizeof *slices->normal,
            slices->texels_count * sizeof *slices->depth,
        }};
    for (int i = 0; i < ARRAYS; i++) {
        packing.places[i] = packing.total;
        packing.total += (packing.sizes[i] + 63) & ~(size_t)63;
    }
    return packing;
}

static void cache_slices(uint64_t key, const struct slices *slices)
{
    struct arena *scratch = arena_create(0);
    struct packing packing = pack(slices);
    const void *arrays[ARRAYS] = {slices,        slices->stacks, slices->slices,
                                  slices->color, slices->normal, slices->depth};
    uint8_t *bytes = arena_alloc(scratch, packing.total, 1);
    for (int i = 0; i < ARRAYS; i++)
        memcpy(bytes + packing.places[i], arrays[i], packing.sizes[i]);
    cache_put("slices", key, bytes, packing.total);
    arena_destroy(scratch);
}

static const struct slices *cached_slices(struct arena *arena, uint64_t key,
                                          const struct slices_request *request)
{
    void *data;
    size_t size;
    if (!cache_get(arena, "slices", key, &data, &size) || size < sizeof(struct slices))
        return NULL;
    struct slices *slices = data;
    if (slices->stacks_count != request->directions_count || slices->count != request->count ||
        slices->texels_count > size || slices->lights_count > 0)
        return NULL;
    struct packing packing = pack(slices);
    if (packing.total != size)
        return NULL;
    uint8_t *bytes = data;
    slices->stacks = (void *)(bytes + packing.places[1]);
    slices->slices = (void *)(bytes + packing.places[2]);
    slices->color = (void *)(bytes + packing.places[3]);
    slices->normal = (void *)(bytes + packing.places[4]);
    slices->depth = (void *)(bytes + packing.places[5]);
    return slices;
}

enum status slices_create(struct arena *arena, struct plant *plant,
                          const struct slices_request *request, int threads,
                          const struct slices **slices, struct error *error)
{
    const struct mesh *mesh;
    uint64_t key;
    enum status status = check(request, error);
    if (status == STATUS_OK)
        status = plant_hash(plant, &key, error);
    if (status != STATUS_OK)
        return status;
    key = key_of(key, request);
    if (request->lights_count == 0 && (*slices = cached_slices(arena, key, request)) != NULL)
        return STATUS_OK;
    struct slices *made = ARENA_NEW(arena, struct slices);
    status = plant_mesh(plant, &mesh, error);
    if (status == STATUS_OK && request->views > 0)
        status = slices_coloring(arena, plant, request, threads, made, error);
    else if (status == STATUS_OK)
        slices_bake(arena, mesh, request, threads, made);
    if (status != STATUS_OK)
        return status;
    if (request->lights_count == 0)
        cache_slices(key, made);
    *slices = made;
    return STATUS_OK;
}
