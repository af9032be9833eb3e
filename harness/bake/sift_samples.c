/* The inner loops of sift.h: spheres against the grid of samples, triangles against samples and
 * depths. */
#include "bake/sift_parts.h"

#include <math.h>
#include <string.h>

/* A rasteriser rounds corners to 1/256 px, and its sums are rounded otherwise than ours. */
static const float margin_px = 1.0f / 128;
/* Samples of each place that a triangle may meet and still be looked at one by one. */
enum { SAMPLES_MAX = 64 };

void sift_screen_set(struct sift_screen *screen, const struct view *view,
                     const struct sampling_places *places)
{
    screen->places = *places;
    screen->width_px = view->width_px;
    screen->height_px = view->height_px;
    screen->near_m = view->near_m;
    for (int j = 0; j < 4; j++) {
        float w = view->view_projection[j][3];
        screen->rows[0][j] = 0.5f * (float)view->width_px * (view->view_projection[j][0] + w);
        screen->rows[1][j] = 0.5f * (float)view->height_px * (view->view_projection[j][1] + w);
        screen->rows[2][j] = w;
    }
    /* toward a corner a sphere is stretched by the secant of the angle from the axis */
    float up = tanf(0.5f * view->fov_y_rad);
    float right = up * (float)view->width_px / (float)view->height_px;
    float focal = 0.5f * (float)view->height_px / up;
    screen->focal_px = 1.02f * focal * sqrtf(1 + up * up + right * right);
}

void sift_project(const struct sift_screen *screen, const float world_m[3], float projected[3])
{
    for (int i = 0; i < 3; i++)
        projected[i] = screen->rows[i][0] * world_m[0] + screen->rows[i][1] * world_m[1] +
                       screen->rows[i][2] * world_m[2] + screen->rows[i][3];
}

/* Of finite numbers; fminf and fmaxf are calls. */
static inline float least(float a, float b)
{
    return a < b ? a : b;
}

static inline float most(float a, float b)
{
    return a > b ? a : b;
}

/* On the screen, px. */
struct extent {
    float x0, x1, y0, y1;
};

/* Samples of one place, one a pixel, inclusive. */
struct box {
    int x0, x1, y0, y1;
};

/* Pixels low..high whose samples, `place` right of their borders, an extent within [0, end] may
 * meet. */
static inline int first_sample(float low, float place)
{
    return (int)(low + (1 - place - margin_px));
}

static inline int last_sample(float high, float place, int end)
{
    int last = (int)(high + (1 - place + margin_px)) - 1;
    return last < end ? last : end - 1;
}

/* The band's samples of a place that an extent may meet; false: none. */
static inline bool box_of(const struct sift_work *work, const struct extent *extent,
                          const float place[2], struct box *box)
{
    const struct sift_screen *screen = work->screen;
    float right = (float)screen->width_px;
    box->x0 = first_sample(most(extent->x0, 0), place[0]);
    box->x1 = last_sample(least(extent->x1, right), place[0], screen->width_px);
    box->y0 = first_sample(most(extent->y0, work->low_row), place[1]);
    box->y1 = last_sample(least(extent->y1, work->high_row), place[1], (int)work->high_row);
    return box->x0 <= box->x1 && box->y0 <= box->y1;
}

/* What box_of asks of an extent. */
static inline bool meets_band(const struct sift_work *work, const struct extent *extent)
{
    return extent->x1 >= 0 && extent->x0 <= (float)work->screen->width_px &&
           extent->y1 >= work->low_row && extent->y0 <= work->high_row;
}

static inline float *depths_at(const struct sift_screen *screen, int row, int place)
{
    size_t first = (size_t)row * (size_t)screen->width_px;
    return screen->depths_m + first * (size_t)screen->places.count + place;
}

static bool box_is_hidden(const struct sift_screen *screen, int place, const struct box *box,
                          float depth_m)
{
    for (int y = box->y0; y <= box->y1; y++) {
        const float *row = depths_at(screen, y, place);
        for (int x = box->x0; x <= box->x1; x++)
            if (row[x * screen->places.count] >= depth_m)
                return false;
    }
    return true;
}

