/* A terrain's levels of detail: the drawn triangles against the full surface, point by point and
 * pixel by pixel; closed borders; as many triangles as the bound asks for. */
#include "pictures.h"

#include "bake/terrain_levels.h"
#include "base/random.h"
#include "scene/relief.h"
#include "scene/terrain.h"

enum { SIDE_X = 200, SIDE_Z = 157 }; /* quads: chunks that do not come out even */

/* Rough relief: hills, and noise on every scale; a needle of one sample in the middle. */
static void make_rough(struct arena *arena, struct terrain *terrain)
{
    const double size_m[2] = {2000, 1500};
    const struct relief_noise noise = {{SIDE_X + 1, SIDE_Z + 1}, 150, 800, 8, 0.3, 7};
    *terrain = (struct terrain){.samples_x = SIDE_X + 1,
                                .samples_z = SIDE_Z + 1,
                                .size_x_m = (float)size_m[0],
                                .size_z_m = (float)size_m[1],
                                .albedo = {0.4f, 0.3f, 0.2f}};
    terrain->heights_m = relief_perlin(arena, &noise, size_m);
    terrain->heights_m[SIDE_Z / 2 * (SIDE_X + 1) + SIDE_X / 2] += 20;
    terrain_normals(arena, terrain);
}

static void random_view(const struct scene *scene, struct random *random, struct view *view)
{
    float eye[3], target[3];
    for (int i = 0; i < 3; i++) {
        float reach = i == 1 ? 0 : i == 0 ? 900 : 700;
        eye[i] = (float)(2 * random_double(random) - 1) * reach;
        target[i] = (float)(2 * random_double(random) - 1) * reach;
    }
    eye[1] = terrain_height(&scene->terrain, eye[0], eye[2]) + 2 +
             400 * (float)pow(random_double(random), 3);
    target[1] = terrain_height(&scene->terrain, target[0], target[2]);
    view_look_at(scene, eye, target, view);
}

static void corner_of(const struct terrain *terrain, uint32_t index, double at[3])
{
    uint32_t x = index % terrain->samples_x, z = index / terrain->samples_x;
    at[0] = ((double)x / (terrain->samples_x - 1) - 0.5) * (double)terrain->size_x_m;
    at[1] = (double)terrain->heights_m[index];
    at[2] = ((double)z / (terrain->samples_z - 1) - 0.5) * (double)terrain->size_z_m;
}

/* Pixels from the upper left corner; false behind the eye and outside the picture. */
static bool pixel_of(const struct view *view, const double at[3], double pixel[2])
{
    double place[3] = {0, 0, 0}, focal = 0.5 * view->height_px / tan(0.5 * (double)view->fov_y_rad);
    for (int i = 0; i < 3; i++) {
        double away = at[i] - (double)view->eye_m[i];
        place[0] += away * (double)view->right[i];
        place[1] -= away * (double)view->up[i];
        place[2] += away * (double)view->forward[i];
    }
    pixel[0] = 0.5 * view->width_px + focal * place[0] / place[2];
    pixel[1] = 0.5 * view->height_px + focal * place[1] / place[2];
    return place[2] > (double)view->near_m;
}

/* The farthest that any point of a triangle, of `points` at random, is moved in the picture. */
static double moved_px(const struct terrain *terrain, const struct view *view,
                       const uint32_t triangle[3], struct random *random, int points)
{
    double corners[3][3], worst = 0;
    for (int k = 0; k < 3; k++)
        corner_of(terrain, triangle[k], corners[k]);
    for (int n = 0; n < points; n++) {
        double u = random_double(random), v = random_double(random), at[3], full[3];
        double pixels[2][2];
        if (u + v > 1) {
            u = 1 - u;
            v = 1 - v;
        }
        for (int i = 0; i < 3; i++)
            at[i] = full[i] = corners[0][i] + u * (corners[1][i] - corners[0][i]) +
                              v * (corners[2][i] - corners[0][i]);
        full[1] = (double)terrain_height(terrain, (float)at[0], (float)at[2]);
        if (!pixel_of(view, full, pixels[0]) || pixels[0][0] < 0 || pixels[0][1] < 0 ||
            pixels[0][0] > view->width_px || pixels[0][1] > view->height_px)
            continue;
        assert_true(pixel_of(view, at, pixels[1]));
        worst = fmax(worst, hypot(pixels[1][0] - pixels[0][0], pixels[1][1] - pixels[0][1]));
    }
    return worst;
}

