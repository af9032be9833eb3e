/* The reference against closed forms, within its own stated error.  test_reference --table prints
 * them all. */
#include "reference_world.h"

#include <stdio.h>
#include <stdlib.h>

enum { RED, GREEN, BLUE, ALPHA };

struct claim {
    const char *name;
    double truth, estimate, error;
};

/* z of a claim; values that have no sampling noise must agree to float precision. */
static double claim_z(const struct claim *claim)
{
    double rounding = 3e-6 * fmax(1e-3, fabs(claim->truth));
    return (claim->estimate - claim->truth) /
           sqrt(claim->error * claim->error + rounding * rounding);
}

static struct claim claim_frame(const char *name, double truth, const struct frame *frame,
                                int channel)
{
    struct claim claim = {.name = name, .truth = truth};
    claim.estimate = frame_mean(frame, channel, &claim.error);
    return claim;
}

/* Pixels of the picture that a metre covers at a distance along the axis. */
static double pixels_per_metre(const struct world *world, double distance_m)
{
    return world->view.height_px / (2 * tan(world->view.fov_y_rad / 2.0) * distance_m);
}

static struct claim disc_coverage(uint64_t seed)
{
    struct world world = world_create(40, 30, 0.7);
    world_add(&world, disc_mesh(world.arena, MATERIAL_LEAF, 1, 64, 2), 0.31f, 0.17f, -5)->scale =
        1.3f;
    world_look(&world, 0, 0, 0, 0, 0, -1);
    double scale = pixels_per_metre(&world, 5) * 1.3f;
    struct frame *frame = world_render(
        &world, (struct reference_options){.seed = seed, .samples_min = 64, .samples_max = 64},
        NULL);
    struct claim claim =
        claim_frame("coverage of a disc", disc_area(64) * scale * scale / (40 * 30), frame, ALPHA);
    arena_destroy(world.arena);
    return claim;
}

/* A smooth sphere of radius 1, rows x columns quads. */
static struct mesh *sphere_mesh(struct arena *arena, int rows, int columns)
{
    struct mesh *mesh = mesh_new(arena, MATERIAL_BARK, 0.5f, 2 * (size_t)rows * (size_t)columns);
    for (int i = 0; i < rows; i++)
        for (int j = 0; j < columns; j++) {
            double p[4][3];
            for (int k = 0; k < 4; k++) {
                double polar = M_PI * (i + (k == 1 || k == 2)) / rows;
                double azimuth = 2 * M_PI * (j + (k >= 2)) / columns;
                p[k][0] = sin(polar) * sin(azimuth);
                p[k][1] = cos(polar);
                p[k][2] = sin(polar) * cos(azimuth);
            }
            if (i < rows - 1)
                mesh_triangle(mesh, p[0], p[1], p[2]);
            if (i > 0)
                mesh_triangle(mesh, p[0], p[2], p[3]);
        }
    memcpy(mesh->normals, mesh->positions, mesh->vertices_count * sizeof *mesh->normals);
    return mesh_finish(arena, mesh);
}

/* Lambert's sphere: the mean over its disc of max(0, N.L) at phase angle t is
 * (2/3) (sin t + (pi - t) cos t) / pi; the eye is far away. */
static struct claim lambert_sphere(const char *name, unsigned effects, double phase_rad,
                                   uint64_t seed)
{
    struct world world = world_create(24, 24, 2.2 / 2000);
    for (int i = 0; i < 3; i++)
        world.scene.ambient[i] = 0.3f;
    world.scene.camera.far_m = 3000;
    world_add(&world, sphere_mesh(world.arena, 256, 512), 0, 0, 0);
    world_look(&world, 0, 0, 2000, 0, 0, 0);
    world_sun(&world, sin(phase_rad), 0, cos(phase_rad));
    double disc = M_PI * pow(pixels_per_metre(&world, 2000), 2) / (24 * 24);
    double lit = 2 / 3.0 * (sin(phase_rad) + (M_PI - phase_rad) * cos(phase_rad)) / M_PI;
    double truth = 0.5 * disc * (lit + (effects & EFFECT_AMBIENT ? 0.3 : 0));
    struct frame *frame =
        world_render(&world,
                     (struct reference_options){
                         .seed = seed, .effects = effects, .samples_min = 4, .samples_max = 4},
                     NULL);
    struct claim claim = claim_frame(name, truth, frame, GREEN);
    arena_destroy(world.arena);
    return claim;
}

