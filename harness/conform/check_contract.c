/* Checks of the contract's letter: description, options, formats, repeatability. */
#include "conform/trial.h"

#include "base/file.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static enum status check_option(struct subject *subject, const struct option *option)
{
    const struct method *method = subject->method;
    char text[128], allowed[128];
    void *values = arena_alloc(subject->arena, 1, method->options_size);
    if (!option->doc || strlen(option->doc) < 4 || !option->unit)
        return subject_fail(subject, "option %s: has no meaning or no unit", option->name);
    if (option->offset >= method->options_size)
        return subject_fail(subject, "option %s: offset %zu is outside the %zu bytes of options",
                            option->name, option->offset, method->options_size);
    for (const struct option *other = method->options; other < option; other++)
        if (!strcmp(other->name, option->name))
            return subject_fail(subject, "option %s: stands twice", option->name);
    option_fallback(option, text, sizeof text);
    option_allowed(option, allowed, sizeof allowed);
    if (option_set(method->options, option->name, text, values, NULL))
        return subject_fail(subject, "option %s: its default %s is outside %s", option->name, text,
                            allowed);
    return STATUS_OK;
}

static enum status check_description(struct subject *subject)
{
    const struct method *method = subject->method;
    const unsigned known = EFFECTS_ALL | TRAIT_CPU | TRAIT_STOCHASTIC | TRAIT_NO_TREES | TRAIT_MASK;
    const char *stem = path_stem(subject->arena, subject->name);
    if (strcmp(method->name, stem) != 0)
        return subject_fail(subject, "its name is '%s', its file's '%s'", method->name, stem);
    if (!method->summary || strlen(method->summary) < 10)
        return subject_fail(subject, "summary: says too little");
    if (!method->source || strlen(method->source) < 5)
        return subject_fail(subject, "source: names nobody");
    if (method->traits & ~known)
        return subject_fail(subject, "traits: bits 0x%x mean nothing", method->traits & ~known);
    enum status status = STATUS_OK;
    for (const struct option *o = method->options; o && o->name && !status; o++)
        status = check_option(subject, o);
    return status;
}

/* "a=1,b=2" with one option at a value and the other whole numbers at their least, so that an end
 * of a range is not paid for at all other options' price. */
static char *options_text(struct subject *subject, const struct option *option, const char *value)
{
    char *text = arena_printf(subject->arena, "%s=%s", option->name, value);
    for (const struct option *o = subject->method->options; o->name; o++)
        if (o != option && o->type == OPTION_INT)
            text = arena_printf(subject->arena, "%s,%s=%.0f", text, o->name, o->minimum);
    return text;
}

static enum status check_value(struct subject *subject, const struct option *option,
                               const char *value)
{
    struct frame *frame;
    struct trial_request request = {.world = {.trees = 2, .width_px = 32, .height_px = 24},
                                    .lod = LOD_HIGH,
                                    .format = TARGET_RGBA16F,
                                    .options = options_text(subject, option, value)};
    subject_say(subject, "%s", request.options);
    enum status status = trial_picture(subject, &request, NULL, &frame);
    if (!status && !(subject->method->traits & TRAIT_NO_TREES) && !(frame_coverage(frame) > 0))
        status = subject_fail(subject, "no tree is seen");
    return status ? error_context(subject->error, "%s", request.options) : STATUS_OK;
}

static enum status check_options(struct subject *subject)
{
    size_t count = 0;
    for (const struct option *o = subject->method->options; o && o->name; o++) {
        char allowed[256], ends[2][32], *rest = allowed;
        const char *separator = "|";
        option_allowed(o, allowed, sizeof allowed);
        if (o->type != OPTION_BOOL && o->type != OPTION_CHOICE) {
            snprintf(ends[0], sizeof ends[0], "%.9g", o->minimum);
            snprintf(ends[1], sizeof ends[1], "%.9g", o->maximum);
            snprintf(allowed, sizeof allowed, "%s|%s", ends[0], ends[1]);
        }
        for (char *value; (value = strsep(&rest, separator)); count++)
            if (check_value(subject, o, value))
                return subject->error->status;
    }
    subject_note(subject, "%zu values", count);
    return STATUS_OK;
}

