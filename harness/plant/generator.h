/* What a plant generator is: a table of options and a function from options to a mesh. */
#ifndef TREELINE_PLANT_GENERATOR_H
#define TREELINE_PLANT_GENERATOR_H

#include "base/option.h"
#include "plant/plant.h"

#define GENERATOR_OPTIONS_SIZE 256 /* bytes that hold every generator's options */

struct generator {
    const char *name;
    unsigned version; /* raised whenever the same options give another mesh */
    const struct option *options;
    size_t options_size; /* at most GENERATOR_OPTIONS_SIZE */
    /* STATUS_INVALID when the options contradict each other. The mesh passes mesh_check. */
    enum status (*build)(struct arena *arena, const void *options, struct mesh **mesh,
                         struct error *error);
};

extern const struct generator poplar_generator, oak_generator, hypertexture_generator;

#endif
