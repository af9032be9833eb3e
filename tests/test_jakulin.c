/* Mixed stacks of foliage around a polygonal trunk: coverage, the order of crossing slices,
 * turning. */
#include "testing_stacks.h"

#include "bake/stack_bake.h"

static int open_fixture(void **state)
{
    return fixture_open(state, "jakulin");
}

/* From the horizon to straight above. */
static const float elevations[] = {0, 0.5f, 1, 1.3f, 1.5707f};
enum { ELEVATIONS = 5 };

static void check_coverage(struct fixture *f, const char *options, double allowed)
{
    struct scene *scene = tree_scene(f->arena, f->plant, 1, 1);
    struct studio studio;
    studio_open(&studio, f->arena, f->method, options, LOD_HIGH, scene, lit);
    for (int e = 0; e < ELEVATIONS; e++)
        for (int a = 0; a < 3; a++) {
            struct view view = tree_view(scene, 0.1f + (float)a * 1.9f, elevations[e], 300, 9);
            struct frame *truth = tree_reference(f->arena, scene, lit, &view);
            struct frame *drawn = studio_draw(&studio, &view);
            double covered = tree_mean(truth, 3), ratio = tree_mean(drawn, 3) / covered;
            double off = tree_difference(drawn, truth, false) / covered;
            if (fabs(ratio - 1) > allowed || off > 0.45)
                fail_msg("azimuth %d, elevation %d: %.3f of the coverage, off by %.3f", a, e, ratio,
                         off);
        }
    studio_close(&studio);
}

static void test_jakulin__coverage_is_the_plants_from_all_sides(void **state)
{
    check_coverage(*state, "", 0.12);
}

static void test_jakulin__in_exact_order_coverage_is_the_plants(void **state)
{
    check_coverage(*state, "order=exact,directions=2", 0.2);
}

static void test_jakulin__a_plant_of_bark_alone_is_drawn_as_polygons_draw_it(void **state)
{
    struct fixture *f = *state;
    struct mesh *mesh = tree_mesh(f->arena, 10);
    mesh->parts_count = 1;
    mesh->triangles_count = mesh->parts[0].triangles_count;
    struct plant *trunk = plant_from_mesh(f->arena, "trunk", mesh);
    struct scene *scene = tree_scene(f->arena, trunk, 1, 1);
    struct view view = tree_view(scene, 0.3f, 0.2f, 60, 9);
    struct frame *drawn = tree_draw(f->arena, f->method, "", scene, lit, &view, NULL);
    struct frame *truth = tree_draw(f->arena, tree_method("polygons"), "", scene, lit, &view, NULL);
    assert_true(tree_mean(truth, 3) > 0.01);
    assert_memory_equal(drawn->rgba, truth->rgba, 4 * TREE_PIXELS * sizeof(float));
}

/* Without its trunk: with one sample a pixel that one's own edges jump. */
static struct plant *crown_alone(struct arena *arena)
{
    struct mesh *mesh = tree_mesh(arena, 400);
    uint32_t bark = mesh->parts[0].triangles_count;
    mesh->triangles += bark;
    mesh->triangles_count -= bark;
    mesh->parts[0] = mesh->parts[1];
    mesh->parts_count = 1;
    mesh->parts[0].first_triangle = 0;
    for (uint32_t i = 0; i <= mesh->parts[0].elements_count; i++)
        mesh->parts[0].element_first[i] -= bark;
    return plant_from_mesh(arena, "crown", mesh);
}

/* Two stacks side by side change places as the eye turns; no step may stand out. */
static void test_jakulin__turning_around_a_crown_and_rising_above_it_never_jump(void **state)
{
    enum { STEPS = 24 };
    struct fixture *f = *state;
    struct scene *scene = tree_scene(f->arena, crown_alone(f->arena), 1, 1);
    struct studio studio;
    studio_open(&studio, f->arena, f->method, "", LOD_HIGH, scene, lit);
    for (int rising = 0; rising < 2; rising++) {
        struct frame *last = NULL;
        double sum = 0, most = 0;
        for (int i = 0; i <= STEPS; i++) {
            float angle = (float)i * (float)M_PI / 96;
            struct view view =
                tree_view(scene, rising ? 0.3f : angle, rising ? angle : 0.2f, 300, 9);
            struct frame *frame = studio_draw(&studio, &view);
            double step = last ? tree_difference(frame, last, false) : 0;
            sum += step;
            most = fmax(most, step);
            last = frame;
        }
        assert_true(sum > 0);
        if (!(most < 2 * sum / STEPS))
            fail_msg("rising %d: a step of %g, their mean is %g", rising, most, sum / STEPS);
    }
    studio_close(&studio);
}

