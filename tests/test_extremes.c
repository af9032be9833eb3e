/* Methods of slices and voxels at their ends, each beside the ray-traced reference: seen along and
 * between their directions, from above and below; of one slice and of the most; lit along and
 * against every axis; of leaves that hide nothing and of solid matter; trees through and within
 * each other; the eye within a crown and at a trunk. Every picture is checked for NaN and coverage
 * in [0, 1] besides. */
#include "testing_tree.h"

static const unsigned lit = EFFECT_TWO_SIDED | EFFECT_AMBIENT;

/* A method, and its options for these tests. */
static const struct subject {
    const char *name, *options;
} subjects[] = {
    {"jakulin", "slices=16,resolution=64"},       {"texels", "slices=32,resolution=64,turns=1"},
    {"shaded-texels", "slices=32,resolution=64"}, {"ray-texels", "resolution=64"},
    {"ray-texels-gl", "resolution=64"},
};
enum { SUBJECTS = sizeof subjects / sizeof *subjects, SHOTS_MAX = 18 };

/* How a picture differs from the reference's, in parts of it. */
struct fault {
    double coverage; /* more or less in all */
    double outline;  /* mean absolute difference of coverage over boxes of 8 x 8 pixels */
    double light;    /* of what is covered */
};

struct shot {
    struct view view;
    struct frame *truth;
    const struct fault *limits; /* one a subject */
};

/* A scene with views of it and the reference's pictures, made once for all methods. */
struct stand {
    struct arena *arena;
    struct scene *scene;
    size_t shots_count;
    struct shot shots[SHOTS_MAX];
};

static struct stand stand_of(struct arena *arena, const struct mesh *mesh, size_t trees)
{
    struct plant *plant = plant_from_mesh(arena, "tree", mesh);
    return (struct stand){.arena = arena, .scene = tree_scene(arena, plant, trees, 0.9f)};
}

static void stand_add(struct stand *stand, const struct view *view,
                      const struct fault limits[SUBJECTS])
{
    struct shot *shot = &stand->shots[stand->shots_count++];
    shot->view = *view;
    shot->truth = tree_reference(stand->arena, stand->scene, lit, view);
    shot->limits = limits;
}

/* From 30 m, at angles. */
static void stand_look(struct stand *stand, float azimuth_rad, float elevation_rad,
                       const struct fault limits[SUBJECTS])
{
    struct view view = tree_view(stand->scene, azimuth_rad, elevation_rad, 30, 9);
    stand_add(stand, &view, limits);
}

static void subject_open(struct studio *studio, struct arena *arena, const struct subject *subject,
                         const char *options, const struct scene *scene)
{
    const struct method *method = tree_method(subject->name);
    if (!(method->traits & TRAIT_CPU)) {
        studio_open(studio, arena, method, options, LOD_HIGH, scene, lit);
        return;
    }
    *studio = (struct studio){.method = method,
                              .workspace = {.arena = arena,
                                            .effects = lit,
                                            .lod = LOD_HIGH,
                                            .format = TARGET_RGBA32F,
                                            .threads = 2}};
    studio->workspace.error = &studio->error;
    studio->target = (struct target){.width_px = TREE_WIDTH,
                                     .height_px = TREE_HEIGHT,
                                     .format = TARGET_RGBA32F,
                                     .pixels = ARENA_ARRAY(arena, float, 4 * TREE_PIXELS)};
    void *values = arena_alloc(arena, 1, method->options_size);
    options_default(method->options, values);
    if (options_parse(method->options, options, values, &studio->error) ||
        method->prepare(&studio->workspace, scene, values, &studio->state))
        fail_msg("%s", studio->error.text);
}

static struct frame *subject_draw(struct studio *studio, const struct view *view)
{
    if (studio->workspace.gl)
        return studio_draw(studio, view);
    struct frame *frame = frame_create(studio->workspace.arena, TREE_WIDTH, TREE_HEIGHT, false);
    if (studio->method->draw(&studio->workspace, studio->state, view, &studio->target))
        fail_msg("%s", studio->error.text);
    memcpy(frame->rgba, studio->target.pixels, 4 * sizeof(float) * TREE_PIXELS);
    if (frame_check(frame, &studio->error))
        fail_msg("%s", studio->error.text);
    return frame;
}

static double outline_fault(const struct frame *frame, const struct frame *truth)
{
    enum { BOX = 8 };
    double sum = 0;
    for (int y = 0; y < TREE_HEIGHT; y += BOX)
        for (int x = 0; x < TREE_WIDTH; x += BOX) {
            double more = 0;
            for (int i = 0; i < BOX * BOX; i++) {
                int at = 4 * ((y + i / BOX) * TREE_WIDTH + x + i % BOX) + 3;
                more += (double)frame->rgba[at] - (double)truth->rgba[at];
            }
            sum += fabs(more);
        }
    return sum / TREE_PIXELS / tree_mean(truth, 3);
}

