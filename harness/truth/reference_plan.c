/* Where the reference's samples go: variance from replicates, and an allocation that does not bias.
 *
 * Spending samples where the estimate of a pixel's own variance is large would bias the pixel's
 * mean, because the two are correlated: a pixel that happens to miss a bright leaf looks both dark
 * and quiet, and is left alone. So nothing that is decided about a pixel looks at the pixel itself.
 * Its share comes from the pilot variances of its neighbours, and the scale that turns shares into
 * samples comes from the other half of the picture (the squares of the other colour of a
 * chessboard). Both are independent of the pixel's own samples in the first round; later rounds
 * only see how often the others were sampled through the noise of their variances. The price: the
 * error asked for is met by the forecast from the other half, not by force.
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

#define DOUBLINGS 17 /* up to REFERENCE_SAMPLES_LIMIT */

/* Sum of the variances of the half's pixels of a level that have 2^j samples now. */
struct plan_table {
    double variance[PLAN_LEVELS][DOUBLINGS];
    double pixels;
};

/* The mean variance to be expected of the half at a scale. */
static double plan_predict(const struct plan_limits *limits, const struct plan_table *table,
                           int scale)
{
    double sum = 0;
    for (int i = 0; i < PLAN_LEVELS; i++) {
        int then = doublings_for(limits, i - PLAN_LEVELS / 2, scale);
        for (int now = 0; now < DOUBLINGS; now++)
            if (table->variance[i][now] > 0)
                sum += table->variance[i][now] * exp2(-FALL * (then - now));
    }
    return sum / (3 * table->pixels);
}

/* The least scale at which the half is expected to meet the target, a little tightened. */
static int plan_scale(const struct plan_limits *limits, const struct plan_table *table)
{
    double allowed = 0.97 * limits->target * 0.97 * limits->target;
    int low = PLAN_SCALE_LEAST, high = -PLAN_SCALE_LEAST; /* high: samples_max everywhere */
    while (high - low > 1) {
        int middle = low + (high - low) / 2;
        if (plan_predict(limits, table, middle) <= allowed)
            high = middle;
        else
            low = middle;
    }
    return high;
}

static int half_of(const struct plan *plan, size_t pixel)
{
    size_t width = (size_t)plan->width_px;
    return (int)((pixel / width + pixel % width) & 1);
}

bool plan_next(struct plan *plan, const float (*variance)[4], size_t pixels,
               struct samples *samples)
{
    struct plan_table tables[2] = {0};
    for (size_t i = 0; i < pixels; i++) {
        struct plan_table *table = &tables[half_of(plan, i)];
        table->variance[plan->levels[i] + PLAN_LEVELS / 2][__builtin_ctz(samples->counts[i])] +=
            (double)variance[i][0] + variance[i][1] + variance[i][2];
        table->pixels++;
    }
    double target = plan->limits.target;
    for (int half = 0; half < 2; half++) {
        const struct plan_table *other = &tables[tables[!half].pixels > 0 ? !half : half];
        if (plan_predict(&plan->limits, other, plan->scale[half]) > target * target) {
            int scale = plan_scale(&plan->limits, other);
            plan->scale[half] = scale > plan->scale[half] ? scale : plan->scale[half];
        }
    }
    bool more = false;
    for (size_t i = 0; i < pixels; i++) {
        uint32_t wish =
            1u << doublings_for(&plan->limits, plan->levels[i], plan->scale[half_of(plan, i)]);
        samples->wanted[i] = wish > samples->counts[i] ? wish : samples->counts[i];
        more |= samples->wanted[i] > samples->counts[i];
    }
    return more;
}
