/* FLIP: Andersson et al. 2020, doi:10.1145/3406183; equation numbers are that paper's sections. */
#include "truth/flip.h"

#include <math.h>

#define PIXELS_PER_DEGREE 67.0
#define PI 3.14159265358979323846
enum { SPATIAL_RADIUS_MAX = 16 };

/* Section 4.1.1: contrast sensitivity a sqrt(pi / b) exp(-pi^2 x^2 / b), x in degrees; blue-yellow
 * is a sum of two. */
struct sensitivity {
    double a, b;
};
static const struct sensitivity achromatic = {1, 0.0047}, red_green = {1, 0.0053},
                                blue_yellow[2] = {{34.1, 0.04}, {13.5, 0.025}};
#define WIDEST_B 0.04

/* Section 4.1 and 4.2 constants. */
#define COLOR_EXPONENT 0.7f   /* q_c */
#define COLOR_KNEE 0.4f       /* p_c, of the largest difference */
#define COLOR_KNEE_ERROR .95f /* p_t */
#define FEATURE_WIDTH 0.082   /* w, degrees */

/* sRGB primaries and D65, as in the authors' program. */
static const float xyz_from_rgb[3][3] = {
    {0.412386563f, 0.357591491f, 0.180450491f},
    {0.212636822f, 0.715182982f, 0.072180196f},
    {0.019330620f, 0.119197164f, 0.950372587f},
};
static const float rgb_from_xyz[3][3] = {
    {3.241003275f, -1.537398934f, -0.498615861f},
    {-0.969224334f, 1.875930071f, 0.041554224f},
    {0.055639423f, -0.204011202f, 1.057148933f},
};
static const float white[3] = {0.950428545f, 1, 1.088900371f};

struct rgb_planes rgb_planes_create(struct arena *arena, struct extent extent)
{
    struct rgb_planes planes;
    for (int c = 0; c < 3; c++)
        planes.channels[c] = ARENA_ARRAY(arena, float, extent_count(extent));
    return planes;
}

static float dot3(const float row[3], const float v[3])
{
    return row[0] * v[0] + row[1] * v[1] + row[2] * v[2];
}

/* XYZ relative to white. */
static void relative_xyz(const float rgb[3], float xyz[3])
{
    for (int i = 0; i < 3; i++)
        xyz[i] = dot3(xyz_from_rgb[i], rgb) / white[i];
}

static float lab_curve(float t)
{
    const float delta = 6 / 29.f;
    return t > delta * delta * delta ? cbrtf(t) : t / (3 * delta * delta) + 4 / 29.f;
}

/* CIELab with a and b scaled by L / 100 (Hunt effect, section 4.1.2). */
static void hunt_lab(const float rgb[3], float lab[3])
{
    float xyz[3];
    relative_xyz(rgb, xyz);
    float x = lab_curve(xyz[0]), y = lab_curve(xyz[1]), z = lab_curve(xyz[2]);
    lab[0] = 116 * y - 16;
    lab[1] = 0.01f * lab[0] * 500 * (x - y);
    lab[2] = 0.01f * lab[0] * 200 * (y - z);
}

/* HyAB distance, section 4.1.2. */
static float hyab(const float a[3], const float b[3])
{
    float da = a[1] - b[1], db = a[2] - b[2];
    return fabsf(a[0] - b[0]) + sqrtf(da * da + db * db);
}

/* Kernels */

static void sensitivity_weights(struct sensitivity s, int radius, double *weights)
{
    int count = 2 * radius + 1;
    double sum = 0;
    for (int k = 0; k < count; k++) {
        double x = (k - radius) / PIXELS_PER_DEGREE;
        sum += weights[k] = exp(-PI * PI * x * x / s.b);
    }
    for (int k = 0; k < count; k++)
        weights[k] /= sum;
}

/* The two-dimensional blue-yellow kernel, sum of a_i sqrt(pi / b_i) exp(-pi^2 r^2 / b_i), is the
 * sum of two separable ones; each gets half of its amplitude (the root) in either direction, both
 * together sum to 1. */
