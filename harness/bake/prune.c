/* Stochastic pruning: leaves and bark as one shuffled list of triangles. Sources in prune.h. */
#include "bake/prune.h"
#include "bake/detail.h"
#include "bake/stout.h"
#include "base/random.h"
#include "plant/normals.h"

#include <math.h>
#include <string.h>

/* Thin elements of more triangles (a whole canopy of one piece) are taken apart. */
enum {
    ELEMENT_TRIANGLES_MAX = 4,
    NEEDLE_ELEMENTS = 2,
    TEXTURE_SAMPLES = 16,
    BARK_SAMPLES_MAX = 200000
};

/* One element before packing. */
struct element {
    float corners[3][3], center[3], normal[3], albedo[3];
    int16_t kind;   /* of leaves 32767, of needles -32767, of bark 0 */
    uint16_t width; /* of bark */
};

struct pruner {
    const struct mesh *mesh;
    struct random random;
    size_t count, room;
    struct element *elements;
    double area_m2, hidden_m2; /* hidden: half of the needles', which no element has */
    uint16_t *widths;          /* of the mesh's vertices */
};

/* What is seen of a triangle: its opaque area, and albedo and position weighted by it. */
struct patch {
    double area, opaque, albedo[3], center[3];
};

/* Bilinear, wrapping. */
static void texture_at(const struct texture *texture, float u, float v, float rgba[4])
{
    float x = u * (float)texture->width_px - 0.5f, y = v * (float)texture->height_px - 0.5f;
    float floor_x = floorf(x), floor_y = floorf(y);
    memset(rgba, 0, 4 * sizeof *rgba);
    for (int corner = 0; corner < 4; corner++) {
        int dx = corner & 1, dy = corner >> 1;
        float weight =
            fabsf(1.0f - (float)dx - (x - floor_x)) * fabsf(1.0f - (float)dy - (y - floor_y));
        long column = (long)fmodf(floor_x + (float)dx, (float)texture->width_px);
        long row = (long)fmodf(floor_y + (float)dy, (float)texture->height_px);
        column += column < 0 ? texture->width_px : 0;
        row += row < 0 ? texture->height_px : 0;
        const float *texel = texture->rgba + 4 * (row * texture->width_px + column);
        for (int i = 0; i < 4; i++)
            rgba[i] += weight * texel[i];
    }
}

/* Adds one sample at barycentric (p, q) of weight area to a patch. */
static void patch_sample(const struct mesh *mesh, const uint32_t *corners,
                         const struct material *material, float p, float q, double area,
                         struct patch *patch)
{
    float weights[3] = {1 - p - q, p, q}, texel[4] = {1, 1, 1, 1};
    if (material->texture && mesh->uvs) {
        float uv[2] = {0, 0};
        for (int i = 0; i < 3; i++)
            for (int axis = 0; axis < 2; axis++)
                uv[axis] += weights[i] * mesh->uvs[corners[i]][axis];
        texture_at(material->texture, uv[0], uv[1], texel);
        if (texel[3] < 0.5f)
            return;
    }
    patch->opaque += area;
    for (int axis = 0; axis < 3; axis++) {
        double color = 0, position = 0;
        for (int i = 0; i < 3; i++) {
            color += weights[i] * (mesh->colors ? mesh->colors[corners[i]][axis] : 1.0f);
            position += weights[i] * mesh->positions[corners[i]][axis];
        }
        patch->albedo[axis] += area * color * material->albedo[axis] * texel[axis];
        patch->center[axis] += area * position;
    }
}

static struct patch patch_of(struct pruner *pruner, uint32_t triangle,
                             const struct material *material)
{
    const struct mesh *mesh = pruner->mesh;
    const uint32_t *corners = mesh->triangles[triangle];
    struct patch patch = {.area = mesh_triangle_area(mesh, triangle)};
    bool textured = material->texture && mesh->uvs;
    int samples = textured ? TEXTURE_SAMPLES : 1;
    float start[2] = {random_float(&pruner->random), random_float(&pruner->random)};
    for (int k = 0; k < samples; k++) {
        /* the centre, or a plastic-number lattice (Roberts 2018) from a random start, folded into
         * the triangle */
        float p = textured ? fmodf(start[0] + 0.7548777f * (float)k, 1) : 1.0f / 3;
        float q = textured ? fmodf(start[1] + 0.5698403f * (float)k, 1) : 1.0f / 3;
        if (p + q > 1) {
            p = 1 - p;
            q = 1 - q;
        }
        patch_sample(mesh, corners, material, p, q, patch.area / samples, &patch);
    }
    return patch;
}

