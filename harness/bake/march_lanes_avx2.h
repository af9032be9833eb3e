/* Lanes of floats for the ray march by AVX2: eight at a time. */
#ifndef TREELINE_BAKE_MARCH_LANES_AVX2_H
#define TREELINE_BAKE_MARCH_LANES_AVX2_H

#include "bake/march_orders_avx2.h"

#include <immintrin.h>
#include <stdbool.h>
#include <stdint.h>

enum { LANES = 8 };
typedef float lanes __attribute__((vector_size(32)));
typedef int32_t lanes_int __attribute__((vector_size(32)));
typedef int32_t lanes_mask __attribute__((vector_size(32))); /* 0 or -1 */

static inline lanes_mask lanes_less(lanes a, lanes b)
{
    return (lanes_mask)_mm256_cmp_ps((__m256)a, (__m256)b, _CMP_LT_OQ);
}
static inline lanes_mask lanes_int_less(lanes_int a, lanes_int b)
{
    return (lanes_mask)(a < b);
}
static inline lanes_mask lanes_int_same(lanes_int a, lanes_int b)
{
    return (lanes_mask)(a == b);
}
static inline lanes_mask lanes_both(lanes_mask a, lanes_mask b)
{
    return a & b;
}
/* The first, but not the second. */
static inline lanes_mask lanes_but(lanes_mask a, lanes_mask b)
{
    return a & ~b;
}
static inline lanes lanes_pick(lanes_mask mask, lanes yes, lanes no)
{
    return (lanes)_mm256_blendv_ps((__m256)no, (__m256)yes, (__m256)mask);
}
static inline lanes_int lanes_int_pick(lanes_mask mask, lanes_int yes, lanes_int no)
{
    return (lanes_int)_mm256_blendv_epi8((__m256i)no, (__m256i)yes, (__m256i)mask);
}
static inline bool lanes_any(lanes_mask mask)
{
    return _mm256_movemask_ps((__m256)mask) != 0;
}
static inline int lanes_count(lanes_mask mask)
{
    return __builtin_popcount((unsigned)_mm256_movemask_ps((__m256)mask));
}
static inline lanes lanes_min(lanes a, lanes b)
{
    return (lanes)_mm256_min_ps((__m256)a, (__m256)b);
}
static inline lanes lanes_max(lanes a, lanes b)
{
    return (lanes)_mm256_max_ps((__m256)a, (__m256)b);
}
static inline lanes lanes_sqrt(lanes a)
{
    return (lanes)_mm256_sqrt_ps((__m256)a);
}
/* a b + c, rounded once. */
static inline lanes lanes_fma(lanes a, lanes b, lanes c)
{
    return (lanes)_mm256_fmadd_ps((__m256)a, (__m256)b, (__m256)c);
}
static inline lanes_int lanes_truncate(lanes a)
{
    return (lanes_int)_mm256_cvttps_epi32((__m256)a);
}
static inline lanes lanes_of(lanes_int a)
{
    return (lanes)_mm256_cvtepi32_ps((__m256i)a);
}
/* words[at], 0 where the mask is not set. */
static inline lanes_int lanes_gather(const uint32_t *words, lanes_int at, lanes_mask mask)
{
    return (lanes_int)_mm256_mask_i32gather_epi32(_mm256_setzero_si256(), (const int *)words,
                                                  (__m256i)at, (__m256i)mask, 4);
}

/* Four words from each of LANES places. Eight loads and a transposition:
 * gathers of single words take twice the time. */
static inline void lanes_gather_four(const uint32_t *words, const int32_t *at, lanes_int got[4])
{
    __m256i pairs[4], mixed[4];
    for (int i = 0; i < 4; i++) {
        __m128i low = _mm_loadu_si128((const __m128i *)(const void *)(words + (uint32_t)at[i]));
        __m128i high =
            _mm_loadu_si128((const __m128i *)(const void *)(words + (uint32_t)at[i + 4]));
        pairs[i] = _mm256_inserti128_si256(_mm256_castsi128_si256(low), high, 1);
    }
    for (int i = 0; i < 2; i++) {
        mixed[i] = _mm256_unpacklo_epi32(pairs[2 * i], pairs[2 * i + 1]);
        mixed[i + 2] = _mm256_unpackhi_epi32(pairs[2 * i], pairs[2 * i + 1]);
    }
    for (int i = 0; i < 2; i++) {
        got[2 * i] = (lanes_int)_mm256_unpacklo_epi64(mixed[2 * i], mixed[2 * i + 1]);
        got[2 * i + 1] = (lanes_int)_mm256_unpackhi_epi64(mixed[2 * i], mixed[2 * i + 1]);
    }
}

/* The byte at a place and the next in bits 0 to 15, whatever above them. Reads four bytes. */
static inline lanes_int lanes_gather_pair(const uint8_t *bytes, lanes_int at)
{
    return (lanes_int)_mm256_i32gather_epi32((const int *)(const void *)bytes, (__m256i)at, 1);
}

/* The numbers of the lanes where a mask is set, in their order; whatever behind them. */
typedef __m256i lanes_order;
static inline lanes_order lanes_order_of(lanes_mask mask)
{
    const uint64_t *order = &lanes_orders[_mm256_movemask_ps((__m256)mask)];
    return _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)(const void *)order));
}
static inline lanes lanes_squeeze(lanes a, lanes_order order)
{
    return (lanes)_mm256_permutevar8x32_ps((__m256)a, order);
}
static inline lanes_int lanes_int_squeeze(lanes_int a, lanes_order order)
{
    return (lanes_int)_mm256_permutevar8x32_epi32((__m256i)a, order);
}

/* Adds to the pixels that the keys name, one after the other. */
static inline void lanes_scatter(float (*to)[4], const int32_t *keys, const lanes rgb[3])
{
    __m256 zero = _mm256_setzero_ps(), mixed[4];
    mixed[0] = _mm256_unpacklo_ps((__m256)rgb[0], (__m256)rgb[1]);
    mixed[1] = _mm256_unpackhi_ps((__m256)rgb[0], (__m256)rgb[1]);
    mixed[2] = _mm256_unpacklo_ps((__m256)rgb[2], zero);
    mixed[3] = _mm256_unpackhi_ps((__m256)rgb[2], zero);
    __m256 pairs[4];
    for (int i = 0; i < 2; i++) {
        pairs[2 * i] = _mm256_shuffle_ps(mixed[i], mixed[i + 2], 0x44);
        pairs[2 * i + 1] = _mm256_shuffle_ps(mixed[i], mixed[i + 2], 0xee);
    }
    for (int i = 0; i < LANES; i++) {
        __m128 add =
            i < 4 ? _mm256_castps256_ps128(pairs[i]) : _mm256_extractf128_ps(pairs[i - 4], 1);
        float *ray = to[keys[i]];
        _mm_storeu_ps(ray, _mm_add_ps(_mm_loadu_ps(ray), add));
    }
}

#endif
