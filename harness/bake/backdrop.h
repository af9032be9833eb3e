/* Sky and terrain, drawn the same way under every GL method, so that only the trees differ. */
#ifndef TREELINE_BAKE_BACKDROP_H
#define TREELINE_BAKE_BACKDROP_H

#include "method/method.h"

struct backdrop;

enum status backdrop_prepare(struct workspace *workspace, const struct scene *scene,
                             struct backdrop **backdrop);
/* Clears the bound framebuffer's colour and depth and draws sky and terrain with alpha 0. Leaves
 * depth test and depth write on, GL_LESS, blending off, no culling, viewport of the view. */
void backdrop_draw(struct workspace *workspace, struct backdrop *backdrop, const struct view *view);

/* Sets the uniforms of bake/shade.glsl on the program in use: view, eye, sun, ambient, fog, by the
 * workspace's effects. Call once a frame and program. */
void shade_uniforms(struct workspace *workspace, GLuint program, const struct scene *scene,
                    const struct view *view);

#endif
