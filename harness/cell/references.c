/* The references of a plan: made once, before the first timed round, each scene in a process of its
 * own. */
#include "cell/cell.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/plural.h"
#include "base/progress.h"
#include "cell/process.h"
#include "cell/stage.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* With a set of effects: the shadow mask, not the light. */
#define SET_MASKED (1u << 31)

/* All references of one scene in one size, tree count and seed. */
struct shoot {
    const struct plan *plan;
    const struct cell *cell; /* the first of the plan that needs it */
    const char *folder;
    uint64_t key;
    size_t effects_count;
    unsigned effects[2 * 32]; /* distinct sets */
    bool drawn[2 * 32];       /* by a method: its flicker needs the neighbouring frames too */
};

static uint64_t shoot_key(const struct cell *cell)
{
    uint64_t hash = hash_text(0, cell->scene);
    hash = hash_u64(hash, cell->trees);
    hash = hash_u64(hash, cell->seed);
    hash = hash_u64(hash, (uint64_t)cell->width_px);
    return hash_u64(hash, (uint64_t)cell->height_px);
}

static void shoot_want(struct shoot *shoot, unsigned effects, bool drawn)
{
    size_t i = 0;
    while (i < shoot->effects_count && shoot->effects[i] != effects)
        i++;
    if (i == sizeof shoot->effects / sizeof *shoot->effects)
        return;
    if (i == shoot->effects_count)
        shoot->effects[shoot->effects_count++] = effects;
    shoot->drawn[i] |= drawn;
}

/* The distinct shoots of a plan; their effects by the scene's wishes and the methods' traits. */
static enum status shoots_list(struct arena *arena, const struct plan *plan, const char *folder,
                               struct shoot **shoots, size_t *count, struct error *error)
{
    *shoots = ARENA_ARRAY(arena, struct shoot, plan->cells_count);
    *count = 0;
    for (size_t i = 0; i < plan->cells_count; i++) {
        const struct cell *cell = &plan->cells[i];
        uint64_t key = shoot_key(cell);
        size_t at = 0;
        while (at < *count && (*shoots)[at].key != key)
            at++;
        struct shoot *shoot = &(*shoots)[at];
        if (at == *count) {
            *shoot = (struct shoot){.plan = plan, .cell = cell, .folder = folder, .key = key};
            ++*count;
        }
        struct scene_summary summary;
        enum status status = scene_summary(arena, cell->scene, &summary, error);
        if (status)
            return status;
        unsigned effects = stage_effects(arena, cell, summary.effects);
        shoot_want(shoot, effects, true);
        shoot_want(shoot, summary.effects, false);
        if (stage_has_mask(cell, effects))
            shoot_want(shoot, SET_MASKED | (effects & EFFECT_TWO_SIDED), true);
    }
    return STATUS_OK;
}

/* A line for the parent, which keeps it. */
static void tracing_tell(struct arena *arena, const struct shoot *shoot, const struct scene *scene,
                         double time, const struct reference_options *options, uint64_t key,
                         const struct reference_stats *stats, int out)
{
    const struct tracing tracing = {.scene = shoot->cell->scene,
                                    .trees = scene->instances_count,
                                    .width_px = shoot->cell->width_px,
                                    .height_px = shoot->cell->height_px,
                                    .threads =
                                        options->threads ? options->threads : clock_cpu_count(),
                                    .effects = options->effects,
                                    .key = key,
                                    .time = time,
                                    .build_seconds = stats->build_seconds,
                                    .trace_seconds = stats->trace_seconds,
                                    .primary_rays = stats->primary_rays,
                                    .shadow_rays = stats->shadow_rays,
                                    .occlusion_rays = stats->occlusion_rays,
                                    .standard_error = (double)stats->standard_error,
                                    .from_cache = stats->from_cache};
    dprintf(out, "%s\n", tracing_to_json(arena, &tracing));
}

static enum status reference_make(struct arena *arena, const struct shoot *shoot,
                                  const struct scene *scene, double time, unsigned set,
                                  bool neighbour, int out, struct error *error)
{
    struct view along, *view = &along;
    time = neighbour ? stage_neighbour_time(scene, time) : time;
    view_at(scene, time, view);
    struct reference_options options =
        set & SET_MASKED
            ? stage_mask_options(shoot->plan, shoot->cell, set & ~SET_MASKED, neighbour)
            : stage_reference_options(shoot->plan, shoot->cell, set, neighbour);
    uint64_t key = reference_key(scene, view, &options);
    const char *path = stage_reference_path(arena, shoot->folder, key);
    if (file_exists(path))
        return STATUS_OK;
    struct frame *frame;
    struct reference_stats stats;
    enum status status = reference_cached(arena, scene, view, &options, &frame, &stats, error);
    if (!status)
        status = frame_save(frame, path, error);
    if (!status)
        tracing_tell(arena, shoot, scene, time, &options, key, &stats, out);
    return status;
}

