/* Sky and terrain under every GL method. The terrain is the mesh that the reference traces, cut
 * into square chunks that are culled one by one; the sky is a triangle behind everything, at pixel
 * centres. */
#include "bake/backdrop.h"
#include "bake/backdrop_levels.h"
#include "bake/cull.h"
#include "bake/horizon.h"
#include "bake/shadow_map.h"
#include "bake/sun_receiver.h"

#include "backdrop.glsl.h"

#include <string.h>

/* Quads along the side of a chunk: 2,048 triangles. */
enum { CHUNK_SIDE = 32 };

struct chunk {
    size_t first_index;
    uint32_t indices_count;
    float center_m[3], radius_m;
};

struct backdrop {
    const struct scene *scene;
    GLuint sky_program, sky_vertices; /* an empty vertex array */
    GLuint terrain_program, terrain_vertices;
    GLuint smooth_program;            /* for an eye above a terrain that is bent little; else 0 */
    GLuint skyline_program, skylines; /* 0: no horizon maps */
    int azimuths;
    bool mixed;
    size_t chunks_count;
    struct chunk *chunks;
    struct backdrop_levels *levels; /* instead of the chunks; NULL: every triangle */
    struct horizon *horizon;
    struct sun_receiver receiver;
    GLuint shadowed_program;
};

/* Copies the triangles of one chunk's quads behind each other. The mesh has two triangles a quad,
 * row by row. */
static struct chunk fill_chunk(const struct mesh *mesh, const struct terrain *terrain,
                               uint32_t quad_x, uint32_t quad_z, uint32_t *indices, size_t first)
{
    uint32_t quads_x = terrain->samples_x - 1, quads_z = terrain->samples_z - 1;
    uint32_t end_x = quad_x + CHUNK_SIDE < quads_x ? quad_x + CHUNK_SIDE : quads_x;
    uint32_t end_z = quad_z + CHUNK_SIDE < quads_z ? quad_z + CHUNK_SIDE : quads_z;
    struct chunk chunk = {.first_index = first};
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t z = quad_z; z < end_z; z++) {
        size_t from = 2 * ((size_t)z * quads_x + quad_x), count = 6 * (size_t)(end_x - quad_x);
        const uint32_t *corners = mesh->triangles[from];
        memcpy(indices + first + chunk.indices_count, corners, count * sizeof *indices);
        chunk.indices_count += (uint32_t)count;
        for (size_t i = 0; i < count; i++)
            for (int axis = 0; axis < 3; axis++) {
                low[axis] = fminf(low[axis], mesh->positions[corners[i]][axis]);
                high[axis] = fmaxf(high[axis], mesh->positions[corners[i]][axis]);
            }
    }
    float square = 0;
    for (int axis = 0; axis < 3; axis++) {
        float half = 0.5f * (high[axis] - low[axis]);
        chunk.center_m[axis] = low[axis] + half;
        square += half * half;
    }
    chunk.radius_m = sqrtf(square) * 1.0001f;
    return chunk;
}

/* Cuts the whole grid; returns the number of indices filled. */
static size_t fill_chunks(struct arena *arena, const struct mesh *mesh,
                          const struct terrain *terrain, struct backdrop *backdrop,
                          uint32_t *indices)
{
    uint32_t quads_x = terrain->samples_x - 1, quads_z = terrain->samples_z - 1;
    uint32_t chunks_x = (quads_x + CHUNK_SIDE - 1) / CHUNK_SIDE;
    uint32_t chunks_z = (quads_z + CHUNK_SIDE - 1) / CHUNK_SIDE;
    size_t filled = 0;
    backdrop->chunks = ARENA_ARRAY(arena, struct chunk, (size_t)chunks_x * chunks_z);
    for (uint32_t z = 0; z < chunks_z; z++)
        for (uint32_t x = 0; x < chunks_x; x++) {
            struct chunk *chunk = &backdrop->chunks[backdrop->chunks_count++];
            *chunk = fill_chunk(mesh, terrain, x * CHUNK_SIDE, z * CHUNK_SIDE, indices, filled);
            filled += chunk->indices_count;
        }
    return filled;
}

