/* Scene files: every key, every refusal, the hash. */
#include "own_folder.h"

#include "base/arena.h"
#include "base/file.h"
#include "base/hash.h"
#include "scene/description.h"
#include "scene/scene.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *write_text(const char *name, const char *text)
{
    static char path[512];
    struct error error = {STATUS_OK, ""};
    snprintf(path, sizeof path, "%s/%s", folder, name);
    assert_int_equal(file_write(path, text, strlen(text), &error), STATUS_OK);
    return path;
}

static enum status load_text(struct arena *arena, const char *text, size_t trees, uint64_t seed,
                             struct scene **scene, struct error *error)
{
    struct scene_request request = {.trees = trees, .seed = seed};
    *error = (struct error){STATUS_OK, ""};
    return scene_load(arena, write_text("scene.json", text), &request, scene, error);
}

static struct scene *load_good(struct arena *arena, const char *text, size_t trees)
{
    struct scene *scene = NULL;
    struct error error;
    enum status status = load_text(arena, text, trees, 1, &scene, &error);
    assert_string_equal(error.text, "");
    assert_int_equal(status, STATUS_OK);
    return scene;
}

#define PLANTS "\"plants\":[{\"generator\":\"poplar\"}]"
#define GRID "\"placement\":{\"kind\":\"grid\",\"spacing_m\":8}"
#define KEYS "\"keys\":[{\"eye\":[0,10,50],\"target\":[0,8,0]}]"
#define CAMERA "\"camera\":{\"kind\":\"still\"," KEYS "}"
#define SCENE_WITH(more) "{" PLANTS "," GRID "," CAMERA more "}"

static void test_scene__a_short_file_loads_with_the_defaults_of_the_readme(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct scene *scene = load_good(arena, SCENE_WITH(""), SIZE_MAX);
    assert_string_equal(scene->name, "scene");
    assert_int_equal(scene->width_px, 800);
    assert_int_equal(scene->height_px, 600);
    assert_int_equal(scene->instances_count, 100);
    assert_int_equal(scene->effects, 0);
    assert_int_equal(scene->species_count, 1);
    assert_string_equal(scene->species[0].name, "poplar");
    assert_float_equal(scene->forest_half_m, 40, 1e-5);
    assert_float_equal(scene->sun.elevation_rad, 0.7853982, 1e-6);
    assert_float_equal(scene->sun.end_elevation_rad, 0.7853982, 1e-6);
    assert_float_equal(scene->camera.fov_y_rad, 0.7853982, 1e-6);
    assert_int_equal(scene->camera.frames_count, 60);
    assert_null(terrain_mesh(arena, &scene->terrain));
    assert_float_equal(terrain_height(&scene->terrain, 5, 5), 0, 0);
    arena_destroy(arena);
}

static void test_scene__the_request_overrides_size_and_number(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct scene *scene = NULL;
    struct error error = {STATUS_OK, ""};
    struct scene_request request = {.trees = 7, .seed = 3, .width_px = 320, .height_px = 200};
    const char *path = write_text("scene.json", SCENE_WITH(""));
    assert_int_equal(scene_load(arena, path, &request, &scene, &error), STATUS_OK);
    assert_int_equal(scene->instances_count, 7);
    assert_int_equal(scene->width_px, 320);
    assert_int_equal(scene->height_px, 200);
    request.trees = 4000001;
    assert_int_equal(scene_load(arena, path, &request, &scene, &error), STATUS_INVALID);
    assert_non_null(strstr(error.text, "trees: value is 4000001; allowed: 0..4000000"));
    request = (struct scene_request){.trees = 1, .width_px = 20000};
    assert_int_equal(scene_load(arena, path, &request, &scene, NULL), STATUS_INVALID);
    arena_destroy(arena);
}

static void test_scene__no_tree_is_a_scene_without_species(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct scene *scene = load_good(arena, SCENE_WITH(""), 0);
    assert_int_equal(scene->instances_count, 0);
    assert_int_equal(scene->species_count, 0);
    struct view view;
    view_at(scene, 0, &view);
    assert_true(view.near_m > 0 && view.near_m < view.far_m);
    arena_destroy(arena);
}

