/* The choice of sun shadows inside methods that draw what can cast or receive them: by a shadow map
 * (bake/shadow_map.h) or none, and what casts into it.
 *
 * What casts may be cheaper than what is seen: a map's texel is no pixel. */
#ifndef TREELINE_BAKE_SHADOW_CHOICE_H
#define TREELINE_BAKE_SHADOW_CHOICE_H

#include "bake/backdrop.h"
#include "bake/shadow_map.h"
#include "bake/triangles.h"

/* exact:     every triangle.
 * low:       fewer and larger pruned leaves, of shadow_options.caster_tx texels.
 * billboard: one picture a tree that faces the sun (bake/shadow_billboards.h). */
enum shadow_casters { SHADOW_CASTERS_EXACT, SHADOW_CASTERS_LOW, SHADOW_CASTERS_BILLBOARD };

/* clang-format off */
#define SHADOW_CASTERS_WORDS "exact|low|billboard"
#define SHADOW_CASTERS_DOC                                                                         \
    "what casts: every triangle; pruned leaves of about a texel; pictures that face the sun"

/* Rows of a method's table whose options hold a struct shadow_choice. */
#define SHADOW_CHOICE_OPTIONS(type, sun)                                                                \
    OPTION_WORD_IN(type, sun, shadow, 0, "none|map",                                               \
        "the sun's shadows on trees and ground: none, or those of a shadow map"),                  \
    OPTION_IN(type, sun, shadow_size, 2048, 256, 8192, "", "shadow=map: texels along a side of a map"), \
    OPTION_IN(type, sun, cascades, 4, 1, 4, "",                                                    \
        "shadow=map: maps, one behind the other along the view"),                                  \
    OPTION_WORD_IN(type, sun, casters, 1, SHADOW_CASTERS_WORDS, "shadow=map: " SHADOW_CASTERS_DOC)
/* clang-format on */

struct shadow_choice {
    int shadow, shadow_size, cascades, casters;
};

/* For a method's `effects`: all, or all but the sun's shadows. */
unsigned shadow_choice_effects(const struct shadow_choice *choice);

struct sun_shadows_request {
    struct shadow_options map;
    enum shadow_casters casters;
    bool own; /* the method draws no triangles that could cast: those that cast are made here */
};
/* What a choice asks for, with the settings that shadow-map has by default. */
struct sun_shadows_request shadow_choice_request(const struct shadow_choice *choice);

struct sun_shadows;

/* The map and what casts; the ground receives from now on. */
enum status sun_shadows_prepare(struct workspace *workspace, const struct scene *scene,
                                const struct sun_shadows_request *request,
                                struct backdrop *backdrop, struct sun_shadows **shadows);
/* Of a choice; NULL where it is none or the workspace wants no shadows. own as in the request. */
enum status shadow_choice_prepare(struct workspace *workspace, const struct scene *scene,
                                  const struct shadow_choice *choice, bool own,
                                  struct backdrop *backdrop, struct sun_shadows **shadows);

/* What receives; NULL of NULL. */
const struct shadow_map *sun_shadows_map(const struct sun_shadows *shadows);

/* shadow_map_share() of its map. */
void sun_shadows_share(struct sun_shadows *shadows, struct shadow_share share);

/* Samples of maps that a receiver's fragment takes; 0 of NULL. */
uint64_t sun_shadows_samples(const struct sun_shadows *shadows);

/* Before each picture: makes the map that its view needs (shadow_map_update), with the size of what
 * is drawn into. drawn: the method's
 * own triangles, which cast unless pictures do; NULL where the request said own. Nothing with
 * shadows NULL. */
enum status sun_shadows_update(struct workspace *workspace, struct sun_shadows *shadows,
                               const struct view *view, struct triangles *drawn);

#endif
