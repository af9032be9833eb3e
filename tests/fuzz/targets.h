/* What is fuzzed, and what must hold whatever the bytes: a loader takes them or refuses them with
 * one line that names the file and a status of bad input; what it takes is whole and comes back the
 * same. Shared by libFuzzer (fuzz.c) and by the test that replays kept inputs (test_fuzz.c). */
#ifndef TREELINE_TESTS_FUZZ_TARGETS_H
#define TREELINE_TESTS_FUZZ_TARGETS_H

#include "base/file.h"
#include "plan/names.h"
#include "plan/settings.h"
#include "plant/images.h"
#include "plant/import_steps.h"
#include "plant/lsystem.h"
#include "report/book.h"
#include "results/calibration.h"
#include "results/result.h"
#include "scene/scene.h"
#include "truth/frame.h"
#include "truth/frame_image.h"
#include "wall/json.h"
#include "wall/mesh_import_check.h"
#include "wall/mesh_import_parts.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

/* One input: its bytes, a folder to write them into, memory that ends with it. */
struct fuzz {
    const char *folder;
    const uint8_t *bytes;
    size_t size;
    struct arena *arena;
    struct error error;
};

static _Noreturn void fuzz_fail(const char *rule, const char *text)
{
    fprintf(stderr, "fuzz: broken: %s: %s\n", rule, text);
    abort();
}

/* The input as a file of the folder. */
static const char *fuzz_file(struct fuzz *fuzz, const char *name)
{
    const char *path = arena_printf(fuzz->arena, "%s/%s", fuzz->folder, name);
    int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (file < 0 || write(file, fuzz->bytes, fuzz->size) != (ssize_t)fuzz->size)
        fuzz_fail("the folder can be written", path);
    close(file);
    return path;
}

/* The input as a text; it ends at its first NUL. */
static const char *fuzz_text(struct fuzz *fuzz)
{
    char *text = arena_alloc(fuzz->arena, fuzz->size + 1, 1);
    if (fuzz->size)
        memcpy(text, fuzz->bytes, fuzz->size);
    return text;
}

/* True when the status is STATUS_OK; else the refusal must be one of bad input and name the thing.
 */
static bool fuzz_accepted(const struct fuzz *fuzz, enum status status, const char *thing)
{
    const struct error *error = &fuzz->error;
    if (status == STATUS_OK)
        return true;
    if (error->status != status || error->text[0] == '\0')
        fuzz_fail("a refusal says why", error->text);
    if (status != STATUS_INVALID && status != STATUS_NOT_FOUND && status != STATUS_IO)
        fuzz_fail("a refusal blames the input", error->text);
    if (!strstr(error->text, thing))
        fuzz_fail("a refusal names the thing", error->text);
    return false;
}

static void fuzz_scene_check(const struct scene *scene)
{
    for (size_t i = 0; i < scene->instances_count; i++) {
        const struct instance *tree = &scene->instances[i];
        for (int k = 0; k < 3; k++)
            if (!isfinite(tree->position_m[k]))
                fuzz_fail("trees stand somewhere", scene->name);
        if (!(tree->scale > 0) || tree->species >= scene->species_count)
            fuzz_fail("trees have a size and a species", scene->name);
    }
    for (int step = 0; step <= 4; step++) {
        struct view view;
        view_at(scene, step / 4.0, &view);
        for (int k = 0; k < 16; k++)
            if (!isfinite(view.view_projection[k / 4][k % 4]))
                fuzz_fail("cameras see", scene->name);
    }
}

static void fuzz_scene(struct fuzz *fuzz)
{
    const char *path = fuzz_file(fuzz, "scene.json");
    struct scene_summary summary;
    enum status status = scene_summary(fuzz->arena, path, &summary, &fuzz->error);
    if (!fuzz_accepted(fuzz, status, path))
        return;
    struct scene_request request = {.trees = 5, .seed = 1};
    struct scene *scene = NULL;
    if (fuzz_accepted(fuzz, scene_load(fuzz->arena, path, &request, &scene, &fuzz->error), path))
        fuzz_scene_check(scene);
}

