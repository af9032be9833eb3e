/* A picture or an error map as a thumbnail on the page and in full size beside it. */
#include "report/picture.h"

#include "truth/frame_image.h"

#include <math.h>
#include <string.h>

struct image *picture_create(struct arena *arena, int width_px, int height_px, int channels)
{
    struct image *image = ARENA_NEW(arena, struct image);
    *image =
        (struct image){.width_px = width_px, .height_px = height_px, .channels_count = channels};
    image->values =
        ARENA_ARRAY(arena, float, (size_t)width_px *(size_t)height_px *(size_t)channels);
    return image;
}

/* Without the coverage, which is no opacity. */
struct image *picture_of_frame(struct arena *arena, const struct frame *frame)
{
    struct image *image = picture_create(arena, frame->width_px, frame->height_px, 3);
    size_t pixels = (size_t)frame->width_px * (size_t)frame->height_px;
    for (size_t i = 0; i < pixels; i++)
        memcpy(image->values + 3 * i, frame->rgba + 4 * i, 3 * sizeof(float));
    return image;
}

/* Averages along one axis; each source value counts by how much of it lies inside the target's. */
static void shrink_axis(const float *source, size_t stride, int count, float *target,
                        size_t target_stride, int target_count)
{
    double step = (double)count / target_count;
    for (int t = 0; t < target_count; t++) {
        double start = t * step, end = start + step, sum = 0;
        for (int s = (int)start; s < count && s < end; s++)
            sum += (fmin(s + 1, end) - fmax(s, start)) * source[(size_t)s * stride];
        target[(size_t)t * target_stride] = (float)(sum / step);
    }
}

/* Box filter in linear light; never enlarges. */
static struct image *image_shrunk(struct arena *arena, const struct image *image, int width_px)
{
    int channels = image->channels_count;
    width_px = width_px < image->width_px ? width_px : image->width_px;
    int height_px = (int)lround((double)image->height_px * width_px / image->width_px);
    height_px = height_px < 1 ? 1 : height_px;
    struct image *rows = picture_create(arena, width_px, image->height_px, channels);
    struct image *small = picture_create(arena, width_px, height_px, channels);
    size_t stride = (size_t)channels, wide = stride * (size_t)image->width_px;
    size_t narrow = stride * (size_t)width_px;
    for (int y = 0; y < image->height_px; y++)
        for (size_t c = 0; c < stride; c++)
            shrink_axis(image->values + (size_t)y * wide + c, stride, image->width_px,
                        rows->values + (size_t)y * narrow + c, stride, width_px);
    for (size_t x = 0; x < narrow; x++)
        shrink_axis(rows->values + x, narrow, image->height_px, small->values + x, narrow,
                    height_px);
    return small;
}

void picture_base64(const uint8_t *bytes, size_t size, FILE *out)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        size_t left = size - i;
        unsigned bits = (unsigned)bytes[i] << 16;
        bits |= left > 1 ? (unsigned)bytes[i + 1] << 8 : 0;
        bits |= left > 2 ? bytes[i + 2] : 0;
        char four[4] = {digits[bits >> 18], digits[bits >> 12 & 63],
                        left > 1 ? digits[bits >> 6 & 63] : '=',
                        left > 2 ? digits[bits & 63] : '='};
        fwrite(four, 1, 4, out);
    }
}

/* Signed values as colours: missing is blue, too much is orange, none is black; by the root of the
 * value, so that thin edges are seen. Both ends are told apart by every reader. Already
 * sRGB-encoded. */
static struct image *signed_to_image(struct arena *arena, const struct image *map)
{
    static const float ends[2][3] = {{0.34f, 0.71f, 0.98f}, {1.0f, 0.63f, 0.22f}};
    struct image *image = picture_create(arena, map->width_px, map->height_px, 3);
    size_t pixels = (size_t)map->width_px * (size_t)map->height_px;
    for (size_t i = 0; i < pixels; i++)
        for (size_t c = 0; c < 3; c++)
            image->values[3 * i + c] =
                sqrtf(fminf(fabsf(map->values[i]), 1)) * ends[map->values[i] > 0][c];
    return image;
}

static struct image *colored(struct arena *arena, enum picture_kind kind, struct image *image)
{
    if (kind == PICTURE_FLIP)
        return map_to_image(arena, image->values, image->width_px, image->height_px, 1);
    return kind == PICTURE_COVERAGE ? signed_to_image(arena, image) : image;
}

void picture_missing(struct gallery *gallery, const char *why, FILE *out)
{
    gallery->missing++;
    fputs("<p class=\"missing\">", out);
    html_put(out, why);
    fputs("</p>", out);
}

void picture_put(const struct picture *picture, struct image *image, FILE *out)
{
    struct gallery *gallery = picture->gallery;
    struct arena *scratch = picture->scratch;
    struct error error = {0};
    bool is_map = picture->kind != PICTURE_DRAWN;
    /* A map is coloured after shrinking: a mean of colours is no colour of the scale. */
    struct image *small =
        image_shrunk(scratch, image, is_map ? gallery->thumbnail_px / 2 : gallery->thumbnail_px);
    image = colored(scratch, picture->kind, image);
    small = colored(scratch, picture->kind, small);
    uint8_t *bytes;
    size_t size;
    const char *path =
        arena_printf(scratch, "%s/pictures/%s.png", gallery->out_folder, picture->name);
    enum status status = image_write(path, image, 8, !is_map, &error);
    if (status == STATUS_OK)
        status = image_png(scratch, small, !is_map, &bytes, &size, &error);
    if (status != STATUS_OK) {
        picture_missing(gallery, error.text, out);
        return;
    }
    fputs("<a href=\"pictures/", out);
    html_put(out, picture->name);
    fprintf(out, ".png\"><img decoding=\"async\" width=\"%d\" height=\"%d\" %s alt=\"",
            small->width_px, small->height_px, picture->attributes);
    html_put(out, picture->alt);
    fputs("\" src=\"data:image/png;base64,", out);
    picture_base64(bytes, size, out);
    fputs("\"></a>", out);
}
