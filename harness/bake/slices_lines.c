/* One line of sight through a plant: which hits count, in which slab, how they look. */
#include "bake/slices_lines.h"

#include "plant/texture.h"

#include <math.h>
#include <string.h>

/* How a hit looks. */
struct look {
    float color[3], normal[3];
    bool leaf; /* a thin one: needles are lit as bark is */
};

static int slab_of(const struct slices_sight *sight, const struct raster_hit *hit)
{
    int count = sight->bake->request->count;
    if (sight->slab && sight->slab[hit->triangle] >= 0)
        return sight->slab[hit->triangle];
    int slab = (int)floorf(hit->depth);
    return slab < 0 ? 0 : slab >= count ? count - 1 : slab;
}

/* Colour and normal of a hit; false where its texture is transparent. */
static bool look_at(const struct slices_sight *sight, uint32_t triangle, int i, int j,
                    struct look *look)
{
    const struct mesh *mesh = sight->bake->mesh;
    const struct material *material = &mesh->materials[sight->bake->material[triangle]];
    const uint32_t *corner = mesh->triangles[triangle];
    float weights[3], normal[3] = {0};
    raster_weights(&sight->plane, triangle, i, j, weights);
    memcpy(look->color, material->albedo, sizeof look->color);
    if (material->texture && mesh->uvs) {
        float uv[2], rgba[4];
        mesh_uv(mesh, triangle, weights[1], weights[2], uv);
        texture_sample(material->texture, uv, rgba);
        if (rgba[3] < 0.5f)
            return false;
        for (int k = 0; k < 3; k++)
            look->color[k] *= rgba[k];
    }
    for (int k = 0; k < 3; k++) {
        float tint = 0;
        for (int c = 0; c < 3; c++) {
            normal[k] += weights[c] * mesh->normals[corner[c]][k];
            tint += mesh->colors ? weights[c] * mesh->colors[corner[c]][k] : 0;
        }
        look->color[k] *= mesh->colors ? tint : 1;
    }
    look->leaf = material_is_thin(material);
    const float *toward = sight->stack->toward;
    float length = sqrtf(slices_dot(normal, normal)), along = slices_dot(normal, toward);
    bool facing = raster_area(&sight->plane, triangle) > 0;
    for (int k = 0; k < 3; k++) {
        float turned = look->leaf ? -normal[k] : normal[k] - 2 * along * toward[k];
        look->normal[k] = length > 0 ? (facing ? normal[k] : turned) / length : toward[k];
    }
    return true;
}

/* Was nothing counted there for this line yet? */
static bool slab_open(const struct slices_column *column, int slab)
{
    return column->cells[slab].line != column->line;
}

/* Of a normal as a tree's stretch turns it, before it is made 1 long again. */
static float tall_length(const float normal[3], float stretch)
{
    float y = normal[1] / stretch;
    return sqrtf(normal[0] * normal[0] + y * y + normal[2] * normal[2]);
}

/* Adds the radiance under every light. */
static void slab_light(const struct slices_sight *sight, const struct look *look, float (*lit)[3])
{
    const struct slices_request *request = sight->bake->request;
    for (size_t n = 0; n < request->lights_count; n++) {
        const struct slices_light *light = &request->lights[n];
        float d = slices_dot(look->normal, sight->suns[n][!look->leaf]);
        if (light->stretch > 0 && light->stretch != 1)
            d /= tall_length(look->normal, light->stretch);
        d = look->leaf && light->two_sided ? fabsf(d) : fmaxf(d, 0);
        for (int k = 0; k < 3; k++)
            lit[n][k] += look->color[k] * (d * light->sun_radiance[k] + light->ambient[k]);
    }
}

static void slab_add(const struct slices_sight *sight, struct slices_column *column, int slab,
                     const struct look *look, float depth)
{
    struct slices_cell *cell = &column->cells[slab];
    if (cell->count == 0)
        column->touched[column->touched_count++] = slab;
    cell->line = column->line;
    cell->count++;
    cell->leaves += look->leaf;
    for (int k = 0; k < 3; k++) {
        cell->color[k] += look->color[k];
        cell->normal[k] += look->normal[k];
    }
    cell->depth += fminf(fmaxf(depth - (float)slab, 0), 1);
    slab_light(sight, look, column->lit + (size_t)slab * sight->bake->request->lights_count);
}

/* Is bark entered as often as left, and never left before? Then it is closed along this line. */
static bool bark_closed(const struct slices_sight *sight, const struct raster_hit *hits,
                        size_t count)
{
    int inside = 0;
    for (size_t i = 0; i < count; i++) {
        if (slices_is_leaf(sight->bake, hits[i].triangle))
            continue;
        inside += raster_area(&sight->plane, hits[i].triangle) > 0 ? 1 : -1;
        if (inside < 0)
            return false;
    }
    return inside == 0;
}

/* What lies inside closed bark is as the surface that is nearer along the line, so that what shows
 * between slices has the normal of the side that it is seen from. */
static void slabs_fill(const struct slices_sight *sight, struct slices_column *column, int front,
                       int back, const struct look *entered, const struct look *left)
{
    for (int s = front - 1; s > back; s--)
        if (slab_open(column, s))
            slab_add(sight, column, s, front - s <= s - back ? entered : left, (float)s + 0.5f);
}

void slices_line(const struct slices_sight *sight, struct slices_column *column,
                 const struct raster_hit *hits, size_t count, int i, int j)
{
    bool closed = bark_closed(sight, hits, count), filled = false;
    int inside = 0, entered_slab = 0;
    struct look look, entered = {0};
    column->line++;
    for (size_t n = 0; n < count; n++) {
        int slab = slab_of(sight, &hits[n]);
        bool bark = !slices_is_leaf(sight->bake, hits[n].triangle);
        int after = inside + (raster_area(&sight->plane, hits[n].triangle) > 0 ? 1 : -1);
        bool open = slab_open(column, slab), entering = closed && bark && inside == 0;
        bool leaving = closed && bark && after == 0;
        bool known = (open || entering || leaving) && look_at(sight, hits[n].triangle, i, j, &look);
        if (known && open)
            slab_add(sight, column, slab, &look, hits[n].depth);
        if (!closed || !bark)
            continue;
        if (entering) {
            filled = known; /* not behind a hole of its texture */
            entered = look;
            entered_slab = slab;
        }
        if (leaving && filled)
            slabs_fill(sight, column, entered_slab, slab, &entered, known ? &look : &entered);
        inside = after;
    }
}
