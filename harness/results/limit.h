/* How near a cell comes to what its machine can do: the roofline of Williams et al. 2009,
 * doi:10.1145/1498765.1498785, over the resources whose use a cell's results count. */
#ifndef TREELINE_RESULTS_LIMIT_H
#define TREELINE_RESULTS_LIMIT_H

#include "results/result.h"
#include "stats/stats.h"

/* X(name, word, doc) */
#define LIMIT_LIST(X)                                                                              \
    X(LIMIT_UNKNOWN, "", "nothing is counted, or the run has no calibration that fits")            \
    X(LIMIT_CALLS, "draw calls", "draw calls / calls_bare")                                        \
    X(LIMIT_VERTICES, "vertices", "vertices / vertices")                                           \
    X(LIMIT_TRIANGLES, "triangles", "primitives / rate of triangles of their mean size")           \
    X(LIMIT_FILL, "fill", "fragments / fill_opaque")                                               \
    X(LIMIT_SAMPLES, "samples", "samples / samples_bilinear")                                      \
    X(LIMIT_RAYS, "rays", "rays / rays_primary + occlusion rays / rays_shadow")                    \
    X(LIMIT_LOOKUPS, "lookups", "lookups / lookups_near; by OpenGL / lookups_shader")              \
    X(LIMIT_MEMORY, "memory", "bytes moved / the fastest of memory_read, _copy and _triad")

enum limit_resource {
#define LIMIT_ENUM(name, word, doc) name,
    LIMIT_LIST(LIMIT_ENUM)
#undef LIMIT_ENUM
        LIMIT_COUNT
};
const char *limit_word(enum limit_resource resource);

struct limit {
    enum limit_resource resource; /* that takes longest: the binding one */
    /* Least time of a frame by it, NaN when unknown: at the upper end of the rate's interval, since
     * what else the machine does can only slow a rate (so STREAM takes the best); to that at the
     * median rate. */
    struct interval seconds;
    struct interval fraction;      /* of the limit that is reached: seconds / frame time */
    double bounds[LIMIT_COUNT];    /* least time by each resource, s; NaN: not counted */
    double fragments_per_triangle; /* beyond one fragment a pixel, which the backdrop takes */
    bool cached; /* the frame took less time than its bytes would have from memory, so it found
                    some in caches; memory then bounds nothing */
    bool mixed;  /* the frame took less time than triangles of one size would have, so it mixes
                    sizes; triangles then count by the rate of culled ones */
};

/* The calibration of the run that fits the result: same threads; of what OpenGL drew also the same
 * target format and renderer, and of several the nearest size. NULL: there is none. */
const struct calibration *limit_calibration(const struct run *run, const struct result *result);

/* Least times by the counts of the result (of a repetition that drew all pictures) over the rates
 * of the calibration; calibration NULL: unknown. frame_seconds: median and interval of the cell. */
struct limit limit_of(const struct calibration *calibration, const struct result *result,
                      struct interval frame_seconds);

/* The same against the machine as it was while the cell ran: each repetition is paired with the
 * calibration of its round (or the last one before it), whose rates are scaled by the repetition's
 * median frame time over the cell's, and then merged; so a machine that is half as fast in one
 * round changes nothing. repetitions: count successful ones of one cell; counted: that of them
 * which has the counts. */
struct limit limit_of_cell(const struct run *run, const struct result *const *repetitions,
                           size_t count, const struct result *counted,
                           struct interval frame_seconds);

/* Least time that a reference's rays take at the calibrated rates (to the sun: shadow, into the
 * sky: ambient), of a calibration with as many threads, and its share of the time that it took;
 * unknown where there is none. */
struct limit limit_of_tracing(const struct run *run, const struct tracing *tracing);

/* The fastest way to move bytes, in 1/s. */
struct interval limit_memory_rate(const struct calibration *calibration);

/* Rate of triangles that shade so many fragments each, in 1/s, from the calibrated sizes:
 * interpolated in the logarithms of size and rate; below the smallest size in the time between it
 * and a culled one, above the largest by fill. */
struct interval limit_triangle_rate(const struct calibration *calibration,
                                    double fragments_per_triangle);

#endif
