/* The small scene that methods are put to the test in, of any size and any number of trees. */
#ifndef TREELINE_CONFORM_WORLD_H
#define TREELINE_CONFORM_WORLD_H

#include "scene/scene.h"

/* Zeros are the defaults. */
struct world {
    size_t trees;
    double scale;            /* of every length; 0: 1 */
    double stretch;          /* of every tree; 0: 1 */
    double spacing_m;        /* between trees before scaling; 0: 12 */
    int width_px, height_px; /* 0: 64 x 48 */
    bool conifers;           /* trees of needles instead of a mesh */
    const char *file;        /* of a scene; NULL: the world is made here */
};

/* A grid of trees, each turned and of a scale of its own,
 * about the origin on a flat terrain. All effects are wanted; the fog is thin. A world of 1 tree
 * has it at the origin. STATUS_INVALID only for a file. */
enum status world_make(struct arena *arena, const struct world *world, struct scene **scene,
                       struct error *error);

/* Its trees, at scale 1. */
#define WORLD_TREE_M 20.0
/* The world's plant as FOLDER/tree.obj with z up and in another unit, and a scene of one such tree
 * without terrain, FOLDER/tree-OFFSET.json, this far from the origin along x and -z. */
enum status world_write(struct arena *arena, const char *folder, double offset_m, const char **path,
                        struct error *error);

/* From a point to a point, both before scaling; the sun is the world's. */
void world_view(const struct scene *scene, const struct world *world, const double eye_m[3],
                const double target_m[3], struct view *view);
/* The view that most checks use: all of one tree, or of few, from a little above. */
void world_view_near(const struct scene *scene, const struct world *world, struct view *view);

#endif
