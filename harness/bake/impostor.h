/* Trees drawn as textured quads: what billboards and crossed quads share. The atlas, the trees on
 * the GL, their order, the state of the three ways to treat coverage. The shader's part is
 * impostor.glsl.
 *
 * What bounds them on llvmpipe with 2 threads, 800 x 600, 10,000 trees, a Xeon of 2026-11: the
 * blocks of 4 x 4 pixels that the fragment stage takes, whole, wherever a tree's outline touches
 * one. Seen from above billboards touch 86,000, 260 ns each (22 ms of the two threads' time; a
 * third of it fetches colour, a fifth light), beside 2.8 ms of corners and setup in the calling
 * thread; both threads never idle would be 12.3 ms a frame. Seen from the ground it is 174,000
 * blocks, 147 ns each on average, 57 ns where all of a block lies behind nearer trees. Drawn a
 * second time, when every tree is hidden by itself, a forest takes 0.7 to 0.9 of the first time:
 * blocks at holes and edges are shaded again. So fewer blocks (outlines) and cheaper ones (one
 * fetch) help; fewer draw calls or a faster sort (0.1 ms) do not. */
#ifndef TREELINE_BAKE_IMPOSTOR_H
#define TREELINE_BAKE_IMPOSTOR_H

#include "bake/atlas.h"
#include "bake/backdrop.h"
#include "bake/cull.h"
#include "bake/nearby.h"
#include "bake/shadow_choice.h"

/* Rotations of a tree that its light is computed for: 1.4 degrees apart. */
enum { IMPOSTOR_SUN_STEPS = 256 };

/* As impostor.glsl reads it. */
struct impostor_sunlight {
    float factors[4], rest, unused[3];
};

struct impostor {
    const struct scene *scene;
    const struct scene *tall; /* the same trees, of species as high as they are: impostor_tall.h */
    struct atlas *atlas;
    struct cull *cull;
    struct backdrop *backdrop;
    struct nearby *nearby;
    struct sun_shadows *shadows; /* NULL: none */
    enum atlas_alpha alpha;
    bool nearest;    /* texels of minified pictures */
    bool deep;       /* depth from the picture in each fragment */
    uint64_t texels; /* that a fragment takes */
    GLuint vertices; /* no attributes; the index buffer of fans */
    GLuint instances_buffer, order_buffer;
    GLuint stretches_buffer; /* what is left of each tree's stretch; 0: no tree is stretched */
    GLuint sunlights_buffer; /* pictures x IMPOSTOR_SUN_STEPS: what the sun makes of the channels */
    float sun_direction[3];  /* that sunlights_buffer holds; zeros: none yet */
    size_t fans_quad,
        fans_hull;      /* how many fans of 4 and of ATLAS_HULL corners the index buffer holds */
    struct target twin; /* of ATLAS_COVERAGE; made at the first draw */
    float area_m2;      /* mean silhouette area of the trees */
};

struct impostor_request {
    struct atlas_request atlas;
    size_t quads_each; /* a tree */
    int mixed;         /* pictures in a fragment; 0: 1 */
    float near_radii;  /* nearby.h */
    struct shadow_choice sun;
};

/* The scene's part: backdrop, atlas, trees, index buffer. */
enum status impostor_prepare(struct workspace *workspace, const struct scene *scene,
                             const struct impostor_request *request, struct impostor **impostor);

/* impostor.glsl and a source of the same stages, as one. */
const char *impostor_source(struct arena *arena, const char *source);
/* The scene's trees as impostor.glsl reads them: a buffer. */
GLuint impostor_trees(struct gl *gl, const struct scene *scene);
/* Their stretches, as it reads them with STRETCHED: a buffer. */
GLuint impostor_stretches(struct gl *gl, const struct scene *scene);

/* Links impostor.glsl and a method's own source; defines may be NULL. Adds ALPHA_TEST,
 * ALPHA_COVERAGE, DEPTH, PICTURE_DEPTH, FOG and what receives shadows. */
enum status impostor_program(struct workspace *workspace, const struct impostor *impostor,
                             const char *name, const char *source, const char *defines,
                             GLuint *program);

/* Draws a method's trees of a list with impostor_use and impostor_draw. */
typedef void impostor_trees_draw(struct workspace *workspace, const void *state,
                                 const struct view *view, const struct cull_list *list);
/* A picture, a method's draw: backdrop, near trees as triangles (before the others, or after them
 * where those are blended), the others, culled and sorted (back to front for blending, else front
 * to back), in the passes that its shadows want. Leaves the state that backdrop_draw leaves. where:
 * for an error of OpenGL. */
enum status impostor_picture(struct workspace *workspace, struct impostor *impostor,
                             const struct view *view, struct target *target,
                             impostor_trees_draw *draw, const void *state, const char *where);

/* Uses a program, with all uniforms and buffers set, trees [first, first + count) of the list to
 * come. */
void impostor_use(struct workspace *workspace, const struct impostor *impostor, GLuint program,
                  const struct view *view, size_t first);
/* Draws fans (corners: 3, 4 or ATLAS_HULL) with the program in use, a few thousand at a time, so
 * that a software GL fills some while it computes the corners of the next. */
void impostor_draw(struct workspace *workspace, const struct impostor *impostor, int corners,
                   size_t fans);

/* From this many pixels on the polygon of ATLAS_HULL corners costs less than the transparent
 * corners of a triangle. */
enum { IMPOSTOR_HULL_PX = 6000 };

/* How many trees at the near end of the list cover more than about area_px pixels each; no more
 * than there are hulls for, hulls_each a tree. */
size_t impostor_near_count(const struct impostor *impostor, const struct view *view,
                           const struct cull_list *list, float area_px, size_t hulls_each);

#endif
