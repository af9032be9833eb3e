/* The parts of scene.json, each read by one function from the root object. Errors are sticky in the
 * document. */
#ifndef TREELINE_SCENE_DESCRIBE_H
#define TREELINE_SCENE_DESCRIBE_H

#include "scene/description.h"
#include "wall/json.h"

/* A path beside scene.json, or an absolute one. */
const char *describe_path(struct arena *arena, const char *scene_path, const char *path);

/* A key that only another kind knows would silently do nothing: an error where it stands. */
void describe_refuse(struct json *object, const char *key, const char *kinds);

void describe_plants(struct arena *arena, struct json *root, struct description *description);
void describe_placement(struct arena *arena, struct json *root, struct description *description);
void describe_ground(struct arena *arena, struct json *root, struct description *description);
void describe_light(struct json *root, struct description *description);
void describe_camera(struct arena *arena, struct json *root, struct description *description);

#endif
