/* Placement: counts, distances, quads, and the distribution of what is drawn at random. */
#include "testing.h"

#include "base/arena.h"
#include "base/file.h"
#include "base/random.h"
#include "scene/place.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static struct plant_entry plants[2] = {
    {.name = "oak", .weight = 3, .scale = {1, 2}, .stretch = {1, 1}, .reach_m = 20},
    {.name = "poplar", .weight = 1, .scale = {3, 3}, .stretch = {0.5f, 2}, .reach_m = 20},
};

static struct description grid_of(double spacing_m, double jitter)
{
    struct description description = {.path = "test.json", .plants = plants, .plants_count = 2};
    description.placement = (struct placement){
        .kind = PLACEMENT_GRID, .spacing_m = spacing_m, .jitter = jitter, .rotate = true};
    return description;
}

static struct description discs_of(double spacing_m, double min_distance_m)
{
    struct description description = grid_of(spacing_m, 0);
    description.placement.kind = PLACEMENT_POISSON;
    description.placement.min_distance_m = min_distance_m;
    return description;
}

/* Places and asks for success. */
static struct instance *place(struct arena *arena, const struct description *description,
                              size_t count, uint64_t seed, double *half_m)
{
    struct instance *instances = NULL;
    struct error error = {STATUS_OK, ""};
    enum status status = place_trees(arena, description, count, seed, &instances, half_m, &error);
    assert_string_equal(error.text, "");
    assert_int_equal(status, STATUS_OK);
    for (size_t k = 0; k < count; k++) {
        assert_true(fabs((double)instances[k].position_m[0]) <= *half_m * (1 + 1e-6));
        assert_true(fabs((double)instances[k].position_m[2]) <= *half_m * (1 + 1e-6));
    }
    return instances;
}

/* Squared distance of the two nearest trees, by comparing all pairs. */
static double nearest2(const struct instance *trees, size_t count)
{
    double nearest = INFINITY;
    for (size_t a = 0; a < count; a++)
        for (size_t b = a + 1; b < count; b++) {
            double dx = (double)trees[a].position_m[0] - trees[b].position_m[0];
            double dz = (double)trees[a].position_m[2] - trees[b].position_m[2];
            nearest = fmin(nearest, dx * dx + dz * dz);
        }
    return nearest;
}

static void test_grid__each_quad_holds_at_most_one_tree_and_the_number_is_exact(void **state)
{
    (void)state;
    static const size_t counts[] = {1, 2, 3, 4, 5, 16, 17, 100, 200, 500, 1000, 10000};
    for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++) {
        struct arena *arena = arena_create(0);
        struct description description = grid_of(8, 1);
        double half_m;
        struct instance *trees = place(arena, &description, counts[c], 5, &half_m);
        assert_float_equal(half_m, 4 * sqrt((double)counts[c]), 1e-9 * half_m);
        size_t side = (size_t)ceil(sqrt((double)counts[c]));
        unsigned *held = ARENA_ARRAY(arena, unsigned, side *side);
        for (size_t k = 0; k < counts[c]; k++) {
            double u = (trees[k].position_m[0] / (2 * half_m) + 0.5) * (double)side;
            double v = (trees[k].position_m[2] / (2 * half_m) + 0.5) * (double)side;
            size_t quad =
                (size_t)fmin(v, (double)side - 1) * side + (size_t)fmin(u, (double)side - 1);
            assert_int_equal(held[quad]++, 0);
        }
        arena_destroy(arena);
    }
}

static void test_grid__without_jitter_trees_stand_in_the_middle_of_their_quads(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct description description = grid_of(10, 0);
    double half_m;
    struct instance *trees = place(arena, &description, 9, 1, &half_m);
    for (int k = 0; k < 9; k++) {
        assert_float_equal(trees[k].position_m[0], 10 * (k % 3 - 1), 1e-5);
        assert_float_equal(trees[k].position_m[2], 10 * (k / 3 - 1), 1e-5);
    }
    trees = place(arena, &description, 1, 1, &half_m);
    assert_float_equal(trees[0].position_m[0], 0, 1e-6);
    arena_destroy(arena);
}

