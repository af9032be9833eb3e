/* Inside the page: its parts, each written to the same sheet. */
#ifndef TREELINE_REPORT_PAGE_H
#define TREELINE_REPORT_PAGE_H

#include "report/book.h"

struct page {
    const struct book *book;
    const struct figures *figures;
    const char *no_plots; /* why there are no plots; NULL */
    const char *out_folder;
    struct arena *arena;
    FILE *out;
    const char *style, *script, *reading;
};

void page_text(const struct page *page, const char *html);
void page_safe(const struct page *page, const char *text); /* escaped; empty or NULL: a dash */
/* A place that the page's script fills; without a script nothing is seen of it. */
void page_live(const struct page *page, const char *id);

/* Tables: all cells, memory and build time, growth laws. Long runs show a part of them here; the
 * script has all. */
void page_results(const struct page *page);
void page_cost(const struct page *page);
void page_laws(const struct page *page);

/* Static figures of these kinds; how many there are. Rooflines stay where the script runs; what
 * others show is drawn by the script, so they are seen on paper and without it. */
size_t page_figures(const struct page *page, enum figure_kind first, enum figure_kind last);
/* What the machine can do, and how near the cells come; nothing where it was not calibrated. */
void page_limit(const struct page *page);
void page_tracings(const struct page *page); /* the references' share of it; a part of it */
/* Papers' printed tables beside ours, and what the run says to their claims; nothing where no
 * table has a cell of the run. */
void page_papers(const struct page *page);

/* Methods without and with the sun's shadows; nothing where the run has no such pair. */
void page_pairs(const struct page *page);

/* The error maps of the shaders of needles, OUT/plots/shaders.png; nothing where no cell draws with
 * them. */
void page_shaders(const struct page *page);

/* Where the numbers come from: failures, provenance, how to cite, how to do it again. */
void page_failures(const struct page *page);
void page_provenance(const struct page *page);
void page_cite(const struct page *page);
void page_redo(const struct page *page);

#endif
