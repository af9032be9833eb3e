/* The level of every chunk in a view, and its triangles. */
#include "bake/terrain_levels.h"
#include "bake/terrain_levels_parts.h"

#include <string.h>

enum { BESIDE_NONE = -1 };

struct chunk {
    float errors_m[LEVELS_COUNT]; /* never falling; of level 0 beside a coarser neighbour */
    float low_m, high_m;          /* of its heights */
};

struct terrain_levels {
    struct arena *arena;
    const struct terrain *terrain;
    uint32_t chunks_x, chunks_z;
    struct chunk_kind kinds[2][2]; /* [last of a column][last of a row] */
    struct chunk *chunks;
    int8_t *chosen; /* BESIDE_NONE: level 0, and so are the neighbours */
    int8_t *cast;   /* chosen, when terrain_levels_cast was last called; NULL: not yet */
    uint32_t *indices;
    size_t indices_room;
};

static const struct chunk_kind *kind_of(const struct terrain_levels *levels, uint32_t x, uint32_t z)
{
    return &levels->kinds[z + 1 == levels->chunks_z][x + 1 == levels->chunks_x];
}

static void chunk_measure(struct terrain_levels *levels, uint32_t cx, uint32_t cz)
{
    const struct terrain *terrain = levels->terrain;
    const struct chunk_kind *kind = kind_of(levels, cx, cz);
    struct chunk *chunk = &levels->chunks[(size_t)cz * levels->chunks_x + cx];
    const uint32_t x = cx * LEVELS_CHUNK, z = cz * LEVELS_CHUNK;
    chunk->low_m = INFINITY;
    chunk->high_m = -INFINITY;
    for (uint32_t j = z; j <= z + kind->height; j++)
        for (uint32_t i = x; i <= x + kind->width; i++) {
            float height_m = terrain->heights_m[(size_t)j * terrain->samples_x + i];
            chunk->low_m = fminf(chunk->low_m, height_m);
            chunk->high_m = fmaxf(chunk->high_m, height_m);
        }
    for (int level = 0; level < LEVELS_COUNT; level++) {
        const struct pattern *all = &kind->all[level];
        float worst = level > 0 ? chunk->errors_m[level - 1] : 0;
        for (size_t k = 0; k < all->count; k++)
            worst = fmaxf(worst, triangle_error(terrain, x, z, all->triangles[k]));
        chunk->errors_m[level] = worst;
    }
}

struct terrain_levels *terrain_levels_create(struct arena *arena, const struct terrain *terrain,
                                             int threads)
{
    struct terrain_levels *levels = ARENA_NEW(arena, struct terrain_levels);
    const uint32_t quads_x = terrain->samples_x - 1, quads_z = terrain->samples_z - 1;
    levels->arena = arena;
    levels->terrain = terrain;
    levels->chunks_x = (quads_x + LEVELS_CHUNK - 1) / LEVELS_CHUNK;
    levels->chunks_z = (quads_z + LEVELS_CHUNK - 1) / LEVELS_CHUNK;
    const uint32_t last_x = quads_x - (levels->chunks_x - 1) * LEVELS_CHUNK;
    const uint32_t last_z = quads_z - (levels->chunks_z - 1) * LEVELS_CHUNK;
    for (int z = 0; z < 2; z++)
        for (int x = 0; x < 2; x++)
            chunk_kind_build(arena, &levels->kinds[z][x], x ? last_x : LEVELS_CHUNK,
                             z ? last_z : LEVELS_CHUNK);
    const size_t count = (size_t)levels->chunks_x * levels->chunks_z;
    levels->chunks = ARENA_ARRAY(arena, struct chunk, count);
    levels->chosen = ARENA_ARRAY(arena, int8_t, count);
#pragma omp parallel for schedule(dynamic, 16) num_threads(threads)
    for (size_t k = 0; k < count; k++)
        chunk_measure(levels, (uint32_t)(k % levels->chunks_x), (uint32_t)(k / levels->chunks_x));
    return levels;
}

