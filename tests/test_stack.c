/* Which stack shows a tree, with how many slices, and in which order: against the criteria's closed
 * forms, on a stack made by hand. */
#include "testing.h"

#include "bake/stack_bake.h"

#include <math.h>
#include <string.h>

enum { FINEST = 64 };

/* A plant in a box of 2 x 2 x 2 m around (0, 1, 0), 64 slices along +z, +x and +y. */
struct fixture {
    struct arena *arena;
    struct stack stack;
    struct view view;
    struct instance instance;
};

static int open_fixture(void **state)
{
    struct arena *arena = arena_create(0);
    struct fixture *f = *state = ARENA_NEW(arena, struct fixture);
    static const float axes[3][3][3] = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                        {{0, 0, -1}, {0, 1, 0}, {1, 0, 0}},
                                        {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}};
    f->arena = arena;
    f->stack.request.bake.directions_count = 3;
    f->stack.request.rectangles = true;
    f->stack.request.texel_px = 1;
    f->stack.plants_count = f->stack.arrays_count = 1;
    f->stack.arrays = ARENA_NEW(arena, struct stack_array);
    *f->stack.arrays = (struct stack_array){.width_px = 64, .height_px = 64, .levels = 7};
    struct stack_plant *plant = f->stack.plants = ARENA_NEW(arena, struct stack_plant);
    *plant = (struct stack_plant){.albedo_scale = 1, .texel_m = 2.0f / 64, .bound = {1, 1.7f}};
    plant->sides = ARENA_ARRAY(arena, struct stack_side, 3);
    for (int d = 0; d < 3; d++) {
        struct stack_side *side = &plant->sides[d];
        memcpy(side->frame.right, axes[d][0], sizeof side->frame.right);
        memcpy(side->frame.up, axes[d][1], sizeof side->frame.up);
        memcpy(side->frame.toward, axes[d][2], sizeof side->frame.toward);
        for (int axis = 0; axis < 3; axis++) {
            float middle = axes[d][axis][1];
            side->frame.low_m[axis] = middle - 1;
            side->frame.high_m[axis] = middle + 1;
        }
        for (int count = FINEST; count > 0; count /= 2) {
            struct stack_level *level = &side->levels[side->levels_count++];
            level->count = count;
            level->low_m = side->frame.low_m[2];
            level->high_m = side->frame.high_m[2];
            level->slices = ARENA_ARRAY(arena, struct slice, (size_t)count);
            for (int k = 0; k < count; k++)
                level->slices[k] = (struct slice){.left = 8, .bottom = 8, .width = 9, .height = 9};
        }
    }
    f->instance.scale = 1;
    f->instance.stretch = 1;
    f->view = (struct view){.fov_y_rad = 0.5f,
                            .height_px = 600,
                            .width_px = 800,
                            .near_m = 0.1f,
                            .forward = {0, 0, -1}};
    return 0;
}

static int close_fixture(void **state)
{
    struct fixture *f = *state;
    arena_destroy(f->arena);
    return 0;
}

/* The eye in a direction from the box's middle, its plant's axes. */
static void look(struct fixture *f, const float direction[3], float distance_m)
{
    for (int i = 0; i < 3; i++)
        f->view.eye_m[i] = (i == 1) + direction[i] * distance_m;
}

static void unit(float azimuth, float elevation, float direction[3])
{
    direction[0] = cosf(elevation) * sinf(azimuth);
    direction[1] = sinf(elevation);
    direction[2] = cosf(elevation) * cosf(azimuth);
}

static void test_stack__the_side_that_faces_the_eye_most_is_chosen(void **state)
{
    struct fixture *f = *state;
    for (int k = 0; k < 200; k++) {
        float direction[3];
        struct stack_part parts[PARTS_MOST];
        unit(0.1f + 0.31f * (float)k, 1.5f * sinf((float)k), direction);
        look(f, direction, 100);
        assert_int_equal(stack_parts(&f->stack, &f->view, LOD_AUTO, &f->instance, parts), 1);
        const float *toward = parts[0].side->frame.toward;
        float facing =
            direction[0] * toward[0] + direction[1] * toward[1] + direction[2] * toward[2];
        for (int i = 0; i < 3; i++)
            assert_true(fabsf(facing) > fabsf(direction[i]) - 1e-4f);
        assert_true(parts[0].behind == (facing < 0));
    }
}

/* A tree that is turned shows what an unturned one shows to an eye that went round it. */
static void test_stack__turning_the_tree_is_going_round_it(void **state)
{
    struct fixture *f = *state;
    for (int k = 0; k < 24; k++) {
        float direction[3], angle = 0.2f + 0.26f * (float)k;
        struct stack_part turned, around;
        unit(0.3f, 0.2f, direction);
        look(f, direction, 50);
        f->instance.rotation_rad = angle;
        stack_parts(&f->stack, &f->view, LOD_AUTO, &f->instance, &turned);
        unit(0.3f - angle, 0.2f, direction);
        look(f, direction, 50);
        f->instance.rotation_rad = 0;
        stack_parts(&f->stack, &f->view, LOD_AUTO, &f->instance, &around);
        assert_true(turned.side == around.side && turned.behind == around.behind);
    }
}

