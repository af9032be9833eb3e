/* Checks of what a method says that it did (struct method_tally): limits are told from it. */
#include "conform/trial.h"

#include "base/clock.h"

#include <inttypes.h>

/* What can be counted, and how much of it no processor does: a thread's units a second, far above
 * all that is built (rays of 10 cycles; two vectors of 16 lanes looked up in every cycle; a cache
 * line of 64 bytes a cycle), and a GPU's, as of a thousand such. */
static const struct {
    const char *word;
    size_t offset; /* in struct method_tally */
    double most;
    bool by_cpu, by_gl, rises; /* who may count it; more pixels are more of it */
} counts[] = {
    {"rays", offsetof(struct method_tally, rays), 1e9, true, false, true},
    {"occlusion rays", offsetof(struct method_tally, occlusion_rays), 1e9, true, false, true},
    {"lookups", offsetof(struct method_tally, lookups), 2e11, true, true, true},
    {"samples", offsetof(struct method_tally, samples), 2e11, false, true, true},
    {"bytes", offsetof(struct method_tally, bytes), 4e11, true, true, false},
};
enum { COUNTS = sizeof counts / sizeof *counts, GPU_THREADS = 1000 };

static uint64_t count_of(const struct method_tally *tally, int which)
{
    return *(const uint64_t *)(const void *)((const char *)tally + counts[which].offset);
}

/* What one draw added, and its time. */
struct told {
    uint64_t counts[COUNTS];
    double seconds;
};

static enum status draw_told(struct trial *trial, const struct view *view, bool counted,
                             struct told *told)
{
    const struct method_tally before = trial->workspace.tally;
    double start = clock_wall_seconds();
    trial->workspace.counted = counted;
    enum status status = trial_draw_only(trial, view);
    trial->workspace.counted = false;
    told->seconds = clock_wall_seconds() - start;
    for (int i = 0; i < COUNTS; i++)
        told->counts[i] = count_of(&trial->workspace.tally, i) - count_of(&before, i);
    return status;
}

/* A counted draw may be slower than a plain one, never so much faster that these are wrong. */
static enum status tally_is_possible(const struct trial *trial, const struct told *told)
{
    struct subject *subject = trial->subject;
    const struct gl *gl = trial->workspace.gl;
    int threads = gl && !gl->software ? GPU_THREADS : trial->workspace.threads;
    for (int i = 0; i < COUNTS; i++) {
        if (told->counts[i] > 0 && !(gl ? counts[i].by_gl : counts[i].by_cpu))
            return subject_fail(subject, "counts %s, which %s", counts[i].word,
                                gl ? "are the CPU's alone: it draws with OpenGL"
                                   : "are OpenGL's alone: it draws without");
        double rate = (double)told->counts[i] / told->seconds, most = counts[i].most * threads;
        if (rate > most)
            return subject_fail(subject,
                                "counts %.3g %s in a draw of %.3g s: %.2g a second, %.2g are more "
                                "than any machine does",
                                (double)told->counts[i], counts[i].word, told->seconds, rate, most);
    }
    return STATUS_OK;
}

/* Plain and counted draws of one view. */
static enum status tally_is_repeated(struct trial *trial, const struct view *view,
                                     struct told *first)
{
    struct subject *subject = trial->subject;
    struct told told;
    enum status status = draw_told(trial, view, true, first);
    if (!status)
        status = tally_is_possible(trial, first);
    if (!status)
        status = draw_told(trial, view, false, &told);
    for (int i = 0; i < COUNTS && !status; i++)
        if (trial->workspace.gl && told.counts[i] > 0)
            return subject_fail(subject, "counts %s in a draw that is timed", counts[i].word);
    if (!status)
        status = draw_told(trial, view, true, &told);
    for (int i = 0; i < COUNTS && !status; i++)
        if (told.counts[i] != first->counts[i])
            return subject_fail(subject, "a view counts %" PRIu64 " %s, again %" PRIu64,
                                first->counts[i], counts[i].word, told.counts[i]);
    return status;
}

static enum status told_of(struct subject *subject, int times, struct told *told)
{
    struct trial_request request = {
        .world = {.trees = 9, .width_px = 128 * times, .height_px = 96 * times},
        .format = TARGET_RGBA16F,
        .lod = LOD_HIGH};
    struct trial trial;
    struct view view;
    enum status status = trial_open(subject, &request, &trial);
    if (status)
        return status;
    world_view_near(trial.scene, &trial.world, &view);
    status = tally_is_repeated(&trial, &view, told);
    trial_close(&trial);
    return status;
}

static enum status check_tally(struct subject *subject)
{
    struct told small, large;
    bool any = false;
    enum status status = told_of(subject, 1, &small);
    if (!status)
        status = told_of(subject, 2, &large);
    for (int i = 0; i < COUNTS && !status; i++) {
        uint64_t before = small.counts[i], after = large.counts[i];
        if (after < before || (counts[i].rises && before > 0 && after == before))
            return subject_fail(subject,
                                "a picture of four times the pixels counts %" PRIu64
                                " %s, not more "
                                "than %" PRIu64,
                                after, counts[i].word, before);
        if (before > 0)
            subject_note(subject, "%.3g %s", (double)before, counts[i].word);
        any |= before > 0;
    }
    if (!status && !any)
        subject_note(subject, subject->method->traits & TRAIT_CPU
                                  ? "counts nothing: only its picture's bytes can bind it"
                                  : "counts nothing of its own");
    return status;
}

const struct check checks_tally[] = {
    {"tally", "what it says that it did is possible, grows with the picture, and is the same again",
     check_tally, false},
    {NULL, NULL, NULL, false},
};
