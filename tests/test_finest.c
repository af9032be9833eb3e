/* The finest that is offered, 512 along each side: it is baked and drawn, takes the memory that it
 * says, and errs no more than 256. */
#include "slices_meshes.h"

#include "bake/slices.h"
#include "bake/voxels.h"

static const unsigned lit = EFFECT_TWO_SIDED | EFFECT_AMBIENT;

/* The texels of a stack of so many slices of a square leaf of 1 m2 that stands askew: each slice
 * holds an upright strip of it. */
static double strips_area_m2(struct arena *arena, int side, size_t *texels_count, size_t *bytes)
{
    struct slices_request request = {.directions_count = 1,
                                     .directions = slices_axes,
                                     .width_px = side,
                                     .height_px = side,
                                     .count = side,
                                     .samples = 1,
                                     .parts = SLICES_LEAVES};
    const struct slices *slices;
    struct error error = {0};
    struct plant *plant = shape_square(arena, 0.7853982f);
    size_t before = arena_used_bytes(arena);
    if (slices_create(arena, plant, &request, 2, &slices, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    *bytes = arena_used_bytes(arena) - before;
    *texels_count = slices->texels_count;
    assert_int_equal(slices->count, side);
    double sum = 0;
    for (int k = 0; k < side; k++) { /* two columns fewer than slices: some slices hold none */
        assert_in_range(slices->slices[k].width, 0, 2);
        assert_int_equal(slices->slices[k].height, slices->slices[k].width ? side - 2 : 0);
    }
    for (size_t i = 0; i < slices->texels_count; i++)
        sum += slices->color[i][3] / 255.0;
    const struct slices_stack *box = &slices->stacks[0];
    return sum * (double)(box->high_m[0] - box->low_m[0]) *
           (double)(box->high_m[1] - box->low_m[1]) / side / side;
}

static void test_finest__five_hundred_and_twelve_cubed_slices_hold_the_leaf(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    size_t texels[2], bytes[2];
    for (int k = 0; k < 2; k++) {
        int side = k ? SLICES_MOST : SLICES_MOST / 2;
        /* a quarter of a right angle askew it hides the cosine of its area */
        assert_float_equal(strips_area_m2(arena, side, &texels[k], &bytes[k]), sqrt(0.5), 1e-3);
        /* colour, normal, depth of a texel; of a slice its place */
        size_t least = 10 * texels[k] + (size_t)side * sizeof(struct slice);
        assert_in_range(bytes[k], least, least + 4096);
    }
    /* as many strips as slices, each as high as the picture: four times the texels */
    assert_float_equal((double)texels[1] / (double)texels[0], 4, 0.05);
    arena_destroy(arena);
}

/* The lopsided tree, so slender that 512 voxels along it are cheap; as high as in tree_view. */
static struct plant *slender(struct arena *arena)
{
    struct mesh *mesh = tree_mesh(arena, 300);
    for (size_t i = 0; i < mesh->vertices_count; i++) {
        mesh->positions[i][0] *= 0.08f;
        mesh->positions[i][2] *= 0.08f;
    }
    for (size_t i = 0; i < mesh->triangles_count; i++) {
        const float *p[3];
        float e[2][3], n[3];
        for (int k = 0; k < 3; k++)
            p[k] = mesh->positions[mesh->triangles[i][k]];
        for (int k = 0; k < 3; k++) {
            e[0][k] = p[1][k] - p[0][k];
            e[1][k] = p[2][k] - p[0][k];
        }
        glm_vec3_crossn(e[0], e[1], n);
        for (int k = 0; k < 3; k++)
            memcpy(mesh->normals[mesh->triangles[i][k]], n, sizeof n);
    }
    mesh_bounds(mesh);
    return plant_from_mesh(arena, "slender", mesh);
}

static void test_finest__voxels_take_four_bytes_a_cell_and_sixteen_where_something_is(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct error error = {0};
    const struct voxels *voxels;
    size_t before = arena_used_bytes(arena), cells = 0;
    struct plant *plant = slender(arena);
    before = arena_used_bytes(arena);
    if (voxels_of_plant(arena, plant, VOXELS_RESOLUTION_MAX, &voxels, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    size_t bytes = arena_used_bytes(arena) - before;
    assert_in_range(voxels->levels[0].size[1], VOXELS_RESOLUTION_MAX - 1, VOXELS_RESOLUTION_MAX);
    for (uint32_t k = 0; k < voxels->levels_count; k++) {
        const uint32_t *size = voxels->levels[k].size;
        cells += (size_t)size[0] * size[1] * size[2];
    }
    assert_true(voxels->voxels_count > 5000);
    size_t stated = 4 * cells + 16 * (size_t)voxels->voxels_count + sizeof *voxels;
    assert_in_range(bytes, stated, stated + stated / 8);
    arena_destroy(arena);
}

static struct frame *marched(struct arena *arena, const char *options, const struct scene *scene,
                             const struct view *view)
{
    const struct method *method = tree_method("ray-texels");
    struct error error = {0};
    struct workspace workspace = {
        .arena = arena, .error = &error, .effects = lit, .lod = LOD_HIGH, .threads = 2};
    void *values = arena_alloc(arena, 1, method->options_size), *made;
    struct frame *frame = frame_create(arena, view->width_px, view->height_px, false);
    struct target target = {.width_px = view->width_px,
                            .height_px = view->height_px,
                            .format = TARGET_RGBA32F,
                            .pixels = frame->rgba};
    options_default(method->options, values);
    if (options_parse(method->options, options, values, &error) ||
        method->prepare(&workspace, scene, values, &made) ||
        method->draw(&workspace, made, view, &target))
        fail_msg("%s", error.text);
    return frame;
}

/* Near enough that a voxel is larger than a pixel. */
static void test_finest__five_hundred_and_twelve_err_no_more_than_half_as_many(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct scene *scene = tree_scene(arena, slender(arena), 1, 0.6f);
    struct view view = tree_view(scene, 0.4f, 0.1f, 30, 1.5f);
    struct frame *truth = tree_reference(arena, scene, lit, &view);
    static const char *const options[2] = {"resolution=256", "resolution=512"};
    double off[2], covered = 0;
    for (int k = 0; k < 2; k++) {
        struct frame *drawn = marched(arena, options[k], scene, &view);
        off[k] = tree_difference(drawn, truth, false);
        covered = tree_mean(drawn, 3) / tree_mean(truth, 3);
    }
    if (off[1] > 0.8 * off[0] || fabs(covered - 1) > 0.05)
        fail_msg("coverage is off by %.4f, with half as many by %.4f; %.3f of the whole", off[1],
                 off[0], covered);
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_finest__five_hundred_and_twelve_cubed_slices_hold_the_leaf),
        cmocka_unit_test(test_finest__voxels_take_four_bytes_a_cell_and_sixteen_where_something_is),
        cmocka_unit_test(test_finest__five_hundred_and_twelve_err_no_more_than_half_as_many),
    };
    setenv("TREELINE_CACHE", "off", 1);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
