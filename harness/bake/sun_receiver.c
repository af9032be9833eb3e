/* Surfaces in the sun: who answers what reaches them. */
#include "bake/sun_receiver.h"
#include "bake/shadow_map.h"
#include "bake/sunlight_gl.h"

enum status sun_receiver_program(struct workspace *workspace, const struct sun_receiver *receiver,
                                 const char *name, const char *source, const char *defines,
                                 GLuint *program)
{
    if (receiver->sunlight)
        return sunlight_gl_program(workspace, receiver->sunlight, name, source, defines, program);
    return shadow_receiver_program(workspace, receiver->map, name, source, defines, program);
}

void sun_receiver_uniforms(struct workspace *workspace, const struct sun_receiver *receiver,
                           GLuint program)
{
    if (receiver->sunlight)
        sunlight_gl_uniforms(workspace, receiver->sunlight, program);
    shadow_receiver_uniforms(workspace, receiver->map, program);
}
