/* The atlas of a scene: plants from the cache or the kiln, mip-maps, upload. */
#include "bake/atlas.h"
#include "bake/atlas_bake.h"

#include "base/color.h"
#include "base/file.h"
#include "base/hash.h"

#include <string.h>

/* Changes whenever the same request would bake other bytes. */
enum { ATLAS_VERSION = 2 };

static size_t plant_pixels(const struct atlas_plant *plant)
{
    return plant->views_count * (size_t)plant->width_px * (size_t)plant->height_px;
}

/* What the cache keeps: the struct itself (its pointers mean nothing there), then its arrays. */
static size_t packed_bytes(const struct atlas_plant *plant)
{
    return sizeof *plant + plant->views_count * sizeof *plant->views + 10 * plant_pixels(plant);
}

static void copy_arrays(struct atlas_plant *plant, uint8_t *bytes, bool pack)
{
    void *arrays[4] = {plant->views, plant->albedo, plant->channels, plant->depth};
    size_t pixels = plant_pixels(plant);
    size_t sizes[4] = {plant->views_count * sizeof *plant->views, 4 * pixels, 4 * pixels,
                       2 * pixels};
    for (int i = 0; i < 4; bytes += sizes[i], i++)
        memcpy(pack ? bytes : arrays[i], pack ? arrays[i] : bytes, sizes[i]);
}

static void cache_plant(struct arena *scratch, uint64_t key, struct atlas_plant *plant)
{
    size_t size = packed_bytes(plant);
    uint8_t *bytes = arena_alloc(scratch, size, 1);
    memcpy(bytes, plant, sizeof *plant);
    copy_arrays(plant, bytes + sizeof *plant, true);
    cache_put("atlas", key, bytes, size);
}

static bool cached_plant(struct arena *scratch, uint64_t key, struct atlas_plant *plant)
{
    void *data;
    size_t size;
    if (!cache_get(scratch, "atlas", key, &data, &size) || size < sizeof *plant)
        return false;
    memcpy(plant, data, sizeof *plant);
    if (plant->width_px < 1 || plant->height_px < 1 || plant->width_px > 4096 ||
        plant->height_px > 4096 || plant->views_count > 1 << 20 || size != packed_bytes(plant))
        return false;
    size_t pixels = plant_pixels(plant);
    plant->views = ARENA_ARRAY(scratch, struct atlas_view, plant->views_count);
    plant->albedo = arena_alloc(scratch, pixels, sizeof *plant->albedo);
    plant->channels = arena_alloc(scratch, pixels, sizeof *plant->channels);
    plant->depth = arena_alloc(scratch, pixels, sizeof *plant->depth);
    copy_arrays(plant, (uint8_t *)data + sizeof *plant, false);
    return true;
}

/* One plant's pictures, from the cache or baked. */
static enum status obtain(struct workspace *workspace, struct arena *scratch, struct plant *source,
                          const struct atlas_request *request, struct atlas_plant *plant)
{
    bool two_sided = workspace->effects & EFFECT_TWO_SIDED;
    const struct mesh *mesh;
    uint64_t key;
    enum status status = plant_hash(source, &key, workspace->error);
    if (status != STATUS_OK)
        return status;
    key = hash_u64(hash_u64(hash_u64(key, ATLAS_VERSION), request->layout), request->side);
    key = hash_u64(hash_u64(key, (uint64_t)request->resolution_px), (uint64_t)request->samples);
    key = hash_text(hash_u64(key, two_sided), workspace->gl->renderer);
    if (cached_plant(scratch, key, plant))
        return STATUS_OK;
    status = plant_mesh(source, &mesh, workspace->error);
    if (status == STATUS_OK)
        status = atlas_bake(workspace, scratch, mesh, request, two_sided, plant);
    if (status == STATUS_OK)
        cache_plant(scratch, key, plant);
    return status;
}

static int power_of_two(int size)
{
    int power = 1;
    while (power < size)
        power *= 2;
    return power;
}

