/* The report against a synthetic run: numbers against Python, front against brute force, files
 * against parsers. */
#include "testing.h"

#include "report/axis.h"
#include "report/book.h"
#include "report/report.h"
#include "report_world.h"

#include "results/calibration.h"
#include "wall/gnuplot.h"

#include <sys/stat.h>
#include <unistd.h>

/* Made once: a run on disk and its report. */
struct world {
    struct arena *arena;
    const char *folder, *out;
    struct run *run;
    enum status status;
    struct error error;
};

static int world_setup(void **state)
{
    struct world *world = calloc(1, sizeof *world);
    char pattern[] = "/tmp/treeline-report-XXXXXX";
    setenv("TREELINE_DATA", ".", 0);
    world->arena = arena_create(0);
    world->folder = arena_strdup(world->arena, mkdtemp(pattern));
    world->out = arena_printf(world->arena, "%s/out", world->folder);
    world->run = world_run(world->arena, world->folder);
    world->status = report_write_run(world->arena, world->run, world->out, &world->error);
    *state = world;
    return 0;
}

static int shell(struct arena *arena, const char *command, char **said)
{
    FILE *pipe = popen(command, "r");
    char text[4096];
    size_t length = pipe ? fread(text, 1, sizeof text - 1, pipe) : 0;
    text[length] = 0;
    *said = arena_strdup(arena, text);
    return pipe ? pclose(pipe) : -1;
}

static int world_teardown(void **state)
{
    struct world *world = *state;
    char *said;
    shell(world->arena, arena_printf(world->arena, "rm -rf %s", world->folder), &said);
    arena_destroy(world->arena);
    free(world);
    return 0;
}

