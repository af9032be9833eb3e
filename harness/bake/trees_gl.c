/* Trees in view to texels: which levels, where on the screen, from where they are looked at. */
#include "bake/trees_gl.h"
#include "bake/sunlight_gl.h"

#include <math.h>

/* Of a tree while one thing turns into another: two levels and a point. */
enum { PIECES_MOST = 3 };
struct piece {
    uint32_t level;
    bool small;  /* a point */
    float share; /* of the tree's optical depth */
};

struct trees_gl {
    const struct scene *scene;
    const struct voxels_gl *voxels;
    float bias, smooth;
    struct march_tree *trees;     /* one an instance */
    struct sunlight_gl *sunlight; /* NULL: the sun has no shadows */
    struct tiles_rect *rects;
    struct tree_texels *texels;
};

struct trees_gl *trees_gl_create(struct arena *arena, const struct scene *scene,
                                 const struct voxels_gl *voxels, float bias, float smooth)
{
    struct trees_gl *trees = ARENA_NEW(arena, struct trees_gl);
    trees->scene = scene;
    trees->voxels = voxels;
    trees->bias = bias;
    trees->smooth = smooth;
    trees->trees = ARENA_ARRAY(arena, struct march_tree, scene->instances_count);
    trees->rects = ARENA_ARRAY(arena, struct tiles_rect, trees_gl_most(trees));
    trees->texels = ARENA_ARRAY(arena, struct tree_texels, trees_gl_most(trees));
    march_trees_fill(scene, trees->trees);
    return trees;
}

const struct march_tree *trees_gl_trees(const struct trees_gl *trees)
{
    return trees->trees;
}

void trees_gl_shade(struct trees_gl *trees, struct sunlight_gl *sunlight)
{
    trees->sunlight = sunlight;
}

size_t trees_gl_most(const struct trees_gl *trees)
{
    return trees->scene->instances_count * (trees->smooth > 0 ? PIECES_MOST : 1);
}

/* A picture's constants. */
struct picture {
    const struct view *view;
    float focal_px, fog_density;
};

static int16_t pixel_of(float at_px, int size_px)
{
    return (int16_t)(at_px > 0 ? at_px < (float)size_px ? at_px : (float)size_px : 0);
}

/* The pixels from first to last that are in the picture. */
static void rect_between(struct tiles_rect *rect, int axis, float first, float last, int size_px)
{
    bool any = first < (float)size_px && last >= 0;
    rect->low[axis] = any ? pixel_of(first, size_px) : 0;
    rect->high[axis] = any ? pixel_of(last, size_px - 1) : -1;
}

/* A tree about as small as a pixel covers its share of the four pixels around its middle. */
static void place_small(const struct picture *picture, const struct march_tree *tree,
                        const struct march_outline *outline, const struct march_box *box,
                        float side_m, struct tiles_rect *rect, struct tree_texels *texels)
{
    const struct view *view = picture->view;
    const float *forward = view->forward, *middle = box->middle_m;
    float depth = middle[0] * forward[0] + middle[1] * forward[1] + middle[2] * forward[2];
    float side_px = picture->focal_px * side_m / depth, stretch = tree->stretch;
    /* a cube of the plant, seen along its axis w, covers stretch / |w stretched| of its side^2 */
    float level_m2 = middle[0] * middle[0] + middle[2] * middle[2], rise_m2 = middle[1] * middle[1];
    float cover =
        stretch == 1
            ? 1
            : stretch * sqrtf((level_m2 + rise_m2 / (stretch * stretch)) / (level_m2 + rise_m2));
    for (int i = 0; i < 2; i++) {
        float first = floorf(outline->middle[i]);
        rect_between(rect, i, first, first + 1, i ? view->height_px : view->width_px);
        texels->where[i] = outline->middle[i];
    }
    texels->where[2] = side_px * side_px * cover;
    texels->per_m = depth;
}

/* A row of the frame: an axis of the screen times a length, and of the view's, for voxels of a
 * box. */
static void frame_row(const struct march_box *box, const uint32_t size[3], const float axis[3],
                      float row[4])
{
    row[3] = 0;
    for (int i = 0; i < 3; i++)
        row[3] += axis[i] * box->middle_m[i];
    for (int k = 0; k < 3; k++) {
        float half = 0;
        for (int i = 0; i < 3; i++)
            half += axis[i] * box->half_m[k][i];
        row[k] = 2 * half / (float)size[k];
        row[3] -= half;
    }
}

