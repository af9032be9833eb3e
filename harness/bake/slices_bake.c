/* Lines of sight through a plant, cut into slabs and gathered into texels. */
#include "bake/slices_bake.h"

#include "bake/atlas_bake.h"
#include "bake/slices_raster.h"
#include "bake/views.h"
#include "plant/normals.h"
#include "truth/reference_parts.h"

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
};

/* Rows of a stack that one thread gathers at a time. */
struct rows {
    struct arena *arena;
    struct chunk *chunks; /* newest first */
};

/* Facts of a triangle that do not depend on the direction. */
struct bake {
    const struct mesh *mesh;
    const struct slices_request *request;
    struct slices *slices;
    int threads;
    uint32_t *triangles; /* those wanted */
    size_t triangles_count;
    uint32_t *material;   /* mesh's triangles */
    float (*centroid)[3]; /* mesh's triangles: of the leaf; NULL: by depth */
};

struct stack_bake {
    const struct bake *bake;
    const struct slices_stack *stack;
    struct raster_plane plane;
    int16_t *slab; /* mesh's triangles; -1: by depth; NULL: all by depth */
};

/* What falls into one slab of one texel. */
struct cell {
    uint32_t line; /* last line of sight counted, from 1 */
    int count, leaves;
    float color[3], normal[3], depth;
};

/* A slab's worth of one line of sight. */
struct look {
    float color[3], normal[3];
    bool leaf;
};

/* One thread's row of slabs. */
struct column {
    struct cell *cells; /* request->count */
    int *touched;
    int touched_count;
    uint32_t line;
};

static bool is_leaf(const struct bake *bake, uint32_t triangle)
{
    return bake->mesh->materials[bake->material[triangle]].kind == MATERIAL_LEAF;
}

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
static void choose(struct arena *arena, struct bake *bake)
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

