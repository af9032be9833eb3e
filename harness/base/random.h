/* Seeded random numbers that are the same on every machine: integers and + - * / only. */
#ifndef TREELINE_BASE_RANDOM_H
#define TREELINE_BASE_RANDOM_H

#include <stdint.h>

struct random {
    uint64_t state, stream;
};

/* PCG-XSH-RR 64/32, O'Neill 2014, HMC-CS-2014-0905. */
struct random random_seed(uint64_t seed, uint64_t stream);
uint32_t random_u32(struct random *random);
float random_float(struct random *random);   /* uniform in [0, 1), 24 bits */
double random_double(struct random *random); /* uniform in [0, 1), 53 bits */
/* Uniform integer in [0, bound), unbiased (Lemire 2019); bound 0 returns 0. */
uint32_t random_below(struct random *random, uint32_t bound);

/* A well mixed 64-bit hash of an integer (splitmix64's finaliser), for seeds made of counters. */
uint64_t random_mix(uint64_t x);

#endif
