/* From a soup of triangles to a plant's mesh: placed, classified, welded, ordered by part and leaf.
 *
 * 1. each material is bark or leaf, by its name or because its texture has holes;
 * 2. vertices of equal position are one point; triangles without area are dropped;
 *    where no material is a leaf's, connected pieces that are flat and open are leaves;
 * 3. axes turned to +y up, scaled to the height wanted, foot moved to the origin;
 * 4. triangles that share points make one leaf;
 * 5. bark parts, then leaf parts, a leaf's triangles side by side;
 * 6. missing normals: smooth over points on bark, flat on leaves; equal vertices are shared. */
#include "base/hash.h"
#include "plant/import_steps.h"
#include "plant/normals.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

static const uint32_t none = UINT32_MAX;

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

static bool is_leaf(const struct convert *convert, size_t triangle)
{
    uint32_t material = convert->soup->triangle_material[triangle];
    return convert->mesh->materials[material].kind == MATERIAL_LEAF;
}

/* From +z up to +y up. */
static void turn(float v[3])
{
    float y = v[1];
    v[1] = v[2];
    v[2] = -y;
}

static void turn_soup(struct import_soup *soup)
{
    for (size_t i = 0; i < soup->vertices_count; i++) {
        turn(soup->positions[i]);
        turn(soup->normals[i]);
    }
}

/* True when the name holds one of the comma-separated words, in any case. */
static bool name_matches(const char *name, const char *words)
{
    for (const char *word = words; *word;) {
        size_t length = strcspn(word, ",");
        const char *start = word;
        size_t n = length;
        while (n && isspace((unsigned char)*start))
            start++, n--;
        while (n && isspace((unsigned char)start[n - 1]))
            n--;
        for (const char *at = name; n && strlen(at) >= n; at++)
            if (strncasecmp(at, start, n) == 0)
                return true;
        word += length + (word[length] == ',');
    }
    return false;
}

static enum status unmatched(const struct convert *convert)
{
    char names[512] = "";
    for (size_t i = 0; i < convert->soup->materials_count; i++) {
        size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, "%s'%s'", used ? ", " : "",
                 convert->soup->materials[i].name);
    }
    return error_set(convert->error, STATUS_INVALID,
                     "%s: leaf: no material's name holds '%s'; its materials are %s",
                     convert->request->path, convert->request->leaf, names);
}

static enum status classify(struct convert *convert, const struct texture *const *textures,
                            const bool *has_holes)
{
    const struct import_request *request = convert->request;
    const char *words = request->leaf ? request->leaf : "leaf,leaves,foliage,needle,feuille";
    struct mesh *mesh = convert->mesh;
    mesh->materials_count = convert->soup->materials_count;
    mesh->materials = ARENA_ARRAY(convert->arena, struct material, 2 * mesh->materials_count);
    for (size_t i = 0; i < mesh->materials_count; i++) {
        const struct import_material *from = &convert->soup->materials[i];
        struct material *to = &mesh->materials[i];
        to->name = arena_strdup(convert->arena, from->name);
        bool leaf = name_matches(from->name, words) || (!request->leaf && has_holes[i]);
        to->kind = leaf ? MATERIAL_LEAF : MATERIAL_BARK;
        convert->has_leaves |= leaf;
        const float *albedo = leaf ? request->leaf_albedo : request->bark_albedo;
        memcpy(to->albedo, albedo ? albedo : from->albedo, sizeof to->albedo);
        to->texture = textures[i];
    }
    bool wanted = request->leaf && *request->leaf;
    return convert->has_leaves || !wanted ? STATUS_OK : unmatched(convert);
}

/* A set of records by their bytes: open addressing over the records' numbers. */
struct set {
    uint32_t *slots;
    size_t mask;
};

static struct set set_new(struct arena *arena, size_t count)
{
    size_t size = 16;
    while (size < count * 2)
        size *= 2;
    struct set set = {ARENA_ARRAY(arena, uint32_t, size), size - 1};
    memset(set.slots, 0xff, size * sizeof *set.slots);
    return set;
}