/* ---- The order of crossing slices, ray by ray. ---- */

enum { WIDTH_PX = 64, HEIGHT_PX = 64, STACKS = 3 };

/* Two vertical stacks and a horizontal one. */
static const int counts[STACKS] = {5, 7, 4};

static float dot(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* A stack whose slices' normal is turned by an angle, 2 m wide, 2 m deep, 3 m high, seen from an
 * eye on the side of its front. */
static void stack_place(float angle, int count, struct stack_tree *tree)
{
    float u[3] = {cosf(angle), 0, -sinf(angle)}, w[3] = {-sinf(angle), 0, -cosf(angle)};
    *tree = (struct stack_tree){.v_m = {0, 3, 0}, .count = (float)count};
    for (int i = 0; i < 3; i++) {
        tree->u_m[i] = 2 * u[i];
        tree->w_m[i] = 2 * w[i] / (float)count;
        tree->base_m[i] = -u[i] - w[i];
    }
}

/* A horizontal one about them, seen from above or from below. */
static void stack_lay(bool below, int count, struct stack_tree *tree)
{
    *tree = (struct stack_tree){.base_m = {-1.5f, below ? 0 : 3, 1.5f},
                                .u_m = {3, 0, 0},
                                .v_m = {0, 0, -3},
                                .w_m = {0, (below ? 3.0f : -3.0f) / (float)count, 0},
                                .count = (float)count};
}

/* Where a ray meets a slice: the distance, and the place along its width and height in texels. */
static bool meets(const struct stack_tree *tree, float slice, const float eye[3],
                  const float ray[3], float *distance, float texel[2])
{
    float plane[3], at[3];
    for (int i = 0; i < 3; i++)
        plane[i] = tree->base_m[i] + (slice + 0.5f) * tree->w_m[i] - eye[i];
    *distance = dot(plane, tree->w_m) / dot(ray, tree->w_m);
    for (int i = 0; i < 3; i++)
        at[i] = *distance * ray[i] - plane[i];
    texel[0] = WIDTH_PX * dot(at, tree->u_m) / dot(tree->u_m, tree->u_m);
    texel[1] = HEIGHT_PX * dot(at, tree->v_m) / dot(tree->v_m, tree->v_m);
    return texel[0] > 0 && texel[0] < WIDTH_PX && texel[1] > 0 && texel[1] < HEIGHT_PX;
}

/* A quad on a ray: 1 met, 0 missed, -1 so near its border that a cut, rounded to half a texel,
 * decides. */
static int quad_met(const struct stack_quad *quad, const struct stack_tree *trees,
                    const float eye[3], const float ray[3], float *distance)
{
    float texel[2];
    int met = meets(&trees[quad->tree], quad->slice, eye, ray, distance, texel);
    for (int axis = 0; axis < 2 && met; axis++) {
        float low = 0.5f * ((float)quad->rect[axis] - 1);
        float high = 0.5f * ((float)quad->rect[axis + 2] - 1);
        if (fabsf(texel[axis] - low) < 0.6f || fabsf(texel[axis] - high) < 0.6f)
            return -1;
        met = texel[axis] >= low && texel[axis] < high;
    }
    return met;
}

/* One ray; whether it tells anything and met all of the first `count` stacks. */
static bool ray_meets_in_order(const struct stack_quad *quads, size_t quads_count,
                               const struct stack_tree *trees, int count, const float eye[3],
                               const float ray[3])
{
    int hits[STACKS] = {0}, wanted[STACKS] = {0};
    float last = INFINITY, distance, texel[2];
    bool all = true;
    for (size_t i = 0; i < quads_count; i++) {
        int met = quad_met(&quads[i], trees, eye, ray, &distance);
        if (met < 0)
            return false;
        if (!met)
            continue;
        hits[quads[i].tree]++;
        if (distance > last)
            fail_msg("%g m after %g m", (double)distance, (double)last);
        last = distance;
    }
    for (int k = 0; k < count; k++) {
        for (int i = 0; i < counts[k]; i++)
            wanted[k] += meets(&trees[k], (float)i, eye, ray, &distance, texel);
        assert_int_equal(hits[k], wanted[k]);
        all = all && hits[k] > 0;
    }
    return all;
}

static void test_jakulin__every_ray_meets_crossing_slices_once_and_from_far_to_near(void **state)
{
    struct fixture *f = *state;
    struct stack_array array = {.width_px = WIDTH_PX, .height_px = HEIGHT_PX};
    struct stack stack = {.arrays = &array};
    struct stack_level levels[STACKS];
    struct stack_side sides[STACKS] = {
        {.frame.toward = {0, 0, 1}}, {.frame.toward = {1, 0, 0}}, {.frame.toward = {0, 1, 0}}};
    struct stack_tree trees[STACKS];
    struct stack_part parts[STACKS];
    struct stack_quad *quads = ARENA_ARRAY(f->arena, struct stack_quad, STACK_CROSSED_MOST);
    struct random random = random_seed(3, 1);
    for (int k = 0; k < STACKS; k++) {
        levels[k] = (struct stack_level){.count = counts[k]};
        levels[k].slices = ARENA_ARRAY(f->arena, struct slice, (size_t)counts[k]);
        for (int i = 0; i < counts[k]; i++)
            levels[k].slices[i] = (struct slice){.width = WIDTH_PX, .height = HEIGHT_PX};
        parts[k] = (struct stack_part){.side = &sides[k], .level = &levels[k]};
        parts[k].drawn = (float)counts[k];
    }
    int met[2] = {0, 0};
    for (int trial = 0; trial < 6000; trial++) {
        int count = trial % 3 ? 3 : 2;
        bool below = trial % 3 == 1;
        float turn = 6.2831853f * random_float(&random), away = 4 + 20 * random_float(&random);
        float rise = random_float(&random), up = count == 2 ? 1 + 4 * rise : 3 + 12 * rise;
        float eye[3] = {away * sinf(turn), below ? 3 - up : up, away * cosf(turn)};
        stack_place(turn - 0.9f * random_float(&random), counts[0], &trees[0]);
        stack_place(turn + 0.1f + 0.6f * random_float(&random), counts[1], &trees[1]);
        stack_lay(below, counts[2], &trees[2]);
        float ray[3] = {1.4f * (random_float(&random) - 0.5f) - eye[0],
                        3 * random_float(&random) - eye[1],
                        1.4f * (random_float(&random) - 0.5f) - eye[2]};
        size_t made = stack_crossed_quads(&stack, parts, count, trees, 0, quads);
        assert_true(made <= (5 + 1) * (7 + 1) * (count == 2 ? 1 : 4 + 1));
        met[count - 2] += ray_meets_in_order(quads, made, trees, count, eye, ray);
    }
    assert_true(met[0] > 300 && met[1] > 300);
}

/* ---- The same in pictures. ---- */

/* A crown 6 m wide, 4 m high, 3 m deep along (1, 0, 1), halfway between two directions of two:
 * small leaves spread evenly, in front red, behind green. */
static struct plant *two_halves(struct arena *arena)
{
    enum { LEAVES = 2500 };
    struct mesh *mesh = tree_mesh(arena, LEAVES);
    struct random random = random_seed(11, 1);
    for (uint32_t k = mesh->parts[1].first_triangle; k < mesh->triangles_count; k++) {
        float across = 6 * random_float(&random) - 3, deep = 3 * random_float(&random) - 1.5f;
        float middle[3] = {(deep + across) * (float)M_SQRT1_2, 2 + 4 * random_float(&random),
                           (deep - across) * (float)M_SQRT1_2};
        for (int corner = 0; corner < 3; corner++) {
            uint32_t vertex = mesh->triangles[k][corner];
            for (int i = 0; i < 3; i++)
                mesh->positions[vertex][i] = middle[i] + 0.4f * (random_float(&random) - 0.5f);
            mesh->colors[vertex][0] = deep > 0;
            mesh->colors[vertex][1] = deep <= 0;
            mesh->colors[vertex][2] = 0;
        }
    }
    mesh->materials[1].albedo[0] = mesh->materials[1].albedo[1] = 0.5f;
    mesh_bounds(mesh);
    return plant_from_mesh(arena, "two halves", mesh);
}

/* Of what the middle of the crown shows, the share of its back; and what is seen through it. */
static double share_of_back(struct fixture *f, const char *options, double *through)
{
    struct scene *scene = tree_scene(f->arena, two_halves(f->arena), 1, 1);
    for (int c = 0; c < 3; c++)
        scene->sun.radiance[c] = 0;
    struct view view = tree_view(scene, (float)M_PI_4, 0, 300, 9);
    struct frame *frame = tree_draw(f->arena, f->method, options, scene, lit, &view, NULL);
    double sums[4] = {0, 0, 0, 0};
    for (int y = 38; y < 58; y++)
        for (int x = 26; x < 70; x++)
            for (int c = 0; c < 4; c++)
                if (x < 44 || x > 51) /* the trunk is no leaf */
                    sums[c] += frame->rgba[4 * (y * TREE_WIDTH + x) + c] / (20 * 36);
    *through = 1 - sums[3];
    sums[0] /= scene->ambient[0];
    sums[1] /= scene->ambient[1];
    return sums[1] / (sums[0] + sums[1]);
}

/* Of a crown that lets T through, each half of it the root: of the back T^1/2 (1 - T^1/2) is seen
 * past the front. One stack drawn over the other, of half its depth each, and of that half a
 * half before the other: with t = T^1/4 it is t (1 - t) (1 + t^2), three times as much. Leaves that
 * stand in clumps of a texel let more through in some places than in others. */
static void test_jakulin__only_in_exact_order_the_front_hides_the_back(void **state)
{
    struct fixture *f = *state;
    for (int exact = 0; exact < 2; exact++) {
        double through,
            shown = share_of_back(f,
                                  exact ? "directions=2,slices=16,resolution=8,order=exact"
                                        : "directions=2,slices=16,resolution=8,order=mixed",
                                  &through);
        double t = pow(through, 0.25);
        double wanted = (exact ? t * t * (1 - t * t) : t * (1 - t) * (1 + t * t)) / (1 - through);
        if (fabs(shown / wanted - 1) > 0.3 || through > 0.1)
            fail_msg("exact %d: %.3f of what is seen is the back, not %.3f; %.3f is seen through",
                     exact, shown, wanted, through);
    }
}

/* The camera goes round a crown, away from one of the directions, and asks for more slices all the
 * way. */
static void test_jakulin__smooth_numbers_of_slices_do_not_jump(void **state)
{
    enum { STEPS = 48 };
    static const char *const orders[2] = {"mixed", "exact"};
    struct fixture *f = *state;
    struct scene *scene = tree_scene(f->arena, crown_alone(f->arena), 1, 1);
    for (int order = 0; order < 2; order++) {
        double worst[2] = {0, 0};
        for (int smooth = 0; smooth < 2; smooth++) {
            struct studio studio;
            struct frame *last = NULL;
            const char *options = arena_printf(
                f->arena, "resolution=64,criterion=1,order=%s,smooth=%d", orders[order], smooth);
            studio_open(&studio, f->arena, f->method, options, LOD_AUTO, scene, lit);
            for (int step = 0; step <= STEPS; step++) {
                struct view view = tree_view(scene, 0.05f + 0.004f * (float)step, 0, 300, 14);
                struct frame *drawn = studio_draw(&studio, &view);
                worst[smooth] = fmax(worst[smooth], last ? tree_rmse(last, drawn) : 0);
                last = drawn;
            }
            studio_close(&studio);
        }
        if (!(worst[1] > 0 && worst[1] < 0.7 * worst[0]))
            fail_msg("order %s: the picture changes by %g at a time, smoothly by %g", orders[order],
                     worst[0], worst[1]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_jakulin__coverage_is_the_plants_from_all_sides),
        cmocka_unit_test(test_jakulin__in_exact_order_coverage_is_the_plants),
        cmocka_unit_test(test_jakulin__a_plant_of_bark_alone_is_drawn_as_polygons_draw_it),
        cmocka_unit_test(test_jakulin__turning_around_a_crown_and_rising_above_it_never_jump),
        cmocka_unit_test(test_jakulin__every_ray_meets_crossing_slices_once_and_from_far_to_near),
        cmocka_unit_test(test_jakulin__only_in_exact_order_the_front_hides_the_back),
        cmocka_unit_test(test_jakulin__smooth_numbers_of_slices_do_not_jump),
    };
    return cmocka_run_group_tests_name("jakulin", tests, open_fixture, close_fixture);
}
