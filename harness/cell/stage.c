/* A cell's process made ready: scene, context, target, method; one picture; the end. */
#include "cell/stage.h"

#include "base/clock.h"

#include <inttypes.h>
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void stage_announce(const struct stage *stage, const char *pass)
{
    if (stage->announce < 0)
        return;
    /* A parent that went away is noticed elsewhere. */
    if (dprintf(stage->announce, "#%s\n", pass) < 0)
        return;
}

/* The cell's options; text that cannot be parsed leaves what came before it. */
static enum status options_read(struct arena *arena, const struct cell *cell, void **options,
                                struct error *error)
{
    const struct method *method = cell->method;
    if (!method->options)
        return STATUS_OK;
    *options = arena_alloc(arena, 1, method->options_size);
    options_default(method->options, *options);
    return options_parse(method->options, cell->options, *options, error);
}

unsigned stage_effects(struct arena *arena, const struct cell *cell, unsigned scene_effects)
{
    struct error unused = {0};
    void *options = NULL;
    options_read(arena, cell, &options, &unused);
    return method_effects(cell->method, options, scene_effects);
}

static int threads_of(const struct plan *plan)
{
    return plan->threads ? plan->threads : clock_cpu_count();
}

/* The same number of threads for llvmpipe, for OpenMP and for the method's own. */
static void threads_set(int threads)
{
    char text[16];
    snprintf(text, sizeof text, "%d", threads);
    setenv("LP_NUM_THREADS", text, 1);
    omp_set_num_threads(threads);
}

static enum status scene_open(struct stage *stage)
{
    const struct cell *cell = stage->cell;
    struct result *result = stage->result;
    double start = clock_wall_seconds();
    enum status status = scene_load(stage->scene_arena, cell->scene,
                                    &(struct scene_request){.trees = cell->trees,
                                                            .seed = cell->seed,
                                                            .width_px = cell->width_px,
                                                            .height_px = cell->height_px},
                                    &stage->scene, stage->error);
    if (status)
        return status;
    result->scene_seconds = clock_wall_seconds() - start;
    result->scene_hash = stage->scene->hash;
    result->instances = stage->scene->instances_count;
    result->scene_effects = stage->scene->effects;
    result->effects = stage_effects(stage->scene_arena, cell, stage->scene->effects);
    const char *reason = "it gives no reason";
    if (cell->method->supported && (status = cell->method->supported(stage->scene, &reason)))
        return error_set(stage->error, status, "%s cannot draw %s: %s", cell->method_name,
                         cell->scene, reason);
    return STATUS_OK;
}

static enum status target_open(struct stage *stage)
{
    const struct cell *cell = stage->cell;
    if (!(cell->method->traits & TRAIT_CPU))
        return gl_target(stage->gl, cell->width_px, cell->height_px, cell->format, &stage->target,
                         stage->error);
    stage->target = (struct target){
        .width_px = cell->width_px, .height_px = cell->height_px, .format = cell->format};
    stage->target.pixels = ARENA_ARRAY(stage->scene_arena, float,
                                       4 * (size_t)cell->width_px * (size_t)cell->height_px);
    return STATUS_OK;
}

static enum status context_open(struct stage *stage)
{
    struct result *result = stage->result;
    result->backend = result->renderer = "cpu";
    result->gl_version = "";
    if (stage->cell->method->traits & TRAIT_CPU)
        return STATUS_OK;
    enum status status =
        gl_context_create(stage->plan->backend, threads_of(stage->plan), &stage->gl, stage->error);
    if (status)
        return status;
    result->backend = arena_strdup(stage->result_arena, stage->gl->backend);
    result->renderer = arena_strdup(stage->result_arena, stage->gl->renderer);
    result->gl_version = arena_strdup(stage->result_arena, stage->gl->version);
    return STATUS_OK;
}

static void workspace_fill(struct stage *stage)
{
    stage->workspace = (struct workspace){
        .arena = stage->arena,
        .gl = stage->gl,
        .error = stage->error,
        .effects = stage->result->effects,
        .lod = stage->cell->lod,
        .format = stage->cell->format,
        .threads = threads_of(stage->plan),
        .seed = stage->cell->seed,
    };
}

enum status stage_open(struct stage *stage)
{
    stage_announce(stage, "loading the scene");
    getloadavg(&stage->result->load_average, 1);
    stage->result->threads = threads_of(stage->plan);
    threads_set(stage->result->threads);
    stage->scene_arena = arena_create(0);
    stage->arena = arena_create(stage->plan->memory_bytes);
    enum status status = scene_open(stage);
    if (!status)
        status = options_read(stage->scene_arena, stage->cell, &stage->options, stage->error);
    stage_announce(stage, "making the GL context");
    if (!status)
        status = context_open(stage);
    if (!status)
        status = target_open(stage);
    workspace_fill(stage);
    return status;
}

