/* Uploads of a plant's triangles. */
#include "bake/plant_gl.h"

#include <stddef.h>
#include <string.h>

static void attribute(struct gl *gl, GLuint array, GLuint location, GLuint binding, GLint size,
                      GLenum type, size_t offset)
{
    gl->VertexArrayAttribFormat(array, location, size, type, type != GL_FLOAT, (GLuint)offset);
    gl->VertexArrayAttribBinding(array, location, binding);
    gl->EnableVertexArrayAttrib(array, location);
}

/* Binding 0: vertices, 1: texture coordinates, 2: instances. */
static GLuint vertex_array(struct gl *gl, GLuint vertices, GLsizei stride, size_t normal_offset,
                           size_t albedo_offset, GLuint elements, GLuint placed)
{
    GLuint array = gl_vertex_array(gl);
    gl->VertexArrayVertexBuffer(array, 0, vertices, 0, stride);
    gl->VertexArrayVertexBuffer(array, 2, placed, 0, sizeof(struct plant_gl_placed));
    gl->VertexArrayBindingDivisor(array, 2, 1);
    gl->VertexArrayElementBuffer(array, elements);
    attribute(gl, array, 0, 0, 3, GL_FLOAT, 0);
    attribute(gl, array, 1, 0, 4, GL_SHORT, normal_offset);
    attribute(gl, array, 2, 0, 4, GL_UNSIGNED_SHORT, albedo_offset);
    attribute(gl, array, 5, 2, 4, GL_FLOAT, offsetof(struct plant_gl_placed, foot_m));
    attribute(gl, array, 6, 2, 4, GL_FLOAT, offsetof(struct plant_gl_placed, turn));
    attribute(gl, array, 8, 2, 2, GL_FLOAT, offsetof(struct plant_gl_placed, stretch));
    return array;
}

/* At full resolution only: a texel's alpha decides as in the reference, and samples average the
 * result. */
static GLuint upload_texture(struct gl *gl, const struct texture *texture)
{
    GLuint name =
        gl_texture(gl, GL_TEXTURE_2D, 1, GL_RGBA16F, texture->width_px, texture->height_px, 1);
    gl->TextureSubImage2D(name, 0, 0, 0, texture->width_px, texture->height_px, GL_RGBA, GL_FLOAT,
                          texture->rgba);
    gl->TextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl->TextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    return name;
}

void plant_gl_detail(struct workspace *workspace, const struct detail *detail,
                     const struct levels *levels, GLuint placed, struct plant_gl *plant)
{
    struct gl *gl = workspace->gl;
    GLuint vertices = gl_buffer(gl, (GLsizeiptr)(detail->vertices_count * sizeof *detail->vertices),
                                detail->vertices, 0);
    GLuint elements = gl_buffer(gl, (GLsizeiptr)(detail->indices_count * sizeof *detail->indices),
                                detail->indices, 0);
    plant->detail =
        vertex_array(gl, vertices, sizeof *detail->vertices, offsetof(struct detail_vertex, normal),
                     offsetof(struct detail_vertex, albedo), elements, placed);
    if (detail->uvs) {
        GLuint uvs = gl_buffer(gl, (GLsizeiptr)(detail->vertices_count * sizeof *detail->uvs),
                               detail->uvs, 0);
        gl->VertexArrayVertexBuffer(plant->detail, 1, uvs, 0, sizeof *detail->uvs);
        attribute(gl, plant->detail, 3, 1, 2, GL_FLOAT, 0);
    }
    plant->batches_count = detail->batches_count;
    plant->batches = ARENA_ARRAY(workspace->arena, struct plant_gl_batch, detail->batches_count);
    for (size_t b = 0; b < detail->batches_count; b++) {
        const struct detail_batch *from = &detail->batches[b];
        struct plant_gl_batch *batch = &plant->batches[b];
        *batch = (struct plant_gl_batch){.kind = from->kind,
                                         .thin = from->thin,
                                         .flat = from->flat,
                                         .closed = from->closed,
                                         .texture =
                                             from->texture ? upload_texture(gl, from->texture) : 0};
        memcpy(batch->levels, from->levels, sizeof batch->levels);
        for (uint32_t s = 0; s < levels->steps_count && from->kind == MATERIAL_BARK; s++)
            batch->stout[s] = detail_stout(detail, b, levels->step_bark[s], levels->step_stout[s]);
    }
}

void plant_gl_pruned(struct workspace *workspace, const struct prune *prune, GLuint placed,
                     struct plant_gl *plant)
{
    struct gl *gl = workspace->gl;
    struct arena *passing = arena_create(0);
    size_t corners = 3 * prune->count;
    uint32_t *indices = ARENA_ARRAY(passing, uint32_t, 2 * corners);
    for (size_t i = 0; i < 2 * corners; i++)
        indices[i] = (uint32_t)(i < corners ? i : i - corners);
    GLuint vertices =
        gl_buffer(gl, (GLsizeiptr)(corners * sizeof *prune->vertices), prune->vertices, 0);
    GLuint elements = gl_buffer(gl, (GLsizeiptr)(2 * corners * sizeof *indices), indices, 0);
    plant->pruned =
        vertex_array(gl, vertices, sizeof *prune->vertices, offsetof(struct prune_vertex, normal),
                     offsetof(struct prune_vertex, albedo), elements, placed);
    attribute(gl, plant->pruned, 4, 0, 3, GL_FLOAT, offsetof(struct prune_vertex, center_m));
    attribute(gl, plant->pruned, 7, 2, 2, GL_FLOAT, offsetof(struct plant_gl_placed, begin));
    arena_destroy(passing);
}
