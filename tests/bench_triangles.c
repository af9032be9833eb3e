/* Triangles a second of the polygons method beside what the driver can do: the same mesh drawn
 * bare with as many samples a pixel, and culled by the frustum, in turns.
 *
 * Beyond 200 million triangles the bare draws are left out.
 *
 *     bench_triangles [scene [trees [lod [rounds [method options]]]]]      poplar-forest 100 high 9
 */
#include "bake/sampling.h"
#include "base/arena.h"
#include "base/clock.h"
#include "method/method.h"
#include "stats/stats.h"
#include "wall/simplify.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS_LIMIT = 99, CONTENDERS = 4 };
enum { POLYGONS, NOTHING, BARE, OUTSIDE };
static const char *const names[CONTENDERS] = {"polygons", "null", "bare", "outside"};

static const char bare_glsl[] = "#pragma stage vertex\n"
                                "layout(location = 0) in vec3 position;\n"
                                "layout(location = 1) in vec4 place;\n" /* foot; scale */
                                "layout(location = 2) in vec2 way;\n"   /* cosine, sine */
                                "uniform vec3 aside;\n"
                                "void main()\n"
                                "{\n"
                                "    vec3 at = rotate_y(position, way.x, way.y) * place.w;\n"
                                "    gl_Position = view_projection * vec4(place.xyz + at, 1.0);\n"
                                "    gl_Position.xyz += aside * gl_Position.w;\n"
                                "}\n"
                                "#pragma stage fragment\n"
                                "layout(location = 0) out vec4 color;\n"
                                "void main()\n"
                                "{\n"
                                "    color = vec4(1.0);\n"
                                "}\n";

struct bench {
    struct arena *arena;
    struct gl *gl;
    const struct scene *scene;
    struct view view;
    struct target target;
    struct workspace workspace;
    void *states[2]; /* of polygons and null */
    const struct method *methods[2];
    GLuint program;
    struct sampling *sampling; /* of the bare draws */
    size_t species_count;
    struct bare { /* a species */
        GLuint array;
        size_t corners, trees;
    } * bare;
    uint64_t triangles[CONTENDERS];
};

static enum status open_method(struct bench *bench, int which, const char *text,
                               struct error *error)
{
    const struct method **method = &bench->methods[which];
    enum status status = method_find(names[which], method, error);
    void *options = status ? NULL : arena_alloc(bench->arena, 1, (*method)->options_size);
    if (!status && (*method)->options) {
        options_default((*method)->options, options);
        status = options_parse((*method)->options, text, options, error);
    }
    bench->workspace.effects = bench->scene->effects & (*method)->traits;
    if (!status)
        status =
            (*method)->prepare(&bench->workspace, bench->scene, options, &bench->states[which]);
    return status;
}

/* One vertex and index buffer a species, its trees as instances in the order of the scene. */
static enum status open_bare(struct bench *bench, uint32_t species, struct error *error)
{
    struct gl *gl = bench->gl;
    struct bare *bare = &bench->bare[species];
    const struct scene *scene = bench->scene;
    const struct mesh *mesh;
    enum status status = plant_mesh(scene->species[species].plant, &mesh, error);
    if (status)
        return status;
    float(*placed)[6] = arena_alloc(bench->arena, scene->instances_count, sizeof *placed);
    for (size_t i = 0; i < scene->instances_count; i++) {
        const struct instance *tree = &scene->instances[i];
        if (tree->species != species)
            continue;
        float *to = placed[bare->trees++];
        memcpy(to, tree->position_m, 3 * sizeof *to);
        to[3] = tree->scale;
        to[4] = cosf(tree->rotation_rad);
        to[5] = sinf(tree->rotation_rad);
    }
    bare->corners = 3 * mesh->triangles_count;
    uint32_t *indices = ARENA_ARRAY(bench->arena, uint32_t, bare->corners);
    memcpy(indices, mesh->triangles, bare->corners * sizeof *indices);
    simplify_order(indices, bare->corners, mesh->vertices_count);
    bare->array = gl_vertex_array(gl);
    GLuint positions = gl_buffer(gl, (GLsizeiptr)(mesh->vertices_count * 12), mesh->positions, 0);
    GLuint places = gl_buffer(gl, (GLsizeiptr)(bare->trees * sizeof *placed), placed, 0);
    gl->VertexArrayVertexBuffer(bare->array, 0, positions, 0, 12);
    gl->VertexArrayVertexBuffer(bare->array, 1, places, 0, sizeof *placed);
    gl->VertexArrayBindingDivisor(bare->array, 1, 1);
    for (GLuint i = 0; i < 3; i++) {
        gl->VertexArrayAttribFormat(bare->array, i,
                                    i == 0   ? 3
                                    : i == 1 ? 4
                                             : 2,
                                    GL_FLOAT, GL_FALSE, i == 2 ? 16 : 0);
        gl->VertexArrayAttribBinding(bare->array, i, i > 0);
        gl->EnableVertexArrayAttrib(bare->array, i);
    }
    gl->VertexArrayElementBuffer(
        bare->array, gl_buffer(gl, (GLsizeiptr)(bare->corners * sizeof *indices), indices, 0));
    return STATUS_OK;
}

