/* A tree's outline and the part of a pixel within it. */
#include "bake/cone_outline.h"

#include <math.h>

/* Integral of a tent of half width 1 and area 1, from its middle. */
static float tent_until(float at)
{
    float v = fminf(fabsf(at), 1);
    return copysignf(v - 0.5f * v * v, at);
}

/* Of what is around a place so far from the middle: the share within half_px of the middle. A
 * pixel's square and where it is at random to the place make a tent. */
static float tent_share(float half_px, float away_px)
{
    return tent_until(half_px - away_px) + tent_until(half_px + away_px);
}

/* Between two of count: the lower one; returns the share of the other. */
static float between(float at, int count, int *low)
{
    at = fminf(fmaxf(at, 0), (float)(count - 1));
    *low = at < (float)(count - 2) ? (int)at : count - 2;
    return at - (float)*low;
}

float cone_outline_rise(int rise)
{
    const float below = 1 - (float)rise / (CONE_RISES - 1);
    return 1 - below * below;
}

/* The other way around, of a sine. */
static float rise_at(float sine)
{
    return (CONE_RISES - 1) * (1 - sqrtf(1 - fminf(fabsf(sine), 1)));
}

static float depth_from(const struct cone_outline *outline, float sine)
{
    int low;
    float share = between(rise_at(sine), CONE_RISES, &low);
    return outline->depths[low] + share * (outline->depths[low + 1] - outline->depths[low]);
}

float cone_outline_fill(const struct cone_outline *outline, float diameter_px, float rise)
{
    static const float octaves = 2;
    const float size = log2f(fmaxf(4 * diameter_px, 1)), over = size - (CONE_SIZES - 1);
    int low[2];
    if (!(outline->fills[0][0] > 0) || over >= octaves)
        return 1;
    const float share = between(rise_at(rise), CONE_RISES, &low[0]);
    const float part = between(size, CONE_SIZES, &low[1]);
    const float *lower = outline->fills[low[0]] + low[1],
                *upper = outline->fills[low[0] + 1] + low[1];
    const float first = lower[0] + share * (upper[0] - lower[0]);
    const float second = lower[1] + share * (upper[1] - lower[1]);
    const float fill = first + part * (second - first);
    return over > 0 ? fill + over / octaves * (1 - fill) : fill;
}

float cone_outline_part(const struct cone_outline *outline, const float place_m[3], float reach_m,
                        const float eye[3], float px)
{
    const float flat = sqrtf(eye[0] * eye[0] + eye[2] * eye[2]);
    const float x = flat > 1e-6f ? eye[0] / flat : 0, z = flat > 1e-6f ? eye[2] / flat : 1;
    const float way_m[3] = {place_m[0] - outline->center_m[0], place_m[1] - outline->center_m[1],
                            place_m[2] - outline->center_m[2]};
    int row = (int)((place_m[1] - outline->low_m) * outline->rows_per_m);
    row = row > 0 ? row < CONE_ROWS ? row : CONE_ROWS - 1 : 0;
    const float steep = eye[1] * eye[1];
    const float half_px[2] = {
        px * (outline->halves_m[row] + steep * (outline->wide_m - outline->halves_m[row])),
        px * (outline->half_m * flat + outline->wide_m * fabsf(eye[1]))};
    /* on the screen: across the plant's axis, and along it */
    const float away_px[2] = {px * fabsf(z * way_m[0] - x * way_m[2]),
                              px * fabsf(flat * way_m[1] - eye[1] * (x * way_m[0] + z * way_m[2]))};
    float share = 1;
    for (int i = 0; i < 2; i++) {
        /* itself, it is within */
        float most_px = fmaxf(half_px[i] - px * reach_m, 0);
        float away = fminf(away_px[i], most_px);
        if (half_px[i] - away < 1)
            share *= tent_share(half_px[i], away);
    }
    if (share >= 1)
        return 1;
    const float depth = depth_from(outline, eye[1]);
    const float covers = -expm1f(-depth);
    if (share * depth < 1e-4f)
        return depth > 1e-4f ? covers / depth : 1;
    return -log1pf(-share * covers) / (share * depth);
}
