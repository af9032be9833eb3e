/* What a reference cost to trace, as a line of a run's results and back. */
#ifndef TREELINE_RESULTS_TRACING_H
#define TREELINE_RESULTS_TRACING_H

#include "base/arena.h"
#include "base/error.h"

#include <stdbool.h>
#include <stdint.h>

#define TRACING_KIND "treeline-reference"

/* Numbers of a line, by key. X(field, doc) */
#define TRACING_NUMBERS(X)                                                                         \
    X(time, "along the camera path, 0..1")                                                         \
    X(build_seconds, "building the ray tracer's scene")                                            \
    X(trace_seconds, "tracing")                                                                    \
    X(primary_rays, "from the eye, all samples of all pixels")                                     \
    X(shadow_rays, "to the sun")                                                                   \
    X(occlusion_rays, "into the sky")                                                              \
    X(standard_error, "that was reached, RMS over the picture, linear RGB")

struct tracing {
    const char *scene;
    size_t trees;
    int width_px, height_px, threads;
    unsigned effects;
    uint64_t key; /* reference_key */
#define TRACING_FIELD(field, doc) double field;
    TRACING_NUMBERS(TRACING_FIELD)
#undef TRACING_FIELD
    bool from_cache; /* traced for an earlier run */
};

/* One line without newline, in the arena. */
char *tracing_to_json(struct arena *arena, const struct tracing *tracing);
/* STATUS_INVALID names what is wrong with the line; where: FILE:LINE. */
enum status tracing_from_json(struct arena *arena, const char *text, const char *where,
                              struct tracing *tracing, struct error *error);

#endif
