/* The calibrations of a run as lines of its results and back, and as one for all its rounds. */
#ifndef TREELINE_RESULTS_CALIBRATION_H
#define TREELINE_RESULTS_CALIBRATION_H

#include "calibrate/calibrate.h"

#define CALIBRATION_KIND "treeline-calibration"

/* One line without newline, in the arena. */
char *calibration_to_json(struct arena *arena, const struct calibration *calibration);
/* STATUS_INVALID names what is wrong with the line; where: FILE:LINE. */
enum status calibration_from_json(struct arena *arena, const char *text, const char *where,
                                  struct calibration *calibration, struct error *error);

struct calibration_part {
    const struct calibration *calibration;
    double scale; /* of its rates */
};
/* Of each rate the median over the parts (at least one, of one kind) and its 95 % interval; a
 * single part keeps its own. The rest is the first one's, seconds are the sum. */
struct calibration calibration_merge(struct arena *arena, const struct calibration_part *parts,
                                     size_t count);
/* Same target format, threads, size and renderer. */
bool calibration_same_kind(const struct calibration *a, const struct calibration *b);
/* run->calibrations from run->measured. */
struct run;
void calibrations_merge(struct arena *arena, struct run *run);

#endif
