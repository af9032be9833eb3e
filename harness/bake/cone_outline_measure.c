/* A tree's outline, measured in pictures of its twigs from around it. */
#include "bake/cone_emit.h"
#include "bake/cone_outline.h"

#include <math.h>
#include <string.h>

enum {
    SIDE_PX = 64,
    FINE_PX = 192,
    TWIGS = 4096,
    TURNS = 2,
    TURNS_MOST = 16,
    TRIES = 9,
    NEEDLES = 200000,  /* in a picture, at most */
    MANY = 32,         /* twigs; of fewer the mean from around is not what one view shows */
    ROOM_PX = 1 << 16, /* of all tries together */
};

/* What a picture of a plant is of. */
struct sitter {
    const struct scene *scene;
    const struct cone_plant *plant;
    enum cone_shaders shaders;
    struct cone_choice choice;
};

struct sketch {
    struct view view;
    struct cone_picture picture;
    struct cone_tree tree;
    int side_px, tries;
    float fills[TRIES];        /* what opacities but the trunk's are multiplied by, a try each */
    float *left;               /* tries x side x side */
    struct cone_strip *strips; /* of a twig */
    double covered[TRIES];     /* pixels */
    double sum;                /* what each strip of the first try covers by itself */
};

/* Right, up and forward of a view from an elevation's sine. */
static void axes_of(float rise, float turn_rad, float axes[3][3])
{
    const float flat = sqrtf(fmaxf(1 - rise * rise, 0)), s = sinf(turn_rad), c = cosf(turn_rad);
    memcpy(axes,
           (float[3][3]){{c, 0, -s}, {-rise * s, flat, -rise * c}, {-flat * s, -rise, -flat * c}},
           sizeof(float[3][3]));
}

/* No more than so many twigs and boughs, the fewer the larger. */
static void tree_cap(struct cone_tree *tree, float most)
{
    const size_t trunks = tree->plant->trunks_count, boughs = tree->plant->barks_count - trunks;
    if (tree->twigs > most) {
        tree->twigs = most;
        tree->twigs_grown = (float)tree->plant->twigs_count / most;
    }
    if (tree->barks - (float)trunks > most) {
        tree->barks = most + (float)trunks;
        tree->barks_grown = (float)boughs / most;
    }
}

/* A plant so wide on a picture, from so far that its sides are parallel. */
static void sketch_begin(const struct sitter *sitter, float diameter_px, const float shift_px[2],
                         float (*axes)[3], struct sketch *sketch)
{
    const struct cone_plant *plant = sitter->plant;
    const float far_m = 1000 * plant->radius_m, px = 0.5f * diameter_px / plant->radius_m;
    struct cone_tree *tree = &sketch->tree;
    sketch->view = (struct view){
        .width_px = sketch->side_px, .height_px = sketch->side_px, .near_m = plant->radius_m};
    sketch->picture = (struct cone_picture){.view = &sketch->view,
                                            .scene = sitter->scene,
                                            .focal_px = px * far_m,
                                            .choice = sitter->choice,
                                            .shaders = sitter->shaders};
    *tree = (struct cone_tree){.plant = plant, .scale = 1, .fill = 1};
    cone_tree_thin(&sitter->choice, px, tree);
    for (int k = 0; k < 3; k++) {
        memcpy(tree->to_camera[k], axes[k], sizeof tree->to_camera[k]);
        tree->eye_m[k] = plant->center_m[k] - far_m * axes[2][k];
        tree->sun[k] = -axes[2][k];
        tree->foot_m[k] = k == 2 ? far_m : shift_px[k] / px;
        for (int i = 0; i < 3; i++)
            tree->foot_m[k] -= axes[k][i] * plant->center_m[i];
    }
    for (int i = 0; i < sketch->tries * sketch->side_px * sketch->side_px; i++)
        sketch->left[i] = 1;
    sketch->sum = 0;
}

static void pixel_draw(struct sketch *sketch, size_t pixel, float w, bool is_trunk)
{
    const size_t pixels = (size_t)sketch->side_px * (size_t)sketch->side_px;
    for (int k = 0; k < sketch->tries; k++) {
        float part = is_trunk ? w : fminf(sketch->fills[k] * w, 1);
        sketch->left[(size_t)k * pixels + pixel] *= 1 - part;
    }
    sketch->sum += w;
}

static void strips_draw(struct sketch *sketch, size_t count, bool is_trunk)
{
    const int side_px = sketch->side_px;
    for (const struct cone_strip *strip = sketch->strips; count > 0; count--, strip++) {
        float low[2], high[2];
        int first[2], last[2];
        cone_strip_rect(strip, low, high);
        for (int i = 0; i < 2; i++) {
            first[i] = (int)fmaxf(ceilf(low[i]), 0);
            last[i] = (int)fminf(floorf(high[i]), (float)(side_px - 1));
        }
        for (int y = first[1]; y <= last[1]; y++)
            for (int x = first[0]; x <= last[0]; x++) {
                struct cone_place place;
                float w = cone_strip_hides(strip, (float)x, (float)y, &place);
                if (w > 0)
                    pixel_draw(sketch, (size_t)(y * side_px + x), w, is_trunk);
            }
    }
}