static void test_scene__a_species_without_a_tree_is_left_out(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    const char *text = "{\"plants\":[{\"generator\":\"oak\",\"weight\":0},"
                       "{\"generator\":\"poplar\"}]," GRID "," CAMERA "}";
    struct scene *scene = load_good(arena, text, 50);
    assert_int_equal(scene->species_count, 1);
    assert_string_equal(scene->species[0].name, "poplar");
    for (size_t k = 0; k < 50; k++)
        assert_int_equal(scene->instances[k].species, 0);
    arena_destroy(arena);
}

static void test_scene__keys_in_extents_grow_with_the_forest_and_stand_on_the_ground(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    write_text("slope.pgm", "P2\n2 2\n100\n0 100\n0 100\n");
    const char *text = "{" PLANTS "," GRID ",\"terrain\":{\"size_m\":[1000,1000],"
                       "\"image\":\"slope.pgm\",\"height_m\":100},"
                       "\"camera\":{\"kind\":\"still\",\"unit\":\"extent\",\"extent_min_m\":10,"
                       "\"keys\":[{\"eye\":[2,1,3],\"target\":[0,0,0]}]}}";
    struct scene *scene = load_good(arena, text, 100);
    assert_float_equal(scene->camera.keys[0].eye_m[0], 80, 1e-4);
    assert_float_equal(scene->camera.keys[0].eye_m[1], 40 + 58, 1e-3); /* 0.1 a metre from -500 */
    assert_float_equal(scene->camera.keys[0].eye_m[2], 120, 1e-4);
    assert_float_equal(scene->camera.keys[0].target_m[1], 50, 1e-3);
    scene = load_good(arena, text, 1);
    assert_float_equal(scene->camera.keys[0].eye_m[0], 20, 1e-4);
    for (size_t k = 0; k < scene->instances_count; k++)
        assert_float_equal(scene->instances[k].position_m[1],
                           0.1f * (scene->instances[k].position_m[0] + 500), 1e-3);
    arena_destroy(arena);
}

