/* A plant under a grid of lines of sight, band by band; what they find becomes texels. */
#include "bake/slices_bake.h"

#include "bake/atlas_bake.h"
#include "bake/slices_lines.h"
#include "bake/views.h"
#include "base/color.h"
#include "plant/normals.h"

#include <math.h>
#include <string.h>

enum { CHUNK = 1024, BAND_LINES = 1 << 15 };

/* One covered texel of one slice, as a band of rows finds it. */
struct found {
    uint16_t slice, row, column, depth;
    uint8_t color[4], normal[4];
};

struct chunk {
    struct chunk *next;
    size_t count;
    struct found found[CHUNK];
    uint8_t (*lit)[3]; /* CHUNK x lights_count */
};

/* Rows of a stack that one thread gathers at a time. */
struct rows {
    struct arena *arena;
    struct chunk *chunks; /* newest first */
};

/* Area-weighted centroid of triangles [first, end). */
static void centroid_of(const struct mesh *mesh, uint32_t first, uint32_t end, float centroid[3])
{
    double sum[3] = {0}, weights = 0;
    for (uint32_t t = first; t < end; t++) {
        const float *p[3];
        double cross[3];
        for (int k = 0; k < 3; k++)
            p[k] = mesh->positions[mesh->triangles[t][k]];
        triangle_cross(p[0], p[1], p[2], cross);
        double weight =
            sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]) + 1e-12;
        for (int i = 0; i < 3; i++)
            sum[i] += weight * ((double)p[0][i] + p[1][i] + p[2][i]) / 3;
        weights += weight;
    }
    for (int i = 0; i < 3; i++)
        centroid[i] = (float)(sum[i] / weights);
}

/* Chooses the triangles and finds their leaves' centroids. */
static void choose(struct arena *arena, struct slices_baking *bake)
{
    const struct mesh *mesh = bake->mesh;
    const struct slices_request *request = bake->request;
    bake->triangles = ARENA_ARRAY(arena, uint32_t, mesh->triangles_count);
    bake->material = ARENA_ARRAY(arena, uint32_t, mesh->triangles_count);
    if (request->cut == SLICES_CENTROID)
        bake->centroid = arena_alloc(arena, mesh->triangles_count, sizeof *bake->centroid);
    for (size_t i = 0; i < mesh->parts_count; i++) {
        const struct mesh_part *part = &mesh->parts[i];
        bool leaf = mesh->materials[part->material].kind == MATERIAL_LEAF;
        uint32_t end = part->first_triangle + part->triangles_count;
        for (uint32_t t = part->first_triangle; t < end; t++) {
            bake->material[t] = part->material;
            if (request->parts & (leaf ? SLICES_LEAVES : SLICES_BARK))
                bake->triangles[bake->triangles_count++] = t;
        }
        for (uint32_t e = 0; bake->centroid && e < part->elements_count; e++) {
            uint32_t first = part->element_first[e], last = part->element_first[e + 1];
            centroid_of(mesh, first, last, bake->centroid[first]);
            for (uint32_t t = first + 1; t < last; t++)
                memcpy(bake->centroid[t], bake->centroid[first], sizeof *bake->centroid);
        }
    }
}

/* The box of the wanted triangles, with the empty ring around. */
static void place_box(const struct slices_baking *bake, struct slices_stack *stack)
{
    const float *axes[3] = {stack->right, stack->up, stack->toward};
    const int sides[2] = {bake->request->width_px, bake->request->height_px};
    float largest = 0;
    for (int k = 0; k < 3; k++) {
        stack->low_m[k] = INFINITY;
        stack->high_m[k] = -INFINITY;
    }
    for (size_t i = 0; i < 3 * bake->triangles_count; i++) {
        const float *p =
            bake->mesh->positions[bake->mesh->triangles[bake->triangles[i / 3]][i % 3]];
        for (int k = 0; k < 3; k++) {
            float s = slices_dot(p, axes[k]);
            stack->low_m[k] = fminf(stack->low_m[k], s);
            stack->high_m[k] = fmaxf(stack->high_m[k], s);
        }
    }
    for (int k = 0; k < 3; k++) {
        if (bake->triangles_count == 0)
            stack->low_m[k] = stack->high_m[k] = 0;
        largest = fmaxf(largest, stack->high_m[k] - stack->low_m[k]);
    }
    /* What is flat gets some thickness. */
    for (int k = 0; k < 3; k++) {
        float size = stack->high_m[k] - stack->low_m[k];
        float more = fmaxf(fmaxf(1e-6f, 1e-4f * largest) - size, 0) / 2;
        if (k < 2 && sides[k] >= 8)
            more += (size + 2 * more) / (float)(sides[k] - 2);
        stack->low_m[k] -= more;
        stack->high_m[k] += more;
    }
}

