/* The ray march: kernels against closed forms and each other, pictures against the reference. */
#include "testing.h"

#include "march_block.h"
#include "march_world.h"

#include <stdlib.h>

/* A box of equal voxels, seen from outside along a direction. */
struct slab {
    struct voxels voxels;
    struct voxel voxel;
    uint32_t cells[8 * 6 * 5];
    struct march_job job;
    struct block rays;
};

static const struct march_form unit = {{1}}, third = {{1.0f / 3}};

static void slab_fill(struct slab *slab, float extinction, const float eye[3], const float ray[3])
{
    const int32_t size[3] = {8, 6, 5};
    struct voxel_optics optics = {.extinction = extinction, .evenness = 1, .albedo = {1, 1, 1}};
    memset(slab, 0, sizeof *slab);
    slab->voxel = voxel_pack(&optics, (const float[3]){1, 1, 1});
    for (int i = 0; i < 8 * 6 * 5; i++)
        slab->cells[i] = MARCH_FULL;
    struct march_job *job = &slab->job;
    job->cells = slab->cells;
    job->voxels = (const uint32_t *)(const void *)&slab->voxel;
    memcpy(job->size, size, sizeof size);
    memcpy(job->eye, eye, sizeof job->eye);
    memcpy(job->first, ray, sizeof job->first);
    job->speed = sqrtf(ray[0] * ray[0] + ray[1] * ray[1] + ray[2] * ray[2]);
    job->step = 1;
    job->far_m = INFINITY;
    job->hidden = job->seen = job->lit = unit;
    for (int c = 0; c < 3; c++)
        job->shade[c] = 1.0f / 255; /* every voxel glows with radiance 1 */
    job->clear = 1;
    block_open(&slab->rays);
}

/* Length of a ray within the box, in double. */
static double length_within(const float eye[3], const float ray[3])
{
    const double size[3] = {8, 6, 5};
    double from = 0, to = INFINITY, speed = 0;
    for (int i = 0; i < 3; i++) {
        double a = -eye[i] / (double)ray[i], b = (size[i] - eye[i]) / (double)ray[i];
        from = fmax(from, fmin(a, b));
        to = fmin(to, fmax(a, b));
        speed += (double)ray[i] * ray[i];
    }
    return to > from ? (to - from) * sqrt(speed) : 0;
}

static void random_ray(struct random *random, float eye[3], float ray[3])
{
    const float middle[3] = {4, 3, 2.5f};
    for (int i = 0; i < 3; i++) {
        float within = middle[i] * (0.3f + 1.4f * random_float(random));
        eye[i] = middle[i] + 40 * (random_float(random) - 0.5f);
        ray[i] = (within - eye[i]) / 10;
    }
}

static void test_march__a_homogeneous_box_lets_exp_of_its_depth_through_from_any_side(void **state)
{
    (void)state;
    struct march_isa isas[4];
    size_t count = march_isas(isas);
    struct random random = random_seed(5, 1);
    for (int n = 0; n < 200; n++) {
        float eye[3], ray[3];
        struct slab slab;
        random_ray(&random, eye, ray);
        double expected = exp(-0.3 * length_within(eye, ray));
        for (size_t isa = 0; isa < count; isa++)
            for (int part = 1; part <= 4; part *= 4) {
                slab_fill(&slab, 0.3f, eye, ray);
                slab.job.step = 1.0f / (float)part; /* however it is cut */
                block_march(&isas[isa], &slab.job, &slab.rays);
                for (int lane = 0; lane < BLOCK_RAYS; lane++) {
                    assert_true(fabs(slab.rays.left[lane] - expected) < 2e-5);
                    /* Kajiya and Kay: a medium of radiance 1 gives 1 - T */
                    assert_true(fabs(slab.rays.rgb[lane][0] + slab.rays.left[lane] - 1) < 1e-5);
                }
            }
    }
}

