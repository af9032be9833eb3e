/* Checks at the ends: no size, place or number gives NaN or silence; a right picture, or a refusal
 * with a reason. */
#include "conform/trial.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What a shot shows: coverage as the reference's; nothing far from the only tree; the tree where it
 * is in the reference's picture. */
enum { COVERS = 1, BOUNDED = 2, ALIKE = 4 };

/* Seen from `places` directions, evenly turned about the world's axis, each shifted by another part
 * of a pixel. */
struct shot {
    const char *name;
    size_t trees;
    double spacing_m;
    int places, wants;
    double eye_m[3], target_m[3];
};

/* Turned by so much about +y and moved by shift_m to the right and up. */
static void shot_view(const struct trial *trial, const struct shot *shot, int place,
                      struct view *view)
{
    const double turn_rad = 2 * M_PI * place / shot->places, c = cos(turn_rad), s = sin(turn_rad);
    double eye_m[3], target_m[3], distance_m = 0;
    for (int i = 0; i < 3; i++)
        distance_m += pow(shot->target_m[i] - shot->eye_m[i], 2);
    double pixel_m = sqrt(distance_m) * 2 * tan(0.5 * (double)trial->scene->camera.fov_y_rad) /
                     trial->scene->height_px;
    /* the additive recurrence of least discrepancy in the plane: Roberts 2018 */
    double right_m = pixel_m * fmod(place * 0.7548776662466927, 1);
    double up_m = pixel_m * fmod(place * 0.5698402909980532, 1);
    const double *from[2] = {shot->eye_m, shot->target_m};
    double *to[2] = {eye_m, target_m};
    for (int k = 0; k < 2; k++) {
        to[k][0] = from[k][0] * c + from[k][2] * s + right_m * c;
        to[k][1] = from[k][1] + up_m;
        to[k][2] = from[k][2] * c - from[k][0] * s - right_m * s;
    }
    world_view(trial->scene, &trial->world, eye_m, target_m, view);
}

static enum status shot_judge(struct subject *subject, const struct shot *shot,
                              const struct likeness *likeness)
{
    static const double MORE = 0.05, BLURRED = 0.3;
    double blurred = likeness->blurred / (double)likeness->pictures;
    bool close = shot->wants & ALIKE;
    enum status status = likeness_covers(subject, likeness, close ? MORE : 0);
    if (status || !close)
        return status;
    subject_note(subject, "over 8 x 8 pixels %.2g", blurred);
    if (blurred > BLURRED)
        return subject_fail(
            subject, "over 8 x 8 pixels coverage differs by %.3g from the reference", blurred);
    return STATUS_OK;
}

static enum status shoot(struct subject *subject, const struct shot *shot)
{
    struct trial_request request = {.world = {.trees = shot->trees, .spacing_m = shot->spacing_m},
                                    .format = TARGET_RGBA16F,
                                    .lod = LOD_AUTO};
    struct likeness likeness = {0};
    struct trial trial;
    subject_say(subject, "%s", shot->name);
    enum status status = trial_open(subject, &request, &trial);
    if (status)
        return status;
    for (int place = 0; place < shot->places && !status; place++) {
        struct view view;
        struct frame *frame;
        shot_view(&trial, shot, place, &view);
        status = trial_draw(&trial, &view, &frame);
        if (!status && shot->wants & BOUNDED)
            status = trial_bounded(&trial, frame, &view);
        if (!status && shot->wants & COVERS)
            status = trial_liken(&trial, frame, &view, &likeness);
    }
    if (!status && shot->wants & COVERS)
        status = shot_judge(subject, shot, &likeness);
    trial_close(&trial);
    return status;
}

static enum status shoot_all(struct subject *subject, const struct shot *shots, size_t count)
{
    enum status status = STATUS_OK;
    if (subject_is_treeless(subject))
        return STATUS_OK;
    for (size_t i = 0; i < count && !status; i++)
        if ((status = shoot(subject, &shots[i])))
            error_context(subject->error, "%s", shots[i].name);
    return status;
}

static enum status check_million(struct subject *subject)
{
    static const struct shot shot = {"a million trees", 1000000,     0, 1, COVERS,
                                     {0, 400, 7000},    {0, 0, 5000}};
    return shoot_all(subject, &shot, 1);
}

