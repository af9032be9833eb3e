/* Shadow volumes counted by the stencil buffer.
 *
 * Eight bits hold no more than 255, and a forest's leaves shade each other more often. Counts wrap,
 * both ways, so that order does not matter; but a sample within as many volumes as they wrap at
 * would be taken for lit. So what casts is counted in two halves, each modulo 128, and the eighth
 * bit keeps that the first half's count was not 0: lit by mistake is only what is within multiples
 * of 128 volumes of both. */
#include "bake/cull.h"
#include "bake/shadow_volume_parts.h"

enum { COUNT_BITS = 0x7f, KEPT_BIT = 0x80 };

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

/* Planes that a volume must come within to be seen: the four sides of the view, and the end of the
 * depths that are asked for. Near and far are no borders to a volume. */
enum { SIDES = 4, PLANES = 5 };

static void planes_of(const struct view *view, float deep_m, float planes[6][4])
{
    cull_planes(view, planes);
    float *end = planes[SIDES], eye = 0;
    for (int axis = 0; axis < 3; axis++) {
        end[axis] = -view->forward[axis];
        eye += view->forward[axis] * view->eye_m[axis];
    }
    end[3] = eye + deep_m; /* an infinite one excludes nothing */
}

/* Whether a piece's volume may be seen: its sphere, swept away from the sun, is outside of no
 * plane. */
