/* Heights and colours from image files: the cache, what is refused, the tent. */
#include "scene/terrain_image.h"

#include "base/file.h"
#include "base/hash.h"
#include "wall/image.h"

#include <string.h>

enum { CACHED_VALUES_MAX = 1 << 25 };

/* What is asked of an image. */
struct kind {
    const char *cache, *thing;
    bool colors;
    uint32_t side_min;
    size_t channels; /* kept */
};
static const struct kind heights_kind = {"terrain", "height", false, 2, 1};
static const struct kind colors_kind = {"terrain-color", "colour", true, 1, 3};

static enum status sides_check(const struct kind *kind, const char *path, uint64_t width,
                               uint64_t height, struct error *error)
{
    if (width >= kind->side_min && height >= kind->side_min && width <= TERRAIN_SAMPLES_MAX &&
        height <= TERRAIN_SAMPLES_MAX)
        return STATUS_OK;
    return error_set(error, STATUS_INVALID,
                     "%s: the %s image is %llu x %llu px; allowed: %u..%d on each side", path,
                     kind->thing, (unsigned long long)width, (unsigned long long)height,
                     kind->side_min, TERRAIN_SAMPLES_MAX);
}

static bool image_from_cache(struct arena *arena, const struct kind *kind, uint64_t hash,
                             struct terrain_image *image)
{
    void *data = NULL;
    size_t size = 0;
    if (!cache_get(arena, kind->cache, hash, &data, &size) || size < 2 * sizeof(uint32_t))
        return false;
    uint32_t sides[2];
    memcpy(sides, data, sizeof sides);
    if (size != sizeof sides + (size_t)sides[0] * sides[1] * kind->channels * sizeof(float) ||
        sides_check(kind, "", sides[0], sides[1], NULL) != STATUS_OK)
        return false;
    image->width = sides[0];
    image->height = sides[1];
    image->values = (float *)(void *)((char *)data + sizeof sides);
    return true;
}

static void image_to_cache(struct arena *arena, const struct kind *kind, uint64_t hash,
                           const struct terrain_image *image)
{
    uint32_t sides[2] = {image->width, image->height};
    size_t values = (size_t)sides[0] * sides[1] * kind->channels;
    if (values > CACHED_VALUES_MAX)
        return;
    char *data = arena_alloc(arena, 1, sizeof sides + values * sizeof(float));
    memcpy(data, sides, sizeof sides);
    memcpy(data + sizeof sides, image->values, values * sizeof(float));
    cache_put(kind->cache, hash, data, sizeof sides + values * sizeof(float));
}

static enum status shape_check(const struct kind *kind, const char *path, const struct image *image,
                               struct error *error)
{
    int channels = image->channels_count;
    if (kind->colors ? channels != 3 && channels != 4 : channels != 1)
        return error_set(error, STATUS_INVALID, "%s: the %s image has %d channel%s; allowed: %s",
                         path, kind->thing, channels, channels == 1 ? "" : "s",
                         kind->colors ? "3 (red, green, blue), or 4 with alpha" : "1 (grey)");
    return sides_check(kind, path, (uint64_t)image->width_px, (uint64_t)image->height_px, error);
}

/* Copies the channels that are kept and checks each value. */
static enum status values_take(const struct kind *kind, const char *path, const struct image *image,
                               double unit, struct terrain_image *taken, struct error *error)
{
    const size_t channels = (size_t)image->channels_count;
    const size_t count = (size_t)taken->width * taken->height;
    const bool shares = kind->colors || !(unit > 0);
    for (size_t i = 0; i < count; i++)
        for (size_t c = 0; c < kind->channels; c++) {
            float value = image->values[i * channels + c];
            if (!kind->colors && unit > 0)
                value = (float)((double)value * unit);
            if (!isfinite(value) || (shares && !(value >= 0 && value <= 1)))
                return error_set(error, STATUS_INVALID,
                                 "%s: the %s at pixel (%zu, %zu) is %g; allowed: %s", path,
                                 kind->thing, i % taken->width, i / taken->width, (double)value,
                                 shares ? "0..1" : "finite numbers");
            taken->values[i * kind->channels + c] = value;
        }
    return STATUS_OK;
}

