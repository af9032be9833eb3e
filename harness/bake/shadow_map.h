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
    int size_px, cascades;
    float split; /* lambda of shadow_splits */
    bool stable, perspective, linear;
    int radius; /* (2 radius + 1)^2 taps */
    enum shadow_bias bias;
    float bias_scale; /* times the closed form */
    int depth_bits;   /* 16, 24, 32 */
    enum shadow_foliage foliage;
    float layer_m;   /* of SHADOW_DEEP, each of four */
    float caster_tx; /* how coarse a caster may be, in texels of the map; 0: every triangle */
    float reach_m;   /* shadows are received to this depth; 0: all of the view */
};

struct shadow_map;
struct triangles;
struct backdrop;

enum status shadow_map_prepare(struct workspace *workspace, const struct scene *scene,
                               const struct shadow_options *options, struct shadow_map **map);

/* gl_program() with shadow_visibility() in front of the source and SHADOWED defined. */
enum status shadow_map_program(struct workspace *workspace, const struct shadow_map *map,
                               const char *name, const char *source, const char *defines,
                               GLuint *program);

/* Makes what the view needs anew: all maps where their fits have changed since the last call, else
 * nothing; always in a counted draw, whose tally it fills in. Changes the framebuffer that is
 * bound. trees: NULL for none. */
enum status shadow_map_update(struct workspace *workspace, struct shadow_map *map,
                              const struct view *view, struct triangles *trees,
                              const struct backdrop *backdrop);

/* Uniforms and textures of a receiver's program that is in use. */
void shadow_map_uniforms(struct workspace *workspace, const struct shadow_map *map, GLuint program);

/* For those who draw casters: the pass that is under way. */
struct shadow_pass {
    const struct shadow_fit *fit;
    float light[16];
    const GLuint *programs; /* SHADOW_CASTS */
    int cascade;
    float layer_depth;
    float per_m; /* tolerances a metre of a caster; 0: every triangle */
};
enum {
    SHADOW_CAST_TERRAIN,
    SHADOW_CAST_PLAIN,
    SHADOW_CAST_TEXTURED,
    SHADOW_CAST_PRUNED,
    SHADOW_CASTS
};
void shadow_pass_use(struct workspace *workspace, const struct shadow_pass *pass, GLuint program);

#endif
