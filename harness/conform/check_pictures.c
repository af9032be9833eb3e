/* Checks of pictures of ordinary scenes: against the ray-traced reference, with and without each
 * effect, by level of detail. */
#include "conform/trial.h"

#include "truth/metrics.h"

#include <math.h>
#include <string.h>

static enum status check_empty(struct subject *subject)
{
    struct trial_request request = {.format = TARGET_RGBA32F};
    struct trial trial;
    struct view view;
    struct frame *frame, *reference;
    enum status status = trial_open(subject, &request, &trial);
    if (status)
        return status;
    world_view_near(trial.scene, &trial.world, &view);
    status = trial_draw(&trial, &view, &frame);
    if (!status)
        status = trial_reference(&trial, &view, trial.workspace.effects, &reference);
    if (!status) {
        struct difference difference = frame_difference(frame, reference);
        if (frame_coverage(frame) != 0)
            status = subject_fail(subject, "no tree stands, but coverage is %.3g",
                                  frame_coverage(frame));
        else if (difference.mean > 0.005)
            status = subject_fail(subject, "differs from the reference by %.3g in the mean",
                                  difference.mean);
        subject_note(subject, "mean difference %.2g", difference.mean);
    }
    trial_close(&trial);
    return status;
}

static enum status one_tree(struct subject *subject, const char *file)
{
    struct trial_request request = {
        .world = {.trees = 1, .file = file}, .format = TARGET_RGBA16F, .lod = LOD_HIGH};
    struct trial trial;
    struct view view;
    struct frame *frame;
    enum status status = trial_open(subject, &request, &trial);
    if (status)
        return status;
    world_view_near(trial.scene, &trial.world, &view);
    status = trial_draw(&trial, &view, &frame);
    bool treeless = subject_is_treeless(subject);
    if (!status && treeless && frame_coverage(frame) > 0)
        status = subject_fail(subject, "says that it draws no trees, but coverage is %.3g",
                              frame_coverage(frame));
    if (!status && !treeless)
        status = trial_covers(&trial, frame, &view);
    if (!status && !treeless)
        status = trial_bounded(&trial, frame, &view);
    trial_close(&trial);
    return status;
}

static enum status check_one_tree(struct subject *subject)
{
    return one_tree(subject, NULL);
}

static enum status check_user_mesh(struct subject *subject)
{
    const char *path;
    enum status status = world_write(subject->arena, subject->folder, 0, &path, subject->error);
    return status ? status : one_tree(subject, path);
}

/* Twice and half as high as the plant; from so far that all of it is seen. */
static enum status check_stretch(struct subject *subject)
{
    static const double stretches[2] = {2, 0.5};
    if (subject_is_treeless(subject))
        return STATUS_OK;
    for (int i = 0; i < 2; i++) {
        struct trial_request request = {.world = {.trees = 1, .stretch = stretches[i]},
                                        .format = TARGET_RGBA16F,
                                        .lod = LOD_HIGH};
        struct trial trial;
        struct view view;
        struct frame *frame;
        double middle_m = 10 * stretches[i];
        subject_say(subject, "stretch %g", stretches[i]);
        enum status status = trial_open(subject, &request, &trial);
        if (status)
            return status;
        world_view(trial.scene, &trial.world, (double[3]){15, middle_m + 7, 60},
                   (double[3]){0, middle_m, 0}, &view);
        status = trial_draw(&trial, &view, &frame);
        if (!status)
            status = trial_covers(&trial, frame, &view);
        trial_close(&trial);
        if (status)
            return error_context(subject->error, "stretch %g", stretches[i]);
    }
    return STATUS_OK;
}

/* Mean luminance where both pictures show plants. */
static double plant_luminance(const struct frame *frame, const struct frame *a,
                              const struct frame *b)
{
    double sum = 0, count = 0;
    size_t pixels = (size_t)frame->width_px * (size_t)frame->height_px;
    for (size_t i = 0; i < pixels; i++) {
        const float *rgb = frame->rgba + 4 * i;
        if (!(a->rgba[4 * i + 3] > 0.5f) || !(b->rgba[4 * i + 3] > 0.5f))
            continue;
        sum += 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
        count++;
    }
    return count > 0 ? sum / count : 0;
}

/* A method's pictures and the references, with and without an effect; all other effects are the
 * method's own. */
struct pair {
    struct frame *drawn[2], *traced[2];
};

/* The effects that the method draws as it comes: an option may have one more. */
static unsigned effects_claimed(const struct subject *subject)
{
    const struct method *method = subject->method;
    void *options = method->options ? arena_alloc(subject->arena, 1, method->options_size) : NULL;
    if (options)
        options_default(method->options, options);
    return method_effects(method, options, EFFECTS_ALL);
}

/* From behind, so that leaves are lit from the other side; far, so that fog is thick. */
static enum status pair_draw(struct subject *subject, unsigned effect, struct pair *pair)
{
    unsigned own = effects_claimed(subject);
    for (int with = 0; with < 2; with++) {
        struct trial_request request = {.world.trees = 1,
                                        .format = TARGET_RGBA32F,
                                        .lod = LOD_HIGH,
                                        .effects_off = with ? 0 : effect,
                                        .scene_effects_off = with ? 0 : effect};
        struct trial trial;
        struct view view;
        enum status status = trial_open(subject, &request, &trial);
        if (status)
            return status;
        world_view_near(trial.scene, &trial.world, &view);
        memcpy(view.sun_direction, (float[3]){0.36f, 0.48f, -0.8f}, sizeof(float[3]));
        status = trial_draw(&trial, &view, &pair->drawn[with]);
        if (!status)
            status = trial_reference(&trial, &view, with ? own | effect : own & ~effect,
                                     &pair->traced[with]);
        trial_close(&trial);
        if (status)
            return status;
    }
    return STATUS_OK;
}

