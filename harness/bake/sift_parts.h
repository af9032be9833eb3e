/* Between sift.c, which shares out the work, and sift_samples.c, which does it. */
#ifndef TREELINE_BAKE_SIFT_PARTS_H
#define TREELINE_BAKE_SIFT_PARTS_H

#include "bake/sift.h"

enum { SIFT_BLOCK = 256 };

/* Rows of the matrix from the world to (x w, y w, w): x, y in pixels from the bottom left corner,
 * w the depth along the view. */
struct sift_screen {
    float rows[3][4];
    int width_px, height_px;
    float near_m;
    float focal_px; /* pixels a metre at a depth of a metre, anywhere in the picture, at most */
    struct sampling_places places;
    float *depths_m; /* height x width x samples, from the bottom: of what is nearest over each */
};

/* One thread at one tree. */
struct sift_work {
    const struct sift_screen *screen;
    float low_row, high_row;
    struct sift_vertex *out[SIFT_STREAMS];
    size_t filled[SIFT_STREAMS]; /* triangles */
    int stream;                  /* of the run at work */
    bool within;                 /* of the tree at work */
    int16_t mean;
    float turn[2], scale, place[3];
    float height;     /* scale along y */
    float reach;      /* the larger of the two */
    float normal[2];  /* what normals are shortened by, across and along y */
    float rows[3][4]; /* from the plant to the screen */
};

void sift_screen_set(struct sift_screen *screen, const struct view *view,
                     const struct sampling_places *places);
void sift_project(const struct sift_screen *screen, const float world_m[3], float projected[3]);

/* Whether the tree may meet the band's rows; where `look` is set, any sample that nothing nearer
 * covers yet. */
bool sift_tree_seen(const struct sift_work *work, const struct sift_tree *tree, bool look);
void sift_tree_set(struct sift_work *work, const struct sift_tree *tree);

/* `count` elements, at most SIFT_BLOCK, of the set from `at` on; rank: the first one's place in the
 * run. */
void sift_block(struct sift_work *work, const struct sift_run *run, size_t at, size_t rank,
                size_t count);

#endif
