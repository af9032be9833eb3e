/* The picture pass: draw, read, check, keep, compare; after the clock has stopped. */
#include "cell/stage.h"

#include "base/file.h"
#include "base/hash.h"
#include "stats/stats.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

/* The sums over the pictures of a repetition. */
struct album {
    size_t count;
    uint64_t draw_calls, triangles;
    struct gl_statistics statistics;
    struct method_tally tally; /* the method's own counts */
    size_t pairs;              /* of a picture and the path's next one, both compared */
    double flicker_squared, flicker_variance, flicker_worst;
    size_t flicker_view;
};

static const char *picture_name(struct arena *arena, const struct cell *cell, size_t view)
{
    return arena_printf(arena, "pictures/%016" PRIx64 "-v%zu.frame", hash_text(0, cell->name),
                        view);
}

/* Median distance from the eye to the trees' feet in the frustum; to all trees when none is in it.
 */
static double trees_distance_m(const struct scene *scene, const struct view *view)
{
    struct arena *arena = arena_create(0);
    double *distances = ARENA_ARRAY(arena, double, scene->instances_count);
    size_t seen = 0;
    for (int all = 0; all < 2 && !seen; all++)
        for (size_t i = 0; i < scene->instances_count; i++) {
            const float *foot = scene->instances[i].position_m;
            if (all || view_sees_sphere(view, foot, 1.0f))
                distances[seen++] = hypot(hypot(foot[0] - view->eye_m[0], foot[1] - view->eye_m[1]),
                                          foot[2] - view->eye_m[2]);
        }
    double median = stats_median(distances, seen);
    arena_destroy(arena);
    return median;
}

/* NaN everywhere first, so that a pixel that is not drawn is found out (8-bit targets cannot hold
 * it). */
static void target_spoil(struct stage *stage)
{
    const struct target *target = &stage->target;
    const float nothing[4] = {NAN, NAN, NAN, NAN};
    if (stage->gl && target->format != TARGET_RGBA8)
        stage->gl->ClearNamedFramebufferfv(target->framebuffer, GL_COLOR, 0, nothing);
    size_t values = 4 * (size_t)target->width_px * (size_t)target->height_px;
    for (size_t i = 0; !stage->gl && i < values; i++)
        target->pixels[i] = NAN;
}

static enum status picture_draw(struct stage *stage, const struct view *view, struct album *album,
                                struct frame **frame)
{
    target_spoil(stage);
    if (stage->gl) {
        gl_counters_reset(stage->gl);
        gl_statistics_begin(stage->gl);
    }
    enum status status = stage_draw(stage, view, NULL);
    if (stage->gl) {
        struct gl_statistics one = gl_statistics_end(stage->gl);
        album->statistics.vertices += one.vertices;
        album->statistics.primitives += one.primitives;
        album->statistics.fragments += one.fragments;
        album->draw_calls += stage->gl->counters.draw_calls;
        album->triangles += stage->gl->counters.triangles;
    }
    if (!status)
        status = stage_check(stage, "a picture");
    if (status)
        return status;
    *frame = stage_read(stage, stage->scene_arena);
    return frame_check(*frame, stage->error);
}

/* The same view once more for the method's own counts: a shader that counts is another one than
 * that which is timed and seen. */
static enum status picture_count(struct stage *stage, const struct view *view, struct album *album)
{
    const struct method_tally before = stage->workspace.tally;
    stage->workspace.counted = true;
    enum status status = stage_draw(stage, view, NULL);
    stage->workspace.counted = false;
    const struct method_tally *after = &stage->workspace.tally;
    album->tally.rays += after->rays - before.rays;
    album->tally.occlusion_rays += after->occlusion_rays - before.occlusion_rays;
    album->tally.lookups += after->lookups - before.lookups;
    album->tally.samples += after->samples - before.samples;
    album->tally.bytes += after->bytes - before.bytes;
    album->tally.shadow_seconds += after->shadow_seconds - before.shadow_seconds;
    album->tally.shadow_bytes += after->shadow_bytes - before.shadow_bytes;
    return status ? status : stage_check(stage, "a counted picture");
}

static const struct frame *reference_find(struct stage *stage, const struct view *view,
                                          unsigned effects, bool neighbour, uint64_t *key)
{
    struct reference_options options =
        stage_reference_options(stage->plan, stage->cell, effects, neighbour);
    return stage_reference(stage, view, &options, key);
}

