/* Impostors: trees and order on the GL, programs. */
#include "bake/impostor.h"

#include "bake/impostor_tall.h"

#include "impostor.glsl.h"

#include <string.h>

/* As impostor.glsl reads it. */
struct tree {
    float position_m[3], scale;
    float cos, sin, species, sun_step;
};

/* Most trees that are drawn with the polygon of ATLAS_HULL corners at a time. */
enum { HULLS_MOST = 65536 };

/* The nearest of the rotations that light is computed for. */
static float sun_step(float rotation_rad)
{
    double turns = rotation_rad / (2 * M_PI), share = turns - floor(turns);
    return (float)(lround(share * IMPOSTOR_SUN_STEPS) % IMPOSTOR_SUN_STEPS);
}

GLuint impostor_trees(struct gl *gl, const struct scene *scene)
{
    struct arena *scratch = arena_create(0);
    struct tree *trees = ARENA_ARRAY(scratch, struct tree, scene->instances_count + 1);
    for (size_t i = 0; i < scene->instances_count; i++) {
        const struct instance *instance = &scene->instances[i];
        trees[i] = (struct tree){.position_m = {instance->position_m[0], instance->position_m[1],
                                                instance->position_m[2]},
                                 .scale = instance->scale,
                                 .cos = cosf(instance->rotation_rad),
                                 .sin = sinf(instance->rotation_rad),
                                 .species = (float)instance->species,
                                 .sun_step = sun_step(instance->rotation_rad)};
    }
    GLuint buffer =
        gl_buffer(gl, (GLsizeiptr)((scene->instances_count + 1) * sizeof *trees), trees, 0);
    arena_destroy(scratch);
    return buffer;
}

GLuint impostor_stretches(struct gl *gl, const struct scene *scene)
{
    struct arena *scratch = arena_create(0);
    float *stretches = ARENA_ARRAY(scratch, float, scene->instances_count + 1);
    for (size_t i = 0; i < scene->instances_count; i++)
        stretches[i] = scene->instances[i].stretch;
    GLuint buffer =
        gl_buffer(gl, (GLsizeiptr)((scene->instances_count + 1) * sizeof *stretches), stretches, 0);
    arena_destroy(scratch);
    return buffer;
}

/* Triangles of fans: first the quads, then the hulls. Both number their corners from 0. */
static GLuint upload_indices(struct gl *gl, size_t quads, size_t hulls)
{
    enum { HULL_INDICES = 3 * (ATLAS_HULL - 2) };
    struct arena *scratch = arena_create(0);
    size_t count = 6 * quads + HULL_INDICES * hulls;
    uint32_t *indices = ARENA_ARRAY(scratch, uint32_t, count + 1), *at = indices;
    for (size_t i = 0; i < quads + hulls; i++) {
        uint32_t corners = i < quads ? 4 : ATLAS_HULL;
        uint32_t first = corners * (uint32_t)(i < quads ? i : i - quads);
        for (uint32_t k = 1; k + 1 < corners; k++) {
            *at++ = first;
            *at++ = first + k;
            *at++ = first + k + 1;
        }
    }
    GLuint buffer = gl_buffer(gl, (GLsizeiptr)((count + 1) * sizeof *indices), indices, 0);
    arena_destroy(scratch);
    return buffer;
}

/* Mean silhouette of the trees over all pictures, in the world's size. */
static float mean_area(const struct scene *scene, const struct atlas *atlas)
{
    double sum = 0;
    for (size_t i = 0; i < scene->instances_count; i++) {
        const struct instance *instance = &scene->instances[i];
        const struct atlas_species *species = &atlas->species[instance->species];
        const struct atlas_view *view = &atlas->views[(size_t)species->first_view];
        sum += (double)instance->scale * instance->scale * (view->high[0] - view->low[0]) *
               (view->high[1] - view->low[1]);
    }
    return scene->instances_count ? (float)(sum / (double)scene->instances_count) : 0;
}

/* What a pixel shows of a picture is known to a texel, in depth to a step of 8 bits: volumes begin
 * so far behind what casts. */
static enum status prepare_shadows(struct workspace *workspace, const struct scene *scene,
                                   const struct impostor_request *request,
                                   struct impostor *impostor)
{
    struct sun_shadows_request sun = shadow_choice_request(&request->sun);
    if (!request->sun.shadow || !(workspace->effects & EFFECT_SUN_SHADOWS))
        return STATUS_OK;
    if (sun.technique >= SHADOW_BY_VOLUME && request->atlas.alpha == ATLAS_BLEND)
        return error_set(
            workspace->error, STATUS_UNSUPPORTED,
            "shadow=%s: with alpha=blend a pixel has many depths, volumes tell of one; "
            "allowed: alpha=test or coverage, or shadow=none or map",
            sun.technique == SHADOW_BY_VOLUME ? "volume" : "hybrid");
    sun.own = true;
    sun.volume.behind_px = 1;
    sun.volume.behind_radii = 2 / (float)request->atlas.resolution_px + 2.0f / 255;
    return sun_shadows_prepare(workspace, scene, &sun, impostor->backdrop, &impostor->shadows);
}