/* The largest angle between the normals of two neighbouring samples, as a cosine. */
static float sharpest_bend_cosine(const struct terrain *terrain)
{
    float sharpest = 1;
    for (uint32_t z = 0; z < terrain->samples_z; z++)
        for (uint32_t x = 0; x < terrain->samples_x; x++) {
            const float *here = terrain->normals[(size_t)z * terrain->samples_x + x];
            const uint32_t right = x + 1 < terrain->samples_x, down = z + 1 < terrain->samples_z;
            const uint32_t steps[3][2] = {{right, 0}, {0, down}, {right, down}};
            for (int i = 0; i < 3; i++) {
                const float *there =
                    terrain
                        ->normals[(size_t)(z + steps[i][1]) * terrain->samples_x + x + steps[i][0]];
                float cosine = here[0] * there[0] + here[1] * there[1] + here[2] * there[2];
                sharpest = fminf(sharpest, cosine);
            }
        }
    return sharpest;
}

/* True when interpolating N.L between the samples errs by less than half a step of a 10-bit float:
 * the mean of unit normals within a cone of half angle h is at least cos(h) long, so N.L errs by at
 * most 1 - cos(h); a triangle whose sides are at most g lies within a cone of g / sqrt(3). */
static bool is_smooth(const struct terrain *terrain)
{
    float half_angle = acosf(fminf(1, sharpest_bend_cosine(terrain))) / sqrtf(3);
    return 1 - cosf(half_angle) < 1.0f / 2048;
}

static const char *terrain_defines(struct workspace *workspace, const struct scene *scene)
{
    bool fog = workspace->effects & EFFECT_FOG && scene->fog.density_per_m > 0;
    return arena_printf(workspace->arena, "%s%s", fog ? "FOG 1\n" : "",
                        scene->terrain.colors ? "COLORS 1\n" : "");
}

static enum status prepare_programs(struct workspace *workspace, const struct scene *scene,
                                    struct backdrop *backdrop)
{
    const char *plain = terrain_defines(workspace, scene);
    const char *smooth = arena_printf(workspace->arena, "%sSMOOTH 1\n", plain);
    enum status status = gl_program(workspace->gl, "terrain", backdrop_glsl, plain,
                                    &backdrop->terrain_program, workspace->error);
    if (status == STATUS_OK && is_smooth(&scene->terrain))
        status = gl_program(workspace->gl, "smooth terrain", backdrop_glsl, smooth,
                            &backdrop->smooth_program, workspace->error);
    return status;
}

static enum status prepare_terrain(struct workspace *workspace, const struct scene *scene,
                                   struct backdrop *backdrop)
{
    struct gl *gl = workspace->gl;
    if (scene->terrain.samples_x == 0)
        return STATUS_OK;
    if (scene->terrain.detail_px > 0)
        return backdrop_levels_prepare(workspace, scene, &backdrop->levels);
    const struct mesh *mesh = terrain_mesh(workspace->arena, &scene->terrain);
    uint32_t *indices = ARENA_ARRAY(workspace->arena, uint32_t, 3 * mesh->triangles_count);
    size_t filled = fill_chunks(workspace->arena, mesh, &scene->terrain, backdrop, indices);
    if (filled != 3 * mesh->triangles_count)
        return error_set(workspace->error, STATUS_INTERNAL,
                         "terrain: %zu triangles do not tile %u x %u samples",
                         mesh->triangles_count, scene->terrain.samples_x, scene->terrain.samples_z);
    size_t plane = mesh->vertices_count * sizeof *mesh->positions;
    GLuint positions = gl_buffer(gl, (GLsizeiptr)plane, mesh->positions, 0);
    GLuint normals = gl_buffer(gl, (GLsizeiptr)plane, mesh->normals, 0);
    GLuint elements = gl_buffer(gl, (GLsizeiptr)(filled * sizeof *indices), indices, 0);
    GLuint array = backdrop->terrain_vertices = gl_vertex_array(gl);
    GLuint planes[3] = {positions, normals, 0};
    if (mesh->colors)
        planes[2] = gl_buffer(gl, (GLsizeiptr)plane, mesh->colors, 0);
    for (GLuint i = 0; i < (mesh->colors ? 3 : 2); i++) {
        gl->VertexArrayVertexBuffer(array, i, planes[i], 0, sizeof *mesh->positions);
        gl->VertexArrayAttribFormat(array, i, 3, GL_FLOAT, GL_FALSE, 0);
        gl->VertexArrayAttribBinding(array, i, i);
        gl->EnableVertexArrayAttrib(array, i);
    }
    gl->VertexArrayElementBuffer(array, elements);
    return prepare_programs(workspace, scene, backdrop);
}