/* The number of an earlier record with the same bytes, or number itself, which is then in the set.
 */
static uint32_t set_find(struct set *set, const void *records, size_t size, uint32_t number)
{
    const char *all = records, *record = all + size * number;
    size_t slot = hash_bytes(0, record, size) & set->mask;
    while (set->slots[slot] != none) {
        if (memcmp(all + size * set->slots[slot], record, size) == 0)
            return set->slots[slot];
        slot = (slot + 1) & set->mask;
    }
    set->slots[slot] = number;
    return number;
}

static void weld(struct convert *convert)
{
    struct import_soup *soup = convert->soup;
    struct set set = set_new(convert->scratch, soup->vertices_count);
    convert->point = ARENA_ARRAY(convert->scratch, uint32_t, soup->vertices_count);
    for (size_t i = 0; i < soup->vertices_count; i++) {
        for (int k = 0; k < 3; k++)
            soup->positions[i][k] += 0.0f; /* -0 becomes 0 */
        convert->point[i] = set_find(&set, soup->positions, sizeof(float[3]), (uint32_t)i);
    }
}

static double length3(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static void cross_of(const struct convert *convert, size_t triangle, double cross[3])
{
    const uint32_t *t = convert->soup->triangles[triangle];
    float(*p)[3] = convert->soup->positions;
    triangle_cross((const float *)p[t[0]], (const float *)p[t[1]], (const float *)p[t[2]], cross);
}

/* Less than a ten-millionth as high as long is rounding, not area. */
static bool has_area(const struct convert *convert, size_t triangle)
{
    const uint32_t *t = convert->soup->triangles[triangle];
    double cross[3], longest = 0;
    cross_of(convert, triangle, cross);
    for (int k = 0; k < 3; k++) {
        const float *a = convert->soup->positions[t[k]];
        const float *b = convert->soup->positions[t[(k + 1) % 3]];
        double edge[3] = {(double)b[0] - (double)a[0], (double)b[1] - (double)a[1],
                          (double)b[2] - (double)a[2]};
        longest = fmax(longest, length3(edge));
    }
    double area = length3(cross);
    return area > 1e-7 * longest * longest;
}

static enum status drop_degenerate(struct convert *convert, size_t *kept)
{
    size_t count = convert->soup->triangles_count;
    convert->keep = ARENA_ARRAY(convert->scratch, bool, count);
    *kept = 0;
    for (size_t i = 0; i < count; i++) {
        convert->keep[i] = has_area(convert, i);
        *kept += convert->keep[i];
    }
    if (*kept == 0)
        return error_set(convert->error, STATUS_INVALID,
                         "%s: none of its %zu triangles has an area", convert->request->path,
                         count);
    if (*kept < count)
        fprintf(stderr, "treeline: %s: %zu of %zu triangles have no area and were dropped\n",
                convert->request->path, count - *kept, count);
    return STATUS_OK;
}

/* Each material of flat pieces becomes a leaf's; one of other pieces too gets a twin for them. */
static void classify_by_shape(struct convert *convert)
{
    struct import_soup *soup = convert->soup;
    struct mesh *mesh = convert->mesh;
    size_t count = mesh->materials_count;
    const bool *flat = import_flat(convert->scratch, soup, convert->point, convert->keep);
    bool *has[2] = {ARENA_ARRAY(convert->scratch, bool, count),
                    ARENA_ARRAY(convert->scratch, bool, count)};
    uint32_t *leaf = ARENA_ARRAY(convert->scratch, uint32_t, count);
    for (size_t i = 0; i < soup->triangles_count; i++)
        if (convert->keep[i])
            has[flat[i]][soup->triangle_material[i]] = true;
    for (uint32_t m = 0; m < count; m++) {
        if (!has[1][m])
            continue;
        leaf[m] = has[0][m] ? (uint32_t)mesh->materials_count++ : m;
        struct material *to = &mesh->materials[leaf[m]];
        *to = mesh->materials[m];
        to->kind = MATERIAL_LEAF;
        const float *albedo = convert->request->leaf_albedo;
        memcpy(to->albedo, albedo ? albedo : soup->materials[m].albedo, sizeof to->albedo);
    }
    for (size_t i = 0; i < soup->triangles_count; i++)
        if (convert->keep[i] && flat[i])
            soup->triangle_material[i] = leaf[soup->triangle_material[i]];
}

/* Marks the points that the kept triangles use, one vertex for each position. */
static bool *used_points(const struct convert *convert)
{
    const struct import_soup *soup = convert->soup;
    bool *used = ARENA_ARRAY(convert->scratch, bool, soup->vertices_count);
    for (size_t i = 0; i < soup->triangles_count; i++)
        for (int k = 0; k < 3 && convert->keep[i]; k++)
            used[convert->point[soup->triangles[i][k]]] = true;
    return used;
}

/* Foot: the mean of the points in the lowest 2 % of the height. */
static void place(struct convert *convert, const bool *used, double low, double high)
{
    struct import_soup *soup = convert->soup;
    double limit = low + 0.02 * (high - low), x = 0, z = 0;
    size_t count = 0;
    for (size_t i = 0; i < soup->vertices_count; i++)
        if (used[i] && (double)soup->positions[i][1] <= limit) {
            x += (double)soup->positions[i][0];
            z += (double)soup->positions[i][2];
            count++;
        }
    double wanted = convert->request->height_m;
    double scale = wanted > 0 ? wanted / (high - low) : 1;
    double foot[3] = {x / (double)count, low, z / (double)count};
    for (size_t i = 0; i < soup->vertices_count; i++)
        for (int k = 0; k < 3; k++)
            soup->positions[i][k] = (float)(((double)soup->positions[i][k] - foot[k]) * scale);
}

static enum status place_soup(struct convert *convert)
{
    const struct import_soup *soup = convert->soup;
    const bool *used = used_points(convert);
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < soup->vertices_count; i++) {
        low = used[i] ? fmin(low, (double)soup->positions[i][1]) : low;
        high = used[i] ? fmax(high, (double)soup->positions[i][1]) : high;
    }
    double scaled = convert->request->height_m > 0 ? convert->request->height_m : high - low;
    if (!(high - low > 0))
        return error_set(convert->error, STATUS_INVALID,
                         "%s: is flat: 0 high along its up axis; allowed: above 0",
                         convert->request->path);
    if (!(scaled >= 1e-3 && scaled <= 1000))
        return error_set(convert->error, STATUS_INVALID,
                         "%s: is %g m high; allowed: 0.001..1000 (height_m scales it)",
                         convert->request->path, scaled);
    place(convert, used, low, high);
    return STATUS_OK;
}

