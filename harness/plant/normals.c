/* Normals from triangles: flat and smooth. */
#include "plant/normals.h"

#include <math.h>
#include <string.h>

void triangle_cross(const float a[3], const float b[3], const float c[3], double cross[3])
{
    double u[3], v[3];
    for (int k = 0; k < 3; k++) {
        u[k] = (double)b[k] - (double)a[k];
        v[k] = (double)c[k] - (double)a[k];
    }
    cross[0] = u[1] * v[2] - u[2] * v[1];
    cross[1] = u[2] * v[0] - u[0] * v[2];
    cross[2] = u[0] * v[1] - u[1] * v[0];
}

void normals_smooth(const float (*positions)[3], uint32_t (*triangles)[3], size_t triangles_count,
                    float (*normals)[3])
{
    for (size_t i = 0; i < triangles_count; i++)
        for (int k = 0; k < 3; k++)
            memset(normals[triangles[i][k]], 0, sizeof(float[3]));
    for (size_t i = 0; i < triangles_count; i++) {
        const uint32_t *t = triangles[i];
        double cross[3];
        triangle_cross(positions[t[0]], positions[t[1]], positions[t[2]], cross);
        for (int corner = 0; corner < 3; corner++)
            for (int k = 0; k < 3; k++)
                normals[t[corner]][k] += (float)cross[k];
    }
    for (size_t i = 0; i < triangles_count; i++)
        for (int corner = 0; corner < 3; corner++) {
            float *n = normals[triangles[i][corner]];
            double length = sqrt((double)n[0] * (double)n[0] + (double)n[1] * (double)n[1] +
                                 (double)n[2] * (double)n[2]);
            if (!(length > 0)) {
                n[0] = n[2] = 0, n[1] = 1;
                continue;
            }
            for (int k = 0; k < 3; k++)
                n[k] = (float)((double)n[k] / length);
        }
}
