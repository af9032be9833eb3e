/* Generated plants and the checks of meshes: counts, closed bark, leaves, repeatability, options.
 */
#include "testing.h"

#include "base/hash.h"
#include "base/option.h"
#include "plant/grow.h"
#include "plant/normals.h"
#include "plant/plant.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct mesh *built(struct arena *arena, const char *generator, const char *options)
{
    struct error error = {0};
    struct plant *plant;
    const struct mesh *mesh = NULL;
    if (plant_generated(arena, generator, options, &plant, &error) != STATUS_OK ||
        plant_mesh(plant, &mesh, &error) != STATUS_OK)
        fail_msg("%s %s: %s", generator, options ? options : "", error.text);
    return mesh;
}

static double area_of(const struct mesh *mesh, uint32_t triangle)
{
    const uint32_t *t = mesh->triangles[triangle];
    double c[3];
    triangle_cross(mesh->positions[t[0]], mesh->positions[t[1]], mesh->positions[t[2]], c);
    return sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]) / 2;
}

static double area_of_leaves(const struct mesh *mesh)
{
    double area = 0;
    for (size_t i = mesh->parts[1].first_triangle; i < mesh->triangles_count; i++)
        area += area_of(mesh, (uint32_t)i);
    return area;
}

static void test_poplar__has_the_papers_triangles_whatever_the_seed(void **state)
{
    (void)state;
    const char *const options[] = {NULL, "seed=2", "seed=77", "height=12", "leaf_length=0.05"};
    for (size_t i = 0; i < sizeof options / sizeof *options; i++) {
        struct arena *arena = arena_create(0);
        assert_int_equal(built(arena, "poplar", options[i])->triangles_count, 98286);
        arena_destroy(arena);
    }
}

static void test_oak__has_about_a_hundred_thousand_triangles(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    assert_int_equal(built(arena, "oak", NULL)->triangles_count, 100000);
    arena_destroy(arena);
}

static void test_triangles__are_as_many_as_asked_less_an_odd_one(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    assert_int_equal(built(arena, "poplar", "triangles=50001")->triangles_count, 50000);
    assert_int_equal(built(arena, "oak", "triangles=250000")->triangles_count, 250000);
    arena_destroy(arena);
}

static void test_generators__make_valid_meshes_of_the_size_asked_for(void **state)
{
    (void)state;
    const struct {
        const char *generator, *options;
        double height, width;
    } cases[] = {{"poplar", NULL, 20, 3.4},
                 {"poplar", "seed=5,height=30", 30, 3.4},
                 {"poplar", "width=5", 20, 5},
                 {"oak", NULL, 15, 16},
                 {"oak", "seed=9", 15, 16},
                 {"oak", "height=8,width=7", 8, 7},
                 {"oak", "height=12,width=18", 12, 18}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct arena *arena = arena_create(0);
        const struct mesh *mesh = built(arena, cases[i].generator, cases[i].options);
        struct error error = {0};
        if (mesh_check(mesh, &error) != STATUS_OK)
            fail_msg("%s", error.text);
        assert_float_equal(mesh->minimum_m[1], 0, 1e-6);
        assert_float_equal(mesh->maximum_m[1], cases[i].height, 0.05 * cases[i].height);
        double width = ((double)(mesh->maximum_m[0] - mesh->minimum_m[0]) +
                        (double)(mesh->maximum_m[2] - mesh->minimum_m[2])) /
                       2;
        assert_float_equal(width, cases[i].width, 0.12 * cases[i].width);
        arena_destroy(arena);
    }
}

/* Directed edges of the bark, sorted. */
static int compare_u64(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

static uint32_t root_of(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i)
        i = parent[i] = parent[parent[i]];
    return i;
}

/* Sorts vertices by place; equal places stand side by side. */
static int compare_places(const void *a, const void *b, void *positions)
{
    float(*p)[3] = positions;
    return memcmp(p[*(const uint32_t *)a], p[*(const uint32_t *)b], sizeof *p);
}

