/* The camera's path in the scene, and the depths that hold what it sees. */
#ifndef TREELINE_SCENE_CAMERA_H
#define TREELINE_SCENE_CAMERA_H

#include "scene/description.h"

/* Eye and target at time in [0, 1]. */
void camera_at(const struct scene *scene, double time, float eye_m[3], float target_m[3]);

/* Keys of the description in metres, heights above the terrain where asked for; near and far where
 * they are automatic. The scene's instances, terrain and bounds are complete. */
void camera_build(struct arena *arena, const struct description *description, struct scene *scene);

/* Depths along any view direction from any of the eyes (count x 3, m; count <= EYES_MAX) that hold
 * the scene. near_m is at least 0.1 m, or a fiftieth of the trees' reach where that is less: an eye
 * within a tree's reach may lose what is nearer. */
enum { EYES_MAX = 65 };
void camera_depths(const struct scene *scene, float (*eyes_m)[3], size_t count, float *near_m,
                   float *far_m);

#endif
