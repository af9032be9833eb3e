/* Triangles to voxels: parallel rays along three axes, one bit a ray and voxel. */
#include "bake/voxels_parts.h"

#include "plant/texture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct corner {
    float place[3]; /* in rays' spacings from the grid's lowest corner */
    float uv[2], color[3];
};

struct facet {
    struct corner corners[3];
    float normal[3];        /* unit, geometric */
    bool is_bark, is_solid; /* solid: bark and needles, of which half faces away */
    const struct material *material;
};

/* The mass of a cell; made when first met. The array grows by copying. */
static struct voxel_mass *mass_at(struct arena *arena, struct voxel_grid *grid, size_t cell)
{
    if (grid->cells[cell])
        return &grid->masses[grid->cells[cell] - 1];
    if (grid->count == grid->capacity) {
        grid->capacity = grid->capacity ? 2 * grid->capacity : 4096;
        struct voxel_mass *more = ARENA_ARRAY(arena, struct voxel_mass, grid->capacity);
        if (grid->count)
            memcpy(more, grid->masses, grid->count * sizeof *more);
        grid->masses = more;
    }
    grid->cells[cell] = (uint32_t)++grid->count;
    return &grid->masses[grid->count - 1];
}

/* Twice the area to the left of the edge a to b, and whether a place on it belongs to the triangle,
 * so that neighbours share no ray. */
struct edge {
    double x, y, dx, dy;
    bool owns;
};

static struct edge edge_of(const double a[2], const double b[2])
{
    double dx = b[0] - a[0], dy = b[1] - a[1];
    return (struct edge){a[0], a[1], dx, dy, dy > 0 || (dy == 0 && dx < 0)};
}

static double edge_side(const struct edge *edge, double x, double y)
{
    return edge->dx * (y - edge->y) - edge->dy * (x - edge->x);
}

/* A ray along the axis meets the facet. weights: barycentric. */
static void deposit(struct arena *arena, struct voxel_grid *grid, const struct facet *facet,
                    int axis, const int at[2], const double weights[3])
{
    float rgb[3], uv[2] = {0, 0}, depth = 0;
    for (int k = 0; k < 3; k++)
        depth += (float)weights[k] * facet->corners[k].place[axis];
    for (int c = 0; c < 3; c++) {
        rgb[c] = 0;
        for (int k = 0; k < 3; k++)
            rgb[c] += (float)weights[k] * facet->corners[k].color[c];
        rgb[c] *= facet->material->albedo[c];
    }
    if (facet->material->texture) {
        float rgba[4];
        for (int k = 0; k < 3; k++)
            for (int c = 0; c < 2; c++)
                uv[c] += (float)weights[k] * facet->corners[k].uv[c];
        texture_sample(facet->material->texture, uv, rgba);
        if (rgba[3] < 0.5f)
            return;
        for (int c = 0; c < 3; c++)
            rgb[c] *= rgba[c];
    }
    int cell[3], b = (axis + 1) % 3, c = (axis + 2) % 3;
    cell[axis] = (int)floorf(depth / VOXEL_RAYS);
    cell[b] = at[0] / VOXEL_RAYS;
    cell[c] = at[1] / VOXEL_RAYS;
    for (int i = 0; i < 3; i++) {
        int last = (int)grid->size[i] - 1;
        cell[i] = cell[i] < 0 ? 0 : cell[i] > last ? last : cell[i];
    }
    struct voxel_mass *mass = mass_at(
        arena, grid,
        ((size_t)cell[2] * grid->size[1] + (size_t)cell[1]) * grid->size[0] + (size_t)cell[0]);
    const float *n = facet->normal;
    /* A ray along an axis stands for 1 / |n_axis| of its spacing squared; the three axes' rays
     * together, each by its n_axis squared, count every area once. */
    float area = fabsf(n[axis]) / (VOXEL_RAYS * VOXEL_RAYS) * (facet->is_solid ? 0.5f : 1.0f);
    mass->area += area;
    mass->bark += facet->is_bark ? area : 0;
    const float products[6] = {n[0] * n[0], n[1] * n[1], n[2] * n[2],
                               n[0] * n[1], n[0] * n[2], n[1] * n[2]};
    for (int i = 0; i < 6; i++)
        mass->moments[i] += area * products[i];
    for (int i = 0; i < 3; i++) {
        mass->facing[i] += area * fabsf(n[i]);
        mass->albedo[i] += area * rgb[i];
    }
    mass->rays[axis] |= 1ull << (at[0] % VOXEL_RAYS + VOXEL_RAYS * (at[1] % VOXEL_RAYS));
}

