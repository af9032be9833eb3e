/* The turtle: modules to branches, twigs and needles. */
#include "plant/grow.h"
#include "plant/lsystem_parts.h"

#include <stdio.h>
#include <string.h>

enum { DEPTH_MAX = 256 };

/* Where the turtle is, what it heads to, its left and its up; and the branch it drew last. */
struct turtle {
    struct vec at, heading, left, up;
    size_t branch; /* SIZE_MAX: none yet */
};

struct drawing {
    const struct lsystem *lsystem;
    struct turtle turtle, stack[DEPTH_MAX];
    int depth;
    struct conifer *conifer;
    struct conifer_twig *twigs; /* as they are drawn */
    size_t *twig_branches;      /* which branch each stands on */
    uint64_t needles;
};

/* Turns a toward b by degrees, both unit and across each other, and b along with it. */
static void turn(struct vec *a, struct vec *b, double degrees)
{
    double s, c;
    grow_sincos(degrees / 360, &s, &c);
    struct vec turned = vec_mad(vec_scale(*a, c), s, *b);
    *b = vec_mad(vec_scale(*b, c), -s, *a);
    *a = turned;
}

/* Rolls until left is level, up as high as it can be. */
static void level(struct turtle *t)
{
    struct vec left = vec_cross((struct vec){0, 1, 0}, t->heading);
    if (vec_length(left) < 1e-6)
        return;
    t->left = vec_unit(left);
    t->up = vec_cross(t->heading, t->left);
}

static enum status wrong(const struct drawing *d, size_t module, const char *what, double value,
                         const char *allowed, struct error *error)
{
    return error_set(error, STATUS_INVALID, "%s: module %zu: %s is %g; allowed: %s",
                     d->lsystem->where, module, what, value, allowed);
}

static void vec_to(struct vec v, float to[3])
{
    to[0] = (float)v.x, to[1] = (float)v.y, to[2] = (float)v.z;
}

/* F(length, radius at its foot, radius at its end) */
static enum status draw_branch(struct drawing *d, size_t number, const double *a,
                               struct error *error)
{
    if (!(a[0] >= 1e-6 && a[0] <= 1000))
        return wrong(d, number, "a branch's length", a[0], "1e-06..1000 m", error);
    for (int k = 1; k < 3; k++)
        if (!(a[k] >= 1e-6 && a[k] <= 100))
            return wrong(d, number, "a branch's radius", a[k], "1e-06..100 m", error);
    struct turtle *t = &d->turtle;
    struct conifer_branch *branch = &d->conifer->branches[d->conifer->branches_count];
    vec_to(t->at, branch->from_m);
    t->at = vec_mad(t->at, a[0], t->heading);
    vec_to(t->at, branch->to_m);
    branch->radius_from_m = (float)a[1];
    branch->radius_to_m = (float)a[2];
    t->branch = d->conifer->branches_count++;
    return STATUS_OK;
}

/* T(length, radius, cones, needles a cone, a needle's length, its radius, its angle, azimuth, step
 * of the azimuth) */
static enum status draw_twig(struct drawing *d, size_t number, const double *a, struct error *error)
{
    const char *const names[] = {"a twig's length",  "a twig's radius",   "a twig's cones",
                                 "a cone's needles", "a needle's length", "a needle's radius",
                                 "a needle's angle"};
    const double minimum[] = {1e-6, 1e-6, 0, 0, 1e-6, 1e-6, 0};
    const double maximum[] = {1000, 100, 1e6, 1e6, 100, 10, 180};
    struct turtle *t = &d->turtle;
    for (int k = 0; k < 7; k++)
        if (!(a[k] >= minimum[k] && a[k] <= maximum[k])) {
            char allowed[64];
            snprintf(allowed, sizeof allowed, "%g..%g", minimum[k], maximum[k]);
            return wrong(d, number, names[k], a[k], allowed, error);
        }
    if (t->branch == SIZE_MAX)
        return error_set(error, STATUS_INVALID,
                         "%s: module %zu: a twig stands on no branch; allowed: after an F",
                         d->lsystem->where, number);
    const double radians = 0.0174532925199432957692;
    double cones = floor(a[2] + 0.5), needles = floor(a[3] + 0.5);
    d->needles += (uint64_t)(cones * needles);
    if (d->needles > CONIFER_NEEDLES_MAX)
        return error_set(error, STATUS_INVALID, "%s: module %zu: more than %d needles",
                         d->lsystem->where, number, CONIFER_NEEDLES_MAX);
    size_t n = d->conifer->twigs_count++;
    struct conifer_twig *twig = &d->twigs[n];
    d->twig_branches[n] = t->branch;
    vec_to(t->at, twig->base_m);
    vec_to(vec_unit(t->heading), twig->axis);
    t->at = vec_mad(t->at, a[0], t->heading);
    twig->length_m = (float)a[0];
    twig->axis_radius_m = (float)a[1];
    twig->cones_count = (uint32_t)cones;
    twig->spacing_m = cones > 0 ? (float)(a[0] / cones) : 0;
    twig->needles_count = (uint32_t)needles;
    twig->needle_length_m = (float)a[4];
    twig->needle_radius_m = (float)a[5];
    twig->needle_angle_rad = (float)(a[6] * radians);
    twig->azimuth_rad = (float)(a[7] * radians);
    twig->azimuth_step_rad = (float)(a[8] * radians);
    return STATUS_OK;
}

