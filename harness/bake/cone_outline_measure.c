/* A tree's outline, measured in pictures of its twigs from around it. */
#include "bake/cone_emit.h"
#include "bake/cone_outline.h"

#include <math.h>
#include <string.h>

enum { SIDE_PX = 64, TWIGS = 4096, TURNS = 2 };

struct sketch {
    struct view view;
    struct cone_picture picture;
    struct cone_tree tree;
    struct cone_strip *strips; /* of a twig */
    float left[SIDE_PX * SIDE_PX];
    double covered, sum; /* pixels: what all strips cover, and each by itself */
};

/* The plant fills the picture, from so far that its sides are parallel. */
static void sketch_begin(const struct scene *scene, const struct cone_plant *plant,
                         enum cone_shaders shaders, int level, float (*axes)[3],
                         struct sketch *sketch)
{
    struct cone_strip *strips = sketch->strips;
    const float far_m = 1000 * plant->radius_m;
    const size_t barks = plant->barks_count - plant->trunks_count;
    *sketch = (struct sketch){
        .strips = strips,
        .view = {.width_px = SIDE_PX, .height_px = SIDE_PX, .near_m = plant->radius_m}};
    sketch->picture = (struct cone_picture){.view = &sketch->view,
                                            .scene = scene,
                                            .focal_px = 0.45f * SIDE_PX * far_m / plant->radius_m,
                                            .choice = {.forced = level},
                                            .shaders = shaders};
    struct cone_tree *tree = &sketch->tree;
    tree->plant = plant;
    tree->scale = 1;
    tree->trunk_step = 1;
    tree->twigs = fminf((float)plant->twigs_count, TWIGS);
    tree->twigs_grown = (float)plant->twigs_count / fmaxf(tree->twigs, 1);
    tree->barks = fminf((float)barks, TWIGS);
    tree->barks_grown = (float)barks / fmaxf(tree->barks, 1);
    tree->barks += (float)plant->trunks_count;
    for (int k = 0; k < 3; k++) {
        memcpy(tree->to_camera[k], axes[k], sizeof tree->to_camera[k]);
        tree->eye_m[k] = plant->center_m[k] - far_m * axes[2][k];
        tree->sun[k] = -axes[2][k];
        tree->foot_m[k] = k == 2 ? far_m : 0;
        for (int i = 0; i < 3; i++)
            tree->foot_m[k] -= axes[k][i] * plant->center_m[i];
    }
    for (int i = 0; i < SIDE_PX * SIDE_PX; i++)
        sketch->left[i] = 1;
}

static void strips_draw(struct sketch *sketch, size_t count)
{
    for (const struct cone_strip *strip = sketch->strips; count > 0; count--, strip++) {
        float low[2], high[2];
        int first[2], last[2];
        cone_strip_rect(strip, low, high);
        for (int i = 0; i < 2; i++) {
            first[i] = (int)fmaxf(ceilf(low[i]), 0);
            last[i] = (int)fminf(floorf(high[i]), SIDE_PX - 1);
        }
        for (int y = first[1]; y <= last[1]; y++)
            for (int x = first[0]; x <= last[0]; x++) {
                struct cone_place place;
                float w = cone_strip_hides(strip, (float)x, (float)y, &place);
                sketch->left[y * SIDE_PX + x] *= 1 - w;
                sketch->sum += w;
            }
    }
}

static void sketch_draw(struct sketch *sketch)
{
    const struct cone_tree *tree = &sketch->tree;
    for (size_t i = 0; (float)i < tree->twigs; i++)
        strips_draw(sketch, cone_twig_emit(&sketch->picture, tree, i, NULL, sketch->strips));
    for (size_t i = 0; (float)i < tree->barks; i++)
        strips_draw(sketch, cone_bark_emit(&sketch->picture, tree, i, sketch->strips));
    for (int i = 0; i < SIDE_PX * SIDE_PX; i++)
        sketch->covered += 1 - (double)sketch->left[i];
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

/* Right, up and forward of a view from an elevation's sine. */
static void axes_of(float rise, float turn_rad, float axes[3][3])
{
    const float flat = sqrtf(1 - rise * rise), s = sinf(turn_rad), c = cosf(turn_rad);
    memcpy(axes,
           (float[3][3]){{c, 0, -s}, {-rise * s, flat, -rise * c}, {-flat * s, -rise, -flat * c}},
           sizeof(float[3][3]));
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

void cone_outline_measure(struct arena *arena, const struct scene *scene, enum cone_shaders shaders,
                          int level, struct cone_plant *plant)
{
    struct cone_outline outline = {.low_m = plant->low_m}; /* the plant's is none meanwhile */
    struct sketch *sketch = ARENA_NEW(arena, struct sketch);
    const float pixel_m = plant->radius_m / (0.45f * SIDE_PX);
    sketch->strips = ARENA_ARRAY(arena, struct cone_strip, strips_most(plant));
    memcpy(outline.center_m, plant->center_m, sizeof outline.center_m);
    outline.half_m = 0.5f * (plant->high_m - plant->low_m);
    outline.rows_per_m = CONE_ROWS / fmaxf(2 * outline.half_m, 1e-9f);
    for (int k = 0; k < TURNS * CONE_RISES; k++) {
        float axes[3][3];
        int rise = k / TURNS;
        axes_of((float)rise / (CONE_RISES - 1), 0.4f + 1.9f * (float)(k % TURNS), axes);
        sketch_begin(scene, plant, shaders, level < 0 ? CONE_TWIG : level, axes, sketch);
        sketch_draw(sketch);
        const double covered = sketch->covered;
        float depth = depth_of(covered, sketch->sum), covers = fmaxf(-expm1f(-depth), 1e-6f);
        if (rise == 0)
            rows_add(sketch, covers, &outline);
        if (rise == CONE_RISES - 1)
            outline.wide_m += 0.5f / TURNS * pixel_m * sqrtf((float)covered / covers);
        outline.depths[rise] += depth / TURNS;
    }
    plant->outline = outline;
}
