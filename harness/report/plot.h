/* A plot being written: its data blocks, its gnuplot script, and the drawing of both. */
#ifndef TREELINE_REPORT_PLOT_H
#define TREELINE_REPORT_PLOT_H

#include "report/axis.h"
#include "report/book.h"

struct plot_box { /* px from the lower left corner of the plotting area */
    double left, right, bottom, top;
};

struct plot {
    const struct book *book;
    const char *folder, *name, *title;
    char *script, *data;
    size_t script_size, data_size;
    FILE *gp, *dat;
    int blocks;   /* data blocks so far */
    int curves;   /* after "plot" */
    int key_rows; /* makes room under the plot */
    int columns;  /* of the key in the wide version; the narrow one has one */
    int notes;    /* labels that the narrow version leaves out */
    int numbers;  /* labels of both */
    struct axis x, y;
    struct plot_box boxes[256]; /* where no label may stand */
    size_t boxes_count;
};

void plot_open(struct plot *plot, const struct book *book, const char *folder, const char *name,
               const char *title);
/* Both axes, with labels. y is logarithmic. */
void plot_axes(struct plot *plot, const struct axis *x, const struct axis *y, const char *x_label,
               const char *y_label);
/* A text for people in the script, quoted for gnuplot. */
void plot_text(FILE *out, const char *text);
/* Starts a data block with a comment line; returns its index. */
int plot_block(struct plot *plot, const char *what);
/* The next curve: writes "plot " or ", ". */
void plot_curve(struct plot *plot);
/* More lines than this no static plot tells apart. */
enum { PLOT_LINES_MAX = 24 };
/* The points of a block of the data with the symbol of a method, filled or open; how: gnuplot's
 * "with yerrorbars" or the like. title: in the key; NULL: not there. */
void plot_points(struct plot *plot, int block, const char *how, size_t method, bool filled,
                 const char *title);
/* A dotted upright line over the whole height, with a text along it; number: of the arrow and label
 * that they are. Call before the first curve. */
void plot_upright(struct plot *plot, int number, double x, const char *text);
/* No label may cover this point. */
void plot_keep_clear(struct plot *plot, double x, double y);
/* Nor what is drawn from one point to another, along an axis. */
void plot_keep_clear_line(struct plot *plot, double x, double y, double to_x, double to_y);
/* A small number as near to a point as it covers nothing, with a line to the point where that is
 * not beside it; in both versions. Call before the first curve. */
void plot_number(struct plot *plot, double x, double y, int number);
/* A small text beside a point, where it covers nothing; left out when there is no such place, and
 * in the narrow version. Call before the first curve. */
void plot_note(struct plot *plot, double x, double y, const char *text);
/* A small text at the right end of a level line, over it; no later note may cover it. */
void plot_line_note(struct plot *plot, double y, const char *text);
/* Nothing to draw after all. */
void plot_discard(struct plot *plot);
/* Writes data and script; the figure gets its name and title. */
enum status plot_close(struct plot *plot, struct figure *figure, struct error *error);
/* Each writes its files, or nothing when there is nothing to show or too much to tell apart: then
 * the figure has no name.
 * Errors against frame time of a group; full: the reference has all effects. */
enum status plot_trade(const struct book *book, const struct group *group, bool full,
                       const char *folder, struct figure *figure, struct error *error);
/* Frame rate against trees of a family. */
enum status plot_growth(const struct book *book, size_t family, const char *folder,
                        struct figure *figure, struct error *error);
/* Error against what the camera changes, over a group's views. */
enum status plot_views(const struct book *book, const struct group *group, enum view_axis axis,
                       const char *folder, struct figure *figure, struct error *error);
/* Frame time against distance, of groups whose cells timed just the views that are compared. */
enum status plot_pace(const struct book *book, const struct group *group, const char *folder,
                      struct figure *figure, struct error *error);
/* What is wrong in a group's shadow masks: against what shadows cost, which is a frame's time over
 * that of method polygons where the group has it; over the distances of its views. */
enum status plot_masks(const struct book *book, const struct group *group, const char *folder,
                       struct figure *figure, struct error *error);
enum status plot_masks_distance(const struct book *book, const struct group *group,
                                const char *folder, struct figure *figure, struct error *error);
/* Total error and frame time of a group's methods without and with the sun's shadows. */
enum status plot_pairs(const struct book *book, const struct group *group, const char *folder,
                       struct figure *figure, struct error *error);
/* The curve of a row through the points of a block of the data, with its label in the key. */
void plot_row_line(struct plot *plot, const struct row *row, int block);
/* Cells of a group under the machine's roof: frames a second of all of them; triangles a second
 * against their size; other work against work a byte. */
enum roofline_kind {
    ROOFLINE_FRAMES,
    ROOFLINE_TRIANGLES,
    ROOFLINE_LOOKUPS,
    ROOFLINE_SAMPLES,
    ROOFLINE_RAYS,
    ROOFLINES_COUNT
};
enum status plot_roofline(const struct book *book, const struct group *group,
                          enum roofline_kind which, const char *folder, struct figure *figure,
                          struct error *error);
/* Ratios of ours against the printed ones of a paper. */
struct paper_beside;
enum status plot_paper(const struct book *book, const struct paper_beside *beside,
                       const char *folder, struct figure *figure, struct error *error);
/* Times of a table that seeks a law, printed and ours over their base rows, and the laws. */
enum status plot_law(const struct book *book, const struct paper_beside *beside, size_t table,
                     const char *folder, struct figure *figure, struct error *error);
/* Error, frame time, memory or wrong shadows against a swept option. */
struct sweep;
enum sweep_axis { SWEEP_ERROR, SWEEP_TIME, SWEEP_MEMORY, SWEEP_MASK, SWEEP_AXES };
enum status plot_sweep(const struct book *book, const struct sweep *sweep, enum sweep_axis axis,
                       const char *folder, struct figure *figure, struct error *error);
/* Error against memory, of a group. */
enum status plot_memory(const struct book *book, const struct group *group, const char *folder,
                        struct figure *figure, struct error *error);

/* Runs gnuplot once over all figures and fills in their SVGs. */
enum status plot_draw(const struct book *book, const char *folder, const struct figures *figures,
                      struct error *error);

#endif