enum status impostor_prepare(struct workspace *workspace, const struct scene *scene,
                             const struct impostor_request *request, struct impostor **result)
{
    struct gl *gl = workspace->gl;
    struct impostor *impostor = *result = ARENA_NEW(workspace->arena, struct impostor);
    impostor->scene = scene;
    impostor->alpha = request->atlas.alpha;
    impostor->nearest = request->atlas.nearest;
    enum status status = backdrop_prepare(workspace, scene, &impostor->backdrop);
    if (status == STATUS_OK)
        status = prepare_shadows(workspace, scene, request, impostor);
    struct atlas_request atlas = request->atlas;
    atlas.depth |= impostor->shadows != NULL;
    impostor->deep = request->atlas.depth || sun_shadows_count(impostor->shadows);
    impostor->texels = (uint64_t)(request->mixed ? request->mixed : 1) * (atlas.depth ? 3 : 2) +
                       sun_shadows_samples(impostor->shadows);
    if (status == STATUS_OK)
        status = impostor_tall(workspace, scene, &impostor->tall);
    const struct scene *tall = impostor->tall;
    if (status == STATUS_OK)
        status = atlas_build(workspace, tall, &atlas, &impostor->atlas);
    if (status == STATUS_OK)
        status = nearby_prepare(workspace, scene, request->near_radii, 0,
                                sun_shadows_map(impostor->shadows), &impostor->nearby);
    if (status != STATUS_OK)
        return status;
    struct cull_bound *bounds =
        ARENA_ARRAY(workspace->arena, struct cull_bound, tall->species_count + 1);
    for (size_t i = 0; i < tall->species_count; i++) {
        bounds[i].center_y_m = impostor->atlas->species[i].center_y_m;
        bounds[i].radius_m = impostor->atlas->species[i].radius_m;
    }
    size_t count = scene->instances_count;
    impostor->cull = cull_create(workspace->arena, tall, bounds);
    impostor->area_m2 = mean_area(tall, impostor->atlas);
    impostor->fans_quad = count * request->quads_each;
    impostor->fans_hull = impostor->fans_quad < HULLS_MOST ? impostor->fans_quad : HULLS_MOST;
    impostor->instances_buffer = impostor_trees(gl, tall);
    if (tall != scene)
        impostor->stretches_buffer = impostor_stretches(gl, tall);
    impostor->order_buffer =
        gl_buffer(gl, (GLsizeiptr)((count + 1) * sizeof(uint32_t)), NULL, GL_DYNAMIC_STORAGE_BIT);
    size_t lights = (size_t)impostor->atlas->layers * IMPOSTOR_SUN_STEPS;
    impostor->sunlights_buffer =
        gl_buffer(gl, (GLsizeiptr)((lights + 1) * sizeof(struct impostor_sunlight)), NULL,
                  GL_DYNAMIC_STORAGE_BIT);
    impostor->vertices = gl_vertex_array(gl);
    gl->VertexArrayElementBuffer(impostor->vertices,
                                 upload_indices(gl, impostor->fans_quad, impostor->fans_hull));
    return gl_check(gl, "impostors", workspace->error);
}

/* The three parts of a source: before the stages, the vertex and the fragment stage; "" where
 * absent. */
static void split_stages(struct arena *arena, const char *source, const char *parts[3])
{
    static const char *const marks[2] = {"#pragma stage vertex", "#pragma stage fragment"};
    const char *vertex = strstr(source, marks[0]), *fragment = strstr(source, marks[1]);
    const char *end = source + strlen(source);
    fragment = fragment ? fragment : end;
    vertex = vertex ? vertex : fragment;
    parts[0] = arena_printf(arena, "%.*s", (int)(vertex - source), source);
    size_t skip = vertex < fragment ? strlen(marks[0]) : 0;
    parts[1] =
        arena_printf(arena, "%.*s", (int)(fragment - vertex - (ptrdiff_t)skip), vertex + skip);
    parts[2] = fragment < end ? fragment + strlen(marks[1]) : "";
}

const char *impostor_source(struct arena *arena, const char *source)
{
    const char *shared[3], *own[3];
    split_stages(arena, impostor_glsl, shared);
    split_stages(arena, source, own);
    return arena_printf(arena, "%s%s\n#pragma stage vertex\n%s%s\n#pragma stage fragment\n%s%s",
                        shared[0], own[0], shared[1], own[1], shared[2], own[2]);
}

enum status impostor_program(struct workspace *workspace, const struct impostor *impostor,
                             const char *name, const char *source, const char *defines,
                             GLuint *program)
{
    struct arena *scratch = arena_create(0);
    const struct shadow_map *shadows = sun_shadows_map(impostor->shadows);
    const char *text = impostor_source(scratch, source);
    static const char *const modes[] = {"", "STRAIGHT 1\nALPHA_TEST 1\n",
                                        "STRAIGHT 1\nALPHA_COVERAGE 1\n"};
    const char *all = arena_printf(
        scratch, "SUN_STEPS %d\nNEAREST %d\n%s%s%s%s%s%s", IMPOSTOR_SUN_STEPS, impostor->nearest,
        impostor->stretches_buffer ? "STRETCHED 1\n" : "", defines ? defines : "",
        modes[impostor->alpha], impostor->deep ? "DEPTH 1\n" : "",
        impostor->atlas->depth ? "PICTURE_DEPTH 1\n" : "",
        workspace->effects & EFFECT_FOG ? "FOG 1\n" : "");
    enum status status = shadow_receiver_program(workspace, shadows, name, text, all, program);
    arena_destroy(scratch);
    return status;
}
