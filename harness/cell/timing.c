/* The timed pass: first frame, warm-up, frames along the path, the sun moved. Nothing is read or
 * compared here. */
#include "cell/stage.h"
#include "cell/warmup.h"

#include "base/clock.h"
#include "stats/stats.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

/* The first frame and those until the time stops falling, all at the path's start; then one in the
 * middle and one at the end, so that nothing is met for the first time while the clock runs. After
 * a first frame of four times the measuring time or more there is nothing to wait for.
 * frame_seconds: what a frame takes about. */
static enum status warm_up(struct stage *stage, double *frame_seconds)
{
    struct result *result = stage->result;
    double limit = stage->plan->frame_seconds, seconds[WARMUP_FRAMES_MAX + 1];
    size_t count = 0;
    struct view view;
    view_at(stage->scene, 0, &view);
    stage_announce(stage, "the first frame");
    enum status status = stage_draw(stage, &view, &result->first_frame_seconds);
    if (!status)
        status = stage_check(stage, "the first frame");
    result->warmup_frames = 1;
    *frame_seconds = result->first_frame_seconds;
    if (status || *frame_seconds >= 4 * limit)
        return status;
    stage_announce(stage, "warm-up");
    do {
        status = stage_draw(stage, &view, &seconds[count++]);
    } while (!status && !warmup_done(seconds, count, limit));
    result->warmup_frames = 1 + (double)count;
    *frame_seconds = seconds[count - 1];
    if (status || stage_path_frames(stage->scene) == 1 || *frame_seconds > limit)
        return status;
    double middle = 0, end = 0;
    view_at(stage->scene, 0.5, &view);
    status = stage_draw(stage, &view, &middle);
    view_at(stage->scene, 1, &view);
    if (!status)
        status = stage_draw(stage, &view, &end);
    result->warmup_frames += 2;
    *frame_seconds = (*frame_seconds + middle + end) / 3;
    return status;
}

/* How many steps one walk of the path takes: all frames of the path when they can be afforded, else
 * as many as can, evenly spaced over the whole path, so that a slow method is timed on the same
 * way; never fewer than are compared. */
static size_t steps_count(const struct stage *stage, double frame_seconds)
{
    size_t path = stage_path_frames(stage->scene);
    double afford = floor(stage->plan->frame_seconds / fmax(frame_seconds, 1e-9));
    size_t least = stage_views_count(stage->scene, stage->plan->views_count);
    size_t most = (size_t)stage->plan->frames_max;
    size_t steps = afford < (double)path ? (size_t)afford : path;
    steps = steps < least ? least : steps;
    return steps > most ? most : steps;
}

/* One walk; sums of the GPU's and the wall's seconds are added up. */
static enum status walk(struct stage *stage, const struct view *views, size_t steps, bool timer,
                        double *gpu_seconds)
{
    struct result *result = stage->result;
    enum status status = STATUS_OK;
    for (size_t i = 0; i < steps && !status; i++) {
        if (timer)
            gl_timer_begin(stage->gl);
        status = stage_draw(stage, &views[i], &result->frame_seconds[result->frames_count++]);
        if (timer)
            *gpu_seconds += gl_timer_end(stage->gl);
    }
    return status;
}

static double peak_bytes(void)
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return (double)usage.ru_maxrss * 1024;
}

static void books_close(struct stage *stage, double wall_seconds, double cpu_seconds,
                        double gpu_seconds, bool timer)
{
    struct result *result = stage->result;
    double frames = (double)result->frames_count, sum = 0;
    for (size_t i = 0; i < result->frames_count; i++)
        sum += result->frame_seconds[i];
    result->harness_seconds_per_frame = fmax(0, wall_seconds - sum) / frames;
    result->cpu_seconds_per_frame = cpu_seconds / frames;
    result->gpu_seconds_per_frame = timer ? gpu_seconds / frames : NAN;
    result->host_bytes = (double)arena_used_bytes(stage->arena);
    result->device_bytes = stage->gl ? (double)gl_device_bytes(stage->gl) : 0;
    result->peak_bytes = peak_bytes();
}

