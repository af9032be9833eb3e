/* What OpenGL can do at most: fill, triangles, vertices and draw calls, through the same context
 * and target as the methods use. */
#include "calibrate/bench.h"

#include "gl_bench.glsl.h"

#include <math.h>
#include <string.h>

enum {
    PATCH = 64,           /* cells along a patch of small triangles */
    TEXTURE_PX = 256,     /* along a side; a layer's left half is opaque */
    QUADS_MOST = 1 << 13, /* a loop */
    SAMPLES = 16,         /* a fragment */
    LOOKUPS = 32,
    WORDS = 1 << 16 /* 256 KiB: as the CPU's lookups have them (bench.h) */
};

/* Triangles to draw, all instances at once. */
struct shape {
    GLuint vertex_array;
    GLenum mode;
    GLsizei count, instances;
    bool indexed;
    float cell_px[2];
};

enum paint { PAINT_FLAT, PAINT_TEXTURED, PAINT_TESTED, PAINT_SAMPLES, PAINT_LOOKUPS, PAINTS_COUNT };

struct gl_bench {
    struct gl *gl;
    struct target target;
    struct arena *arena;
    struct {
        GLuint program;
        GLint cell_px, depth, color;
    } paints[PAINTS_COUNT];
    GLuint textures[2], words;
    struct shape picture, shared, single, quads[3];
};

struct gl *gl_bench_gl(const struct gl_bench *bench)
{
    return bench->gl;
}

const struct target *gl_bench_target(const struct gl_bench *bench)
{
    return &bench->target;
}

/* corners: corners_count x 2; indices may be NULL; places: instances x 2, px. */
static struct shape shape_make(struct gl *gl, GLenum mode, const float *corners,
                               size_t corners_count, const uint32_t *indices, size_t indices_count,
                               const float *places, size_t instances)
{
    const GLsizei pair = 2 * sizeof(float);
    struct shape shape = {.vertex_array = gl_vertex_array(gl),
                          .mode = mode,
                          .count = (GLsizei)(indices ? indices_count : corners_count),
                          .instances = (GLsizei)instances,
                          .indexed = indices != NULL};
    GLuint buffers[2] = {gl_buffer(gl, (GLsizeiptr)corners_count * pair, corners, 0),
                         gl_buffer(gl, (GLsizeiptr)instances * pair, places, 0)};
    for (GLuint i = 0; i < 2; i++) {
        gl->VertexArrayVertexBuffer(shape.vertex_array, i, buffers[i], 0, pair);
        gl->EnableVertexArrayAttrib(shape.vertex_array, i);
        gl->VertexArrayAttribFormat(shape.vertex_array, i, 2, GL_FLOAT, GL_FALSE, 0);
        gl->VertexArrayAttribBinding(shape.vertex_array, i, i);
        gl->VertexArrayBindingDivisor(shape.vertex_array, i, i);
    }
    if (indices)
        gl->VertexArrayElementBuffer(
            shape.vertex_array,
            gl_buffer(gl, (GLsizeiptr)(indices_count * sizeof *indices), indices, 0));
    return shape;
}

/* Whole cells of this size side by side over the target, at most most of them. */
static float *places_make(const struct gl_bench *bench, float side_px, size_t most, size_t *count)
{
    size_t columns = (size_t)((float)bench->target.width_px / side_px);
    size_t rows = (size_t)((float)bench->target.height_px / side_px);
    *count = columns * rows < most ? columns * rows : most;
    float *places = ARENA_ARRAY(bench->arena, float, 2 * *count);
    for (size_t i = 0; i < *count; i++) {
        places[2 * i] = (float)(i % columns) * side_px;
        places[2 * i + 1] = (float)(i / columns) * side_px;
    }
    return places;
}

static const float strip[4][2] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};

static struct shape quads_make(const struct gl_bench *bench, float side_px)
{
    size_t count;
    const float *places = places_make(bench, side_px, QUADS_MOST, &count);
    struct shape shape =
        shape_make(bench->gl, GL_TRIANGLE_STRIP, &strip[0][0], 4, NULL, 0, places, count);
    shape.cell_px[0] = shape.cell_px[1] = side_px;
    return shape;
}

