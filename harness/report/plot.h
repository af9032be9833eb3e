/* A plot being written: its data blocks, its gnuplot script, and the drawing of both. */
#ifndef TREELINE_REPORT_PLOT_H
#define TREELINE_REPORT_PLOT_H

#include "report/axis.h"
#include "report/book.h"

struct plot {
    const struct book *book;
    const char *folder, *name, *title;
    char *script, *data;
    size_t script_size, data_size;
    FILE *gp, *dat;
    int blocks;   /* data blocks so far */
    int curves;   /* after "plot" */
    int key_rows; /* makes room under the plot */
    int notes;    /* labels that the narrow version leaves out */
};

void plot_open(struct plot *plot, const struct book *book, const char *folder, const char *name,
               const char *title);
/* Both axes logarithmic, with labels. */
void plot_axes(struct plot *plot, const struct axis *x, const struct axis *y, const char *x_label,
               const char *y_label);
/* A text for people in the script, quoted for gnuplot. */
void plot_text(FILE *out, const char *text);
/* Starts a data block with a comment line; returns its index. */
int plot_block(struct plot *plot, const char *what);
/* The next curve: writes "plot " or ", ". */
void plot_curve(struct plot *plot);
/* A small text at a place of the plot, left out of the narrow version. */
void plot_note(struct plot *plot, double x, double y, const char *where, const char *text);
/* Runs gnuplot and fills the figure. */
enum status plot_close(struct plot *plot, struct figure *figure, struct error *error);

#endif
