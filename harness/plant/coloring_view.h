/* The rays of a picture with depth. */
#ifndef TREELINE_PLANT_COLORING_VIEW_H
#define TREELINE_PLANT_COLORING_VIEW_H

#include "plant/coloring.h"

struct ray {
    float origin_m[3], direction[3];
};

/* Of the middle of a pixel: origin + depth x direction is the point at a depth. */
struct ray depth_view_ray(const struct depth_view *view, int column, int row);

#endif