/* Two counter-clockwise triangles a cell of half a pixel, PATCH x PATCH cells. */
static void patches_make(struct gl_bench *bench)
{
    enum { SIDE = PATCH + 1, CORNERS = SIDE * SIDE, INDICES = 6 * PATCH * PATCH };
    float *corners = ARENA_ARRAY(bench->arena, float, 2 * CORNERS);
    float *own = ARENA_ARRAY(bench->arena, float, 2 * INDICES);
    uint32_t *indices = ARENA_ARRAY(bench->arena, uint32_t, INDICES), *index = indices;
    for (uint32_t i = 0; i < CORNERS; i++) {
        corners[2 * i] = (float)(i % SIDE);
        corners[2 * i + 1] = (float)(i / SIDE);
    }
    for (uint32_t row = 0; row < PATCH; row++)
        for (uint32_t column = 0; column < PATCH; column++) {
            uint32_t first = row * SIDE + column;
            const uint32_t six[6] = {first,     first + 1,        first + SIDE,
                                     first + 1, first + SIDE + 1, first + SIDE};
            memcpy(index, six, sizeof six);
            index += 6;
        }
    for (size_t i = 0; i < INDICES; i++)
        memcpy(own + 2 * i, corners + 2 * (size_t)indices[i], 2 * sizeof *own);
    const float cell_px = 0.5f;
    size_t count;
    const float *places = places_make(bench, PATCH * cell_px, 4, &count);
    bench->shared =
        shape_make(bench->gl, GL_TRIANGLES, corners, CORNERS, indices, INDICES, places, count);
    bench->single = shape_make(bench->gl, GL_TRIANGLES, own, INDICES, NULL, 0, places, count);
    bench->shared.cell_px[0] = bench->shared.cell_px[1] = cell_px;
    bench->single.cell_px[0] = bench->single.cell_px[1] = cell_px;
}

/* Two layers; each texel's colour tells its place, the left half is opaque. */
static void textures_make(struct gl_bench *bench)
{
    struct gl *gl = bench->gl;
    const size_t texels = (size_t)TEXTURE_PX * TEXTURE_PX;
    uint8_t *rgba = ARENA_ARRAY(bench->arena, uint8_t, 4 * texels);
    for (size_t i = 0; i < texels; i++) {
        size_t x = i % TEXTURE_PX, y = i / TEXTURE_PX;
        const uint8_t texel[4] = {(uint8_t)x, (uint8_t)y, 0, x < TEXTURE_PX / 2 ? 255 : 0};
        memcpy(rgba + 4 * i, texel, sizeof texel);
    }
    for (int k = 0; k < 2; k++) {
        GLuint texture = bench->textures[k] =
            gl_texture(gl, GL_TEXTURE_2D_ARRAY, 1, GL_RGBA8, TEXTURE_PX, TEXTURE_PX, 2);
        for (int layer = 0; layer < 2; layer++)
            gl->TextureSubImage3D(texture, 0, 0, 0, layer, TEXTURE_PX, TEXTURE_PX, 1, GL_RGBA,
                                  GL_UNSIGNED_BYTE, rgba);
        gl->TextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        gl->TextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    }
}

static enum status words_make(struct gl_bench *bench, struct error *error)
{
    uint32_t *words = ARENA_ARRAY(bench->arena, uint32_t, WORDS);
    for (uint32_t i = 0; i < WORDS; i++)
        words[i] = i;
    GLuint buffer = gl_buffer(bench->gl, WORDS * sizeof *words, words, 0);
    return gl_texture_buffer(bench->gl, GL_R32UI, sizeof *words, buffer, &bench->words, error);
}

static enum status paints_make(struct gl_bench *bench, struct error *error)
{
    const char *const defines[PAINTS_COUNT] = {
        [PAINT_TEXTURED] = "TEXTURED 1\n",
        [PAINT_TESTED] = "TEXTURED 1\nTESTED 1\n",
        [PAINT_SAMPLES] = arena_printf(bench->arena, "TEXTURED 1\nSAMPLES %d\n", SAMPLES),
        [PAINT_LOOKUPS] = arena_printf(bench->arena, "LOOKUPS %d\n", LOOKUPS)};
    struct gl *gl = bench->gl;
    for (int i = 0; i < PAINTS_COUNT; i++) {
        GLuint program;
        enum status status =
            gl_program(gl, "calibration", gl_bench_glsl, defines[i], &program, error);
        if (status)
            return status;
        bench->paints[i].program = program;
        bench->paints[i].cell_px = gl_uniform(gl, program, "cell_px");
        bench->paints[i].depth = gl_uniform(gl, program, "depth");
        bench->paints[i].color = gl_uniform(gl, program, "color");
        gl->ProgramUniform2f(program, gl_uniform(gl, program, "to_ndc"),
                             2 / (float)bench->target.width_px, 2 / (float)bench->target.height_px);
        gl->ProgramUniform1f(program, gl_uniform(gl, program, "texel"), 1.0f / TEXTURE_PX);
    }
    return STATUS_OK;
}

