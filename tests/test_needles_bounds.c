/* The shaders of needles where numbers are in danger: along axes, against the light, at the ends of
 * angles, densities and exponents; finite, never negative, never more than light came, in float as
 * in double. */
#include "testing.h"

#include "bake/needles.h"
#include "bake/needles_double.h"
#include "base/random.h"

#define PI 3.14159265358979324
#define COUNT(array) (sizeof(array) / sizeof *(array))

static const double angles[] = {0,      1e-7, 1e-4, 0.01,      0.5, PI / 4, 1, PI / 2 - 1e-4,
                                PI / 2, 2,    3,    PI - 1e-4, PI};
static const double exponents[] = {-1, 0, 1, 10, 100, 10000};

static void direction_of(double polar, double turn, float out[3])
{
    out[0] = (float)(sin(polar) * cos(turn)), out[1] = (float)(sin(polar) * sin(turn));
    out[2] = (float)cos(polar);
}

static void in_range(float value, float most)
{
    assert_true(isfinite(value));
    assert_true(value >= 0);
    assert_true(value <= most * 1.00001f);
}

static void shade_in_range(const struct needles_shade *shade)
{
    in_range(shade->opacity, 1);
    in_range(shade->diffuse, 1);
    in_range(shade->specular, 1);
}

/* Everything of one needle angle, at one density, in one light, exact and as printed. */
static void check_all(double phi, float density, const struct needles_sight *sight)
{
    const float spacing = 2 * 16 * 0.01f / ((float)PI * density);
    struct needles_twig twig = needles_twig_of((float)phi, 16, 0.02f, 0.0002f, spacing * 0.02f);
    for (int regular = 0; regular < 2; regular++) {
        struct needles_twig_shade shade = needles_twig_shade(&twig, sight, regular);
        struct needles_cone_shade cone = needles_cone_shade(&twig, sight, regular, 1e-4f);
        shade_in_range(&shade.all);
        shade_in_range(&cone.all);
        in_range(shade.halves[0].opacity + shade.halves[1].opacity, shade.all.opacity);
        for (int half = 0; half < 2; half++) {
            shade_in_range(&shade.halves[half]);
            shade_in_range(&cone.halves[half]);
        }
    }
    struct needles_twig_shade paper = needles_paper_twig_shade(&twig, sight);
    struct needles_cone_shade cone = needles_paper_cone_shade(&twig, sight, 1e-4f);
    shade_in_range(&paper.all);
    shade_in_range(&cone.all);
}

static void test_shaders__stay_in_range_at_every_end(void **state)
{
    (void)state;
    static const float densities[] = {1e-6f, 0.3f, 100};
    for (size_t i = 0; i < COUNT(angles); i++)
        for (size_t j = 0; j < COUNT(angles); j++)
            for (int k = 0; k < 7; k++) {
                /* light: along the eye, against it, along the twig, aside, nearly one of them */
                float eye[3], light[3];
                double n = exponents[(i + j + (size_t)k) % COUNT(exponents)];
                direction_of(angles[i], 1, eye);
                direction_of(k < 2    ? angles[i]
                             : k == 2 ? 0
                                      : angles[(size_t)k * 2],
                             k < 2 ? 1 : 0.3 + k, light);
                for (int c = 0; c < 3; c++)
                    light[c] = k == 1 ? -eye[c] : light[c];
                struct needles_sight sight = needles_sight_of(light, eye, (float)n, k & 1);
                for (size_t d = 0; d < COUNT(densities); d++)
                    check_all(fmin(angles[j], PI), densities[d], &sight);
                float axis[3];
                direction_of(angles[j], 1, axis);
                struct needles_shade needle =
                    needles_needle_shade(axis, 0.02f, 0.0002f, &sight, 1e-6f);
                struct needles_shine paper = needles_paper_reflect(axis, &sight);
                shade_in_range(&needle);
                in_range(paper.diffuse, k & 1 ? 1 : (float)PI / 4);
                in_range(paper.specular, 1);
            }
}