/* Each bad file is one line with the file, the key, the value and what is allowed. */
static const struct {
    const char *text, *expected;
} bad_files[] = {
    {"{", "scene.json:1: not JSON"},
    {"[]", "scene.json: is not an object"},
    {"{" GRID "," CAMERA "}", "plants: has 0 elements; allowed: 1..256"},
    {"{" PLANTS "," CAMERA "}", "placement: is missing"},
    {"{" PLANTS "," GRID "}", "camera: is missing"},
    {SCENE_WITH(",\"siz\":[1,2]"),
     "siz: is not a key known here (did you mean 'size'?); allowed: "},
    {SCENE_WITH(",\"light\":{\"elevation\":45}"),
     "light.elevation: is not a key known here (did you mean 'elevation_deg'?)"},
    {SCENE_WITH(",\"size\":[0,600]"), "size[0]: value is 0; allowed: 1..16384"},
    {SCENE_WITH(",\"size\":[800.5,600]"), "size: value is 800.5; allowed: whole numbers 1..16384"},
    {SCENE_WITH(",\"size\":800"), "size: is a number; allowed: a list"},
    {SCENE_WITH(",\"doc\":3"), "doc: is a number; allowed: a text"},
    {SCENE_WITH(",\"trees\":{\"default\":-1}"), "trees.default: value is -1; allowed: 0..4000000"},
    {SCENE_WITH(",\"trees\":{\"standard\":[1,5000000]}"),
     "trees.standard[1]: value is 5000000; allowed: 0..4000000"},
    {SCENE_WITH(",\"trees\":{\"standard\":[1.5]}"), "trees.standard: value is 1.5; allowed: whole"},
    {SCENE_WITH(",\"effects\":[\"shadow\"]"),
     "effects: value is 'shadow'; allowed: "
     "two-sided|ambient|sun-shadows|sky-occlusion|fog|specular"},
    {SCENE_WITH(",\"effects\":[\"fog\"]"), "fog: is missing or has no density"},
    {SCENE_WITH(",\"ambient\":[1,2]"), "ambient: has 2 values; allowed: 3"},
    {SCENE_WITH(",\"light\":{\"elevation_deg\":91}"),
     "light.elevation_deg: value is 91; allowed: -90..90"},
    {SCENE_WITH(",\"light\":{\"radiance\":[1,-1,1]}"),
     "light.radiance[1]: value is -1; allowed: 0..1000"},
    {SCENE_WITH(",\"fog\":{\"density_per_m\":11}"),
     "fog.density_per_m: value is 11; allowed: 0..10"},
    {SCENE_WITH(",\"terrain\":{}"), "terrain.size_m: is missing; allowed: [x, z]"},
    {SCENE_WITH(",\"terrain\":{\"size_m\":[50,500]}"),
     "terrain.size_m[0]: value is 50 m, but 100 trees stand on a square of 80 m; allowed: at "
     "least"},
    {SCENE_WITH(",\"terrain\":{\"size_m\":[500,500],\"height_m\":3}"),
     "terrain.height_m: means nothing to this kind; allowed: with an image"},
    {SCENE_WITH(",\"terrain\":{\"size_m\":[500,500],\"image\":\"none.png\",\"height_m\":3}"),
     "scene.json: terrain.image: "},
    {SCENE_WITH(",\"terrain\":{\"size_m\":[500,500],\"image\":\"none.png\"}"),
     "terrain.height_m: is missing; a number is required"},
    {"{\"plants\":[{}]," GRID "," CAMERA "}",
     "plants[0].generator: is missing, and so are a file and images"},
    {"{\"plants\":[{\"generator\":\"poplar\",\"file\":\"x.obj\"}]," GRID "," CAMERA "}",
     "plants[0].generator: stands beside a file; allowed: either"},
    {"{\"plants\":[{\"generator\":\"elm\"}]," GRID "," CAMERA "}", "scene.json: plants[0]: "},
    {"{\"plants\":[{\"generator\":\"poplar\",\"options\":\"hight=3\"}]," GRID "," CAMERA "}",
     "scene.json: plants[0]: "},
    {"{\"plants\":[{\"file\":\"x.obj\",\"options\":\"height=3\"}]," GRID "," CAMERA "}",
     "plants[0].options: value is 'height=3'; allowed: with a generator only"},
    {"{\"plants\":[{\"generator\":\"lsystem\"}]," GRID "," CAMERA "}",
     "plants[0].file: is missing; allowed: a grammar's file"},
    {"{" PLANTS "," GRID "," CAMERA ",\"terrain\":{\"size_m\":[99,99],\"relief\":{\"level\":27,"
     "\"spike_m\":1}}}",
     "terrain.relief.level: value is 27; allowed: 1..26"},
    {SCENE_WITH(",\"terrain\":{\"size_m\":[500,500],\"image\":\"x.png\",\"height_m\":1,"
                "\"perlin\":{\"height_m\":1,\"period_m\":9}}"),
     "terrain.perlin: stands beside an image; allowed: one of them"},
    {SCENE_WITH(",\"terrain\":{\"size_m\":[500,500],\"perlin\":{\"height_m\":1}}"),
     "terrain.perlin.period_m: is missing"},
    {SCENE_WITH(",\"terrain\":{\"size_m\":[500,500],\"perlin\":{\"height_m\":1,\"period_m\":9,"
                "\"samples\":[1,9]}}"),
     "terrain.perlin.samples[0]: value is 1; allowed: 2..8193"},
    {SCENE_WITH(",\"terrain\":{\"size_m\":[500,500],\"color\":\"none.png\"}"),
     "scene.json: terrain.color: "},
    {"{" PLANTS ",\"placement\":{\"kind\":\"grid\",\"spacing_m\":5,\"slope_max_deg\":9}," CAMERA
     "}",
     "placement.slope_max_deg: means nothing without a terrain"},
    {"{" PLANTS ",\"placement\":{\"kind\":\"grid\",\"spacing_m\":5,\"heights_m\":[3,2]}," CAMERA
     ",\"terrain\":{\"size_m\":[500,500]}}",
     "placement.heights_m: value is [3, 2]; allowed: the lower one first"},
    {"{\"plants\":[{\"generator\":\"poplar\",\"import\":{}}]," GRID "," CAMERA "}",
     "plants[0].import: stands without a file"},
    {"{\"plants\":[{\"generator\":\"poplar\",\"scale\":[2,1]}]," GRID "," CAMERA "}",
     "plants[0].scale: value is [2, 1]; allowed: the smaller one first"},
    {"{\"plants\":[{\"generator\":\"poplar\",\"stretch\":[2,1]}]," GRID "," CAMERA "}",
     "plants[0].stretch: value is [2, 1]; allowed: the smaller one first"},
    {"{\"plants\":[{\"generator\":\"poplar\",\"stretch\":[0,1]}]," GRID "," CAMERA "}",
     "plants[0].stretch"},
    {"{\"plants\":[{\"generator\":\"poplar\",\"weight\":-1}]," GRID "," CAMERA "}",
     "plants[0].weight: value is -1; allowed: 0..1000000"},
    {"{\"plants\":[{\"generator\":\"poplar\",\"weight\":0}]," GRID "," CAMERA "}",
     "plants: the sum of the weights is 0"},
    {"{\"plants\":[{\"generator\":\"poplar\"},{\"generator\":\"poplar\"}]," GRID "," CAMERA "}",
     "plants[1].name: value is 'poplar', the name of plants[0]"},
    {"{" PLANTS ",\"placement\":{\"kind\":\"row\"}," CAMERA "}",
     "placement.kind: value is 'row'; allowed: grid|poisson|file"},
    {"{" PLANTS ",\"placement\":{\"kind\":\"grid\"}," CAMERA "}",
     "placement.spacing_m: is missing, and so is extent_m"},
    {"{" PLANTS ",\"placement\":{\"kind\":\"grid\",\"extent_m\":9,\"spacing_m\":1}," CAMERA "}",
     "placement.spacing_m: stands beside extent_m; allowed: either"},
    {"{" PLANTS ",\"placement\":{\"kind\":\"poisson\",\"spacing_m\":9,\"jitter\":1}," CAMERA "}",
     "placement.jitter: means nothing to this kind; allowed: with grid"},
    {"{" PLANTS ",\"placement\":{\"kind\":\"file\"}," CAMERA "}", "placement.file: is missing"},
    {"{" PLANTS ",\"placement\":{\"kind\":\"file\",\"file\":\"no.csv\"}," CAMERA "}",
     "scene.json: placement.file: "},
    {"{" PLANTS "," GRID ",\"camera\":{\"kind\":\"fly\"," KEYS "}}",
     "camera.kind: value is 'fly'; allowed: still|orbit|walk|approach|fly-over|keys"},
    {"{" PLANTS "," GRID ",\"camera\":{\"kind\":\"walk\"," KEYS "}}",
     "camera.keys: has 1 elements; allowed for this kind: 2..2"},
    {"{" PLANTS "," GRID ",\"camera\":{\"kind\":\"still\",\"turn_deg\":90," KEYS "}}",
     "camera.turn_deg: means nothing to this kind; allowed: with orbit"},
    {"{" PLANTS "," GRID ",\"camera\":{\"kind\":\"still\",\"rise_deg\":90," KEYS "}}",
     "camera.rise_deg: means nothing to this kind; allowed: with orbit"},
    {"{" PLANTS "," GRID ",\"camera\":{\"kind\":\"still\",\"extent_min_m\":9," KEYS "}}",
     "camera.extent_min_m: means nothing to metres"},
    {"{" PLANTS "," GRID ",\"camera\":{\"kind\":\"still\",\"fov_y_deg\":180," KEYS "}}",
     "camera.fov_y_deg: value is 180; allowed: 1..170"},
    {"{" PLANTS "," GRID ",\"camera\":{\"kind\":\"still\",\"near_m\":9,\"far_m\":3," KEYS "}}",
     "camera.far_m: value is 3; allowed: above near_m, 9"},
    {"{" PLANTS "," GRID ",\"camera\":{\"kind\":\"still\",\"keys\":[{\"eye\":[1,2,3]}]}}",
     "camera.keys[0].target: is missing"},
    {"{" PLANTS "," GRID ",\"camera\":{\"kind\":\"still\",\"keys\":"
     "[{\"eye\":[1,2,3],\"target\":[1,2,3]}]}}",
     "camera.keys[0].target: is the eye; allowed: another point"},
};