static struct fault fault_of(const struct frame *frame, const struct frame *truth)
{
    double drawn = tree_mean(frame, 3), covered = tree_mean(truth, 3);
    double light = tree_mean(frame, 1) / drawn, wanted = tree_mean(truth, 1) / covered;
    return (struct fault){drawn / covered - 1, outline_fault(frame, truth), light / wanted - 1};
}

static void shot_judge(const struct shot *shot, size_t subject, struct studio *studio)
{
    const struct fault fault = fault_of(subject_draw(studio, &shot->view), shot->truth);
    const struct fault *limit = &shot->limits[subject];
    if (!(fabs(fault.coverage) <= limit->coverage && fault.outline <= limit->outline &&
          fabs(fault.light) <= limit->light))
        fail_msg("%s from %.2f, %.2f, %.2f: coverage %+.3f (%.2f), outline %.3f (%.2f), light "
                 "%+.3f (%.2f)",
                 subjects[subject].name, (double)shot->view.eye_m[0], (double)shot->view.eye_m[1],
                 (double)shot->view.eye_m[2], fault.coverage, limit->coverage, fault.outline,
                 limit->outline, fault.light, limit->light);
}

/* All shots by the first methods, each with options or its own ones; one context at a time. */
static void stand_judge(struct stand *stand, const char *const *options, size_t subjects_count)
{
    for (size_t s = 0; s < subjects_count; s++) {
        struct studio studio;
        struct arena *arena = arena_create(0);
        subject_open(&studio, arena, &subjects[s], options ? options[s] : subjects[s].options,
                     stand->scene);
        for (size_t i = 0; i < stand->shots_count; i++)
            shot_judge(&stand->shots[i], s, &studio);
        if (studio.workspace.gl)
            studio_close(&studio);
        arena_destroy(arena);
    }
    arena_destroy(stand->arena);
}

/* Along and between directions. Limits are those of 16 to 32 slices and 64 voxels. Between their
 * directions slices show gaps and take another share of light. */
static void look_around(struct stand *stand)
{
    static const struct fault level[SUBJECTS] = {{0.09, 0.1, 0.09},
                                                 {0.1, 0.25, 0.26},
                                                 {0.1, 0.18, 0.15},
                                                 {0.1, 0.12, 0.09},
                                                 {0.12, 0.13, 0.08}},
                              between[SUBJECTS] = {{0.09, 0.13, 0.06},
                                                   {0.35, 0.37, 0.2},
                                                   {0.28, 0.3, 0.06},
                                                   {0.1, 0.12, 0.09},
                                                   {0.08, 0.12, 0.09}},
                              steep[SUBJECTS] = {{0.22, 0.22, 0.07},
                                                 {0.13, 0.22, 0.09},
                                                 {0.12, 0.13, 0.08},
                                                 {0.08, 0.1, 0.05},
                                                 {0.08, 0.09, 0.05}},
                              above[SUBJECTS] = {{0.08, 0.09, 0.06},
                                                 {0.08, 0.08, 0.06},
                                                 {0.08, 0.08, 0.06},
                                                 {0.08, 0.09, 0.06},
                                                 {0.1, 0.13, 0.06}};
    stand_look(stand, 0, 0, level);
    stand_look(stand, 0.39f, 0, level);
    stand_look(stand, 0.785f, 0, level);
    stand_look(stand, 1.5708f, 0, level);
    stand_look(stand, 0.4f, 0.4f, level);
    stand_look(stand, 0.785f, 0.785f, between);
    stand_look(stand, 0.4f, 1.2f, steep);
    stand_look(stand, 1.2f, -0.6f, steep);
    stand_look(stand, 0, 1.5708f, above);
}

/* The sun along and against each axis. */
static void light_around(struct stand *stand)
{
    static const struct fault limits[SUBJECTS] = {{0.08, 0.08, 0.07},
                                                  {0.05, 0.16, 0.13},
                                                  {0.05, 0.12, 0.13},
                                                  {0.08, 0.1, 0.05},
                                                  {0.05, 0.08, 0.05}};
    for (int k = 0; k < 6; k++) {
        struct view view = tree_view(stand->scene, 0.5f, 0.25f, 30, 9);
        memset(view.sun_direction, 0, sizeof view.sun_direction);
        view.sun_direction[k / 2] = k % 2 ? -1 : 1;
        stand_add(stand, &view, limits);
    }
}