static char *content(struct world *world, const char *name)
{
    char *text = NULL;
    size_t size;
    struct error error = {0};
    const char *path = arena_printf(world->arena, "%s/%s", world->out, name);
    if (file_read(world->arena, path, 0, &text, &size, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    return text;
}

/* One round of one scene and tree count: a report that is quick to write. */
static struct run first_group(const struct world *world)
{
    struct run run = *world->run;
    run.results_count = WORLD_METHODS;
    return run;
}

static bool has(const char *text, const char *part)
{
    return strstr(text, part) != NULL;
}

static void test_report__every_file_is_well_formed_and_self_contained(void **state)
{
    struct world *world = *state;
    char *said;
    if (world->status != STATUS_OK)
        fail_msg("%s", world->error.text);
    int code =
        shell(world->arena,
              arena_printf(world->arena, "python3 tests/page_check.py %s 2>&1", world->out), &said);
    if (code != 0)
        fail_msg("%s", said);
}

/* Writes the raw frame times for Python, which computes the nested medians on its own. */
static void test_report__the_medians_in_the_csv_are_those_of_python(void **state)
{
    struct world *world = *state;
    const char *raw = arena_printf(world->arena, "%s/raw.txt", world->folder);
    FILE *file = fopen(raw, "w");
    for (size_t i = 0; i < world->run->results_count; i++) {
        const struct result *result = &world->run->results[i];
        if (result->status != STATUS_OK)
            continue;
        fprintf(file, "%s\t%.17g", result->cell.name, result->build_seconds);
        for (size_t k = 0; k < result->frames_count; k++)
            fprintf(file, "\t%.17g", result->frame_seconds[k]);
        fputc('\n', file);
    }
    fclose(file);
    static const char script[] =
        "import csv,statistics,sys,collections\n"
        "times,builds=collections.defaultdict(list),collections.defaultdict(list)\n"
        "for line in open(sys.argv[1]):\n"
        "    name,build,*values=line.rstrip().split('\\t')\n"
        "    times[name].append(statistics.median(map(float,values)))\n"
        "    builds[name].append(float(build))\n"
        "rows=list(csv.DictReader(open(sys.argv[2])))\n"
        "assert len(rows)==24,len(rows)\n"
        "for row in rows:\n"
        "    name=row['cell']\n"
        "    if row['status']!='ok':\n"
        "        assert name not in times and row['frame_seconds']=='' and "
        "row['same_flip']=='',row\n"
        "        continue\n"
        "    value=float(row['frame_seconds'])\n"
        "    assert abs(value-statistics.median(times[name]))<=1e-12*value,name\n"
        "    assert abs(float(row['fps'])*value-1)<1e-12\n"
        "    assert min(times[name])<=float(row['frame_seconds_low'])<=value\n"
        "    assert value<=float(row['frame_seconds_high'])<=max(times[name])\n"
        "    assert float(row['build_seconds'])==statistics.median(builds[name]),name\n"
        "    assert int(row['repetitions'])==len(times[name])\n"
        "    assert row['gpu_seconds_per_frame']==''\n";
    const char *path = arena_printf(world->arena, "%s/check.py", world->folder);
    struct error error = {0};
    assert_int_equal(file_write(path, script, strlen(script), &error), STATUS_OK);
    char *said;
    int code = shell(world->arena,
                     arena_printf(world->arena, "python3 %s %s %s/tables/results.csv 2>&1", path,
                                  raw, world->out),
                     &said);
    if (code != 0)
        fail_msg("%s", said);
}

static double mean_flip(const struct result *result)
{
    double sum = 0;
    for (size_t i = 0; i < result->views_count; i++)
        sum += result->views[i].same.value.flip / (double)result->views_count;
    return sum;
}

static void test_report__the_front_is_what_no_comparable_cell_beats(void **state)
{
    struct world *world = *state;
    size_t count, on_front = 0;
    struct summary *all = report_summaries(world->arena, world->run, &count);
    assert_int_equal(count, 24);
    for (size_t i = 0; i < count; i++) {
        const struct cell *a = &all[i].first->cell;
        bool beaten = all[i].repetitions == 0 || strcmp(a->method_name, "null") == 0;
        for (size_t k = 0; k < count && !beaten; k++) {
            const struct cell *b = &all[k].first->cell;
            if (k == i || !all[k].repetitions || strcmp(b->method_name, "null") == 0 ||
                strcmp(a->scene, b->scene) != 0 || a->trees != b->trees)
                continue;
            beaten = all[k].frame_seconds.value <= all[i].frame_seconds.value &&
                     mean_flip(all[k].first) <= mean_flip(all[i].first);
        }
        assert_int_equal(all[i].on_front, !beaten);
        on_front += all[i].on_front;
    }
    assert_true(on_front > 4);
}

static void test_report__a_failed_repetition_is_counted_and_gives_no_number(void **state)
{
    struct world *world = *state;
    size_t count;
    struct summary *all = report_summaries(world->arena, world->run, &count);
    for (size_t i = 0; i < count; i++) {
        const struct result *first = all[i].first;
        bool never = strcmp(first->cell.method_name, "polygons") == 0 &&
                     first->cell.lod == LOD_HIGH && first->cell.trees == 1000;
        bool once = strcmp(first->cell.method_name, "cross-quads") == 0 && first->cell.trees == 100;
        assert_int_equal(all[i].failures, never ? 5 : once ? 1 : 0);
        assert_int_equal(all[i].repetitions, never ? 0 : once ? 4 : 5);
        assert_int_equal(isnan(all[i].frame_seconds.value), never);
        assert_int_equal(first->status, never ? STATUS_TIMEOUT : STATUS_OK);
    }
}

static void test_report__failures_are_told_with_message_and_replay_command(void **state)
{
    struct world *world = *state;
    const char *page = content(world, "index.html");
    assert_true(
        has(page, "ran past 60 s in frame 3 &lt;&amp;&quot;quoted&quot;&gt; | 100 % of_it"));
    assert_true(has(page, "./treeline run --cell "
                          "'poplar-forest/polygons/trees=1000/lod=high/size=96x72/"
                          "target=rgba16f/seed=1' --timeout 60 --threads 2<"));
    assert_true(has(page, "signal 11"));
    assert_true(has(page, "<span class=\"bad\">timeout</span>"));
}

static void test_report__the_headline_reads_the_front_out(void **state)
{
    struct world *world = *state;
    struct book *book = book_make(world->arena, world->run);
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    answer_headline(book, out);
    fclose(out);
    /* The forest with the most trees is spoken about, where all triangles time out: by construction
     * quads are the fastest and most wrong, pruned triangles the slowest and most exact. */
    const char *quads = strstr(text, "cross-quads"), *triangles = strstr(text, "polygons");
    assert_true(has(text, "with 1,000 trees") || has(text, "with 1000 trees"));
    assert_false(has(text, "polygons lod=high"));
    assert_non_null(quads);
    assert_non_null(triangles);
    assert_true(quads < strstr(text, "is the fastest") &&
                strstr(text, "is the fastest") < triangles);
    assert_false(has(text, "null"));
    free(text);
}

static void test_report__a_tree_count_has_its_own_front_and_null_none(void **state)
{
    struct world *world = *state;
    struct book *book = book_make(world->arena, world->run);
    assert_int_equal(book->groups_count, 4);
    assert_int_equal(book->families_count, 2);
    size_t front[32];
    for (size_t g = 0; g < book->groups_count; g++) {
        size_t count = book_front(book, &book->groups[g], front);
        assert_true(count > 0);
        for (size_t i = 1; i < count; i++) {
            const struct row *quick = &book->rows[front[i - 1]], *slow = &book->rows[front[i]];
            assert_true(quick->values[COLUMN_frame_seconds] <= slow->values[COLUMN_frame_seconds]);
            assert_true(quick->values[COLUMN_same_flip] > slow->values[COLUMN_same_flip]);
            assert_true(quick->group == g && slow->group == g && !slow->is_floor);
        }
    }
}

/* Of one cell: the angles and errors that the plot's data has, in its order. */
static size_t plotted(const char *path, const char *label, double (*points)[2], size_t most)
{
    FILE *file = fopen(path, "r");
    char line[512] = "";
    size_t count = 0;
    while (file && !strstr(line, label) && fgets(line, sizeof line, file))
        ;
    while (file && count < most && fgets(line, sizeof line, file) &&
           sscanf(line, "%lf %lf", &points[count][0], &points[count][1]) == 2)
        count++;
    if (file)
        fclose(file);
    return count;
}

/* Walking in, the distance; going up at one distance, the elevation, in its order; nothing against
 * the azimuth, which never changes. */
static void test_report__errors_stand_against_what_the_camera_changes(void **state)
{
    struct world *world = *state;
    const char *walk = "walk-in-30", *forest = "poplar-forest-1000", *out = world->out;
    static const char *const kinds[] = {"distance", "elevation", "azimuth"};
    for (size_t k = 0; k < 3; k++)
        for (int walks = 0; walks < 2; walks++) {
            const char *path = arena_printf(world->arena, "%s/plots/%s-%s.svg", out, kinds[k],
                                            walks ? walk : forest);
            if (file_exists(path) != (k == (walks ? 0 : 1)))
                fail_msg("%s", path);
        }
    const char *data = arena_printf(world->arena, "%s/plots/elevation-%s.dat", out, forest);
    const struct book *book = book_make(world->arena, world->run);
    size_t cells = 0;
    for (size_t i = 0; i < book->rows_count; i++) {
        const struct row *row = &book->rows[i];
        if (row->trees != 1000 || !row->ok || row->is_floor)
            continue;
        double points[WORLD_VIEWS + 1][2];
        assert_int_equal(plotted(data, row->label, points, WORLD_VIEWS + 1), WORLD_VIEWS);
        for (size_t v = 0; v < WORLD_VIEWS; v++) {
            const struct result_view *view = &row->seen->views[WORLD_VIEWS - 1 - v];
            assert_true(fabs(points[v][0] - view->elevation_deg) < 1e-6);
            assert_true(fabs(points[v][1] - view->same.value.flip) < 1e-6);
        }
        cells++;
    }
    assert_int_equal(cells, WORLD_METHODS - 2); /* less null and the one that fails */
    assert_true(has(content(world, "index.html"), "<h2 id=\"angle\">"));
    struct run still = first_group(world);
    const char *folder = arena_printf(world->arena, "%s/still", world->folder);
    struct result *results = ARENA_ARRAY(world->arena, struct result, still.results_count);
    for (size_t i = 0; i < still.results_count; i++) {
        results[i] = still.results[i];
        results[i].views_count = results[i].views_count ? 2 : 0; /* two views are no curve */
    }
    still.results = results;
    assert_int_equal(report_write_run(world->arena, &still, folder, &world->error), STATUS_OK);
    const char *page = arena_printf(world->arena, "../still/%s", "index.html");
    assert_false(has(content(world, page), "<h2 id=\"angle\">"));
}

static void test_report__labels_tell_cells_apart_and_say_no_more(void **state)
{
    struct world *world = *state;
    struct book *book = book_make(world->arena, world->run);
    for (size_t i = 0; i < book->rows_count; i++)
        for (size_t k = 0; k < i; k++)
            assert_true(book->rows[i].group != book->rows[k].group ||
                        strcmp(book->rows[i].label, book->rows[k].label) != 0);
    assert_int_equal(book->series_count, WORLD_METHODS);
    for (size_t i = 0; i < book->rows_count; i++)
        assert_false(has(book->rows[i].label, "billboards") && has(book->rows[i].label, "lod"));
}

static void test_report__a_missing_picture_is_said_and_costs_nothing_else(void **state)
{
    struct world *world = *state;
    char *said;
    struct arena *arena = world->arena;
    const char *folder = arena_printf(arena, "%s/torn", world->folder);
    struct error error = {0};
    file_make_folder(folder, &error);
    shell(arena, arena_printf(arena, "cp -r %s/pictures %s/", world->folder, folder), &said);
    struct run run = first_group(world);
    run.folder = folder; /* no references there; one picture is gone, one is torn */
    const char *gone = run.results[1].views[0].picture, *torn = run.results[1].views[1].picture;
    unlink(arena_printf(arena, "%s/%s", folder, gone));
    assert_int_equal(truncate(arena_printf(arena, "%s/%s", folder, torn), 1000), 0);
    const char *out = arena_printf(arena, "%s/out", folder);
    assert_int_equal(report_write_run(arena, &run, out, &error), STATUS_OK);
    char *page = NULL;
    size_t size;
    assert_int_equal(
        file_read(arena, arena_printf(arena, "%s/index.html", out), 0, &page, &size, &error),
        STATUS_OK);
    assert_true(has(page, gone) && has(page, torn));
    assert_true(has(page, "no error maps without the reference"));
    assert_true(has(page, "could not be shown; each place says why"));
    assert_true(has(page, "<table class=\"results\">"));
}

static void test_report__without_gnuplot_tables_and_page_are_still_written(void **state)
{
    struct world *world = *state;
    struct arena *arena = world->arena;
    const char *out = arena_printf(arena, "%s/plain", world->folder);
    char *path = arena_strdup(arena, getenv("PATH"));
    struct error error = {0};
    setenv("PATH", world->folder, 1);
    struct run run = first_group(world);
    enum status status = report_write_run(arena, &run, out, &error);
    setenv("PATH", path, 1);
    assert_int_equal(status, STATUS_UNAVAILABLE);
    assert_true(has(error.text, "gnuplot"));
    assert_true(file_exists(arena_printf(arena, "%s/tables/results.csv", out)));
    assert_true(file_exists(arena_printf(arena, "%s/tables/results.tex", out)));
    assert_true(file_exists(arena_printf(arena, "%s/index.html", out)));
}

static void test_report__bad_folders_are_named(void **state)
{
    struct world *world = *state;
    struct error error = {0};
    assert_int_not_equal(report_write("/nowhere/at-all", world->out, &error), STATUS_OK);
    assert_true(has(error.text, "/nowhere/at-all"));
    const char *below_a_file = arena_printf(world->arena, "%s/tables/results.csv/x", world->out);
    assert_int_equal(report_write_run(world->arena, world->run, below_a_file, &error), STATUS_IO);
    assert_true(has(error.text, "results.csv"));
    struct run empty = {.folder = "some/run"};
    assert_int_equal(report_write_run(world->arena, &empty, world->out, &error), STATUS_INVALID);
    assert_true(has(error.text, "some/run"));
}

static void test_report__a_run_of_failures_alone_still_makes_a_page(void **state)
{
    struct world *world = *state;
    struct arena *arena = world->arena;
    struct run run = *world->run;
    run.results = ARENA_ARRAY(arena, struct result, run.results_count);
    run.results_count = 0;
    for (size_t i = 0; i < world->run->results_count; i++)
        if (world->run->results[i].status == STATUS_TIMEOUT)
            run.results[run.results_count++] = world->run->results[i];
    assert_int_equal(run.results_count, WORLD_ROUNDS);
    struct error error = {0};
    const char *out = arena_printf(arena, "%s/failures", world->folder);
    if (report_write_run(arena, &run, out, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    char *said;
    if (shell(arena, arena_printf(arena, "python3 tests/page_check.py %s 2>&1", out), &said) != 0)
        fail_msg("%s", said);
}

static void test_report__numbers_are_rounded_and_never_nan(void **state)
{
    (void)state;
    static const struct {
        double value;
        const char *plain, *brief, *exact;
    } cases[] = {
        {0, "0", "0", "0"},
        {0.0123456, "0.0123", "0.0123", "0.0123456"},
        {12.3456, "12.3", "12.3", "12.3456"},
        {98286, "98,286", "98.3 k", "98286"},
        {9828600, "9,828,600", "9.83 M", "9828600"},
        {999999, "999,999", "1.00 M", "999999"},
        {-4.5, "-4.50", "-4.50", "-4.5"},
        {NAN, "\u2013", "\u2013", ""},
        {INFINITY, "\u2013", "\u2013", ""},
        {0.1 + 0.2, "0.300", "0.300", "0.30000000000000004"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_string_equal(number_plain(cases[i].value, 3).text, cases[i].plain);
        assert_string_equal(number_exact(cases[i].value).text, cases[i].exact);
        assert_string_equal(number_short(cases[i].value, 3).text, cases[i].brief);
    }
    assert_string_equal(number_plain(1e5, 15).text, "100,000"); /* trees are counted exactly */
    assert_string_equal(number_plain(1234567, 15).text, "1,234,567");
    assert_string_equal(number_seconds(0.0123).text, "12.3 ms");
    assert_string_equal(number_seconds(4.5).text, "4.50 s");
    assert_string_equal(number_seconds(NAN).text, "\u2013");
}

static void test_report__every_axis_has_ticks_inside_its_range(void **state)
{
    struct world *world = *state;
    static const double ranges[][2] = {{1, 1},   {0.05, 0.06}, {3, 40},  {1e-7, 1e4},
                                       {1, 1e6}, {0, 0},       {NAN, -1}};
    for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++) {
        struct axis axis = axis_empty();
        axis_add(&axis, ranges[i][0]);
        axis_add(&axis, ranges[i][1]);
        axis_widen(&axis, 0.1, 0.1);
        assert_true(axis.low > 0 && axis.low < axis.high && isfinite(axis.high));
        char *text = NULL;
        size_t size = 0;
        FILE *out = open_memstream(&text, &size);
        axis_put(&axis, "x", out);
        fclose(out);
        int ticks = 0;
        const char *at = strstr(text, "tics (");
        for (at = at ? strchr(at, '"') : NULL; at; at = strchr(at, '"')) {
            double value = strtod(strchr(at + 1, '"') + 1, NULL);
            assert_true(value >= axis.low * 0.999999 && value <= axis.high * 1.000001);
            ticks++;
            at = strchr(at + 1, '"') + 1;
        }
        free(text);
        assert_in_range(ticks, 3, 12);
    }
    (void)world;
}

static void test_gnuplot__complaints_and_overtime_are_told(void **state)
{
    struct world *world = *state;
    struct error error = {0};
    const char *wrong = "set termnal svg\n", *endless = "pause 30\n";
    struct arena *arena = world->arena;
    file_write(arena_printf(arena, "%s/wrong.gp", world->folder), wrong, strlen(wrong), &error);
    file_write(arena_printf(arena, "%s/endless.gp", world->folder), endless, strlen(endless),
               &error);
    assert_int_equal(gnuplot_run(world->folder, "wrong.gp", 20, &error), STATUS_IO);
    assert_true(has(error.text, "wrong.gp") && has(error.text, "line 1"));
    assert_int_equal(gnuplot_run(world->folder, "endless.gp", 0.3, &error), STATUS_TIMEOUT);
    assert_int_equal(gnuplot_run("/nowhere", "x.gp", 5, &error), STATUS_IO);
}

/* A machine that fill binds, and of billboards samples. */
static void calibrate_world(struct arena *arena, struct run *run)
{
    static const struct {
        enum calibration_index index;
        double rate;
    } known[] = {{CALIBRATION_fill_opaque, 400e6},
                 {CALIBRATION_calls_bare, 1e6},
                 {CALIBRATION_samples_bilinear, 80e6},
                 {CALIBRATION_memory_copy, 8e9}};
    struct calibration *machine = run->measured = ARENA_NEW(arena, struct calibration);
    *machine = (struct calibration){.width_px = WORLD_WIDTH,
                                    .height_px = WORLD_HEIGHT,
                                    .format = TARGET_RGBA16F,
                                    .threads = 2,
                                    .core_ghz = 2.4,
                                    .seconds = 3.5,
                                    .backend = "osmesa",
                                    .renderer = run->results->renderer};
    for (size_t i = 0; i < CALIBRATION_COUNT; i++)
        machine->measures[i] = (struct calibration_measure){{NAN, NAN, NAN}, NAN};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        machine->measures[known[i].index].rate =
            (struct interval){known[i].rate, 0.95 * known[i].rate, 1.05 * known[i].rate};
    run->measured_count = 1;
    calibrations_merge(arena, run);
    for (size_t i = 0; i < run->results_count; i++) {
        struct result *result = &run->results[i];
        bool sampled = strcmp(result->cell.method_name, "billboards") == 0;
        result->samples = sampled ? 2 * result->fragments : NAN;
        result->moved_bytes = 8.0 * WORLD_WIDTH * WORLD_HEIGHT;
    }
}

/* test_report page RUN OUT: writes the synthetic run and its report, for tests/page.sh. */
static int write_page(const char *run_folder, const char *out)
{
    struct arena *arena = arena_create(0);
    struct error error = {0};
    enum status status = file_make_folder(run_folder, &error);
    struct run *run = world_run(arena, run_folder);
    calibrate_world(arena, run);
    if (status == STATUS_OK)
        status = report_write_run(arena, run, out, &error);
    if (status != STATUS_OK)
        fprintf(stderr, "%s\n", error.text);
    arena_destroy(arena);
    return (int)status;
}

/* test_report many RUN OUT: the first round's cells again and again, as 200 scenes of 50 cells. */
static int write_many(const char *folder, const char *out)
{
    enum { SCENES = 200, CELLS = 50 };
    struct arena *arena = arena_create(0);
    struct error error = {0};
    enum status status = file_make_folder(folder, &error);
    struct run run = *world_run(arena, folder);
    const struct result *seeds = run.results;
    run.results = ARENA_ARRAY(arena, struct result, SCENES * CELLS);
    run.results_count = SCENES * CELLS;
    for (size_t i = 0; i < run.results_count; i++) {
        struct result *result = &run.results[i];
        struct cell *cell = &result->cell;
        size_t k = i % CELLS;
        *result = seeds[k % (4 * WORLD_METHODS)];
        cell->scene = arena_printf(arena, "scene-%03zu", i / CELLS);
        cell->trees = 10 * (1 + k % 3);
        cell->options = arena_printf(arena, "variant=%zu", k);
        cell->name = arena_printf(arena, "%s/%s:%s/trees=%zu", cell->scene, cell->method_name,
                                  cell->options, cell->trees);
        result->frame_seconds = ARENA_ARRAY(arena, double, WORLD_FRAMES);
        for (size_t f = 0; f < result->frames_count; f++)
            result->frame_seconds[f] =
                seeds[k % (4 * WORLD_METHODS)].frame_seconds[f] * (1 + 1e-3 * (double)(i % 997));
    }
    if (status == STATUS_OK)
        status = report_write_run(arena, &run, out, &error);
    if (status != STATUS_OK)
        fprintf(stderr, "%s\n", error.text);
    arena_destroy(arena);
    return (int)status;
}

int main(int count, char **arguments)
{
    if (count == 4 && strcmp(arguments[1], "page") == 0)
        return write_page(arguments[2], arguments[3]);
    if (count == 4 && strcmp(arguments[1], "many") == 0)
        return write_many(arguments[2], arguments[3]);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_report__every_file_is_well_formed_and_self_contained),
        cmocka_unit_test(test_report__the_medians_in_the_csv_are_those_of_python),
        cmocka_unit_test(test_report__the_front_is_what_no_comparable_cell_beats),
        cmocka_unit_test(test_report__a_failed_repetition_is_counted_and_gives_no_number),
        cmocka_unit_test(test_report__failures_are_told_with_message_and_replay_command),
        cmocka_unit_test(test_report__the_headline_reads_the_front_out),
        cmocka_unit_test(test_report__a_tree_count_has_its_own_front_and_null_none),
        cmocka_unit_test(test_report__errors_stand_against_what_the_camera_changes),
        cmocka_unit_test(test_report__labels_tell_cells_apart_and_say_no_more),
        cmocka_unit_test(test_report__a_missing_picture_is_said_and_costs_nothing_else),
        cmocka_unit_test(test_report__without_gnuplot_tables_and_page_are_still_written),
        cmocka_unit_test(test_report__bad_folders_are_named),
        cmocka_unit_test(test_report__a_run_of_failures_alone_still_makes_a_page),
        cmocka_unit_test(test_report__numbers_are_rounded_and_never_nan),
        cmocka_unit_test(test_report__every_axis_has_ticks_inside_its_range),
        cmocka_unit_test(test_gnuplot__complaints_and_overtime_are_told),
    };
    return cmocka_run_group_tests(tests, world_setup, world_teardown);
}