static void blue_yellow_weights(int radius, double *first, double *second)
{
    double *weights[2] = {first, second};
    int count = 2 * radius + 1;
    double total = 0;
    for (int i = 0; i < 2; i++) {
        struct sensitivity s = blue_yellow[i];
        double sum = 0;
        for (int k = 0; k < count; k++) {
            double x = (k - radius) / PIXELS_PER_DEGREE;
            sum += weights[i][k] = sqrt(s.a * sqrt(PI / s.b)) * exp(-PI * PI * x * x / s.b);
        }
        total += sum * sum;
    }
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < count; k++)
            weights[i][k] /= sqrt(total);
}

/* Positive and negative weights each sum to 1. */
static void balance(double *weights, int count)
{
    double positive = 0, negative = 0;
    for (int k = 0; k < count; k++)
        *(weights[k] > 0 ? &positive : &negative) += fabs(weights[k]);
    for (int k = 0; k < count; k++)
        weights[k] /= weights[k] > 0 ? positive : negative;
}

/* Section 4.2.1: a Gaussian of half the feature's width and its first two derivatives. */
static void feature_weights(int radius, double sigma, double *smooth, double *first, double *second)
{
    int count = 2 * radius + 1;
    double sum = 0;
    for (int k = 0; k < count; k++) {
        int x = k - radius;
        double value = exp(-x * x / (2 * sigma * sigma));
        sum += smooth[k] = value;
        first[k] = -x * value;
        second[k] = (x * x / (sigma * sigma) - 1) * value;
    }
    for (int k = 0; k < count; k++)
        smooth[k] /= sum;
    balance(first, count);
    balance(second, count);
}

/* Features of one picture */

/* Luminance y, red-green x - y and blue-yellow y - z, relative to white: the opponent space YCxCz
 * without its scale and offset, which filters of sum 1 leave alone. */
static void opponent_planes(const struct rgb_planes *picture, struct extent extent,
                            double *const out[3])
{
    float *const *in = picture->channels;
#pragma omp parallel for
    for (size_t i = 0; i < extent_count(extent); i++) {
        float xyz[3];
        relative_xyz((float[3]){in[0][i], in[1][i], in[2][i]}, xyz);
        out[0][i] = (double)xyz[1];
        out[1][i] = (double)(xyz[0] - xyz[1]);
        out[2][i] = (double)(xyz[1] - xyz[2]);
    }
}

static void blur(const double *in, struct extent extent, int radius, const double *weights,
                 double *scratch, double *out)
{
    struct kernel kernel = {radius, weights, BORDER_REPLICATE};
    filter_rows(in, extent, &kernel, scratch);
    filter_columns(scratch, extent, &kernel, out);
}

static void filtered_lab(double *const opponent[3], const double *more, struct extent extent,
                         float *const lab[3])
{
#pragma omp parallel for
    for (size_t i = 0; i < extent_count(extent); i++) {
        float y = (float)opponent[0][i], cx = (float)opponent[1][i];
        float cz = (float)(opponent[2][i] + more[i]);
        float xyz[3] = {(cx + y) * white[0], y * white[1], (y - cz) * white[2]}, rgb[3], out[3];
        for (int c = 0; c < 3; c++)
            rgb[c] = fminf(fmaxf(dot3(rgb_from_xyz[c], xyz), 0), 1);
        hunt_lab(rgb, out);
        for (int c = 0; c < 3; c++)
            lab[c][i] = out[c];
    }
}

static void magnitude(const double *x, const double *y, struct extent extent, float *out)
{
#pragma omp parallel for
    for (size_t i = 0; i < extent_count(extent); i++)
        out[i] = (float)sqrt(x[i] * x[i] + y[i] * y[i]);
}

/* Planes that are needed on the way. */
struct work {
    double *opponent[3], *filtered[3], *rows, *more;
};

static struct work work_planes(struct arena *arena, struct extent extent)
{
    struct work work;
    size_t count = extent_count(extent);
    for (int c = 0; c < 3; c++) {
        work.opponent[c] = ARENA_ARRAY(arena, double, count);
        work.filtered[c] = ARENA_ARRAY(arena, double, count);
    }
    work.rows = ARENA_ARRAY(arena, double, count);
    work.more = ARENA_ARRAY(arena, double, count);
    return work;
}

enum { WEIGHTS = 2 * SPATIAL_RADIUS_MAX + 1 };

