/* Front to back with early saturation: a picture, its mask, its way to the target. */
#include "bake/stack_front.h"

#include "stack_front.glsl.h"

struct stack_front {
    GLuint close_program, blend_program, vertices;
    GLuint framebuffer, depth_framebuffer; /* the picture and the depth; the depth alone */
    GLuint color;
    int width_px, height_px; /* of color */
};

enum status stack_front_prepare(struct workspace *workspace, struct stack_front **result)
{
    struct gl *gl = workspace->gl;
    struct stack_front *front = *result = ARENA_NEW(workspace->arena, struct stack_front);
    front->vertices = gl_vertex_array(gl);
    front->framebuffer = gl_framebuffer(gl);
    front->depth_framebuffer = gl_framebuffer(gl);
    gl->NamedFramebufferDrawBuffer(front->depth_framebuffer, GL_NONE);
    enum status status = gl_program(gl, "stack_front", stack_front_glsl, "CLOSE 1\n",
                                    &front->close_program, workspace->error);
    if (status == STATUS_OK)
        status = gl_program(gl, "stack_front", stack_front_glsl, NULL, &front->blend_program,
                            workspace->error);
    return status;
}

void stack_front_begin(struct workspace *workspace, struct stack_front *front,
                       const struct target *target)
{
    struct gl *gl = workspace->gl;
    static const float empty[4] = {0, 0, 0, 0};
    if (front->width_px != target->width_px || front->height_px != target->height_px) {
        if (front->color)
            gl_delete_texture(gl, front->color);
        front->color = gl_texture(gl, GL_TEXTURE_2D, 1,
                                  target->format == TARGET_RGBA32F ? GL_RGBA32F : GL_RGBA16F,
                                  target->width_px, target->height_px, 1);
        front->width_px = target->width_px;
        front->height_px = target->height_px;
    }
    gl->NamedFramebufferTexture(front->framebuffer, GL_COLOR_ATTACHMENT0, front->color, 0);
    gl->NamedFramebufferTexture(front->framebuffer, GL_DEPTH_ATTACHMENT, target->depth, 0);
    gl->NamedFramebufferTexture(front->depth_framebuffer, GL_DEPTH_ATTACHMENT, target->depth, 0);
    gl->BindFramebuffer(GL_FRAMEBUFFER, front->framebuffer);
    gl->ClearBufferfv(GL_COLOR, 0, empty);
}

void stack_front_under(struct workspace *workspace)
{
    struct gl *gl = workspace->gl;
    gl->Enable(GL_BLEND);
    gl->BlendFunc(GL_ONE_MINUS_DST_ALPHA, GL_ONE);
    gl->DepthMask(GL_FALSE);
}

static void cover(struct workspace *workspace, const struct stack_front *front, GLuint program)
{
    struct gl *gl = workspace->gl;
    gl->UseProgram(program);
    gl->BindVertexArray(front->vertices);
    gl->BindTextureUnit(0, front->color);
    gl_draw_arrays(gl, GL_TRIANGLES, 0, 3, 1);
}

void stack_front_close(struct workspace *workspace, const struct stack_front *front)
{
    struct gl *gl = workspace->gl;
    gl->BindFramebuffer(GL_FRAMEBUFFER, front->depth_framebuffer);
    gl->DepthMask(GL_TRUE);
    gl->DepthFunc(GL_ALWAYS);
    cover(workspace, front, front->close_program);
    gl->DepthFunc(GL_LESS);
    gl->BindFramebuffer(GL_FRAMEBUFFER, front->framebuffer);
}

void stack_front_end(struct workspace *workspace, const struct stack_front *front,
                     const struct target *target)
{
    struct gl *gl = workspace->gl;
    gl->BindFramebuffer(GL_FRAMEBUFFER, target->framebuffer);
    gl->Disable(GL_DEPTH_TEST);
    gl->Enable(GL_BLEND);
    gl->BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    cover(workspace, front, front->blend_program);
    gl->Enable(GL_DEPTH_TEST);
    gl->BindTextureUnit(0, 0);
}
