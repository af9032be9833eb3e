/* The reference: checks, passes of samples until the stated error is reached, the frame, and the
 * disk cache. */
#include "truth/reference_parts.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/progress.h"

#include <math.h>
#include <omp.h>
#include <string.h>

/* Counted up whenever a picture would change. */
#define TRACER_VERSION 3
#define THREADS_LIMIT 1024

static uint32_t power_of_two(int count)
{
    uint32_t power = REFERENCE_REPLICATES;
    while (power < (uint32_t)count)
        power *= 2;
    return power;
}

static enum status limits_set(const struct reference_options *options, struct plan_limits *limits,
                              struct error *error)
{
    int least = options->samples_min ? options->samples_min : 16;
    int most = options->samples_max ? options->samples_max : least > 4096 ? least : 4096;
    if (least < 1 || least > REFERENCE_SAMPLES_LIMIT)
        return error_set(error, STATUS_INVALID, "reference: samples_min: %d is outside 1..%d",
                         least, REFERENCE_SAMPLES_LIMIT);
    if (most < least || most > REFERENCE_SAMPLES_LIMIT)
        return error_set(error, STATUS_INVALID, "reference: samples_max: %d is outside %d..%d",
                         most, least, REFERENCE_SAMPLES_LIMIT);
    if (!(options->standard_error >= 0) || !isfinite(options->standard_error))
        return error_set(error, STATUS_INVALID,
                         "reference: standard_error: %g is not a finite number from 0 on",
                         (double)options->standard_error);
    limits->samples_min = power_of_two(least);
    limits->samples_max = power_of_two(most);
    limits->target = options->standard_error;
    return STATUS_OK;
}

static enum status request_check(const struct view *view, const struct reference_options *options,
                                 struct plan_limits *limits, struct error *error)
{
    if (view->width_px < 1 || view->width_px > REFERENCE_SIDE_LIMIT || view->height_px < 1 ||
        view->height_px > REFERENCE_SIDE_LIMIT)
        return error_set(error, STATUS_INVALID, "reference: size %d x %d px is outside 1..%d",
                         view->width_px, view->height_px, REFERENCE_SIDE_LIMIT);
    if (options->effects & ~(unsigned)EFFECTS_ALL)
        return error_set(error, STATUS_INVALID, "reference: effects: 0x%x is outside 0..0x%x",
                         options->effects, (unsigned)EFFECTS_ALL);
    if (options->threads < 0 || options->threads > THREADS_LIMIT)
        return error_set(error, STATUS_INVALID, "reference: threads: %d is outside 0..%d",
                         options->threads, THREADS_LIMIT);
    return limits_set(options, limits, error);
}

/* view_ray() as a plane of directions that are 1 along forward. */
static void plane_direction(const struct view *view, float x_px, float y_px, float direction[3])
{
    view_ray(view, x_px, y_px, direction);
    float depth = 0;
    for (int i = 0; i < 3; i++)
        depth += direction[i] * view->forward[i];
    for (int i = 0; i < 3; i++)
        direction[i] /= depth;
}

static void picture_aim(struct picture *picture)
{
    const struct view *view = picture->view;
    float width = (float)view->width_px, height = (float)view->height_px, right[3], bottom[3];
    plane_direction(view, 0, 0, picture->corner);
    plane_direction(view, width, 0, right);
    plane_direction(view, 0, height, bottom);
    for (int i = 0; i < 3; i++) {
        picture->step_x[i] = (right[i] - picture->corner[i]) / width;
        picture->step_y[i] = (bottom[i] - picture->corner[i]) / height;
    }
}

static void picture_set(const struct scene *scene, const struct view *view,
                        const struct reference_options *options, struct picture *picture)
{
    picture->view = view;
    picture->effects = options->effects;
    picture->masked = options->masked;
    picture->seed = options->seed;
    picture->width_px = view->width_px;
    picture->height_px = view->height_px;
    for (int i = 0; i < 3; i++) {
        picture->sun[i] = scene->sun.radiance[i];
        picture->ambient[i] = options->effects & EFFECT_AMBIENT ? scene->ambient[i] : 0;
        picture->sun_shines |= picture->sun[i] > 0;
        picture->sky_shines |= picture->ambient[i] > 0;
    }
    picture_aim(picture);
}

/* What a picture needs while it is made. */
struct render {
    struct picture picture;
    struct plan plan;
    struct samples samples;
    float (*variance)[4];
    size_t pixels;
    int tiles, threads;
    struct tile_work **works; /* one a thread */
    struct ray_counts rays;
    double samples_done; /* of the pass */
    struct progress *progress;
};