/* Root mean square standard error of the picture's RGB. */
static float standard_error(const struct frame *frame)
{
    if (!frame->variance)
        return 0;
    double sum = 0;
    size_t pixels = (size_t)frame->width_px * (size_t)frame->height_px;
    for (size_t i = 0; i < pixels; i++)
        for (int c = 0; c < 3; c++)
            sum += frame->variance[4 * i + (size_t)c];
    return (float)sqrt(sum / (3 * (double)pixels));
}

static enum status picture_compare(struct stage *stage, const struct view *view,
                                   const struct frame *frame, struct result_view *result,
                                   const struct frame **reference)
{
    struct result *whole = stage->result;
    const struct frame *same =
        reference_find(stage, view, whole->effects, false, &result->same_key);
    const struct frame *full = same;
    result->full_key = result->same_key;
    if (whole->effects != whole->scene_effects)
        full = reference_find(stage, view, whole->scene_effects, false, &result->full_key);
    *reference = same;
    if (!same || !full)
        return STATUS_OK;
    struct arena *arena = arena_create(0);
    enum status status = metrics_compare(arena, frame, same, &result->same, NULL, stage->error);
    result->full = result->same;
    if (!status && full != same)
        status = metrics_compare(arena, frame, full, &result->full, NULL, stage->error);
    arena_destroy(arena);
    result->same_standard_error = standard_error(same);
    result->full_standard_error = standard_error(full);
    result->compared = !status;
    return status;
}

/* The path's next frame as well, and how the change from this one to it differs from the
 * references' change. */
static enum status picture_flicker(struct stage *stage, size_t index, const struct frame *picture,
                                   const struct frame *reference, struct album *album)
{
    struct album unused = {0};
    struct view view;
    struct frame *next;
    uint64_t key;
    stage_announce(stage, "a picture's neighbour");
    view_at(stage->scene, stage_neighbour_time(stage->scene, stage->result->views[index].time),
            &view);
    enum status status = picture_draw(stage, &view, &unused, &next);
    if (status)
        return error_context(stage->error, "the neighbour of picture %zu", index);
    const struct frame *frames[2] = {picture, next};
    const struct frame *references[2] = {
        reference, reference_find(stage, &view, stage->result->effects, true, &key)};
    if (!references[1])
        return STATUS_OK;
    struct flicker pair;
    struct arena *arena = arena_create(0);
    status = metrics_flicker(arena, frames, references, 2, &pair, stage->error);
    arena_destroy(arena);
    if (status)
        return status;
    album->pairs++;
    album->flicker_squared += pair.mean * pair.mean;
    album->flicker_variance += pair.floor * pair.floor;
    if (pair.peak > album->flicker_worst) {
        album->flicker_worst = pair.peak;
        album->flicker_view = index;
    }
    return STATUS_OK;
}

static enum status view_picture(struct stage *stage, size_t index, size_t count,
                                struct album *album)
{
    struct result_view *result = &stage->result->views[index];
    const struct frame *reference = NULL;
    struct view view;
    struct frame *frame;
    result->time = path_time(stage->scene, index, count);
    view_at(stage->scene, result->time, &view);
    stage_announce(stage, "a picture");
    enum status status = picture_draw(stage, &view, album, &frame);
    if (!status)
        status = picture_count(stage, &view, album);
    if (status)
        return error_context(stage->error, "picture %zu", index);
    result->picture_hash = frame_hash(frame);
    result->distance_m = trees_distance_m(stage->scene, &view);
    view_angles_deg(&view, &result->elevation_deg, &result->azimuth_deg);
    if (stage->folder) {
        result->picture = picture_name(stage->result_arena, stage->cell, index);
        const char *path =
            arena_printf(stage->scene_arena, "%s/%s", stage->folder, result->picture);
        status = frame_save(frame, path, stage->error);
    }
    stage_announce(stage, "comparing a picture");
    if (!status)
        status = picture_compare(stage, &view, frame, result, &reference);
    if (!status && result->compared && stage_path_frames(stage->scene) > 1)
        status = picture_flicker(stage, index, frame, reference, album);
    return status ? status : stage_mask(stage, &view, result);
}

