/* skeleton: one double cone a tree, as wide and as high as its plant and of its mean colour. */
#include "bake/backdrop.h"
#include "method/method.h"

#include "skeleton.glsl.h"

/* One field an option; its row gives default, range, unit and meaning. */
struct options {
    int sides;
};

/* clang-format off */
static const struct option table[] = {
    OPTION(struct options, sides, 24, 3, 256, "", "sides of a double cone at full detail"),
    OPTION_END,
};
/* clang-format on */

/* A species: the size of its double cone at scale and stretch 1, its colour, and where its trees
 * begin in the buffer.
 */
struct kind {
    float radius_m, height_m, albedo[3];
    size_t first, count;
};

/* What prepare leaves for draw; in the workspace's arena, so nothing is freed. */
struct state {
    const struct scene *scene;
    struct backdrop *backdrop;
    struct kind *kinds; /* scene->species_count */
    GLuint program, feet, cones;
    int sides;
};

/* Mean albedo of a plant's triangles. */
static void mean_albedo(const struct mesh *mesh, float albedo[3])
{
    static const float white[3] = {1, 1, 1};
    for (size_t p = 0; p < mesh->parts_count; p++) {
        const struct mesh_part *part = &mesh->parts[p];
        const float *material = mesh->materials[part->material].albedo;
        for (uint32_t t = 0; t < part->triangles_count; t++) {
            const uint32_t corner = mesh->triangles[part->first_triangle + t][0];
            const float *color = mesh->colors ? mesh->colors[corner] : white;
            for (int i = 0; i < 3; i++)
                albedo[i] += material[i] * color[i] / (float)mesh->triangles_count;
        }
    }
}

/* The trees' feet, their scales of width and of height, species by species, into one buffer. */
static void upload_trees(struct workspace *workspace, struct state *state)
{
    const struct scene *scene = state->scene;
    struct gl *gl = workspace->gl;
    float(*feet)[5] = arena_alloc(workspace->arena, scene->instances_count, sizeof *feet);
    size_t filled = 0;
    for (size_t k = 0; k < scene->species_count; k++) {
        state->kinds[k].first = filled;
        for (size_t i = 0; i < scene->instances_count; i++) {
            const struct instance *tree = &scene->instances[i];
            if (tree->species != k)
                continue;
            for (int axis = 0; axis < 3; axis++)
                feet[filled][axis] = tree->position_m[axis];
            feet[filled][3] = tree->scale;
            feet[filled++][4] = tree->scale * tree->stretch;
        }
        state->kinds[k].count = filled - state->kinds[k].first;
    }
    state->feet = gl_buffer(gl, (GLsizeiptr)(filled * sizeof *feet), feet, 0);
    state->cones = gl_vertex_array(gl);
    for (GLuint k = 0; k < 2; k++) { /* 0: a foot, 1: its scales, from 12 bytes on */
        gl->VertexArrayAttribFormat(state->cones, k, k ? 2 : 3, GL_FLOAT, GL_FALSE, 12 * k);
        gl->VertexArrayAttribBinding(state->cones, k, 0);
        gl->EnableVertexArrayAttrib(state->cones, k);
    }
    gl->VertexArrayBindingDivisor(state->cones, 0, 1);
}

/* lod=low is cheap, high is the method's best, auto is its own choice. */
static int sides_of(const struct options *options, enum lod lod)
{
    int divisor = lod == LOD_LOW ? 4 : lod == LOD_INTERMEDIATE ? 2 : 1;
    return options->sides / divisor < 3 ? 3 : options->sides / divisor;
}

/* Everything that does not depend on the view: baking, uploads, shaders. Timed as build_seconds. */
static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *values, void **result)
{
    const struct options *options = values;
    struct state *state = *result = ARENA_NEW(workspace->arena, struct state);
    state->scene = scene;
    state->kinds = ARENA_ARRAY(workspace->arena, struct kind, scene->species_count);
    state->sides = sides_of(options, workspace->lod);
    enum status status = backdrop_prepare(workspace, scene, &state->backdrop);
    for (size_t k = 0; k < scene->species_count && status == STATUS_OK; k++) {
        const struct mesh *mesh;
        status = plant_mesh(scene->species[k].plant, &mesh, workspace->error);
        if (status != STATUS_OK)
            break;
        state->kinds[k].radius_m = mesh->radius_m;
        state->kinds[k].height_m = mesh->maximum_m[1];
        mean_albedo(mesh, state->kinds[k].albedo);
    }
    if (status == STATUS_OK)
        status = gl_program(workspace->gl, "skeleton", skeleton_glsl,
                            arena_printf(workspace->arena, "SIDES %d\n", state->sides),
                            &state->program, workspace->error);
    if (status != STATUS_OK)
        return status;
    upload_trees(workspace, state);
    return gl_check(workspace->gl, "skeleton", workspace->error);
}

/* One picture. The harness finishes the GPU's work and stops the clock. */
static enum status draw(struct workspace *workspace, void *own, const struct view *view,
                        struct target *target)
{
    const struct state *state = own;
    struct gl *gl = workspace->gl;
    gl->BindFramebuffer(GL_FRAMEBUFFER, target->framebuffer);
    backdrop_draw(workspace, state->backdrop, view);
    gl->UseProgram(state->program);
    shade_uniforms(workspace, state->program, state->scene, view);
    gl->BindVertexArray(state->cones);
    for (size_t k = 0; k < state->scene->species_count; k++) {
        const struct kind *kind = &state->kinds[k];
        gl->Uniform2f(gl_uniform(gl, state->program, "size_m"), kind->radius_m, kind->height_m);
        gl->Uniform3fv(gl_uniform(gl, state->program, "albedo"), 1, kind->albedo);
        gl->VertexArrayVertexBuffer(state->cones, 0, state->feet,
                                    (GLintptr)(kind->first * sizeof(float[5])), sizeof(float[5]));
        gl_draw_arrays(gl, GL_TRIANGLES, 0, 6 * state->sides, (GLsizei)kind->count);
    }
    return gl_check(gl, "skeleton", workspace->error);
}

extern const struct method skeleton_method;
const struct method skeleton_method = {
    .abi = METHOD_ABI,
    .name = "skeleton",
    .summary = "one double cone a tree, of its plant's size and mean colour",
    .source = "this project",
    .traits = EFFECT_TWO_SIDED | EFFECT_AMBIENT | EFFECT_FOG,
    .options = table,
    .options_size = sizeof(struct options),
    .prepare = prepare,
    .draw = draw,
};
