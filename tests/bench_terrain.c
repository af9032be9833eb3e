/* What levels of detail and the quadtree are worth on Perlin's noise, 40 km a side: frames of
 * `null` by OpenGL with every triangle and at three bounds, and of the CPU's backdrop.
 *
 *     bench_terrain [level [rounds [ways]]]      8 7 all
 *
 * level: 2^level quads a side, in as many octaves; ways: all, levels (not every triangle), cpu. A
 * line a way of drawing: seconds to prepare, median seconds a frame over the rounds, triangles, and
 * what the picture differs from the first line's. One way after the other. */
#include "bake/backdrop_cpu.h"
#include "base/clock.h"
#include "pictures.h"
#include "scene/relief.h"
#include "scene/terrain.h"
#include "stats/stats.h"

#include <stdio.h>

enum { WIDTH = 800, HEIGHT = 600, ROUNDS_MAX = 99, WAYS = 4, TILE = 32 };

static struct scene *bench_scene(struct arena *arena, int level)
{
    struct scene *scene = scene_by_hand(arena, WIDTH, HEIGHT);
    struct terrain *terrain = &scene->terrain;
    const uint32_t side = (1u << level) + 1;
    const double size_m[2] = {40000, 40000};
    const struct relief_noise noise = {{side, side}, 1500, 12000, level, 0.45, 4};
    terrain->heights_m = relief_perlin(arena, &noise, size_m);
    terrain->samples_x = terrain->samples_z = side;
    terrain->size_x_m = terrain->size_z_m = 40000;
    for (int i = 0; i < 3; i++)
        terrain->albedo[i] = 0.3f;
    terrain_normals(arena, terrain);
    scene->camera.far_m = 60000;
    scene->camera.near_m = 5;
    return scene;
}

/* From on high toward the middle, or low over the ground. */
static void bench_view(const struct scene *scene, int round, struct view *view)
{
    float eye[3] = {3000, 0, 12000 - 200.0f * (float)round}, target[3] = {0, 0, 0};
    eye[1] = terrain_height(&scene->terrain, eye[0], eye[2]) + (round % 2 ? 100 : 2500);
    view_look_at(scene, eye, target, view);
}

struct way {
    float detail_px;
    struct workspace workspace;
    struct gl *gl;
    const struct method *method;
    void *state;
    struct target target;
    double prepare_seconds, seconds[ROUNDS_MAX], triangles, square;
    float *rgba;
};

static void way_prepare(struct way *way, struct scene *scene)
{
    struct arena *arena = arena_create(0);
    struct error *error = ARENA_NEW(arena, struct error);
    void *options = NULL;
    scene->terrain.detail_px = way->detail_px;
    if (method_find("null", &way->method, error) != STATUS_OK ||
        gl_context_create(NULL, 2, &way->gl, error) != STATUS_OK)
        exit(1);
    way->workspace = (struct workspace){.arena = arena,
                                        .gl = way->gl,
                                        .error = error,
                                        .effects = EFFECT_AMBIENT,
                                        .format = TARGET_RGBA16F,
                                        .threads = 2};
    options = arena_alloc(arena, 1, way->method->options_size + 1);
    gl_target(way->gl, WIDTH, HEIGHT, TARGET_RGBA16F, &way->target, error);
    double start = clock_wall_seconds();
    if (way->method->prepare(&way->workspace, scene, options, &way->state) != STATUS_OK)
        fprintf(stderr, "%s\n", error->text);
    way->gl->Finish();
    way->prepare_seconds = clock_wall_seconds() - start;
    way->rgba = ARENA_ARRAY(arena, float, 4 * WIDTH * HEIGHT);
}

static void way_draw(struct way *way, struct scene *scene, int round)
{
    struct view view;
    bench_view(scene, round, &view);
    scene->terrain.detail_px = way->detail_px;
    gl_counters_reset(way->gl);
    double start = clock_wall_seconds();
    way->method->draw(&way->workspace, way->state, &view, &way->target);
    way->gl->Finish();
    way->seconds[round] = clock_wall_seconds() - start;
    way->triangles += (double)way->gl->counters.triangles;
}