/* Largest difference of what is seen and lit of a needle and of a twig, in float and in double. */
static double rounding_of(const float axis[3], float phi, float density, const float light[3],
                          const float eye[3], float exponent)
{
    double a[3], l[3], e[3], most = 0;
    for (int c = 0; c < 3; c++)
        a[c] = (double)axis[c], l[c] = (double)light[c], e[c] = (double)eye[c];
    const float spacing = 2 * 16 * 0.01f / ((float)PI * density) * 0.02f;
    const struct needles_twig twig = needles_twig_of(phi, 16, 0.02f, 0.0002f, spacing);
    const struct needles_twig_double twig_double =
        needles_twig_of_double((double)phi, 16, (double)0.02f, (double)0.0002f, (double)spacing);
    const struct needles_sight sight = needles_sight_of(light, eye, exponent, false);
    const struct needles_sight_double sight_double =
        needles_sight_of_double(l, e, (double)exponent, false);
    const struct needles_shade needle = needles_needle_shade(axis, 0.02f, 0.0002f, &sight, 1e-4f);
    const struct needles_shade_double needle_double = needles_needle_shade_double(
        a, (double)0.02f, (double)0.0002f, &sight_double, (double)1e-4f);
    const struct needles_twig_shade whole = needles_twig_shade(&twig, &sight, false);
    const struct needles_twig_shade_double whole_double =
        needles_twig_shade_double(&twig_double, &sight_double, false);
    const double differences[] = {
        (double)needle.opacity - needle_double.opacity,
        (double)needle.diffuse - needle_double.diffuse,
        (double)needle.specular - needle_double.specular,
        (double)whole.all.opacity - whole_double.all.opacity,
        (double)whole.all.diffuse - whole_double.all.diffuse,
        (double)whole.all.specular - whole_double.all.specular,
    };
    for (size_t k = 0; k < COUNT(differences); k++)
        most = fmax(most, isfinite(differences[k]) ? fabs(differences[k]) : INFINITY);
    return most;
}

/* A needle along the eye or the light, light from behind or before, rays along the twig, needles
 * along it and across it, thin and thick ones, lobes of every width. */
static void test_shaders__at_every_end_are_in_float_as_in_double(void **state)
{
    (void)state;
    static const float phis[] = {0, 1e-4f, 0.7f, (float)(PI / 2)};
    static const float densities[] = {1e-6f, 0.3f, 100};
    for (size_t i = 0; i < COUNT(angles); i++)
        for (size_t j = 0; j < COUNT(phis); j++)
            for (int k = 0; k < 4; k++)
                for (size_t n = 0; n < COUNT(exponents); n++) {
                    float eye[3], light[3], axis[3];
                    direction_of(angles[i], 1, eye);
                    direction_of(angles[COUNT(angles) - 1 - i], 1.3, light);
                    direction_of(0.4, 0.2, axis);
                    for (int c = 0; c < 3; c++) {
                        light[c] = k == 1 ? -eye[c] : k == 2 ? eye[c] : light[c];
                        axis[c] = j == 0 ? eye[c] : j == 1 ? light[c] : axis[c];
                    }
                    const double most = rounding_of(axis, phis[j], densities[(i + n) % 3], light,
                                                    eye, (float)exponents[n]);
                    if (!(most < 0.01)) /* 0.005 along dense twigs */
                        fail_msg("eye at %g, phi %g, light %d, exponent %g: float is off by %.3g",
                                 angles[i], (double)phis[j], k, exponents[n], most);
                }
}

/* A highlight that passes through the caustic, where the paper's line of needles square to H ends.
 */
static void test_cone__shines_without_a_jump_through_the_caustic(void **state)
{
    (void)state;
    float last[2] = {0, 0}, most = 0;
    for (int i = 0; i <= 2000; i++) {
        float eye[3], light[3];
        direction_of(0.2 + 2.7 * i / 2000, 0, eye);
        direction_of(1.1, 0.2, light);
        struct needles_sight sight = needles_sight_of(light, eye, 50, false);
        struct needles_sums sums = needles_cone_sums(sinf(0.6f), cosf(0.6f), &sight);
        for (int half = 0; half < 2; half++) {
            assert_true(sums.specular[half] >= 0 && sums.specular[half] <= sums.seen[half]);
            most = fmaxf(most, sums.specular[half]);
            assert_true(i == 0 || fabsf(sums.specular[half] - last[half]) < 0.01f);
            last[half] = sums.specular[half];
        }
    }
    assert_true(most > 0.05f); /* it was there */
}

static void turn_a_little(const float from[3], float step, struct random *random, float to[3])
{
    float length = 0;
    for (int i = 0; i < 3; i++) {
        to[i] = from[i] + step * (random_float(random) - 0.5f);
        length += to[i] * to[i];
    }
    for (int i = 0; i < 3; i++)
        to[i] /= sqrtf(length);
}

static void random_direction(struct random *random, double least, float out[3])
{
    direction_of(acos((2 * random_double(random) - 1) * cos(least)), 7 * random_double(random),
                 out);
}

