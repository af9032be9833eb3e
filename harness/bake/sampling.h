/* 1, 4 or 16 samples a pixel, for a method that draws triangles. */
#ifndef TREELINE_BAKE_SAMPLING_H
#define TREELINE_BAKE_SAMPLING_H

#include "method/method.h"

enum { SAMPLING_PLACES_MAX = 16 };

/* clang-format off */
/* The row of a method's table for an int `samples`: a word, whose number sampling_count knows. */
#define SAMPLING_OPTION(type, fallback)                                                            \
    OPTION_WORD(type, samples, fallback, "1|4|16",                                                 \
        "samples a pixel: 4 are multisampled, 16 too where the driver has them, else 4 in 2 x 2 texels")
/* clang-format on */
static inline int sampling_count(int word)
{
    return 1 << 2 * word;
}

/* Where the samples of a texel lie in it, from its bottom left corner, in [0, 1]. */
struct sampling_places {
    int count;
    float at[SAMPLING_PLACES_MAX][2];
};

/* Of the bound framebuffer, which has so many samples a texel: 1 or a multisampled target's. */
struct sampling_places sampling_places_bound(struct gl *gl, int samples);

struct sampling;

/* samples: 1 draws into the target itself; 4 into a multisampled twin; 16 too where the driver has
 * so many, else into 4 samples of each of 2 x 2 texels. The twin is made by the first frame, which
 * knows its size. Varyings want `centroid`: at a pixel's centre outside a small triangle they run
 * wild. */
enum status sampling_prepare(struct workspace *workspace, int samples, struct sampling **sampling);

/* The twin has a stencil buffer; then one sample has a twin too. Before the first frame. */
void sampling_stencil(struct sampling *sampling);

/* The view with the size of what sampling_begin binds. */
struct view sampling_view(const struct sampling *sampling, const struct view *view);

/* Binds what is to be drawn into; drawn is view with its size. */
enum status sampling_begin(struct workspace *workspace, struct sampling *sampling,
                           const struct target *target, const struct view *view,
                           struct view *drawn);
/* Of each texel of what is bound. */
const struct sampling_places *sampling_places(const struct sampling *sampling);
/* Averages what was drawn into target. */
void sampling_end(struct workspace *workspace, const struct sampling *sampling,
                  const struct target *target);

#endif