static void draw_bare(struct bench *bench, bool outside)
{
    struct gl *gl = bench->gl;
    struct view drawn;
    sampling_begin(&bench->workspace, bench->sampling, &bench->target, &bench->view, &drawn);
    gl->Viewport(0, 0, drawn.width_px, drawn.height_px);
    gl->Enable(GL_DEPTH_TEST);
    gl->DepthMask(GL_TRUE);
    gl->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    gl->UseProgram(bench->program);
    gl->UniformMatrix4fv(gl_uniform(gl, bench->program, "view_projection"), 1, GL_FALSE,
                         bench->view.view_projection[0]);
    gl->Uniform3f(gl_uniform(gl, bench->program, "aside"), outside ? 9 : 0, 0, 0);
    for (size_t s = 0; s < bench->species_count; s++) {
        gl->BindVertexArray(bench->bare[s].array);
        gl_draw_elements(gl, GL_TRIANGLES, (GLsizei)bench->bare[s].corners, GL_UNSIGNED_INT, 0,
                         (GLsizei)bench->bare[s].trees, 0, 0);
    }
    sampling_end(&bench->workspace, bench->sampling, &bench->target);
}

/* Seconds of one frame. */
static double frame(struct bench *bench, int contender)
{
    bench->gl->Finish();
    gl_counters_reset(bench->gl);
    double start = clock_wall_seconds();
    if (contender == BARE || contender == OUTSIDE)
        draw_bare(bench, contender == OUTSIDE);
    else
        bench->methods[contender]->draw(&bench->workspace, bench->states[contender], &bench->view,
                                        &bench->target);
    bench->gl->Finish();
    double seconds = clock_wall_seconds() - start;
    bench->triangles[contender] = bench->gl->counters.triangles;
    return seconds;
}

/* Contenders in turns, there and back; null's time, the backdrop, is taken off polygons. */
static void measure(struct bench *bench, int rounds)
{
    static double seconds[CONTENDERS][ROUNDS_LIMIT];
    double whole = 0;
    for (size_t s = 0; s < bench->species_count; s++)
        whole += (double)bench->bare[s].corners / 3 * (double)bench->bare[s].trees;
    int contenders = whole > 2e8 ? BARE : CONTENDERS;
    for (int round = -1; round < rounds; round++)
        for (int i = 0; i < contenders; i++) {
            int contender = round & 1 ? contenders - 1 - i : i;
            double took = frame(bench, contender);
            if (round >= 0)
                seconds[contender][round] = took;
        }
    double trees[ROUNDS_LIMIT];
    for (int c = 0; c < contenders; c++) {
        struct interval s = stats_median_interval(seconds[c], (size_t)rounds, 1);
        printf("%-9s %8.2f ms [%.2f, %.2f] %9llu triangles, %6.2f million/s\n", names[c],
               1e3 * s.value, 1e3 * s.low, 1e3 * s.high, (unsigned long long)bench->triangles[c],
               (double)bench->triangles[c] / s.value / 1e6);
    }
    if (contenders < CONTENDERS)
        return;
    for (int i = 0; i < rounds; i++)
        trees[i] = seconds[POLYGONS][i] - seconds[NOTHING][i];
    struct interval ratio = stats_ratio_interval(trees, seconds[BARE], (size_t)rounds, 1);
    printf("trees of polygons / bare draw of all %.0f triangles: %.3f [%.3f, %.3f]\n", whole,
           ratio.value, ratio.low, ratio.high);
}

static enum status run(struct bench *bench, int argc, char **argv, struct error *error)
{
    struct scene_request request = {.trees = argc > 2 ? strtoul(argv[2], NULL, 10) : 100};
    int rounds = argc > 4 ? atoi(argv[4]) : 9;
    struct scene *scene;
    if (rounds < 1 || rounds > ROUNDS_LIMIT)
        return error_set(error, STATUS_USAGE, "rounds: %d is outside 1..%d", rounds, ROUNDS_LIMIT);
    bench->workspace = (struct workspace){.arena = bench->arena,
                                          .error = error,
                                          .lod = LOD_HIGH,
                                          .format = TARGET_RGBA16F,
                                          .threads = clock_cpu_count(),
                                          .seed = 1};
    if (argc > 3 && !lod_from_word(argv[3], &bench->workspace.lod))
        return error_set(error, STATUS_USAGE, "lod: no level '%s'", argv[3]);
    enum status status =
        scene_load(bench->arena, argc > 1 ? argv[1] : "poplar-forest", &request, &scene, error);
    bench->scene = scene;
    if (!status)
        status = gl_context_create(NULL, 0, &bench->gl, error);
    if (status)
        return status;
    bench->workspace.gl = bench->gl;
    view_at(scene, 0, &bench->view);
    status = gl_target(bench->gl, bench->view.width_px, bench->view.height_px, TARGET_RGBA16F,
                       &bench->target, error);
    for (int m = 0; m < 2 && !status; m++)
        status = open_method(bench, m, argc > 5 && m == POLYGONS ? argv[5] : NULL, error);
    const char *samples = argc > 5 ? strstr(argv[5], "samples=") : NULL;
    if (!status)
        status = sampling_prepare(
            &bench->workspace, samples ? atoi(samples + strlen("samples=")) : 1, &bench->sampling);
    bench->species_count = scene->species_count;
    bench->bare = ARENA_ARRAY(bench->arena, struct bare, scene->species_count);
    for (uint32_t s = 0; s < scene->species_count && !status; s++)
        status = open_bare(bench, s, error);
    if (!status)
        status = gl_program(bench->gl, "bare", bare_glsl, NULL, &bench->program, error);
    if (status)
        return status;
    printf("%s, %zu trees, %d x %d px, %s\n", scene->name, scene->instances_count,
           bench->view.width_px, bench->view.height_px, bench->gl->renderer);
    measure(bench, rounds);
    return gl_check(bench->gl, "bench", error);
}

int main(int argc, char **argv)
{
    struct error error = {0};
    struct bench bench = {.arena = arena_create(0)};
    enum status status = run(&bench, argc, argv, &error);
    if (bench.gl)
        gl_context_destroy(bench.gl);
    arena_destroy(bench.arena);
    if (status)
        fprintf(stderr, "%s\n", error.text);
    return status;
}
