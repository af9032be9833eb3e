/* Memory bandwidth: copy and triad of McCalpin's STREAM (IEEE TCCA Newsletter, 1995), its way of
 * counting: what is read and written, no write-allocate. */
#include "calibrate/bench.h"

#include <math.h>

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
    *bench = (struct memory_bench){.count = count,
                                   .threads = threads,
                                   .a = ARENA_ARRAY(arena, double, count),
                                   .b = ARENA_ARRAY(arena, double, count),
                                   .c = ARENA_ARRAY(arena, double, count)};
    /* Written by the threads that will use them, so that the pages lie near them. */
#pragma omp parallel for num_threads(threads) schedule(static)
    for (size_t i = 0; i < count; i++) {
        bench->a[i] = 0;
        bench->b[i] = (double)i;
        bench->c[i] = 1;
    }
    double bytes = (double)count * sizeof(double);
    works[CALIBRATION_memory_copy] = (struct work){pass, bench, 2 * bytes, NAN};
    works[CALIBRATION_memory_triad] = (struct work){pass, bench, 3 * bytes, NAN};
}
