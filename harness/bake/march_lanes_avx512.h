/* Lanes of floats for the ray march by AVX-512: sixteen at a time. */
#ifndef TREELINE_BAKE_MARCH_LANES_AVX512_H
#define TREELINE_BAKE_MARCH_LANES_AVX512_H

#include <immintrin.h>
#include <stdbool.h>
#include <stdint.h>

enum { LANES = 16 };
typedef float lanes __attribute__((vector_size(64)));
typedef int32_t lanes_int __attribute__((vector_size(64)));
typedef __mmask16 lanes_mask;

static inline lanes_mask lanes_less(lanes a, lanes b)
{
    return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LT_OQ);
}
static inline lanes_mask lanes_int_less(lanes_int a, lanes_int b)
{
    return _mm512_cmplt_epi32_mask((__m512i)a, (__m512i)b);
}
static inline lanes_mask lanes_int_same(lanes_int a, lanes_int b)
{
    return _mm512_cmpeq_epi32_mask((__m512i)a, (__m512i)b);
}
static inline lanes_mask lanes_both(lanes_mask a, lanes_mask b)
{
    return (lanes_mask)(a & b);
}
/* The first, but not the second. */
static inline lanes_mask lanes_but(lanes_mask a, lanes_mask b)
{
    return (lanes_mask)(a & ~b);
}
static inline lanes lanes_pick(lanes_mask mask, lanes yes, lanes no)
{
    return (lanes)_mm512_mask_blend_ps(mask, (__m512)no, (__m512)yes);
}
static inline lanes_int lanes_int_pick(lanes_mask mask, lanes_int yes, lanes_int no)
{
    return (lanes_int)_mm512_mask_blend_epi32(mask, (__m512i)no, (__m512i)yes);
}
static inline bool lanes_any(lanes_mask mask)
{
    return mask != 0;
}
static inline int lanes_count(lanes_mask mask)
{
    return __builtin_popcount(mask);
}
static inline lanes lanes_min(lanes a, lanes b)
{
    return (lanes)_mm512_min_ps((__m512)a, (__m512)b);
}
static inline lanes lanes_max(lanes a, lanes b)
{
    return (lanes)_mm512_max_ps((__m512)a, (__m512)b);
}
static inline lanes lanes_sqrt(lanes a)
{
    return (lanes)_mm512_sqrt_ps((__m512)a);
}
/* a b + c, rounded once. */
static inline lanes lanes_fma(lanes a, lanes b, lanes c)
{
    return (lanes)_mm512_fmadd_ps((__m512)a, (__m512)b, (__m512)c);
}
static inline lanes_int lanes_truncate(lanes a)
{
    return (lanes_int)_mm512_cvttps_epi32((__m512)a);
}
static inline lanes lanes_of(lanes_int a)
{
    return (lanes)_mm512_cvtepi32_ps((__m512i)a);
}
/* words[at], 0 where the mask is not set. */
static inline lanes_int lanes_gather(const uint32_t *words, lanes_int at, lanes_mask mask)
{
    return (lanes_int)_mm512_mask_i32gather_epi32(_mm512_setzero_si512(), mask, (__m512i)at,
                                                  (const int *)words, 4);
}

/* Four words from each of LANES places. */
static inline void lanes_gather_four(const uint32_t *words, const int32_t *at, lanes_int got[4])
{
    const __m512i places = _mm512_loadu_si512(at);
    for (int k = 0; k < 4; k++)
        got[k] = (lanes_int)_mm512_i32gather_epi32(places, (const int *)(words + k), 4);
}

/* The byte at a place and the next in bits 0 to 15, whatever above them. Reads four bytes. */
static inline lanes_int lanes_gather_pair(const uint8_t *bytes, lanes_int at)
{
    return (lanes_int)_mm512_i32gather_epi32((__m512i)at, (const void *)bytes, 1);
}

/* The lanes where a mask is set, in their order; whatever behind them. */
typedef __mmask16 lanes_order;
static inline lanes_order lanes_order_of(lanes_mask mask)
{
    return mask;
}
static inline lanes lanes_squeeze(lanes a, lanes_order order)
{
    return (lanes)_mm512_maskz_compress_ps(order, (__m512)a);
}
static inline lanes_int lanes_int_squeeze(lanes_int a, lanes_order order)
{
    return (lanes_int)_mm512_maskz_compress_epi32(order, (__m512i)a);
}

/* Adds to the pixels that the keys name, one after the other. */
static inline void lanes_scatter(float (*to)[4], const int32_t *keys, const lanes rgb[3])
{
    for (int i = 0; i < LANES; i++)
        for (int c = 0; c < 3; c++)
            to[keys[i]][c] += rgb[c][i];
}

#endif
