/* The march's sun shadows in OpenGL's buffers. */
#include "bake/sunlight_gl.h"
#include "bake/march_job.h"
#include "bake/shadow_ground.h"
#include "base/clock.h"

#include "sunlight.glsl.h"

#include <math.h>
#include <string.h>

/* Directions from which plants are looked at from far away: middles of so many parts of the
 * picture each way. */
enum { CUTS = 4, FARS = CUTS * CUTS * MARCH_TURNS };

/* What a plant's own shadow leaves. */
struct far {
    uint64_t picture; /* that it is of */
    float lit;
};

/* A buffer that grows, as texels. */
struct texels {
    GLuint buffer, texture;
    size_t room_bytes;
};
enum { PASSES, GAINS, VOLUMES, MAP, TERRAIN, TEXELS };

/* Four texels: rows from a level's voxels to cells; cells along them; the first one. */
struct volume_texels {
    float to_cells[3][4];
    uint32_t size[3], first;
};

struct sunlight_gl {
    const struct scene *scene;
    struct sunlight_gl_request request;
    struct march_species *species;
    struct march_shadows *shadows;
    struct texels texels[TEXELS];
    GLuint above; /* the ground's shares; 0: none */
    size_t above_bytes;
    struct volume_texels *volumes; /* kinds x VOXELS_LEVELS_MAX */
    uint32_t *corners;             /* trees x side x side */
    uint16_t *kinds;               /* one a tree */
    struct far *fars;              /* species x FARS */
    const struct view *view;       /* of this picture */
    uint64_t picture;
    unsigned effects;
    double seconds; /* that the last making took */
};

static enum status texels_room(struct workspace *workspace, struct sunlight_gl *sunlight, int kind,
                               size_t bytes)
{
    static const struct {
        GLenum format;
        size_t texel_bytes;
    } formats[TEXELS] = {[PASSES] = {GL_R8UI, 1},
                         [GAINS] = {GL_R32UI, 4},
                         [VOLUMES] = {GL_RGBA32UI, 16},
                         [MAP] = {GL_RGBA32UI, 16},
                         [TERRAIN] = {GL_R32F, 4}};
    struct gl *gl = workspace->gl;
    struct texels *texels = &sunlight->texels[kind];
    bytes = bytes > 16 ? bytes : 16;
    if (bytes <= texels->room_bytes)
        return STATUS_OK;
    if (texels->texture) {
        gl_delete_texture(gl, texels->texture);
        gl_delete_buffer(gl, texels->buffer);
    }
    texels->room_bytes = (bytes + bytes / 8 + 15) / 16 * 16;
    texels->buffer = gl_buffer(gl, (GLsizeiptr)texels->room_bytes, NULL, GL_DYNAMIC_STORAGE_BIT);
    return gl_texture_buffer(gl, formats[kind].format, formats[kind].texel_bytes, texels->buffer,
                             &texels->texture, workspace->error);
}

static enum status texels_put(struct workspace *workspace, struct sunlight_gl *sunlight, int kind,
                              const void *data, size_t bytes)
{
    enum status status = texels_room(workspace, sunlight, kind, bytes);
    if (!status && bytes)
        workspace->gl->NamedBufferSubData(sunlight->texels[kind].buffer, 0, (GLsizeiptr)bytes,
                                          data);
    return status;
}

enum status sunlight_gl_prepare(struct workspace *workspace, const struct scene *scene,
                                const struct sunlight_gl_request *request,
                                struct sunlight_gl **result)
{
    struct arena *arena = workspace->arena;
    struct sunlight_gl *sunlight = *result = ARENA_NEW(arena, struct sunlight_gl);
    const struct voxels_gl *voxels = request->voxels;
    const struct march_options options = {.resolution = voxels->resolution,
                                          .model = request->model,
                                          .shadow_resolution = request->cells};
    sunlight->scene = scene;
    sunlight->request = *request;
    sunlight->effects = workspace->effects;
    sunlight->species = ARENA_ARRAY(arena, struct march_species, scene->species_count);
    for (size_t i = 0; i < scene->species_count; i++)
        march_species_fill(arena, voxels->volumes[i], voxels->meshes[i], &sunlight->species[i]);
    enum status status = march_shadows_create(workspace, scene, &options, sunlight->species,
                                              request->trees, NULL, &sunlight->shadows);
    if (status)
        return status;
    int side;
    march_shadows_gains(sunlight->shadows, &side);
    const size_t count = scene->instances_count;
    sunlight->corners = ARENA_ARRAY(arena, uint32_t, count * (size_t)(side * side));
    sunlight->volumes = ARENA_ARRAY(arena, struct volume_texels,
                                    march_shadows_kinds(sunlight->shadows) * VOXELS_LEVELS_MAX);
    sunlight->fars = ARENA_ARRAY(arena, struct far, scene->species_count * FARS);
    sunlight->kinds = ARENA_ARRAY(arena, uint16_t, count);
    for (size_t i = 0; i < count; i++)
        sunlight->kinds[i] = (uint16_t)march_shadows_kind(sunlight->shadows, &request->trees[i]);
    return STATUS_OK;
}

