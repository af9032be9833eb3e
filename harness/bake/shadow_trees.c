/* Triangles of trees in the world, in one vertex array, by texture and tree. */
#include "bake/shadow_trees.h"
#include "bake/backdrop.h"
#include "bake/cull.h"
#include "bake/shadow_map.h"

#include "shadow_volume.glsl.h"

#include <stddef.h>
#include <string.h>

struct vertex {
    float position_m[3];
    int16_t normal[4]; /* w: 1 leaf, 0 bark */
    uint16_t albedo[4];
    float uv[2];
};

/* What is drawn of one tree with one texture. */
struct run {
    uint32_t instance;
    size_t first, count; /* indices */
};

struct batch {
    GLuint texture; /* 0: none */
    size_t first_run, runs_count;
};

struct shadow_trees {
    const struct scene *scene;
    const struct shadow_map *map; /* received; NULL: none */
    const struct mesh **meshes;   /* a species */
    struct cull_bound *bounds;
    GLuint programs[2], vertices; /* program: of no texture, of one */
    size_t batches_count, runs_count;
    struct batch *batches;
    struct run *runs;
};

/* What is being filled. */
struct filling {
    struct vertex *vertices;
    uint32_t *indices, *renumbered; /* of a mesh's vertices, + 1 */
    size_t vertices_count, indices_count;
};

enum status shadow_trees_check(struct workspace *workspace, const struct scene *scene,
                               int triangles_most)
{
    double triangles = 0;
    for (size_t i = 0; i < scene->instances_count; i++) {
        const struct mesh *mesh;
        enum status status =
            plant_mesh(scene->species[scene->instances[i].species].plant, &mesh, workspace->error);
        if (status != STATUS_OK)
            return status;
        triangles += (double)mesh->triangles_count;
    }
    if (triangles <= triangles_most)
        return STATUS_OK;
    return error_set(workspace->error, STATUS_UNSUPPORTED,
                     "trees: %.0f triangles together; allowed: %d, by option triangles", triangles,
                     triangles_most);
}

void shadow_trees_place(const struct instance *instance, const float point[3], float world_m[3])
{
    float c = cosf(instance->rotation_rad) * instance->scale;
    float s = sinf(instance->rotation_rad) * instance->scale;
    world_m[0] = instance->position_m[0] + (point[0] * c + point[2] * s);
    world_m[1] = instance->position_m[1] + point[1] * (instance->scale * instance->stretch);
    world_m[2] = instance->position_m[2] + (point[2] * c - point[0] * s);
}

static void place_normal(const struct instance *instance, const float normal[3], bool thin,
                         int16_t packed[4])
{
    float c = cosf(instance->rotation_rad), s = sinf(instance->rotation_rad);
    float turned[3] = {normal[0] * c + normal[2] * s, normal[1] / instance->stretch,
                       normal[2] * c - normal[0] * s};
    float length = sqrtf(turned[0] * turned[0] + turned[1] * turned[1] + turned[2] * turned[2]);
    for (int i = 0; i < 3; i++)
        packed[i] = (int16_t)lrintf(32767 * turned[i] / (length > 0 ? length : 1));
    packed[3] = thin ? 32767 : 0;
}

static void fill_vertex(const struct mesh *mesh, const struct material *material,
                        const struct instance *instance, uint32_t from, struct vertex *to)
{
    shadow_trees_place(instance, mesh->positions[from], to->position_m);
    place_normal(instance, mesh->normals[from], material_is_thin(material), to->normal);
    for (int i = 0; i < 3; i++) {
        float albedo = material->albedo[i] * (mesh->colors ? mesh->colors[from][i] : 1);
        to->albedo[i] = (uint16_t)lrintf(65535 * fminf(1, fmaxf(0, albedo)));
    }
    if (mesh->uvs)
        memcpy(to->uv, mesh->uvs[from], sizeof to->uv);
}

/* A part's triangles; its vertices are its own, since the material's colour is in them. */
static void fill_part(const struct mesh *mesh, const struct mesh_part *part,
                      const struct instance *instance, struct filling *filling)
{
    memset(filling->renumbered, 0, mesh->vertices_count * sizeof *filling->renumbered);
    for (uint32_t t = 0; t < part->triangles_count; t++)
        for (int i = 0; i < 3; i++) {
            uint32_t from = mesh->triangles[part->first_triangle + t][i];
            uint32_t *number = &filling->renumbered[from];
            if (!*number) {
                fill_vertex(mesh, &mesh->materials[part->material], instance, from,
                            &filling->vertices[filling->vertices_count]);
                *number = (uint32_t)++filling->vertices_count;
            }
            filling->indices[filling->indices_count++] = *number - 1;
        }
}

