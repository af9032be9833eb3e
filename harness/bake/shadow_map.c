/* Shadow maps: their textures, when they are made, what receivers are told. */
#include "bake/shadow_map.h"

#include "bake/backdrop.h"
#include "bake/shadow_billboards.h"
#include "bake/triangles.h"
#include "base/clock.h"

#include "shadow_cast.glsl.h"
#include "shadow_cover.glsl.h"
#include "shadow_map.glsl.h"

#include <string.h>

enum { UNIT_LAYERS = 4, UNIT_FIRST = 5, UNIT_MAPS = 6, COVERAGE_SAMPLES = 4 };

struct shadow_map {
    const struct scene *scene;
    struct shadow_options options;
    GLuint maps, framebuffer;
    GLuint layers, covered, cover_framebuffer, layer_framebuffer; /* of foliage; else 0 */
    GLuint programs[2][SHADOW_CASTS];                             /* depths, coverage */
    struct shadow_fit fits[SHADOW_CASCADES_MAX];
    double ends_m[SHADOW_CASCADES_MAX + 1];
    float sun[3]; /* that axes and casters are of */
    double axes[3][3];
    struct shadow_box casters;
    float forward[3];
    struct shadow_share share;
};

static GLenum depth_format(int bits)
{
    return bits == 16   ? GL_DEPTH_COMPONENT16
           : bits == 24 ? GL_DEPTH_COMPONENT24
                        : GL_DEPTH_COMPONENT32F;
}

