/* From arguments or a plan file to cells; their names, their order. */
#ifndef TREELINE_PLAN_PLAN_H
#define TREELINE_PLAN_PLAN_H

#include "base/arena.h"
#include "base/error.h"
#include "method/method.h"

/* One (scene, method, options, tree count, level of detail) in one size and target format. */
struct cell {
    const char *name; /* "SCENE/METHOD[:opt=val,...]/trees=N/lod=L/size=WxH/target=F/seed=S": can be
                         pasted back */
    const char *scene; /* name or path */
    const struct method *method;
    const char *method_name; /* as it was named; a plugin's path */
    const char *options;     /* canonical text, only what differs from the defaults; "" */
    size_t trees;
    enum lod lod;
    int width_px, height_px;
    enum target_format format;
    uint64_t seed;
};

struct plan {
    const char *name;
    size_t cells_count;
    struct cell *cells;
    int rounds;             /* repetitions of each cell, each in a fresh process */
    double frame_seconds;   /* measuring time a repetition, after warm-up */
    int frames_max;         /* timed frames a repetition at most */
    double timeout_seconds; /* of one repetition */
    size_t memory_bytes;    /* budget of a cell; 0: none */
    double reference_error; /* standard error asked of the references */
    int reference_samples_max;
    int threads;         /* 0: all */
    size_t views_count;  /* pictures compared along the path */
    const char *backend; /* NULL: chosen by gl_context_create */
    uint64_t hash;       /* of the cells' names and the measuring settings */
};

/* What the command line gave; NULL, 0 or SIZE_MAX where it gave nothing. Lists are comma-separated.
 * A plan file's values are overridden by the command line's. */
struct plan_request {
    const char
        *plan_path; /* JSON, documented in harness/plan/README.md; or a name in scenes/plans/ */
    const char *const *scenes;
    size_t scenes_count;
    const char *const *methods;
    size_t methods_count; /* "billboards:views=8,16,alpha=test": lists sweep */
    const char *trees, *lods, *sizes, *targets;
    const char *const *cells;
    size_t cells_count; /* names pasted back */
    const char *filter; /* POSIX extended regular expression on cell names */
    int rounds, threads, frames_max, reference_samples_max;
    double frame_seconds, timeout_seconds, reference_error;
    size_t views_count, memory_bytes;
    bool seed_given, threads_given, memory_given; /* their 0 means something */
    uint64_t seed;
    const char *backend;
};

/* "billboards:views=8,16,alpha=test" means views in {8, 16}, alpha = test: a list item without '='
 * continues the option before it. Cells are unique and in a stable order. */
enum status plan_load(struct arena *arena, const struct plan_request *request, struct plan **plan,
                      struct error *error);

/* One cell from its name; every part but the scene and method may be missing. */
enum status cell_parse(struct arena *arena, const char *name, struct cell *cell,
                       struct error *error);

/* Order of round r: a permutation of 0..cells_count-1, by the seed; so rounds interleave the cells.
 */
void plan_order(const struct plan *plan, int round, size_t *order);

#endif