/* The quads of a partly filled grid are chosen evenly: over many seeds each is taken as often as
 * the others. */
static void test_grid__no_quad_is_preferred(void **state)
{
    (void)state;
    enum { SEEDS = 4000, SIDE = 3, TREES = 5 };
    unsigned taken[SIDE * SIDE] = {0};
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        struct arena *arena = arena_create(0);
        struct description description = grid_of(1, 1);
        double half_m;
        struct instance *trees = place(arena, &description, TREES, seed, &half_m);
        for (int k = 0; k < TREES; k++) {
            int i = (int)((trees[k].position_m[0] / (2 * half_m) + 0.5) * SIDE);
            int j = (int)((trees[k].position_m[2] / (2 * half_m) + 0.5) * SIDE);
            taken[j * SIDE + i]++;
        }
        arena_destroy(arena);
    }
    double mean = SEEDS * 5.0 / 9, deviation = sqrt(SEEDS * 5.0 / 9 * 4 / 9);
    for (int q = 0; q < SIDE * SIDE; q++)
        assert_true(fabs(taken[q] - mean) < 4.5 * deviation);
}

/* Computed by a separate program from the papers' descriptions of PCG-XSH-RR 64/32 and splitmix64.
 */
static void test_grid__is_the_forest_that_another_program_computes(void **state)
{
    (void)state;
    static const double expected[4][5] = {
        {-7.912995, -6.560241, 1.110706, 1.750617, 0},
        {0.677022, -8.021463, 5.620591, 1.52163, 0},
        {-6.73974, 5.523112, 2.996145, 1.855577, 0},
        {3.738899, 6.656356, 3.577533, 1.620245, 0},
    };
    struct arena *arena = arena_create(0);
    struct description description = grid_of(10, 1);
    double half_m;
    struct instance *trees = place(arena, &description, 4, 7, &half_m);
    for (int k = 0; k < 4; k++) {
        assert_float_equal(trees[k].position_m[0], expected[k][0], 2e-6);
        assert_float_equal(trees[k].position_m[2], expected[k][1], 2e-6);
        assert_float_equal(trees[k].rotation_rad, expected[k][2], 2e-6);
        assert_float_equal(trees[k].scale, expected[k][3], 2e-6);
        assert_int_equal(trees[k].species, (int)expected[k][4]);
    }
    arena_destroy(arena);
}

static void test_trees__turn_scale_and_species_follow_their_distributions(void **state)
{
    (void)state;
    enum { TREES = 40000, BINS = 32 };
    struct arena *arena = arena_create(0);
    struct description description = grid_of(5, 1);
    double half_m, chi2 = 0, scale_sum = 0;
    struct instance *trees = place(arena, &description, TREES, 11, &half_m);
    unsigned bins[BINS] = {0}, oaks = 0;
    double stretch_sum = 0;
    for (int k = 0; k < TREES; k++) {
        double turn = trees[k].rotation_rad / 6.283185307179586;
        assert_true(turn >= 0 && turn <= 1);
        bins[(int)fmin(turn * BINS, BINS - 1)]++;
        oaks += trees[k].species == 0;
        if (trees[k].species == 0) {
            assert_true(trees[k].scale >= 1 && trees[k].scale <= 2);
            scale_sum += trees[k].scale;
            assert_float_equal(trees[k].stretch, 1, 0);
        } else {
            assert_float_equal(trees[k].scale, 3, 0);
            assert_true(trees[k].stretch >= 0.5f && trees[k].stretch <= 2);
            stretch_sum += trees[k].stretch;
        }
        assert_float_equal(trees[k].position_m[1], 0, 0);
    }
    for (int b = 0; b < BINS; b++)
        chi2 += (bins[b] - 1250.0) * (bins[b] - 1250.0) / 1250.0;
    assert_true(chi2 < 70);  /* 31 degrees of freedom: P(chi2 > 70) = 8e-5 */
    assert_true(chi2 > 8.5); /* and not too even: P(chi2 < 8.5) = 2e-5 */
    assert_true(fabs(oaks - 0.75 * TREES) < 4.5 * sqrt(TREES * 0.75 * 0.25));
    assert_true(fabs(scale_sum / oaks - 1.5) < 4.5 / sqrt(12.0 * oaks));
    assert_true(fabs(stretch_sum / (TREES - oaks) - 1.25) <
                4.5 * 1.5 / sqrt(12.0 * (TREES - oaks)));
    description.placement.rotate = false;
    trees = place(arena, &description, 10, 11, &half_m);
    for (int k = 0; k < 10; k++)
        assert_float_equal(trees[k].rotation_rad, 0, 0);
    arena_destroy(arena);
}

