/* Rays against a terrain's quadtree: Embree on the same triangles, one by one where they disagree;
 * rays through edges and vertices; limits. */
#include "pictures.h"

#include "bake/backdrop_cpu_parts.h"
#include "bake/terrain_rays.h"
#include "base/random.h"
#include "scene/relief.h"
#include "scene/terrain.h"
#include "wall/embree.h"

enum { SIDE_X = 61, SIDE_Z = 46 }; /* quads: no power of two */

static struct terrain make_rough(struct arena *arena)
{
    const double size_m[2] = {300, 200};
    const struct relief_noise noise = {{SIDE_X + 1, SIDE_Z + 1}, 40, 60, 5, 0.5, 3};
    struct terrain terrain = {
        .samples_x = SIDE_X + 1, .samples_z = SIDE_Z + 1, .size_x_m = 300, .size_z_m = 200};
    terrain.heights_m = relief_perlin(arena, &noise, size_m);
    terrain_normals(arena, &terrain);
    return terrain;
}

struct ray {
    float origin[3], direction[3];
};

static double uniform(struct random *random, double low, double high)
{
    return low + random_double(random) * (high - low);
}

/* Kinds: anywhere to anywhere; along the ground just above it; straight down and up; from below
 * upward; from outside, toward and away. */
static struct ray random_ray(const struct terrain *terrain, struct random *random, int kind)
{
    struct ray ray;
    double reach[3] = {150, 60, 100}, square = 0;
    for (int i = 0; i < 3; i++) {
        ray.origin[i] = (float)uniform(random, -reach[i], reach[i]);
        ray.direction[i] = (float)uniform(random, -1, 1);
        square += (double)ray.direction[i] * (double)ray.direction[i];
    }
    float ground_m = terrain_height(terrain, ray.origin[0], ray.origin[2]);
    for (int i = 0; i < 3; i++)
        ray.direction[i] /= (float)sqrt(square);
    if (kind == 1) {
        ray.origin[1] = ground_m + (float)uniform(random, 0.001, 1);
        ray.direction[1] = (float)uniform(random, -0.02, 0.02);
    } else if (kind == 2) {
        ray.origin[1] = random_double(random) < 0.5 ? 90 : -90;
        ray.direction[0] = ray.direction[2] = 0;
        ray.direction[1] = ray.origin[1] > 0 ? -1 : 1;
    } else if (kind == 3) {
        ray.origin[1] = ground_m - (float)uniform(random, 0.01, 50);
        ray.direction[1] = fabsf(ray.direction[1]);
    } else if (kind == 4) {
        for (int i = 0; i < 3; i++) {
            ray.direction[i] = -ray.origin[i];
            ray.origin[i] *= 4;
        }
        if (random_double(random) < 0.2)
            for (int i = 0; i < 3; i++)
                ray.direction[i] *= -1;
    }
    return ray;
}

/* Every triangle in double. */
static struct hit slow_hit(const struct mesh *mesh, const struct ray *ray)
{
    struct hit hit = {.distance_m = INFINITY};
    for (size_t t = 0; t < mesh->triangles_count; t++) {
        double corners[3][3];
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < 3; i++)
                corners[k][i] = (double)mesh->positions[mesh->triangles[t][k]][i];
        ray_triangle(ray->origin, ray->direction, (const double(*)[3])corners, t, &hit);
    }
    return hit;
}