static enum status turn_or_move(struct drawing *d, size_t number, const struct module *module,
                                struct error *error)
{
    struct turtle *t = &d->turtle;
    double a = module->arguments[0];
    if (module->symbol < SYMBOLS_COUNT && fabs(a) > 1e6)
        return wrong(d, number, "an angle or a length", a, "-1e6..1e6", error);
    switch (module->symbol) {
    case SYMBOL_MOVE:
        t->at = vec_mad(t->at, a, t->heading);
        break;
    case SYMBOL_LEFT:
        turn(&t->heading, &t->left, a);
        break;
    case SYMBOL_RIGHT:
        turn(&t->heading, &t->left, -a);
        break;
    case SYMBOL_UP:
        turn(&t->heading, &t->up, a);
        break;
    case SYMBOL_DOWN:
        turn(&t->heading, &t->up, -a);
        break;
    case SYMBOL_ROLL:
        turn(&t->left, &t->up, a);
        break;
    default:
        break; /* a name without a rule that matches draws nothing */
    }
    return STATUS_OK;
}

static enum status draw(struct drawing *d, size_t number, const struct module *module,
                        struct error *error)
{
    switch (module->symbol) {
    case SYMBOL_PUSH:
        if (d->depth == DEPTH_MAX)
            return wrong(d, number, "the depth of brackets", d->depth + 1, "at most 256", error);
        d->stack[d->depth++] = d->turtle;
        return STATUS_OK;
    case SYMBOL_POP:
        d->turtle = d->stack[--d->depth]; /* each text pairs its own */
        return STATUS_OK;
    case SYMBOL_LEVEL:
        level(&d->turtle);
        return STATUS_OK;
    case SYMBOL_BRANCH:
        return draw_branch(d, number, module->arguments, error);
    case SYMBOL_TWIG:
        return draw_twig(d, number, module->arguments, error);
    default:
        return turn_or_move(d, number, module, error);
    }
}

/* The twigs in the order of their branches. */
static void sort_twigs(struct arena *arena, struct drawing *d)
{
    struct conifer *conifer = d->conifer;
    uint32_t first = 0;
    for (size_t i = 0; i < conifer->twigs_count; i++)
        conifer->branches[d->twig_branches[i]].twigs_count++;
    for (size_t i = 0; i < conifer->branches_count; i++) {
        conifer->branches[i].first_twig = first;
        first += conifer->branches[i].twigs_count;
        conifer->branches[i].twigs_count = 0;
    }
    conifer->twigs = ARENA_ARRAY(arena, struct conifer_twig, conifer->twigs_count);
    for (size_t i = 0; i < conifer->twigs_count; i++) {
        struct conifer_branch *branch = &conifer->branches[d->twig_branches[i]];
        conifer->twigs[branch->first_twig + branch->twigs_count++] = d->twigs[i];
    }
}

enum status lsystem_conifer(struct arena *arena, const struct lsystem *lsystem,
                            struct conifer **conifer, struct error *error)
{
    struct arena *scratch = arena_create(0);
    struct modules modules = {0, NULL};
    enum status status = lsystem_derive(scratch, lsystem, &modules, error);
    size_t branches = 0, twigs = 0;
    for (size_t k = 0; k < modules.count; k++) {
        branches += modules.modules[k].symbol == SYMBOL_BRANCH;
        twigs += modules.modules[k].symbol == SYMBOL_TWIG;
    }
    struct drawing *d = ARENA_NEW(scratch, struct drawing);
    d->lsystem = lsystem;
    d->turtle = (struct turtle){{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, -1}, SIZE_MAX};
    d->conifer = ARENA_NEW(arena, struct conifer);
    *d->conifer = lsystem->look;
    d->conifer->branches = ARENA_ARRAY(arena, struct conifer_branch, branches);
    d->twigs = ARENA_ARRAY(scratch, struct conifer_twig, twigs);
    d->twig_branches = ARENA_ARRAY(scratch, size_t, twigs);
    for (size_t k = 0; k < modules.count && status == STATUS_OK; k++)
        status = draw(d, k + 1, &modules.modules[k], error);
    if (status == STATUS_OK) {
        sort_twigs(arena, d);
        status = conifer_finish(d->conifer, error);
        if (status != STATUS_OK)
            error_context(error, "%s", lsystem->where);
        *conifer = d->conifer;
    }
    arena_destroy(scratch);
    return status;
}
