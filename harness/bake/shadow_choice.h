/* The choice of sun shadows inside methods that draw what can cast or receive them: none; a shadow
 * map (bake/shadow_map.h); shadow volumes (bake/shadow_volume.h); volumes near by and a map beyond.
 *
 * What a method draws receives a struct shadow_map, whatever the technique: with volumes it is one
 * that says of all surfaces at once whether they are lit, and all are drawn twice: out of the sun,
 * and, where no volume is counted, in it (Abderrahmani 2018, 5.1, the three passes). So volumes
 * want one depth a sample: nothing that blends can receive them.
 *
 * What casts into a map may be cheaper than what is seen: its texel is no pixel. Volumes stand
 * behind every triangle. */
#ifndef TREELINE_BAKE_SHADOW_CHOICE_H
#define TREELINE_BAKE_SHADOW_CHOICE_H

#include "bake/backdrop.h"
#include "bake/shadow_map.h"
#include "bake/shadow_volume.h"
#include "bake/triangles.h"

/* exact:     every triangle.
 * low:       fewer and larger pruned leaves, of shadow_options.caster_tx texels.
 * billboard: one picture a tree that faces the sun (bake/shadow_billboards.h), where its texels are
 *            no larger than the map's, else as low. */
enum shadow_casters { SHADOW_CASTERS_EXACT, SHADOW_CASTERS_LOW, SHADOW_CASTERS_BILLBOARD };
enum shadow_technique { SHADOW_BY_NONE, SHADOW_BY_MAP, SHADOW_BY_VOLUME, SHADOW_BY_HYBRID };

/* clang-format off */
#define SHADOW_CASTERS_WORDS "exact|low|billboard"
#define SHADOW_CASTERS_DOC                                                                         \
    "what casts: every triangle; pruned leaves of about a texel; pictures that face the sun, where " \
    "their texels are no larger than the map's"

/* Rows of a method's table whose options hold a struct shadow_choice: of one whose slices blend, */
#define SHADOW_CHOICE_OPTIONS(type, sun)                                                                \
    OPTION_WORD_IN(type, sun, shadow, 0, "none|map",                                               \
        "the sun's shadows on trees and ground: none, or those of a shadow map; "                  \
        "volumes want one depth a pixel, slices have many"),                                       \
    SHADOW_CHOICE_MAP_OPTIONS(type, sun, "shadow=map: ")
/* and of one that can draw one depth a sample. */
#define SHADOW_CHOICE_VOLUME_OPTIONS(type, sun)                                                    \
    OPTION_WORD_IN(type, sun, shadow, 0, "none|map|volume|hybrid",                                 \
        "the sun's shadows on trees and ground: none, of a shadow map, of shadow volumes, "        \
        "or of volumes near by and a map beyond"),                                                 \
    SHADOW_CHOICE_MAP_OPTIONS(type, sun, "shadow=map, hybrid: "),                                  \
    OPTION_IN(type, sun, triangles, 524288, 10000, 8388608, "",                                    \
        "shadow=volume, hybrid: that all trees may have together; more are refused: each casts a " \
        "volume in every frame")
#define SHADOW_CHOICE_MAP_OPTIONS(type, sun, of)                                                   \
    OPTION_IN(type, sun, shadow_size, 2048, 256, 8192, "", of "texels along a side of a map"),     \
    OPTION_IN(type, sun, cascades, 4, 1, 4, "", of "maps, one behind the other along the view"),   \
    OPTION_WORD_IN(type, sun, casters, 1, SHADOW_CASTERS_WORDS, of SHADOW_CASTERS_DOC)
/* clang-format on */

struct shadow_choice {
    int shadow, shadow_size, cascades, casters, triangles;
};

/* For a method's `effects`: all, or all but the sun's shadows. */
unsigned shadow_choice_effects(const struct shadow_choice *choice);

struct sun_shadows_request {
    enum shadow_technique technique;
    /* of maps */
    struct shadow_options map;
    enum shadow_casters casters;
    bool own; /* the method draws no triangles that could cast: those that cast are made here */
    /* of volumes */
    struct shadow_volume_request volume;
    int triangles_most; /* of all trees together */
    /* of both */
    float near_m;   /* volumes shade what is nearer; 0: to where the map's texels are as small as */
    float texel_px; /* so many pixels */
    float blend;    /* share of that depth, 0..1, before whose end both count */
};
/* What a choice asks for, with the settings that shadow-map and shadow-hybrid have by default;
 * volumes begin a little behind what casts. */
struct sun_shadows_request shadow_choice_request(const struct shadow_choice *choice);

struct sun_shadows;

/* Maps, volumes and what casts; the ground receives from now on. STATUS_UNSUPPORTED where volumes
 * are asked for and the trees or the terrain have too many triangles, or the terrain is drawn by
 * levels of detail: it casts every triangle. */
enum status sun_shadows_prepare(struct workspace *workspace, const struct scene *scene,
                                const struct sun_shadows_request *request,
                                struct backdrop *backdrop, struct sun_shadows **shadows);
/* Of a choice; NULL where it is none or the workspace wants no shadows. own as in the request. */
enum status shadow_choice_prepare(struct workspace *workspace, const struct scene *scene,
                                  const struct shadow_choice *choice, bool own,
                                  struct backdrop *backdrop, struct sun_shadows **shadows);

/* What receives; NULL of NULL. */
const struct shadow_map *sun_shadows_map(const struct sun_shadows *shadows);

/* Whether pictures are drawn in passes, into what has a stencil buffer; not of NULL. */
bool sun_shadows_count(const struct sun_shadows *shadows);

/* Samples of maps that a receiver's fragment takes; 0 of NULL. */
uint64_t sun_shadows_samples(const struct sun_shadows *shadows);

/* Before each picture: makes the map that its view needs (shadow_map_update), with the size of what
 * is drawn into. drawn: the method's own triangles, which cast where no picture does; NULL where
 * the request said own. Nothing with shadows NULL. */
enum status sun_shadows_update(struct workspace *workspace, struct sun_shadows *shadows,
                               const struct view *view, struct triangles *drawn);

/* Ground and trees of a view into what is bound, backdrop_draw first: a method's own. */
typedef enum status sun_shadows_surfaces(struct workspace *workspace, void *state,
                                         const struct view *view);
/* A picture's surfaces, once, or in passes with volumes counted between them: then with the far
 * plane at infinity, and where the stencil test fails what was drawn before stays. drawn: the view
 * with the size of what is bound. After sun_shadows_update. */
enum status sun_shadows_draw(struct workspace *workspace, struct sun_shadows *shadows,
                             const struct view *view, const struct view *drawn,
                             sun_shadows_surfaces *surfaces, void *state);

#endif