enum status stage_time(struct stage *stage)
{
    double frame_seconds = 0, limit = stage->plan->frame_seconds;
    enum status status = warm_up(stage, &frame_seconds);
    if (status)
        return status;
    size_t steps = steps_count(stage, frame_seconds), most = (size_t)stage->plan->frames_max;
    struct view *views = ARENA_ARRAY(stage->scene_arena, struct view, steps);
    for (size_t i = 0; i < steps; i++)
        view_at(stage->scene, path_time(stage->scene, i, steps), &views[i]);
    struct result *result = stage->result;
    result->frame_seconds = ARENA_ARRAY(stage->result_arena, double, most > steps ? most : steps);
    /* Touched now, so that no page fault falls between two frames. */
    memset(result->frame_seconds, 0, sizeof(double) * most);
    bool timer = stage->gl && stage->gl->has_timer && !stage->gl->software;
    double gpu_seconds = 0, pass_seconds = 0;
    stage_announce(stage, "timed frames");
    double cpu = clock_cpu_seconds(), start = clock_wall_seconds(), spent = 0;
    do {
        status = walk(stage, views, steps, timer, &gpu_seconds);
        pass_seconds = clock_wall_seconds() - start - spent;
        spent += pass_seconds;
    } while (!status && result->frames_count + steps <= most && spent + pass_seconds <= limit);
    books_close(stage, spent, clock_cpu_seconds() - cpu, gpu_seconds, timer);
    return status ? status : stage_check(stage, "the timed frames");
}

/* The view with the sun turned about +y. */
static struct view sun_turned(const struct view *view, double angle_rad)
{
    struct view turned = *view;
    float c = (float)cos(angle_rad), s = (float)sin(angle_rad);
    turned.sun_direction[0] = c * view->sun_direction[0] + s * view->sun_direction[2];
    turned.sun_direction[2] = c * view->sun_direction[2] - s * view->sun_direction[0];
    return turned;
}

/* The sun moved, back, and a frame without any change of light; three times. Where light alone
 * takes longer than all frames may, moved once, against the first timed frame. */
static enum status relight_pairs(struct stage *stage, const struct view *view)
{
    enum { PAIRS = 3 };
    double plain[PAIRS], relit[PAIRS];
    enum status status = STATUS_OK;
    for (int i = 0; i < PAIRS && !status; i++) {
        struct view turned = sun_turned(view, 0.35 * (i + 1));
        status = stage_draw(stage, &turned, &relit[i]);
        if (!status && relit[i] > stage->plan->frame_seconds) {
            stage->result->relight_seconds = relit[i] - stage->result->frame_seconds[0];
            return STATUS_OK;
        }
        if (!status)
            status = stage_draw(stage, view, NULL);
        if (!status)
            status = stage_draw(stage, view, &plain[i]);
    }
    if (!status)
        stage->result->relight_seconds = stats_median(relit, PAIRS) - stats_median(plain, PAIRS);
    return status;
}

enum status stage_relight(struct stage *stage)
{
    struct result *result = stage->result;
    struct view view;
    enum status status = STATUS_OK;
    stage_announce(stage, "the sun moved");
    view_at(stage->scene, 0, &view);
    if (result->frame_seconds[0] * 9 < stage->plan->frame_seconds) {
        status = relight_pairs(stage, &view);
    } else if (!result->repetition) {
        /* A slow method is asked once a cell, against its first timed frame: coarse, but short. */
        struct view turned = sun_turned(&view, 0.35);
        double relit = 0;
        status = stage_draw(stage, &turned, &relit);
        result->relight_seconds = relit - result->frame_seconds[0];
    }
    return status ? status : stage_check(stage, "the sun moved");
}