static void connect_leaves(struct convert *convert)
{
    size_t count = convert->soup->triangles_count;
    bool *leaf = ARENA_ARRAY(convert->scratch, bool, count);
    for (size_t i = 0; i < count; i++)
        leaf[i] = convert->keep[i] && is_leaf(convert, i);
    convert->leaf_root = import_connect(convert->scratch, convert->soup, convert->point, leaf);
}

/* Orders the part's triangles by leaf, leaves by their first triangle; fills the part's elements.
 */
static void order_leaves(struct convert *convert, struct mesh_part *part, uint32_t *leaf_number,
                         const uint32_t *members)
{
    uint32_t count = part->triangles_count, leaves = 0;
    uint32_t *leaf_of = ARENA_ARRAY(convert->scratch, uint32_t, count);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t vertex = convert->soup->triangles[members[i]][0];
        uint32_t root = convert->leaf_root[convert->point[vertex]];
        if (leaf_number[root] == none)
            leaf_number[root] = leaves++;
        leaf_of[i] = leaf_number[root];
    }
    uint32_t *first = ARENA_ARRAY(convert->arena, uint32_t, (size_t)leaves + 1);
    for (uint32_t i = 0; i < count; i++)
        first[leaf_of[i] + 1]++;
    for (uint32_t i = 0; i < leaves; i++)
        first[i + 1] += first[i];
    uint32_t *next = ARENA_ARRAY(convert->scratch, uint32_t, leaves);
    memcpy(next, first, leaves * sizeof *next);
    for (uint32_t i = 0; i < count; i++)
        convert->order[part->first_triangle + next[leaf_of[i]]++] = members[i];
    for (uint32_t i = 0; i <= leaves; i++)
        first[i] += part->first_triangle;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t vertex = convert->soup->triangles[members[i]][0];
        leaf_number[convert->leaf_root[convert->point[vertex]]] = none;
    }
    part->element_first = first;
    part->elements_count = leaves;
}