static void test_scene__a_bad_file_is_refused_with_file_key_value_and_allowance(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof bad_files / sizeof bad_files[0]; k++) {
        struct arena *arena = arena_create(0);
        struct scene *scene = NULL;
        struct error error;
        enum status status = load_text(arena, bad_files[k].text, SIZE_MAX, 1, &scene, &error);
        if (status != STATUS_INVALID && status != STATUS_NOT_FOUND)
            fail_msg("'%s' gave %s", bad_files[k].text, status_word(status));
        if (!strstr(error.text, bad_files[k].expected) || !strstr(error.text, "scene.json"))
            fail_msg("'%s' lacks '%s'", error.text, bad_files[k].expected);
        assert_null(strchr(error.text, '\n'));
        assert_null(scene);
        arena_destroy(arena);
    }
}

static void test_scene__a_name_that_is_no_scene_is_told_the_nearest(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    struct scene *scene = NULL;
    struct error error = {STATUS_OK, ""};
    struct scene_request request = {.trees = 1};
    assert_int_equal(scene_load(arena, "tny", &request, &scene, &error), STATUS_NOT_FOUND);
    assert_non_null(strstr(error.text, "'tny'"));
    assert_non_null(strstr(error.text, "did you mean 'tiny'"));
    assert_int_equal(scene_load(arena, "/nowhere/x.json", &request, &scene, &error),
                     STATUS_NOT_FOUND);
    assert_non_null(strstr(error.text, "/nowhere/x.json"));
    arena_destroy(arena);
}

