/* Voxel colouring: back projection, visibility, agreement. */
#include "plant/coloring_view.h"

#include <math.h>
#include <string.h>

/* What the rays say of a voxel in which one ended. */
struct gathered {
    uint32_t cell, hits, passes, views;
    uint32_t view_hits, view_passes, view_blocked; /* rays of the view at hand */
    float view_color[3], view_m2;
    float color[3], normal[3], point_m[3], leaf; /* sums over hits */
    float means[3], squares[3];                  /* sums of the views' mean colours */
    float shadows, facings; /* sums over views of area seen x |cosine|, cosine^2 */
    float chords_m;         /* sum over rays */
    bool carved;
};

struct volume {
    int grid;
    float minimum_m[3], voxel_m[3];
    uint32_t *cells;
    struct gathered *gathered; /* cells hold COLORING_FIRST + index */
    size_t count;
};

/* The cell of a point; false outside of the box. */
static bool cell_of(const struct volume *volume, const float point_m[3], int cell[3])
{
    for (int i = 0; i < 3; i++) {
        float at = (point_m[i] - volume->minimum_m[i]) / volume->voxel_m[i];
        if (!(at >= 0 && at < (float)volume->grid)) /* not finite: outside */
            return false;
        cell[i] = (int)at;
    }
    return true;
}

static size_t cell_index(const struct volume *volume, const int cell[3])
{
    size_t n = (size_t)volume->grid;
    return ((size_t)cell[2] * n + (size_t)cell[1]) * n + (size_t)cell[0];
}

static struct gathered *gathered_at(const struct volume *volume, const int cell[3])
{
    return &volume->gathered[volume->cells[cell_index(volume, cell)] - COLORING_FIRST];
}

/* Where a pixel's ray ends: its point and cell; false where nothing in the box is hit. */
static bool pixel_hit(const struct volume *volume, const struct depth_view *view, int column,
                      int row, float point_m[3], int cell[3])
{
    float depth = view->depth_m[(size_t)row * (size_t)view->width_px + (size_t)column];
    if (!(depth > 0) || !isfinite(depth))
        return false;
    depth_view_point(view, column, row, depth, point_m);
    return cell_of(volume, point_m, cell);
}

/* First sweep: which voxels does a ray end in? */
static void find_hits(struct arena *arena, struct volume *volume, const struct depth_view *views,
                      size_t views_count)
{
    float point[3];
    int cell[3];
    for (size_t v = 0; v < views_count; v++)
        for (int y = 0; y < views[v].height_px; y++)
            for (int x = 0; x < views[v].width_px; x++) {
                if (pixel_hit(volume, &views[v], x, y, point, cell))
                    volume->cells[cell_index(volume, cell)] = COLORING_FIRST;
            }
    size_t cells = (size_t)volume->grid * (size_t)volume->grid * (size_t)volume->grid;
    for (size_t i = 0; i < cells; i++)
        if (volume->cells[i] == COLORING_FIRST)
            volume->cells[i] = COLORING_FIRST + (uint32_t)volume->count++;
    volume->gathered = ARENA_ARRAY(arena, struct gathered, volume->count);
    for (size_t i = 0; i < cells; i++)
        if (volume->cells[i] >= COLORING_FIRST)
            volume->gathered[volume->cells[i] - COLORING_FIRST].cell = (uint32_t)i;
}

/* Second sweep: where and how the surface in a voxel lies. */
static void gather_surface(const struct volume *volume, const struct depth_view *view)
{
    float point[3], normal[3];
    int cell[3];
    for (int y = 0; y < view->height_px; y++)
        for (int x = 0; x < view->width_px; x++) {
            if (!pixel_hit(volume, view, x, y, point, cell))
                continue;
            struct gathered *to = gathered_at(volume, cell);
            depth_view_normal(view, x, y, normal);
            float facing = 0;
            for (int i = 0; i < 3; i++)
                facing += normal[i] * to->normal[i];
            for (int i = 0; i < 3; i++) {
                to->point_m[i] += point[i];
                to->normal[i] += facing < 0 ? -normal[i] : normal[i];
            }
            size_t pixel = (size_t)y * (size_t)view->width_px + (size_t)x;
            to->leaf += view->leaf ? view->leaf[pixel] : 1;
            to->hits++;
        }
}

