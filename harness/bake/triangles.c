/* Triangles of trees: what is made ready once. */
#include "bake/triangles_parts.h"
#include "base/random.h"

#include "triangles.glsl.h"

enum { PROBES_MAX = 512, SPECIES_MAX = 64, MEANS_MAX = 8 };

static const char *const variant_defines[VARIANTS] = {"",
                                                      "LEAF 1",
                                                      "LEAF 1\nLIT_AT_VERTICES 1",
                                                      "TEXTURED 1",
                                                      "LEAF 1\nTEXTURED 1",
                                                      "PRUNED 1\nLIT_AT_VERTICES 1",
                                                      "SIFTED 1",
                                                      "SIFTED 1\nLEAF 1",
                                                      "SIFTED 1\nLIT_AT_VERTICES 1"};

float triangles_tolerance_px(float error_px, enum lod lod)
{
    static const float allowances[] = {
        [LOD_LOW] = 4, [LOD_INTERMEDIATE] = 2, [LOD_HIGH] = 0, [LOD_AUTO] = 1};
    return error_px * allowances[lod];
}

float triangles_taper(const struct triangles *triangles)
{
    return triangles->request.smooth ? 0.5f : 0;
}

int triangles_variant(const struct triangles *triangles, const struct plant_gl_batch *batch)
{
    if (batch->texture)
        return batch->thin ? VARIANT_LEAF_TEXTURED : VARIANT_BARK_TEXTURED;
    if (batch->thin)
        return batch->flat && !triangles->request.shadows ? VARIANT_LEAF_LIT : VARIANT_LEAF;
    return VARIANT_BARK;
}

static void keep_probes(struct arena *arena, struct kind *kind, const struct prune *prune)
{
    kind->probes_count = prune->count < PROBES_MAX ? (uint32_t)prune->count : PROBES_MAX;
    kind->probes = ARENA_ARRAY(arena, struct prune_vertex, kind->probes_count);
    for (uint32_t i = 0; i < kind->probes_count; i++)
        kind->probes[i] = prune->vertices[3 * i];
}

static enum status prepare_kind(struct workspace *workspace, struct triangles *triangles,
                                uint32_t species)
{
    struct kind *kind = &triangles->kinds[species];
    const struct mesh *mesh;
    enum status status =
        plant_mesh(triangles->scene->species[species].plant, &mesh, workspace->error);
    if (status != STATUS_OK)
        return status;
    struct arena *passing = arena_create(0);
    bool simplify = triangles->request.tolerance_px > 0;
    const struct detail *detail = detail_create(passing, mesh, simplify);
    const struct prune *prune = simplify ? prune_create(passing, mesh, workspace->seed) : NULL;
    levels_fill(&kind->levels, mesh, detail, prune, triangles_taper(triangles));
    if (prune)
        keep_probes(workspace->arena, kind, prune);
    if (triangles->sifted.sift) {
        kind->sift = sift_plant_create(workspace->arena, detail, prune, &kind->levels);
    } else {
        plant_gl_detail(workspace, detail, &kind->levels, triangles->placed_buffer, &kind->gpu);
        if (prune)
            plant_gl_pruned(workspace, prune, triangles->placed_buffer, &kind->gpu);
    }
    arena_destroy(passing);
    return STATUS_OK;
}

static enum status prepare_programs(struct workspace *workspace, struct triangles *triangles)
{
    bool wanted[VARIANTS] = {false};
    bool fog = workspace->effects & EFFECT_FOG && triangles->scene->fog.density_per_m > 0;
    for (size_t k = 0; k < triangles->kinds_count; k++) {
        for (size_t b = 0; b < triangles->kinds[k].gpu.batches_count; b++)
            wanted[triangles_variant(triangles, &triangles->kinds[k].gpu.batches[b])] = true;
        wanted[VARIANT_PRUNED] |= triangles->kinds[k].gpu.pruned > 0;
    }
    for (int v = VARIANT_SIFTED; v < VARIANTS; v++)
        wanted[v] = triangles->sifted.sift;
    for (int v = 0; v < VARIANTS; v++) {
        if (!wanted[v])
            continue;
        const char *defines =
            arena_printf(workspace->arena, "MEANS %d\n%s%s", triangles->means_count,
                         fog ? "FOG 1\n" : "", variant_defines[v]);
        const struct shadow_map *shadows = triangles->request.shadows;
        GLuint *program = &triangles->programs[v];
        enum status status = shadow_receiver_program(workspace, shadows, "triangles",
                                                     triangles_glsl, defines, program);
        if (status != STATUS_OK)
            return status;
    }
    return STATUS_OK;
}

