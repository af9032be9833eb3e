/* What this machine can do at most: fill, triangles, draw calls, rays, memory; a few seconds of
 * measuring. The roof against which every cell's time is held (results/limit.h). */
#ifndef TREELINE_CALIBRATE_CALIBRATE_H
#define TREELINE_CALIBRATE_CALIBRATE_H

#include "base/arena.h"
#include "base/error.h"
#include "stats/stats.h"
#include "wall/gl.h"

/* One table for the measuring, the JSON keys, `treeline calibrate` and the docs.
 * X(field, kind, unit counted, doc). Fragments are counted as the driver's pipeline statistics
 * count them, here and in the cells: llvmpipe counts whole blocks of 4 x 4. */
#define CALIBRATION_LIST(X)                                                                        \
    X(fill_opaque, FILL, "px", "whole picture, one colour, no depth")                              \
    X(fill_blended, FILL, "px", "the same, blended")                                               \
    X(fill_textured, FILL, "px", "bilinear texture array, blended")                                \
    X(fill_tested, FILL, "px", "bilinear texture array, alpha test: half is thrown away")          \
    X(triangles_culled, TRIANGLES, "tri", "indexed, turned away: vertices and culling alone")      \
    X(triangles_shared, TRIANGLES, "tri", "indexed, 1/8 px each, neighbours share vertices")       \
    X(triangles_single, TRIANGLES, "tri", "1/8 px each, three vertices of their own")              \
    X(quads_2px, TRIANGLES, "tri", "instanced quads of 2 x 2 px")                                  \
    X(quads_8px, TRIANGLES, "tri", "instanced quads of 8 x 8 px")                                  \
    X(quads_32px, TRIANGLES, "tri", "instanced quads of 32 x 32 px")                               \
    X(vertices, VERTICES, "vert", "of triangles outside of the picture")                           \
    X(calls_bare, CALLS, "call", "nothing changes between two draws of a triangle")                \
    X(calls_uniform, CALLS, "call", "a uniform changes")                                           \
    X(calls_texture, CALLS, "call", "a texture is bound")                                          \
    X(samples_bilinear, SAMPLES, "sample", "16 bilinear ones a fragment, of a layer of 256 KiB")   \
    X(lookups_shader, LOOKUPS, "load",                                                             \
      "32 a fragment, of 4 bytes scattered over a buffer of 256 KiB")                              \
    X(rays_primary, RAYS, "ray", "at one poplar, packets of 16 neighbours")                        \
    X(rays_shadow, RAYS, "ray", "from what they hit to the sun, packets of 16")                    \
    X(rays_ambient, RAYS, "ray", "from what they hit into the hemisphere, packets of 16")          \
    X(lookups_near, LOOKUPS, "load", "of 8 bytes from scattered places in 256 KiB a thread")       \
    X(memory_read, MEMORY, "B", "all of a added up; bytes read")                                   \
    X(memory_copy, MEMORY, "B", "a = b; bytes read and written")                                   \
    X(memory_triad, MEMORY, "B", "a = b + s c; bytes read and written")

enum calibration_kind { /* of work that is counted */
                        CALIBRATION_FILL,
                        CALIBRATION_TRIANGLES,
                        CALIBRATION_VERTICES,
                        CALIBRATION_CALLS,
                        CALIBRATION_SAMPLES,
                        CALIBRATION_RAYS,
                        CALIBRATION_LOOKUPS,
                        CALIBRATION_MEMORY
};

enum calibration_index {
#define CALIBRATION_ENUM(field, kind, unit, doc) CALIBRATION_##field,
    CALIBRATION_LIST(CALIBRATION_ENUM)
#undef CALIBRATION_ENUM
        CALIBRATION_COUNT
};

struct calibration_info {
    const char *field;
    enum calibration_kind kind;
    const char *unit, *doc;
};
extern const struct calibration_info calibration_table[CALIBRATION_COUNT];

/* The unit in which people read a rate of this kind, and what 1/s is multiplied by for it. */
const char *calibration_unit(enum calibration_kind kind, double *factor);

struct calibration_measure {
    struct interval rate;          /* units a second: median over repeats, 95 % interval; NaN: not
                                      measured */
    double fragments_per_triangle; /* mean; NaN where no triangle is counted */
};

struct calibration {
    int width_px, height_px; /* of the picture it was measured on */
    enum target_format format;
    int threads;
    int round;       /* of repetitions before which it was made; 0 outside of a run */
    double core_ghz; /* nominal; NaN: not known */
    double seconds;  /* that it took */
    const char *backend, *renderer;
    struct calibration_measure measures[CALIBRATION_COUNT];
};

struct calibrate_request {
    const char *backend;     /* NULL: the best there is */
    int threads;             /* 0: all */
    int width_px, height_px; /* each side is held in CALIBRATE_SIDE_MIN..CALIBRATE_SIDE_MAX */
    enum target_format format;
    double seconds; /* of measuring, about; setting up comes on top (half a second on llvmpipe) */
};
#define CALIBRATE_SIDE_MIN 128
#define CALIBRATE_SIDE_MAX 2048
#define CALIBRATE_SECONDS 4.0

/* The request as it is carried out: all threads counted, sides held. */
struct calibrate_request calibrate_held(const struct calibrate_request *request);

/* Measures in this process, every kind of work in turn, again and again, so that a slow moment of
 * the machine meets all kinds alike. Without OpenGL or without Embree its rates are NaN, and
 * error tells why OpenGL's are; STATUS_UNAVAILABLE when there is neither, or not the back end that
 * was asked for by name. Texts are in the arena. */
enum status calibrate_run(struct arena *arena, const struct calibrate_request *request,
                          struct calibration *calibration, struct error *error);

#endif
