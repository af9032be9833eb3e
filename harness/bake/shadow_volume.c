/* Boundaries of shadow volumes, kept while the sun stands still. */
#include "bake/shadow_volume_parts.h"
#include "base/clock.h"

#include "shadow_volume.glsl.h"

#include <string.h>

static void add_piece(struct shadow_volume *volume, const struct shadow_caster *caster,
                      const struct instance *instance)
{
    struct shadow_piece *piece = &volume->pieces[volume->pieces_count++];
    piece->caster = caster;
    piece->instance = instance;
    piece->base = (uint32_t)volume->points_count;
    volume->points_count += caster->points_count;
    for (int s = 0; s < STRETCHES; s++)
        volume->room[s] += shadow_caster_room(caster) / (s == WALLS ? 1 : 6);
}

/* Points of all casters, and a sphere about each caster. */
static void place_points(struct shadow_volume *volume)
{
    for (size_t p = 0; p < volume->pieces_count; p++) {
        struct shadow_piece *piece = &volume->pieces[p];
        const struct shadow_caster *caster = piece->caster;
        float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
        for (size_t i = 0; i < caster->points_count; i++) {
            float *place = volume->places_m[piece->base + i];
            if (piece->instance)
                shadow_trees_place(piece->instance, caster->points[i], place);
            else
                memcpy(place, caster->points[i], sizeof caster->points[i]);
            for (int axis = 0; axis < 3; axis++) {
                low[axis] = fminf(low[axis], place[axis]);
                high[axis] = fmaxf(high[axis], place[axis]);
            }
        }
        float square = 0;
        for (int axis = 0; axis < 3; axis++) {
            piece->center_m[axis] = 0.5f * (low[axis] + high[axis]);
            square += (high[axis] - low[axis]) * (high[axis] - low[axis]);
        }
        piece->radius_m = 0.5001f * sqrtf(square);
    }
}

/* Where volumes begin behind what casts: never closer than floats of such places tell. */
static void place_behind(struct shadow_volume *volume)
{
    const struct shadow_volume_request *request = &volume->request;
    float largest_m = 0, radius_m = 0;
    if (!(request->behind_px > 0 || request->behind_radii > 0))
        return;
    for (size_t p = 0; p < volume->pieces_count; p++) {
        const struct shadow_piece *piece = &volume->pieces[p];
        for (int axis = 0; axis < 3; axis++)
            largest_m = fmaxf(largest_m, fabsf(piece->center_m[axis]) + piece->radius_m);
        if (piece->instance)
            radius_m = fmaxf(radius_m, piece->radius_m);
    }
    volume->behind_m = fmaxf(0x1p-20f * largest_m, request->behind_radii * radius_m);
}

/* Room for points, as they are, and for their ends. */
static void upload_points(struct gl *gl, struct shadow_volume *volume)
{
    size_t bytes = 2 * volume->points_count * sizeof(float[4]);
    struct arena *passing = arena_create(0);
    float(*points)[4] = arena_alloc(passing, 2 * volume->points_count, sizeof *points);
    for (size_t i = 0; i < volume->points_count; i++) {
        memcpy(points[i], volume->places_m[i], sizeof volume->places_m[i]);
        points[i][3] = 1;
    }
    volume->points = gl_buffer(gl, (GLsizeiptr)bytes, points, GL_DYNAMIC_STORAGE_BIT);
    arena_destroy(passing);
}

static enum status find_casters(struct workspace *workspace, const struct scene *scene,
                                struct shadow_volume *volume)
{
    struct arena *arena = workspace->arena;
    struct shadow_caster *casters =
        ARENA_ARRAY(arena, struct shadow_caster, scene->species_count + 1);
    const struct mesh *mesh = NULL;
    volume->pieces = ARENA_ARRAY(arena, struct shadow_piece, scene->instances_count + 1);
    for (size_t s = 0; s < scene->species_count; s++) {
        enum status status = plant_mesh(scene->species[s].plant, &mesh, workspace->error);
        if (status != STATUS_OK)
            return status;
        shadow_caster_build(arena, mesh, false, &casters[s]);
    }
    for (size_t i = 0; i < scene->instances_count; i++)
        add_piece(volume, &casters[scene->instances[i].species], &scene->instances[i]);
    mesh = volume->request.trees_alone ? NULL : terrain_mesh(arena, &scene->terrain);
    if (mesh) {
        shadow_caster_build(arena, mesh, true, &casters[scene->species_count]);
        add_piece(volume, &casters[scene->species_count], NULL);
    }
    return STATUS_OK;
}

