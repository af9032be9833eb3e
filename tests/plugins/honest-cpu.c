/* A plugin without OpenGL that keeps the contract: sky and flat terrain, a ray a pixel. */
#include "method/method.h"

#include <math.h>

struct state {
    const struct scene *scene;
    unsigned effects;
};

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *options, void **state)
{
    (void)options;
    struct state *made = *state = ARENA_NEW(workspace->arena, struct state);
    made->scene = scene;
    made->effects = workspace->effects;
    return STATUS_OK;
}

/* Radiance along a ray that meets the plane y = 0 at this distance. */
static void ground(const struct state *state, const struct view *view, float distance_m,
                   float radiance[3])
{
    const struct scene *scene = state->scene;
    float cosine = fmaxf(0, view->sun_direction[1]);
    float clear = 1;
    if (state->effects & EFFECT_FOG)
        clear = expf(-scene->fog.density_per_m * distance_m);
    for (int i = 0; i < 3; i++) {
        float light = scene->sun.radiance[i] * cosine;
        if (state->effects & EFFECT_AMBIENT)
            light += scene->ambient[i];
        float lit = scene->terrain.albedo[i] * light;
        radiance[i] = clear * lit + (1 - clear) * scene->fog.color[i];
    }
}

static enum status draw(struct workspace *workspace, void *own, const struct view *view,
                        struct target *target)
{
    const struct state *state = own;
    const struct terrain *terrain = &state->scene->terrain;
#pragma omp parallel for num_threads(workspace->threads)
    for (int y = 0; y < target->height_px; y++)
        for (int x = 0; x < target->width_px; x++) {
            float *pixel = target->pixels + 4 * ((size_t)y * (size_t)target->width_px + (size_t)x);
            float ray[3], hit[3], distance_m;
            view_ray(view, (float)x + 0.5f, (float)y + 0.5f, ray);
            distance_m = ray[1] < 0 ? -view->eye_m[1] / ray[1] : -1;
            for (int i = 0; i < 3; i++)
                hit[i] = view->eye_m[i] + distance_m * ray[i];
            if (terrain->samples_x && distance_m > 0 && fabsf(hit[0]) <= 0.5f * terrain->size_x_m &&
                fabsf(hit[2]) <= 0.5f * terrain->size_z_m)
                ground(state, view, distance_m, pixel);
            else
                sky_radiance(&state->scene->sky, ray, pixel);
            pixel[3] = 0;
        }
    return STATUS_OK;
}

extern const struct method honest_cpu_method;
const struct method honest_cpu_method = {
    .abi = METHOD_ABI,
    .name = "honest-cpu",
    .summary = "sky and flat terrain by rays",
    .source = "this project",
    .traits = EFFECT_AMBIENT | EFFECT_FOG | TRAIT_CPU | TRAIT_NO_TREES,
    .prepare = prepare,
    .draw = draw,
};
