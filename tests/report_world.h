/* A synthetic run for the tests of the report: plausible numbers and small pictures, made from a
 * seed. */
#ifndef TREELINE_TESTS_REPORT_WORLD_H
#define TREELINE_TESTS_REPORT_WORLD_H

#include "base/file.h"
#include "base/random.h"
#include "results/result.h"
#include "truth/frame.h"
#include "truth/metrics.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WORLD_WIDTH = 96, WORLD_HEIGHT = 72, WORLD_ROUNDS = 5, WORLD_FRAMES = 9, WORLD_VIEWS = 3 };

struct world_method {
    const char *name, *options;
    enum lod lod;
    double seconds_1, exponent; /* frame time of one tree, growth */
    double error;               /* strength of its distortion */
    unsigned effects;
};

static const struct world_method world_methods[] = {
    {"null", "", LOD_HIGH, 0.0009, 0.0, 1.0, EFFECTS_ALL},
    {"polygons", "", LOD_HIGH, 0.020, 0.85, 0.03, EFFECTS_ALL & ~EFFECT_SKY_OCCLUSION},
    {"polygons", "", LOD_LOW, 0.006, 0.7, 0.12, EFFECTS_ALL & ~EFFECT_SKY_OCCLUSION},
    {"billboards", "views=16", LOD_HIGH, 0.004, 0.4, 0.3, EFFECT_TWO_SIDED | EFFECT_AMBIENT},
    {"billboards", "views=64", LOD_HIGH, 0.005, 0.45, 0.22, EFFECT_TWO_SIDED | EFFECT_AMBIENT},
    {"cross-quads", "planes=2", LOD_HIGH, 0.003, 0.38, 0.5, EFFECT_TWO_SIDED | EFFECT_AMBIENT},
};
enum { WORLD_METHODS = sizeof world_methods / sizeof *world_methods };

static double world_normal(struct random *random)
{
    double radius = sqrt(-2 * log(1 - random_double(random)));
    return radius * cos(2 * M_PI * random_double(random));
}

/* Sky over grass with round trees; distortion moves and noises them. */
static struct frame *world_frame(struct arena *arena, size_t trees, int view, double distortion,
                                 uint64_t seed)
{
    struct frame *frame = frame_create(arena, WORLD_WIDTH, WORLD_HEIGHT, distortion == 0);
    for (int y = 0; y < WORLD_HEIGHT; y++)
        for (int x = 0; x < WORLD_WIDTH; x++) {
            float *pixel = frame->rgba + 4 * (y * WORLD_WIDTH + x);
            float up = (float)(WORLD_HEIGHT - y) / WORLD_HEIGHT;
            pixel[0] = up > 0.5f ? 0.35f * up : 0.12f;
            pixel[1] = up > 0.5f ? 0.5f * up : 0.14f;
            pixel[2] = up > 0.5f ? 0.8f * up : 0.06f;
        }
    struct random place = random_seed(7, (uint64_t)view), noise = random_seed(seed, 3);
    int drawn = trees < 60 ? (int)trees : 60;
    for (int t = 0; t < drawn; t++) {
        double size = (6 + 5 * random_double(&place)) * (1 + 0.4 * view);
        double x0 = WORLD_WIDTH * random_double(&place) + 3 * distortion * world_normal(&noise);
        double y0 = WORLD_HEIGHT * (0.45 + 0.3 * random_double(&place));
        for (int y = 0; y < WORLD_HEIGHT; y++)
            for (int x = 0; x < WORLD_WIDTH; x++) {
                double r = hypot(x - x0, 0.6 * (y - y0)) / size;
                float *pixel = frame->rgba + 4 * (y * WORLD_WIDTH + x);
                if (r > 1)
                    continue;
                double leaf = 0.12 + 0.06 * cos(12 * r + x * 0.9) * sin(y * 1.1);
                leaf *= 1 + 0.5 * distortion * world_normal(&noise);
                pixel[0] = (float)fabs(0.5 * leaf);
                pixel[1] = (float)fabs(leaf);
                pixel[2] = (float)fabs(0.2 * leaf);
                pixel[3] = 1;
            }
    }
    for (size_t i = 0; frame->variance && i < 4 * WORLD_WIDTH * WORLD_HEIGHT; i++)
        frame->variance[i] = 1e-7f;
    return frame;
}

