/* The march's sun shadows (bake/march_shadow.h) as shaders read them: of each plant, as it is
 * turned, a volume of what reaches each place in it from the sun, and the light on each tree, for
 * what marches rays; the forest's map and the terrain, for what is lit as a surface. All is made by
 * the CPU when the sun has moved; an eye that moves costs nothing. */
#ifndef TREELINE_BAKE_SUNLIGHT_GL_H
#define TREELINE_BAKE_SUNLIGHT_GL_H

#include "bake/march.h"
#include "bake/march_tree.h"
#include "bake/voxels_gl.h"

struct sunlight_gl;

struct sunlight_gl_request {
    const struct voxels_gl *voxels;
    const struct march_tree *trees; /* one an instance */
    enum march_model model;
    int cells; /* of a volume along a plant's longest extent */
};
/* What the request names stays. STATUS_UNSUPPORTED where the driver has too small buffers. */
enum status sunlight_gl_prepare(struct workspace *workspace, const struct scene *scene,
                                const struct sunlight_gl_request *request,
                                struct sunlight_gl **sunlight);
/* Before each picture: makes everything anew where the sun has moved. */
enum status sunlight_gl_update(struct workspace *workspace, struct sunlight_gl *sunlight,
                               const struct view *view);

/* Where a shader finds a tree's light at a level of its voxels: four texels from 4 x volume on, and
 * corners of gains. */
struct sunlight_gl_place {
    uint32_t volume, gains;
};
struct sunlight_gl_place sunlight_gl_of(const struct sunlight_gl *sunlight, uint32_t tree,
                                        uint32_t level);
/* Share of the sun's light that is left, by its own shadow and the others', of what is seen of a
 * tree from far away, whose middle is at a place of the last updated view, px. */
float sunlight_gl_far(struct sunlight_gl *sunlight, uint32_t tree, const float at_px[2]);

/* Binds what a march reads, from this unit on: what passes (a byte a cell), gains (bytes of four
 * corners), volumes; and sets the uniform vec2 light_terms: columns of gains, cells that bark takes
 * its light nearer the sun. */
enum { SUNLIGHT_GL_UNITS = 3 };
void sunlight_gl_bind(struct workspace *workspace, const struct sunlight_gl *sunlight,
                      GLuint program, GLuint unit);

/* For surfaces: gl_program() with sunlight.glsl in front of the source and SHADOWED defined; and,
 * of the program in use, uniforms and textures. */
enum status sunlight_gl_program(struct workspace *workspace, const struct sunlight_gl *sunlight,
                                const char *name, const char *source, const char *defines,
                                GLuint *program);
void sunlight_gl_uniforms(struct workspace *workspace, const struct sunlight_gl *sunlight,
                          GLuint program);

#endif
