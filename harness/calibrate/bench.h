/* Between the files of the calibration: the kinds of work, and what they are done on. */
#ifndef TREELINE_CALIBRATE_BENCH_H
#define TREELINE_CALIBRATE_BENCH_H

#include "calibrate/calibrate.h"

/* Loops of one kind of work, each ended; counts: what a loop does. */
struct work {
    void (*pass)(void *bench, enum calibration_index index, int loops); /* NULL: cannot be done */
    void *bench;
    double count;                  /* units a loop */
    double fragments_per_triangle; /* NaN: no triangles */
};

/* Fills in the works of their kinds, warmed up and counted; left alone where the error tells why
 * not. Destroy with the function below; NULL is allowed. */
struct gl_bench;
enum status gl_bench_create(struct arena *arena, const struct calibrate_request *request,
                            struct gl_bench **bench, struct work works[CALIBRATION_COUNT],
                            struct error *error);
void gl_bench_destroy(struct gl_bench *bench);
struct gl *gl_bench_gl(const struct gl_bench *bench);
const struct target *gl_bench_target(const struct gl_bench *bench);

struct ray_bench;
enum status ray_bench_create(struct arena *arena, int threads, struct ray_bench **bench,
                             struct work works[CALIBRATION_COUNT], struct error *error);
void ray_bench_destroy(struct ray_bench *bench);

/* count: values of each of the three arrays. */
struct memory_bench {
    size_t count;
    int threads;
    double *a, *b, *c;   /* a: 0, b: its place, c: 1 */
    uint64_t sum;        /* of the bits that memory_read met last */
    uint64_t *near;      /* threads x LOOKUP_WORDS; each word is its place */
    uint64_t *near_sums; /* threads: of what lookups_near met last */
};
#define LOOKUP_WORDS                                                                               \
    ((size_t)32 << 10) /* 256 KiB: beyond a core's first cache, within its second */
#define MEMORY_BENCH_VALUES ((size_t)8 << 20) /* 64 MiB an array: beyond most caches */
void memory_bench_create(struct arena *arena, size_t count, int threads, struct memory_bench *bench,
                         struct work works[CALIBRATION_COUNT]);

#endif
