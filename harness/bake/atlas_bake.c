/* Renders a plant's pictures with many samples a texel and reduces them to coverage, colour, light
 * and depth. */
#include "bake/atlas_bake.h"

#include "base/color.h"

#include "atlas.glsl.h"

#include <string.h>

enum { TILE_TEXELS = 256 };

/* What the GL holds while a plant is baked. */
struct kiln {
    struct gl *gl;
    GLuint program, vertices, framebuffer;
    GLuint buffers[5]; /* positions, normals, colours, uvs, indices; 0: absent */
    GLuint targets[3]; /* colour and kind, normal and depth, depth */
    GLuint *textures;  /* one a material, 0: none */
    const struct mesh *mesh;
    int tile_width, tile_height; /* texels */
    int samples;
    float (*colors)[4]; /* samples of a tile, row 0 at the bottom */
    float (*normals)[4];
};

static GLuint upload_texture(struct gl *gl, const struct texture *texture)
{
    GLuint name =
        gl_texture(gl, GL_TEXTURE_2D, 1, GL_RGBA32F, texture->width_px, texture->height_px, 1);
    gl->TextureSubImage2D(name, 0, 0, 0, texture->width_px, texture->height_px, GL_RGBA, GL_FLOAT,
                          texture->rgba);
    gl->TextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl->TextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl->TextureParameteri(name, GL_TEXTURE_WRAP_S, GL_REPEAT);
    gl->TextureParameteri(name, GL_TEXTURE_WRAP_T, GL_REPEAT);
    return name;
}

static void upload_mesh(struct kiln *kiln, struct arena *scratch)
{
    struct gl *gl = kiln->gl;
    const struct mesh *mesh = kiln->mesh;
    const void *data[4] = {mesh->positions, mesh->normals, mesh->colors, mesh->uvs};
    static const GLint sizes[4] = {3, 3, 3, 2};
    kiln->vertices = gl_vertex_array(gl);
    for (GLuint i = 0; i < 4; i++) {
        GLsizei stride = sizes[i] * (GLsizei)sizeof(float);
        if (!data[i])
            continue;
        kiln->buffers[i] = gl_buffer(gl, (GLsizeiptr)mesh->vertices_count * stride, data[i], 0);
        gl->VertexArrayVertexBuffer(kiln->vertices, i, kiln->buffers[i], 0, stride);
        gl->VertexArrayAttribFormat(kiln->vertices, i, sizes[i], GL_FLOAT, GL_FALSE, 0);
        gl->VertexArrayAttribBinding(kiln->vertices, i, i);
        gl->EnableVertexArrayAttrib(kiln->vertices, i);
    }
    size_t index_bytes = mesh->triangles_count * sizeof *mesh->triangles;
    kiln->buffers[4] = gl_buffer(gl, (GLsizeiptr)index_bytes, mesh->triangles, 0);
    gl->VertexArrayElementBuffer(kiln->vertices, kiln->buffers[4]);
    kiln->textures = ARENA_ARRAY(scratch, GLuint, mesh->materials_count);
    for (size_t i = 0; i < mesh->materials_count; i++)
        if (mesh->materials[i].texture && mesh->uvs)
            kiln->textures[i] = upload_texture(gl, mesh->materials[i].texture);
}

static enum status kiln_open(struct kiln *kiln, struct workspace *workspace, struct arena *scratch)
{
    struct gl *gl = kiln->gl;
    static const GLenum formats[3] = {GL_RGBA32F, GL_RGBA32F, GL_DEPTH_COMPONENT32F};
    static const GLenum places[3] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1,
                                     GL_DEPTH_ATTACHMENT};
    int width = kiln->tile_width * kiln->samples, height = kiln->tile_height * kiln->samples;
    size_t count = (size_t)width * (size_t)height;
    kiln->colors = arena_alloc(scratch, count, sizeof *kiln->colors);
    kiln->normals = arena_alloc(scratch, count, sizeof *kiln->normals);
    upload_mesh(kiln, scratch);
    kiln->framebuffer = gl_framebuffer(gl);
    for (int i = 0; i < 3; i++) {
        kiln->targets[i] = gl_texture(gl, GL_TEXTURE_2D, 1, formats[i], width, height, 1);
        gl->NamedFramebufferTexture(kiln->framebuffer, places[i], kiln->targets[i], 0);
    }
    gl->NamedFramebufferDrawBuffers(kiln->framebuffer, 2, places);
    if (gl->CheckNamedFramebufferStatus(kiln->framebuffer, GL_FRAMEBUFFER) !=
        GL_FRAMEBUFFER_COMPLETE)
        return error_set(workspace->error, STATUS_GL, "atlas: no framebuffer of %d x %d px", width,
                         height);
    return gl_program(gl, "atlas", atlas_glsl, NULL, &kiln->program, workspace->error);
}

