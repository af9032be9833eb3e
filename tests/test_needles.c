/* The shaders of needles against golden values and against quadrature of what they stand for. */
#include "testing.h"

#include "bake/needles_double.h"
#include "base/random.h"
#include "needles_golden.h"
#include "needles_ways.h"

#include <gsl/gsl_integration.h>
#include <gsl/gsl_sf_expint.h>
#include <gsl/gsl_sf_psi.h>
#include <stdio.h>

static struct needles_sight_double sight_of(const double light[3], const double eye[3], double n)
{
    double l[3], v[3];
    unit(light, l);
    unit(eye, v);
    return needles_sight_of_double(l, v, n, false);
}

static struct needles_sight_double random_sight(struct random *random, double n)
{
    double l[3], v[3];
    random_direction(random, l);
    random_direction(random, v);
    return needles_sight_of_double(l, v, n, false);
}

static double off(double value, double truth)
{
    return fabs(value - truth) / fmax(fabs(truth), 1e-300);
}

/* ---- one needle ---- */

/* The surface's integrals of (1) and (3): over the azimuths where light and eye both are in front.
 */
static void needle_truth(const double axis[3], const struct needles_sight_double *sight,
                         double reflect[2])
{
    double x[3], y[3], other[3] = {fabs(axis[0]) < 0.6, fabs(axis[0]) >= 0.6, 0};
    needles_cross_double(axis, other, y);
    unit(y, y);
    needles_cross_double(y, axis, x);
    const double *l = sight->light, *v = sight->eye;
    double lx = needles_dot_double(l, x), ly = needles_dot_double(l, y);
    double vx = needles_dot_double(v, x), vy = needles_dot_double(v, y);
    double from_l = atan2(ly, lx), turn = remainder(atan2(vy, vx) - from_l, 2 * PI);
    double from = from_l + fmax(0, turn) - PI / 2, to = from_l + fmin(0, turn) + PI / 2;
    gsl_integration_glfixed_table *table = gsl_integration_glfixed_table_alloc(60);
    reflect[0] = reflect[1] = 0;
    for (size_t i = 0; i < 60; i++) {
        double at, weight;
        gsl_integration_glfixed_point(from, to, i, &at, &weight, table);
        double nl = lx * cos(at) + ly * sin(at), nv = vx * cos(at) + vy * sin(at);
        double h = 0;
        for (int k = 0; k < 3; k++)
            h += sight->half[k] * (x[k] * cos(at) + y[k] * sin(at));
        reflect[0] += weight * nl * nv / (2 * hypot(vx, vy));
        reflect[1] += weight * pow(fmax(h, 0), sight->exponent) * nv / (2 * hypot(vx, vy));
    }
    gsl_integration_glfixed_table_free(table);
}

static void test_needle__has_the_golden_values(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(golden_g1); i++) {
        const struct golden_g1 *g = &golden_g1[i];
        struct needles_sight_double sight = sight_of(g->light, g->eye, g->exponent);
        double axis[3];
        unit(g->axis, axis);
        struct needles_shine_double shine = needles_reflect_double(axis, &sight);
        assert_true(fabs(shine.seen - g->seen) < 1e-13);
        assert_true(fabs(shine.diffuse - g->diffuse) < 1e-13 + 1e-10 * g->diffuse);
        assert_true(fabs(shine.specular - g->specular) < 0.12 / g->exponent);
        assert_true(g->specular > 1e-10 || shine.specular < 1e-9);
    }
}

static void test_needle__is_the_integral_over_its_surface(void **state)
{
    (void)state;
    static const double exponents[] = {1, 5, 10, 20, 50};
    static const double most[] = {0.026, 0.020, 0.011, 0.0055, 0.0022};
    static const double mean[] = {0.015, 0.012, 0.0055, 0.0016, 0.0003};
    struct random random = random_seed(1, 0);
    for (size_t e = 0; e < COUNT(exponents); e++) {
        double error = 0, sum = 0;
        for (int i = 0; i < 1500; i++) {
            double axis[3], truth[2];
            random_direction(&random, axis);
            struct needles_sight_double sight = random_sight(&random, exponents[e]);
            struct needles_shine_double shine = needles_reflect_double(axis, &sight);
            needle_truth(axis, &sight, truth);
            assert_true(fabs(shine.diffuse - truth[0]) < 1e-10);
            assert_true(fabs(shine.specular - truth[1]) < 1.1 * most[e]);
            error += fabs(shine.specular - truth[1]);
            sum += truth[1];
        }
        assert_true(error / sum < 1.2 * mean[e]);
    }
}

