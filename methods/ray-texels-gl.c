/* ray-texels-gl: rays marched through voxels of the plants by OpenGL. One triangle covers the
 * picture; each fragment's ray meets the trees of its tile, front to back, until nothing more is
 * seen: hidden trees cost nothing, and the target is blended once. */
#include "bake/backdrop.h"
#include "bake/cull.h"
#include "bake/march_tree.h"
#include "bake/tally.h"
#include "bake/tiles.h"
#include "bake/voxels.h"
#include "method/method.h"

#include "ray-texels-gl.glsl.h"

#include <math.h>
#include <string.h>

struct options {
    int resolution, model;
    float stop, step, bias, smooth;
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
    OPTION_END,
};
/* clang-format on */

enum { CELLS, VOXELS, TREES, FIRSTS, ENTRIES, BUFFERS, DEPTH = BUFFERS, TEXTURES };

/* A tree as the shader reads it: three texels. */
struct texels {
    uint16_t low[2], high[2]; /* pixels, both ends included, row 0 on top */
    uint32_t first_cell;
    uint32_t size;   /* three times 10 bits; bit 30: smaller than a pixel; 31: opaque */
    float where[3];  /* the eye in voxels from the box's corner; of a small tree: its middle on
                        the screen, from pixel centres, px; its area, px^2 */
    float per_m;     /* voxels a metre; of a small tree: its depth along the view, m */
    float turn[2];   /* cosine, sine, both over the stretch */
    uint32_t shares; /* what fog leaves, and of the optical depth what is drawn: 16 bits each */
    uint32_t albedo; /* three times 10 bits */
};

/* Of a tree while one thing turns into another: two levels and a point. */
enum { PIECES_MOST = 3 };
struct piece {
    uint32_t level;
    bool small;  /* a point */
    float share; /* of the tree's optical depth */
};

struct state {
    const struct scene *scene;
    struct options options;
    struct backdrop *backdrop;
    const struct voxels **volumes;              /* one a species */
    const struct mesh **meshes;                 /* the same */
    uint32_t (*first_cells)[VOXELS_LEVELS_MAX]; /* one a species: in the buffer of cells */
    struct cull *cull;
    struct tiles *tiles;
    struct tiles_rect *rects; /* of the trees in view, in their order */
    struct texels *texels;
    struct march_tree *trees;                        /* one an instance */
    GLuint program, counting, vertices, framebuffer; /* counting: made when it is asked for */
    GLuint buffers[BUFFERS], textures[BUFFERS];
};

/* Voxels of all species in one row; cells name them. */
static void upload_volumes(struct workspace *workspace, struct state *state)
{
    const size_t species_count = state->scene->species_count;
    struct arena *scratch = arena_create(0);
    size_t cells_count = 0, voxels_count = 0;
    for (size_t i = 0; i < species_count; i++) {
        const struct voxels *volume = state->volumes[i];
        voxels_count += volume->voxels_count;
        for (uint32_t k = 0; k < volume->levels_count; k++) {
            const uint32_t *size = volume->levels[k].size;
            state->first_cells[i][k] = (uint32_t)cells_count;
            cells_count += (size_t)size[0] * size[1] * size[2];
        }
    }
    uint32_t *cells = ARENA_ARRAY(scratch, uint32_t, cells_count);
    struct voxel *voxels = ARENA_ARRAY(scratch, struct voxel, voxels_count);
    uint32_t *cell = cells, first = 0;
    for (size_t i = 0; i < species_count; i++) {
        const struct voxels *volume = state->volumes[i];
        memcpy(voxels + first, volume->voxels, volume->voxels_count * sizeof *voxels);
        for (uint32_t v = 0; v < volume->voxels_count && mesh_is_solid(state->meshes[i]); v++)
            voxels[first + v].color |= 15u << 28; /* needles are lit as bark is */
        for (uint32_t k = 0; k < volume->levels_count; k++) {
            const struct voxels_level *level = &volume->levels[k];
            size_t count = (size_t)level->size[0] * level->size[1] * level->size[2];
            for (size_t at = 0; at < count; at++)
                *cell++ = level->cells[at] + (level->cells[at] < VOXELS_FIRST ? 0 : first);
        }
        first += volume->voxels_count;
    }
    state->buffers[CELLS] =
        gl_buffer(workspace->gl, (GLsizeiptr)(cells_count * sizeof *cells), cells, 0);
    state->buffers[VOXELS] =
        gl_buffer(workspace->gl, (GLsizeiptr)(voxels_count * sizeof *voxels), voxels, 0);
    arena_destroy(scratch);
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
        [TREES] = state->scene->instances_count * sizeof(struct texels) *
                  (state->options.smooth > 0 ? PIECES_MOST : 1),
        [FIRSTS] = (TILES_MAX + 1) * sizeof(uint32_t),
        [ENTRIES] = state->tiles->capacity * sizeof(uint32_t),
    };
    struct gl *gl = workspace->gl;
    upload_volumes(workspace, state);
    enum status status = STATUS_OK;
    for (int i = 0; i < BUFFERS && !status; i++) {
        if (sizes[i] || !state->buffers[i])
            state->buffers[i] = gl_buffer(gl, (GLsizeiptr)sizes[i], NULL, GL_DYNAMIC_STORAGE_BIT);
        status = gl_texture_buffer(gl, formats[i].format, formats[i].texel_bytes, state->buffers[i],
                                   &state->textures[i], workspace->error);
    }
    return status;
}