/* In the crown, out of it and at the trunk; within the trunk. */
static void look_from_within(struct stand *stand)
{
    static const struct fault limits[SUBJECTS] = {{0.01, 0.02, 0.01},
                                                  {0.01, 0.02, 0.01},
                                                  {0.01, 0.02, 0.01},
                                                  {0.26, 0.6, 0.1},
                                                  {0.26, 0.75, 0.16}},
                              within[SUBJECTS] = {{0.001, 0.001, 0.02},
                                                  {0.001, 0.001, 0.02},
                                                  {0.001, 0.001, 0.02},
                                                  {0.001, 0.001, 0.02},
                                                  {0.001, 0.001, 0.02}};
    static const float looks[][2][3] = {{{0.7f, 4.5f, 0.2f}, {3, 4.7f, -2}},
                                        {{0.7f, 4.5f, 0.2f}, {0, 2, 0}},
                                        {{0, 2, 0}, {1, 2.2f, 0.6f}}};
    for (size_t i = 0; i < 3; i++) {
        struct view view;
        stand->scene->camera.fov_y_rad = 1;
        view_look_at(stand->scene, looks[i][0], looks[i][1], &view);
        stand_add(stand, &view, i < 2 ? limits : within);
    }
}

static void test_extremes__a_tree_is_as_traced_from_every_side_in_every_light(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct stand stand = stand_of(arena, tree_mesh(arena, 300), 1);
    look_around(&stand);
    light_around(&stand);
    look_from_within(&stand);
    stand_judge(&stand, NULL, SUBJECTS);
}

/* The trunk is five pixels wide: a voxel more or less at its sides is a fifth. */
static void test_extremes__leaves_that_hide_nothing_leave_the_trunk(void **state)
{
    (void)state;
    static const struct fault limits[SUBJECTS] = {{0.16, 0.17, 0.05},
                                                  {0.27, 0.27, 0.16},
                                                  {0.27, 0.27, 0.15},
                                                  {0.18, 0.19, 0.2},
                                                  {0.27, 0.29, 0.2}};
    struct arena *arena = arena_create(0);
    struct mesh *mesh = tree_mesh(arena, 300);
    struct texture *clear = ARENA_NEW(arena, struct texture);
    *clear = (struct texture){1, 1, ARENA_ARRAY(arena, float, 4)};
    mesh->uvs = arena_alloc(arena, mesh->vertices_count, sizeof *mesh->uvs);
    mesh->materials[1].texture = clear;
    struct stand stand = stand_of(arena, mesh, 1);
    stand_look(&stand, 0, 0, limits);
    stand_look(&stand, 0.5f, 0.4f, limits);
    stand_judge(&stand, NULL, SUBJECTS);
}

/* A closed ball of bark, 2 m in radius about (0, 3.5, 0). */
static struct mesh *ball_mesh(struct arena *arena)
{
    enum { AROUND = 24, UP = 12 };
    struct mesh *mesh = tree_mesh(arena, 2 * AROUND * UP);
    mesh->triangles_count = mesh->vertices_count = 0;
    static const float white[3] = {1, 1, 1};
    for (int k = 0; k < AROUND * UP; k++) {
        float corners[4][3];
        for (int c = 0; c < 4; c++) {
            float a = (float)(k % AROUND + (c == 1 || c == 2)) * 6.2831853f / AROUND;
            float b = (float)(k / AROUND + (c > 1)) * 3.1415927f / UP;
            const float p[3] = {2 * sinf(b) * sinf(a), 3.5f - 2 * cosf(b), 2 * sinf(b) * cosf(a)};
            memcpy(corners[c], p, sizeof p);
        }
        const float halves[2][3][3] = {{{corners[0][0], corners[0][1], corners[0][2]},
                                        {corners[1][0], corners[1][1], corners[1][2]},
                                        {corners[2][0], corners[2][1], corners[2][2]}},
                                       {{corners[0][0], corners[0][1], corners[0][2]},
                                        {corners[2][0], corners[2][1], corners[2][2]},
                                        {corners[3][0], corners[3][1], corners[3][2]}}};
        if (k / AROUND) /* at the lower pole the first half has no area */
            tree_triangle(mesh, halves[0], white);
        if (k / AROUND < UP - 1)
            tree_triangle(mesh, halves[1], white);
    }
    mesh->parts_count = mesh->materials_count = 1;
    mesh->parts[0].triangles_count = (uint32_t)mesh->triangles_count;
    mesh_bounds(mesh);
    return mesh;
}

/* Many slices share the ball's edge, and what each covers of it adds up: a texel more all around.
 */
