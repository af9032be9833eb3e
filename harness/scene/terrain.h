/* Terrain: a flat plane, heights from an image or a relief; normals; the surface that everybody
 * draws. */
#ifndef TREELINE_SCENE_TERRAIN_H
#define TREELINE_SCENE_TERRAIN_H

#include "scene/description.h"

/* Builds the terrain that scene.json asks for. It keeps 16 bytes a sample, 28 with a colour image:
 * of 8,192 x 8,192 samples 1.1 and 1.9 GB. */
enum status terrain_build(struct arena *arena, const struct description *description,
                          struct terrain *terrain, struct error *error);

/* Fills normals from heights: central differences on both axes, one-sided on the border. */
void terrain_normals(struct arena *arena, struct terrain *terrain);

#endif
