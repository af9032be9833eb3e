/* The shaders of cones and twigs against rays cast at needles that are cylinders, sparse and dense.
 */
#include "testing.h"

#include "bake/needles.h"
#include "base/random.h"
#include "wall/embree.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define PI 3.14159265358979324f

typedef float point[3];
typedef uint32_t triple[3];

enum { SIDES = 12, TRIANGLES = 2 * SIDES };

/* Needles in the twig's frame, their cylinders as prisms of the same mean outline. */
struct forest {
    struct arena *arena;
    struct embree *embree;
    size_t count;
    point *bases, *axes;
    float length, radius;
};

static void needle_corners(const struct forest *forest, size_t needle, point *corners)
{
    const float *a = forest->axes[needle], other[3] = {fabsf(a[0]) < 0.6f, fabsf(a[0]) >= 0.6f, 0};
    float x[3], y[3];
    needles_cross(a, other, y);
    float length = sqrtf(needles_dot(y, y)), around = PI / SIDES;
    for (int i = 0; i < 3; i++)
        y[i] /= length;
    needles_cross(y, a, x);
    for (int corner = 0; corner < 2 * SIDES; corner++) {
        float turn = 2 * around * (float)(corner / 2),
              wide = forest->radius * around / sinf(around);
        for (int i = 0; i < 3; i++)
            corners[corner][i] = forest->bases[needle][i] +
                                 (corner & 1 ? forest->length * a[i] : 0) +
                                 wide * (cosf(turn) * x[i] + sinf(turn) * y[i]);
    }
}

