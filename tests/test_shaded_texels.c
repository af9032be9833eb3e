/* Shaded texels against the ray-traced reference and closed forms: coverage from all sides, light,
 * fog, numbers of slices, and the borders of their use. */
#include "testing_tree.h"

static const unsigned lit = EFFECT_TWO_SIDED | EFFECT_AMBIENT;

struct fixture {
    struct arena *arena;
    struct plant *plant;
    const struct method *method;
};

static int open_fixture(void **state)
{
    struct fixture *fixture = calloc(1, sizeof *fixture);
    fixture->arena = arena_create(0);
    fixture->plant = plant_from_mesh(fixture->arena, "lopsided", tree_mesh(fixture->arena, 400));
    fixture->method = tree_method("shaded-texels");
    *state = fixture;
    return 0;
}

static int close_fixture(void **state)
{
    struct fixture *fixture = *state;
    arena_destroy(fixture->arena);
    free(fixture);
    return 0;
}

static void
test_shaded_texels__coverage_is_the_plants_from_twelve_azimuths_and_three_elevations(void **state)
{
    struct fixture *f = *state;
    static const float elevations[3] = {0, 0.6f, 1.2f};
    for (int e = 0; e < 3; e++)
        for (int a = 0; a < 12; a++) {
            struct scene *scene = tree_scene(f->arena, f->plant, 1, 1);
            struct view view = tree_view(scene, (float)a * 0.5235988f, elevations[e], 300, 9);
            struct frame *truth = tree_reference(f->arena, scene, lit, &view);
            struct frame *drawn = tree_draw(f->arena, f->method, "", scene, lit, &view, NULL);
            double covered = tree_mean(truth, 3), ratio = tree_mean(drawn, 3) / covered;
            double off = tree_difference(drawn, truth, false) / covered;
            if (fabs(ratio - 1) > 0.15 || off > 0.4)
                fail_msg("azimuth %d, elevation %d: %.3f of the coverage, off by %.3f", a, e, ratio,
                         off);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(
            test_shaded_texels__coverage_is_the_plants_from_twelve_azimuths_and_three_elevations),
    };
    return cmocka_run_group_tests_name("shaded-texels", tests, open_fixture, close_fixture);
}
