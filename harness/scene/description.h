/* What scene.json says, read and checked but not acted upon: no tree placed, no terrain read, no
 * plant made. */
#ifndef TREELINE_SCENE_DESCRIPTION_H
#define TREELINE_SCENE_DESCRIPTION_H

#include "plant/coloring.h"
#include "scene/relief.h"
#include "scene/scene.h"

enum { TREES_MAX = 4000000, SIDE_PX_MAX = 16384, TERRAIN_SAMPLES_MAX = 8193 };

/* Beyond a factor of eight a tree is a blade or a disc, and a float's normals are short of bits. */
#define STRETCH_MIN 0.125
#define STRETCH_MAX 8.0

/* Of any ground, up and down: beyond are no mountains but marks of missing data. */
#define HEIGHT_M_MAX 20000.0

struct plant_entry {
    const char *name;
    const char *generator, *options; /* a generated plant; options may be NULL */
    const char *file;                /* or a mesh's path; of "lsystem", the grammar's */
    const char *images; /* or a folder of pictures; but for "lsystem" two of the three are NULL */
    struct plant_import import;
    struct coloring_request coloring; /* of images; the box is the folder's */
    float weight, scale[2], stretch[2];
    float reach_m; /* no vertex is farther from the foot, at scale 1, stretch 1 */
};

enum placement_kind { PLACEMENT_GRID, PLACEMENT_POISSON, PLACEMENT_FILE };

struct placement {
    enum placement_kind kind;
    double extent_m;       /* side of the square; 0: spacing_m sqrt(trees) */
    double spacing_m;      /* each tree has spacing_m^2 of ground; 0: extent_m holds */
    double jitter;         /* grid: 0 the middle of the quad, 1 anywhere in it */
    double min_distance_m; /* Poisson disc; 0: by density */
    double clearing_m;     /* no tree's foot nearer to the origin */
    bool rotate;           /* each tree is turned by a random angle */
    const char *file;      /* positions */
    bool bounded;          /* trees stand where what follows allows them */
    double slope_max_deg;
    double heights_m[2];           /* of the ground: the least and the most */
    const struct terrain *terrain; /* where bounded; terrain_build() comes before */
};

struct ground {
    bool given;
    double size_m[2];  /* along x and z */
    const char *image; /* path; NULL: flat, a relief or noise */
    double height_m;   /* of a white texel, black is 0; or of 1 in floats and signed integers */
    int level;         /* of a fractal relief (scene/relief.h); 0: none */
    double spike_m;    /* its first displacement at most */
    uint64_t seed;
    struct relief_noise noise; /* samples 0: none */
    const char *color;         /* path; NULL: albedo everywhere */
    float albedo[3];
    float detail_px; /* as of struct terrain; below 0: by the number of triangles */
};

struct description {
    const char *path, *name, *doc;
    int width_px, height_px;
    size_t default_trees;
    size_t *trees;
    size_t trees_count;
    unsigned effects;
    size_t plants_count;
    struct plant_entry *plants;
    struct placement placement;
    struct ground ground;
    struct sun sun;
    float ambient[3];
    struct sky sky;
    struct fog fog;
    struct camera_path
        camera;             /* keys in units of camera_unit_m, near_m and far_m 0 when automatic */
    double origin_m[3];     /* as of struct scene; already taken from the keys */
    bool camera_in_extents; /* the keys' unit is the forest's half side, at least extent_min_m */
    bool ground_relative;   /* the keys' heights are above the terrain */
    double extent_min_m;
};

/* Reads and checks scene.json. scenes/README.md documents every key. */
enum status description_load(struct arena *arena, const char *name, struct description *description,
                             struct error *error);

#endif
