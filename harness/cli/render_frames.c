/* treeline render --frames: the pictures along a camera path, and a video of them. */
#include "cell/cell.h"
#include "cli/render.h"

#include "base/file.h"
#include "truth/frame_image.h"
#include "wall/video.h"

#include <stdint.h>
#include <stdio.h>

enum { FRAMES_PER_SECOND = 25 };

static enum status keep(void *context, size_t index, const struct frame *frame, struct error *error)
{
    const struct render_request *request = context;
    struct arena *scratch = arena_create(0);
    const char *path = arena_printf(scratch, "%s/frame-%05zu.png", request->frames, index + 1);
    enum status status = frame_write_image(path, frame, error);
    arena_destroy(scratch);
    return status;
}

/* Without ffmpeg the frames are all there is, and that is said. */
static enum status film(const struct render_request *request, size_t count, struct error *error)
{
    enum status status = video_write(request->frames, "path.mp4", FRAMES_PER_SECOND, error);
    bool quiet = request->shot.quiet;
    if (!quiet)
        fprintf(stderr, "treeline: %s/frame-00001.png and on, %zu of them\n", request->frames,
                count);
    if (!quiet && status == STATUS_UNAVAILABLE)
        fprintf(stderr, "treeline: no video: %s\n", error->text);
    else if (!quiet && !status)
        fprintf(stderr, "treeline: %s/path.mp4\n", request->frames);
    return status == STATUS_UNAVAILABLE ? STATUS_OK : status;
}

enum status render_frames(struct arena *arena, const struct render_request *request,
                          struct error *error)
{
    struct cell cell;
    struct scene *scene;
    enum status status = cli_shot_cell(arena, &request->shot, true, &cell, error);
    if (status)
        return status;
    struct scene_request wanted = {cell.trees, cell.seed, cell.width_px, cell.height_px};
    status = scene_load(arena, cell.scene, &wanted, &scene, error);
    if (!status)
        status = file_make_folder(request->frames, error);
    if (status)
        return status;
    size_t count =
        request->frames_count ? (size_t)request->frames_count : scene->camera.frames_count;
    struct view *views = ARENA_ARRAY(arena, struct view, count);
    for (size_t i = 0; i < count; i++)
        view_at(scene, path_time(scene, i, count), &views[i]);
    struct cell_taker taker = {keep, (void *)(uintptr_t)request};
    status = cell_render_views(&cell, views, count, request->shot.backend, &taker, error);
    return status ? status : film(request, count, error);
}
