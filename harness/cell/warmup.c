/* The warm-up rule. */
#include "cell/warmup.h"

#include "stats/stats.h"

bool warmup_done(const double *seconds, size_t count, double limit_seconds)
{
    double spent = 0;
    for (size_t i = 0; i < count; i++)
        spent += seconds[i];
    if (count >= WARMUP_FRAMES_MAX || (count && spent >= limit_seconds))
        return true;
    if (count < 2 * WARMUP_WINDOW)
        return false;
    const double *newest = seconds + count - WARMUP_WINDOW;
    return stats_median(newest, WARMUP_WINDOW) >=
           0.98 * stats_median(newest - WARMUP_WINDOW, WARMUP_WINDOW);
}
