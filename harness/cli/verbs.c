/* The table of verbs. */
#include "cli/cli.h"

const struct verb verbs[] = {
    {"run", "time cells, draw and judge their pictures", verb_run},
    {"report", "write the page, plots and tables of a run", verb_report},
    {"list", "list methods, scenes, metrics, plants or grammars", verb_list},
    {"render", "draw one view of a cell to an EXR or PNG file", verb_render},
    {"reference", "ray trace one view to an EXR or PNG file", verb_reference},
    {"views", "ray trace pictures with depth around a plant", verb_views},
    {"diff", "compare two pictures by every metric", verb_diff},
    {"shaders", "map the errors of the shaders of needles", verb_shaders},
    {"calibrate", "measure what this machine can do at most", verb_calibrate},
    {"conform", "check that methods and plugins keep the contract", verb_conform},
    {"cache", "show, trim or clear the cache of built things", verb_cache},
    {"help", "explain a verb, a method or the exit codes", verb_help},
    {NULL, NULL, NULL},
};