/* A row a tree, read by a scene that asks for one tree. */
static void fuzz_placement(struct fuzz *fuzz)
{
    static const char text[] =
        "{\"size\":[8,8],\"trees\":{\"default\":1,\"standard\":[1]},\"plants\":[{\"generator\":"
        "\"poplar\",\"name\":\"a\"},{\"generator\":\"oak\",\"name\":\"b\"}],\"placement\":{"
        "\"kind\":"
        "\"file\",\"file\":\"rows.csv\"},\"camera\":{\"kind\":\"still\",\"keys\":[{\"eye\":[0,2,9],"
        "\"target\":[0,1,0]}]}}";
    struct fuzz fixed = *fuzz;
    fixed.bytes = (const uint8_t *)text;
    fixed.size = sizeof text - 1;
    const char *rows = fuzz_file(fuzz, "rows.csv"), *path = fuzz_file(&fixed, "rows.json");
    struct scene_request request = {.trees = 1, .seed = 1};
    struct scene *scene = NULL;
    if (fuzz_accepted(fuzz, scene_load(fuzz->arena, path, &request, &scene, &fuzz->error), rows))
        fuzz_scene_check(scene);
}

/* The cameras of a folder of pictures: what is taken is orthonormal. */
static void fuzz_cameras(struct fuzz *fuzz)
{
    const char *path = fuzz_file(fuzz, "cameras.json");
    struct images images;
    if (!fuzz_accepted(fuzz, images_describe(fuzz->arena, fuzz->folder, &images, &fuzz->error),
                       path))
        return;
    for (size_t k = 0; k < images.views_count; k++) {
        const struct depth_view *view = &images.views[k];
        float unit = 0, across = 0;
        for (int i = 0; i < 3; i++) {
            unit += view->up[i] * view->up[i] + view->right[i] * view->right[i];
            across += view->up[i] * view->forward[i] + view->right[i] * view->up[i];
        }
        if (!(unit > 1.999f && unit < 2.001f && across > -0.001f && across < 0.001f))
            fuzz_fail("a camera that is taken is orthonormal", path);
    }
}

/* A cell's name, taken, is read back as the same name. */
static void fuzz_cell_again(struct fuzz *fuzz, const char *name)
{
    struct cell cell;
    if (cell_parse(fuzz->arena, name, &cell, &fuzz->error) != STATUS_OK ||
        strcmp(cell.name, name) != 0)
        fuzz_fail("a name can be pasted back", name);
}

static void fuzz_plan(struct fuzz *fuzz)
{
    const char *path = fuzz_file(fuzz, "plan.json");
    struct plan_request request = {.plan_path = path};
    struct plan *plan = NULL;
    if (!fuzz_accepted(fuzz, plan_load(fuzz->arena, &request, &plan, &fuzz->error), ""))
        return;
    for (size_t i = 0; i < plan->cells_count && i < 16; i++)
        fuzz_cell_again(fuzz, plan->cells[i].name);
    size_t *order = ARENA_ARRAY(fuzz->arena, size_t, plan->cells_count);
    plan_order(plan, 0, order);
}

static void fuzz_cell(struct fuzz *fuzz)
{
    struct cell cell;
    enum status status = cell_parse(fuzz->arena, fuzz_text(fuzz), &cell, &fuzz->error);
    if (fuzz_accepted(fuzz, status, "cell '"))
        fuzz_cell_again(fuzz, cell.name);
}

