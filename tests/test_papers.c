/* Papers beside a run: ratios and verdicts on a synthetic run whose every ratio is known by
 * construction, under a machine whose speed drifts by a factor of three from round to round. */
#include "any_result.h"

#include "base/file.h"
#include "report/paper.h"
#include "report/report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { ROUNDS = 5 };
static const double drift[ROUNDS] = {1, 0.4, 1.2, 0.7, 0.9};

/* A cell of the synthetic run: its rate in a round is rate * wobble^(+-1) * drift. */
struct kind {
    const char *scene, *method, *options;
    size_t trees;
    enum lod lod;
    double rate, wobble;
    bool fails;
};

static const struct {
    size_t trees;
    enum lod lod;
    double plain, fog; /* as Senegas 2001 prints them */
} printed[] = {
    {200, LOD_LOW, 16.84, 16.9}, {200, LOD_INTERMEDIATE, 8.66, 7.51},  {200, LOD_HIGH, 2.24, 2.28},
    {500, LOD_LOW, 8.22, 8.16},  {500, LOD_INTERMEDIATE, 4.24, 3.98},  {500, LOD_HIGH, 1.04, 1.03},
    {1000, LOD_LOW, 5.31, 4.46}, {1000, LOD_INTERMEDIATE, 2.51, 2.48}, {1000, LOD_HIGH, 0.64, 0.63},
};
enum { PRINTED = sizeof printed / sizeof *printed };

static void add(struct arena *arena, struct run *run, const struct kind *kind, size_t rounds)
{
    for (size_t round = 0; round < rounds; round++) {
        struct result *result = &run->results[run->results_count++];
        struct cell cell = {.scene = kind->scene,
                            .method_name = kind->method,
                            .options = kind->options,
                            .trees = kind->trees,
                            .lod = kind->lod,
                            .width_px = 800,
                            .height_px = 600,
                            .format = TARGET_RGBA16F,
                            .seed = 1};
        cell.name =
            arena_printf(arena, "%s/%s%s%s/trees=%zu/lod=%s/size=800x600/target=rgba16f/seed=1",
                         cell.scene, cell.method_name, *cell.options ? ":" : "", cell.options,
                         cell.trees, lod_word(cell.lod));
        result_init(result, &cell, (int)round);
        result->instances = kind->trees;
        result->renderer = "llvmpipe";
        if (kind->fails) {
            result->status = STATUS_TIMEOUT;
            result->message = "ran past 60 s";
            continue;
        }
        double wobble = round % 2 ? 1 / kind->wobble : kind->wobble;
        result->frames_count = 3;
        result->frame_seconds = ARENA_ARRAY(arena, double, 3);
        for (int i = 0; i < 3; i++) /* the median is the middle one */
            result->frame_seconds[i] = (0.8 + 0.2 * i) / (kind->rate * wobble * drift[round]);
    }
}

/* path=naive: ten times the printed rates, one cell timing out. Default: 100 frames a second at
 * 200 trees and the high level, 1/sqrt(trees); the intermediate level 1.5 times that, the low one
 * 1.5 times more in the mean and 1.3 to 1.73 by turns; fog costs a half; one cell missing.
 * Polygons: trees to the power -1.3. */
