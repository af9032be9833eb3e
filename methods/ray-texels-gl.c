/* ray-texels-gl: rays marched through voxels of the plants by OpenGL. One triangle covers the
 * picture; each fragment's ray meets the trees of its tile, front to back, until nothing more is
 * seen: hidden trees cost nothing, and the target is blended once. */
#include "bake/backdrop.h"
#include "bake/cull.h"
#include "bake/march_free.h"
#include "bake/march_tree.h"
#include "bake/sunlight_gl.h"
#include "bake/tally.h"
#include "bake/trees_gl.h"
#include "method/method.h"

#include "ray-texels-gl.glsl.h"

#include <string.h>

struct options {
    int resolution, model;
    float stop, step, bias, smooth;
    int shadows;
};

/* clang-format off */
static const struct option table[] = {
    OPTION(struct options, resolution, 128, 1, 256, "", "voxels along a plant's longest extent"),
    OPTION_WORD(struct options, model, 0, "sggx|isotropic",
                "how leaves hide and are lit: by the second moments of their normals, or alike on all sides"),
    OPTION(struct options, stop, 0.02, 0, 0.5, "", "a ray ends when it lets through no more"),
    OPTION(struct options, step, 1.5, 0.125, 4, "voxels", "along a ray, where voxels are not empty"),
    OPTION(struct options, bias, 0, -4, 4, "", "added to the level of detail that a pixel asks for"),
    OPTION(struct options, smooth, 0, 0, 1, "levels",
           "over which a level of detail turns into the next, both being drawn, and the last one into "
           "a point; 0: at once"),
    OPTION(struct options, shadows, 0, 0, 512, "",
           "cells of the sun's shadows along a plant's longest extent; 0: the sun casts none"),
    OPTION_END,
};
/* clang-format on */

enum {
    CELLS,
    VOXELS,
    TREES,
    FIRSTS,
    ENTRIES,
    BUFFERS,
    DEPTH = BUFFERS,
    SUN,
    TEXTURES = SUN + SUNLIGHT_GL_UNITS
};

/* What a program draws: the picture; the same, its lookups counted; the shadow mask. */
enum { DRAWN, COUNTED, MASKED, PROGRAMS };

struct state {
    const struct scene *scene;
    struct options options;
    struct backdrop *backdrop;
    struct voxels_gl *voxels;
    struct trees_gl *trees;
    struct sunlight_gl *sunlight; /* NULL: the sun has no shadows */
    struct cull *cull;
    struct tiles *tiles;
    GLuint programs[PROGRAMS], vertices, framebuffer; /* programs: made when they are asked for */
    GLuint buffers[BUFFERS], textures[BUFFERS];
};

static unsigned effects(const void *values)
{
    const struct options *options = values;
    return EFFECTS_ALL & ~(unsigned)(options->shadows ? 0 : EFFECT_SUN_SHADOWS);
}

static enum status prepare_buffers(struct workspace *workspace, struct state *state)
{
    static const struct {
        GLenum format;
        size_t texel_bytes;
    } formats[BUFFERS] = {[CELLS] = {GL_R32UI, 4},
                          [VOXELS] = {GL_RGBA32UI, 16},
                          [TREES] = {GL_RGBA32UI, 16},
                          [FIRSTS] = {GL_R32UI, 4},
                          [ENTRIES] = {GL_R32UI, 4}};
    const size_t sizes[BUFFERS] = {
        [TREES] = trees_gl_most(state->trees) * sizeof(struct tree_texels),
        [FIRSTS] = (TILES_MAX + 1) * sizeof(uint32_t),
        [ENTRIES] = state->tiles->capacity * sizeof(uint32_t),
    };
    struct gl *gl = workspace->gl;
    state->buffers[CELLS] = state->voxels->cells;
    state->buffers[VOXELS] = state->voxels->voxels;
    enum status status = STATUS_OK;
    for (int i = 0; i < BUFFERS && !status; i++) {
        if (sizes[i] || !state->buffers[i])
            state->buffers[i] = gl_buffer(gl, (GLsizeiptr)sizes[i], NULL, GL_DYNAMIC_STORAGE_BIT);
        status = gl_texture_buffer(gl, formats[i].format, formats[i].texel_bytes, state->buffers[i],
                                   &state->textures[i], workspace->error);
    }
    return status;
}

static enum status make_program(struct workspace *workspace, struct state *state, int kind)
{
    static const char *const kinds[PROGRAMS] = {"", "COUNT 1\n", "MASKED 1\n"};
    struct arena *scratch = arena_create(0);
    const char *defines = arena_printf(
        scratch, "FULL %uu\nPROBES 2\nBIAS %d\nSOLID %g\n%s%s%s%s%s", MARCH_FULL, TREE_TEXELS_BIAS,
        (double)march_solid, scene_is_stretched(state->scene) ? "STRETCHED 1\n" : "",
        state->options.smooth > 0 ? "SMOOTH 1\n" : "", state->options.model ? "ISOTROPIC 1\n" : "",
        state->sunlight ? "SHADOWS 1\n" : "", kinds[kind]);
    enum status status = STATUS_OK;
    if (!state->programs[kind])
        status = gl_program(workspace->gl, "ray-texels-gl", ray_texels_gl_glsl, defines,
                            &state->programs[kind], workspace->error);
    arena_destroy(scratch);
    return status;
}