/* The hash of a scene of text, at 20 trees. */
static uint64_t hash_of(const char *text, uint64_t seed)
{
    struct arena *arena = arena_create(0);
    struct scene *scene = NULL;
    struct error error;
    load_text(arena, text, 20, seed, &scene, &error);
    assert_string_equal(error.text, "");
    uint64_t hash = scene->hash;
    arena_destroy(arena);
    return hash;
}

#define FULL(doc, size, plant, place, albedo, azimuth, end, ambient, sky, fog, eye)                \
    "{\"doc\":\"" doc "\",\"size\":" size ",\"plants\":[{\"generator\":\"poplar\"" plant "}],"     \
    "\"placement\":{\"kind\":\"grid\"," place "},\"terrain\":{\"size_m\":[500,500],\"albedo\":"    \
    "[0.1,0.1," albedo "]},\"light\":{\"azimuth_deg\":" azimuth ",\"end_elevation_deg\":" end      \
    "},\"ambient\":[" ambient ",0,0],\"sky\":{\"zenith\":[0,0," sky "]},\"fog\":{" fog "},"        \
    "\"camera\":{\"kind\":\"still\",\"keys\":[{\"eye\":[0,10," eye "],\"target\":[0,8,0]}]}}"

static void test_hash__changes_with_all_that_can_change_a_picture(void **state)
{
    (void)state;
    static const char *const texts[] = {
        FULL("a", "[8,8]", "", "\"spacing_m\":8", "0.1", "40", "45", "0", "1", "", "50"),
        FULL("a", "[8,8]", ",\"options\":\"seed=9\"", "\"spacing_m\":8", "0.1", "40", "45", "0",
             "1", "", "50"),
        FULL("a", "[8,8]", ",\"scale\":[1,2]", "\"spacing_m\":8", "0.1", "40", "45", "0", "1", "",
             "50"),
        FULL("a", "[8,8]", ",\"stretch\":[1,2]", "\"spacing_m\":8", "0.1", "40", "45", "0", "1", "",
             "50"),
        FULL("a", "[8,8]", "", "\"spacing_m\":9", "0.1", "40", "45", "0", "1", "", "50"),
        FULL("a", "[8,8]", "", "\"spacing_m\":8,\"jitter\":0.5", "0.1", "40", "45", "0", "1", "",
             "50"),
        FULL("a", "[8,8]", "", "\"spacing_m\":8,\"rotate\":false", "0.1", "40", "45", "0", "1", "",
             "50"),
        FULL("a", "[8,8]", "", "\"spacing_m\":8", "0.2", "40", "45", "0", "1", "", "50"),
        FULL("a", "[8,8]", "", "\"spacing_m\":8", "0.1", "41", "45", "0", "1", "", "50"),
        FULL("a", "[8,8]", "", "\"spacing_m\":8", "0.1", "40", "46", "0", "1", "", "50"),
        FULL("a", "[8,8]", "", "\"spacing_m\":8", "0.1", "40", "45", "1", "1", "", "50"),
        FULL("a", "[8,8]", "", "\"spacing_m\":8", "0.1", "40", "45", "0", "2", "", "50"),
        FULL("a", "[8,8]", "", "\"spacing_m\":8", "0.1", "40", "45", "0", "1",
             "\"density_per_m\":0.1", "50"),
        FULL("a", "[8,8]", "", "\"spacing_m\":8", "0.1", "40", "45", "0", "1",
             "\"density_per_m\":0.1,\"color\":[0,0,0]", "50"),
    };
    enum { COUNT = sizeof texts / sizeof texts[0] };
    uint64_t hashes[COUNT + 1];
    for (int k = 0; k < COUNT; k++)
        hashes[k] = hash_of(texts[k], 1);
    hashes[COUNT] = hash_of(texts[0], 2);
    for (int a = 0; a <= COUNT; a++)
        for (int b = 0; b < a; b++)
            if (hashes[a] == hashes[b])
                fail_msg("variants %d and %d have one hash", a, b);
}

