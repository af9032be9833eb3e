/* What stack.c and its neighbours share; methods include stack.h. */
#ifndef TREELINE_BAKE_STACK_BAKE_H
#define TREELINE_BAKE_STACK_BAKE_H

#include "bake/stack.h"

/* Fills stack->plants and stack->arrays: slices at every number of them, as textures. */
enum status stack_bake(struct workspace *workspace, struct stack *stack);
/* Bakes a moved sun into the colours anew; does nothing where it has not moved or is not baked. */
enum status stack_relight(struct workspace *workspace, struct stack *stack,
                          const float sun_direction[3]);
/* The steps that light is baked for: how many, and the stretches of the scene's trees. */
void stack_steps(struct workspace *workspace, struct stack *stack);
/* Which of stack->plants a tree is. */
size_t stack_plant_index(const struct stack *stack, const struct instance *instance);
/* What is baked into one of stack->plants, seen from the front and from behind: the sun and the
 * sky, then the sky alone, which only what receives shadows needs. */
enum { STACK_LIGHTS = 4 };
void stack_lights(const struct workspace *workspace, const struct stack *stack, size_t index,
                  struct slices_light lights[STACK_LIGHTS]);
/* The slices of a tree's species, of the nearest steps of its rotation and stretch.
 */
const struct stack_plant *stack_plant_of(const struct stack *stack,
                                         const struct instance *instance);

enum { STACK_BAND = 4 }; /* 1 / the part of an octave, or of a cosine, in which two change */

/* A tree's stack as stack.glsl reads it. Slice 0 is the nearest to the eye. */
struct stack_tree {
    float base_m[3], layer; /* world: texture coordinates 0, 0 of the front; layer of slice 0 */
    float u_m[3], step;     /* along the picture's width; to the next slice's layer */
    float v_m[3], count;    /* along its height; slices */
    float w_m[3], level;    /* to the next slice; mip level */
    float leaf_light[3];    /* plant's space: toward the sun, its y divided by the stretch */
    float power;            /* of each slice's transmittance */
    float bark_light[3], albedo_scale;
    float eye[3], rise; /* plant's space: toward the eye, 1 long along toward; 1 / stretch */
    float toward[3];
    uint32_t array; /* textures */
};

/* How far the corners of a part's box are moved, m; from slice 0's front to the last's back, each
 * (0, 0), (1, 0), (0, 1), (1, 1) in texture coordinates. */
struct stack_bend {
    float corners_m[8][4];
};

struct stack_quad {
    uint32_t tree;
    float slice;      /* 0: the nearest; between two it is interpolated */
    uint16_t rect[4]; /* left, bottom, right, top: half texels plus 1 */
};

/* A stack that shows a tree, or a share of it while two change places. */
struct stack_part {
    const struct stack_side *side;
    const struct stack_level *level;
    bool behind;
    float share;      /* of the tree's optical depth */
    float drawn;      /* slices; more than the level's are interpolated */
    float distance_m; /* of the eye, of the world over the tree's scale */
    float to_eye[3];  /* plant's space: unit, from the box's middle */
};

/* The parts of a tree, at most PARTS_MOST; those of a side follow each other. */
enum { PARTS_MOST = 6 };
int stack_parts(const struct stack *stack, const struct view *view, enum lod lod,
                const struct instance *instance, struct stack_part *parts);

/* What the shader needs of a part. */
void stack_tree_fill(const struct stack *stack, const struct view *view,
                     const struct instance *instance, const struct stack_part *part,
                     struct stack_tree *tree);

/* How a part's box is bent to stand on the terrain. */
void stack_bend_fill(const struct stack *stack, const struct instance *instance,
                     const struct stack_tree *tree, struct stack_bend *bend);

/* Quads of a run of count parts of one side, farthest first; part i is tree first_tree + i. Returns
 * how many: at most STACK_QUADS_MOST. */
enum { STACK_DENSER = 4, STACK_QUADS_MOST = 2 * STACK_DENSER * SLICES_MOST };
size_t stack_quads(const struct stack *stack, const struct stack_part *parts, int count,
                   const struct stack_tree *trees, uint32_t first_tree, struct stack_quad *quads);

/* The quad of one place between the slices of a part, 0 the nearest; false where nothing is. */
bool stack_quad_at(const struct stack *stack, const struct stack_part *part,
                   const struct stack_tree *tree, float place, struct stack_quad *quad);

/* Quads of a tree of one or two vertical parts and, last, perhaps a horizontal one, farthest first:
 * slices are cut where they meet those of a later part. At most STACK_CROSSED_MOST, as long as no
 * part has more than STACK_CROSSED_SLICES; and so many with another such set of half as many. */
enum { STACK_CROSSED_SLICES = 32, STACK_CROSSED_MOST = 41 * 1024 };
size_t stack_crossed_quads(const struct stack *stack, const struct stack_part *parts, int count,
                           const struct stack_tree *trees, uint32_t first_tree,
                           struct stack_quad *quads);

#endif