/* What the eye resolves of the colours, section 4.1.1. */
static void color_planes(const struct work *work, struct extent extent, float *const lab[3])
{
    int radius = (int)ceil(3 * sqrt(WIDEST_B / (2 * PI * PI)) * PIXELS_PER_DEGREE);
    double y_weights[WEIGHTS], cx_weights[WEIGHTS], cz_weights[2][WEIGHTS];
    sensitivity_weights(achromatic, radius, y_weights);
    sensitivity_weights(red_green, radius, cx_weights);
    blue_yellow_weights(radius, cz_weights[0], cz_weights[1]);
    blur(work->opponent[0], extent, radius, y_weights, work->rows, work->filtered[0]);
    blur(work->opponent[1], extent, radius, cx_weights, work->rows, work->filtered[1]);
    blur(work->opponent[2], extent, radius, cz_weights[0], work->rows, work->filtered[2]);
    blur(work->opponent[2], extent, radius, cz_weights[1], work->rows, work->more);
    filtered_lab(work->filtered, work->more, extent, lab);
}

/* Lengths of the first and second derivatives of luminance, section 4.2.1. Overwrites the filtered
 * planes. */
static void feature_planes(const struct work *work, struct extent extent, float *edges,
                           float *points)
{
    double sigma_px = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
    int radius = (int)ceil(3 * sigma_px);
    double smooth[WEIGHTS], first[WEIGHTS], second[WEIGHTS];
    feature_weights(radius, sigma_px, smooth, first, second);
    struct kernel gaussian = {radius, smooth, BORDER_REPLICATE};
    struct kernel changes[2] = {{radius, first, BORDER_REPLICATE},
                                {radius, second, BORDER_REPLICATE}};
    double *smoothed = work->more, *along_x = work->filtered[0], *along_y = work->filtered[1];
    filter_rows(work->opponent[0], extent, &gaussian, smoothed);
    for (int k = 0; k < 2; k++) {
        filter_rows(work->opponent[0], extent, &changes[k], work->rows);
        filter_columns(work->rows, extent, &gaussian, along_x);
        filter_columns(smoothed, extent, &changes[k], along_y);
        magnitude(along_x, along_y, extent, k ? points : edges);
    }
}

struct flip_features flip_features(struct arena *arena, const struct rgb_planes *picture,
                                   struct extent extent)
{
    struct arena *scratch = arena_create(0);
    struct work work = work_planes(scratch, extent);
    struct rgb_planes lab = rgb_planes_create(arena, extent);
    struct flip_features features = {{lab.channels[0], lab.channels[1], lab.channels[2]},
                                     ARENA_ARRAY(arena, float, extent_count(extent)),
                                     ARENA_ARRAY(arena, float, extent_count(extent))};
    opponent_planes(picture, extent, work.opponent);
    color_planes(&work, extent, lab.channels);
    feature_planes(&work, extent, features.edges, features.points);
    arena_destroy(scratch);
    return features;
}

/* Comparison */

/* The largest difference there is, between the primaries green and blue, section 4.1.3. */
static float largest_color_difference(void)
{
    float green[3], blue[3];
    hunt_lab((float[3]){0, 1, 0}, green);
    hunt_lab((float[3]){0, 0, 1}, blue);
    return powf(hyab(green, blue), COLOR_EXPONENT);
}

/* Section 4.1.3: [0, knee] is stretched to [0, .95], the rest squeezed into [.95, 1]. */
static float color_error(float difference, float largest)
{
    float power = powf(difference, COLOR_EXPONENT), knee = COLOR_KNEE * largest;
    if (power < knee)
        return power * (COLOR_KNEE_ERROR / knee);
    float error = COLOR_KNEE_ERROR + (power - knee) / (largest - knee) * (1 - COLOR_KNEE_ERROR);
    return fminf(error, 1);
}

void flip_map(const struct flip_features *a, const struct flip_features *b, struct extent extent,
              float *map)
{
    float largest = largest_color_difference();
#pragma omp parallel for
    for (size_t i = 0; i < extent_count(extent); i++) {
        float difference = hyab((float[3]){a->lab[0][i], a->lab[1][i], a->lab[2][i]},
                                (float[3]){b->lab[0][i], b->lab[1][i], b->lab[2][i]});
        float edge = fabsf(a->edges[i] - b->edges[i]), point = fabsf(a->points[i] - b->points[i]);
        /* Section 4.2.2, q_f = .5; section 4.3. */
        float feature = fminf(sqrtf(fmaxf(edge, point) * 0.70710678f), 1);
        float color = color_error(difference, largest);
        map[i] = color > 0 ? powf(color, 1 - feature) : 0;
    }
}