static void gather_color(const struct volume *volume, const struct depth_view *view)
{
    float point[3];
    int cell[3];
    for (int y = 0; y < view->height_px; y++)
        for (int x = 0; x < view->width_px; x++) {
            if (!pixel_hit(volume, view, x, y, point, cell))
                continue;
            struct gathered *to = gathered_at(volume, cell);
            size_t pixel = (size_t)y * (size_t)view->width_px + (size_t)x;
            float scale = view->pinhole ? view->depth_m[pixel] : 1;
            to->view_m2 += 4 * scale * scale * view->half[0] * view->half[1] /
                           ((float)view->width_px * (float)view->height_px);
            for (int i = 0; i < 3; i++)
                to->view_color[i] += view->color[pixel][i];
            to->view_hits++;
        }
}

/* Where a ray enters the box, and how far on it leaves it; false when it misses. */
static bool clip(const struct volume *volume, const struct ray *ray, float range[2])
{
    for (int i = 0; i < 3; i++) {
        float low = volume->minimum_m[i], high = low + volume->voxel_m[i] * (float)volume->grid;
        if (ray->direction[i] == 0) {
            if (ray->origin_m[i] < low || ray->origin_m[i] > high)
                return false;
            continue;
        }
        float a = (low - ray->origin_m[i]) / ray->direction[i];
        float b = (high - ray->origin_m[i]) / ray->direction[i];
        range[0] = fmaxf(range[0], fminf(a, b));
        range[1] = fminf(range[1], fmaxf(a, b));
    }
    return range[0] < range[1];
}

/* A ray on its way from cell to cell. Amanatides and Woo 1987, "A Fast Voxel Traversal Algorithm
 * for Ray Tracing". */
struct walk {
    int cell[3], sign[3];
    float next[3], step[3], end;
};

static bool walk_begin(const struct volume *volume, const struct ray *ray, struct walk *walk)
{
    float range[2] = {0, INFINITY};
    if (!clip(volume, ray, range))
        return false;
    walk->end = range[1];
    for (int i = 0; i < 3; i++) {
        float at = ray->origin_m[i] + range[0] * ray->direction[i] - volume->minimum_m[i];
        int last = volume->grid - 1, first = (int)floorf(at / volume->voxel_m[i]);
        walk->cell[i] = first < 0 ? 0 : first > last ? last : first;
        walk->sign[i] = ray->direction[i] < 0 ? -1 : 1;
        int edge = walk->cell[i] + (ray->direction[i] < 0 ? 0 : 1);
        float edge_m = volume->minimum_m[i] + volume->voxel_m[i] * (float)edge;
        bool still = ray->direction[i] == 0;
        walk->next[i] = still ? INFINITY : (edge_m - ray->origin_m[i]) / ray->direction[i];
        walk->step[i] = still ? INFINITY : volume->voxel_m[i] / fabsf(ray->direction[i]);
    }
    return true;
}

/* The depth at which the ray enters the next cell; above the walk's end outside of the box. */
static float walk_on(const struct volume *volume, struct walk *walk)
{
    const float *next = walk->next;
    int axis = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : (next[1] < next[2] ? 1 : 2);
    float depth = next[axis];
    walk->cell[axis] += walk->sign[axis];
    walk->next[axis] += walk->step[axis];
    bool inside = walk->cell[axis] >= 0 && walk->cell[axis] < volume->grid;
    return inside ? depth : INFINITY;
}

/* A ray that ends at a depth, in a cell (NULL: outside of the box), tells the cells before that it
 * passes them, and those far enough behind that it is blocked: what stops it within 3 cells may be
 * the same surface. Several threads at once. */
