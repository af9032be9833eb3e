/* A method under test, and what a check says about it. */
#ifndef TREELINE_CONFORM_SUBJECT_H
#define TREELINE_CONFORM_SUBJECT_H

#include "method/method.h"

struct subject {
    const char *name; /* as it was named; a plugin's path */
    const struct method *method;
    const char *folder; /* scratch */
    const char *backend;
    struct arena *arena; /* as long as the check */
    struct error *error;
    int out;        /* descriptor to the parent */
    bool skipped;   /* the note says why */
    char note[512]; /* figures, told when the check passed */
};

/* What a check does: STATUS_OK, or a status and a line in subject->error. */
struct check {
    const char *name, *doc;
    enum status (*run)(struct subject *subject);
    bool twice; /* in two processes, whose notes must be the same */
};
/* Ends with a NULL name each. */
extern const struct check checks_contract[], checks_resources[], checks_pictures[],
    checks_extremes[], checks_tally[];

/* Tells the parent what begins, so that a crash names it. */
void subject_say(const struct subject *subject, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* Adds to the note. */
void subject_note(struct subject *subject, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* Passed over, with a reason; returns STATUS_OK. */
enum status subject_skip(struct subject *subject, const char *reason);
/* True for a method that says it draws no tree; such a check is skipped. */
bool subject_is_treeless(struct subject *subject);
/* The contract is broken, in one line. */
#define subject_fail(subject, ...) error_set((subject)->error, STATUS_NONCONFORMING, __VA_ARGS__)

#endif
