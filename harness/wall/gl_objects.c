/* Counted OpenGL objects, counted draws, statistics and the GPU timer. */
#include "wall/gl_load.h"

#include <string.h>

GLuint gl_books_add(struct gl *gl, enum gl_kind kind, GLuint name, size_t bytes)
{
    struct gl_books *books = gl->books;
    if (books->objects_count == books->objects_room) {
        size_t room = books->objects_room ? 2 * books->objects_room : 64;
        struct gl_object *objects = ARENA_ARRAY(books->arena, struct gl_object, room);
        if (books->objects_count)
            memcpy(objects, books->objects, books->objects_count * sizeof *objects);
        books->objects = objects;
        books->objects_room = room;
    }
    books->objects[books->objects_count++] = (struct gl_object){kind, name, bytes};
    books->device_bytes += bytes;
    return name;
}

static void delete_object(struct gl *gl, enum gl_kind kind, GLuint name)
{
    switch (kind) {
    case GL_KIND_BUFFER:
        gl->DeleteBuffers(1, &name);
        break;
    case GL_KIND_TEXTURE:
        gl->DeleteTextures(1, &name);
        break;
    case GL_KIND_FRAMEBUFFER:
        gl->DeleteFramebuffers(1, &name);
        break;
    case GL_KIND_VERTEX_ARRAY:
        gl->DeleteVertexArrays(1, &name);
        break;
    case GL_KIND_PROGRAM:
        gl->DeleteProgram(name);
        break;
    }
}

/* Deletes one object; a name that is not in the books (0 too) is left alone. */
static void books_remove(struct gl *gl, enum gl_kind kind, GLuint name)
{
    struct gl_books *books = gl->books;
    for (size_t i = books->objects_count; i-- > 0;) {
        struct gl_object *object = &books->objects[i];
        if (object->kind != kind || object->name != name)
            continue;
        delete_object(gl, kind, name);
        books->device_bytes -= object->bytes;
        *object = books->objects[--books->objects_count];
        return;
    }
}

void gl_books_clear(struct gl *gl)
{
    struct gl_books *books = gl->books;
    gl->BindFramebuffer(GL_FRAMEBUFFER, 0);
    gl->UseProgram(0);
    gl->BindVertexArray(0);
    while (books->objects_count > 0) {
        struct gl_object *object = &books->objects[--books->objects_count];
        delete_object(gl, object->kind, object->name);
    }
    books->device_bytes = 0;
    if (books->statistics_queries[0])
        gl->DeleteQueries(3, books->statistics_queries);
    if (books->timer_query)
        gl->DeleteQueries(1, &books->timer_query);
}

size_t gl_device_bytes(const struct gl *gl)
{
    return gl->books->device_bytes;
}

GLuint gl_buffer(struct gl *gl, GLsizeiptr size_bytes, const void *data, GLbitfield storage_flags)
{
    GLuint name;
    gl->CreateBuffers(1, &name);
    /* Storage of 0 bytes is an error in OpenGL; an empty forest is none. */
    gl->NamedBufferStorage(name, size_bytes > 0 ? size_bytes : 1, size_bytes > 0 ? data : NULL,
                           storage_flags);
    return gl_books_add(gl, GL_KIND_BUFFER, name, size_bytes > 0 ? (size_t)size_bytes : 1);
}

/* Bytes of a texture's level by the sizes that the driver gives its channels. */
static size_t level_bytes(struct gl *gl, GLuint texture, int level)
{
    static const GLenum sizes[] = {GL_TEXTURE_RED_SIZE,   GL_TEXTURE_GREEN_SIZE,
                                   GL_TEXTURE_BLUE_SIZE,  GL_TEXTURE_ALPHA_SIZE,
                                   GL_TEXTURE_DEPTH_SIZE, GL_TEXTURE_STENCIL_SIZE,
                                   GL_TEXTURE_SHARED_SIZE};
    GLint compressed = 0, width = 0, height = 0, depth = 0, bits = 0;
    gl->GetTextureLevelParameteriv(texture, level, GL_TEXTURE_COMPRESSED, &compressed);
    if (compressed) {
        GLint bytes = 0;
        gl->GetTextureLevelParameteriv(texture, level, GL_TEXTURE_COMPRESSED_IMAGE_SIZE, &bytes);
        return (size_t)bytes;
    }
    gl->GetTextureLevelParameteriv(texture, level, GL_TEXTURE_WIDTH, &width);
    gl->GetTextureLevelParameteriv(texture, level, GL_TEXTURE_HEIGHT, &height);
    gl->GetTextureLevelParameteriv(texture, level, GL_TEXTURE_DEPTH, &depth);
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        GLint size = 0;
        gl->GetTextureLevelParameteriv(texture, level, sizes[i], &size);
        bits += size;
    }
    return (size_t)width * (size_t)height * (size_t)(depth > 0 ? depth : 1) * (size_t)bits / 8;
}