static enum status check_pixel(struct subject *subject)
{
    /* 48 rows at 0.7 rad: 20 m are a pixel at 1,315 m. Trees that are apart show what one covers in
     * the mean. */
    static const struct shot shots[] = {
        {"a tree of a pixel", 1, 0, 4, BOUNDED, {0, 100, 1300}, {0, 10, 0}},
        {"a tree below a pixel", 1, 0, 4, BOUNDED, {0, 300, 6000}, {0, 10, 0}},
        {"trees of a pixel, apart", 100, 100, 16, COVERS, {100, 300, 1300}, {0, 10, 0}},
        {"trees below a pixel, apart", 400, 100, 16, COVERS, {100, 600, 2600}, {0, 10, 0}},
        {"a forest of trees of a pixel", 2500, 0, 16, COVERS, {100, 500, 1300}, {0, 10, 0}},
        {"a forest of trees below a pixel", 2500, 0, 16, COVERS, {500, 1500, 4000}, {0, 10, 0}},
    };
    return shoot_all(subject, shots, sizeof shots / sizeof *shots);
}

static enum status check_close(struct subject *subject)
{
    static const struct shot shots[] = {
        {"a tree that fills the picture", 1, 0, 4, COVERS, {3, 12, 9}, {0, 12, 0}},
        {"a tree around the camera", 1, 0, 4, COVERS | ALIKE, {1.5, 12, 1}, {0, 12.5, -9}},
        {"the camera within a trunk", 1, 0, 4, COVERS | ALIKE, {0, 2, 0}, {5, 2.5, -5}},
        {"the camera at a tree's foot", 1, 0, 4, COVERS | ALIKE, {0, 0.5, 0}, {0, 1.5, 0.5}},
        {"straight up, below a tree", 1, 0, 4, COVERS | ALIKE, {2, 1, 0}, {2, 9, 0}},
    };
    return shoot_all(subject, shots, sizeof shots / sizeof *shots);
}

/* Straight down is the limit of tilting: a thousandth of a radian beside it the picture is the
 * same. */
static enum status check_down(struct subject *subject)
{
    static const double LIMIT = 0.02;
    struct trial_request request = {.world.trees = 16, .format = TARGET_RGBA32F};
    struct trial trial;
    struct frame *frames[2];
    enum status status = trial_open(subject, &request, &trial);
    if (status)
        return status;
    for (int i = 0; i < 2 && !status; i++) {
        struct view view;
        world_view(trial.scene, &trial.world, (double[3]){1, 90, 2},
                   (double[3]){1, 0, 2 - 0.09 * i}, &view);
        status = trial_draw(&trial, &view, &frames[i]);
    }
    if (!status) {
        double difference = frame_difference(frames[0], frames[1]).mean;
        subject_note(subject, "tilted by 0.001 rad %.2g", difference);
        if (difference > LIMIT)
            status = subject_fail(subject, "tilted by 0.001 rad the picture differs by %.3g",
                                  difference);
    }
    trial_close(&trial);
    return status;
}

/* Mean over pixels where neither picture has plants: the terrain and the sky. */
static double bare_difference(const struct frame *a, const struct frame *b)
{
    double sum = 0, count = 0;
    for (size_t i = 0; i < (size_t)a->width_px * (size_t)a->height_px; i++) {
        const float *p = a->rgba + 4 * i, *q = b->rgba + 4 * i;
        if (p[3] > 0.001f || q[3] > 0.001f)
            continue;
        for (int c = 0; c < 3; c++)
            sum += fabs((double)p[c] - q[c]);
        count += 3;
    }
    return count > 0 ? sum / count : 0;
}

