/* What the files that make a mesh of a soup share: the work at hand, sets of records. */
#ifndef TREELINE_PLANT_IMPORT_PARTS_H
#define TREELINE_PLANT_IMPORT_PARTS_H

#include "plant/import_steps.h"

#include <math.h>

#define IMPORT_NONE UINT32_MAX

struct convert {
    struct arena *arena, *scratch;
    const struct import_request *request;
    struct import_soup *soup;
    struct mesh *mesh;
    bool has_leaves;     /* some material is a leaf's by its name or its texture */
    uint32_t *point;     /* of each soup vertex: the first vertex at the same position */
    uint32_t *leaf_root; /* of each point: the same number for all points of a leaf */
    uint32_t *order;     /* soup triangles in the order of the mesh */
    float (*smooth)[3];  /* bark normals of points */
    bool *keep;          /* of each soup triangle */
    struct error *error;
};

/* Twice the area along the normal. */
void import_cross(const struct convert *convert, size_t triangle, double cross[3]);

/* Orders the kept triangles by part and leaf, makes normals and vertices. */
void import_assemble(struct convert *convert, size_t kept);

/* A set of records by their bytes: open addressing over the records' numbers. */
struct set {
    uint32_t *slots;
    size_t mask;
};

struct set set_new(struct arena *arena, size_t count);
/* The number of an earlier record with the same bytes, or number itself, which is then in the set.
 */
uint32_t set_find(struct set *set, const void *records, size_t size, uint32_t number);

static inline double import_length(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

#endif