static void test_levels__move_no_point_of_the_surface_farther_than_the_bound(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct scene *scene = scene_by_hand(arena, 320, 240);
    make_rough(arena, &scene->terrain);
    scene->camera.far_m = 5000;
    struct terrain_levels *levels = terrain_levels_create(arena, &scene->terrain, 2);
    struct random random = random_seed(5, 5);
    size_t fewest = SIZE_MAX;
    double closest = 0;
    for (int n = 0; n < 6; n++) {
        struct view view;
        random_view(scene, &random, &view);
        float bound_px = (float[3]){1, 4, 12}[n % 3];
        const uint32_t *indices;
        size_t count = terrain_levels_view(levels, &view, bound_px, &indices);
        fewest = count < fewest ? count : fewest;
        int points = (int)(45000 / (count + 1)) + 1;
        for (size_t k = 0; k < count; k += 3) {
            double moved = moved_px(&scene->terrain, &view, indices + k, &random, points);
            if (moved > (double)bound_px * 1.001 + 0.01)
                fail_msg("view %d: a point moves by %g px, bound %g", n, moved, (double)bound_px);
            closest = fmax(closest, moved / (double)bound_px);
        }
    }
    assert_true(fewest < 3 * SIDE_X * SIDE_Z / 2); /* the levels are used */
    if (closest < 0.3)                             /* and the bound is nearly reached */
        fail_msg("no point moves by more than %g of the bound", closest);
    arena_destroy(arena);
}

static int by_edge(const void *a, const void *b)
{
    return memcmp(a, b, 2 * sizeof(uint32_t));
}

static double area_of(const struct terrain *terrain, const uint32_t triangle[3])
{
    double c[3][3];
    for (int k = 0; k < 3; k++)
        corner_of(terrain, triangle[k], c[k]);
    return 0.5 *
           ((c[1][2] - c[0][2]) * (c[2][0] - c[0][0]) - (c[1][0] - c[0][0]) * (c[2][2] - c[0][2]));
}

/* Seen from straight above, where nothing is culled: triangles that face up and tile the plane, and
 * each edge is of two of them, or of one where the terrain ends: then no crack can be anywhere. */
static void test_levels__tile_the_terrain_and_share_every_edge(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct scene *scene = scene_by_hand(arena, 320, 240);
    make_rough(arena, &scene->terrain);
    struct terrain *terrain = &scene->terrain;
    scene->camera.far_m = 5000;
    struct terrain_levels *levels = terrain_levels_create(arena, terrain, 2);
    for (int n = 1; n < 6; n += 2) {
        struct view view;
        float eye[3] = {(float)(n * 250 - 900), 20.0f * (float)(1 << n) * (float)(n + 1) / 2,
                        (float)(n * 90 - 400)};
        eye[1] += terrain_height(terrain, eye[0], eye[2]);
        scene->camera.fov_y_rad = 3.1f;
        view_look_at(scene, eye, (float[3]){eye[0], eye[1] - 10, eye[2]}, &view);
        view.fov_y_rad = 0.8f; /* the frustum sees all, the lens is usual */
        const uint32_t *indices;
        size_t count = terrain_levels_view(levels, &view, 2, &indices), edges_count = 0;
        uint32_t(*edges)[2] = arena_alloc(arena, count, sizeof *edges);
        double area = 0;
        for (size_t k = 0; k < count; k += 3) {
            double one = area_of(terrain, indices + k);
            assert_true(one > 0);
            area += one;
            for (size_t e = 0; e < 3; e++) {
                uint32_t a = indices[k + e], b = indices[k + (e + 1) % 3];
                edges[edges_count][0] = a < b ? a : b;
                edges[edges_count++][1] = a < b ? b : a;
            }
        }
        assert_float_equal(area, 2000 * 1500, 0.1);
        qsort(edges, edges_count, sizeof *edges, by_edge);
        for (size_t i = 0, end; i < edges_count; i = end) {
            for (end = i + 1; end < edges_count && by_edge(edges[i], edges[end]) == 0; end++)
                continue;
            if (end - i == 2)
                continue;
            assert_int_equal(end - i, 1);
            double a[3], b[3];
            corner_of(terrain, edges[i][0], a);
            corner_of(terrain, edges[i][1], b);
            bool side = a[0] == b[0] && fabs(a[0]) == 1000,
                 end_z = a[2] == b[2] && fabs(a[2]) == 750;
            if (!side && !end_z)
                fail_msg("view %d: an open edge at %g, %g to %g, %g", n, a[0], a[2], b[0], b[2]);
        }
    }
    arena_destroy(arena);
}

