/* Low-discrepancy points: Owen-scrambled Sobol pairs, one independent set for every pixel and
 * replicate.
 *
 * Sobol' 1967, dimensions 1 and 2: every 2^m consecutive points from a multiple of 2^m form a (0,
 * m, 2)-net in base
 * 2. Owen 1995: nested uniform scrambling keeps the net and makes each point uniform, so that means
 * are unbiased and independent scrambles give an honest variance. Hash-based form: Laine and Karras
 * 2011, Burley 2020 (Practical hash-based Owen scrambling, JCGT 9(4)), with the better mixing
 * constants of Vegdahl 2021. */
#ifndef TREELINE_TRUTH_SAMPLER_H
#define TREELINE_TRUTH_SAMPLER_H

#include <stdint.h>

/* What a sample decides. Pairs are padded: each has its own scramble and its own order of the
 * points. */
enum sampler_pair { SAMPLER_PIXEL, SAMPLER_SKY };

/* One scramble: two independent seeds for the coordinates, one for the order. */
struct sampler {
    uint32_t seed_x, seed_y, seed_order;
};

/* The scramble of a pixel's replicate; different arguments give independent scrambles. */
struct sampler sampler_create(uint64_t seed, uint32_t pixel, uint32_t replicate,
                              enum sampler_pair pair);

/* Point `index` of the set, each coordinate in [0, 1), a multiple of 2^-24. Points 0 .. 2^m - 1 are
 * a (0, m, 2)-net for every m. SAMPLER_SKY points come in scrambled order, so that they do not
 * depend on SAMPLER_PIXEL's. */
void sampler_point(const struct sampler *sampler, uint32_t index, float point[2]);

/* Nested uniform scramble of a fraction of 32 bits; the bits are reversed: bit 0 weighs 1/2. */
uint32_t sampler_scramble(uint32_t reversed, uint32_t seed);

#endif