static float dot3(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The box of the wanted triangles, with the empty ring around. */
static void place_box(const struct bake *bake, struct slices_stack *stack)
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
            float s = dot3(p, axes[k]);
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
static void project(struct arena *arena, struct stack_bake *work)
{
    const struct bake *bake = work->bake;
    const struct slices_request *request = bake->request;
    const struct slices_stack *stack = work->stack;
    const struct mesh *mesh = bake->mesh;
    float *depths = ARENA_ARRAY(arena, float, mesh->vertices_count);
    double scale[3];
    const int counts[3] = {request->width_px * request->samples * 1024,
                           request->height_px * request->samples * 1024, request->count};
    for (int k = 0; k < 3; k++)
        scale[k] = counts[k] / ((double)stack->high_m[k] - stack->low_m[k]);
    work->plane = (struct raster_plane){
        .width = request->width_px * request->samples,
        .height = request->height_px * request->samples,
        .points = arena_alloc(arena, mesh->vertices_count, sizeof *work->plane.points),
        .depths = depths,
        .triangles = (const uint32_t(*)[3])mesh->triangles,
    };
#pragma omp parallel for num_threads(bake->threads)
    for (size_t i = 0; i < mesh->vertices_count; i++) {
        const float *p = mesh->positions[i];
        double x = scale[0] * (dot3(p, stack->right) - stack->low_m[0]);
        double y = scale[1] * (dot3(p, stack->up) - stack->low_m[1]);
        /* Vertices of unwanted parts may lie outside. */
        work->plane.points[i][0] = (int32_t)lrint(fmin(fmax(x, -1e6), counts[0] + 1e6));
        work->plane.points[i][1] = (int32_t)lrint(fmin(fmax(y, -1e6), counts[1] + 1e6));
        depths[i] = (float)(scale[2] * (dot3(p, stack->toward) - stack->low_m[2]));
    }
    if (!bake->centroid)
        return;
    work->slab = ARENA_ARRAY(arena, int16_t, mesh->triangles_count);
    for (size_t i = 0; i < bake->triangles_count; i++) {
        uint32_t t = bake->triangles[i];
        int slab = (int)(scale[2] * (dot3(bake->centroid[t], stack->toward) - stack->low_m[2]));
        slab = slab < 0 ? 0 : slab >= request->count ? request->count - 1 : slab;
        work->slab[t] = (int16_t)(is_leaf(bake, t) ? slab : -1);
    }
}

static int slab_of(const struct stack_bake *work, const struct raster_hit *hit)
{
    int count = work->bake->request->count;
    if (work->slab && work->slab[hit->triangle] >= 0)
        return work->slab[hit->triangle];
    int slab = (int)floorf(hit->depth);
    return slab < 0 ? 0 : slab >= count ? count - 1 : slab;
}

/* Colour and normal of a hit; false where its texture is transparent. */
static bool look_at(const struct stack_bake *work, uint32_t triangle, int i, int j,
                    struct look *look)
{
    const struct mesh *mesh = work->bake->mesh;
    const struct material *material = &mesh->materials[work->bake->material[triangle]];
    const uint32_t *corner = mesh->triangles[triangle];
    float weights[3], normal[3] = {0};
    raster_weights(&work->plane, triangle, i, j, weights);
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
    look->leaf = material->kind == MATERIAL_LEAF;
    const float *toward = work->stack->toward;
    float length = sqrtf(dot3(normal, normal)), along = dot3(normal, toward);
    bool facing = raster_area(&work->plane, triangle) > 0;
    for (int k = 0; k < 3; k++) {
        float turned = look->leaf ? -normal[k] : normal[k] - 2 * along * toward[k];
        look->normal[k] = length > 0 ? (facing ? normal[k] : turned) / length : toward[k];
    }
    return true;
}

/* Counts a look into a slab, unless something in front of it was counted there for this line. */
static bool slab_open(const struct column *column, int slab)
{
    return column->cells[slab].line != column->line;
}

static void slab_add(struct column *column, int slab, const struct look *look, float depth)
{
    struct cell *cell = &column->cells[slab];
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
}

/* Is bark entered as often as left, and never left before? Then it is closed along this line. */
static bool bark_closed(const struct stack_bake *work, const struct raster_hit *hits, size_t count)
{
    int inside = 0;
    for (size_t i = 0; i < count; i++) {
        if (is_leaf(work->bake, hits[i].triangle))
            continue;
        inside += raster_area(&work->plane, hits[i].triangle) > 0 ? 1 : -1;
        if (inside < 0)
            return false;
    }
    return inside == 0;
}

/* One line of sight, foremost hit first. */
static void line_add(const struct stack_bake *work, struct column *column,
                     const struct raster_hit *hits, size_t count, int i, int j)
{
    bool closed = bark_closed(work, hits, count), filled = false;
    int inside = 0, entered_slab = 0;
    struct look look, entered = {0};
    column->line++;
    for (size_t n = 0; n < count; n++) {
        int slab = slab_of(work, &hits[n]);
        bool bark = !is_leaf(work->bake, hits[n].triangle);
        bool open = slab_open(column, slab), entering = closed && bark && inside == 0;
        bool known = (open || entering) && look_at(work, hits[n].triangle, i, j, &look);
        if (known && open)
            slab_add(column, slab, &look, hits[n].depth);
        if (!closed || !bark)
            continue;
        if (entering) {
            filled = known; /* not behind a hole of its texture */
            entered = look;
            entered_slab = slab;
        }
        inside += raster_area(&work->plane, hits[n].triangle) > 0 ? 1 : -1;
        for (int s = entered_slab - 1; filled && inside == 0 && s > slab; s--)
            if (slab_open(column, s))
                slab_add(column, s, &entered, (float)s + 0.5f);
    }
}

static uint8_t byte_of(float value)
{
    return (uint8_t)(fminf(fmaxf(value, 0), 1) * 255 + 0.5f);
}

static struct found *found_next(struct rows *rows)
{
    if (!rows->chunks || rows->chunks->count == CHUNK) {
        struct chunk *chunk = ARENA_NEW(rows->arena, struct chunk);
        chunk->next = rows->chunks;
        rows->chunks = chunk;
    }
    return &rows->chunks->found[rows->chunks->count++];
}

/* Turns the touched slabs into texels and empties them. */
static void column_flush(const struct stack_bake *work, struct column *column, struct rows *rows,
                         int x, int y)
{
    int samples = work->bake->request->samples;
    float share = 1 / (float)(samples * samples), scale = work->bake->slices->albedo_scale;
    for (int n = 0; n < column->touched_count; n++) {
        struct cell *cell = &column->cells[column->touched[n]];
        struct found *found = found_next(rows);
        float inverse = 1 / (float)cell->count;
        found->slice = (uint16_t)column->touched[n];
        found->row = (uint16_t)y;
        found->column = (uint16_t)x;
        found->depth = (uint16_t)(65535 * inverse * cell->depth + 0.5f);
        for (int k = 0; k < 3; k++) {
            found->color[k] = byte_of(cell->color[k] * share / scale);
            found->normal[k] = (uint8_t)(128 + lrintf(127 * inverse * cell->normal[k]));
        }
        found->color[3] = byte_of((float)cell->count * share);
        found->normal[3] = byte_of((float)cell->leaves * inverse);
        memset(cell, 0, sizeof *cell);
    }
    column->touched_count = 0;
}

/* Gathers `rows_count` rows of texels from row y on. */
static void bake_rows(const struct stack_bake *work, const uint32_t *list, size_t count, int y,
                      int rows_count, struct rows *rows)
{
    const struct slices_request *request = work->bake->request;
    struct arena *scratch = arena_create(0);
    struct raster_band band;
    struct column column = {
        .cells = ARENA_ARRAY(scratch, struct cell, (size_t)request->count),
        .touched = ARENA_ARRAY(scratch, int, (size_t)request->count),
    };
    int samples = request->samples;
    rows->arena = arena_create(0);
    raster_cast(scratch, &work->plane, list, count, y * samples, rows_count * samples, &band);
    for (int row = 0; row < rows_count; row++)
        for (int x = 0; x < request->width_px; x++) {
            for (int n = 0; n < samples * samples; n++) {
                int i = x * samples + n % samples, j = row * samples + n / samples;
                size_t at = (size_t)j * (size_t)work->plane.width + (size_t)i;
                size_t hits = band.first[at + 1] - band.first[at];
                if (hits > 0)
                    line_add(work, &column, band.hits + band.first[at], hits, i, y * samples + j);
            }
            column_flush(work, &column, rows, x, y + row);
        }
    arena_destroy(scratch);
}

/* Which triangles meet which band of rows: band b's are list[first[b]], ..., first[b + 1] - 1. */
static uint32_t *bin(struct arena *arena, const struct stack_bake *work, int lines, int bands,
                     size_t *first)
{
    const struct bake *bake = work->bake;
    uint32_t *list = NULL;
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < bake->triangles_count; i++) {
            int low, high;
            raster_rows(&work->plane, bake->triangles[i], &low, &high);
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
static void bake_stack(const struct bake *bake, size_t index, int band_rows, int bands,
                       struct rows *rows)
{
    const struct slices_request *request = bake->request;
    struct slices_stack *stack = &bake->slices->stacks[index];
    struct arena *scratch = arena_create(0);
    struct stack_bake work = {.bake = bake, .stack = stack};
    memcpy(stack->toward, request->directions[index], sizeof stack->toward);
    views_plane(stack->toward, stack->right, stack->up);
    place_box(bake, stack);
    project(scratch, &work);
    size_t *first = ARENA_ARRAY(scratch, size_t, (size_t)bands + 1);
    const uint32_t *list = bin(scratch, &work, band_rows * request->samples, bands, first);
#pragma omp parallel for num_threads(bake->threads) schedule(dynamic)
    for (int b = 0; b < bands; b++) {
        int y = b * band_rows;
        int count = request->height_px - y < band_rows ? request->height_px - y : band_rows;
        bake_rows(&work, list + first[b], first[b + 1] - first[b], y, count, &rows[b]);
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
            }
}

void slices_bake(struct arena *arena, const struct mesh *mesh, const struct slices_request *request,
                 int threads, struct slices *slices)
{
    struct arena *scratch = arena_create(0);
    struct bake bake = {
        .mesh = mesh, .request = request, .slices = slices, .threads = threads > 0 ? threads : 1};
    *slices = (struct slices){
        .stacks_count = request->directions_count,
        .width_px = request->width_px,
        .height_px = request->height_px,
        .count = request->count,
        .albedo_scale = atlas_brightest(mesh),
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
    scatter(slices, rows, (size_t)bands);
    for (size_t b = 0; b < rows_count; b++)
        arena_destroy(rows[b].arena);
    arena_destroy(scratch);
}
