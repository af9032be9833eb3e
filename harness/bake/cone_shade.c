/* The shaders' integrals by a few nodes each. */
#include "bake/cone_shade.h"

#include <math.h>

#define PI 3.14159265f

static float dot3(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* |a x b|: no cancellation where a and b are nearly one. */
static float sine_of(const float a[3], const float b[3])
{
    float x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2];
    float z = a[0] * b[1] - a[1] * b[0];
    return sqrtf(x * x + y * y + z * z);
}

/* sin D + (pi - D) cos D of c = cos D, to 0.0037; never below 0. */
static float facing_of(float c)
{
    float square = c * c;
    float f = 1 + 0.5f * PI * c + (0.5f * PI - 1) * square - 0.0991f * square * (1 - square);
    return f > 0 ? f : 0;
}

/* Of a direction across a needle. */
struct across {
    float sine, cosine;
};

static struct across across_of(const float axis[3], const float a[3], const float b[3])
{
    float ca = dot3(axis, a), cb = dot3(axis, b), sa = sine_of(axis, a), sb = sine_of(axis, b);
    float c = (dot3(a, b) - ca * cb) / fmaxf(sa * sb, 1e-9f);
    c = c > -1 ? c < 1 ? c : 1 : -1;
    return (struct across){sqrtf(1 - c * c), c};
}

/* Eq 3 where the sun shines, by the cheap form: half of sh^n J. */
static float gloss_of(const float axis[3], const struct cone_sight *sight)
{
    const float n = sight->exponent;
    float half[3], square = 0;
    for (int i = 0; i < 3; i++) {
        half[i] = sight->sun[i] + sight->eye[i];
        square += half[i] * half[i];
    }
    if (square < 1e-12f || sine_of(axis, sight->eye) < 1e-6f)
        return 0;
    for (int i = 0; i < 3; i++)
        half[i] /= sqrtf(square);
    float along = dot3(axis, half), sines = 1 - along * along;
    if (sines < 1e-12f)
        return 0;
    struct across eye = across_of(axis, half, sight->eye);
    struct across sun = across_of(axis, half, sight->sun);
    float k = sqrtf(0.5f * (n + 1.5f)), peak = 0.5f * sqrtf(2 * PI / (n + 1.5f)) / erff(k);
    float lobe = eye.cosine * peak * (erff(k * eye.cosine) + erff(k * sun.cosine)) +
                 eye.sine * (powf(eye.sine, n + 1) - powf(sun.sine, n + 1)) / (n + 1);
    return 0.5f * powf(sines, 0.5f * n) * fmaxf(lobe, 0);
}

struct cone_shine cone_needle_shine(const float axis[3], const struct cone_sight *sight)
{
    float seen = sine_of(axis, sight->eye), lit = sine_of(axis, sight->sun);
    struct cone_shine shine = {lit / PI, 0};
    if (seen > 1e-5f) {
        float c = across_of(axis, sight->sun, sight->eye).cosine;
        shine.diffuse = 0.25f * lit * (facing_of(c) + (sight->two_sided ? facing_of(-c) : 0));
    } else if (sight->two_sided) {
        shine.diffuse *= 2;
    }
    if (sight->exponent > 0)
        shine.gloss = gloss_of(axis, sight);
    return shine;
}

struct cone_halves cone_halves_of(float sine, float cosine, const struct cone_sight *sight)
{
    /* Gauss and Legendre with two nodes on a quarter of a turn */
    static const float nodes[2] = {0.25f * PI * (1 - 0.57735027f), 0.25f * PI * (1 + 0.57735027f)};
    const float *eye = sight->eye, flat = sqrtf(eye[0] * eye[0] + eye[1] * eye[1]);
    const float ex = flat > 1e-6f ? eye[0] / flat : 1, ey = flat > 1e-6f ? eye[1] / flat : 0;
    struct cone_halves halves = {{0, 0}, {{0, 0}, {0, 0}}};
    for (int node = 0; node < 4; node++) {
        float c = cosf(nodes[node / 2]),
              s = node & 1 ? -sinf(nodes[node / 2]) : sinf(nodes[node / 2]);
        for (int back = 0; back < 2; back++) {
            float x = back ? -c : c;
            const float axis[3] = {sine * (x * ex - s * ey), sine * (x * ey + s * ex), cosine};
            float seen = 0.25f * sine_of(axis, eye);
            struct cone_shine shine = cone_needle_shine(axis, sight);
            halves.seen[back] += seen;
            halves.shine[back].diffuse += seen * shine.diffuse;
            halves.shine[back].gloss += seen * shine.gloss;
        }
    }
    for (int back = 0; back < 2; back++) {
        float seen = fmaxf(halves.seen[back], 1e-9f);
        halves.shine[back].diffuse /= seen;
        halves.shine[back].gloss /= seen;
    }
    return halves;
}

float cone_disc_depth(const float sun[2], float toward, float aside)
{
    float high = sqrtf(fmaxf(1 - aside * aside, 0));
    return fmaxf(toward >= 0 ? sun[0] * (high - toward) : sun[0] * high - sun[1] * toward, 0);
}

/* Visible opacity is the variable: a node sees as much as another. */
static float half_lit(const struct cone_depths *depths, float x, float rx, int back)
{
    static const float at[3] = {0.11270167f, 0.5f, 0.88729833f};
    static const float weights[3] = {5.0f / 18, 8.0f / 18, 5.0f / 18};
    const float depth = fmaxf(depths->eye[back], 1e-6f), all = 1 - expf(-depth * rx);
    float sum = 0;
    for (int k = 0; k < 3; k++) {
        float d = -logf(1 - all * at[k]) / depth, w = back ? -d : rx - d;
        float toward = w * depths->cosine + x * depths->sine;
        float aside = x * depths->cosine - w * depths->sine;
        sum += weights[k] * expf(-cone_disc_depth(depths->sun, toward, aside));
    }
    return all * sum;
}

struct cone_disc cone_disc_of(const struct cone_depths *depths)
{
    static const float at[3] = {0.23861919f, 0.66120939f, 0.93246951f};
    static const float weights[3] = {0.46791393f, 0.36076157f, 0.17132449f};
    const bool dark = depths->sun[0] + depths->sun[1] > 0;
    struct cone_disc disc = {{0, 0}, 0, 0};
    for (int k = 0; k < 6; k++) {
        float t = 0.5f * PI * (k & 1 ? at[k / 2] : -at[k / 2]), x = sinf(t), rx = cosf(t);
        float weight = 0.25f * PI * weights[k / 2] * rx;
        float front = 1 - expf(-depths->eye[0] * rx), past = 1 - front;
        float back = past * (1 - expf(-depths->eye[1] * rx));
        disc.opacity += weight * (front + back);
        disc.opacity_front += weight * front;
        disc.lit[0] += weight * (dark ? half_lit(depths, x, rx, 0) : front);
        disc.lit[1] += weight * (dark ? past * half_lit(depths, x, rx, 1) : back);
    }
    return disc;
}
