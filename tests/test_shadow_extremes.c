/* Shadows at their extremes: a sun from the horizon to the zenith over relief, planes a million
 * apart, 16 bits of depth, against ray-traced masks. */
#include "cell/cell.h"

#include "testing.h"

#include <math.h>

enum { VIEWS = 3 };

/* The masks of scene stones-day: the sun at 0, 45 and 90 degrees. */
static void masks_of(const char *method, struct mask_error masks[VIEWS])
{
    struct arena *arena = arena_create(0);
    const char *cell = arena_printf(arena, "stones-day/%s/trees=12/size=40x30", method);
    struct plan *plan = NULL;
    struct error error = {0};
    struct plan_request request = {.cells = &cell,
                                   .cells_count = 1,
                                   .rounds = 1,
                                   .frame_seconds = 0.01,
                                   .frames_max = 1,
                                   .timeout_seconds = 100,
                                   .reference_error = 0.02,
                                   .reference_samples_max = 16,
                                   .views_count = VIEWS};
    struct result result;
    if (plan_load(arena, &request, &plan, &error))
        fail_msg("%s", error.text);
    if (cell_run(arena, plan, plan->cells, 0, NULL, &result))
        fail_msg("%s: %s", cell, result.message);
    assert_int_equal(result.views_count, VIEWS);
    for (int v = 0; v < VIEWS; v++) {
        masks[v] = result.views[v].mask;
        assert_true(result.views[v].masked && isfinite(masks[v].wrong));
        printf("# %s, %d degrees: wrong %.4f, stray %.4f, floor %.4f, dark %.2f\n", method, 45 * v,
               masks[v].wrong, masks[v].stray, masks[v].floor, masks[v].dark);
    }
    arena_destroy(arena);
}

/* The relief's volumes are counted behind samples, the stones' before them. */
static void test_shadow__volumes_are_right_from_sunrise_to_noon(void **unused)
{
    struct mask_error masks[VIEWS];
    masks_of("shadow-volume:samples=4", masks);
    for (int v = 0; v < VIEWS; v++)
        assert_true(masks[v].stray < 0.002 && masks[v].judged > 0.98);
    (void)unused;
}

static void test_shadow__maps_of_16_bits_with_planes_a_million_apart_lose_little(void **unused)
{
    struct mask_error masks[VIEWS];
    masks_of("shadow-map:depth=16,cascades=4,split=1", masks);
    for (int v = 0; v < VIEWS; v++)
        assert_true(masks[v].wrong < 0.08 && masks[v].judged > 0.98);
    (void)unused;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shadow__volumes_are_right_from_sunrise_to_noon),
        cmocka_unit_test(test_shadow__maps_of_16_bits_with_planes_a_million_apart_lose_little),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