/* Sizes of the arrays for all plants; STATUS_INVALID when they are too large. */
static enum status lay_out(struct workspace *workspace, const struct atlas_request *request,
                           const struct atlas_plant *const *plants, struct atlas *atlas)
{
    GLint layers_most = 0;
    int width = 1, height = 1;
    for (size_t i = 0; i < atlas->species_count; i++) {
        atlas->species[i].first_view = plants[i] ? (float)atlas->layers : -1;
        if (!plants[i])
            continue;
        atlas->layers += (int)atlas->views_count;
        width = plants[i]->width_px > width ? plants[i]->width_px : width;
        height = plants[i]->height_px > height ? plants[i]->height_px : height;
    }
    atlas->width_px = power_of_two(width);
    atlas->height_px = power_of_two(height);
    for (int w = atlas->width_px, h = atlas->height_px; w > 0 || h > 0; w /= 2, h /= 2) {
        int shorter = atlas->width_px < atlas->height_px ? w : h;
        if (atlas->levels > 0 && request->alpha == ATLAS_TEST && shorter < 4)
            break;
        atlas->levels++;
    }
    double bytes = 13.4 * atlas->width_px * atlas->height_px * atlas->layers;
    workspace->gl->GetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &layers_most);
    if (atlas->layers > layers_most || bytes > 4294967296.0)
        return error_set(
            workspace->error, STATUS_INVALID,
            "atlas: %d pictures of %d x %d texels need %.0f MiB; allowed: %d pictures, "
            "4096 MiB (fewer views or a lower resolution)",
            atlas->layers, atlas->width_px, atlas->height_px, bytes / 1048576, (int)layers_most);
    return STATUS_OK;
}

/* Level 0 of one picture as floats, in the lower left corner of an empty layer. */
static void expand(const struct atlas_plant *plant, size_t view, const struct atlas *atlas,
                   float *texels)
{
    size_t width = (size_t)plant->width_px, height = (size_t)plant->height_px;
    memset(texels, 0,
           TEXEL_FLOATS * sizeof *texels * (size_t)atlas->width_px * (size_t)atlas->height_px);
    for (size_t y = 0; y < height; y++)
        for (size_t x = 0; x < width; x++) {
            size_t from = (view * height + y) * width + x;
            float *to = texels + TEXEL_FLOATS * (y * (size_t)atlas->width_px + x);
            for (int i = 0; i < 4; i++) {
                to[i] = plant->albedo[from][i] / 255.0f;
                to[4 + i] = plant->channels[from][i] / 255.0f;
            }
            to[8] = plant->depth[from] / 65535.0f;
        }
}

/* A level as bytes for the arrays. Straight colour of empty texels is the coarser level's. */
struct level {
    int width_px, height_px;
    float *texels;   /* height x width x 9 */
    float *straight; /* height x width x 3 */
    uint8_t (*albedo)[4], (*light)[4];
    uint16_t *depth;
};

static struct level *levels_create(struct arena *scratch, const struct atlas *atlas)
{
    struct level *levels = ARENA_ARRAY(scratch, struct level, (size_t)atlas->levels + 16);
    int width = atlas->width_px, height = atlas->height_px;
    for (int i = 0;; i++) {
        size_t count = (size_t)width * (size_t)height;
        levels[i].width_px = width;
        levels[i].height_px = height;
        levels[i].texels = ARENA_ARRAY(scratch, float, TEXEL_FLOATS *count);
        levels[i].straight = ARENA_ARRAY(scratch, float, 3 * count);
        levels[i].albedo = arena_alloc(scratch, count, 4);
        levels[i].light = arena_alloc(scratch, count, 4);
        levels[i].depth = ARENA_ARRAY(scratch, uint16_t, count);
        if (count == 1)
            return levels;
        width = width > 1 ? width / 2 : 1;
        height = height > 1 ? height / 2 : 1;
    }
}