/* Every vertex of another colour. */
static void paint(struct arena *arena, struct terrain *terrain)
{
    size_t count = (size_t)terrain->samples_x * terrain->samples_z;
    terrain->colors = arena_alloc(arena, count, sizeof *terrain->colors);
    for (size_t k = 0; k < count; k++)
        for (size_t c = 0; c < 3; c++)
            terrain->colors[k][c] = 0.5f + 0.5f * (float)sin(0.02 * (double)k + (double)c);
}

static struct picture draw_null(struct arena *arena, struct scene *scene, const struct view *view,
                                float detail_px)
{
    struct setting setting = {
        .method = "null", .effects = EFFECT_AMBIENT | EFFECT_FOG, .format = TARGET_RGBA32F};
    scene->terrain.detail_px = detail_px;
    return picture_draw(arena, scene, view, &setting);
}

/* Red is of the sky alone. */
static bool is_sky(const struct picture *picture, int x, int y)
{
    return picture->rgba[4 * (y * picture->width_px + x)] > 2;
}

static bool sky_within(const struct picture *picture, int x, int y, int reach)
{
    for (int j = y - reach; j <= y + reach; j++)
        for (int i = x - reach; i <= x + reach; i++)
            if (i >= 0 && j >= 0 && i < picture->width_px && j < picture->height_px &&
                is_sky(picture, i, j))
                return true;
    return false;
}

/* Pixels that the full surface and its neighbourhood cover show no background, from 2 m above the
 * ground to high, and from below; and what they do show is what the full surface shows there. */
static void test_levels__let_no_background_through_and_look_like_the_full_surface(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct scene *scene = scene_by_hand(arena, 128, 96);
    make_rough(arena, &scene->terrain);
    paint(arena, &scene->terrain);
    scene->fog.density_per_m = 0.0005f;
    scene->camera.far_m = 5000;
    for (int c = 0; c < 3; c++)
        scene->sky.zenith[c] = scene->sky.horizon[c] = scene->sky.ground[c] = c == 0 ? 9.0f : 0;
    struct random random = random_seed(9, 9);
    for (int n = 1; n < 5; n += n) { /* 1, 2, 4 */
        struct view view;
        random_view(scene, &random, &view);
        if (n == 4) /* from below */
            view_look_at(scene, (float[3]){100, -700, 200}, (float[3]){0, 0, 0}, &view);
        const float bound_px = n % 2 ? 3 : 1;
        struct picture full = draw_null(arena, scene, &view, 0);
        struct picture levels = draw_null(arena, scene, &view, bound_px);
        size_t covered = 0;
        double square = 0;
        for (int y = 0; y < 96; y++)
            for (int x = 0; x < 128; x++) {
                if (sky_within(&full, x, y, (int)bound_px + 1))
                    continue;
                if (is_sky(&levels, x, y))
                    fail_msg("view %d: background at pixel (%d, %d)", n, x, y);
                covered++;
                for (int c = 0; c < 3; c++) {
                    double away = (double)(levels.rgba[4 * (y * 128 + x) + c] -
                                           full.rgba[4 * (y * 128 + x) + c]);
                    square += away * away / 3;
                }
            }
        assert_true(covered > 1000);
        assert_true(levels.triangles < full.triangles);
        if (sqrt(square / (double)covered) > 0.04)
            fail_msg("view %d: RMSE %g", n, sqrt(square / (double)covered));
    }
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_levels__move_no_point_of_the_surface_farther_than_the_bound),
        cmocka_unit_test(test_levels__tile_the_terrain_and_share_every_edge),
        cmocka_unit_test(test_levels__let_no_background_through_and_look_like_the_full_surface),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
