/* Look-ups of a mesh's textures. */
#include "plant/texture.h"

#include <math.h>
#include <string.h>

void mesh_uv(const struct mesh *mesh, uint32_t triangle, float u, float v, float uv[2])
{
    const uint32_t *corner = mesh->triangles[triangle];
    for (int i = 0; i < 2; i++)
        uv[i] = (1 - u - v) * mesh->uvs[corner[0]][i] + u * mesh->uvs[corner[1]][i] +
                v * mesh->uvs[corner[2]][i];
}

static int texel_wrap(float texel, int size_px)
{
    float wrapped = texel - floorf(texel / (float)size_px) * (float)size_px;
    int at = (int)wrapped;
    return at >= 0 && at < size_px ? at : 0;
}

void texture_sample(const struct texture *texture, const float uv[2], float rgba[4])
{
    float x = uv[0] * (float)texture->width_px - 0.5f, y = uv[1] * (float)texture->height_px - 0.5f;
    float left = floorf(x), below = floorf(y);
    float s = x - left, t = y - below;
    int columns[2] = {texel_wrap(left, texture->width_px), texel_wrap(left + 1, texture->width_px)};
    int rows[2] = {texel_wrap(below, texture->height_px),
                   texel_wrap(below + 1, texture->height_px)};
    memset(rgba, 0, 4 * sizeof *rgba);
    for (int k = 0; k < 4; k++) {
        const float *texel = texture->rgba + 4 * ((size_t)rows[k / 2] * (size_t)texture->width_px +
                                                  (size_t)columns[k % 2]);
        float weight = (k % 2 ? s : 1 - s) * (k / 2 ? t : 1 - t);
        for (int i = 0; i < 4; i++)
            rgba[i] += weight * texel[i];
    }
}
