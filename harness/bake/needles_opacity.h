/* How much a disc of matter covers, by its optical depth over a radius. */
#ifndef TREELINE_BAKE_NEEDLES_OPACITY_H
#define TREELINE_BAKE_NEEDLES_OPACITY_H

/* Gauss and Legendre on [0, 1], nodes 1 to 8 each: at[n - 1]. */
struct needles_nodes {
    real at[8], weights[8];
};

static inline struct needles_nodes needles_nodes_of(int count)
{
    static const real half[8][4] = {
        {0},
        {REAL(0.5773502691896257645)},
        {0, REAL(0.7745966692414833770)},
        {REAL(0.3399810435848562648), REAL(0.8611363115940525752)},
        {0, REAL(0.5384693101056830910), REAL(0.9061798459386639928)},
        {REAL(0.2386191860831969086), REAL(0.6612093864662645137), REAL(0.9324695142031520278)},
        {0, REAL(0.4058451513773971669), REAL(0.7415311855993944399), REAL(0.9491079123427585245)},
        {REAL(0.1834346424956498049), REAL(0.5255324099163289858), REAL(0.7966664774136267396),
         REAL(0.9602898564975362317)}};
    static const real weights[8][4] = {
        {2},
        {1},
        {REAL(0.8888888888888888889), REAL(0.5555555555555555556)},
        {REAL(0.6521451548625461426), REAL(0.3478548451374538574)},
        {REAL(0.5688888888888888889), REAL(0.4786286704993664680), REAL(0.2369268850561890875)},
        {REAL(0.4679139345726910474), REAL(0.3607615730481386076), REAL(0.1713244923791703450)},
        {REAL(0.4179591836734693878), REAL(0.3818300505051189449), REAL(0.2797053914892766679),
         REAL(0.1294849661688696933)},
        {REAL(0.3626837833783619830), REAL(0.3137066458778872873), REAL(0.2223810344533744706),
         REAL(0.1012285362903762591)}};
    struct needles_nodes nodes = {{0}, {0}};
    for (int i = 0, k = 0; i < count; k++)
        for (int sign = (count & 1) && k == 0 ? 1 : -1; sign <= 1; sign += 2, i++) {
            nodes.at[i] = (1 + REAL(sign) * half[count - 1][k]) / 2;
            nodes.weights[i] = weights[count - 1][k] / 2;
        }
    return nodes;
}

/* a_I: mean of 1 - exp(-depth 2 sqrt(1 - x^2) / 2) over a disc's width (19), for matter that fills
 * the disc evenly; = (pi/2)(I1 - L1). Relative error 1.4e-4, 2e-7 below 10. */
static inline real needles_disc_opacity(real depth)
{
    if (depth > 20) {
        const real inverse = 1 / (depth * depth);
        return 1 - inverse * (1 + inverse * (3 + inverse * 45));
    }
    const struct needles_nodes nodes = needles_nodes_of(8);
    real sum = 0;
    for (int i = 0; i < 8; i++) {
        const real t = REAL_PI / 2 * nodes.at[i], cosine = real_cos(t);
        sum -= nodes.weights[i] * cosine * real_expm1(-depth * cosine);
    }
    return REAL_PI / 2 * sum;
}

/* a_rho: as needles make the disc, its density as 1 / (2 radius): (t/4)(psi(t/8 + 3/4) -
 * psi(t/8 + 1/4)) by a ratio of polynomials, relative error 1.3e-6. */
static inline real needles_radial_opacity(real depth)
{
    const real a1 = REAL(0.14091335), a2 = REAL(0.0073220172), b1 = a1 + REAL_PI / 4;
    const real b2 = REAL(0.27687384), b3 = REAL(0.035421322), b4 = a2 / 4;
    /* 1 - A/B as (B - A)/B: nothing cancels at small depths, nothing overflows at large ones. */
    if (depth > 1) {
        const real u = 1 / depth;
        return 1 - u * u * (a2 + u * (a1 + u)) / (b4 + u * (b3 + u * (b2 + u * (b1 + u))));
    }
    return depth * (REAL_PI / 4 + depth * (b2 - a2 + depth * (b3 + depth * b4))) /
           (1 + depth * (b1 + depth * (b2 + depth * (b3 + depth * b4))));
}

/* E1(x) + log x for x in [0, 2]. */
static inline real needles_e1_log(real x)
{
    real sum = REAL(-0.57721566490153286), term = 1;
    for (int i = 1; i <= 24; i++) {
        term *= -x / REAL(i);
        sum -= term / REAL(i);
    }
    return sum;
}

/* o: opacity of a sheet of needles from one point, of a mean optical depth (their density falls
 * with the distance from the point): 1 - 2 E3(depth / 2). */
static inline real needles_sheet_opacity(real depth)
{
    const real x = depth / 2;
    if (!(x > 0))
        return 0;
    if (x <= 2)
        return real_max(
            x * real_exp(-x) - real_expm1(-x) - x * x * (needles_e1_log(x) - real_log(x)), 0);
    real tail = x + 43; /* E3 as a continued fraction */
    for (int i = 20; i >= 1; i--)
        tail = x + REAL(2 * i + 1) - REAL(i * (i + 2)) / tail;
    return 1 - 2 * real_exp(-x) / tail;
}

#endif
