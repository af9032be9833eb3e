/* An oak (Quercus robur) grown in the open: a short bole, gnarled limbs, a broad lumpy crown 15 m
 * high.
 *
 * Limbs and branches grow by space colonisation (Runions, Lane, Prusinkiewicz 2007,
 * doi:10.2312/NPH/NPH07/063-070) toward attraction points in lumps of foliage that cover a dome;
 * the lumps leave gaps of light. Departures: a few main limbs are laid out first, which gives the
 * wide forks of a tree that stood free, and branch points are smoothed. Thickness follows da
 * Vinci's rule: a stem's cross section is the sum of its children's (the exponent 2 of the paper's
 * eq. r^n = r1^n + r2^n). */
#include "plant/generator.h"
#include "plant/grow.h"

#include <string.h>

enum {
    BOLE_NODES = 7,
    LIMBS = 8,
    LIMB_NODES = 13,
    LUMPS = 58,
    POINTS_PER_LUMP = 46,
    POINTS = LUMPS * POINTS_PER_LUMP,
    NODES_MAX = 8000,
    ROUNDS_MAX = 120,
    TWIGS_MAX = 3 * NODES_MAX,
};

static const float bark_albedo[3] = {0.175f, 0.15f, 0.12f};
static const float leaf_albedo[3] = {0.11f, 0.22f, 0.045f};

struct options {
    float height, width, leaf_length;
    int triangles, seed;
};

/* clang-format off */
static const struct option table[] = {
    OPTION(struct options, height, 15, 4, 40, "m", "height of the tree"),
    OPTION(struct options, width, 16, 3, 50, "m", "diameter of the crown"),
    OPTION(struct options, leaf_length, 0.2, 0.02, 1, "m",
           "mean length of a leaf; each stands for a small spray, a real one is half as long"),
    OPTION(struct options, triangles, 100000, 40000, 4000000, "",
           "triangles of bark and leaves together; leaves have two, so an odd one is left out"),
    OPTION(struct options, seed, 1, 0, 1000000, "", "another tree for each"),
    OPTION_END,
};
/* clang-format on */

struct node {
    struct vec position;
    int parent; /* -1: the foot */
    int main_child, children_count;
    double area; /* of the cross section, until scaled in units of a tip's */
    double radius_m;
};

struct lump {
    struct vec middle;
    double radius;
};

struct twig {
    struct vec foot, tip;
};

struct oak {
    const struct options *options;
    struct random random;
    struct grow grow;
    double scale; /* of the crown, relative to 15 m x 16 m: the size of steps and reaches */
    struct node *nodes;
    int nodes_count;
    struct vec *points;
    int *nearest;      /* the node nearest to each point; -1: the point is used up */
    double *distance2; /* to it */
    struct twig *twigs;
    size_t twigs_count;
};

static int add_node(struct oak *oak, struct vec position, int parent)
{
    struct node *node = &oak->nodes[oak->nodes_count];
    *node = (struct node){.position = position, .parent = parent, .main_child = -1};
    if (parent >= 0)
        oak->nodes[parent].children_count++;
    return oak->nodes_count++;
}

/* The crown is an ellipsoid about the axis, flatter below. in: relative to its middle and half
 * axes. */
static struct vec crown_place(const struct oak *oak, struct vec in)
{
    /* Twigs reach on. */
    double height = 0.98 * (double)oak->options->height;
    double half = 0.93 * (double)oak->options->width / 2;
    double middle = 0.47 * height;
    double y = middle + in.y * (in.y > 0 ? height - middle : 0.33 * height);
    return (struct vec){in.x * half, y, in.z * half};
}

/* Lumps stand near the crown's skin in Fibonacci's lattice, so that none is left out, and some
 * inside. */
static void place_points(struct oak *oak)
{
    struct random *random = &oak->random;
    for (int i = 0; i < LUMPS; i++) {
        double y = 1 - 1.55 * (i + 0.5) / LUMPS, s, c;
        double across = sqrt(1 - y * y);
        grow_sincos(i * 0.381966011250105 + random_between(random, -0.03, 0.03), &s, &c);
        double depth = random_between(random, 0.72, 0.90) - (i % 5 == 2 ? 0.34 : 0);
        struct vec in = vec_scale((struct vec){across * c, y, across * s}, depth);
        double radius = random_between(random, 0.17, 0.26) * (i % 5 == 2 ? 0.8 : 1);
        for (int k = 0; k < POINTS_PER_LUMP; k++) {
            struct vec offset = random_in_ball(random);
            offset.y *= 0.75;
            struct vec p = vec_mad(in, radius, offset);
            double length = vec_length(p);
            if (length > 1)
                p = vec_scale(p, 1 / length);
            oak->points[i * POINTS_PER_LUMP + k] = crown_place(oak, p);
        }
    }
}