static struct run *make_run(struct arena *arena, const char *folder, size_t rounds)
{
    struct run *run = ARENA_NEW(arena, struct run);
    run->folder = folder;
    run->provenance = somewhere();
    run->provenance.plan = "senegas";
    run->results = ARENA_ARRAY(arena, struct result, 100 * rounds);
    for (size_t i = 0; i < PRINTED; i++)
        for (int fog = 0; fog < 2; fog++) {
            struct kind kind = {.scene = fog ? "poplar-fog" : "poplar-forest",
                                .method = "shaded-texels",
                                .options = "path=naive",
                                .trees = printed[i].trees,
                                .lod = printed[i].lod,
                                .rate = 10 * (fog ? printed[i].fog : printed[i].plain),
                                .wobble = 1,
                                .fails = fog && i == PRINTED - 1};
            add(arena, run, &kind, rounds);
            bool missing = !fog && kind.trees == 500 && kind.lod == LOD_LOW;
            kind.options = "";
            kind.fails = false;
            kind.rate = (fog ? 50 : 100) * sqrt(200.0 / (double)kind.trees);
            kind.rate *= kind.lod == LOD_HIGH ? 1 : kind.lod == LOD_INTERMEDIATE ? 1.5 : 2.25;
            kind.wobble = kind.lod == LOD_LOW ? 1.3 / 1.5 : 1;
            if (!missing)
                add(arena, run, &kind, rounds);
        }
    for (size_t trees = 1; trees <= 200; trees += 199) {
        const struct kind kind = {.scene = "poplar-forest",
                                  .method = "polygons",
                                  .options = "",
                                  .trees = trees,
                                  .lod = LOD_HIGH,
                                  .rate = 30 * pow((double)trees, -1.3),
                                  .wobble = 1};
        add(arena, run, &kind, rounds);
    }
    return run;
}

struct world {
    struct arena *arena;
    struct book *book;
    struct paper paper;
    struct paper_beside *beside;
};

