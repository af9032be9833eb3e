/* The shaders of needles as printed: where the corrected golden forms say what they would be, and
 * how far they are from what they stand for. */
#include "testing.h"

#include "bake/needles_double.h"
#include "base/random.h"
#include "needles_golden.h"
#include "needles_ways.h"

#include <string.h>

static struct needles_sight_double golden_sight(const struct golden_g2 *g)
{
    double light[3], eye[3];
    unit(g->light, light);
    unit(g->eye, eye);
    return needles_sight_of_double(light, eye, g->exponent, false);
}

/* (4): s_h^n / 2 cos(alpha_H - alpha_V) sqrt(2 pi / n), clamped. */
static double printed_needle(const double axis[3], const double eye[3], const double half[3],
                             double n)
{
    double h[3], v[3], lengths[2] = {0, 0}, dot = 0;
    for (int i = 0; i < 3; i++) {
        h[i] = half[i] - needles_dot_double(axis, half) * axis[i];
        v[i] = eye[i] - needles_dot_double(axis, eye) * axis[i];
        lengths[0] += h[i] * h[i];
        lengths[1] += v[i] * v[i];
        dot += h[i] * v[i];
    }
    double cosine = lengths[1] > 1e-20 ? dot / sqrt(lengths[0] * lengths[1]) : 0;
    return fmax(0, pow(lengths[0], n / 2) / 2 * cosine * sqrt(2 * PI / n));
}

/* In its own domain, N.H > 0, (4) is off by at most 1.2 / n. */
static void test_printed__needle_shines_as_far_from_the_golden_one_as_is_known(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(golden_g1); i++) {
        const struct golden_g1 *g = &golden_g1[i];
        double light[3], eye[3], axis[3];
        unit(g->light, light);
        unit(g->eye, eye);
        unit(g->axis, axis);
        struct needles_sight_double sight = needles_sight_of_double(light, eye, g->exponent, false);
        struct needles_shine_double shine = needles_paper_reflect_double(axis, &sight);
        assert_true(fabs(shine.diffuse - g->diffuse) < 1e-10);
        assert_true(fabs(shine.specular - printed_needle(axis, eye, sight.half, g->exponent)) <
                    1e-10);
        assert_true(fabs(shine.specular - g->specular_all) <
                    fmin(1.2 / g->exponent, 0.1 * g->specular_all + 0.02));
    }
}

/* Angles of light, eye and needle folded so that larger and smaller one add up to pi at most. */
static void folded(double phi, const double direction[3], double angles[2])
{
    double polar = acos(direction[2]);
    double a = fmax(phi, polar), b = fmin(phi, polar);
    angles[0] = a + b > PI ? PI - b : a;
    angles[1] = a + b > PI ? PI - a : b;
}

/* (11) is the chord of the needles' sines where its angle of the eye is an elevation and the
 * needles' the smaller one. */
static void test_printed__cone_seen_from_an_elevation_is_the_golden_chord(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(golden_g2); i++) {
        double eye[3], angles[2];
        unit(golden_g2[i].eye, eye);
        folded(golden_g2[i].phi * PI / 180, eye, angles);
        const double raised[3] = {fabs(cos(angles[0])), 0, sin(angles[0])};
        struct needles_sight_double sight = needles_sight_of_double(raised, raised, -1, false);
        struct needles_sums_double sums =
            needles_paper_sums_double(sin(angles[1]), cos(angles[1]), &sight);
        int turned = cos(angles[0]) < 0; /* the eye is below: halves change places */
        for (int half = 0; half < 2; half++)
            assert_true(fabs(sums.seen[half ^ turned] - golden_g9[i].seen[half]) < 1e-12);
    }
}

/* (9) of the half toward the eye, before it is clamped to what (11) leaves of it to be seen. */
static double printed_shine(double sine, double cosine, const struct needles_sight_double *sight)
{
    int lines[2];
    needles_paper_lines_double(sine, cosine, sight, lines);
    double shine = PI / sight->exponent * sight->half_dot * lines[0];
    struct needles_sums_double sums = needles_paper_sums_double(sine, cosine, sight);
    assert_true(fabs(sums.specular[0] - fmin(shine, sums.seen[0])) < 1e-12);
    return shine;
}