static enum status image_decode(struct arena *arena, struct arena *scratch, const struct kind *kind,
                                const char *path, struct terrain_image *taken, struct error *error)
{
    struct image *image = NULL;
    double unit = 0;
    enum status status = kind->colors ? image_read(scratch, path, true, &image, error)
                                      : image_read_units(scratch, path, &image, &unit, error);
    if (status == STATUS_OK)
        status = shape_check(kind, path, image, error);
    if (status != STATUS_OK)
        return status;
    taken->width = (uint32_t)image->width_px;
    taken->height = (uint32_t)image->height_px;
    taken->values =
        ARENA_ARRAY(arena, float, (size_t)taken->width * taken->height * kind->channels);
    return values_take(kind, path, image, unit, taken, error);
}

static enum status image_take(struct arena *arena, const struct kind *kind, const char *path,
                              struct terrain_image *taken, struct error *error)
{
    struct arena *scratch = arena_create(0);
    char *bytes = NULL;
    size_t size = 0;
    enum status status = file_read(scratch, path, 0, &bytes, &size, error);
    uint64_t hash = status == STATUS_OK ? hash_bytes(0, bytes, size) : 0;
    if (status == STATUS_OK && !image_from_cache(arena, kind, hash, taken)) {
        status = image_decode(arena, scratch, kind, path, taken, error);
        if (status == STATUS_OK)
            image_to_cache(scratch, kind, hash, taken);
    }
    arena_destroy(scratch);
    return status;
}

enum status terrain_image_heights(struct arena *arena, const char *path,
                                  struct terrain_image *heights, struct error *error)
{
    return image_take(arena, &heights_kind, path, heights, error);
}

enum status terrain_image_colors(struct arena *arena, const char *path,
                                 struct terrain_image *colors, struct error *error)
{
    return image_take(arena, &colors_kind, path, colors, error);
}

/* The pixels around one sample along an axis, each by its weight. */
struct tent {
    double at, radius;
    uint32_t first, end;
};

static struct tent tent_at(uint32_t sample, uint32_t samples, uint32_t pixels)
{
    const double spacing = (double)(pixels - 1) / (samples - 1);
    struct tent tent = {.at = sample * spacing, .radius = fmax(1, spacing)};
    double first = floor(tent.at - tent.radius) + 1, last = ceil(tent.at + tent.radius) - 1;
    tent.first = (uint32_t)fmax(0, first);
    tent.end = (uint32_t)fmin(pixels - 1, last) + 1;
    return tent;
}

static double tent_weight(const struct tent *tent, uint32_t pixel)
{
    return fmax(0, 1 - fabs((double)pixel - tent->at) / tent->radius);
}

static void color_at(const struct terrain_image *image, const struct tent *across,
                     const struct tent *down, float color[3])
{
    double sums[3] = {0, 0, 0}, total = 0;
    for (uint32_t z = down->first; z < down->end; z++)
        for (uint32_t x = across->first; x < across->end; x++) {
            double weight = tent_weight(across, x) * tent_weight(down, z);
            total += weight;
            for (int c = 0; c < 3; c++)
                sums[c] +=
                    weight * (double)image->values[3 * ((size_t)z * image->width + x) + (size_t)c];
        }
    for (int c = 0; c < 3; c++)
        color[c] = (float)(sums[c] / total);
}

float (*terrain_image_resample(struct arena *arena, const struct terrain_image *colors,
                               uint32_t samples_x, uint32_t samples_z))[3]
{
    float(*result)[3] = arena_alloc(arena, (size_t)samples_x * samples_z, sizeof *result);
    for (uint32_t z = 0; z < samples_z; z++) {
        const struct tent down = tent_at(z, samples_z, colors->height);
        for (uint32_t x = 0; x < samples_x; x++) {
            const struct tent across = tent_at(x, samples_x, colors->width);
            color_at(colors, &across, &down, result[(size_t)z * samples_x + x]);
        }
    }
    return result;
}
