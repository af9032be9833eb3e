/* Boundaries of shadow volumes: kept while the sun stands still, counted by the stencil buffer. */
#include "bake/shadow_volume.h"
#include "bake/backdrop.h"
#include "bake/cull.h"
#include "bake/shadow_caster.h"
#include "bake/shadow_floor.h"
#include "bake/shadow_trees.h"
#include "base/clock.h"

#include "shadow_volume.glsl.h"

#include <string.h>

/* Walls, caps, caps of leaves: each a stretch of the index buffer, by caster. */
enum stretch { WALLS, CAPS, LEAF_CAPS, STRETCHES };

/* One tree, or the terrain. */
struct shadow_piece {
    const struct shadow_caster *caster;
    const struct instance *instance;           /* NULL: the terrain */
    uint32_t base;                             /* its first point */
    float center_m[3], radius_m;               /* of a sphere that holds it */
    float floor_m;                             /* its walls end there; NaN: at infinity */
    size_t first[STRETCHES], count[STRETCHES]; /* indices */
};

struct shadow_volume {
    struct shadow_volume_request request;
    size_t pieces_count, points_count;
    struct shadow_piece *pieces;
    struct shadow_floor *ground;
    float (*places_m)[3]; /* of points, in the world */
    GLuint program, vertices, points, indices;
    size_t room[STRETCHES], offset[STRETCHES]; /* indices that may come; begin in the buffer */
    size_t indices_room;                       /* of the buffer */
    uint32_t *lists[STRETCHES];
    float sun[3]; /* 0: none yet */
};

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
    if (status != STATUS_OK)
        return status;
    for (int s = 0; s < STRETCHES; s++)
        made->lists[s] = ARENA_ARRAY(workspace->arena, uint32_t, made->room[s]);
    made->ground = shadow_floor_create(workspace->arena, &scene->terrain);
    made->places_m = arena_alloc(workspace->arena, made->points_count, sizeof *made->places_m);
    place_points(made);
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

static void extrude(struct workspace *workspace, struct shadow_volume *volume,
                    const float sun_direction[3])
{
    memcpy(volume->sun, sun_direction, sizeof volume->sun);
    struct shadow_boundary boundary = {.walls = volume->lists[WALLS],
                                       .caps = volume->lists[CAPS],
                                       .leaf_caps = volume->lists[LEAF_CAPS]};
    const size_t *counts[STRETCHES] = {&boundary.walls_count, &boundary.caps_count,
                                       &boundary.leaf_caps_count};
    for (size_t p = 0; p < volume->pieces_count; p++) {
        struct shadow_piece *piece = &volume->pieces[p];
        float toward[3];
        toward_sun(piece->instance, sun_direction, toward);
        for (int s = 0; s < STRETCHES; s++)
            piece->first[s] = *counts[s];
        shadow_caster_extrude(piece->caster, toward, !volume->request.triangles, piece->base,
                              (uint32_t)volume->points_count, &boundary);
        for (int s = 0; s < STRETCHES; s++)
            piece->count[s] = *counts[s] - piece->first[s];
    }
    place_ends(workspace->gl, volume, sun_direction);
    upload_indices(workspace->gl, volume,
                   (size_t[]){boundary.walls_count, boundary.caps_count, boundary.leaf_caps_count});
}

void shadow_volume_extrude(struct workspace *workspace, struct shadow_volume *volume,
                           const float sun_direction[3])
{
    if (!workspace->counted && memcmp(volume->sun, sun_direction, sizeof volume->sun) == 0)
        return;
    double start = clock_wall_seconds();
    extrude(workspace, volume, sun_direction);
    if (!workspace->counted)
        return;
    workspace->gl->Finish();
    workspace->tally.shadow_seconds += clock_wall_seconds() - start;
    workspace->tally.shadow_bytes +=
        volume->indices_room * sizeof(uint32_t) + 2 * volume->points_count * sizeof(float[4]);
}

/* lim far -> infinity: clip z = clip w - 2 near for a point, and exactly clip w at infinity. */
void shadow_volume_view(struct view *view)
{
    for (int column = 0; column < 4; column++) {
        view->projection[column][2] = view->projection[column][3];
        view->view_projection[column][2] = view->view_projection[column][3];
    }
    view->projection[3][2] -= 2 * view->near_m;
    view->view_projection[3][2] -= 2 * view->near_m;
}

/* Whether a piece's volume may be seen: its sphere, swept away from the sun, is outside of no
 * plane. */
static bool is_seen(const struct shadow_piece *piece, float planes[6][4], const float sun[3],
                    bool endless)
{
    bool ended = !endless && !isnan(piece->floor_m);
    float length_m = ended ? (piece->center_m[1] + piece->radius_m - piece->floor_m) / sun[1] : 0;
    for (int i = 0; i < 4; i++) { /* near and far are no borders to a volume */
        const float *n = planes[i];
        float along = n[0] * sun[0] + n[1] * sun[1] + n[2] * sun[2];
        float at = n[0] * piece->center_m[0] + n[1] * piece->center_m[1] +
                   n[2] * piece->center_m[2] + n[3];
        bool leaves = along >= 0 || (ended && at - along * length_m < -1.001f * piece->radius_m);
        if (leaves && at < -1.001f * piece->radius_m)
            return false;
    }
    return true;
}

/* Whether the eye may be in a piece's volume: the piece's sphere is before the sun. */
static bool may_hold_eye(const struct shadow_piece *piece, const struct view *view,
                         const float sun[3])
{
    float along = 0, square = 0, reach_m = 1.001f * piece->radius_m + 2 * view->near_m;
    for (int axis = 0; axis < 3; axis++) {
        float offset = piece->center_m[axis] - view->eye_m[axis];
        along += offset * sun[axis];
        square += offset * offset;
    }
    return along > -reach_m && square - along * along < reach_m * reach_m;
}

