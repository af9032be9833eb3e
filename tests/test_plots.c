/* Plots: the numbers that stand in their data. */
#include "own_folder.h"
#include "tiny_result.h"

#include "base/file.h"
#include "report/plot.h"

typedef enum status plot_over(const struct book *, const struct group *, const char *,
                              struct figure *, struct error *);

/* The plot's data hold these rows, one after the other. */
static void check_rows(struct book *book, plot_over *plot, const char *rows)
{
    struct figure figure = {0};
    struct error error = {0};
    char *text = NULL;
    size_t size = 0;
    if (plot(book, book->groups, folder, &figure, &error) != STATUS_OK || !figure.name)
        fail_msg("nothing is drawn: %s", error.text);
    const char *path = arena_printf(book->arena, "%s/%s.dat", folder, figure.name);
    assert_int_equal(file_read(book->arena, path, 0, &text, &size, &error), STATUS_OK);
    if (!strstr(text, rows))
        fail_msg("'%s' does not hold '%s'", text, rows);
}

/* Views in another order than their distances; frames of 2, 4 and 6 ms; 1, 2 and 3 of 100 wrong. */
static void test_plots__over_the_distance_are_milliseconds_and_percent_in_its_order(void **state)
{
    (void)state;
    enum { VIEWS = 3 };
    static const double distances_m[VIEWS] = {40, 10, 20};
    struct arena *arena = arena_create(0);
    struct run *run = tiny_run(arena, 1);
    struct result *result = tiny_result(arena, run, "polygons", "shadow=map", 4, 0);
    result->views_count = result->frames_count = VIEWS;
    result->views = ARENA_ARRAY(arena, struct result_view, VIEWS);
    result->frame_seconds = ARENA_ARRAY(arena, double, VIEWS);
    for (int i = 0; i < VIEWS; i++) {
        struct result_view *view = &result->views[i];
        view->distance_m = distances_m[i];
        view->compared = view->masked = true;
        view->same.value.flip = view->full.value.flip = 0.125;
        view->mask.wrong = 0.01 * (i + 1);
        result->frame_seconds[i] = 0.002 * (i + 1);
    }
    struct book *book = book_make(arena, run);
    check_rows(book, plot_pace, "\n10 4\n20 6\n40 2\n");
    check_rows(book, plot_masks_distance, "\n10 2\n20 3\n40 1\n");
    arena_destroy(arena);
}

/* A cell of one view, which has a mask where its method draws shadows. */
static void add_masked(struct arena *arena, struct run *run, const char *method,
                       const char *options, double seconds)
{
    struct result *result = tiny_drawn(arena, run, method, options, 0, seconds);
    result->views_count = 1;
    result->views = ARENA_NEW(arena, struct result_view);
    result->views[0].masked = result->effects & EFFECT_SUN_SHADOWS;
    result->views[0].mask.wrong = 0.02;
}

/* Billboards of 2 ms take 12 with a map; a map by itself, 35, where polygons take 20. */
static void
test_plots__shadows_cost_what_they_add_to_their_own_cell_or_to_the_triangles(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct run *run = tiny_run(arena, 4);
    add_masked(arena, run, "billboards", "", 0.002);
    add_masked(arena, run, "billboards", "shadow=map", 0.012);
    add_masked(arena, run, "shadow-map", "", 0.035);
    add_masked(arena, run, "polygons", "", 0.020);
    struct book *book = book_make(arena, run);
    check_rows(book, plot_masks, "\n2 10 2 2 ");
    check_rows(book, plot_masks, "\n2 15 2 2 ");
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_plots__over_the_distance_are_milliseconds_and_percent_in_its_order),
        cmocka_unit_test(
            test_plots__shadows_cost_what_they_add_to_their_own_cell_or_to_the_triangles),
    };
    return cmocka_run_group_tests(tests, folder_make, folder_remove);
}
