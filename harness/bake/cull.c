/* Frustum culling of bounding spheres, radix sort by depth, stable grouping. */
#include "bake/cull.h"

#include <string.h>

struct cull {
    size_t count;
    float *x, *y, *z, *radius; /* count each: the spheres, m */
    uint32_t *instances[2];    /* the lists and their scratch, count each */
    float *depths[2];
};

struct cull_bound cull_bound_of(const struct mesh *mesh)
{
    float half = 0.5f * (mesh->maximum_m[1] - mesh->minimum_m[1]);
    return (struct cull_bound){mesh->minimum_m[1] + half,
                               sqrtf(mesh->radius_m * mesh->radius_m + half * half)};
}

bool cull_cylinder_holds(const struct cull_cylinder *cylinder, const struct instance *instance,
                         const float eye_m[3], float margin_m)
{
    const float *foot = instance->position_m;
    float x = eye_m[0] - foot[0], y = eye_m[1] - foot[1], z = eye_m[2] - foot[2];
    float reach_m = instance->scale * cylinder->radius_m + margin_m;
    return x * x + z * z <= reach_m * reach_m &&
           y >= instance->scale * (instance->stretch * cylinder->low_m - cylinder->beyond_m) -
                    margin_m &&
           y <= instance->scale * (instance->stretch * cylinder->high_m + cylinder->beyond_m) +
                    margin_m;
}

struct cull *cull_create(struct arena *arena, const struct scene *scene,
                         const struct cull_bound *bounds)
{
    struct cull *cull = ARENA_NEW(arena, struct cull);
    size_t count = cull->count = scene->instances_count;
    cull->x = ARENA_ARRAY(arena, float, count);
    cull->y = ARENA_ARRAY(arena, float, count);
    cull->z = ARENA_ARRAY(arena, float, count);
    cull->radius = ARENA_ARRAY(arena, float, count);
    for (int i = 0; i < 2; i++) {
        cull->instances[i] = ARENA_ARRAY(arena, uint32_t, count);
        cull->depths[i] = ARENA_ARRAY(arena, float, count);
    }
    for (size_t i = 0; i < count; i++) {
        const struct instance *instance = &scene->instances[i];
        const struct cull_bound *bound = &bounds[instance->species];
        cull->x[i] = instance->position_m[0];
        cull->y[i] =
            instance->position_m[1] + instance->scale * instance->stretch * bound->center_y_m;
        cull->z[i] = instance->position_m[2];
        cull->radius[i] = instance_reach(instance) * bound->radius_m;
    }
    return cull;
}

/* Gribb and Hartmann 2001. */
void cull_planes(const struct view *view, float planes[6][4])
{
    for (int i = 0; i < 6; i++) {
        int row = i / 2;
        float sign = i % 2 ? -1.0f : 1.0f, length = 0;
        for (int j = 0; j < 4; j++)
            planes[i][j] = view->view_projection[j][3] + sign * view->view_projection[j][row];
        for (int j = 0; j < 3; j++)
            length += planes[i][j] * planes[i][j];
        length = sqrtf(length);
        for (int j = 0; j < 4 && length > 0; j++)
            planes[i][j] /= length;
    }
}

/* How far inside the nearest plane each sphere of a block reaches (negative: outside), branch-free.
 */
enum { BLOCK = 256 };
static void reach_of_block(const struct cull *cull, size_t begin, size_t count,
                           const float planes[6][4], float *restrict reach)
{
    const float *restrict x = cull->x + begin, *restrict y = cull->y + begin;
    const float *restrict z = cull->z + begin, *restrict radius = cull->radius + begin;
    for (size_t i = 0; i < count; i++) {
        float least = 1e30f;
        for (int p = 0; p < 6; p++) {
            float d =
                planes[p][0] * x[i] + planes[p][1] * y[i] + planes[p][2] * z[i] + planes[p][3];
            least = d < least ? d : least;
        }
        reach[i] = least + radius[i];
    }
}

struct cull_list cull_view(struct cull *cull, const struct view *view, enum cull_order order)
{
    struct cull_list list = {0, cull->instances[0], cull->depths[0]};
    const float *f = view->forward, *eye = view->eye_m;
    float offset = f[0] * eye[0] + f[1] * eye[1] + f[2] * eye[2];
    float planes[6][4], reach[BLOCK];
    cull_planes(view, planes);
    for (size_t begin = 0; begin < cull->count; begin += BLOCK) {
        size_t count = cull->count - begin < BLOCK ? cull->count - begin : BLOCK;
        reach_of_block(cull, begin, count, (const float(*)[4])planes, reach);
        for (size_t i = 0; i < count; i++) {
            size_t at = begin + i;
            list.instances[list.count] = (uint32_t)at;
            list.depths_m[list.count] =
                f[0] * cull->x[at] + f[1] * cull->y[at] + f[2] * cull->z[at] - offset;
            list.count += reach[i] >= 0;
        }
    }
    if (order != CULL_AS_PLACED)
        cull_sort(list.depths_m, list.instances, cull->depths[1], cull->instances[1], list.count,
                  order == CULL_BACK_TO_FRONT);
    return list;
}

