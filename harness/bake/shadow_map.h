/* Shadow maps of the sun, as a room that methods share: trees and ground cast, and what is shaded
 * by bake/shade.glsl receives.
 *
 * Williams 1978; percentage-closer filtering: Reeves, Salesin, Cook 1987, doi:10.1145/37402.37435;
 * cascades: Zhang et al. 2006; light-space perspective: Wimmer, Scherzer, Purgathofer 2004; layers
 * of opacity behind the first depth: Kim, Neumann 2001 (opacity shadow maps), with the layers of
 * Yuksel, Keyser 2008 (deep opacity maps), coverage from 4 samples a texel. */
#ifndef TREELINE_BAKE_SHADOW_MAP_H
#define TREELINE_BAKE_SHADOW_MAP_H

#include "bake/shadow_math.h"
#include "method/method.h"

enum shadow_bias {
    SHADOW_BIAS_NONE,
    SHADOW_BIAS_CONSTANT,
    SHADOW_BIAS_SLOPE,
    SHADOW_BIAS_PLANE,
    SHADOW_BIAS_NORMAL
};
enum shadow_foliage { SHADOW_SOLID, SHADOW_ALPHA, SHADOW_DEEP };

struct shadow_options {
    int size_px, cascades; /* cascades 0: no map, all is what shadow_map_share says */
    float split;           /* lambda of shadow_splits */
    bool stable, perspective, linear;
    int radius; /* (2 radius + 1)^2 taps */
    enum shadow_bias bias;
    float bias_scale; /* times the closed form */
    int depth_bits;   /* 16, 24, 32 */
    enum shadow_foliage foliage;
    float layer_m;   /* of SHADOW_DEEP, each of four */
    float caster_tx; /* how coarse a caster may be, in texels of the map; 0: every triangle */
    float reach_m;   /* shadows are received to this depth; 0: all of the view */
    bool shared;     /* with what knows better near the eye: shadow_map_share */
};

struct shadow_map;
struct triangles;
struct shadow_billboards;
struct backdrop;

/* The trees that cast: as pictures where there are any that suit, else as triangles; NULL both:
 * none do. */
struct shadow_cast_by {
    struct triangles *triangles;
    const struct shadow_billboards *billboards;
};

/* Depths behind the first that a texel's coverage is kept for: 0, 1 or 4; shadow_map.glsl's LAYERS.
 */
int shadow_layers(const struct shadow_options *options);

enum status shadow_map_prepare(struct workspace *workspace, const struct scene *scene,
                               const struct shadow_options *options, struct shadow_map **map);

/* Makes what the view needs anew: all maps where their fits have changed since the last call, or
 * the levels of detail that a large ground is drawn by, else nothing; always in a counted draw,
 * whose tally it fills in. view: with the size of what is drawn into. Changes the framebuffer that
 * is bound. */
enum status shadow_map_update(struct workspace *workspace, struct shadow_map *map,
                              const struct view *view, const struct shadow_cast_by *trees,
                              const struct backdrop *backdrop);

/* Of a map that is shared, until the next call: a receiver no deeper than from_m is lit, or not, as
 * another says; from to_m on by the map alone; between them both count by the depth. */
struct shadow_share {
    float from_m, to_m;
    bool lit;
};
void shadow_map_share(struct shadow_map *map, struct shadow_share share);

/* The depth from which on a texel of the map, across the light, is no larger than texel_px pixels
 * of a view; at most its far plane, 0 where that is so everywhere. After shadow_map_update. */
float shadow_map_fine_m(const struct shadow_map *map, const struct view *view, float texel_px);

/* For what receives if there is a map: gl_program() where map is NULL, else with
 * shadow_map.glsl in front of the source and SHADOWED defined; and, of the program in use, uniforms
 * and textures, none where map is NULL. */
enum status shadow_receiver_program(struct workspace *workspace, const struct shadow_map *map,
                                    const char *name, const char *source, const char *defines,
                                    GLuint *program);
void shadow_receiver_uniforms(struct workspace *workspace, const struct shadow_map *map,
                              GLuint program);

/* For those who draw casters: the pass that is under way. */
struct shadow_pass {
    const struct shadow_fit *fit;
    float light[16];
    const GLuint *programs; /* SHADOW_CASTS */
    bool covers;            /* coverage behind the first depths is drawn, else the depths */
    int cascade;
    float layer_depth;
    float sun[3]; /* unit, toward it */
    float per_m;  /* tolerances a metre of a caster; 0: every triangle */
    const struct shadow_billboards *billboards; /* what suits them is cast by them; NULL: none */
};
/* What draws casters: gl_program() with shadow_cover.glsl at the head of the fragment stage; LAYERS
 * where it is to say what it covers. */
enum status shadow_cast_program(struct workspace *workspace, const struct shadow_options *options,
                                bool covers, const char *source, const char *defines,
                                GLuint *program);
enum {
    SHADOW_CAST_TERRAIN,
    SHADOW_CAST_PLAIN,
    SHADOW_CAST_TEXTURED,
    SHADOW_CAST_PRUNED,
    SHADOW_CASTS
};
void shadow_pass_use(struct workspace *workspace, const struct shadow_pass *pass, GLuint program);

#endif
