/* Inside the report: what every table, plot and page is made from, derived once from the run. */
#ifndef TREELINE_REPORT_BOOK_H
#define TREELINE_REPORT_BOOK_H

#include "report/report.h"
#include "stats/stats.h"

#include <stdio.h>

/* The numbers of a row. Every number of every table, plot and page is one of these, in SI units. */
#define FRAME_COLUMNS(X)                                                                           \
    X(repetitions, "", 0, "repetitions that succeeded")                                            \
    X(failures, "", -1, "repetitions that failed")                                                 \
    X(frame_seconds, "s", -1, "median over repetitions of each one's median frame time")           \
    X(frame_seconds_low, "s", 0, "lower end of its 95 % interval (below 3 repetitions: smallest)") \
    X(frame_seconds_high, "s", 0, "upper end of its 95 % interval (below 3 repetitions: largest)") \
    X(fps, "1/s", +1, "1 / frame_seconds")                                                         \
    X(trees_per_second, "1/s", +1, "trees of the scene / frame_seconds")                           \
    X(rays_per_second, "1/s", +1, "rays of both kinds / frame_seconds")                            \
    X(lookups_per_second, "1/s", +1, "lookups / frame_seconds")                                    \
    X(samples_per_second, "1/s", +1, "samples / frame_seconds")                                    \
    X(triangles_per_second, "1/s", +1, "triangles submitted / frame_seconds")                      \
    X(fragments_per_second, "1/s", +1, "fragments / frame_seconds")                                \
    X(limit_fraction, "", +1, "of the machine's limit that the cell reaches (results/README.md)")  \
    X(limit_fraction_low, "", 0, "lower end: best rate, slowest frame time of the interval")       \
    X(limit_fraction_high, "", 0, "upper end: median rate, fastest frame time of the interval")    \
    X(frames, "", 0, "timed frames of all repetitions")                                            \
    X(flicker_mean, "", -1, "rmse of the frame-to-frame change against the reference's")           \
    X(flicker_peak, "", -1, "its largest pair of views")                                           \
    X(flicker_floor, "", -1, "what noise alone would give")                                        \
    X(mask_wrong, "", -1, "shadow mask: wrong share of the surface, mean over views")              \
    X(mask_leak, "", -1, "the part of it that is lit and should be dark")                          \
    X(mask_acne, "", -1, "the part of it that is dark and should be lit")                          \
    X(mask_stray, "", -1, "the part of it that is over 2 px from every true edge")                 \
    X(mask_edge_px, "px", -1, "mean distance of what is wrong to the true edge")                   \
    X(mask_floor, "", -1, "wrong share that the reference's noise alone would give")               \
    X(mask_judged, "", 1, "share of the reference's surface that was compared")                    \
    X(mask_dark, "", 0, "the truth's share of shadow")                                             \
    X(mask_shimmer, "", -1, "wrong change of the mask from a view to the path's next frame")       \
    X(same_standard_error, "", -1, "of the references with the same effects, mean over views")     \
    X(full_standard_error, "", -1, "of the references with all effects, mean over views")

enum column_index {
#define COLUMN_ENUM(field, unit, better, doc) COLUMN_##field,
    FRAME_COLUMNS(COLUMN_ENUM) RESULT_COLUMNS(COLUMN_ENUM)
#undef COLUMN_ENUM
#define COLUMN_ENUM(field, word, better, domain, doc) COLUMN_same_##field,
        METRIC_LIST(COLUMN_ENUM)
#undef COLUMN_ENUM
#define COLUMN_ENUM(field, word, better, domain, doc) COLUMN_full_##field,
            METRIC_LIST(COLUMN_ENUM)
#undef COLUMN_ENUM
#define COLUMN_ENUM(field, word, better, domain, doc) COLUMN_floor_##field,
                METRIC_LIST(COLUMN_ENUM)
#undef COLUMN_ENUM
                    COLUMNS_COUNT
};

struct column {
    const char *key, *unit, *doc;
    int better;
};
extern const struct column column_table[COLUMNS_COUNT];

