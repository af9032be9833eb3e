/* Bark tubes, leaves and the mesh that they end in, for every generator. */
#include "plant/grow.h"

#include "plant/normals.h"
#include "plant/plant.h"

#include <string.h>

struct vec vec_unit(struct vec a)
{
    double length = vec_length(a);
    if (!(length > 1e-12))
        return (struct vec){0, 1, 0};
    return vec_scale(a, 1 / length);
}

void grow_sincos(double turns, double *sine, double *cosine)
{
    double quarters = floor(turns * 4 + 0.5);
    double x = (turns - quarters / 4) * 6.283185307179586477;
    double x2 = x * x;
    double s =
        x * (1 + x2 * (-1.0 / 6 +
                       x2 * (1.0 / 120 +
                             x2 * (-1.0 / 5040 + x2 * (1.0 / 362880 + x2 * (-1.0 / 39916800))))));
    double c =
        1 + x2 * (-1.0 / 2 +
                  x2 * (1.0 / 24 +
                        x2 * (-1.0 / 720 + x2 * (1.0 / 40320 +
                                                 x2 * (-1.0 / 3628800 + x2 * (1.0 / 479001600))))));
    int quadrant = (int)(quarters - 4 * floor(quarters / 4));
    *sine = quadrant == 0 ? s : quadrant == 1 ? c : quadrant == 2 ? -s : -c;
    *cosine = quadrant == 0 ? c : quadrant == 1 ? -s : quadrant == 2 ? -c : s;
}

struct vec vec_across(struct vec a, double turns)
{
    struct vec helper = fabs(a.y) < 0.9 ? (struct vec){0, 1, 0} : (struct vec){1, 0, 0};
    struct vec u = vec_unit(vec_cross(helper, a));
    struct vec v = vec_cross(a, u);
    double s, c;
    grow_sincos(turns, &s, &c);
    return vec_add(vec_scale(u, c), vec_scale(v, s));
}

double random_between(struct random *random, double low, double high)
{
    return low + (high - low) * random_double(random);
}

struct vec random_in_ball(struct random *random)
{
    for (;;) {
        struct vec p;
        p.x = random_between(random, -1, 1);
        p.y = random_between(random, -1, 1);
        p.z = random_between(random, -1, 1);
        if (vec_dot(p, p) <= 1)
            return p;
    }
}

void grow_begin(struct grow *grow, struct arena *scratch, uint64_t seed, size_t triangles_capacity,
                size_t leaves_capacity)
{
    memset(grow, 0, sizeof *grow);
    grow->scratch = scratch;
    grow->random = random_seed(seed, 0x62617266);
    grow->triangles_capacity = triangles_capacity;
    grow->triangles = arena_alloc(scratch, triangles_capacity, sizeof(uint32_t[3]));
    grow->vertices_capacity = triangles_capacity * 2;
    grow->positions = arena_alloc(scratch, grow->vertices_capacity, sizeof(float[3]));
    grow->normals = arena_alloc(scratch, grow->vertices_capacity, sizeof(float[3]));
    grow->colors = arena_alloc(scratch, grow->vertices_capacity, sizeof(float[3]));
    grow->leaves_capacity = leaves_capacity;
    grow->leaf_first = ARENA_ARRAY(scratch, uint32_t, leaves_capacity);
}

static void *enlarged(struct arena *arena, const void *old, size_t used, size_t capacity,
                      size_t size)
{
    void *grown = arena_alloc(arena, capacity, size);
    memcpy(grown, old, used * size);
    return grown;
}

static uint32_t vertex(struct grow *grow, struct vec p, struct vec normal, const float tint[3])
{
    size_t n = grow->vertices_count;
    if (n == grow->vertices_capacity) {
        size_t capacity = n * 2 + 64;
        grow->positions = enlarged(grow->scratch, grow->positions, n, capacity, sizeof(float[3]));
        grow->normals = enlarged(grow->scratch, grow->normals, n, capacity, sizeof(float[3]));
        grow->colors = enlarged(grow->scratch, grow->colors, n, capacity, sizeof(float[3]));
        grow->vertices_capacity = capacity;
    }
    float *to = grow->positions[n];
    to[0] = (float)p.x, to[1] = (float)p.y, to[2] = (float)p.z;
    to = grow->normals[n];
    to[0] = (float)normal.x, to[1] = (float)normal.y, to[2] = (float)normal.z;
    memcpy(grow->colors[n], tint, sizeof(float[3]));
    grow->vertices_count++;
    return (uint32_t)n;
}

