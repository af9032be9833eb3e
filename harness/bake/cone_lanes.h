/* The exact shaders of twigs (bake/needles.h), of many twigs at once: a lane a twig. Exponentials,
 * logarithms and error functions are the lanes' own, to about 1e-6; every set of lanes gives the
 * same bits. */
#ifndef TREELINE_BAKE_CONE_LANES_H
#define TREELINE_BAKE_CONE_LANES_H

#include <stdbool.h>
#include <stddef.h>

enum { CONE_LANES = 8 };

/* Twigs in, what they look like out. All lanes hold twigs; all directions are unit, in the axes of
 * each twig. */
struct cone_lanes_job {
    float exponent;                                   /* below 0: no specular wanted */
    bool shaded;                                      /* whether a twig shades itself */
    float sine[CONE_LANES], cosine[CONE_LANES];       /* of phi */
    float area_m2[CONE_LANES];                        /* r l of all needles */
    float radius_m[CONE_LANES], length_m[CONE_LANES]; /* of the cylinder that they fill */
    float light[3][CONE_LANES], eye[3][CONE_LANES];
    /* Of the half nearer to the eye and of the other one. */
    float seen[2][CONE_LANES]; /* mean sine between needle and eye */
    float diffuse[2][CONE_LANES], specular[2][CONE_LANES];
    float depths[2][CONE_LANES], light_depths[2][CONE_LANES]; /* of the disc */
    float disc_seen[2][CONE_LANES], disc_lit[2][CONE_LANES];  /* shares of its width */
    float disc_cosine[CONE_LANES], disc_sine[CONE_LANES];
    float axis_diffuse[CONE_LANES]; /* of the twig's axis (2) */
};

struct cone_isa {
    const char *name;
    void (*shade)(struct cone_lanes_job *job);
};
void cone_shade_plain(struct cone_lanes_job *job);
void cone_shade_avx2(struct cone_lanes_job *job);
/* Those that this processor has, the fastest last; returns how many. */
size_t cone_isas(struct cone_isa isas[2]);

#endif
