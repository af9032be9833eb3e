/* Trees in a view: their matrices, how much of them is drawn, strips of rods, bark. */
#include "bake/cone_emit.h"
#include "bake/cone_emit_parts.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265f

static float dot3(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* R_y(-rotation). */
static void to_plant(const struct instance *instance, const float world[3], float plant[3])
{
    float c = cosf(instance->rotation_rad), s = sinf(instance->rotation_rad);
    plant[0] = world[0] * c - world[2] * s;
    plant[1] = world[1];
    plant[2] = world[0] * s + world[2] * c;
}

/* How many of count to draw where their area on the screen is so large. areas: sums of the first so
 * many. */
static float kept_of(size_t count, const float *areas, float thin, float area_px2, float *grown)
{
    static const float least = CONE_LANES; /* fewer take no less time */
    float all = (float)count, kept = thin > 0 ? fmaxf(thin * area_px2, least) : all;
    kept = fminf(kept, all);
    *grown = 1;
    if (!(kept < all))
        return kept;
    size_t whole = (size_t)kept;
    float part = areas[whole] + (kept - (float)whole) * (areas[whole + 1] - areas[whole]);
    *grown = areas[count] / fmaxf(part, 1e-6f * areas[count]);
    return kept;
}

/* Pieces of a trunk together are at least a pixel long. */
static uint32_t trunk_step_of(float piece_px)
{
    uint32_t step = 1;
    while (step < 64 && (float)step * piece_px < 1)
        step *= 2;
    return step;
}

void cone_tree_thin(const struct cone_choice *choice, float px, struct cone_tree *tree)
{
    const struct cone_plant *plant = tree->plant;
    const float area_px2 = px * px * plant->area_m2;
    tree->twigs =
        kept_of(plant->twigs_count, plant->twigs_areas, choice->thin, area_px2, &tree->twigs_grown);
    tree->barks = kept_of(plant->barks_count - plant->trunks_count, plant->barks_areas,
                          choice->thin, area_px2, &tree->barks_grown);
    tree->barks += (float)plant->trunks_count;
    tree->trunk_step = choice->thin > 0 ? trunk_step_of(px * plant->piece_m) : 1;
}

/* The share of a plant's opacity as it is seen from here. */
static float fill_of(const struct cone_tree *tree, float px)
{
    float eye[3];
    for (int i = 0; i < 3; i++)
        eye[i] = tree->eye_m[i] - tree->plant->center_m[i];
    return cone_outline_fill(&tree->plant->outline, 2 * px * tree->plant->radius_m,
                             eye[1] / sqrtf(fmaxf(dot3(eye, eye), 1e-30f)));
}

void cone_tree_of(const struct cone_picture *picture, size_t index, struct cone_tree *tree)
{
    const struct instance *instance = &picture->scene->instances[index];
    const struct view *view = picture->view;
    const float *axes[3] = {view->right, view->up, view->forward};
    float offset[3];
    tree->plant = picture->plants[instance->species];
    tree->scale = instance->scale;
    for (int i = 0; i < 3; i++)
        offset[i] = instance->position_m[i] - view->eye_m[i];
    for (int k = 0; k < 3; k++) {
        to_plant(instance, axes[k], tree->to_camera[k]);
        for (int i = 0; i < 3; i++)
            tree->to_camera[k][i] *= instance->scale;
        tree->foot_m[k] = dot3(axes[k], offset);
        tree->sun_camera[k] = dot3(axes[k], view->sun_direction);
    }
    to_plant(instance, offset, tree->eye_m);
    for (int i = 0; i < 3; i++)
        tree->eye_m[i] /= -instance->scale;
    to_plant(instance, view->sun_direction, tree->sun);
    float middle_m[3], px = picture->focal_px * instance->scale;
    cone_to_camera(tree, tree->plant->center_m, middle_m);
    px /= fmaxf(middle_m[2] - instance->scale * tree->plant->radius_m, view->near_m);
    cone_tree_thin(&picture->choice, px, tree);
    tree->fill = fill_of(tree, px);
    tree->light.cones = NULL;
    if (picture->lights)
        cone_lights_of_tree(picture->lights, index, &tree->light);
}

bool cone_picture_sees(const struct cone_picture *picture, const float middle_m[3], float radius_m)
{
    const float nearest_m = middle_m[2] - radius_m, px = picture->focal_px / middle_m[2];
    if (!picture->canvas || nearest_m <= picture->view->near_m)
        return true;
    const float place_px[2] = {0.5f * (float)picture->view->width_px + px * middle_m[0],
                               0.5f * (float)picture->view->height_px - px * middle_m[1]};
    return cone_canvas_sees(picture->canvas, place_px,
                            1.5f * picture->focal_px / nearest_m * radius_m + 2, nearest_m);
}

void cone_to_camera(const struct cone_tree *tree, const float place_m[3], float camera_m[3])
{
    for (int k = 0; k < 3; k++)
        camera_m[k] = dot3(tree->to_camera[k], place_m) + tree->foot_m[k];
}

bool cone_strip_place(const struct cone_picture *picture, const struct cone_tree *tree,
                      const struct cone_rod *rod, struct cone_strip *strip)
{
    const float near_m = picture->view->near_m;
    float ends[2][3], radius[2], screen[2][2];
    for (int end = 0; end < 2; end++) {
        cone_to_camera(tree, rod->ends_m[end], ends[end]);
        radius[end] = tree->scale * rod->radius_m[end];
    }
    if (ends[0][2] <= near_m && ends[1][2] <= near_m)
        return false;
    for (int end = 0; end < 2; end++)
        if (ends[end][2] < near_m) {
            float share = (near_m - ends[end][2]) / (ends[1 - end][2] - ends[end][2]);
            for (int i = 0; i < 3; i++)
                ends[end][i] += share * (ends[1 - end][i] - ends[end][i]);
            radius[end] += share * (radius[1 - end] - radius[end]);
        }
    float way_m[3] = {ends[1][0] - ends[0][0], ends[1][1] - ends[0][1], ends[1][2] - ends[0][2]};
    for (int end = 0; end < 2; end++) {
        float px = picture->focal_px / ends[end][2];
        screen[end][0] = 0.5f * (float)(picture->view->width_px - 1) + px * ends[end][0];
        screen[end][1] = 0.5f * (float)(picture->view->height_px - 1) - px * ends[end][1];
        strip->half_px[end] = px * radius[end];
        strip->depths_m[end] = ends[end][2];
    }
    strip->depth_m = 0.5f * (ends[0][2] + ends[1][2]);
    float x = screen[1][0] - screen[0][0], y = screen[1][1] - screen[0][1];
    strip->length_px = sqrtf(x * x + y * y);
    strip->along[0] = strip->length_px > 1e-4f ? x / strip->length_px : 1;
    strip->along[1] = strip->length_px > 1e-4f ? y / strip->length_px : 0;
    memcpy(strip->from_px, screen[0], sizeof screen[0]);
    /* a capped cylinder's two half discs, as long as they are large */
    float middle[3] = {ends[0][0] + ends[1][0], ends[0][1] + ends[1][1], ends[0][2] + ends[1][2]};
    float c = fabsf(dot3(way_m, middle)) /
              sqrtf(fmaxf(dot3(way_m, way_m) * dot3(middle, middle), 1e-30f));
    for (int end = 0; end < 2; end++)
        strip->beyond_px[end] = 0.25f * PI * c * strip->half_px[end];
    strip->opacity = 1;
    strip->round = 0;
    strip->mean = 1;
    strip->lit[0] = strip->lit[1] = 1;
    return true;
}

void cone_strip_color(const struct cone_picture *picture, const struct cone_material *material,
                      const struct needles_shade *shade, struct cone_strip *strip)
{
    float clear = 1;
    if (picture->fog_density_per_m > 0) {
        float x = strip->from_px[0] + 0.5f * strip->length_px * strip->along[0];
        float y = strip->from_px[1] + 0.5f * strip->length_px * strip->along[1];
        x = (x - 0.5f * (float)picture->view->width_px) / picture->focal_px;
        y = (y - 0.5f * (float)picture->view->height_px) / picture->focal_px;
        clear = expf(-picture->fog_density_per_m * strip->depth_m * sqrtf(1 + x * x + y * y));
    }
    for (int c = 0; c < 3; c++) {
        strip->shade[c] = clear * material->albedo[c] * picture->ambient[c] +
                          (1 - clear) * picture->scene->fog.color[c];
        strip->sun[c] =
            clear * picture->sun[c] *
            (material->albedo[c] * shade->diffuse + material->specular * shade->specular);
    }
}

void cone_strip_round(const struct cone_tree *tree, const struct cone_rod *rod, float mean,
                      struct cone_strip *strip)
{
    float half = fmaxf(strip->half_px[0], strip->half_px[1]);
    strip->mean = mean;
    strip->round = fminf(fmaxf(2 * half - 1, 0), 1);
    if (strip->round <= 0)
        return;
    float axis[3], eye[3], ends[2][3], across[3];
    for (int end = 0; end < 2; end++)
        cone_to_camera(tree, rod->ends_m[end], ends[end]);
    for (int i = 0; i < 3; i++) {
        axis[i] = ends[1][i] - ends[0][i];
        eye[i] = -0.5f * (ends[0][i] + ends[1][i]);
    }
    float square = fmaxf(dot3(axis, axis), 1e-30f), along = dot3(eye, axis) / square;
    for (int i = 0; i < 3; i++)
        eye[i] -= along * axis[i]; /* across the axis, toward the eye */
    float length = sqrtf(fmaxf(dot3(eye, eye), 1e-30f));
    for (int i = 0; i < 3; i++)
        eye[i] /= length;
    across[0] = axis[1] * eye[2] - axis[2] * eye[1];
    across[1] = axis[2] * eye[0] - axis[0] * eye[2];
    across[2] = axis[0] * eye[1] - axis[1] * eye[0];
    /* to the side of the screen where its across_px grows: y down */
    float side = -across[0] * strip->along[1] - across[1] * strip->along[0];
    float per = (side < 0 ? -1 : 1) / sqrtf(square);
    strip->across = per * dot3(across, tree->sun_camera);
    strip->toward = dot3(eye, tree->sun_camera);
}

float cone_opacity_part(float opacity, float share)
{
    return share >= 1 ? opacity : 1 - powf(1 - fminf(opacity, 0.9999f), share);
}

bool cone_beam_meets(const struct cone_beam *beam, const float center_m[3], float radius_m)
{
    float way[3];
    for (int i = 0; i < 3; i++)
        way[i] = center_m[i] - beam->origin_m[i];
    float at = dot3(way, beam->direction), square = dot3(way, way) - at * at;
    float reach = radius_m + beam->wide_m + beam->spread * fmaxf(at + radius_m, 0);
    return at > -radius_m && square < reach * reach;
}

size_t cone_bark_emit(const struct cone_picture *picture, const struct cone_tree *tree,
                      size_t index, struct cone_strip *strip)
{
    const struct cone_plant *plant = tree->plant;
    const struct cone_bark *bark = &plant->barks[index], *last = bark;
    struct cone_rod rod = {.radius_m = {bark->radius_m[0], bark->radius_m[1]}};
    float axis[3], eye[3], middle_m[3], grown = 1;
    if (index < plant->trunks_count && tree->trunk_step > 1) {
        if (bark->place % tree->trunk_step)
            return 0;
        uint32_t left = bark->pieces - bark->place;
        last += (left < tree->trunk_step ? left : tree->trunk_step) - 1;
        rod.radius_m[1] = last->radius_m[1];
    }
    memcpy(rod.ends_m[0], bark->from_m, sizeof rod.ends_m[0]);
    memcpy(rod.ends_m[1], last->to_m, sizeof rod.ends_m[1]);
    for (int i = 0; i < 3; i++) {
        middle_m[i] = 0.5f * (bark->from_m[i] + last->to_m[i]);
        axis[i] = last->to_m[i] - bark->from_m[i];
        eye[i] = tree->eye_m[i] - middle_m[i];
    }
    float length = sqrtf(fmaxf(dot3(axis, axis), 1e-30f)), away = sqrtf(dot3(eye, eye));
    if (index >= plant->trunks_count) {
        grown = tree->barks_grown * fminf(tree->barks - (float)index, 1);
        grown = sqrtf(fmaxf(grown, 0));
        for (int i = 0; i < 3 && grown != 1; i++) {
            rod.ends_m[0][i] = middle_m[i] - 0.5f * grown * axis[i];
            rod.ends_m[1][i] = middle_m[i] + 0.5f * grown * axis[i];
        }
    }
    for (int i = 0; i < 3; i++) {
        axis[i] /= length;
        eye[i] /= fmaxf(away, 1e-20f);
    }
    rod.radius_m[0] *= grown;
    rod.radius_m[1] *= grown;
    if (!cone_strip_place(picture, tree, &rod, strip))
        return 0;
    if (grown == 1) /* half a pixel, and less of what is shorter than a pixel */
        for (int end = 0; end < 2; end++)
            strip->beyond_px[end] += 0.5f * fminf(strip->length_px * strip->length_px, 1);
    const struct cone_material material = {plant->conifer->bark_albedo, 0};
    const struct needles_shade white = {1, 0, 1};
    const struct needles_sight sight = needles_sight_of(tree->sun, eye, -1, false);
    cone_strip_color(picture, &material, &white, strip);
    cone_strip_round(tree, &rod, needles_reflect(axis, &sight).diffuse, strip);
    strip->opacity =
        cone_outline_part(&plant->outline, middle_m, fmaxf(rod.radius_m[0], rod.radius_m[1]), eye,
                          tree->scale * picture->focal_px / strip->depth_m);
    if (index >= plant->trunks_count)
        strip->opacity = fminf(tree->fill * strip->opacity, 1);
    if (tree->light.cones) {
        float gain = cone_tree_light_gain(&tree->light, middle_m);
        strip->lit[0] = strip->lit[1] = gain * (float)tree->light.barks[index] / 255;
    }
    return 1;
}
