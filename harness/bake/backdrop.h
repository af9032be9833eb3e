/* Sky and terrain, drawn the same way under every GL method, so that only the trees differ. */
#ifndef TREELINE_BAKE_BACKDROP_H
#define TREELINE_BAKE_BACKDROP_H

#include "bake/skyline.h"
#include "method/method.h"

struct backdrop;

enum status backdrop_prepare(struct workspace *workspace, const struct scene *scene,
                             struct backdrop **backdrop);
struct shadow_map;
struct shadow_pass;
struct sunlight_gl;
/* The ground receives the map's shadows from now on. */
enum status backdrop_receive(struct workspace *workspace, struct backdrop *backdrop,
                             const struct shadow_map *map);
/* The same of the march's light. */
enum status backdrop_receive_sunlight(struct workspace *workspace, struct backdrop *backdrop,
                                      const struct sunlight_gl *sunlight);
/* Before a map's passes for a view: ground that is drawn by levels of detail casts what the view
 * shows of it. True where that is not what cast before. */
bool backdrop_cast_view(struct workspace *workspace, const struct backdrop *backdrop,
                        const struct view *view);
/* The ground, where it is bent, as a caster of a shadow map's pass. */
void backdrop_cast(struct workspace *workspace, const struct backdrop *backdrop,
                   const struct shadow_pass *pass);
/* From now on the terrain, all of whose triangles are drawn, is in the shadow of its horizon maps.
 * mixed: of the two nearest
 * azimuths, else of the nearest, as Max 1988 has it. */
enum status backdrop_skyline(struct workspace *workspace, struct backdrop *backdrop,
                             const struct skyline *skyline, bool mixed);
/* Clears the bound framebuffer's colour and depth and draws sky and terrain with alpha 0. Leaves
 * depth test and depth write on, GL_LESS, blending off, no culling, viewport of the view. */
void backdrop_draw(struct workspace *workspace, struct backdrop *backdrop, const struct view *view);

/* Sets the uniforms of bake/shade.glsl on the program in use: view, eye, sun, ambient, fog, by the
 * workspace's effects. Call once a frame and program. */
void shade_uniforms(struct workspace *workspace, GLuint program, const struct scene *scene,
                    const struct view *view);

#endif