/* Shadows of what is there, and the ground receives them. */
static enum status prepare_sunlight(struct workspace *workspace, struct state *state)
{
    const struct sunlight_gl_request request = {.voxels = state->voxels,
                                                .trees = trees_gl_trees(state->trees),
                                                .model = state->options.model ? MARCH_ISOTROPIC
                                                                              : MARCH_SGGX,
                                                .cells = state->options.shadows};
    if (!state->options.shadows || !(workspace->effects & EFFECT_SUN_SHADOWS))
        return STATUS_OK;
    enum status status = sunlight_gl_prepare(workspace, state->scene, &request, &state->sunlight);
    trees_gl_shade(state->trees, state->sunlight);
    return status ? status : backdrop_receive_sunlight(workspace, state->backdrop, state->sunlight);
}

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *values, void **result)
{
    struct gl *gl = workspace->gl;
    struct arena *arena = workspace->arena;
    struct state *state = *result = ARENA_NEW(arena, struct state);
    state->scene = scene;
    state->options = *(const struct options *)values;
    state->vertices = gl_vertex_array(gl);
    state->framebuffer = gl_framebuffer(gl);
    enum status status = backdrop_prepare(workspace, scene, &state->backdrop);
    if (!status)
        status = voxels_gl_prepare(workspace, scene, state->options.resolution, &state->voxels);
    if (status)
        return status;
    state->cull = cull_create(arena, scene, state->voxels->bounds);
    state->trees =
        trees_gl_create(arena, scene, state->voxels, state->options.bias, state->options.smooth);
    state->tiles = tiles_create(arena, trees_gl_most(state->trees));
    status = prepare_sunlight(workspace, state);
    if (!status)
        status = prepare_buffers(workspace, state);
    if (!status)
        status = make_program(workspace, state, DRAWN);
    return status ? status : gl_check(gl, "ray-texels-gl", workspace->error);
}

/* Trees in view to the shader; false when there are none. */
static bool upload_trees(struct workspace *workspace, struct state *state, const struct view *view)
{
    struct gl *gl = workspace->gl;
    const float fog =
        workspace->effects & EFFECT_FOG && !workspace->masked ? state->scene->fog.density_per_m : 0;
    const struct tiles_rect *rects;
    const struct tree_texels *texels;
    struct cull_list list = cull_view(state->cull, view, CULL_FRONT_TO_BACK);
    struct tiles *tiles = state->tiles;
    size_t count = trees_gl_see(state->trees, view, &list, fog, &rects, &texels);
    tiles_bin(tiles, view->width_px, view->height_px, rects, count);
    size_t tiles_count = (size_t)(tiles->columns * tiles->rows);
    size_t entries_count = tiles->first[tiles_count];
    if (entries_count == 0)
        return false;
    gl->NamedBufferSubData(state->buffers[TREES], 0, (GLsizeiptr)(count * sizeof *texels), texels);
    gl->NamedBufferSubData(state->buffers[FIRSTS], 0,
                           (GLsizeiptr)((tiles_count + 1) * sizeof(uint32_t)), tiles->first);
    gl->NamedBufferSubData(state->buffers[ENTRIES], 0,
                           (GLsizeiptr)(entries_count * sizeof(uint32_t)), tiles->entries);
    return true;
}

static void set_uniforms(struct workspace *workspace, const struct state *state, GLuint program,
                         const struct view *view)
{
    struct gl *gl = workspace->gl;
    const float focal = cull_focal_px(view);
    const float width = (float)view->width_px, height = (float)view->height_px;
    float axes[9];
    memcpy(axes, view->right, sizeof view->right);
    memcpy(axes + 3, view->up, sizeof view->up);
    memcpy(axes + 6, view->forward, sizeof view->forward);
    shade_uniforms(workspace, program, state->scene, view);
    gl->Uniform2f(gl_uniform(gl, program, "pixel_slope"), 1 / focal, 1 / focal);
    gl->Uniform2f(gl_uniform(gl, program, "corner_slope"), 0.5f * (1 - width) / focal,
                  0.5f * (1 - height) / focal);
    gl->UniformMatrix3fv(gl_uniform(gl, program, "axes"), 1, GL_FALSE, axes);
    gl->Uniform3i(gl_uniform(gl, program, "tiling"), state->tiles->side_px, state->tiles->columns,
                  view->height_px);
    gl->Uniform2f(gl_uniform(gl, program, "depth_terms"), view->projection[2][2],
                  view->projection[3][2]);
    gl->Uniform4f(gl_uniform(gl, program, "limits"), view->near_m, state->options.stop,
                  state->options.step, workspace->effects & EFFECT_TWO_SIDED ? 0 : 1);
}