/* For each vertex one that stands for all at its place. */
static uint32_t *weld(const struct mesh *mesh)
{
    size_t count = mesh->vertices_count;
    uint32_t *order = malloc(count * sizeof *order), *place = malloc(count * sizeof *place);
    for (size_t i = 0; i < count; i++)
        order[i] = (uint32_t)i;
    qsort_r(order, count, sizeof *order, compare_places, mesh->positions);
    for (size_t i = 0; i < count; i++) {
        bool same = i > 0 && compare_places(&order[i], &order[i - 1], mesh->positions) == 0;
        place[order[i]] = same ? place[order[i - 1]] : order[i];
    }
    free(order);
    return place;
}

/* Each tube is one component: its border is one ring, and the volume that it and the ring's disc
 * hold is positive when its triangles are counter-clockwise from outside. */
static void check_tubes(const struct mesh *mesh)
{
    size_t count = mesh->parts[0].triangles_count, vertices = mesh->vertices_count;
    uint32_t *place = weld(mesh);
    uint64_t *edges = malloc(3 * count * sizeof *edges);
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            uint64_t a = place[mesh->triangles[i][k]], b = place[mesh->triangles[i][(k + 1) % 3]];
            edges[3 * i + (size_t)k] = a << 32 | b;
        }
    qsort(edges, 3 * count, sizeof *edges, compare_u64);
    uint32_t *parent = malloc(vertices * sizeof *parent);
    size_t *border = calloc(vertices, sizeof *border);
    double(*middle)[3] = calloc(vertices, sizeof *middle),
    *volume = calloc(vertices, sizeof *volume);
    for (size_t i = 0; i < vertices; i++)
        parent[i] = (uint32_t)i;
    for (size_t i = 0; i < 3 * count; i++)
        parent[root_of(parent, (uint32_t)(edges[i] >> 32))] = root_of(parent, (uint32_t)edges[i]);
    for (size_t i = 0; i < 3 * count; i++) {
        assert_true(i == 0 || edges[i] != edges[i - 1]);
        uint64_t back = edges[i] << 32 | edges[i] >> 32;
        if (bsearch(&back, edges, 3 * count, sizeof *edges, compare_u64))
            continue;
        uint32_t vertex = (uint32_t)edges[i], root = root_of(parent, vertex);
        border[root]++;
        for (int k = 0; k < 3; k++)
            middle[root][k] += (double)mesh->positions[vertex][k];
    }
    for (size_t i = 0; i < count; i++) {
        const uint32_t *t = mesh->triangles[i];
        uint32_t root = root_of(parent, place[t[0]]);
        double cross[3], *m = middle[root];
        triangle_cross(mesh->positions[t[0]], mesh->positions[t[1]], mesh->positions[t[2]], cross);
        for (int k = 0; k < 3; k++)
            volume[root] +=
                cross[k] / 6 * ((double)mesh->positions[t[0]][k] - m[k] / (double)border[root]);
    }
    for (size_t i = 0; i < vertices; i++)
        if (parent[i] == i && volume[i] != 0) {
            assert_true(border[i] == 4 || border[i] == 8 || border[i] == 16);
            assert_true(volume[i] > 0);
        }
    free(edges), free(parent), free(border), free(middle), free(volume), free(place);
}

static void test_bark__is_closed_but_for_each_stems_foot_and_faces_outward(void **state)
{
    (void)state;
    const char *const generators[] = {"poplar", "oak"};
    for (int i = 0; i < 2; i++) {
        struct arena *arena = arena_create(0);
        check_tubes(built(arena, generators[i], NULL));
        arena_destroy(arena);
    }
}

static void test_normals__lie_on_the_outer_side_of_their_triangles(void **state)
{
    (void)state;
    const char *const generators[] = {"poplar", "oak"};
    for (int g = 0; g < 2; g++) {
        struct arena *arena = arena_create(0);
        const struct mesh *mesh = built(arena, generators[g], NULL);
        size_t wrong = 0, bark = mesh->parts[0].triangles_count;
        for (size_t i = 0; i < mesh->triangles_count; i++) {
            const uint32_t *t = mesh->triangles[i];
            double c[3];
            triangle_cross(mesh->positions[t[0]], mesh->positions[t[1]], mesh->positions[t[2]], c);
            double length = sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
            for (int k = 0; k < 3; k++) {
                const float *n = mesh->normals[t[k]];
                double along =
                    (c[0] * (double)n[0] + c[1] * (double)n[1] + c[2] * (double)n[2]) / length;
                if (i >= bark && along < 0.998)
                    fail_msg("leaf triangle %zu is not flat: %g", i, along);
                wrong += i < bark && along < 0.1;
            }
        }
        /* At sharp bends of a gnarled limb a smooth normal may leave a triangle. */
        if (wrong * 200 >= bark * 3)
            fail_msg("%s: %zu of %zu corners", generators[g], wrong, 3 * bark);
        arena_destroy(arena);
    }
}

