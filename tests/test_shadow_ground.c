/* The sun on the ground under a pixel against the mean of rays through all of the pixel. */
#include "march_world.h"

#include "bake/shadow_ground.h"

#include <math.h>
#include <string.h>

enum { ALONG = 60, ROWS = 6, ACROSS = 24, DOWN = 96 };
static const float pixel = 0.004f; /* its side, 1 m before the eye */

/* Rows of opaque squares that float above the ground: shadows thinner than a pixel from afar. */
struct rows {
    struct arena *arena;
    struct terrain terrain;
    struct shadow_light light;
    struct shadow_ground ground;
    struct shadow_volume volume;
    struct shadow_caster casters[ALONG * ROWS];
    float rise; /* of the ground, along z */
};

static void rows_create(struct rows *rows, float rise)
{
    static const float sun[3] = {0.36f, 0.8f, 0.48f};
    memset(rows, 0, sizeof *rows);
    rows->arena = arena_create(0);
    rows->rise = rise;
    rows->terrain = (struct terrain){.samples_x = 2,
                                     .samples_z = 2,
                                     .size_x_m = 2000,
                                     .size_z_m = 2000,
                                     .heights_m = ARENA_ARRAY(rows->arena, float, 4)};
    rows->terrain.normals = arena_alloc(rows->arena, 4, sizeof *rows->terrain.normals);
    for (int i = 0; i < 4; i++) {
        rows->terrain.heights_m[i] = (i < 2 ? -1000 : 1000) * rise;
        rows->terrain.normals[i][1] = 1 / sqrtf(1 + rise * rise);
        rows->terrain.normals[i][2] = -rise / sqrtf(1 + rise * rise);
    }
    shadow_light_create(rows->arena, &rows->terrain, &rows->light);
    shadow_light_turn(&rows->light, sun);
    struct shadow_volume *volume = &rows->volume;
    *volume = (struct shadow_volume){.low_m = {-0.2f, -0.2f, -0.2f}, .cell_m = 0.1f};
    for (int k = 0; k < 3; k++)
        volume->size[k] = 4;
    shadow_volume_lay_plates(rows->arena, volume);
    for (int k = 0; k < 16; k++)
        volume->plates[0][k] = (struct shadow_plate){1, -0.2f, 0.2f};
    shadow_volume_halve_plates(volume);
    for (int k = 0; k < ALONG * ROWS; k++) {
        const float x_m = 0.8f * (float)(k % ALONG - ALONG / 2), z_m = -1.3f * (float)(k / ALONG);
        rows->casters[k] = (struct shadow_caster){.scale = 1, .volume = volume};
        shadow_along(&rows->light.frame, (float[3]){x_m, 3 + rise * z_m, z_m},
                     rows->casters[k].place_m);
    }
    shadow_map_fill(rows->arena, &rows->light.map, rows->casters, ALONG * ROWS, 1 << 21, 0.1f, 1);
    shadow_ground_fill(rows->arena, &rows->ground, &rows->light, 2);
}

/* A pixel that looks from so high at a place of the ground, turned a little about its ray. */
static struct shadow_pixel pixel_at(const struct rows *rows, float x_m, float z_m, float away_m,
                                    float up_m)
{
    struct shadow_pixel seen = {.eye_m = {x_m - 0.6f * away_m, 0, z_m + 0.8f * away_m}};
    seen.eye_m[1] = rows->rise * seen.eye_m[2] + up_m;
    const float to_m[3] = {x_m - seen.eye_m[0], rows->rise * z_m - seen.eye_m[1],
                           z_m - seen.eye_m[2]};
    const float flat_m = sqrtf(to_m[0] * to_m[0] + to_m[2] * to_m[2]);
    seen.depth_m = sqrtf(flat_m * flat_m + to_m[1] * to_m[1]);
    const float c = 0.96f * pixel, s = 0.28f * pixel;
    for (int i = 0; i < 3; i++) {
        const float right = i == 0 ? -to_m[2] / flat_m : i == 2 ? to_m[0] / flat_m : 0;
        seen.ray[i] = to_m[i] / seen.depth_m;
        const float down =
            i == 1 ? -flat_m / seen.depth_m : to_m[i] / flat_m * to_m[1] / seen.depth_m;
        seen.right[i] = c * right + s * down;
        seen.down[i] = c * down - s * right;
    }
    return seen;
}

/* The light at the places that rays through all of the pixel meet. */
static float by_rays(const struct rows *rows, const struct shadow_pixel *seen)
{
    double sum = 0;
    for (int k = 0; k < ACROSS * DOWN; k++) {
        const float x = ((float)(k % ACROSS) + 0.5f) / ACROSS - 0.5f;
        const float y = ((float)(k / ACROSS) + 0.5f) / DOWN - 0.5f;
        float ray[3], place_m[3];
        for (int i = 0; i < 3; i++)
            ray[i] = seen->ray[i] + x * seen->right[i] + y * seen->down[i];
        const float depth_m =
            (rows->rise * seen->eye_m[2] - seen->eye_m[1]) / (ray[1] - rows->rise * ray[2]);
        for (int i = 0; i < 3; i++)
            place_m[i] = seen->eye_m[i] + depth_m * ray[i];
        sum += (double)shadow_light_at(&rows->light, place_m);
    }
    return (float)(sum / (ACROSS * DOWN));
}

/* Differences from the rays' mean, of pixels so far away: mean, largest, and of one look-up at the
 * middle. */