/* Where trees are in a row of tiles; up to GAP empty tiles between cost less than another draw. */
static void draw_row(struct gl *gl, const struct tiles *tiles, int row, int height_px)
{
    enum { GAP = 3 };
    const uint32_t *first = tiles->first + row * tiles->columns;
    const int side = tiles->side_px, low_px = height_px - (row + 1) * side;
    for (int x = 0; x < tiles->columns; x++) {
        if (first[x + 1] == first[x])
            continue;
        int begin = x, end = x + 1;
        for (; x < tiles->columns && x < end + GAP; x++)
            if (first[x + 1] > first[x])
                end = x + 1;
        gl->Scissor(begin * side, low_px > 0 ? low_px : 0, (end - begin) * side,
                    low_px > 0 ? side : side + low_px);
        gl_draw_arrays(gl, GL_TRIANGLES, 0, 3, 1);
    }
}

/* The target's colour without its depth, which the shader reads. */
static void draw_trees(struct workspace *workspace, const struct state *state, GLuint program,
                       const struct view *view, const struct target *target)
{
    struct gl *gl = workspace->gl;
    gl->NamedFramebufferTexture(state->framebuffer, GL_COLOR_ATTACHMENT0, target->color, 0);
    gl->BindFramebuffer(GL_FRAMEBUFFER, state->framebuffer);
    gl->UseProgram(program);
    gl->BindVertexArray(state->vertices);
    for (GLuint i = 0; i < BUFFERS; i++)
        gl->BindTextureUnit(i, state->textures[i]);
    gl->BindTextureUnit(DEPTH, target->depth);
    set_uniforms(workspace, state, program, view);
    if (state->sunlight)
        sunlight_gl_bind(workspace, state->sunlight, program, SUN);
    gl->Disable(GL_DEPTH_TEST);
    gl->Enable(GL_BLEND);
    gl->BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    gl->Enable(GL_SCISSOR_TEST);
    for (int row = 0; row < state->tiles->rows; row++)
        draw_row(gl, state->tiles, row, view->height_px);
    gl->Disable(GL_SCISSOR_TEST);
    gl->Disable(GL_BLEND);
    gl->Enable(GL_DEPTH_TEST);
    for (GLuint i = 0; i < TEXTURES; i++)
        gl->BindTextureUnit(i, 0);
    gl->BindVertexArray(0);
    gl->UseProgram(0);
    gl->BindFramebuffer(GL_FRAMEBUFFER, target->framebuffer);
}

/* The same with the lookups counted, a counter a row of pixels. */
static enum status count_trees(struct workspace *workspace, struct state *state,
                               const struct view *view, const struct target *target)
{
    size_t rows = (size_t)target->height_px;
    enum status status = make_program(workspace, state, COUNTED);
    if (status)
        return status;
    GLuint counters = tally_words_begin(workspace, 0, rows);
    draw_trees(workspace, state, state->programs[COUNTED], view, target);
    workspace->tally.lookups += tally_words_end(workspace, counters, 0, rows);
    return STATUS_OK;
}

static enum status draw(struct workspace *workspace, void *own, const struct view *view,
                        struct target *target)
{
    struct state *state = own;
    struct gl *gl = workspace->gl;
    enum status status = STATUS_OK;
    if (state->sunlight)
        status = sunlight_gl_update(workspace, state->sunlight, view);
    if (status)
        return status;
    gl->BindFramebuffer(GL_FRAMEBUFFER, target->framebuffer);
    backdrop_draw(workspace, state->backdrop, view);
    gl->Flush(); /* a software GL fills the backdrop while the trees are culled and binned */
    bool any = upload_trees(workspace, state, view);
    const int kind = workspace->masked ? MASKED : DRAWN;
    if (any && workspace->counted)
        status = count_trees(workspace, state, view, target);
    else if (any)
        status = make_program(workspace, state, kind);
    if (any && !workspace->counted && !status)
        draw_trees(workspace, state, state->programs[kind], view, target);
    return status ? status : gl_check(gl, "ray-texels-gl", workspace->error);
}

extern const struct method ray_texels_gl_method;
const struct method ray_texels_gl_method = {
    .abi = METHOD_ABI,
    .name = "ray-texels-gl",
    .summary = "rays marched through voxels of the plants, by OpenGL",
    .source = "Kajiya and Kay 1989, doi:10.1145/74334.74361; Neyret 1998, doi:10.1109/2945.675652; "
              "Heitz et al. 2015, doi:10.1145/2766988; Senegas 2001",
    .traits = EFFECT_TWO_SIDED | EFFECT_AMBIENT | EFFECT_SUN_SHADOWS | EFFECT_FOG | TRAIT_MASK,
    .options = table,
    .options_size = sizeof(struct options),
    .effects = effects,
    .prepare = prepare,
    .draw = draw,
};
