/* From a soup of triangles to a plant's mesh: placed, classified, welded, ordered by part and leaf.
 *
 * 1. each material is bark or leaf, by its name or because its texture has holes;
 * 2. vertices of equal position are one point; triangles without area are dropped;
 *    where no material is a leaf's, connected pieces that are flat and open are leaves;
 * 3. axes turned to +y up, scaled to the height wanted, foot moved to the origin;
 * 4. triangles that share points make one leaf;
 * 5. bark parts, then leaf parts, a leaf's triangles side by side;
 * 6. missing normals: smooth over points on bark, flat on leaves; equal vertices are shared. */
#include "plant/import_parts.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

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

/* Less than a ten-millionth as high as long is rounding, not area. */
static bool has_area(const struct convert *convert, size_t triangle)
{
    const uint32_t *t = convert->soup->triangles[triangle];
    double cross[3], longest = 0;
    import_cross(convert, triangle, cross);
    for (int k = 0; k < 3; k++) {
        const float *a = convert->soup->positions[t[k]];
        const float *b = convert->soup->positions[t[(k + 1) % 3]];
        double edge[3] = {(double)b[0] - (double)a[0], (double)b[1] - (double)a[1],
                          (double)b[2] - (double)a[2]};
        longest = fmax(longest, import_length(edge));
    }
    double area = import_length(cross);
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
        import_assemble(&convert, kept);
        *mesh = convert.mesh;
    }
    arena_destroy(convert.scratch);
    return status;
}
