/* Checks and bounds of meshes. */
#include "plant/mesh.h"

#include "plant/plant.h"

#include <math.h>

static void cross_edges(const float *a, const float *b, const float *c, double n[3])
{
    double u[3], v[3];
    for (int i = 0; i < 3; i++) {
        u[i] = (double)b[i] - a[i];
        v[i] = (double)c[i] - a[i];
    }
    for (int i = 0; i < 3; i++)
        n[i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
}

double mesh_triangle_area(const struct mesh *mesh, size_t triangle)
{
    const uint32_t *corners = mesh->triangles[triangle];
    double n[3];
    cross_edges(mesh->positions[corners[0]], mesh->positions[corners[1]],
                mesh->positions[corners[2]], n);
    return 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

void mesh_bounds(struct mesh *mesh)
{
    double radius2 = 0;
    for (int k = 0; k < 3; k++)
        mesh->minimum_m[k] = mesh->maximum_m[k] =
            mesh->vertices_count > 0 ? mesh->positions[0][k] : 0;
    for (size_t i = 0; i < mesh->vertices_count; i++) {
        const float *p = mesh->positions[i];
        for (int k = 0; k < 3; k++) {
            mesh->minimum_m[k] = fminf(mesh->minimum_m[k], p[k]);
            mesh->maximum_m[k] = fmaxf(mesh->maximum_m[k], p[k]);
        }
        radius2 = fmax(radius2, (double)p[0] * (double)p[0] + (double)p[2] * (double)p[2]);
    }
    /* Rounded up, so that the cylinder holds the mesh. */
    float radius = (float)sqrt(radius2);
    while ((double)radius * (double)radius < radius2)
        radius = nextafterf(radius, INFINITY);
    mesh->radius_m = radius;
}

static bool finite3(const float v[3])
{
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

static bool unit3(const float v[3])
{
    float square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    return square > 0.998f && square < 1.002f; /* NaN fails */
}

static bool albedo3(const float v[3])
{
    for (int k = 0; k < 3; k++)
        if (!(v[k] >= 0 && v[k] <= 1))
            return false;
    return true;
}

static enum status check_vertices(const struct mesh *mesh, struct error *error)
{
    for (size_t i = 0; i < mesh->vertices_count; i++) {
        const float *p = mesh->positions[i], *n = mesh->normals[i];
        if (!finite3(p))
            return error_set(error, STATUS_INVALID,
                             "vertex %zu: position (%g, %g, %g) is not finite", i, (double)p[0],
                             (double)p[1], (double)p[2]);
        if (!unit3(n))
            return error_set(error, STATUS_INVALID,
                             "vertex %zu: normal (%g, %g, %g) is not of length 1", i, (double)n[0],
                             (double)n[1], (double)n[2]);
        if (mesh->uvs && !(isfinite(mesh->uvs[i][0]) && isfinite(mesh->uvs[i][1])))
            return error_set(error, STATUS_INVALID, "vertex %zu: uv (%g, %g) is not finite", i,
                             (double)mesh->uvs[i][0], (double)mesh->uvs[i][1]);
        const float *c = mesh->colors ? mesh->colors[i] : NULL;
        if (c && !albedo3(c))
            return error_set(error, STATUS_INVALID,
                             "vertex %zu: color (%g, %g, %g) is outside 0..1", i, (double)c[0],
                             (double)c[1], (double)c[2]);
    }
    return STATUS_OK;
}

static enum status check_triangles(const struct mesh *mesh, struct error *error)
{
    for (size_t i = 0; i < mesh->triangles_count; i++)
        for (int k = 0; k < 3; k++)
            if (mesh->triangles[i][k] >= mesh->vertices_count)
                return error_set(error, STATUS_INVALID, "triangle %zu: vertex %u is outside 0..%zu",
                                 i, (unsigned)mesh->triangles[i][k], mesh->vertices_count - 1);
    return STATUS_OK;
}

static enum status check_materials(const struct mesh *mesh, struct error *error)
{
    for (size_t i = 0; i < mesh->materials_count; i++) {
        const struct material *m = &mesh->materials[i];
        const struct texture *t = m->texture;
        if (m->kind != MATERIAL_BARK && m->kind != MATERIAL_LEAF)
            return error_set(error, STATUS_INVALID, "material %zu: kind %d is not bark or leaf", i,
                             (int)m->kind);
        if (!albedo3(m->albedo))
            return error_set(error, STATUS_INVALID,
                             "material %zu: albedo (%g, %g, %g) is outside 0..1", i,
                             (double)m->albedo[0], (double)m->albedo[1], (double)m->albedo[2]);
        if (t && (t->width_px < 1 || t->height_px < 1 || !t->rgba))
            return error_set(error, STATUS_INVALID,
                             "material %zu: a texture of %d x %d pixels is empty", i, t->width_px,
                             t->height_px);
        if (t && !mesh->uvs)
            return error_set(error, STATUS_INVALID,
                             "material %zu: has a texture, but the mesh has no uvs", i);
    }
    return STATUS_OK;
}

static enum status check_elements(const struct mesh_part *part, size_t i, struct error *error)
{
    const uint32_t *first = part->element_first;
    uint32_t end = part->first_triangle + part->triangles_count;
    if (!first || part->elements_count == 0)
        return error_set(error, STATUS_INVALID, "part %zu: leaves without elements", i);
    if (first[0] != part->first_triangle || first[part->elements_count] != end)
        return error_set(error, STATUS_INVALID, "part %zu: elements %u..%u do not tile %u..%u", i,
                         (unsigned)first[0], (unsigned)first[part->elements_count],
                         (unsigned)part->first_triangle, (unsigned)end);
    for (uint32_t k = 0; k < part->elements_count; k++)
        if (first[k] >= first[k + 1])
            return error_set(error, STATUS_INVALID, "part %zu: element %u is empty", i,
                             (unsigned)k);
    return STATUS_OK;
}

static enum status check_parts(const struct mesh *mesh, struct error *error)
{
    uint64_t next = 0;
    bool leaves_seen = false;
    for (size_t i = 0; i < mesh->parts_count; i++) {
        const struct mesh_part *part = &mesh->parts[i];
        if (part->first_triangle != next || part->triangles_count == 0)
            return error_set(error, STATUS_INVALID,
                             "part %zu: %u triangles from %u do not follow on %llu", i,
                             (unsigned)part->triangles_count, (unsigned)part->first_triangle,
                             (unsigned long long)next);
        next += part->triangles_count;
        if (part->material >= mesh->materials_count)
            return error_set(error, STATUS_INVALID, "part %zu: material %u is outside 0..%zu", i,
                             (unsigned)part->material, mesh->materials_count - 1);
        bool leaf = mesh->materials[part->material].kind == MATERIAL_LEAF;
        if (leaves_seen && !leaf)
            return error_set(error, STATUS_INVALID, "part %zu: bark comes after leaves", i);
        leaves_seen = leaf;
        if (leaf && next <= mesh->triangles_count && check_elements(part, i, error) != STATUS_OK)
            return STATUS_INVALID;
        if (!leaf && (part->element_first || part->elements_count))
            return error_set(error, STATUS_INVALID, "part %zu: bark has elements", i);
    }
    if (next != mesh->triangles_count)
        return error_set(error, STATUS_INVALID, "parts hold %llu of %zu triangles",
                         (unsigned long long)next, mesh->triangles_count);
    return STATUS_OK;
}

enum status mesh_check(const struct mesh *mesh, struct error *error)
{
    if (mesh->vertices_count == 0 || mesh->triangles_count == 0 || mesh->parts_count == 0 ||
        mesh->materials_count == 0)
        return error_set(error, STATUS_INVALID, "the mesh is empty");
    if (mesh->vertices_count > UINT32_MAX || mesh->triangles_count > UINT32_MAX)
        return error_set(error, STATUS_INVALID,
                         "%zu vertices and %zu triangles: at most 4294967295", mesh->vertices_count,
                         mesh->triangles_count);
    enum status status = check_vertices(mesh, error);
    if (status == STATUS_OK)
        status = check_triangles(mesh, error);
    if (status == STATUS_OK)
        status = check_materials(mesh, error);
    if (status == STATUS_OK)
        status = check_parts(mesh, error);
    return status;
}