/* Whether the sphere about a tree may reach into the band. */
static bool sphere_seen(const struct sift_work *work, const struct sift_tree *tree)
{
    const struct instance *instance = tree->instance;
    float half_m = 0.5f * (tree->high_m - tree->low_m), p[3];
    float middle[3] = {instance->position_m[0],
                       instance->position_m[1] +
                           instance->scale * instance->stretch * (tree->low_m + half_m),
                       instance->position_m[2]};
    float reach_m = instance_reach(instance) * (half_m + tree->radius_m);
    sift_project(work->screen, middle, p);
    if (!(p[2] > work->screen->near_m + 8 * reach_m))
        return true;
    float reach_px = reach_m * work->screen->focal_px, row = p[1];
    return row + reach_px >= work->low_row * p[2] && row - reach_px <= work->high_row * p[2];
}

bool sift_tree_seen(const struct sift_work *work, const struct sift_tree *tree, bool look)
{
    const struct sift_screen *screen = work->screen;
    const struct instance *instance = tree->instance;
    if (!look)
        return sphere_seen(work, tree);
    struct extent extent = {INFINITY, -INFINITY, INFINITY, -INFINITY};
    float near_m = INFINITY;
    for (int corner = 0; corner < 8; corner++) {
        float radius = instance->scale * tree->radius_m, p[3], world[3];
        world[0] = instance->position_m[0] + (corner & 1 ? radius : -radius);
        world[1] = instance->position_m[1] +
                   instance->scale * instance->stretch * (corner & 2 ? tree->high_m : tree->low_m);
        world[2] = instance->position_m[2] + (corner & 4 ? radius : -radius);
        sift_project(screen, world, p);
        if (!(p[2] > screen->near_m))
            return true;
        near_m = least(near_m, p[2]);
        extent.x0 = least(extent.x0, p[0] / p[2]);
        extent.x1 = most(extent.x1, p[0] / p[2]);
        extent.y0 = least(extent.y0, p[1] / p[2]);
        extent.y1 = most(extent.y1, p[1] / p[2]);
    }
    if (!meets_band(work, &extent))
        return false;
    for (int place = 0; place < screen->places.count; place++) {
        struct box box;
        if (box_of(work, &extent, screen->places.at[place], &box) &&
            !box_is_hidden(screen, place, &box, near_m))
            return true;
    }
    return false;
}

void sift_tree_set(struct sift_work *work, const struct sift_tree *tree)
{
    const struct instance *instance = tree->instance;
    float c = cosf(instance->rotation_rad), s = sinf(instance->rotation_rad);
    work->turn[0] = c;
    work->turn[1] = s;
    work->scale = instance->scale;
    work->height = instance->scale * instance->stretch;
    work->reach = instance_reach(instance);
    work->normal[0] = least(1, instance->stretch);
    work->normal[1] = least(1, 1 / instance->stretch);
    work->mean = tree->mean;
    work->within = tree->within;
    memcpy(work->place, instance->position_m, sizeof work->place);
    for (int i = 0; i < 3; i++) {
        const float *row = work->screen->rows[i];
        double foot = row[3];
        for (int j = 0; j < 3; j++)
            foot += (double)row[j] * instance->position_m[j];
        work->rows[i][0] = instance->scale * (row[0] * c - row[2] * s);
        work->rows[i][1] = work->height * row[1];
        work->rows[i][2] = instance->scale * (row[0] * s + row[2] * c);
        work->rows[i][3] = (float)foot;
    }
}