/* Runs of the trees of one species, or of all, whose parts have this texture. */
static void fill_batch(struct shadow_trees *trees, const struct texture *texture,
                       struct filling *filling)
{
    const struct scene *scene = trees->scene;
    struct batch *batch = &trees->batches[trees->batches_count++];
    batch->first_run = trees->runs_count;
    for (size_t i = 0; i < scene->instances_count; i++) {
        const struct instance *instance = &scene->instances[i];
        const struct mesh *mesh = trees->meshes[instance->species];
        size_t first = filling->indices_count;
        for (size_t p = 0; p < mesh->parts_count; p++)
            if (mesh->materials[mesh->parts[p].material].texture == texture)
                fill_part(mesh, &mesh->parts[p], instance, filling);
        if (filling->indices_count > first)
            trees->runs[trees->runs_count++] =
                (struct run){(uint32_t)i, first, filling->indices_count - first};
    }
    batch->runs_count = trees->runs_count - batch->first_run;
}

static GLuint upload_texture(struct gl *gl, const struct texture *texture)
{
    GLuint name =
        gl_texture(gl, GL_TEXTURE_2D, 1, GL_RGBA16F, texture->width_px, texture->height_px, 1);
    gl->TextureSubImage2D(name, 0, 0, 0, texture->width_px, texture->height_px, GL_RGBA, GL_FLOAT,
                          texture->rgba);
    gl->TextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl->TextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    return name;
}

static void upload(struct gl *gl, struct shadow_trees *trees, const struct filling *filling)
{
    static const struct {
        GLint size;
        GLenum type;
        size_t offset;
    } attributes[] = {{3, GL_FLOAT, offsetof(struct vertex, position_m)},
                      {4, GL_SHORT, offsetof(struct vertex, normal)},
                      {4, GL_UNSIGNED_SHORT, offsetof(struct vertex, albedo)},
                      {2, GL_FLOAT, offsetof(struct vertex, uv)}};
    GLuint array = trees->vertices = gl_vertex_array(gl);
    GLuint vertices =
        gl_buffer(gl, (GLsizeiptr)(filling->vertices_count * sizeof *filling->vertices),
                  filling->vertices, 0);
    GLuint indices = gl_buffer(gl, (GLsizeiptr)(filling->indices_count * sizeof *filling->indices),
                               filling->indices, 0);
    gl->VertexArrayVertexBuffer(array, 0, vertices, 0, sizeof(struct vertex));
    gl->VertexArrayElementBuffer(array, indices);
    for (GLuint i = 0; i < 4; i++) {
        gl->VertexArrayAttribFormat(array, i, attributes[i].size, attributes[i].type,
                                    attributes[i].type != GL_FLOAT, (GLuint)attributes[i].offset);
        gl->VertexArrayAttribBinding(array, i, 0);
        gl->EnableVertexArrayAttrib(array, i);
    }
}

/* Room for everything, then a batch without texture and one for each texture. */
static void fill(struct workspace *workspace, struct shadow_trees *trees, struct arena *passing)
{
    const struct scene *scene = trees->scene;
    struct filling filling = {0};
    size_t corners = 0, vertices = 0, textures = 0;
    for (size_t i = 0; i < scene->instances_count; i++)
        corners += 3 * trees->meshes[scene->instances[i].species]->triangles_count;
    for (size_t s = 0; s < scene->species_count; s++) {
        vertices = vertices > trees->meshes[s]->vertices_count ? vertices
                                                               : trees->meshes[s]->vertices_count;
        textures += trees->meshes[s]->materials_count;
    }
    filling.vertices = ARENA_ARRAY(passing, struct vertex, corners);
    filling.indices = ARENA_ARRAY(passing, uint32_t, corners);
    filling.renumbered = ARENA_ARRAY(passing, uint32_t, vertices);
    trees->batches = ARENA_ARRAY(workspace->arena, struct batch, textures + 1);
    trees->runs =
        ARENA_ARRAY(workspace->arena, struct run, scene->instances_count * (textures + 1));
    fill_batch(trees, NULL, &filling);
    for (size_t s = 0; s < scene->species_count; s++)
        for (size_t m = 0; m < trees->meshes[s]->materials_count; m++) {
            const struct texture *texture = trees->meshes[s]->materials[m].texture;
            bool known = !texture;
            for (size_t before = 0; before < m; before++)
                known = known || trees->meshes[s]->materials[before].texture == texture;
            if (known)
                continue;
            trees->batches[trees->batches_count].texture = upload_texture(workspace->gl, texture);
            fill_batch(trees, texture, &filling);
        }
    upload(workspace->gl, trees, &filling);
}

