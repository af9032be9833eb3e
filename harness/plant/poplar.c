/* A Lombardy poplar (Populus nigra 'Italica'): a slim flame of steep branches, 20 m high.
 *
 * By default it has exactly 98,286 triangles, the figure of the poplar in Senegas 2001: leaves, two
 * triangles each, fill up what the bark leaves over. The crown's outline, the steep branches and
 * the deltoid leaves of 5 to 9 cm follow the species; Weber and Penn 1995,
 * doi:10.1145/218380.218427, is the model for growing stems by level. */
#include "plant/generator.h"
#include "plant/grow.h"

enum {
    TRUNK_POINTS = 34,
    BRANCH_POINTS = 8,
    TWIG_POINTS = 3,
    BRANCHES = 116,
    TWIGS = 9, /* a branch */
};

static const float bark_albedo[3] = {0.20f, 0.17f, 0.135f};
static const float leaf_albedo[3] = {0.105f, 0.225f, 0.05f};

struct options {
    float height, width, leaf_length;
    int triangles, seed;
};

/* clang-format off */
static const struct option table[] = {
    OPTION(struct options, height, 20, 5, 40, "m", "height of the tree"),
    OPTION(struct options, width, 3.4, 0.5, 12, "m", "diameter of the crown"),
    OPTION(struct options, leaf_length, 0.08, 0.02, 0.5, "m", "mean length of a leaf"),
    OPTION(struct options, triangles, 98286, 30000, 4000000, "",
           "triangles of bark and leaves together; leaves have two, so an odd one is left out"),
    OPTION(struct options, seed, 1, 0, 1000000, "", "another tree for each"),
    OPTION_END,
};
/* clang-format on */

/* A stretch of twig that bears leaves. */
struct bearer {
    struct vec from, to;
    double end; /* length of all bearers up to and with this one */
};

struct poplar {
    const struct options *options;
    struct random random;
    struct grow grow;
    struct stem_point trunk[TRUNK_POINTS];
    struct bearer *bearers;
    size_t bearers_count;
};

/* Half width of the crown at relative height t, relative to its widest: swells from the lowest
 * branches, widest at 0.36, then runs out in a point. */
static double outline(double t)
{
    const double low = 0.06, widest = 0.36;
    if (t < low)
        return 0.3;
    if (t < widest) {
        double s = (t - low) / (widest - low);
        return 0.3 + 0.7 * s * (2 - s);
    }
    double u = t < 1 ? (t - widest) / (1 - widest) : 1;
    return (1 - u) * (1 + 0.95 * u);
}

static void bear(struct poplar *p, struct vec from, struct vec to)
{
    size_t n = p->bearers_count;
    double before = n ? p->bearers[n - 1].end : 0;
    p->bearers[n] = (struct bearer){from, to, before + vec_length(vec_sub(to, from))};
    p->bearers_count++;
}

static void grow_trunk(struct poplar *p)
{
    double height = (double)p->options->height, lean = 0, lean_z = 0;
    double foot = 0.0145 * height;
    for (int i = 0; i < TRUNK_POINTS; i++) {
        double s = (double)i / (TRUNK_POINTS - 1);
        double t = s * (0.35 + 0.65 * s); /* rings stand closer near the foot */
        struct stem_point *point = &p->trunk[i];
        double flare = t < 0.05 ? (1 - t / 0.05) * (1 - t / 0.05) : 0;
        point->position_m = (struct vec){lean, t * height, lean_z};
        point->radius_m = foot * ((1 - t) * (0.85 + 0.15 * (1 - t)) + 0.012 + 0.4 * flare);
        point->flute = 0.05 + 0.16 * flare;
        point->sides = t < 0.55 ? 16 : t < 0.9 ? 8 : 4;
        double sway = i > 0 ? 0.0016 * height : 0; /* the foot's ring lies level */
        lean += random_between(&p->random, -1, 1) * sway;
        lean_z += random_between(&p->random, -1, 1) * sway;
    }
    grow_tube(&p->grow, p->trunk, TRUNK_POINTS);
    for (int i = TRUNK_POINTS - 7; i + 1 < TRUNK_POINTS; i++)
        bear(p, p->trunk[i].position_m, p->trunk[i + 1].position_m);
}

