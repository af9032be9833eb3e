/* Stacks along the three axes, as Meyer and Neyret 1998 have them, or more directions: the options
 * that methods of them share, and what is requested by them. */
#ifndef TREELINE_BAKE_STACK_AXES_H
#define TREELINE_BAKE_STACK_AXES_H

#include "bake/stack.h"

struct stack_axes {
    int path; /* enum stack_path */
    int slices, resolution, directions, cut, samples, filter;
    float texel, near, distant;
    bool oblique, interpolate, smooth;
    struct shadow_choice sun;
};

enum stack_path { STACK_NAIVE, STACK_FAST };

/* clang-format off */
/* Rows of a method's table whose options hold a struct stack_axes `axes`. */
#define STACK_AXES_OPTIONS(type)                                                                   \
    OPTION_WORD_IN(type, axes, path, 1, "naive|fast",                                              \
        "naive: as published, every slice a whole trilinear quad, a draw a tree"),                 \
    OPTION_IN(type, axes, slices, 64, 1, 512, "", "slices along each of the directions"),          \
    OPTION_WORD_IN(type, axes, directions, 0, "3|7|13",                                            \
        "of slices: the axes; also a cube's diagonals; also those of its faces; of volumes the axes alone"), \
    OPTION_IN(type, axes, resolution, 128, 8, 512, "px", "texels along a picture's longer side"),  \
    OPTION_WORD_IN(type, axes, cut, 1, "clip|centroid",                                            \
        "leaves are cut by the slabs, or lie whole in that of their centroid"),                    \
    OPTION_IN(type, axes, samples, 4, 1, 8, "",                                                    \
        "samples along a texel's side when slices are baked"),                                     \
    OPTION_WORD_IN(type, axes, filter, 1, "trilinear|bilinear", "bilinear: of one mip level a tree"), \
    OPTION_IN(type, axes, texel, 1, 0.1, 16, "px", "largest size of minified texels on the picture"), \
    OPTION_IN(type, axes, near, 1, 0, 16, "radii",                                                 \
        "upright trees closer to the eye than so many of their radii are drawn by their triangles; " \
        "none on path=naive"),                                                                     \
    OPTION_IN(type, axes, distant, 16, 0, 32, "px",                                                \
        "at lod=auto, where the largest tree is smaller, trees are single pictures drawn by the CPU; " \
        "none on path=naive; 0: none"),                                                            \
    OPTION_IN(type, axes, oblique, 1, 0, 1, "",                                                    \
        "slices seen at a slant hide as much as the longer way through them; none on path=naive"), \
    OPTION_IN(type, axes, interpolate, 0, 0, 1, "",                                                \
        "up to four times the slices, by interpolation, where the criterion asks for more"),       \
    OPTION_IN(type, axes, smooth, 0, 0, 1, "",                                                     \
        "numbers of slices and directions change gradually, and trees become distant, or near, so; " \
        "with front, near at once"),                                                               \
    SHADOW_CHOICE_OPTIONS(type, axes.sun)
/* clang-format on */

/* What these options ask for; a method adds its own. */
struct stack_request stack_axes_request(const struct stack_axes *axes);

#endif