enum status shadow_volume_prepare(struct workspace *workspace, const struct scene *scene,
                                  const struct shadow_volume_request *request,
                                  struct shadow_volume **volume)
{
    struct gl *gl = workspace->gl;
    struct shadow_volume *made = *volume = ARENA_NEW(workspace->arena, struct shadow_volume);
    made->request = *request;
    enum status status = find_casters(workspace, scene, made);
    if (status == STATUS_OK)
        status = gl_program(gl, "shadow volume", shadow_volume_glsl, NULL, &made->program,
                            workspace->error);
    if (status == STATUS_OK)
        status = gl_program(gl, "all of the picture", shadow_volume_glsl, "WHOLE 1",
                            &made->whole_program, workspace->error);
    if (status != STATUS_OK)
        return status;
    for (int s = 0; s < STRETCHES; s++)
        made->lists[s] = ARENA_ARRAY(workspace->arena, uint32_t, made->room[s]);
    made->ground = shadow_floor_create(workspace->arena, &scene->terrain);
    made->places_m = arena_alloc(workspace->arena, made->points_count, sizeof *made->places_m);
    place_points(made);
    place_behind(made);
    upload_points(gl, made);
    made->vertices = gl_vertex_array(gl);
    gl->VertexArrayVertexBuffer(made->vertices, 0, made->points, 0, sizeof(float[4]));
    gl->VertexArrayAttribFormat(made->vertices, 0, 4, GL_FLOAT, GL_FALSE, 0);
    gl->VertexArrayAttribBinding(made->vertices, 0, 0);
    gl->EnableVertexArrayAttrib(made->vertices, 0);
    return gl_check(gl, "shadow volume", workspace->error);
}

/* The sun as the instance's plant sees it: not unit, which no side minds. */
static void toward_sun(const struct instance *instance, const float sun[3], float toward[3])
{
    memcpy(toward, sun, 3 * sizeof *toward);
    if (!instance)
        return;
    float c = cosf(instance->rotation_rad), s = sinf(instance->rotation_rad);
    toward[0] = sun[0] * c - sun[2] * s;
    toward[1] = sun[1] / instance->stretch;
    toward[2] = sun[0] * s + sun[2] * c;
}

static void upload_indices(struct gl *gl, struct shadow_volume *volume, const size_t counts[])
{
    size_t all = counts[WALLS] + counts[CAPS] + counts[LEAF_CAPS];
    if (all > volume->indices_room || !volume->indices) {
        gl_delete_buffer(gl, volume->indices);
        volume->indices_room = all + all / 4;
        volume->indices = gl_buffer(gl, (GLsizeiptr)(volume->indices_room * sizeof(uint32_t)), NULL,
                                    GL_DYNAMIC_STORAGE_BIT);
        gl->VertexArrayElementBuffer(volume->vertices, volume->indices);
    }
    size_t offset = 0;
    for (int s = 0; s < STRETCHES; s++) {
        volume->offset[s] = offset;
        gl->NamedBufferSubData(volume->indices, (GLintptr)(offset * sizeof(uint32_t)),
                               (GLsizeiptr)(counts[s] * sizeof(uint32_t)), volume->lists[s]);
        offset += counts[s];
    }
}

/* Where the rays of the sun through each point end: at the piece's floor, or at infinity. */
static void place_ends(struct gl *gl, struct shadow_volume *volume, const float sun[3])
{
    size_t bytes = volume->points_count * sizeof(float[4]);
    struct arena *passing = arena_create(0);
    float(*ends)[4] = arena_alloc(passing, volume->points_count, sizeof *ends);
    for (size_t p = 0; p < volume->pieces_count; p++) {
        struct shadow_piece *piece = &volume->pieces[p];
        size_t last = piece->base + piece->caster->points_count;
        piece->floor_m =
            piece->instance ? shadow_floor_of(volume->ground, piece->center_m, piece->radius_m, sun)
                            : NAN;
        for (size_t i = piece->base; i < last; i++) {
            const float *place = volume->places_m[i];
            bool ended = !isnan(piece->floor_m);
            float along_m = ended ? fmaxf(0, place[1] - piece->floor_m) / sun[1] : 0;
            for (int axis = 0; axis < 3; axis++)
                ends[i][axis] = ended ? place[axis] - along_m * sun[axis] : -sun[axis];
            ends[i][3] = ended;
        }
    }
    gl->NamedBufferSubData(volume->points, (GLintptr)bytes, (GLsizeiptr)bytes, ends);
    arena_destroy(passing);
}