/* The first byte chooses a table; what is taken is printed, read and printed again as the same. */
static void fuzz_options(struct fuzz *fuzz)
{
    const struct option *tables[32] = {plan_settings_table};
    size_t count = 1;
    for (const char *const *plant = plant_generators; *plant; plant++)
        tables[count++] = plant_options(*plant);
    for (const struct method *const *each = methods_builtin; *each && count < 32; each++)
        tables[count++] = (*each)->options;
    if (fuzz->size == 0)
        return;
    const struct option *table = tables[fuzz->bytes[0] % count];
    _Alignas(16) unsigned char values[2][4096] = {{0}};
    char first[4096], second[4096];
    options_default(table, values[0]);
    options_default(table, values[1]);
    enum status status = options_parse(table, fuzz_text(fuzz) + 1, values[0], &fuzz->error);
    if (!fuzz_accepted(fuzz, status, ""))
        return;
    options_print(table, values[0], first, sizeof first);
    if (options_parse(table, first, values[1], &fuzz->error) != STATUS_OK)
        fuzz_fail("options read back", first);
    options_print(table, values[1], second, sizeof second);
    if (strcmp(first, second) != 0)
        fuzz_fail("options read back as the same", first);
}

static void fuzz_results(struct fuzz *fuzz)
{
    const char *path = fuzz_file(fuzz, "cells.jsonl");
    struct run *run = NULL;
    if (!fuzz_accepted(fuzz, run_read(fuzz->arena, path, &run, &fuzz->error), path))
        return;
    for (size_t i = 0; i < run->results_count; i++) {
        const char *line = result_to_json(fuzz->arena, &run->results[i]);
        struct result again;
        if (result_from_json(fuzz->arena, line, "again", &again, &fuzz->error) != STATUS_OK)
            fuzz_fail("a result reads back", fuzz->error.text);
        if (strcmp(line, result_to_json(fuzz->arena, &again)) != 0)
            fuzz_fail("a result reads back as the same", line);
    }
    for (size_t i = 0; i < run->calibrations_count; i++) {
        const char *line = calibration_to_json(fuzz->arena, &run->calibrations[i]);
        struct calibration again;
        if (calibration_from_json(fuzz->arena, line, "again", &again, &fuzz->error) != STATUS_OK)
            fuzz_fail("a calibration reads back", fuzz->error.text);
        if (strcmp(line, calibration_to_json(fuzz->arena, &again)) != 0)
            fuzz_fail("a calibration reads back as the same", line);
    }
}

/* What the page says about a run, whatever its numbers are. */
static void fuzz_report(struct fuzz *fuzz)
{
    const char *path = fuzz_file(fuzz, "cells.jsonl");
    struct run *run = NULL;
    if (run_read(fuzz->arena, path, &run, &fuzz->error) != STATUS_OK || run->results_count == 0)
        return;
    struct book *book = book_make(fuzz->arena, run);
    char *page = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&page, &size);
    answer_headline(book, out);
    answer_fronts(book, out);
    answer_overall(book, out);
    fclose(out);
    bool named = memmem(fuzz->bytes, fuzz->size, "nan", 3) != NULL;
    if (!named && (strstr(page, ">nan") || strstr(page, " nan") || strstr(page, "-nan")))
        fuzz_fail("no sentence says nan", page);
    free(page);
    const char *data = data_json(book, fuzz->arena);
    struct json_doc *doc = json_parse(fuzz->arena, data, "data", &fuzz->error);
    if (!doc)
        fuzz_fail("the page's data is JSON", fuzz->error.text);
}

/* The looks before assimp reads. */
static void fuzz_ply(struct fuzz *fuzz)
{
    const char *path = fuzz_file(fuzz, "check.ply");
    bool encoded;
    fuzz_accepted(fuzz, ply_check(path, &encoded, &fuzz->error), path);
    fuzz_accepted(fuzz, glb_check(path, &fuzz->error), path);
}

/* The endings that a mesh's first bytes speak for. */
static const char *fuzz_mesh_name(const struct fuzz *fuzz)
{
    const char *text = (const char *)fuzz->bytes;
    if (fuzz->size >= 4 && memcmp(text, "glTF", 4) == 0)
        return "tree.glb";
    if (fuzz->size >= 3 && memcmp(text, "ply", 3) == 0)
        return "tree.ply";
    return fuzz->size >= 1 && text[0] == '{' ? "tree.gltf" : "tree.obj";
}

