/* Metrics of what is seen: PSNR, SSIM, FLIP, HDR-FLIP, with the noise floor from a seeded noisy
 * reference. */
#include "truth/compare.h"

#include "base/random.h"
#include "truth/flip.h"
#include "truth/ssim.h"

#include <math.h>

#define PSNR_MAX_DB 100.0
#define NOISE_SEED 0x7265666e6f697365u
#define PI 3.14159265358979323846

/* One picture in the forms that the metrics take. noisy: the reference with noise added; absent
 * when both are exact. */
struct picture {
    struct rgb_planes linear;
    struct rgb_planes display; /* sRGB-encoded */
    struct ssim_features ssim;
};
struct pictures {
    struct arena *arena;
    struct extent extent;
    bool has_noise;
    struct picture test, reference, noisy;
};

static void split(const struct frame *frame, const struct rgb_planes *planes)
{
    size_t count = (size_t)frame->width_px * (size_t)frame->height_px;
#pragma omp parallel for
    for (size_t i = 0; i < count; i++)
        for (size_t c = 0; c < 3; c++)
            planes->channels[c][i] = frame->rgba[4 * i + c];
}

/* Adds a normal deviate (Box and Muller 1958) a pixel, scaled by each channel's standard deviation.
 */
static void add_noise(const struct frame *test, const struct frame *reference,
                      const struct rgb_planes *planes)
{
    size_t width = (size_t)reference->width_px;
#pragma omp parallel for
    for (int y = 0; y < reference->height_px; y++) {
        struct random random = random_seed(NOISE_SEED, (uint64_t)y);
        for (size_t i = (size_t)y * width; i < ((size_t)y + 1) * width; i++) {
            double radius = sqrt(-2 * log(1 - random_double(&random)));
            double deviate = radius * cos(2 * PI * random_double(&random));
            for (size_t c = 0; c < 3; c++)
                planes->channels[c][i] +=
                    (float)(deviate * sqrt(compare_variance(test, reference, 4 * i + c)));
        }
    }
}

static void prepare(struct arena *arena, struct extent extent, struct picture *picture)
{
    size_t count = extent_count(extent);
    picture->display = rgb_planes_create(arena, extent);
    float *const *in = picture->linear.channels, *const *out = picture->display.channels;
    float *luma = ARENA_ARRAY(arena, float, count);
#pragma omp parallel for
    for (size_t i = 0; i < count; i++) {
        for (int c = 0; c < 3; c++)
            out[c][i] = srgb_encode(in[c][i]);
        luma[i] = 0.2126f * out[0][i] + 0.7152f * out[1][i] + 0.0722f * out[2][i];
    }
    picture->ssim = ssim_features(arena, luma, extent);
}

static struct pictures pictures_prepare(struct arena *arena, const struct frame *test,
                                        const struct frame *reference)
{
    struct pictures all = {.arena = arena,
                           .extent = {test->width_px, test->height_px},
                           .has_noise = test->variance || reference->variance};
    all.test.linear = rgb_planes_create(arena, all.extent);
    all.reference.linear = rgb_planes_create(arena, all.extent);
    split(test, &all.test.linear);
    split(reference, &all.reference.linear);
    prepare(arena, all.extent, &all.test);
    prepare(arena, all.extent, &all.reference);
    if (all.has_noise) {
        all.noisy.linear = rgb_planes_create(arena, all.extent);
        split(reference, &all.noisy.linear);
        add_noise(test, reference, &all.noisy.linear);
        prepare(arena, all.extent, &all.noisy);
    }
    return all;
}

/* Slope of the sRGB curve at a linear value whose encoding is known; 0 where it is clipped. */
static double srgb_slope(double linear, double encoded)
{
    if (linear <= 0 || linear >= 1)
        return 0;
    return linear <= 0.0031308 ? 12.92 : (encoded + 0.055) / (2.4 * linear);
}

static double decibels(double mean_square)
{
    return fmin(-10 * log10(fmax(mean_square, 1e-300)), PSNR_MAX_DB);
}

/* Variance of an encoded value, to first order. */
static double encoded_variance(const struct frame *frame, size_t i, float encoded)
{
    if (!frame->variance)
        return 0;
    double slope = srgb_slope((double)frame->rgba[i], (double)encoded);
    return slope * slope * (double)frame->variance[i];
}

static void set_psnr(const struct pictures *all, const struct frame *test,
                     const struct frame *reference, struct comparison *out)
{
    size_t count = extent_count(all->extent);
    double squared = 0, variance = 0;
    for (size_t c = 0; c < 3; c++) {
        const float *a = all->test.display.channels[c], *b = all->reference.display.channels[c];
        for (size_t i = 0; i < count; i++) {
            double difference = (double)a[i] - (double)b[i];
            squared += difference * difference;
            variance += encoded_variance(test, 4 * i + c, a[i]) +
                        encoded_variance(reference, 4 * i + c, b[i]);
        }
    }
    double values = 3 * (double)count;
    out->raw.psnr_db = decibels(squared / values);
    out->value.psnr_db = decibels((squared - variance) / values);
    out->floor.psnr_db = decibels(variance / values);
}