static uint64_t world_key(const char *scene, size_t trees, int view, unsigned effects)
{
    return strlen(scene) * 1000003u + trees * 101 + (uint64_t)view * 7 + effects * 10007;
}

static void world_reference(struct arena *arena, const char *folder, const char *scene,
                            size_t trees, int view, unsigned effects, struct frame **frame)
{
    *frame = world_frame(arena, trees, view, 0, 1);
    float light = effects == EFFECTS_ALL ? 0.8f : 1;
    for (size_t i = 0; i < 4 * WORLD_WIDTH * WORLD_HEIGHT; i++)
        (*frame)->rgba[i] *= i % 4 == 3 || (*frame)->rgba[i | 3] == 0 ? 1 : light;
    uint64_t key = world_key(scene, trees, view, effects);
    char *path =
        arena_printf(arena, "%s/references/%016llx.frame", folder, (unsigned long long)key);
    struct error error = {0};
    if (!file_exists(path) && frame_save(*frame, path, &error) != STATUS_OK)
        fprintf(stderr, "%s\n", error.text);
}

static void world_view(struct arena *arena, const char *folder, struct result *result, int view,
                       const struct world_method *method)
{
    struct result_view *out = &result->views[view];
    bool walks = strcmp(result->cell.scene, "walk-in") == 0;
    struct error error = {0};
    struct frame *same, *full;
    size_t trees = result->cell.trees;
    *out = (struct result_view){.time = view / 2.0,
                                .distance_m = walks ? 200.0 / (1 << 2 * view) : 120,
                                .elevation_deg = walks ? 3 : 90 - 40.0 * view,
                                .azimuth_deg = 200,
                                .same_key =
                                    world_key(result->cell.scene, trees, view, method->effects),
                                .full_key = world_key(result->cell.scene, trees, view, EFFECTS_ALL),
                                .compared = true,
                                .same_standard_error = 0.002f,
                                .full_standard_error = 0.003f};
    world_reference(arena, folder, result->cell.scene, trees, view, method->effects, &same);
    world_reference(arena, folder, result->cell.scene, trees, view, EFFECTS_ALL, &full);
    struct frame *drawn = world_frame(arena, strcmp(method->name, "null") ? trees : 0, view,
                                      method->error, result->cell.trees + view);
    out->picture_hash = frame_hash(drawn);
    out->picture =
        arena_printf(arena, "pictures/%016llx.frame", (unsigned long long)out->picture_hash);
    frame_save(drawn, arena_printf(arena, "%s/%s", folder, out->picture), &error);
    metrics_compare(arena, drawn, same, &out->same, NULL, &error);
    metrics_compare(arena, drawn, full, &out->full, NULL, &error);
}

static void world_result(struct arena *arena, const char *folder, const char *scene, size_t trees,
                         const struct world_method *method, int round, bool pictures,
                         struct result *result)
{
    struct random random = random_seed(trees + 17, (uint64_t)round + 31 * (uint64_t)method->lod);
    double seconds = 0.0009 + method->seconds_1 * pow((double)trees, method->exponent);
    seconds = strcmp(method->name, "null") ? seconds : 0.0009;
    *result = (struct result){.repetition = round,
                              .status = STATUS_OK,
                              .message = "",
                              .started = "2026-11-22T12:00:00Z",
                              .seconds = 2,
                              .effects = method->effects,
                              .scene_effects = EFFECTS_ALL,
                              .instances = trees,
                              .backend = "osmesa",
                              .renderer = "llvmpipe (LLVM 15.0.6, 256 bits)",
                              .gl_version = "4.5 (Core Profile) Mesa 22.3.6",
                              .threads = 2,
                              .frames_count = WORLD_FRAMES};
    struct cell *cell = &result->cell;
    *cell = (struct cell){.scene = scene,
                          .method_name = method->name,
                          .options = method->options,
                          .trees = trees,
                          .lod = method->lod,
                          .width_px = WORLD_WIDTH,
                          .height_px = WORLD_HEIGHT,
                          .format = TARGET_RGBA16F,
                          .seed = 1};
    cell->name = arena_printf(arena, "%s/%s%s%s/trees=%zu/lod=%s/size=%dx%d/target=rgba16f/seed=1",
                              scene, method->name, *method->options ? ":" : "", method->options,
                              trees, lod_word(method->lod), WORLD_WIDTH, WORLD_HEIGHT);
#define WORLD_NAN(field, unit, better, doc) result->field = NAN;
    RESULT_COLUMNS(WORLD_NAN)
#undef WORLD_NAN
    result->build_seconds = 0.4 * (1 + method->error) * (1 + 0.01 * round);
    result->plant_seconds = 0.11;
    result->scene_seconds = 0.01;
    result->first_frame_seconds = seconds + 0.08;
    result->host_bytes = 3e6 + 80.0 * (double)trees;
    result->device_bytes = method->error > 0.2 ? 42e6 : 9.4e6;
    result->peak_bytes = 190e6;
    result->draw_calls = 3;
    result->triangles = method->error > 0.2 ? 2.0 * (double)trees : 98286.0 * (double)trees;
    result->fragments = 480000 + 900.0 * (double)trees;
    result->frame_seconds = ARENA_ARRAY(arena, double, WORLD_FRAMES);
    for (int i = 0; i < WORLD_FRAMES; i++)
        result->frame_seconds[i] = seconds * exp(0.02 * fabs(world_normal(&random)));
    result->views_count = WORLD_VIEWS;
    result->views = ARENA_ARRAY(arena, struct result_view, WORLD_VIEWS);
    for (int view = 0; view < WORLD_VIEWS && pictures; view++)
        world_view(arena, folder, result, view, method);
    result->has_flicker = pictures;
    result->flicker = (struct flicker){0.01 * method->error, 0.05 * method->error, 0.0004, 1};
}