static void kiln_close(struct kiln *kiln)
{
    struct gl *gl = kiln->gl;
    gl->BindFramebuffer(GL_FRAMEBUFFER, 0);
    gl->BindVertexArray(0);
    gl->UseProgram(0);
    gl->BindTextureUnit(0, 0);
    for (int i = 0; i < 5; i++)
        if (kiln->buffers[i])
            gl_delete_buffer(gl, kiln->buffers[i]);
    for (int i = 0; i < 3; i++)
        if (kiln->targets[i])
            gl_delete_texture(gl, kiln->targets[i]);
    for (size_t i = 0; kiln->textures && i < kiln->mesh->materials_count; i++)
        if (kiln->textures[i])
            gl_delete_texture(gl, kiln->textures[i]);
}

static void set_state(struct gl *gl, const struct kiln *kiln)
{
    gl->BindFramebuffer(GL_FRAMEBUFFER, kiln->framebuffer);
    gl->Viewport(0, 0, kiln->tile_width * kiln->samples, kiln->tile_height * kiln->samples);
    gl->Disable(GL_SCISSOR_TEST);
    gl->Disable(GL_BLEND);
    gl->Disable(GL_CULL_FACE);
    gl->Enable(GL_DEPTH_TEST);
    gl->DepthFunc(GL_LESS);
    gl->DepthMask(GL_TRUE);
    gl->ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    gl->BindVertexArray(kiln->vertices);
    gl->UseProgram(kiln->program);
}

/* Draws the tile whose lower left texel is (column, row) and reads it back. */
static void render_tile(const struct kiln *kiln, const struct atlas_plant *plant,
                        const struct atlas_view *view, int column, int row)
{
    struct gl *gl = kiln->gl;
    const struct mesh *mesh = kiln->mesh;
    GLuint program = kiln->program;
    static const float nothing[4] = {0, 0, 0, 0}, far = 1;
    float scale_s = 2 / ((float)kiln->tile_width * plant->texel_m);
    float scale_t = 2 / ((float)kiln->tile_height * plant->texel_m);
    float s = view->origin_s + (float)column * plant->texel_m;
    float t = view->origin_t + (float)row * plant->texel_m;
    set_state(gl, kiln);
    gl->ClearBufferfv(GL_COLOR, 0, nothing);
    gl->ClearBufferfv(GL_COLOR, 1, nothing);
    gl->ClearBufferfv(GL_DEPTH, 0, &far);
    gl->Uniform3fv(gl_uniform(gl, program, "plane_right"), 1, view->right);
    gl->Uniform3fv(gl_uniform(gl, program, "plane_up"), 1, view->up);
    gl->Uniform3fv(gl_uniform(gl, program, "plane_toward"), 1, view->toward);
    gl->Uniform3f(gl_uniform(gl, program, "center_m"), 0, plant->center_y_m, 0);
    gl->Uniform4f(gl_uniform(gl, program, "window"), scale_s, scale_t, -s * scale_s - 1,
                  -t * scale_t - 1);
    gl->Uniform1f(gl_uniform(gl, program, "radius_m"), plant->radius_m);
    gl->Uniform1i(gl_uniform(gl, program, "has_color"), mesh->colors != NULL);
    for (size_t i = 0; i < mesh->parts_count; i++) {
        const struct mesh_part *part = &mesh->parts[i];
        const struct material *material = &mesh->materials[part->material];
        gl->Uniform3fv(gl_uniform(gl, program, "material_albedo"), 1, material->albedo);
        gl->Uniform1f(gl_uniform(gl, program, "kind"), material_is_thin(material) ? 1 : 2);
        gl->Uniform1i(gl_uniform(gl, program, "has_texture"), kiln->textures[part->material] != 0);
        gl->BindTextureUnit(0, kiln->textures[part->material]);
        gl_draw_elements(gl, GL_TRIANGLES, (GLsizei)(3 * part->triangles_count), GL_UNSIGNED_INT,
                         12 * (size_t)part->first_triangle, 1, 0, 0);
    }
    GLsizei bytes = (GLsizei)sizeof(float[4]) * kiln->tile_width * kiln->tile_height *
                    kiln->samples * kiln->samples;
    gl->GetTextureImage(kiln->targets[0], 0, GL_RGBA, GL_FLOAT, bytes, kiln->colors);
    gl->GetTextureImage(kiln->targets[1], 0, GL_RGBA, GL_FLOAT, bytes, kiln->normals);
}

/* Sums of the samples of a texel. */
struct texel {
    float count, color[3], moments[LIGHT_MOMENTS], weight, depth;
};