/* A column as people read it: heading and unit for which the value is multiplied by scale. */
struct shown {
    enum column_index column;
    const char *heading, *unit;
    double scale;
};
extern const struct shown shown_table[]; /* that a results table may have */
extern const size_t shown_table_count;

/* One cell. */
struct row {
    const struct summary *summary;
    const struct result
        *seen;     /* the successful repetition with compared views, else summary->first */
    bool ok;       /* at least one repetition succeeded */
    bool compared; /* has errors */
    bool is_floor; /* method null: draws no tree, takes part in no front */
    const char *method, *label; /* label: method and what tells it from the others in its group */
    const char *variant;        /* the label without the method; "" when the method is enough */
    size_t method_index;        /* colour and symbol */
    size_t series; /* cells that differ in scene, trees, size and seed alone share one */
    size_t group;
    size_t trees;
    double values[COLUMNS_COUNT]; /* NaN: not measured */
};

/* The method's memory and GL objects; NaN where neither was measured. */
double row_megabytes(const struct row *row);

/* Cells that may be compared: of one scene, tree count, size and seed. */
struct group {
    const char *scene, *title, *slug; /* slug: for file names and anchors */
    size_t trees;
    int width_px, height_px;
    uint64_t seed;
    const size_t *rows; /* indices into book.rows, one after the other */
    size_t rows_count;
    size_t family; /* groups that differ in trees alone share one */
};

/* A row of a series in a family. */
struct law_point {
    size_t family, series, row;
};
/* Frame seconds = time.a * trees ^ time.b: least squares of logarithms, the interval of b by
 * Student's t. */
struct law {
    const struct law_point *points; /* by trees */
    size_t points_count;
    struct power_law time;
    bool is_fitted; /* three points or more */
};

struct book {
    struct arena *arena;
    const struct run *run;
    struct shown *shown; /* columns of the results table: those that a row has a value in */
    size_t shown_count;
    const char *run_name;
    struct row *rows;
    size_t rows_count;
    struct group *groups; /* in order of scene, size, seed, trees */
    size_t groups_count;
    const char **methods; /* sorted */
    size_t methods_count;
    const char **series; /* labels, by first appearance */
    size_t series_count;
    const char **families; /* titles */
    size_t families_count;
    struct law *laws; /* a family and series, those with one point too */
    size_t laws_count;
    bool effects_differ;                /* some cell draws less than its scene asks for */
    const struct paper_beside *besides; /* papers whose printed tables the run has cells of */
    size_t besides_count;
};
struct paper_beside;
struct book *book_make(struct arena *arena, const struct run *run);
void book_find_laws(struct book *book); /* by book_make */
/* Any row has a value in the column. */
bool book_knows(const struct book *book, enum column_index column);
/* The group with the most trees of its family: what overviews show. */
bool book_is_overview(const struct book *book, size_t group);
/* What the camera changes along a path. */
enum view_axis { VIEW_DISTANCE, VIEW_ELEVATION, VIEW_AZIMUTH };
enum { VIEW_AXES = VIEW_AZIMUTH + 1 };
/* A group's views tell how the error depends on it: the distance changes by more than a tenth; or
 * it does not, and an angle changes by 10 degrees or more over three views or more. */
bool views_go(const struct book *book, const struct group *group, enum view_axis axis);
/* Rows of a group on the front, fastest first; front holds group->rows_count places. */
size_t book_front(const struct book *book, const struct group *group, size_t *front);

/* Numbers for people. Not measured: an en dash. */
struct number {
    char text[40];
};
struct number number_plain(double value, int digits); /* significant digits, thousands separated */
struct number number_short(double value, int digits); /* 98.3 k, 1.2 M */
struct number number_exact(double value);             /* shortest that reads back; NaN: "" */
/* "12.3 ms" or "1.23 s". */
struct number number_seconds(double seconds);

void html_put(FILE *out, const char *text);
void html_put_mark(FILE *out, const struct book *book, size_t method_index); /* a method's symbol */
void html_put_label(FILE *out, const struct book *book, const struct row *row); /* with symbol */
/* Writes what an open_memstream collected; closes it and frees. */
enum status sheet_write(FILE *sheet, char **data, const size_t *size, const char *path,
                        struct error *error);