/* One cell of two scenes fails in every round, one in a single round. */
static void world_break(struct arena *arena, struct result *result)
{
    bool polygons = strcmp(result->cell.method_name, "polygons") == 0;
    if (polygons && result->cell.lod == LOD_HIGH && result->cell.trees == 1000) {
        result->status = STATUS_TIMEOUT;
        result->message = "ran past 60 s in frame 3 <&\"quoted\"> | 100 % of_it";
    } else if (!polygons && result->cell.trees == 100 && result->repetition == 2 &&
               strcmp(result->cell.method_name, "cross-quads") == 0) {
        result->status = STATUS_CRASH;
        result->signal = 11;
        result->message = "died of SIGSEGV";
    } else {
        return;
    }
    result->frames_count = 0;
    result->frame_seconds = arena_alloc(arena, 1, sizeof(double));
    result->views_count = 0;
    result->has_flicker = false;
    result->build_seconds = result->host_bytes = result->device_bytes = NAN;
}

/* folder must exist. */
static struct run *world_run(struct arena *arena, const char *folder)
{
    static const struct {
        const char *scene;
        size_t trees;
    } groups[] = {
        {"poplar-forest", 1}, {"poplar-forest", 100}, {"poplar-forest", 1000}, {"walk-in", 30}};
    struct error error = {0};
    file_make_folder(arena_printf(arena, "%s/references", folder), &error);
    file_make_folder(arena_printf(arena, "%s/pictures", folder), &error);
    struct run *run = ARENA_NEW(arena, struct run);
    run->folder = folder;
    run->provenance = (struct provenance){.host = "testhost",
                                          .cpu = "AMD EPYC <9B14>",
                                          .kernel = "6.1.0",
                                          .os = "Debian GNU/Linux 12",
                                          .compiler = "gcc 12.2.0",
                                          .flags = "-O3 -g",
                                          .revision = "0123abcd",
                                          .libraries = "Mesa 22.3.6",
                                          .plan = "quick",
                                          .command = "./treeline run quick --out results/x & \"y\"",
                                          .settings = "--timeout 60 --threads 2",
                                          .started = "2026-11-22T12:00:00Z",
                                          .cores = 2,
                                          .memory_bytes = 25.2e9,
                                          .seed = 1,
                                          .plan_hash = 42,
                                          .rounds = WORLD_ROUNDS,
                                          .frame_seconds = 2,
                                          .reference_error = 0.002};
    run->results = ARENA_ARRAY(arena, struct result, 4 * WORLD_METHODS * WORLD_ROUNDS);
    for (int round = 0; round < WORLD_ROUNDS; round++)
        for (size_t g = 0; g < 4; g++)
            for (size_t m = 0; m < WORLD_METHODS; m++) {
                struct result *result = &run->results[run->results_count++];
                world_result(arena, folder, groups[g].scene, groups[g].trees, &world_methods[m],
                             round, round == 0, result);
                world_break(arena, result);
            }
    return run;
}

#endif