static void test_leaves__are_kites_of_the_length_asked_for(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    const struct mesh *mesh = built(arena, "poplar", "leaf_length=0.06");
    const struct mesh_part *leaves = &mesh->parts[1];
    double mean = 0;
    assert_int_equal(leaves->elements_count * 2, leaves->triangles_count);
    for (uint32_t i = 0; i < leaves->elements_count; i++) {
        uint32_t first = leaves->element_first[i];
        assert_int_equal(leaves->element_first[i + 1], first + 2);
        /* (base, right, tip), (base, tip, left): a kite's area is half the product of its
         * diagonals. */
        const float *base = mesh->positions[mesh->triangles[first][0]];
        const float *right = mesh->positions[mesh->triangles[first][1]];
        const float *tip = mesh->positions[mesh->triangles[first][2]];
        const float *left = mesh->positions[mesh->triangles[first + 1][2]];
        double length = 0, width = 0;
        for (int k = 0; k < 3; k++) {
            length += ((double)tip[k] - (double)base[k]) * ((double)tip[k] - (double)base[k]);
            width += ((double)left[k] - (double)right[k]) * ((double)left[k] - (double)right[k]);
        }
        double area = area_of(mesh, first) + area_of(mesh, first + 1);
        assert_float_equal(area, sqrt(length * width) / 2, 1e-5 * 0.06);
        assert_true(area > 0);
        mean += sqrt(length) / leaves->elements_count;
    }
    assert_float_equal(mean, 0.06, 0.03 * 0.06);
    arena_destroy(arena);
}

/* Ground that leaves and bark hide from above, counted on a raster of 5 cm. */
static double cover_m2(const struct mesh *mesh)
{
    enum { CELLS = 800 };
    const double cell = 0.05;
    char *hidden = calloc(CELLS * CELLS, 1);
    for (size_t i = 0; i < mesh->triangles_count; i++) {
        const uint32_t *t = mesh->triangles[i];
        double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9}, p[3][2];
        for (int k = 0; k < 3; k++)
            for (int a = 0; a < 2; a++) {
                p[k][a] = (double)mesh->positions[t[k]][2 * a] / cell + CELLS / 2.0;
                low[a] = fmin(low[a], p[k][a]);
                high[a] = fmax(high[a], p[k][a]);
            }
        for (int y = (int)low[1]; y <= (int)high[1]; y++)
            for (int x = (int)low[0]; x <= (int)high[0]; x++) {
                int sides = 0;
                for (int k = 0; k < 3; k++) {
                    const double *a = p[k], *b = p[(k + 1) % 3];
                    sides +=
                        (b[0] - a[0]) * (y + 0.5 - a[1]) - (b[1] - a[1]) * (x + 0.5 - a[0]) > 0;
                }
                if (sides == 0 || sides == 3)
                    hidden[y * CELLS + x] = 1;
            }
    }
    size_t count = 0;
    for (size_t i = 0; i < CELLS * CELLS; i++)
        count += (size_t)hidden[i];
    free(hidden);
    return (double)count * cell * cell;
}

static void test_oak__bears_three_to_six_square_metres_of_leaf_on_one_of_ground(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    const struct mesh *mesh = built(arena, "oak", NULL);
    double index = area_of_leaves(mesh) / cover_m2(mesh);
    assert_true(index > 3 && index < 6);
    arena_destroy(arena);
}

/* Ross 1981: leaves that look everywhere alike show half their area to any direction. */
static void test_poplar__has_leaves_that_look_everywhere(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    const struct mesh *mesh = built(arena, "poplar", NULL);
    double shown[3] = {0};
    for (size_t i = mesh->parts[1].first_triangle; i < mesh->triangles_count; i++)
        for (int k = 0; k < 3; k++)
            shown[k] +=
                area_of(mesh, (uint32_t)i) * fabs((double)mesh->normals[mesh->triangles[i][0]][k]);
    for (int k = 0; k < 3; k++)
        assert_float_equal(shown[k] / area_of_leaves(mesh), 0.5, 0.08);
    arena_destroy(arena);
}