/* The trunk's middle and radius at relative height t. */
static struct stem_point on_trunk(const struct poplar *p, double t)
{
    double y = t * (double)p->options->height;
    int i = 1;
    while (i < TRUNK_POINTS - 1 && p->trunk[i].position_m.y < y)
        i++;
    const struct stem_point *a = &p->trunk[i - 1], *b = &p->trunk[i];
    double s = (y - a->position_m.y) / (b->position_m.y - a->position_m.y);
    struct stem_point at = *a;
    at.position_m = vec_mad(a->position_m, s, vec_sub(b->position_m, a->position_m));
    at.radius_m = a->radius_m + s * (b->radius_m - a->radius_m);
    return at;
}

/* A twig leaves its branch by about 35 degrees and bends upward. */
static void grow_twig(struct poplar *p, struct vec foot, struct vec along, double turns,
                      double length)
{
    struct stem_point points[TWIG_POINTS];
    struct vec out = vec_across(along, turns);
    struct vec direction = vec_unit(vec_mad(along, random_between(&p->random, 0.55, 0.95), out));
    double radius = 0.0035 + 0.005 * length;
    for (int i = 0; i < TWIG_POINTS; i++) {
        double s = (double)i / (TWIG_POINTS - 1);
        points[i] = (struct stem_point){foot, radius * (1 - 0.6 * s), 0, 4};
        struct vec next = vec_mad(foot, length / (TWIG_POINTS - 1), direction);
        if (i + 1 < TWIG_POINTS)
            bear(p, i ? foot : vec_mad(foot, 0.3, vec_sub(next, foot)), next);
        foot = next;
        direction = vec_unit(vec_add(direction, (struct vec){0, 0.45, 0}));
    }
    grow_tube(&p->grow, points, TWIG_POINTS);
}

/* Branch k of all: leaves the trunk by some 40 degrees and bends up until it stands almost upright
 * where it meets the outline. */
static void grow_branch(struct poplar *p, int k)
{
    struct stem_point points[BRANCH_POINTS];
    double height = (double)p->options->height;
    double half = (double)p->options->width / 2, twigs_reach = 0.017 * height;
    half = half > 1.5 * twigs_reach ? half - twigs_reach : half / 3;
    double u = (k + random_double(&p->random)) / BRANCHES;
    double t = 0.055 + 0.88 * u * (0.82 + 0.18 * u);
    struct stem_point root = on_trunk(p, t);
    double rise = height * random_between(&p->random, 0.15, 0.24) * (1.1 - 0.75 * t);
    double room = height * (1.0 - t);
    rise = rise < 0.82 * room ? rise : 0.82 * room;
    double top = t + rise / height;
    double reach = random_double(&p->random);
    reach = half * outline(top) * (1.0 - 0.55 * reach * reach);
    double turns = k * 0.381966011250105 + random_between(&p->random, -0.06, 0.06);
    double drift = random_between(&p->random, -0.05, 0.05);
    double length = sqrt(rise * rise + reach * reach);
    double foot = 0.010 * length + 0.008;
    foot = foot < 0.7 * root.radius_m ? foot : 0.7 * root.radius_m;
    for (int i = 0; i < BRANCH_POINTS; i++) {
        double s = (double)i / (BRANCH_POINTS - 1), sine, cosine;
        grow_sincos(turns + drift * s, &sine, &cosine);
        double away = reach * s * (2 - s) * (0.93 + 0.07 * s), wave = 0.018 * length * s;
        struct vec position = {cosine * away, s * rise * (0.85 + 0.15 * s), sine * away};
        position = vec_add(position, root.position_m);
        position = vec_mad(position, wave, random_in_ball(&p->random));
        int sides = foot * (1 - s) > 0.02 ? 8 : 4;
        points[i] = (struct stem_point){position, foot * (1 - 0.86 * s), 0, sides};
    }
    grow_tube(&p->grow, points, BRANCH_POINTS);
    for (int i = BRANCH_POINTS - 4; i + 1 < BRANCH_POINTS; i++)
        bear(p, points[i].position_m, points[i + 1].position_m);
    for (int j = 0; j < TWIGS; j++) {
        double s = (j + random_between(&p->random, 0.1, 0.9)) / TWIGS;
        s = 0.16 + 0.8 * s;
        double place = s * (BRANCH_POINTS - 1);
        int i = (int)place;
        struct vec along = vec_sub(points[i + 1].position_m, points[i].position_m);
        struct vec at = vec_mad(points[i].position_m, place - i, along);
        double twig = length * random_between(&p->random, 0.16, 0.30) * (1.15 - 0.6 * s);
        grow_twig(p, at, vec_unit(along), j * 0.381966 + random_between(&p->random, -0.1, 0.1),
                  twig + 0.12);
    }
}