static double rmse(const float *a, const float *b)
{
    double square = 0;
    for (int k = 0; k < 4 * WIDTH * HEIGHT; k++)
        square += ((double)a[k] - (double)b[k]) * ((double)a[k] - (double)b[k]);
    return sqrt(square / (3 * WIDTH * HEIGHT));
}

/* One way at a time, since contexts do not share a thread. */
static void bench_gl(struct scene *scene, int rounds, bool all)
{
    static const float bounds_px[WAYS] = {0, 0.5f, 1, 2};
    float *first = NULL;
    for (int w = all ? 0 : 1; w < WAYS; w++) {
        struct way way = {.detail_px = bounds_px[w]};
        way_prepare(&way, scene);
        way_draw(&way, scene, 0); /* warm */
        way.triangles = 0;
        for (int round = 0; round < rounds; round++)
            way_draw(&way, scene, round);
        gl_target_read(way.gl, &way.target, way.rgba);
        printf("gl   detail_px %-4g prepare %7.3f s  frame %9.3f ms  %10.0f triangles  RMSE %.4f  "
               "device %.0f MB\n",
               (double)way.detail_px, way.prepare_seconds,
               1e3 * stats_median(way.seconds, (size_t)rounds), way.triangles / rounds,
               first ? rmse(first, way.rgba) : 0, 1e-6 * (double)gl_device_bytes(way.gl));
        fflush(stdout);
        if (!first) {
            first = malloc(sizeof(float) * 4 * WIDTH * HEIGHT);
            memcpy(first, way.rgba, sizeof(float) * 4 * WIDTH * HEIGHT);
        }
        gl_context_destroy(way.gl);
        arena_destroy(way.workspace.arena);
    }
    free(first);
}

static void bench_cpu(struct scene *scene, int rounds)
{
    struct arena *arena = arena_create(0);
    struct workspace workspace = {.arena = arena, .effects = EFFECT_AMBIENT, .threads = 2};
    struct backdrop_cpu *backdrop = NULL;
    float *depths_m = ARENA_ARRAY(arena, float, WIDTH *HEIGHT);
    float(*rgb)[3] = arena_alloc(arena, (size_t)WIDTH * HEIGHT, sizeof *rgb);
    double seconds[ROUNDS_MAX], start = clock_wall_seconds();
    backdrop_cpu_prepare(&workspace, scene, &backdrop);
    double prepare_seconds = clock_wall_seconds() - start;
    const int across = WIDTH / TILE, down = (HEIGHT + TILE - 1) / TILE;
    for (int round = -1; round < rounds; round++) {
        struct view view;
        bench_view(scene, round < 0 ? 0 : round, &view);
        start = clock_wall_seconds();
        backdrop_cpu_begin(&workspace, backdrop, &view);
#pragma omp parallel for schedule(dynamic, 4) num_threads(2)
        for (int t = 0; t < across * down; t++) {
            int x = t % across * TILE, y = t / across * TILE;
            struct backdrop_tile tile = {x,
                                         y,
                                         TILE,
                                         y + TILE < HEIGHT ? TILE : HEIGHT - y,
                                         WIDTH,
                                         depths_m + y * WIDTH + x,
                                         rgb + y * WIDTH + x,
                                         NULL};
            backdrop_cpu_tile(backdrop, &tile);
        }
        seconds[round < 0 ? 0 : round] = clock_wall_seconds() - start;
    }
    printf("cpu                prepare %7.3f s  frame %9.3f ms\n", prepare_seconds,
           1e3 * stats_median(seconds, (size_t)rounds));
    arena_destroy(arena);
}

int main(int count, char **arguments)
{
    int level = count > 1 ? atoi(arguments[1]) : 8;
    int rounds = count > 2 ? atoi(arguments[2]) : 7;
    const char *ways = count > 3 ? arguments[3] : "all";
    rounds = rounds < 1 ? 1 : rounds > ROUNDS_MAX ? ROUNDS_MAX : rounds;
    struct arena *arena = arena_create(0);
    struct scene *scene = bench_scene(arena, level);
    printf("%u x %u samples\n", scene->terrain.samples_x, scene->terrain.samples_z);
    bench_cpu(scene, rounds);
    if (strcmp(ways, "cpu") != 0)
        bench_gl(scene, rounds, strcmp(ways, "all") == 0);
    arena_destroy(arena);
    return 0;
}
