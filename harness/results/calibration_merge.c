/* Calibrations of several rounds made one: medians over the rounds, with their intervals. */
#include "results/calibration.h"

#include "results/result.h"

#include <string.h>

/* One round tells no more than its own interval. */
static struct interval rate_merge(const double *rates, const struct calibration_part *parts,
                                  size_t count, size_t index)
{
    if (count > 1)
        return stats_median_interval(rates, count, index);
    struct interval only = parts->calibration->measures[index].rate;
    return (struct interval){only.value * parts->scale, only.low * parts->scale,
                             only.high * parts->scale};
}

struct calibration calibration_merge(struct arena *arena, const struct calibration_part *parts,
                                     size_t count)
{
    struct calibration merged = *parts->calibration;
    double *rates = ARENA_ARRAY(arena, double, count), *sizes = ARENA_ARRAY(arena, double, count);
    for (size_t index = 0; index < CALIBRATION_COUNT; index++) {
        for (size_t i = 0; i < count; i++) {
            const struct calibration_measure *measure = &parts[i].calibration->measures[index];
            rates[i] = measure->rate.value * parts[i].scale;
            sizes[i] = measure->fragments_per_triangle;
        }
        merged.measures[index].rate = rate_merge(rates, parts, count, index);
        merged.measures[index].fragments_per_triangle = stats_median(sizes, count);
    }
    for (size_t i = 1; i < count; i++)
        merged.seconds += parts[i].calibration->seconds;
    return merged;
}

bool calibration_same_kind(const struct calibration *a, const struct calibration *b)
{
    return a->format == b->format && a->threads == b->threads && a->width_px == b->width_px &&
           a->height_px == b->height_px && strcmp(a->renderer, b->renderer) == 0;
}

void calibrations_merge(struct arena *arena, struct run *run)
{
    size_t count = run->measured_count;
    struct calibration_part *parts = ARENA_ARRAY(arena, struct calibration_part, count);
    run->calibrations = ARENA_ARRAY(arena, struct calibration, count);
    for (size_t i = 0; i < count; i++) {
        size_t alike = 0;
        bool again = false;
        for (size_t k = 0; k < run->calibrations_count && !again; k++)
            again = calibration_same_kind(&run->calibrations[k], &run->measured[i]);
        for (size_t k = i; k < count && !again; k++)
            if (calibration_same_kind(&run->measured[i], &run->measured[k]))
                parts[alike++] = (struct calibration_part){&run->measured[k], 1};
        if (!again)
            run->calibrations[run->calibrations_count++] = calibration_merge(arena, parts, alike);
    }
}
