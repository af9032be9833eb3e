/* The reference's tracer as a method draws with it: kept from view to view, other samples. */
#include "bake/rays.h"

#include "base/random.h"
#include "truth/reference.h"

#include <string.h>

struct rays {
    struct tracer *tracer;
};

static void end(void *thing)
{
    tracer_close(thing);
}

enum status rays_prepare(struct workspace *workspace, const struct scene *scene, struct rays **rays)
{
    *rays = ARENA_NEW(workspace->arena, struct rays);
    enum status status = tracer_open(workspace->arena, scene, workspace->threads, &(*rays)->tracer,
                                     workspace->error);
    arena_at_end(workspace->arena, end, (*rays)->tracer);
    return status;
}

enum status rays_draw(struct workspace *workspace, const struct rays *rays, const struct view *view,
                      int samples, struct target *target)
{
    size_t pixels = (size_t)view->width_px * (size_t)view->height_px;
    if (pixels > RAYS_PRIMARY_MAX / (size_t)samples)
        return error_set(workspace->error, STATUS_UNSUPPORTED,
                         "%d rays for each of %d x %d pixels are more than %zu", samples,
                         view->width_px, view->height_px, RAYS_PRIMARY_MAX);
    /* A reference of the same seed would err as the picture does. */
    struct reference_options options = {.effects = workspace->effects,
                                        .samples_min = samples,
                                        .samples_max = samples,
                                        .seed = random_mix(workspace->seed ^ 0x72617973u),
                                        .quiet = true};
    struct reference_stats stats;
    struct frame *frame;
    struct arena *scratch = arena_create(0);
    enum status status =
        tracer_trace(rays->tracer, scratch, view, &options, &frame, &stats, workspace->error);
    if (!status) {
        memcpy(target->pixels, frame->rgba, 4 * pixels * sizeof(float));
        workspace->tally.rays += (uint64_t)stats.primary_rays;
        workspace->tally.occlusion_rays += (uint64_t)(stats.shadow_rays + stats.occlusion_rays);
    }
    arena_destroy(scratch);
    return status;
}