static void make_parts(struct convert *convert, size_t kept)
{
    const struct import_soup *soup = convert->soup;
    struct mesh *mesh = convert->mesh;
    uint32_t *counts = ARENA_ARRAY(convert->scratch, uint32_t, mesh->materials_count);
    uint32_t *starts = ARENA_ARRAY(convert->scratch, uint32_t, mesh->materials_count);
    uint32_t *leaf_number = ARENA_ARRAY(convert->scratch, uint32_t, soup->vertices_count);
    uint32_t *members = ARENA_ARRAY(convert->scratch, uint32_t, kept);
    memset(leaf_number, 0xff, soup->vertices_count * sizeof *leaf_number);
    for (size_t i = 0; i < soup->triangles_count; i++)
        counts[soup->triangle_material[i]] += convert->keep[i];
    mesh->parts = ARENA_ARRAY(convert->arena, struct mesh_part, mesh->materials_count);
    uint32_t next = 0;
    for (int kind = MATERIAL_BARK; kind <= MATERIAL_LEAF; kind++)
        for (size_t m = 0; m < mesh->materials_count; m++) {
            if ((int)mesh->materials[m].kind != kind || counts[m] == 0)
                continue;
            mesh->parts[mesh->parts_count++] =
                (struct mesh_part){next, counts[m], (uint32_t)m, NULL, 0};
            starts[m] = next;
            next += counts[m];
        }
    for (size_t i = 0; i < soup->triangles_count; i++)
        if (convert->keep[i])
            members[starts[soup->triangle_material[i]]++] = (uint32_t)i;
    convert->order = ARENA_ARRAY(convert->scratch, uint32_t, kept);
    memcpy(convert->order, members, kept * sizeof *members);
    for (size_t i = 0; i < mesh->parts_count; i++)
        if (mesh->materials[mesh->parts[i].material].kind == MATERIAL_LEAF)
            order_leaves(convert, &mesh->parts[i], leaf_number,
                         members + mesh->parts[i].first_triangle);
}

/* Area-weighted means over all bark triangles at a point. */
static void smooth_bark(struct convert *convert)
{
    const struct import_soup *soup = convert->soup;
    convert->smooth = arena_alloc(convert->scratch, soup->vertices_count, sizeof(float[3]));
    for (size_t i = 0; i < soup->triangles_count; i++) {
        if (!convert->keep[i] || is_leaf(convert, i))
            continue;
        double cross[3];
        cross_of(convert, i, cross);
        for (int corner = 0; corner < 3; corner++)
            for (int k = 0; k < 3; k++)
                convert->smooth[convert->point[soup->triangles[i][corner]]][k] += (float)cross[k];
    }
}

static bool unit(const float from[3], float to[3])
{
    double v[3] = {(double)from[0], (double)from[1], (double)from[2]};
    double length = length3(v);
    if (!(length > 1e-30) || !isfinite(length))
        return false;
    for (int k = 0; k < 3; k++)
        to[k] = (float)(v[k] / length);
    return true;
}

/* The file's normal, else the smooth one on bark, else the triangle's. */
static void corner_normal(const struct convert *convert, size_t triangle, uint32_t vertex,
                          float normal[3])
{
    if (unit(convert->soup->normals[vertex], normal))
        return;
    if (!is_leaf(convert, triangle) && unit(convert->smooth[convert->point[vertex]], normal))
        return;
    double cross[3];
    cross_of(convert, triangle, cross);
    double length = length3(cross);
    for (int k = 0; k < 3; k++)
        normal[k] = (float)(cross[k] / length);
}