static void test_march__nothing_hides_nothing_and_opaque_all(void **state)
{
    (void)state;
    struct march_isa isas[4];
    size_t count = march_isas(isas);
    const float eye[3] = {-3, 3.1f, 2.2f}, ray[3] = {1, 0, 0}, away[3] = {-1, 0, 0};
    struct slab slab;
    for (size_t isa = 0; isa < count; isa++) {
        slab_fill(&slab, 0, eye, ray);
        assert_int_equal(0, block_march(&isas[isa], &slab.job, &slab.rays));
        assert_true(slab.rays.left[0] == 1 && slab.rays.rgb[0][0] == 0);
        slab_fill(&slab, 1e6f, eye, ray);
        assert_int_equal(BLOCK_RAYS, block_march(&isas[isa], &slab.job, &slab.rays));
        assert_true(slab.rays.left[0] < 1e-30f && fabsf(slab.rays.rgb[0][0] - 1) < 1e-6f);
        slab_fill(&slab, 1e6f, eye, away);
        block_march(&isas[isa], &slab.job, &slab.rays);
        assert_true(slab.rays.left[0] == 1);
        slab_fill(&slab, 1e6f, eye, ray); /* something stands before the box */
        slab.rays.depths_m[0] = 2.9f;
        block_march(&isas[isa], &slab.job, &slab.rays);
        assert_true(slab.rays.left[0] == 1 && slab.rays.left[1] < 1e-30f);
        slab_fill(&slab, 0.3f, (const float[3]){4, 3, 2}, ray); /* the eye within */
        block_march(&isas[isa], &slab.job, &slab.rays);
        assert_true(fabs(slab.rays.left[0] - exp(-0.3 * 4)) < 2e-5);
    }
}

/* The mean of what a leaf shows of the sun, over normals on a ring of half angle `cone` around +y:
 * projected area weighs. */
static void ring(double cone, const double eye[3], const double sun[3], double *two_sided,
                 double *one_sided, double moments[6])
{
    double area = 0, even = 0, odd = 0;
    memset(moments, 0, 6 * sizeof *moments);
    enum { STEPS = 20000 };
    for (int k = 0; k < STEPS; k++) {
        /* cone < 0: the whole sphere, by the golden spiral */
        double z = cone < 0 ? 1 - (2.0 * k + 1) / STEPS : cos(cone);
        double turn = cone < 0 ? k * 2.399963229728653 : 2 * M_PI * (k + 0.5) / STEPS;
        double r = sqrt(1 - z * z), n[3] = {r * cos(turn), z, r * sin(turn)};
        double a = n[0] * eye[0] + n[1] * eye[1] + n[2] * eye[2];
        double b = n[0] * sun[0] + n[1] * sun[1] + n[2] * sun[2];
        area += fabs(a);
        even += fabs(a) * fabs(b);
        odd += fabs(a) * fmax(0, a > 0 ? b : -b);
        const double products[6] = {n[0] * n[0], n[1] * n[1], n[2] * n[2],
                                    n[0] * n[1], n[0] * n[2], n[1] * n[2]};
        for (int i = 0; i < 6; i++)
            moments[i] += products[i] / STEPS;
    }
    *two_sided = even / area;
    *one_sided = odd / area;
}

static struct march_form form_by_hand(const double x[3], const double y[3])
{
    double zz = x[2] * y[2], xy = x[0] * y[1] + x[1] * y[0], xz = x[0] * y[2] + x[2] * y[0];
    double yz = x[1] * y[2] + x[2] * y[1];
    return (struct march_form){{(float)(zz - (xy + xz + yz) / 2), (float)((x[0] * y[0] - zz) / 63),
                                (float)((x[1] * y[1] - zz) / 63), (float)(xy / 62),
                                (float)(xz / 62), (float)(yz / 62)}};
}