/* The whole way of a user's mesh, the child that reads it included. The child says only that it
 * ended; fuzz.sh gives a sanitizer's report the exit code 86, so that it is told from assimp's
 * crashes. */
static void fuzz_mesh(struct fuzz *fuzz)
{
    const char *path = fuzz_file(fuzz, fuzz_mesh_name(fuzz));
    struct import_request *request = NULL;
    struct mesh *mesh = NULL;
    if (import_request(fuzz->arena, path, NULL, &request, &fuzz->error) != STATUS_OK)
        fuzz_fail("the request is good", fuzz->error.text);
    enum status status = import_mesh(fuzz->arena, request, &mesh, &fuzz->error);
    if (status != STATUS_OK && strstr(fuzz->error.text, "(exit code 86)"))
        fuzz_fail("the child has no sanitizer's report", fuzz->error.text);
    if (fuzz_accepted(fuzz, status, path) && mesh_check(mesh, &fuzz->error) != STATUS_OK)
        fuzz_fail("a mesh that is taken is whole", fuzz->error.text);
}

/* What the child hands over, torn or wrong, and what is made of it. */
static void fuzz_soup(struct fuzz *fuzz)
{
    int file = memfd_create("fuzz-soup", MFD_CLOEXEC);
    if (file < 0 || write(file, fuzz->bytes, fuzz->size) != (ssize_t)fuzz->size)
        fuzz_fail("memory can be written", "memfd");
    struct import_soup *soup = soup_read(fuzz->arena, file);
    close(file);
    struct import_request *request = NULL;
    struct mesh *mesh = NULL;
    if (!soup || import_request(fuzz->arena, "soup.obj", NULL, &request, &fuzz->error) != STATUS_OK)
        return;
    const struct texture **textures =
        ARENA_ARRAY(fuzz->arena, const struct texture *, soup->materials_count);
    bool *has_holes = ARENA_ARRAY(fuzz->arena, bool, soup->materials_count);
    enum status status =
        import_convert(fuzz->arena, request, soup, textures, has_holes, &mesh, &fuzz->error);
    if (fuzz_accepted(fuzz, status, "soup.obj"))
        mesh_check(mesh, &fuzz->error);
}

/* A plant as the disk cache keeps it; what is taken is written and read as the same. */
static void fuzz_packed(struct fuzz *fuzz)
{
    void *bytes = arena_alloc(fuzz->arena, fuzz->size, 1);
    if (fuzz->size)
        memcpy(bytes, fuzz->bytes, fuzz->size);
    struct mesh *mesh = import_decode(fuzz->arena, bytes, fuzz->size);
    if (!mesh || mesh_check(mesh, &fuzz->error) != STATUS_OK)
        return;
    size_t first_size, second_size;
    void *first = import_encode(fuzz->arena, mesh, &first_size);
    void *copy = memcpy(arena_alloc(fuzz->arena, first_size, 1), first, first_size);
    mesh = import_decode(fuzz->arena, copy, first_size);
    if (!mesh)
        fuzz_fail("a plant reads back", "packed");
    void *second = import_encode(fuzz->arena, mesh, &second_size);
    if (first_size != second_size || memcmp(first, second, first_size) != 0)
        fuzz_fail("a plant reads back as the same", "packed");
}

static void fuzz_frame(struct fuzz *fuzz)
{
    struct frame *frame = NULL;
    enum status status =
        frame_unpack(fuzz->arena, fuzz->bytes, fuzz->size, "x.frame", &frame, &fuzz->error);
    if (fuzz_accepted(fuzz, status, "x.frame"))
        frame_check(frame, &fuzz->error);
}

static void fuzz_image(struct fuzz *fuzz)
{
    const char *text = (const char *)fuzz->bytes;
    bool exr = fuzz->size >= 4 && memcmp(text, "\x76\x2f\x31\x01", 4) == 0;
    bool jpeg = fuzz->size >= 2 && memcmp(text, "\xff\xd8", 2) == 0;
    const char *path = fuzz_file(fuzz, exr ? "x.exr" : jpeg ? "x.jpg" : "x.png");
    struct frame *frame = NULL;
    bool exact;
    enum status status = frame_read_image(fuzz->arena, path, &frame, &exact, &fuzz->error);
    if (fuzz_accepted(fuzz, status, path))
        frame_check(frame, &fuzz->error);
}

