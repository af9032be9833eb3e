/* Pictures of trees as casters of shadow maps. */
#include "bake/shadow_billboards.h"
#include "bake/impostor.h"

#include "shadow_billboards.glsl.h"

/* Pictures a species, 22 degrees apart above the horizon, and texels along a plant. */
enum { SIDE = 7, RESOLUTION_PX = 128, SAMPLES = 4 };

struct shadow_billboards {
    const struct scene *scene;
    struct atlas *atlas;
    uint32_t *order;    /* of a pass: those that may cast */
    GLuint programs[2]; /* depths, coverage */
    GLuint vertices, trees_buffer, order_buffer;
    GLuint stretches_buffer; /* 0: no tree is stretched */
};

static enum status prepare_programs(struct workspace *workspace,
                                    const struct shadow_options *options,
                                    struct shadow_billboards *billboards)
{
    struct arena *scratch = arena_create(0);
    enum status status = STATUS_OK;
    const char *source = impostor_source(scratch, shadow_billboards_glsl);
    const char *defines = arena_printf(scratch, "CAST 1\nVIEWS 1\nLAYOUT %d\n%s", VIEWS_HEMISPHERE,
                                       billboards->stretches_buffer ? "STRETCHED 1\n" : "");
    const int kinds = shadow_layers(options) > 0 ? 2 : 1;
    for (int covers = 0; covers < kinds && status == STATUS_OK; covers++)
        status = shadow_cast_program(workspace, options, covers, source, defines,
                                     &billboards->programs[covers]);
    arena_destroy(scratch);
    return status;
}

enum status shadow_billboards_prepare(struct workspace *workspace, const struct scene *scene,
                                      const struct shadow_options *options,
                                      struct shadow_billboards **result)
{
    struct gl *gl = workspace->gl;
    struct shadow_billboards *billboards = *result =
        ARENA_NEW(workspace->arena, struct shadow_billboards);
    const struct atlas_request request = {.layout = VIEWS_HEMISPHERE,
                                          .side = SIDE,
                                          .resolution_px = RESOLUTION_PX,
                                          .samples = SAMPLES,
                                          .alpha = ATLAS_TEST,
                                          .depth = true};
    billboards->scene = scene;
    if (scene_is_stretched(scene))
        billboards->stretches_buffer = impostor_stretches(gl, scene);
    enum status status = atlas_build(workspace, scene, &request, &billboards->atlas);
    if (status == STATUS_OK)
        status = prepare_programs(workspace, options, billboards);
    if (status != STATUS_OK)
        return status;
    billboards->order = ARENA_ARRAY(workspace->arena, uint32_t, scene->instances_count + 1);
    billboards->trees_buffer = impostor_trees(gl, scene);
    billboards->order_buffer =
        gl_buffer(gl, (GLsizeiptr)((scene->instances_count + 1) * sizeof *billboards->order), NULL,
                  GL_DYNAMIC_STORAGE_BIT);
    billboards->vertices = gl_vertex_array(gl);
    return gl_check(gl, "shadow billboards", workspace->error);
}

bool shadow_billboards_suit(const struct shadow_billboards *billboards,
                            const struct shadow_pass *pass, const struct instance *tree)
{
    double texel_m = fmax(pass->fit->texel_m[0], pass->fit->texel_m[1]);
    float picture_m = billboards->atlas->species[tree->species].texel_m * instance_reach(tree);
    return (double)picture_m <= texel_m;
}

/* Lists the trees that suit and whose spheres reach into the map. */
static size_t list_casters(const struct shadow_billboards *billboards,
                           const struct shadow_pass *pass)
{
    const struct scene *scene = billboards->scene;
    size_t count = 0;
    for (size_t i = 0; i < scene->instances_count; i++) {
        const struct instance *tree = &scene->instances[i];
        const struct atlas_species *species = &billboards->atlas->species[tree->species];
        double center_m[3] = {
            (double)tree->position_m[0],
            (double)(tree->position_m[1] + species->center_y_m * tree->scale * tree->stretch),
            (double)tree->position_m[2]};
        if (shadow_billboards_suit(billboards, pass, tree) &&
            shadow_fit_meets(pass->fit, center_m,
                             (double)(species->radius_m * instance_reach(tree))))
            billboards->order[count++] = (uint32_t)i;
    }
    return count;
}

void shadow_billboards_cast(struct workspace *workspace, const struct shadow_billboards *billboards,
                            const struct shadow_pass *pass)
{
    struct gl *gl = workspace->gl;
    const struct atlas *atlas = billboards->atlas;
    /* of impostor.glsl's bindings; what casts has no light */
    const GLuint buffers[6] = {billboards->trees_buffer,
                               billboards->order_buffer,
                               atlas->views_buffer,
                               atlas->species_buffer,
                               0,
                               billboards->stretches_buffer};
    GLuint program = billboards->programs[pass->covers];
    size_t count = list_casters(billboards, pass);
    if (count == 0)
        return;
    gl->NamedBufferSubData(billboards->order_buffer, 0,
                           (GLsizeiptr)(count * sizeof *billboards->order), billboards->order);
    shadow_pass_use(workspace, pass, program);
    gl->BindVertexArray(billboards->vertices);
    for (GLuint i = 0; i < 6; i++)
        gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, i, buffers[i]);
    gl->BindTextureUnit(0, atlas->albedo);
    gl->BindTextureUnit(2, atlas->depth);
    gl->Uniform3fv(gl_uniform(gl, program, "sun_direction"), 1, pass->sun);
    gl->Uniform1i(gl_uniform(gl, program, "side"), SIDE);
    gl->Uniform2f(gl_uniform(gl, program, "layer_px"), (float)atlas->width_px,
                  (float)atlas->height_px);
    gl->Uniform1f(gl_uniform(gl, program, "texel_m"),
                  (float)fmax(pass->fit->texel_m[0], pass->fit->texel_m[1]));
    gl->Uniform1i(gl_uniform(gl, program, "last_level"), atlas->levels - 1);
    gl_draw_arrays(gl, GL_TRIANGLES, 0, (GLsizei)(6 * count), 1);
    for (GLuint i = 0; i < 6; i++)
        gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, i, 0);
}
