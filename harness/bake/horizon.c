/* The borders of a flat terrain against the sky. */
#include "bake/horizon.h"
#include "bake/backdrop.h"

#include "horizon.glsl.h"

struct horizon {
    const struct scene *scene;
    bool flat;
    GLuint program, no_vertices;
};

bool horizon_is_flat(const struct terrain *terrain)
{
    size_t count = (size_t)terrain->samples_x * terrain->samples_z;
    if (terrain->colors)
        return false;
    for (size_t i = 0; i < count; i++)
        if (terrain->heights_m[i] != terrain->heights_m[0] || terrain->normals[i][1] != 1)
            return false;
    return true;
}

enum status horizon_prepare(struct workspace *workspace, const struct scene *scene,
                            struct horizon **horizon)
{
    struct gl *gl = workspace->gl;
    struct horizon *made = *horizon = ARENA_NEW(workspace->arena, struct horizon);
    made->scene = scene;
    made->flat = scene->terrain.samples_x > 0 && horizon_is_flat(&scene->terrain);
    if (!made->flat)
        return STATUS_OK;
    made->no_vertices = gl_vertex_array(gl);
    return gl_program(gl, "horizon", horizon_glsl, NULL, &made->program, workspace->error);
}

static bool eye_is_within(const struct terrain *terrain, const float eye_m[3])
{
    return fabsf(eye_m[0]) <= 0.5f * terrain->size_x_m &&
           fabsf(eye_m[2]) <= 0.5f * terrain->size_z_m && eye_m[1] > terrain->heights_m[0];
}

/* The direction through a place in clip space, not unit. */
static void clip_ray(const struct view *view, float x, float y, float ray[3])
{
    float up = tanf(0.5f * view->fov_y_rad);
    float right = up * (float)view->width_px / (float)view->height_px;
    for (int axis = 0; axis < 3; axis++)
        ray[axis] = view->forward[axis] + x * right * view->right[axis] + y * up * view->up[axis];
}

void horizon_screen(const struct view *view, const float world_m[3], float screen[3])
{
    float clip[4];
    for (int row = 0; row < 4; row++)
        clip[row] = view->view_projection[0][row] * world_m[0] +
                    view->view_projection[1][row] * world_m[1] +
                    view->view_projection[2][row] * world_m[2] + view->view_projection[3][row];
    screen[0] = (0.5f * clip[0] / clip[3] + 0.5f) * (float)view->width_px;
    screen[1] = (0.5f * clip[1] / clip[3] + 0.5f) * (float)view->height_px;
    screen[2] = clip[3];
}

/* A border cut to what is before the eye; false when nothing is. inward: across it on the screen.
 */
static bool cut_border(const struct view *view, const float middle_m[3], float ends[2][3],
                       float inward[2])
{
    float screen[2][3], inner_m[3], inner[3];
    for (int end = 0; end < 2; end++)
        horizon_screen(view, ends[end], screen[end]);
    float near_m = 2 * view->near_m;
    if (screen[0][2] < near_m && screen[1][2] < near_m)
        return false;
    for (int end = 0; end < 2; end++) {
        float share = (near_m - screen[end][2]) / (screen[!end][2] - screen[end][2]);
        for (int axis = 0; axis < 3 && screen[end][2] < near_m; axis++)
            ends[end][axis] += share * (ends[!end][axis] - ends[end][axis]);
        horizon_screen(view, ends[end], screen[end]);
    }
    /* a point of the ground just within, beside the farther end */
    int far_end = screen[1][2] > screen[0][2];
    for (int axis = 0; axis < 3; axis++) {
        float along = 0.5f * ends[far_end][axis] + 0.5f * ends[!far_end][axis];
        inner_m[axis] = along + 1e-3f * (middle_m[axis] - along);
    }
    horizon_screen(view, inner_m, inner);
    float x = screen[1][0] - screen[0][0], y = screen[1][1] - screen[0][1];
    float length = sqrtf(x * x + y * y);
    float side = x * (inner[1] - screen[0][1]) - y * (inner[0] - screen[0][0]);
    if (!(length > 1e-3f) || !(inner[2] > 0))
        return false;
    inward[0] = (side > 0 ? -y : y) / length;
    inward[1] = (side > 0 ? x : -x) / length;
    return true;
}

int horizon_borders(const struct terrain *terrain, const struct view *view, float ends[8][3],
                    float inward[4][2])
{
    int count = 0;
    float middle[3] = {view->eye_m[0], terrain->heights_m[0], view->eye_m[2]};
    for (int border = 0; border < 4 && eye_is_within(terrain, view->eye_m); border++) {
        float(*end)[3] = ends + 2 * (size_t)count;
        for (int i = 0; i < 2; i++) {
            int corner = (border + i) % 4;
            end[i][0] = (corner == 1 || corner == 2 ? 0.5f : -0.5f) * terrain->size_x_m;
            end[i][1] = terrain->heights_m[0];
            end[i][2] = (corner >= 2 ? 0.5f : -0.5f) * terrain->size_z_m;
        }
        count += cut_border(view, middle, end, inward[count]);
    }
    return count;
}

void horizon_draw(struct workspace *workspace, const struct horizon *horizon,
                  const struct view *view)
{
    struct gl *gl = workspace->gl;
    const struct terrain *terrain = &horizon->scene->terrain;
    static const struct sky nothing = {{0}, {0}, {0}};
    const struct sky *sky = workspace->masked ? &nothing : &horizon->scene->sky;
    GLuint program = horizon->program;
    GLint samples = 0;
    gl->GetIntegerv(GL_SAMPLES, &samples);
    if (!horizon->flat || samples > 1)
        return;
    float ends[8][3], inward[4][2], rays[3][3];
    GLint count = horizon_borders(terrain, view, ends, inward);
    if (!count)
        return;
    float right_px = 2 / (float)view->width_px, up_px = 2 / (float)view->height_px;
    clip_ray(view, -1, -1, rays[0]);
    clip_ray(view, -1 + right_px, -1, rays[1]);
    clip_ray(view, -1, -1 + up_px, rays[2]);
    for (int axis = 0; axis < 3; axis++) {
        rays[1][axis] -= rays[0][axis];
        rays[2][axis] -= rays[0][axis];
    }
    gl->UseProgram(program);
    gl->BindVertexArray(horizon->no_vertices);
    shade_uniforms(workspace, program, horizon->scene, view);
    gl->Uniform3fv(gl_uniform(gl, program, "zenith"), 1, sky->zenith);
    gl->Uniform3fv(gl_uniform(gl, program, "horizon"), 1, sky->horizon);
    gl->Uniform3fv(gl_uniform(gl, program, "ground"), 1, sky->ground);
    gl->Uniform3fv(gl_uniform(gl, program, "albedo"), 1, terrain->albedo);
    gl->Uniform3fv(gl_uniform(gl, program, "ends"), 2 * count, ends[0]);
    gl->Uniform2fv(gl_uniform(gl, program, "inward"), count, inward[0]);
    gl->Uniform2f(gl_uniform(gl, program, "size_px"), (float)view->width_px,
                  (float)view->height_px);
    gl->Uniform3fv(gl_uniform(gl, program, "first_ray"), 1, rays[0]);
    gl->Uniform3fv(gl_uniform(gl, program, "ray_x"), 1, rays[1]);
    gl->Uniform3fv(gl_uniform(gl, program, "ray_y"), 1, rays[2]);
    gl->Disable(GL_DEPTH_TEST);
    gl_draw_arrays(gl, GL_TRIANGLES, 0, 6 * count, 1);
    gl->Enable(GL_DEPTH_TEST);
}