static void sketch_draw(struct sketch *sketch)
{
    const struct cone_tree *tree = &sketch->tree;
    const int pixels = sketch->side_px * sketch->side_px;
    for (size_t i = 0; (float)i < tree->twigs; i++)
        strips_draw(sketch, cone_twig_emit(&sketch->picture, tree, i, NULL, sketch->strips), false);
    for (size_t i = 0; (float)i < tree->barks; i++)
        strips_draw(sketch, cone_bark_emit(&sketch->picture, tree, i, sketch->strips),
                    i < tree->plant->trunks_count);
    for (int k = 0; k < sketch->tries; k++) {
        sketch->covered[k] = 0;
        for (int i = 0; i < pixels; i++)
            sketch->covered[k] += 1 - (double)sketch->left[k * pixels + i];
    }
}

/* The optical depth of what covers so much less than the sum of its parts: (1 - exp(-t)) / t. */
static float depth_of(double covered, double sum)
{
    double low = 0, high = 1e3;
    for (int step = 0; step < 60; step++) {
        double depth = 0.5 * (low + high);
        *(-expm1(-depth) * sum > covered * depth ? &low : &high) = depth;
    }
    return (float)low;
}

/* Half widths of rows, of a picture from the side. */
static void rows_add(const struct sketch *sketch, float covers, struct cone_outline *outline)
{
    const struct cone_plant *plant = sketch->tree.plant;
    const float pixel_m = plant->radius_m / (0.45f * SIDE_PX);
    for (int i = 0; i < SIDE_PX * SIDE_PX; i++) {
        float up_px = 0.5f * (SIDE_PX - 1) - (float)(i / SIDE_PX);
        float at = (plant->center_m[1] + pixel_m * up_px - outline->low_m) * outline->rows_per_m;
        int row = at > 0 ? at < CONE_ROWS ? (int)at : CONE_ROWS - 1 : 0;
        outline->halves_m[row] +=
            0.5f / TURNS * pixel_m * pixel_m * outline->rows_per_m * (1 - sketch->left[i]) / covers;
    }
}

static size_t strips_most(const struct cone_plant *plant)
{
    size_t most = 1;
    for (size_t i = 0; i < plant->twigs_count; i++) {
        const struct conifer_twig *twig = plant->twigs[i].twig;
        size_t count = 2 + (size_t)twig->cones_count * (2 + (size_t)twig->needles_count);
        most = count > most ? count : most;
    }
    return most;
}

static struct sketch *sketch_create(struct arena *arena, const struct cone_plant *plant)
{
    struct sketch *sketch = ARENA_NEW(arena, struct sketch);
    sketch->strips = ARENA_ARRAY(arena, struct cone_strip, strips_most(plant));
    sketch->left = ARENA_ARRAY(arena, float, ROOM_PX);
    return sketch;
}

/* Widths and depths, in pictures of all twigs. */
static void body_measure(const struct sitter *sitter, struct sketch *sketch,
                         struct cone_outline *outline)
{
    const struct cone_plant *plant = sitter->plant;
    const float pixel_m = plant->radius_m / (0.45f * SIDE_PX), middle[2] = {0, 0};
    struct sitter whole = *sitter;
    whole.choice = (struct cone_choice){
        .forced = sitter->choice.forced < 0 ? CONE_TWIG : sitter->choice.forced};
    sketch->side_px = SIDE_PX;
    sketch->tries = 1;
    sketch->fills[0] = 1;
    for (int k = 0; k < TURNS * CONE_RISES; k++) {
        float axes[3][3];
        int rise = k / TURNS;
        axes_of(cone_outline_rise(rise), 0.4f + 1.9f * (float)(k % TURNS), axes);
        sketch_begin(&whole, 0.9f * SIDE_PX, middle, axes, sketch);
        tree_cap(&sketch->tree, TWIGS);
        sketch_draw(sketch);
        const double covered = sketch->covered[0];
        float depth = depth_of(covered, sketch->sum), covers = fmaxf(-expm1f(-depth), 1e-6f);
        if (rise == 0)
            rows_add(sketch, covers, outline);
        if (rise == CONE_RISES - 1)
            outline->wide_m += 0.5f / TURNS * pixel_m * sqrtf((float)covered / covers);
        outline->depths[rise] += depth / TURNS;
    }
}

