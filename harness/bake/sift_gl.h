/* Drawing what sift.h leaves. */
#ifndef TREELINE_BAKE_SIFT_GL_H
#define TREELINE_BAKE_SIFT_GL_H

#include "bake/sift.h"
#include "method/method.h"

struct sift_gl {
    struct sift *sift; /* NULL: none */
    GLuint array, buffer;
};

/* Attributes 0 position, 1 normal, 2 albedo, as struct sift_vertex has them. */
void sift_gl_create(struct workspace *workspace, struct sift_gl *sifted);

/* The picture that sift_begin began, each stream with its program. */
void sift_gl_draw(struct workspace *workspace, const struct sift_gl *sifted,
                  const GLuint programs[SIFT_STREAMS]);

#endif