static struct hull_frame frame_of(const struct picture *picture, const struct march_box *box,
                                  const uint32_t size[3])
{
    const struct view *view = picture->view;
    const float middle_px[2] = {0.5f * (float)(view->width_px - 1),
                                0.5f * (float)(view->height_px - 1)};
    float across[3], down[3];
    for (int i = 0; i < 3; i++) {
        across[i] = picture->focal_px * view->right[i] + middle_px[0] * view->forward[i];
        down[i] = -picture->focal_px * view->up[i] + middle_px[1] * view->forward[i];
    }
    struct hull_frame frame;
    frame_row(box, size, across, frame.across);
    frame_row(box, size, down, frame.down);
    frame_row(box, size, view->forward, frame.depth);
    return frame;
}

static uint16_t quarters(float at_px, float (*round)(float))
{
    return (uint16_t)fminf(fmaxf(round(4 * at_px) + TREE_TEXELS_BIAS, 0), 65535);
}

/* A rectangle as bounds that do not lean. */
static void bound_rect(const struct tiles_rect *rect, struct tree_texels *texels)
{
    texels->rows[0] = (uint16_t)rect->low[1];
    texels->rows[1] = (uint16_t)rect->high[1];
    texels->lean = 0;
    for (int end = 0; end < 2; end++) {
        int at = 4 * (end ? rect->high[0] : rect->low[0]) + TREE_TEXELS_BIAS;
        texels->bounds[end] = (uint16_t)(at < 65535 ? at : 65535);
    }
}

/* The bounds of a silhouette, which are of its own first row, from the first one in the picture
 * on. */
static void bound_silhouette(const struct silhouette *silhouette, const struct tiles_rect *rect,
                             struct tree_texels *texels)
{
    const float way = silhouette->lean * ((float)rect->low[1] - silhouette->low[1]);
    bound_rect(rect, texels);
    texels->lean = 4 * silhouette->lean;
    texels->bounds[0] = quarters(silhouette->bounds[0] + way, floorf);
    texels->bounds[1] = quarters(silhouette->bounds[1] + way, ceilf);
}

/* Narrower boxes' outlines cost more to make than the steps that they spare. */
static const float outlined_px = 8;

/* The pixels that a level's voxels may be seen in; of a tree around the near plane or of a few
 * pixels all that its box is in. */
static void place(const struct picture *picture, const struct march_outline *outline,
                  const struct march_box *box, const uint32_t size[3], const struct hull *hull,
                  struct tiles_rect *rect, struct tree_texels *texels)
{
    const int size_px[2] = {picture->view->width_px, picture->view->height_px};
    struct silhouette silhouette;
    const float *low = outline->low, *high = outline->high;
    bool wide = outline->high[0] - outline->low[0] >= outlined_px;
    if (outline->before && wide && hull->count) {
        const struct hull_frame frame = frame_of(picture, box, size);
        silhouette_of(hull, &frame, &silhouette);
        low = silhouette.low;
        high = silhouette.high;
    }
    for (int i = 0; i < 2; i++)
        rect_between(rect, i, ceilf(low[i]), floorf(high[i]),
                     outline->any && hull->count ? size_px[i] : 0);
    if (low == silhouette.low)
        bound_silhouette(&silhouette, rect, texels);
    else
        bound_rect(rect, texels);
}

static uint32_t pack_10(const uint32_t values[3])
{
    return values[0] | values[1] << 10 | values[2] << 20;
}

/* The share of the coarser of two, all of it at a size, nothing from smooth octaves above on. */
static float coarser_share(float octaves, float smooth)
{
    if (octaves < 0 || !(smooth > 0))
        return octaves < 0 ? 1 : 0;
    return fmaxf(0, 1 - octaves / smooth);
}