/* Every ray along the axis that meets the facet. */
static void cast(struct arena *arena, struct voxel_grid *grid, const struct facet *facet, int axis)
{
    int b = (axis + 1) % 3, c = (axis + 2) % 3, low[2], high[2];
    double p[3][2];
    for (int k = 0; k < 3; k++) {
        p[k][0] = facet->corners[k].place[b];
        p[k][1] = facet->corners[k].place[c];
    }
    double twice =
        (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]);
    if (twice == 0)
        return;
    int second = twice > 0 ? 1 : 2, third = 3 - second;
    for (int i = 0; i < 2; i++) {
        double least = fmin(p[0][i], fmin(p[1][i], p[2][i]));
        double most = fmax(p[0][i], fmax(p[1][i], p[2][i]));
        int last = (int)grid->size[i ? c : b] * VOXEL_RAYS - 1;
        low[i] = (int)fmax(0, ceil(least - 0.5));
        high[i] = (int)fmin(last, floor(most - 0.5));
    }
    struct edge edges[3] = {edge_of(p[second], p[third]), edge_of(p[third], p[0]),
                            edge_of(p[0], p[second])};
    for (int y = low[1]; y <= high[1]; y++)
        for (int x = low[0]; x <= high[0]; x++) {
            double side[3], weights[3];
            bool inside = true;
            for (int e = 0; e < 3; e++) {
                side[e] = edge_side(&edges[e], x + 0.5, y + 0.5);
                inside &= side[e] > 0 || (side[e] == 0 && edges[e].owns);
            }
            if (!inside)
                continue;
            weights[0] = side[0] / fabs(twice);
            weights[second] = side[1] / fabs(twice);
            weights[third] = side[2] / fabs(twice);
            deposit(arena, grid, facet, axis, (const int[2]){x, y}, weights);
        }
}

static bool facet_of(const struct mesh *mesh, const struct mesh_part *part, size_t triangle,
                     const float origin_m[3], float spacing_m, struct facet *facet)
{
    const uint32_t *corners = mesh->triangles[triangle];
    const float *p[3];
    facet->material = &mesh->materials[part->material];
    facet->is_bark = facet->material->kind == MATERIAL_BARK;
    facet->is_solid = !material_is_thin(facet->material);
    for (int k = 0; k < 3; k++) {
        struct corner *corner = &facet->corners[k];
        p[k] = mesh->positions[corners[k]];
        for (int i = 0; i < 3; i++) {
            corner->place[i] = (p[k][i] - origin_m[i]) / spacing_m;
            corner->color[i] = mesh->colors ? mesh->colors[corners[k]][i] : 1;
        }
        for (int i = 0; i < 2; i++)
            corner->uv[i] = mesh->uvs ? mesh->uvs[corners[k]][i] : 0;
    }
    double u[3], v[3], n[3], length = 0;
    for (int i = 0; i < 3; i++) {
        u[i] = (double)p[1][i] - p[0][i];
        v[i] = (double)p[2][i] - p[0][i];
    }
    for (int i = 0; i < 3; i++) {
        int b = (i + 1) % 3, c = (i + 2) % 3;
        n[i] = u[b] * v[c] - u[c] * v[b];
        length += n[i] * n[i];
    }
    length = sqrt(length);
    for (int i = 0; i < 3; i++)
        facet->normal[i] = length > 0 ? (float)(n[i] / length) : 0;
    return length > 0;
}

static float share_of_bits(uint64_t bits)
{
    return (float)__builtin_popcountll(bits) / (VOXEL_RAYS * VOXEL_RAYS);
}

enum status voxel_grid_fill(struct arena *arena, const struct mesh *mesh, const float origin_m[3],
                            float voxel_m, struct voxel_grid *grid, struct error *error)
{
    size_t cells = (size_t)grid->size[0] * grid->size[1] * grid->size[2];
    grid->cells = ARENA_ARRAY(arena, uint32_t, cells);
    for (size_t part = 0; part < mesh->parts_count; part++) {
        const struct mesh_part *run = &mesh->parts[part];
        for (size_t t = 0; t < run->triangles_count; t++) {
            struct facet facet;
            if (!facet_of(mesh, run, run->first_triangle + t, origin_m, voxel_m / VOXEL_RAYS,
                          &facet))
                continue;
            for (int axis = 0; axis < 3; axis++)
                cast(arena, grid, &facet, axis);
        }
        if (grid->count > UINT32_MAX / 2 - VOXELS_FIRST)
            return error_set(error, STATUS_INVALID, "voxels: more than %u are not empty",
                             UINT32_MAX / 2 - VOXELS_FIRST);
    }
    for (size_t i = 0; i < grid->count; i++)
        for (int axis = 0; axis < 3; axis++)
            grid->masses[i].cover[axis] = share_of_bits(grid->masses[i].rays[axis]);
    return STATUS_OK;
}