/* (9) lacks the density of needles about those that are square to H. */
static void test_printed__cone_shines_as_the_golden_one_but_for_its_density(void **state)
{
    (void)state;
    int lines = 0;
    for (size_t i = 0; i < COUNT(golden_g2); i++) {
        const struct golden_g2 *g = &golden_g2[i];
        struct needles_sight_double sight = golden_sight(g);
        double sine = sin(g->phi * PI / 180), cosine = cos(g->phi * PI / 180);
        double shine = printed_shine(sine, cosine, &sight);
        double square = sine * sine - sight.half[2] * sight.half[2];
        double density = square > 0 ? 1 / sqrt(square) : 0;
        lines += golden_g9[i].specular > 0;
        assert_true(fabs(shine * density - golden_g9[i].specular) < 1e-10);
    }
    assert_true(lines > 0);
}

/* (7) with light and eye in one plane, its front and back exchanged and pi/8 for 1/4, on angles of
 * which the sums are the golden form's: half the sum for each of them, where none is folded
 * (lambda_2 is 0). */
static void test_printed__cone_is_lit_as_the_golden_one_but_for_its_faults(void **state)
{
    (void)state;
    int checked = 0;
    for (size_t i = 0; i < COUNT(golden_g2); i++) {
        const struct golden_g2 *g = &golden_g2[i];
        struct needles_sight_double sight = golden_sight(g);
        double of_light[2], of_eye[2], diffuse[2];
        folded(g->phi * PI / 180, sight.light, of_light);
        folded(g->phi * PI / 180, sight.eye, of_eye);
        double turn = atan2(sight.light[1], sight.light[0]) - atan2(sight.eye[1], sight.eye[0]);
        double bl = of_light[1], bv = of_eye[1], a = of_light[0] + of_eye[0];
        double b = sqrt(bl * bl + bv * bv + 2 * bl * bv * cos(turn));
        double aside = b > 0 ? (bl * cos(turn) + bv) / b : 1;
        if (a + b > PI || aside < 0 || a < b)
            continue;
        needles_paper_diffuse_double(b / 2, a / 2, a / 2, 2 * aside * aside - 1,
                                     needles_dot_double(sight.light, sight.eye), diffuse);
        checked++;
        if (fabs(PI / 2 * diffuse[1] - golden_g9[i].diffuse) > 1e-10)
            fail_msg("row %zu: %.10f; golden %.10f", i + 1, PI / 2 * diffuse[1],
                     golden_g9[i].diffuse);
    }
    assert_true(checked >= 3);
}

/* Over all directions (11), (7) and (9) are off by so much of what they stand for, in the mean. */
static void test_printed__cone_errs_in_the_mean_by_what_was_measured(void **state)
{
    (void)state;
    enum { DRAWS = 4000 };
    static const double exponents[4] = {10, 20, 50, 100}, shines[4] = {0.53, 0.55, 0.57, 0.58};
    struct random random = random_seed(7, 0);
    double off[6] = {0}, sums[6] = {0}, unseen = 0, dark = 0;
    for (int i = 0; i < DRAWS; i++) {
        double light[3], eye[3], raw[2];
        double phi = (10 + 75 * random_double(&random)) * PI / 180;
        random_direction(&random, light);
        random_direction(&random, eye);
        struct needles_sight_double sight =
            needles_sight_of_double(light, eye, exponents[i % 4], false);
        struct needles_sums_double exact = {{0, 0}, {0, 0}, {0, 0}};
        needles_cone_panel_double(sin(phi), cos(phi), &sight, 8, 0, 0.5, &exact);
        needles_cone_panel_double(sin(phi), cos(phi), &sight, 8, 0.5, 1, &exact);
        struct needles_sums_double printed = needles_paper_sums_double(sin(phi), cos(phi), &sight);
        double turn = (light[0] * eye[0] + light[1] * eye[1]) /
                      (hypot(light[0], light[1]) * hypot(eye[0], eye[1]));
        needles_paper_diffuse_double(phi, acos(light[2]), acos(eye[2]), turn,
                                     needles_dot_double(light, eye), raw);
        unseen += printed.seen[0] <= 0;
        dark += raw[0] < 0;
        off[4] += fabs(raw[0] - exact.diffuse[0]);
        sums[4] += exact.diffuse[0];
        off[i % 4] += fabs(printed_shine(sin(phi), cos(phi), &sight) - exact.specular[0]);
        sums[i % 4] += exact.specular[0];
    }
    print_message("unseen %.3f, dark %.3f, lit off by %.3f, shines off by %.3f %.3f %.3f %.3f\n",
                  unseen / DRAWS, dark / DRAWS, off[4] / sums[4], off[0] / sums[0],
                  off[1] / sums[1], off[2] / sums[2], off[3] / sums[3]);
    assert_true(fabs(unseen / DRAWS - 0.79) < 0.02);
    assert_true(fabs(dark / DRAWS - 0.49) < 0.03);
    assert_true(fabs(off[4] / sums[4] - 1.06) < 0.06);
    for (int k = 0; k < 4; k++)
        assert_true(fabs(off[k] / sums[k] - shines[k]) < 0.06);
}