/* Vertices in units of lines and slabs. */
static void project(struct arena *arena, struct slices_sight *sight)
{
    const struct slices_baking *bake = sight->bake;
    const struct slices_request *request = bake->request;
    const struct slices_stack *stack = sight->stack;
    const struct mesh *mesh = bake->mesh;
    float *depths = ARENA_ARRAY(arena, float, mesh->vertices_count);
    double scale[3];
    const int counts[3] = {request->width_px * request->samples * 1024,
                           request->height_px * request->samples * 1024, request->count};
    for (int k = 0; k < 3; k++)
        scale[k] = counts[k] / ((double)stack->high_m[k] - stack->low_m[k]);
    sight->plane = (struct raster_plane){
        .width = request->width_px * request->samples,
        .height = request->height_px * request->samples,
        .points = arena_alloc(arena, mesh->vertices_count, sizeof *sight->plane.points),
        .depths = depths,
        .triangles = (const uint32_t(*)[3])mesh->triangles,
    };
#pragma omp parallel for num_threads(bake->threads)
    for (size_t i = 0; i < mesh->vertices_count; i++) {
        const float *p = mesh->positions[i];
        double x = scale[0] * (slices_dot(p, stack->right) - stack->low_m[0]);
        double y = scale[1] * (slices_dot(p, stack->up) - stack->low_m[1]);
        /* Vertices of unwanted parts may lie outside. */
        sight->plane.points[i][0] = (int32_t)lrint(fmin(fmax(x, -1e6), counts[0] + 1e6));
        sight->plane.points[i][1] = (int32_t)lrint(fmin(fmax(y, -1e6), counts[1] + 1e6));
        depths[i] = (float)(scale[2] * (slices_dot(p, stack->toward) - stack->low_m[2]));
    }
    if (!bake->centroid)
        return;
    sight->slab = ARENA_ARRAY(arena, int16_t, mesh->triangles_count);
    for (size_t i = 0; i < bake->triangles_count; i++) {
        uint32_t t = bake->triangles[i];
        int slab =
            (int)(scale[2] * (slices_dot(bake->centroid[t], stack->toward) - stack->low_m[2]));
        slab = slab < 0 ? 0 : slab >= request->count ? request->count - 1 : slab;
        sight->slab[t] = (int16_t)(slices_is_leaf(bake, t) ? slab : -1);
    }
}

/* The place of the next texel; *lit: of its lit colours. */
static struct found *found_next(struct rows *rows, size_t lights_count, uint8_t (**lit)[3])
{
    if (!rows->chunks || rows->chunks->count == CHUNK) {
        struct chunk *chunk = ARENA_NEW(rows->arena, struct chunk);
        chunk->next = rows->chunks;
        chunk->lit = arena_alloc(rows->arena, CHUNK * lights_count, sizeof *chunk->lit);
        rows->chunks = chunk;
    }
    *lit = rows->chunks->lit + rows->chunks->count * lights_count;
    return &rows->chunks->found[rows->chunks->count++];
}

/* Turns the touched slabs into texels and empties them. */
static void column_flush(const struct slices_sight *sight, struct slices_column *column,
                         struct rows *rows, int x, int y)
{
    int samples = sight->bake->request->samples;
    size_t lights_count = sight->bake->request->lights_count;
    float share = 1 / (float)(samples * samples), scale = sight->bake->slices->albedo_scale;
    for (int n = 0; n < column->touched_count; n++) {
        struct slices_cell *cell = &column->cells[column->touched[n]];
        uint8_t(*lit)[3];
        float(*sums)[3] = column->lit + (size_t)column->touched[n] * lights_count;
        struct found *found = found_next(rows, lights_count, &lit);
        float inverse = 1 / (float)cell->count;
        found->slice = (uint16_t)column->touched[n];
        found->row = (uint16_t)y;
        found->column = (uint16_t)x;
        found->depth = (uint16_t)(65535 * inverse * cell->depth + 0.5f);
        for (int k = 0; k < 3; k++) {
            found->color[k] = color_byte(cell->color[k] * share / scale);
            found->normal[k] = (uint8_t)(128 + lrintf(127 * inverse * cell->normal[k]));
        }
        found->color[3] = color_byte((float)cell->count * share);
        found->normal[3] = color_byte((float)cell->leaves * inverse);
        for (size_t k = 0; k < 3 * lights_count; k++)
            lit[k / 3][k % 3] =
                color_byte(sums[k / 3][k % 3] * share / sight->bake->slices->lit_scale);
        memset(cell, 0, sizeof *cell);
        memset(sums, 0, lights_count * sizeof *sums);
    }
    column->touched_count = 0;
}

