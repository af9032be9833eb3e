/* One method prepared in one world, alone in its context, as a cell has it; and what its pictures
 * say. */
#ifndef TREELINE_CONFORM_TRIAL_H
#define TREELINE_CONFORM_TRIAL_H

#include "conform/subject.h"
#include "conform/world.h"
#include "truth/frame.h"

/* Zeros are the defaults: no tree, all effects that the method has, every option's default,
 * LOD_LOW. */
struct trial_request {
    struct world world;
    enum target_format format;
    enum lod lod;
    unsigned effects_off;        /* EFFECT_* that are not drawn */
    unsigned scene_effects_off;  /* nor wanted by the scene; of fog, none is there */
    const char *options;         /* text over the defaults */
    const struct method *method; /* NULL: the subject's */
};

struct trial {
    struct subject *subject;
    struct world world;
    const struct method *method;
    struct arena *arena;        /* the scene's: not the method's */
    struct workspace workspace; /* its arena is the method's */
    struct scene *scene;
    struct target target;
    void *state;
};

/* Scene, context, target, prepare. After an error the trial is closed. A scene that the method does
 * not support is STATUS_UNSUPPORTED. */
enum status trial_open(struct subject *subject, const struct trial_request *request,
                       struct trial *trial);
void trial_close(struct trial *trial);

/* One picture over a target that was spoiled first, checked (frame_check, GL errors), in the
 * subject's arena; frame may be NULL. */
enum status trial_draw(struct trial *trial, const struct view *view, struct frame **frame);
/* draw and its errors alone. */
enum status trial_draw_only(struct trial *trial, const struct view *view);
/* The same view, ray traced with these effects at 64 samples a pixel. */
enum status trial_reference(struct trial *trial, const struct view *view, unsigned effects,
                            struct frame **frame);

/* Opens, draws world_view_near or the given view, closes. */
enum status trial_picture(struct subject *subject, const struct trial_request *request,
                          const struct view *view, struct frame **frame);

/* Pictures beside the reference's, summed: what chance and the places of samples do to one picture
 * averages out. */
struct likeness {
    size_t pictures;
    double coverage, reference; /* sums of mean alpha */
    double blurred;             /* sum of the RMS difference of mean alpha over 8 x 8 pixels */
};
enum status trial_liken(struct trial *trial, const struct frame *frame, const struct view *view,
                        struct likeness *likeness);
/* Coverage is the reference's, within a sixth of it and so much more: a representation may be a
 * little fatter or thinner than the truth. Notes both. */
enum status likeness_covers(struct subject *subject, const struct likeness *likeness, double more);
/* trial_liken and likeness_covers of one picture, with nothing more. */
enum status trial_covers(struct trial *trial, const struct frame *frame, const struct view *view);
/* Alpha is 0 outside of the ball that holds the world's first tree, with a margin of 2 pixels. */
enum status trial_bounded(struct trial *trial, const struct frame *frame, const struct view *view);

double frame_coverage(const struct frame *frame); /* mean alpha */
/* Absolute differences of two pictures' values, all channels. */
struct difference {
    double mean, worst;
};
struct difference frame_difference(const struct frame *a, const struct frame *b);

#endif