static bool is_counted(const struct shadow_volume *volume, const struct shadow_piece *piece,
                       const struct view *view, float planes[6][4], bool z_fail, bool endless)
{
    enum shadow_test test = volume->request.test;
    bool fails =
        test == SHADOW_Z_FAIL ||
        (test == SHADOW_AUTO && (!piece->instance || may_hold_eye(piece, view, volume->sun)));
    return fails == z_fail && is_seen(piece, planes, volume->sun, endless);
}

/* A stretch of the pieces that are tested this way, neighbours in one call. base: of points, 0 or
 * points_count; then of their ends, of those that have some. */
static void draw_stretch(struct gl *gl, const struct shadow_volume *volume, const bool *counted,
                         enum stretch stretch, size_t base)
{
    size_t first = 0, count = 0;
    for (size_t p = 0; p <= volume->pieces_count; p++) {
        const struct shadow_piece *piece = &volume->pieces[p];
        if (p < volume->pieces_count && counted[p] && !(base && isnan(piece->floor_m))) {
            first = count ? first : piece->first[stretch];
            count += piece->count[stretch];
        } else if (count) {
            shadow_trees_indices(gl, volume->offset[stretch] + first, count, (uint32_t)base);
            count = 0;
        }
    }
}

/* Depths of a cap and of its own surface are interpolated along other corners and differ in the
 * last bits. */
static const float cap_units = 4;

/* A cap at its own surface's depth: a surface that the sun's side of the cap shows is without, what
 * faces away is within if it is bark, and without if it is a leaf. So back faces of leaves' caps
 * are the only ones that are before what is as deep. */
static void draw_boundaries(struct gl *gl, const struct shadow_volume *volume, const bool *counted,
                            bool z_fail)
{
    GLenum front = z_fail ? GL_DECR_WRAP : GL_INCR_WRAP,
           back = z_fail ? GL_INCR_WRAP : GL_DECR_WRAP;
    gl->StencilOpSeparate(GL_FRONT, GL_KEEP, z_fail ? front : GL_KEEP, z_fail ? GL_KEEP : front);
    gl->StencilOpSeparate(GL_BACK, GL_KEEP, z_fail ? back : GL_KEEP, z_fail ? GL_KEEP : back);
    draw_stretch(gl, volume, counted, WALLS, 0);
    gl->Enable(GL_POLYGON_OFFSET_FILL);
    gl->PolygonOffset(0, cap_units);
    if (z_fail) {
        draw_stretch(gl, volume, counted, CAPS, 0);
        gl->FrontFace(GL_CW); /* as the caps, but seen from without below */
        draw_stretch(gl, volume, counted, CAPS, volume->points_count);
        draw_stretch(gl, volume, counted, LEAF_CAPS, volume->points_count);
        gl->FrontFace(GL_CCW);
    }
    gl->Enable(GL_CULL_FACE);
    draw_stretch(gl, volume, counted, LEAF_CAPS, 0);
    gl->CullFace(GL_FRONT);
    gl->DepthFunc(GL_LEQUAL);
    gl->PolygonOffset(0, -cap_units);
    draw_stretch(gl, volume, counted, LEAF_CAPS, 0);
    gl->DepthFunc(GL_LESS);
    gl->CullFace(GL_BACK);
    gl->Disable(GL_CULL_FACE);
    gl->PolygonOffset(0, 0);
    gl->Disable(GL_POLYGON_OFFSET_FILL);
}

void shadow_volume_count(struct workspace *workspace, const struct shadow_volume *volume,
                         const struct view *view)
{
    struct gl *gl = workspace->gl;
    struct arena *passing = arena_create(0);
    bool *counted = ARENA_ARRAY(passing, bool, volume->pieces_count + 1);
    float planes[6][4];
    cull_planes(view, planes);
    gl->ClearStencil(0);
    gl->Clear(GL_STENCIL_BUFFER_BIT);
    gl->UseProgram(volume->program);
    gl->BindVertexArray(volume->vertices);
    gl->UniformMatrix4fv(gl_uniform(gl, volume->program, "view_projection"), 1, GL_FALSE,
                         view->view_projection[0]);
    gl->Uniform1i(gl_uniform(gl, volume->program, "points"), (GLint)volume->points_count);
    gl->Uniform3f(gl_uniform(gl, volume->program, "away"), -volume->sun[0], -volume->sun[1],
                  -volume->sun[2]);
    gl->ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    gl->DepthMask(GL_FALSE);
    gl->DepthFunc(GL_LESS);
    gl->Enable(GL_DEPTH_TEST);
    gl->Enable(GL_DEPTH_CLAMP);
    gl->Enable(GL_STENCIL_TEST);
    gl->StencilFunc(GL_ALWAYS, 0, 0xff);
    bool endless = !shadow_floor_is_below(volume->ground, view);
    gl->Uniform1i(gl_uniform(gl, volume->program, "endless"), endless);
    for (int z_fail = 0; z_fail < 2; z_fail++) {
        for (size_t p = 0; p < volume->pieces_count; p++)
            counted[p] = is_counted(volume, &volume->pieces[p], view, planes, z_fail, endless);
        draw_boundaries(gl, volume, counted, z_fail);
    }
    gl->Disable(GL_DEPTH_CLAMP);
    gl->DepthMask(GL_TRUE);
    gl->ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    gl->StencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
    gl->StencilFunc(GL_EQUAL, 0, 0xff);
    arena_destroy(passing);
}

void shadow_volume_end(struct workspace *workspace)
{
    struct gl *gl = workspace->gl;
    gl->StencilFunc(GL_ALWAYS, 0, 0xff);
    gl->Disable(GL_STENCIL_TEST);
}
