/* Slices of plants whose sections are known, and of a small tree beside rays. */
#include "slices_meshes.h"

#include "bake/slices.h"
#include "bake/views.h"
#include "wall/embree.h"

#include <ftw.h>

static const float front[1][3] = {{0, 0, 1}};

/* A request of one stack of square pictures along +z. */
static struct slices_request request_of(int side, int count, int samples)
{
    return (struct slices_request){.directions_count = 1,
                                   .directions = front,
                                   .width_px = side,
                                   .height_px = side,
                                   .count = count,
                                   .samples = samples,
                                   .parts = SLICES_BARK | SLICES_LEAVES};
}

static const struct slices *make(struct arena *arena, struct plant *plant,
                                 const struct slices_request *request)
{
    struct error error;
    const struct slices *slices;
    if (slices_create(arena, plant, request, 2, &slices, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    return slices;
}

static double texel_area_m2(const struct slices *slices, size_t stack)
{
    const struct slices_stack *box = &slices->stacks[stack];
    return ((double)box->high_m[0] - box->low_m[0]) / slices->width_px *
           ((double)box->high_m[1] - box->low_m[1]) / slices->height_px;
}

/* Square metres that a slice covers. */
static double covered_m2(const struct slices *slices, size_t stack, int index)
{
    const struct slice *slice = &slices->slices[stack * (size_t)slices->count + (size_t)index];
    double sum = 0;
    for (size_t i = 0; i < (size_t)slice->width * (size_t)slice->height; i++)
        sum += slices->color[slice->first + i][3] / 255.0;
    return sum * texel_area_m2(slices, stack);
}

static double covered_by_all_m2(const struct slices *slices, size_t stack)
{
    double sum = 0;
    for (int k = 0; k < slices->count; k++)
        sum += covered_m2(slices, stack, k);
    return sum;
}

static void test_slices__a_turned_leaf_covers_its_projection(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    for (int turn = 0; turn < 4; turn++)
        for (int cut = 0; cut < 2; cut++) {
            struct slices_request request = request_of(64, 16, 4);
            float angle = 0.4f * (float)turn;
            request.cut = (enum slices_cut)cut;
            const struct slices *slices = make(arena, shape_square(arena, angle), &request);
            assert_float_equal(covered_by_all_m2(slices, 0), cosf(angle), 0.01);
        }
    arena_destroy(arena);
}

static void test_slices__a_leaf_is_whole_in_the_slice_of_its_centroid(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    /* 0.99 m deep in 9 slabs: its middle is in the fifth. */
    struct plant *plant = shape_square(arena, 1.4f);
    struct slices_request request = request_of(32, 9, 2);
    const struct slices *clipped = make(arena, plant, &request);
    request.cut = SLICES_CENTROID;
    const struct slices *whole = make(arena, plant, &request);
    for (int k = 0; k < 9; k++) {
        assert_true(covered_m2(clipped, 0, k) > 0.01);
        assert_float_equal(covered_m2(clipped, 0, k), cosf(1.4f) / 9, 0.005);
        assert_float_equal(covered_m2(whole, 0, k), k == 4 ? cosf(1.4f) : 0, 0.005);
    }
    arena_destroy(arena);
}

static void test_slices__closed_bark_is_filled(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct slices_request request = request_of(32, 7, 4);
    request.directions = slices_axes;
    request.directions_count = 3;
    const struct slices *bark = make(arena, shape_box(arena, MATERIAL_BARK), &request);
    const struct slices *leaf = make(arena, shape_box(arena, MATERIAL_LEAF), &request);
    static const double faces[3] = {6, 3, 2}; /* m2, seen along z, x, y */
    for (size_t stack = 0; stack < 3; stack++)
        for (int k = 0; k < 7; k++) {
            assert_float_equal(covered_m2(bark, stack, k), faces[stack], 0.02 * faces[stack]);
            double thin = k == 0 || k == 6 ? faces[stack] : 0;
            assert_float_equal(covered_m2(leaf, stack, k), thin, 0.02 * faces[stack]);
        }
    arena_destroy(arena);
}

static void test_slices__a_ball_is_cut_into_discs(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct slices_request request = request_of(64, 10, 4);
    const struct slices *slices = make(arena, shape_ball(arena), &request);
    for (int k = 0; k < 10; k++) {
        double low = -1 + 0.2 * k, high = low + 0.2; /* the widest section of the slab */
        double middle = low <= 0 && high >= 0 ? 0 : fmin(fabs(low), fabs(high));
        assert_float_equal(covered_m2(slices, 0, k), M_PI * (1 - middle * middle), 0.02);
    }
    arena_destroy(arena);
}

/* The value of texel (x, y) of a slice; NULL outside of its rectangle. */
static const uint8_t *texel(const struct slices *slices, uint8_t (*array)[4], int index, int x,
                            int y)
{
    const struct slice *slice = &slices->slices[index];
    x -= slice->left;
    y -= slice->bottom;
    if (x < 0 || y < 0 || x >= slice->width || y >= slice->height)
        return NULL;
    return array[slice->first + (size_t)y * (size_t)slice->width + (size_t)x];
}

/* Between slices the filling shows: in a sheared box its two slanted faces' normals, the back one's
 * mirrored, lie on opposite sides of the view. */
static void test_slices__filling_has_the_normal_of_the_nearer_side(void **state)
{
    (void)state;
    const float shear = 0.5f, side = shear / hypotf(1, shear);
    struct arena *arena = arena_create(0);
    struct slices_request request = request_of(34, 16, 1);
    struct plant *plant = shape_sheared_box(arena, MATERIAL_BARK, shear);
    const struct slices *slices = make(arena, plant, &request);
    const float *low = slices->stacks[0].low_m, *high = slices->stacks[0].high_m;
    int checked[2] = {0, 0};
    for (int i = 2; i < 32; i++)
        for (int k = 0; k < 16; k++) {
            float x = low[0] + ((float)i + 0.5f) * (high[0] - low[0]) / 34;
            float z = low[2] + ((float)k + 0.5f) * (high[2] - low[2]) / 16 - shear * x;
            if (z < 0.01f || z > 0.99f || fabsf(z - 0.5f) < 0.15f)
                continue;
            const uint8_t *normal = texel(slices, slices->normal, k, i, 17);
            assert_non_null(normal);
            assert_float_equal((normal[0] - 128) / 127.0, z > 0.5f ? -side : side, 0.01);
            checked[z > 0.5f]++;
        }
    assert_true(checked[0] > 50 && checked[1] > 50);
    arena_destroy(arena);
}

static void test_slices__bark_seen_from_inside_is_mirrored_and_leaves_are_turned(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct slices_request request = request_of(66, 8, 1);
    const struct slices *ball = make(arena, shape_ball(arena), &request);
    for (int half = 0; half < 2; half++) { /* the shells behind and in front of the middle */
        int index = half ? 4 : 3, checked = 0;
        for (int i = 0; i < 66 * 66; i++) {
            double x = (i % 66 - 32.5) / 32, y = (i / 66.0 - 0.5 / 66 - 32.5) / 32;
            y = (i / 66 - 32.5) / 32;
            double square = 1 - x * x - y * y;
            const uint8_t *normal = texel(ball, ball->normal, index, i % 66, i / 66);
            if (square <= 0.002 || square >= 0.06) /* the slab's bark, not its filling */
                continue;
            const double outward[3] = {x, y, sqrt(square)};
            assert_non_null(normal);
            for (int k = 0; k < 3; k++)
                assert_float_equal((normal[k] - 128) / 127.0, outward[k], 0.03);
            assert_int_equal(normal[3], 0);
            checked++;
        }
        assert_true(checked > 100);
    }
    const float toward[2][3] = {{0, 0, 1}, {0, 0, -1}};
    request.directions = toward;
    request.directions_count = 2;
    const struct slices *leaf = make(arena, shape_square(arena, 0.5f), &request);
    for (size_t stack = 0; stack < 2; stack++) {
        int sign = stack ? -1 : 1, checked = 0;
        const struct slice *from = &leaf->slices[stack * 8];
        for (size_t i = from->first; i < from->first + (size_t)from->width * 8; i++)
            if (leaf->color[i][3]) {
                assert_int_equal(leaf->normal[i][0], 128 + sign * (int)lrintf(127 * sinf(0.5f)));
                assert_int_equal(leaf->normal[i][2], 128 + sign * (int)lrintf(127 * cosf(0.5f)));
                assert_int_equal(leaf->normal[i][3], 255);
                checked++;
            }
        assert_true(checked > 10);
    }
    arena_destroy(arena);
}

/* The tree's parts in Embree, hit by rays that come from the front. */
struct rays {
    struct embree *embree;
    const struct mesh *mesh;
};

static struct rays rays_open(struct arena *arena, const struct mesh *mesh)
{
    struct rays rays = {.mesh = mesh};
    struct error error;
    struct embree_part parts[2];
    static const float still[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    for (int i = 0; i < 2; i++)
        parts[i] = (struct embree_part){.first_triangle = mesh->parts[i].first_triangle,
                                        .triangles_count = mesh->parts[i].triangles_count};
    struct embree_mesh source = {mesh->positions[0],
                                 mesh->vertices_count,
                                 mesh->triangles[0],
                                 mesh->triangles_count,
                                 parts,
                                 2};
    assert_int_equal(embree_create(arena, 2, &rays.embree, &error), STATUS_OK);
    assert_int_equal(embree_add_mesh(rays.embree, &source, &error), STATUS_OK);
    embree_add_instance(rays.embree, 0, still);
    assert_int_equal(embree_commit(rays.embree, &error), STATUS_OK);
    return rays;
}

/* Triangle seen at point (s, t) of the stack's plane; EMBREE_NONE where none is. */
static uint32_t rays_cast(const struct rays *rays, const struct slices_stack *stack, float s,
                          float t)
{
    struct embree_packet packet = {0};
    for (int k = 0; k < 3; k++) {
        packet.origin[k][0] = s * stack->right[k] + t * stack->up[k] + 50 * stack->toward[k];
        packet.direction[k][0] = -stack->toward[k];
    }
    packet.far[0] = INFINITY;
    embree_intersect(rays->embree, &packet, 1, false);
    if (packet.geometry[0] == EMBREE_NONE)
        return EMBREE_NONE;
    return rays->mesh->parts[packet.geometry[0]].first_triangle + packet.primitive[0];
}

static void test_slices__a_stack_seen_from_the_front_is_what_rays_see(void **state)
{
    (void)state;
    enum { SIDE = 128 };
    struct arena *arena = arena_create(0);
    struct mesh *mesh = tree_mesh(arena, 300);
    struct rays rays = rays_open(arena, mesh);
    static const float directions[4][3] = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {0.6f, 0.48f, -0.64f}};
    struct slices_request request = request_of(SIDE, 24, 1);
    request.directions = directions;
    request.directions_count = 4;
    const struct slices *slices = make(arena, plant_from_mesh(arena, "tree", mesh), &request);
    float *texels = ARENA_ARRAY(arena, float, SIDE *SIDE *SLICES_FLOATS);
    float *sum = ARENA_ARRAY(arena, float, SIDE *SIDE *SLICES_FLOATS);
    for (size_t n = 0; n < 4; n++) {
        const struct slices_stack *stack = &slices->stacks[n];
        int others = 0, covered = 0;
        memset(sum, 0, sizeof(float[SIDE * SIDE * SLICES_FLOATS]));
        for (int k = 0; k < 24; k++) {
            slices_expand(slices, n, k, texels);
            slices_fuse(texels, sum, SIDE * SIDE, sum);
        }
        for (int i = 0; i < SIDE * SIDE; i++) {
            float s = ((float)(i % SIDE) + 0.5f) / SIDE, t = ((float)(i / SIDE) + 0.5f) / SIDE;
            uint32_t hit =
                rays_cast(&rays, stack, stack->low_m[0] + s * (stack->high_m[0] - stack->low_m[0]),
                          stack->low_m[1] + t * (stack->high_m[1] - stack->low_m[1]));
            const float *seen = sum + SLICES_FLOATS * i;
            bool leaf = hit != EMBREE_NONE && hit >= mesh->parts[1].first_triangle, same;
            same = seen[3] == (hit != EMBREE_NONE) && seen[7] == leaf;
            for (int k = 0; same && leaf && k < 3; k++) {
                float color =
                    mesh->colors[mesh->triangles[hit][0]][k] * mesh->materials[1].albedo[k];
                same = fabsf(seen[k] * slices->albedo_scale - color) < 0.005f;
            }
            others += !same;
            covered += hit != EMBREE_NONE;
        }
        assert_true(covered > SIDE * SIDE / 10);
        assert_true(others <= SIDE * SIDE / 2000); /* lines that graze an edge */
    }
    embree_destroy(rays.embree);
    arena_destroy(arena);
}

static void test_slices__parts_are_told_apart(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct plant *plant = plant_from_mesh(arena, "tree", tree_mesh(arena, 60));
    struct slices_request request = request_of(32, 8, 2);
    for (unsigned parts = 0; parts < 4; parts++) {
        size_t covered[2] = {0};
        request.parts = parts;
        const struct slices *slices = make(arena, plant, &request);
        for (size_t i = 0; i < slices->texels_count; i++) {
            covered[0] += slices->color[i][3] && slices->normal[i][3] < 255;
            covered[1] += slices->color[i][3] && slices->normal[i][3] > 0;
        }
        assert_int_equal(covered[0] > 0, (parts & SLICES_BARK) != 0);
        assert_int_equal(covered[1] > 0, (parts & SLICES_LEAVES) != 0);
        for (int k = 0; k < 3; k++) /* a box there is, always */
            assert_true(slices->stacks[0].high_m[k] > slices->stacks[0].low_m[k]);
    }
    arena_destroy(arena);
}

static void test_slices__holes_of_a_texture_are_holes(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct mesh *mesh = shape_new(arena, 2, MATERIAL_LEAF);
    static const float corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    struct texture texture = {2, 1, ARENA_ARRAY(arena, float, 8)};
    /* Opaque for 1/4 < u < 3/4 + what bilinear wrapping gives: alpha 1/2 is crossed at u = 1/2 and
     * at 0. */
    static const float rgba[8] = {1, 0.5f, 0.25f, 1, 1, 0.5f, 0.25f, 0};
    memcpy(texture.rgba, rgba, sizeof rgba);
    shape_quad(mesh, corners);
    mesh->materials[0].texture = &texture;
    struct slices_request request = request_of(40, 3, 4);
    const struct slices *slices = make(arena, shape_plant(arena, mesh, 2), &request);
    assert_float_equal(covered_by_all_m2(slices, 0), 0.5, 0.01);
    for (size_t i = 0; i < slices->texels_count; i++)
        if (slices->color[i][3] == 255) {
            assert_float_equal(slices->color[i][0] * slices->albedo_scale / 255, 0.5, 0.003);
            assert_float_equal(slices->color[i][2] * slices->albedo_scale / 255, 0.125, 0.003);
        }
    arena_destroy(arena);
}

static void test_slices__colours_are_lit_as_each_side_sees_them(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    /* The leaf's normal is turned by .5 from +z toward +x. */
    struct plant *leaf = shape_square(arena, 0.5f), *ball = shape_ball(arena);
    struct slices_light lights[8];
    for (int n = 0; n < 8; n++) {
        float angle = n & 4 ? 2.6f : -0.3f;
        lights[n] = (struct slices_light){.sun_direction = {sinf(angle), 0, cosf(angle)},
                                          .sun_radiance = {2, 1, 0.5f},
                                          .ambient = {0.1f, 0.2f, 0.3f},
                                          .two_sided = n & 1,
                                          .from_behind = n & 2};
    }
    struct slices_request request = request_of(40, 1, 4);
    request.lights_count = 8;
    request.lights = lights;
    const struct slices *slices = make(arena, leaf, &request);
    for (int n = 0; n < 8; n++) {
        double d = cos(0.5 - (n & 4 ? 2.6 : -0.3)) * (n & 2 ? -1 : 1);
        d = n & 1 ? fabs(d) : fmax(d, 0);
        size_t checked = 0;
        for (size_t i = 0; i < slices->texels_count; i++) {
            const uint8_t *lit = slices->lit[(size_t)n * slices->texels_count + i];
            assert_int_equal(lit[3], slices->color[i][3]);
            if (lit[3] < 255)
                continue;
            checked++;
            for (int k = 0; k < 3; k++) {
                double radiance = 0.5 * (d * lights[n].sun_radiance[k] + lights[n].ambient[k]);
                assert_float_equal(lit[k] * slices->lit_scale / 255, radiance, 0.005);
            }
        }
        assert_true(checked > 300);
    }
    /* Over a ball's disc, max(0, N.L) has the mean 2/3 where the sun stands behind the eye, 0 where
     * it stands opposite. */
    for (int n = 0; n < 4; n++) {
        lights[n] = (struct slices_light){.sun_direction = {0, 0, n & 1 ? -1 : 1},
                                          .sun_radiance = {1, 1, 1},
                                          .two_sided = true,
                                          .from_behind = n & 2};
        request.lights_count = (size_t)n + 1;
    }
    slices = make(arena, ball, &request);
    for (int n = 0; n < 4; n++) {
        double sum = 0, covered = 0;
        for (size_t i = 0; i < slices->texels_count; i++) {
            const uint8_t *lit = slices->lit[(size_t)n * slices->texels_count + i];
            sum += lit[0] * slices->lit_scale / 0.5;
            covered += lit[3];
        }
        assert_float_equal(sum / covered, n == 0 || n == 3 ? 2.0 / 3 : 0, 0.005);
    }
    arena_destroy(arena);
}

static void test_slices__sizes_from_one_to_the_most_are_made(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct plant *plant = shape_square(arena, 0.7f);
    static const int cases[5][3] = {{1, 1, 8}, {1, 512, 1}, {7, 3, 2}, {8, 1, 3}, {512, 2, 1}};
    for (int n = 0; n < 5; n++) {
        struct slices_request request = request_of(cases[n][0], cases[n][1], cases[n][2]);
        const struct slices *slices = make(arena, plant, &request);
        double tolerance = n == 1 ? 1e-3 : cases[n][0] * cases[n][2] < 20 ? 0.25 : 0.02;
        if (n != 1) /* one line of sight, which meets the leaf */
            assert_float_equal(covered_by_all_m2(slices, 0), cosf(0.7f), tolerance);
        else
            assert_float_equal(covered_by_all_m2(slices, 0), texel_area_m2(slices, 0), tolerance);
    }
    arena_destroy(arena);
}

static void test_slices__a_wrong_request_is_refused_by_name(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct plant *plant = shape_square(arena, 0);
    const struct slices *slices;
    struct error error;
    static const float long_one[1][3] = {{0, 2, 0}};
    for (int n = 0; n < 6; n++) {
        static const char *const names[6] = {"width_px: 0", "height_px: 513", "count: 0",
                                             "samples: 9",  "directions: 0",  "direction 0: (0, 2"};
        struct slices_request request = request_of(16, 4, 1);
        request.width_px = n == 0 ? 0 : 16;
        request.height_px = n == 1 ? 513 : 16;
        request.count = n == 2 ? 0 : 4;
        request.samples = n == 3 ? 9 : 1;
        request.directions_count = n == 4 ? 0 : 1;
        request.directions = n == 5 ? long_one : front;
        assert_int_equal(slices_create(arena, plant, &request, 1, &slices, &error), STATUS_INVALID);
        assert_non_null(strstr(error.text, names[n]));
    }
    arena_destroy(arena);
}

static void same_slices(const struct slices *a, const struct slices *b)
{
    size_t count = a->stacks_count * (size_t)a->count;
    assert_int_equal(a->texels_count, b->texels_count);
    assert_memory_equal(a->stacks, b->stacks, a->stacks_count * sizeof *a->stacks);
    assert_memory_equal(a->slices, b->slices, count * sizeof *a->slices);
    assert_memory_equal(a->color, b->color, a->texels_count * sizeof *a->color);
    assert_memory_equal(a->normal, b->normal, a->texels_count * sizeof *a->normal);
    assert_memory_equal(a->depth, b->depth, a->texels_count * sizeof *a->depth);
}

static int remove_entry(const char *path, const struct stat *status, int kind, struct FTW *walk)
{
    (void)status, (void)kind, (void)walk;
    return remove(path);
}

static void test_slices__neither_threads_nor_the_cache_change_a_byte(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct plant *plant = plant_from_mesh(arena, "tree", tree_mesh(arena, 200));
    struct slices_request request = request_of(48, 16, 3);
    const struct slices *slices[4];
    struct error error;
    char folder[] = "/tmp/treeline-slices-XXXXXX";
    assert_non_null(mkdtemp(folder));
    request.directions = slices_axes;
    request.directions_count = 3;
    request.cut = SLICES_CENTROID;
    for (int n = 0; n < 4; n++) {
        setenv("TREELINE_CACHE", n < 2 ? "off" : folder, 1);
        assert_int_equal(slices_create(arena, plant, &request, n == 0 ? 1 : 4, &slices[n], &error),
                         STATUS_OK);
        same_slices(slices[0], slices[n]);
    }
    setenv("TREELINE_CACHE", "off", 1);
    nftw(folder, remove_entry, 8, FTW_DEPTH | FTW_PHYS);
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_slices__a_turned_leaf_covers_its_projection),
        cmocka_unit_test(test_slices__a_leaf_is_whole_in_the_slice_of_its_centroid),
        cmocka_unit_test(test_slices__closed_bark_is_filled),
        cmocka_unit_test(test_slices__filling_has_the_normal_of_the_nearer_side),
        cmocka_unit_test(test_slices__a_ball_is_cut_into_discs),
        cmocka_unit_test(test_slices__bark_seen_from_inside_is_mirrored_and_leaves_are_turned),
        cmocka_unit_test(test_slices__a_stack_seen_from_the_front_is_what_rays_see),
        cmocka_unit_test(test_slices__parts_are_told_apart),
        cmocka_unit_test(test_slices__holes_of_a_texture_are_holes),
        cmocka_unit_test(test_slices__colours_are_lit_as_each_side_sees_them),
        cmocka_unit_test(test_slices__sizes_from_one_to_the_most_are_made),
        cmocka_unit_test(test_slices__a_wrong_request_is_refused_by_name),
        cmocka_unit_test(test_slices__neither_threads_nor_the_cache_change_a_byte),
    };
    setenv("TREELINE_CACHE", "off", 1);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