/* Leaf stands on a petiole away from its twig; the blade hangs and its sides look anywhere. */
static void grow_poplar_leaf(struct poplar *p, struct vec at, struct vec along, double turns)
{
    struct random *random = &p->random;
    double mean = (double)p->options->leaf_length;
    struct leaf_shape leaf = {.widest = 0.36};
    leaf.length_m = mean * random_between(random, 0.72, 1.25);
    leaf.width_m = leaf.length_m * random_between(random, 0.88, 1.05);
    struct vec petiole = vec_mad(vec_across(along, turns), 0.4, along);
    petiole = vec_mad(petiole, 0.45, random_in_ball(random));
    petiole = vec_unit(petiole);
    leaf.base_m = vec_mad(at, mean * random_between(random, 0.4, 0.9), petiole);
    struct vec hang = vec_mad(petiole, 0.8, random_in_ball(random));
    hang.y -= random_between(random, 0.1, 1.0);
    leaf.along = vec_unit(hang);
    leaf.normal = vec_across(leaf.along, random_double(random));
    float light = (float)random_between(random, 0.72, 1), yellow = (float)random_double(random);
    leaf.tint[0] = light * (0.78f + 0.22f * yellow);
    leaf.tint[1] = light;
    leaf.tint[2] = light * (1.0f - 0.25f * yellow);
    grow_leaf(&p->grow, &leaf);
}

static void grow_leaves(struct poplar *p, size_t count)
{
    double total = p->bearers[p->bearers_count - 1].end;
    size_t b = 0;
    for (size_t i = 0; i < count; i++) {
        double at = ((double)i + random_double(&p->random)) / (double)count * total;
        while (b + 1 < p->bearers_count && p->bearers[b].end < at)
            b++;
        const struct bearer *bearer = &p->bearers[b];
        struct vec along = vec_sub(bearer->to, bearer->from);
        double length = vec_length(along);
        double s = 1 - (bearer->end - at) / length;
        grow_poplar_leaf(p, vec_mad(bearer->from, s, along), vec_scale(along, 1 / length),
                         (double)i * 0.381966011250105 + random_between(&p->random, -0.1, 0.1));
    }
}

static enum status build(struct arena *arena, const void *options, struct mesh **mesh,
                         struct error *error)
{
    (void)error;
    struct arena *scratch = arena_create(0);
    struct poplar *p = ARENA_NEW(scratch, struct poplar);
    p->options = options;
    p->random = random_seed((uint64_t)p->options->seed, 0x706f706c);
    p->bearers = ARENA_ARRAY(scratch, struct bearer,
                             TRUNK_POINTS + BRANCHES * (3 + TWIGS * (TWIG_POINTS - 1)));
    size_t triangles = (size_t)p->options->triangles;
    grow_begin(&p->grow, scratch, (uint64_t)p->options->seed, triangles, triangles / 2);
    grow_trunk(p);
    for (int k = 0; k < BRANCHES; k++)
        grow_branch(p, k);
    grow_leaves(p, (triangles - p->grow.bark_triangles_count) / 2);
    *mesh = grow_mesh(&p->grow, arena, bark_albedo, leaf_albedo);
    arena_destroy(scratch);
    return STATUS_OK;
}

const struct generator poplar_generator = {"poplar", 1, table, sizeof(struct options), build};
