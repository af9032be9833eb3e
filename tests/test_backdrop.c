/* Sky and terrain as drawn, with OpenGL and on the CPU, against rays cast one by one at pixel
 * centres. */
#include "pictures.h"

enum { WIDTH = 48, HEIGHT = 36 };
#define EFFECTS (EFFECT_AMBIENT | EFFECT_FOG)

/* Hills of two sines; flat when height is 0. */
static void make_terrain(struct arena *arena, struct scene *scene, uint32_t samples, float size_m,
                         float height_m)
{
    struct terrain *terrain = &scene->terrain;
    *terrain =
        (struct terrain){samples, samples, size_m, size_m, NULL, NULL, {0.4f, 0.3f, 0.2f}, NULL, 0};
    terrain->heights_m = ARENA_ARRAY(arena, float, samples *samples);
    terrain->normals = arena_alloc(arena, samples * samples, sizeof *terrain->normals);
    for (uint32_t j = 0; j < samples; j++)
        for (uint32_t i = 0; i < samples; i++) {
            float x = (float)i / (float)(samples - 1) * 9, z = (float)j / (float)(samples - 1) * 7;
            float slope = height_m * 9 / size_m * cosf(x);
            float length = sqrtf(1 + slope * slope);
            terrain->heights_m[j * samples + i] = height_m * (sinf(x) + 0.5f * sinf(2 * z + 1));
            terrain->normals[j * samples + i][0] = -slope / length;
            terrain->normals[j * samples + i][1] = 1 / length;
        }
}

/* What the pixel ought to be; false where the ray passes too near an edge to decide. */
static bool expected(const struct scene *scene, const struct view *view, const struct mesh *mesh,
                     unsigned effects, int column, int row, double radiance[3])
{
    float direction[3], sky[3];
    struct hit hit = {.distance_m = INFINITY};
    view_ray(view, (float)column + 0.5f, (float)row + 0.5f, direction);
    for (size_t t = 0; mesh && t < mesh->triangles_count; t++) {
        double corners[3][3];
        for (int i = 0; i < 3; i++)
            for (int axis = 0; axis < 3; axis++)
                corners[i][axis] = mesh->positions[mesh->triangles[t][i]][axis];
        ray_triangle(view->eye_m, direction, (const double(*)[3])corners, t, &hit);
    }
    if (isinf(hit.distance_m)) {
        sky_radiance(&scene->sky, direction, sky);
        for (int i = 0; i < 3; i++)
            radiance[i] = sky[i];
        return true;
    }
    double normal[3] = {0, 0, 0}, albedo[3], length = 0;
    const uint32_t *corners = mesh->triangles[hit.triangle];
    for (int axis = 0; axis < 3; axis++) {
        normal[axis] = (1 - hit.p - hit.q) * mesh->normals[corners[0]][axis] +
                       hit.p * mesh->normals[corners[1]][axis] +
                       hit.q * mesh->normals[corners[2]][axis];
        length += normal[axis] * normal[axis];
        albedo[axis] = scene->terrain.albedo[axis];
        if (scene->terrain.colors)
            albedo[axis] *= (1 - hit.p - hit.q) * scene->terrain.colors[corners[0]][axis] +
                            hit.p * scene->terrain.colors[corners[1]][axis] +
                            hit.q * scene->terrain.colors[corners[2]][axis];
    }
    for (int axis = 0; axis < 3; axis++)
        normal[axis] /= sqrt(length);
    shade(scene, view, effects, false, albedo, normal, hit.front, hit.distance_m, radiance);
    return hit.margin > 1e-3;
}

