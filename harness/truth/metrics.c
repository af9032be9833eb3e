/* The table of metrics, the comparison of two pictures, and the flicker of a path. */
#include "truth/metrics.h"

#include "truth/compare.h"

#include <math.h>
#include <stddef.h>

const struct metric_info metric_table[] = {
#define METRIC_INFO(field, word, better, domain, doc)                                              \
    {#field, word, domain, doc, better, offsetof(struct metrics, field)},
    METRIC_LIST(METRIC_INFO)
#undef METRIC_INFO
        {NULL, NULL, NULL, NULL, 0, 0},
};

const struct metric_info flicker_table[] = {
    {"mean", "flicker", "linear", "rmse of the change from frame to frame along a path", -1,
     offsetof(struct flicker, mean)},
    {"peak", "flicker-peak", "linear", "the same of the worst pair of frames: popping", -1,
     offsetof(struct flicker, peak)},
    {NULL, NULL, NULL, NULL, 0, 0},
};

double metric_of(const struct metrics *metrics, const struct metric_info *info)
{
    const void *field = (const char *)metrics + info->offset;
    return *(const double *)field;
}

static enum status check_pair(const struct frame *test, const struct frame *reference,
                              struct error *error)
{
    if (test->width_px != reference->width_px || test->height_px != reference->height_px)
        return error_set(
            error, STATUS_INVALID, "the pictures differ in size: test %d x %d, reference %d x %d",
            test->width_px, test->height_px, reference->width_px, reference->height_px);
    if (frame_check(test, error))
        return error_context(error, "test");
    if (frame_check(reference, error))
        return error_context(error, "reference");
    return STATUS_OK;
}

enum status metrics_compare(struct arena *arena, const struct frame *test,
                            const struct frame *reference, struct comparison *comparison,
                            float **flip_map, struct error *error)
{
    struct error own;
    if (check_pair(test, reference, &own))
        return error_set(error, own.status, "%s", own.text);
    *comparison = (struct comparison){0};
    float *map = NULL;
    if (flip_map)
        *flip_map = map =
            ARENA_ARRAY(arena, float, (size_t)test->width_px *(size_t)test->height_px);
    compare_pixels(test, reference, comparison);
    compare_display(test, reference, comparison, map);
    return STATUS_OK;
}

/* Mean square over RGB and pixels of the error of one change, and the mean of its known variance.
 */
static void change_error(const struct frame *const *frames, const struct frame *const *references,
                         double *squared, double *variance)
{
    size_t count = (size_t)frames[0]->width_px * (size_t)frames[0]->height_px * 4;
    *squared = *variance = 0;
    for (size_t i = 0; i < count; i++) {
        if (i % 4 == 3)
            continue;
        double change = (double)frames[1]->rgba[i] - (double)frames[0]->rgba[i];
        double wanted = (double)references[1]->rgba[i] - (double)references[0]->rgba[i];
        *squared += (change - wanted) * (change - wanted);
        *variance += compare_variance(frames[0], references[0], i) +
                     compare_variance(frames[1], references[1], i);
    }
    *squared /= (double)(count / 4 * 3);
    *variance /= (double)(count / 4 * 3);
}

static enum status check_path(const struct frame *const *frames,
                              const struct frame *const *references, size_t count,
                              struct error *error)
{
    for (size_t k = 0; k < count; k++) {
        if (frames[k]->width_px != frames[0]->width_px ||
            frames[k]->height_px != frames[0]->height_px)
            return error_set(error, STATUS_INVALID, "frame %zu is %d x %d, frame 0 is %d x %d", k,
                             frames[k]->width_px, frames[k]->height_px, frames[0]->width_px,
                             frames[0]->height_px);
        if (check_pair(frames[k], references[k], error))
            return error_context(error, "frame %zu", k);
    }
    return STATUS_OK;
}

enum status metrics_flicker(struct arena *arena, const struct frame *const *frames,
                            const struct frame *const *references, size_t count,
                            struct flicker *flicker, struct error *error)
{
    (void)arena;
    *flicker = (struct flicker){0};
    struct error own;
    if (check_path(frames, references, count, &own))
        return error_set(error, own.status, "%s", own.text);
    double squared_sum = 0, variance_sum = 0, worst = -1;
    for (size_t k = 0; k + 1 < count; k++) {
        double squared, variance;
        change_error(frames + k, references + k, &squared, &variance);
        squared_sum += squared;
        variance_sum += variance;
        double corrected = fmax(squared - variance, 0);
        if (corrected > worst) {
            worst = corrected;
            flicker->peak_frame = k + 1;
        }
    }
    if (count < 2)
        return STATUS_OK;
    double pairs = (double)(count - 1);
    flicker->mean = sqrt(fmax(squared_sum - variance_sum, 0) / pairs);
    flicker->peak = sqrt(worst);
    flicker->floor = sqrt(variance_sum / pairs);
    return STATUS_OK;
}