static enum status check_sun(struct subject *subject)
{
    static const double BARE = 0.005, NUDGE = 0.002;
    static const struct {
        const char *name;
        float direction[2][3]; /* the sun's, and a thousandth of a radian beside it */
    } suns[] = {
        {"at the zenith", {{0, 1, 0}, {0, 1, 0.001f}}},
        {"at the horizon", {{0, 0, 1}, {0, 0.001f, 1}}},
        {"below the horizon", {{0.6f, -0.8f, 0}, {0.6f, -0.8f, 0.001f}}},
        {"at the nadir", {{0, -1, 0}, {0, -1, 0.001f}}},
    };
    struct trial_request request = {.world.trees = 3, .format = TARGET_RGBA32F};
    struct trial trial;
    struct view view;
    enum status status = trial_open(subject, &request, &trial);
    if (status)
        return status;
    world_view_near(trial.scene, &trial.world, &view);
    for (size_t s = 0; s < sizeof suns / sizeof *suns && !status; s++) {
        struct frame *frames[2], *reference;
        subject_say(subject, "the sun %s", suns[s].name);
        for (int i = 1; i >= 0 && !status; i--) {
            memcpy(view.sun_direction, suns[s].direction[i], sizeof view.sun_direction);
            status = trial_draw(&trial, &view, &frames[i]);
        }
        if (!status)
            status = trial_reference(&trial, &view, trial.workspace.effects, &reference);
        if (status)
            break;
        double bare = bare_difference(frames[0], reference);
        double nudged = frame_difference(frames[0], frames[1]).mean;
        if (bare > BARE)
            status = subject_fail(subject,
                                  "the sun %s: terrain and sky differ by %.3g from the "
                                  "reference",
                                  suns[s].name, bare);
        else if (nudged > NUDGE)
            status = subject_fail(subject,
                                  "the sun %s: 0.001 rad beside it the picture differs by "
                                  "%.3g",
                                  suns[s].name, nudged);
    }
    trial_close(&trial);
    return status;
}

/* All lengths times a number: the same picture. Rounding moves some edges. */
static enum status check_scale(struct subject *subject)
{
    static const double scales[] = {1, 1e-3, 1e6}, LIMIT = 0.01;
    struct frame *frames[3];
    for (int i = 0; i < 3; i++) {
        struct trial_request request = {
            .world = {.trees = 9, .scale = scales[i]}, .format = TARGET_RGBA32F, .lod = LOD_AUTO};
        subject_say(subject, "scale %g", scales[i]);
        enum status status = trial_picture(subject, &request, NULL, &frames[i]);
        if (status)
            return error_context(subject->error, "scale %g", scales[i]);
        double difference = frame_difference(frames[i], frames[0]).mean;
        if (i)
            subject_note(subject, "scale %g %.2g", scales[i], difference);
        if (difference > LIMIT)
            return subject_fail(subject, "scale %g: differs from scale 1 by %.3g in the mean",
                                scales[i], difference);
    }
    return STATUS_OK;
}

/* A scene a thousand kilometres away: the same picture, by its own camera. */
static enum status check_offset(struct subject *subject)
{
    static const double offsets_m[] = {0, 999000}, LIMIT = 0.001;
    struct frame *frames[2];
    for (int i = 0; i < 2; i++) {
        struct trial_request request = {.format = TARGET_RGBA32F};
        struct trial trial;
        struct view view;
        subject_say(subject, "offset %g m", offsets_m[i]);
        if (world_write(subject->arena, subject->folder, offsets_m[i], &request.world.file,
                        subject->error) ||
            trial_open(subject, &request, &trial))
            return subject->error->status;
        view_at(trial.scene, 0, &view);
        enum status status = trial_draw(&trial, &view, &frames[i]);
        trial_close(&trial);
        if (status)
            return error_context(subject->error, "offset %g m", offsets_m[i]);
    }
    double difference = frame_difference(frames[0], frames[1]).mean;
    subject_note(subject, "mean difference %.2g", difference);
    if (difference > LIMIT)
        return subject_fail(subject, "%g m from the origin the picture differs by %.3g in the mean",
                            offsets_m[1], difference);
    return STATUS_OK;
}

static enum status check_tiny(struct subject *subject)
{
    static const int sizes[][2] = {{1, 1}, {1, 29}, {31, 1}, {3, 2}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        struct frame *frame;
        struct trial_request request = {
            .world = {.trees = 4, .width_px = sizes[i][0], .height_px = sizes[i][1]},
            .format = TARGET_RGBA16F,
            .lod = LOD_AUTO};
        subject_say(subject, "%d x %d", sizes[i][0], sizes[i][1]);
        if (trial_picture(subject, &request, NULL, &frame))
            return error_context(subject->error, "%d x %d", sizes[i][0], sizes[i][1]);
    }
    return STATUS_OK;
}