static void test_trees__a_species_of_no_weight_is_never_drawn(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct description description = grid_of(5, 1);
    struct plant_entry unweighted[3] = {plants[0], plants[1], plants[0]};
    unweighted[0].weight = unweighted[2].weight = 0;
    description.plants = unweighted;
    description.plants_count = 3;
    double half_m;
    struct instance *trees = place(arena, &description, 1000, 3, &half_m);
    for (int k = 0; k < 1000; k++)
        assert_int_equal(trees[k].species, 1);
    arena_destroy(arena);
}

static void test_seed__the_same_is_the_same_forest_and_another_is_another(void **state)
{
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        struct arena *arena = arena_create(0);
        struct description description = kind ? discs_of(6, 0) : grid_of(6, 1);
        double half_m;
        size_t bytes = 500 * sizeof(struct instance);
        struct instance *first = place(arena, &description, 500, 1, &half_m);
        struct instance *again = place(arena, &description, 500, 1, &half_m);
        struct instance *other = place(arena, &description, 500, 2, &half_m);
        assert_memory_equal(first, again, bytes);
        assert_memory_not_equal(first, other, bytes);
        arena_destroy(arena);
    }
}

static void test_stretch__leaves_place_turn_scale_and_species_as_they_are(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct description description = grid_of(10, 1);
    struct plant_entry plain[2];
    double half_m;
    struct instance *stretched = place(arena, &description, 100, 3, &half_m);
    memcpy(plain, description.plants, sizeof plain);
    plain[1].stretch[0] = plain[1].stretch[1] = 1;
    description.plants = plain;
    struct instance *trees = place(arena, &description, 100, 3, &half_m);
    for (int k = 0; k < 100; k++) {
        assert_memory_equal(&stretched[k], &trees[k], offsetof(struct instance, stretch));
        assert_float_equal(trees[k].stretch, 1, 0);
    }
    arena_destroy(arena);
}

static void test_poisson__the_number_is_exact_and_no_two_trees_are_nearer_than_asked(void **state)
{
    (void)state;
    static const size_t counts[] = {1, 2, 3, 4, 5, 7, 10, 50, 333, 2000};
    for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++)
        for (uint64_t seed = 0; seed < 5; seed++) {
            struct arena *arena = arena_create(0);
            struct description description = discs_of(8, counts[c] > 3 ? 5 : 0);
            double half_m;
            struct instance *trees = place(arena, &description, counts[c], seed, &half_m);
            double least_m = counts[c] > 3 ? 5 : 0.3 * 8;
            assert_true(nearest2(trees, counts[c]) >= least_m * least_m);
            arena_destroy(arena);
        }
    /* The automatic distance is 0.7 of a tree's share where that fits. */
    struct arena *arena = arena_create(0);
    struct description description = discs_of(8, 0);
    double half_m;
    struct instance *trees = place(arena, &description, 2000, 9, &half_m);
    assert_true(nearest2(trees, 2000) >= 5.6 * 5.6 * (1 - 1e-9));
    arena_destroy(arena);
}