/* Pixels that differ from the rays; every alpha has to be 0. */
static size_t differences_of(struct arena *arena, const char *method, const struct scene *scene,
                             const float eye[3], const float target[3], unsigned effects,
                             size_t *terrain_pixels)
{
    struct view view;
    view_look_at(scene, eye, target, &view);
    struct setting setting = {.method = method, .effects = effects, .format = TARGET_RGBA32F};
    struct picture picture = picture_draw(arena, scene, &view, &setting);
    const struct mesh *mesh = terrain_mesh(arena, &scene->terrain);
    size_t wrong = 0;
    *terrain_pixels = 0;
    for (int row = 0; row < HEIGHT; row++)
        for (int column = 0; column < WIDTH; column++) {
            double radiance[3], worst = 0;
            float sky[3], direction[3];
            const float *pixel = picture.rgba + 4 * (row * WIDTH + column);
            bool decided = expected(scene, &view, mesh, effects, column, row, radiance);
            for (int i = 0; i < 3; i++)
                worst = fmax(worst, fabs(pixel[i] - radiance[i]));
            wrong += decided && !(worst < 2e-4);
            assert_true(pixel[3] == 0);
            view_ray(&view, (float)column + 0.5f, (float)row + 0.5f, direction);
            sky_radiance(&scene->sky, direction, sky);
            *terrain_pixels += fabs(radiance[0] - sky[0]) > 1e-6;
        }
    return wrong;
}

static const char *const methods[2] = {"null", "ray-texels"};

/* Of the worse of the two. */
static size_t differences(struct arena *arena, const struct scene *scene, const float eye[3],
                          const float target[3], unsigned effects, size_t *terrain_pixels)
{
    size_t worst = 0;
    for (int i = 0; i < 2; i++) {
        size_t wrong =
            differences_of(arena, methods[i], scene, eye, target, effects, terrain_pixels);
        worst = wrong > worst ? wrong : worst;
    }
    return worst;
}

static void test_backdrop__the_sky_is_sky_radiance_at_every_pixel_centre(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct scene *scene = scene_by_hand(arena, WIDTH, HEIGHT);
    size_t terrain;
    static const float eyes[3][3] = {{0, 2, 20}, {3, 50, 1}, {0, -9, 0}};
    static const float targets[3][3] = {{0, 2, 0}, {0, 0, 0}, {1, 20, 3}};
    for (int i = 0; i < 3; i++) {
        assert_int_equal(differences(arena, scene, eyes[i], targets[i], EFFECTS, &terrain), 0);
        assert_int_equal(terrain, 0);
    }
    arena_destroy(arena);
}

static void test_backdrop__hills_are_where_rays_meet_them_and_lit_as_defined(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct scene *scene = scene_by_hand(arena, WIDTH, HEIGHT);
    make_terrain(arena, scene, 50, 200, 6); /* 49 quads a side: chunks that do not come out even */
    static const float eyes[6][3] = {
        {0, 12, 40},     /* within, over the hills: back faces are dropped */
        {95, 14, 95},    /* in a corner */
        {150, 3, 10},    /* outside, low: the border's under side shows */
        {10, -40, 0},    /* below */
        {-70, 60, -60},  /* high */
        {-99, 15, -98}}; /* straight down on a corner */
    static const float targets[6][3] = {{0, 8, -50},  {0, 5, 0},   {0, 4, 0},
                                        {0, 10, -20}, {20, 0, 20}, {-99.5f, 0, -99}};
    for (int i = 0; i < 6; i++) {
        size_t terrain, wrong = differences(arena, scene, eyes[i], targets[i], EFFECTS, &terrain);
        if (wrong > 2 || terrain < 100)
            fail_msg("view %d: %zu of %zu terrain pixels differ", i, wrong, terrain);
    }
    arena_destroy(arena);
}

/* Each vertex of another colour. */
static void paint_terrain(struct arena *arena, struct terrain *terrain)
{
    size_t count = (size_t)terrain->samples_x * terrain->samples_z;
    terrain->colors = arena_alloc(arena, count, sizeof *terrain->colors);
    for (size_t k = 0; k < count; k++)
        for (size_t c = 0; c < 3; c++)
            terrain->colors[k][c] = (float)((7 * k + 31 * c + k * c) % 97) / 96;
}