enum { HUGE_PX = 8192, SMALL_PX = 64, BOX_PX = HUGE_PX / SMALL_PX };

/* The picture's means over boxes, strip by strip, so that it is never whole in memory twice. */
static void boxes_read(struct trial *trial, struct frame *small)
{
    struct gl *gl = trial->workspace.gl;
    float *strip = ARENA_ARRAY(trial->arena, float, (size_t)4 * HUGE_PX * BOX_PX);
    for (int row = 0; row < SMALL_PX; row++) {
        const float *pixels = strip;
        if (gl) {
            gl->BindFramebuffer(GL_READ_FRAMEBUFFER, trial->target.framebuffer);
            gl->ReadPixels(0, HUGE_PX - (row + 1) * BOX_PX, HUGE_PX, BOX_PX, GL_RGBA, GL_FLOAT,
                           strip);
        } else {
            pixels = trial->target.pixels + (size_t)4 * HUGE_PX * BOX_PX * (size_t)row;
        }
        float *sums = small->rgba + (size_t)4 * SMALL_PX * (size_t)row;
        for (size_t i = 0; i < (size_t)HUGE_PX * BOX_PX; i++)
            for (size_t c = 0; c < 4; c++)
                sums[4 * (i % HUGE_PX / BOX_PX) + c] +=
                    pixels[4 * i + c] / ((float)BOX_PX * BOX_PX);
    }
}

/* Means over boxes against the reference of one pixel a box. */
static enum status boxes_judge(struct trial *trial, const struct frame *small,
                               const struct view *view)
{
    static const double LIMIT = 0.03;
    struct frame *reference;
    enum status status = trial_reference(trial, view, trial->workspace.effects, &reference);
    if (status)
        return status;
    for (size_t i = 0; i < (size_t)4 * SMALL_PX * SMALL_PX; i++)
        reference->rgba[i] = fminf(reference->rgba[i], 1);
    double bare = bare_difference(small, reference);
    if (bare > LIMIT)
        return subject_fail(trial->subject, "terrain and sky differ by %.3g from the reference",
                            bare);
    if (trial->method->traits & TRAIT_NO_TREES)
        return STATUS_OK;
    return trial_covers(trial, small, view);
}

/* 8 bits a channel: 0.5 GB with the depth. */
static enum status check_huge(struct subject *subject)
{
    struct trial_request request = {
        .world = {.trees = 3, .width_px = HUGE_PX, .height_px = HUGE_PX}, .lod = LOD_AUTO};
    struct trial trial;
    struct view view;
    enum status status = trial_open(subject, &request, &trial);
    if (status)
        return status;
    world_view_near(trial.scene, &trial.world, &view);
    status = trial_draw_only(&trial, &view);
    if (!status) {
        struct frame *small = frame_create(subject->arena, SMALL_PX, SMALL_PX, false);
        boxes_read(&trial, small);
        view.width_px = view.height_px = SMALL_PX;
        status = frame_check(small, subject->error);
        if (!status)
            status = boxes_judge(&trial, small, &view);
    }
    trial_close(&trial);
    return status;
}

const struct check checks_extremes[] = {
    {"pixel", "trees of a pixel and below, alone and in a forest", check_pixel, false},
    {"close", "a tree that fills the picture, around the camera, and the camera within its trunk",
     check_close, false},
    {"down", "straight down is the limit of tilting", check_down, false},
    {"sun", "the sun at the zenith, the horizon, below it and at the nadir", check_sun, false},
    {"scale", "a world of a thousandth and of a million times the size gives the same picture",
     check_scale, false},
    {"offset", "a scene a thousand kilometres from the origin gives the same picture", check_offset,
     false},
    {"tiny", "pictures of 1 x 1, 1 x n and n x 1 pixels", check_tiny, false},
    {"huge", "a picture of 8192 x 8192 pixels", check_huge, false},
    {"million", "a million trees", check_million, false},
    {NULL, NULL, NULL, false},
};
