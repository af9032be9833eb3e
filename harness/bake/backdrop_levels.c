/* Levels of detail of a terrain by OpenGL: one buffer of heights, one draw of the view's triangles.
 */
#include "bake/backdrop_levels.h"
#include "bake/backdrop.h"
#include "bake/terrain_levels.h"
#include "base/color.h"

#include "backdrop_levels.glsl.h"

struct backdrop_levels {
    const struct scene *scene;
    struct terrain_levels *levels;
    GLuint program, normals, colors; /* colors 0: none */
    struct sun_receiver receiver;
    struct drawn {
        GLuint vertices, indices;
        size_t indices_room, count;
    } seen, casters; /* casters: of the last view that something was cast into */
    GLuint heights;
};

/* A row of normals, or of colours in sRGB, as texels of four. */
static void normals_row(const struct terrain *terrain, uint32_t z, int16_t (*texels)[4])
{
    for (uint32_t x = 0; x < terrain->samples_x; x++) {
        const float *normal = terrain->normals[(size_t)z * terrain->samples_x + x];
        for (int i = 0; i < 3; i++)
            texels[x][i] = (int16_t)lrintf(32767 * normal[i]);
        texels[x][3] = 0;
    }
}

static void colors_row(const struct terrain *terrain, uint32_t z, uint8_t (*texels)[4])
{
    for (uint32_t x = 0; x < terrain->samples_x; x++) {
        const float *color = terrain->colors[(size_t)z * terrain->samples_x + x];
        for (int i = 0; i < 3; i++)
            texels[x][i] = (uint8_t)lrintf(255 * srgb_encode(color[i]));
        texels[x][3] = 255;
    }
}

/* Row by row, so that no copy of the terrain stands beside it. */
static GLuint terrain_texture(struct workspace *workspace, const struct terrain *terrain,
                              bool colors)
{
    struct gl *gl = workspace->gl;
    const GLsizei width = (GLsizei)terrain->samples_x, height = (GLsizei)terrain->samples_z;
    struct arena *scratch = arena_create(0);
    int16_t(*normals_texels)[4] = arena_alloc(scratch, terrain->samples_x, sizeof *normals_texels);
    uint8_t(*colors_texels)[4] = arena_alloc(scratch, terrain->samples_x, sizeof *colors_texels);
    GLuint texture = gl_texture(gl, GL_TEXTURE_2D, 0, colors ? GL_SRGB8_ALPHA8 : GL_RGBA16_SNORM,
                                width, height, 1);
    for (GLsizei z = 0; z < height; z++) {
        if (colors)
            colors_row(terrain, (uint32_t)z, colors_texels);
        else
            normals_row(terrain, (uint32_t)z, normals_texels);
        gl->TextureSubImage2D(texture, 0, 0, z, width, 1, GL_RGBA,
                              colors ? GL_UNSIGNED_BYTE : GL_SHORT,
                              colors ? (const void *)colors_texels : (const void *)normals_texels);
    }
    gl->GenerateTextureMipmap(texture);
    gl->TextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    gl->TextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl->TextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl->TextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    arena_destroy(scratch);
    return texture;
}

static enum status prepare_program(struct workspace *workspace, struct backdrop_levels *levels)
{
    const struct scene *scene = levels->scene;
    bool fog = workspace->effects & EFFECT_FOG && scene->fog.density_per_m > 0;
    const char *defines = arena_printf(workspace->arena, "%s%s", fog ? "FOG 1\n" : "",
                                       scene->terrain.colors ? "COLORS 1\n" : "");
    return sun_receiver_program(workspace, &levels->receiver, "terrain levels",
                                backdrop_levels_glsl, defines, &levels->program);
}

/* An array of heights alone. */
static GLuint vertices_of(struct gl *gl, GLuint heights)
{
    GLuint vertices = gl_vertex_array(gl);
    gl->VertexArrayVertexBuffer(vertices, 0, heights, 0, sizeof(float));
    gl->VertexArrayAttribFormat(vertices, 0, 1, GL_FLOAT, GL_FALSE, 0);
    gl->VertexArrayAttribBinding(vertices, 0, 0);
    gl->EnableVertexArrayAttrib(vertices, 0);
    return vertices;
}