static void walk_through(const struct volume *volume, const struct ray *ray, float depth,
                         const int *end)
{
    struct walk walk;
    int behind = 0;
    if (!walk_begin(volume, ray, &walk))
        return;
    float at = 0;
    while (at < walk.end) {
        uint32_t *kept = &volume->cells[cell_index(volume, walk.cell)], state;
        behind +=
            behind > 0 || at >= depth || (end && memcmp(walk.cell, end, sizeof walk.cell) == 0);
#pragma omp atomic read
        state = *kept;
        if (state == COLORING_UNSEEN && !behind) {
#pragma omp atomic write
            *kept = COLORING_CLEAR;
        } else if (state >= COLORING_FIRST && !behind) {
#pragma omp atomic
            volume->gathered[state - COLORING_FIRST].view_passes++;
        } else if (state >= COLORING_FIRST && behind > 3) {
#pragma omp atomic
            volume->gathered[state - COLORING_FIRST].view_blocked++;
        }
        at = walk_on(volume, &walk);
    }
}

/* Which cells do a view's rays pass, and which are hidden from them? In any order, as counts are
 * all that is kept. */
static void gather_passes(const struct volume *volume, const struct depth_view *view)
{
#pragma omp parallel for schedule(dynamic, 8)
    for (int y = 0; y < view->height_px; y++)
        for (int x = 0; x < view->width_px; x++) {
            float point[3];
            int cell[3];
            float depth = view->depth_m[(size_t)y * (size_t)view->width_px + (size_t)x];
            bool hit = pixel_hit(volume, view, x, y, point, cell);
            struct ray ray = depth_view_ray(view, x, y);
            walk_through(volume, &ray, depth > 0 ? depth : INFINITY, hit ? cell : NULL);
        }
}

/* A view's ray to the middle of a voxel's surface, of length 1 along forward. */
static void ray_to(const struct depth_view *view, const struct gathered *of, float ray[3])
{
    float depth = 0;
    for (int i = 0; i < 3; i++) {
        ray[i] = view->pinhole ? of->point_m[i] / (float)of->hits - view->position_m[i]
                               : view->forward[i];
        depth += ray[i] * view->forward[i];
    }
    for (int i = 0; i < 3; i++)
        ray[i] /= depth;
}

/* The cosine between a ray and the mean normal of a voxel, times the ray's length. */
static float cosine(const struct gathered *of, const float ray[3])
{
    float along = 0, length2 = 0;
    for (int i = 0; i < 3; i++) {
        along += ray[i] * of->normal[i];
        length2 += of->normal[i] * of->normal[i];
    }
    return length2 > 0 ? along / sqrtf(length2) : -1;
}

/* Mean length of the parallels to a ray inside of a voxel: its volume over its shadow. */
static float chord_m(const struct volume *volume, const float ray[3])
{
    const float *v = volume->voxel_m;
    float length = sqrtf(ray[0] * ray[0] + ray[1] * ray[1] + ray[2] * ray[2]);
    return length / (fabsf(ray[0]) / v[0] + fabsf(ray[1]) / v[1] + fabsf(ray[2]) / v[2]);
}

/* Adds the view at hand to a voxel's statistics. A view sees the surface where rays end, or where
 * they pass and the surface faces it; an area A then shows A |cosine|, less what is blocked before
 * it, and A is the least squares' over the views. */
