/* Shadows at their extremes: a sun from the horizon to the zenith over relief, planes a million
 * apart, 16 bits of depth, against ray-traced masks. */
#include "shadow_world.h"

enum { VIEWS = 3 };
/* The sun at 0, 45 and 90 degrees. */
#define STONES(method) "stones-day/" method "/trees=12/size=40x30"

/* The relief's volumes are counted behind samples, the stones' before them. */
static void test_shadow__volumes_are_right_from_sunrise_to_noon(void **unused)
{
    struct mask_error masks[VIEWS];
    cell_masks(STONES("shadow-volume:samples=4"), VIEWS, masks);
    for (int v = 0; v < VIEWS; v++)
        assert_true(masks[v].stray < 0.002 && masks[v].judged > 0.98);
    (void)unused;
}

static void test_shadow__maps_of_16_bits_with_planes_a_million_apart_lose_little(void **unused)
{
    struct mask_error masks[VIEWS];
    cell_masks(STONES("shadow-map:depth=16,cascades=4,split=1"), VIEWS, masks);
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
