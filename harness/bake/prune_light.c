/* The mean radiance of a plant, for elements that stand for many. */
#include "bake/prune.h"

#include <math.h>
#include <string.h>

enum { PROBE_TURNS = 8 };

/* D of effects.h for a unit normal seen from a direction. */
static float lambert(const struct view *view, bool both_sides, const float n[3], float toward_eye)
{
    const float *sun = view->sun_direction;
    float d = n[0] * sun[0] + n[1] * sun[1] + n[2] * sun[2];
    return both_sides ? fabsf(d) : fmaxf(0, toward_eye >= 0 ? d : -d);
}

/* The stretched tree's normal, made unit; returns by how much that shortened it: the share of an
 * area that is turned so grows as much (the area's vector transforms as the normal does). */
static float raise(float stretch, float n[3])
{
    if (stretch == 1)
        return 1;
    n[1] /= stretch;
    float length = fmaxf(sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]), 1e-12f);
    for (int i = 0; i < 3; i++)
        n[i] /= length;
    return length;
}

void prune_mean_radiance(const struct prune_vertex *probes, size_t count,
                         const struct prune_light *light, float mean[2][3])
{
    const struct scene *scene = light->scene;
    const struct view *view = light->view;
    bool two_sided = light->effects & EFFECT_TWO_SIDED;
    float seen[2] = {0, 0};
    memset(mean, 0, 2 * sizeof *mean);
    for (size_t i = 0; i < count; i++)
        for (int turn = 0; turn < PROBE_TURNS; turn++) {
            const struct prune_vertex *probe = &probes[i];
            float angle = 6.28318531f / PROBE_TURNS * (float)turn;
            float c = cosf(angle) / 32767, s = sinf(angle) / 32767;
            float n[3] = {probe->normal[0] * c + probe->normal[2] * s, probe->normal[1] / 32767.0f,
                          -probe->normal[0] * s + probe->normal[2] * c};
            float area = raise(light->stretch, n);
            float toward_eye =
                -(n[0] * view->forward[0] + n[1] * view->forward[1] + n[2] * view->forward[2]);
            int leaf = probe->normal[3] != 0, thin = probe->normal[3] > 0;
            float d = lambert(view, thin && two_sided, n, toward_eye),
                  weight = area * fabsf(toward_eye);
            seen[leaf] += weight;
            for (int axis = 0; axis < 3; axis++) {
                float ambient = light->effects & EFFECT_AMBIENT ? scene->ambient[axis] : 0;
                mean[leaf][axis] += weight * probe->albedo[axis] / 65535.0f *
                                    (scene->sun.radiance[axis] * d + ambient);
            }
        }
    for (int leaf = 0; leaf < 2; leaf++)
        for (int axis = 0; axis < 3 && seen[leaf] > 0; axis++)
            mean[leaf][axis] /= seen[leaf];
}