/* How a kind of work is drawn. */
struct drawing {
    size_t shape; /* offset in struct gl_bench */
    enum paint paint;
    bool blended, culled, outside;
};

static const struct drawing drawings[CALIBRATION_COUNT] = {
    [CALIBRATION_fill_opaque] = {.shape = offsetof(struct gl_bench, picture)},
    [CALIBRATION_fill_blended] = {.shape = offsetof(struct gl_bench, picture), .blended = true},
    [CALIBRATION_fill_textured] = {.shape = offsetof(struct gl_bench, picture),
                                   .paint = PAINT_TEXTURED,
                                   .blended = true},
    [CALIBRATION_fill_tested] = {.shape = offsetof(struct gl_bench, picture),
                                 .paint = PAINT_TESTED},
    [CALIBRATION_triangles_culled] = {.shape = offsetof(struct gl_bench, shared), .culled = true},
    [CALIBRATION_triangles_shared] = {.shape = offsetof(struct gl_bench, shared)},
    [CALIBRATION_triangles_single] = {.shape = offsetof(struct gl_bench, single)},
    [CALIBRATION_quads_2px] = {.shape = offsetof(struct gl_bench, quads[0])},
    [CALIBRATION_quads_8px] = {.shape = offsetof(struct gl_bench, quads[1])},
    [CALIBRATION_quads_32px] = {.shape = offsetof(struct gl_bench, quads[2])},
    [CALIBRATION_vertices] = {.shape = offsetof(struct gl_bench, single), .outside = true},
    [CALIBRATION_calls_bare] = {.shape = offsetof(struct gl_bench, quads[0])},
    [CALIBRATION_calls_uniform] = {.shape = offsetof(struct gl_bench, quads[0])},
    [CALIBRATION_calls_texture] = {.shape = offsetof(struct gl_bench, quads[0]),
                                   .paint = PAINT_TEXTURED},
    [CALIBRATION_samples_bilinear] = {.shape = offsetof(struct gl_bench, picture),
                                      .paint = PAINT_SAMPLES},
    [CALIBRATION_lookups_shader] = {.shape = offsetof(struct gl_bench, picture),
                                    .paint = PAINT_LOOKUPS},
};

static const struct shape *shape_of(const struct gl_bench *bench, enum calibration_index index)
{
    return (const struct shape *)(const void *)((const char *)bench + drawings[index].shape);
}

/* Blending adds the colour to what is there, as premultiplied alpha does: one, one minus alpha. */
static void state_set(const struct gl_bench *bench, enum calibration_index index)
{
    const struct drawing *drawing = &drawings[index];
    const struct shape *shape = shape_of(bench, index);
    struct gl *gl = bench->gl;
    gl->BindFramebuffer(GL_FRAMEBUFFER, bench->target.framebuffer);
    gl->Viewport(0, 0, bench->target.width_px, bench->target.height_px);
    gl->Disable(GL_DEPTH_TEST);
    (drawing->blended ? gl->Enable : gl->Disable)(GL_BLEND);
    gl->BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    (drawing->culled ? gl->Enable : gl->Disable)(GL_CULL_FACE);
    gl->CullFace(GL_FRONT);
    gl->BindTextureUnit(0, bench->textures[0]);
    gl->BindTextureUnit(1, bench->words);
    gl->BindVertexArray(shape->vertex_array);
    gl->UseProgram(bench->paints[drawing->paint].program);
    gl->Uniform2f(bench->paints[drawing->paint].cell_px, shape->cell_px[0], shape->cell_px[1]);
    gl->Uniform1f(bench->paints[drawing->paint].depth, drawing->outside ? 2.0f : 0.0f);
    const float unit = drawing->paint == PAINT_FLAT ? 1.0f / 255 : 1;
    gl->Uniform4f(bench->paints[drawing->paint].color, unit, unit, unit,
                  drawing->paint == PAINT_FLAT ? 0 : 1);
}

static void shape_draw(struct gl *gl, const struct shape *shape)
{
    if (shape->indexed)
        gl_draw_elements(gl, shape->mode, shape->count, GL_UNSIGNED_INT, 0, shape->instances, 0, 0);
    else
        gl_draw_arrays(gl, shape->mode, 0, shape->count, shape->instances);
}