static struct element *new_element(struct pruner *pruner, int16_t kind, const double albedo[3])
{
    struct element *element = &pruner->elements[pruner->count++];
    element->kind = kind;
    for (int i = 0; i < 3; i++)
        element->albedo[i] = (float)albedo[i];
    return element;
}

/* All triangles of a leaf, colour and position divided by the opaque area. largest: one of them and
 * its area. */
static struct patch patch_sum(struct pruner *pruner, uint32_t begin, uint32_t end,
                              const struct material *material, uint32_t *largest,
                              double *largest_area)
{
    struct patch sum = {0};
    *largest = begin;
    *largest_area = 0;
    for (uint32_t t = begin; t < end; t++) {
        struct patch patch = patch_of(pruner, t, material);
        sum.area += patch.area;
        sum.opaque += patch.opaque;
        for (int i = 0; i < 3; i++) {
            sum.albedo[i] += patch.albedo[i];
            sum.center[i] += patch.center[i];
        }
        if (patch.area > *largest_area) {
            *largest_area = patch.area;
            *largest = t;
        }
    }
    for (int i = 0; i < 3 && sum.opaque > 0; i++) {
        sum.albedo[i] /= sum.opaque;
        sum.center[i] /= sum.opaque;
    }
    return sum;
}

/* A leaf of a few triangles: the largest of them, moved to the leaf's centre and scaled to its
 * opaque area. */
static void add_leaf(struct pruner *pruner, uint32_t begin, uint32_t end,
                     const struct material *material)
{
    const struct mesh *mesh = pruner->mesh;
    uint32_t largest;
    double largest_area;
    struct patch sum = patch_sum(pruner, begin, end, material, &largest, &largest_area);
    if (!(sum.opaque > 0))
        return;
    struct element *element = new_element(pruner, INT16_MAX, sum.albedo);
    const uint32_t *corners = mesh->triangles[largest];
    float size = (float)sqrt(sum.opaque / largest_area);
    for (int axis = 0; axis < 3; axis++) {
        float middle = 0;
        for (int i = 0; i < 3; i++) {
            middle += mesh->positions[corners[i]][axis] / 3;
            element->normal[axis] += mesh->normals[corners[i]][axis] / 3;
        }
        element->center[axis] = (float)sum.center[axis];
        for (int i = 0; i < 3; i++)
            element->corners[i][axis] =
                element->center[axis] + size * (mesh->positions[corners[i]][axis] - middle);
    }
    pruner->area_m2 += sum.opaque;
}

/* One triangle of a closed, convex piece, each as likely as it is large, scaled to an area. Over
 * many pieces their normals, turned to the eye, are those that the pieces' fronts show. */
static void add_side(struct pruner *pruner, uint32_t begin, uint32_t end, const struct patch *sum,
                     double area)
{
    const struct mesh *mesh = pruner->mesh;
    double place = sum->area * random_double(&pruner->random), at = 0, chosen_area = 0, cross[3];
    uint32_t chosen = begin;
    for (uint32_t t = begin; t < end && at <= place; t++) {
        double of_this = mesh_triangle_area(mesh, t);
        chosen = of_this > 0 ? t : chosen;
        chosen_area = of_this > 0 ? of_this : chosen_area;
        at += of_this;
    }
    struct element *element = new_element(pruner, -INT16_MAX, sum->albedo);
    const float *p[3];
    for (int i = 0; i < 3; i++)
        p[i] = mesh->positions[mesh->triangles[chosen][i]];
    triangle_cross(p[0], p[1], p[2], cross);
    float size = (float)sqrt(area / chosen_area);
    for (int axis = 0; axis < 3; axis++) {
        float middle = (p[0][axis] + p[1][axis] + p[2][axis]) / 3;
        element->normal[axis] = (float)(cross[axis] / (2 * chosen_area));
        element->center[axis] = middle;
        for (int i = 0; i < 3; i++)
            element->corners[i][axis] = middle + size * (p[i][axis] - middle);
    }
}