/* A vertex with all that belongs to it; equal bytes are one vertex. */
struct corner {
    float position[3], normal[3], uv[2], color[3];
};

static void fill_corner(const struct convert *convert, size_t triangle, uint32_t vertex,
                        struct corner *corner)
{
    const struct import_soup *soup = convert->soup;
    const struct import_request *request = convert->request;
    memset(corner, 0, sizeof *corner);
    memcpy(corner->position, soup->positions[vertex], sizeof corner->position);
    corner_normal(convert, triangle, vertex, corner->normal);
    bool overridden = is_leaf(convert, triangle) ? request->leaf_albedo : request->bark_albedo;
    if (soup->uvs)
        memcpy(corner->uv, soup->uvs[vertex], sizeof corner->uv);
    for (int k = 0; k < 3; k++)
        corner->color[k] = soup->colors && !overridden ? soup->colors[vertex][k] : 1;
}

static void make_vertices(struct convert *convert, size_t kept)
{
    const struct import_soup *soup = convert->soup;
    struct mesh *mesh = convert->mesh;
    struct set set = set_new(convert->scratch, 3 * kept);
    struct corner *corners = ARENA_ARRAY(convert->scratch, struct corner, 3 * kept);
    mesh->triangles_count = kept;
    mesh->triangles = arena_alloc(convert->arena, kept, sizeof(uint32_t[3]));
    uint32_t count = 0;
    for (size_t i = 0; i < kept; i++)
        for (int k = 0; k < 3; k++) {
            uint32_t triangle = convert->order[i];
            fill_corner(convert, triangle, soup->triangles[triangle][k], &corners[count]);
            uint32_t number = set_find(&set, corners, sizeof *corners, count);
            mesh->triangles[i][k] = number;
            count += number == count;
        }
    mesh->vertices_count = count;
    mesh->positions = arena_alloc(convert->arena, count, sizeof(float[3]));
    mesh->normals = arena_alloc(convert->arena, count, sizeof(float[3]));
    mesh->uvs = soup->uvs ? arena_alloc(convert->arena, count, sizeof(float[2])) : NULL;
    mesh->colors = soup->colors ? arena_alloc(convert->arena, count, sizeof(float[3])) : NULL;
    for (uint32_t i = 0; i < count; i++) {
        memcpy(mesh->positions[i], corners[i].position, sizeof(float[3]));
        memcpy(mesh->normals[i], corners[i].normal, sizeof(float[3]));
        if (mesh->uvs)
            memcpy(mesh->uvs[i], corners[i].uv, sizeof(float[2]));
        if (mesh->colors)
            memcpy(mesh->colors[i], corners[i].color, sizeof(float[3]));
    }
}

enum status import_convert(struct arena *arena, const struct import_request *request,
                           struct import_soup *soup, const struct texture *const *textures,
                           const bool *has_holes, struct mesh **mesh, struct error *error)
{
    struct convert convert = {.arena = arena, .request = request, .soup = soup, .error = error};
    convert.mesh = ARENA_NEW(arena, struct mesh);
    size_t kept = 0;
    enum status status = classify(&convert, textures, has_holes);
    if (status != STATUS_OK)
        return status;
    convert.scratch = arena_create(0);
    if (request->z_up)
        turn_soup(soup);
    weld(&convert);
    status = drop_degenerate(&convert, &kept);
    if (status == STATUS_OK && !convert.has_leaves && !request->leaf)
        classify_by_shape(&convert);
    if (status == STATUS_OK)
        status = place_soup(&convert);
    if (status == STATUS_OK) {
        connect_leaves(&convert);
        make_parts(&convert, kept);
        smooth_bark(&convert);
        make_vertices(&convert, kept);
        mesh_bounds(convert.mesh);
        *mesh = convert.mesh;
    }
    arena_destroy(convert.scratch);
    return status;
}