static void straighten(struct level *level, const struct level *coarser)
{
    int step_x = level->width_px > 1 ? 2 : 1, step_y = level->height_px > 1 ? 2 : 1;
    for (int y = 0; y < level->height_px; y++)
        for (int x = 0; x < level->width_px; x++) {
            size_t at = (size_t)y * (size_t)level->width_px + (size_t)x;
            size_t above =
                coarser ? (size_t)(y / step_y) * (size_t)coarser->width_px + (size_t)(x / step_x)
                        : 0;
            const float *texel = level->texels + TEXEL_FLOATS * at;
            for (int i = 0; i < 3; i++)
                level->straight[3 * at + (size_t)i] =
                    texel[3] > 0 ? texel[i] / texel[3]
                                 : (coarser ? coarser->straight[3 * above + (size_t)i] : 0);
        }
}

static void quantise(struct level *level, enum atlas_alpha alpha, bool nearest)
{
    size_t count = (size_t)level->width_px * (size_t)level->height_px;
    float scale = alpha == ATLAS_TEST
                      ? atlas_test_scale(level->texels, level->width_px, level->height_px, nearest)
                      : 1;
    for (size_t at = 0; at < count; at++) {
        const float *texel = level->texels + TEXEL_FLOATS * at;
        const float *color = alpha == ATLAS_BLEND ? texel : level->straight + 3 * at;
        for (size_t i = 0; i < 3; i++)
            level->albedo[at][i] = color_byte(color[i]);
        level->albedo[at][3] = color_byte(scale * texel[3]);
        for (size_t i = 0; i < 4; i++)
            level->light[at][i] = color_byte(texel[4 + i]);
        level->depth[at] = (uint16_t)(fminf(fmaxf(texel[8], 0), 1) * 65535 + 0.5f);
    }
}

/* All levels of one picture, from its finest. */
static void build_levels(struct level *levels, const struct atlas_request *request)
{
    int last = 0;
    for (; levels[last].width_px > 1 || levels[last].height_px > 1; last++)
        atlas_halve(levels[last].texels, levels[last].width_px, levels[last].height_px,
                    levels[last + 1].texels);
    for (int i = last; i >= 0; i--) {
        struct level *coarser = i < last ? &levels[i + 1] : NULL;
        straighten(&levels[i], coarser);
        if (coarser)
            atlas_fill(levels[i].texels, levels[i].width_px, levels[i].height_px, coarser->texels);
        quantise(&levels[i], request->alpha, request->nearest && i > 0);
    }
}