/* A closed, convex piece: some of its triangles, as large together as half of the surface. That is
 * what flat pieces show half of in the mean over all directions, when a convex one shows a quarter
 * of its own (Cauchy). */
static void add_needle(struct pruner *pruner, uint32_t begin, uint32_t end,
                       const struct material *material)
{
    uint32_t largest;
    double largest_area;
    struct patch sum = patch_sum(pruner, begin, end, material, &largest, &largest_area);
    for (int k = 0; k < NEEDLE_ELEMENTS && sum.opaque > 0; k++)
        add_side(pruner, begin, end, &sum, 0.5 * sum.opaque / NEEDLE_ELEMENTS);
    pruner->area_m2 += sum.opaque;
    pruner->hidden_m2 += 0.5 * sum.opaque;
}

static void add_leaves(struct pruner *pruner, const struct mesh_part *part)
{
    const struct material *material = &pruner->mesh->materials[part->material];
    for (uint32_t e = 0; e < part->elements_count; e++) {
        uint32_t begin = part->element_first[e], end = part->element_first[e + 1];
        if (material->solid && end > begin)
            add_needle(pruner, begin, end, material);
        else if (end - begin <= ELEMENT_TRIANGLES_MAX && end > begin)
            add_leaf(pruner, begin, end, material);
        else
            for (uint32_t t = begin; t < end; t++)
                add_leaf(pruner, t, t + 1, material);
    }
}

/* An equilateral triangle of an area in the plane of a normal, turned at random. */
static void lay_sample(struct pruner *pruner, struct element *element, double area)
{
    const float *n = element->normal;
    /* Duff et al. 2017, Building an orthonormal basis, revisited, listing 3 */
    float sign = copysignf(1, n[2]), a = -1 / (sign + n[2]), b = n[0] * n[1] * a;
    float x[3] = {1 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]};
    float y[3] = {b, sign + n[1] * n[1] * a, -n[1]};
    /* area = 3 sqrt(3) / 4 r^2 */
    double radius = sqrt(4 * area / (3 * sqrt(3.0)));
    double turn = 2 * 3.14159265358979323846 * random_double(&pruner->random);
    for (int i = 0; i < 3; i++) {
        float c = (float)(radius * cos(turn + i * 2.09439510239319549)),
              s = (float)(radius * sin(turn + i * 2.09439510239319549));
        for (int axis = 0; axis < 3; axis++)
            element->corners[i][axis] = element->center[axis] + c * x[axis] + s * y[axis];
    }
}

/* One sample of bark on a triangle. */
static void add_sample(struct pruner *pruner, uint32_t triangle, const struct material *material,
                       double area)
{
    const struct mesh *mesh = pruner->mesh;
    const uint32_t *corners = mesh->triangles[triangle];
    float p = random_float(&pruner->random), q = random_float(&pruner->random);
    if (p + q > 1) {
        p = 1 - p;
        q = 1 - q;
    }
    struct patch patch = {0};
    patch_sample(mesh, corners, material, p, q, 1, &patch);
    pruner->area_m2 += patch.opaque > 0 ? area : 0;
    if (!(patch.opaque > 0))
        return;
    struct element *element = new_element(pruner, 0, patch.albedo);
    element->width = pruner->widths[corners[0]];
    float length = 0;
    for (int axis = 0; axis < 3; axis++) {
        element->center[axis] = (float)patch.center[axis];
        element->normal[axis] = (1 - p - q) * mesh->normals[corners[0]][axis] +
                                p * mesh->normals[corners[1]][axis] +
                                q * mesh->normals[corners[2]][axis];
        length += element->normal[axis] * element->normal[axis];
    }
    for (int axis = 0; axis < 3; axis++)
        element->normal[axis] = length > 0 ? element->normal[axis] / sqrtf(length) : axis == 1;
    lay_sample(pruner, element, area);
}