static struct claim sphere_facing(uint64_t seed)
{
    return lambert_sphere("Lambert sphere, sun behind the eye", 0, 0, seed);
}

static struct claim sphere_side(uint64_t seed)
{
    return lambert_sphere("Lambert sphere, sun at 100 degrees, own shadow", EFFECT_SUN_SHADOWS,
                          100 * M_PI / 180, seed);
}

static struct claim sphere_ambient(uint64_t seed)
{
    return lambert_sphere("Lambert sphere, sun at 60 degrees and ambient", EFFECT_AMBIENT, M_PI / 3,
                          seed);
}

/* A unit vector, uniform on the sphere. */
static void random_direction(struct random *random, double direction[3])
{
    double z = 2 * random_double(random) - 1, angle = 2 * M_PI * random_double(random);
    direction[0] = sqrt(1 - z * z) * cos(angle);
    direction[1] = sqrt(1 - z * z) * sin(angle);
    direction[2] = z;
}

/* `count` triangles of area `area_m2` with their centres uniform in 12 x 12 x 4 m, uniform
 * directions. */
static struct mesh *leaf_slab(struct arena *arena, uint64_t seed, int count, double area_m2)
{
    struct random random = random_seed(seed, 77);
    struct mesh *mesh = mesh_new(arena, MATERIAL_LEAF, 1, (size_t)count);
    double radius = sqrt(area_m2 / (0.75 * sqrt(3)));
    for (int i = 0; i < count; i++) {
        double first[3], second[3], other[3], p[3][3], length = 0, along = 0;
        double center[3] = {12 * random_double(&random) - 6, 12 * random_double(&random) - 6,
                            4 * random_double(&random) - 2};
        random_direction(&random, first);
        random_direction(&random, other);
        for (int k = 0; k < 3; k++)
            along += first[k] * other[k];
        for (int k = 0; k < 3; k++) {
            second[k] = other[k] - along * first[k];
            length += second[k] * second[k];
        }
        for (int corner = 0; corner < 3; corner++)
            for (int k = 0; k < 3; k++)
                p[corner][k] =
                    center[k] + radius * (cos(2 * M_PI * corner / 3) * first[k] +
                                          sin(2 * M_PI * corner / 3) * second[k] / sqrt(length));
        mesh_triangle(mesh, p[0], p[1], p[2]);
    }
    return mesh_finish(arena, mesh);
}

/* Beer and Lambert: leaves of mean projected area a / 2 leave exp(-count a / (2 area)) of the
 * light. The error is that of the slabs' own scatter. */
static struct claim random_leaves(uint64_t seed)
{
    enum { SLABS = 40, LEAVES = 6000 };
    double area_m2 = 0.03, sum = 0, squares = 0;
    for (uint64_t slab = SLABS * seed; slab < SLABS * (seed + 1); slab++) {
        struct world world = world_create(24, 24, 8.0 / 2000);
        world_add(&world, leaf_slab(world.arena, slab, LEAVES, area_m2), 0, 0, 0);
        world_look(&world, 0, 0, 2000, 0, 0, 0);
        double error;
        double mean =
            frame_mean(world_render(&world,
                                    (struct reference_options){
                                        .seed = seed, .samples_min = 16, .samples_max = 16},
                                    NULL),
                       ALPHA, &error);
        sum += mean;
        squares += mean * mean;
        arena_destroy(world.arena);
    }
    double mean = sum / SLABS;
    return (struct claim){"slab of random leaves against exp(-density)",
                          1 - exp(-LEAVES * area_m2 / 2 / (12 * 12)), mean,
                          sqrt((squares / SLABS - mean * mean) / (SLABS - 1))};
}

