/* Where a pixel is larger than a tree, or crosses its outline, the tree's twigs stand behind one
 * another in a part of the pixel: composed as if each were anywhere in it, they would cover more
 * than all of the tree does. Their opacity is lowered so that they cover as much. */
#ifndef TREELINE_BAKE_CONE_OUTLINE_H
#define TREELINE_BAKE_CONE_OUTLINE_H

enum { CONE_ROWS = 16, CONE_RISES = 6, CONE_SIZES = 9 };

/* A plant as a body of even optical depth, in the plant's axes. */
struct cone_outline {
    float center_m[3], low_m, rows_per_m;
    float half_m;              /* of its height */
    float halves_m[CONE_ROWS]; /* half as wide as this, from the side, at these heights */
    float wide_m;              /* half the side of the square that it is from above */
    float depths[CONE_RISES];  /* by the elevation that it is seen from (cone_outline_rise) */
    /* What opacities are multiplied by so that in the mean the plant covers what its needles do, by
     * elevation and by the octave of its diameter, from 1/4 px on; 0: as it is. */
    float fills[CONE_RISES][CONE_SIZES];
};

/* The sine of the elevation of a measured view, denser toward the zenith: whorls that stand above
 * one another hide each other there alone. */
float cone_outline_rise(int rise);

/* The share of its opacity that something around a place has, the eye in the direction `eye`
 * (unit), a metre being so many pixels. It is 1 where its pixels hold nothing but the plant. */
float cone_outline_part(const struct cone_outline *outline, const float place_m[3], float reach_m,
                        const float eye[3], float px);
/* `fills` of a plant of so many pixels, seen from above by the sine `rise`. 1 from two octaves
 * above the largest size on: there each twig is seen by itself. */
float cone_outline_fill(const struct cone_outline *outline, float diameter_px, float rise);

#endif