static enum status prepare_volumes(struct workspace *workspace, struct state *state)
{
    const struct scene *scene = state->scene;
    /* the level of detail is the volumes' resolution */
    int divisor = workspace->lod == LOD_LOW ? 4 : workspace->lod == LOD_INTERMEDIATE ? 2 : 1;
    int resolution = (state->options.resolution + divisor - 1) / divisor;
    struct cull_bound *bounds =
        ARENA_ARRAY(workspace->arena, struct cull_bound, scene->species_count);
    state->volumes = ARENA_ARRAY(workspace->arena, const struct voxels *, scene->species_count);
    state->meshes = ARENA_ARRAY(workspace->arena, const struct mesh *, scene->species_count);
    state->first_cells =
        arena_alloc(workspace->arena, scene->species_count, sizeof *state->first_cells);
    for (size_t i = 0; i < scene->species_count; i++) {
        const struct mesh *mesh;
        enum status status = voxels_of_plant(workspace->arena, scene->species[i].plant, resolution,
                                             &state->volumes[i], workspace->error);
        if (!status)
            status = plant_mesh(scene->species[i].plant, &mesh, workspace->error);
        if (status)
            return status;
        bounds[i] = cull_bound_of(mesh);
        state->meshes[i] = mesh;
    }
    state->cull = cull_create(workspace->arena, scene, bounds);
    return STATUS_OK;
}

static enum status make_program(struct workspace *workspace, const struct state *state, bool counts,
                                GLuint *program)
{
    struct arena *scratch = arena_create(0);
    const char *defines =
        arena_printf(scratch, "FIRST 256u\nPROBES 2\nSOLID %g\n%s%s%s%s", (double)march_solid,
                     scene_is_stretched(state->scene) ? "STRETCHED 1\n" : "",
                     state->options.smooth > 0 ? "SMOOTH 1\n" : "",
                     state->options.model ? "ISOTROPIC 1\n" : "", counts ? "COUNT 1\n" : "");
    enum status status = gl_program(workspace->gl, "ray-texels-gl", ray_texels_gl_glsl, defines,
                                    program, workspace->error);
    arena_destroy(scratch);
    return status;
}

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *values, void **result)
{
    struct gl *gl = workspace->gl;
    struct state *state = *result = ARENA_NEW(workspace->arena, struct state);
    state->scene = scene;
    state->options = *(const struct options *)values;
    const size_t count = scene->instances_count * (state->options.smooth > 0 ? PIECES_MOST : 1);
    state->tiles = tiles_create(workspace->arena, count);
    state->rects = ARENA_ARRAY(workspace->arena, struct tiles_rect, count);
    state->texels = ARENA_ARRAY(workspace->arena, struct texels, count);
    state->trees = ARENA_ARRAY(workspace->arena, struct march_tree, scene->instances_count);
    march_trees_fill(scene, state->trees);
    state->vertices = gl_vertex_array(gl);
    state->framebuffer = gl_framebuffer(gl);
    enum status status = backdrop_prepare(workspace, scene, &state->backdrop);
    if (!status)
        status = prepare_volumes(workspace, state);
    if (!status)
        status = prepare_buffers(workspace, state);
    if (!status)
        status = make_program(workspace, state, false, &state->program);
    return status ? status : gl_check(gl, "ray-texels-gl", workspace->error);
}

/* A picture's constants. */
struct picture {
    const struct view *view;
    float focal_px, fog_density;
};