static struct embree *trace_of(struct arena *arena, const struct mesh *mesh)
{
    struct embree *embree = NULL;
    const struct embree_part part = {0, (uint32_t)mesh->triangles_count, NULL, NULL};
    const struct embree_mesh traced = {(const float *)mesh->positions,
                                       mesh->vertices_count,
                                       (const uint32_t *)mesh->triangles,
                                       mesh->triangles_count,
                                       &part,
                                       1};
    const float identity[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    assert_int_equal(embree_create(arena, 1, &embree, NULL), STATUS_OK);
    assert_int_equal(embree_add_mesh(embree, &traced, NULL), STATUS_OK);
    embree_add_instance(embree, 0, identity);
    assert_int_equal(embree_commit(embree, NULL), STATUS_OK);
    return embree;
}

static void packet_put(struct embree_packet *packet, int lane, const struct ray *ray)
{
    for (int i = 0; i < 3; i++) {
        packet->origin[i][lane] = ray->origin[i];
        packet->direction[i][lane] = ray->direction[i];
    }
    packet->near[lane] = 0;
    packet->far[lane] = INFINITY;
}

/* Agree: both miss, or both hit within 1e-4 of the distance, on one triangle or neighbours of it.
 */
static bool agree(bool found, double distance, bool other, double other_distance)
{
    return found == other &&
           (!found || fabs(distance - other_distance) <= 1e-4 * (1 + other_distance));
}

static void test_rays__meet_what_embree_meets_from_everywhere_to_everywhere(void **state)
{
    (void)state;
    enum { BATCHES = 80 };
    struct arena *arena = arena_create(0);
    struct terrain terrain = make_rough(arena);
    const struct mesh *mesh = terrain_mesh(arena, &terrain);
    struct embree *embree = trace_of(arena, mesh);
    struct terrain_rays *rays = terrain_rays_create(arena, &terrain);
    struct random random = random_seed(1, 2);
    for (int kind = 0; kind < 5; kind++) {
        size_t hits = 0, odd = 0;
        for (int batch = 0; batch < BATCHES; batch++) {
            struct embree_packet packet = {0};
            struct ray lanes[EMBREE_LANES];
            for (int k = 0; k < EMBREE_LANES; k++) {
                lanes[k] = random_ray(&terrain, &random, kind);
                packet_put(&packet, k, &lanes[k]);
            }
            embree_intersect(embree, &packet, EMBREE_LANES, false);
            for (int k = 0; k < EMBREE_LANES; k++) {
                struct terrain_hit hit = {0};
                const struct ray *ray = &lanes[k];
                bool other = packet.geometry[k] != EMBREE_NONE;
                bool found = terrain_rays_hit(rays, ray->origin, ray->direction, INFINITY, &hit);
                hits += found;
                assert_true(found == terrain_rays_blocked(rays, ray->origin, ray->direction, 1e30));
                if (agree(found, hit.distance, other, (double)packet.far[k]))
                    continue;
                odd++; /* a float's edge: the slow way decides */
                struct hit slow = slow_hit(mesh, ray);
                if (!agree(found, hit.distance, isfinite(slow.distance_m), slow.distance_m) &&
                    !(slow.margin < 1e-9))
                    fail_msg("kind %d: %d at %g, Embree %d at %g, slowly %g", kind, found,
                             hit.distance, other, (double)packet.far[k], slow.distance_m);
            }
        }
        assert_true(hits > BATCHES * EMBREE_LANES / 4);
        assert_true(odd <= BATCHES * EMBREE_LANES / 100);
    }
    embree_destroy(embree);
    arena_destroy(arena);
}

/* The weights give the place of the hit, the corners are a triangle of the mesh, the side is right.
 */
static void test_rays__tell_the_triangle_its_weights_and_its_side(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct terrain terrain = make_rough(arena);
    const struct mesh *mesh = terrain_mesh(arena, &terrain);
    struct terrain_rays *rays = terrain_rays_create(arena, &terrain);
    struct random random = random_seed(3, 4);
    size_t hits = 0;
    for (int n = 0; n < 200; n++) {
        struct ray ray = random_ray(&terrain, &random, n % 5);
        struct terrain_hit hit;
        if (!terrain_rays_hit(rays, ray.origin, ray.direction, INFINITY, &hit))
            continue;
        struct hit slow = slow_hit(mesh, &ray);
        hits++;
        if (slow.margin < 1e-3)
            continue;
        assert_memory_equal(hit.corners, mesh->triangles[slow.triangle], sizeof hit.corners);
        assert_int_equal(hit.front, slow.front);
        assert_float_equal(hit.weights[1], slow.p, 1e-5);
        assert_float_equal(hit.weights[2], slow.q, 1e-5);
        assert_float_equal(hit.weights[0] + hit.weights[1] + hit.weights[2], 1, 1e-5);
    }
    assert_true(hits > 100);
    arena_destroy(arena);
}

/* Straight down on every vertex, every edge's middle and along every line of the grid; and slanted
 * through vertices: a surface without gaps lets none of them through. */
static void test_rays__through_vertices_and_edges_are_not_lost(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct terrain terrain = make_rough(arena);
    const struct mesh *mesh = terrain_mesh(arena, &terrain);
    struct terrain_rays *rays = terrain_rays_create(arena, &terrain);
    struct random random = random_seed(6, 6);
    for (size_t t = 0; t < mesh->triangles_count; t++)
        for (int k = 0; k < 3; k++) {
            const float *a = mesh->positions[mesh->triangles[t][k]];
            const float *b = mesh->positions[mesh->triangles[t][(k + 1) % 3]];
            float share = k == 0 ? 0 : (float)random_double(&random);
            float place[3], down[3] = {0, -1, 0};
            for (int i = 0; i < 3; i++)
                place[i] = a[i] + share * (b[i] - a[i]);
            float height_m = place[1];
            place[1] = 200;
            struct terrain_hit hit;
            assert_true(terrain_rays_hit(rays, place, down, INFINITY, &hit));
            assert_float_equal(200 - hit.distance, height_m, 1e-3);
            bool border = fabsf(place[0]) > 149.9f || fabsf(place[2]) > 99.9f;
            float away[3] = {place[0] / 3, 300, place[2] / 4}, slanted[3];
            for (int i = 0; i < 3; i++)
                slanted[i] = (i == 1 ? height_m : place[i]) - away[i];
            assert_true(border || terrain_rays_blocked(rays, away, slanted, 1.5));
        }
    arena_destroy(arena);
}

static void test_rays__end_where_they_are_told_and_of_two_samples_there_is_a_plane(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct terrain terrain = {.samples_x = 2, .samples_z = 2, .size_x_m = 10, .size_z_m = 10};
    terrain.heights_m = ARENA_ARRAY(arena, float, 4);
    struct terrain_rays *rays = terrain_rays_create(arena, &terrain);
    const float eye[3] = {1, 4, 2}, down[3] = {0, -2, 0}, up[3] = {0, 1, 0}, along[3] = {1, 0, 0};
    struct terrain_hit hit;
    assert_true(terrain_rays_hit(rays, eye, down, INFINITY, &hit));
    assert_float_equal(hit.distance, 2, 1e-12);
    assert_true(hit.front);
    assert_true(terrain_rays_blocked(rays, eye, down, 2.001));
    assert_false(terrain_rays_blocked(rays, eye, down, 1.999));
    assert_false(terrain_rays_blocked(rays, eye, up, INFINITY));
    assert_false(terrain_rays_blocked(rays, eye, along, INFINITY));
    const float beyond[3] = {5.1f, 4, 0}, within[3] = {1, 0, 2}; /* in the plane: no side to meet */
    assert_false(terrain_rays_blocked(rays, beyond, down, INFINITY));
    assert_false(terrain_rays_blocked(rays, within, along, INFINITY));
    arena_destroy(arena);
}

enum { TILE = 48 };

static void draw_tile(const struct hills *hills, const struct view *view,
                      const struct backdrop_light *light, float *depths_m, float (*rgb)[3],
                      float *suns)
{
    const struct backdrop_rays rays = backdrop_rays_of(view);
    const struct backdrop_tile tile = {0, 0, TILE, TILE, TILE, depths_m, rgb, suns};
    for (int k = 0; k < TILE * TILE; k++) {
        depths_m[k] = INFINITY;
        suns[k] = rgb[k][0] = rgb[k][1] = rgb[k][2] = -1;
    }
    hills_tile(hills, &rays, view->eye_m, light, &tile);
}

/* From above, from below and from outside, with fog and colours: but for pixels on an edge both
 * ways of drawing give depth, radiance and the sun's part alike. */
static void test_rays__draw_the_hills_that_the_triangles_draw(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct scene *scene = scene_by_hand(arena, TILE, TILE);
    struct terrain *terrain = &scene->terrain;
    *terrain = make_rough(arena);
    terrain->colors = arena_alloc(arena, (SIDE_X + 1) * (SIDE_Z + 1), sizeof *terrain->colors);
    for (size_t k = 0; k < (SIDE_X + 1) * (SIDE_Z + 1); k++)
        for (size_t c = 0; c < 3; c++)
            terrain->colors[k][c] = (float)((7 * k + 31 * c) % 97) / 96;
    struct hills *ways[2] = {hills_prepare(arena, terrain, false),
                             hills_prepare(arena, terrain, true)};
    struct backdrop_light light = {
        {0.6f, 0.64f, 0.48f}, {1, 2, 3}, {0.1f, 0.2f, 0.3f}, {0.5f, 0.6f, 0.7f}, 0.005f};
    static const float eyes[3][3] = {{20, 40, 30}, {5, -60, 0}, {250, 60, -190}};
    static float depths_m[2][TILE * TILE], rgb[2][TILE * TILE][3], suns[2][TILE * TILE];
    for (int n = 0; n < 3; n++) {
        struct view view;
        size_t seen = 0, odd = 0;
        view_look_at(scene, eyes[n], (float[3]){0, 0, -10}, &view);
        for (int way = 0; way < 2; way++) {
            hills_begin(ways[way], &view, 1);
            draw_tile(ways[way], &view, &light, depths_m[way], rgb[way], suns[way]);
        }
        for (int k = 0; k < TILE * TILE; k++) {
            bool hit = isfinite(depths_m[0][k]);
            bool same = hit == isfinite(depths_m[1][k]) &&
                        (!hit || fabsf(depths_m[0][k] - depths_m[1][k]) < 1e-4f * depths_m[0][k]) &&
                        fabsf(suns[0][k] - suns[1][k]) < 1e-3f;
            for (int c = 0; c < 3; c++)
                same &= fabsf(rgb[0][k][c] - rgb[1][k][c]) < 2e-3f;
            seen += hit;
            odd += !same;
        }
        assert_true(seen > 300);
        if (odd > 4)
            fail_msg("view %d: %zu of %zu pixels differ", n, odd, seen);
    }
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rays__meet_what_embree_meets_from_everywhere_to_everywhere),
        cmocka_unit_test(test_rays__tell_the_triangle_its_weights_and_its_side),
        cmocka_unit_test(test_rays__through_vertices_and_edges_are_not_lost),
        cmocka_unit_test(test_rays__draw_the_hills_that_the_triangles_draw),
        cmocka_unit_test(test_rays__end_where_they_are_told_and_of_two_samples_there_is_a_plane),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