/* A chunk's corners in the world. */
static void chunk_box(const struct terrain_levels *levels, uint32_t cx, uint32_t cz, float low[3],
                      float high[3])
{
    const struct terrain *terrain = levels->terrain;
    const struct chunk_kind *kind = kind_of(levels, cx, cz);
    const struct chunk *chunk = &levels->chunks[(size_t)cz * levels->chunks_x + cx];
    const float quad_m[2] = {terrain->size_x_m / (float)(terrain->samples_x - 1),
                             terrain->size_z_m / (float)(terrain->samples_z - 1)};
    low[0] = (float)(cx * LEVELS_CHUNK) * quad_m[0] - 0.5f * terrain->size_x_m;
    low[1] = chunk->low_m;
    low[2] = (float)(cz * LEVELS_CHUNK) * quad_m[1] - 0.5f * terrain->size_z_m;
    high[0] = low[0] + (float)kind->width * quad_m[0];
    high[1] = chunk->high_m;
    high[2] = low[2] + (float)kind->height * quad_m[1];
}

/* What makes pixels of metres in a view. */
struct lens {
    const struct view *view;
    float focal_px, secant; /* of the angle to the picture's corner */
    float bound_px;
};

/* A point that moves up by e from depth z to z' moves in the picture by at most f e secant / z',
 * since its image moves by f (e_side - tan e_depth) / z'. All of a chunk, at any level, is in its
 * box: z' is at least the box's least depth. Where that is behind the eye, what is in the picture
 * is at least cos(angle) times the distance deep, and what it moves to less by e. */
static int chunk_level(const struct terrain_levels *levels, uint32_t cx, uint32_t cz,
                       const struct lens *lens)
{
    const struct chunk *chunk = &levels->chunks[(size_t)cz * levels->chunks_x + cx];
    float low[3], high[3], depth_m = 0, square = 0;
    chunk_box(levels, cx, cz, low, high);
    for (int i = 0; i < 3; i++) {
        const float eye = lens->view->eye_m[i], forward = lens->view->forward[i];
        float away = fmaxf(0, fmaxf(low[i] - eye, eye - high[i]));
        square += away * away;
        depth_m += forward * ((forward > 0 ? low[i] : high[i]) - eye);
    }
    const float near_m = sqrtf(square) / lens->secant;
    int level = lens->bound_px > 0 ? LEVELS_COUNT - 1 : BESIDE_NONE;
    for (; level > BESIDE_NONE; level--) {
        float error_m = chunk->errors_m[level];
        float least_m = fmaxf(depth_m, near_m - error_m);
        if (least_m > 0 && lens->focal_px * error_m * lens->secant <= lens->bound_px * least_m)
            break;
    }
    return level;
}

/* Lowers levels until neighbours differ by one at most: down and up again. */
static void levels_restrict(struct terrain_levels *levels)
{
    const size_t across = levels->chunks_x, count = across * levels->chunks_z;
    int8_t *chosen = levels->chosen;
    for (size_t k = 0; k < count; k++) {
        if (k % across > 0 && chosen[k] > chosen[k - 1] + 1)
            chosen[k] = (int8_t)(chosen[k - 1] + 1);
        if (k >= across && chosen[k] > chosen[k - across] + 1)
            chosen[k] = (int8_t)(chosen[k - across] + 1);
    }
    for (size_t k = count; k-- > 0;) {
        if (k % across + 1 < across && chosen[k] > chosen[k + 1] + 1)
            chosen[k] = (int8_t)(chosen[k + 1] + 1);
        if (k + across < count && chosen[k] > chosen[k + across] + 1)
            chosen[k] = (int8_t)(chosen[k + across] + 1);
    }
}

static int level_of(const struct terrain_levels *levels, size_t chunk)
{
    return levels->chosen[chunk] > 0 ? levels->chosen[chunk] : 0;
}

