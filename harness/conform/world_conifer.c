/* The conifer of the conformance checks: whorls of boughs, twigs on them, needles on these. */
#include "conform/world_conifer.h"

#include "plant/conifer.h"

#include <math.h>
#include <string.h>

enum { WHORLS = 12, BOUGHS = 7, TWIGS = 2, CONES = 10, NEEDLES = 10 };
static const float ROOT_M = -0.3f, TOP_M = 19.5f, TRUNK_M[2] = {0.5f, 0.1f};
static const float LOWEST_M = 5.5f, HIGHEST_M = 19, BOUGHS_M[2] = {4, 0.9f};
static const float NEEDLE_M = 0.45f, NEEDLE_RADIUS_M = 0.01f;

/* At a height, about as thick as the trunk of the world's other tree. */
static float trunk_m(float y_m)
{
    return TRUNK_M[0] + (y_m - ROOT_M) / (TOP_M - ROOT_M) * (TRUNK_M[1] - TRUNK_M[0]);
}

/* Twigs fork from a bough to both sides, and a little upward. */
static void twigs_add(struct conifer *conifer, const struct conifer_branch *bough, float turn_rad,
                      float bough_m)
{
    for (int k = 0; k < TWIGS; k++) {
        struct conifer_twig *twig = &conifer->twigs[conifer->twigs_count++];
        const float at = 0.35f + 0.4f * (float)k, away_rad = turn_rad + (k ? -0.5f : 0.5f);
        const float rise = 0.2f, flat = sqrtf(1 - rise * rise), length_m = 0.5f * bough_m;
        *twig = (struct conifer_twig){
            .axis = {flat * cosf(away_rad), rise, flat * sinf(away_rad)},
            .length_m = length_m,
            .axis_radius_m = 0.02f,
            .cones_count = CONES,
            .spacing_m = length_m / CONES,
            .needles_count = NEEDLES,
            .needle_length_m = NEEDLE_M,
            .needle_radius_m = NEEDLE_RADIUS_M,
            .needle_angle_rad = 0.8f,
            .azimuth_step_rad = 0.9f,
        };
        for (int i = 0; i < 3; i++)
            twig->base_m[i] = bough->from_m[i] + at * (bough->to_m[i] - bough->from_m[i]);
    }
}

static void whorl_add(struct conifer *conifer, int whorl)
{
    const float share = (float)whorl / (WHORLS - 1), rise = 0.1f;
    const float y_m = LOWEST_M + share * (HIGHEST_M - LOWEST_M);
    const float bough_m = BOUGHS_M[0] + share * (BOUGHS_M[1] - BOUGHS_M[0]);
    for (int k = 0; k < BOUGHS; k++) {
        struct conifer_branch *bough = &conifer->branches[conifer->branches_count++];
        const float turn_rad = 2.4f * (float)whorl + 6.2831853f * (float)k / BOUGHS;
        *bough = (struct conifer_branch){
            .from_m = {0, y_m, 0},
            .to_m = {bough_m * cosf(turn_rad), y_m + rise * bough_m, bough_m * sinf(turn_rad)},
            .radius_from_m = 0.2f * trunk_m(y_m),
            .radius_to_m = 0.01f,
            .first_twig = (uint32_t)conifer->twigs_count,
            .twigs_count = TWIGS,
        };
        twigs_add(conifer, bough, turn_rad, bough_m);
    }
}

struct plant *world_conifer(struct arena *arena)
{
    static const float needles[3] = {0.2f, 0.42f, 0.1f}, bark[3] = {0.25f, 0.18f, 0.12f};
    struct conifer *conifer = ARENA_NEW(arena, struct conifer);
    conifer->branches = ARENA_ARRAY(arena, struct conifer_branch, 1 + WHORLS * BOUGHS);
    conifer->twigs = ARENA_ARRAY(arena, struct conifer_twig, WHORLS * BOUGHS * TWIGS);
    conifer->branches[conifer->branches_count++] = (struct conifer_branch){
        {0, ROOT_M, 0}, {0, TOP_M, 0}, TRUNK_M[0], TRUNK_M[1], .twigs_count = 0};
    for (int whorl = 0; whorl < WHORLS; whorl++)
        whorl_add(conifer, whorl);
    memcpy(conifer->needle_albedo, needles, sizeof needles);
    memcpy(conifer->bark_albedo, bark, sizeof bark);
    conifer->needle_specular = 0.1f;
    conifer->needle_exponent = 20;
    conifer_finish(conifer, NULL); /* these numbers are within its ranges */
    return plant_from_conifer(arena, "conifer", conifer);
}