static void test_hash__does_not_change_with_anything_else(void **state)
{
    (void)state;
    uint64_t hash = hash_of(
        FULL("a", "[8,8]", "", "\"spacing_m\":8", "0.1", "40", "45", "0", "1", "", "50"), 1);
    static const char *const texts[] = {
        FULL("b", "[8,8]", "", "\"spacing_m\":8", "0.1", "40", "45", "0", "1", "", "50"),
        FULL("a", "[9,8]", "", "\"spacing_m\":8", "0.1", "40", "45", "0", "1", "", "50"),
        FULL("a", "[8,8]", ",\"stretch\":[1,1]", "\"spacing_m\":8", "0.1", "40", "45", "0", "1", "",
             "50"),
        FULL("a", "[8,8]", ",\"name\":\"tall\"", "\"spacing_m\":8", "0.1", "40", "45", "0", "1", "",
             "50"),
        FULL("a", "[8,8]", ",\"weight\":7", "\"spacing_m\":8", "0.1", "40", "45", "0", "1", "",
             "50"),
        FULL("a", "[8,8]", ",\"reach_m\":30", "\"spacing_m\":8", "0.1", "40", "45", "0", "1", "",
             "50"),
        FULL("a", "[8,8]", "", "\"spacing_m\":8", "0.1", "40", "45", "0", "1", "", "60"),
        FULL("a", "[8,8]", "", "\"spacing_m\":8", "0.1", "40", "45", "0", "1", "\"color\":[0,0,0]",
             "50"),
    };
    for (size_t k = 0; k < sizeof texts / sizeof texts[0]; k++)
        if (hash_of(texts[k], 1) != hash)
            fail_msg("variant %zu has another hash", k);
}

