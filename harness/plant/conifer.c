/* Conifers: the check, the bounds, and where each needle is. */
#include "plant/conifer.h"

#include "plant/grow.h"

#include <string.h>

static struct vec vec_of(const float v[3])
{
    return (struct vec){(double)v[0], (double)v[1], (double)v[2]};
}

static void vec_to(struct vec v, float to[3])
{
    to[0] = (float)v.x, to[1] = (float)v.y, to[2] = (float)v.z;
}

static double turns_of(double angle_rad)
{
    return angle_rad * 0.159154943091895335769;
}

void conifer_frame(const float axis[3], float across[3], float along[3])
{
    struct vec a = vec_of(axis), u = vec_across(a, 0);
    vec_to(u, across);
    vec_to(vec_cross(a, u), along);
}

/* What all needles of a twig share. */
struct whorl {
    struct vec base, axis, across, along;
    double sine, cosine; /* of phi */
};

static struct whorl whorl_of(const struct conifer_twig *twig)
{
    struct whorl whorl = {.base = vec_of(twig->base_m), .axis = vec_of(twig->axis)};
    whorl.across = vec_across(whorl.axis, 0);
    whorl.along = vec_cross(whorl.axis, whorl.across);
    grow_sincos(turns_of((double)twig->needle_angle_rad), &whorl.sine, &whorl.cosine);
    return whorl;
}

static void whorl_needle(const struct whorl *whorl, const struct conifer_twig *twig, uint32_t cone,
                         uint32_t needle, float base_m[3], float tip_m[3])
{
    double turns = turns_of((double)twig->azimuth_rad + cone * (double)twig->azimuth_step_rad);
    double s, c, length = (double)twig->needle_length_m;
    grow_sincos(turns + (double)needle / twig->needles_count, &s, &c);
    struct vec out = vec_mad(vec_scale(whorl->across, c), s, whorl->along);
    struct vec base = vec_mad(whorl->base, (cone + 0.5) * (double)twig->spacing_m, whorl->axis);
    struct vec tip = vec_mad(base, length * whorl->cosine, whorl->axis);
    vec_to(base, base_m);
    vec_to(vec_mad(tip, length * whorl->sine, out), tip_m);
}

void conifer_needle(const struct conifer_twig *twig, uint32_t cone, uint32_t needle,
                    float base_m[3], float tip_m[3])
{
    const struct whorl whorl = whorl_of(twig);
    whorl_needle(&whorl, twig, cone, needle, base_m, tip_m);
}

void conifer_bark(const struct conifer *conifer, struct conifer_piece *pieces)
{
    for (size_t i = 0; i < conifer->branches_count; i++, pieces++) {
        const struct conifer_branch *branch = &conifer->branches[i];
        memcpy(pieces->a_m, branch->from_m, sizeof pieces->a_m);
        memcpy(pieces->b_m, branch->to_m, sizeof pieces->b_m);
        pieces->radius_a_m = branch->radius_from_m;
        pieces->radius_b_m = branch->radius_to_m;
    }
    for (size_t i = 0; i < conifer->twigs_count; i++, pieces++) {
        const struct conifer_twig *twig = &conifer->twigs[i];
        memcpy(pieces->a_m, twig->base_m, sizeof pieces->a_m);
        vec_to(vec_mad(vec_of(twig->base_m), (double)twig->length_m, vec_of(twig->axis)),
               pieces->b_m);
        pieces->radius_a_m = pieces->radius_b_m = twig->axis_radius_m;
    }
}

void conifer_needles(const struct conifer *conifer, struct conifer_piece *pieces)
{
    for (size_t i = 0; i < conifer->twigs_count; i++) {
        const struct conifer_twig *twig = &conifer->twigs[i];
        const struct whorl whorl = whorl_of(twig);
        for (uint32_t cone = 0; cone < twig->cones_count; cone++)
            for (uint32_t needle = 0; needle < twig->needles_count; needle++, pieces++) {
                whorl_needle(&whorl, twig, cone, needle, pieces->a_m, pieces->b_m);
                pieces->radius_a_m = pieces->radius_b_m = twig->needle_radius_m;
            }
    }
}

