/* Parametric L-systems: a grammar as JSON, its rewriting, and the turtle that grows a conifer from
 * what is left.
 *
 * Prusinkiewicz and Lindenmayer 1990, The Algorithmic Beauty of Plants, chapter 1: parametric,
 * conditional and stochastic rules, a turtle with heading, left and up. scenes/plants/README.md
 * documents the file and the turtle's symbols. All modules are rewritten at once, step by step,
 * until no rule matches any. What does not end within LSYSTEM_STEPS_MAX steps, grows above
 * LSYSTEM_MODULES_MAX modules or takes more than LSYSTEM_REWRITES_MAX applications or
 * LSYSTEM_OPERATIONS_MAX operations of expressions (a number, a name and an operator are one each)
 * is refused. */
#ifndef TREELINE_PLANT_LSYSTEM_H
#define TREELINE_PLANT_LSYSTEM_H

#include "base/arena.h"
#include "base/option.h"
#include "plant/conifer.h"

enum {
    LSYSTEM_STEPS_MAX = 1000,
    LSYSTEM_MODULES_MAX = 1 << 20,
    LSYSTEM_REWRITES_MAX = 4 << 20,
    LSYSTEM_OPERATIONS_MAX = 64 << 20,
    LSYSTEM_ARGUMENTS_MAX = 9,
};

struct lsystem; /* belongs to an arena */

/* Reads and checks a grammar: every name that is written has a rule and always as many arguments,
 * every expression is of known names. STATUS_INVALID names file and key. */
enum status lsystem_load(struct arena *arena, const char *path, struct lsystem **lsystem,
                         struct error *error);
/* The same from text; where stands for the file's name in errors. */
enum status lsystem_parse(struct arena *arena, const char *text, const char *where,
                          struct lsystem **lsystem, struct error *error);

/* The grammar's parameters and "seed", as a table of options. */
const struct option *lsystem_options(const struct lsystem *lsystem);
/* Parameters as text, "boughs=6,seed=3"; NULL: those of the file. */
enum status lsystem_set(struct lsystem *lsystem, const char *options, struct error *error);

/* The modules when no rule matches any more, as text: "F(1,0.1,0.1)[+(30)F(2,0.1,0.1)]". */
enum status lsystem_text(struct arena *arena, const struct lsystem *lsystem, char **text,
                         struct error *error);
/* The conifer that the turtle draws, finished. */
enum status lsystem_conifer(struct arena *arena, const struct lsystem *lsystem,
                            struct conifer **conifer, struct error *error);

/* Of the grammar's text and the parameters: changes when the conifer may. */
uint64_t lsystem_hash(const struct lsystem *lsystem);

#endif