/* What each tree keeps, and room for the lists of a frame. */
static void prepare_instances(struct workspace *workspace, struct triangles *triangles)
{
    struct arena *arena = workspace->arena;
    size_t room = triangles->request.trees_room, count = triangles->scene->instances_count;
    size_t calls_room = 0, runs_room = 1;
    triangles->bounds = ARENA_ARRAY(arena, struct cull_bound, triangles->kinds_count);
    for (size_t k = 0; k < triangles->kinds_count; k++) {
        struct kind *kind = &triangles->kinds[k];
        triangles->bounds[k] = kind->levels.bound;
        kind->first_group = (uint32_t)triangles->groups_count;
        kind->groups_count = plant_groups_count(&kind->levels);
        triangles->groups_count += kind->groups_count;
        calls_room += kind->gpu.batches_count + 1;
        triangles->commands_room += kind->groups_count * (kind->gpu.batches_count + 1);
        if (kind->sift && runs_room < kind->sift->batches_count + 1)
            runs_room = kind->sift->batches_count + 1;
    }
    if (triangles->request.tolerance_px > 0)
        triangles->runs = ARENA_ARRAY(arena, uint8_t, count);
    for (size_t i = 0; triangles->runs && i < count; i++)
        triangles->runs[i] = (uint8_t)(random_mix(workspace->seed + i) % LEVELS_RUNS);
    if (triangles->sifted.sift) {
        triangles->sift_trees = ARENA_ARRAY(arena, struct sift_tree, room);
        triangles->sift_runs = ARENA_ARRAY(arena, struct sift_run, room * runs_room);
        return;
    }
    triangles->groups = ARENA_ARRAY(arena, uint32_t, room);
    triangles->first = ARENA_ARRAY(arena, uint32_t, triangles->groups_count + 1);
    triangles->calls = ARENA_ARRAY(arena, struct call, calls_room);
    triangles->commands = ARENA_ARRAY(arena, struct plant_command, triangles->commands_room);
    triangles->command_buffer = gl_buffer(
        workspace->gl, (GLsizeiptr)(triangles->commands_room * sizeof(struct plant_command)), NULL,
        GL_DYNAMIC_STORAGE_BIT);
}

/* Steps of stretch that a mean radiance is computed for, a species. Sifted, all species share one
 * list of them; else each call has its own. */
static void plan_means(struct triangles *triangles)
{
    const struct scene *scene = triangles->scene;
    bool share = triangles->sifted.sift;
    for (size_t i = 0; i < scene->instances_count; i++) {
        const struct instance *tree = &scene->instances[i];
        struct kind *kind = &triangles->kinds[tree->species];
        bool first = !(kind->stretch[0] > 0);
        kind->stretch[0] = first ? tree->stretch : fminf(kind->stretch[0], tree->stretch);
        kind->stretch[1] = fmaxf(kind->stretch[1], tree->stretch);
    }
    for (size_t k = 0; k < triangles->kinds_count; k++) {
        struct kind *kind = &triangles->kinds[k];
        int room = share ? SPECIES_MAX / (int)triangles->kinds_count : MEANS_MAX;
        kind->means_count = kind->stretch[1] <= kind->stretch[0] ? 1
                            : room < MEANS_MAX                   ? room
                                                                 : MEANS_MAX;
        kind->first_mean = share ? triangles->means_count : 0;
        triangles->means_count = share ? triangles->means_count + kind->means_count : MEANS_MAX;
    }
    if (triangles->means_count < 1)
        triangles->means_count = 1;
}

int triangles_mean_of(const struct kind *kind, float stretch)
{
    if (kind->means_count < 2)
        return 2 * kind->first_mean;
    float along = logf(stretch / kind->stretch[0]) / logf(kind->stretch[1] / kind->stretch[0]);
    return 2 * (kind->first_mean + (int)lrintf(along * (float)(kind->means_count - 1)));
}

float triangles_mean_stretch(const struct kind *kind, int step)
{
    if (kind->means_count < 2)
        return kind->stretch[0];
    return kind->stretch[0] *
           powf(kind->stretch[1] / kind->stretch[0], (float)step / (float)(kind->means_count - 1));
}

/* Sifts where that pays and is possible. */
static enum status prepare_sift(struct workspace *workspace, struct triangles *triangles)
{
    bool use = triangles->request.sift && !triangles->request.shadows && workspace->gl->software &&
               triangles->kinds_count <= SPECIES_MAX;
    for (size_t k = 0; k < triangles->kinds_count && use; k++) {
        const struct mesh *mesh;
        enum status status = STATUS_OK;
        if (triangles->kinds[k].drawn)
            status = plant_mesh(triangles->scene->species[k].plant, &mesh, workspace->error);
        if (status != STATUS_OK)
            return status;
        use = !triangles->kinds[k].drawn || sift_plant_possible(mesh);
    }
    if (!use)
        return STATUS_OK;
    sift_gl_create(workspace, &triangles->sifted);
    return STATUS_OK;
}

enum status triangles_prepare(struct workspace *workspace, const struct scene *scene,
                              const struct triangles_request *request, struct triangles **result)
{
    struct triangles *triangles = *result = ARENA_NEW(workspace->arena, struct triangles);
    triangles->scene = scene;
    triangles->request = *request;
    triangles->kinds_count = scene->species_count;
    triangles->kinds = ARENA_ARRAY(workspace->arena, struct kind, scene->species_count);
    for (size_t i = 0; i < scene->instances_count; i++)
        triangles->kinds[scene->instances[i].species].drawn = true;
    enum status status = prepare_sift(workspace, triangles);
    plan_means(triangles);
    if (!triangles->sifted.sift)
        triangles->placed_buffer = gl_buffer(
            workspace->gl, (GLsizeiptr)(request->trees_room * sizeof(struct plant_gl_placed)), NULL,
            GL_MAP_WRITE_BIT);
    for (uint32_t k = 0; k < triangles->kinds_count && status == STATUS_OK; k++)
        if (triangles->kinds[k].drawn)
            status = prepare_kind(workspace, triangles, k);
    if (status == STATUS_OK)
        status = prepare_programs(workspace, triangles);
    if (status != STATUS_OK)
        return status;
    prepare_instances(workspace, triangles);
    return gl_check(workspace->gl, "triangles", workspace->error);
}

const struct cull_bound *triangles_bounds(const struct triangles *triangles)
{
    return triangles->bounds;
}

enum cull_order triangles_order(const struct triangles *triangles)
{
    /* groups go from near to far by themselves; within a detail level the order saves shading */
    bool grouped = !triangles->sifted.sift && triangles->request.tolerance_px > 0;
    return grouped ? CULL_AS_PLACED : CULL_FRONT_TO_BACK;
}
