/* Lanes of floats for the ray march in plain C: four at a time, by the compiler's own vectors. */
#ifndef TREELINE_BAKE_MARCH_LANES_PLAIN_H
#define TREELINE_BAKE_MARCH_LANES_PLAIN_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

enum { LANES = 4 };
typedef float lanes __attribute__((vector_size(16)));
typedef int32_t lanes_int __attribute__((vector_size(16)));
typedef int32_t lanes_mask __attribute__((vector_size(16))); /* 0 or -1 */

static inline lanes_mask lanes_less(lanes a, lanes b)
{
    return (lanes_mask)(a < b);
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
    return (lanes)((mask & (lanes_mask)yes) | (~mask & (lanes_mask)no));
}
static inline lanes_int lanes_int_pick(lanes_mask mask, lanes_int yes, lanes_int no)
{
    return (lanes_int)((mask & (lanes_mask)yes) | (~mask & (lanes_mask)no));
}
static inline bool lanes_any(lanes_mask mask)
{
    return (mask[0] | mask[1] | mask[2] | mask[3]) != 0;
}
static inline int lanes_count(lanes_mask mask)
{
    return -(mask[0] + mask[1] + mask[2] + mask[3]);
}
static inline lanes lanes_min(lanes a, lanes b)
{
    return lanes_pick(lanes_less(a, b), a, b);
}
static inline lanes lanes_max(lanes a, lanes b)
{
    return lanes_pick(lanes_less(b, a), a, b);
}
static inline lanes lanes_sqrt(lanes a)
{
    lanes root;
    for (int i = 0; i < LANES; i++)
        root[i] = sqrtf(a[i]);
    return root;
}
/* a b + c, rounded once. */
static inline lanes lanes_fma(lanes a, lanes b, lanes c)
{
    lanes sum;
    for (int i = 0; i < LANES; i++)
        sum[i] = fmaf(a[i], b[i], c[i]);
    return sum;
}
static inline lanes_int lanes_truncate(lanes a)
{
    return __builtin_convertvector(a, lanes_int);
}
static inline lanes lanes_of(lanes_int a)
{
    return __builtin_convertvector(a, lanes);
}
/* words[at], 0 where the mask is not set. */
static inline lanes_int lanes_gather(const uint32_t *words, lanes_int at, lanes_mask mask)
{
    lanes_int got;
    for (int i = 0; i < LANES; i++)
        got[i] = mask[i] ? (int32_t)words[at[i]] : 0;
    return got;
}

/* Four words from each of LANES places. */
static inline void lanes_gather_four(const uint32_t *words, const int32_t *at, lanes_int got[4])
{
    for (int i = 0; i < LANES; i++)
        for (int k = 0; k < 4; k++)
            got[k][i] = (int32_t)words[at[i] + k];
}

/* The byte at a place and the next in bits 0 to 15. */
static inline lanes_int lanes_gather_pair(const uint8_t *bytes, lanes_int at)
{
    lanes_int got;
    for (int i = 0; i < LANES; i++)
        got[i] = bytes[at[i]] | bytes[at[i] + 1] << 8;
    return got;
}

/* The numbers of the lanes where a mask is set, in their order; whatever behind them. */
typedef lanes_int lanes_order;
static inline lanes_order lanes_order_of(lanes_mask mask)
{
    lanes_order order = {0};
    for (int i = 0, count = 0; i < LANES && count < LANES; i++) {
        order[count] = i;
        count -= mask[i];
    }
    return order;
}
static inline lanes lanes_squeeze(lanes a, lanes_order order)
{
    lanes squeezed;
    for (int i = 0; i < LANES; i++)
        squeezed[i] = a[order[i]];
    return squeezed;
}
static inline lanes_int lanes_int_squeeze(lanes_int a, lanes_order order)
{
    lanes_int squeezed;
    for (int i = 0; i < LANES; i++)
        squeezed[i] = a[order[i]];
    return squeezed;
}

/* Adds to the pixels that the keys name, one after the other. */
static inline void lanes_scatter(float (*to)[4], const int32_t *keys, const lanes rgb[3])
{
    for (int i = 0; i < LANES; i++)
        for (int c = 0; c < 3; c++)
            to[keys[i]][c] += rgb[c][i];
}

#endif
