/* Slices from pictures: where the volume lies in them, what they cover, how they are lit. */
#include "testing.h"

#include "bake/coloring_views.h"
#include "bake/slices.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static struct plant *plant_of(struct arena *arena, const char *generator, const char *options)
{
    struct error error = {0};
    struct plant *plant = NULL;
    if (plant_generated(arena, generator, options, &plant, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    return plant;
}

static struct slices_request usual(int side, size_t views)
{
    return (struct slices_request){.directions_count = 3,
                                   .directions = slices_axes,
                                   .width_px = side,
                                   .height_px = side,
                                   .count = side,
                                   .samples = 1,
                                   .parts = SLICES_BARK | SLICES_LEAVES,
                                   .views = views};
}

static const struct slices *made(struct arena *arena, struct plant *plant,
                                 const struct slices_request *request)
{
    struct error error = {0};
    const struct slices *slices = NULL;
    if (slices_create(arena, plant, request, 2, &slices, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    return slices;
}

/* Mean coverage of a stack seen from the front, composited. */
static double cover(struct arena *arena, const struct slices *slices, size_t stack)
{
    size_t texels = (size_t)slices->width_px * (size_t)slices->height_px;
    float *clear = ARENA_ARRAY(arena, float, texels);
    double sum = 0;
    for (int k = 0; k < slices->count; k++) {
        const struct slice *slice = &slices->slices[stack * (size_t)slices->count + (size_t)k];
        for (int row = 0; row < slice->height; row++)
            for (int column = 0; column < slice->width; column++) {
                size_t from = slice->first + (size_t)(row * slice->width + column);
                size_t to = (size_t)(slice->bottom + row) * (size_t)slices->width_px +
                            (size_t)(slice->left + column);
                float alpha = (float)slices->color[from][3] / 255;
                clear[to] = 1 - (1 - clear[to]) * (1 - alpha); /* covered so far */
            }
    }
    for (size_t i = 0; i < texels; i++)
        sum += (double)clear[i] / (double)texels;
    return sum;
}

/* Against the plant's own rays: the share of a picture's pixels that hit it. */
static void test_slices__of_pictures_cover_what_the_plant_covers(void **state)
{
    (void)state;
    static const char *const plants[] = {"poplar", "hypertexture"};
    for (int p = 0; p < 2; p++) {
        struct arena *arena = arena_create(0);
        struct plant *plant = plant_of(arena, plants[p], NULL);
        struct slices_request request = usual(64, 12);
        const struct slices *slices = made(arena, plant, &request);
        struct images pictures;
        struct coloring_shots shots = {6, 256, 1.01f / 62};
        assert_int_equal(coloring_trace(arena, plant, &shots, 2, &pictures, NULL), STATUS_OK);
        static const size_t view_of[3] = {4, 0, 2}; /* +z, +x, +y */
        for (size_t k = 0; k < 3; k++) {
            double hits = 0;
            for (size_t i = 0; i < 256 * 256; i++)
                hits += isfinite(pictures.views[view_of[k]].depth_m[i]) / 65536.0;
            double covered = cover(arena, slices, k);
            if (fabs(covered / hits - 1) > 0.06)
                fail_msg("%s along axis %zu: %g of %g", plants[p], k, covered, hits);
        }
        arena_destroy(arena);
    }
}

/* The ball of radius 1, its middle 1 m above the ground. */
static struct plant *ball(struct arena *arena)
{
    return plant_of(arena, "hypertexture", "radius=1,amplitude=0,threshold=0.5625,resolution=60");
}

/* Every texel that is covered lies, by its stack's box and depth, within a voxel of the ball, its
 * normal faces the front, and the outermost ring is empty. */
static void test_slices__of_a_ball_lie_in_the_ball(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct slices_request request = usual(32, 12);
    const struct slices *slices = made(arena, ball(arena), &request);
    double volume = 0;
    for (size_t i = 0; i < 3 * 32; i++) {
        const struct slices_stack *stack = &slices->stacks[i / 32];
        const struct slice *slice = &slices->slices[i];
        if (slice->width > 0)
            assert_true(slice->left > 0 && slice->bottom > 0 && slice->left + slice->width < 32 &&
                        slice->bottom + slice->height < 32);
        float voxel[3];
        for (int k = 0; k < 3; k++)
            voxel[k] = (stack->high_m[k] - stack->low_m[k]) / 32;
        for (int t = 0; t < slice->width * slice->height; t++) {
            size_t texel = slice->first + (size_t)t;
            if (slices->color[texel][3] == 0)
                continue;
            float along[3] = {(float)(slice->left + t % slice->width) + 0.5f,
                              (float)(slice->bottom + t / slice->width) + 0.5f,
                              (float)(i % 32) + (float)slices->depth[texel] / 65535};
            float at[3], facing = 0;
            for (int k = 0; k < 3; k++)
                along[k] = stack->low_m[k] + along[k] * voxel[k];
            for (int c = 0; c < 3; c++) {
                at[c] = along[0] * stack->right[c] + along[1] * stack->up[c] +
                        along[2] * stack->toward[c];
                facing += ((float)slices->normal[texel][c] - 128) / 127 * stack->toward[c];
            }
            double radius =
                sqrt((double)(at[0] * at[0] + (at[1] - 1) * (at[1] - 1) + at[2] * at[2]));
            assert_true(radius < 1 + (double)voxel[0]);
            assert_true(facing > -0.01f);
            volume +=
                (double)slices->color[texel][3] / 255 * (double)(voxel[0] * voxel[1] * voxel[2]);
        }
    }
    assert_float_equal(volume / 3 / (4.18879), 1, 0.06);
    arena_destroy(arena);
}

/* Light along the stack's own direction: the foremost texel of the middle is lit fully, seen from
 * behind the hindmost, which looks away, not at all (bark: the reference's cosine). */
static void test_slices__of_a_ball_are_lit_by_its_normals(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct slices_request request = usual(32, 12);
    struct slices_light lights[2] = {
        {.sun_direction = {0, 0, 1}, .sun_radiance = {2, 2, 2}, .ambient = {0.5f, 0.5f, 0.5f}},
        {.sun_direction = {0, 0, 1},
         .sun_radiance = {2, 2, 2},
         .ambient = {0.5f, 0.5f, 0.5f},
         .from_behind = true}};
    request.lights = lights;
    request.lights_count = 2;
    const struct slices *slices = made(arena, ball(arena), &request);
    double front = 0, back = 0;
    for (int k = 0; k < 32; k++) {
        const struct slice *slice = &slices->slices[k];
        int column = 16 - slice->left, row = 16 - slice->bottom;
        if (column < 0 || row < 0 || column >= slice->width || row >= slice->height)
            continue;
        size_t texel = slice->first + (size_t)(row * slice->width + column);
        if (slices->color[texel][3] < 128)
            continue;
        double albedo = (double)slices->color[texel][0] * (double)slices->albedo_scale;
        front = (double)slices->lit[texel][0] * (double)slices->lit_scale / albedo;
        if (back == 0)
            back = (double)slices->lit[slices->texels_count + texel][0] *
                   (double)slices->lit_scale / albedo;
    }
    assert_float_equal(front, 2.5, 0.1);
    assert_float_equal(back, 0.5, 0.1);
    arena_destroy(arena);
}

static void refused(struct slices_request request, const char *words)
{
    struct arena *arena = arena_create(0);
    struct error error = {0};
    const struct slices *slices = NULL;
    assert_int_equal(slices_create(arena, ball(arena), &request, 1, &slices, &error),
                     STATUS_INVALID);
    if (!strstr(error.text, words))
        fail_msg("'%s' does not say '%s'", error.text, words);
    arena_destroy(arena);
}

static void test_slices__of_pictures_refuse_what_no_grid_has(void **state)
{
    (void)state;
    struct slices_request request = usual(16, 12);
    request.count = 8;
    refused(request, "slices: 8 of 16 x 16 texels; allowed from pictures: as many as texels");
    refused(usual(257, 12), "257 of 257 x 257 texels; allowed");
    refused(usual(16, 65), "slices: views: 65 is outside 0..64");
    static const float aslant[1][3] = {{0.6f, 0.8f, 0}};
    request = usual(16, 12);
    request.directions_count = 1;
    request.directions = aslant;
    refused(request, "direction 0: (0.6, 0.8, 0) is no axis");
}

int main(void)
{
    setenv("TREELINE_CACHE", "off", 1);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_slices__of_pictures_cover_what_the_plant_covers),
        cmocka_unit_test(test_slices__of_a_ball_lie_in_the_ball),
        cmocka_unit_test(test_slices__of_a_ball_are_lit_by_its_normals),
        cmocka_unit_test(test_slices__of_pictures_refuse_what_no_grid_has),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
