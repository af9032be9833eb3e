/* Memory bandwidth: copy and triad of McCalpin's STREAM (IEEE TCCA Newsletter, 1995), its way of
 * counting: what is read and written, no write-allocate; a sum, which only reads; and loads from
 * scattered places of a core's second cache, which bound whoever walks through a volume. */
#include "calibrate/bench.h"

#include <math.h>
#include <string.h>

/* Bits are added as integers: their order is free, so that memory is waited for and not the sum. */
static void read_pass(void *context, enum calibration_index index, int loops)
{
    (void)index;
    struct memory_bench *bench = context;
    uint64_t sum = 0;
    for (int loop = 0; loop < loops; loop++) {
#pragma omp parallel for num_threads(bench->threads) schedule(static) reduction(+ : sum)
        for (size_t i = 0; i < bench->count; i++) {
            uint64_t bits;
            memcpy(&bits, bench->a + i, sizeof bits);
            sum += bits;
        }
    }
    bench->sum = sum;
}

/* A Weyl sequence's upper bits choose the word: no load waits for the one before. */
static void lookup_pass(void *context, enum calibration_index index, int loops)
{
    (void)index;
    const struct memory_bench *bench = context;
#pragma omp parallel for num_threads(bench->threads) schedule(static)
    for (int thread = 0; thread < bench->threads; thread++) {
        const uint64_t *words = bench->near + (size_t)thread * LOOKUP_WORDS;
        uint64_t at = 0, sum = 0;
        for (size_t i = 0; i < LOOKUP_WORDS * (size_t)loops; i++) {
            at += UINT64_C(0x9e3779b97f4a7c15);
            sum += words[at / (UINT64_MAX / LOOKUP_WORDS + 1)];
        }
        bench->near_sums[thread] = sum;
    }
}

static void pass(void *context, enum calibration_index index, int loops)
{
    const struct memory_bench *bench = context;
    const double *restrict b = bench->b, *restrict c = bench->c;
    double *restrict a = bench->a;
    bool triad = index == CALIBRATION_memory_triad;
    for (int loop = 0; loop < loops; loop++) {
        if (triad) {
#pragma omp parallel for num_threads(bench->threads) schedule(static)
            for (size_t i = 0; i < bench->count; i++)
                a[i] = b[i] + 3 * c[i];
        } else {
#pragma omp parallel for num_threads(bench->threads) schedule(static)
            for (size_t i = 0; i < bench->count; i++)
                a[i] = b[i];
        }
    }
}

void memory_bench_create(struct arena *arena, size_t count, int threads, struct memory_bench *bench,
                         struct work works[CALIBRATION_COUNT])
{
    size_t words = (size_t)threads * LOOKUP_WORDS;
    *bench = (struct memory_bench){.count = count,
                                   .threads = threads,
                                   .a = ARENA_ARRAY(arena, double, count),
                                   .b = ARENA_ARRAY(arena, double, count),
                                   .c = ARENA_ARRAY(arena, double, count),
                                   .near = ARENA_ARRAY(arena, uint64_t, words),
                                   .near_sums = ARENA_ARRAY(arena, uint64_t, threads)};
    /* Written by the threads that will use them, so that the pages lie near them. */
#pragma omp parallel for num_threads(threads) schedule(static)
    for (size_t i = 0; i < count; i++) {
        bench->a[i] = 0;
        bench->b[i] = (double)i;
        bench->c[i] = 1;
    }
    for (size_t i = 0; i < words; i++)
        bench->near[i] = i % LOOKUP_WORDS;
    double bytes = (double)count * sizeof(double);
    works[CALIBRATION_lookups_near] = (struct work){lookup_pass, bench, (double)words, NAN};
    works[CALIBRATION_memory_read] = (struct work){read_pass, bench, bytes, NAN};
    works[CALIBRATION_memory_copy] = (struct work){pass, bench, 2 * bytes, NAN};
    works[CALIBRATION_memory_triad] = (struct work){pass, bench, 3 * bytes, NAN};
}