static struct world make_world(struct arena *arena, size_t rounds)
{
    struct world world = {.arena = arena};
    struct error error = {0};
    if (paper_read(arena, "reports/papers/senegas-2001.json", &world.paper, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    size_t count = 0;
    world.book = book_make(arena, make_run(arena, "x", rounds));
    world.beside = papers_beside(world.book, &world.paper, 1, &count);
    assert_int_equal(count, 1);
    return world;
}

static int setup(void **state)
{
    *state = arena_create(0);
    return 0;
}

static int teardown(void **state)
{
    arena_destroy(*state);
    return 0;
}

static const struct paper_block *block_of(const struct world *world, const char *method,
                                          const char *options)
{
    for (size_t i = 0; i < world->beside->blocks_count; i++) {
        const struct paper_block *block = &world->beside->blocks[i];
        if (!strcmp(block->example->method, method) &&
            !strcmp(block->example->seen->cell.options, options))
            return block;
    }
    fail_msg("no block %s:%s", method, options);
    return NULL;
}

static const struct paper_finding *finding_of(const struct world *world, const char *id,
                                              const char *options)
{
    for (size_t i = 0; i < world->beside->findings_count; i++) {
        const struct paper_finding *finding = &world->beside->findings[i];
        if (!strcmp(finding->claim->id, id) &&
            (!finding->example || !strcmp(finding->example->seen->cell.options, options)))
            return finding;
    }
    fail_msg("no finding %s", id);
    return NULL;
}

static void near(double value, double wanted)
{
    if (!(fabs(value - wanted) <= 1e-9 * fabs(wanted)))
        fail_msg("%.12g instead of %.12g", value, wanted);
}

static void test_papers__ratios_are_those_of_construction_whatever_the_machine_does(void **state)
{
    struct world world = make_world(*state, ROUNDS);
    assert_int_equal(world.beside->blocks_count, 3);
    const struct paper_block *naive = block_of(&world, "shaded-texels", "path=naive");
    assert_int_equal(naive->lines_count, 2 * PRINTED);
    for (size_t i = 0; i + 1 < naive->lines_count; i++) {
        const struct paper_line *line = &naive->lines[i];
        double rate = i % 2 ? printed[i / 2].fog : printed[i / 2].plain;
        assert_int_equal(line->printed->cell.trees, printed[i / 2].trees);
        assert_int_equal(line->printed->cell.lod, printed[i / 2].lod);
        near(line->printed->value, rate);
        near(line->printed_ratio, rate / 2.24);
        near(line->ratio.value, rate / 2.24);
        near(line->ratio.low, rate / 2.24);
        near(line->ratio.high, rate / 2.24);
        near(line->value.value, 10 * rate * 0.9); /* the median drift */
        assert_int_equal(line->rounds, ROUNDS);
    }
    const struct paper_block *polygons = block_of(&world, "polygons", "");
    near(polygons->lines[1].ratio.value, pow(200, -1.3));
    near(polygons->lines[1].printed_ratio, 0.135 / 27);
}

static void test_papers__a_failed_and_a_missing_cell_give_no_number(void **state)
{
    struct world world = make_world(*state, ROUNDS);
    const struct paper_block *naive = block_of(&world, "shaded-texels", "path=naive");
    const struct paper_line *failed = &naive->lines[2 * PRINTED - 1];
    assert_non_null(failed->ours);
    assert_int_equal(failed->rounds, 0);
    assert_true(isnan(failed->value.value) && isnan(failed->ratio.value));
    const struct paper_block *fast = block_of(&world, "shaded-texels", "");
    for (size_t i = 0; i < fast->lines_count; i++) {
        const struct paper_line *line = &fast->lines[i];
        bool missing = i == 6;
        assert_int_equal(line->ours == NULL, missing);
        assert_int_equal(isnan(line->ratio.value), missing);
    }
}

static void test_papers__without_its_base_row_a_variant_has_rates_but_no_ratios(void **state)
{
    struct arena *arena = *state;
    struct world world = make_world(arena, ROUNDS);
    struct run *run = make_run(arena, "x", ROUNDS);
    for (size_t i = 0; i < run->results_count; i++)
        if (run->results[i].cell.trees == 200 && run->results[i].cell.lod == LOD_HIGH &&
            !strcmp(run->results[i].cell.scene, "poplar-forest"))
            run->results[i].status = STATUS_CRASH;
    size_t count = 0;
    world.book = book_make(arena, run);
    world.beside = papers_beside(world.book, &world.paper, 1, &count);
    const struct paper_block *naive = block_of(&world, "shaded-texels", "path=naive");
    assert_false(isnan(naive->lines[0].value.value));
    for (size_t i = 0; i < naive->lines_count; i++)
        assert_true(isnan(naive->lines[i].ratio.value));
}

static void test_papers__verdicts_follow_from_interval_and_band(void **state)
{
    struct world world = make_world(*state, ROUNDS);
    double product = 1;
    for (size_t i = 0; i + 1 < PRINTED; i++) /* the last pair's fog fails */
        product *= printed[i].fog / printed[i].plain;
    const struct paper_finding *fog = finding_of(&world, "senegas-fog-is-free", "path=naive");
    assert_int_equal(fog->pairs, 9);
    assert_int_equal(fog->usable, 8);
    near(fog->ours.value, pow(product, 1 / 8.0));
    near(fog->ours.high, pow(product, 1 / 8.0));
    near(fog->smallest, 4.46 / 5.31);
    near(fog->largest, 2.28 / 2.24);
    near(fog->printed.value, pow(product * 0.63 / 0.64, 1 / 9.0));
    assert_int_equal(fog->verdict, PAPER_HOLDS);
    assert_non_null(strstr(fog->reason, "1 of 9 left out"));
    const struct paper_finding *slow = finding_of(&world, "senegas-fog-is-free", "");
    assert_int_equal(slow->pairs, 8); /* one cell is not in the run */
    near(slow->ours.value, 0.5);
    assert_int_equal(slow->verdict, PAPER_FAILS);
    assert_int_equal(finding_of(&world, "senegas-lod-4x", "path=naive")->verdict, PAPER_HOLDS);
    const struct paper_finding *lod = finding_of(&world, "senegas-lod-4x", "");
    near(lod->ours.value, 1.5);
    assert_int_equal(lod->pairs, 6);
    assert_int_equal(lod->verdict, PAPER_FAILS);
    const struct paper_finding *low = finding_of(&world, "senegas-low-2x", "");
    near(low->ours.value, 1.3); /* three rounds of five */
    assert_true(low->ours.low <= 1.3 && low->ours.high > 1.5);
    assert_int_equal(low->verdict, PAPER_OPEN);
    const struct paper_finding *growth = finding_of(&world, "senegas-polygons-linear", "");
    near(growth->ours.value, -1.3);
    near(growth->printed.value, -1); /* 27 at 1, 0.135 at 200 */
    assert_int_equal(growth->verdict, PAPER_FAILS);
}

static void test_papers__what_no_cell_decides_is_not_measured(void **state)
{
    struct world world = make_world(*state, ROUNDS);
    static const char *const ids[] = {"senegas-same-cost-as-unshaded", "senegas-not-fill-bound",
                                      "senegas-dilation", "senegas-oblique-holes"};
    for (size_t i = 0; i < sizeof ids / sizeof *ids; i++) {
        const struct paper_finding *finding = finding_of(&world, ids[i], "");
        assert_int_equal(finding->verdict, PAPER_NOT_MEASURED);
        assert_true(isnan(finding->ours.value));
        assert_true(*finding->reason);
    }
}

static void test_papers__a_claim_on_errors_is_decided_by_the_errors_themselves(void **state)
{
    struct arena *arena = *state;
    static const double flips[] = {0.10, 0.13}; /* whole leaves, cut ones */
    for (int swap = 0; swap < 2; swap++) {
        struct world world = make_world(arena, 1);
        struct run *run = make_run(arena, "x", 1);
        for (int cut = 0; cut < 2; cut++) {
            const struct kind kind = {.scene = "single-tree",
                                      .method = "shaded-texels",
                                      .options = cut ? "path=naive,cut=clip" : "path=naive",
                                      .trees = 1,
                                      .lod = LOD_HIGH,
                                      .rate = 10,
                                      .wobble = 1};
            add(arena, run, &kind, 1);
            struct result *result = &run->results[run->results_count - 1];
            result->views_count = 1;
            result->views = ARENA_ARRAY(arena, struct result_view, 1);
            result->views->compared = true;
            result->views->same.value.flip = flips[cut ^ swap];
        }
        size_t count = 0;
        world.book = book_make(arena, run);
        world.beside = papers_beside(world.book, &world.paper, 1, &count);
        const struct paper_finding *finding =
            finding_of(&world, "senegas-centroid-slicing", "path=naive,cut=clip");
        near(finding->ours.value, swap ? 0.10 / 0.13 : 1.3);
        assert_int_equal(finding->verdict, swap ? PAPER_FAILS : PAPER_HOLDS);
        assert_int_equal(finding_of(&world, "senegas-dilation", "")->verdict, PAPER_NOT_MEASURED);
    }
}

static void test_papers__errors_between_two_directions_are_of_the_views_from_there(void **state)
{
    struct arena *arena = *state;
    static const double azimuths[] = {90, 135, 132, 270}, holes[] = {0.010, 0.012, 0.016, 9};
    for (int missing = 0; missing < 2; missing++) {
        struct world world = make_world(arena, 1);
        struct run *run = make_run(arena, "x", 1);
        const struct kind kind = {.scene = "closed-azimuth",
                                  .method = "shaded-texels",
                                  .options = "path=naive",
                                  .trees = 1,
                                  .lod = LOD_HIGH,
                                  .rate = 10,
                                  .wobble = 1};
        add(arena, run, &kind, 1);
        struct result *result = &run->results[run->results_count - 1];
        result->views_count = 4;
        result->views = ARENA_ARRAY(arena, struct result_view, 4);
        for (int v = 0; v < 4; v++) {
            result->views[v].compared = !(missing && v == 0);
            result->views[v].azimuth_deg = azimuths[v];
            result->views[v].same.value.coverage = holes[v];
        }
        size_t count = 0;
        world.book = book_make(arena, run);
        world.beside = papers_beside(world.book, &world.paper, 1, &count);
        const struct paper_finding *finding =
            finding_of(&world, "senegas-oblique-holes", "path=naive");
        assert_int_equal(finding->verdict, missing ? PAPER_NOT_MEASURED : PAPER_HOLDS);
        if (!missing)
            near(finding->ours.value, 0.014 / 0.010);
        assert_int_equal(finding_of(&world, "senegas-oblique-holes-closed", "")->verdict,
                         PAPER_NOT_MEASURED);
    }
}

static void test_papers__one_and_two_rounds_leave_every_claim_open(void **state)
{
    for (size_t rounds = 1; rounds <= 2; rounds++) {
        struct world world = make_world(*state, rounds);
        for (size_t i = 0; i < world.beside->findings_count; i++) {
            const struct paper_finding *finding = &world.beside->findings[i];
            assert_int_equal(finding->verdict, finding->rounds ? PAPER_OPEN : PAPER_NOT_MEASURED);
            assert_true(finding->rounds <= rounds);
        }
        const struct paper_line *line = block_of(&world, "polygons", "")->lines;
        assert_int_equal(line[1].rounds, rounds);
        near(line[1].ratio.value, pow(200, -1.3));
    }
}

static void test_papers__a_run_without_a_printed_cell_has_no_section(void **state)
{
    struct arena *arena = *state;
    struct world world = make_world(arena, ROUNDS);
    struct run *run = make_run(arena, "x", ROUNDS);
    for (size_t i = 0; i < run->results_count; i++)
        run->results[i].cell.width_px = 400; /* another size is another table */
    size_t count = 1;
    papers_beside(book_make(arena, run), &world.paper, 1, &count);
    assert_int_equal(count, 0);
}

static void test_papers__claims_without_tables_stand_beside_a_run_that_decides_one(void **state)
{
    struct arena *arena = *state;
    struct world world = make_world(arena, ROUNDS);
    size_t count = 0;
    world.paper.tables_count = 0;
    world.beside = papers_beside(world.book, &world.paper, 1, &count);
    assert_int_equal(count, 1);
    assert_int_equal(world.beside->blocks_count, 0);
    assert_true(world.beside->findings_count > 0);
    for (size_t i = 0; i < world.paper.claims_count; i++)
        world.paper.claims[i].of.method = "unheard-of";
    papers_beside(world.book, &world.paper, 1, &count);
    assert_int_equal(count, 0);
}

static void add_conifers(struct arena *arena, struct run *run, const char *scene,
                         const char *options, size_t trees, double rate)
{
    const struct kind kind = {scene, "conifers", options, trees, LOD_AUTO, rate, 1.01, false};
    add(arena, run, &kind, ROUNDS);
}

static struct paper conifers_paper(struct arena *arena)
{
    struct error error = {0};
    struct paper paper;
    if (paper_read(arena, "reports/papers/hattab-babahenini-djedi.json", &paper, &error))
        fail_msg("%s", error.text);
    return paper;
}

/* Levels and needles alone on a walk: a claim of the conifers' paper, none of its tables; on their
 * landscape it would be no claim of its own. */
static void test_papers__a_claim_on_a_scene_of_no_table_stands_alone(void **state)
{
    static const char *const options[] = {"", "level=needle"};
    struct paper paper = conifers_paper(*state);
    struct run *run = make_run(*state, "x", ROUNDS);
    run->results_count = 0;
    for (size_t i = 0; i < 2; i++)
        add_conifers(*state, run, "pines-walk", options[i], 24, i ? 1 : 3);
    size_t count, saves = 0;
    struct paper_beside *beside = papers_beside(book_make(*state, run), &paper, 1, &count);
    assert_int_equal(count, 1);
    assert_int_equal(beside->blocks_count, 0);
    for (size_t i = 0; i < beside->findings_count; i++)
        if (strcmp(beside->findings[i].claim->id, "conifer-lod-saves") == 0) {
            assert_int_equal(beside->findings[i].verdict, PAPER_HOLDS);
            near(beside->findings[i].ours.value, 3);
            saves++;
        }
    assert_int_equal(saves, 1);
    for (size_t i = 0; i < paper.claims_count; i++)
        if (paper.claims[i].of.scene)
            paper.claims[i].of.scene = "pines";
    for (size_t i = 0; i < run->results_count; i++)
        run->results[i].cell.scene = "pines";
    papers_beside(book_make(*state, run), &paper, 1, &count);
    assert_int_equal(count, 0);
}

static void test_papers__a_variant_of_one_printed_row_has_no_table(void **state)
{
    struct arena *arena = *state;
    struct world world = make_world(arena, ROUNDS);
    struct run *run = make_run(arena, "x", ROUNDS);
    const struct kind swept = {.scene = "poplar-forest",
                               .method = "shaded-texels",
                               .options = "slices=8",
                               .trees = 1000,
                               .lod = LOD_HIGH,
                               .rate = 99,
                               .wobble = 1};
    add(arena, run, &swept, ROUNDS);
    size_t count = 0;
    world.beside = papers_beside(book_make(arena, run), &world.paper, 1, &count);
    assert_int_equal(count, 1);
    assert_int_equal(world.beside->blocks_count, 3);
}

static void test_papers__worst_and_best_are_the_slowest_and_fastest_frames(void **state)
{
    struct arena *arena = *state;
    struct run *run = make_run(arena, "x", ROUNDS);
    double *path = ARENA_ARRAY(arena, double, 101);
    for (int i = 0; i <= 100; i++) /* 10 to 30 ms, not in order */
        path[i] = 0.01 + 0.0002 * (i * 37 % 101);
    for (size_t i = 0; i < run->results_count; i++) {
        run->results[i].frame_seconds = path;
        run->results[i].frames_count = 101;
    }
    struct book *book = book_make(arena, run);
    size_t rounds = 0;
    for (int unit = 0; unit < 2; unit++) {
        static const double seconds[] = {
            [PAPER_MEDIAN] = 0.02, [PAPER_WORST] = 0.029, [PAPER_BEST] = 0.011};
        for (int k = 0; k < 3; k++) {
            const struct paper_sample *samples =
                paper_samples(book, (enum paper_unit)unit, (enum paper_statistic)k, &rounds);
            near(samples[0].values[0], unit == PAPER_FPS ? 1 / seconds[k] : seconds[k]);
        }
    }
}

/* The paper of the conifers, on runs whose times are a straight line and an exponential of the
 * trees. */
static void test_papers__a_law_is_judged_by_its_residuals(void **state)
{
    static const size_t trees[] = {36, 40, 51, 68, 85, 102, 113, 204};
    for (int exponential = 0; exponential < 2; exponential++) {
        struct paper paper = conifers_paper(*state);
        struct run *run = make_run(*state, "x", ROUNDS);
        run->results_count = 0;
        for (size_t i = 0; i < sizeof trees / sizeof *trees; i++) {
            double n = (double)trees[i], seconds = exponential ? exp(0.01 * n) : 2 + 0.1 * n;
            add_conifers(*state, run, "pines", "", trees[i], 1 / seconds);
        }
        size_t count;
        struct book *book = book_make(*state, run);
        struct paper_beside *beside = papers_beside(book, &paper, 1, &count);
        assert_int_equal(count, 1);
        assert_int_equal(beside->blocks_count, 1);
        const struct growth_fit *fits = beside->blocks->fits;
        assert_true(fits[exponential ? GROWTH_EXPONENTIAL : GROWTH_LINEAR].residual < 0.02);
        assert_true(fits[exponential ? GROWTH_LINEAR : GROWTH_EXPONENTIAL].residual > 0.1);
        assert_true(fabs(fits[GROWTH_EXPONENTIAL].b - 0.01) < 1e-4 || !exponential);
        for (size_t i = 0; i < beside->findings_count; i++)
            if (beside->findings[i].claim->kind == PAPER_LAW)
                assert_int_equal(beside->findings[i].verdict,
                                 exponential ? PAPER_HOLDS : PAPER_FAILS);
    }
}

/* Both ways of conifers in both tables: four blocks, two variants. */
static void test_papers__a_variant_has_one_number_in_all_tables(void **state)
{
    static const char *const options[] = {"", "path=naive,shaders=paper"};
    static const struct {
        const char *scene;
        size_t trees;
    } cells[] = {{"pine-16-8-16", 1}, {"pine-16-8-20", 1}, {"pines", 36}, {"pines", 40}};
    struct paper paper = conifers_paper(*state);
    struct run *run = make_run(*state, "x", ROUNDS);
    run->results_count = 0;
    for (size_t i = 0; i < 8; i++) {
        add_conifers(*state, run, cells[i / 2].scene, options[(i + (i > 3)) % 2],
                     cells[i / 2].trees, 1);
    }
    size_t count, firsts = 0;
    struct paper_beside *beside = papers_beside(book_make(*state, run), &paper, 1, &count);
    assert_int_equal(beside->blocks_count, 4);
    for (size_t b = 0; b < 4; b++) {
        bool is_first, other_first;
        size_t number = paper_variant_number(*state, beside, b, &is_first);
        assert_true(number < 2);
        firsts += is_first;
        for (size_t k = 0; k < b; k++) {
            bool alike = strcmp(beside->blocks[k].example->seen->cell.options,
                                beside->blocks[b].example->seen->cell.options) == 0;
            assert_int_equal(alike,
                             paper_variant_number(*state, beside, k, &other_first) == number);
        }
    }
    assert_int_equal(firsts, 2);
}

/* test_papers page RUN OUT: the report of the synthetic run, for tests/page.sh. */
static int write_page(const char *folder, const char *out)
{
    struct arena *arena = arena_create(0);
    struct error error = {0};
    enum status status = report_write_run(arena, make_run(arena, folder, ROUNDS), out, &error);
    if (status != STATUS_OK)
        fprintf(stderr, "%s\n", error.text);
    arena_destroy(arena);
    return (int)status;
}

int main(int count, char **arguments)
{
    setenv("TREELINE_DATA", ".", 0);
    if (count == 4 && strcmp(arguments[1], "page") == 0)
        return write_page(arguments[2], arguments[3]);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_papers__ratios_are_those_of_construction_whatever_the_machine_does),
        cmocka_unit_test(test_papers__a_failed_and_a_missing_cell_give_no_number),
        cmocka_unit_test(test_papers__without_its_base_row_a_variant_has_rates_but_no_ratios),
        cmocka_unit_test(test_papers__verdicts_follow_from_interval_and_band),
        cmocka_unit_test(test_papers__what_no_cell_decides_is_not_measured),
        cmocka_unit_test(test_papers__a_claim_on_errors_is_decided_by_the_errors_themselves),
        cmocka_unit_test(test_papers__errors_between_two_directions_are_of_the_views_from_there),
        cmocka_unit_test(test_papers__one_and_two_rounds_leave_every_claim_open),
        cmocka_unit_test(test_papers__a_run_without_a_printed_cell_has_no_section),
        cmocka_unit_test(test_papers__claims_without_tables_stand_beside_a_run_that_decides_one),
        cmocka_unit_test(test_papers__a_claim_on_a_scene_of_no_table_stands_alone),
        cmocka_unit_test(test_papers__a_variant_of_one_printed_row_has_no_table),
        cmocka_unit_test(test_papers__worst_and_best_are_the_slowest_and_fastest_frames),
        cmocka_unit_test(test_papers__a_law_is_judged_by_its_residuals),
        cmocka_unit_test(test_papers__a_variant_has_one_number_in_all_tables),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
