/* treeline views: pictures with depth around a plant, as a folder that a scene's plant may be. */
#include "bake/coloring_views.h"
#include "base/clock.h"
#include "base/file.h"
#include "cli/cli.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

struct request {
    char *plant;
    const char *folder;
    int views, pixels, grid;
};

enum { KEY_VIEWS = 256, KEY_PIXELS, KEY_GRID };

static const struct argp_option options[] = {
    {"output", 'o', "FOLDER", 0, "folder to write, made where it is missing", 0},
    {"views", KEY_VIEWS, "N", 0,
     "how many, 1..64: 6 look along the axes, 12, the default, from an icosahedron's vertices", 0},
    {"pixels", KEY_PIXELS, "N", 0, "side of a picture, 256 by default", 0},
    {"grid", KEY_GRID, "N", 0, "voxels a side to count, 128 by default", 0},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct request *request = state->input;
    switch (key) {
    case 'o':
        request->folder = text;
        return 0;
    case KEY_VIEWS:
        request->views = cli_integer(state, "views", text, 1, COLORING_VIEWS_MAX);
        return 0;
    case KEY_PIXELS:
        request->pixels = cli_integer(state, "pixels", text, 1, 4096);
        return 0;
    case KEY_GRID:
        request->grid = cli_integer(state, "grid", text, 2, COLORING_GRID_MAX);
        return 0;
    case ARGP_KEY_ARG:
        if (state->arg_num > 0)
            argp_failure(state, STATUS_USAGE, 0, "'%s' is too much", text);
        request->plant = text;
        return 0;
    case ARGP_KEY_NO_ARGS:
        argp_failure(state, STATUS_USAGE, 0, "which plant? such as poplar:height=12");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static enum status make_plant(struct arena *arena, const char *text, struct plant **plant,
                              struct error *error)
{
    char *name = arena_strdup(arena, text), *colon = strchr(name, ':');
    if (path_ends_with(name, ".obj") || path_ends_with(name, ".ply") ||
        path_ends_with(name, ".gltf") || path_ends_with(name, ".glb"))
        return plant_file(arena, name, NULL, plant, error);
    if (colon)
        *colon = '\0';
    return plant_generated(arena, name, colon ? colon + 1 : NULL, plant, error);
}

static enum status make_views(struct arena *arena, const struct request *request,
                              struct error *error)
{
    struct plant *plant = NULL;
    struct images images;
    struct coloring_shots shots = {(size_t)request->views, request->pixels, 0.005f};
    enum status status = make_plant(arena, request->plant, &plant, error);
    if (status == STATUS_OK)
        status = coloring_trace(arena, plant, &shots, clock_cpu_count(), &images, error);
    if (status == STATUS_OK && request->folder)
        status = images_write(request->folder, &images, error);
    if (status != STATUS_OK)
        return status;
    struct coloring_request coloring_request = {
        .grid = request->grid, .agreement = INFINITY, .see_through = 1};
    memcpy(coloring_request.minimum_m, images.minimum_m, sizeof images.minimum_m);
    memcpy(coloring_request.maximum_m, images.maximum_m, sizeof images.maximum_m);
    struct coloring coloring;
    coloring_build(arena, images.views, images.views_count, &coloring_request, &coloring);
    size_t grid = (size_t)request->grid;
    printf(
        "%d views of %d x %d pixels colour %zu of %zu voxels; %zu are seen through, %zu unseen\n",
        request->views, request->pixels, request->pixels, coloring.voxels_count, grid * grid * grid,
        coloring.clear_count, coloring.unseen_count);
    return STATUS_OK;
}

int verb_views(int argc, char **argv)
{
    const struct argp argp = {
        options,
        parse,
        "PLANT[:opt=val,...]",
        "Ray traces pictures with depth around a plant (a generator or a mesh file) and says how "
        "many voxels they colour.\v"
        "The folder of -o holds color-NN.exr, depth-NN.exr and cameras.json; a scene names it as "
        "a plant's \"images\" (scenes/README.md).",
        NULL,
        NULL,
        NULL};
    struct request request = {.views = 12, .pixels = 256, .grid = 128};
    argp_parse(&argp, argc, argv, 0, NULL, &request);
    struct error error = {0};
    struct arena *arena = arena_create(0);
    enum status status = make_views(arena, &request, &error);
    arena_destroy(arena);
    return status == STATUS_OK ? STATUS_OK : cli_fail(&error);
}
