/* Needles are solid: every method that draws a conifer from its mesh lights them on the outside
 * alone, as the tracer does its round ones, also where leaves are lit on both sides; and what
 * stands for far ones. */
#include "pictures.h"
#include "testing_tree.h"

#include "bake/prune.h"
#include "plant/conifer.h"

static const unsigned lit = EFFECT_TWO_SIDED;

/* A stem in a cylinder of twigs that stick out of it to all sides. */
static struct conifer *brush(struct arena *arena)
{
    enum { TWIGS = 24 };
    struct conifer *conifer = ARENA_NEW(arena, struct conifer);
    struct error error = {0};
    *conifer = (struct conifer){.branches_count = 1,
                                .branches = ARENA_NEW(arena, struct conifer_branch),
                                .twigs_count = TWIGS,
                                .twigs = ARENA_ARRAY(arena, struct conifer_twig, TWIGS),
                                .needle_albedo = {0.3f, 0.6f, 0.2f},
                                .bark_albedo = {0.3f, 0.2f, 0.1f}};
    *conifer->branches = (struct conifer_branch){
        .to_m = {0, 7, 0}, .radius_from_m = 0.1f, .radius_to_m = 0.05f, .twigs_count = TWIGS};
    for (int k = 0; k < TWIGS; k++) {
        float turn = 2.4f * (float)k;
        conifer->twigs[k] = (struct conifer_twig){
            .base_m = {0.1f * cosf(turn), 1 + 0.23f * (float)k, 0.1f * sinf(turn)},
            .axis = {0.96f * cosf(turn), 0.28f, 0.96f * sinf(turn)},
            .length_m = 1.6f,
            .axis_radius_m = 0.01f,
            .cones_count = 8,
            .spacing_m = 0.2f,
            .needles_count = 7,
            .needle_length_m = 0.4f,
            .needle_radius_m = 0.015f,
            .needle_angle_rad = 0.8f,
            .azimuth_rad = (float)k,
            .azimuth_step_rad = 0.9f};
    }
    assert_int_equal(conifer_finish(conifer, &error), STATUS_OK);
    return conifer;
}

/* Mean radiance of what is covered. */
static double light_of(const struct frame *frame)
{
    return tree_mean(frame, 1) / tree_mean(frame, 3);
}

/* A method, and the span of the picture at the tree: from far it may draw something else. */
static const struct subject {
    const char *name, *options;
    float span_m;
} subjects[] = {
    {"polygons", "", 9},
    {"polygons", "", 40},
    {"billboards", "alpha=blend,resolution=64", 9},
    {"cross-quads", "resolution=64", 9},
    {"texels", "slices=8,resolution=32,turns=1", 9},
    {"shaded-texels", "slices=8,resolution=32", 9},
    {"jakulin", "slices=8,resolution=32", 9},
    {"ray-texels", "resolution=32", 9},
    {"ray-texels-gl", "resolution=32", 9},
};

static void test_needles__are_lit_on_their_outside_alone_by_every_method(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    /* toward the sun one sees little of what it reaches; leaves would be 2 to 3 times as bright */
    struct scene *scene =
        tree_scene(arena, plant_from_conifer(arena, "brush", brush(arena)), 1, 2.2f);
    for (size_t k = 0; k < sizeof subjects / sizeof *subjects; k++) {
        const struct subject *s = &subjects[k];
        struct view view = tree_view(scene, 0, 0.1f, 300, s->span_m);
        struct setting setting = {.method = s->name,
                                  .options = s->options,
                                  .effects = lit,
                                  .lod = LOD_AUTO,
                                  .format = TARGET_RGBA32F};
        struct picture picture = picture_draw(arena, scene, &view, &setting);
        struct frame frame = {
            .width_px = view.width_px, .height_px = view.height_px, .rgba = picture.rgba};
        double truth = light_of(tree_reference(arena, scene, lit, &view));
        if (!(fabs(light_of(&frame) / truth - 1) < 0.35))
            fail_msg("%s over %g m: %.4f, traced %.4f", s->name, (double)s->span_m,
                     light_of(&frame), truth);
    }
    arena_destroy(arena);
}

/* What stands for needles has half of their surface, each faces as a side does, and all of them
 * together every way. */
static void test_prune__makes_triangles_of_half_its_surface_of_a_needle(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct conifer *conifer = brush(arena);
    const struct mesh *mesh = conifer_mesh(arena, conifer);
    const struct mesh_part *needles = &mesh->parts[1];
    const struct prune *prune = prune_create(arena, mesh, 1);
    double surface = 0, area = 0, count = 0, mean[3] = {0, 0, 0};
    for (uint32_t t = 0; t < needles->triangles_count; t++)
        surface += mesh_triangle_area(mesh, needles->first_triangle + t);
    for (size_t i = 0; i < prune->count; i++) {
        const struct prune_vertex *v = &prune->vertices[3 * i];
        if (v->normal[3] == 0)
            continue;
        assert_int_equal(v->normal[3], -INT16_MAX);
        double e[2][3], square = 0, along = 0, length = 0;
        for (int k = 0; k < 2; k++)
            for (int axis = 0; axis < 3; axis++)
                e[k][axis] = (double)v[k + 1].position_m[axis] - (double)v->position_m[axis];
        for (int axis = 0; axis < 3; axis++) {
            double c = e[0][(axis + 1) % 3] * e[1][(axis + 2) % 3] -
                       e[0][(axis + 2) % 3] * e[1][(axis + 1) % 3];
            square += c * c;
            along += c * v->normal[axis] / 32767;
            length += pow(v->normal[axis] / 32767.0, 2);
            mean[axis] += v->normal[axis] / 32767.0;
        }
        assert_true(fabs(length - 1) < 1e-3);
        assert_true(along > 0.99 * sqrt(square));
        area += sqrt(square) / 2;
        count++;
    }
    assert_true(count == 2 * (double)conifer->needles_count);
    assert_true(fabs(area / surface - 0.5) < 1e-3);
    for (int axis = 0; axis < 3; axis++)
        assert_true(fabs(mean[axis]) / count < 0.03);
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_needles__are_lit_on_their_outside_alone_by_every_method),
        cmocka_unit_test(test_prune__makes_triangles_of_half_its_surface_of_a_needle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
