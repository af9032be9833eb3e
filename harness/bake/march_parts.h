/* What the ray march's kernels are given: a rectangle of rays and a tree. */
#ifndef TREELINE_BAKE_MARCH_PARTS_H
#define TREELINE_BAKE_MARCH_PARTS_H

#include "bake/march_free.h"

/* Rays, row by row. Front to back: what has been gathered, and how much is still seen behind it. A
 * kernel reads up to MARCH_ROOM floats of left and depths_m past the last row's end. */
enum { MARCH_ROOM = 16 };
struct march_rays {
    int stride;            /* rays from row to row, 4096 in all at most */
    float *left;           /* transmittance */
    float (*rgb)[4];       /* the fourth stays */
    const float *depths_m; /* of what is behind the trees, along the view */
    uint64_t lookups;      /* a cell is one, a voxel two, its shadow three, for each ray; also those
                              that a ray asks for before it is known that nothing is seen through it */
};

/* Columns and rows, both ends included. */
struct march_rect {
    int low[2], high[2];
};

/* x' M y of a packed matrix: factors[0] + sum of its five entries of 6 bits, each by its factor. */
struct march_form {
    float factors[6];
};

/* How much of the sun reaches a place in a tree: what its matter lets through, times what falls on
 * it from outside. Places are turned into cells along the light's axes. */
struct march_sun {
    const uint8_t *passes; /* NULL: all. size 1, 0, 2 (fastest), at the upper side of each layer */
    const uint8_t *gains;  /* side x side over columns 1, 0, at their corners */
    float to_cells[3][4], to_gains[2];
    float bark_cells; /* what is all bark takes its light so much nearer the sun */
    int32_t size[3], side;
};

/* A tree at one of its levels, seen through rays. Lengths in the level's voxels. */
struct march_job {
    const uint32_t *cells;  /* as march_free.h has them */
    const uint32_t *voxels; /* four words each */
    int32_t size[3];
    float eye[3];
    float first[3], right[3], down[3]; /* rays, a metre along the view: column 0, row 0; from each
                                          to the next */
    float speed;                       /* length of a ray a metre along the view */
    float near_m, far_m, step, stop;
    float thinned;                     /* share of all density that is left out */
    struct march_form hidden;          /* w' S w */
    struct march_form seen, lit, both; /* w' M w, l' M l, w' M l */
    bool by_mean; /* normals are known by their means alone, as voxels_visible.h has it */
    float toward_eye[3], toward_sun[3], cosine; /* unit, in the plant's axes; between the two */
    /* A stretched tree's toward_sun is not unit, its y divided by the stretch; a normal n becomes
     * diag(1, 1 / stretch, 1) n, of the mean square 1 + raise M_yy. */
    float sun_square, raise;
    struct march_form upright; /* M_yy */
    float sun[3], shade[3];    /* radiance of a white voxel's byte: by the sun, by the sky */
    float one_sided;           /* 1: leaves are lit on the side of the sun alone */
    struct march_sun light;
    float clear, fog[3]; /* the share that fog leaves; what it adds */
};

/* Marches a rectangle's open rays, those of left > stop, through a tree. Returns how many of them
 * that closed. */
typedef int march_kernel(const struct march_job *job, const struct march_rect *rect,
                         struct march_rays *rays);

/* The kernels of this build, from the slowest to the fastest that this processor runs; the first is
 * plain C. Same picture, to the bit. */
struct march_isa {
    const char *name;
    march_kernel *kernel;
};
size_t march_isas(struct march_isa isas[4]);

march_kernel march_kernel_plain, march_kernel_avx2, march_kernel_avx512;

#endif