/* Whether a piece's shadow, its sphere swept away from the sun, comes as near to the eye as
 * radius_m. */
static bool comes_near(const struct shadow_piece *piece, const float sun[3], const float eye_m[3],
                       float radius_m)
{
    float along_m = 0, square = 0, reach_m = radius_m + 1.001f * piece->radius_m;
    float length_m = isnan(piece->floor_m)
                         ? INFINITY
                         : (piece->center_m[1] + piece->radius_m - piece->floor_m) / sun[1];
    for (int axis = 0; axis < 3; axis++)
        along_m += (piece->center_m[axis] - eye_m[axis]) * sun[axis];
    along_m = fminf(fmaxf(along_m, 0), length_m);
    for (int axis = 0; axis < 3; axis++) {
        float away_m = piece->center_m[axis] - along_m * sun[axis] - eye_m[axis];
        square += away_m * away_m;
    }
    return square <= reach_m * reach_m;
}

/* Boundaries of all pieces whose shadows come so near. */
static void extrude(struct workspace *workspace, struct shadow_volume *volume, const float eye_m[3],
                    float radius_m)
{
    struct shadow_boundary boundary = {.walls = volume->lists[WALLS],
                                       .caps = volume->lists[CAPS],
                                       .leaf_caps = volume->lists[LEAF_CAPS]};
    const size_t *counts[STRETCHES] = {&boundary.walls_count, &boundary.caps_count,
                                       &boundary.leaf_caps_count};
    for (size_t p = 0; p < volume->pieces_count; p++)
        volume->pieces[p].extruded = comes_near(&volume->pieces[p], volume->sun, eye_m, radius_m);
    for (int half = 0; half < HALVES; half++)
        for (size_t p = 0; p < volume->pieces_count; p++) {
            struct shadow_piece *piece = &volume->pieces[p];
            struct shadow_extrusion extrusion = {.silhouette = !volume->request.triangles,
                                                 .half = half,
                                                 .base = piece->base,
                                                 .ends = (uint32_t)volume->points_count};
            toward_sun(piece->instance, volume->sun, extrusion.toward);
            for (int s = 0; s < STRETCHES; s++)
                piece->first[half][s] = *counts[s];
            if (piece->extruded)
                shadow_caster_extrude(piece->caster, &extrusion, &boundary);
            for (int s = 0; s < STRETCHES; s++)
                piece->count[half][s] = *counts[s] - piece->first[half][s];
        }
    upload_indices(workspace->gl, volume,
                   (size_t[]){boundary.walls_count, boundary.caps_count, boundary.leaf_caps_count});
}

/* The sun's new place; true where no piece has boundaries for it yet. */
static bool turn(struct gl *gl, struct shadow_volume *volume, const float sun_direction[3])
{
    if (memcmp(volume->sun, sun_direction, sizeof volume->sun) == 0)
        return false;
    memcpy(volume->sun, sun_direction, sizeof volume->sun);
    place_ends(gl, volume, sun_direction);
    return true;
}

/* How far from the eye a sample of the view may be that is no deeper than deep_m. */
static float zone_radius(const struct view *view, float deep_m)
{
    float up = tanf(0.5f * view->fov_y_rad);
    float right = up * (float)view->width_px / (float)view->height_px;
    return deep_m * sqrtf(1 + up * up + right * right);
}

void shadow_volume_extrude(struct workspace *workspace, struct shadow_volume *volume,
                           const struct view *view, float deep_m)
{
    static const float margin = 1.25f; /* for the eye to move in */
    const float radius_m = zone_radius(view, deep_m);
    double start = clock_wall_seconds();
    if (workspace->counted)
        memset(volume->sun, 0, sizeof volume->sun);
    bool lacks = turn(workspace->gl, volume, view->sun_direction);
    for (size_t p = 0; p < volume->pieces_count && !lacks; p++)
        lacks = !volume->pieces[p].extruded &&
                comes_near(&volume->pieces[p], volume->sun, view->eye_m, radius_m);
    if (!lacks)
        return;
    extrude(workspace, volume, view->eye_m, margin * radius_m);
    if (!workspace->counted)
        return;
    workspace->gl->Finish();
    workspace->tally.shadow_seconds += clock_wall_seconds() - start;
    workspace->tally.shadow_bytes +=
        volume->indices_room * sizeof(uint32_t) + 2 * volume->points_count * sizeof(float[4]);
}