static double bark_area(const struct mesh *mesh)
{
    double area = 0;
    for (size_t p = 0; p < mesh->parts_count; p++) {
        const struct mesh_part *part = &mesh->parts[p];
        bool bark = mesh->materials[part->material].kind == MATERIAL_BARK;
        for (uint32_t t = 0; bark && t < part->triangles_count; t++)
            area += mesh_triangle_area(mesh, part->first_triangle + t);
    }
    return area;
}

/* Samples at equal steps of area along the list of triangles, with a random start; each stands for
 * `element` of area. */
static void add_bark(struct pruner *pruner, size_t samples, double step, double element)
{
    const struct mesh *mesh = pruner->mesh;
    double next = step * random_double(&pruner->random), area = 0;
    size_t added = 0;
    for (size_t p = 0; p < mesh->parts_count; p++) {
        const struct mesh_part *part = &mesh->parts[p];
        const struct material *material = &mesh->materials[part->material];
        for (uint32_t t = 0; material->kind == MATERIAL_BARK && t < part->triangles_count; t++) {
            area += mesh_triangle_area(mesh, part->first_triangle + t);
            for (; next < area && added < samples; next += step, added++)
                add_sample(pruner, part->first_triangle + t, material, element);
        }
    }
}

static void pack_elements(const struct pruner *pruner, const uint32_t *order, struct prune *prune)
{
    for (size_t i = 0; i < prune->count; i++) {
        const struct element *element = &pruner->elements[order[i]];
        for (size_t corner = 0; corner < 3; corner++) {
            struct prune_vertex *vertex = &prune->vertices[3 * i + corner];
            memcpy(vertex->position_m, element->corners[corner], sizeof vertex->position_m);
            memcpy(vertex->center_m, element->center, sizeof vertex->center_m);
            detail_pack_normal(element->normal, vertex->normal);
            vertex->normal[3] = element->kind;
            detail_pack_albedo(element->albedo, vertex->albedo);
            vertex->albedo[3] = element->width;
        }
    }
}

struct prune *prune_create(struct arena *arena, const struct mesh *mesh, uint64_t seed)
{
    struct prune *prune = ARENA_NEW(arena, struct prune);
    struct pruner pruner = {.mesh = mesh, .random = random_seed(seed, 0x7072756e65)};
    pruner.widths = stout_widths(arena, mesh);
    double bark = 0.5 * bark_area(mesh); /* a branch shows half of its surface */
    /* leaves make at most one element a triangle; bark is sampled as finely as it is cut, at most
     */
    pruner.room = mesh->triangles_count + BARK_SAMPLES_MAX;
    pruner.elements = ARENA_ARRAY(arena, struct element, pruner.room);
    size_t bark_triangles = 0;
    for (size_t p = 0; p < mesh->parts_count; p++)
        if (mesh->materials[mesh->parts[p].material].kind == MATERIAL_LEAF)
            add_leaves(&pruner, &mesh->parts[p]);
        else
            bark_triangles += mesh->parts[p].triangles_count;
    if (bark > 0) {
        double shown = pruner.area_m2 - pruner.hidden_m2;
        double mean = pruner.count ? shown / (double)pruner.count : 0;
        double wanted = mean > 0 ? ceil(bark / mean) : (double)bark_triangles;
        size_t samples = (size_t)fmin(fmax(wanted, 1), BARK_SAMPLES_MAX);
        add_bark(&pruner, samples, 2 * bark / (double)samples, bark / (double)samples);
    }
    prune->count = pruner.count;
    prune->area_m2 = pruner.area_m2;
    prune->vertices = ARENA_ARRAY(arena, struct prune_vertex, 3 * prune->count);
    uint32_t *order = ARENA_ARRAY(arena, uint32_t, prune->count);
    for (size_t i = 0; i < prune->count; i++) { /* Fisher and Yates, inside out */
        size_t at = random_below(&pruner.random, (uint32_t)i + 1);
        order[i] = order[at];
        order[at] = (uint32_t)i;
    }
    pack_elements(&pruner, order, prune);
    return prune;
}