enum status backdrop_prepare(struct workspace *workspace, const struct scene *scene,
                             struct backdrop **backdrop)
{
    struct gl *gl = workspace->gl;
    struct backdrop *made = *backdrop = ARENA_NEW(workspace->arena, struct backdrop);
    made->scene = scene;
    made->sky_vertices = gl_vertex_array(gl);
    enum status status =
        gl_program(gl, "sky", backdrop_glsl, "SKY 1", &made->sky_program, workspace->error);
    if (status == STATUS_OK)
        status = prepare_terrain(workspace, scene, made);
    if (status == STATUS_OK)
        status = horizon_prepare(workspace, scene, &made->horizon);
    return status == STATUS_OK ? gl_check(gl, "backdrop", workspace->error) : status;
}

static enum status receive(struct workspace *workspace, struct backdrop *backdrop)
{
    if (backdrop->levels)
        return backdrop_levels_receive(workspace, backdrop->levels, &backdrop->receiver);
    if (backdrop->chunks_count == 0)
        return STATUS_OK;
    return sun_receiver_program(workspace, &backdrop->receiver, "shadowed terrain", backdrop_glsl,
                                terrain_defines(workspace, backdrop->scene),
                                &backdrop->shadowed_program);
}

enum status backdrop_receive(struct workspace *workspace, struct backdrop *backdrop,
                             const struct shadow_map *map)
{
    backdrop->receiver = (struct sun_receiver){.map = map};
    return receive(workspace, backdrop);
}

enum status backdrop_receive_sunlight(struct workspace *workspace, struct backdrop *backdrop,
                                      const struct sunlight_gl *sunlight)
{
    backdrop->receiver = (struct sun_receiver){.sunlight = sunlight};
    return receive(workspace, backdrop);
}

bool backdrop_cast_view(struct workspace *workspace, const struct backdrop *backdrop,
                        const struct view *view)
{
    return backdrop->levels && backdrop_levels_cast_view(workspace, backdrop->levels, view);
}

void backdrop_cast(struct workspace *workspace, const struct backdrop *backdrop,
                   const struct shadow_pass *pass)
{
    if (backdrop->levels)
        backdrop_levels_cast(workspace, backdrop->levels, pass);
    if (backdrop->chunks_count == 0 || horizon_is_flat(&backdrop->scene->terrain))
        return;
    const struct chunk *last = &backdrop->chunks[backdrop->chunks_count - 1];
    shadow_pass_use(workspace, pass, pass->programs[SHADOW_CAST_TERRAIN]);
    workspace->gl->BindVertexArray(backdrop->terrain_vertices);
    gl_draw_elements(workspace->gl, GL_TRIANGLES,
                     (GLsizei)(last->first_index + last->indices_count), GL_UNSIGNED_INT, 0, 1, 0,
                     0);
}