/* Of the disc's half toward the eye [0] and of the other one, the way of light through the half
 * toward the light [0] and through the other one, summed over the half's area. */
static void ways_of_light(double angle, double ways[2][2])
{
    enum { SIDE = 600 };
    memset(ways, 0, 4 * sizeof(double));
    for (int i = 0; i < SIDE; i++)
        for (int j = 0; j < SIDE; j++) {
            double x = 2 * (i + 0.5) / SIDE - 1, w = 2 * (j + 0.5) / SIDE - 1;
            if (x * x + w * w >= 1)
                continue;
            double along = w * cos(angle) + x * sin(angle);
            double across = x * cos(angle) - w * sin(angle), area = 4.0 / SIDE / SIDE;
            ways[w < 0][0] += area * (sqrt(1 - across * across) - fmax(along, 0));
            ways[w < 0][1] += area * fmax(-along, 0);
        }
}

/* S1..S4: what a little of each light takes from (20), (21). */
static void test_printed__twig_is_shaded_by_the_ways_of_light_through_its_halves(void **state)
{
    (void)state;
    const double k = 8 / (3 * PI * PI), few = 1e-6, none[2] = {0, 0};
    for (int i = 0; i <= 6; i++) {
        double angle = PI * i / 6, ways[2][2], lit[2], bare[2];
        const double eye[2] = {few, few};
        ways_of_light(angle, ways);
        needles_paper_lit_double(eye, none, cos(angle), bare);
        for (int light = 0; light < 2; light++) {
            const double shade[2] = {light ? 0 : few, light ? few : 0};
            needles_paper_lit_double(eye, shade, cos(angle), lit);
            for (int half = 0; half < 2; half++) {
                double taken = (bare[half] - lit[half]) / (few * few) / k;
                assert_true(fabs(taken - 3 * ways[half][light]) < 5e-3);
            }
        }
    }
}

static double between(double value, double most)
{
    return fmin(fmax(value, 0), most);
}

static void same(double got, double wanted)
{
    if (!(fabs(got - wanted) <= 1e-9 + 1e-7 * fabs(wanted)))
        fail_msg("%.12g; printed %.12g", got, wanted);
}

/* A drawn cone and twig, and the printed terms of both halves, clamped: (11), (7), (9) over (11).
 */
struct drawn {
    struct needles_twig_double twig;
    struct needles_sight_double sight;
    double phi, eye_rad, light_rad, turn;
    double seen[2], diffuse[2], shine[2];
};

/* (7), as it stands there. */
static void printed_lit(struct drawn *d, double light_eye)
{
    const double al = fmax(d->light_rad, d->phi), bl = fmin(d->light_rad, d->phi);
    const double av = fmax(d->eye_rad, d->phi), bv = fmin(d->eye_rad, d->phi);
    const double a = al + av, b = bl + bv, most = cos(a - b), least = cos(a + b);
    const double lambda1 = (least - most) / 2;
    const double lambda2 = a - b < PI && PI < a + b ? lambda1 * b / (4 * (2 * PI - a)) : 0;
    const double lambda0 = (least + most) / 2 - lambda2;
    const double aside =
        (bl * cos(d->turn) + bv) / sqrt(bl * bl + bv * bv + 2 * bl * bv * cos(d->turn));
    for (int half = 0; half < 2; half++)
        d->diffuse[half] = (PI * (light_eye - lambda0) + (half ? 2 : -2) * lambda1 * aside) / 4;
}

static struct drawn draw(struct random *random)
{
    double light[3], eye[3];
    struct drawn d = {.phi = (10 + 70 * random_double(random)) * PI / 180};
    random_direction(random, light);
    random_direction(random, eye);
    const double count = 10 + 20 * random_double(random), radius = 2e-4;
    d.twig = needles_twig_of_double(d.phi, count, 0.02, radius,
                                    count * radius / (0.1 + 1.5 * random_double(random)));
    d.sight = needles_sight_of_double(light, eye, 20, false);
    d.eye_rad = acos(eye[2]);
    d.light_rad = acos(light[2]);
    d.turn = atan2(light[1], light[0]) - atan2(eye[1], eye[0]);
    printed_lit(&d, needles_dot_double(light, eye));
    /* (9): azimuths where needles are square to H, toward the eye or not. */
    const double *h = d.sight.half;
    const double root = -1 / (tan(d.phi) * tan(acos(h[2])));
    for (int sign = -1; sign <= 1 && fabs(root) <= 1; sign += 2) {
        double at = atan2(h[1], h[0]) + sign * acos(root) - atan2(eye[1], eye[0]);
        d.shine[cos(at) <= 0] += PI / 20 * d.sight.half_dot;
    }
    for (int half = 0; half < 2; half++) {
        double swing = 2 * sin(d.phi) * sin(d.eye_rad);
        d.seen[half] = between(PI * cos(d.phi) * cos(d.eye_rad) + (half ? swing : -swing), PI);
        d.diffuse[half] = between(d.diffuse[half], PI / 4 * d.seen[half]);
        d.shine[half] = between(d.shine[half], d.seen[half]);
    }
    return d;
}