static void test_backdrop__colours_multiply_the_albedo_of_hills_and_of_a_plane(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    static const float eyes[3][3] = {{0, 12, 40}, {10, -40, 0}, {-70, 60, -60}};
    static const float targets[3][3] = {{0, 8, -50}, {0, 10, -20}, {20, 0, 20}};
    for (int i = 0; i < 9; i++) {
        struct scene *scene = scene_by_hand(arena, WIDTH, HEIGHT);
        make_terrain(arena, scene, 21, 200, (float[3]){6, 1, 0}[i / 3]); /* 1: smooth */
        paint_terrain(arena, &scene->terrain);
        size_t terrain;
        size_t wrong = differences(arena, scene, eyes[i % 3], targets[i % 3], EFFECTS, &terrain);
        if (wrong > 2 || terrain < 100)
            fail_msg("view %d: %zu of %zu terrain pixels differ", i, wrong, terrain);
    }
    arena_destroy(arena);
}

/* Where relief takes the sun there is none left, of any colour: what is taken has the place's
 * albedo. */
static void test_backdrop__coloured_ground_in_shade_is_black_and_never_darker(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct scene *scene = scene_by_hand(arena, WIDTH, HEIGHT);
    make_terrain(arena, scene, 50, 200, 12);
    paint_terrain(arena, &scene->terrain);
    scene->sun.elevation_rad = scene->sun.end_elevation_rad = 0.1f;
    struct view view;
    view_look_at(scene, (float[3]){0, 80, 90}, (float[3]){0, 0, 0}, &view);
    struct setting setting = {
        .method = "ray-texels", .effects = EFFECT_SUN_SHADOWS, .format = TARGET_RGBA32F};
    struct picture picture = picture_draw(arena, scene, &view, &setting);
    size_t black = 0, bright = 0;
    for (size_t k = 0; k < WIDTH * HEIGHT; k++) {
        const float *rgba = picture.rgba + 4 * k;
        for (int c = 0; c < 3; c++)
            assert_true(rgba[c] > -1e-6f);
        black += rgba[0] + rgba[1] + rgba[2] < 1e-6f;
        bright += rgba[0] + rgba[1] + rgba[2] > 1e-3f;
    }
    assert_true(black > 200 && bright > 200);
    arena_destroy(arena);
}

static void test_backdrop__effects_that_are_off_are_off(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct scene *scene = scene_by_hand(arena, WIDTH, HEIGHT);
    make_terrain(arena, scene, 9, 300,
                 1e-3f); /* as good as flat; one sample a pixel at its border */
    static const float eye[3] = {0, 9, 60}, target[3] = {0, 0, 0};
    size_t terrain;
    assert_true(differences(arena, scene, eye, target, 0, &terrain) <= 1);
    assert_true(terrain > 100);
    assert_true(differences(arena, scene, eye, target, EFFECT_AMBIENT, &terrain) <= 1);
    assert_true(differences(arena, scene, eye, target, EFFECT_FOG, &terrain) <= 1);
    arena_destroy(arena);
}

/* The share of a pixel whose rays meet the plane y = 0 within its borders, of 32 x 32. */
static double plane_share(const struct scene *scene, const struct view *view, int column, int row)
{
    enum { SIDE = 32 };
    int hits = 0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        float direction[3];
        view_ray(view, (float)column + ((float)(i % SIDE) + 0.5f) / SIDE,
                 (float)row + ((float)(i / SIDE) + 0.5f) / SIDE, direction);
        float t = -view->eye_m[1] / direction[1];
        hits += t > 0 && fabsf(view->eye_m[0] + t * direction[0]) < scene->terrain.size_x_m / 2 &&
                fabsf(view->eye_m[2] + t * direction[2]) < scene->terrain.size_z_m / 2;
    }
    return (double)hits / (SIDE * SIDE);
}

/* Pixels of a plane's picture whose mixture of terrain and sky is not by area; how many are mixed.
 */
