/* What a pixel gets of a whole needle, cone and twig, put together here from converged integrals:
 * each part has its own tests. */
#include "testing.h"

#include "bake/needles_double.h"
#include "base/random.h"
#include "needles_ways.h"

enum { DRAWS = 400 };

struct drawn {
    struct needles_twig_double twig;
    struct needles_sight_double sight;
    struct needles_sums_double sums; /* (10), (6), (8), converged */
};

static struct drawn draw(struct random *random)
{
    double light[3], eye[3];
    random_direction(random, light);
    random_direction(random, eye);
    const double phi = (15 + 60 * random_double(random)) * PI / 180, radius = 1e-4;
    const double density = 0.1 + random_double(random); /* 2 N r/(pi dh) */
    struct drawn d = {
        .twig = needles_twig_of_double(phi, 16, 0.02, radius, 2 * 16 * radius / (PI * density)),
        .sight = needles_sight_of_double(light, eye, 10, false)};
    d.sums = needles_converged_sums_double(&d.twig, &d.sight);
    return d;
}

/* The mean error of a value over its mean. */
struct mean_error {
    double off, sum;
};

static void add(struct mean_error *error, double value, double truth)
{
    error->off += fabs(value - truth);
    error->sum += truth;
}

static void below(const struct mean_error *error, double most, const char *what)
{
    if (!(error->off < most * error->sum))
        fail_msg("%s is off by %.4f in the mean", what, error->off / error->sum);
}

/* An end that faces away from the light is dark, whichever end is seen. */
static void test_needle__shows_the_end_that_faces_the_eye(void **state)
{
    (void)state;
    const double axis[3] = {0, 0, 1};
    for (int below_it = 0; below_it < 2; below_it++)
        for (int lit = 0; lit < 2; lit++) {
            const double eye[3] = {0, 0, below_it ? -1 : 1};
            const double light[3] = {0.6, 0, lit == below_it ? -0.8 : 0.8};
            struct needles_sight_double sight = needles_sight_of_double(light, eye, -1, false);
            struct needles_shade_double shade =
                needles_needle_shade_double(axis, 0.02, 0.0005, &sight, 1e-6);
            assert_true(fabs(shade.diffuse - (lit ? 0.8 : 0)) < 1e-12);
        }
}

/* A cone is as bright as all its needles in the mean, and each half as its own. */
static void test_cone__is_as_bright_as_its_needles(void **state)
{
    (void)state;
    struct random random = random_seed(11, 1);
    struct mean_error diffuse = {0, 0}, shine = {0, 0}, halves[2] = {{0, 0}, {0, 0}};
    for (int i = 0; i < DRAWS; i++) {
        struct drawn d = draw(&random);
        struct needles_cone_shade_double cone =
            needles_cone_shade_double(&d.twig, &d.sight, true, 1e-3);
        const double seen = d.sums.seen[0] + d.sums.seen[1];
        add(&diffuse, cone.all.diffuse, (d.sums.diffuse[0] + d.sums.diffuse[1]) / seen);
        add(&shine, cone.all.specular, (d.sums.specular[0] + d.sums.specular[1]) / seen);
        for (int half = 0; half < 2; half++) {
            const double opacity = 16 * 1e-4 * 0.02 / PI * d.sums.seen[half] / 1e-3;
            add(&halves[half], cone.halves[half].diffuse * cone.halves[half].opacity,
                d.sums.diffuse[half] / d.sums.seen[half] * opacity);
        }
    }
    below(&diffuse, 0.01, "diffuse");
    below(&shine, 0.03, "shine");
    below(&halves[0], 0.02, "the front half");
    below(&halves[1], 0.02, "the rear half");
}

/* The disc that a twig is in section: depths (A R/dh) K of converged K, the angle between light and
 * eye around the twig from their azimuths. */
static struct needles_disc_double disc_of(const struct drawn *d)
{
    const double *light = d->sight.light, *eye = d->sight.eye;
    const double turn = atan2(light[1], light[0]) - atan2(eye[1], eye[0]);
    struct needles_disc_double disc = {{0, 0}, {0, 0}, cos(turn), fabs(sin(turn))};
    for (int side = 0; side < 2; side++) {
        const double *way = side ? light : eye;
        struct needles_sight_double along = needles_sight_of_double(way, way, -1, false);
        struct needles_sums_double sums = needles_converged_sums_double(&d->twig, &along);
        for (int half = 0; half < 2; half++)
            (side ? disc.light : disc.eye)[half] = 2 * d->twig.count * d->twig.radius_m /
                                                   (PI * d->twig.spacing_m) * sums.seen[half] /
                                                   (PI * d->twig.sine * hypot(way[0], way[1]));
    }
    return disc;
}

/* A twig's needles are as bright as a cone's where light comes to them, in both halves and for both
 * kinds of light. */
static void test_twig__is_as_bright_as_what_is_lit_of_its_needles(void **state)
{
    (void)state;
    struct random random = random_seed(12, 1);
    struct mean_error opacity = {0, 0}, diffuse = {0, 0}, shine = {0, 0};
    for (int i = 0; i < DRAWS; i++) {
        struct drawn d = draw(&random);
        struct needles_twig_shade_double twig = needles_twig_shade_double(&d.twig, &d.sight, false);
        struct needles_disc_double disc = disc_of(&d);
        struct needles_lit_double lit = needles_disc_lit_double(&disc);
        const double depth = disc.eye[0] + disc.eye[1];
        /* (19): of a mean over the disc's width, by its own integral */
        const double seen = needles_disc_opacity_double(depth);
        double truth[2] = {0, 0};
        for (int half = 0; half < 2; half++) {
            truth[0] += lit.lit[half] / seen * d.sums.diffuse[half] / d.sums.seen[half];
            truth[1] += lit.lit[half] / seen * d.sums.specular[half] / d.sums.seen[half];
        }
        add(&opacity, twig.all.opacity, needles_radial_opacity_double(depth));
        add(&diffuse, twig.all.diffuse, truth[0]);
        add(&shine, twig.all.specular, truth[1]);
    }
    below(&opacity, 0.01, "opacity");
    below(&diffuse, 0.015, "diffuse");
    below(&shine, 0.03, "shine");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_needle__shows_the_end_that_faces_the_eye),
        cmocka_unit_test(test_cone__is_as_bright_as_its_needles),
        cmocka_unit_test(test_twig__is_as_bright_as_what_is_lit_of_its_needles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
