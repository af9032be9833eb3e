/* Frames to images and back; error maps to colours. */
#include "truth/frame_image.h"

#include "base/file.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

static const char *const frame_names[] = {"R",          "G",          "B",          "A",
                                          "variance.R", "variance.G", "variance.B", "variance.A"};

/* Every sixteenth of matplotlib's magma. */
static const float magma[17][3] = {
    {0.0015f, 0.0005f, 0.0139f}, {0.0394f, 0.0309f, 0.1330f}, {0.1124f, 0.0653f, 0.2756f},
    {0.2104f, 0.0622f, 0.4173f}, {0.3151f, 0.0712f, 0.4848f}, {0.4128f, 0.1096f, 0.5045f},
    {0.5105f, 0.1473f, 0.5077f}, {0.6108f, 0.1809f, 0.4990f}, {0.7132f, 0.2139f, 0.4762f},
    {0.8135f, 0.2542f, 0.4381f}, {0.9013f, 0.3165f, 0.3899f}, {0.9592f, 0.4135f, 0.3599f},
    {0.9859f, 0.5300f, 0.3801f}, {0.9959f, 0.6477f, 0.4423f}, {0.9970f, 0.7633f, 0.5296f},
    {0.9928f, 0.8776f, 0.6335f}, {0.9871f, 0.9914f, 0.7495f},
};

/* count channels of rgba and variance side by side. */
static float *interleave(struct arena *arena, const struct frame *frame, size_t channels)
{
    size_t count = (size_t)frame->width_px * (size_t)frame->height_px;
    float *values = ARENA_ARRAY(arena, float, count *channels);
    for (size_t i = 0; i < count; i++)
        for (size_t c = 0; c < channels; c++)
            values[i * channels + c] =
                c < 4 ? frame->rgba[4 * i + c] : frame->variance[4 * i + c - 4];
    return values;
}

enum status frame_write_image(const char *path, const struct frame *frame, struct error *error)
{
    bool exr = path_ends_with(path, ".exr");
    struct arena *scratch = arena_create(0);
    size_t channels = !exr ? 3 : frame->variance ? 8 : 4;
    struct image image = {frame->width_px, frame->height_px, (int)channels,
                          interleave(scratch, frame, channels), frame_names};
    enum status status = image_write(path, &image, exr ? 32 : 8, true, error);
    arena_destroy(scratch);
    return status;
}

/* Reading */

static int channel_named(const struct image *image, const char *name)
{
    for (int c = 0; c < image->channels_count; c++)
        if (image->names && strcasecmp(image->names[c], name) == 0)
            return c;
    return -1;
}

/* Which channel of the image is R, G, B, A (-1: none) and variance of each (-1: none). */
static void find_channels(const struct image *image, int at[8])
{
    for (int c = 0; c < 8; c++)
        at[c] = channel_named(image, frame_names[c]);
    bool named = at[0] >= 0 && at[1] >= 0 && at[2] >= 0;
    bool grey = image->channels_count < 3;
    for (int c = 0; c < 3 && !named; c++)
        at[c] = grey ? 0 : c;
    if (at[3] < 0 && !named && image->channels_count == 2)
        at[3] = 1;
    if (at[4] < 0 || at[5] < 0 || at[6] < 0 || at[7] < 0)
        at[4] = -1;
}

static enum status image_to_frame(struct arena *arena, const struct image *image, const char *path,
                                  struct frame **frame, bool *has_coverage, struct error *error)
{
    if (image->width_px > FRAME_SIDE_MAX_PX || image->height_px > FRAME_SIDE_MAX_PX ||
        image->width_px > FRAME_PIXELS_MAX / image->height_px)
        return error_set(error, STATUS_INVALID,
                         "%s: size %d x %d is outside 1..%d px a side, %d px in all", path,
                         image->width_px, image->height_px, FRAME_SIDE_MAX_PX, FRAME_PIXELS_MAX);
    int at[8];
    find_channels(image, at);
    *frame = frame_create(arena, image->width_px, image->height_px, at[4] >= 0);
    *has_coverage = at[3] >= 0;
    size_t count = (size_t)image->width_px * (size_t)image->height_px;
    for (size_t i = 0; i < count; i++) {
        const float *pixel = image->values + i * (size_t)image->channels_count;
        for (size_t c = 0; c < 4; c++) {
            (*frame)->rgba[4 * i + c] = at[c] >= 0 ? pixel[at[c]] : 1;
            if ((*frame)->variance)
                (*frame)->variance[4 * i + c] = pixel[at[4 + c]];
        }
    }
    return STATUS_OK;
}

static bool is_frame_file(const char *path)
{
    char start[sizeof FRAME_FILE_MAGIC - 1];
    struct stat info;
    FILE *file = stat(path, &info) == 0 && S_ISREG(info.st_mode) ? fopen(path, "rb") : NULL;
    if (!file)
        return false;
    bool is = fread(start, 1, sizeof start, file) == sizeof start &&
              memcmp(start, FRAME_FILE_MAGIC, sizeof start) == 0;
    fclose(file);
    return is;
}

enum status frame_read_image(struct arena *arena, const char *path, struct frame **frame,
                             bool *has_coverage, struct error *error)
{
    *has_coverage = true;
    if (is_frame_file(path))
        return frame_load(arena, path, frame, error);
    struct arena *scratch = arena_create(0);
    struct image *image;
    enum status status = image_read(scratch, path, true, &image, error);
    if (status == STATUS_OK)
        status = image_to_frame(arena, image, path, frame, has_coverage, error);
    arena_destroy(scratch);
    return status;
}

/* Error maps */

struct image *map_to_image(struct arena *arena, const float *map, int width_px, int height_px,
                           float full)
{
    size_t count = (size_t)width_px * (size_t)height_px;
    struct image *image = ARENA_NEW(arena, struct image);
    *image = (struct image){width_px, height_px, 3, ARENA_ARRAY(arena, float, 3 * count), NULL};
    for (size_t i = 0; i < count; i++) {
        float place = fminf(fmaxf(map[i] / full, 0), 1) * 16; /* fmaxf(NaN, 0) is 0 */
        int below = place < 15 ? (int)place : 15;
        float part = place - (float)below;
        for (size_t c = 0; c < 3; c++)
            image->values[3 * i + c] =
                magma[below][c] + part * (magma[below + 1][c] - magma[below][c]);
    }
    return image;
}