/* Gathers `rows_count` rows of texels from row y on. */
static void bake_rows(const struct slices_sight *sight, const uint32_t *list, size_t count, int y,
                      int rows_count, struct rows *rows)
{
    const struct slices_request *request = sight->bake->request;
    struct arena *scratch = arena_create(0);
    struct raster_band band;
    struct slices_column column = {
        .cells = ARENA_ARRAY(scratch, struct slices_cell, (size_t)request->count),
        .touched = ARENA_ARRAY(scratch, int, (size_t)request->count),
        .lit = arena_alloc(scratch, (size_t)request->count * request->lights_count,
                           sizeof *column.lit),
    };
    int samples = request->samples;
    rows->arena = arena_create(0);
    raster_cast(scratch, &sight->plane, list, count, y * samples, rows_count * samples, &band);
    for (int row = 0; row < rows_count; row++)
        for (int x = 0; x < request->width_px; x++) {
            for (int n = 0; n < samples * samples; n++) {
                int i = x * samples + n % samples, j = row * samples + n / samples;
                size_t at = (size_t)j * (size_t)sight->plane.width + (size_t)i;
                size_t hits = band.first[at + 1] - band.first[at];
                if (hits > 0)
                    slices_line(sight, &column, band.hits + band.first[at], hits, i,
                                y * samples + j);
            }
            column_flush(sight, &column, rows, x, y + row);
        }
    arena_destroy(scratch);
}

/* A stack's normals face the front: seen from behind, leaves' are negated and bark's mirrored, or
 * the sun is. Suns are squeezed as normals are to be: N.(D L) = (D N).L. */
static void turn_suns(struct arena *arena, struct slices_sight *sight)
{
    const struct slices_request *request = sight->bake->request;
    const float *toward = sight->stack->toward;
    sight->suns = arena_alloc(arena, request->lights_count, sizeof *sight->suns);
    for (size_t n = 0; n < request->lights_count; n++) {
        const struct slices_light *light = &request->lights[n];
        float squeezed[3];
        memcpy(squeezed, light->sun_direction, sizeof squeezed);
        squeezed[1] /= light->stretch > 0 ? light->stretch : 1;
        float along = slices_dot(squeezed, toward);
        for (int k = 0; k < 3; k++) {
            float sun = squeezed[k];
            sight->suns[n][0][k] = light->from_behind ? -sun : sun;
            sight->suns[n][1][k] = light->from_behind ? sun - 2 * along * toward[k] : sun;
        }
    }
}

/* The most that light makes of a white surface. */
static float brightest_light(const struct slices_request *request)
{
    float most = 0;
    for (size_t n = 0; n < request->lights_count; n++)
        for (int k = 0; k < 3; k++)
            most = fmaxf(most, request->lights[n].sun_radiance[k] + request->lights[n].ambient[k]);
    return most > 0 ? most : 1;
}

/* Which triangles meet which band of rows: band b's are list[first[b]], ..., first[b + 1] - 1. */
static uint32_t *bin(struct arena *arena, const struct slices_sight *sight, int lines, int bands,
                     size_t *first)
{
    const struct slices_baking *bake = sight->bake;
    uint32_t *list = NULL;
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < bake->triangles_count; i++) {
            int low, high;
            raster_rows(&sight->plane, bake->triangles[i], &low, &high);
            for (int b = low / lines; low <= high && b <= high / lines; b++) {
                if (pass)
                    list[first[b]] = bake->triangles[i];
                first[b + !pass]++;
            }
        }
        for (int b = 0; pass == 0 && b < bands; b++)
            first[b + 1] += first[b];
        if (pass == 0)
            list = ARENA_ARRAY(arena, uint32_t, first[bands]);
    }
    for (int b = bands; b > 0; b--)
        first[b] = first[b - 1];
    first[0] = 0;
    return list;
}

/* Bakes one stack into bands of found texels. */
static void bake_stack(const struct slices_baking *bake, size_t index, int band_rows, int bands,
                       struct rows *rows)
{
    const struct slices_request *request = bake->request;
    struct slices_stack *stack = &bake->slices->stacks[index];
    struct arena *scratch = arena_create(0);
    struct slices_sight sight = {.bake = bake, .stack = stack};
    memcpy(stack->toward, request->directions[index], sizeof stack->toward);
    views_plane(stack->toward, stack->right, stack->up);
    place_box(bake, stack);
    project(scratch, &sight);
    turn_suns(scratch, &sight);
    size_t *first = ARENA_ARRAY(scratch, size_t, (size_t)bands + 1);
    const uint32_t *list = bin(scratch, &sight, band_rows * request->samples, bands, first);
#pragma omp parallel for num_threads(bake->threads) schedule(dynamic)
    for (int b = 0; b < bands; b++) {
        int y = b * band_rows;
        int count = request->height_px - y < band_rows ? request->height_px - y : band_rows;
        bake_rows(&sight, list + first[b], first[b + 1] - first[b], y, count, &rows[b]);
    }
    arena_destroy(scratch);
}

