/* The verbs of the command line, and what they share. */
#ifndef TREELINE_CLI_CLI_H
#define TREELINE_CLI_CLI_H

#include "base/arena.h"
#include "base/error.h"
#include "plan/plan.h"

/* getopt.h, which argp.h includes, has a struct option of its own. */
#define option getopt_option
#include <argp.h>
#undef option

struct verb {
    const char *name, *summary;
    int (*run)(int argc, char **argv); /* argv[0] is "treeline NAME"; returns the exit code */
};
extern const struct verb verbs[]; /* ends with a NULL name */

int verb_list(int argc, char **argv);
int verb_help(int argc, char **argv);
int verb_run(int argc, char **argv);
int verb_render(int argc, char **argv);
int verb_reference(int argc, char **argv);
int verb_views(int argc, char **argv);
int verb_diff(int argc, char **argv);
int verb_report(int argc, char **argv);
int verb_shaders(int argc, char **argv);
int verb_calibrate(int argc, char **argv);
int verb_conform(int argc, char **argv);
int verb_cache(int argc, char **argv);

/* "treeline: TEXT" on stderr; returns the status as exit code. */
int cli_fail(const struct error *error);

/* For argp parsers: one line "treeline VERB: --OPTION: 'VALUE' is not ..." and exit code usage when
 * the text is no such number. Sizes take k, M, G (powers of 1024). */
int cli_integer(const struct argp_state *state, const char *option, const char *text, int minimum,
                int maximum);
double cli_number(const struct argp_state *state, const char *option, const char *text,
                  double minimum, double maximum);
size_t cli_bytes(const struct argp_state *state, const char *what, const char *text);
uint64_t cli_seed(const struct argp_state *state, const char *text);

/* Where a verb that writes a folder writes it, and whether it prints the path of what to look at.
 */
struct cli_folder {
    const char *out; /* as the verb has set it without --out */
    bool quiet;
};
extern const struct argp cli_folder_argp; /* a child parser; its input is the struct cli_folder */

/* One cell and one camera, as `render` and `reference` take them. */
struct cli_shot {
    const char *scene, *method, *trees, *lod, *size, *target_format, *cell, *backend, *out;
    uint64_t seed;
    bool seed_given, has_eye, has_target, quiet;
    double time;
    double eye_m[3], target_m[3]; /* in scene.json's coordinates */
};
extern const struct argp cli_shot_argp; /* a child parser; its input is the struct cli_shot */
/* The cell that a shot names; with_method false: the null method stands in. */
enum status cli_shot_cell(struct arena *arena, const struct cli_shot *shot, bool with_method,
                          struct cell *cell, struct error *error);
/* The view of a shot in its scene. */
void cli_shot_view(const struct cli_shot *shot, const struct scene *scene, struct view *view);

/* The manual page, roff, to stdout: from the verbs' own --help and the status table. */
int man_page(void);
/* methods/README.md to stdout: from the methods' own structs and option tables. */
int methods_page(void);

#endif
