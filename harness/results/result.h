/* What one repetition of one cell gave, and how it is kept: JSON lines, append-only, versioned. */
#ifndef TREELINE_RESULTS_RESULT_H
#define TREELINE_RESULTS_RESULT_H

#include "base/arena.h"
#include "base/error.h"
#include "calibrate/calibrate.h"
#include "plan/plan.h"
#include "results/tracing.h"
#include "truth/mask.h"
#include "truth/metrics.h"

/* Version 2 added the calibration; a run of version 1 is read as one that has none. Version 3 added
 * the method's own counts, calibrations of several rounds, and the references' cost. Version 4
 * added the angles of views, and what methods with OpenGL count. Version 5 added shadow masks and
 * the cost of shadows. */
#define RESULT_VERSION 5
#define RESULT_VERSION_OLDEST 1

/* Scalar columns, one table for JSON keys, report columns and docs. X(field, unit, better, doc).
 * All are double; NaN in memory means "not measured" and is null in JSON. Times of frames are in
 * frame_seconds[]. */
#define RESULT_COLUMNS(X)                                                                          \
    X(scene_seconds, "s", -1, "loading the scene and placing the trees")                           \
    X(plant_seconds, "s", -1, "building the plants the method asked for")                          \
    X(plant_bytes, "B", -1, "memory of the plants that were built")                                \
    X(build_seconds, "s", -1, "prepare, cold, without the plants")                                 \
    X(first_frame_seconds, "s", -1, "the first frame, shader compilation included")                \
    X(warmup_frames, "", 0, "frames drawn before the time was stable")                             \
    X(cpu_seconds_per_frame, "s", -1, "CPU time of all threads a timed frame")                     \
    X(gpu_seconds_per_frame, "s", -1, "GPU timer a frame; null on software")                       \
    X(harness_seconds_per_frame, "s", -1, "time between two frames that is not draw and finish")   \
    X(relight_seconds, "s", -1, "one frame after the sun moved, less a plain frame")               \
    X(host_bytes, "B", -1, "the method's host memory (arena)")                                     \
    X(device_bytes, "B", -1, "GL buffers and textures")                                            \
    X(peak_bytes, "B", -1, "peak resident memory of the process until the last timed frame")       \
    X(draw_calls, "", -1, "draw calls a frame")                                                    \
    X(triangles, "", 0, "triangles submitted a frame")                                             \
    X(vertices, "", 0, "vertices processed a frame (pipeline statistics)")                         \
    X(primitives, "", 0, "primitives after clipping a frame (pipeline statistics)")                \
    X(fragments, "", 0, "fragments shaded a frame (pipeline statistics)")                          \
    X(rays, "", 0, "rays to the nearest triangle a frame (the method's count)")                    \
    X(occlusion_rays, "", 0, "rays to any triangle a frame (the method's count)")                  \
    X(lookups, "", 0, "voxels and texels that were looked up a frame (the method's count)")        \
    X(samples, "", 0, "texels that OpenGL filtered for shaders a frame (the method's count)")      \
    X(moved_bytes, "B", 0, "a frame's least memory traffic: its picture, what the method counted") \
    X(shadow_seconds, "s", -1, "making all shadows once (the method's count); shading is apart")   \
    X(shadow_bytes, "B", -1, "what shadows hold: maps, volumes (the method's count)")              \
    X(load_average, "", -1, "1-minute load of the machine at the start")

/* One compared picture. */
struct result_view {
    double time;                       /* along the path */
    double distance_m;                 /* median distance of the eye to the trees in the frustum */
    double elevation_deg, azimuth_deg; /* of the eye, view_angles_deg() */
    uint64_t picture_hash;
    const char *picture;         /* path of the frame file under the run folder */
    uint64_t same_key, full_key; /* reference_key of either reference */
    bool compared;
    struct comparison
        same; /* against the reference of the same effects: error of the representation */
    struct comparison full; /* against the reference of all that the scene asks for: total error */
    float same_standard_error, full_standard_error; /* of the references */
    bool masked;                                    /* has a shadow mask */
    struct mask_error mask;
};

struct result {
    struct cell cell;
    int repetition;
    enum status status;
    const char *message;             /* one line; "" when ok and nothing is odd */
    int signal;                      /* that killed it, else 0 */
    const char *started;             /* ISO 8601 UTC */
    double seconds;                  /* the whole repetition */
    unsigned effects, scene_effects; /* drawn; asked for */
    size_t instances;
    uint64_t scene_hash;
    const char *backend, *renderer, *gl_version;
    int threads;
#define RESULT_FIELD(field, unit, better, doc) double field;
    RESULT_COLUMNS(RESULT_FIELD)
#undef RESULT_FIELD
    size_t frames_count;
    double *frame_seconds; /* wall clock around draw and finish */
    size_t views_count;
    struct result_view *views;
    bool has_flicker;
    struct flicker flicker; /* from each compared view to the path's next frame, same effects */
};

/* A result about which nothing is known yet: columns NaN, texts "", status ok. */
void result_init(struct result *result, const struct cell *cell, int repetition);

/* First line of a run's file: where, what, by whom. */
struct provenance {
    const char *host, *cpu, *kernel, *os, *compiler, *flags, *revision, *libraries, *plan, *command,
        *settings, *started; /* settings: options of `run` that measure so; "": the defaults */
    int cores;
    double memory_bytes;
    uint64_t seed, plan_hash;
    double rounds, frame_seconds, reference_error;
};

struct run {
    const char *folder;
    struct provenance provenance;
    size_t results_count;
    struct result *results; /* in file order */
    size_t measured_count;
    struct calibration *measured; /* calibrations as they were made, in file order */
    size_t calibrations_count;
    struct calibration *calibrations; /* the same over all rounds: one a kind */
    size_t tracings_count;
    struct tracing *tracings; /* of references, in file order */
    size_t torn_lines;        /* a last line cut by a kill is dropped and counted */
};

struct json;
/* The line's version is one that this program reads; else the document's error is set. */
enum status result_version_check(struct json *root);
/* One line without newline, in the arena. */
char *result_to_json(struct arena *arena, const struct result *result);
enum status result_from_json(struct arena *arena, const char *text, const char *where,
                             struct result *result, struct error *error);
char *provenance_to_json(struct arena *arena, const struct provenance *provenance);

/* FOLDER/cells.jsonl. Creates the folder and the first line when absent; a file of another version
 * or plan is refused unless resume allows the plan. Appends are whole lines, fsynced. */
enum status run_open(const char *folder, const struct provenance *provenance, bool resume,
                     struct error *error);
enum status run_append(const char *folder, const struct result *result, struct error *error);
enum status run_append_calibration(const char *folder, const struct calibration *calibration,
                                   struct error *error);
enum status run_append_tracing(const char *folder, const struct tracing *tracing,
                               struct error *error);
/* Reads a run; accepts the folder or the file. A malformed line in the middle is STATUS_INVALID
 * with its number. */
enum status run_read(struct arena *arena, const char *path, struct run **run, struct error *error);

/* Fills in everything about this machine and build; command is argv joined, settings are those of
 * the plan as options. */
void provenance_here(struct arena *arena, const struct plan *plan, const char *command,
                     const char *settings, struct provenance *provenance);

#endif
