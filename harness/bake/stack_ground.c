/* Boxes of slices on the ground: how their corners follow the terrain. */
#include "bake/stack_bake.h"

#include <string.h>

/* Unit normal of the triangulated terrain's smooth surface at (x, z), by differences over a metre
 * or a hundredth of the terrain, whichever is less. */
static void normal_at(const struct terrain *terrain, float x, float z, float normal[3])
{
    float step = fminf(1, 0.01f * fminf(terrain->size_x_m, terrain->size_z_m));
    normal[0] = terrain_height(terrain, x - step, z) - terrain_height(terrain, x + step, z);
    normal[1] = 2 * step;
    normal[2] = terrain_height(terrain, x, z - step) - terrain_height(terrain, x, z + step);
    float length = sqrtf(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    for (int i = 0; i < 3; i++)
        normal[i] /= length;
}

void stack_bend_fill(const struct stack *stack, const struct instance *instance,
                     const struct stack_tree *tree, struct stack_bend *bend)
{
    const struct terrain *terrain = &stack->scene->terrain;
    float low = INFINITY, high = -INFINITY, corners[8][3];
    memset(bend, 0, sizeof *bend);
    for (int c = 0; c < 8; c++) {
        for (int i = 0; i < 3; i++)
            corners[c][i] = tree->base_m[i] + (c & 1 ? tree->u_m[i] : 0) +
                            (c & 2 ? tree->v_m[i] : 0) + (c & 4 ? tree->count * tree->w_m[i] : 0);
        low = fminf(low, corners[c][1]);
        high = fmaxf(high, corners[c][1]);
    }
    if (terrain->samples_x == 0)
        return;
    for (int c = 0; c < 8; c++) {
        float normal[3], *moved = bend->corners_m[c];
        float ground = terrain_height(terrain, corners[c][0], corners[c][2]);
        float above = corners[c][1] - instance->position_m[1];
        if (stack->request.ground == GROUND_BASE) {
            bool top = 2 * corners[c][1] > low + high;
            moved[1] = top ? 0 : ground - instance->position_m[1];
            continue;
        }
        normal_at(terrain, corners[c][0], corners[c][2], normal);
        moved[0] = above * normal[0];
        moved[1] = ground + above * normal[1] - corners[c][1];
        moved[2] = above * normal[2];
    }
}