static void grow_bole(struct oak *oak)
{
    struct vec at = {0, 0, 0};
    int parent = -1;
    double step = 0.20 * (double)oak->options->height / (BOLE_NODES - 1);
    for (int i = 0; i < BOLE_NODES; i++) {
        parent = add_node(oak, at, parent);
        at.x += random_between(&oak->random, -0.09, 0.09) * step * i;
        at.z += random_between(&oak->random, -0.09, 0.09) * step * i;
        at.y += step;
    }
}

/* A limb leaves the bole and wanders to somewhere inside the crown's skin: outward first, rising
 * later. */
static void grow_limb(struct oak *oak, int k)
{
    struct random *random = &oak->random;
    double s, c, share = (double)k / (LIMBS - 1);
    int parent = BOLE_NODES - 1 - (k < LIMBS / 2 ? (LIMBS / 2 - k) / 2 : 0);
    grow_sincos(k * 0.381966011250105 + random_between(random, -0.05, 0.05), &s, &c);
    double away = random_between(random, 0.55, 0.68) * (1 - 0.75 * share * share);
    struct vec in = {away * c, -0.22 + 0.95 * share * random_between(random, 0.85, 1.0), away * s};
    struct vec goal = crown_place(oak, in), at = oak->nodes[parent].position;
    struct vec direction =
        vec_unit((struct vec){c * (1.1 - share), 0.75 + share, s * (1.1 - share)});
    double step = 1.18 * vec_length(vec_sub(goal, at)) / LIMB_NODES;
    for (int i = 0; i < LIMB_NODES; i++) {
        struct vec pull = vec_unit(vec_sub(goal, at));
        direction = vec_mad(direction, 0.42, pull);
        direction = vec_unit(vec_mad(direction, 0.52, random_in_ball(random)));
        at = vec_mad(at, step, direction);
        parent = add_node(oak, at, parent);
    }
}

static void find_nearest(struct oak *oak, int first_new)
{
    for (int k = 0; k < POINTS; k++) {
        if (oak->nearest[k] < 0)
            continue;
        struct vec p = oak->points[k];
        double best = oak->distance2[k];
        int nearest = oak->nearest[k];
        for (int i = first_new; i < oak->nodes_count; i++) {
            struct vec d = vec_sub(oak->nodes[i].position, p);
            double d2 = vec_dot(d, d);
            if (d2 < best)
                best = d2, nearest = i;
        }
        oak->nearest[k] = nearest;
        oak->distance2[k] = best;
    }
}

/* One round: every node that is nearest to some points steps toward their mean direction. */
static bool colonise(struct oak *oak, struct vec *pull, double step, double kill)
{
    int before = oak->nodes_count;
    memset(pull, 0, (size_t)before * sizeof *pull);
    for (int k = 0; k < POINTS; k++) {
        if (oak->nearest[k] < 0)
            continue;
        struct vec *sum = &pull[oak->nearest[k]];
        *sum =
            vec_add(*sum, vec_unit(vec_sub(oak->points[k], oak->nodes[oak->nearest[k]].position)));
    }
    for (int i = 0; i < before && oak->nodes_count < NODES_MAX; i++) {
        if (vec_length(pull[i]) < 1e-6)
            continue;
        struct vec direction = vec_unit(pull[i]);
        direction = vec_unit(vec_mad(direction, 0.28, random_in_ball(&oak->random)));
        if (oak->nodes[i].children_count < 3)
            add_node(oak, vec_mad(oak->nodes[i].position, step, direction), i);
    }
    find_nearest(oak, before);
    for (int k = 0; k < POINTS; k++)
        if (oak->nearest[k] >= 0 && oak->distance2[k] < kill * kill)
            oak->nearest[k] = -1;
    return oak->nodes_count > before && oak->nodes_count < NODES_MAX;
}