static struct texel reduce(const struct kiln *kiln, int column, int row, bool two_sided)
{
    struct texel sum = {0};
    int samples = kiln->samples;
    for (int y = 0; y < samples; y++) {
        size_t from = ((size_t)(row * samples + y) * (size_t)kiln->tile_width + (size_t)column) *
                      (size_t)samples;
        for (int x = 0; x < samples; x++) {
            const float *color = kiln->colors[from + (size_t)x];
            const float *normal = kiln->normals[from + (size_t)x];
            if (color[3] == 0)
                continue;
            /* Light is averaged by what it multiplies. */
            float weight = color[0] + color[1] + color[2] + 1e-4f;
            sum.count++;
            for (int i = 0; i < 3; i++)
                sum.color[i] += color[i];
            light_moments_add(sum.moments, normal, !two_sided || color[3] > 1.5f, weight);
            sum.weight += weight;
            sum.depth += normal[3];
        }
    }
    return sum;
}

/* Moments wait as 16-bit fractions (they lie in [-1, 1]) until all are known and the light's basis
 * is fitted. */
struct bake {
    struct kiln kiln;
    struct atlas_plant *plant;
    int16_t (*moments)[LIGHT_MOMENTS];
    struct light_sums sums;
    bool two_sided;
};

static void keep_texel(struct bake *bake, struct texel *sum, size_t at)
{
    struct atlas_plant *plant = bake->plant;
    if (sum->count == 0)
        return;
    float share = 1 / (float)(bake->kiln.samples * bake->kiln.samples);
    for (int i = 0; i < 3; i++)
        plant->albedo[at][i] = color_byte(sum->color[i] * share / plant->albedo_scale);
    plant->albedo[at][3] = color_byte(sum->count * share);
    float depth = sum->depth / sum->count / plant->radius_m * 0.5f + 0.5f;
    plant->depth[at] = (uint16_t)(fminf(fmaxf(depth, 0), 1) * 65535 + 0.5f);
    for (int i = 0; i < LIGHT_MOMENTS; i++) {
        sum->moments[i] /= sum->weight;
        bake->moments[at][i] = (int16_t)lrintf(32767 * fminf(fmaxf(sum->moments[i], -1), 1));
    }
    light_sums_add(&bake->sums, sum->moments, sum->weight);
}

static void bake_view(struct bake *bake, size_t index)
{
    struct atlas_plant *plant = bake->plant;
    struct kiln *kiln = &bake->kiln;
    size_t pixels = (size_t)plant->width_px * (size_t)plant->height_px;
    for (int row = 0; row < plant->height_px; row += kiln->tile_height)
        for (int column = 0; column < plant->width_px; column += kiln->tile_width) {
            render_tile(kiln, plant, &plant->views[index], column, row);
            for (int y = 0; y < kiln->tile_height && row + y < plant->height_px; y++)
                for (int x = 0; x < kiln->tile_width && column + x < plant->width_px; x++) {
                    struct texel sum = reduce(kiln, x, y, bake->two_sided);
                    keep_texel(bake, &sum,
                               index * pixels + (size_t)(row + y) * (size_t)plant->width_px +
                                   (size_t)(column + x));
                }
        }
}

static void encode_light(struct bake *bake)
{
    struct atlas_plant *plant = bake->plant;
    size_t count = plant->views_count * (size_t)plant->width_px * (size_t)plant->height_px;
    light_basis_fit(&bake->sums, &plant->light);
    for (size_t at = 0; at < count; at++) {
        float moments[LIGHT_MOMENTS], channels[LIGHT_CHANNELS];
        if (plant->albedo[at][3] == 0)
            continue;
        for (int i = 0; i < LIGHT_MOMENTS; i++)
            moments[i] = (float)bake->moments[at][i] / 32767;
        light_encode(&plant->light, moments, channels);
        for (int i = 0; i < LIGHT_CHANNELS; i++)
            plant->channels[at][i] = color_byte(channels[i]);
    }
}

float atlas_brightest(const struct mesh *mesh)
{
    float color = 0, most = 0;
    for (size_t i = 0; mesh->colors && i < 3 * mesh->vertices_count; i++)
        color = fmaxf(color, mesh->colors[i / 3][i % 3]);
    for (size_t i = 0; i < mesh->materials_count; i++) {
        const struct material *material = &mesh->materials[i];
        float texel = material->texture ? 0 : 1;
        for (int k = 0; material->texture &&
                        k < 4 * material->texture->width_px * material->texture->height_px;
             k++)
            texel = k % 4 < 3 ? fmaxf(texel, material->texture->rgba[k]) : texel;
        for (int k = 0; k < 3; k++)
            most = fmaxf(most, material->albedo[k] * texel * (mesh->colors ? color : 1));
    }
    return most > 0 ? most : 1;
}

