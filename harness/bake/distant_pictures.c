/* Small pictures of plants from many directions, lit for every step of a tree's rotation. */
#include "bake/distant_parts.h"
#include "bake/slices.h"
#include "bake/views.h"

#include <math.h>
#include <string.h>

/* Texels along a plant's height when its light is computed; the first picture that is kept has half
 * as many. */
enum { LIT_PX = 32, SAMPLES = 4 };

static int power_of_two_above(float wanted)
{
    int side = 1;
    while ((float)side < wanted && side < LIT_PX)
        side *= 2;
    return side;
}

static void levels_plan(struct distant_plant *plant, int width, int height)
{
    for (;;) {
        width = width > 1 ? width / 2 : 1;
        height = height > 1 ? height / 2 : 1;
        struct distant_level *level = &plant->levels[plant->levels_count++];
        *level = (struct distant_level){width, height, plant->texels_count};
        plant->texels_count += (size_t)(width + 2) * (size_t)(height + 2);
        if (width == 1 && height == 1)
            return;
    }
}

/* The mean place of what a picture shows: there it stays when it is seen from a little beside the
 * direction that it was made from. */
static void middle_of(const struct slices *slices, size_t view, float middle_m[3])
{
    const struct slices_stack *frame = &slices->stacks[view];
    const struct slice *slice = &slices->slices[view];
    const float *axes[3] = {frame->right, frame->up, frame->toward};
    double sums[4] = {0, 0, 0, 0};
    for (int y = 0; y < slice->height; y++)
        for (int x = 0; x < slice->width; x++) {
            size_t at = slice->first + (size_t)(y * slice->width + x);
            double covered = slices->color[at][3];
            sums[0] += covered * (slice->left + x + 0.5) / slices->width_px;
            sums[1] += covered * (slice->bottom + y + 0.5) / slices->height_px;
            sums[2] += covered * slices->depth[at] / 65535;
            sums[3] += covered;
        }
    for (int k = 0; k < 3 && sums[3] > 0; k++) {
        float along = (float)(sums[k] / sums[3]);
        along = frame->low_m[k] + along * (frame->high_m[k] - frame->low_m[k]);
        for (int i = 0; i < 3; i++)
            middle_m[i] += along * axes[k][i];
    }
}

/* Where the pictures stand. */
static void frames_place(struct distant_plant *plant)
{
    const struct slices *slices = plant->slices;
    const struct distant_level *level = &plant->levels[0];
    for (size_t v = 0; v < DISTANT_VIEWS; v++) {
        const struct slices_stack *frame = &slices->stacks[v];
        const float *axes[2] = {frame->right, frame->up}, *at = plant->middle_m[v];
        const int texels[2] = {level->width, level->height};
        middle_of(slices, v, plant->middle_m[v]);
        for (int axis = 0; axis < 2; axis++) {
            plant->low_m[v][axis] = frame->low_m[axis] - at[0] * axes[axis][0] -
                                    at[1] * axes[axis][1] - at[2] * axes[axis][2];
            plant->texel_m[v][axis] =
                (frame->high_m[axis] - frame->low_m[axis]) / (float)texels[axis];
        }
    }
}

enum status distant_plant_measure(struct workspace *workspace, struct plant *plant,
                                  struct distant_plant *made)
{
    const struct mesh *mesh;
    enum status status = plant_mesh(plant, &mesh, workspace->error);
    if (status != STATUS_OK)
        return status;
    made->foot_reach_m =
        hypotf(mesh->radius_m, fmaxf(fabsf(mesh->minimum_m[1]), fabsf(mesh->maximum_m[1])));
    made->height_m = fmaxf(mesh->maximum_m[1] - mesh->minimum_m[1], 1e-12f);
    made->width_m = fmaxf(2 * mesh->radius_m, 1e-12f);
    return STATUS_OK;
}

enum status distant_plant_bake(struct workspace *workspace, struct plant *plant,
                               struct distant_plant *made)
{
    struct arena *arena = workspace->arena;
    float(*directions)[3] = arena_alloc(arena, DISTANT_VIEWS, sizeof *directions);
    for (size_t v = 0; v < DISTANT_VIEWS; v++)
        views_direction(VIEWS_HEMISPHERE, DISTANT_SIDE, v, directions[v]);
    float longest_m = fmaxf(made->height_m, made->width_m);
    struct slices_request request = {
        .directions_count = DISTANT_VIEWS,
        .directions = (const float(*)[3])directions,
        .width_px = power_of_two_above(LIT_PX * made->width_m / longest_m),
        .height_px = power_of_two_above(LIT_PX * made->height_m / longest_m),
        .count = 1,
        .samples = SAMPLES,
        .cut = SLICES_CLIP,
        .parts = SLICES_BARK | SLICES_LEAVES,
    };
    enum status status =
        slices_create(arena, plant, &request, workspace->threads, &made->slices, workspace->error);
    if (status != STATUS_OK)
        return status;
    levels_plan(made, request.width_px, request.height_px);
    frames_place(made);
    made->texels = arena_alloc(arena, DISTANT_VIEWS * DISTANT_TURNS * made->texels_count,
                               sizeof *made->texels);
    return STATUS_OK;
}