static void render_allocate(struct arena *arena, struct render *render)
{
    const struct picture *picture = &render->picture;
    render->pixels = (size_t)picture->width_px * (size_t)picture->height_px;
    render->tiles = ((picture->width_px + TILE_SIDE - 1) / TILE_SIDE) *
                    ((picture->height_px + TILE_SIDE - 1) / TILE_SIDE);
    render->samples.sums = arena_alloc(arena, render->pixels, sizeof *render->samples.sums);
    render->samples.counts = ARENA_ARRAY(arena, uint32_t, render->pixels);
    render->samples.wanted = ARENA_ARRAY(arena, uint32_t, render->pixels);
    memset(render->samples.counts, 0, render->pixels * sizeof *render->samples.counts);
    render->plan.levels = ARENA_ARRAY(arena, int16_t, render->pixels);
    render->plan.width_px = picture->width_px;
    render->plan.scale[0] = render->plan.scale[1] = PLAN_SCALE_LEAST;
    render->variance = arena_alloc(arena, render->pixels, sizeof *render->variance);
    render->works = ARENA_ARRAY(arena, struct tile_work *, (size_t)render->threads);
    for (int i = 0; i < render->threads; i++)
        render->works[i] = tile_work_create(arena);
}

/* Takes all samples that are wanted. Tiles do not touch each other's pixels, so that the picture
 * does not depend on which thread takes which. */
static void render_pass(struct render *render)
{
    double primary = 0, shadow = 0, occlusion = 0, before = render->samples_done, done = 0;
#pragma omp parallel num_threads(render->threads) reduction(+ : primary, shadow, occlusion)
    {
        struct tile_work *work = render->works[omp_get_thread_num()];
        struct ray_counts counts = {0};
#pragma omp for schedule(dynamic, 1)
        for (int tile = 0; tile < render->tiles; tile++) {
            double primary_before = counts.primary, now;
            tile_trace(&render->picture, work, tile, &render->samples, &counts);
#pragma omp atomic capture
            now = done += counts.primary - primary_before;
            progress_update(render->progress, before + now, NULL);
        }
        primary += counts.primary;
        shadow += counts.shadow;
        occlusion += counts.occlusion;
    }
    render->samples_done += primary;
    render->rays.primary += primary;
    render->rays.shadow += shadow;
    render->rays.occlusion += occlusion;
    samples_variance(&render->samples, render->pixels, render->variance);
}

static double samples_missing(const struct samples *samples, size_t pixels)
{
    double missing = 0;
    for (size_t i = 0; i < pixels; i++)
        missing += samples->wanted[i] - samples->counts[i];
    return missing;
}

static bool render_plan(struct render *render)
{
    return plan_next(&render->plan, (const float(*)[4])render->variance, render->pixels,
                     &render->samples);
}

static void render_passes(struct render *render, bool quiet)
{
    bool adaptive = render->plan.limits.target > 0;
    uint32_t count = adaptive ? render->plan.limits.samples_min : render->plan.limits.samples_max;
    for (size_t i = 0; i < render->pixels; i++)
        render->samples.wanted[i] = count;
    double missing = samples_missing(&render->samples, render->pixels);
    render->progress = progress_start(adaptive ? "reference, pilot" : "reference", missing, quiet);
    render_pass(render);
    progress_end(render->progress);
    if (!adaptive)
        return;
    plan_levels((const float(*)[4])render->variance, render->picture.width_px,
                render->picture.height_px, render->plan.levels);
    if (!render_plan(render))
        return;
    /* The first plan foresees nearly all that is to come. */
    missing = 1.1 * samples_missing(&render->samples, render->pixels);
    render->progress = progress_start("reference", missing, quiet);
    render->samples_done = 0;
    do
        render_pass(render);
    while (render_plan(render));
    progress_end(render->progress);
}

static struct frame *render_frame(struct arena *arena, const struct render *render)
{
    struct frame *frame =
        frame_create(arena, render->picture.width_px, render->picture.height_px, true);
    for (size_t pixel = 0; pixel < render->pixels; pixel++)
        for (size_t channel = 0; channel < 4; channel++) {
            double sum = 0;
            for (int k = 0; k < REFERENCE_REPLICATES; k++)
                sum += (double)render->samples.sums[pixel][k][channel];
            frame->rgba[4 * pixel + channel] = (float)(sum / render->samples.counts[pixel]);
            frame->variance[4 * pixel + channel] = render->variance[pixel][channel];
        }
    return frame;
}

/* Traces a picture whose scene is built. The scratch arena holds all but the frame. */
static void render_trace(struct arena *scratch, struct arena *arena, struct render *render,
                         bool quiet, struct frame **frame, struct reference_stats *stats)
{
    double start = clock_wall_seconds();
    render_allocate(scratch, render);
    render_passes(render, quiet);
    *frame = render_frame(arena, render);
    stats->trace_seconds = clock_wall_seconds() - start;
    stats->primary_rays = stats->samples = render->rays.primary;
    stats->shadow_rays = render->rays.shadow;
    stats->occlusion_rays = render->rays.occlusion;
    stats->standard_error =
        (float)plan_standard_error((const float(*)[4])render->variance, render->pixels);
}

struct tracer {
    const struct scene *scene;
    struct traced_scene traced;
    int threads;
};

enum status tracer_open(struct arena *arena, const struct scene *scene, int threads,
                        struct tracer **tracer, struct error *error)
{
    struct tracer *made = *tracer = ARENA_NEW(arena, struct tracer);
    made->scene = scene;
    made->threads = threads ? threads : clock_cpu_count();
    return traced_scene_build(arena, scene, made->threads, &made->traced, error);
}