static void triangle(struct grow *grow, uint32_t a, uint32_t b, uint32_t c)
{
    size_t n = grow->triangles_count;
    if (n == grow->triangles_capacity) {
        size_t capacity = n * 2 + 64;
        grow->triangles =
            enlarged(grow->scratch, grow->triangles, n, capacity, sizeof(uint32_t[3]));
        grow->triangles_capacity = capacity;
    }
    uint32_t *to = grow->triangles[n];
    to[0] = a, to[1] = b, to[2] = c;
    grow->triangles_count++;
}

/* A ring of vertices across direction; start is the unit vector toward its first vertex. Its
 * normals are made from the triangles later. */
static uint32_t ring(struct grow *grow, const struct stem_point *point, struct vec direction,
                     struct vec start)
{
    struct vec side = vec_cross(direction, start);
    uint32_t first = (uint32_t)grow->vertices_count;
    double rough = point->radius_m > 0.04 ? 0.06 : 0;
    for (int j = 0; j < point->sides; j++) {
        double s, c, lobe_s, lobe_c;
        double turns = (double)j / point->sides;
        grow_sincos(turns, &s, &c);
        grow_sincos(turns * 5, &lobe_s, &lobe_c);
        double radius = point->radius_m *
                        (1 + point->flute * lobe_c + rough * random_between(&grow->random, -1, 1));
        struct vec out = vec_add(vec_scale(start, c), vec_scale(side, s));
        float light = (float)random_between(&grow->random, 0.7, 1);
        float warm = (float)random_between(&grow->random, 0.94, 1);
        float tint[3] = {light, light * warm, light * warm * warm};
        vertex(grow, vec_mad(point->position_m, radius, out), direction, tint);
    }
    return first;
}

/* Joins ring a of sides_a vertices with the ring b above it of as many or half as many. */
static void join(struct grow *grow, uint32_t a, int sides_a, uint32_t b, int sides_b)
{
    for (int j = 0; j < sides_b; j++) {
        uint32_t b0 = b + (uint32_t)j, b1 = b + (uint32_t)((j + 1) % sides_b);
        if (sides_a == sides_b) {
            uint32_t a0 = a + (uint32_t)j, a1 = a + (uint32_t)((j + 1) % sides_a);
            triangle(grow, a0, a1, b1);
            triangle(grow, a0, b1, b0);
        } else {
            uint32_t a0 = a + (uint32_t)(2 * j), a1 = a0 + 1;
            uint32_t a2 = a + (uint32_t)((2 * j + 2) % sides_a);
            triangle(grow, a0, a1, b0);
            triangle(grow, a1, b1, b0);
            triangle(grow, a1, a2, b1);
        }
    }
}

void grow_tube(struct grow *grow, const struct stem_point *points, size_t count)
{
    struct vec direction = vec_unit(vec_sub(points[1].position_m, points[0].position_m));
    struct vec start = vec_across(direction, 0);
    uint32_t below = ring(grow, &points[0], direction, start);
    int sides = points[0].sides;
    for (size_t i = 1; i + 1 < count; i++) {
        direction = vec_unit(vec_sub(points[i + 1].position_m, points[i - 1].position_m));
        /* Parallel transport: the start vector turns no more than the stem does. */
        struct vec across = vec_mad(start, -vec_dot(start, direction), direction);
        start = vec_length(across) > 1e-3 ? vec_unit(across) : vec_across(direction, 0);
        uint32_t above = ring(grow, &points[i], direction, start);
        join(grow, below, sides, above, points[i].sides);
        below = above;
        sides = points[i].sides;
    }
    const float tint[3] = {0.85f, 0.85f, 0.82f};
    /* One apex a side, so that each keeps its side's normal: shared, they would all look along the
     * stem. */
    for (int j = 0; j < sides; j++) {
        uint32_t apex = vertex(grow, points[count - 1].position_m, direction, tint);
        triangle(grow, below + (uint32_t)j, below + (uint32_t)((j + 1) % sides), apex);
    }
    grow->bark_triangles_count = grow->triangles_count;
}

