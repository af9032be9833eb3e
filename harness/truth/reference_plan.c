/* Where the reference's samples go: variance from replicates, and an allocation that does not bias.
 *
 * Spending samples where the estimate of a pixel's own variance is large would bias the pixel's
 * mean, because the two are correlated (a pixel that happens to miss a bright leaf looks both dark
 * and quiet, and is left alone). Here the share of a pixel comes from the pilot variances of its
 * neighbours alone, which are independent of its own samples; the only other thing that enters is
 * one scale for the whole picture. So the mean and the stated variance of a pixel stay unbiased up
 * to its own part in that scale, of the order of 1 / pixels.
 *
 * Shares follow Neyman 1934: with a variance that falls as v n^-p the total is smallest for n ~
 * v^(1 / (1 + p)). */
#include "truth/reference_parts.h"

#include <math.h>

/* p for scrambled nets: 1 for noise, 3/2 for clean edges; measured about 1.15 on forests. */
#define FALL 1.15

void samples_variance(const struct samples *samples, size_t pixels, float (*variance)[4])
{
    for (size_t pixel = 0; pixel < pixels; pixel++) {
        double count = samples->counts[pixel] / (double)REFERENCE_REPLICATES;
        for (int channel = 0; channel < 4; channel++) {
            double mean = 0, squares = 0;
            for (int k = 0; k < REFERENCE_REPLICATES; k++)
                mean += samples->sums[pixel][k][channel] / REFERENCE_REPLICATES;
            for (int k = 0; k < REFERENCE_REPLICATES; k++) {
                double away = samples->sums[pixel][k][channel] - mean;
                squares += away * away;
            }
            variance[pixel][channel] =
                (float)(squares / (count * count) /
                        (REFERENCE_REPLICATES * (REFERENCE_REPLICATES - 1.0)));
        }
    }
}

double plan_standard_error(const float (*variance)[4], size_t pixels)
{
    double sum = 0;
    for (size_t pixel = 0; pixel < pixels; pixel++)
        sum += (double)variance[pixel][0] + variance[pixel][1] + variance[pixel][2];
    return sqrt(sum / (3.0 * (double)pixels));
}

static float variance_at(const float (*variance)[4], int width_px, int height_px, int x, int y)
{
    if (x < 0 || y < 0 || x >= width_px || y >= height_px)
        return -1;
    const float *rgb = variance[(size_t)y * (size_t)width_px + (size_t)x];
    return (rgb[0] + rgb[1] + rgb[2]) / 3;
}

/* Of the four lines through the pixel the one whose two neighbours are noisiest together (an edge
 * runs along it), and the mean of the 5 x 5 around. */
static float weight_at(const float (*variance)[4], int width_px, int height_px, int x, int y)
{
    static const int lines[4][2] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}};
    float along = 0, around = 0;
    int count = 0;
    for (int k = 0; k < 4; k++) {
        float before = variance_at(variance, width_px, height_px, x - lines[k][0], y - lines[k][1]);
        float behind = variance_at(variance, width_px, height_px, x + lines[k][0], y + lines[k][1]);
        if (before < 0 || behind < 0)
            before = behind = fmaxf(before, behind);
        if (before > 0 && behind > 0)
            along = fmaxf(along, sqrtf(before * behind));
    }
    for (int dy = -2; dy <= 2; dy++)
        for (int dx = -2; dx <= 2; dx++) {
            float near = variance_at(variance, width_px, height_px, x + dx, y + dy);
            if ((dx || dy) && near >= 0) {
                around += near;
                count++;
            }
        }
    return 0.75f * along + 0.25f * around / (float)(count ? count : 1);
}

void plan_levels(const float (*variance)[4], int width_px, int height_px, int16_t *levels)
{
    for (int y = 0; y < height_px; y++)
        for (int x = 0; x < width_px; x++) {
            float weight = weight_at(variance, width_px, height_px, x, y);
            double level = weight > 0 ? log2((double)weight) / (1 + FALL) * PLAN_STEPS : -INFINITY;
            level = fmin(fmax(level, -PLAN_LEVELS / 2), PLAN_LEVELS / 2 - 1);
            levels[(size_t)y * (size_t)width_px + (size_t)x] = (int16_t)lround(level);
        }
}

/* log2 of the samples of a level, the nearest whole number within the limits: every replicate stays
 * a net. */
static int doublings_for(const struct plan_limits *limits, int level, int scale)
{
    int doublings = (level + scale + PLAN_STEPS / 2) >> PLAN_STEPS_BITS;
    int least = __builtin_ctz(limits->samples_min), most = __builtin_ctz(limits->samples_max);
    return doublings < least ? least : doublings > most ? most : doublings;
}

#define DOUBLINGS 32

/* Sum of the variances of all pixels of a level that have 2^j samples now. */
struct plan_table {
    double variance[PLAN_LEVELS][DOUBLINGS];
};

/* The sum of variances to be expected when the samples are scaled. */
static double plan_predict(const struct plan_limits *limits, const struct plan_table *table,
                           int scale)
{
    double sum = 0;
    for (int i = 0; i < PLAN_LEVELS; i++) {
        int then = doublings_for(limits, i - PLAN_LEVELS / 2, scale);
        for (int now = 0; now < DOUBLINGS; now++)
            if (table->variance[i][now] > 0)
                sum += table->variance[i][now] * exp2(-FALL * (then > now ? then - now : 0));
    }
    return sum;
}

bool plan_next(const struct plan_limits *limits, const int16_t *levels, const float (*variance)[4],
               size_t pixels, struct samples *samples)
{
    struct plan_table table = {0};
    for (size_t i = 0; i < pixels; i++)
        table.variance[levels[i] + PLAN_LEVELS / 2][__builtin_ctz(samples->counts[i])] +=
            (double)variance[i][0] + variance[i][1] + variance[i][2];
    double allowed = 3 * (double)pixels * limits->target * limits->target;
    int low = -2 * PLAN_LEVELS, high = 2 * PLAN_LEVELS; /* high: samples_max everywhere */
    if (plan_predict(limits, &table, low) <= allowed)
        return false;
    while (high - low > 1) {
        int middle = low + (high - low) / 2;
        if (plan_predict(limits, &table, middle) <= allowed)
            high = middle;
        else
            low = middle;
    }
    bool more = false;
    for (size_t i = 0; i < pixels; i++) {
        uint32_t wish = 1u << doublings_for(limits, levels[i], high);
        samples->wanted[i] = wish > samples->counts[i] ? wish : samples->counts[i];
        more |= samples->wanted[i] > samples->counts[i];
    }
    return more;
}