/* Darts thrown until none fits jam at a covered share of 0.547070 (random sequential addition of
 * discs; Zhang and Torquato 2013, doi:10.1103/PhysRevE.88.053312). Centres fill the square, so
 * discs reach half a radius beyond it: the share counts the square and that seam. */
static void test_poisson__a_full_square_is_maximal_and_has_the_jamming_density(void **state)
{
    (void)state;
    enum { WANTED = 100000 };
    struct arena *arena = arena_create(0);
    double(*points)[2] = arena_alloc(arena, WANTED, sizeof *points);
    double side_m = 200, diameter_m = 1.5;
    size_t count = place_poisson(0.5 * side_m, diameter_m, 0, 3, WANTED, points);
    double discs_m2 = (double)count * 0.25 * 3.14159265358979 * diameter_m * diameter_m;
    double share_low = discs_m2 / ((side_m + diameter_m) * (side_m + diameter_m));
    double share_high = discs_m2 / (side_m * side_m);
    assert_true(share_low < 0.547070 * 1.006);
    assert_true(share_high > 0.547070 * 0.994);
    /* Probes find a point within one distance wherever they fall: buckets of one point at most
     * each. */
    enum { BUCKETS = 190 };
    double bucket_m = side_m / BUCKETS;
    assert_true(bucket_m < diameter_m / sqrt(2));
    double(*held)[2] = arena_alloc(arena, BUCKETS * BUCKETS, sizeof *held);
    for (size_t p = 0; p < count; p++) {
        int i = (int)fmin((points[p][0] + 0.5 * side_m) / bucket_m, BUCKETS - 1);
        int j = (int)fmin((points[p][1] + 0.5 * side_m) / bucket_m, BUCKETS - 1);
        assert_true(held[j * BUCKETS + i][0] == 0 && held[j * BUCKETS + i][1] == 0);
        memcpy(held[j * BUCKETS + i], points[p], sizeof *held);
    }
    struct random random = random_seed(8, 1);
    for (int k = 0; k < 1000000; k++) {
        double x = random_double(&random) * side_m, z = random_double(&random) * side_m;
        int i = (int)(x / bucket_m), j = (int)(z / bucket_m);
        double nearest = INFINITY;
        for (int v = j > 2 ? j - 2 : 0; v <= j + 2 && v < BUCKETS; v++)
            for (int u = i > 2 ? i - 2 : 0; u <= i + 2 && u < BUCKETS; u++) {
                const double *point = held[v * BUCKETS + u];
                double dx = point[0] - (x - 0.5 * side_m), dz = point[1] - (z - 0.5 * side_m);
                if (point[0] != 0 || point[1] != 0)
                    nearest = fmin(nearest, dx * dx + dz * dz);
            }
        if (nearest > diameter_m * diameter_m * 1.0001)
            fail_msg("nothing within %g m of (%g, %g)", sqrt(nearest), x, z);
    }
    arena_destroy(arena);
}

/* Stopping early must not leave a corner empty: 16 tiles hold about the same number. */
static void test_poisson__trees_are_spread_evenly_over_the_square(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct description description = discs_of(8, 0);
    double half_m;
    unsigned tiles[16] = {0};
    struct instance *trees = place(arena, &description, 16000, 4, &half_m);
    for (int k = 0; k < 16000; k++) {
        int i = (int)fmin(3, (trees[k].position_m[0] / (2 * half_m) + 0.5) * 4);
        int j = (int)fmin(3, (trees[k].position_m[2] / (2 * half_m) + 0.5) * 4);
        tiles[4 * j + i]++;
    }
    for (int t = 0; t < 16; t++)
        assert_true(abs((int)tiles[t] - 1000) < 60);
    arena_destroy(arena);
}

