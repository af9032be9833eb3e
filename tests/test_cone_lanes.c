/* Twigs shaded by lanes: the bytes of every set of lanes, and bake/needles.h one by one. */
#include "testing.h"

#include "bake/cone_lanes.h"
#include "bake/cone_shade.h"
#include "base/random.h"

#include <math.h>
#include <string.h>

static void direction(struct random *random, int odd, float d[3])
{
    double z = 2 * random_double(random) - 1, turn = 2 * M_PI * random_double(random);
    double flat = odd == 1 ? 0 : odd == 2 ? 1 : sqrt(1 - z * z);
    z = odd == 1 ? (z < 0 ? -1 : 1) : odd == 2 ? 0 : z;
    d[0] = (float)(flat * cos(turn));
    d[1] = (float)(flat * sin(turn));
    d[2] = (float)z;
}

/* Twigs as they come, and at the ends of their numbers: along the eye or the light, across both,
 * light behind or before, needles along the twig or across it, dense and sparse. */
static void job_fill(struct random *random, int round, struct cone_lanes_job *job)
{
    static const float exponents[] = {-1, 0, 1, 20, 400, 10000};
    memset(job, 0, sizeof *job);
    job->exponent = exponents[round % 6];
    job->shaded = round % 4;
    for (int lane = 0; lane < CONE_LANES; lane++) {
        double phi = round % 5 == 0 ? (lane & 1 ? 1e-4 : M_PI / 2) : 1.5 * random_double(random);
        float eye[3], light[3];
        direction(random, round % 7 == 3 ? 1 + lane % 2 : 0, eye);
        direction(random, round % 7 == 5 ? 1 + lane % 2 : 0, light);
        for (int i = 0; i < 3; i++) {
            light[i] = round % 11 == 7 ? (lane & 1 ? eye[i] : -eye[i]) : light[i];
            job->eye[i][lane] = eye[i];
            job->light[i][lane] = light[i];
        }
        job->sine[lane] = (float)sin(phi);
        job->cosine[lane] = (float)cos(phi);
        job->radius_m[lane] = fmaxf(0.05f * job->sine[lane], 5e-4f);
        job->length_m[lane] = 0.24f;
        job->area_m2[lane] =
            (float)(144 * 2.5e-5 *
                    pow(10, (round % 9 == 0 ? 4 : 1.5) * (random_double(random) - 0.5)));
    }
}

/* What the scalar shaders have of one lane; depths are taken from the lanes. */
static void lane_check(const struct cone_lanes_job *job, int lane, int round)
{
    const float eye[3] = {job->eye[0][lane], job->eye[1][lane], job->eye[2][lane]};
    const float light[3] = {job->light[0][lane], job->light[1][lane], job->light[2][lane]};
    const float axis[3] = {0, 0, 1};
    const struct needles_sight sight = needles_sight_of(light, eye, job->exponent, false);
    const struct needles_twig twig = {.sine = job->sine[lane], .cosine = job->cosine[lane]};
    const struct cone_halves halves = cone_halves_of(CONE_EXACT, &twig, &sight);
    const struct needles_disc disc = {{job->depths[0][lane], job->depths[1][lane]},
                                      {job->light_depths[0][lane], job->light_depths[1][lane]},
                                      job->disc_cosine[lane],
                                      job->disc_sine[lane]};
    const struct needles_lit lit = needles_disc_lit(&disc);
    const float wanted[][2] = {
        {halves.seen[0], job->seen[0][lane]},
        {halves.seen[1], job->seen[1][lane]},
        {halves.shade[0].diffuse, job->diffuse[0][lane]},
        {halves.shade[1].diffuse, job->diffuse[1][lane]},
        {halves.shade[0].specular, job->specular[0][lane]},
        {halves.shade[1].specular, job->specular[1][lane]},
        {lit.seen[0], job->disc_seen[0][lane]},
        {lit.seen[1], job->disc_seen[1][lane]},
        {lit.lit[0], job->disc_lit[0][lane]},
        {lit.lit[1], job->disc_lit[1][lane]},
        {needles_reflect(axis, &sight).diffuse, job->axis_diffuse[lane]},
    };
    for (size_t k = 0; k < sizeof wanted / sizeof *wanted; k++)
        if (!(fabsf(wanted[k][0] - wanted[k][1]) < 5e-4f))
            fail_msg("round %d, lane %d, value %zu: %.6f by lanes, %.6f alone", round, lane, k,
                     (double)wanted[k][1], (double)wanted[k][0]);
}

static void test_lanes__shade_as_the_shaders_of_one_twig(void **state)
{
    (void)state;
    struct random random = random_seed(5, 1);
    for (int round = 0; round < 400; round++) {
        struct cone_lanes_job job;
        job_fill(&random, round, &job);
        cone_shade_plain(&job);
        for (int lane = 0; lane < CONE_LANES; lane++)
            lane_check(&job, lane, round);
    }
}

static void test_lanes__of_every_processor_give_the_same_bytes(void **state)
{
    (void)state;
    struct random random = random_seed(6, 1);
    struct cone_isa isas[2];
    const size_t count = cone_isas(isas);
    for (int round = 0; round < 200; round++) {
        struct cone_lanes_job job, first;
        job_fill(&random, round, &job);
        for (size_t isa = 0; isa < count; isa++) {
            struct cone_lanes_job other = job;
            isas[isa].shade(&other);
            first = isa ? first : other;
            assert_memory_equal(&other, &first, sizeof other);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lanes__shade_as_the_shaders_of_one_twig),
        cmocka_unit_test(test_lanes__of_every_processor_give_the_same_bytes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
