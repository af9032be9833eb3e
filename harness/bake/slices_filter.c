/* Filtering of slices: smaller pictures, composites, bytes for textures, dilation. */
#include "bake/slices.h"

#include "base/color.h"

#include <math.h>
#include <string.h>

void slices_decode(const struct slices *slices, size_t first, size_t count, float *texels)
{
    for (size_t at = first; at < first + count; at++, texels += SLICES_FLOATS) {
        float coverage = slices->color[at][3] / 255.0f;
        for (int k = 0; k < 4; k++)
            texels[k] = slices->color[at][k] / 255.0f;
        for (int k = 0; k < 3; k++)
            texels[4 + k] = coverage * (float)(slices->normal[at][k] - 128) / 127.0f;
        texels[7] = coverage * slices->normal[at][3] / 255.0f;
    }
}

void slices_expand(const struct slices *slices, size_t stack, int slice, float *texels)
{
    const struct slice *from = &slices->slices[stack * (size_t)slices->count + (size_t)slice];
    size_t width = (size_t)slices->width_px, pixels = width * (size_t)slices->height_px;
    memset(texels, 0, pixels * SLICES_FLOATS * sizeof *texels);
    for (size_t y = 0; y < (size_t)from->height; y++)
        slices_decode(slices, from->first + y * (size_t)from->width, (size_t)from->width,
                      texels + SLICES_FLOATS *
                                   (((size_t)from->bottom + y) * width + (size_t)from->left));
}

/* Sources [first, first + 2) of texel `to` of a halved side, and their weights: an odd side of 2 n
 * + 1 texels is spread evenly over n, three sources each. */
static int sources(int size, int to, int *first, float weights[3])
{
    int half = size > 1 ? size / 2 : 1;
    if (size % 2 == 0 || size == 1) {
        *first = size > 1 ? 2 * to : 0;
        weights[0] = weights[1] = size > 1 ? 0.5f : 1;
        return size > 1 ? 2 : 1;
    }
    float step = (float)size / (float)half; /* 2 + 1 / n texels, from to x step on */
    *first = 2 * to;
    weights[0] = (float)(half - to) / (float)half / step;
    weights[1] = 1 / step;
    weights[2] = (float)(to + 1) / (float)half / step;
    return 3;
}

void slices_halve(const float *from, int width_px, int height_px, float *to)
{
    int width = width_px > 1 ? width_px / 2 : 1, height = height_px > 1 ? height_px / 2 : 1;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++, to += SLICES_FLOATS) {
            float across[3], along[3];
            int left, bottom, columns = sources(width_px, x, &left, across),
                              rows = sources(height_px, y, &bottom, along);
            memset(to, 0, SLICES_FLOATS * sizeof *to);
            for (int j = 0; j < rows; j++)
                for (int i = 0; i < columns; i++) {
                    const float *texel =
                        from + SLICES_FLOATS *
                                   ((size_t)(bottom + j) * (size_t)width_px + (size_t)(left + i));
                    for (int k = 0; k < SLICES_FLOATS; k++)
                        to[k] += across[i] * along[j] * texel[k];
                }
        }
}

void slices_fuse(const float *near, const float *far, size_t texels, float *to)
{
    for (size_t i = 0; i < texels * SLICES_FLOATS; i += SLICES_FLOATS) {
        float through = 1 - near[i + 3];
        for (size_t k = i; k < i + SLICES_FLOATS; k++)
            to[k] = near[k] + through * far[k];
    }
}

void slices_encode(const float *texels, size_t count, bool straight, bool unit, uint8_t (*color)[4],
                   uint8_t (*normal)[4])
{
    for (size_t i = 0; i < count; i++, texels += SLICES_FLOATS) {
        float coverage = texels[3], inverse = coverage > 0 ? 1 / coverage : 0;
        for (int k = 0; k < 3; k++)
            color[i][k] = color_byte(straight ? texels[k] * inverse : texels[k]);
        color[i][3] = color_byte(coverage);
        if (!normal)
            continue;
        float length = sqrtf(texels[4] * texels[4] + texels[5] * texels[5] + texels[6] * texels[6]);
        float scale = unit ? (length > 1e-6f * coverage ? 1 / length : 0) : inverse;
        for (int k = 0; k < 3; k++)
            normal[i][k] =
                (uint8_t)(128 + lrintf(127 * fminf(fmaxf(scale * texels[4 + k], -1), 1)));
        normal[i][3] = color_byte(texels[7] * inverse);
    }
}

/* The ring that a texel was given in: 0 covered, UINT8_MAX none yet. */
struct dilation {
    uint8_t (*color)[4], (*normal)[4];
    uint8_t *ring;
    int width_px, height_px;
};

/* The mean normal's direction with the normals' mean length, in 1/127. */
static void mean_normal(const int sum[3], float lengths, int found, uint8_t normal[4])
{
    float length = sqrtf((float)(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]));
    float scale = length > 0 ? lengths / (float)found / length : 0;
    for (int k = 0; k < 3; k++)
        normal[k] = (uint8_t)(128 + lrintf(scale * (float)sum[k]));
}

/* Fills one empty texel from neighbours of rings below `ring`. */
static void dilate_texel(const struct dilation *dilation, int x, int y, int ring)
{
    int colors[3] = {0}, normals[3] = {0}, leaves = 0, found = 0;
    float lengths = 0;
    for (int n = 0; n < 9; n++) {
        int i = x + n % 3 - 1, j = y + n / 3 - 1;
        if (i < 0 || j < 0 || i >= dilation->width_px || j >= dilation->height_px)
            continue;
        size_t from = (size_t)j * (size_t)dilation->width_px + (size_t)i;
        if (dilation->ring[from] >= ring)
            continue;
        int square = 0;
        found++;
        for (int k = 0; k < 3; k++) {
            int component = dilation->normal ? dilation->normal[from][k] - 128 : 0;
            colors[k] += dilation->color[from][k];
            normals[k] += component;
            square += component * component;
        }
        lengths += sqrtf((float)square);
        leaves += dilation->normal ? dilation->normal[from][3] : 0;
    }
    if (found == 0)
        return;
    size_t at = (size_t)y * (size_t)dilation->width_px + (size_t)x;
    dilation->ring[at] = (uint8_t)ring;
    for (int k = 0; k < 3; k++)
        dilation->color[at][k] = (uint8_t)((colors[k] + found / 2) / found);
    if (!dilation->normal)
        return;
    mean_normal(normals, lengths, found, dilation->normal[at]);
    dilation->normal[at][3] = (uint8_t)((leaves + found / 2) / found);
}

void slices_dilate(uint8_t (*color)[4], uint8_t (*normal)[4], int width_px, int height_px,
                   int rings)
{
    size_t pixels = (size_t)width_px * (size_t)height_px;
    struct arena *scratch = arena_create(0);
    struct dilation dilation = {color, normal, arena_alloc(scratch, pixels, 1), width_px,
                                height_px};
    rings = rings < UINT8_MAX - 1 ? rings : UINT8_MAX - 1;
    for (size_t i = 0; i < pixels; i++)
        dilation.ring[i] = color[i][3] > 0 ? 0 : UINT8_MAX;
    for (int ring = 1; ring <= rings; ring++)
        for (int y = 0; y < height_px; y++)
            for (int x = 0; x < width_px; x++)
                if (dilation.ring[(size_t)y * (size_t)width_px + (size_t)x] == UINT8_MAX)
                    dilate_texel(&dilation, x, y, ring);
    arena_destroy(scratch);
}
