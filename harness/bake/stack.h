/* Forests drawn as stacks of slices with OpenGL: textures, choice of stack and number of slices for
 * each tree, drawing. Senegas 2001; Meyer and Neyret 1998, doi:10.1007/978-3-7091-6453-2_15;
 * Rezk-Salama et al. 2000, doi:10.1145/346876.348238 (interpolated slices).
 *
 * A tree is drawn by the stack that most faces the eye, its slices as quads that OpenGL blends,
 * back to front. Following all slices along a ray in one fragment was tried and left: the same
 * picture took 24 ms for one slice a tree instead of 9 (1,000 poplars, llvmpipe). */
#ifndef TREELINE_BAKE_STACK_H
#define TREELINE_BAKE_STACK_H

#include "bake/backdrop.h"
#include "bake/cull.h"
#include "bake/distant.h"
#include "bake/nearby.h"
#include "bake/shadow_choice.h"
#include "bake/slices.h"
#include "bake/stack_front.h"
#include "bake/stack_near.h"

/* How boxes stand on the terrain: upright, as trees do; with the four points of their base on it;
 * with their tops as high above it along its normals (Meyer and Neyret 1998: boxes of 2 x 4 points
 * on the patches of a surface). Slices are interpolated between the points. */
enum stack_ground { GROUND_UPRIGHT, GROUND_BASE, GROUND_PATCH };

/* Which stacks show a tree.
 * one:     the one that most faces the eye.
 * mixed:   of vertical ones the two nearest to the eye, weighted by the angle to them, one after
 *          the other though their slices cross (Jakulin 2000).
 * crossed: the same, the slices of the one cut at those of the other, all of it in order. */
enum stack_mix { STACK_ONE, STACK_MIXED, STACK_CROSSED };

struct stack_request {
    struct slices_request bake; /* width_px and height_px: 0, made from resolution_px */
    int resolution_px;          /* texels along a picture's longer side */
    bool square;                /* as many along the other one; else texels are about square */
    bool straight;              /* colours are filtered without their coverage */
    bool dilate;                /* empty texels get their neighbours' colour and normal */
    bool unit;                  /* normals get length 1 after filtering */
    bool trilinear;             /* else the nearest mip level, chosen a tree */
    bool rectangles;            /* quads hold only the occupied rectangle of a slice */
    float near_radii;           /* nearer trees are drawn by their triangles; 0: none */
    float near_octaves;         /* over which they become so, with groups = 0; 0: at once */
    bool each;                  /* one draw a tree */
    int groups; /* of trees, front to back, saturated pixels closed after each; 0: back to front */
    int turns;  /* light is baked into the colours for trees turned by so many steps, and for every
                   step of their stretch; 0: light in every fragment */
    enum stack_ground ground;
    bool rough;         /* normals that scatter in a texel spread its light */
    bool facing;        /* leaves show the area that they turn to the eye */
    bool oblique;       /* slices are as dense as the way of a slanted ray through them is long */
    bool interpolate;   /* more slices than there are, between two each */
    bool smooth;        /* no jump between numbers of slices, stacks and distant pictures */
    float criterion_px; /* C2: parallax between two slices, px; 0: without it */
    float criterion_texels; /* C1: gap between two slices along them, texels; 0: without it */
    float texel_px;         /* mip level: texels are about this large on the picture */
    float distant_px;       /* at lod=auto, where the largest tree is smaller, trees are pictures
                               drawn by the CPU; 0: none is. Not on GROUND_BASE and GROUND_PATCH,
                               and not in shadows */
    struct shadow_choice sun;
    enum stack_mix mix;
    bool above; /* mixed, crossed: the last direction is +y, its stack's share of a tree grows from
                   an elevation of the eye of 30 degrees to 1 at 90 */
};

/* Of the distance, over which slices turn into triangles where that is gradual. */
#define STACK_NEAR_OCTAVES 0.5f

/* Steps of a tree's stretch that light is baked for, as those of turns: a quarter of an octave,
 * from 1/8 to 8. */
enum { STACK_TALLS = 25 };

/* Every level halves the number of slices of the one before. */
enum { STACK_LEVELS = 10 };

/* A stack of one plant at one number of slices. */
struct stack_level {
    int count;
    float low_m, high_m;  /* of the box along toward */
    int layer[2];         /* the hindmost slice's; 1: as fused from behind */
    struct slice *slices; /* count */
};

struct stack_side {
    struct slices_stack frame;
    size_t array; /* textures */
    int levels_count;
    struct stack_level levels[STACK_LEVELS];
};

struct stack_plant {
    struct stack_side *sides;    /* directions_count */
    float albedo_scale, texel_m; /* a texel's size */
    struct cull_bound bound;
};

struct stack_array {
    GLuint color, normal; /* normal: of light that is baked in, colours in the shade or 0 */
    int width_px, height_px, layers, levels;
};

struct stack {
    const struct scene *scene;
    struct stack_request request;
    size_t plants_count, arrays_count;
    size_t steps_count;         /* of turns and of stretches; 1 where light is not baked in */
    float *stretches;           /* species x STACK_TALLS: what those are baked for; 0: no tree */
    struct stack_plant *plants; /* species x steps */
    struct stack_array *arrays;
    struct backdrop *backdrop;
    struct cull *cull;
    struct nearby *nearby;
    struct sun_shadows *shadows; /* NULL: none */
    struct distant *distant;     /* NULL: no tree is */
    struct stack_front *front;   /* NULL: back to front */
    struct stack_near *turning;  /* to triangles; NULL: no tree does so gradually */
    GLuint program, vertices, trees_buffer, quads_buffer;
    GLuint bends_buffer;      /* 0: upright */
    struct stack_bend *bends; /* of stack_bake.h, as trees */
    float sun_direction[3];   /* that is baked in */
    struct stack_tree *trees; /* stack_bake.h: the parts of one batch */
    struct stack_quad *quads; /* theirs */
};

/* Bakes or finds the slices of every species, makes textures, programs, buffers. */
enum status stack_prepare(struct workspace *workspace, const struct scene *scene,
                          const struct stack_request *request, struct stack **stack);

/* Light and shadows for the view's sun, then the target bound and the backdrop in it; a method may
 * add what is opaque before the forest. */
enum status stack_backdrop(struct workspace *workspace, struct stack *stack,
                           const struct view *view, struct target *target);
/* The forest into the target, which is bound. */
enum status stack_trees(struct workspace *workspace, struct stack *stack, const struct view *view,
                        const struct target *target);
/* Both. */
enum status stack_draw(struct workspace *workspace, struct stack *stack, const struct view *view,
                       struct target *target);

#endif
