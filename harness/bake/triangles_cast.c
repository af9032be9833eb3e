/* Triangles of trees as casters of shadow maps. */
#include "bake/shadow_billboards.h"
#include "bake/shadow_map.h"
#include "bake/triangles_parts.h"

#include <string.h>

/* Whether a tree's sphere reaches into the map, and no picture of it casts in its place. */
static bool casts(const struct triangles *triangles, const struct shadow_pass *pass,
                  const struct instance *tree)
{
    if (pass->billboards && shadow_billboards_suit(pass->billboards, pass, tree))
        return false;
    const struct cull_bound *bound = &triangles->bounds[tree->species];
    double center_m[3] = {
        (double)tree->position_m[0],
        (double)(tree->position_m[1] + bound->center_y_m * tree->scale * tree->stretch),
        (double)tree->position_m[2]};
    return shadow_fit_meets(pass->fit, center_m, (double)(bound->radius_m * instance_reach(tree)));
}

/* Counts the casters of each group, then lays them out one group behind the other. */
static void place_casters(struct workspace *workspace, struct triangles *triangles,
                          const struct shadow_pass *pass)
{
    const struct scene *scene = triangles->scene;
    struct gl *gl = workspace->gl;
    uint32_t *first = triangles->first;
    memset(first, 0, (triangles->groups_count + 1) * sizeof *first);
    for (size_t i = 0; i < scene->instances_count; i++) {
        const struct instance *tree = &scene->instances[i];
        const struct kind *kind = &triangles->kinds[tree->species];
        struct levels_choice choice = {0, -1};
        triangles->groups[i] = UINT32_MAX;
        if (!casts(triangles, pass, tree))
            continue;
        if (pass->per_m > 0 && triangles->runs)
            choice = levels_choose(&kind->levels, pass->per_m * instance_reach(tree));
        triangles->groups[i] =
            kind->first_group +
            plant_group(&kind->levels, &choice, triangles->runs ? triangles->runs[i] : 0);
        first[triangles->groups[i] + 1]++;
    }
    for (size_t g = 0; g < triangles->groups_count; g++)
        first[g + 1] += first[g];
    struct plant_gl_placed *placed = gl->MapNamedBufferRange(
        triangles->placed_buffer, 0,
        (GLsizeiptr)(scene->instances_count * sizeof(struct plant_gl_placed)),
        GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT);
    for (size_t i = 0; i < scene->instances_count; i++) {
        uint32_t group = triangles->groups[i];
        if (group == UINT32_MAX)
            continue;
        const struct instance *tree = &scene->instances[i];
        const struct kind *kind = &triangles->kinds[tree->species];
        const struct levels_seen seen = {.per_m = pass->per_m * instance_reach(tree), .rise = 0.5f};
        placed[first[group]++] =
            plant_place(&kind->levels, group - kind->first_group, tree, &seen, 0);
    }
    gl->UnmapNamedBuffer(triangles->placed_buffer);
    memmove(first + 1, first, triangles->groups_count * sizeof *first);
    first[0] = 0;
}

static void cast_batch(struct workspace *workspace, struct triangles *triangles,
                       const struct kind *kind, const struct plant_gl_batch *batch,
                       const struct shadow_pass *pass)
{
    struct gl *gl = workspace->gl;
    uint64_t count = 0;
    size_t commands = plant_commands(&kind->levels, batch, triangles->first + kind->first_group,
                                     triangles->commands, &count);
    if (commands == 0)
        return;
    int which = !batch           ? SHADOW_CAST_PRUNED
                : batch->texture ? SHADOW_CAST_TEXTURED
                                 : SHADOW_CAST_PLAIN;
    shadow_pass_use(workspace, pass, pass->programs[which]);
    gl->Uniform1f(gl_uniform(gl, pass->programs[which], "elements"), (float)kind->levels.elements);
    if (batch && batch->texture)
        gl->BindTextureUnit(0, batch->texture);
    gl->BindVertexArray(batch ? kind->gpu.detail : kind->gpu.pruned);
    gl->NamedBufferSubData(triangles->command_buffer, 0,
                           (GLsizeiptr)(commands * sizeof *triangles->commands),
                           triangles->commands);
    gl_multi_draw_elements_indirect(gl, GL_TRIANGLES, GL_UNSIGNED_INT, 0, (GLsizei)commands, count);
}

void triangles_cast(struct workspace *workspace, struct triangles *triangles,
                    const struct shadow_pass *pass)
{
    struct gl *gl = workspace->gl;
    if (triangles->scene->instances_count == 0)
        return;
    place_casters(workspace, triangles, pass);
    gl->BindBuffer(GL_DRAW_INDIRECT_BUFFER, triangles->command_buffer);
    for (size_t k = 0; k < triangles->kinds_count; k++) {
        const struct kind *kind = &triangles->kinds[k];
        for (size_t b = 0; b < kind->gpu.batches_count; b++)
            cast_batch(workspace, triangles, kind, &kind->gpu.batches[b], pass);
        if (kind->levels.elements > 0 && kind->gpu.pruned)
            cast_batch(workspace, triangles, kind, NULL, pass);
    }
    gl->BindBuffer(GL_DRAW_INDIRECT_BUFFER, 0);
}