static size_t unlike_area_of(struct arena *arena, const char *method, const struct scene *scene,
                             const float eye[3], const float target[3], double tolerance,
                             size_t *mixed)
{
    struct view view;
    view_look_at(scene, eye, target, &view);
    struct setting setting = {
        .method = method, .effects = EFFECT_AMBIENT, .format = TARGET_RGBA32F};
    struct picture picture = picture_draw(arena, scene, &view, &setting);
    size_t wrong = 0;
    *mixed = 0;
    for (int row = 0; row < HEIGHT; row++)
        for (int column = 0; column < WIDTH; column++) {
            double share = plane_share(scene, &view, column, row), lit = view.sun_direction[1];
            float direction[3], sky[3];
            const float *pixel = picture.rgba + 4 * (row * WIDTH + column);
            view_ray(&view, (float)column + 0.5f, (float)row + 0.5f, direction);
            sky_radiance(&scene->sky, direction, sky);
            double terrain =
                scene->terrain.albedo[2] * (scene->sun.radiance[2] * lit + scene->ambient[2]);
            double expected_blue = share * terrain + (1 - share) * sky[2];
            *mixed += share > 0.1 && share < 0.9;
            wrong += fabs(pixel[2] - expected_blue) > tolerance * fabs(sky[2] - terrain) + 1e-4;
            assert_true(pixel[3] == 0);
        }
    return wrong;
}

/* Of the worse of the two. */
static size_t unlike_area(struct arena *arena, const struct scene *scene, const float eye[3],
                          const float target[3], double tolerance, size_t *mixed)
{
    size_t worst = 0;
    for (int i = 0; i < 2; i++) {
        size_t wrong = unlike_area_of(arena, methods[i], scene, eye, target, tolerance, mixed);
        worst = wrong > worst ? wrong : worst;
    }
    return worst;
}

static void test_backdrop__the_horizon_of_a_plane_is_mixed_by_area(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct scene *scene = scene_by_hand(arena, WIDTH, HEIGHT);
    scene->camera.far_m = 5000;
    make_terrain(arena, scene, 2, 400, 0);
    /* The far border, z = -200, is seen from height h at row 18 + 18 (h / 200) / tan(fov / 2) when
     * the eye looks level from z = 0: h puts it where we like. */
    for (int k = 0; k < 8; k++) {
        double row = 20.05 + 0.37 * k;
        float height = (float)((row - 18) / 18 * tan(0.4) * 200);
        float eye[3] = {0, height, 0}, target[3] = {0, height, -100};
        size_t mixed, wrong = unlike_area(arena, scene, eye, target, 0.04, &mixed);
        if (wrong > 0)
            fail_msg("row %g: %zu pixels differ, %zu mixed", row, wrong, mixed);
    }
    /* toward a corner, along a border, and down on one: slanted borders */
    static const float eyes[3][3] = {{150, 60, 150}, {190, 5, -100}, {150, 120, 20}};
    static const float targets[3][3] = {{230, 0, 240}, {200, 0, 200}, {199, 0, 25}};
    for (int k = 0; k < 3; k++) {
        size_t mixed, wrong = unlike_area(arena, scene, eyes[k], targets[k], 0.05, &mixed);
        if (wrong > 2 || mixed < 20) /* a corner has two borders in a pixel */
            fail_msg("view %d: %zu pixels differ, %zu mixed", k, wrong, mixed);
    }
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_backdrop__the_sky_is_sky_radiance_at_every_pixel_centre),
        cmocka_unit_test(test_backdrop__hills_are_where_rays_meet_them_and_lit_as_defined),
        cmocka_unit_test(test_backdrop__colours_multiply_the_albedo_of_hills_and_of_a_plane),
        cmocka_unit_test(test_backdrop__coloured_ground_in_shade_is_black_and_never_darker),
        cmocka_unit_test(test_backdrop__effects_that_are_off_are_off),
        cmocka_unit_test(test_backdrop__the_horizon_of_a_plane_is_mixed_by_area),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