/* Extent of the mesh on the view's plane, m. */
static void plane_extent(const struct mesh *mesh, float center_y_m, const struct atlas_view *view,
                         float low[2], float high[2])
{
    low[0] = low[1] = INFINITY;
    high[0] = high[1] = -INFINITY;
    for (size_t i = 0; i < mesh->vertices_count; i++) {
        const float *p = mesh->positions[i];
        float y = p[1] - center_y_m;
        float st[2] = {view->right[0] * p[0] + view->right[1] * y + view->right[2] * p[2],
                       view->up[0] * p[0] + view->up[1] * y + view->up[2] * p[2]};
        for (int k = 0; k < 2; k++) {
            low[k] = fminf(low[k], st[k]);
            high[k] = fmaxf(high[k], st[k]);
        }
    }
}

/* Directions, texel size, layer size and where each picture lies in its layer. */
static void place_views(struct arena *arena, struct arena *scratch, const struct mesh *mesh,
                        const struct atlas_request *request, struct atlas_plant *plant)
{
    size_t count = plant->views_count = views_count(request->layout, request->side);
    float(*bounds)[4] = arena_alloc(scratch, count, sizeof *bounds);
    float size[2] = {1e-6f, 1e-6f}, square = 0;
    plant->views = ARENA_ARRAY(arena, struct atlas_view, count);
    plant->center_y_m = 0.5f * (mesh->minimum_m[1] + mesh->maximum_m[1]);
    for (size_t i = 0; i < mesh->vertices_count; i++) {
        const float *p = mesh->positions[i];
        float y = p[1] - plant->center_y_m;
        square = fmaxf(square, p[0] * p[0] + y * y + p[2] * p[2]);
    }
    plant->radius_m = fmaxf(sqrtf(square), 1e-6f);
    for (size_t i = 0; i < count; i++) {
        struct atlas_view *view = &plant->views[i];
        views_direction(request->layout, request->side, i, view->toward);
        views_plane(view->toward, view->right, view->up);
        plane_extent(mesh, plant->center_y_m, view, bounds[i], bounds[i] + 2);
        for (int k = 0; k < 2; k++)
            size[k] = fmaxf(size[k], bounds[i][2 + k] - bounds[i][k]);
    }
    plant->texel_m = fmaxf(size[0], size[1]) / (float)(request->resolution_px - 2);
    plant->width_px = ((int)ceilf(size[0] / plant->texel_m - 1e-3f) + 2 + 3) & ~3;
    plant->height_px = ((int)ceilf(size[1] / plant->texel_m - 1e-3f) + 2 + 3) & ~3;
    for (size_t i = 0; i < count; i++) {
        const float *bound = bounds[i];
        plant->views[i].origin_s =
            0.5f * (bound[0] + bound[2] - plant->texel_m * (float)plant->width_px);
        plant->views[i].origin_t =
            0.5f * (bound[1] + bound[3] - plant->texel_m * (float)plant->height_px);
    }
}

enum status atlas_bake(struct workspace *workspace, struct arena *arena, const struct mesh *mesh,
                       const struct atlas_request *request, bool two_sided,
                       struct atlas_plant *plant)
{
    struct arena *scratch = arena_create(0);
    struct bake bake = {.plant = plant, .two_sided = two_sided};
    place_views(arena, scratch, mesh, request, plant);
    plant->albedo_scale = atlas_brightest(mesh);
    size_t pixels = (size_t)plant->width_px * (size_t)plant->height_px;
    plant->albedo = arena_alloc(arena, plant->views_count * pixels, sizeof *plant->albedo);
    plant->channels = arena_alloc(arena, plant->views_count * pixels, sizeof *plant->channels);
    plant->depth = ARENA_ARRAY(arena, uint16_t, plant->views_count * pixels);
    bake.moments = arena_alloc(scratch, plant->views_count * pixels, sizeof *bake.moments);
    bake.kiln = (struct kiln){
        .gl = workspace->gl,
        .mesh = mesh,
        .samples = request->samples,
        .tile_width = plant->width_px < TILE_TEXELS ? plant->width_px : TILE_TEXELS,
        .tile_height = plant->height_px < TILE_TEXELS ? plant->height_px : TILE_TEXELS};
    enum status status = kiln_open(&bake.kiln, workspace, scratch);
    for (size_t i = 0; status == STATUS_OK && i < plant->views_count; i++) {
        bake_view(&bake, i);
        atlas_outline(scratch, (const uint8_t(*)[4])(plant->albedo + i * pixels),
                      plant->depth + i * pixels, plant->width_px, plant->height_px, plant->texel_m,
                      plant->radius_m, &plant->views[i]);
    }
    kiln_close(&bake.kiln);
    if (status == STATUS_OK) {
        encode_light(&bake);
        status = gl_check(workspace->gl, "atlas", workspace->error);
    }
    arena_destroy(scratch);
    return status;
}
