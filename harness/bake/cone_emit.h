/* From a tree in a view down its hierarchy to strips: which level a twig is drawn at, and what it
 * is there. */
#ifndef TREELINE_BAKE_CONE_EMIT_H
#define TREELINE_BAKE_CONE_EMIT_H

#include "bake/cone_canvas.h"
#include "bake/cone_lanes.h"
#include "bake/cone_light.h"
#include "bake/cone_shade.h"
#include "bake/cone_strip.h"

enum cone_level { CONE_NEEDLE, CONE_CONE, CONE_TWIG, CONE_LEVELS };

struct cone_choice {
    int forced;               /* a level, or -1 */
    float needle_px, twig_px; /* needles at least so long are drawn one by one; shorter: by twigs */
    float limits_m[2];        /* the paper's lim1, lim2; 0: by size */
    float thin; /* twigs a pixel of a tree's outline; fewer, larger ones are drawn where
                   there are more; 0: all */
};

/* Constants of a picture. */
struct cone_picture {
    const struct view *view;
    const struct scene *scene;
    unsigned effects;
    float focal_px;
    float sun[3], ambient[3]; /* radiance of a white surface */
    float fog_density_per_m;
    struct cone_choice choice;
    enum cone_shaders shaders;
    void (*shade)(struct cone_lanes_job *job); /* twigs by lanes; NULL: one by one */
    struct cone_plant *const *plants;
    const struct cone_lights *lights; /* NULL: the sun has no shadows */
    const struct cone_canvas *canvas; /* what it hides is left out; NULL: nothing is */
};

/* An instance as the picture has it. Camera: right, up, forward. */
struct cone_tree {
    const struct cone_plant *plant;
    float to_camera[3][3], foot_m[3]; /* of a place in the plant's axes, scale included */
    float eye_m[3], sun[3];           /* in the plant's axes; the eye at scale 1 */
    float sun_camera[3];
    float scale;
    float twigs, barks;             /* how many of the first ones are drawn, the last one partly */
    float twigs_grown, barks_grown; /* how much more area each then has */
    uint32_t trunk_step;            /* so many pieces of a trunk are drawn as one */
    float fill;                     /* of opacities, but the trunk's (cone_outline_fill) */
    struct cone_tree_light light;
};
/* Whether anything within a sphere around a place of the camera's may be seen. */
bool cone_picture_sees(const struct cone_picture *picture, const float middle_m[3], float radius_m);
void cone_tree_of(const struct cone_picture *picture, size_t instance, struct cone_tree *tree);
/* How much of its plant is drawn where a metre of it is so many pixels. */
void cone_tree_thin(const struct cone_choice *choice, float px, struct cone_tree *tree);

/* Shares of the levels, which sum to 1. */
struct cone_mix {
    float shares[CONE_LEVELS];
};
struct cone_mix cone_mix_of(const struct cone_choice *choice, float needle_px, float distance_m);

/* The most strips that a twig can become no nearer than a depth. */
size_t cone_twig_most(const struct cone_picture *picture, const struct cone_tree *tree,
                      const struct cone_twig *twig, float depth_m);

/* Strips of a twig or a piece of bark; returns how many. sphere: of the twig's cones those alone
 * are wanted that touch a beam, or NULL: all. */
struct cone_beam {
    float origin_m[3], direction[3]; /* in the plant's axes; unit */
    float wide_m, spread;            /* its radius at the origin, and how that grows */
};
bool cone_beam_meets(const struct cone_beam *beam, const float center_m[3], float radius_m);
size_t cone_twig_emit(const struct cone_picture *picture, const struct cone_tree *tree, size_t twig,
                      const struct cone_beam *beam, struct cone_strip *strips);
/* All strips of some twigs, one after the other; ends: how many there are with each. */
void cone_twigs_emit(const struct cone_picture *picture, const struct cone_tree *tree, size_t first,
                     size_t count, struct cone_strip *strips, size_t ends[CONE_LANES]);
size_t cone_bark_emit(const struct cone_picture *picture, const struct cone_tree *tree, size_t bark,
                      struct cone_strip *strips);

/* Measures the outline of a plant that is drawn so: pictures of its twigs from around it; and of
 * all its needles, if they are not too many, for what it is to cover. */
void cone_outline_measure(const struct scene *scene, enum cone_shaders shaders,
                          const struct cone_choice *choice, int threads, struct cone_plant *plant);

#endif