static void grow_branches(struct oak *oak, struct arena *scratch)
{
    struct vec *pull = ARENA_ARRAY(scratch, struct vec, NODES_MAX);
    for (int k = 0; k < POINTS; k++)
        oak->distance2[k] = 1e30;
    find_nearest(oak, BOLE_NODES - 1);
    for (int i = 0; i < ROUNDS_MAX; i++)
        if (!colonise(oak, pull, 0.36 * oak->scale, 0.52 * oak->scale))
            return;
}

/* Moves every node that does not fork toward the middle of its neighbours; angles of growth become
 * curves. */
static void smooth(struct oak *oak)
{
    for (int i = BOLE_NODES; i < oak->nodes_count; i++) {
        struct node *node = &oak->nodes[i];
        if (node->main_child < 0)
            continue;
        struct vec middle = vec_scale(
            vec_add(oak->nodes[node->parent].position, oak->nodes[node->main_child].position), 0.5);
        node->position = vec_mad(vec_scale(node->position, 0.55), 0.45, middle);
    }
}

/* Children come after their parents, so one backward pass adds up the cross sections. */
static void thicken(struct oak *oak)
{
    for (int i = oak->nodes_count - 1; i >= 0; i--) {
        struct node *node = &oak->nodes[i];
        node->area += node->children_count == 0 ? 1 : 0.06;
        if (node->parent < 0)
            continue;
        struct node *parent = &oak->nodes[node->parent];
        parent->area += node->area;
        if (parent->main_child < 0 || node->area > oak->nodes[parent->main_child].area)
            parent->main_child = i;
    }
    double foot = 0.032 * (double)oak->options->height;
    double scale = foot / sqrt(oak->nodes[0].area);
    for (int i = 0; i < oak->nodes_count; i++)
        oak->nodes[i].radius_m = scale * sqrt(oak->nodes[i].area);
}

static int sides_of(double radius_m)
{
    return radius_m > 0.15 ? 16 : radius_m > 0.045 ? 8 : 4;
}

/* The stem that starts with the step from -> first and follows the thickest child to its tip. */
static void grow_stem(struct oak *oak, int from, int first, struct stem_point *points)
{
    size_t count = 0;
    int sides = 16;
    if (from >= 0) {
        double radius = 1.25 * oak->nodes[first].radius_m, most = oak->nodes[from].radius_m;
        sides = sides_of(radius);
        points[count++] =
            (struct stem_point){oak->nodes[from].position, radius < most ? radius : most, 0, sides};
    }
    for (int i = first; i >= 0; i = oak->nodes[i].main_child) {
        const struct node *node = &oak->nodes[i];
        int wanted = sides_of(node->radius_m);
        sides = wanted < sides && count > 0 ? sides / 2 : sides;
        points[count] = (struct stem_point){node->position, node->radius_m, 0.05, sides};
        if (from < 0 && i < BOLE_NODES) {
            double flare = i < 3 ? (1 - i / 3.0) * (1 - i / 3.0) : 0;
            points[count].radius_m *= 1 + 0.55 * flare;
            points[count].flute += 0.14 * flare;
        }
        count++;
    }
    grow_tube(&oak->grow, points, count);
}

static void grow_stems(struct oak *oak, struct arena *scratch)
{
    struct stem_point *points = ARENA_ARRAY(scratch, struct stem_point, NODES_MAX + 1);
    grow_stem(oak, -1, 0, points);
    for (int i = 1; i < oak->nodes_count; i++) {
        int parent = oak->nodes[i].parent;
        if (oak->nodes[parent].main_child != i)
            grow_stem(oak, parent, i, points);
    }
}

static void grow_twig(struct oak *oak, const struct node *node, struct vec along)
{
    struct random *random = &oak->random;
    double length = oak->scale * random_between(random, 0.35, 0.75);
    struct vec direction = vec_mad(along, 1.1, random_in_ball(random));
    direction.y += 0.25;
    struct vec tip = vec_mad(node->position, length, vec_unit(direction));
    double radius = 0.009 * oak->scale;
    radius = radius < node->radius_m ? radius : node->radius_m;
    struct stem_point points[2] = {{node->position, radius, 0, 4}, {tip, 0, 0, 4}};
    grow_tube(&oak->grow, points, 2);
    oak->twigs[oak->twigs_count++] = (struct twig){node->position, tip};
}

/* Thin stems bear twigs, their tips more of them. */
static void grow_twigs(struct oak *oak)
{
    for (int i = BOLE_NODES; i < oak->nodes_count; i++) {
        const struct node *node = &oak->nodes[i];
        if (node->radius_m > 0.035 * oak->scale)
            continue;
        struct vec along = vec_unit(vec_sub(node->position, oak->nodes[node->parent].position));
        int twigs = node->children_count == 0 ? 3 : 1;
        for (int k = 0; k < twigs; k++)
            grow_twig(oak, node, along);
    }
}