static bool finite3(const float v[3])
{
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

/* Finite and above 0. */
static bool length_ok(float length_m)
{
    return length_m > 0 && isfinite(length_m);
}

static enum status check_branch(const struct conifer *conifer, size_t i, uint64_t *twigs,
                                struct error *error)
{
    const struct conifer_branch *branch = &conifer->branches[i];
    if (!finite3(branch->from_m) || !finite3(branch->to_m))
        return error_set(error, STATUS_INVALID, "branch %zu: an end is not finite", i);
    if (!length_ok((float)vec_length(vec_sub(vec_of(branch->to_m), vec_of(branch->from_m)))))
        return error_set(error, STATUS_INVALID, "branch %zu: its ends are the same point", i);
    if (!length_ok(branch->radius_from_m) || !length_ok(branch->radius_to_m))
        return error_set(error, STATUS_INVALID,
                         "branch %zu: radii are %g and %g m; allowed: above 0", i,
                         (double)branch->radius_from_m, (double)branch->radius_to_m);
    if (branch->twigs_count && branch->first_twig != *twigs)
        return error_set(error, STATUS_INVALID,
                         "branch %zu: its twigs begin at %u; allowed: %llu, where the last "
                         "branch's ended",
                         i, (unsigned)branch->first_twig, (unsigned long long)*twigs);
    *twigs += branch->twigs_count;
    return STATUS_OK;
}

static enum status check_twig(const struct conifer_twig *twig, size_t i, struct error *error)
{
    double square = vec_dot(vec_of(twig->axis), vec_of(twig->axis));
    if (!finite3(twig->base_m) || !(fabs(square - 1) < 1e-3))
        return error_set(error, STATUS_INVALID,
                         "twig %zu: base is not finite or axis is not of length 1", i);
    if (!length_ok(twig->length_m) || !length_ok(twig->axis_radius_m))
        return error_set(error, STATUS_INVALID,
                         "twig %zu: length %g m, radius %g m; allowed: above 0", i,
                         (double)twig->length_m, (double)twig->axis_radius_m);
    if (twig->cones_count == 0 || twig->needles_count == 0)
        return STATUS_OK;
    if (!(twig->spacing_m >= 0) || !isfinite(twig->spacing_m) ||
        !length_ok(twig->needle_length_m) || !length_ok(twig->needle_radius_m))
        return error_set(error, STATUS_INVALID,
                         "twig %zu: cones %g m apart, needles of length %g m and radius %g m; "
                         "allowed: above 0",
                         i, (double)twig->spacing_m, (double)twig->needle_length_m,
                         (double)twig->needle_radius_m);
    if (!(twig->needle_angle_rad >= 0 && twig->needle_angle_rad <= 3.1415927f))
        return error_set(error, STATUS_INVALID,
                         "twig %zu: needles' angle is %g rad; allowed: 0..pi", i,
                         (double)twig->needle_angle_rad);
    if (!isfinite(twig->azimuth_rad) || !isfinite(twig->azimuth_step_rad))
        return error_set(error, STATUS_INVALID, "twig %zu: an azimuth is not finite", i);
    return STATUS_OK;
}

static enum status check_counts(const struct conifer *conifer, struct error *error)
{
    if (conifer->branches_count < 1 || conifer->branches_count > CONIFER_BRANCHES_MAX)
        return error_set(error, STATUS_INVALID, "%zu branch%s; allowed: 1..%d",
                         conifer->branches_count, conifer->branches_count == 1 ? "" : "es",
                         CONIFER_BRANCHES_MAX);
    if (conifer->twigs_count > CONIFER_TWIGS_MAX)
        return error_set(error, STATUS_INVALID, "%zu twigs; allowed: 0..%d", conifer->twigs_count,
                         CONIFER_TWIGS_MAX);
    const uint32_t sides[2] = {conifer->needle_sides, conifer->branch_sides};
    for (int k = 0; k < 2; k++)
        if (sides[k] && (sides[k] < 3 || sides[k] > 64))
            return error_set(error, STATUS_INVALID, "a prism of %u sides; allowed: 3..64",
                             (unsigned)sides[k]);
    return STATUS_OK;
}

static void bounds_add(struct conifer *conifer, const float at_m[3], float radius_m)
{
    for (int k = 0; k < 3; k++) {
        conifer->minimum_m[k] = fminf(conifer->minimum_m[k], at_m[k] - radius_m);
        conifer->maximum_m[k] = fmaxf(conifer->maximum_m[k], at_m[k] + radius_m);
    }
}

static void bounds_of(struct conifer *conifer)
{
    for (int k = 0; k < 3; k++) {
        conifer->minimum_m[k] = INFINITY;
        conifer->maximum_m[k] = -INFINITY;
    }
    for (size_t i = 0; i < conifer->branches_count; i++) {
        bounds_add(conifer, conifer->branches[i].from_m, conifer->branches[i].radius_from_m);
        bounds_add(conifer, conifer->branches[i].to_m, conifer->branches[i].radius_to_m);
    }
    for (size_t i = 0; i < conifer->twigs_count; i++) {
        const struct conifer_twig *twig = &conifer->twigs[i];
        const struct whorl whorl = whorl_of(twig);
        float end_m[3];
        bounds_add(conifer, twig->base_m, twig->axis_radius_m);
        vec_to(vec_mad(whorl.base, (double)twig->length_m, whorl.axis), end_m);
        bounds_add(conifer, end_m, twig->axis_radius_m);
        for (uint32_t cone = 0; cone < twig->cones_count; cone++)
            for (uint32_t needle = 0; needle < twig->needles_count; needle++) {
                float base_m[3];
                whorl_needle(&whorl, twig, cone, needle, base_m, end_m);
                bounds_add(conifer, base_m, twig->needle_radius_m);
                bounds_add(conifer, end_m, twig->needle_radius_m);
            }
    }
}

enum status conifer_finish(struct conifer *conifer, struct error *error)
{
    enum status status = check_counts(conifer, error);
    uint64_t twigs = 0;
    for (size_t i = 0; i < conifer->branches_count && status == STATUS_OK; i++)
        status = check_branch(conifer, i, &twigs, error);
    if (status == STATUS_OK && twigs != conifer->twigs_count)
        return error_set(error, STATUS_INVALID, "the branches have %llu of %zu twigs",
                         (unsigned long long)twigs, conifer->twigs_count);
    conifer->needles_count = 0;
    for (size_t i = 0; i < conifer->twigs_count && status == STATUS_OK; i++) {
        const struct conifer_twig *twig = &conifer->twigs[i];
        status = check_twig(twig, i, error);
        conifer->needles_count += (uint64_t)twig->cones_count * twig->needles_count;
        if (status == STATUS_OK && conifer->needles_count > CONIFER_NEEDLES_MAX)
            return error_set(error, STATUS_INVALID, "more than %d needles, at twig %zu of %zu",
                             CONIFER_NEEDLES_MAX, i, conifer->twigs_count);
    }
    if (status == STATUS_OK)
        bounds_of(conifer);
    return status;
}