struct cull_list cull_view_of(struct cull *cull, const struct view *view, enum cull_order order,
                              const uint32_t *instances, size_t count)
{
    struct cull_list list = {0, cull->instances[0], cull->depths[0]};
    const float *f = view->forward, *eye = view->eye_m;
    float offset = f[0] * eye[0] + f[1] * eye[1] + f[2] * eye[2];
    for (size_t i = 0; i < count; i++) {
        size_t at = instances[i];
        const float middle[3] = {cull->x[at], cull->y[at], cull->z[at]};
        list.instances[list.count] = (uint32_t)at;
        list.depths_m[list.count] = f[0] * middle[0] + f[1] * middle[1] + f[2] * middle[2] - offset;
        list.count += view_sees_sphere(view, middle, cull->radius[at]);
    }
    if (order != CULL_AS_PLACED)
        cull_sort(list.depths_m, list.instances, cull->depths[1], cull->instances[1], list.count,
                  order == CULL_BACK_TO_FRONT);
    return list;
}

void cull_group(struct cull *cull, struct cull_list *list, const uint32_t *groups,
                size_t groups_count, uint32_t *first)
{
    memset(first, 0, (groups_count + 1) * sizeof *first);
    for (size_t i = 0; i < list->count; i++)
        first[groups[i] + 1]++;
    for (size_t g = 0; g < groups_count; g++)
        first[g + 1] += first[g];
    for (size_t i = 0; i < list->count; i++) {
        uint32_t to = first[groups[i]]++;
        cull->instances[1][to] = list->instances[i];
        cull->depths[1][to] = list->depths_m[i];
    }
    for (size_t g = groups_count; g > 0; g--) /* each first has run to the next one's place */
        first[g] = first[g - 1];
    first[0] = 0;
    memcpy(list->instances, cull->instances[1], list->count * sizeof *list->instances);
    memcpy(list->depths_m, cull->depths[1], list->count * sizeof *list->depths_m);
}

float cull_focal_px(const struct view *view)
{
    return 0.5f * (float)view->height_px / tanf(0.5f * view->fov_y_rad);
}

/* A float's bits so that unsigned order is the floats' order. */
static inline uint32_t sortable(float key, uint32_t flip)
{
    uint32_t bits;
    memcpy(&bits, &key, sizeof bits);
    if (key != key)
        return UINT32_MAX;
    bits ^= bits >> 31 ? UINT32_MAX : 0x80000000u;
    return bits ^ flip;
}

void cull_sort(float *keys, uint32_t *values, float *scratch_keys, uint32_t *scratch_values,
               size_t count, bool down)
{
    enum { DIGIT_BITS = 11, DIGITS = 1 << DIGIT_BITS, PASSES = 3 };
    uint32_t flip = down ? UINT32_MAX : 0;
    uint32_t place[PASSES][DIGITS];
    memset(place, 0, sizeof place);
    for (size_t i = 0; i < count; i++) {
        uint32_t bits = sortable(keys[i], flip);
        for (int p = 0; p < PASSES; p++)
            place[p][bits >> p * DIGIT_BITS & (DIGITS - 1)]++;
    }
    for (int p = 0; p < PASSES; p++) {
        uint32_t sum = 0;
        for (int d = 0; d < DIGITS; d++) {
            uint32_t here = place[p][d];
            place[p][d] = sum;
            sum += here;
        }
    }
    float *from_keys = keys, *to_keys = scratch_keys;
    uint32_t *from = values, *to = scratch_values;
    for (int p = 0; p < PASSES; p++) {
        for (size_t i = 0; i < count; i++) {
            uint32_t digit = sortable(from_keys[i], flip) >> p * DIGIT_BITS & (DIGITS - 1);
            uint32_t at = place[p][digit]++;
            to_keys[at] = from_keys[i];
            to[at] = from[i];
        }
        float *swap_keys = from_keys;
        from_keys = to_keys;
        to_keys = swap_keys;
        uint32_t *swap = from;
        from = to;
        to = swap;
    }
    /* An odd number of passes ends in the scratch. */
    memcpy(keys, from_keys, count * sizeof *keys);
    memcpy(values, from, count * sizeof *values);
}