static enum status check_formats(struct subject *subject)
{
    struct frame *frame, *first = NULL;
    for (enum target_format format = TARGET_RGBA8; format <= TARGET_RGBA32F; format++) {
        struct trial_request request = {
            .world.trees = 3, .format = format, .effects_off = EFFECT_FOG};
        subject_say(subject, "%s", target_format_word(format));
        if (trial_picture(subject, &request, NULL, &frame))
            return error_context(subject->error, "%s", target_format_word(format));
        if (first && frame_difference(frame, first).mean > 0.02)
            return subject_fail(subject, "%s: differs from rgba16f by %.3g in the mean",
                                target_format_word(format), frame_difference(frame, first).mean);
        if (format == TARGET_RGBA16F) /* 8 bits cut off what is brighter than 1 */
            first = frame;
    }
    return STATUS_OK;
}

static enum status check_bytes(struct subject *subject)
{
    struct trial_request request = {.world.trees = 9, .format = TARGET_RGBA16F, .lod = LOD_AUTO};
    struct trial trial;
    struct frame *frames[3] = {NULL, NULL, NULL};
    struct view views[2];
    enum status status = trial_open(subject, &request, &trial);
    if (status)
        return status;
    world_view_near(trial.scene, &trial.world, &views[0]);
    world_view(trial.scene, &trial.world, (double[3]){-50, 60, -20}, (double[3]){0, 5, 0},
               &views[1]);
    memcpy(views[1].sun_direction, (float[3]){0.6f, 0.48f, -0.64f}, sizeof(float[3]));
    for (int i = 0; i < 3 && !status; i++)
        status = trial_draw(&trial, &views[i == 1], &frames[i]);
    if (!status && frame_hash(frames[0]) != frame_hash(frames[2]))
        status =
            subject_fail(subject, "a view drawn again after another one differs by %.3g at worst",
                         frame_difference(frames[0], frames[2]).worst);
    if (!status)
        subject_note(subject, "%016" PRIx64, frame_hash(frames[0]));
    trial_close(&trial);
    return status;
}

static enum status check_sun_moved(struct subject *subject)
{
    struct trial_request request = {.world.trees = 3, .format = TARGET_RGBA32F};
    struct trial trial;
    struct frame *before, *moved, *fresh;
    struct view view;
    enum status status = trial_open(subject, &request, &trial);
    if (status)
        return status;
    world_view_near(trial.scene, &trial.world, &view);
    status = trial_draw(&trial, &view, &before);
    memcpy(view.sun_direction, (float[3]){0.6f, 0.48f, -0.64f}, sizeof(float[3]));
    if (!status)
        status = trial_draw(&trial, &view, &moved);
    if (!status)
        status = trial_picture(subject, &request, &view, &fresh);
    if (!status && frame_difference(moved, fresh).worst > 1e-4)
        status =
            subject_fail(subject, "the moved sun's picture differs from a fresh start's by %.3g",
                         frame_difference(moved, fresh).worst);
    if (!status && frame_difference(moved, before).worst < 0.01)
        status = subject_fail(subject, "the sun moved and nothing changed");
    trial_close(&trial);
    return status;
}

static enum status check_load(struct subject *subject)
{
    (void)subject; /* it is loaded */
    return STATUS_OK;
}

const struct check checks_contract[] = {
    {"load", "it is there, of this ABI, and has what a method must have", check_load, false},
    {"description", "name, summary, source, traits and options make sense", check_description,
     false},
    {"options", "every option's ends, or words, give a picture", check_options, false},
    {"formats", "every pixel is drawn, finite, alpha in [0, 1], in every target format",
     check_formats, false},
    {"bytes", "the same view gives the same bytes: again, after another view, in another process",
     check_bytes, true},
    {"sun-moved", "a moved sun gives the picture of a sun that always stood there", check_sun_moved,
     false},
    {NULL, NULL, NULL, false},
};
