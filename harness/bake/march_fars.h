/* How the march's plants look from far away, in one picture: made for a few directions over the
 * picture, between which it changes linearly, and only where some tree or cell asks. */
#ifndef TREELINE_BAKE_MARCH_FARS_H
#define TREELINE_BAKE_MARCH_FARS_H

#include "bake/march_job.h"

struct march_fars;

/* trees: one an instance of the scene. */
struct march_fars *march_fars_create(struct arena *arena, const struct scene *scene,
                                     const struct march_tree *trees, int threads);
/* Nothing is asked for. */
void march_fars_begin(struct march_fars *fars);
/* A thread asks for a species at a turn, or in all turns that its trees have (MARCH_TURNS), around
 * a place in the picture. */
void march_fars_ask(struct march_fars *fars, int thread, const struct view *view, uint32_t species,
                    uint32_t turn, const float at_px[2]);
void march_fars_make(struct march_fars *fars, const struct march_view *picture,
                     march_kernel *kernel);
/* What was asked for. */
struct march_far march_fars_at(const struct march_fars *fars, const struct view *view,
                               uint32_t species, uint32_t turn, const float at_px[2]);

/* The picture of one turn from the nearest of the directions, and its own means. */
const struct march_sprite *march_fars_sprite(const struct march_fars *fars, const struct view *view,
                                             uint32_t species, uint32_t turn, const float at_px[2],
                                             const struct march_far **means);

#endif