static void set_ssim(const struct pictures *all, struct comparison *out)
{
    out->value.ssim = out->raw.ssim = ssim_mean(&all->test.ssim, &all->reference.ssim, all->extent);
    out->floor.ssim =
        all->has_noise ? ssim_mean(&all->noisy.ssim, &all->reference.ssim, all->extent) : 1;
}

/* FLIP */

static double plane_mean(const float *plane, struct extent extent)
{
    double sum = 0;
    for (size_t i = 0; i < extent_count(extent); i++)
        sum += (double)plane[i];
    return sum / (double)extent_count(extent);
}

static struct flip_features clamped_features(struct arena *arena, const struct picture *picture,
                                             struct extent extent, const struct rgb_planes *scratch)
{
    for (int c = 0; c < 3; c++)
        for (size_t i = 0; i < extent_count(extent); i++)
            scratch->channels[c][i] = fminf(fmaxf(picture->linear.channels[c][i], 0), 1);
    return flip_features(arena, scratch, extent);
}

static void set_flip(const struct pictures *all, struct comparison *out, float *wanted)
{
    struct arena *scratch = arena_create(0);
    struct extent extent = all->extent;
    struct rgb_planes planes = rgb_planes_create(scratch, extent);
    float *map = wanted ? wanted : ARENA_ARRAY(scratch, float, extent_count(extent));
    struct flip_features reference = clamped_features(scratch, &all->reference, extent, &planes);
    if (all->has_noise) {
        struct flip_features noisy = clamped_features(scratch, &all->noisy, extent, &planes);
        flip_map(&noisy, &reference, extent, map);
        out->floor.flip = plane_mean(map, extent);
    }
    struct flip_features test = clamped_features(scratch, &all->test, extent, &planes);
    flip_map(&test, &reference, extent, map);
    out->value.flip = out->raw.flip = plane_mean(map, extent);
    arena_destroy(scratch);
}

static struct flip_features exposed_features(struct arena *arena, const struct picture *picture,
                                             struct extent extent, double stops,
                                             const struct rgb_planes *scratch)
{
    hdr_flip_expose(&picture->linear, extent, stops, scratch);
    return flip_features(arena, scratch, extent);
}

static void keep_maximum(const float *map, struct extent extent, float *maximum)
{
    for (size_t i = 0; i < extent_count(extent); i++)
        maximum[i] = fmaxf(maximum[i], map[i]);
}

/* Maps of one exposure, kept where they are the largest so far. */
static void add_exposure(const struct pictures *all, double stops, float *test_maximum,
                         float *noise_maximum)
{
    struct arena *scratch = arena_create(0);
    struct extent extent = all->extent;
    struct rgb_planes planes = rgb_planes_create(scratch, extent);
    float *map = ARENA_ARRAY(scratch, float, extent_count(extent));
    struct flip_features reference =
        exposed_features(scratch, &all->reference, extent, stops, &planes);
    struct flip_features test = exposed_features(scratch, &all->test, extent, stops, &planes);
    flip_map(&test, &reference, extent, map);
    keep_maximum(map, extent, test_maximum);
    if (all->has_noise) {
        struct flip_features noisy = exposed_features(scratch, &all->noisy, extent, stops, &planes);
        flip_map(&noisy, &reference, extent, map);
        keep_maximum(map, extent, noise_maximum);
    }
    arena_destroy(scratch);
}

static void set_hdr_flip(const struct pictures *all, struct comparison *out)
{
    struct arena *scratch = arena_create(0);
    size_t count = extent_count(all->extent);
    float *test = ARENA_ARRAY(scratch, float, count), *noise = ARENA_ARRAY(scratch, float, count);
    struct exposures exposures = hdr_flip_exposures(&all->reference.linear, all->extent);
    for (int k = 0; k < exposures.count; k++) {
        double part = exposures.count > 1 ? (double)k / (exposures.count - 1) : 0;
        add_exposure(all, exposures.first + part * (exposures.last - exposures.first), test, noise);
    }
    out->value.hdr_flip = out->raw.hdr_flip = plane_mean(test, all->extent);
    out->floor.hdr_flip = plane_mean(noise, all->extent);
    arena_destroy(scratch);
}

void compare_display(const struct frame *test, const struct frame *reference,
                     struct comparison *comparison, float *map)
{
    struct arena *scratch = arena_create(0);
    struct pictures all = pictures_prepare(scratch, test, reference);
    set_psnr(&all, test, reference, comparison);
    set_ssim(&all, comparison);
    set_flip(&all, comparison, map);
    set_hdr_flip(&all, comparison);
    arena_destroy(scratch);
}