static void test_twig__changes_little_where_little_changes(void **state)
{
    (void)state;
    struct random random = random_seed(1, 1);
    for (int i = 0; i < 2000; i++) {
        float eye[3], light[3], near_eye[3], near_light[3];
        random_direction(&random, 0.1, eye);
        random_direction(&random, 0.1, light);
        turn_a_little(eye, 1e-4f, &random, near_eye);
        turn_a_little(light, 1e-4f, &random, near_light);
        float phi = 0.02f + 1.5f * random_float(&random);
        struct needles_twig twig = needles_twig_of(phi, 16, 1, 0.01f, 0.3f);
        struct needles_twig close = needles_twig_of(phi + 1e-5f, 16, 1, 0.01f, 0.3f);
        struct needles_sight a = needles_sight_of(light, eye, 30, false);
        struct needles_sight b = needles_sight_of(near_light, near_eye, 30, false);
        struct needles_twig_shade one = needles_twig_shade(&twig, &a, i & 1);
        struct needles_twig_shade two = needles_twig_shade(&close, &b, i & 1);
        assert_true(fabsf(one.all.opacity - two.all.opacity) < 2e-3f);
        assert_true(fabsf(one.all.diffuse - two.all.diffuse) < 4e-3f);
        assert_true(fabsf(one.all.specular - two.all.specular) < 4e-3f);
    }
}

static void test_twig__in_float_is_as_in_double(void **state)
{
    (void)state;
    struct random random = random_seed(2, 2);
    for (int i = 0; i < 3000; i++) {
        float eye[3], light[3];
        random_direction(&random, 1e-3, eye);
        random_direction(&random, 1e-3, light);
        if (i % 5 == 0)
            turn_a_little((float[3]){-eye[0], -eye[1], -eye[2]}, 1e-3f, &random, light);
        double e[3], l[3], n = pow(10, 2 * random_double(&random));
        for (int c = 0; c < 3; c++)
            e[c] = (double)eye[c], l[c] = (double)light[c];
        float phi = 1.5f * random_float(&random), spacing = powf(10, -3 * random_float(&random));
        struct needles_twig twig = needles_twig_of(phi, 16, 1, 0.01f, spacing);
        struct needles_sight sight = needles_sight_of(light, eye, (float)n, false);
        struct needles_twig_double twig_double =
            needles_twig_of_double((double)phi, 16, 1, (double)0.01f, (double)spacing);
        struct needles_sight_double sight_double =
            needles_sight_of_double(l, e, (double)(float)n, false);
        struct needles_twig_shade a = needles_twig_shade(&twig, &sight, i & 1);
        struct needles_twig_shade_double b =
            needles_twig_shade_double(&twig_double, &sight_double, i & 1);
        assert_true(fabs((double)a.all.opacity - b.all.opacity) < 1e-5);
        assert_true(fabs((double)a.all.diffuse - b.all.diffuse) < 5e-4);
        assert_true(fabs((double)a.all.specular - b.all.specular) < 5e-4);
    }
}

/* Few needles: a twig is its cones; with more, shadows only take. */
static void test_twig__of_few_needles_is_as_its_cones_and_more_only_shade(void **state)
{
    (void)state;
    struct random random = random_seed(3, 3);
    for (int i = 0; i < 500; i++) {
        float eye[3], light[3];
        random_direction(&random, 0.2, eye);
        random_direction(&random, 0.2, light);
        struct needles_sight sight = needles_sight_of(light, eye, 20, false);
        struct needles_twig thin = needles_twig_of(0.8f, 16, 1, 0.01f, 1e4f);
        struct needles_twig thick = needles_twig_of(0.8f, 16, 1, 0.01f, 0.1f);
        struct needles_cone_shade cone = needles_cone_shade(&thin, &sight, true, 1e4f);
        struct needles_twig_shade bare = needles_twig_shade(&thin, &sight, false);
        struct needles_twig_shade full = needles_twig_shade(&thick, &sight, false);
        assert_true(fabsf(bare.all.diffuse - cone.all.diffuse) < 1e-3f);
        assert_true(full.halves[0].diffuse <= cone.halves[0].diffuse * 1.0001f);
        assert_true(full.halves[1].diffuse <= cone.halves[1].diffuse * 1.0001f);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shaders__stay_in_range_at_every_end),
        cmocka_unit_test(test_shaders__at_every_end_are_in_float_as_in_double),
        cmocka_unit_test(test_cone__shines_without_a_jump_through_the_caustic),
        cmocka_unit_test(test_twig__changes_little_where_little_changes),
        cmocka_unit_test(test_twig__in_float_is_as_in_double),
        cmocka_unit_test(test_twig__of_few_needles_is_as_its_cones_and_more_only_shade),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