static struct mesh *wall_mesh(struct arena *arena, double half_m, float albedo)
{
    struct mesh *mesh = mesh_new(arena, MATERIAL_BARK, albedo, 2);
    mesh_quad(mesh, (double[]){-half_m, -half_m, 0}, (double[]){half_m, -half_m, 0},
              (double[]){half_m, half_m, 0}, (double[]){-half_m, half_m, 0});
    return mesh_finish(arena, mesh);
}

/* A wall across the view: exp(-density distance / cos) averaged over the picture by quadrature. */
static struct claim fog_on_a_wall(uint64_t seed)
{
    struct world world = world_create(32, 20, 1.1);
    world.scene.fog = (struct fog){{0.2f, 0.4f, 0.8f}, 0.06f};
    world_add(&world, wall_mesh(world.arena, 500, 0.8f), 0, 0, -20);
    world_look(&world, 0, 0, 0, 0, 0, -1);
    world_sun(&world, 0, 0.6, 0.8);
    double clear = 0, top = tan(1.1f / 2.0), side = top * 32 / 20;
    enum { STEPS = 400 };
    for (int i = 0; i < STEPS; i++)
        for (int j = 0; j < STEPS; j++) {
            double x = side * (2 * (i + 0.5) / STEPS - 1), y = top * (2 * (j + 0.5) / STEPS - 1);
            clear += exp(-0.06f * 20 * sqrt(1 + x * x + y * y)) / (STEPS * STEPS);
        }
    double truth = clear * 0.8f * 0.8 + (1 - clear) * 0.8f;
    struct frame *frame =
        world_render(&world,
                     (struct reference_options){
                         .seed = seed, .effects = EFFECT_FOG, .samples_min = 16, .samples_max = 16},
                     NULL);
    struct claim claim = claim_frame("fog before a wall", truth, frame, BLUE);
    arena_destroy(world.arena);
    return claim;
}

/* A black disc 2 m above white ground, seen straight from above; its umbra lies beside it. What is
 * lit is the picture less the disc less its shadow of the same area. */
static struct claim umbra(uint64_t seed)
{
    struct world world = world_create(48, 32, 0.9);
    world.scene.terrain = level_ground(world.arena, 1000, 0.9f);
    world_add(&world, disc_mesh(world.arena, MATERIAL_LEAF, 0, 80, 1), -1.5f, 2, 0);
    world_look(&world, 0, 12, 0, 0, 0, 0);
    world_sun(&world, -2, 1, 0);
    double near = pixels_per_metre(&world, 10), far = pixels_per_metre(&world, 12);
    double hidden = disc_area(80) * (near * near + far * far) / (48 * 32);
    double truth = 0.9f / sqrt(5) * (1 - hidden);
    struct frame *frame = world_render(
        &world,
        (struct reference_options){
            .seed = seed, .effects = EFFECT_SUN_SHADOWS, .samples_min = 64, .samples_max = 64},
        NULL);
    struct claim claim = claim_frame("umbra of a disc", truth, frame, RED);
    arena_destroy(world.arena);
    return claim;
}

static struct claim sky_claim(const char *name, struct world *world, double truth, uint64_t seed)
{
    for (int i = 0; i < 3; i++) {
        world->scene.ambient[i] = 1;
        world->scene.sun.radiance[i] = 0;
    }
    struct frame *frame =
        world_render(world,
                     (struct reference_options){.seed = seed,
                                                .effects = EFFECT_AMBIENT | EFFECT_SKY_OCCLUSION,
                                                .samples_min = 256,
                                                .samples_max = 256},
                     NULL);
    struct claim claim = claim_frame(name, truth, frame, RED);
    arena_destroy(world->arena);
    return claim;
}

