/* scene.json: terrain. */
#include "scene/describe.h"

#include <string.h>

static const double REQUIRED = (double)NAN;

void describe_refuse(struct json *object, const char *key, const char *kinds)
{
    if (json_has(object, key))
        json_fail(object, key, "means nothing to this kind; allowed: with %s", kinds);
}

static void describe_relief(struct json *terrain, struct ground *ground)
{
    struct json *relief = json_object(terrain, "relief");
    if (!relief)
        return;
    ground->level = (int)json_integer(relief, "level", 0, 1, RELIEF_LEVEL_MAX);
    ground->spike_m = json_number(relief, "spike_m", REQUIRED, 0, 10000);
    ground->seed = (uint64_t)json_integer(relief, "seed", 1, 0, 1000000);
}

static void describe_noise(struct json *terrain, struct ground *ground)
{
    struct json *object = json_object(terrain, "perlin");
    struct relief_noise *noise = &ground->noise;
    if (!object)
        return;
    float samples[2] = {101, 101};
    json_vector(object, "samples", samples, 2, 2, TERRAIN_SAMPLES_MAX);
    for (int k = 0; k < 2; k++) {
        noise->samples[k] = (uint32_t)samples[k];
        if (samples[k] != (float)noise->samples[k])
            json_fail(object, "samples", "value is %g; allowed: whole numbers", (double)samples[k]);
    }
    noise->height_m = json_number(object, "height_m", REQUIRED, 0, 10000);
    noise->period_m = json_number(object, "period_m", REQUIRED, 0.01, 1e6);
    noise->octaves = (int)json_integer(object, "octaves", 6, 1, 16);
    noise->gain = json_number(object, "gain", 0.5, 0, 1);
    noise->seed = (uint64_t)json_integer(object, "seed", 1, 0, 1000000);
}

void describe_ground(struct arena *arena, struct json *root, struct description *description)
{
    struct ground *ground = &description->ground;
    struct json *terrain = json_object(root, "terrain");
    if (!terrain)
        return;
    float size_m[2] = {0, 0};
    ground->given = true;
    if (!json_vector(terrain, "size_m", size_m, 2, 1, 1e6))
        json_fail(terrain, "size_m", "is missing; allowed: [x, z] in 1..1e6");
    ground->size_m[0] = (double)size_m[0];
    ground->size_m[1] = (double)size_m[1];
    ground->image = describe_path(arena, description->path, json_text(terrain, "image", NULL));
    ground->height_m = json_number(terrain, "height_m", ground->image ? REQUIRED : 0, 0, 10000);
    if (!ground->image)
        describe_refuse(terrain, "height_m", "an image");
    describe_relief(terrain, ground);
    describe_noise(terrain, ground);
    if (ground->image && ground->level)
        json_fail(terrain, "relief", "stands beside an image; allowed: one of them");
    if (ground->noise.samples[0] && (ground->image || ground->level))
        json_fail(terrain, "perlin", "stands beside %s; allowed: one of them",
                  ground->image ? "an image" : "a relief");
    ground->detail_px = (float)json_number(terrain, "detail_px", -1, 0, 16);
    ground->color = describe_path(arena, description->path, json_text(terrain, "color", NULL));
    float albedo[3] = {0.06f, 0.08f, 0.032f}, white[3] = {1, 1, 1};
    memcpy(ground->albedo, ground->color ? white : albedo, sizeof albedo);
    json_vector(terrain, "albedo", ground->albedo, 3, 0, 1);
}