static int16_t pixel_of(float at_px, int size_px)
{
    return (int16_t)(at_px > 0 ? at_px < (float)size_px ? at_px : (float)size_px : 0);
}

/* The pixels from first to last that are in the picture. */
static void rect_between(struct tiles_rect *rect, int axis, float first, float last, int size_px)
{
    bool any = first < (float)size_px && last >= 0;
    rect->low[axis] = any ? pixel_of(first, size_px) : 0;
    rect->high[axis] = any ? pixel_of(last, size_px - 1) : -1;
}

/* A tree about as small as a pixel covers its share of the four pixels around its middle. */
static void place_small(const struct picture *picture, const struct march_tree *tree,
                        const struct march_outline *outline, const struct march_box *box,
                        float side_m, struct tiles_rect *rect, struct texels *texels)
{
    const struct view *view = picture->view;
    const float *forward = view->forward, *middle = box->middle_m;
    float depth = middle[0] * forward[0] + middle[1] * forward[1] + middle[2] * forward[2];
    float side_px = picture->focal_px * side_m / depth, stretch = tree->stretch;
    /* a cube of the plant, seen along its axis w, covers stretch / |w stretched| of its side^2 */
    float level_m2 = middle[0] * middle[0] + middle[2] * middle[2], rise_m2 = middle[1] * middle[1];
    float cover =
        stretch == 1
            ? 1
            : stretch * sqrtf((level_m2 + rise_m2 / (stretch * stretch)) / (level_m2 + rise_m2));
    for (int i = 0; i < 2; i++) {
        float first = floorf(outline->middle[i]);
        rect_between(rect, i, first, first + 1, i ? view->height_px : view->width_px);
        texels->where[i] = outline->middle[i];
    }
    texels->where[2] = side_px * side_px * cover;
    texels->per_m = depth;
}

static uint32_t pack_10(const uint32_t values[3])
{
    return values[0] | values[1] << 10 | values[2] << 20;
}

/* The share of the coarser of two, all of it at a size, nothing from smooth octaves above on. */
static float coarser_share(float octaves, float smooth)
{
    if (octaves < 0 || !(smooth > 0))
        return octaves < 0 ? 1 : 0;
    return fmaxf(0, 1 - octaves / smooth);
}

/* What a tree is drawn as; returns how many pieces. */
static int pieces_of(const struct state *state, const struct picture *picture, uint32_t number,
                     float depth_m, struct piece pieces[PIECES_MOST])
{
    static const float small_px = 0.75f;
    const struct view *view = picture->view;
    const struct march_tree *tree = &state->trees[number];
    const struct voxels *volume = state->volumes[tree->species];
    const float smooth = state->options.smooth;
    const uint32_t last = volume->levels_count - 1;
    float detail =
        march_detail_of(view, tree, volume, picture->focal_px, state->options.bias, depth_m);
    struct march_box box = march_box_of(view, tree, volume, 0);
    struct march_outline outline = march_outline_of(view, &box, picture->focal_px);
    float side_px = fmaxf(outline.high[0] - outline.low[0], outline.high[1] - outline.low[1]);
    float small = outline.before ? coarser_share(log2f(side_px / (2 * small_px)), smooth) : 0;
    uint32_t level = (uint32_t)detail;
    float next = level < last ? coarser_share((float)(level + 1) - detail, smooth) : 0;
    const struct piece all[PIECES_MOST] = {{level, false, (1 - next) * (1 - small)},
                                           {level + 1, false, next * (1 - small)},
                                           {last, true, small}};
    int count = 0;
    for (int k = 0; k < PIECES_MOST; k++)
        if (all[k].share > 0)
            pieces[count++] = all[k];
    return count;
}