/* In the child: every view and set of effects; a line for each picture that it made, and "SHARE"
 * done. */
static enum status shoot_work(void *context, int out)
{
    const struct shoot *shoot = context;
    const struct cell *cell = shoot->cell;
    struct arena *arena = arena_create(0);
    struct error error = {0};
    struct scene *scene;
    struct scene_request request = {.trees = cell->trees,
                                    .seed = cell->seed,
                                    .width_px = cell->width_px,
                                    .height_px = cell->height_px};
    enum status status = scene_load(arena, cell->scene, &request, &scene, &error);
    size_t views = status ? 0 : stage_views_count(scene, shoot->plan->views_count);
    size_t total = views * shoot->effects_count;
    bool moves = !status && stage_path_frames(scene) > 1;
    for (size_t i = 0; i < total && !status; i++) {
        struct arena *scratch = arena_create(0);
        double time = path_time(scene, i % views, views);
        size_t set = i / views;
        unsigned effects = shoot->effects[set];
        status = reference_make(scratch, shoot, scene, time, effects, false, out, &error);
        if (!status && moves && shoot->drawn[set])
            status = reference_make(scratch, shoot, scene, time, effects, true, out, &error);
        arena_destroy(scratch);
        dprintf(out, "%.6f\n", (double)(i + 1) / (double)total);
    }
    if (status)
        fprintf(stderr, "\n%s\n", error.text);
    return status;
}

struct listener {
    struct progress *progress;
    size_t before; /* shoots done */
    const char *label, *folder;
    enum status status; /* of keeping what was heard */
    struct error *error;
};

static void shoot_heard(void *context, const char *line)
{
    struct listener *listener = context;
    if (*line == '{') {
        struct arena *arena = arena_create(0);
        struct tracing tracing;
        if (!listener->status)
            listener->status =
                tracing_from_json(arena, line, "the tracer's process", &tracing, listener->error);
        if (!listener->status)
            listener->status = run_append_tracing(listener->folder, &tracing, listener->error);
        arena_destroy(arena);
        return;
    }
    progress_update(listener->progress, (double)listener->before + strtod(line, NULL),
                    listener->label);
}

static enum status shoot_run(struct arena *arena, struct shoot *shoot, struct listener *listener)
{
    struct process_request request = {
        .work = shoot_work, .context = shoot, .heard = shoot_heard, .listener = listener};
    struct process_outcome outcome;
    struct error error = {0};
    enum status status = process_run(arena, &request, &outcome, &error);
    if (!status && outcome.interrupted)
        return STATUS_INTERRUPTED;
    if (listener->status)
        return listener->status;
    if (!status && !outcome.signal && !outcome.exit_code)
        return STATUS_OK;
    const char *why = status ? error.text : outcome.errors;
    fprintf(
        stderr, "treeline: no reference for %s with %zu tree%s, its cells run uncompared: %s%s%s\n",
        shoot->cell->scene, shoot->cell->trees, plural(shoot->cell->trees),
        outcome.signal ? strsignal(outcome.signal) : "", outcome.signal && *why ? ": " : "", why);
    return STATUS_OK;
}

enum status cell_references(struct arena *arena, const struct plan *plan, const char *folder,
                            bool quiet, struct error *error)
{
    struct shoot *shoots;
    size_t count;
    enum status status = shoots_list(arena, plan, folder, &shoots, &count, error);
    if (!status)
        status = file_make_folder(arena_printf(arena, "%s/references", folder), error);
    if (status)
        return status;
    struct listener listener = {.progress = progress_start("references", (double)count, quiet),
                                .folder = folder,
                                .error = error};
    for (size_t i = 0; i < count && !status; i++) {
        listener.before = i;
        listener.label = arena_printf(arena, "%s, %zu tree%s", shoots[i].cell->scene,
                                      shoots[i].cell->trees, plural(shoots[i].cell->trees));
        progress_update(listener.progress, (double)i, listener.label);
        status = shoot_run(arena, &shoots[i], &listener);
    }
    progress_end(listener.progress);
    if (status == STATUS_INTERRUPTED)
        return error_set(error, status, "stopped while the references were made");
    return status;
}
