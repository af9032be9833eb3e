/* A coloured volume as a mesh: a rectangle a voxel. */
#include "plant/coloring.h"

#include "plant/plant.h"

#include <math.h>

/* Unit normal, and two unit vectors across it: the first one along the projection of the grid's
 * axis that is most across the normal, so that the rectangles of a flat surface make a pattern. */
static void frame_of(const struct colored_voxel *voxel, float normal[3], float a[3], float b[3])
{
    const float *n = voxel->normal;
    float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    int axis = 0;
    for (int i = 0; i < 3; i++)
        normal[i] = length > 1e-6f ? n[i] / length : (float)(i == 1);
    for (int i = 1; i < 3; i++)
        axis = fabsf(normal[i]) < fabsf(normal[axis]) ? i : axis;
    float across = sqrtf(1 - normal[axis] * normal[axis]);
    for (int i = 0; i < 3; i++)
        a[i] = ((float)(i == axis) - normal[axis] * normal[i]) / across;
    for (int i = 0; i < 3; i++)
        b[i] = normal[(i + 1) % 3] * a[(i + 2) % 3] - normal[(i + 2) % 3] * a[(i + 1) % 3];
}

/* A rectangle of the voxel's area whose sides are to each other as the voxel's extents along them,
 * at most half as long again. */
static void rectangle(const struct colored_voxel *voxel, const float voxel_m[3], struct mesh *mesh,
                      size_t k)
{
    float normal[3], a[3], b[3], extent_m[2] = {0, 0};
    frame_of(voxel, normal, a, b);
    for (int i = 0; i < 3; i++) {
        extent_m[0] += fabsf(a[i]) * voxel_m[i];
        extent_m[1] += fabsf(b[i]) * voxel_m[i];
    }
    float scale = fminf(sqrtf(voxel->area_m2 / (extent_m[0] * extent_m[1])), 1.5f) / 2;
    for (int corner = 0; corner < 4; corner++) {
        float u = (corner == 0 || corner == 3 ? -scale : scale) * extent_m[0];
        float v = (corner < 2 ? -scale : scale) * extent_m[1];
        for (int i = 0; i < 3; i++) {
            mesh->positions[4 * k + (size_t)corner][i] = voxel->position_m[i] + u * a[i] + v * b[i];
            mesh->normals[4 * k + (size_t)corner][i] = normal[i];
            mesh->colors[4 * k + (size_t)corner][i] = voxel->color[i];
        }
    }
    for (int t = 0; t < 2; t++)
        for (int i = 0; i < 3; i++)
            mesh->triangles[2 * k + (size_t)t][i] =
                (uint32_t)(4 * k) + (uint32_t)(i == 0 ? 0 : i + t);
}

struct mesh *coloring_mesh(struct arena *arena, const struct coloring *coloring)
{
    size_t count = coloring->voxels_count;
    if (count == 0)
        return NULL;
    struct mesh *mesh = ARENA_NEW(arena, struct mesh);
    mesh->vertices_count = 4 * count;
    mesh->positions = arena_alloc(arena, 4 * count, sizeof *mesh->positions);
    mesh->normals = arena_alloc(arena, 4 * count, sizeof *mesh->normals);
    mesh->colors = arena_alloc(arena, 4 * count, sizeof *mesh->colors);
    mesh->triangles_count = 2 * count;
    mesh->triangles = arena_alloc(arena, 2 * count, sizeof *mesh->triangles);
    for (size_t k = 0; k < count; k++)
        rectangle(&coloring->voxels[k], coloring->voxel_m, mesh, k);
    mesh->materials_count = mesh->parts_count = 1;
    mesh->materials = ARENA_NEW(arena, struct material);
    mesh->materials[0] = (struct material){
        .name = arena_strdup(arena, "voxel"), .kind = MATERIAL_LEAF, .albedo = {1, 1, 1}};
    mesh->parts = ARENA_NEW(arena, struct mesh_part);
    mesh->parts[0] = (struct mesh_part){.triangles_count = (uint32_t)(2 * count),
                                        .element_first = ARENA_ARRAY(arena, uint32_t, count + 1),
                                        .elements_count = (uint32_t)count};
    for (size_t k = 0; k <= count; k++)
        mesh->parts[0].element_first[k] = (uint32_t)(2 * k);
    mesh_bounds(mesh);
    return mesh;
}
