/* Functions of lanes, after march_lanes_*.h: S. Moshier's Cephes polynomials (expf, logf),
 * Abramowitz and Stegun 7.1.26 (erf, 1.5e-7) and 4.4.46 (arc cosine, 2e-8). */
#ifndef TREELINE_BAKE_CONE_LANES_MATH_H
#define TREELINE_BAKE_CONE_LANES_MATH_H

#define LANES_PI 3.14159265f

static inline lanes lanes_even(float value)
{
    return (lanes){0} + value;
}

static inline lanes lanes_abs(lanes a)
{
    return lanes_max(a, -a);
}

/* exp of a <= 0; what is below 1e-37 is about that. */
static inline lanes lanes_exp(lanes a)
{
    a = lanes_max(a, lanes_even(-86));
    const lanes_int whole = lanes_truncate(a * 1.44269504f - 0.5f);
    const lanes n = lanes_of(whole), r = a - n * 0.693359375f + n * 2.12194440e-4f;
    lanes sum = r * 1.9875691500e-4f + 1.3981999507e-3f;
    sum = sum * r + 8.3334519073e-3f;
    sum = sum * r + 4.1665795894e-2f;
    sum = sum * r + 1.6666665459e-1f;
    sum = sum * r + 5.0000001201e-1f;
    return (sum * r * r + r + 1) * (lanes)((whole + 127) << 23);
}

/* log of a in [1e-30, 1]; below it is that of 1e-30. */
static inline lanes lanes_log(lanes a)
{
    const lanes_int bits = (lanes_int)lanes_max(a, lanes_even(1e-30f));
    lanes e = lanes_of((bits >> 23) - 126), m = (lanes)((bits & 0x7fffff) | 0x3f000000);
    const lanes_mask low = lanes_less(m, lanes_even(0.707106781f));
    e = lanes_pick(low, e - 1, e);
    m = lanes_pick(low, m + m, m) - 1;
    lanes sum = m * 7.0376836292e-2f - 1.1514610310e-1f;
    sum = sum * m + 1.1676998740e-1f;
    sum = sum * m - 1.2420140846e-1f;
    sum = sum * m + 1.4249322787e-1f;
    sum = sum * m - 1.6668057665e-1f;
    sum = sum * m + 2.0000714765e-1f;
    sum = sum * m - 2.4999993993e-1f;
    sum = sum * m + 3.3333331174e-1f;
    const lanes square = m * m;
    return m + (sum * m * square - e * 2.12194440e-4f - 0.5f * square) + e * 0.693359375f;
}

static inline lanes lanes_erf(lanes a)
{
    const lanes x = lanes_abs(a), t = 1 / (1 + 0.3275911f * x);
    lanes sum = t * 1.061405429f - 1.453152027f;
    sum = sum * t + 1.421413741f;
    sum = sum * t - 0.284496736f;
    sum = sum * t + 0.254829592f;
    const lanes erf = 1 - sum * t * lanes_exp(-x * x);
    return lanes_pick(lanes_less(a, lanes_even(0)), -erf, erf);
}

/* pi less the arc cosine of c, whose sine is s >= 0. */
static inline lanes lanes_turn(lanes s, lanes c)
{
    const lanes size = lanes_abs(c), x = lanes_min(size, s);
    lanes sum = x * -0.0012624911f + 0.0066700901f;
    sum = sum * x - 0.0170881256f;
    sum = sum * x + 0.0308918810f;
    sum = sum * x - 0.0501743046f;
    sum = sum * x + 0.0889789874f;
    sum = sum * x - 0.2145988016f;
    sum = sum * x + 1.5707963050f;
    const lanes arc = lanes_sqrt(lanes_max(1 - x, lanes_even(0))) * sum;
    const lanes from_axis = lanes_pick(lanes_less(s, size), 0.5f * LANES_PI - arc, arc);
    return lanes_pick(lanes_less(c, lanes_even(0)), from_axis, LANES_PI - from_axis);
}

#endif
