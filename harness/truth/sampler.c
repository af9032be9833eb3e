/* Owen-scrambled Sobol pairs; see sampler.h for the sources. */
#include "truth/sampler.h"

#include "base/random.h"

/* Laine and Karras: only + of a seed, * by odd numbers and ^ of even multiples, so that a bit
 * depends on itself and on lower ones alone. In reversed order these are the digits before it:
 * Owen's tree. */
uint32_t sampler_scramble(uint32_t reversed, uint32_t seed)
{
    uint32_t x = reversed;
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

static uint32_t bits_reverse(uint32_t x)
{
    x = __builtin_bswap32(x);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x >> 4) & 0x0f0f0f0fu);
    x = ((x & 0x33333333u) << 2) | ((x >> 2) & 0x33333333u);
    return ((x & 0x55555555u) << 1) | ((x >> 1) & 0x55555555u);
}

/* The second Sobol dimension, bits reversed. Its matrix is Pascal's triangle modulo 2, the fifth
 * Kronecker power of
 * ((1 1) (0 1)): five butterfly steps instead of a loop over 32 direction numbers. */
static uint32_t sobol_second_reversed(uint32_t index)
{
    uint32_t x = index;
    x ^= (x & 0xaaaaaaaau) >> 1;
    x ^= (x & 0xccccccccu) >> 2;
    x ^= (x & 0xf0f0f0f0u) >> 4;
    x ^= (x & 0xff00ff00u) >> 8;
    return x ^ (x & 0xffff0000u) >> 16;
}

static float fraction(uint32_t reversed)
{
    return (float)(bits_reverse(reversed) >> 8) * 0x1p-24f;
}

struct sampler sampler_create(uint64_t seed, uint32_t pixel, uint32_t replicate,
                              enum sampler_pair pair)
{
    uint64_t place = random_mix(seed) + ((uint64_t)pixel << 32 | replicate << 1 | (uint32_t)pair);
    uint64_t first = random_mix(place);
    struct sampler sampler = {(uint32_t)first, (uint32_t)(first >> 32), 0};
    if (pair != SAMPLER_PIXEL)
        sampler.seed_order = (uint32_t)random_mix(first ^ 0x9e3779b97f4a7c15u) | 1u;
    return sampler;
}

void sampler_point(const struct sampler *sampler, uint32_t index, float point[2])
{
    /* The first dimension is the index itself, reversed. The order is an Owen scramble of the
     * index: blocks of 2^m points are mapped to blocks of 2^m points. */
    if (sampler->seed_order)
        index = bits_reverse(sampler_scramble(bits_reverse(index), sampler->seed_order));
    point[0] = fraction(sampler_scramble(index, sampler->seed_x));
    point[1] = fraction(sampler_scramble(sobol_second_reversed(index), sampler->seed_y));
}