static void test_needle__of_two_sides_is_lit_from_both(void **state)
{
    (void)state;
    struct random random = random_seed(2, 0);
    for (int i = 0; i < 200; i++) {
        double axis[3], truth[2], back[2];
        random_direction(&random, axis);
        struct needles_sight_double sight = random_sight(&random, -1);
        double away[3] = {-sight.light[0], -sight.light[1], -sight.light[2]};
        struct needles_sight_double other = needles_sight_of_double(away, sight.eye, -1, false);
        needle_truth(axis, &sight, truth);
        needle_truth(axis, &other, back);
        sight.two_sided = true;
        struct needles_shine_double shine = needles_reflect_double(axis, &sight);
        assert_true(fabs(shine.diffuse - truth[0] - back[0]) < 1e-10);
        assert_true(shine.specular == 0);
    }
}

static void test_needle__seen_along_its_axis_shows_its_end(void **state)
{
    (void)state;
    const double axis[3] = {0, 0, 1}, eye[3] = {0, 0, 1}, light[3] = {0.6, 0, 0.8};
    struct needles_sight_double sight = needles_sight_of_double(light, eye, 20, false);
    struct needles_shade_double shade =
        needles_needle_shade_double(axis, 0.02, 0.0005, &sight, 1e-6);
    assert_true(off(shade.opacity, PI * 0.25) < 1e-12);
    assert_true(off(shade.diffuse, 0.8) < 1e-12);
    const double side[3] = {1, 0, 0};
    sight = needles_sight_of_double(side, side, 20, false);
    shade = needles_needle_shade_double(axis, 0.02, 0.0005, &sight, 1e-4);
    assert_true(off(shade.opacity, 0.2) < 1e-12);
    assert_true(off(shade.diffuse, PI / 4) < 1e-12);
}

/* ---- a cone ---- */

struct cone_part {
    double sine, cosine;
    const struct needles_sight_double *sight;
    int back, what;
};

static double cone_integrand(double step, void *data)
{
    const struct cone_part *part = data;
    double axis[3], truth[2];
    needles_axis_double(part->sine, part->cosine, part->sight->eye, step, part->back, axis);
    double across[3];
    needles_cross_double(axis, part->sight->eye, across);
    double seen = sqrt(needles_dot_double(across, across));
    if (part->what == 0)
        return seen;
    if (part->what == 1)
        return seen * needles_reflect_double(axis, part->sight).diffuse;
    needle_truth(axis, part->sight, truth);
    return seen * truth[1];
}

/* Of one half, by 24 nodes on both its quarters. */
static double cone_truth(struct cone_part *part)
{
    gsl_integration_glfixed_table *table = gsl_integration_glfixed_table_alloc(24);
    gsl_function function = {cone_integrand, part};
    double sum = gsl_integration_glfixed(&function, -PI / 2, 0, table) +
                 gsl_integration_glfixed(&function, 0, PI / 2, table);
    gsl_integration_glfixed_table_free(table);
    return sum;
}