/* Marks the elements whose spheres may meet a sample of the band; branch-free. */
static void mark_block(const struct sift_work *work, const struct sift_set *set, size_t at,
                       size_t count, float growth, const float place[2], uint8_t *restrict marks)
{
    const float *restrict x = set->x + at, *restrict y = set->y + at;
    const float *restrict z = set->z + at, *restrict radius = set->radius_m + at;
    const float(*m)[4] = work->rows;
    float near_m = work->screen->near_m, focal = work->screen->focal_px * work->reach * growth;
    float right = (float)work->screen->width_px, low = work->low_row, high = work->high_row;
    float behind_m = 0.999f * near_m, scale = work->reach * growth, shift_x = 1 - place[0],
          shift_y = 1 - place[1];
    for (size_t i = 0; i < count; i++) {
        float w = m[2][0] * x[i] + m[2][1] * y[i] + m[2][2] * z[i] + m[2][3];
        float inverse = 1 / w, r = radius[i] * focal * inverse + margin_px;
        float px = (m[0][0] * x[i] + m[0][1] * y[i] + m[0][2] * z[i] + m[0][3]) * inverse;
        float py = (m[1][0] * x[i] + m[1][1] * y[i] + m[1][2] * z[i] + m[1][3]) * inverse;
        float x0 = px - r + shift_x, x1 = px + r + shift_x;
        float y0 = py - r + shift_y, y1 = py + r + shift_y;
        /* whole numbers in (x0, x1] are samples; the first one stands right of the left border */
        x0 = x0 > 0.5f ? x0 : 0.5f;
        y0 = y0 > low + 0.5f ? y0 : low + 0.5f;
        x1 = x1 < right + 0.5f ? x1 : right + 0.5f;
        y1 = y1 < high + 0.5f ? y1 : high + 0.5f;
        x1 = x1 > 0 ? x1 : 0;
        y1 = y1 > 0 ? y1 : 0;
        x0 = x0 < right + 1 ? x0 : right + 1;
        y0 = y0 < high + 1 ? y0 : high + 1;
        int meets = ((int)x1 > (int)x0) & ((int)y1 > (int)y0);
        /* behind the near plane nothing is drawn */
        int close = (w < near_m + 8 * scale * radius[i]) & (w > behind_m - scale * radius[i]);
        marks[i] |= (uint8_t)(meets | close);
    }
}

/* A triangle on the screen. */
struct projected {
    float x[3], y[3], w[3];
};

static struct extent extent_of(const struct projected *p)
{
    return (struct extent){
        least(least(p->x[0], p->x[1]), p->x[2]), most(most(p->x[0], p->x[1]), p->x[2]),
        least(least(p->y[0], p->y[1]), p->y[2]), most(most(p->y[0], p->y[1]), p->y[2])};
}

/* Inside where x dy - y dx of all three edges, from their first corners on, is negative. */
struct edges {
    float dx[3], dy[3], slack[3];
    float near_m, far_m;
};

/* Whether the triangle may change a sample of a place; depths are brought up to date with what it
 * surely covers. */
static inline bool place_seen(const struct sift_screen *screen, const struct projected *p,
                              const struct edges *edges, int place, const struct box *box)
{
    const float *at = screen->places.at[place];
    int step = screen->places.count;
    bool seen = false;
    for (int y = box->y0; y <= box->y1; y++) {
        float *row = depths_at(screen, y, place);
        for (int x = box->x0; x <= box->x1; x++) {
            bool meets = true, covers = true;
            float *depth = row + x * step;
            for (int i = 0; i < 3; i++) {
                float edge = edges->dx[i] * ((float)y + at[1] - p->y[i]) -
                             edges->dy[i] * ((float)x + at[0] - p->x[i]);
                meets &= edge >= -edges->slack[i];
                covers &= edge > edges->slack[i];
            }
            seen |= meets & (edges->near_m <= *depth);
            if (covers && edges->far_m < *depth)
                *depth = edges->far_m;
        }
    }
    return seen;
}

static struct edges edges_of(const struct projected *p, float area)
{
    float sign = area < 0 ? -1.0f : 1.0f;
    struct edges edges = {.near_m = least(least(p->w[0], p->w[1]), p->w[2]) * (1 - 2e-5f),
                          .far_m = most(most(p->w[0], p->w[1]), p->w[2])};
    for (int i = 0; i < 3; i++) {
        int j = i == 2 ? 0 : i + 1;
        edges.dx[i] = sign * (p->x[j] - p->x[i]);
        edges.dy[i] = sign * (p->y[j] - p->y[i]);
        edges.slack[i] = margin_px * (fabsf(edges.dx[i]) + fabsf(edges.dy[i]));
    }
    return edges;
}

/* Whether the triangle may change the picture. */
static bool triangle_seen(const struct sift_work *work, const struct projected *p, bool closed)
{
    const struct sift_screen *screen = work->screen;
    struct extent extent = extent_of(p);
    struct box boxes[SAMPLING_PLACES_MAX];
    bool some[SAMPLING_PLACES_MAX], any = false, seen = false;
    if (!meets_band(work, &extent))
        return false;
    for (int i = 0; i < screen->places.count; i++) {
        struct box *box = &boxes[i];
        some[i] = box_of(work, &extent, screen->places.at[i], box);
        any |= some[i];
        if (some[i] &&
            (size_t)(box->x1 - box->x0 + 1) * (size_t)(box->y1 - box->y0 + 1) > SAMPLES_MAX)
            return true;
    }
    float area =
        (p->x[1] - p->x[0]) * (p->y[2] - p->y[0]) - (p->x[2] - p->x[0]) * (p->y[1] - p->y[0]);
    if (!any || (closed && area < 0))
        return false;
    struct edges edges = edges_of(p, area);
    for (int i = 0; i < screen->places.count; i++)
        if (some[i])
            seen |= place_seen(screen, p, &edges, i, &boxes[i]);
    return seen;
}