static void forest_build(struct forest *forest)
{
    size_t vertices = forest->count * 2 * SIDES;
    point *positions = ARENA_ARRAY(forest->arena, point, vertices);
    triple *triangles = ARENA_ARRAY(forest->arena, triple, forest->count * TRIANGLES);
    for (size_t n = 0; n < forest->count; n++) {
        needle_corners(forest, n, positions + n * 2 * SIDES);
        for (uint32_t side = 0; side < SIDES; side++) {
            uint32_t first = (uint32_t)n * 2 * SIDES, a = first + 2 * side;
            uint32_t b = first + 2 * ((side + 1) % SIDES);
            memcpy(triangles[n * TRIANGLES + 2 * side], (triple){a, a + 1, b}, sizeof *triangles);
            memcpy(triangles[n * TRIANGLES + 2 * side + 1], (triple){b, a + 1, b + 1},
                   sizeof *triangles);
        }
    }
    struct embree_part part = {0, (uint32_t)(forest->count * TRIANGLES), NULL, NULL};
    struct embree_mesh mesh = {*positions, vertices, *triangles, forest->count * TRIANGLES,
                               &part,      1};
    const float place[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    struct error error = {0};
    assert_int_equal(embree_create(forest->arena, 1, &forest->embree, &error), STATUS_OK);
    assert_int_equal(embree_add_mesh(forest->embree, &mesh, &error), STATUS_OK);
    embree_add_instance(forest->embree, 0, place);
    assert_int_equal(embree_commit(forest->embree, &error), STATUS_OK);
}

/* Cones from `from` on, `cones` of them; regular: needles at even azimuths from one point. */
static struct forest *forest_grow(struct random *random, const struct needles_twig *twig, int cones,
                                  float from, bool regular)
{
    struct arena *arena = arena_create(0);
    struct forest *forest = ARENA_ARRAY(arena, struct forest, 1);
    *forest = (struct forest){.arena = arena, .length = twig->length_m, .radius = twig->radius_m};
    forest->bases = ARENA_ARRAY(arena, point, (size_t)cones * (size_t)twig->count);
    forest->axes = ARENA_ARRAY(arena, point, (size_t)cones * (size_t)twig->count);
    for (int cone = 0; cone < cones; cone++) {
        float phase = random_float(random);
        for (int n = 0; n < (int)twig->count; n++) {
            float turn = 2 * PI * (regular ? phase + (float)n / twig->count : random_float(random));
            float jitter = regular || cones == 1 ? 0 : random_float(random);
            float *axis = forest->axes[forest->count];
            axis[0] = twig->sine * cosf(turn), axis[1] = twig->sine * sinf(turn);
            axis[2] = twig->cosine;
            forest->bases[forest->count++][2] = from + twig->spacing_m * ((float)cone + jitter);
        }
    }
    forest_build(forest);
    return forest;
}

static void forest_fell(struct forest *forest)
{
    embree_destroy(forest->embree);
    arena_destroy(forest->arena);
}

/* Sums over rays. */
struct seen {
    double hits, diffuse, lit; /* of N.L, without and with shadows */
};

static void hit_shade(const struct forest *forest, const struct embree_packet *packet, int lane,
                      const float light[3], struct seen *seen)
{
    size_t needle = packet->primitive[lane] / TRIANGLES;
    const float *a = forest->axes[needle], *base = forest->bases[needle];
    float out[3], along = 0, length = 0;
    for (int i = 0; i < 3; i++) {
        out[i] = packet->origin[i][lane] + packet->far[lane] * packet->direction[i][lane] - base[i];
        along += out[i] * a[i];
    }
    for (int i = 0; i < 3; i++) {
        out[i] -= along * a[i];
        length += out[i] * out[i];
    }
    struct embree_packet shadow = {0};
    float facing = 0;
    for (int i = 0; i < 3; i++) {
        float normal = out[i] / sqrtf(length);
        facing += normal * light[i];
        shadow.origin[i][0] = base[i] + along * a[i] + 1.02f * forest->radius * normal;
        shadow.direction[i][0] = light[i];
    }
    seen->hits++;
    if (facing <= 0)
        return;
    shadow.near[0] = 1e-6f, shadow.far[0] = 1e3f;
    seen->diffuse += facing;
    if (!embree_occluded(forest->embree, &shadow, 1))
        seen->lit += facing;
}

/* side x side parallel rays through a parallelogram about the origin. */
static struct seen forest_look(struct random *random, const struct forest *forest, int side,
                               const float edges[2][3], const struct needles_sight *sight)
{
    struct seen seen = {0, 0, 0};
    for (int first = 0; first < side * side; first += EMBREE_LANES) {
        struct embree_packet packet = {0};
        int count = side * side - first < EMBREE_LANES ? side * side - first : EMBREE_LANES;
        for (int lane = 0; lane < count; lane++) {
            int ray = first + lane;
            float u = ((float)(ray % side) + random_float(random)) / (float)side - 0.5f;
            float v = ((float)(ray / side) + random_float(random)) / (float)side - 0.5f;
            for (int i = 0; i < 3; i++) {
                packet.origin[i][lane] = u * edges[0][i] + v * edges[1][i] + 50 * sight->eye[i];
                packet.direction[i][lane] = -sight->eye[i];
            }
            packet.far[lane] = 1e3f;
        }
        embree_intersect(forest->embree, &packet, count, false);
        for (int lane = 0; lane < count; lane++)
            if (packet.geometry[lane] != EMBREE_NONE)
                hit_shade(forest, &packet, lane, sight->light, &seen);
    }
    double rays = side * side;
    return (struct seen){seen.hits / rays, seen.diffuse / rays, seen.lit / rays};
}

/* At least `least` rad from the twig. */
static void random_direction(struct random *random, float least, float out[3])
{
    float z = (2 * random_float(random) - 1) * cosf(least), turn = 2 * PI * random_float(random);
    float flat = sqrtf(1 - z * z);
    out[0] = flat * cosf(turn), out[1] = flat * sinf(turn), out[2] = z;
}

static struct needles_sight random_sight(struct random *random, float least)
{
    float light[3], eye[3];
    random_direction(random, least, light);
    random_direction(random, least, eye);
    return needles_sight_of(light, eye, -1, false);
}

/* ---- cones ---- */

/* Mean relative errors over some cones: of what they cover, of their brightness. */
static void cones_compare(uint64_t seed, bool regular, int needles, float radius, double errors[2])
{
    const int cones = 10, turns = 6;
    struct random random = random_seed(seed, (uint64_t)needles);
    double off[2] = {0, 0}, all[2] = {0, 0};
    for (int i = 0; i < cones; i++) {
        struct needles_twig twig = needles_twig_of((15 + 65 * random_float(&random)) * PI / 180,
                                                   (float)needles, 1, radius, 1);
        struct needles_sight sight = random_sight(&random, 0.1f);
        struct needles_cone_shade shade = needles_cone_shade(&twig, &sight, regular, 1);
        float up[3] = {0, 0, 1}, edges[2][3];
        needles_cross(up, sight.eye, edges[0]);
        float length = sqrtf(needles_dot(edges[0], edges[0]));
        for (int k = 0; k < 3; k++)
            edges[0][k] *= 2.1f / length;
        needles_cross(sight.eye, edges[0], edges[1]);
        double covered = 0, bright = 0;
        for (int turn = 0; turn < turns; turn++) {
            struct forest *forest = forest_grow(&random, &twig, 1, 0, regular);
            struct seen seen = forest_look(&random, forest, 64, (const float(*)[3])edges, &sight);
            forest_fell(forest);
            covered += seen.hits * 2.1 * 2.1 / turns;
            bright += seen.diffuse * 2.1 * 2.1 / turns;
        }
        off[0] += fabs(shade.all.opacity - covered);
        off[1] += fabs(shade.all.opacity * shade.all.diffuse - bright);
        all[0] += covered, all[1] += bright;
    }
    errors[0] = off[0] / all[0], errors[1] = off[1] / all[1];
    print_message("%d needles of r/l %g, %s: cover %.3f, brightness %.3f\n", needles,
                  (double)radius, regular ? "regular" : "random", errors[0], errors[1]);
}

static void test_cone__covers_what_rays_meet(void **state)
{
    (void)state;
    static const struct {
        int needles;
        float radius;
    } cones[] = {{8, 0.005f}, {16, 0.01f}, {24, 0.02f}};
    for (size_t i = 0; i < sizeof cones / sizeof *cones; i++)
        for (int regular = 0; regular < 2; regular++) {
            double errors[2];
            cones_compare(1, regular, cones[i].needles, cones[i].radius, errors);
            assert_true(errors[0] < 0.08);
            assert_true(errors[1] < (regular ? 0.15 : 0.2)); /* few azimuths: noise */
        }
}

/* ---- twigs ---- */

/* Mean and largest relative errors over some twigs of one density: of opacity [0] and light [1]; of
 * the exact form and of the paper's. */
struct gaps {
    double exact[2], most[2], paper[2];
};

/* dh is the paper's, 2 pi R/N of R = 3/4, and r follows; or dh is given. */
static struct gaps twigs_compare(uint64_t seed, float density, float spacing, bool regular)
{
    const int twigs = 10;
    struct random random = random_seed(seed, 7);
    struct gaps gaps = {{0, 0}, {0, 0}, {0, 0}};
    double all[2] = {0, 0};
    for (int i = 0; i < twigs; i++) {
        const float window = ceilf(2 / spacing) * spacing;
        const float radius = PI * density * spacing / 32; /* 2 N r/(pi dh) is the density */
        struct needles_twig twig =
            needles_twig_of((30 + 40 * random_float(&random)) * PI / 180, 16, 1, radius, spacing);
        struct needles_sight sight = random_sight(&random, 0.6f);
        int cones = (int)((window + 12) / spacing);
        struct forest *forest =
            forest_grow(&random, &twig, cones, -0.5f * (float)cones * spacing, regular);
        float edges[2][3] = {{-sight.eye[1], sight.eye[0], 0}, {0, 0, window}};
        float length = sqrtf(needles_dot(edges[0], edges[0]));
        for (int k = 0; k < 3; k++)
            edges[0][k] *= 2 * twig.reach_m / length;
        struct seen seen = forest_look(&random, forest, 100, (const float(*)[3])edges, &sight);
        forest_fell(forest);
        struct needles_twig_shade shade = needles_twig_shade(&twig, &sight, regular);
        struct needles_twig_shade paper = needles_paper_twig_shade(&twig, &sight);
        const double truth[2] = {seen.hits, seen.lit};
        const double exact[2] = {shade.all.opacity, shade.all.opacity * shade.all.diffuse};
        const double printed[2] = {paper.all.opacity, paper.all.opacity * paper.all.diffuse};
        for (int k = 0; k < 2; k++) {
            gaps.exact[k] += fabs(exact[k] - truth[k]);
            gaps.paper[k] += fabs(printed[k] - truth[k]);
            gaps.most[k] = fmax(gaps.most[k], fabs(exact[k] - truth[k]) / fmax(truth[k], 0.02));
            all[k] += truth[k];
        }
    }
    for (int k = 0; k < 2; k++) {
        gaps.exact[k] /= all[k];
        gaps.paper[k] /= all[k];
    }
    print_message("density %g, %s: opacity %.3f (most %.3f, paper %.3f), light %.3f (%.3f, %.3f)\n",
                  (double)density, regular ? "regular" : "random", gaps.exact[0], gaps.most[0],
                  gaps.paper[0], gaps.exact[1], gaps.most[1], gaps.paper[1]);
    return gaps;
}

static const float densities[] = {0.1f, 0.4f, 0.8f};
static const float paper_spacing = 2 * PI * 0.75f / 16;

static void test_twig__of_random_needles_is_as_opaque_and_bright_as_rays_find_it(void **state)
{
    (void)state;
    static const double light[] = {0.1, 0.16, 0.25};
    for (int i = 0; i < 3; i++) {
        struct gaps gaps = twigs_compare(2, densities[i], paper_spacing, false);
        assert_true(gaps.exact[0] < 0.07 && gaps.exact[1] < light[i]);
        assert_true(gaps.paper[1] > 3 * gaps.exact[1]);
        assert_true(i > 0 || gaps.most[1] < 0.3);
    }
}

static void test_twig__of_regular_cones_is_as_opaque_and_bright_as_rays_find_it(void **state)
{
    (void)state;
    static const double light[] = {0.1, 0.17, 0.25};
    for (int i = 0; i < 3; i++) {
        struct gaps gaps = twigs_compare(3, densities[i], paper_spacing, true);
        assert_true(gaps.exact[0] < 0.07 && gaps.exact[1] < light[i]);
        assert_true(gaps.paper[1] > 3 * gaps.exact[1]);
    }
}

/* The sheet's a_I takes needles of one cone for unrelated ones: where cones stand an l apart it
 * finds 12 % more opacity than there is; no twig covers more than its cones one by one. */
static void test_twig__of_cones_far_apart_covers_no_more_than_they_do(void **state)
{
    (void)state;
    struct gaps gaps = twigs_compare(4, 0.1f, 1, true);
    assert_true(gaps.exact[0] < 0.08);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cone__covers_what_rays_meet),
        cmocka_unit_test(test_twig__of_random_needles_is_as_opaque_and_bright_as_rays_find_it),
        cmocka_unit_test(test_twig__of_regular_cones_is_as_opaque_and_bright_as_rays_find_it),
        cmocka_unit_test(test_twig__of_cones_far_apart_covers_no_more_than_they_do),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