/* filter: within a level, where texels are not larger than pixels. */
static GLuint create_array(struct gl *gl, const struct atlas *atlas, GLenum format, GLint filter)
{
    GLuint name = gl_texture(gl, GL_TEXTURE_2D_ARRAY, atlas->levels, format, atlas->width_px,
                             atlas->height_px, atlas->layers);
    gl->TextureParameteri(name, GL_TEXTURE_MIN_FILTER, filter);
    gl->TextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl->TextureParameteri(name, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl->TextureParameteri(name, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    return name;
}

static void upload_picture(struct gl *gl, const struct atlas *atlas, const struct level *levels,
                           int layer)
{
    for (int i = 0; i < atlas->levels; i++) {
        const struct level *level = &levels[i];
        gl->TextureSubImage3D(atlas->albedo, i, 0, 0, layer, level->width_px, level->height_px, 1,
                              GL_RGBA, GL_UNSIGNED_BYTE, level->albedo);
        gl->TextureSubImage3D(atlas->light, i, 0, 0, layer, level->width_px, level->height_px, 1,
                              GL_RGBA, GL_UNSIGNED_BYTE, level->light);
        if (atlas->depth)
            gl->TextureSubImage3D(atlas->depth, i, 0, 0, layer, level->width_px, level->height_px,
                                  1, GL_RED, GL_UNSIGNED_SHORT, level->depth);
    }
}

static void upload(struct workspace *workspace, struct arena *scratch,
                   const struct atlas_request *request, const struct atlas_plant *const *plants,
                   struct atlas *atlas)
{
    struct gl *gl = workspace->gl;
    struct level *levels = levels_create(scratch, atlas);
    int layer = 0;
    /* Light varies less than coverage does: its nearest texel will do, at a third of the cost. */
    atlas->albedo =
        create_array(gl, atlas, GL_RGBA8,
                     request->nearest ? GL_NEAREST_MIPMAP_NEAREST : GL_LINEAR_MIPMAP_NEAREST);
    atlas->light = create_array(gl, atlas, GL_RGBA8, GL_NEAREST_MIPMAP_NEAREST);
    atlas->depth = request->depth ? create_array(gl, atlas, GL_R16, GL_LINEAR_MIPMAP_NEAREST) : 0;
    for (size_t i = 0; i < atlas->species_count; i++)
        for (size_t view = 0; plants[i] && view < atlas->views_count; view++, layer++) {
            expand(plants[i], view, atlas, levels[0].texels);
            build_levels(levels, request);
            upload_picture(gl, atlas, levels, layer);
            atlas->views[layer] = plants[i]->views[view];
        }
}

static void describe_species(const struct atlas_plant *plant, struct atlas_species *species)
{
    if (!plant)
        return;
    species->center_y_m = plant->center_y_m;
    species->radius_m = plant->radius_m;
    species->texel_m = plant->texel_m;
    species->albedo_scale = plant->albedo_scale;
    memcpy(species->light, plant->light.row, sizeof species->light);
}

/* One plant per species, NULL where the scene has no tree of it. */
static enum status obtain_all(struct workspace *workspace, struct arena *scratch,
                              const struct scene *scene, const struct atlas_request *request,
                              const struct atlas_plant **plants)
{
    enum status status = STATUS_OK;
    bool *used = ARENA_ARRAY(scratch, bool, scene->species_count);
    for (size_t i = 0; i < scene->instances_count; i++)
        used[scene->instances[i].species] = true;
    for (size_t i = 0; status == STATUS_OK && i < scene->species_count; i++) {
        struct atlas_plant *plant = used[i] ? ARENA_NEW(scratch, struct atlas_plant) : NULL;
        plants[i] = plant;
        if (plant)
            status = obtain(workspace, scratch, scene->species[i].plant, request, plant);
    }
    return status;
}

enum status atlas_build(struct workspace *workspace, const struct scene *scene,
                        const struct atlas_request *request, struct atlas **result)
{
    struct gl *gl = workspace->gl;
    struct arena *scratch = arena_create(0);
    struct atlas *atlas = *result = ARENA_NEW(workspace->arena, struct atlas);
    const struct atlas_plant **plants =
        ARENA_ARRAY(scratch, const struct atlas_plant *, scene->species_count);
    atlas->species_count = scene->species_count;
    atlas->species = ARENA_ARRAY(workspace->arena, struct atlas_species, scene->species_count);
    atlas->views_count = views_count(request->layout, request->side);
    enum status status = obtain_all(workspace, scratch, scene, request, plants);
    if (status == STATUS_OK)
        status = lay_out(workspace, request, plants, atlas);
    if (status == STATUS_OK && atlas->layers > 0) {
        atlas->views = ARENA_ARRAY(workspace->arena, struct atlas_view, (size_t)atlas->layers);
        upload(workspace, scratch, request, plants, atlas);
        for (size_t i = 0; i < scene->species_count; i++)
            describe_species(plants[i], &atlas->species[i]);
        atlas->views_buffer =
            gl_buffer(gl, atlas->layers * (GLsizeiptr)sizeof *atlas->views, atlas->views, 0);
        atlas->species_buffer = gl_buffer(
            gl, (GLsizeiptr)(scene->species_count * sizeof *atlas->species), atlas->species, 0);
        status = gl_check(gl, "atlas", workspace->error);
    }
    arena_destroy(scratch);
    return status;
}
