/* Replays every kept input of the fuzzer, seeds and those that once broke a rule, without
 * libFuzzer. */
#include "testing.h"

#include "fuzz/targets.h"

#include <dirent.h>
#include <unistd.h>

static char folder[] = "/tmp/treeline-fuzz-XXXXXX";

static int set_up(void **state)
{
    (void)state;
    setenv("TREELINE_CACHE", "off", 1);
    return mkdtemp(folder) ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    static const char *const names[] = {
        "scene.json", "rows.csv",  "rows.json", "plan.json", "cells.jsonl", "check.ply", "tree.glb",
        "tree.ply",   "tree.gltf", "tree.obj",  "x.exr",     "x.jpg",       "x.png"};
    struct arena *arena = arena_create(0);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        unlink(arena_printf(arena, "%s/%s", folder, names[i]));
    arena_destroy(arena);
    return rmdir(folder);
}

/* Runs the files of one folder, each whole and cut after each eighth of it; returns how many. */
static size_t replay(const struct fuzz_target *target, const char *path)
{
    struct arena *arena = arena_create(0);
    DIR *files = opendir(path);
    size_t count = 0;
    for (struct dirent *item; files && (item = readdir(files));) {
        char *bytes;
        size_t size;
        struct error error = {0};
        if (item->d_name[0] == '.' || item->d_type == DT_DIR)
            continue;
        const char *file = arena_printf(arena, "%s/%s", path, item->d_name);
        if (file_read(arena, file, 0, &bytes, &size, &error) != STATUS_OK)
            fail_msg("%s", error.text);
        for (size_t eighth = target->slow ? 8 : 1; eighth <= 8; eighth++)
            fuzz_run(target, folder, (const uint8_t *)bytes, size * eighth / 8);
        count++;
    }
    if (files)
        closedir(files);
    arena_destroy(arena);
    return count;
}

static void test_fuzz__kept_inputs_of_every_target_hold_its_rules(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    for (int i = 0; i < FUZZ_TARGETS; i++) {
        const struct fuzz_target *target = &fuzz_targets[i];
        const char *path = arena_printf(arena, "%s/%s", data_folder(), target->seeds);
        if (replay(target, path) == 0)
            fail_msg("%s holds no seed of %s", path, target->name);
        replay(target,
               arena_printf(arena, "%s/tests/fuzz/regress/%s", data_folder(), target->name));
        fuzz_run(target, folder, (const uint8_t *)"", 0);
    }
    arena_destroy(arena);
}

static void test_fuzz__every_folder_of_kept_inputs_belongs_to_a_target(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    static const char *const kinds[] = {"seeds", "regress"};
    for (int k = 0; k < 2; k++) {
        const char *path = arena_printf(arena, "%s/tests/fuzz/%s", data_folder(), kinds[k]);
        DIR *folders = opendir(path);
        assert_non_null(folders);
        for (struct dirent *item; (item = readdir(folders));)
            if (item->d_name[0] != '.' && !fuzz_target(item->d_name))
                fail_msg("%s/%s: no target of this name", path, item->d_name);
        closedir(folders);
    }
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fuzz__kept_inputs_of_every_target_hold_its_rules),
        cmocka_unit_test(test_fuzz__every_folder_of_kept_inputs_belongs_to_a_target),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