/* The keys that the loader asks for, from its source: the words in json_...(object, "key". */
static size_t loader_keys(struct arena *arena, const char *file, const char **keys, size_t count)
{
    char *text = NULL, *at;
    size_t size = 0;
    const char *path = arena_printf(arena, "%s/harness/scene/%s", data_folder(), file);
    assert_int_equal(file_read(arena, path, 0, &text, &size, NULL), STATUS_OK);
    for (at = text; (at = strpbrk(at, "jd")) != NULL; at++) {
        bool getter = strncmp(at, "json_", 5) == 0 && strncmp(at, "json_fail", 9) != 0;
        if (!getter && strncmp(at, "describe_color(", 15) != 0 &&
            strncmp(at, "describe_albedo(", 16) != 0)
            continue;
        char *quote = strchr(at, '"'), *end = at + strcspn(at, ")\n{");
        if (!quote || quote > end)
            continue;
        keys[count++] = arena_printf(arena, "%.*s", (int)strcspn(quote + 1, "\""), quote + 1);
    }
    return count;
}

static void test_readme__has_every_key_of_the_loader(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    const char *keys[256];
    size_t count = loader_keys(arena, "description.c", keys, 0);
    count = loader_keys(arena, "describe_forest.c", keys, count);
    count = loader_keys(arena, "describe_view.c", keys, count);
    assert_in_range(count, 50, 250);
    char *readme = NULL;
    size_t size = 0;
    const char *path = arena_printf(arena, "%s/scenes/README.md", data_folder());
    assert_int_equal(file_read(arena, path, 0, &readme, &size, NULL), STATUS_OK);
    for (size_t k = 0; k < count; k++) {
        const char *tick = arena_printf(arena, "`%s`", keys[k]);
        const char *dotted = arena_printf(arena, ".%s`", keys[k]);
        const char *outer = arena_printf(arena, "`%s.", keys[k]);
        if (!strstr(readme, tick) && !strstr(readme, dotted) && !strstr(readme, outer))
            fail_msg("scenes/README.md lacks %s", keys[k]);
    }
    arena_destroy(arena);
}

/* Where a key of the README stands: the file around it, the required keys beside it. */
struct place {
    const char *section, *outer, *before, *after;
    const char *beside[2][2];
};

static const struct place places[] = {
    {"`plants`", "import", "\"plants\":[{\"file\":\"x\",\"import\":", "}]", {{NULL}}},
    {"`plants`", "coloring", "\"plants\":[{\"images\":\"x\",\"coloring\":", "}]", {{NULL}}},
    {"`plants`", NULL, "\"plants\":[", "]", {{"generator", "\"poplar\""}}},
    {"`placement`", NULL, PLANTS ",\"placement\":", "", {{"kind", "\"grid\""}, {"extent_m", "9"}}},
    {"`terrain`",
     "relief",
     PLANTS "," GRID ",\"terrain\":{\"size_m\":[99,99],\"relief\":",
     "}",
     {{"level", "5"}, {"spike_m", "3"}}},
    {"`terrain`",
     "perlin",
     PLANTS "," GRID ",\"terrain\":{\"size_m\":[99,99],\"perlin\":",
     "}",
     {{"height_m", "5"}, {"period_m", "3"}}},
    {"`terrain`", NULL, PLANTS "," GRID ",\"terrain\":", "", {{"size_m", "[99,99]"}}},
    {"`camera`",
     "keys[]",
     PLANTS "," GRID ",\"camera\":{\"kind\":\"still\",\"keys\":[",
     "]}",
     {{"eye", "[0,0,0]"}, {"target", "[0,0,1]"}}},
    {"`camera`",
     NULL,
     PLANTS "," GRID ",\"camera\":",
     "",
     {{"kind", "\"still\""}, {"keys", "[{\"eye\":[0,0,0],\"target\":[0,0,1]}]"}}},
    {"", "trees", PLANTS "," GRID ",\"trees\":", "", {{NULL}}},
    {"", "light", PLANTS "," GRID ",\"light\":", "", {{NULL}}},
    {"", "sky", PLANTS "," GRID ",\"sky\":", "", {{NULL}}},
    {"", "fog", PLANTS "," GRID ",\"fog\":", "", {{NULL}}},
};

