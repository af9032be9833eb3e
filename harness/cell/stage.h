/* A cell's repetition inside its process: what the passes share. */
#ifndef TREELINE_CELL_STAGE_H
#define TREELINE_CELL_STAGE_H

#include "cell/cell.h"
#include "truth/frame.h"
#include "truth/reference.h"

struct stage {
    const struct plan *plan;
    const struct cell *cell;
    const char *folder;         /* NULL: no pictures are kept */
    struct arena *result_arena; /* what the result points to */
    struct arena *scene_arena;  /* scene, plants, pictures: not the method's */
    struct arena *arena;        /* the method's, within the budget */
    struct result *result;
    struct error *error;
    int announce; /* descriptor that hears which pass begins; negative: none */
    struct scene *scene;
    void *options;
    struct workspace workspace;
    struct gl *gl; /* NULL for a CPU method */
    struct target target;
    void *state;
};

/* Tells the parent which pass begins, so that a crash names it. */
void stage_announce(const struct stage *stage, const char *pass);

/* Scene, context, target; then prepare. */
enum status stage_open(struct stage *stage);
enum status stage_prepare(struct stage *stage);
void stage_close(struct stage *stage);

/* One picture, finished. seconds may be NULL. */
enum status stage_draw(struct stage *stage, const struct view *view, double *seconds);
/* The target as a frame in the arena, not checked. */
struct frame *stage_read(struct stage *stage, struct arena *arena);
/* STATUS_GL when OpenGL has an error pending. */
enum status stage_check(struct stage *stage, const char *where);

/* Pictures along the path: 1 when neither camera nor sun moves. */
size_t stage_path_frames(const struct scene *scene);
size_t stage_views_count(const struct scene *scene, size_t wanted);
/* The time of the path's next frame, or of the one before at the path's end; for flicker. */
double stage_neighbour_time(const struct scene *scene, double time);

/* The passes, in this order. */
enum status stage_time(struct stage *stage);
enum status stage_relight(struct stage *stage);
enum status stage_pictures(struct stage *stage);
enum status stage_build_cold(struct stage *stage);

/* What every reference of a plan is asked for. neighbour: for the neighbouring frame, with noise of
 * its own, since flicker takes the noise of the two as independent. */
struct reference_options stage_reference_options(const struct plan *plan, const struct cell *cell,
                                                 unsigned effects, bool neighbour);
/* The same for the true shadow mask; whether a cell that draws these effects has one. */
struct reference_options stage_mask_options(const struct plan *plan, const struct cell *cell,
                                            unsigned effects, bool neighbour);
bool stage_has_mask(const struct cell *cell, unsigned effects);
/* A reference from the run's folder; without a folder through the cache. NULL with a note when
 * there is none. */
const struct frame *stage_reference(struct stage *stage, const struct view *view,
                                    const struct reference_options *options, uint64_t *key);
/* The view's shadow mask and its error, and its shimmer towards the path's next frame; only where
 * the cell has one. */
enum status stage_mask(struct stage *stage, const struct view *view, struct result_view *result);
/* RUN/references/KEY.frame */
const char *stage_reference_path(struct arena *arena, const char *folder, uint64_t key);
/* Effects that a cell draws of those its scene asks for. */
unsigned stage_effects(struct arena *arena, const struct cell *cell, unsigned scene_effects);

#endif