static void put_triangle(struct sift_work *work, const struct sift_vertex *corners,
                         const float center[3], float size, float growth)
{
    struct sift_vertex *out = work->out[work->stream] + 3 * work->filled[work->stream]++;
    float c = work->turn[0], s = work->turn[1], scale = work->scale;
    float across = work->normal[0], along = work->normal[1];
    for (int i = 0; i < 3; i++) {
        const float *p = corners[i].position_m;
        const int16_t *n = corners[i].normal;
        float x = center[0] + size * (p[0] - center[0]), y = center[1] + size * (p[1] - center[1]);
        float z = center[2] + size * (p[2] - center[2]);
        out[i].position_m[0] = work->place[0] + scale * (x * c + z * s);
        out[i].position_m[1] = work->place[1] + work->height * y;
        out[i].position_m[2] = work->place[2] + scale * (z * c - x * s);
        float nx = across * ((float)n[0] * c + (float)n[2] * s);
        float nz = across * ((float)n[2] * c - (float)n[0] * s);
        out[i].normal[0] = (int16_t)lrintf(least(most(nx, -32767), 32767));
        out[i].normal[1] = (int16_t)lrintf(along * (float)n[1]);
        out[i].normal[2] = (int16_t)lrintf(least(most(nz, -32767), 32767));
        out[i].normal[3] = (int16_t)(n[3] + work->mean);
        memcpy(out[i].albedo, corners[i].albedo, sizeof out[i].albedo);
        out[i].albedo[3] = (uint16_t)(growth > 1 ? 65535 / growth : 65535);
    }
}

static void sift_element(struct sift_work *work, const struct sift_run *run, size_t element,
                         float rank)
{
    const struct sift_set *set = run->set;
    const float(*m)[4] = (const float(*)[4])work->rows;
    float size = run->growth;
    if (run->taper > 0)
        size *= least(most((run->kept - rank - 0.5f) / (run->taper * run->kept), 0), 1);
    const float center[3] = {set->x[element], set->y[element], set->z[element]};
    for (uint32_t t = set->first[element]; t < set->first[element + 1]; t++) {
        const struct sift_vertex *corners = set->vertices + 3 * (size_t)t;
        struct projected p;
        bool close = false, behind = true;
        if (run->stout && !(corners[0].normal[3] & 1) && corners[0].albedo[3] >= run->stout)
            continue;
        for (int i = 0; i < 3; i++) {
            const float *at = corners[i].position_m;
            float x = center[0] + size * (at[0] - center[0]),
                  y = center[1] + size * (at[1] - center[1]);
            float z = center[2] + size * (at[2] - center[2]);
            p.w[i] = m[2][0] * x + m[2][1] * y + m[2][2] * z + m[2][3];
            float inverse = 1 / p.w[i];
            p.x[i] = (m[0][0] * x + m[0][1] * y + m[0][2] * z + m[0][3]) * inverse;
            p.y[i] = (m[1][0] * x + m[1][1] * y + m[1][2] * z + m[1][3]) * inverse;
            close |= !(p.w[i] > work->screen->near_m);
            behind &= p.w[i] < 0.999f * work->screen->near_m;
        }
        if (behind || (!close && !triangle_seen(work, &p, set->closed && !work->within)))
            continue;
        put_triangle(work, corners, center, size, run->growth);
    }
}

void sift_block(struct sift_work *work, const struct sift_run *run, size_t at, size_t rank,
                size_t count)
{
    _Alignas(64) uint8_t marks[SIFT_BLOCK] = {0};
    for (int i = 0; i < work->screen->places.count; i++)
        mark_block(work, run->set, at, count, run->growth, work->screen->places.at[i], marks);
    for (size_t eight = 0; eight < count; eight += 8) {
        uint64_t any;
        memcpy(&any, marks + eight, sizeof any);
        for (size_t i = eight; any && i < eight + 8; i++)
            if (marks[i])
                sift_element(work, run, at + i, (float)(rank + i));
    }
}
