/* Terrain: a flat plane, heights from an image or a relief; normals; the surface that everybody draws. */
#ifndef TREELINE_SCENE_TERRAIN_H
#define TREELINE_SCENE_TERRAIN_H

#include "scene/description.h"

/* Builds the terrain that scene.json asks for. The image is decoded once and its heights are kept
 * in the cache under the hash of the file's bytes, so that OpenImageIO is loaded only on a miss. */
enum status terrain_build(struct arena *arena, const struct description *description,
                          struct terrain *terrain, struct error *error);

/* Fills normals from heights: central differences on both axes, one-sided on the border. */
void terrain_normals(struct arena *arena, struct terrain *terrain);

#endif