/* A grammar: what is taken grows, the same twice, or is refused for its size; every needle is
 * finite. */
static void fuzz_grammar(struct fuzz *fuzz)
{
    struct lsystem *lsystem = NULL;
    struct conifer *conifer = NULL, *again = NULL;
    enum status status =
        lsystem_parse(fuzz->arena, fuzz_text(fuzz), "x.json", &lsystem, &fuzz->error);
    if (!fuzz_accepted(fuzz, status, "x.json") ||
        !fuzz_accepted(fuzz, lsystem_conifer(fuzz->arena, lsystem, &conifer, &fuzz->error),
                       "x.json"))
        return;
    if (lsystem_conifer(fuzz->arena, lsystem, &again, &fuzz->error) != STATUS_OK ||
        again->needles_count != conifer->needles_count)
        fuzz_fail("a grammar grows the same twice", "needles");
    uint64_t needles = 0;
    for (size_t i = 0; i < conifer->twigs_count; i++) {
        const struct conifer_twig *twig = &conifer->twigs[i];
        float base_m[3], tip_m[3];
        needles += (uint64_t)twig->cones_count * twig->needles_count;
        if (!twig->cones_count || !twig->needles_count)
            continue;
        conifer_needle(twig, twig->cones_count - 1, twig->needles_count - 1, base_m, tip_m);
        for (int k = 0; k < 3; k++)
            if (!isfinite(base_m[k]) || !isfinite(tip_m[k]))
                fuzz_fail("needles are somewhere", "needle");
    }
    if (needles != conifer->needles_count)
        fuzz_fail("needles are counted", "needles");
}

static const struct fuzz_target {
    const char *name, *seeds; /* seeds: a folder of good inputs */
    bool slow;                /* a child for each input */
    void (*run)(struct fuzz *fuzz);
} fuzz_targets[] = {
    {"scene", "scenes", false, fuzz_scene},
    {"placement", "scenes/placements", false, fuzz_placement},
    {"cameras", "tests/fuzz/seeds/cameras", false, fuzz_cameras},
    {"plan", "scenes/plans", false, fuzz_plan},
    {"cell", "tests/fuzz/seeds/cell", false, fuzz_cell},
    {"options", "tests/fuzz/seeds/options", false, fuzz_options},
    {"results", "tests/fuzz/seeds/results", false, fuzz_results},
    {"report", "tests/fuzz/seeds/results", false, fuzz_report},
    {"ply", "tests/fuzz/seeds/ply", false, fuzz_ply},
    {"mesh", "tests/fuzz/seeds/mesh", true, fuzz_mesh},
    {"soup", "tests/fuzz/seeds/soup", false, fuzz_soup},
    {"packed", "tests/fuzz/seeds/packed", false, fuzz_packed},
    {"frame", "tests/fuzz/seeds/frame", false, fuzz_frame},
    {"image", "tests/fuzz/seeds/image", false, fuzz_image},
    {"grammar", "scenes/plants", false, fuzz_grammar},
};
enum { FUZZ_TARGETS = sizeof fuzz_targets / sizeof *fuzz_targets };

static const struct fuzz_target *fuzz_target(const char *name)
{
    for (int i = 0; i < FUZZ_TARGETS; i++)
        if (name && strcmp(fuzz_targets[i].name, name) == 0)
            return &fuzz_targets[i];
    return NULL;
}

/* Runs one input; folder: of this process alone. */
static void fuzz_run(const struct fuzz_target *target, const char *folder, const uint8_t *bytes,
                     size_t size)
{
    struct fuzz fuzz = {.folder = folder, .bytes = bytes, .size = size, .arena = arena_create(0)};
    target->run(&fuzz);
    arena_destroy(fuzz.arena);
}

#endif