static size_t texture_bytes(struct gl *gl, GLuint texture)
{
    enum { LEVELS_MAX = 15 };
    GLint target = 0, levels = 0, samples = 0;
    size_t bytes = 0;
    gl->GetTextureParameteriv(texture, GL_TEXTURE_TARGET, &target);
    if (target == 0) { /* no question for a buffer texture; its buffer is counted */
        gl->GetError();
        return 0;
    }
    gl->GetTextureParameteriv(texture, GL_TEXTURE_IMMUTABLE_LEVELS, &levels);
    for (int level = 0; level < (levels ? levels : LEVELS_MAX); level++)
        bytes += level_bytes(gl, texture, level) * (target == GL_TEXTURE_CUBE_MAP ? 6 : 1);
    gl->GetTextureLevelParameteriv(texture, 0, GL_TEXTURE_SAMPLES, &samples);
    return bytes * (samples > 1 ? (size_t)samples : 1);
}

static size_t renderbuffer_bytes(struct gl *gl, GLuint buffer)
{
    static const GLenum sizes[] = {GL_RENDERBUFFER_RED_SIZE,   GL_RENDERBUFFER_GREEN_SIZE,
                                   GL_RENDERBUFFER_BLUE_SIZE,  GL_RENDERBUFFER_ALPHA_SIZE,
                                   GL_RENDERBUFFER_DEPTH_SIZE, GL_RENDERBUFFER_STENCIL_SIZE};
    GLint width = 0, height = 0, samples = 0, bits = 0;
    gl->GetNamedRenderbufferParameteriv(buffer, GL_RENDERBUFFER_WIDTH, &width);
    gl->GetNamedRenderbufferParameteriv(buffer, GL_RENDERBUFFER_HEIGHT, &height);
    gl->GetNamedRenderbufferParameteriv(buffer, GL_RENDERBUFFER_SAMPLES, &samples);
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        GLint size = 0;
        gl->GetNamedRenderbufferParameteriv(buffer, sizes[i], &size);
        bits += size;
    }
    return (size_t)width * (size_t)height * (samples > 1 ? (size_t)samples : 1) * (size_t)bits / 8;
}

size_t gl_alive_bytes(struct gl *gl)
{
    enum { NAMES = 1 << 14 }; /* drivers count up from 1 */
    size_t bytes = 0;
    for (GLuint name = 1; name < NAMES; name++) {
        GLint64 size = 0;
        if (gl->IsBuffer(name))
            gl->GetNamedBufferParameteri64v(name, GL_BUFFER_SIZE, &size);
        bytes += (size_t)size;
        if (gl->IsTexture(name))
            bytes += texture_bytes(gl, name);
        if (gl->IsRenderbuffer(name))
            bytes += renderbuffer_bytes(gl, name);
    }
    return bytes;
}

static int full_pyramid(int width_px, int height_px, int depth)
{
    int side = width_px > height_px ? width_px : height_px, levels = 1;
    for (side = side > depth ? side : depth; side > 1; side /= 2)
        levels++;
    return levels;
}

GLuint gl_texture(struct gl *gl, GLenum target, int levels, GLenum internal_format, int width_px,
                  int height_px, int layers)
{
    GLuint name;
    bool flat = target == GL_TEXTURE_2D || target == GL_TEXTURE_CUBE_MAP;
    if (levels <= 0)
        levels = full_pyramid(width_px, height_px, target == GL_TEXTURE_3D ? layers : 1);
    gl->CreateTextures(target, 1, &name);
    if (flat)
        gl->TextureStorage2D(name, levels, internal_format, width_px, height_px);
    else
        gl->TextureStorage3D(name, levels, internal_format, width_px, height_px, layers);
    size_t bytes = 0;
    for (int level = 0; level < levels; level++)
        bytes += level_bytes(gl, name, level) * (target == GL_TEXTURE_CUBE_MAP ? 6 : 1);
    return gl_books_add(gl, GL_KIND_TEXTURE, name, bytes);
}

GLuint gl_texture_multisample(struct gl *gl, int samples, GLenum internal_format, int width_px,
                              int height_px)
{
    GLuint name;
    gl->CreateTextures(GL_TEXTURE_2D_MULTISAMPLE, 1, &name);
    gl->TextureStorage2DMultisample(name, samples, internal_format, width_px, height_px, GL_TRUE);
    GLint given = samples;
    gl->GetTextureLevelParameteriv(name, 0, GL_TEXTURE_SAMPLES, &given);
    return gl_books_add(gl, GL_KIND_TEXTURE, name, level_bytes(gl, name, 0) * (size_t)given);
}