static void test_poisson__too_many_trees_for_the_distance_are_refused_with_the_number(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct description description = discs_of(5, 4.6);
    struct instance *trees;
    struct error error = {STATUS_OK, ""};
    double half_m;
    assert_int_equal(place_trees(arena, &description, 1000, 1, &trees, &half_m, &error),
                     STATUS_INVALID);
    assert_non_null(strstr(error.text, "test.json: placement.min_distance_m: 1000 trees"));
    assert_non_null(strstr(error.text, "4.6 m"));
    size_t fit = strtoul(strstr(error.text, "up to ") + 6, NULL, 10);
    assert_in_range(fit, 700, 999);
    description.placement.extent_m = 2 * half_m;
    place(arena, &description, fit, 1, &half_m);
    description = discs_of(5000, 0.001);
    assert_int_equal(place_trees(arena, &description, 1000, 1, &trees, &half_m, &error),
                     STATUS_INVALID);
    assert_non_null(strstr(error.text, "placement.min_distance_m: value is 0.001; allowed"));
    arena_destroy(arena);
}

static void test_clearing__holds_no_tree_and_the_number_stays_exact(void **state)
{
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        struct arena *arena = arena_create(0);
        struct description description = kind ? discs_of(6, 0) : grid_of(6, 1);
        description.placement.clearing_m = 30;
        double half_m;
        struct instance *trees = place(arena, &description, 400, 2, &half_m);
        double near_m = INFINITY;
        for (int k = 0; k < 400; k++)
            near_m = fmin(near_m, hypot(trees[k].position_m[0], trees[k].position_m[2]));
        assert_true(near_m >= 30 * (1 - 1e-6));
        assert_true(near_m < 40);
        struct error error = {STATUS_OK, ""};
        assert_int_equal(place_trees(arena, &description, 9, 2, &trees, &half_m, &error),
                         STATUS_INVALID);
        assert_non_null(strstr(error.text, "test.json: placement.clearing_m: value is 30"));
        arena_destroy(arena);
    }
}

static void test_extent__fixes_the_square_whatever_the_number(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct description description = grid_of(0, 1);
    description.placement.extent_m = 50;
    double half_m;
    place(arena, &description, 10, 1, &half_m);
    assert_float_equal(half_m, 25, 0);
    place(arena, &description, 1000, 1, &half_m);
    assert_float_equal(half_m, 25, 0);
    arena_destroy(arena);
}

static void test_forest__no_tree_is_a_forest_and_many_are_placed(void **state)
{
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        struct arena *arena = arena_create(0);
        struct description description = kind ? discs_of(6, 0) : grid_of(6, 1);
        double half_m;
        place(arena, &description, 0, 1, &half_m);
        assert_true(half_m > 0);
        place(arena, &description, 200000, 1, &half_m);
        arena_destroy(arena);
    }
}

/* Writes a positions file and places from it; the status, with the error's text. */
static enum status place_text(struct arena *arena, const char *text, size_t count, double extent_m,
                              struct instance **trees, double *half_m, struct error *error)
{
    char path[] = "/tmp/treeline-test-XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    assert_int_equal(write(file, text, strlen(text)), strlen(text));
    close(file);
    struct description description = grid_of(0, 0);
    description.placement.kind = PLACEMENT_FILE;
    description.placement.extent_m = extent_m;
    description.placement.file = path;
    *error = (struct error){STATUS_OK, ""};
    enum status status = place_trees(arena, &description, count, 1, trees, half_m, error);
    unlink(path);
    return status;
}

static void test_file__rows_with_few_or_many_columns_are_read(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct instance *trees;
    struct error error;
    double half_m;
    const char *text = "# x z rotation scale species stretch\r\n"
                       "1, 2, 90, 1.5, poplar, 0.75\r\n"
                       "\n"
                       "-3.5 4\n"
                       "\t7;-8;180;2 # the last";
    assert_int_equal(place_text(arena, text, 3, 0, &trees, &half_m, &error), STATUS_OK);
    assert_float_equal(trees[0].position_m[0], 1, 0);
    assert_float_equal(trees[0].position_m[2], 2, 0);
    assert_float_equal(trees[0].rotation_rad, 1.5707963, 1e-6);
    assert_float_equal(trees[0].scale, 1.5, 0);
    assert_int_equal(trees[0].species, 1);
    assert_float_equal(trees[0].stretch, 0.75, 0);
    assert_float_equal(trees[1].position_m[0], -3.5, 0);
    assert_float_equal(trees[2].scale, 2, 0);
    assert_float_equal(half_m, 8, 0);
    assert_int_equal(place_text(arena, text, 2, 0, &trees, &half_m, &error), STATUS_OK);
    assert_float_equal(half_m, 4, 0);
    assert_int_equal(place_text(arena, text, 4, 0, &trees, &half_m, &error), STATUS_INVALID);
    assert_non_null(strstr(error.text, "trees: value is 4; allowed: 0..3"));
    arena_destroy(arena);
}