static void test_extremes__a_solid_ball_is_solid_from_every_side(void **state)
{
    (void)state;
    static const struct fault limits[SUBJECTS] = {{0.01, 0.02, 0.02},
                                                  {0.1, 0.1, 0.06},
                                                  {0.1, 0.1, 0.06},
                                                  {0.01, 0.08, 0.05},
                                                  {0.07, 0.09, 0.05}};
    struct arena *arena = arena_create(0);
    struct stand stand = stand_of(arena, ball_mesh(arena), 1);
    stand_look(&stand, 0, 0, limits);
    stand_look(&stand, 0.785f, 0.6f, limits);
    stand_look(&stand, 0.4f, 1.5708f, limits);
    stand_judge(&stand, NULL, SUBJECTS);
}

static void test_extremes__trees_in_each_other_hide_what_they_ought_to(void **state)
{
    (void)state;
    static const struct fault limits[SUBJECTS] = {{0.05, 0.08, 0.05},
                                                  {0.06, 0.15, 0.26},
                                                  {0.06, 0.12, 0.13},
                                                  {0.05, 0.08, 0.09},
                                                  {0.04, 0.08, 0.09}};
    static const char *const options[SUBJECTS] = {
        "slices=16,resolution=64", "slices=32,resolution=64,turns=16", "slices=32,resolution=64",
        "resolution=64", "resolution=64"};
    struct arena *arena = arena_create(0);
    struct stand stand = stand_of(arena, tree_mesh(arena, 300), 4);
    static const struct instance places[] = {
        {.position_m = {0, 0, 0}, .scale = 1, .stretch = 1},
        {.position_m = {0.8f, 0, -0.5f}, .rotation_rad = 2, .scale = 1, .stretch = 1},
        {.position_m = {-0.7f, 0, 0.6f}, .rotation_rad = 4, .scale = 0.9f, .stretch = 1},
        {.position_m = {0.5f, 2.5f, 0.2f}, .rotation_rad = 1, .scale = 0.4f, .stretch = 1}};
    memcpy(stand.scene->instances, places, sizeof places);
    stand_look(&stand, 0.1f, 0.1f, limits);
    stand_look(&stand, 0.8f, 0.6f, limits);
    stand_judge(&stand, options, SUBJECTS);
}

/* One slice is exact from straight in front; one voxel covers as much as the tree, somewhere in its
 * box. All leaves of one slice fill its texels, and at a slant those that turn away hide as much,
 * so jakulin, which draws it along two directions, covers more. */
static void test_extremes__one_slice_shows_the_tree_and_one_voxel_as_much(void **state)
{
    (void)state;
    static const struct fault front[SUBJECTS] = {{0.07, 0.09, 0.05},
                                                 {0.02, 0.06, 0.03},
                                                 {0.02, 0.06, 0.03},
                                                 {0.06, 1.6, 0.05},
                                                 {0.06, 1.6, 0.05}},
                              aside[SUBJECTS] = {{0.1, 0.23, 0.12},
                                                 {0.08, 0.28, 0.21},
                                                 {0.08, 0.27, 0.15},
                                                 {0.07, 1.5, 0.05},
                                                 {0.07, 1.5, 0.05}};
    static const char *const options[SUBJECTS] = {"slices=1", "slices=1,turns=1", "slices=1",
                                                  "resolution=1", "resolution=1"};
    struct arena *arena = arena_create(0);
    struct stand stand = stand_of(arena, tree_mesh(arena, 300), 1);
    stand_look(&stand, 0, 0, front);
    stand_look(&stand, 0.4f, 0.3f, aside);
    stand_judge(&stand, options, SUBJECTS);
}

/* A leaf in one of 512 slices is thinner than a texel. */
static void test_extremes__the_most_slices_show_the_tree(void **state)
{
    (void)state;
    static const struct fault limits[SUBJECTS] = {
        {0.08, 0.1, 0.07}, {0.2, 0.2, 0.22}, {0.2, 0.2, 0.12}};
    static const char *const options[] = {"slices=32,resolution=64",
                                          "slices=512,resolution=64,samples=2,turns=1",
                                          "slices=512,resolution=64,samples=2"};
    struct arena *arena = arena_create(0);
    struct stand stand = stand_of(arena, tree_mesh(arena, 300), 1);
    stand_look(&stand, 0.4f, 0.3f, limits);
    stand_judge(&stand, options, sizeof options / sizeof *options);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_extremes__a_tree_is_as_traced_from_every_side_in_every_light),
        cmocka_unit_test(test_extremes__one_slice_shows_the_tree_and_one_voxel_as_much),
        cmocka_unit_test(test_extremes__the_most_slices_show_the_tree),
        cmocka_unit_test(test_extremes__leaves_that_hide_nothing_leave_the_trunk),
        cmocka_unit_test(test_extremes__a_solid_ball_is_solid_from_every_side),
        cmocka_unit_test(test_extremes__trees_in_each_other_hide_what_they_ought_to),
    };
    return cmocka_run_group_tests_name("extremes", tests, NULL, NULL);
}