enum status gl_texture_buffer(struct gl *gl, GLenum internal_format, size_t texel_bytes,
                              GLuint buffer, GLuint *texture, struct error *error)
{
    GLint64 bytes = 0;
    GLint most = 0;
    gl->GetNamedBufferParameteri64v(buffer, GL_BUFFER_SIZE, &bytes);
    gl->GetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
    if ((size_t)bytes / texel_bytes > (size_t)most)
        return error_set(error, STATUS_UNSUPPORTED,
                         "buffer texture: %zu texels are more than this driver's %d",
                         (size_t)bytes / texel_bytes, most);
    gl->CreateTextures(GL_TEXTURE_BUFFER, 1, texture);
    gl->TextureBuffer(*texture, internal_format, buffer);
    gl_books_add(gl, GL_KIND_TEXTURE, *texture, 0);
    return STATUS_OK;
}

GLuint gl_framebuffer(struct gl *gl)
{
    GLuint name;
    gl->CreateFramebuffers(1, &name);
    return gl_books_add(gl, GL_KIND_FRAMEBUFFER, name, 0);
}

GLuint gl_vertex_array(struct gl *gl)
{
    GLuint name;
    gl->CreateVertexArrays(1, &name);
    return gl_books_add(gl, GL_KIND_VERTEX_ARRAY, name, 0);
}

void gl_delete_buffer(struct gl *gl, GLuint buffer)
{
    books_remove(gl, GL_KIND_BUFFER, buffer);
}

void gl_delete_texture(struct gl *gl, GLuint texture)
{
    books_remove(gl, GL_KIND_TEXTURE, texture);
}

static uint64_t triangles_of(GLenum mode, GLsizei count)
{
    if (mode == GL_TRIANGLES)
        return (uint64_t)count / 3;
    if ((mode == GL_TRIANGLE_STRIP || mode == GL_TRIANGLE_FAN) && count > 2)
        return (uint64_t)count - 2;
    return 0;
}

static void count_draw(struct gl *gl, uint64_t triangles)
{
    gl->counters.draw_calls++;
    gl->counters.triangles += triangles;
}

void gl_draw_arrays(struct gl *gl, GLenum mode, GLint first, GLsizei count, GLsizei instances)
{
    gl->DrawArraysInstanced(mode, first, count, instances);
    count_draw(gl, triangles_of(mode, count) * (uint64_t)instances);
}

void gl_draw_elements(struct gl *gl, GLenum mode, GLsizei count, GLenum type, size_t offset_bytes,
                      GLsizei instances, GLint base_vertex, GLuint base_instance)
{
    gl->DrawElementsInstancedBaseVertexBaseInstance(mode, count, type, (const void *)offset_bytes,
                                                    instances, base_vertex, base_instance);
    count_draw(gl, triangles_of(mode, count) * (uint64_t)instances);
}

void gl_multi_draw_elements_indirect(struct gl *gl, GLenum mode, GLenum type, size_t offset_bytes,
                                     GLsizei count, uint64_t triangles)
{
    gl->MultiDrawElementsIndirect(mode, type, (const void *)offset_bytes, count, 0);
    count_draw(gl, triangles);
}

void gl_counters_reset(struct gl *gl)
{
    gl->counters = (struct gl_counters){0, 0};
}

static const GLenum statistics_targets[3] = {
    GL_VERTEX_SHADER_INVOCATIONS, GL_CLIPPING_OUTPUT_PRIMITIVES, GL_FRAGMENT_SHADER_INVOCATIONS};

void gl_statistics_begin(struct gl *gl)
{
    GLuint *queries = gl->books->statistics_queries;
    if (!gl->has_pipeline_statistics)
        return;
    if (!queries[0])
        gl->GenQueries(3, queries);
    for (int i = 0; i < 3; i++)
        gl->BeginQuery(statistics_targets[i], queries[i]);
}

struct gl_statistics gl_statistics_end(struct gl *gl)
{
    GLuint64 values[3] = {0, 0, 0};
    if (gl->has_pipeline_statistics) {
        for (int i = 0; i < 3; i++)
            gl->EndQuery(statistics_targets[i]);
        for (int i = 0; i < 3; i++)
            gl->GetQueryObjectui64v(gl->books->statistics_queries[i], GL_QUERY_RESULT, &values[i]);
    }
    return (struct gl_statistics){values[0], values[1], values[2]};
}

void gl_timer_begin(struct gl *gl)
{
    if (!gl->has_timer)
        return;
    if (!gl->books->timer_query)
        gl->GenQueries(1, &gl->books->timer_query);
    gl->BeginQuery(GL_TIME_ELAPSED, gl->books->timer_query);
}

double gl_timer_end(struct gl *gl)
{
    GLuint64 nanoseconds = 0;
    if (!gl->has_timer)
        return -1;
    gl->EndQuery(GL_TIME_ELAPSED);
    gl->GetQueryObjectui64v(gl->books->timer_query, GL_QUERY_RESULT, &nanoseconds);
    return (double)nanoseconds * 1e-9;
}