/* On the ground 3 m before an endless wall of 4 m, top at the angle t: (1 + cos t) / 2 of the sky
 * is left. */
static struct claim sky_before_a_wall(uint64_t seed)
{
    struct world world = world_create(16, 16, 2e-4);
    world.scene.terrain = level_ground(world.arena, 1000, 1);
    struct mesh *wall = mesh_new(world.arena, MATERIAL_BARK, 0, 2);
    mesh_quad(wall, (double[]){-1e5, 0, 0}, (double[]){1e5, 0, 0}, (double[]){1e5, 4, 0},
              (double[]){-1e5, 4, 0});
    world_add(&world, mesh_finish(world.arena, wall), 0, 0, 0);
    world_look(&world, 0, 3, 5, 0, 0, 3);
    return sky_claim("sky before an endless wall", &world, (1 + 3 / 5.0) / 2, seed);
}

/* On the ground 2 m under the middle of a disc of radius 1.5: 4 / (4 + 2.25) of the sky is left. */
static struct claim sky_under_a_disc(uint64_t seed)
{
    struct world world = world_create(16, 16, 2e-4);
    world.scene.terrain = level_ground(world.arena, 1000, 1);
    world_add(&world, disc_mesh(world.arena, MATERIAL_LEAF, 0, 2000, 1), 0, 2, 0)->scale = 1.5f;
    world_look(&world, 2, 1, 2, 0, 0, 0);
    return sky_claim("sky under a disc", &world, 4 / 6.25, seed);
}

/* A leaf in the sun over open ground sees the whole hemisphere above it, and none below a lid that
 * touches nothing. */
static struct claim sky_between_lids(uint64_t seed)
{
    struct world world = world_create(16, 16, 0.02);
    world.scene.terrain = level_ground(world.arena, 1000, 1);
    world_add(&world, disc_mesh(world.arena, MATERIAL_LEAF, 1, 90, 1), 0, 3, 0);
    world_look(&world, 0, 6, 2, 0, 3, 0);
    return sky_claim("sky over a leaf", &world, 1, seed);
}

/* A quad whose texture is opaque where u is in (1/2, 1): alpha 0 0 1 1 in a row, bilinear and
 * wrapping, crosses 1/2 half way between texels. */
static struct mesh *half_leaf(struct arena *arena, float albedo)
{
    struct mesh *mesh = mesh_new(arena, MATERIAL_LEAF, albedo, 2);
    mesh_quad(mesh, (double[]){-1, 0, 1}, (double[]){1, 0, 1}, (double[]){1, 0, -1},
              (double[]){-1, 0, -1});
    static float texels[4][4] = {{1, 1, 1, 0}, {1, 1, 1, 0}, {1, 1, 1, 1}, {1, 1, 1, 1}};
    struct texture *texture = ARENA_NEW(arena, struct texture);
    *texture = (struct texture){4, 1, texels[0]};
    mesh->materials->texture = texture;
    mesh->uvs = arena_alloc(arena, 6, sizeof *mesh->uvs);
    for (int i = 0; i < 6; i++) {
        mesh->uvs[i][0] = (mesh->positions[i][0] + 1) / 2;
        mesh->uvs[i][1] = (mesh->positions[i][2] + 1) / 2;
    }
    return mesh_finish(arena, mesh);
}

static struct claim leaf_with_holes(uint64_t seed)
{
    struct world world = world_create(40, 40, 0.9);
    world_add(&world, half_leaf(world.arena, 1), 0.1f, 2, 0.05f)->rotation_rad = 0.3f;
    world_look(&world, 0, 7, 0, 0, 0, 0);
    double scale = pixels_per_metre(&world, 5);
    struct frame *frame = world_render(
        &world, (struct reference_options){.seed = seed, .samples_min = 64, .samples_max = 64},
        NULL);
    struct claim claim =
        claim_frame("coverage of a leaf with a hole", 2 * scale * scale / 1600, frame, ALPHA);
    arena_destroy(world.arena);
    return claim;
}