static void light_check(double cone, double evenness, double tolerance)
{
    struct march_isa isas[4];
    march_isas(isas);
    struct random random = random_seed(11, 2);
    for (int n = 0; n < 40; n++) {
        double eye[3], sun[3], lengths[2] = {0, 0}, two, single, moments[6];
        for (int i = 0; i < 3; i++) {
            eye[i] = random_double(&random) - 0.5;
            sun[i] = random_double(&random) - 0.5;
            lengths[0] += eye[i] * eye[i];
            lengths[1] += sun[i] * sun[i];
        }
        for (int i = 0; i < 3; i++) {
            eye[i] /= sqrt(lengths[0]);
            sun[i] /= sqrt(lengths[1]);
        }
        if (cone >= 0 && fabs(eye[1]) < 0.3)
            continue; /* edge-on to all leaves: packing decides */
        ring(cone, eye, sun, &two, &single, moments);
        for (int sided = 0; sided < 2; sided++) {
            struct slab slab;
            slab_fill(&slab, 50, (const float[3]){-3, 3.1f, 2.2f}, (const float[3]){1, 0, 0});
            struct voxel_optics optics = {
                .extinction = 50, .evenness = (float)evenness, .albedo = {1, 1, 1}};
            for (int i = 0; i < 6; i++)
                optics.normals[i] = (float)moments[i];
            slab.voxel = voxel_pack(&optics, (const float[3]){1, 1, 1});
            slab.job.seen = form_by_hand(eye, eye);
            slab.job.lit = form_by_hand(sun, sun);
            slab.job.both = form_by_hand(eye, sun);
            slab.job.one_sided = (float)sided;
            for (int c = 0; c < 3; c++) {
                slab.job.shade[c] = 0;
                slab.job.sun[c] = 1.0f / 255;
            }
            block_march(&isas[0], &slab.job, &slab.rays);
            assert_true(fabs(slab.rays.rgb[0][1] - (sided ? single : two)) < tolerance);
        }
    }
}

static void test_march__light_of_leaves_is_that_of_quadrature(void **state)
{
    (void)state;
    light_check(0, 1, 0.03);            /* all lie flat */
    light_check(-1, sqrt(3) / 2, 0.03); /* turned everywhere alike */
}

static void test_march__every_instruction_set_gives_the_same_bits(void **state)
{
    (void)state;
    struct march_isa isas[4];
    size_t count = march_isas(isas);
    struct random random = random_seed(9, 1);
    for (int n = 0; n < 300; n++) {
        struct slab slabs[4];
        float eye[3], ray[3];
        random_ray(&random, eye, ray);
        slab_fill(&slabs[0], 0.4f, eye, ray);
        for (int i = 0; i < 8 * 6 * 5; i++)
            slabs[0].cells[i] = random_below(&random, 3) ? 0 : MARCH_FULL;
        slabs[0].voxel.normals = random_u32(&random) >> 2;
        slabs[0].voxel.color = random_u32(&random);
        for (int i = 0; i < 3; i++) {
            slabs[0].job.right[i] = 0.02f * random_float(&random);
            slabs[0].job.down[i] = 0.02f * random_float(&random);
            slabs[0].job.sun[i] = random_float(&random);
        }
        slabs[0].job.seen = slabs[0].job.lit = third;
        slabs[0].job.both.factors[3] = 0.01f;
        slabs[0].job.by_mean = n % 2;
        slabs[0].job.toward_eye[n % 3] = slabs[0].job.toward_sun[1] = 1;
        for (size_t isa = 0; isa < count; isa++) {
            slabs[isa] = slabs[0];
            slabs[isa].job.cells = slabs[isa].cells;
            slabs[isa].job.voxels = (const uint32_t *)(const void *)&slabs[isa].voxel;
        }
        for (size_t isa = 0; isa < count; isa++) {
            block_march(&isas[isa], &slabs[isa].job, &slabs[isa].rays);
            assert_memory_equal(&slabs[isa].rays, &slabs[0].rays, sizeof slabs->rays);
        }
    }
}

enum { MANY_ACROSS = 23, MANY_DOWN = 17, MANY = MANY_ACROSS * MANY_DOWN };
struct many {
    float left[MANY + MARCH_ROOM], depths_m[MANY + MARCH_ROOM], rgb[MANY][4];
};

/* Some are closed before, some end within. */
static void many_open(struct many *many)
{
    struct random random = random_seed(3, 8);
    memset(many, 0, sizeof *many);
    for (int i = 0; i < MANY; i++) {
        many->left[i] = random_below(&random, 4) ? 1 - 0.9f * random_float(&random) : 0.01f;
        many->depths_m[i] = random_below(&random, 4) ? INFINITY : 10 * random_float(&random);
    }
}