void tracer_close(struct tracer *tracer)
{
    embree_destroy(tracer->traced.embree);
}

enum status tracer_trace(const struct tracer *tracer, struct arena *arena, const struct view *view,
                         const struct reference_options *options, struct frame **frame,
                         struct reference_stats *stats, struct error *error)
{
    struct render render = {.threads = tracer->threads, .picture.traced = tracer->traced};
    struct reference_stats made = {0};
    enum status status = request_check(view, options, &render.plan.limits, error);
    if (status)
        return status;
    picture_set(tracer->scene, view, options, &render.picture);
    struct arena *scratch = arena_create(0);
    render_trace(scratch, arena, &render, options->quiet, frame, &made);
    arena_destroy(scratch);
    if (stats)
        *stats = made;
    return frame_check(*frame, error);
}

enum status reference_render(struct arena *arena, const struct scene *scene,
                             const struct view *view, const struct reference_options *options,
                             struct frame **frame, struct reference_stats *stats,
                             struct error *error)
{
    struct plan_limits limits;
    enum status status = request_check(view, options, &limits, error);
    if (status)
        return status;
    struct arena *scratch = arena_create(0);
    struct tracer *tracer;
    double start = clock_wall_seconds();
    status = tracer_open(scratch, scene, options->threads, &tracer, error);
    double build_seconds = clock_wall_seconds() - start;
    if (!status)
        status = tracer_trace(tracer, arena, view, options, frame, stats, error);
    if (!status && stats)
        stats->build_seconds = build_seconds;
    tracer_close(tracer);
    arena_destroy(scratch);
    return status;
}

static uint64_t hash_floats(uint64_t hash, const float *values, size_t count)
{
    for (size_t i = 0; i < count; i++)
        hash = hash_double(hash, (double)values[i]);
    return hash;
}

uint64_t reference_key(const struct scene *scene, const struct view *view,
                       const struct reference_options *options)
{
    struct plan_limits limits = {0};
    if (limits_set(options, &limits, NULL))
        return 0;
    uint64_t hash = hash_u64(0, TRACER_VERSION);
    hash = hash_text(hash, embree_version());
    hash = hash_u64(hash, scene->hash);
    hash = hash_floats(hash, view->eye_m, 3);
    hash = hash_floats(hash, view->right, 3);
    hash = hash_floats(hash, view->up, 3);
    hash = hash_floats(hash, view->forward, 3);
    hash = hash_floats(hash, view->sun_direction, 3);
    hash = hash_floats(hash, (const float *)view->view_projection, 16);
    hash = hash_double(hash, (double)view->fov_y_rad);
    hash = hash_double(hash, (double)view->near_m);
    hash = hash_u64(hash, (uint64_t)view->width_px << 32 | (uint32_t)view->height_px);
    hash = hash_u64(hash, options->effects);
    hash = hash_double(hash, limits.target);
    hash = hash_u64(hash, (uint64_t)limits.samples_min << 32 | limits.samples_max);
    if (options->masked)
        hash = hash_text(hash, "mask");
    return hash_u64(hash, options->seed);
}

/* In the cache the statistics come first, then the packed frame. */
static bool cached_take(struct arena *arena, uint64_t key, struct frame **frame,
                        struct reference_stats *stats)
{
    struct arena *scratch = arena_create(0);
    void *data;
    size_t size;
    bool found = cache_get(scratch, "reference", key, &data, &size) && size > sizeof *stats &&
                 frame_unpack(arena, (char *)data + sizeof *stats, size - sizeof *stats,
                              "the cache", frame, NULL) == STATUS_OK;
    if (found) {
        memcpy(stats, data, sizeof *stats);
        stats->from_cache = true;
    }
    arena_destroy(scratch);
    return found;
}

static void cached_keep(uint64_t key, const struct frame *frame,
                        const struct reference_stats *stats)
{
    struct arena *scratch = arena_create(0);
    size_t size;
    void *packed = frame_pack(scratch, frame, &size);
    char *data = arena_alloc(scratch, sizeof *stats + size, 1);
    memcpy(data, stats, sizeof *stats);
    memcpy(data + sizeof *stats, packed, size);
    cache_put("reference", key, data, sizeof *stats + size);
    arena_destroy(scratch);
}

enum status reference_cached(struct arena *arena, const struct scene *scene,
                             const struct view *view, const struct reference_options *options,
                             struct frame **frame, struct reference_stats *stats,
                             struct error *error)
{
    struct plan_limits limits;
    struct reference_stats made = {0};
    enum status status = request_check(view, options, &limits, error);
    if (status)
        return status;
    uint64_t key = reference_key(scene, view, options);
    if (!cached_take(arena, key, frame, &made)) {
        status = reference_render(arena, scene, view, options, frame, &made, error);
        if (!status)
            cached_keep(key, *frame, &made);
    }
    if (!status && stats)
        *stats = made;
    return status;
}