static void test_cone__has_the_golden_integrals(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(golden_g2); i++) {
        const struct golden_g2 *g = &golden_g2[i];
        const struct golden_g7 *ours = &golden_g7[i];
        struct needles_sight_double sight = sight_of(g->light, g->eye, g->exponent);
        double sine = sin(g->phi * PI / 180), cosine = cos(g->phi * PI / 180);
        struct needles_sums_double sums = needles_cone_sums_double(sine, cosine, &sight);
        struct needles_sums_double fine = {{0, 0}, {0, 0}, {0, 0}};
        for (int panel = 0; panel < 40; panel++)
            needles_cone_panel_double(sine, cosine, &sight, 8, panel / 40.0, (panel + 1) / 40.0,
                                      &fine);
        assert_true(ours->number == (double)i + 1);
        assert_true(off(sums.specular[0], ours->specular) < 1e-9);
        for (int half = 0; half < 2; half++) {
            assert_true(off(sums.seen[half], ours->seen[half]) < 1e-12);
            assert_true(off(sums.diffuse[half], ours->diffuse[half]) < 1e-12);
            assert_true(off(sums.seen[half], g->seen[half]) < 1e-2);
            assert_true(fabs(sums.diffuse[half] - g->diffuse[half]) < 0.042);
            assert_true(off(fine.seen[half], g->seen[half]) < 2e-6);
            assert_true(off(fine.diffuse[half], g->diffuse[half]) < 5e-6);
            assert_true(fabs(fine.specular[half] - g->specular[half]) <
                        0.035 * g->specular[half] + 3e-5);
        }
    }
}

static void test_cone__is_the_sum_of_its_needles(void **state)
{
    (void)state;
    struct random random = random_seed(3, 0);
    double error[3] = {0, 0, 0}, sum[3] = {0, 0, 0};
    for (int i = 0; i < 250; i++) {
        double phi = (10 + 75 * random_double(&random)) * PI / 180, n = i & 1 ? 10 : 20;
        struct needles_sight_double sight = random_sight(&random, n);
        struct needles_sums_double sums = needles_cone_sums_double(sin(phi), cos(phi), &sight);
        for (int k = 0; k < 6; k++) {
            struct cone_part part = {sin(phi), cos(phi), &sight, k & 1, k / 2};
            double truth = cone_truth(&part);
            double value = (k < 2 ? sums.seen : k < 4 ? sums.diffuse : sums.specular)[k & 1];
            error[k / 2] += fabs(value - truth);
            sum[k / 2] += truth;
            assert_true(fabs(value - truth) < (k < 2   ? 0.0105 * truth + 1e-6
                                               : k < 4 ? 0.05
                                                       : 0.06));
        }
    }
    assert_true(error[0] / sum[0] < 0.004);
    assert_true(error[1] / sum[1] < 0.009);
    assert_true(error[2] / sum[2] < 0.015);
}

static void test_cover__has_the_golden_sheets(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(golden_g3); i++) {
        const struct golden_g3 *g = &golden_g3[i];
        for (int mirror = 0; mirror < 2; mirror++) {
            double phi = g->phi * PI / 180, phi_eye = g->phi_eye * PI / 180;
            double eye[3] = {sin(phi_eye), 0, mirror ? -cos(phi_eye) : cos(phi_eye)};
            struct needles_twig_double twig =
                needles_twig_of_double(mirror ? PI - phi : phi, g->q * PI / 0.001, 1, 0.001, 1);
            struct needles_cover_double cover = needles_cone_cover_double(&twig, eye);
            assert_true(fabs(cover.limit_rad - g->limit) < 1e-7);
            for (int sheet = 0; sheet < 2; sheet++) {
                assert_true(fabs(cover.footprint[sheet] - g->footprint[sheet]) < 1e-9);
                assert_true(fabs(cover.area[sheet] - g->area[sheet]) < 5e-5);
            }
            assert_true(off(cover.random, g->random) < 2e-4);
            assert_true(off(cover.regular, g->regular) < 2e-4);
        }
    }
}

/* ---- opacities ---- */

static void test_opacities__have_the_golden_values(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(golden_g4); i++) {
        const struct golden_g4 *g = &golden_g4[i];
        assert_true(off(needles_disc_opacity_double(g->depth), g->disc) < 2e-7);
        assert_true(off(needles_radial_opacity_double(g->depth), g->radial) < 2e-6);
        assert_true(off(needles_sheet_opacity_double(g->depth), g->sheet) < 1e-9);
    }
}

static double disc_integrand(double t, void *depth)
{
    return -expm1(-*(double *)depth * cos(t)) * cos(t);
}

