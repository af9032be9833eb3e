/* What shades a surface by OpenGL: a shadow map, the march's light, or nothing. */
#ifndef TREELINE_BAKE_SUN_RECEIVER_H
#define TREELINE_BAKE_SUN_RECEIVER_H

#include "method/method.h"

struct shadow_map;
struct sunlight_gl;

/* One of them, or none. */
struct sun_receiver {
    const struct shadow_map *map;
    const struct sunlight_gl *sunlight;
};

static inline bool sun_receiver_is_shaded(const struct sun_receiver *receiver)
{
    return receiver->map || receiver->sunlight;
}

/* gl_program() of a source that asks SHADOW_VISIBILITY() where SHADOWED is defined. */
enum status sun_receiver_program(struct workspace *workspace, const struct sun_receiver *receiver,
                                 const char *name, const char *source, const char *defines,
                                 GLuint *program);
/* Of the program in use. */
void sun_receiver_uniforms(struct workspace *workspace, const struct sun_receiver *receiver,
                           GLuint program);

#endif