static uint64_t hash_of(const struct mesh *mesh)
{
    uint64_t hash = hash_bytes(0, mesh->positions, mesh->vertices_count * sizeof(float[3]));
    hash = hash_bytes(hash, mesh->normals, mesh->vertices_count * sizeof(float[3]));
    hash = hash_bytes(hash, mesh->colors, mesh->vertices_count * sizeof(float[3]));
    return hash_bytes(hash, mesh->triangles, mesh->triangles_count * sizeof(uint32_t[3]));
}

static void test_seed__gives_the_same_tree_again_and_another_for_another(void **state)
{
    (void)state;
    const char *const generators[] = {"poplar", "oak", "hypertexture"};
    for (int i = 0; i < 3; i++) {
        struct arena *arena = arena_create(0);
        uint64_t one = hash_of(built(arena, generators[i], "seed=3"));
        assert_true(one == hash_of(built(arena, generators[i], "seed=3")));
        assert_true(one != hash_of(built(arena, generators[i], "seed=4")));
        arena_destroy(arena);
    }
}

static void test_sincos__agrees_with_the_library_to_eleven_digits(void **state)
{
    (void)state;
    for (int i = -30000; i <= 30000; i++) {
        double turns = i / 9973.0, s, c;
        grow_sincos(turns, &s, &c);
        assert_true(fabs(s - sin(turns * 6.283185307179586477)) < 1e-11);
        assert_true(fabs(c - cos(turns * 6.283185307179586477)) < 1e-11);
    }
}

static void test_plant__is_built_when_first_asked_for(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct plant *plant;
    const struct mesh *first, *second;
    assert_int_equal(plant_generated(arena, "poplar", NULL, &plant, NULL), STATUS_OK);
    assert_string_equal(plant_name(plant), "poplar");
    assert_false(plant_cost(plant).built);
    size_t before = arena_used_bytes(arena);
    assert_int_equal(plant_mesh(plant, &first, NULL), STATUS_OK);
    assert_int_equal(plant_mesh(plant, &second, NULL), STATUS_OK);
    assert_ptr_equal(first, second);
    struct plant_cost cost = plant_cost(plant);
    assert_true(cost.built && cost.build_seconds > 0);
    assert_int_equal(cost.triangles_count, 98286);
    assert_int_equal(cost.build_bytes, arena_used_bytes(arena) - before);
    arena_destroy(arena);
}

static uint64_t plant_hash_of(struct arena *arena, const char *generator, const char *options)
{
    struct plant *plant;
    uint64_t hash = 0;
    assert_int_equal(plant_generated(arena, generator, options, &plant, NULL), STATUS_OK);
    assert_int_equal(plant_hash(plant, &hash, NULL), STATUS_OK);
    assert_false(plant_cost(plant).built);
    return hash;
}

static void test_hash__tells_plants_apart_by_what_changes_them(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    uint64_t poplar = plant_hash_of(arena, "poplar", NULL);
    assert_true(poplar == plant_hash_of(arena, "poplar", "height=20,seed=1"));
    assert_true(poplar != plant_hash_of(arena, "poplar", "height=20.5"));
    assert_true(poplar != plant_hash_of(arena, "poplar", "seed=2"));
    assert_true(poplar != plant_hash_of(arena, "oak", NULL));
    arena_destroy(arena);
}

static void refused(const char *generator, const char *options, enum status status,
                    const char *words)
{
    struct arena *arena = arena_create(0);
    struct error error = {0};
    struct plant *plant;
    const struct mesh *mesh;
    enum status got = plant_generated(arena, generator, options, &plant, &error);
    if (got == STATUS_OK)
        got = plant_mesh(plant, &mesh, &error);
    assert_int_equal(got, status);
    if (!strstr(error.text, words))
        fail_msg("'%s' does not say '%s'", error.text, words);
    arena_destroy(arena);
}