/* Mean m^2 that a plant covers, in `turns` pictures of so many pixels, a try each. */
static void covers_measure(const struct sitter *sitter, float rise, float diameter_px, int turns,
                           float twigs_most, struct sketch *sketch, double covers_m2[TRIES])
{
    const double pixel_m = 2 * (double)sitter->plant->radius_m / (double)diameter_px;
    memset(covers_m2, 0, TRIES * sizeof *covers_m2);
    for (int turn = 0; turn < turns; turn++) {
        /* evenly within a pixel: Roberts 2018 */
        const float shift_px[2] = {fmodf(0.7548777f * (float)turn, 1),
                                   fmodf(0.5698403f * (float)turn, 1)};
        float axes[3][3];
        axes_of(rise, 0.4f + 2.4f * (float)turn, axes);
        sketch_begin(sitter, diameter_px, shift_px, axes, sketch);
        tree_cap(&sketch->tree, twigs_most);
        sketch_draw(sketch);
        for (int k = 0; k < sketch->tries; k++)
            covers_m2[k] += pixel_m * pixel_m * sketch->covered[k] / turns;
    }
}

/* What a plant covers as its needles do. */
static double needles_cover_m2(const struct sitter *sitter, float rise, struct sketch *sketch)
{
    double covers_m2[TRIES], needles = 0;
    struct sitter whole = *sitter;
    const struct cone_plant *plant = sitter->plant;
    for (size_t i = 0; i < plant->twigs_count; i++) {
        const struct conifer_twig *twig = plant->twigs[i].twig;
        needles += (double)twig->cones_count * (double)twig->needles_count;
    }
    whole.choice = (struct cone_choice){.forced = needles > NEEDLES ? CONE_TWIG : CONE_NEEDLE};
    whole.shaders = CONE_EXACT;
    sketch->side_px = FINE_PX;
    sketch->tries = 1;
    sketch->fills[0] = 1;
    covers_measure(&whole, rise, 0.9f * FINE_PX, 2, INFINITY, sketch, covers_m2);
    return covers_m2[0];
}

/* Where a row of tries that cover more and more covers as much as is wanted. */
static float try_of(const struct sketch *sketch, const double covers_m2[TRIES], double wanted_m2)
{
    int k = 1;
    if (!(covers_m2[0] > 0))
        return 1;
    while (k < TRIES - 1 && covers_m2[k] < wanted_m2)
        k++;
    double share = (wanted_m2 - covers_m2[k - 1]) / fmax(covers_m2[k] - covers_m2[k - 1], 1e-30);
    share = fmin(fmax(share, 0), 1);
    return sketch->fills[k - 1] + (float)share * (sketch->fills[k] - sketch->fills[k - 1]);
}

static void fills_measure(const struct sitter *sitter, int rise, struct sketch *sketch,
                          float fills[CONE_SIZES])
{
    const float sine = cone_outline_rise(rise);
    const double wanted_m2 = needles_cover_m2(sitter, sine, sketch);
    sketch->tries = TRIES;
    for (int k = 0; k < TRIES; k++)
        sketch->fills[k] = 0.4f * powf(4, (float)k / (TRIES - 1));
    for (int size = 0; size < CONE_SIZES; size++) {
        const float diameter_px = 0.25f * (float)(1 << size);
        double covers_m2[TRIES];
        sketch->side_px = (int)(diameter_px + 1) + 8;
        covers_measure(sitter, sine, diameter_px,
                       size < 6   ? TURNS_MOST
                       : size < 8 ? TURNS_MOST / 4
                                  : TURNS_MOST / 8,
                       fmaxf(64, 4 * diameter_px * diameter_px), sketch, covers_m2);
        fills[size] = try_of(sketch, covers_m2, wanted_m2);
    }
}

void cone_outline_measure(const struct scene *scene, enum cone_shaders shaders,
                          const struct cone_choice *choice, int threads, struct cone_plant *plant)
{
    struct arena *scratch = arena_create(0);
    struct cone_outline outline = {.low_m = plant->low_m}; /* the plant's is none meanwhile */
    struct sitter sitter = {scene, plant, shaders, *choice};
    struct sketch *sketches[CONE_RISES];
    float fills[CONE_RISES][CONE_SIZES];
    for (int rise = 0; rise < CONE_RISES; rise++)
        sketches[rise] = sketch_create(scratch, plant);
    memcpy(outline.center_m, plant->center_m, sizeof outline.center_m);
    outline.half_m = 0.5f * (plant->high_m - plant->low_m);
    outline.rows_per_m = CONE_ROWS / fmaxf(2 * outline.half_m, 1e-9f);
    body_measure(&sitter, sketches[0], &outline);
    plant->outline = outline;
    sitter.choice.limits_m[0] = sitter.choice.limits_m[1] = 0; /* of distances, not of sizes */
    /* as published, it covers what it covers */
    const int rises = shaders == CONE_PAPER || plant->twigs_count < MANY ? 0 : CONE_RISES;
#pragma omp parallel for num_threads(threads) schedule(dynamic, 1)
    for (int rise = 0; rise < rises; rise++)
        fills_measure(&sitter, rise, sketches[rise], fills[rise]);
    if (rises)
        memcpy(plant->outline.fills, fills, sizeof fills);
    arena_destroy(scratch);
}