/* A scene in which the key, a path as "import.leaf", holds a list in a list: a wrong type
 * everywhere. */
static const char *scene_with_wrong(struct arena *arena, const char *section, const char *key)
{
    const char *dot = strrchr(key, '.'), *last = dot ? dot + 1 : key;
    for (size_t k = 0; k < sizeof places / sizeof places[0]; k++) {
        const struct place *place = &places[k];
        size_t length = dot ? (size_t)(dot - key) : 0;
        if (!strstr(section, place->section) || !place->outer != !dot ||
            (dot && (strlen(place->outer) != length || memcmp(place->outer, key, length) != 0)))
            continue;
        const char *text = arena_printf(arena, "{%s{\"%s\":[[]]", place->before, last);
        for (int b = 0; b < 2 && place->beside[b][0]; b++)
            if (strcmp(place->beside[b][0], last) != 0)
                text = arena_printf(arena, "%s,\"%s\":%s", text, place->beside[b][0],
                                    place->beside[b][1]);
        return arena_printf(arena, "%s}%s}", text, place->after);
    }
    return arena_printf(arena, "{" PLANTS "," GRID ",\"%s\":[[]]}", key);
}

/* The other way: each key of the README's tables, given a wrong type, is an error about that type,
 * not about an unknown key. */
static void test_readme__names_no_key_that_the_loader_does_not_know(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    char *readme = NULL, *rest = NULL;
    size_t size = 0, keys_count = 0;
    const char *path = arena_printf(arena, "%s/scenes/README.md", data_folder()), *section = "";
    assert_int_equal(file_read(arena, path, 0, &readme, &size, NULL), STATUS_OK);
    for (char *line = strtok_r(strstr(readme, "## The file"), "\n", &rest); line;
         line = strtok_r(NULL, "\n", &rest)) {
        if (strncmp(line, "### ", 4) == 0)
            section = line;
        if (strncmp(line, "## A folder", 11) == 0)
            break; /* keys of cameras.json */
        if (strncmp(line, "| `", 3) != 0)
            continue;
        const char *key = arena_printf(arena, "%.*s", (int)strcspn(line + 3, "`"), line + 3);
        const char *last = strrchr(key, '.') ? strrchr(key, '.') + 1 : key;
        struct scene *scene = NULL;
        struct error error;
        load_text(arena, scene_with_wrong(arena, section, key), 1, 1, &scene, &error);
        if (!strstr(error.text, last) || strstr(error.text, "not a key") ||
            strstr(error.text, "is missing"))
            fail_msg("%s: '%s'", key, error.text);
        keys_count++;
    }
    assert_in_range(keys_count, 45, 100);
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_scene__a_short_file_loads_with_the_defaults_of_the_readme),
        cmocka_unit_test(test_scene__the_request_overrides_size_and_number),
        cmocka_unit_test(test_scene__no_tree_is_a_scene_without_species),
        cmocka_unit_test(test_scene__a_species_without_a_tree_is_left_out),
        cmocka_unit_test(test_scene__keys_in_extents_grow_with_the_forest_and_stand_on_the_ground),
        cmocka_unit_test(test_scene__a_bad_file_is_refused_with_file_key_value_and_allowance),
        cmocka_unit_test(test_scene__a_name_that_is_no_scene_is_told_the_nearest),
        cmocka_unit_test(test_hash__changes_with_all_that_can_change_a_picture),
        cmocka_unit_test(test_hash__does_not_change_with_anything_else),
        cmocka_unit_test(test_readme__has_every_key_of_the_loader),
        cmocka_unit_test(test_readme__names_no_key_that_the_loader_does_not_know),
    };
    return cmocka_run_group_tests(tests, folder_make, folder_remove);
}
