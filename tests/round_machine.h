/* The calibration of a machine of round figures. */
#ifndef TREELINE_TESTS_ROUND_MACHINE_H
#define TREELINE_TESTS_ROUND_MACHINE_H

#include "testing.h"

#include "results/calibration.h"

#include <math.h>

static inline void check_near(double a, double b, double within)
{
    if (!(fabs(a - b) <= within))
        fail_msg("%.17g is not %.17g within %g", a, b, within);
}

/* A machine of round figures, at its best. */
static inline struct calibration round_machine(void)
{
    struct calibration made = {.width_px = 800,
                               .height_px = 600,
                               .format = TARGET_RGBA8,
                               .threads = 2,
                               .core_ghz = NAN,
                               .seconds = 3.5,
                               .backend = "osmesa",
                               .renderer = "round"};
    static const struct {
        enum calibration_index index;
        double rate, fragments;
    } known[] = {
        {CALIBRATION_fill_opaque, 500e6, 240000}, {CALIBRATION_triangles_culled, 50e6, 0},
        {CALIBRATION_triangles_shared, 10e6, 2},  {CALIBRATION_quads_2px, 4e6, 16},
        {CALIBRATION_quads_8px, 2e6, 64},         {CALIBRATION_quads_32px, 0.5e6, 512},
        {CALIBRATION_vertices, 150e6, NAN},       {CALIBRATION_calls_bare, 2e6, NAN},
        {CALIBRATION_rays_primary, 10e6, NAN},    {CALIBRATION_rays_shadow, 5e6, NAN},
        {CALIBRATION_lookups_near, 2e9, NAN},     {CALIBRATION_memory_read, 20e9, NAN},
        {CALIBRATION_memory_copy, 16e9, NAN},     {CALIBRATION_memory_triad, 18e9, NAN},
        {CALIBRATION_lookups_shader, 1e9, NAN},   {CALIBRATION_samples_bilinear, 200e6, NAN},
    };
    for (size_t i = 0; i < CALIBRATION_COUNT; i++)
        made.measures[i] = (struct calibration_measure){{NAN, NAN, NAN}, NAN};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        made.measures[known[i].index] = (struct calibration_measure){
            {0.5 * known[i].rate, 0.25 * known[i].rate, known[i].rate}, known[i].fragments};
    return made;
}

#endif
