/* What tests of shadows share: masks of a cell's views, how far pictures are apart. */
#ifndef TREELINE_TESTS_SHADOW_WORLD_H
#define TREELINE_TESTS_SHADOW_WORLD_H

#include "testing.h"

#include "cell/cell.h"
#include "truth/frame.h"

#include <math.h>

/* RMS difference of two pictures, over 8 x 8 pixels. */
static inline double boxes_apart(const struct frame *a, const struct frame *b)
{
    double sum = 0;
    int count = 0;
    for (int y = 0; y + 8 <= a->height_px; y += 8)
        for (int x = 0; x + 8 <= a->width_px; x += 8, count++) {
            double difference = 0;
            for (int i = 0; i < 64; i++) {
                size_t at = 4 * ((size_t)(y + i / 8) * (size_t)a->width_px + (size_t)(x + i % 8));
                difference += ((double)a->rgba[at + 1] - (double)b->rgba[at + 1]) / 64;
            }
            sum += difference * difference;
        }
    return sqrt(sum / count);
}

/* The masks of a cell's views against the ray-traced ones; what its shadows cost is told. */
static inline void cell_masks(const char *cell, size_t views, struct mask_error masks[])
{
    struct arena *arena = arena_create(0);
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
                                   .views_count = (int)views};
    struct result result;
    if (plan_load(arena, &request, &plan, &error))
        fail_msg("%s", error.text);
    if (cell_run(arena, plan, plan->cells, 0, NULL, &result))
        fail_msg("%s: %s", cell, result.message);
    assert_int_equal(result.views_count, views);
    assert_true(result.shadow_bytes > 0 && result.shadow_seconds > 0);
    for (size_t v = 0; v < views; v++) {
        masks[v] = result.views[v].mask;
        assert_true(result.views[v].masked && isfinite(masks[v].wrong));
        printf("# %s, view %zu: wrong %.4f, leak %.4f, acne %.4f, stray %.4f, judged %.3f\n", cell,
               v, masks[v].wrong, masks[v].leak, masks[v].acne, masks[v].stray, masks[v].judged);
    }
    arena_destroy(arena);
}

#endif