/* The slices' rectangles and where their texels begin. */
static void lay_out(struct slices *slices, const struct rows *rows, size_t bands)
{
    size_t slices_count = slices->stacks_count * (size_t)slices->count;
    for (size_t b = 0; b < slices->stacks_count * bands; b++)
        for (const struct chunk *chunk = rows[b].chunks; chunk; chunk = chunk->next)
            for (size_t i = 0; i < chunk->count; i++) {
                const struct found *found = &chunk->found[i];
                struct slice *slice =
                    &slices->slices[b / bands * (size_t)slices->count + found->slice];
                int x = found->column, y = found->row;
                if (slice->width == 0)
                    *slice = (struct slice){.left = x, .bottom = y, .width = 1, .height = 1};
                int right = slice->left + slice->width, top = slice->bottom + slice->height;
                slice->left = x < slice->left ? x : slice->left;
                slice->bottom = y < slice->bottom ? y : slice->bottom;
                slice->width = (x >= right ? x + 1 : right) - slice->left;
                slice->height = (y >= top ? y + 1 : top) - slice->bottom;
            }
    for (size_t i = 0; i < slices_count; i++) {
        struct slice *slice = &slices->slices[i];
        slice->first = slices->texels_count;
        slices->texels_count += (size_t)slice->width * (size_t)slice->height;
    }
}

static void scatter(struct slices *slices, const struct rows *rows, size_t bands)
{
    for (size_t b = 0; b < slices->stacks_count * bands; b++)
        for (const struct chunk *chunk = rows[b].chunks; chunk; chunk = chunk->next)
            for (size_t i = 0; i < chunk->count; i++) {
                const struct found *found = &chunk->found[i];
                const struct slice *slice =
                    &slices->slices[b / bands * (size_t)slices->count + found->slice];
                size_t at = slice->first +
                            (size_t)(found->row - slice->bottom) * (size_t)slice->width +
                            (size_t)(found->column - slice->left);
                memcpy(slices->color[at], found->color, sizeof found->color);
                memcpy(slices->normal[at], found->normal, sizeof found->normal);
                slices->depth[at] = found->depth;
                for (size_t n = 0; n < slices->lights_count; n++) {
                    uint8_t *lit = slices->lit[n * slices->texels_count + at];
                    memcpy(lit, chunk->lit[i * slices->lights_count + n], sizeof *chunk->lit);
                    lit[3] = found->color[3];
                }
            }
}

void slices_bake(struct arena *arena, const struct mesh *mesh, const struct slices_request *request,
                 int threads, struct slices *slices)
{
    struct arena *scratch = arena_create(0);
    struct slices_baking bake = {
        .mesh = mesh, .request = request, .slices = slices, .threads = threads > 0 ? threads : 1};
    *slices = (struct slices){
        .stacks_count = request->directions_count,
        .width_px = request->width_px,
        .height_px = request->height_px,
        .count = request->count,
        .albedo_scale = atlas_brightest(mesh),
        .lights_count = request->lights_count,
        .lit_scale = atlas_brightest(mesh) * brightest_light(request),
        .stacks = ARENA_ARRAY(arena, struct slices_stack, request->directions_count),
        .slices =
            ARENA_ARRAY(arena, struct slice, request->directions_count * (size_t)request->count),
    };
    choose(scratch, &bake);
    int lines = request->width_px * request->samples * request->samples;
    int band_rows = BAND_LINES / lines < 1 ? 1 : BAND_LINES / lines;
    int bands = (request->height_px + band_rows - 1) / band_rows;
    size_t rows_count = slices->stacks_count * (size_t)bands;
    struct rows *rows = ARENA_ARRAY(scratch, struct rows, rows_count);
    for (size_t i = 0; i < slices->stacks_count; i++)
        bake_stack(&bake, i, band_rows, bands, rows + i * (size_t)bands);
    lay_out(slices, rows, (size_t)bands);
    slices->color = arena_alloc(arena, slices->texels_count, sizeof *slices->color);
    slices->normal = arena_alloc(arena, slices->texels_count, sizeof *slices->normal);
    slices->depth = ARENA_ARRAY(arena, uint16_t, slices->texels_count);
    slices->lit =
        arena_alloc(arena, slices->lights_count * slices->texels_count, sizeof *slices->lit);
    scatter(slices, rows, (size_t)bands);
    for (size_t b = 0; b < rows_count; b++)
        arena_destroy(rows[b].arena);
    arena_destroy(scratch);
}