static void album_flicker(struct result *result, const struct album *album)
{
    result->has_flicker = album->count && album->pairs == album->count;
    if (!result->has_flicker)
        return;
    double pairs = (double)album->pairs;
    result->flicker = (struct flicker){.mean = sqrt(album->flicker_squared / pairs),
                                       .peak = album->flicker_worst,
                                       .floor = sqrt(album->flicker_variance / pairs),
                                       .peak_frame = album->flicker_view};
}

/* The mean over the pictures; what was never counted is not known. */
static double mean_count(uint64_t sum, size_t count)
{
    return sum ? (double)sum / (double)count : NAN;
}

/* The picture itself, written once, is the least that a frame moves. */
static void album_tally(struct stage *stage, const struct album *album)
{
    static const double pixel_bytes[] = {
        [TARGET_RGBA8] = 4, [TARGET_RGBA16F] = 8, [TARGET_RGBA32F] = 16};
    const struct target *target = &stage->target;
    struct result *result = stage->result;
    result->rays = mean_count(album->tally.rays, album->count);
    result->occlusion_rays = mean_count(album->tally.occlusion_rays, album->count);
    result->lookups = mean_count(album->tally.lookups, album->count);
    result->samples = mean_count(album->tally.samples, album->count);
    result->shadow_bytes = mean_count(album->tally.shadow_bytes, album->count);
    if (album->tally.shadow_bytes)
        result->shadow_seconds = album->tally.shadow_seconds / (double)album->count;
    result->moved_bytes = (double)album->tally.bytes / (double)album->count +
                          pixel_bytes[stage->gl ? target->format : TARGET_RGBA32F] *
                              target->width_px * target->height_px;
}

static void album_counts(struct result *result, const struct album *album, bool statistics)
{
    double count = (double)album->count;
    result->draw_calls = (double)album->draw_calls / count;
    result->triangles = (double)album->triangles / count;
    if (!statistics)
        return;
    result->vertices = (double)album->statistics.vertices / count;
    result->primitives = (double)album->statistics.primitives / count;
    result->fragments = (double)album->statistics.fragments / count;
}

/* The first picture once more, against the one that repetition 0 kept: the same cell gives the same
 * bytes. */
static enum status picture_again(struct stage *stage, const struct frame *before)
{
    struct album album = {.count = 1};
    struct frame *frame;
    struct view view;
    struct result *result = stage->result;
    stage_announce(stage, "a picture");
    double time =
        path_time(stage->scene, 0, stage_views_count(stage->scene, stage->plan->views_count));
    view_at(stage->scene, time, &view);
    enum status status = picture_draw(stage, &view, &album, &frame);
    if (status)
        return error_context(stage->error, "picture 0");
    result->views_count = 1;
    result->views = ARENA_NEW(stage->result_arena, struct result_view);
    result->views[0].time = time;
    result->views[0].distance_m = NAN;
    view_angles_deg(&view, &result->views[0].elevation_deg, &result->views[0].azimuth_deg);
    result->views[0].picture_hash = frame_hash(frame);
    if (result->views[0].picture_hash != frame_hash(before))
        result->message = "the picture differs from repetition 0's";
    return STATUS_OK;
}

enum status stage_pictures(struct stage *stage)
{
    struct arena *arena = stage->scene_arena;
    struct result *result = stage->result;
    if (stage->folder && result->repetition) {
        struct frame *before;
        const char *path =
            arena_printf(arena, "%s/%s", stage->folder, picture_name(arena, stage->cell, 0));
        if (file_exists(path) && !frame_load(arena, path, &before, NULL))
            return picture_again(stage, before);
    }
    struct album album = {.count = stage_views_count(stage->scene, stage->plan->views_count)};
    result->views_count = album.count;
    result->views = ARENA_ARRAY(stage->result_arena, struct result_view, album.count);
    enum status status = STATUS_OK;
    if (stage->folder)
        status = file_make_folder(arena_printf(arena, "%s/pictures", stage->folder), stage->error);
    for (size_t i = 0; i < album.count && !status; i++)
        status = view_picture(stage, i, album.count, &album);
    if (!status && stage->gl)
        album_counts(result, &album, stage->gl->has_pipeline_statistics);
    if (!status)
        album_tally(stage, &album);
    if (!status)
        album_flicker(result, &album);
    return status;
}