static void test_options__out_of_range_are_refused_by_name(void **state)
{
    (void)state;
    refused("poplar", "height=4.9", STATUS_INVALID, "height: '4.9' is outside 5..40");
    refused("poplar", "triangles=29999", STATUS_INVALID, "triangles: '29999' is outside");
    refused("poplar", "leaf_length=0.6", STATUS_INVALID, "leaf_length");
    refused("oak", "seed=-1", STATUS_INVALID, "plant oak: seed");
    refused("oak", "leafs=7", STATUS_INVALID, "no option 'leafs'");
    refused("oak", "height=40,width=3", STATUS_INVALID, "width: 3 is outside 20..120");
    refused("elm", NULL, STATUS_NOT_FOUND,
            "no plant 'elm'; plants that can be generated are poplar, oak, hypertexture");
}

static void test_options__at_their_ends_give_valid_trees(void **state)
{
    (void)state;
    const char *const cases[][2] = {{"poplar", "height=5,width=0.5,triangles=30000"},
                                    {"poplar", "height=40,width=12,leaf_length=0.5"},
                                    {"oak", "height=4,width=12,leaf_length=1,triangles=60000"},
                                    {"oak", "height=40,width=50,leaf_length=0.02,seed=1000000"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct arena *arena = arena_create(0);
        struct error error = {0};
        if (mesh_check(built(arena, cases[i][0], cases[i][1]), &error) != STATUS_OK)
            fail_msg("%s", error.text);
        arena_destroy(arena);
    }
}

static void test_plant_options__lists_every_generators_table(void **state)
{
    (void)state;
    for (size_t i = 0; plant_generators[i]; i++) {
        const struct option *table = plant_options(plant_generators[i]);
        assert_non_null(table);
        bool ball = strcmp(plant_generators[i], "hypertexture") == 0;
        assert_string_equal(table->name, ball ? "radius" : "height");
    }
    assert_null(plant_options("elm"));
}

/* A box of 2 x 4 x 6 m with a leaf above it; each test breaks one thing. */
struct sample {
    struct mesh mesh;
    float positions[7][3], normals[7][3], colors[7][3];
    uint32_t triangles[3][3], element_first[2];
    struct mesh_part parts[2];
    struct material materials[2];
};

static void make_sample(struct sample *s)
{
    static const float positions[7][3] = {{-1, 0, -3}, {1, 0, -3}, {-1, 4, 3}, {1, 4, 3},
                                          {0, 4, 0},   {0, 4, 1},  {1, 4, 0}};
    memset(s, 0, sizeof *s);
    memcpy(s->positions, positions, sizeof positions);
    for (int i = 0; i < 7; i++) {
        s->normals[i][1] = 1;
        s->colors[i][0] = 0.5f;
    }
    const uint32_t triangles[3][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}};
    memcpy(s->triangles, triangles, sizeof triangles);
    s->element_first[0] = 2, s->element_first[1] = 3;
    s->parts[0] = (struct mesh_part){0, 2, 0, NULL, 0};
    s->parts[1] = (struct mesh_part){2, 1, 1, s->element_first, 1};
    s->materials[1].kind = MATERIAL_LEAF;
    s->mesh = (struct mesh){.vertices_count = 7,
                            .positions = s->positions,
                            .normals = s->normals,
                            .colors = s->colors,
                            .triangles_count = 3,
                            .triangles = s->triangles,
                            .parts_count = 2,
                            .parts = s->parts,
                            .materials_count = 2,
                            .materials = s->materials};
}

static void violates(struct sample *s, const char *words)
{
    struct error error = {0};
    assert_int_equal(mesh_check(&s->mesh, &error), STATUS_INVALID);
    if (!strstr(error.text, words))
        fail_msg("'%s' does not say '%s'", error.text, words);
    make_sample(s);
    assert_int_equal(mesh_check(&s->mesh, &error), STATUS_OK);
}

