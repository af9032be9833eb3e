/* Pairs of cells without and with the sun's shadows: which rows are one. */
#include "tiny_result.h"

#include "report/page.h"
#include "report/pairs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static struct shadow_pair *found(struct arena *arena, struct run *run, struct book **book,
                                 size_t *count)
{
    *book = book_make(arena, run);
    assert_int_equal((*book)->groups_count, 1);
    return shadow_pairs(*book, (*book)->groups, count);
}

static void test_pairs__a_switch_and_what_depends_on_it_may_differ_and_nothing_else(void **state)
{
    (void)state;
    static const char *const cells[][2] = {
        {"billboards", ""},
        {"billboards", "shadow=map"},
        {"billboards", "shadow=map,casters=billboard"},
        {"billboards", "views=8,shadow=map"}, /* nobody's */
        {"ray-texels", "shadows=0"},
        {"ray-texels", ""},
        {"ray-texels", "shadows=32"},
        {"conifers", "shadows=off"},
        {"shadow-map", ""}, /* has no switch */
        {"polygons", ""},
    };
    static const char *const wanted[][2] = {
        {"billboards", "billboards shadow=map"},
        {"billboards", "billboards shadow=map casters=billboard"},
        {"ray-texels shadows=0", "ray-texels"},
        {"ray-texels shadows=0", "ray-texels shadows=32"},
    };
    struct arena *arena = arena_create(0);
    struct run *run = tiny_run(arena, 32);
    struct book *book;
    size_t count;
    for (size_t i = 0; i < sizeof cells / sizeof *cells; i++)
        tiny_drawn(arena, run, cells[i][0], cells[i][1], 0, 0.01);
    const struct shadow_pair *pairs = found(arena, run, &book, &count);
    assert_int_equal(count, sizeof wanted / sizeof *wanted);
    for (size_t i = 0; i < count; i++) {
        assert_string_equal(book->rows[pairs[i].without].label, wanted[i][0]);
        assert_string_equal(book->rows[pairs[i].with].label, wanted[i][1]);
    }
    arena_destroy(arena);
}

/* Two cells that are a pair but for one thing. */
static void test_pairs__other_levels_formats_effects_and_failures_part_cells(void **state)
{
    (void)state;
    for (int part = 0; part < 7; part++) {
        struct arena *arena = arena_create(0);
        struct run *run = tiny_run(arena, 2);
        struct book *book;
        size_t count;
        struct result *without = tiny_drawn(arena, run, "polygons", "", 0, 0.01);
        struct result *with = tiny_drawn(arena, run, "polygons", "shadow=map", 0, 0.02);
        if (part == 1)
            with->cell.lod = LOD_HIGH;
        if (part == 2)
            with->cell.format = TARGET_RGBA8;
        if (part == 3)
            without->effects &= ~EFFECT_FOG;
        if (part == 4)
            with->effects = without->effects;
        if (part >= 5)
            (part == 5 ? with : without)->status = STATUS_CRASH;
        found(arena, run, &book, &count);
        assert_int_equal(count, part == 0);
        arena_destroy(arena);
    }
}

/* Ratios of 3, 5 and 4; that of the medians would be 5. */
static void test_pairs__the_price_is_of_times_of_the_same_round(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct run *run = tiny_run(arena, 32);
    struct book *book;
    size_t count;
    static const double seconds[3][2] = {{0.02, 0.06}, {0.01, 0.05}, {0.01, 0.04}};
    for (int round = 0; round < 3; round++) {
        tiny_drawn(arena, run, "polygons", "", round, seconds[round][0]);
        tiny_drawn(arena, run, "polygons", "shadow=map", round, seconds[round][1]);
    }
    const struct shadow_pair *pairs = found(arena, run, &book, &count);
    assert_int_equal(count, 1);
    assert_true(fabs(pairs->price.value - 4) < 1e-9);
    assert_true(pairs->price.low >= 3 - 1e-9 && pairs->price.high <= 5 + 1e-9);
    arena_destroy(arena);
}

/* What a run knows of both rows stands in one row of the table; a run without pairs has none. */
static void test_pairs__the_page_sets_both_errors_and_the_price_beside_each_other(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct run *run = tiny_run(arena, 32);
    struct figures figures = {0};
    for (int with = 0; with < 2; with++) {
        char *text = NULL;
        size_t size = 0;
        tiny_drawn(arena, run, "polygons", with ? "shadow=map" : "", 0, with ? 0.0515 : 0.0206);
        struct result *result = &run->results[with];
        result->views_count = 1;
        result->views = ARENA_NEW(arena, struct result_view);
        result->views->compared = true;
        result->views->full.value.flip = with ? 0.125 : 0.25;
        result->host_bytes = with ? 7.25e6 : 2e6;
        struct book *book = book_make(arena, run);
        struct page page = {.book = book, .figures = &figures, .arena = arena};
        page.out = open_memstream(&text, &size);
        page_pairs(&page);
        fclose(page.out);
        if (with)
            assert_true(strstr(text, "0.250 \u2192 0.125") && strstr(text, "20.6 \u2192 51.5") &&
                        strstr(text, ">2.50<") && strstr(text, ">5.25<"));
        else
            assert_int_equal(size, 0);
        free(text);
    }
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pairs__a_switch_and_what_depends_on_it_may_differ_and_nothing_else),
        cmocka_unit_test(test_pairs__other_levels_formats_effects_and_failures_part_cells),
        cmocka_unit_test(test_pairs__the_price_is_of_times_of_the_same_round),
        cmocka_unit_test(test_pairs__the_page_sets_both_errors_and_the_price_beside_each_other),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
