/* Pairs of slices fused into one: random texels beside the closed form a + b (1 - a), and what a
 * forest far away shows of them. */
#include "slices_meshes.h"

#include "bake/slices.h"

/* ---- Random texels. ---- */

enum { WIDTH = 13, HEIGHT = 9, STACKS = 2 };

/* Stacks whose slices have rectangles anywhere, some of them empty. */
static struct slices *random_slices(struct arena *arena, int count, uint64_t seed)
{
    struct random random = random_seed(seed, 1);
    struct slices *slices = ARENA_NEW(arena, struct slices);
    *slices = (struct slices){.stacks_count = STACKS,
                              .width_px = WIDTH,
                              .height_px = HEIGHT,
                              .count = count,
                              .albedo_scale = 0.7f};
    slices->stacks = ARENA_ARRAY(arena, struct slices_stack, STACKS);
    slices->slices = ARENA_ARRAY(arena, struct slice, STACKS * (size_t)count);
    for (int i = 0; i < STACKS * count; i++) {
        struct slice *slice = &slices->slices[i];
        slice->first = slices->texels_count;
        slice->width = (int)random_below(&random, WIDTH + 1);
        slice->height = slice->width ? 1 + (int)random_below(&random, HEIGHT) : 0;
        slice->left = (int)random_below(&random, (uint32_t)(WIDTH - slice->width + 1));
        slice->bottom = (int)random_below(&random, (uint32_t)(HEIGHT - slice->height + 1));
        slices->texels_count += (size_t)slice->width * (size_t)slice->height;
    }
    for (int k = 0; k < STACKS; k++)
        slices->stacks[k] = (struct slices_stack){.low_m = {0, 0, -1.0f - (float)k},
                                                  .high_m = {1, 1, 2.0f + (float)k}};
    slices->color = arena_alloc(arena, slices->texels_count, 4);
    slices->normal = arena_alloc(arena, slices->texels_count, 4);
    slices->depth = ARENA_ARRAY(arena, uint16_t, slices->texels_count);
    for (size_t i = 0; i < slices->texels_count; i++) {
        uint32_t kind = random_below(&random, 8);
        uint8_t coverage = (uint8_t)(kind == 0   ? 0
                                     : kind == 1 ? 255
                                                 : 1 + random_below(&random, 254));
        slices->color[i][3] = coverage;
        slices->normal[i][3] = (uint8_t)random_below(&random, 256);
        slices->depth[i] = (uint16_t)random_below(&random, 65536);
        for (int k = 0; k < 3; k++) {
            slices->color[i][k] = (uint8_t)random_below(&random, coverage + 1u);
            slices->normal[i][k] = (uint8_t)(55 + random_below(&random, 147));
        }
    }
    return slices;
}

/* What a slice holds at a place of its picture: nothing outside of its rectangle. */
struct texel {
    double color[3], coverage, normal[3], leaf, depth;
};

static struct texel texel_of(const struct slices *slices, size_t stack, int index, int x, int y)
{
    struct texel texel = {0};
    const struct slice *slice = &slices->slices[stack * (size_t)slices->count + (size_t)index];
    int column = x - slice->left, row = y - slice->bottom;
    if (index >= slices->count || column < 0 || row < 0 || column >= slice->width ||
        row >= slice->height)
        return texel;
    size_t at = slice->first + (size_t)(row * slice->width + column);
    texel.coverage = slices->color[at][3] / 255.0;
    texel.leaf = slices->normal[at][3] / 255.0;
    texel.depth = slices->depth[at] / 65535.0;
    for (int k = 0; k < 3; k++) {
        texel.color[k] = slices->color[at][k] / 255.0;
        texel.normal[k] = (slices->normal[at][k] - 128) / 127.0;
    }
    return texel;
}

/* near over far: what is seen of far is (1 - a) of it. */
static struct texel texel_over(const struct texel *near, const struct texel *far)
{
    double seen = (1 - near->coverage) * far->coverage, all = near->coverage + seen;
    struct texel both = {.coverage = all};
    for (int k = 0; k < 3; k++)
        both.color[k] = near->color[k] + (1 - near->coverage) * far->color[k];
    for (int k = 0; k < 3 && all > 0; k++)
        both.normal[k] = (near->coverage * near->normal[k] + seen * far->normal[k]) / all;
    if (all > 0) {
        both.leaf = (near->coverage * near->leaf + seen * far->leaf) / all;
        both.depth = (near->coverage * near->depth + seen * far->depth) / all;
    }
    return both;
}

static void compare_texel(const struct texel *has, const struct texel *wants)
{
    assert_float_equal(has->coverage, wants->coverage, 0.51 / 255);
    for (int k = 0; k < 3; k++)
        assert_float_equal(has->color[k], wants->color[k], 0.51 / 255);
    if (!(wants->coverage > 0))
        return;
    assert_float_equal(has->leaf, wants->leaf, 0.51 / 255);
    assert_float_equal(has->depth, wants->depth, 1.0 / 65535);
    for (int k = 0; k < 3; k++)
        assert_float_equal(has->normal[k], wants->normal[k], 0.51 / 127);
}

