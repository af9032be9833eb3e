/* A scene: what is to be drawn, as data. scene.json is documented in scenes/README.md. */
#ifndef TREELINE_SCENE_SCENE_H
#define TREELINE_SCENE_SCENE_H

#include "base/arena.h"
#include "base/error.h"
#include "plant/plant.h"
#include "scene/effects.h"

#include <cglm/cglm.h>
#include <math.h>

enum lod { LOD_LOW, LOD_INTERMEDIATE, LOD_HIGH, LOD_AUTO };
const char *lod_word(enum lod lod); /* "low", "intermediate", "high", "auto" */
bool lod_from_word(const char *word, enum lod *lod);

struct species {
    const char *name;
    struct plant *plant;
    float weight;               /* share of the trees */
    float scale_min, scale_max; /* uniform */
};

/* One tree. World position = R_y(rotation) * scale * diag(1, stretch, 1) * vertex + position. A
 * normal's direction is R_y(rotation) * diag(1, 1 / stretch, 1) * normal: what a vector transforms
 * by, transposed and inverted, so that it stays perpendicular to the surface. */
struct instance {
    float position_m[3];
    float rotation_rad; /* about +y: x' = x cos + z sin, z' = -x sin + z cos */
    float scale;        /* of width and height */
    uint32_t species;
    float stretch; /* height over width, > 0 */
};

/* A regular height field centred on the origin, or nothing (samples_x == 0). Quad (i, j) is cut
 * along the diagonal from (i, j) to (i+1, j+1). terrain_mesh() below is the surface that everybody
 * draws and traces. */
struct terrain {
    uint32_t samples_x, samples_z; /* vertices along x and z, >= 2 */
    float size_x_m, size_z_m;
    float *heights_m;    /* samples_z x samples_x */
    float (*normals)[3]; /* samples_z x samples_x, unit, central differences on both axes */
    float albedo[3];
    float (*colors)[3]; /* samples_z x samples_x, linear; times albedo. NULL: 1 everywhere */
    float
        detail_px; /* how far OpenGL's backdrop may move the surface in a picture; 0: not at all */
};

struct sun {
    float azimuth_rad;   /* 0 is toward +z, grows toward +x */
    float elevation_rad; /* 0 horizon, pi/2 zenith */
    float end_azimuth_rad,
        end_elevation_rad; /* at the end of the camera path; equal: the sun stands still */
    float radiance[3];
};

struct sky {
    float zenith[3], horizon[3], ground[3];
};

struct fog {
    float color[3];
    float density_per_m;
};

enum path_kind { PATH_STILL, PATH_ORBIT, PATH_WALK, PATH_APPROACH, PATH_FLY_OVER, PATH_KEYS };

struct camera_key {
    float eye_m[3], target_m[3];
};

/* Keys already in metres (JSON may give them in units of the forest's half side). still: 1 key;
 * orbit: 1 key, the eye turns around the target by turn_rad and rises by rise_rad, at most to
 * straight above or below it; walk, fly-over, approach: straight from first to last key (approach
 * in equal ratios of distance to the target; walk keeps the eye's height above the ground, which
 * changes evenly from the first key's to the last's); keys: Catmull-Rom through all. clearance_m
 * keeps the eye above the terrain. */
struct camera_path {
    enum path_kind kind;
    size_t keys_count;
    struct camera_key *keys;
    float turn_rad, rise_rad;
    float clearance_m;
    float fov_y_rad;
    float near_m, far_m; /* near > 0; the frustum holds the whole scene */
    size_t frames_count; /* default number of frames along the path, >= 1 */
};

struct scene {
    const char *name; /* file name without .json */
    const char *path;
    int width_px, height_px;
    unsigned effects; /* wanted */
    size_t species_count;
    struct species *species; /* those that have at least one instance */
    size_t instances_count;
    struct instance *instances;
    double origin_m[3];  /* of all that follows, in scene.json's coordinates; y is 0; 0, 0 but where
                            the camera is far away and no terrain is */
    float forest_half_m; /* half side of the square that holds the trees' feet */
    struct terrain terrain;
    struct sun sun;
    float ambient[3];
    struct sky sky;
    struct fog fog;
    struct camera_path camera;
    float minimum_m[3], maximum_m[3]; /* of terrain and feet; trees rise above */
    float tree_reach_m; /* no tree's vertex is farther from its foot, by the species' reach_m in
                           scene.json */
    uint64_t hash; /* of all that can change a picture except effects, view and size: placement,
                      plants (by parameters or file bytes), terrain, light, sky, fog */
};