/* A cone: (6), (8), (10) with the factor N r l / (pi S) for their l A. */
static void test_printed__cone_has_its_terms_over_its_section(void **state)
{
    (void)state;
    struct random random = random_seed(3, 1);
    int sure = 0;
    for (int i = 0; i < 2000; i++) {
        struct drawn d = draw(&random);
        double all = d.seen[0] + d.seen[1], part = random_double(&random);
        double area = d.twig.count * 2e-4 * 0.02, section = area * (0.1 + 4 * part);
        if (all < 1e-3)
            continue;
        struct needles_cone_shade_double shade =
            needles_paper_cone_shade_double(&d.twig, &d.sight, section);
        double opacity = area / PI * all / section;
        sure += opacity > 1;
        same(shade.all.opacity, fmin(opacity, 1));
        same(shade.all.diffuse, (d.diffuse[0] + d.diffuse[1]) / all);
        same(shade.all.specular, (d.shine[0] + d.shine[1]) / all);
        for (int half = 0; half < 2; half++)
            same(shade.halves[half].opacity, fmin(area / PI * d.seen[half] / section, 1));
    }
    assert_true(sure > 100);
}

/* A twig: (19) to (21) with 0 for light of less than none, over the needles' own reflectances. */
static void test_printed__twig_has_its_terms_where_they_are_no_less_than_none(void **state)
{
    (void)state;
    const double k = 8 / (3 * PI * PI);
    struct random random = random_seed(4, 1);
    int dark = 0, sure = 0;
    for (int i = 0; i < 2000; i++) {
        struct drawn d = draw(&random);
        const double a = d.twig.count * d.twig.radius_m / (2 * d.twig.spacing_m), c = cos(d.turn);
        double eye[2], light[2], diffuse = 0, shine = 0;
        for (int half = 0; half < 2; half++) {
            double sign = half ? 1 : -1;
            eye[half] = between(a * fabs(1 / tan(d.phi) + sign / tan(d.eye_rad)), 1);
            light[half] = between(a * fabs(1 / tan(d.phi) + sign / tan(d.light_rad)), 1);
        }
        double lit[2] = {
            1 - k * (2 * eye[0] + (1 - c) * light[1] + (3 - c) * light[0]),
            1 - k * (4 * eye[0] + 2 * eye[1] + (1 + c) * light[1] + (3 + c) * light[0])};
        struct needles_twig_shade_double shade = needles_paper_twig_shade_double(&d.twig, &d.sight);
        double all = eye[0] + eye[1];
        sure += all > 1;
        same(shade.all.opacity, fmin(all, 1));
        for (int half = 0; half < 2; half++) {
            double seen = d.seen[half] > 0 ? between(lit[half], 1) / d.seen[half] : 0;
            dark += lit[half] < 0;
            diffuse += d.diffuse[half] * seen * eye[half] / all;
            shine += d.shine[half] * seen * eye[half] / all;
            same(shade.halves[half].opacity, fmin(all, 1) * eye[half] / all);
            same(shade.halves[half].diffuse, d.diffuse[half] * seen);
            same(shade.halves[half].specular, d.shine[half] * seen);
        }
        same(shade.all.diffuse, diffuse);
        same(shade.all.specular, shine);
    }
    assert_true(dark > 100 && sure > 100);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_printed__needle_shines_as_far_from_the_golden_one_as_is_known),
        cmocka_unit_test(test_printed__cone_seen_from_an_elevation_is_the_golden_chord),
        cmocka_unit_test(test_printed__cone_shines_as_the_golden_one_but_for_its_density),
        cmocka_unit_test(test_printed__cone_is_lit_as_the_golden_one_but_for_its_faults),
        cmocka_unit_test(test_printed__cone_errs_in_the_mean_by_what_was_measured),
        cmocka_unit_test(test_printed__twig_is_shaded_by_the_ways_of_light_through_its_halves),
        cmocka_unit_test(test_printed__cone_has_its_terms_over_its_section),
        cmocka_unit_test(test_printed__twig_has_its_terms_where_they_are_no_less_than_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