/* What a tree is drawn as; returns how many pieces. */
static int pieces_of(const struct trees_gl *trees, const struct picture *picture, uint32_t number,
                     float depth_m, struct piece pieces[PIECES_MOST])
{
    static const float small_px = 0.75f;
    const struct view *view = picture->view;
    const struct march_tree *tree = &trees->trees[number];
    const struct voxels *volume = trees->voxels->volumes[tree->species];
    const float smooth = trees->smooth;
    const uint32_t last = volume->levels_count - 1;
    float detail = march_detail_of(view, tree, volume, picture->focal_px, trees->bias, depth_m);
    struct march_box box = march_box_of(view, tree, volume, 0);
    struct march_outline outline = march_outline_of(view, &box, picture->focal_px);
    float side_px = fmaxf(outline.high[0] - outline.low[0], outline.high[1] - outline.low[1]);
    float small = outline.before ? coarser_share(log2f(side_px / (2 * small_px)), smooth) : 0;
    uint32_t level = (uint32_t)detail;
    float next = level < last ? coarser_share((float)(level + 1) - detail, smooth) : 0;
    const struct piece all[PIECES_MOST] = {{level, false, (1 - next) * (1 - small)},
                                           {level + 1, false, next * (1 - small)},
                                           {last, true, small}};
    int count = 0;
    for (int k = 0; k < PIECES_MOST; k++)
        if (all[k].share > 0)
            pieces[count++] = all[k];
    return count;
}

/* Where its sunlight is found. */
static void light(const struct trees_gl *trees, uint32_t number, const struct piece *piece,
                  struct tree_texels *texels)
{
    struct sunlight_gl_place place = sunlight_gl_of(trees->sunlight, number, piece->level);
    texels->volume = place.volume;
    texels->gains = place.gains;
    texels->lit = piece->small ? sunlight_gl_far(trees->sunlight, number, texels->where) : -1;
}

static void see(const struct trees_gl *trees, const struct picture *picture, uint32_t number,
                const struct piece *piece, struct tiles_rect *rect, struct tree_texels *texels)
{
    const struct view *view = picture->view;
    const struct march_tree *tree = &trees->trees[number];
    const struct voxels *volume = trees->voxels->volumes[tree->species];
    struct march_box box = march_box_of(view, tree, volume, piece->small ? 0 : piece->level);
    struct march_outline outline = march_outline_of(view, &box, picture->focal_px);
    const struct voxels_level *grid = &volume->levels[piece->level];
    const float voxel_m = tree->scale * grid->voxel_m;
    if (piece->small) {
        place_small(picture, tree, &outline, &box, voxel_m, rect, texels);
        bound_rect(rect, texels);
    } else {
        texels->per_m = 1 / voxel_m;
        march_eye_of(view, tree, volume, piece->level, texels->per_m, texels->where);
        place(picture, &outline, &box, grid->size,
              &trees->voxels->hulls[tree->species][piece->level], rect, texels);
    }
    uint32_t albedo[3];
    for (int c = 0; c < 3; c++)
        albedo[c] = (uint32_t)(volume->albedo[c] * 1023 + 0.5f);
    bool within =
        !outline.before && march_within_bark(view, tree, trees->voxels->meshes[tree->species]);
    texels->first_cell = trees->voxels->first_cells[tree->species][piece->level];
    texels->size = pack_10(grid->size) | (uint32_t)piece->small << 30 | (uint32_t)within << 31;
    texels->turn[0] = tree->cosine / tree->stretch;
    texels->turn[1] = tree->sine / tree->stretch;
    float clear = march_box_clear(&box, picture->fog_density);
    texels->shares = (uint32_t)(65535 * clear + 0.5f) | (uint32_t)(65535 * piece->share + 0.5f)
                                                            << 16;
    texels->albedo = pack_10(albedo);
    if (trees->sunlight)
        light(trees, number, piece, texels);
}

size_t trees_gl_see(struct trees_gl *trees, const struct view *view, const struct cull_list *list,
                    float fog_density_per_m, const struct tiles_rect **rects,
                    const struct tree_texels **texels)
{
    const struct picture picture = {view, cull_focal_px(view), fog_density_per_m};
    size_t count = 0;
    for (size_t i = 0; i < list->count; i++) {
        struct piece pieces[PIECES_MOST];
        const uint32_t number = list->instances[i];
        int pieces_count = pieces_of(trees, &picture, number, list->depths_m[i], pieces);
        for (int k = 0; k < pieces_count; k++, count++)
            see(trees, &picture, number, &pieces[k], &trees->rects[count], &trees->texels[count]);
    }
    *rects = trees->rects;
    *texels = trees->texels;
    return count;
}
