/* Polygons of a conifer: a capped prism for each branch, twig and needle. */
#include "plant/conifer.h"
#include "plant/grow.h"
#include "plant/plant.h"

#include <string.h>

#define PI 3.14159265358979323846

/* Vertices a side: of a round prism a corner of its side at each end, of a flat one two; and one of
 * each cap. */
enum { ROUND_VERTICES = 4, FLAT_VERTICES = 6, SIDES_MAX = 64 };

static size_t prism_triangles(uint32_t sides)
{
    return 4 * (size_t)sides - 4; /* 2 a side, sides - 2 a cap */
}

/* Unit vectors of the corners across the axis, and of the middles of the sides behind them. */
struct corners {
    uint32_t sides;
    bool flat;
    uint32_t vertices; /* a side */
    double cosine[SIDES_MAX], sine[SIDES_MAX], middle_cosine[SIDES_MAX], middle_sine[SIDES_MAX];
    double swell; /* a regular polygon of this circumradius has a circle's perimeter of radius 1 */
};

static struct corners corners_of(uint32_t sides, bool flat)
{
    struct corners corners = {
        .sides = sides, .flat = flat, .vertices = flat ? FLAT_VERTICES : ROUND_VERTICES};
    double s, c;
    for (uint32_t k = 0; k < sides; k++) {
        grow_sincos((double)k / sides, &corners.sine[k], &corners.cosine[k]);
        grow_sincos((k + 0.5) / sides, &corners.middle_sine[k], &corners.middle_cosine[k]);
    }
    grow_sincos(0.5 / sides, &s, &c);
    corners.swell = PI / (sides * s);
    return corners;
}

static struct vec vec_of(const float v[3])
{
    return (struct vec){(double)v[0], (double)v[1], (double)v[2]};
}

static void vertex_set(struct mesh *mesh, size_t at, struct vec position, struct vec normal)
{
    float *p = mesh->positions[at], *n = mesh->normals[at];
    p[0] = (float)position.x, p[1] = (float)position.y, p[2] = (float)position.z;
    n[0] = (float)normal.x, n[1] = (float)normal.y, n[2] = (float)normal.z;
}

/* The line's two ends in a direction across it, with a normal. */
struct ends {
    struct vec at[2], normal;
};

static void ends_set(struct mesh *mesh, size_t first, const struct ends *ends)
{
    vertex_set(mesh, first, ends->at[0], ends->normal);
    vertex_set(mesh, first + 1, ends->at[1], ends->normal);
}

/* Vertices first_vertex.. are the sides', a and b of each corner, of flat ones of the corner and
 * the next; then the caps' a and b. */
static void prism_vertices(struct mesh *mesh, size_t first_vertex,
                           const struct conifer_piece *piece, const struct corners *corners)
{
    struct vec a = vec_of(piece->a_m), b = vec_of(piece->b_m), line = vec_sub(b, a);
    struct vec axis = vec_unit(line), across = vec_across(axis, 0), along = vec_cross(axis, across);
    double slope = (double)(piece->radius_a_m - piece->radius_b_m) / vec_length(line);
    double radius_a = corners->swell * (double)piece->radius_a_m;
    double radius_b = corners->swell * (double)piece->radius_b_m;
    const uint32_t sides = corners->sides, side_vertices = corners->vertices - 2;
    for (uint32_t k = 0; k < sides; k++) {
        struct vec out = vec_scale(across, corners->cosine[k]);
        struct vec middle = vec_scale(across, corners->middle_cosine[k]);
        out = vec_mad(out, corners->sine[k], along);
        middle = vec_mad(middle, corners->middle_sine[k], along);
        struct ends ends = {{vec_mad(a, radius_a, out), vec_mad(b, radius_b, out)},
                            vec_unit(vec_mad(corners->flat ? middle : out, slope, axis))};
        size_t side = first_vertex + side_vertices * (size_t)k;
        size_t before = first_vertex + side_vertices * (size_t)((k + sides - 1) % sides);
        size_t cap = first_vertex + side_vertices * (size_t)sides + 2 * (size_t)k;
        ends_set(mesh, side, &ends);
        vertex_set(mesh, cap, ends.at[0], vec_scale(axis, -1));
        vertex_set(mesh, cap + 1, ends.at[1], axis);
        if (!corners->flat)
            continue;
        middle = vec_scale(across, corners->middle_cosine[(k + sides - 1) % sides]);
        middle = vec_mad(middle, corners->middle_sine[(k + sides - 1) % sides], along);
        ends.normal = vec_unit(vec_mad(middle, slope, axis));
        ends_set(mesh, before + 2, &ends);
    }
}