/* The least power of two above F H sin(a) / (Z d1), formulas of Meyer and Neyret 1998. */
static void test_stack__criterion_c2_gives_the_least_number_that_is_enough(void **state)
{
    struct fixture *f = *state;
    f->stack.request.criterion_px = 1;
    int seen = 0;
    for (int k = 0; k < 300; k++) {
        float direction[3], angle = 0.02f + 0.0025f * (float)k;
        float distance = 15 * expf(0.018f * (float)k);
        struct stack_part part;
        unit(angle, 0, direction);
        look(f, direction, distance);
        stack_parts(&f->stack, &f->view, LOD_AUTO, &f->instance, &part);
        float focal = 300 / tanf(0.25f), spread = asinf(1.7f / distance);
        float wanted = focal * 2 * sinf(angle + spread) / distance;
        int count = FINEST;
        while (count > 1 && (float)(count / 2) > wanted * 1.001f)
            count /= 2;
        if ((float)(count / 2) > wanted * 0.999f && (float)(count / 2) < wanted * 1.001f)
            continue;
        assert_int_equal(part.level->count, count);
        seen |= count;
    }
    assert_true((seen & 16) && (seen & 8) && (seen & 2));
    f->stack.request.criterion_px = 0;
}

static void test_stack__levels_of_detail_have_eight_and_all_slices(void **state)
{
    struct fixture *f = *state;
    float direction[3];
    struct stack_part part;
    unit(0.5f, 0, direction);
    f->stack.request.criterion_px = 1;
    for (int far = 0; far < 2; far++) {
        look(f, direction, far ? 2000 : 20);
        stack_parts(&f->stack, &f->view, LOD_LOW, &f->instance, &part);
        assert_int_equal(part.level->count, 8);
        stack_parts(&f->stack, &f->view, LOD_HIGH, &f->instance, &part);
        assert_int_equal(part.level->count, FINEST);
        stack_parts(&f->stack, &f->view, LOD_INTERMEDIATE, &f->instance, &part);
        assert_int_equal(part.level->count, far ? 8 : FINEST);
    }
    f->stack.request.criterion_px = 0;
}

/* What a part has of the tree's optical depth is shared out whole, and changes little by little. */
static void test_stack__shares_add_up_to_one_and_do_not_jump(void **state)
{
    struct fixture *f = *state;
    float last[3][STACK_LEVELS] = {{0}};
    f->stack.request.criterion_px = 1;
    f->stack.request.smooth = true;
    for (int k = 0; k < 4000; k++) {
        float direction[3], share[3][STACK_LEVELS] = {{0}}, sum = 0;
        struct stack_part parts[PARTS_MOST];
        unit(0.0004f * (float)k, 0.3f, direction);
        look(f, direction, 100 + 0.1f * (float)k);
        int count = stack_parts(&f->stack, &f->view, LOD_AUTO, &f->instance, parts);
        for (int i = 0; i < count; i++) {
            share[parts[i].side - f->stack.plants->sides][parts[i].level - parts[i].side->levels] +=
                parts[i].share;
            sum += parts[i].share;
        }
        assert_true(fabsf(sum - 1) < 1e-5f);
        for (int d = 0; d < 3 && k > 0; d++)
            for (int l = 0; l < STACK_LEVELS; l++)
                if (fabsf(share[d][l] - last[d][l]) > 0.02f)
                    fail_msg("step %d: the share of side %d, level %d goes from %g to %g", k, d, l,
                             (double)last[d][l], (double)share[d][l]);
        memcpy(last, share, sizeof last);
    }
    f->stack.request.criterion_px = 0;
    f->stack.request.smooth = false;
}

/* Slices come farthest first, whichever side is seen, at the places of the box. */
static void test_stack__quads_come_farthest_first(void **state)
{
    struct fixture *f = *state;
    static struct stack_quad quads[STACK_QUADS_MOST];
    for (int k = 0; k < 6; k++) {
        float direction[3] = {0.1f, 0.1f, 0.1f};
        direction[k % 3] = k < 3 ? 1 : -1;
        look(f, direction, 30);
        struct stack_part part;
        struct stack_tree tree;
        stack_parts(&f->stack, &f->view, LOD_HIGH, &f->instance, &part);
        stack_tree_fill(&f->stack, &f->view, &f->instance, &part, &tree);
        size_t count = stack_quads(&f->stack, &part, 1, &tree, 5, quads);
        assert_int_equal(count, FINEST);
        float farther = INFINITY;
        for (size_t i = 0; i < count; i++) {
            float away = 0;
            for (int axis = 0; axis < 3; axis++) {
                float at = tree.base_m[axis] + (quads[i].slice + 0.5f) * tree.w_m[axis] +
                           0.5f * (tree.u_m[axis] + tree.v_m[axis]);
                assert_true(fabsf(at - (axis == 1)) < 1.0001f); /* within the box */
                away += (at - f->view.eye_m[axis]) * -direction[axis];
            }
            assert_int_equal(quads[i].tree, 5);
            assert_true(away < farther);
            farther = away;
            assert_true(quads[i].rect[0] <= 17 && quads[i].rect[2] >= 35);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_stack__the_side_that_faces_the_eye_most_is_chosen),
        cmocka_unit_test(test_stack__turning_the_tree_is_going_round_it),
        cmocka_unit_test(test_stack__criterion_c2_gives_the_least_number_that_is_enough),
        cmocka_unit_test(test_stack__levels_of_detail_have_eight_and_all_slices),
        cmocka_unit_test(test_stack__shares_add_up_to_one_and_do_not_jump),
        cmocka_unit_test(test_stack__quads_come_farthest_first),
    };
    return cmocka_run_group_tests_name("stack", tests, open_fixture, close_fixture);
}