static void gather_end(const struct coloring_request *request, const struct volume *volume,
                       const struct depth_view *view, struct gathered *of)
{
    uint32_t rays = of->view_hits + of->view_passes;
    float ray[3];
    ray_to(view, of, ray);
    if (rays >= 4 && (float)of->view_passes > request->see_through * (float)rays)
        of->carved = true;
    float slant = rays > 0 ? cosine(of, ray) : 0;
    of->chords_m += (float)rays * chord_m(volume, ray);
    if (of->view_hits > 0 || slant < 0) { /* never where no ray arrives */
        of->shadows += of->view_m2 * fabsf(slant);
        of->facings += slant * slant * (float)rays / (float)(rays + of->view_blocked);
    }
    for (int i = 0; i < 3 && of->view_hits > 0; i++) {
        float mean = of->view_color[i] / (float)of->view_hits;
        of->color[i] += of->view_color[i];
        of->means[i] += mean;
        of->squares[i] += mean * mean;
        of->view_color[i] = 0;
    }
    of->views += of->view_hits > 0;
    of->passes += of->view_passes;
    of->view_hits = of->view_passes = of->view_blocked = 0;
    of->view_m2 = 0;
}

/* The sample standard deviation of the views' colours, of the worst channel. */
static float disagreement(const struct gathered *of)
{
    float worst = 0, n = (float)of->views;
    for (int i = 0; i < 3 && of->views > 1; i++)
        worst = fmaxf(worst, (of->squares[i] - of->means[i] * of->means[i] / n) / (n - 1));
    return sqrtf(worst);
}

static struct colored_voxel voxel_of(const struct coloring_request *request,
                                     const struct gathered *of)
{
    float hits = (float)of->hits, share = hits / (hits + (float)of->passes);
    struct colored_voxel voxel = {
        .cell = of->cell, .opacity = request->binary ? 1 : share, .leaf = of->leaf / hits};
    for (int i = 0; i < 3; i++) {
        voxel.color[i] = fminf(fmaxf(of->color[i] / hits, 0), 1);
        voxel.normal[i] = of->normal[i] / hits;
        voxel.position_m[i] = of->point_m[i] / hits;
    }
    voxel.chord_m = of->chords_m / (hits + (float)of->passes);
    voxel.area_m2 = of->facings > 0 ? of->shadows / of->facings : 0;
    return voxel;
}

void coloring_build(struct arena *arena, const struct depth_view *views, size_t views_count,
                    const struct coloring_request *request, struct coloring *coloring)
{
    struct arena *scratch = arena_create(0);
    struct volume volume = {.grid = request->grid};
    size_t cells = (size_t)request->grid * (size_t)request->grid * (size_t)request->grid;
    volume.cells = ARENA_ARRAY(arena, uint32_t, cells);
    for (int i = 0; i < 3; i++) {
        volume.minimum_m[i] = request->minimum_m[i];
        volume.voxel_m[i] = (request->maximum_m[i] - request->minimum_m[i]) / (float)request->grid;
    }
    find_hits(scratch, &volume, views, views_count);
    for (size_t v = 0; v < views_count; v++)
        gather_surface(&volume, &views[v]);
    for (size_t v = 0; v < views_count; v++) {
        gather_color(&volume, &views[v]);
        gather_passes(&volume, &views[v]);
        for (size_t i = 0; i < volume.count; i++)
            gather_end(request, &volume, &views[v], &volume.gathered[i]);
    }
    *coloring = (struct coloring){.grid = request->grid, .cells = volume.cells};
    memcpy(coloring->minimum_m, volume.minimum_m, sizeof volume.minimum_m);
    memcpy(coloring->voxel_m, volume.voxel_m, sizeof volume.voxel_m);
    coloring->voxels = ARENA_ARRAY(arena, struct colored_voxel, volume.count);
    for (size_t i = 0; i < volume.count; i++) {
        const struct gathered *of = &volume.gathered[i];
        bool carved = of->carved || disagreement(of) > request->agreement;
        coloring->carved_count += carved;
        volume.cells[of->cell] =
            carved ? COLORING_CARVED : COLORING_FIRST + (uint32_t)coloring->voxels_count;
        if (!carved)
            coloring->voxels[coloring->voxels_count++] = voxel_of(request, of);
    }
    for (size_t i = 0; i < cells; i++) {
        coloring->unseen_count += volume.cells[i] == COLORING_UNSEEN;
        coloring->clear_count += volume.cells[i] == COLORING_CLEAR;
    }
    arena_destroy(scratch);
}
