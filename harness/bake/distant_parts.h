/* What distant.c and its neighbours share; methods include distant.h. */
#ifndef TREELINE_BAKE_DISTANT_PARTS_H
#define TREELINE_BAKE_DISTANT_PARTS_H

#include "bake/distant.h"

enum {
    DISTANT_SIDE = 8, /* views_layout's hemisphere: 28 directions on the horizon */
    DISTANT_VIEWS = DISTANT_SIDE * DISTANT_SIDE,
    DISTANT_TURNS = 8,  /* steps of a tree's rotation that light is made for */
    DISTANT_STEPS = 32, /* and that its picture is chosen for */
    DISTANT_LEVELS = 8,
};

/* ---- Pictures: a plant from each direction, for each turn of the light. ---- */

/* One size of them; a ring of empty texels is around each. */
struct distant_level {
    int width, height; /* texels, without the ring */
    size_t first;      /* of the texels of one picture */
};

struct distant_plant {
    float foot_reach_m;               /* of any vertex from the foot */
    float height_m, width_m;          /* of its box; of the circle around its axis */
    float middle_m[DISTANT_VIEWS][3]; /* of what is seen, from the foot */
    float low_m[DISTANT_VIEWS][2], texel_m[DISTANT_VIEWS][2]; /* from the middle; of level 0 */
    int levels_count;
    struct distant_level levels[DISTANT_LEVELS];
    size_t texels_count;  /* of all levels of one picture */
    float scale;          /* radiance of 255 */
    uint8_t (*texels)[4]; /* views x turns x texels_count: radiance x coverage, coverage */
    const struct slices *slices;
};

struct distant_light {
    float sun_direction[3], sun_radiance[3], ambient[3];
    bool two_sided;
};

/* Fills foot_reach_m, height_m and width_m alone. */
enum status distant_plant_measure(struct workspace *workspace, struct plant *plant,
                                  struct distant_plant *made);
/* Bakes or finds the pictures of a plant that is measured; they are not lit yet. */
enum status distant_plant_bake(struct workspace *workspace, struct plant *plant,
                               struct distant_plant *made);
/* Lights all of a plant's pictures. */
void distant_plant_light(struct workspace *workspace, struct distant_plant *plant,
                         const struct distant_light *light);

/* ---- Cells of many trees. ---- */

struct distant_tree {
    float position_m[3], scale;
    uint16_t species;
    uint8_t step; /* of its rotation, of DISTANT_STEPS */
};

struct distant_cell {
    uint32_t first, count;
    float middle_m[3], radius_m; /* a sphere that holds its trees */
};

struct distant_cells {
    size_t cells_count;
    struct distant_cell *cells;
    uint32_t *instances;        /* by cells: indices into the scene's instances */
    struct distant_tree *trees; /* the same */
};

struct distant_cells *distant_cells_create(struct arena *arena, const struct scene *scene,
                                           float reach_m);

/* ---- Drawing. ---- */

/* Blocks of 8 x 8 pixels: what is hidden in all of them is passed over. */
enum { DISTANT_BLOCK = 8 };

struct distant_block {
    int open;         /* pixels that still let something through */
    float farthest_m; /* of the terrain */
};

/* A picture of trees alone, row 0 on top. */
struct distant_canvas {
    const struct view *view;
    const struct scene *scene;
    float fog_density_per_m;
    float (*pixels)[4];           /* height x width: radiance, premultiplied, transmittance */
    float *depths_m;              /* the terrain's */
    struct distant_block *blocks; /* rows x columns */
    int columns;
};

/* A cell in view. */
struct distant_seen {
    uint32_t cell;
    int low_px[2], high_px[2]; /* pixels that its sphere may touch, both ends included */
    float nearest_m;           /* along the view */
    float share;               /* of its trees' optical depth that is drawn */
};

/* The part of a cell's trees within columns [low_px, high_px], under what is there. Returns how
 * many pixels are mixed from four texels each. */
uint64_t distant_cell_draw(const struct distant_canvas *canvas, const struct distant_cells *cells,
                           const struct distant_plant *plants, const struct distant_seen *seen,
                           int low_px, int high_px);

#endif
