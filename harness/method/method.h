/* The contract of a method: everything that a file in methods/ has to know. */
#ifndef TREELINE_METHOD_METHOD_H
#define TREELINE_METHOD_METHOD_H

#include "base/arena.h"
#include "base/error.h"
#include "base/option.h"
#include "scene/scene.h"
#include "wall/gl.h"

#define METHOD_ABI 5u

/* What a method is and which effects it models. The low bits are EFFECT_*. */
enum {
    TRAIT_CPU = 1u << 16, /* draws into target->pixels; workspace->gl is NULL */
    TRAIT_STOCHASTIC =
        1u << 17, /* its noise depends on the seed; still the same bytes for the same seed */
    TRAIT_NO_TREES = 1u << 18, /* sky and terrain alone: a floor for the others */
    TRAIT_MASK = 1u << 19,     /* heeds workspace->masked */
};

/* What a frame did of that which the harness cannot count itself; a method adds to
 * workspace->tally (workspace->tally.rays += ...). With the machine's calibrated rates it tells
 * what bounds a cell (results/limit.h), so count what any program with this algorithm had to do,
 * not waste. The harness takes the difference over a draw that it marks by workspace->counted; for
 * the same view the same figures; what stays 0 is not counted. A method without OpenGL may count in
 * every draw, summed in its threads first, so that counting costs no time; one with OpenGL counts
 * in counted draws alone (bake/tally.h). */
struct method_tally {
    uint64_t rays;           /* to the nearest triangle (embree_intersect), lanes, not packets */
    uint64_t occlusion_rays; /* to any triangle (embree_occluded); rays are the CPU's alone */
    uint64_t lookups;        /* loads of up to 8 bytes from places that rays or pixels decide: a
                                voxel, a texel, a corner of a filter, a node; each lane for itself;
                                of a shader also texels that it fetches unfiltered */
    uint64_t samples;        /* texels that OpenGL filtered for a shader, bilinear or more */
    uint64_t bytes; /* that the frame must read or write, each counted once however often it
                       is used; without the picture, which the harness adds */
    /* Of counted draws alone; a method that knows may wait for OpenGL in them. */
    double shadow_seconds; /* making all shadows (maps, volumes) once; not shading */
    uint64_t shadow_bytes; /* that shadows hold: maps, volumes; of one draw, not a sum of parts */
};

/* Lives as long as the cell; nothing to free. */
struct workspace {
    struct arena *arena; /* all host memory, counted as host_bytes */
    struct gl *gl;       /* all GL objects, counted as device_bytes; NULL for a CPU method */
    struct error *error;
    unsigned effects; /* to draw: the scene's wanted ones that the method has, as its options are */
    enum lod lod;
    enum target_format format; /* of every target that will come */
    int threads;               /* that a CPU method may use, and llvmpipe uses */
    uint64_t seed;
    struct method_tally tally; /* of all frames so far */
    bool counted;              /* this draw is neither timed nor seen: time for a tally by OpenGL */
    bool masked; /* with TRAIT_MASK: this draw shows where the sun shines (scene/effects.h, the
                    shadow mask) in place of light; not timed. bake/shade.glsl heeds it */
};

struct method {          /* its name is its file's name, '-' written '_' in C */
    unsigned abi;        /* METHOD_ABI, first, so that an old plugin is refused */
    const char *name;    /* as in `--method NAME` */
    const char *summary; /* one line, for list and docs */
    const char *source;  /* authors, title, year, DOI */
    unsigned traits;
    const struct option *options; /* ends with OPTION_END; NULL: none */
    size_t options_size;
    /* Optional: those of the traits' effects that are left with these options; NULL: all. */
    unsigned (*effects)(const void *options);
    /* Optional. STATUS_UNSUPPORTED with *reason when this scene cannot be drawn. */
    enum status (*supported)(const struct scene *scene, const char **reason);
    /* Everything that does not depend on the view; timed cold as build_seconds. */
    enum status (*prepare)(struct workspace *workspace, const struct scene *scene,
                           const void *options, void **state);
    /* One picture: sky, terrain and trees, every pixel of target. Relights when view->sun_direction
     * differs from the last call's. Must not wait for the GPU: the harness finishes and stops the
     * clock. Leaves OpenGL's state as it found it, but for bindings, blend function and depth
     * test. */
    enum status (*draw)(struct workspace *workspace, void *state, const struct view *view,
                        struct target *target);
};

/* A method's `supported` where its light or its shapes are right in trees of their plant's ratio of
 * height to width alone. */
enum status method_needs_no_stretch(const struct scene *scene, const char **reason);

/* The methods built in, sorted by name; generated from the file names in methods/. Ends with NULL.
 */
extern const struct method *const methods_builtin[];

/* A built-in method by name, or a plugin by the path of its shared object (a name with '/' or
 * ".so"). STATUS_NOT_FOUND names the nearest; an object built for another ABI, or without the
 * symbol, is STATUS_INVALID; one that crashes, leaves or hangs while it is loaded is STATUS_CRASH
 * or STATUS_TIMEOUT. */
enum status method_find(const char *name, const struct method **method, struct error *error);

/* The effects of those wanted that a method draws with its options. */
static inline unsigned method_effects(const struct method *method, const void *options,
                                      unsigned wanted)
{
    unsigned left = method->effects ? method->effects(options) : EFFECTS_ALL;
    return wanted & left & method->traits & EFFECTS_ALL;
}

#endif
