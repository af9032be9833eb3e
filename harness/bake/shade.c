/* The uniforms of bake/shade.glsl: a view in its light. */
#include "bake/backdrop.h"

void shade_uniforms(struct workspace *workspace, GLuint program, const struct scene *scene,
                    const struct view *view)
{
    struct gl *gl = workspace->gl;
    static const float none[3] = {0, 0, 0};
    unsigned effects = workspace->effects;
    const float *ambient = effects & EFFECT_AMBIENT ? scene->ambient : none;
    gl->UniformMatrix4fv(gl_uniform(gl, program, "view_projection"), 1, GL_FALSE,
                         view->view_projection[0]);
    gl->Uniform3fv(gl_uniform(gl, program, "eye_m"), 1, view->eye_m);
    gl->Uniform3fv(gl_uniform(gl, program, "sun_direction"), 1, view->sun_direction);
    gl->Uniform3fv(gl_uniform(gl, program, "sun_radiance"), 1, scene->sun.radiance);
    gl->Uniform3fv(gl_uniform(gl, program, "ambient"), 1, ambient);
    gl->Uniform3fv(gl_uniform(gl, program, "fog_color"), 1, scene->fog.color);
    gl->Uniform1f(gl_uniform(gl, program, "fog_density"),
                  effects & EFFECT_FOG && !workspace->masked ? scene->fog.density_per_m : 0);
    gl->Uniform1i(gl_uniform(gl, program, "masked"), workspace->masked);
    gl->Uniform1i(gl_uniform(gl, program, "two_sided"), (effects & EFFECT_TWO_SIDED) != 0);
}