static void test_file__bad_rows_are_refused_with_line_column_and_allowance(void **state)
{
    (void)state;
    static const struct {
        const char *text, *line, *part;
    } bad[] = {
        {"1 2\n3\n", ":2:", "only '3'; allowed: at least x and z"},
        {"1 zwei\n", ":1:", "z: value is 'zwei'; allowed: a number in -20..20"},
        {"1 2\n1 nan\n", ":2:", "z: value is 'nan'"},
        {"1 21\n", ":1:", "z: value is '21'; allowed: a number in -20..20"},
        {"1 2 east\n", ":1:", "rotation_deg: value is 'east'"},
        {"1 2 3 0\n", ":1:", "scale: value is '0'; allowed: a number in 0.001..1000"},
        {"1 2 3 1 elm\n", ":1:", "species: value is 'elm'; allowed: oak, poplar"},
        {"1 2 3 1 oak 9\n", ":1:", "stretch: value is '9'; allowed: a number in 0.125..8"},
        {"1 2 3 1 oak 1 7\n", ":1:", "column 7 is '7'"},
    };
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
        struct arena *arena = arena_create(0);
        struct instance *trees;
        struct error error;
        double half_m;
        assert_int_equal(place_text(arena, bad[k].text, 1, 40, &trees, &half_m, &error),
                         STATUS_INVALID);
        assert_non_null(strstr(error.text, "/tmp/treeline-test-"));
        assert_non_null(strstr(error.text, bad[k].line));
        if (!strstr(error.text, bad[k].part))
            fail_msg("'%s' lacks '%s'", error.text, bad[k].part);
        arena_destroy(arena);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_grid__each_quad_holds_at_most_one_tree_and_the_number_is_exact),
        cmocka_unit_test(test_grid__without_jitter_trees_stand_in_the_middle_of_their_quads),
        cmocka_unit_test(test_grid__no_quad_is_preferred),
        cmocka_unit_test(test_grid__is_the_forest_that_another_program_computes),
        cmocka_unit_test(test_trees__turn_scale_and_species_follow_their_distributions),
        cmocka_unit_test(test_trees__a_species_of_no_weight_is_never_drawn),
        cmocka_unit_test(test_seed__the_same_is_the_same_forest_and_another_is_another),
        cmocka_unit_test(test_stretch__leaves_place_turn_scale_and_species_as_they_are),
        cmocka_unit_test(test_poisson__the_number_is_exact_and_no_two_trees_are_nearer_than_asked),
        cmocka_unit_test(test_poisson__a_full_square_is_maximal_and_has_the_jamming_density),
        cmocka_unit_test(test_poisson__trees_are_spread_evenly_over_the_square),
        cmocka_unit_test(test_poisson__too_many_trees_for_the_distance_are_refused_with_the_number),
        cmocka_unit_test(test_clearing__holds_no_tree_and_the_number_stays_exact),
        cmocka_unit_test(test_extent__fixes_the_square_whatever_the_number),
        cmocka_unit_test(test_forest__no_tree_is_a_forest_and_many_are_placed),
        cmocka_unit_test(test_file__rows_with_few_or_many_columns_are_read),
        cmocka_unit_test(test_file__bad_rows_are_refused_with_line_column_and_allowance),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