void grow_leaf(struct grow *grow, const struct leaf_shape *leaf)
{
    if (grow->leaves_count == grow->leaves_capacity) {
        size_t capacity = grow->leaves_count * 2 + 64;
        grow->leaf_first = enlarged(grow->scratch, grow->leaf_first, grow->leaves_count, capacity,
                                    sizeof(uint32_t));
        grow->leaves_capacity = capacity;
    }
    grow->leaf_first[grow->leaves_count++] = (uint32_t)grow->triangles_count;
    struct vec right = vec_cross(leaf->along, leaf->normal);
    double half = leaf->width_m / 2;
    struct vec base = leaf->base_m, tip = vec_mad(base, leaf->length_m, leaf->along);
    struct vec middle = vec_mad(base, leaf->length_m * leaf->widest, leaf->along);
    middle = vec_mad(middle, half * leaf->fold, leaf->normal);
    struct vec right_edge = vec_mad(middle, half, right), left_edge = vec_mad(middle, -half, right);
    struct vec right_normal = vec_unit(vec_mad(leaf->normal, -leaf->fold, right));
    struct vec left_normal = vec_unit(vec_mad(leaf->normal, leaf->fold, right));
    uint32_t b = vertex(grow, base, right_normal, leaf->tint);
    uint32_t r = vertex(grow, right_edge, right_normal, leaf->tint);
    uint32_t t = vertex(grow, tip, right_normal, leaf->tint);
    triangle(grow, b, r, t);
    if (leaf->fold > 0) {
        b = vertex(grow, base, left_normal, leaf->tint);
        t = vertex(grow, tip, left_normal, leaf->tint);
    }
    triangle(grow, b, t, vertex(grow, left_edge, left_normal, leaf->tint));
}

static void material(struct arena *arena, struct material *to, const char *name,
                     enum material_kind kind, const float albedo[3])
{
    to->name = arena_strdup(arena, name);
    to->kind = kind;
    memcpy(to->albedo, albedo, sizeof to->albedo);
}

static void *kept(struct arena *arena, const void *from, size_t count, size_t size)
{
    return memcpy(arena_alloc(arena, count, size), from, count * size);
}

struct mesh *grow_mesh(struct grow *grow, struct arena *arena, const float bark_albedo[3],
                       const float leaf_albedo[3])
{
    struct mesh *mesh = ARENA_NEW(arena, struct mesh);
    mesh->vertices_count = grow->vertices_count;
    mesh->positions = kept(arena, grow->positions, mesh->vertices_count, sizeof(float[3]));
    mesh->normals = kept(arena, grow->normals, mesh->vertices_count, sizeof(float[3]));
    mesh->colors = kept(arena, grow->colors, mesh->vertices_count, sizeof(float[3]));
    mesh->triangles_count = grow->triangles_count;
    mesh->triangles = kept(arena, grow->triangles, mesh->triangles_count, sizeof(uint32_t[3]));
    mesh->materials_count = mesh->parts_count = 2;
    mesh->materials = ARENA_ARRAY(arena, struct material, 2);
    material(arena, &mesh->materials[0], "bark", MATERIAL_BARK, bark_albedo);
    material(arena, &mesh->materials[1], "leaf", MATERIAL_LEAF, leaf_albedo);
    mesh->parts = ARENA_ARRAY(arena, struct mesh_part, 2);
    uint32_t bark = (uint32_t)grow->bark_triangles_count, all = (uint32_t)grow->triangles_count;
    mesh->parts[0].triangles_count = bark;
    struct mesh_part *leaves = &mesh->parts[1];
    leaves->first_triangle = bark;
    leaves->triangles_count = all - bark;
    leaves->material = 1;
    leaves->elements_count = (uint32_t)grow->leaves_count;
    leaves->element_first = ARENA_ARRAY(arena, uint32_t, grow->leaves_count + 1);
    memcpy(leaves->element_first, grow->leaf_first, grow->leaves_count * sizeof(uint32_t));
    leaves->element_first[grow->leaves_count] = all;
    normals_smooth((const float(*)[3])mesh->positions, mesh->triangles, bark, mesh->normals);
    mesh_bounds(mesh);
    return mesh;
}