/* A ray's bits do not depend on which others go with it, in which lanes and in which order. */
static void test_march__a_ray_gives_the_same_bits_alone_and_among_others(void **state)
{
    (void)state;
    struct march_isa isas[4];
    const size_t count = march_isas(isas);
    struct random random = random_seed(7, 4);
    struct slab slab;
    slab_fill(&slab, 1.3f, (const float[3]){-4, 2.8f, 2.1f}, (const float[3]){1, -0.35f, -0.3f});
    for (int i = 0; i < 8 * 6 * 5; i++)
        slab.cells[i] = random_below(&random, 3) ? 0 : MARCH_FULL;
    slab.job.right[1] = 0.7f / MANY_ACROSS;
    slab.job.down[2] = 0.6f / MANY_DOWN;
    slab.job.stop = 0.02f;
    struct many alone, among;
    for (int width = 1; width <= MANY_ACROSS; width++) {
        const int x = (MANY_ACROSS - width) / 2, y = width % 5;
        const struct march_rect rect = {{x, y}, {x + width - 1, MANY_DOWN - 1}};
        int closed = 0;
        many_open(&alone);
        struct march_rays rays = {MANY_ACROSS, alone.left, alone.rgb, alone.depths_m, 0};
        for (int row = rect.low[1]; row <= rect.high[1]; row++)
            for (int column = rect.low[0]; column <= rect.high[0]; column++) {
                const struct march_rect one = {{column, row}, {column, row}};
                closed += isas[0].kernel(&slab.job, &one, &rays);
            }
        for (size_t isa = 0; isa < count; isa++) {
            many_open(&among);
            rays = (struct march_rays){MANY_ACROSS, among.left, among.rgb, among.depths_m, 0};
            assert_int_equal(closed, isas[isa].kernel(&slab.job, &rect, &rays));
            assert_memory_equal(&among, &alone, sizeof among);
        }
        if (width == MANY_ACROSS) /* there are some of each kind */
            assert_in_range(closed, MANY / 10, MANY / 2);
    }
}

static void balls_check(size_t trees, size_t leaves, double leg_m, unsigned effects,
                        double tolerance)
{
    struct world world = world_of_balls(trees, leaves, leg_m);
    double drawn[4], true_means[4];
    means_of(march_picture(&world, &usual, effects, 2), drawn);
    means_of(traced(&world, effects), true_means);
    for (int c = 0; c < 4; c++)
        if (!(fabs(drawn[c] / true_means[c] - 1) < tolerance))
            fail_msg("%zu trees, channel %d: %g, reference %g", trees, c, drawn[c], true_means[c]);
    arena_destroy(world.arena);
}

static void test_march__a_ball_of_leaves_covers_and_shines_as_traced(void **state)
{
    (void)state;
    balls_check(1, 3000, 0.25, EFFECT_TWO_SIDED | EFFECT_AMBIENT, 0.04);
    balls_check(1, 3000, 0.25, EFFECT_AMBIENT, 0.04);
    balls_check(1, 20000, 0.25, EFFECT_TWO_SIDED, 0.05);
}

/* A scalar density is the root mean square of the axes' where the mean over directions hides: of
 * one flat leaf 1 / sqrt(3) in place of 1 / 2. */
static void test_march__a_ball_of_leaves_covers_as_traced_by_every_model(void **state)
{
    (void)state;
    static const double most[] = {[MARCH_SGGX] = 1.05,
                                  [MARCH_ISOTROPIC] = 1.1547,
                                  [MARCH_NOMA] = 1.05,
                                  [MARCH_VISIBLE] = 1.05};
    struct world world = world_of_balls(1, 3000, 0.25);
    double drawn[4], true_means[4];
    means_of(traced(&world, EFFECT_TWO_SIDED), true_means);
    for (enum march_model model = MARCH_SGGX; model <= MARCH_VISIBLE; model++) {
        struct march_options options = usual;
        options.model = model;
        means_of(march_picture(&world, &options, EFFECT_TWO_SIDED, 2), drawn);
        for (int c = 0; c < 4; c++)
            if (!(drawn[c] / true_means[c] > 0.95 && drawn[c] / true_means[c] < most[model]))
                fail_msg("model %d, channel %d: %g, reference %g", (int)model, c, drawn[c],
                         true_means[c]);
    }
    arena_destroy(world.arena);
}

