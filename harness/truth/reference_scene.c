/* The reference's scene: plants, terrain and instances as Embree has them, and how their parts are
 * shaded. */
#include "plant/conifer.h"
#include "plant/texture.h"
#include "truth/reference_parts.h"

#include <math.h>
#include <string.h>

static bool surface_opaque(const void *data, uint32_t primitive, float u, float v)
{
    const struct surface *surface = data;
    float uv[2], rgba[4];
    mesh_uv(surface->mesh, surface->first_triangle + primitive, u, v, uv);
    texture_sample(surface->texture, uv, rgba);
    return rgba[3] >= 0.5f;
}

static bool texture_has_holes(const struct texture *texture)
{
    size_t texels = (size_t)texture->width_px * (size_t)texture->height_px;
    for (size_t i = 0; i < texels; i++)
        if (texture->rgba[4 * i + 3] < 0.5f)
            return true;
    return false;
}

/* Are the vertices' normals those of the triangles, on their outer side? Then shading needs no
 * look-up. */
static bool part_is_flat(const struct mesh *mesh, const struct mesh_part *part)
{
    for (uint32_t t = part->first_triangle; t < part->first_triangle + part->triangles_count; t++) {
        const uint32_t *corner = mesh->triangles[t];
        vec3 first, second, normal;
        glm_vec3_sub(mesh->positions[corner[1]], mesh->positions[corner[0]], first);
        glm_vec3_sub(mesh->positions[corner[2]], mesh->positions[corner[0]], second);
        glm_vec3_cross(first, second, normal);
        float length = glm_vec3_norm(normal);
        for (int k = 0; k < 3; k++)
            if (glm_vec3_dot(normal, mesh->normals[corner[k]]) < 0.99999f * length)
                return false;
    }
    return true;
}

/* One albedo a triangle where its three corners have one colour; NULL where a colour changes
 * inside. */
static float (*part_tints(struct arena *arena, const struct mesh *mesh,
                          const struct mesh_part *part))[3]
{
    const float *albedo = mesh->materials[part->material].albedo;
    for (uint32_t t = 0; t < part->triangles_count; t++) {
        const uint32_t *corner = mesh->triangles[part->first_triangle + t];
        for (int k = 1; k < 3; k++)
            if (memcmp(mesh->colors[corner[k]], mesh->colors[corner[0]], sizeof *mesh->colors) != 0)
                return NULL;
    }
    float(*tints)[3] = arena_alloc(arena, part->triangles_count, sizeof *tints);
    for (uint32_t t = 0; t < part->triangles_count; t++)
        for (int i = 0; i < 3; i++)
            tints[t][i] = albedo[i] * mesh->colors[mesh->triangles[part->first_triangle + t][0]][i];
    return tints;
}

static void surface_set(struct arena *arena, struct surface *surface, const struct mesh *mesh,
                        const struct mesh_part *part, bool plant)
{
    const struct material *material = &mesh->materials[part->material];
    *surface = (struct surface){
        .mesh = mesh,
        .first_triangle = part->first_triangle,
        .leaf = material_is_thin(material),
        .plant = plant,
        .flat = part_is_flat(mesh, part),
        .tints = mesh->colors ? part_tints(arena, mesh, part) : NULL,
        .texture = mesh->uvs ? material->texture : NULL,
    };
    surface->varied = surface->texture || (mesh->colors && !surface->tints);
    memcpy(surface->albedo, material->albedo, sizeof surface->albedo);
}

static enum status add_mesh(struct arena *arena, struct traced_scene *traced,
                            const struct mesh *mesh, struct surface *surfaces, bool plant,
                            struct error *error)
{
    struct embree_part *parts = ARENA_ARRAY(arena, struct embree_part, mesh->parts_count);
    for (size_t i = 0; i < mesh->parts_count; i++) {
        surface_set(arena, &surfaces[i], mesh, &mesh->parts[i], plant);
        parts[i] = (struct embree_part){.first_triangle = mesh->parts[i].first_triangle,
                                        .triangles_count = mesh->parts[i].triangles_count};
        if (surfaces[i].texture && texture_has_holes(surfaces[i].texture)) {
            parts[i].opaque = surface_opaque;
            parts[i].data = &surfaces[i];
        }
    }
    struct embree_mesh traced_mesh = {.positions = (const float *)mesh->positions,
                                      .vertices_count = mesh->vertices_count,
                                      .triangles = (const uint32_t *)mesh->triangles,
                                      .triangles_count = mesh->triangles_count,
                                      .parts = parts,
                                      .parts_count = mesh->parts_count};
    return embree_add_mesh(traced->embree, &traced_mesh, error);
}

/* A conifer is not traced as polygons: its branches and needles are round, solid, lit on the
 * outside alone. First the bark, then the needles, where there are any. */
static size_t conifer_surfaces(const struct conifer *conifer)
{
    return conifer->needles_count ? 2 : 1;
}

static struct embree_cones cones_of(struct arena *arena, const struct conifer_piece *pieces,
                                    size_t count)
{
    float(*ends)[2][4] = arena_alloc(arena, count, sizeof *ends);
    for (size_t i = 0; i < count; i++) {
        memcpy(ends[i][0], pieces[i].a_m, sizeof pieces[i].a_m);
        memcpy(ends[i][1], pieces[i].b_m, sizeof pieces[i].b_m);
        ends[i][0][3] = pieces[i].radius_a_m;
        ends[i][1][3] = pieces[i].radius_b_m;
    }
    return (struct embree_cones){ends[0][0], count};
}