static void test_opacities__hold_from_a_millionth_to_a_hundred(void **state)
{
    (void)state;
    gsl_integration_workspace *workspace = gsl_integration_workspace_alloc(200);
    for (double depth = 1e-6; depth <= 100; depth *= 1.1) {
        double disc, error;
        gsl_function function = {disc_integrand, &depth};
        gsl_integration_qag(&function, 0, PI / 2, 0, 1e-12, 200, GSL_INTEG_GAUSS61, workspace,
                            &disc, &error);
        double radial = depth / 4 * (gsl_sf_psi(depth / 8 + 0.75) - gsl_sf_psi(depth / 8 + 0.25));
        assert_true(off(needles_disc_opacity_double(depth), disc) < (depth < 10 ? 2e-7 : 1.4e-4));
        assert_true(off(needles_radial_opacity_double(depth), radial) < 2e-6);
        if (depth > 1e-2)
            assert_true(off(needles_sheet_opacity_double(depth),
                            1 - 2 * gsl_sf_expint_En(3, depth / 2)) < 1e-9);
        else
            assert_true(off(needles_sheet_opacity_double(depth), depth) < 0.04);
    }
    gsl_integration_workspace_free(workspace);
}

/* ---- a twig ---- */

static void test_twig__crosses_as_many_needles_as_the_golden_counts(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(golden_g5); i++) {
        const struct golden_g5 *g = &golden_g5[i];
        double phi = g->phi * PI / 180, phi_eye = g->phi_eye * PI / 180, depths[2], alpha[2];
        double eye[3] = {sin(phi_eye), 0, cos(phi_eye)}, r = 1e-4;
        /* 2 N r/(pi dh) = 1: the depth is K. a K = pi/4 K. */
        struct needles_twig_double twig = needles_twig_of_double(phi, 20, 0.02, r, 2 * 20 * r / PI);
        needles_twig_depths_double(&twig, eye, depths);
        assert_true(off(depths[0], g->k_front) < 1e-2);
        assert_true(off(depths[1], g->k_rear) < 1e-2);
        /* As much as all needles together: a(K_F + K_R) = cone area/(2 R dh sin). */
        struct cone_part part = {sin(phi), cos(phi), NULL, 0, 0};
        struct needles_sight_double sight = needles_sight_of_double(eye, eye, -1, false);
        part.sight = &sight;
        double area = cone_truth(&part);
        part.back = 1;
        area = (area + cone_truth(&part)) * 20 * r * 0.02 / PI;
        assert_true(off(PI / 4 * (depths[0] + depths[1]),
                        area / (2 * twig.reach_m * twig.spacing_m * sin(phi_eye))) < 1e-2);
        needles_paper_opacities_double(&twig, eye, alpha);
        assert_true(fabs(alpha[0] - fmin(PI / 4 * g->k, 1)) < 1e-12);
        assert_true(fabs(alpha[1] - fmin(PI / 4 * g->k_bar, 1)) < 1e-12);
    }
}

static void test_disc__has_the_golden_values(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(golden_g6); i++) {
        const struct golden_g6 *g = &golden_g6[i];
        struct needles_disc_double disc = {
            {g->eye[0], g->eye[1]}, {g->light[0], g->light[1]}, cos(g->angle), sin(g->angle)};
        struct needles_lit_double lit = needles_disc_lit_double(&disc);
        double alpha_eye[2], alpha_light[2], linear[2];
        for (int half = 0; half < 2; half++) {
            assert_true(off(lit.lit[half], golden_g8[i].lit[half]) < 1e-9);
            assert_true(fabs(lit.lit[half] - g->lit[half]) < 0.045 * g->lit[half] + 1e-3);
            alpha_eye[half] = PI / 4 * g->eye[half];
            alpha_light[half] = PI / 4 * g->light[half];
        }
        needles_paper_lit_double(alpha_eye, alpha_light, cos(g->angle), linear);
        assert_true(off(linear[0], g->linear[0]) < 1e-8);
        assert_true(off(linear[1], g->linear[1]) < 1e-8);
    }
    assert_true(golden_g8[10].number == 11);
}