static size_t volume_cells(const struct shadow_volume *volume)
{
    return volume ? (size_t)volume->size[0] * (size_t)volume->size[1] * (size_t)volume->size[2] : 0;
}

/* The volumes behind each other, and where each begins. */
static enum status volumes_put(struct workspace *workspace, struct sunlight_gl *sunlight)
{
    const size_t kinds = march_shadows_kinds(sunlight->shadows);
    const size_t species = sunlight->scene->species_count, turns = species ? kinds / species : 1;
    size_t cells = 0, first = 0;
    for (size_t k = 0; k < kinds; k++)
        cells += volume_cells(march_shadows_volume(sunlight->shadows, k));
    enum status status = texels_room(workspace, sunlight, PASSES, cells);
    for (size_t k = 0; k < kinds && !status; k++) {
        const struct shadow_volume *volume = march_shadows_volume(sunlight->shadows, k);
        if (!volume)
            continue;
        for (uint32_t l = 0; l < sunlight->species[k / turns].voxels->levels_count; l++) {
            struct volume_texels *to = &sunlight->volumes[k * VOXELS_LEVELS_MAX + l];
            march_shadows_to_cells(sunlight->shadows, k, l, to->to_cells);
            for (int i = 0; i < 3; i++)
                to->size[i] = (uint32_t)volume->size[i];
            to->first = (uint32_t)first;
        }
        workspace->gl->NamedBufferSubData(sunlight->texels[PASSES].buffer, (GLintptr)first,
                                          (GLsizeiptr)volume_cells(volume), volume->passes);
        first += volume_cells(volume);
    }
    if (!status)
        status = texels_put(workspace, sunlight, VOLUMES, sunlight->volumes,
                            kinds * VOXELS_LEVELS_MAX * sizeof *sunlight->volumes);
    return status;
}

/* Each corner with those to its right, above, and both, in a word. */
static enum status gains_put(struct workspace *workspace, struct sunlight_gl *sunlight)
{
    int side;
    const uint8_t *gains = march_shadows_gains(sunlight->shadows, &side);
    const size_t corners = (size_t)(side * side), count = sunlight->scene->instances_count;
    for (size_t i = 0; i < count; i++, gains += corners)
        for (int y = 0; y + 1 < side; y++)
            for (int x = 0; x + 1 < side; x++) {
                const uint8_t *at = gains + y * side + x;
                sunlight->corners[i * corners + (size_t)(y * side + x)] =
                    at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[side] << 16 |
                    (uint32_t)at[side + 1] << 24;
            }
    return texels_put(workspace, sunlight, GAINS, sunlight->corners,
                      count * corners * sizeof *sunlight->corners);
}

/* The ground's shares; sides are powers of two so that levels halve as the ground's do, and what is
 * beyond its own is lit. */