static struct plant_cost plants_cost(const struct scene *scene)
{
    struct plant_cost sum = {0};
    for (size_t i = 0; i < scene->species_count; i++) {
        bool again = false;
        for (size_t k = 0; k < i; k++)
            again |= scene->species[k].plant == scene->species[i].plant;
        struct plant_cost cost = plant_cost(scene->species[i].plant);
        if (again || !cost.built)
            continue;
        sum.build_seconds += cost.build_seconds;
        sum.build_bytes += cost.build_bytes;
    }
    return sum;
}

/* prepare with its status and the error it left made one. */
static enum status method_prepare(struct stage *stage)
{
    stage->error->status = STATUS_OK;
    enum status status = stage->cell->method->prepare(&stage->workspace, stage->scene,
                                                      stage->options, &stage->state);
    if (stage->gl)
        stage->gl->Finish();
    if (status && !stage->error->status)
        return error_set(stage->error, status, "%s: prepare failed and gave no reason",
                         stage->cell->method_name);
    return status ? status : stage_check(stage, "prepare");
}

enum status stage_prepare(struct stage *stage)
{
    stage_announce(stage, "prepare");
    enum status status = method_prepare(stage);
    struct plant_cost plants = plants_cost(stage->scene);
    stage->result->plant_seconds = plants.build_seconds;
    stage->result->plant_bytes = (double)plants.build_bytes;
    return status;
}

/* prepare once more with the plants built and without the disk cache: what a first build costs.
 * After everything else, in a context and an arena of its own, so that it touches no other figure.
 */
enum status stage_build_cold(struct stage *stage)
{
    if (stage->result->repetition)
        return STATUS_OK;
    stage_announce(stage, "prepare without the disk cache");
    const char *cache = getenv("TREELINE_CACHE");
    char *before = cache ? arena_strdup(stage->scene_arena, cache) : NULL;
    setenv("TREELINE_CACHE", "off", 1);
    if (stage->gl)
        gl_context_destroy(stage->gl);
    stage->gl = NULL;
    arena_destroy(stage->arena);
    stage->arena = arena_create(stage->plan->memory_bytes);
    enum status status = context_open(stage);
    workspace_fill(stage);
    double start = clock_wall_seconds();
    if (!status)
        status = method_prepare(stage);
    if (!status)
        stage->result->build_seconds = clock_wall_seconds() - start;
    if (before)
        setenv("TREELINE_CACHE", before, 1);
    else
        unsetenv("TREELINE_CACHE");
    return status;
}

void stage_close(struct stage *stage)
{
    if (stage->gl)
        gl_context_destroy(stage->gl);
    arena_destroy(stage->arena);
    arena_destroy(stage->scene_arena);
}

enum status stage_draw(struct stage *stage, const struct view *view, double *seconds)
{
    double start = clock_wall_seconds();
    enum status status =
        stage->cell->method->draw(&stage->workspace, stage->state, view, &stage->target);
    if (stage->gl)
        stage->gl->Finish();
    if (seconds)
        *seconds = clock_wall_seconds() - start;
    if (status && !stage->error->status)
        return error_set(stage->error, status, "%s: draw failed and gave no reason",
                         stage->cell->method_name);
    return status;
}

enum status stage_check(struct stage *stage, const char *where)
{
    return stage->gl ? gl_check(stage->gl, where, stage->error) : STATUS_OK;
}

struct frame *stage_read(struct stage *stage, struct arena *arena)
{
    const struct target *target = &stage->target;
    struct frame *frame = frame_create(arena, target->width_px, target->height_px, false);
    if (stage->gl)
        gl_target_read(stage->gl, target, frame->rgba);
    else
        memcpy(frame->rgba, target->pixels,
               4 * sizeof(float) * (size_t)target->width_px * (size_t)target->height_px);
    return frame;
}

size_t stage_path_frames(const struct scene *scene)
{
    const struct sun *sun = &scene->sun;
    bool sun_still =
        sun->azimuth_rad == sun->end_azimuth_rad && sun->elevation_rad == sun->end_elevation_rad;
    if ((scene->camera.kind == PATH_STILL && sun_still) || !scene->camera.frames_count)
        return 1;
    return scene->camera.frames_count;
}

size_t stage_views_count(const struct scene *scene, size_t wanted)
{
    size_t frames = stage_path_frames(scene);
    return wanted < frames ? wanted : frames;
}

double stage_neighbour_time(const struct scene *scene, double time)
{
    double step = 1 / fmax(1, (double)stage_path_frames(scene) - 1);
    return time + step <= 1 + 1e-9 ? time + step : time - step;
}

struct reference_options stage_reference_options(const struct plan *plan, const struct cell *cell,
                                                 unsigned effects, bool neighbour)
{
    return (struct reference_options){
        .effects = effects,
        .standard_error = (float)plan->reference_error,
        .samples_max = plan->reference_samples_max,
        .threads = plan->threads,
        .seed = cell->seed + neighbour,
        .quiet = true,
    };
}

const char *stage_reference_path(struct arena *arena, const char *folder, uint64_t key)
{
    return arena_printf(arena, "%s/references/%016" PRIx64 ".frame", folder, key);
}