struct errors {
    double mean, most, one, light;
};

static struct errors errors_at(const struct rows *rows, float away_m, float up_m)
{
    enum { COUNT = 60 };
    struct errors errors = {0, 0, 0, 0};
    for (int k = 0; k < COUNT; k++) {
        /* across the middle of the shadows, a fifth of a pixel on each */
        const float step_m = 0.37f * (float)k - 11,
                    middle_m[2] = {-1.35f + step_m, -5 + 0.11f * step_m};
        const struct shadow_pixel seen = pixel_at(rows, middle_m[0], middle_m[1], away_m, up_m);
        const float place_m[3] = {middle_m[0], rows->rise * middle_m[1], middle_m[1]};
        const double truth = (double)by_rays(rows, &seen);
        const double off = (double)shadow_ground_at(&rows->ground, &rows->light, &seen) - truth;
        errors.mean += fabs(off) / COUNT;
        errors.most = fmax(errors.most, fabs(off));
        errors.one += fabs((double)shadow_light_at(&rows->light, place_m) - truth) / COUNT;
        errors.light += truth / COUNT;
    }
    return errors;
}

static void check(float rise)
{
    static const float ways_m[5][2] = {{4, 6}, {30, 12}, {75, 10}, {150, 12}, {300, 60}};
    struct rows *rows = calloc(1, sizeof *rows);
    rows_create(rows, rise);
    for (int k = 0; k < 5; k++) {
        const struct errors errors = errors_at(rows, ways_m[k][0], ways_m[k][1]);
        const bool is_far = ways_m[k][0] > 50;
        if (!(errors.mean < 0.025 && errors.most < 0.08) || !(errors.light < 0.97) ||
            (is_far && !(errors.mean < 0.1 * errors.one)))
            fail_msg("rise %g, %g m away, %g m up: off by %.4f, at most %.4f; one look-up by %.4f; "
                     "light %.3f",
                     (double)rise, (double)ways_m[k][0], (double)ways_m[k][1], errors.mean,
                     errors.most, errors.one, errors.light);
    }
    arena_destroy(rows->arena);
    free(rows);
}

static void test_shadow_ground__a_pixel_has_the_mean_light_of_what_it_covers(void **state)
{
    (void)state;
    check(0);
    check(0.1f);
}

/* Where the ground of a pixel ends at the horizon. */
static void test_shadow_ground__at_the_horizon_light_is_between_none_and_all(void **state)
{
    (void)state;
    struct rows *rows = calloc(1, sizeof *rows);
    rows_create(rows, 0);
    for (int k = 0; k < 40; k++) {
        const struct shadow_pixel seen =
            pixel_at(rows, 0.3f * (float)k - 6, -5, 30 + 20 * (float)k, 0.05f);
        const float light = shadow_ground_at(&rows->ground, &rows->light, &seen);
        if (!(light > 0.3f && light <= 1))
            fail_msg("%d: %g", k, (double)light);
    }
    arena_destroy(rows->arena);
    free(rows);
}

/* Crowns far apart and their shadows, seen at a slant in which a pixel's ground is longer than a
 * shadow. */
static struct world world_of_shadows(void)
{
    struct world world = world_of_balls(1, 3000, 0.25);
    struct scene *scene = &world.scene;
    scene->terrain = level_ground(world.arena, 300, 0.4f);
    for (scene->instances_count = 0; scene->instances_count < 40; scene->instances_count++) {
        struct instance *tree = &scene->instances[scene->instances_count];
        *tree = scene->instances[0];
        tree->position_m[0] = 25 * ((float)(scene->instances_count % 8) - 3.5f);
        tree->position_m[2] = 25 * ((float)(scene->instances_count / 8) - 2);
    }
    world_look(&world, 200, 90, 400, 0, 0, 0);
    world_sun(&world, 0.7, 0.5, -0.5);
    return world;
}

static void test_shadow_ground__the_march_has_shadows_finer_than_pixels_as_traced(void **state)
{
    (void)state;
    static const unsigned effects[2] = {EFFECT_TWO_SIDED, EFFECT_TWO_SIDED | EFFECT_SUN_SHADOWS};
    struct world world = world_of_shadows();
    const struct frame *drawn[2], *truth[2];
    double error = 0, shade = 0;
    for (int k = 0; k < 2; k++) {
        drawn[k] = march_picture(&world, &usual, effects[k], 2);
        truth[k] = traced(&world, effects[k]);
    }
    for (int i = 0; i < 96 * 80; i++) {
        const double dark = truth[0]->rgba[4 * i] - truth[1]->rgba[4 * i];
        const double off = drawn[0]->rgba[4 * i] - drawn[1]->rgba[4 * i] - dark;
        if (truth[1]->rgba[4 * i + 3] > 0.02f || drawn[1]->rgba[4 * i + 3] > 0.02f)
            continue;
        error += off * off;
        shade += dark * dark;
    }
    printf("# off by %.4f of %.4f\n", sqrt(error / (96 * 80)), sqrt(shade / (96 * 80)));
    if (!(sqrt(error) < 0.2 * sqrt(shade)))
        fail_msg("off by %g of %g", sqrt(error), sqrt(shade));
    arena_destroy(world.arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shadow_ground__a_pixel_has_the_mean_light_of_what_it_covers),
        cmocka_unit_test(test_shadow_ground__at_the_horizon_light_is_between_none_and_all),
        cmocka_unit_test(test_shadow_ground__the_march_has_shadows_finer_than_pixels_as_traced),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