/* One file of FOLDER: its name, and who writes it. */
struct export_table {
    const char *name;
    void (*write)(const struct book *book, FILE *out);
};
enum status export_write(const struct book *book, const char *folder,
                         const struct export_table *tables, size_t count, struct error *error);
enum status export_tables(const struct book *book, const char *folder, struct error *error);
enum status export_papers(const struct book *book, const char *folder, struct error *error);
void csv_text(FILE *out, const char *text);      /* quoted where it must be */
void markdown_text(FILE *out, const char *text); /* escaped */

/* The group to speak about first: a front of the three points that are told, then the most trees,
 * then the most cells; NULL: no group has a front. front: as of book_front, of rows_count places.
 */
const struct group *answer_group(const struct book *book, size_t *front, size_t *front_count);
/* Sentences. */
void answer_headline(const struct book *book, FILE *out);
void answer_fronts(const struct book *book, FILE *out);  /* HTML table: a row per group */
void answer_overall(const struct book *book, FILE *out); /* HTML table: a row per series */

/* Colours: light for gnuplot, both as CSS variables. */
enum tint { TINT_INK, TINT_MUTED, TINT_FAINT, TINT_METHOD }; /* TINT_METHOD + k, k < TINT_METHODS */
enum { TINT_METHODS = 8 };
unsigned tint_rgb(size_t tint); /* 0xRRGGBB, light */
size_t tint_method(const struct book *book, size_t method_index);
const char *symbol_html(const struct book *book,
                        size_t method_index); /* a small inline SVG's body */
int symbol_gnuplot(const struct book *book, size_t method_index, bool filled); /* point type */
const char *tint_variable(size_t tint);
void theme_css(FILE *out);
/* gnuplot's SVG made fit for light and dark: its colours become CSS variables, its ids get the
 * prefix. alone: with its own style sheet, for a file; else for inclusion in the page. */
void theme_svg(const char *svg, const char *prefix, const char *title, bool alone, FILE *out);

/* One static figure of the overview. Files FOLDER/NAME.{dat,gp,svg,png} and NAME-narrow.svg. */
enum figure_kind {
    FIGURE_TRADE_SAME,
    FIGURE_TRADE_FULL,
    FIGURE_MASKS,
    FIGURE_MASKS_DISTANCE,
    FIGURE_PAIRS,
    FIGURE_GROWTH,
    FIGURE_DISTANCE,
    FIGURE_PACE,
    FIGURE_ELEVATION,
    FIGURE_AZIMUTH,
    FIGURE_LIMIT,
    FIGURE_ROOFLINE,
    FIGURE_PAPER,
    FIGURE_LAW,
    FIGURE_SWEEP,
    FIGURE_MEMORY
};
struct figure {
    enum figure_kind kind;
    const char *name, *title;
    char *svg, *svg_narrow; /* for inclusion; NULL: could not be drawn */
};
struct figures {
    struct figure *list;
    size_t count;
};
/* The overview's figures, of the first families; one gnuplot draws them all. */
enum status plots_draw(const struct book *book, const char *folder, struct figures *figures,
                       struct error *error);

/* Pictures as HTML and as OUT/pictures/NAME.png, within what a page may hold. */
struct gallery {
    const struct book *book;
    const char *out_folder;
    int thumbnail_px;                                /* width; maps have half of it */
    bool overview_only, first_view_only, front_only; /* what the page's size allows */
    size_t missing;                                  /* pictures that could not be shown */
};
void gallery_start(struct gallery *gallery, const struct book *book, const char *out_folder);
bool gallery_shows(const struct gallery *gallery, const struct group *group);
void gallery_group(struct gallery *gallery, const struct group *group, FILE *out);

/* The page's data: one line of JSON. */
const char *data_json(const struct book *book, struct arena *arena);

enum status page_write(const struct book *book, const struct figures *figures, const char *no_plots,
                       const char *out_folder, struct error *error);

#endif