enum status backdrop_levels_prepare(struct workspace *workspace, const struct scene *scene,
                                    struct backdrop_levels **levels)
{
    struct gl *gl = workspace->gl;
    const struct terrain *terrain = &scene->terrain;
    struct backdrop_levels *made = *levels = ARENA_NEW(workspace->arena, struct backdrop_levels);
    GLint side_max = 0;
    gl->GetIntegerv(GL_MAX_TEXTURE_SIZE, &side_max);
    if (terrain->samples_x > (uint32_t)side_max || terrain->samples_z > (uint32_t)side_max)
        return error_set(workspace->error, STATUS_UNSUPPORTED,
                         "terrain: %u x %u samples; allowed by this OpenGL: up to %d on each side",
                         terrain->samples_x, terrain->samples_z, side_max);
    made->scene = scene;
    made->levels = terrain_levels_create(workspace->arena, terrain, workspace->threads);
    made->normals = terrain_texture(workspace, terrain, false);
    made->colors = terrain->colors ? terrain_texture(workspace, terrain, true) : 0;
    const size_t samples = (size_t)terrain->samples_x * terrain->samples_z;
    made->heights = gl_buffer(gl, (GLsizeiptr)(samples * sizeof(float)), terrain->heights_m, 0);
    made->seen.vertices = vertices_of(gl, made->heights);
    return prepare_program(workspace, made);
}

enum status backdrop_levels_receive(struct workspace *workspace, struct backdrop_levels *levels,
                                    const struct sun_receiver *receiver)
{
    levels->receiver = *receiver;
    levels->casters.vertices = vertices_of(workspace->gl, levels->heights);
    return prepare_program(workspace, levels);
}

/* Indices into a buffer that grows. */
static void indices_put(struct gl *gl, struct drawn *drawn, const uint32_t *indices, size_t count)
{
    if (count > drawn->indices_room) {
        if (drawn->indices)
            gl_delete_buffer(gl, drawn->indices);
        drawn->indices_room = count + count / 2;
        drawn->indices = gl_buffer(gl, (GLsizeiptr)(drawn->indices_room * sizeof *indices), NULL,
                                   GL_DYNAMIC_STORAGE_BIT);
        gl->VertexArrayElementBuffer(drawn->vertices, drawn->indices);
    }
    drawn->count = count;
    gl->NamedBufferSubData(drawn->indices, 0, (GLsizeiptr)(count * sizeof *indices), indices);
}

/* Where a vertex stands: by its number and height. */
static void place_uniforms(struct gl *gl, GLuint program, const struct terrain *terrain)
{
    gl->Uniform1i(gl_uniform(gl, program, "samples_x"), (GLint)terrain->samples_x);
    gl->Uniform2f(gl_uniform(gl, program, "last_sample"), (float)(terrain->samples_x - 1),
                  (float)(terrain->samples_z - 1));
    gl->Uniform2f(gl_uniform(gl, program, "size_m"), terrain->size_x_m, terrain->size_z_m);
}

bool backdrop_levels_cast_view(struct workspace *workspace, struct backdrop_levels *levels,
                               const struct view *view)
{
    const uint32_t *indices = NULL;
    size_t count = 0;
    bool changed = terrain_levels_cast(levels->levels, view, levels->scene->terrain.detail_px,
                                       &indices, &count);
    if (changed)
        indices_put(workspace->gl, &levels->casters, indices, count);
    return changed;
}

void backdrop_levels_cast(struct workspace *workspace, const struct backdrop_levels *levels,
                          const struct shadow_pass *pass)
{
    struct gl *gl = workspace->gl;
    const GLuint program = pass->programs[SHADOW_CAST_TERRAIN];
    shadow_pass_use(workspace, pass, program);
    place_uniforms(gl, program, &levels->scene->terrain);
    gl->BindVertexArray(levels->casters.vertices);
    gl_draw_elements(gl, GL_TRIANGLES, (GLsizei)levels->casters.count, GL_UNSIGNED_INT, 0, 1, 0, 0);
}

void backdrop_levels_draw(struct workspace *workspace, struct backdrop_levels *levels,
                          const struct view *view, bool above)
{
    struct gl *gl = workspace->gl;
    const struct scene *scene = levels->scene;
    const struct terrain *terrain = &scene->terrain;
    const GLuint program = levels->program;
    const uint32_t *indices = NULL;
    size_t count = terrain_levels_view(levels->levels, view, terrain->detail_px, &indices);
    if (!count)
        return;
    gl->UseProgram(program);
    gl->BindVertexArray(levels->seen.vertices);
    indices_put(gl, &levels->seen, indices, count);
    shade_uniforms(workspace, program, scene, view);
    sun_receiver_uniforms(workspace, &levels->receiver, program);
    gl->Uniform3fv(gl_uniform(gl, program, "albedo"), 1, terrain->albedo);
    place_uniforms(gl, program, terrain);
    gl->BindTextureUnit(0, levels->normals);
    if (levels->colors)
        gl->BindTextureUnit(1, levels->colors);
    if (above)
        gl->Enable(GL_CULL_FACE);
    gl_draw_elements(gl, GL_TRIANGLES, (GLsizei)count, GL_UNSIGNED_INT, 0, 1, 0, 0);
    gl->Disable(GL_CULL_FACE);
}