struct scene_request {
    size_t trees;            /* SIZE_MAX: the scene's default */
    uint64_t seed;           /* placement */
    int width_px, height_px; /* 0: the scene's default */
};

/* name: "tiny" (scenes/tiny.json in data_folder()) or a path that ends in .json. Unknown keys,
 * wrong types and values out of range are STATUS_INVALID with "FILE: key.path: value is ...;
 * allowed: ...". */
enum status scene_load(struct arena *arena, const char *name, const struct scene_request *request,
                       struct scene **scene, struct error *error);

/* What scene.json says without placing trees or reading terrain: for `list scenes` and plans. */
struct scene_summary {
    const char *name, *doc;
    int width_px, height_px;
    size_t default_trees;
    const size_t *trees; /* the standard tree counts of this scene */
    size_t trees_count;
    unsigned effects;
    size_t frames_count;
};
enum status scene_summary(struct arena *arena, const char *name, struct scene_summary *summary,
                          struct error *error);
/* Names of the scenes in data_folder()/scenes, sorted. */
enum status scene_names(struct arena *arena, char ***names, size_t *count, struct error *error);

/* One picture's camera and sun. Metres; matrices column-major, OpenGL clip space (z in [-1, 1]). */
struct view {
    mat4 view, projection, view_projection;
    float eye_m[3];
    float right[3], up[3], forward[3]; /* unit */
    float fov_y_rad, near_m, far_m;
    int width_px, height_px;
    float sun_direction[3]; /* unit, toward the sun */
    double time;            /* along the path, 0..1 */
};

/* The view at time in [0, 1] along the path; NaN and values outside are clamped. */
void view_at(const struct scene *scene, double time, struct view *view);
/* The time of frame k of n: k / n on a closed orbit, k / (n - 1) elsewhere, 0 when n is 1. */
double path_time(const struct scene *scene, size_t frame, size_t frames_count);
/* An arbitrary camera (tests, `render --eye --target`), the sun as at time 0. near and far are the
 * path's, or farther apart where this view needs it. Looking straight down, the picture's top is
 * -z; straight up, +z. */
void view_look_at(const struct scene *scene, const float eye_m[3], const float target_m[3],
                  struct view *view);

/* Where the eye stands as seen from what it looks at: its elevation above the horizon, -90..90, and
 * its azimuth, 0..360, measured as the sun's: 0 is toward +z, grows toward +x. */
void view_angles_deg(const struct view *view, double *elevation_deg, double *azimuth_deg);

/* Unit direction of the ray through image point (x, y) in pixels, origin at the top left corner of
 * the picture. */
void view_ray(const struct view *view, float x_px, float y_px, float direction[3]);

/* The sky in a unit direction; below the horizon the ground colour. Continuous, monotone in
 * direction.y: y >= 0: mix(horizon, zenith, sqrt(y)); y < 0: mix(horizon, ground, min(1, -8 y)). */
static inline void sky_radiance(const struct sky *sky, const float direction[3], float radiance[3])
{
    float y = direction[1];
    const float *end = y >= 0 ? sky->zenith : sky->ground;
    float t = y >= 0 ? sqrtf(y) : fminf(1.0f, -8.0f * y);
    for (int i = 0; i < 3; i++)
        radiance[i] = sky->horizon[i] + t * (end[i] - sky->horizon[i]);
}

/* Height of the triangulated terrain at (x, z), clamped to its border; 0 without terrain. */
float terrain_height(const struct terrain *terrain, float x_m, float z_m);
/* The albedo of the triangulated terrain at (x, z), clamped to its border. */
void terrain_albedo(const struct terrain *terrain, float x_m, float z_m, float albedo[3]);
/* Degrees of the triangle at (x, z) against the horizon; 0 without terrain. */
float terrain_slope_deg(const struct terrain *terrain, float x_m, float z_m);
/* The terrain as a mesh with one MATERIAL_BARK material; NULL without terrain. */
struct mesh *terrain_mesh(struct arena *arena, const struct terrain *terrain);

/* Model matrix of an instance. */
void instance_matrix(const struct instance *instance, mat4 matrix);

/* How far a metre of the plant reaches in the tree, at most: its larger scale. */
static inline float instance_reach(const struct instance *instance)
{
    return instance->scale * fmaxf(1, instance->stretch);
}

/* Whether some tree has another ratio of height to width than its plant. */
bool scene_is_stretched(const struct scene *scene);

/* True when the sphere may touch the view frustum. */
bool view_sees_sphere(const struct view *view, const float center_m[3], float radius_m);

#endif