enum status shadow_trees_prepare(struct workspace *workspace, const struct scene *scene,
                                 int triangles_most, const struct shadow_map *map,
                                 struct shadow_trees **trees)
{
    struct shadow_trees *made = *trees = ARENA_NEW(workspace->arena, struct shadow_trees);
    enum status status = STATUS_OK;
    made->scene = scene;
    made->map = map;
    made->meshes = arena_alloc(workspace->arena, scene->species_count, sizeof *made->meshes);
    made->bounds = ARENA_ARRAY(workspace->arena, struct cull_bound, scene->species_count);
    for (size_t s = 0; s < scene->species_count && status == STATUS_OK; s++) {
        status = plant_mesh(scene->species[s].plant, &made->meshes[s], workspace->error);
        if (status == STATUS_OK)
            made->bounds[s] = cull_bound_of(made->meshes[s]);
    }
    if (status == STATUS_OK)
        status = shadow_trees_check(workspace, scene, triangles_most);
    bool fog = workspace->effects & EFFECT_FOG && scene->fog.density_per_m > 0;
    for (int textured = 0; textured < 2 && status == STATUS_OK; textured++)
        status = shadow_receiver_program(workspace, map, "trees", shadow_volume_glsl,
                                         arena_printf(workspace->arena, "TREES 1\n%s%s",
                                                      textured ? "TEXTURED 1\n" : "",
                                                      fog ? "FOG 1\n" : ""),
                                         &made->programs[textured]);
    if (status != STATUS_OK)
        return status;
    struct arena *passing = arena_create(0);
    fill(workspace, made, passing);
    arena_destroy(passing);
    return gl_check(workspace->gl, "trees", workspace->error);
}

static bool is_seen(const struct shadow_trees *trees, const struct view *view, uint32_t number)
{
    const struct instance *instance = &trees->scene->instances[number];
    const struct cull_bound *bound = &trees->bounds[instance->species];
    float center[3] = {instance->position_m[0],
                       instance->position_m[1] +
                           bound->center_y_m * instance->scale * instance->stretch,
                       instance->position_m[2]};
    return view_sees_sphere(view, center, bound->radius_m * instance_reach(instance) * 1.0001f);
}

void shadow_trees_indices(struct gl *gl, size_t first, size_t count, uint32_t base)
{
    enum { CALL_INDICES = 3 << 14 };
    for (size_t done = 0; done < count; done += CALL_INDICES) {
        size_t left = count - done, part = left < CALL_INDICES ? left : CALL_INDICES;
        gl_draw_elements(gl, GL_TRIANGLES, (GLsizei)part, GL_UNSIGNED_INT,
                         (first + done) * sizeof(uint32_t), 1, (GLint)base, 0);
        gl->Flush();
    }
}

void shadow_trees_draw(struct workspace *workspace, const struct shadow_trees *trees,
                       const struct view *view)
{
    struct gl *gl = workspace->gl;
    gl->BindVertexArray(trees->vertices);
    for (size_t b = 0; b < trees->batches_count; b++) {
        const struct batch *batch = &trees->batches[b];
        if (!batch->runs_count)
            continue;
        GLuint program = trees->programs[batch->texture != 0];
        gl->UseProgram(program);
        shade_uniforms(workspace, program, trees->scene, view);
        shadow_receiver_uniforms(workspace, trees->map, program);
        if (batch->texture)
            gl->BindTextureUnit(0, batch->texture);
        size_t first = 0, count = 0;
        for (size_t r = 0; r <= batch->runs_count; r++) {
            const struct run *run = &trees->runs[batch->first_run + r];
            bool seen = r < batch->runs_count && is_seen(trees, view, run->instance);
            if (seen) {
                first = count ? first : run->first;
                count += run->count;
            } else if (count) {
                shadow_trees_indices(gl, first, count, 0);
                count = 0;
            }
        }
    }
}