/* Where light and eye are in line, or there is no shadow, the disc has closed forms. */
static void test_disc__has_its_closed_forms_in_line(void **state)
{
    (void)state;
    struct random random = random_seed(4, 0);
    double (*const a)(double) = needles_disc_opacity_double;
    for (int i = 0; i < 300; i++) {
        double t1 = 2 * random_double(&random), t2 = 2 * random_double(&random);
        double s1 = 2 * random_double(&random), s2 = t1 + 0.1 + random_double(&random);
        struct needles_disc_double disc = {{t1, t2}, {0, 0}, 1, 0};
        struct needles_lit_double lit = needles_disc_lit_double(&disc);
        assert_true(fabs(lit.lit[0] + lit.lit[1] - a(t1 + t2)) < 2e-4);
        disc.light[0] = s1, disc.light[1] = s2;
        lit = needles_disc_lit_double(&disc);
        assert_true(fabs(lit.lit[0] - t1 / (t1 + s1) * a(t1 + s1)) < 2e-3);
        assert_true(fabs(lit.lit[1] - t2 / (t2 + s2) * (a(t1 + s1 + t2 + s2) - a(t1 + s1))) < 2e-3);
        disc.cosine = -1;
        lit = needles_disc_lit_double(&disc);
        assert_true(fabs(lit.lit[0] - t1 / (s2 - t1) * (a(s1 + s2) - a(t1 + s1))) < 3e-3);
    }
}

/* One line of sight, a place after the other: (14) by brute force. */
static void disc_truth(const struct needles_disc_double *disc, double lit[2])
{
    const int lines = 400, places = 400;
    lit[0] = lit[1] = 0;
    for (int i = 0; i < lines; i++) {
        double x = -1 + (i + 0.5) * 2 / lines, edge = sqrt(1 - x * x), step = 2 * edge / places;
        double depth = 0;
        for (int j = 0; j < places; j++) {
            double w = edge - (j + 0.5) * step, rate = disc->eye[w < 0];
            double along = w * disc->cosine + x * disc->sine;
            double across = x * disc->cosine - w * disc->sine;
            double top = sqrt(fmax(1 - across * across, 0));
            double shade = along >= 0 ? disc->light[0] * (top - along)
                                      : disc->light[0] * top - disc->light[1] * along;
            lit[w < 0] += 1.0 / lines * exp(-depth - shade) * -expm1(-rate * step);
            depth += rate * step;
        }
    }
}

static void test_disc__is_the_volume_integral(void **state)
{
    (void)state;
    struct random random = random_seed(5, 0);
    static const double ranges[] = {1, 2, 5}, mean[] = {0.003, 0.008, 0.025};
    for (size_t range = 0; range < COUNT(ranges); range++) {
        double error[2] = {0, 0}, sum[2] = {0, 0};
        for (int i = 0; i < 40; i++) {
            double angle = PI * random_double(&random), truth[2];
            struct needles_disc_double disc = {{0, 0}, {0, 0}, cos(angle), sin(angle)};
            for (int half = 0; half < 2; half++) {
                disc.eye[half] = ranges[range] * random_double(&random);
                disc.light[half] = ranges[range] * random_double(&random);
            }
            struct needles_lit_double lit = needles_disc_lit_double(&disc);
            disc_truth(&disc, truth);
            for (int half = 0; half < 2; half++) {
                error[half] += fabs(lit.lit[half] - truth[half]);
                sum[half] += truth[half];
            }
        }
        assert_true(error[0] / sum[0] < mean[range]);
        assert_true(error[1] / sum[1] < mean[range]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_needle__has_the_golden_values),
        cmocka_unit_test(test_needle__is_the_integral_over_its_surface),
        cmocka_unit_test(test_needle__of_two_sides_is_lit_from_both),
        cmocka_unit_test(test_needle__seen_along_its_axis_shows_its_end),
        cmocka_unit_test(test_cone__has_the_golden_integrals),
        cmocka_unit_test(test_cone__is_the_sum_of_its_needles),
        cmocka_unit_test(test_cover__has_the_golden_sheets),
        cmocka_unit_test(test_opacities__have_the_golden_values),
        cmocka_unit_test(test_opacities__hold_from_a_millionth_to_a_hundred),
        cmocka_unit_test(test_twig__crosses_as_many_needles_as_the_golden_counts),
        cmocka_unit_test(test_disc__has_the_golden_values),
        cmocka_unit_test(test_disc__has_its_closed_forms_in_line),
        cmocka_unit_test(test_disc__is_the_volume_integral),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