enum status backdrop_skyline(struct workspace *workspace, struct backdrop *backdrop,
                             const struct skyline *skyline, bool mixed)
{
    struct gl *gl = workspace->gl;
    if (!backdrop->chunks_count)
        return STATUS_OK;
    backdrop->azimuths = skyline->azimuths;
    backdrop->mixed = mixed;
    backdrop->skylines = gl_texture(gl, GL_TEXTURE_2D_ARRAY, 1, GL_R32F, (int)skyline->samples_x,
                                    (int)skyline->samples_z, skyline->azimuths);
    gl->TextureSubImage3D(backdrop->skylines, 0, 0, 0, 0, (GLsizei)skyline->samples_x,
                          (GLsizei)skyline->samples_z, skyline->azimuths, GL_RED, GL_FLOAT,
                          skyline->tangents);
    gl->TextureParameteri(backdrop->skylines, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl->TextureParameteri(backdrop->skylines, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl->TextureParameteri(backdrop->skylines, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl->TextureParameteri(backdrop->skylines, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    const char *defines = arena_printf(workspace->arena, "SKYLINE 1\n%s",
                                       terrain_defines(workspace, backdrop->scene));
    return sun_receiver_program(workspace, &backdrop->receiver, "skyline", backdrop_glsl, defines,
                                &backdrop->skyline_program);
}

static void skyline_uniforms(struct gl *gl, const struct backdrop *backdrop,
                             const struct view *view)
{
    GLuint program = backdrop->skyline_program;
    const struct terrain *terrain = &backdrop->scene->terrain;
    const float *sun = view->sun_direction;
    float level = sqrtf(sun[0] * sun[0] + sun[2] * sun[2]), azimuths = (float)backdrop->azimuths;
    float layer = atan2f(sun[0], sun[2]) / (2 * (float)M_PI) * azimuths;
    layer = backdrop->mixed ? layer : rintf(layer);
    layer = fmodf(layer + azimuths, azimuths);
    gl->Uniform2f(gl_uniform(gl, program, "terrain_m"), terrain->size_x_m, terrain->size_z_m);
    gl->Uniform1f(gl_uniform(gl, program, "sun_layer"), layer);
    /* no sun at all: nothing is in its shadow */
    float tangent = level > 0 || sun[1] != 0 ? sun[1] / fmaxf(level, 1e-6f) : 1e6f;
    gl->Uniform1f(gl_uniform(gl, program, "sun_tangent"), tangent);
    gl->BindTextureUnit(0, backdrop->skylines);
}

/* Above a height field and within its borders the first thing that a ray meets is a front face. */
static bool eye_is_above(const struct terrain *terrain, const float eye_m[3])
{
    return fabsf(eye_m[0]) <= 0.5f * terrain->size_x_m &&
           fabsf(eye_m[2]) <= 0.5f * terrain->size_z_m &&
           eye_m[1] > terrain_height(terrain, eye_m[0], eye_m[2]);
}

static void smooth_uniforms(struct workspace *workspace, GLuint program, const struct scene *scene)
{
    struct gl *gl = workspace->gl;
    bool ambient = workspace->effects & EFFECT_AMBIENT;
    float in_sun[3], in_shade[3];
    for (int i = 0; i < 3; i++) {
        in_sun[i] = scene->terrain.albedo[i] * scene->sun.radiance[i];
        in_shade[i] = ambient ? scene->terrain.albedo[i] * scene->ambient[i] : 0;
    }
    gl->Uniform3fv(gl_uniform(gl, program, "in_sun"), 1, in_sun);
    gl->Uniform3fv(gl_uniform(gl, program, "in_shade"), 1, in_shade);
}

/* Light may be interpolated only where nothing but the surface's own slope dims it. */
static GLuint terrain_program_of(const struct workspace *workspace, const struct backdrop *backdrop,
                                 bool above)
{
    if (backdrop->skyline_program)
        return backdrop->skyline_program;
    if (sun_receiver_is_shaded(&backdrop->receiver))
        return backdrop->shadowed_program;
    bool smooth = above && backdrop->smooth_program && !workspace->masked;
    return smooth ? backdrop->smooth_program : backdrop->terrain_program;
}

static void draw_terrain(struct workspace *workspace, struct backdrop *backdrop,
                         const struct view *view)
{
    struct gl *gl = workspace->gl;
    const struct scene *scene = backdrop->scene;
    if (backdrop->chunks_count == 0 && !backdrop->levels)
        return;
    bool above = eye_is_above(&scene->terrain, view->eye_m);
    if (backdrop->levels) {
        backdrop_levels_draw(workspace, backdrop->levels, view, above);
        return;
    }
    GLuint program = terrain_program_of(workspace, backdrop, above);
    gl->UseProgram(program);
    gl->BindVertexArray(backdrop->terrain_vertices);
    shade_uniforms(workspace, program, scene, view);
    sun_receiver_uniforms(workspace, &backdrop->receiver, program);
    if (program == backdrop->smooth_program)
        smooth_uniforms(workspace, program, scene);
    else
        gl->Uniform3fv(gl_uniform(gl, program, "albedo"), 1, scene->terrain.albedo);
    if (program == backdrop->skyline_program)
        skyline_uniforms(gl, backdrop, view);
    if (above)
        gl->Enable(GL_CULL_FACE);
    /* Neighbouring chunks that are seen go in one call. */
    size_t first = 0, count = 0;
    for (size_t i = 0; i <= backdrop->chunks_count; i++) {
        const struct chunk *chunk = &backdrop->chunks[i];
        bool seen =
            i < backdrop->chunks_count && view_sees_sphere(view, chunk->center_m, chunk->radius_m);
        if (seen) {
            first = count ? first : chunk->first_index;
            count += chunk->indices_count;
        } else if (count) {
            gl_draw_elements(gl, GL_TRIANGLES, (GLsizei)count, GL_UNSIGNED_INT,
                             first * sizeof(uint32_t), 1, 0, 0);
            count = 0;
        }
    }
    gl->Disable(GL_CULL_FACE);
}

static void draw_sky(struct workspace *workspace, const struct backdrop *backdrop,
                     const struct view *view)
{
    struct gl *gl = workspace->gl;
    static const struct sky nothing = {{0}, {0}, {0}};
    const struct sky *sky = workspace->masked ? &nothing : &backdrop->scene->sky;
    GLuint program = backdrop->sky_program;
    float up = tanf(0.5f * view->fov_y_rad);
    float right = up * (float)view->width_px / (float)view->height_px;
    static const float corners[3][2] = {{-1, -1}, {3, -1}, {-1, 3}};
    float rays[3][3];
    for (int corner = 0; corner < 3; corner++)
        for (int axis = 0; axis < 3; axis++)
            rays[corner][axis] = view->forward[axis] +
                                 corners[corner][0] * right * view->right[axis] +
                                 corners[corner][1] * up * view->up[axis];
    gl->UseProgram(program);
    gl->BindVertexArray(backdrop->sky_vertices);
    gl->Uniform3fv(gl_uniform(gl, program, "corner_rays"), 3, rays[0]);
    gl->Uniform3fv(gl_uniform(gl, program, "zenith"), 1, sky->zenith);
    gl->Uniform3fv(gl_uniform(gl, program, "horizon"), 1, sky->horizon);
    gl->Uniform3fv(gl_uniform(gl, program, "ground"), 1, sky->ground);
    gl->DepthMask(GL_FALSE);
    gl->DepthFunc(GL_LEQUAL);
    gl_draw_arrays(gl, GL_TRIANGLES, 0, 3, 1);
    gl->DepthFunc(GL_LESS);
    gl->DepthMask(GL_TRUE);
}

void backdrop_draw(struct workspace *workspace, struct backdrop *backdrop, const struct view *view)
{
    struct gl *gl = workspace->gl;
    gl->Viewport(0, 0, view->width_px, view->height_px);
    gl->Disable(GL_SCISSOR_TEST);
    gl->Disable(GL_BLEND);
    gl->Disable(GL_CULL_FACE);
    gl->Disable(GL_SAMPLE_ALPHA_TO_COVERAGE);
    gl->Enable(GL_DEPTH_TEST);
    gl->DepthFunc(GL_LESS);
    gl->DepthMask(GL_TRUE);
    gl->ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    gl->ClearDepth(1);
    gl->Clear(GL_DEPTH_BUFFER_BIT); /* terrain and sky reach every pixel's colour */
    draw_terrain(workspace, backdrop, view);
    draw_sky(workspace, backdrop, view);
    horizon_draw(workspace, backdrop->horizon, view);
}
