/* Shadow masks of a cell: the method's against the ray-traced, after its pictures. */
#include "cell/stage.h"

#include "base/file.h"

#include <math.h>

bool stage_has_mask(const struct cell *cell, unsigned effects)
{
    return cell->method->traits & TRAIT_MASK && effects & EFFECT_SUN_SHADOWS;
}

struct reference_options stage_mask_options(const struct plan *plan, const struct cell *cell,
                                            unsigned effects, bool neighbour)
{
    unsigned kept = (effects & EFFECT_TWO_SIDED) | EFFECT_SUN_SHADOWS;
    struct reference_options options = stage_reference_options(plan, cell, kept, neighbour);
    options.masked = true;
    return options;
}

const struct frame *stage_reference(struct stage *stage, const struct view *view,
                                    const struct reference_options *options, uint64_t *key)
{
    struct error why = {0};
    struct frame *frame = NULL;
    *key = reference_key(stage->scene, view, options);
    if (stage->folder) {
        const char *path = stage_reference_path(stage->scene_arena, stage->folder, *key);
        if (!file_exists(path) || frame_load(stage->scene_arena, path, &frame, &why))
            frame = NULL;
    } else {
        struct reference_stats stats;
        if (reference_cached(stage->scene_arena, stage->scene, view, options, &frame, &stats, &why))
            frame = NULL;
    }
    if (!frame)
        stage->result->message = arena_printf(stage->result_arena, "not compared: %s",
                                              *why.text ? why.text : "the reference was not made");
    return frame;
}

/* The method's mask and the true one; truth NULL: not made. */
static enum status masks_draw(struct stage *stage, const struct view *view, bool neighbour,
                              const struct frame **test, const struct frame **truth)
{
    struct reference_options options =
        stage_mask_options(stage->plan, stage->cell, stage->result->effects, neighbour);
    uint64_t key;
    *truth = stage_reference(stage, view, &options, &key);
    stage->workspace.masked = true;
    enum status status = stage_draw(stage, view, NULL);
    stage->workspace.masked = false;
    if (!status)
        status = stage_check(stage, "a shadow mask");
    if (status)
        return status;
    struct frame *drawn = stage_read(stage, stage->scene_arena);
    *test = drawn;
    return frame_check(drawn, stage->error);
}

enum status stage_mask(struct stage *stage, const struct view *view, struct result_view *result)
{
    const struct frame *tests[2], *truths[2];
    struct view next;
    if (!stage_has_mask(stage->cell, stage->result->effects))
        return STATUS_OK;
    stage_announce(stage, "a shadow mask");
    enum status status = masks_draw(stage, view, false, &tests[0], &truths[0]);
    if (status || !truths[0])
        return status;
    status = mask_compare(tests[0], truths[0], &result->mask, stage->error);
    result->masked = !status;
    if (status || stage_path_frames(stage->scene) < 2)
        return status;
    view_at(stage->scene, stage_neighbour_time(stage->scene, result->time), &next);
    status = masks_draw(stage, &next, true, &tests[1], &truths[1]);
    if (status || !truths[1])
        return status;
    return mask_shimmer(tests, truths, &result->mask.shimmer, stage->error);
}