/* Solid maps are compared by the sampler; those with layers are fetched. */
static void prepare_maps(struct gl *gl, struct shadow_map *map)
{
    const struct shadow_options *options = &map->options;
    GLenum filter = options->linear && !map->layers ? GL_LINEAR : GL_NEAREST;
    map->maps = gl_texture(gl, GL_TEXTURE_2D_ARRAY, 1, depth_format(options->depth_bits),
                           options->size_px, options->size_px, options->cascades);
    gl->TextureParameteri(map->maps, GL_TEXTURE_MIN_FILTER, (GLint)filter);
    gl->TextureParameteri(map->maps, GL_TEXTURE_MAG_FILTER, (GLint)filter);
    gl->TextureParameteri(map->maps, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl->TextureParameteri(map->maps, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    if (!map->layers) {
        gl->TextureParameteri(map->maps, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
        gl->TextureParameteri(map->maps, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    }
    map->framebuffer = gl_framebuffer(gl);
    gl->NamedFramebufferDrawBuffer(map->framebuffer, GL_NONE);
}

int shadow_layers(const struct shadow_options *options)
{
    return options->foliage == SHADOW_SOLID ? 0 : options->foliage == SHADOW_ALPHA ? 1 : 4;
}

enum status shadow_cast_program(struct workspace *workspace, const struct shadow_options *options,
                                bool covers, const char *source, const char *defines,
                                GLuint *program)
{
    static const char stage[] = "#pragma stage fragment\n";
    struct arena *scratch = arena_create(0);
    const char *body = strstr(source, stage) + sizeof stage - 1;
    const char *text =
        arena_printf(scratch, "%.*s%s%s", (int)(body - source), source, shadow_cover_glsl, body);
    const char *layers = covers ? arena_printf(scratch, "LAYERS %d\n", shadow_layers(options)) : "";
    enum status status =
        gl_program(workspace->gl, "shadow caster", text,
                   arena_printf(scratch, "%s%s", layers, defines), program, workspace->error);
    arena_destroy(scratch);
    return status;
}

static enum status prepare_programs(struct workspace *workspace, struct shadow_map *map)
{
    const char *variants[SHADOW_CASTS] = {"TERRAIN 1\n", "", "TEXTURED 1\n", "PRUNED 1\n"};
    if (map->scene->terrain.detail_px > 0)
        variants[SHADOW_CAST_TERRAIN] = "TERRAIN 1\nHEIGHTS 1\n";
    for (int covers = 0; covers < (map->layers ? 2 : 1); covers++)
        for (int v = 0; v < SHADOW_CASTS; v++) {
            enum status status =
                shadow_cast_program(workspace, &map->options, covers, shadow_cast_glsl, variants[v],
                                    &map->programs[covers][v]);
            if (status)
                return status;
        }
    return STATUS_OK;
}

static void prepare_layers(struct gl *gl, struct shadow_map *map)
{
    int size = map->options.size_px;
    map->layers =
        gl_texture(gl, GL_TEXTURE_2D_ARRAY, 1, GL_RGBA8, size, size, map->options.cascades);
    gl->TextureParameteri(map->layers, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl->TextureParameteri(map->layers, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    map->covered = gl_texture_multisample(gl, COVERAGE_SAMPLES, GL_RGBA8, size, size);
    map->cover_framebuffer = gl_framebuffer(gl);
    map->layer_framebuffer = gl_framebuffer(gl);
    gl->NamedFramebufferTexture(map->cover_framebuffer, GL_COLOR_ATTACHMENT0, map->covered, 0);
}

enum status shadow_map_prepare(struct workspace *workspace, const struct scene *scene,
                               const struct shadow_options *options, struct shadow_map **result)
{
    struct gl *gl = workspace->gl;
    struct shadow_map *map = *result = ARENA_NEW(workspace->arena, struct shadow_map);
    map->scene = scene;
    map->options = *options;
    if (options->cascades == 0)
        return STATUS_OK;
    if (options->foliage != SHADOW_SOLID)
        prepare_layers(gl, map);
    prepare_maps(gl, map);
    enum status status = prepare_programs(workspace, map);
    return status ? status : gl_check(gl, "shadow map", workspace->error);
}

/* With shadow_map.glsl in front of the source and SHADOWED defined. */
static enum status map_program(struct workspace *workspace, const struct shadow_map *map,
                               const char *name, const char *source, const char *defines,
                               GLuint *program)
{
    const struct shadow_options *options = &map->options;
    const char *all =
        options->cascades == 0
            ? arena_printf(workspace->arena, "SHADOWED 1\nELSEWHERE 1\n%s", defines ? defines : "")
            : arena_printf(workspace->arena,
                           "SHADOWED 1\nBIAS %d\nRADIUS %d\nLINEAR %d\nLAYERS %d\n%s%s",
                           (int)options->bias, options->radius, options->linear && !map->layers,
                           shadow_layers(options), options->shared ? "SHARED 1\n" : "",
                           defines ? defines : "");
    const char *text = arena_printf(workspace->arena, "%s\n%s", shadow_map_glsl, source);
    return gl_program(workspace->gl, name, text, all, program, workspace->error);
}

/* True when a fit is not what it was. */
static bool fits_find(struct shadow_map *map, const struct view *view)
{
    const struct shadow_options *options = &map->options;
    struct shadow_fit before[SHADOW_CASCADES_MAX];
    memcpy(before, map->fits, sizeof before);
    double far_m = (double)view->far_m, near_m = (double)view->near_m;
    if (options->reach_m > 0 && (double)options->reach_m > 1.01 * near_m)
        far_m = fmin(far_m, (double)options->reach_m);
    if (memcmp(map->sun, view->sun_direction, sizeof map->sun) != 0) {
        memcpy(map->sun, view->sun_direction, sizeof map->sun);
        shadow_axes(map->sun, map->axes);
        map->casters = shadow_casters_box(map->scene, (const double(*)[3])map->axes);
    }
    shadow_splits(near_m, far_m, (double)options->split, options->cascades, map->ends_m);
    struct shadow_request request = {.view = view,
                                     .size_px = options->size_px,
                                     .stable = options->stable,
                                     .perspective = options->perspective,
                                     .casters = map->casters};
    for (int c = 0; c < options->cascades; c++) {
        request.near_m = map->ends_m[c];
        request.far_m = map->ends_m[c + 1];
        shadow_fit(&request, (const double(*)[3])map->axes, &map->fits[c]);
    }
    memcpy(map->forward, view->forward, sizeof map->forward);
    return memcmp(before, map->fits, sizeof before) != 0;
}

void shadow_pass_use(struct workspace *workspace, const struct shadow_pass *pass, GLuint program)
{
    struct gl *gl = workspace->gl;
    gl->UseProgram(program);
    gl->UniformMatrix4fv(gl_uniform(gl, program, "light"), 1, GL_FALSE, pass->light);
    gl->Uniform1i(gl_uniform(gl, program, "layer"), pass->cascade);
    gl->Uniform1f(gl_uniform(gl, program, "layer_depth"), pass->layer_depth);
}

static void pass_draw(struct workspace *workspace, const struct shadow_map *map, int cascade,
                      bool covers, const struct shadow_cast_by *trees,
                      const struct backdrop *backdrop)
{
    const struct shadow_fit *fit = &map->fits[cascade];
    struct shadow_pass pass = {.fit = fit,
                               .programs = map->programs[covers],
                               .covers = covers,
                               .cascade = cascade,
                               .layer_depth = map->options.layer_m / (float)fit->range_m};
    for (int i = 0; i < 16; i++)
        pass.light[i] = (float)fit->matrix[i / 4][i % 4];
    if (map->options.caster_tx > 0)
        pass.per_m = 1 / (map->options.caster_tx * (float)fmax(fit->texel_m[0], fit->texel_m[1]));
    memcpy(pass.sun, map->sun, sizeof pass.sun);
    pass.billboards = trees->billboards;
    backdrop_cast(workspace, backdrop, &pass);
    if (trees->billboards)
        shadow_billboards_cast(workspace, trees->billboards, &pass);
    if (trees->triangles)
        triangles_cast(workspace, trees->triangles, &pass);
}

/* Which of a texel's samples are covered, to each depth; then their mean. */
static void cascade_cover(struct workspace *workspace, const struct shadow_map *map, int cascade,
                          const struct shadow_cast_by *trees, const struct backdrop *backdrop)
{
    struct gl *gl = workspace->gl;
    static const float nothing[4] = {0, 0, 0, 0};
    int size = map->options.size_px;
    gl->BindFramebuffer(GL_FRAMEBUFFER, map->cover_framebuffer);
    gl->ClearBufferfv(GL_COLOR, 0, nothing);
    gl->BindTextureUnit(UNIT_FIRST, map->maps);
    gl->Disable(GL_DEPTH_TEST);
    gl->Enable(GL_BLEND);
    gl->BlendEquation(GL_MAX);
    pass_draw(workspace, map, cascade, true, trees, backdrop);
    gl->BlendEquation(GL_FUNC_ADD);
    gl->Disable(GL_BLEND);
    gl->Enable(GL_DEPTH_TEST);
    gl->NamedFramebufferTextureLayer(map->layer_framebuffer, GL_COLOR_ATTACHMENT0, map->layers, 0,
                                     cascade);
    gl->BlitNamedFramebuffer(map->cover_framebuffer, map->layer_framebuffer, 0, 0, size, size, 0, 0,
                             size, size, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

static void maps_make(struct workspace *workspace, struct shadow_map *map,
                      const struct shadow_cast_by *trees, const struct backdrop *backdrop)
{
    struct gl *gl = workspace->gl;
    static const float far_end = 1;
    gl->Disable(GL_SCISSOR_TEST);
    gl->Disable(GL_BLEND);
    gl->Disable(GL_CULL_FACE);
    gl->Enable(GL_DEPTH_TEST);
    gl->DepthFunc(GL_LESS);
    gl->DepthMask(GL_TRUE);
    gl->ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    gl->Enable(GL_DEPTH_CLAMP); /* what is before the map casts too */
    gl->Viewport(0, 0, map->options.size_px, map->options.size_px);
    for (int c = 0; c < map->options.cascades; c++) {
        gl->NamedFramebufferTextureLayer(map->framebuffer, GL_DEPTH_ATTACHMENT, map->maps, 0, c);
        gl->BindFramebuffer(GL_FRAMEBUFFER, map->framebuffer);
        gl->ClearBufferfv(GL_DEPTH, 0, &far_end);
        pass_draw(workspace, map, c, false, trees, backdrop);
        if (map->layers)
            cascade_cover(workspace, map, c, trees, backdrop);
    }
    gl->Disable(GL_DEPTH_CLAMP);
}

static uint64_t bytes_of(const struct shadow_options *options)
{
    uint64_t texels = (uint64_t)options->size_px * (uint64_t)options->size_px;
    uint64_t depth = options->depth_bits == 16 ? 2 : 4;
    uint64_t maps = texels * depth * (uint64_t)options->cascades;
    if (options->foliage == SHADOW_SOLID)
        return maps;
    return maps + texels * 4 * ((uint64_t)options->cascades + COVERAGE_SAMPLES);
}

enum status shadow_map_update(struct workspace *workspace, struct shadow_map *map,
                              const struct view *view, const struct shadow_cast_by *trees,
                              const struct backdrop *backdrop)
{
    struct gl *gl = workspace->gl;
    if (map->options.cascades == 0)
        return STATUS_OK;
    bool changed = fits_find(map, view);
    changed |= backdrop_cast_view(workspace, backdrop, view);
    if (!changed && !workspace->counted)
        return STATUS_OK;
    double start = clock_wall_seconds();
    if (workspace->counted) {
        gl->Finish();
        start = clock_wall_seconds();
    }
    maps_make(workspace, map, trees, backdrop);
    if (workspace->counted) {
        gl->Finish();
        workspace->tally.shadow_seconds += clock_wall_seconds() - start;
        workspace->tally.shadow_bytes += bytes_of(&map->options);
    }
    return gl_check(gl, "shadow map", workspace->error);
}

void shadow_map_share(struct shadow_map *map, struct shadow_share share)
{
    map->share = share;
}

float shadow_map_fine_m(const struct shadow_map *map, const struct view *view, float texel_px)
{
    double fine_m = 0;
    double pixel = 2 * tan(0.5 * (double)view->fov_y_rad) / view->height_px; /* m at 1 m */
    for (int c = 0; c < map->options.cascades; c++) {
        const struct shadow_fit *fit = &map->fits[c];
        double texel_m = fmax(fit->texel_m[0], fit->texel_m[1]);
        double from_m = fmin(texel_m / ((double)texel_px * pixel), map->ends_m[c + 1]);
        if (from_m > map->ends_m[c])
            fine_m = from_m;
    }
    return (float)fine_m;
}

void shadow_receiver_uniforms(struct workspace *workspace, const struct shadow_map *map,
                              GLuint program)
{
    struct gl *gl = workspace->gl;
    if (map && map->options.cascades == 0)
        gl->Uniform1f(gl_uniform(gl, program, "shadow_lit"), map->share.lit);
    if (!map || map->options.cascades == 0)
        return;
    float matrices[SHADOW_CASCADES_MAX][16] = {{0}}, texels[SHADOW_CASCADES_MAX][3] = {{0}};
    float ends[4] = {0};
    for (int c = 0; c < map->options.cascades; c++) {
        const struct shadow_fit *fit = &map->fits[c];
        for (int i = 0; i < 16; i++) { /* from -1..1 to 0..1 */
            double value = fit->matrix[i / 4][i % 4], w = fit->matrix[i / 4][3];
            matrices[c][i] = (float)(i % 4 == 3 ? value : 0.5 * (value + w));
        }
        texels[c][0] = (float)fit->texel_m[0];
        texels[c][1] = (float)fit->texel_m[1];
        texels[c][2] = (float)fit->range_m;
        ends[c] = (float)map->ends_m[c + 1];
    }
    /* A step of what is stored, and of the 24 bits that float arithmetic has on the way. */
    double step = map->options.depth_bits == 16 ? 1.0 / 65535 : 1.0 / 8388607;
    gl->UniformMatrix4fv(gl_uniform(gl, program, "shadow_matrix"), 4, GL_FALSE, matrices[0]);
    gl->Uniform3fv(gl_uniform(gl, program, "shadow_texel"), 4, texels[0]);
    gl->Uniform4fv(gl_uniform(gl, program, "shadow_ends"), 1, ends);
    gl->Uniform3fv(gl_uniform(gl, program, "shadow_forward"), 1, map->forward);
    gl->Uniform1i(gl_uniform(gl, program, "shadow_cascades"), map->options.cascades);
    gl->Uniform1f(gl_uniform(gl, program, "shadow_bias"), map->options.bias_scale);
    gl->Uniform1f(gl_uniform(gl, program, "shadow_size"), (float)map->options.size_px);
    gl->Uniform1f(gl_uniform(gl, program, "shadow_step"), (float)step);
    gl->Uniform1f(gl_uniform(gl, program, "shadow_layer_m"), map->options.layer_m);
    gl->Uniform3f(gl_uniform(gl, program, "shadow_share"), map->share.from_m, map->share.to_m,
                  map->share.lit);
    gl->BindTextureUnit(UNIT_MAPS, map->maps);
    if (map->layers) {
        gl->BindTextureUnit(UNIT_FIRST, map->maps);
        gl->BindTextureUnit(UNIT_LAYERS, map->layers);
    }
}

enum status shadow_receiver_program(struct workspace *workspace, const struct shadow_map *map,
                                    const char *name, const char *source, const char *defines,
                                    GLuint *program)
{
    return map ? map_program(workspace, map, name, source, defines, program)
               : gl_program(workspace->gl, name, source, defines, program, workspace->error);
}
