/* Papers' printed tables beside a run: what they print, the cells of ours that stand for it, and
 * what the run says to their claims. Only ratios within a machine are compared. */
#ifndef TREELINE_REPORT_PAPER_H
#define TREELINE_REPORT_PAPER_H

#include "report/book.h"

/* Of the frames along a repetition's path: the median one, or the 5 % slowest or fastest. */
enum paper_statistic { PAPER_MEDIAN, PAPER_WORST, PAPER_BEST };
enum paper_unit { PAPER_FPS, PAPER_SECONDS };

/* Which cells are meant; what is not said is free. */
struct paper_side {
    const char *scene, *method, *options; /* NULL: free; options: canonical text */
    bool has_lod;
    enum lod lod;
    size_t trees;            /* SIZE_MAX: free */
    int width_px, height_px; /* 0: free */
    bool has_azimuth;        /* of a column: of the views seen from there alone */
    float azimuth_deg[2];    /* low, high; of the eye around the trees, 0..360 */
};

/* One printed value. */
struct paper_row {
    struct paper_side
        cell; /* of ours that stands for it; options NULL: each variant stands apart */
    const char *effects, *note; /* as printed; note: "" */
    double size;                /* that the table's law is over; the trees where it says none */
    enum paper_statistic statistic;
    double value; /* in the table's unit */
};

struct paper_table {
    const char *title;
    enum paper_unit unit;
    const char *law;         /* what the time grows with ("trees"); NULL: no law is sought */
    size_t rows_count, base; /* ratios are to the base row */
    struct paper_row *rows;
};

enum paper_kind {
    PAPER_UNTESTED, /* no figure of a run decides it */
    PAPER_RATIO,  /* rate of some cells over that of others, pairs alike in all that no side says */
    PAPER_GROWTH, /* exponent of the rate against the trees */
    PAPER_VALUE,  /* a rate itself */
    PAPER_LAW     /* residual of an exponential of the trees over that of the better of a straight
                     line and a power law, of the time */
};
struct paper_claim {
    const char *id, *claim, *figure;
    enum paper_kind kind;
    enum paper_statistic statistic;
    const struct column *column; /* the figure is made of this number of a cell, which every round
                                    gives alike (an error, memory); NULL: of rates */
    struct paper_side of, over;
    double low, high; /* band in which the claim holds; infinite where it is open */
    const char *why;  /* this band */
};

struct paper {
    const char *name; /* of the file */
    const char *title, *authors, *source, *machine, *note;
    int year; /* 0: not known */
    size_t tables_count, claims_count;
    struct paper_table *tables;
    struct paper_claim *claims;
};

/* One paper's file, as reports/papers/README.md says; unknown keys and values out of range are
 * STATUS_INVALID. */
enum status paper_read(struct arena *arena, const char *path, struct paper *paper,
                       struct error *error);
/* All of FOLDER/NAME.json, by name; a folder that is not there holds none. */
enum status papers_read(struct arena *arena, const char *folder, struct paper **papers,
                        size_t *count, struct error *error);

/* A printed row beside ours. */
struct paper_line {
    const struct paper_row *printed;
    const struct row *ours; /* NULL: not in the run */
    size_t rounds;          /* of ours; 0: failed or missing */
    double printed_ratio;
    struct interval value; /* ours in the table's unit, over the rounds */
    struct interval ratio; /* ours over our base row, paired by round; NaN: either is missing */
};
/* A table beside one variant of a method of ours. */
struct paper_block {
    const struct paper_table *table;
    const struct row *example; /* one of the variant's rows: its name and colour */
    size_t lines_count;
    struct paper_line *lines;
    /* Laws of the time; NaN where the table seeks none. */
    struct growth_fit printed_fits[GROWTH_LAWS], fits[GROWTH_LAWS];
};
/* Fits the laws to the lines that both have: the same rows for printed and ours. */
void paper_fit(struct arena *arena, struct paper_block *block);
/* The residual of the exponential over the smaller of the others'; NaN: fewer than three. */
double paper_exponential(const double *sizes, const double *seconds, size_t count);
/* "a + b N", "a N^b", "a e^(b N)" with numbers; N is what the law is over. */
const char *paper_law(struct arena *arena, enum growth_law law, const struct growth_fit *fit);

enum paper_verdict { PAPER_HOLDS, PAPER_FAILS, PAPER_OPEN, PAPER_NOT_MEASURED };
/* What a run says to a claim: one a variant of the method that the claim speaks of. */
struct paper_finding {
    const struct paper_claim *claim;
    const struct row *example; /* NULL: nothing of it is in the run */
    size_t pairs, usable;      /* ratios, series or values that the run holds; that succeeded */
    size_t rounds;
    struct interval ours;       /* geometric mean of the ratios, mean exponent, smallest rate */
    double smallest, largest;   /* of the usable ones, each its median over rounds */
    struct interval printed;    /* the same of the printed rows: mean, smallest, largest */
    enum paper_verdict verdict; /* from the interval and the band */
    const char *reason;
};

struct paper_beside {
    const struct paper *paper;
    size_t blocks_count, findings_count;
    struct paper_block *blocks;
    struct paper_finding *findings;
};

/* The papers of which the run has a variant with cells for two rows of a printed table, or cells
 * for a claim about a scene that no table has. */
struct paper_beside *papers_beside(const struct book *book, const struct paper *papers,
                                   size_t papers_count, size_t *count);
/* A paper's claims, judged; in the order of the file. */
struct paper_finding *paper_judge(const struct book *book, const struct paper *paper,
                                  size_t *count);

/* A row's method and options, without its level: "shaded-texels path=naive". */
const char *paper_variant(struct arena *arena, const struct row *row);
/* A block's variant among those of its method, from 0 in the order of their first blocks. is_first:
 * no earlier block is of it. */
size_t paper_variant_number(struct arena *arena, const struct paper_beside *beside, size_t block,
                            bool *is_first);
const char *paper_verdict_word(enum paper_verdict verdict);
const char *paper_unit_word(enum paper_unit unit);
/* "3 or more", "-1.1 to -0.9". */
const char *paper_band(struct arena *arena, const struct paper_claim *claim);

/* A cell's rate or time in each round; NaN where the round failed or was not run. */
struct paper_sample {
    struct paper_side cell; /* nothing is free */
    uint64_t seed;
    enum target_format format;
    const struct row *row; /* NULL: printed */
    double *values;        /* rounds */
};
/* One a row of the book, in its order: rates or times. */
struct paper_sample *paper_samples(const struct book *book, enum paper_unit unit,
                                   enum paper_statistic statistic, size_t *rounds);
/* The same of a column, as a single round; where the side names an azimuth, of the views within. */
struct paper_sample *paper_samples_column(const struct book *book, const struct column *column,
                                          const struct paper_side *side);
bool paper_side_matches(const struct paper_side *side, const struct paper_sample *sample);

#endif
