/* A conifer as cones of pixels meet it: pieces of bark and twigs in one order in which any
 * beginning is a fair sample of all, with what of a twig does not depend on the view. */
#ifndef TREELINE_BAKE_CONE_PLANT_H
#define TREELINE_BAKE_CONE_PLANT_H

#include "bake/cone_outline.h"
#include "bake/needles.h"
#include "base/arena.h"
#include "plant/conifer.h"

struct cone_bark {
    float from_m[3], to_m[3], radius_m[2];
    uint32_t place, pieces; /* along its branch, of so many */
};

struct cone_twig {
    float base_m[3], axis[3], across[3], along[3];
    float cone_0_m;      /* where the first cone stands along the axis */
    float length_m;      /* cones_count x spacing */
    float radius_m;      /* of the cylinder that its needles fill */
    float sine, cosine;  /* of phi */
    uint32_t first_cone; /* among the cones of the plant */
    const struct conifer_twig *twig;
};

struct cone_plant {
    const struct conifer *conifer;
    size_t barks_count, trunks_count; /* the first so many barks are always drawn */
    struct cone_bark *barks;
    float piece_m;      /* about as long as they are */
    float *barks_areas; /* sums of length x width of the first so many behind the trunks */
    size_t twigs_count;
    struct cone_twig *twigs;
    float *twigs_areas; /* sums of length x width of the first so many; count + 1 */
    size_t cones_count;
    float center_m[3], radius_m; /* of a sphere that holds all */
    float low_m, high_m;         /* heights */
    float area_m2;               /* of its outline from the side, about */
    struct cone_outline outline; /* filled by cone_outline_measure; else nothing is lowered */
};

struct cone_plant *cone_plant_create(struct arena *arena, const struct conifer *conifer);

/* As the shaders want a twig. */
static inline struct needles_twig cone_twig_shape(const struct cone_twig *twig)
{
    return (struct needles_twig){twig->sine,
                                 twig->cosine,
                                 (float)twig->twig->needles_count,
                                 twig->twig->needle_length_m,
                                 twig->twig->needle_radius_m,
                                 twig->twig->spacing_m,
                                 twig->radius_m};
}

/* Largest distance of a twig's matter from the middle of its axis. */
float cone_twig_reach(const struct cone_twig *twig, float center_m[3]);

#endif