static void pass_shape(void *context, enum calibration_index index, int loops)
{
    struct gl_bench *bench = context;
    state_set(bench, index);
    for (int i = 0; i < loops; i++)
        shape_draw(bench->gl, shape_of(bench, index));
    bench->gl->Finish();
}

enum { CALLS_A_LOOP = 64 };

static void pass_calls(void *context, enum calibration_index index, int loops)
{
    struct gl_bench *bench = context;
    struct gl *gl = bench->gl;
    state_set(bench, index);
    for (int i = 0; i < loops * CALLS_A_LOOP; i++) {
        if (index == CALIBRATION_calls_uniform)
            gl->Uniform1f(bench->paints[PAINT_FLAT].depth, (float)(i % 2) * 0.5f);
        else if (index == CALIBRATION_calls_texture)
            gl->BindTextureUnit(0, bench->textures[i % 2]);
        gl_draw_arrays(gl, GL_TRIANGLES, 0, 3, 1);
    }
    gl->Finish();
}

/* One loop, counted by the driver where it can; else by what was asked for. */
static struct work work_count(struct gl_bench *bench, enum calibration_index index)
{
    enum calibration_kind kind = calibration_table[index].kind;
    struct work work = {kind == CALIBRATION_CALLS ? pass_calls : pass_shape, bench, 0, NAN};
    const struct shape *shape = shape_of(bench, index);
    struct gl *gl = bench->gl;
    work.pass(bench, index, 1); /* shaders are compiled */
    gl_counters_reset(gl);
    gl_statistics_begin(gl);
    work.pass(bench, index, 1);
    struct gl_statistics counted = gl_statistics_end(gl);
    double triangles = (double)gl->counters.triangles;
    if (!gl->has_pipeline_statistics) {
        double cells = (double)(shape->indexed || shape->count > 4 ? PATCH * PATCH : 1);
        counted.fragments = (uint64_t)((double)shape->instances * cells *
                                       (double)shape->cell_px[0] * (double)shape->cell_px[1]);
        counted.vertices = (uint64_t)shape->count * (uint64_t)shape->instances;
    }
    double fragments = drawings[index].culled ? 0 : (double)counted.fragments;
    work.count = kind == CALIBRATION_FILL       ? fragments
                 : kind == CALIBRATION_SAMPLES  ? fragments * SAMPLES
                 : kind == CALIBRATION_LOOKUPS  ? fragments * LOOKUPS
                 : kind == CALIBRATION_VERTICES ? (double)counted.vertices
                 : kind == CALIBRATION_CALLS    ? CALLS_A_LOOP
                                                : triangles;
    if (kind == CALIBRATION_FILL || kind == CALIBRATION_TRIANGLES)
        work.fragments_per_triangle = fragments / triangles;
    return work;
}

enum status gl_bench_create(struct arena *arena, const struct calibrate_request *request,
                            struct gl_bench **bench, struct work works[CALIBRATION_COUNT],
                            struct error *error)
{
    struct gl_bench *made = ARENA_NEW(arena, struct gl_bench);
    made->arena = arena;
    enum status status = gl_context_create(request->backend, request->threads, &made->gl, error);
    if (status)
        return status;
    *bench = made;
    status = gl_target(made->gl, request->width_px, request->height_px, request->format,
                       &made->target, error);
    if (!status)
        status = words_make(made, error);
    if (!status)
        status = paints_make(made, error);
    if (status)
        return status;
    const float nowhere[2] = {0, 0};
    made->picture = shape_make(made->gl, GL_TRIANGLE_STRIP, &strip[0][0], 4, NULL, 0, nowhere, 1);
    made->picture.cell_px[0] = (float)request->width_px;
    made->picture.cell_px[1] = (float)request->height_px;
    patches_make(made);
    const float sides_px[3] = {2, 8, 32};
    for (int i = 0; i < 3; i++)
        made->quads[i] = quads_make(made, sides_px[i]);
    textures_make(made);
    const float black[4] = {0, 0, 0, 0};
    made->gl->ClearNamedFramebufferfv(made->target.framebuffer, GL_COLOR, 0, black);
    for (size_t i = CALIBRATION_fill_opaque; i <= CALIBRATION_lookups_shader; i++)
        works[i] = work_count(made, (enum calibration_index)i);
    return gl_check(made->gl, "calibration", error);
}

void gl_bench_destroy(struct gl_bench *bench)
{
    if (bench)
        gl_context_destroy(bench->gl);
}