/* Mean light of a texel, as light_of() of stack.glsl with ROUGH: normal x coverage, share of leaf x
 * coverage. */
static float light_of(const float texel[SLICES_FLOATS], const float sun[3], bool two_sided)
{
    float along = 0, square = 0, per = 1 / texel[3];
    for (int i = 0; i < 3; i++) {
        along += texel[4 + i] * per * sun[i];
        square += texel[4 + i] * per * texel[4 + i] * per;
    }
    float size = sqrtf(along * along + fmaxf(1 - square, 0) / 4.5f);
    float leaf = two_sided ? texel[7] * per : 0;
    return leaf * size + (1 - leaf) * 0.5f * (along + size);
}

/* A tree's colours, premultiplied, rgb and coverage a texel. */
static void picture_light(const struct distant_plant *plant, const struct distant_light *light,
                          const float sun[3], const float *texels, float (*lit)[4])
{
    const struct slices *slices = plant->slices;
    size_t count = (size_t)slices->width_px * (size_t)slices->height_px;
    for (size_t i = 0; i < count; i++) {
        const float *texel = texels + i * SLICES_FLOATS;
        float diffuse = texel[3] > 0 ? light_of(texel, sun, light->two_sided) : 0;
        for (int c = 0; c < 3; c++)
            lit[i][c] = texel[c] * slices->albedo_scale *
                        (diffuse * light->sun_radiance[c] + light->ambient[c]);
        lit[i][3] = texel[3];
    }
}

/* Means of 2 x 2, 2 x 1 or 1 x 2 texels, in place; sides are powers of two. */
static void picture_halve(float (*lit)[4], int *width, int *height)
{
    int wide = *width > 1 ? 2 : 1, high = *height > 1 ? 2 : 1, from = *width;
    *width /= wide;
    *height /= high;
    for (int y = 0; y < *height; y++)
        for (int x = 0; x < *width; x++)
            for (int c = 0; c < 4; c++) {
                float sum = 0;
                for (int k = 0; k < wide * high; k++)
                    sum += lit[(high * y + k / wide) * from + wide * x + k % wide][c];
                lit[y * *width + x][c] = sum / (float)(wide * high);
            }
}

static void level_store(const struct distant_level *level, float scale, float (*lit)[4],
                        uint8_t (*texels)[4])
{
    for (int y = 0; y < level->height; y++)
        for (int x = 0; x < level->width; x++) {
            const float *from = lit[y * level->width + x];
            uint8_t *to = texels[level->first + (size_t)((y + 1) * (level->width + 2) + x + 1)];
            for (int c = 0; c < 4; c++)
                to[c] = (uint8_t)(fminf(from[c] * (c < 3 ? 255 / scale : 255), 255) + 0.5f);
        }
}

/* One direction, for all turns of the light. */
static void view_light(struct distant_plant *plant, const struct distant_light *light, size_t view)
{
    const struct slices *slices = plant->slices;
    struct arena *scratch = arena_create(0);
    size_t count = (size_t)slices->width_px * (size_t)slices->height_px;
    float *texels = ARENA_ARRAY(scratch, float, count *SLICES_FLOATS);
    float(*lit)[4] = arena_alloc(scratch, count, sizeof *lit);
    slices_expand(slices, view, 0, texels);
    for (size_t turn = 0; turn < DISTANT_TURNS; turn++) {
        float angle = (float)turn * 2 * (float)M_PI / DISTANT_TURNS;
        float c = cosf(angle), s = sinf(angle);
        const float *world = light->sun_direction;
        const float sun[3] = {world[0] * c - world[2] * s, world[1], world[0] * s + world[2] * c};
        int width = slices->width_px, height = slices->height_px;
        picture_light(plant, light, sun, texels, lit);
        for (int l = 0; l < plant->levels_count; l++) {
            picture_halve(lit, &width, &height);
            level_store(&plant->levels[l], plant->scale, lit,
                        plant->texels + (view * DISTANT_TURNS + turn) * plant->texels_count);
        }
    }
    arena_destroy(scratch);
}

void distant_plant_light(struct workspace *workspace, struct distant_plant *plant,
                         const struct distant_light *light)
{
    plant->scale = 0;
    for (int c = 0; c < 3; c++)
        plant->scale = fmaxf(plant->scale, light->sun_radiance[c] + light->ambient[c]);
    plant->scale = fmaxf(plant->scale * plant->slices->albedo_scale, 1e-12f);
#pragma omp parallel for num_threads(workspace->threads > 0 ? workspace->threads : 1)              \
    schedule(dynamic)
    for (size_t view = 0; view < DISTANT_VIEWS; view++)
        view_light(plant, light, view);
}