static enum status add_conifer(struct traced_scene *traced, const struct conifer *conifer,
                               struct surface *surfaces, struct error *error)
{
    struct arena *scratch = arena_create(0);
    size_t bark = conifer->branches_count + conifer->twigs_count;
    struct conifer_piece *pieces = ARENA_ARRAY(scratch, struct conifer_piece, bark);
    conifer_bark(conifer, pieces);
    struct embree_cones sets[2] = {cones_of(scratch, pieces, bark)};
    const float *albedos[2] = {conifer->bark_albedo, conifer->needle_albedo};
    if (conifer->needles_count) {
        pieces = ARENA_ARRAY(scratch, struct conifer_piece, conifer->needles_count);
        conifer_needles(conifer, pieces);
        sets[1] = cones_of(scratch, pieces, conifer->needles_count);
    }
    for (size_t k = 0; k < conifer_surfaces(conifer); k++) {
        surfaces[k] = (struct surface){.plant = true, .flat = true};
        memcpy(surfaces[k].albedo, albedos[k], sizeof surfaces[k].albedo);
        surfaces[k].specular = k ? conifer->needle_specular : 0;
        surfaces[k].exponent = conifer->needle_exponent;
    }
    enum status status = embree_add_cones(traced->embree, sets, conifer_surfaces(conifer), error);
    arena_destroy(scratch);
    return status;
}

static void add_instance(struct traced_scene *traced, size_t number, mat4 matrix, uint32_t mesh,
                         const struct placement *placement)
{
    float to_world[12];
    for (int column = 0; column < 4; column++)
        for (int row = 0; row < 3; row++)
            to_world[3 * column + row] = matrix[column][row];
    embree_add_instance(traced->embree, mesh, to_world);
    traced->placements[number] = *placement;
}

/* A mesh or a conifer that is traced: its number in Embree and its surfaces. */
struct traced_mesh {
    const struct mesh *mesh;       /* NULL: not in the scene, or a conifer */
    const struct conifer *conifer; /* NULL: not in the scene, or a mesh */
    uint32_t number, first_surface;
};

/* The meshes of the species that have an instance, then the terrain's. */
static enum status find_meshes(struct arena *arena, const struct scene *scene,
                               struct traced_mesh *meshes, struct error *error)
{
    for (size_t i = 0; i < scene->instances_count; i++) {
        uint32_t species = scene->instances[i].species;
        if (species >= scene->species_count)
            return error_set(error, STATUS_INVALID, "instance %zu: species %u is outside 0..%zu", i,
                             species, scene->species_count - 1);
        if (meshes[species].mesh || meshes[species].conifer)
            continue;
        struct plant *plant = scene->species[species].plant;
        enum status status = plant_conifer(plant, &meshes[species].conifer, error);
        if (!status && !meshes[species].conifer)
            status = plant_mesh(plant, &meshes[species].mesh, error);
        if (status)
            return status;
    }
    if (scene->terrain.samples_x)
        meshes[scene->species_count].mesh = terrain_mesh(arena, &scene->terrain);
    return STATUS_OK;
}

static size_t surfaces_of(const struct traced_mesh *traced)
{
    return traced->conifer ? conifer_surfaces(traced->conifer)
           : traced->mesh  ? traced->mesh->parts_count
                           : 0;
}

static enum status add_meshes(struct arena *arena, const struct scene *scene,
                              struct traced_mesh *meshes, struct traced_scene *traced,
                              struct error *error)
{
    size_t surfaces_count = 0;
    for (size_t i = 0; i <= scene->species_count; i++)
        surfaces_count += surfaces_of(&meshes[i]);
    traced->surfaces = ARENA_ARRAY(arena, struct surface, surfaces_count);
    uint32_t number = 0, first_surface = 0;
    for (size_t i = 0; i <= scene->species_count; i++) {
        if (!surfaces_of(&meshes[i]))
            continue;
        struct surface *surfaces = traced->surfaces + first_surface;
        meshes[i].number = number++;
        meshes[i].first_surface = first_surface;
        enum status status = meshes[i].conifer
                                 ? add_conifer(traced, meshes[i].conifer, surfaces, error)
                                 : add_mesh(arena, traced, meshes[i].mesh, surfaces,
                                            i < scene->species_count, error);
        if (status)
            return status;
        first_surface += (uint32_t)surfaces_of(&meshes[i]);
    }
    return STATUS_OK;
}

enum status traced_scene_build(struct arena *arena, const struct scene *scene, int threads,
                               struct traced_scene *traced, struct error *error)
{
    *traced = (struct traced_scene){.scene = scene};
    struct traced_mesh *meshes = ARENA_ARRAY(arena, struct traced_mesh, scene->species_count + 1);
    enum status status = find_meshes(arena, scene, meshes, error);
    if (!status)
        status = embree_create(arena, threads, &traced->embree, error);
    if (!status)
        status = add_meshes(arena, scene, meshes, traced, error);
    if (status)
        return status;
    traced->placements = ARENA_ARRAY(arena, struct placement, scene->instances_count + 1);
    for (size_t i = 0; i < scene->instances_count; i++) {
        const struct instance *instance = &scene->instances[i];
        const struct traced_mesh *mesh = &meshes[instance->species];
        mat4 matrix = GLM_MAT4_IDENTITY_INIT;
        instance_matrix(instance, matrix);
        const struct placement placement = {cosf(instance->rotation_rad),
                                            sinf(instance->rotation_rad), 1 / instance->stretch,
                                            mesh->first_surface};
        add_instance(traced, i, matrix, mesh->number, &placement);
    }
    const struct traced_mesh *terrain = &meshes[scene->species_count];
    if (terrain->mesh) {
        mat4 matrix = GLM_MAT4_IDENTITY_INIT;
        const struct placement placement = {1, 0, 1, terrain->first_surface};
        add_instance(traced, scene->instances_count, matrix, terrain->number, &placement);
    }
    return embree_commit(traced->embree, error);
}