static void mass_add(struct voxel_mass *sum, const struct voxel_mass *mass)
{
    sum->area += mass->area;
    sum->bark += mass->bark;
    for (int i = 0; i < 6; i++)
        sum->moments[i] += mass->moments[i];
    for (int i = 0; i < 3; i++) {
        sum->facing[i] += mass->facing[i];
        sum->albedo[i] += mass->albedo[i];
    }
}

/* Every other ray of a face, gathered into a quarter of one: bits 0, 2, 4, 6 of rows 0, 2, 4, 6. */
static uint64_t every_other(uint64_t bits)
{
    uint64_t quarter = 0;
    for (int y = 0; y < VOXEL_RAYS / 2; y++)
        for (int x = 0; x < VOXEL_RAYS / 2; x++)
            quarter |= (bits >> (2 * x + 2 * VOXEL_RAYS * y) & 1) << (x + VOXEL_RAYS * y);
    return quarter;
}

/* The eight cells of a coarse one; NULL where empty or outside. */
static bool children_of(const struct voxel_grid *fine, const uint32_t at[3],
                        const struct voxel_mass *children[8])
{
    bool any = false;
    for (uint32_t k = 0; k < 8; k++) {
        uint32_t x = 2 * at[0] + (k & 1), y = 2 * at[1] + (k >> 1 & 1), z = 2 * at[2] + (k >> 2);
        children[k] = NULL;
        if (x >= fine->size[0] || y >= fine->size[1] || z >= fine->size[2])
            continue;
        uint32_t cell = fine->cells[((size_t)z * fine->size[1] + y) * fine->size[0] + x];
        if (cell) {
            children[k] = &fine->masses[cell - 1];
            any = true;
        }
    }
    return any;
}

/* Rays along an axis pass two cells in each of four columns. The cells' covers are known better
 * than from the few rays that are kept of them: these say only how much hides behind each other. */
static void mass_see(struct voxel_mass *sum, const struct voxel_mass *const children[8], int axis)
{
    int b = (axis + 1) % 3, c = (axis + 2) % 3;
    float cover = 0, apart = 0, together = 0;
    for (int column = 0; column < 4; column++) {
        int right = column & 1, up = column >> 1;
        uint64_t bits = 0;
        for (int step = 0; step < 2; step++) {
            const struct voxel_mass *child = children[step << axis | right << b | up << c];
            if (!child)
                continue;
            bits |= child->rays[axis];
            apart += share_of_bits(child->rays[axis]);
            cover += 0.25f * child->cover[axis];
        }
        together += share_of_bits(bits);
        sum->rays[axis] |= every_other(bits)
                           << (VOXEL_RAYS / 2 * right + VOXEL_RAYS * VOXEL_RAYS / 2 * up);
    }
    sum->cover[axis] = fminf(1, apart > 0 ? cover * together / apart : cover);
}

void voxel_grid_halve(struct arena *arena, const struct voxel_grid *fine, struct voxel_grid *coarse)
{
    size_t cells = 1;
    *coarse = (struct voxel_grid){0};
    for (int i = 0; i < 3; i++) {
        coarse->size[i] = (fine->size[i] + 1) / 2;
        cells *= coarse->size[i];
    }
    coarse->cells = ARENA_ARRAY(arena, uint32_t, cells);
    coarse->capacity = cells < fine->count ? cells : fine->count;
    coarse->masses = ARENA_ARRAY(arena, struct voxel_mass, coarse->capacity);
    uint32_t at[3];
    size_t cell = 0;
    for (at[2] = 0; at[2] < coarse->size[2]; at[2]++)
        for (at[1] = 0; at[1] < coarse->size[1]; at[1]++)
            for (at[0] = 0; at[0] < coarse->size[0]; at[0]++, cell++) {
                const struct voxel_mass *children[8];
                if (!children_of(fine, at, children))
                    continue;
                struct voxel_mass *sum = mass_at(arena, coarse, cell);
                for (int k = 0; k < 8; k++)
                    if (children[k])
                        mass_add(sum, children[k]);
                for (int axis = 0; axis < 3; axis++)
                    mass_see(sum, children, axis);
            }
}