/* A claimed effect changes the trees as it changes the reference's, in sign and roughly in size; an
 * unclaimed one changes nothing and is not there all the same. */
static enum status effect_judge(struct subject *subject, const char *word, bool claimed,
                                const struct pair *pair)
{
    double drawn[2], traced[2];
    for (int with = 0; with < 2; with++) {
        drawn[with] = plant_luminance(pair->drawn[with], pair->drawn[0], pair->traced[0]);
        traced[with] = plant_luminance(pair->traced[with], pair->drawn[0], pair->traced[0]);
    }
    double wanted = traced[1] - traced[0], given = drawn[1] - drawn[0];
    if (fabs(wanted) < 0.05 * traced[0])
        return STATUS_OK; /* cannot be seen here */
    if (claimed) {
        subject_note(subject, "%s %.2f of the reference's", word, given / wanted);
        if (frame_difference(pair->drawn[0], pair->drawn[1]).worst < 1e-3)
            return subject_fail(subject, "claims %s, which changes nothing", word);
        if (given / wanted < 0.1 || given / wanted > 10)
            return subject_fail(subject,
                                "claims %s, which changes the trees' luminance by %.3g, the "
                                "reference's by %.3g",
                                word, given, wanted);
        return STATUS_OK;
    }
    if (frame_difference(pair->drawn[0], pair->drawn[1]).worst > 0)
        return subject_fail(subject, "does not claim %s, but draws it when the scene has it", word);
    double share = (drawn[0] - traced[0]) / wanted;
    subject_note(subject, "%s not claimed, %.2f there", word, share);
    if (fabs(wanted) > 0.25 * traced[0] && share > 0.75)
        return subject_fail(subject, "does not claim %s, but its picture without is %.0f %% with",
                            word, 100 * share);
    return STATUS_OK;
}

static enum status check_effects(struct subject *subject)
{
    static const struct {
        unsigned effect;
        const char *word;
    } effects[] = {
#define EFFECT_ROW(name, bit, word, meaning) {name, word},
        EFFECT_LIST(EFFECT_ROW)
#undef EFFECT_ROW
    };
    if (subject_is_treeless(subject))
        return STATUS_OK;
    for (size_t e = 0; e < sizeof effects / sizeof *effects; e++) {
        struct pair pair;
        subject_say(subject, "%s", effects[e].word);
        enum status status = pair_draw(subject, effects[e].effect, &pair);
        if (!status)
            status = effect_judge(subject, effects[e].word,
                                  effects_claimed(subject) & effects[e].effect, &pair);
        if (status)
            return status;
    }
    return STATUS_OK;
}

/* Error of boxes of 4 x 4 pixels, so that a sample or two a pixel are no error of the method. */
static enum status lod_error(struct subject *subject, enum lod lod, double *rmse, double *floor)
{
    struct trial_request request = {.world = {.trees = 9, .width_px = 128, .height_px = 96},
                                    .format = TARGET_RGBA32F,
                                    .lod = lod};
    struct trial trial;
    struct view view;
    struct frame *frame, *reference;
    struct comparison comparison;
    enum status status = trial_open(subject, &request, &trial);
    if (status)
        return status;
    world_view(trial.scene, &trial.world, (double[3]){12, 22, 60}, (double[3]){0, 8, 0}, &view);
    status = trial_draw(&trial, &view, &frame);
    if (!status)
        status = trial_reference(&trial, &view, trial.workspace.effects, &reference);
    if (!status)
        status = metrics_compare(trial.arena, frame, reference, &comparison, NULL, subject->error);
    if (!status) {
        *rmse = comparison.value.rmse_box4;
        *floor = comparison.floor.rmse_box4;
        subject_note(subject, "%s %.4f", lod_word(lod), *rmse);
    }
    trial_close(&trial);
    return status;
}

static enum status check_lod(struct subject *subject)
{
    static const double NOISE = 1.05; /* of one picture: another one has another choice of leaves */
    double rmse[LOD_HIGH + 1], floor;
    if (subject_is_treeless(subject))
        return STATUS_OK;
    for (int lod = LOD_LOW; lod <= LOD_HIGH; lod++) {
        subject_say(subject, "lod=%s", lod_word((enum lod)lod));
        if (lod_error(subject, (enum lod)lod, &rmse[lod], &floor))
            return subject->error->status;
        if (lod > LOD_LOW && rmse[lod] > NOISE * rmse[lod - 1] + floor)
            return subject_fail(
                subject, "lod=%s errs by %.4f, lod=%s by %.4f (RMSE of 4 x 4 pixels)",
                lod_word((enum lod)lod), rmse[lod], lod_word((enum lod)(lod - 1)), rmse[lod - 1]);
    }
    return STATUS_OK;
}

const struct check checks_pictures[] = {
    {"empty", "no tree: sky and terrain alone, as the reference has them", check_empty, false},
    {"one-tree", "one tree covers about what the reference's does, and nothing far from it",
     check_one_tree, false},
    {"user-mesh", "the same of a tree from an OBJ file in another unit and with z up",
     check_user_mesh, false},
    {"stretch", "a tree twice and half as high as its plant covers what the reference's does",
     check_stretch, false},
    {"effects", "claimed effects act as in the reference, others do not", check_effects, false},
    {"lod", "the error does not grow with the level of detail", check_lod, false},
    {NULL, NULL, NULL, false},
};
