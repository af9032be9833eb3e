/* Buffers and draws of what sifting leaves. */
#include "bake/sift_gl.h"

#include <stddef.h>

/* Of each stream of a thread, drawn at a time. */
enum { TRIANGLES_ROOM = 1 << 15 };

static GLsizeiptr bytes_of(const struct sift *sift)
{
    return (GLsizeiptr)(sift_vertices_count(sift) * sizeof(struct sift_vertex));
}

void sift_gl_create(struct workspace *workspace, struct sift_gl *sifted)
{
    struct gl *gl = workspace->gl;
    sifted->sift = sift_create(workspace->arena, workspace->threads, TRIANGLES_ROOM);
    sifted->buffer = gl_buffer(gl, bytes_of(sifted->sift), NULL, GL_MAP_WRITE_BIT);
    GLuint array = sifted->array = gl_vertex_array(gl);
    static const size_t offsets[3] = {offsetof(struct sift_vertex, position_m),
                                      offsetof(struct sift_vertex, normal),
                                      offsetof(struct sift_vertex, albedo)};
    static const GLenum types[3] = {GL_FLOAT, GL_SHORT, GL_UNSIGNED_SHORT};
    gl->VertexArrayVertexBuffer(array, 0, sifted->buffer, 0, sizeof(struct sift_vertex));
    for (GLuint i = 0; i < 3; i++) {
        gl->VertexArrayAttribFormat(array, i, i ? 4 : 3, types[i], i > 0, (GLuint)offsets[i]);
        gl->VertexArrayAttribBinding(array, i, 0);
        gl->EnableVertexArrayAttrib(array, i);
    }
}

static void draw_streams(struct gl *gl, const struct sift_gl *sifted,
                         const GLuint programs[SIFT_STREAMS])
{
    gl->BindVertexArray(sifted->array);
    for (int stream = 0; stream < SIFT_STREAMS; stream++) {
        bool begun = false;
        for (int thread = 0; thread < sift_threads(sifted->sift); thread++) {
            struct sift_span span = sift_left(sifted->sift, stream, thread);
            if (span.count == 0)
                continue;
            if (!begun)
                gl->UseProgram(programs[stream]);
            begun = true;
            gl_draw_arrays(gl, GL_TRIANGLES, (GLint)span.first, (GLsizei)span.count, 1);
        }
    }
}

void sift_gl_draw(struct workspace *workspace, const struct sift_gl *sifted,
                  const GLuint programs[SIFT_STREAMS])
{
    struct gl *gl = workspace->gl;
    for (bool left = true; left;) {
        struct sift_vertex *vertices =
            gl->MapNamedBufferRange(sifted->buffer, 0, bytes_of(sifted->sift),
                                    GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT);
        left = sift_fill(sifted->sift, vertices);
        gl->UnmapNamedBuffer(sifted->buffer);
        if (left)
            draw_streams(gl, sifted, programs);
    }
}