static void test_march__overlapping_trees_and_one_within_another_cover_as_traced(void **state)
{
    (void)state;
    balls_check(2, 3000, 0.25, EFFECT_TWO_SIDED | EFFECT_AMBIENT, 0.05);
    balls_check(3, 3000, 0.25, EFFECT_TWO_SIDED | EFFECT_AMBIENT, 0.05);
}

/* Two trees in one place, each one homogeneous voxel of the same leaves but for their colour: of
 * all that is hidden each hides a half, whichever comes first. */
static void test_march__thin_slabs_of_overlapping_trees_sum_their_densities(void **state)
{
    (void)state;
    struct world world = world_of_balls(1, 3000, 0.25);
    struct scene *scene = &world.scene;
    struct mesh *dark = ball_of_leaves(world.arena, 3000, 0.25);
    struct march_options options = {.resolution = 1, .step = 1, .tile_px = 16};
    const float *pictures[4]; /* neither, the first, the second, both */
    for (int c = 0; c < 3; c++)
        dark->materials[0].albedo[c] *= 0.1f * (float)(c + 1);
    scene->species[1] =
        (struct species){"dark", plant_from_mesh(world.arena, "dark", dark), 1, 1, 1};
    scene->species_count = 2;
    for (int k = 0; k < 4; k++) {
        scene->instances[0] = scene->instances[1] = (struct instance){{0, 0, 0}, 0.3f, 1, 0, 1};
        scene->instances[1].species = 1;
        if (k == 2)
            scene->instances[0].species = 1;
        scene->instances_count = k == 3 ? 2 : k > 0;
        options.slab = k == 3 ? 0.004f : 0;
        pictures[k] = march_picture(&world, &options, EFFECT_TWO_SIDED, 2)->rgba;
    }
    options.slab = 0;
    const float *whole = march_picture(&world, &options, EFFECT_TWO_SIDED, 2)->rgba;
    double worst = 0, apart = 0;
    for (size_t i = 0; i < 96 * 80; i++) {
        double clear = 1 - pictures[1][4 * i + 3];
        assert_true(fabs(1 - pictures[3][4 * i + 3] - clear * clear) < 1e-4);
        for (size_t c = 4 * i; c < 4 * i + 3; c++) {
            double behind = pictures[0][c], first = pictures[1][c] - clear * behind;
            double second = pictures[2][c] - clear * behind;
            double sum = (first + second) / 2 * (1 + clear) + clear * clear * behind;
            worst = fmax(worst, fabs(pictures[3][c] - sum));
            apart = fmax(apart, fabs(whole[c] - sum));
        }
    }
    if (!(worst < 0.002 && apart > 10 * worst))
        fail_msg("slabs off by %g, whole trees by %g", worst, apart);
    arena_destroy(world.arena);
}

static void test_march__light_along_each_axis_shines_as_traced(void **state)
{
    (void)state;
    struct world world = world_of_balls(1, 3000, 0.25);
    struct ready *ready = march_ready(&world, &usual, EFFECT_TWO_SIDED, 2);
    for (int axis = 0; axis < 6; axis++) {
        double to[3] = {0, 0, 0}, drawn[4], true_means[4];
        to[axis % 3] = axis < 3 ? 1 : -1;
        world_sun(&world, to[0], to[1], to[2]);
        means_of(ready_picture(&world, ready), drawn);
        means_of(traced(&world, EFFECT_TWO_SIDED), true_means);
        if (!(fabs(drawn[1] / true_means[1] - 1) < 0.05))
            fail_msg("axis %d: %g, reference %g", axis, drawn[1], true_means[1]);
    }
    arena_destroy(world.arena);
}

static void test_march__the_eye_within_a_crown_sees_as_traced(void **state)
{
    (void)state;
    struct world world = world_of_balls(1, 3000, 0.25);
    double drawn[4], true_means[4];
    world_look(&world, 0.4f, 5.2f, 0.3f, 4, 6, -3);
    means_of(march_picture(&world, &usual, EFFECT_TWO_SIDED, 2), drawn);
    means_of(traced(&world, EFFECT_TWO_SIDED), true_means);
    assert_true(fabs(drawn[3] - true_means[3]) < 0.06);
    arena_destroy(world.arena);
}