static struct claim shadow_with_holes(uint64_t seed)
{
    struct world world = world_create(40, 40, 0.9);
    world.scene.terrain = level_ground(world.arena, 100, 1);
    world_add(&world, half_leaf(world.arena, 0), 0, 10, 0);
    world_look(&world, 0, 8, 0, 0, 0, 0);
    world_sun(&world, 0, 1, 0);
    double scale = pixels_per_metre(&world, 8);
    struct frame *frame = world_render(
        &world,
        (struct reference_options){
            .seed = seed, .effects = EFFECT_SUN_SHADOWS, .samples_min = 64, .samples_max = 64},
        NULL);
    struct claim claim =
        claim_frame("shadow of a leaf with a hole", 1 - 2 * scale * scale / 1600, frame, RED);
    arena_destroy(world.arena);
    return claim;
}

/* The sky's gradient, averaged over the picture by quadrature. */
static struct claim empty_sky(uint64_t seed)
{
    struct world world = world_create(32, 24, 1.2);
    world.scene.sky = (struct sky){{0.1f, 0.2f, 0.9f}, {0.7f, 0.8f, 0.9f}, {0.3f, 0.2f, 0.1f}};
    world_look(&world, 0, 0, 0, 0, 0.1f, -1);
    double truth = 0, top = tan(1.2f / 2.0), side = top * 32 / 24, tilt = atan(0.1);
    enum { STEPS = 1200 };
    for (int i = 0; i < STEPS; i++)
        for (int j = 0; j < STEPS; j++) {
            double x = side * (2 * (i + 0.5) / STEPS - 1), y = top * (2 * (j + 0.5) / STEPS - 1);
            double up = (sin(tilt) + y * cos(tilt)) / sqrt(1 + x * x + y * y);
            truth +=
                (up >= 0 ? 0.7 + sqrt(up) * (0.1 - 0.7) : 0.7 + fmin(1, -8 * up) * (0.3 - 0.7)) /
                (STEPS * (double)STEPS);
        }
    struct frame *frame = world_render(
        &world, (struct reference_options){.seed = seed, .samples_min = 16, .samples_max = 16},
        NULL);
    struct claim claim = claim_frame("empty sky", truth, frame, RED);
    arena_destroy(world.arena);
    return claim;
}

static struct claim (*const claims[])(uint64_t seed) = {
    disc_coverage,    sphere_facing,    sphere_side,     sphere_ambient,
    random_leaves,    fog_on_a_wall,    umbra,           sky_before_a_wall,
    sky_under_a_disc, sky_between_lids, leaf_with_holes, shadow_with_holes,
    empty_sky,
};
enum { CLAIMS_COUNT = sizeof claims / sizeof *claims };

static void test_reference__every_closed_form_is_met_within_the_stated_error(void **state)
{
    (void)state;
    uint64_t seed = 1;
    for (size_t i = 0; i < CLAIMS_COUNT; i++) {
        struct claim claim = claims[i](seed);
        if (!(fabs(claim_z(&claim)) < 3.5))
            fail_msg("%s: %.9g, not %.9g; stated error %.3g", claim.name, claim.estimate,
                     claim.truth, claim.error);
    }
}

static int print_table(uint64_t seed)
{
    printf("%-48s %12s %12s %12s %7s\n", "closed form", "value", "estimate", "stated error", "z");
    for (size_t i = 0; i < CLAIMS_COUNT; i++) {
        struct claim claim = claims[i](seed);
        printf("%-48s %12.7f %12.7f %12.2e %7.2f\n", claim.name, claim.truth, claim.estimate,
               claim.error, claim_z(&claim));
    }
    return 0;
}

int main(int argc, char **argv)
{
    if (argc > 1 && strcmp(argv[1], "--table") == 0)
        return print_table(argc > 2 ? strtoull(argv[2], NULL, 10) : 1);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_reference__every_closed_form_is_met_within_the_stated_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