static void above_put(struct gl *gl, struct sunlight_gl *sunlight)
{
    static const float lit[4] = {1, 1, 1, 1};
    static const uint8_t all = 255;
    const struct shadow_ground *ground = march_shadows_ground(sunlight->shadows);
    int sides[2] = {1, 1};
    if (sunlight->above)
        gl_delete_texture(gl, sunlight->above);
    sunlight->above = 0;
    sunlight->above_bytes = 0;
    if (ground->levels_count == 0)
        return;
    for (int k = 0; k < 2; k++)
        while (sides[k] < ground->size[0][k])
            sides[k] *= 2;
    sunlight->above = gl_texture(gl, GL_TEXTURE_2D, 0, GL_R8, sides[0], sides[1], 1);
    gl->ClearTexImage(sunlight->above, 0, GL_RED, GL_UNSIGNED_BYTE, &all);
    gl->TextureSubImage2D(sunlight->above, 0, 0, 0, ground->size[0][0], ground->size[0][1], GL_RED,
                          GL_UNSIGNED_BYTE, ground->levels[0]);
    gl->GenerateTextureMipmap(sunlight->above);
    sunlight->above_bytes = (size_t)sides[0] * (size_t)sides[1] * 4 / 3;
    gl->TextureParameteri(sunlight->above, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    gl->TextureParameteri(sunlight->above, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl->TextureParameteri(sunlight->above, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
    gl->TextureParameteri(sunlight->above, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
    gl->TextureParameterfv(sunlight->above, GL_TEXTURE_BORDER_COLOR, lit);
}

static enum status all_put(struct workspace *workspace, struct sunlight_gl *sunlight)
{
    const struct shadow_light *light = march_shadows_sun(sunlight->shadows);
    const struct terrain *terrain = &sunlight->scene->terrain;
    size_t texels = (size_t)light->map.size[0] * (size_t)light->map.size[1];
    size_t samples = light->terrain_m ? (size_t)terrain->samples_x * terrain->samples_z : 0;
    enum status status = volumes_put(workspace, sunlight);
    if (!status)
        status = gains_put(workspace, sunlight);
    if (!status)
        status = texels_put(workspace, sunlight, MAP, light->map.texels,
                            texels * sizeof *light->map.texels);
    if (!status)
        status = texels_put(workspace, sunlight, TERRAIN, light->terrain_m,
                            samples * sizeof *light->terrain_m);
    above_put(workspace->gl, sunlight);
    return status;
}

enum status sunlight_gl_update(struct workspace *workspace, struct sunlight_gl *sunlight,
                               const struct view *view)
{
    double start = clock_wall_seconds();
    enum status status = STATUS_OK;
    if (march_shadows_light(sunlight->shadows, view->sun_direction, workspace->threads)) {
        status = all_put(workspace, sunlight);
        sunlight->seconds = clock_wall_seconds() - start;
    }
    sunlight->view = view;
    sunlight->picture++;
    if (workspace->counted) {
        workspace->tally.shadow_seconds += sunlight->seconds;
        workspace->tally.shadow_bytes += sunlight->above_bytes;
        for (int i = 0; i < TEXELS; i++)
            workspace->tally.shadow_bytes += sunlight->texels[i].room_bytes;
    }
    return status;
}

struct sunlight_gl_place sunlight_gl_of(const struct sunlight_gl *sunlight, uint32_t tree,
                                        uint32_t level)
{
    int side;
    march_shadows_gains(sunlight->shadows, &side);
    return (struct sunlight_gl_place){sunlight->kinds[tree] * (uint32_t)VOXELS_LEVELS_MAX + level,
                                      tree * (uint32_t)(side * side)};
}

/* From the middle of the part of the picture that a place is in. */
static float own_far(const struct sunlight_gl *sunlight, const struct march_tree *tree, int part)
{
    struct march_isa isas[4];
    march_kernel *kernel = isas[march_isas(isas) - 1].kernel;
    const struct view *view = sunlight->view;
    const struct march_view picture = {
        .view = view,
        .scene = sunlight->scene,
        .rays = backdrop_rays_of(view),
        .focal_px = cull_focal_px(view),
        .effects = sunlight->effects,
        .options = {.model = sunlight->request.model, .step = 1, .stop = 0.02f},
        .species = sunlight->species,
        .shadows = sunlight->shadows,
    };
    float x = ((float)(part % CUTS) + 0.5f) / CUTS, y = ((float)(part / CUTS) + 0.5f) / CUTS;
    return march_far_lit(&picture, tree->species, tree->turn, x * (float)view->width_px - 0.5f,
                         y * (float)view->height_px - 0.5f, kernel);
}

float sunlight_gl_far(struct sunlight_gl *sunlight, uint32_t number, const float at_px[2])
{
    const struct march_tree *tree = &sunlight->request.trees[number];
    const struct view *view = sunlight->view;
    const int sizes_px[2] = {view->width_px, view->height_px};
    int part[2];
    for (int i = 0; i < 2; i++)
        part[i] = (int)fminf(fmaxf((at_px[i] + 0.5f) * CUTS / (float)sizes_px[i], 0), CUTS - 1);
    struct far *far = sunlight->fars + (size_t)tree->species * FARS +
                      (size_t)((part[1] * CUTS + part[0]) * MARCH_TURNS + tree->turn);
    if (far->picture != sunlight->picture)
        *far = (struct far){sunlight->picture, own_far(sunlight, tree, part[1] * CUTS + part[0])};
    float away_m[3], square = 0;
    for (int i = 0; i < 3; i++) {
        away_m[i] = tree->position_m[i] - view->eye_m[i];
        square += away_m[i] * away_m[i];
    }
    float rise = away_m[1] / fmaxf(sqrtf(square), 1e-20f);
    return far->lit * march_shadows_of_tree(sunlight->shadows, number, rise);
}

void sunlight_gl_bind(struct workspace *workspace, const struct sunlight_gl *sunlight,
                      GLuint program, GLuint unit)
{
    struct gl *gl = workspace->gl;
    int side;
    march_shadows_gains(sunlight->shadows, &side);
    for (GLuint i = 0; i < SUNLIGHT_GL_UNITS; i++)
        gl->BindTextureUnit(unit + i, sunlight->texels[PASSES + i].texture);
    gl->Uniform2f(gl_uniform(gl, program, "light_terms"), (float)side, march_shadows_bark_cells);
}

enum status sunlight_gl_program(struct workspace *workspace, const struct sunlight_gl *sunlight,
                                const char *name, const char *source, const char *defines,
                                GLuint *program)
{
    const char *all = arena_printf(
        workspace->arena, "SHADOWED 1\n%s%s",
        march_shadows_sun(sunlight->shadows)->terrain_m ? "BENT 1\n" : "", defines ? defines : "");
    const char *text = arena_printf(workspace->arena, "%s\n%s", sunlight_glsl, source);
    return gl_program(workspace->gl, name, text, all, program, workspace->error);
}

void sunlight_gl_uniforms(struct workspace *workspace, const struct sunlight_gl *sunlight,
                          GLuint program)
{
    enum { UNIT_TERRAIN = 5, UNIT_MAP = 6, UNIT_ABOVE = 7 };
    struct gl *gl = workspace->gl;
    const struct shadow_light *light = march_shadows_sun(sunlight->shadows);
    const struct shadow_map *map = &light->map;
    const struct terrain *terrain = &sunlight->scene->terrain;
    const bool any = map->size[0] > 0;
    const struct shadow_ground *ground = march_shadows_ground(sunlight->shadows);
    const float texels = any ? 1 / map->texel_m : 0, depths = any ? 1 / map->depth_m : 0;
    gl->UniformMatrix3fv(gl_uniform(gl, program, "sun_axes"), 1, GL_FALSE, light->frame.axes[0]);
    gl->Uniform3fv(gl_uniform(gl, program, "sun_low"), 1, map->low_m);
    gl->Uniform3f(gl_uniform(gl, program, "sun_per_m"), texels, texels, depths);
    gl->Uniform2i(gl_uniform(gl, program, "sun_size"), map->size[0], map->size[1]);
    gl->Uniform3f(gl_uniform(gl, program, "sun_ground_m"), terrain->size_x_m, terrain->size_z_m,
                  light->least_m);
    gl->Uniform2i(gl_uniform(gl, program, "sun_samples"), (GLint)terrain->samples_x,
                  (GLint)terrain->samples_z);
    gl->Uniform3f(gl_uniform(gl, program, "sun_above_place"), ground->low_m[0], ground->low_m[1],
                  sunlight->above ? 1 / ground->cell_m : 0);
    gl->Uniform2f(gl_uniform(gl, program, "sun_above_size"), (float)ground->size[0][0],
                  (float)ground->size[0][1]);
    gl->BindTextureUnit(UNIT_ABOVE, sunlight->above);
    gl->BindTextureUnit(UNIT_TERRAIN, sunlight->texels[TERRAIN].texture);
    gl->BindTextureUnit(UNIT_MAP, sunlight->texels[MAP].texture);
}