static void test_march__threads_tiles_and_instruction_sets_change_no_byte(void **state)
{
    (void)state;
    struct world world = world_of_balls(3, 2000, 0.25);
    struct march_options plain = usual, tiles = usual;
    plain.isa = "plain";
    tiles.tile_px = 8;
    const struct frame *first = march_picture(&world, &usual, EFFECT_TWO_SIDED, 1);
    size_t size = 4 * sizeof(float) * 96 * 80;
    assert_memory_equal(march_picture(&world, &usual, EFFECT_TWO_SIDED, 3)->rgba, first->rgba,
                        size);
    assert_memory_equal(march_picture(&world, &plain, EFFECT_TWO_SIDED, 2)->rgba, first->rgba,
                        size);
    const struct frame *other = march_picture(&world, &tiles, EFFECT_TWO_SIDED, 2);
    double sum = 0; /* of what differs: a tile's direction stands for its pixels' */
    for (size_t i = 0; i < 4 * 96 * 80; i++)
        sum += fabs((double)other->rgba[i] - first->rgba[i]);
    assert_true(sum / (4 * 96 * 80) < 0.005);
    arena_destroy(world.arena);
}

/* Trees grow smaller than pixels: they cover what they covered, whichever way they are drawn. The
 * ball is nearly opaque: about its disc. Coarse voxels widen it, by less than half of one. */
static void far_ball_check(float far_px)
{
    struct march_options options = usual;
    options.far_px = far_px;
    struct world world = world_of_balls(1, 20000, 0.25);
    struct ready *ready = march_ready(&world, &options, 0, 2);
    world.scene.camera.far_m = 1e6f;
    for (float distance = 300; distance < 20000; distance *= 1.7f) {
        double radius_px = 4 * 40 / tan(0.3) / (sqrt(1.26) * distance), drawn = 0;
        enum { PLACES = 9 };
        for (int k = 0; k < PLACES; k++) { /* in the pixel */
            float shift = distance * 0.0026f, means[2] = {(float)(k % 3), (float)(k / 3)};
            double one[4];
            world_look(&world, 0.1f * distance, 0.5f * distance, distance, shift * means[0],
                       5 + shift * means[1], 0);
            means_of(ready_picture(&world, ready), one);
            drawn += one[3] * 96 * 80 / PLACES;
        }
        double wide = radius_px > 0.4 ? radius_px + 0.3 : radius_px;
        double low = 0.95 * M_PI * radius_px * radius_px, high = 1.05 * M_PI * wide * wide;
        if (!(drawn > low && drawn < high))
            fail_msg("at %g m: %g px, of a disc of %g to %g", (double)distance, drawn, low, high);
    }
    arena_destroy(world.arena);
}

static void test_march__trees_of_a_pixel_and_below_cover_what_they_ought_to(void **state)
{
    (void)state;
    far_ball_check(0);
    far_ball_check(4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_march__a_homogeneous_box_lets_exp_of_its_depth_through_from_any_side),
        cmocka_unit_test(test_march__nothing_hides_nothing_and_opaque_all),
        cmocka_unit_test(test_march__light_of_leaves_is_that_of_quadrature),
        cmocka_unit_test(test_march__every_instruction_set_gives_the_same_bits),
        cmocka_unit_test(test_march__a_ray_gives_the_same_bits_alone_and_among_others),
        cmocka_unit_test(test_march__a_ball_of_leaves_covers_and_shines_as_traced),
        cmocka_unit_test(test_march__a_ball_of_leaves_covers_as_traced_by_every_model),
        cmocka_unit_test(test_march__overlapping_trees_and_one_within_another_cover_as_traced),
        cmocka_unit_test(test_march__thin_slabs_of_overlapping_trees_sum_their_densities),
        cmocka_unit_test(test_march__light_along_each_axis_shines_as_traced),
        cmocka_unit_test(test_march__the_eye_within_a_crown_sees_as_traced),
        cmocka_unit_test(test_march__threads_tiles_and_instruction_sets_change_no_byte),
        cmocka_unit_test(test_march__trees_of_a_pixel_and_below_cover_what_they_ought_to),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
