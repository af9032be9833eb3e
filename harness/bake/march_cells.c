/* A cell spreads evenly over a rectangle of the picture that has the variances of what it shows.
 * Trees that stand at random hide each other at random: of a pixel on which they hide A altogether
 * exp(-A) stays clear (Boolean model; Stoyan, Kendall and Mecke 1995, Stochastic Geometry). */
#include "bake/march_cells.h"

#include <math.h>

/* The optical depth of a tree that hides a square pixels, per a, as tree by tree it would be:
 * spread evenly over a pixel's square it has in the pixels that it touches shares u v, u and v even
 * in 0..1, and of -ln(1 - a u v) the mean is the sum of a^n / (n (n + 1)^2). */
static float crowding_of(float a)
{
    return 1 + a * (4.0f / 18 + a * (4.0f / 48 + a * (4.0f / 100 + a * (4.0f / 180))));
}

void march_cell_middle(const struct march_view *picture, const struct cells_sums *sums,
                       float middle[3])
{
    /* turned every way, a plant's middle is over its foot */
    struct march_tree mean = {.scale = sums->scale, .stretch = 1, .species = sums->species};
    for (int i = 0; i < 3; i++)
        mean.position_m[i] = sums->foot_m[i];
    march_middle(picture, &mean, middle);
}

/* The side of the rectangle along an axis of the screen: of evenly spread feet, and of crowns that
 * are ellipsoids. */
static float side_px(const struct march_view *picture, const struct cells_sums *sums,
                     const float axis[3], float depth_m)
{
    const float *half_m = picture->species[sums->species].half_m;
    float flat_m2 = 0.5f * (half_m[0] * half_m[0] + half_m[2] * half_m[2]);
    float rise2 = axis[1] * axis[1];
    float crown_m2 =
        sums->scale * sums->scale * (rise2 * half_m[1] * half_m[1] + (1 - rise2) * flat_m2) / 5;
    float px = picture->focal_px / depth_m * sqrtf(12 * (cells_spread_m2(sums, axis) + crown_m2));
    return fminf(fmaxf(px, 1), SPLAT_SIDE - 1);
}

struct march_seen march_cell_see(const struct march_view *picture, const struct cells_sums *sums,
                                 const float middle[3])
{
    const struct view *view = picture->view;
    struct march_seen seen = {.level = MARCH_CELL};
    for (int i = 0; i < 2; i++) {
        float reach = 0.5f + 0.5f * side_px(picture, sums, i ? view->up : view->right, middle[2]);
        march_seen_between(&seen, i, floorf(middle[i] - reach) + 1, floorf(middle[i] + reach),
                           i ? view->height_px : view->width_px);
    }
    return seen;
}

void march_cell_splat(const struct march_view *picture, const struct cells_sums *sums,
                      const float middle[3], const struct march_far *far, struct march_splat *splat)
{
    const struct view *view = picture->view;
    float per_m = picture->focal_px / middle[2], per_m2 = far->cover_m2 * per_m * per_m;
    float sides_px[2];
    for (int i = 0; i < 2; i++)
        sides_px[i] = side_px(picture, sums, i ? view->up : view->right, middle[2]);
    march_splat_place(picture, middle, sides_px, sums->foot_m[1], far, splat);
    splat->area_px2 = per_m2 * sums->square * crowding_of(per_m2 * sums->fourth / sums->square);
    splat->is_many = true;
    /* the ground is behind its nearest trees, those of an even bar along the view */
    splat->depth_m -= sqrtf(3 * cells_spread_m2(sums, view->forward));
}
