/* The calibration of a run as a line of its results and back. */
#ifndef TREELINE_RESULTS_CALIBRATION_H
#define TREELINE_RESULTS_CALIBRATION_H

#include "calibrate/calibrate.h"

#define CALIBRATION_KIND "treeline-calibration"

/* One line without newline, in the arena. */
char *calibration_to_json(struct arena *arena, const struct calibration *calibration);
/* STATUS_INVALID names what is wrong with the line; where: FILE:LINE. */
enum status calibration_from_json(struct arena *arena, const char *text, const char *where,
                                  struct calibration *calibration, struct error *error);

#endif
