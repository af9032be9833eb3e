/* The ray-traced reference: unbiased, low-discrepancy, adaptive to a stated standard error, its
 * noise kept. */
#ifndef TREELINE_TRUTH_REFERENCE_H
#define TREELINE_TRUTH_REFERENCE_H

#include "scene/scene.h"
#include "truth/frame.h"

struct reference_options {
    unsigned effects;     /* EFFECT_*; what is not asked for is not traced */
    float standard_error; /* target of the root mean square, over the picture, of the standard error
                             of a pixel's linear RGB; 0: only sample counts decide */
    int samples_min, samples_max; /* a pixel; 0: 16 and 4096 */
    int threads;                  /* 0: all */
    uint64_t seed;
    bool masked; /* the shadow mask of scene/effects.h in place of light */
    bool quiet;  /* no progress bar */
};

struct reference_stats {
    double build_seconds, trace_seconds;
    double primary_rays, shadow_rays, occlusion_rays;
    double samples;       /* total over all pixels */
    float standard_error; /* reached, RMS over the picture */
    bool from_cache;
};

/* One view of a scene. The picture's variance is that of each pixel's mean, estimated from
 * independently scrambled replicates, so that it holds for a low-discrepancy sampler. Deterministic
 * for a seed, whatever the number of threads. */
enum status reference_render(struct arena *arena, const struct scene *scene,
                             const struct view *view, const struct reference_options *options,
                             struct frame **frame, struct reference_stats *stats,
                             struct error *error);

/* A scene that is built once and traced from many views. threads: 0 for all. The arena must live as
 * long; the caller ends it with tracer_close, also after an error. */
struct tracer;
enum status tracer_open(struct arena *arena, const struct scene *scene, int threads,
                        struct tracer **tracer, struct error *error);
void tracer_close(struct tracer *tracer);
/* As reference_render, but stats->build_seconds stays 0 and options->threads is not looked at. */
enum status tracer_trace(const struct tracer *tracer, struct arena *arena, const struct view *view,
                         const struct reference_options *options, struct frame **frame,
                         struct reference_stats *stats, struct error *error);

/* reference_render through the disk cache (key: scene hash, view, effects, options, tracer
 * version). The Embree scene is built only on a miss. */
enum status reference_cached(struct arena *arena, const struct scene *scene,
                             const struct view *view, const struct reference_options *options,
                             struct frame **frame, struct reference_stats *stats,
                             struct error *error);
/* Key of reference_cached, for results and for children that only read the cache. */
uint64_t reference_key(const struct scene *scene, const struct view *view,
                       const struct reference_options *options);

#endif