static void grow_oak_leaf(struct oak *oak, const struct twig *twig)
{
    struct random *random = &oak->random;
    struct vec along = vec_sub(twig->tip, twig->foot);
    double s = random_double(random);
    s = 1.02 - 0.85 * s * s; /* clusters toward the tip */
    double mean = (double)oak->options->leaf_length;
    struct vec at = vec_mad(twig->foot, s, along);
    along = vec_unit(along);
    struct vec out = vec_mad(vec_scale(along, 0.5), 1.0, vec_across(along, random_double(random)));
    out = vec_unit(vec_mad(out, 0.4, random_in_ball(random)));
    struct leaf_shape leaf = {.widest = 0.6};
    leaf.base_m = vec_mad(at, mean * random_between(random, 0.1, 0.7), out);
    leaf.length_m = mean * random_between(random, 0.7, 1.3);
    leaf.width_m = leaf.length_m * random_between(random, 0.68, 0.82);
    leaf.fold = random_between(random, 0.08, 0.5);
    out.y -= random_between(random, -0.2, 0.5);
    leaf.along = vec_unit(out);
    /* Blades tend to face the sky. */
    struct vec up = vec_mad((struct vec){0, 0.75, 0}, 1.0, random_in_ball(random));
    up = vec_mad(up, -vec_dot(up, leaf.along), leaf.along);
    leaf.normal = vec_length(up) > 1e-3 ? vec_unit(up) : vec_across(leaf.along, 0);
    float light = (float)random_between(random, 0.66, 1), yellow = (float)random_double(random);
    leaf.tint[0] = light * (0.68f + 0.32f * yellow);
    leaf.tint[1] = light;
    leaf.tint[2] = light * (1.0f - 0.3f * yellow);
    grow_leaf(&oak->grow, &leaf);
}

static enum status build(struct arena *arena, const void *options, struct mesh **mesh,
                         struct error *error)
{
    const struct options *given = options;
    double slender = (double)given->width / (double)given->height;
    if (slender < 0.5 || slender > 3)
        return error_set(
            error, STATUS_INVALID, "width: %g is outside %g..%g, half to three times the height",
            (double)given->width, 0.5 * (double)given->height, 3 * (double)given->height);
    struct arena *scratch = arena_create(0);
    struct oak *oak = ARENA_NEW(scratch, struct oak);
    oak->options = given;
    oak->random = random_seed((uint64_t)oak->options->seed, 0x6f616b);
    oak->scale = (double)oak->options->height / 30 + (double)oak->options->width / 32;
    oak->nodes = ARENA_ARRAY(scratch, struct node, NODES_MAX + 1);
    oak->points = ARENA_ARRAY(scratch, struct vec, POINTS);
    oak->nearest = ARENA_ARRAY(scratch, int, POINTS);
    oak->distance2 = ARENA_ARRAY(scratch, double, POINTS);
    oak->twigs = ARENA_ARRAY(scratch, struct twig, TWIGS_MAX);
    size_t triangles = (size_t)oak->options->triangles;
    grow_begin(&oak->grow, scratch, (uint64_t)oak->options->seed, triangles, triangles / 2);
    place_points(oak);
    grow_bole(oak);
    for (int k = 0; k < LIMBS; k++)
        grow_limb(oak, k);
    grow_branches(oak, scratch);
    thicken(oak);
    smooth(oak);
    smooth(oak);
    grow_stems(oak, scratch);
    grow_twigs(oak);
    size_t bark = oak->grow.bark_triangles_count;
    enum status status = STATUS_OK;
    if (bark + 2 > triangles) {
        status = error_set(error, STATUS_INVALID,
                           "triangles: %zu leaves no room for leaves; the bark alone has %zu",
                           triangles, bark);
    } else {
        size_t leaves = (triangles - bark) / 2;
        for (size_t i = 0; i < leaves; i++)
            grow_oak_leaf(oak, &oak->twigs[i * oak->twigs_count / leaves]);
        *mesh = grow_mesh(&oak->grow, arena, bark_albedo, leaf_albedo);
    }
    arena_destroy(scratch);
    return status;
}

const struct generator oak_generator = {"oak", 1, table, sizeof(struct options), build};
