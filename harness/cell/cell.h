/* A cell's repetition in a child process: the only room that knows the order of things. */
#ifndef TREELINE_CELL_CELL_H
#define TREELINE_CELL_CELL_H

#include "plan/plan.h"
#include "results/result.h"

/* Forks; the child loads the scene, prepares, warms up, times, then draws and compares the
 * pictures. The parent touches no GL, Embree or image library. Whatever happens to the child is
 * told in result (never an error): status, message, signal. Returns STATUS_INTERRUPTED when this
 * process was asked to stop. folder: the run's folder for pictures, NULL: none are kept. */
enum status cell_run(struct arena *arena, const struct plan *plan, const struct cell *cell,
                     int repetition, const char *folder, struct result *result);

/* One picture of a cell at a time along its path or from a given view (`render`). view may be NULL.
 */
enum status cell_render(struct arena *arena, const struct cell *cell, double time,
                        const struct view *view, const char *backend, struct frame **frame,
                        struct error *error);

/* Several views of a cell, prepared once. Each picture goes to take, whose frame ends with the
 * call; a status other than ok from it ends the drawing. */
struct cell_taker {
    enum status (*take)(void *context, size_t index, const struct frame *frame,
                        struct error *error);
    void *context;
};
enum status cell_render_views(const struct cell *cell, const struct view *views, size_t count,
                              const char *backend, const struct cell_taker *taker,
                              struct error *error);

/* Before the first timed round: every reference that the plan's cells are compared with, once,
 * through the disk cache, each scene in a child process (Embree starts threads), kept as
 * FOLDER/references/KEY.frame (16 hex digits of reference_key). One that fails is told on stderr
 * and its cells run uncompared. STATUS_INTERRUPTED when stopped. */
enum status cell_references(struct arena *arena, const struct plan *plan, const char *folder,
                            bool quiet, struct error *error);

/* Before a round: what this machine can do at most, in a child process, for each target format that
 * a GL cell of the plan has (where none has, for the first cell's), at its largest picture, added
 * to FOLDER/cells.jsonl unless this round's is there. One that fails is told on stderr. seconds: of
 * measuring, each. STATUS_INTERRUPTED when stopped. */
enum status cell_calibrate(struct arena *arena, const struct plan *plan, const char *folder,
                           int round, double seconds, struct error *error);

#endif