static int coarser_sides(const struct terrain_levels *levels, uint32_t cx, uint32_t cz)
{
    const size_t across = levels->chunks_x, k = (size_t)cz * across + cx;
    const int own = level_of(levels, k);
    int sides = 0;
    sides |= cx > 0 && level_of(levels, k - 1) > own ? SIDE_WEST : 0;
    sides |= cx + 1 < across && level_of(levels, k + 1) > own ? SIDE_EAST : 0;
    sides |= cz > 0 && level_of(levels, k - across) > own ? SIDE_NORTH : 0;
    sides |= cz + 1 < levels->chunks_z && level_of(levels, k + across) > own ? SIDE_SOUTH : 0;
    return sides;
}

static bool chunk_is_seen(const struct terrain_levels *levels, uint32_t cx, uint32_t cz,
                          const struct view *view)
{
    float low[3], high[3], center[3], square = 0;
    chunk_box(levels, cx, cz, low, high);
    for (int i = 0; i < 3; i++) {
        center[i] = 0.5f * (low[i] + high[i]);
        square += (high[i] - center[i]) * (high[i] - center[i]);
    }
    return view_sees_sphere(view, center, sqrtf(square) * 1.0001f);
}

static void room_for(struct terrain_levels *levels, size_t filled, size_t more)
{
    if (filled + more <= levels->indices_room)
        return;
    size_t room = 2 * (filled + more);
    uint32_t *grown = ARENA_ARRAY(levels->arena, uint32_t, room);
    if (filled)
        memcpy(grown, levels->indices, filled * sizeof *grown);
    levels->indices = grown;
    levels->indices_room = room;
}

static void levels_choose_all(struct terrain_levels *levels, const struct view *view,
                              float bound_px)
{
    const float up = tanf(0.5f * view->fov_y_rad);
    const float right = up * (float)view->width_px / (float)view->height_px;
    const struct lens lens = {view, 0.5f * (float)view->height_px / up,
                              sqrtf(1 + up * up + right * right), bound_px};
    for (uint32_t z = 0; z < levels->chunks_z; z++)
        for (uint32_t x = 0; x < levels->chunks_x; x++)
            levels->chosen[(size_t)z * levels->chunks_x + x] =
                (int8_t)chunk_level(levels, x, z, &lens);
    levels_restrict(levels);
}

/* seen_by: of the chunks that it may see; NULL: of all. */
static size_t levels_fill_indices(struct terrain_levels *levels, const struct view *seen_by)
{
    const uint32_t samples_x = levels->terrain->samples_x;
    size_t filled = 0;
    for (uint32_t z = 0; z < levels->chunks_z; z++)
        for (uint32_t x = 0; x < levels->chunks_x; x++) {
            if (seen_by && !chunk_is_seen(levels, x, z, seen_by))
                continue;
            const int level = level_of(levels, (size_t)z * levels->chunks_x + x);
            const struct pattern *pattern =
                &kind_of(levels, x, z)->patterns[level][coarser_sides(levels, x, z)];
            const uint32_t first = (z * samples_x + x) * LEVELS_CHUNK;
            room_for(levels, filled, 3 * pattern->count);
            for (size_t t = 0; t < pattern->count; t++)
                for (int k = 0; k < 3; k++)
                    levels->indices[filled++] =
                        first + pattern->triangles[t][k].z * samples_x + pattern->triangles[t][k].x;
        }
    return filled;
}

size_t terrain_levels_view(struct terrain_levels *levels, const struct view *view, float bound_px,
                           const uint32_t **indices)
{
    levels_choose_all(levels, view, bound_px);
    size_t count = levels_fill_indices(levels, view);
    *indices = levels->indices;
    return count;
}

bool terrain_levels_cast(struct terrain_levels *levels, const struct view *view, float bound_px,
                         const uint32_t **indices, size_t *count)
{
    const size_t chunks = (size_t)levels->chunks_x * levels->chunks_z;
    levels_choose_all(levels, view, bound_px);
    if (levels->cast && memcmp(levels->cast, levels->chosen, chunks) == 0)
        return false;
    if (!levels->cast)
        levels->cast = ARENA_ARRAY(levels->arena, int8_t, chunks);
    memcpy(levels->cast, levels->chosen, chunks);
    *count = levels_fill_indices(levels, NULL);
    *indices = levels->indices;
    return true;
}