static void prism_indices(uint32_t (*triangles)[3], uint32_t first, const struct corners *corners)
{
    uint32_t sides = corners->sides, side_vertices = corners->vertices - 2;
    uint32_t cap = first + side_vertices * sides;
    for (uint32_t k = 0; k < sides; k++) {
        uint32_t here = first + side_vertices * k;
        uint32_t next = corners->flat ? here + 2 : first + side_vertices * ((k + 1) % sides);
        uint32_t pair[2][3] = {{here, next, next + 1}, {here, next + 1, here + 1}};
        memcpy(triangles, pair, sizeof pair);
        triangles += 2;
    }
    for (uint32_t k = 1; k + 1 < sides; k++) {
        uint32_t pair[2][3] = {{cap, cap + 2 * (k + 1), cap + 2 * k},
                               {cap + 1, cap + 2 * k + 1, cap + 2 * (k + 1) + 1}};
        memcpy(triangles, pair, sizeof pair);
        triangles += 2;
    }
}

/* Adds the prisms behind what the mesh has already. */
static void add_prisms(struct mesh *mesh, const struct conifer_piece *pieces, size_t count,
                       uint32_t sides, bool flat)
{
    const struct corners corners = corners_of(sides, flat);
    size_t vertices = mesh->vertices_count, triangles = mesh->triangles_count;
    size_t of_one = (size_t)corners.vertices * sides;
    mesh->vertices_count += count * of_one;
    mesh->triangles_count += count * prism_triangles(sides);
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < count; i++) {
        size_t first = vertices + i * of_one;
        prism_vertices(mesh, first, &pieces[i], &corners);
        prism_indices(mesh->triangles + triangles + i * prism_triangles(sides), (uint32_t)first,
                      &corners);
    }
}

static void add_material(struct arena *arena, struct mesh *mesh, const char *name,
                         enum material_kind kind, const float albedo[3])
{
    struct material *material = &mesh->materials[mesh->materials_count++];
    material->name = arena_strdup(arena, name);
    material->kind = kind;
    memcpy(material->albedo, albedo, sizeof material->albedo);
}

/* A part of all triangles from first on; elements: 0 for bark. */
static void add_part(struct arena *arena, struct mesh *mesh, size_t first, size_t elements)
{
    struct mesh_part *part = &mesh->parts[mesh->parts_count];
    part->first_triangle = (uint32_t)first;
    part->triangles_count = (uint32_t)(mesh->triangles_count - first);
    part->material = (uint32_t)mesh->parts_count++;
    part->elements_count = (uint32_t)elements;
    if (!elements)
        return;
    part->element_first = ARENA_ARRAY(arena, uint32_t, elements + 1);
    for (size_t i = 0; i <= elements; i++)
        part->element_first[i] = (uint32_t)(first + i * (part->triangles_count / elements));
}

struct mesh *conifer_mesh(struct arena *arena, const struct conifer *conifer)
{
    uint32_t bark_sides = conifer->branch_sides ? conifer->branch_sides : 6;
    uint32_t needle_sides = conifer->needle_sides ? conifer->needle_sides : 3;
    size_t bark = conifer->branches_count + conifer->twigs_count;
    size_t needles = (size_t)conifer->needles_count;
    size_t vertices = ROUND_VERTICES * bark * bark_sides + FLAT_VERTICES * needles * needle_sides;
    struct arena *scratch = arena_create(0);
    struct conifer_piece *pieces =
        ARENA_ARRAY(scratch, struct conifer_piece, bark > needles ? bark : needles);
    struct mesh *mesh = ARENA_NEW(arena, struct mesh);
    mesh->positions = arena_alloc(arena, vertices, sizeof *mesh->positions);
    mesh->normals = arena_alloc(arena, vertices, sizeof *mesh->normals);
    mesh->triangles = arena_alloc(
        arena, bark * prism_triangles(bark_sides) + needles * prism_triangles(needle_sides),
        sizeof *mesh->triangles);
    mesh->parts = ARENA_ARRAY(arena, struct mesh_part, 2);
    mesh->materials = ARENA_ARRAY(arena, struct material, 2);
    conifer_bark(conifer, pieces);
    add_prisms(mesh, pieces, bark, bark_sides, false);
    add_material(arena, mesh, "bark", MATERIAL_BARK, conifer->bark_albedo);
    add_part(arena, mesh, 0, 0);
    if (needles) {
        size_t first = mesh->triangles_count;
        conifer_needles(conifer, pieces);
        add_prisms(mesh, pieces, needles, needle_sides, true);
        add_material(arena, mesh, "needle", MATERIAL_LEAF, conifer->needle_albedo);
        mesh->materials[mesh->materials_count - 1].solid = true;
        add_part(arena, mesh, first, needles);
    }
    arena_destroy(scratch);
    mesh_bounds(mesh);
    return mesh;
}
