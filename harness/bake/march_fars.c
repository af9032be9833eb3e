/* Plants from far away: asked for by all threads, made once, looked up between directions. */
#include "bake/march_fars.h"

#include <math.h>
#include <string.h>

/* Directions: the corners of CUTS x CUTS parts of the picture. Turns: each, and all of them. */
enum { CUTS = 4, SIDE = CUTS + 1, CORNERS = SIDE * SIDE, KINDS = MARCH_TURNS + 1 };

struct march_fars {
    size_t species_count;
    int threads;
    float *shares;                /* species x turns: of the trees' squared scales */
    bool *asked;                  /* threads x species x corners x kinds */
    struct march_far *all;        /* species x corners x kinds */
    struct march_sprite *sprites; /* species x corners x turns */
};

struct march_fars *march_fars_create(struct arena *arena, const struct scene *scene,
                                     const struct march_tree *trees, int threads)
{
    struct march_fars *fars = ARENA_NEW(arena, struct march_fars);
    size_t size = scene->species_count * CORNERS * KINDS;
    fars->species_count = scene->species_count;
    fars->threads = threads;
    fars->shares = ARENA_ARRAY(arena, float, scene->species_count *MARCH_TURNS);
    fars->asked = ARENA_ARRAY(arena, bool, size *(size_t)threads);
    fars->all = ARENA_ARRAY(arena, struct march_far, size);
    fars->sprites =
        ARENA_ARRAY(arena, struct march_sprite, scene->species_count * CORNERS * MARCH_TURNS);
    struct arena *passing = arena_create(0);
    double *sums = ARENA_ARRAY(passing, double, scene->species_count *KINDS);
    for (size_t i = 0; i < scene->instances_count; i++) {
        double square = (double)trees[i].scale * trees[i].scale;
        sums[trees[i].species * KINDS + trees[i].turn] += square;
        sums[trees[i].species * KINDS + MARCH_TURNS] += square;
    }
    for (size_t k = 0; k < scene->species_count * MARCH_TURNS; k++) {
        const double *of_species = sums + k / MARCH_TURNS * KINDS;
        double sum = of_species[MARCH_TURNS];
        fars->shares[k] = (float)(sum > 0 ? of_species[k % MARCH_TURNS] / sum : 0);
    }
    arena_destroy(passing);
    return fars;
}

void march_fars_begin(struct march_fars *fars)
{
    memset(fars->asked, 0, fars->species_count * CORNERS * KINDS * (size_t)fars->threads);
}

/* The corner above and to the left, and how far beyond it a place is: 0..1. */
static size_t corner_of(const struct view *view, const float at_px[2], float beyond[2])
{
    const int sizes_px[2] = {view->width_px, view->height_px};
    size_t corner = 0;
    for (int i = 2; i-- > 0;) {
        float at = fminf(fmaxf((at_px[i] + 0.5f) * CUTS / (float)sizes_px[i], 0), CUTS);
        float first = fminf(floorf(at), CUTS - 1);
        beyond[i] = at - first;
        corner = corner * SIDE + (size_t)first;
    }
    return corner;
}

void march_fars_ask(struct march_fars *fars, int thread, const struct view *view, uint32_t species,
                    uint32_t turn, const float at_px[2])
{
    float beyond[2];
    size_t corner = corner_of(view, at_px, beyond);
    bool *asked = fars->asked + ((size_t)thread * fars->species_count + species) * CORNERS * KINDS;
    asked += corner * KINDS + turn;
    asked[0] = asked[KINDS] = asked[SIDE * KINDS] = asked[(SIDE + 1) * KINDS] = true;
}

static bool is_asked(const struct march_fars *fars, size_t place, size_t kind)
{
    size_t size = fars->species_count * CORNERS * KINDS;
    for (int thread = 0; thread < fars->threads; thread++)
        if (fars->asked[size * (size_t)thread + place * KINDS + kind])
            return true;
    return false;
}

static void all_turns(const struct march_far *turns, const float *shares, struct march_far *all)
{
    *all = (struct march_far){0};
    for (int turn = 0; turn < MARCH_TURNS; turn++) {
        if (!(shares[turn] > 0))
            continue;
        float cover_m2 = shares[turn] * turns[turn].cover_m2;
        all->cover_m2 += cover_m2;
        for (int c = 0; c < 3; c++) {
            all->rgb[c] += cover_m2 * turns[turn].rgb[c];
            all->sun_rgb[c] += cover_m2 * turns[turn].sun_rgb[c];
        }
    }
    for (int c = 0; c < 3 && all->cover_m2 > 0; c++) {
        all->rgb[c] /= all->cover_m2;
        all->sun_rgb[c] /= all->cover_m2;
    }
}

void march_fars_make(struct march_fars *fars, const struct march_view *picture,
                     march_kernel *kernel)
{
    const struct view *view = picture->view;
    const size_t places = fars->species_count * CORNERS;
#pragma omp parallel num_threads(fars->threads)
    {
#pragma omp for schedule(dynamic, 4)
        for (size_t k = 0; k < places * MARCH_TURNS; k++) {
            size_t place = k / MARCH_TURNS, turn = k % MARCH_TURNS, corner = place % CORNERS;
            uint32_t species = (uint32_t)(place / CORNERS);
            bool for_all = fars->shares[species * MARCH_TURNS + turn] > 0 &&
                           is_asked(fars, place, MARCH_TURNS);
            if (for_all || is_asked(fars, place, turn))
                march_far_fill(picture, species, (uint32_t)turn,
                               (float)(corner % SIDE) / CUTS * (float)view->width_px - 0.5f,
                               (float)(corner / SIDE) / CUTS * (float)view->height_px - 0.5f,
                               kernel, &fars->all[place * KINDS + turn], &fars->sprites[k]);
        }
#pragma omp for schedule(static)
        for (size_t place = 0; place < places; place++)
            if (is_asked(fars, place, MARCH_TURNS))
                all_turns(fars->all + place * KINDS, fars->shares + place / CORNERS * MARCH_TURNS,
                          &fars->all[place * KINDS + MARCH_TURNS]);
    }
}

struct march_far march_fars_at(const struct march_fars *fars, const struct view *view,
                               uint32_t species, uint32_t turn, const float at_px[2])
{
    float beyond[2];
    size_t corner = corner_of(view, at_px, beyond);
    const struct march_far *first = fars->all + (species * CORNERS + corner) * KINDS + turn;
    struct march_far far = {0};
    for (int k = 0; k < 4; k++) {
        float share = (k & 1 ? beyond[0] : 1 - beyond[0]) * (k >> 1 ? beyond[1] : 1 - beyond[1]);
        const struct march_far *from = first + ((k & 1) + (k >> 1) * SIDE) * KINDS;
        far.cover_m2 += share * from->cover_m2;
        for (int c = 0; c < 3; c++) {
            far.rgb[c] += share * from->rgb[c];
            far.sun_rgb[c] += share * from->sun_rgb[c];
        }
    }
    return far;
}

const struct march_sprite *march_fars_sprite(const struct march_fars *fars, const struct view *view,
                                             uint32_t species, uint32_t turn, const float at_px[2],
                                             const struct march_far **means)
{
    float beyond[2];
    size_t corner = corner_of(view, at_px, beyond);
    corner += (beyond[0] > 0.5f) + (beyond[1] > 0.5f) * SIDE;
    size_t place = species * CORNERS + corner;
    *means = &fars->all[place * KINDS + turn];
    return &fars->sprites[place * MARCH_TURNS + turn];
}