static bool is_seen(const struct shadow_piece *piece, float planes[6][4], const float sun[3],
                    bool endless)
{
    bool ended = !endless && !isnan(piece->floor_m);
    float length_m = ended ? (piece->center_m[1] + piece->radius_m - piece->floor_m) / sun[1] : 0;
    for (int i = 0; i < PLANES; i++) {
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

/* What is being counted. */
struct tally {
    const struct shadow_volume *volume;
    int half;
    bool z_fail;
    bool *counted; /* a piece: it is tested this way */
};

/* A stretch of the pieces that are tested this way, neighbours in one call. base: of points, 0 or
 * points_count; then of their ends, of those that have some. */
static void draw_stretch(struct gl *gl, const struct tally *tally, enum stretch stretch,
                         size_t base)
{
    const struct shadow_volume *volume = tally->volume;
    size_t first = 0, count = 0;
    for (size_t p = 0; p <= volume->pieces_count; p++) {
        const struct shadow_piece *piece = &volume->pieces[p];
        if (p < volume->pieces_count && tally->counted[p] && !(base && isnan(piece->floor_m))) {
            first = count ? first : piece->first[tally->half][stretch];
            count += piece->count[tally->half][stretch];
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
static void draw_boundaries(struct gl *gl, const struct tally *tally)
{
    bool z_fail = tally->z_fail;
    size_t ends = tally->volume->points_count;
    GLenum front = z_fail ? GL_DECR_WRAP : GL_INCR_WRAP,
           back = z_fail ? GL_INCR_WRAP : GL_DECR_WRAP;
    gl->StencilOpSeparate(GL_FRONT, GL_KEEP, z_fail ? front : GL_KEEP, z_fail ? GL_KEEP : front);
    gl->StencilOpSeparate(GL_BACK, GL_KEEP, z_fail ? back : GL_KEEP, z_fail ? GL_KEEP : back);
    draw_stretch(gl, tally, WALLS, 0);
    gl->Enable(GL_POLYGON_OFFSET_FILL);
    gl->PolygonOffset(0, cap_units);
    if (z_fail) {
        draw_stretch(gl, tally, CAPS, 0);
        gl->FrontFace(GL_CW); /* as the caps, but seen from without below */
        draw_stretch(gl, tally, CAPS, ends);
        draw_stretch(gl, tally, LEAF_CAPS, ends);
        gl->FrontFace(GL_CCW);
    }
    gl->Enable(GL_CULL_FACE);
    draw_stretch(gl, tally, LEAF_CAPS, 0);
    gl->CullFace(GL_FRONT);
    gl->DepthFunc(GL_LEQUAL);
    gl->PolygonOffset(0, -cap_units);
    draw_stretch(gl, tally, LEAF_CAPS, 0);
    gl->DepthFunc(GL_LESS);
    gl->CullFace(GL_BACK);
    gl->Disable(GL_CULL_FACE);
    gl->PolygonOffset(0, 0);
    gl->Disable(GL_POLYGON_OFFSET_FILL);
}

/* One triangle over the picture, at a depth in clip space, where the stencil passes: ref is
 * written. */
static void cover(struct gl *gl, const struct shadow_volume *volume, float depth)
{
    gl->UseProgram(volume->whole_program);
    gl->Uniform1f(gl_uniform(gl, volume->whole_program, "depth"), depth);
    gl->StencilMask(COUNT_BITS | KEPT_BIT);
    gl->StencilOp(GL_KEEP, GL_KEEP, GL_REPLACE);
    gl_draw_arrays(gl, GL_TRIANGLES, 0, 3, 1);
    gl->StencilFunc(GL_ALWAYS, 0, 0xff);
    gl->UseProgram(volume->program);
}

/* Where the half was counted, the eighth bit is set; the other seven are 0 for the next half. */
static void merge(struct gl *gl, const struct shadow_volume *volume)
{
    gl->Disable(GL_DEPTH_TEST);
    gl->StencilFunc(GL_NOTEQUAL, KEPT_BIT, COUNT_BITS);
    cover(gl, volume, 0);
    gl->Enable(GL_DEPTH_TEST);
}

/* Samples deeper than deep_m count as within a volume: what the sun lights there is another's. */
static void mark_beyond(struct gl *gl, const struct shadow_volume *volume, const struct view *view,
                        float deep_m)
{
    gl->StencilFunc(GL_ALWAYS, 1, 0xff);
    cover(gl, volume, 1 - 2 * view->near_m / deep_m);
}

/* Of a depth buffer: twice what it resolves at 1 m with a near plane there. */
static const float depth_step = 0x1p-23f;

static void count_pieces(struct workspace *workspace, const struct shadow_volume *volume,
                         const struct view *view, float deep_m)
{
    struct gl *gl = workspace->gl;
    struct arena *passing = arena_create(0);
    struct tally tally = {.volume = volume,
                          .counted = ARENA_ARRAY(passing, bool, volume->pieces_count + 1)};
    const bool endless = !shadow_floor_is_below(volume->ground, view);
    float planes[6][4];
    planes_of(view, deep_m, planes);
    gl->UseProgram(volume->program);
    gl->BindVertexArray(volume->vertices);
    gl->UniformMatrix4fv(gl_uniform(gl, volume->program, "view_projection"), 1, GL_FALSE,
                         view->view_projection[0]);
    gl->Uniform1i(gl_uniform(gl, volume->program, "points"), (GLint)volume->points_count);
    gl->Uniform3f(gl_uniform(gl, volume->program, "away"), -volume->sun[0], -volume->sun[1],
                  -volume->sun[2]);
    gl->Uniform1i(gl_uniform(gl, volume->program, "endless"), endless);
    gl->Uniform3f(gl_uniform(gl, volume->program, "behind"), volume->behind_m,
                  volume->request.behind_px / cull_focal_px(view), depth_step / view->near_m);
    for (int pass = 0; pass < 2 * HALVES; pass++) {
        tally.half = pass / 2;
        tally.z_fail = pass % 2;
        for (size_t p = 0; p < volume->pieces_count; p++)
            tally.counted[p] =
                is_counted(volume, &volume->pieces[p], view, planes, tally.z_fail, endless);
        /* no sample that is asked for is behind what is deeper */
        const bool clips = isfinite(deep_m) && !tally.z_fail;
        gl->Uniform1f(gl_uniform(gl, volume->program, "deep_m"), clips ? deep_m : 0);
        if (clips)
            gl->Enable(GL_CLIP_DISTANCE0);
        gl->StencilMask(COUNT_BITS);
        draw_boundaries(gl, &tally);
        gl->Disable(GL_CLIP_DISTANCE0);
        if (pass == 1)
            merge(gl, volume);
    }
    arena_destroy(passing);
}

void shadow_volume_count(struct workspace *workspace, const struct shadow_volume *volume,
                         const struct view *view, float deep_m)
{
    struct gl *gl = workspace->gl;
    gl->ClearStencil(0);
    gl->Clear(GL_STENCIL_BUFFER_BIT);
    gl->ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    gl->DepthMask(GL_FALSE);
    gl->DepthFunc(GL_LESS);
    gl->Enable(GL_DEPTH_TEST);
    gl->Enable(GL_DEPTH_CLAMP);
    gl->Enable(GL_STENCIL_TEST);
    gl->StencilFunc(GL_ALWAYS, 0, 0xff);
    count_pieces(workspace, volume, view, deep_m);
    if (isfinite(deep_m))
        mark_beyond(gl, volume, view, deep_m);
    gl->StencilMask(COUNT_BITS | KEPT_BIT);
    gl->Disable(GL_DEPTH_CLAMP);
    gl->DepthMask(GL_TRUE);
    gl->ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    gl->StencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
    gl->StencilFunc(GL_EQUAL, 0, 0xff);
}

void shadow_volume_end(struct workspace *workspace)
{
    struct gl *gl = workspace->gl;
    gl->StencilFunc(GL_ALWAYS, 0, 0xff);
    gl->Disable(GL_STENCIL_TEST);
}