static void test_slices_fused__a_pair_is_the_near_slice_over_the_far_one(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    for (int n = 0; n < 24; n++) {
        int count = 1 + n % 8;
        bool behind = n / 8 == 1;
        const struct slices *slices = random_slices(arena, count, (uint64_t)n);
        const struct slices *fused = slices_fused(arena, slices, behind);
        assert_int_equal(fused->count, (count + 1) / 2);
        for (int place = 0; place < STACKS * WIDTH * HEIGHT * fused->count; place++) {
            int x = place % WIDTH, y = place / WIDTH % HEIGHT, pair = place / (WIDTH * HEIGHT);
            size_t stack = (size_t)(pair / fused->count);
            int index = pair % fused->count;
            struct texel has = texel_of(fused, stack, index, x, y);
            struct texel back = texel_of(slices, stack, 2 * index, x, y);
            struct texel front = {0};
            if (2 * index + 1 < count)
                front = texel_of(slices, stack, 2 * index + 1, x, y);
            back.depth *= 0.5; /* of a slab twice as thick */
            front.depth = 0.5 + 0.5 * front.depth;
            struct texel wants = behind ? texel_over(&back, &front) : texel_over(&front, &back);
            compare_texel(&has, &wants);
        }
        for (int k = 0; k < STACKS; k++) { /* slabs twice as thick, from the same back on */
            const struct slices_stack *box = &slices->stacks[k], *wide = &fused->stacks[k];
            assert_float_equal(wide->low_m[2], box->low_m[2], 1e-6);
            assert_float_equal((wide->high_m[2] - wide->low_m[2]) / (float)fused->count,
                               2 * (box->high_m[2] - box->low_m[2]) / (float)count, 1e-5);
        }
    }
    arena_destroy(arena);
}

/* ---- Through a picture. ---- */

enum { BARS = 124 };
static const float SIDE_M = 6, APART_M = 0.4f;
/* Of the shape's material, whose albedo is 0.5: the front bars', the back bars'. */
static const float tints[2][3] = {{1, 0.5f, 0.2f}, {0.2f, 0.6f, 1}};

/* Two sheets of bars with gaps as wide, one behind the other: upright in front (+z), level behind.
 * Each hides half, both hide 1/2 + 1/2 (1 - 1/2). */
static struct plant *fence(struct arena *arena)
{
    struct mesh *mesh = shape_new(arena, 4 * BARS, MATERIAL_LEAF);
    for (int bar = 0; bar < 2 * BARS; bar++) {
        bool front = bar < BARS;
        float low = SIDE_M * (float)(bar % BARS) / BARS, high = low + 0.5f * SIDE_M / BARS;
        float z = front ? APART_M / 2 : -APART_M / 2, corners[4][3];
        for (int k = 0; k < 4; k++) {
            bool right = k == 1 || k == 2, top = k >= 2;
            corners[k][0] = (front ? (right ? high : low) : (right ? SIDE_M : 0)) - SIDE_M / 2;
            corners[k][1] = (front ? (top ? SIDE_M : 0) : (top ? high : low)) + 0.5f;
            corners[k][2] = z;
        }
        for (int half = 0; half < 2; half++) {
            float triangle[3][3];
            for (int k = 0; k < 3; k++)
                memcpy(triangle[k], corners[k == 0 ? 0 : k + half], sizeof triangle[k]);
            tree_triangle(mesh, (const float(*)[3])triangle, tints[front ? 0 : 1]);
        }
    }
    return shape_plant(arena, mesh, 2);
}

/* Mean of the pixels that lie within the sheets. */
static void mean_within(const struct frame *frame, double mean[4])
{
    enum { HALF = 2 };
    int middle = frame->width_px / 2;
    for (int c = 0; c < 4; c++) {
        mean[c] = 0;
        for (int y = middle - HALF; y < middle + HALF; y++)
            for (int x = middle - HALF; x < middle + HALF; x++)
                mean[c] += (double)frame->rgba[4 * (y * frame->width_px + x) + c] / 16;
    }
}

/* Far away one slice stands for two: seen from the front and from behind. */
static void test_slices_fused__far_away_one_slice_shows_what_two_do(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct scene *scene = tree_scene(arena, fence(arena), 1, 0);
    for (int i = 0; i < 3; i++) {
        scene->sun.radiance[i] = 0;
        scene->ambient[i] = 1;
    }
    for (int n = 0; n < 4; n++) {
        bool behind = n & 1, fused = n & 2;
        struct view view = tree_view(scene, behind ? 3.1415927f : 0, 0, 300, 80);
        struct gl_counters counters;
        struct frame *drawn = tree_draw_as(arena, tree_method("shaded-texels"),
                                           "slices=2,resolution=64,distant=0,near=0,criterion=64",
                                           fused ? LOD_AUTO : LOD_HIGH, TARGET_RGBA32F, scene,
                                           EFFECT_TWO_SIDED | EFFECT_AMBIENT, &view, &counters);
        double mean[4];
        mean_within(drawn, mean);
        assert_int_equal(counters.triangles / 2, fused ? 1 : 2); /* the sky is one triangle more */
        assert_float_equal(mean[3], 0.75, 0.02);
        for (int c = 0; c < 3; c++) {
            double near = 0.5 * (double)tints[behind][c], far = 0.5 * (double)tints[!behind][c];
            assert_float_equal(mean[c], 0.5 * near + 0.25 * far, 0.01);
        }
    }
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_slices_fused__a_pair_is_the_near_slice_over_the_far_one),
        cmocka_unit_test(test_slices_fused__far_away_one_slice_shows_what_two_do),
    };
    setenv("TREELINE_CACHE", "off", 1);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