static void test_mesh_check__names_the_first_violation(void **state)
{
    (void)state;
    struct sample s;
    struct texture texture = {0};
    make_sample(&s);
    s.positions[3][1] = NAN, violates(&s, "vertex 3: position (1, nan, 3)");
    s.normals[5][1] = 0.9f, violates(&s, "vertex 5: normal (0, 0.9, 0)");
    s.colors[6][2] = 1.5f, violates(&s, "vertex 6: color (0.5, 0, 1.5)");
    s.triangles[1][2] = 7, violates(&s, "triangle 1: vertex 7 is outside 0..6");
    s.parts[1].first_triangle = 1, violates(&s, "part 1: 1 triangles from 1");
    s.parts[1].material = 2, violates(&s, "part 1: material 2 is outside 0..1");
    s.element_first[1] = 2, violates(&s, "part 1: elements 2..2 do not tile 2..3");
    s.parts[1].elements_count = 0, violates(&s, "part 1: leaves without elements");
    s.mesh.parts_count = 1, violates(&s, "parts hold 2 of 3 triangles");
    s.materials[0].albedo[1] = -0.1f, violates(&s, "material 0: albedo (0, -0.1, 0)");
    s.materials[0].texture = &texture, violates(&s, "material 0: a texture of 0 x 0 pixels");
    s.mesh.triangles_count = 0, violates(&s, "the mesh is empty");
    s.materials[0].kind = MATERIAL_LEAF, s.materials[1].kind = MATERIAL_BARK;
    violates(&s, "part 0: leaves without elements");
}

static void test_mesh_bounds__hold_the_mesh_and_touch_it(void **state)
{
    (void)state;
    struct sample s;
    make_sample(&s);
    mesh_bounds(&s.mesh);
    const float low[3] = {-1, 0, -3}, high[3] = {1, 4, 3};
    assert_memory_equal(s.mesh.minimum_m, low, sizeof low);
    assert_memory_equal(s.mesh.maximum_m, high, sizeof high);
    assert_true((double)s.mesh.radius_m * (double)s.mesh.radius_m >= 10);
    assert_float_equal(s.mesh.radius_m, sqrt(10), 1e-6);
}

static void test_plant_from_mesh__gives_the_mesh_back_and_hashes_its_bytes(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct sample s;
    make_sample(&s);
    const struct mesh *mesh;
    uint64_t first, second;
    struct plant *plant = plant_from_mesh(arena, "box", &s.mesh);
    assert_int_equal(plant_mesh(plant, &mesh, NULL), STATUS_OK);
    assert_ptr_equal(mesh, &s.mesh);
    assert_int_equal(plant_hash(plant, &first, NULL), STATUS_OK);
    s.positions[0][0] = -1.5f;
    assert_int_equal(plant_hash(plant_from_mesh(arena, "box", &s.mesh), &second, NULL), STATUS_OK);
    assert_true(first != second);
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_poplar__has_the_papers_triangles_whatever_the_seed),
        cmocka_unit_test(test_oak__has_about_a_hundred_thousand_triangles),
        cmocka_unit_test(test_triangles__are_as_many_as_asked_less_an_odd_one),
        cmocka_unit_test(test_generators__make_valid_meshes_of_the_size_asked_for),
        cmocka_unit_test(test_bark__is_closed_but_for_each_stems_foot_and_faces_outward),
        cmocka_unit_test(test_normals__lie_on_the_outer_side_of_their_triangles),
        cmocka_unit_test(test_leaves__are_kites_of_the_length_asked_for),
        cmocka_unit_test(test_oak__bears_three_to_six_square_metres_of_leaf_on_one_of_ground),
        cmocka_unit_test(test_poplar__has_leaves_that_look_everywhere),
        cmocka_unit_test(test_seed__gives_the_same_tree_again_and_another_for_another),
        cmocka_unit_test(test_sincos__agrees_with_the_library_to_eleven_digits),
        cmocka_unit_test(test_plant__is_built_when_first_asked_for),
        cmocka_unit_test(test_hash__tells_plants_apart_by_what_changes_them),
        cmocka_unit_test(test_options__out_of_range_are_refused_by_name),
        cmocka_unit_test(test_options__at_their_ends_give_valid_trees),
        cmocka_unit_test(test_plant_options__lists_every_generators_table),
        cmocka_unit_test(test_mesh_check__names_the_first_violation),
        cmocka_unit_test(test_mesh_bounds__hold_the_mesh_and_touch_it),
        cmocka_unit_test(test_plant_from_mesh__gives_the_mesh_back_and_hashes_its_bytes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