static void see(const struct state *state, const struct picture *picture, uint32_t number,
                const struct piece *piece, struct tiles_rect *rect, struct texels *texels)
{
    const struct view *view = picture->view;
    const struct march_tree *tree = &state->trees[number];
    const struct voxels *volume = state->volumes[tree->species];
    struct march_box box = march_box_of(view, tree, volume, piece->small ? 0 : piece->level);
    struct march_outline outline = march_outline_of(view, &box, picture->focal_px);
    const struct voxels_level *grid = &volume->levels[piece->level];
    const float voxel_m = tree->scale * grid->voxel_m;
    if (piece->small) {
        place_small(picture, tree, &outline, &box, voxel_m, rect, texels);
    } else {
        texels->per_m = 1 / voxel_m;
        march_eye_of(view, tree, volume, piece->level, texels->per_m, texels->where);
        const int size_px[2] = {view->width_px, view->height_px};
        for (int i = 0; i < 2; i++)
            rect_between(rect, i, ceilf(outline.low[i]), floorf(outline.high[i]),
                         outline.any ? size_px[i] : 0);
    }
    uint32_t albedo[3];
    for (int c = 0; c < 3; c++)
        albedo[c] = (uint32_t)(volume->albedo[c] * 1023 + 0.5f);
    for (int i = 0; i < 2; i++) {
        texels->low[i] = (uint16_t)rect->low[i];
        texels->high[i] = (uint16_t)rect->high[i];
    }
    bool within = !outline.before && march_within_bark(view, tree, state->meshes[tree->species]);
    texels->first_cell = state->first_cells[tree->species][piece->level];
    texels->size = pack_10(grid->size) | (uint32_t)piece->small << 30 | (uint32_t)within << 31;
    texels->turn[0] = tree->cosine / tree->stretch;
    texels->turn[1] = tree->sine / tree->stretch;
    float clear = march_box_clear(&box, picture->fog_density);
    texels->shares = (uint32_t)(65535 * clear + 0.5f) | (uint32_t)(65535 * piece->share + 0.5f)
                                                            << 16;
    texels->albedo = pack_10(albedo);
}

/* Trees in view to the shader; false when there are none. */
static bool upload_trees(struct workspace *workspace, struct state *state, const struct view *view)
{
    struct gl *gl = workspace->gl;
    const struct picture picture = {
        .view = view,
        .focal_px = cull_focal_px(view),
        .fog_density = workspace->effects & EFFECT_FOG ? state->scene->fog.density_per_m : 0,
    };
    struct cull_list list = cull_view(state->cull, view, CULL_FRONT_TO_BACK);
    struct tiles *tiles = state->tiles;
    size_t count = 0;
    for (size_t i = 0; i < list.count; i++) {
        struct piece pieces[PIECES_MOST];
        int pieces_count = pieces_of(state, &picture, list.instances[i], list.depths_m[i], pieces);
        for (int k = 0; k < pieces_count; k++, count++)
            see(state, &picture, list.instances[i], &pieces[k], &state->rects[count],
                &state->texels[count]);
    }
    tiles_bin(tiles, view->width_px, view->height_px, state->rects, count);
    size_t tiles_count = (size_t)(tiles->columns * tiles->rows);
    size_t entries_count = tiles->first[tiles_count];
    if (entries_count == 0)
        return false;
    gl->NamedBufferSubData(state->buffers[TREES], 0, (GLsizeiptr)(count * sizeof *state->texels),
                           state->texels);
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
    enum status status = STATUS_OK;
    size_t rows = (size_t)target->height_px;
    if (!state->counting)
        status = make_program(workspace, state, true, &state->counting);
    if (status)
        return status;
    GLuint counters = tally_words_begin(workspace, 0, rows);
    draw_trees(workspace, state, state->counting, view, target);
    workspace->tally.lookups += tally_words_end(workspace, counters, 0, rows);
    return STATUS_OK;
}

static enum status draw(struct workspace *workspace, void *own, const struct view *view,
                        struct target *target)
{
    struct state *state = own;
    struct gl *gl = workspace->gl;
    gl->BindFramebuffer(GL_FRAMEBUFFER, target->framebuffer);
    backdrop_draw(workspace, state->backdrop, view);
    gl->Flush(); /* a software GL fills the backdrop while the trees are culled and binned */
    bool any = upload_trees(workspace, state, view);
    enum status status = STATUS_OK;
    if (any && workspace->counted)
        status = count_trees(workspace, state, view, target);
    else if (any)
        draw_trees(workspace, state, state->program, view, target);
    return status ? status : gl_check(gl, "ray-texels-gl", workspace->error);
}

extern const struct method ray_texels_gl_method;
const struct method ray_texels_gl_method = {
    .abi = METHOD_ABI,
    .name = "ray-texels-gl",
    .summary = "rays marched through voxels of the plants, by OpenGL",
    .source = "Kajiya and Kay 1989, doi:10.1145/74334.74361; Neyret 1998, doi:10.1109/2945.675652; "
              "Heitz et al. 2015, doi:10.1145/2766988; Senegas 2001",
    .traits = EFFECT_TWO_SIDED | EFFECT_AMBIENT | EFFECT_FOG,
    .options = table,
    .options_size = sizeof(struct options),
    .prepare = prepare,
    .draw = draw,
};
