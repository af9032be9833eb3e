/* The page: one HTML file that holds its style, its script, its plots and its pictures. */
#include "report/book.h"

#include "base/file.h"
#include "base/plural.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct page {
    const struct book *book;
    const struct plots *plots;
    const char *no_plots; /* why there are no plots; NULL */
    const char *out_folder;
    struct arena *arena;
    FILE *out;
    const char *style, *script, *reading;
};

static enum status load_template(struct page *page, const char *name, const char **text,
                                 struct error *error)
{
    char *data = NULL;
    size_t size = 0;
    const char *path = arena_printf(page->arena, "%s/reports/template/%s", data_folder(), name);
    enum status status = file_read(page->arena, path, (size_t)1 << 20, &data, &size, error);
    *text = data;
    return status;
}

static void put(const struct page *page, const char *text)
{
    fputs(text, page->out);
}

static void put_safe(const struct page *page, const char *text)
{
    html_put(page->out, text && *text ? text : "\u2013");
}

static void put_label(const struct page *page, const struct row *row)
{
    fprintf(page->out,
            "<svg class=\"mark\" viewBox=\"-1.5 -1.5 3 3\" aria-hidden=\"true\" "
            "style=\"color:var(--%s)\">%s</svg>",
            tint_variable(tint_method(page->book, row->method_index)),
            symbol_html(page->book, row->method_index));
    html_put(page->out, row->label);
}

static void put_fact(const struct page *page, const char *what, const char *value)
{
    put(page, "<div><dt>");
    put_safe(page, what);
    put(page, "</dt><dd>");
    put_safe(page, value);
    put(page, "</dd></div>\n");
}

/* "2026-11-22T12:00:00Z" as "2026-11-22 12:00 UTC"; anything else as it is. */
static const char *plain_date(struct arena *arena, const char *iso)
{
    if (!iso || strlen(iso) != 20 || iso[10] != 'T' || iso[19] != 'Z')
        return iso;
    return arena_printf(arena, "%.10s %.5s UTC", iso, iso + 11);
}

static void put_head(const struct page *page)
{
    FILE *out = page->out;
    put(page, "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
              "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
              "<meta name=\"color-scheme\" content=\"light dark\">\n<title>treeline: ");
    put_safe(page, page->book->run_name);
    put(page, "</title>\n<link rel=\"icon\" href=\"data:,\">\n<style>\n");
    theme_css(out);
    put(page, page->style);
    put(page, "</style>\n</head>\n<body>\n<header>\n<p class=\"kicker\">treeline report \u00b7 ");
    put_safe(page, page->book->run_name);
    put(page, "</p>\n<h1>Which way of drawing a forest is the fastest, at which error?</h1>\n"
              "<p class=\"answer\">");
    answer_headline(page->book, out);
    put(page, "</p>\n");
}

static void put_facts(const struct page *page)
{
    const struct book *book = page->book;
    const struct provenance *from = &book->run->provenance;
    size_t failed = 0, seen = 0;
    for (size_t i = 0; i < book->rows_count; i++) {
        failed += !book->rows[i].ok;
        seen += book->rows[i].summary->repetitions + book->rows[i].summary->failures;
    }
    char cells[96];
    snprintf(cells, sizeof cells, "%zu cell%s, %zu failed", book->rows_count,
             plural(book->rows_count), failed);
    char repetitions[64];
    snprintf(repetitions, sizeof repetitions, "%zu", seen);
    put(page, "<dl class=\"facts\">\n");
    put_fact(page, "measured", cells);
    put_fact(page, "repetitions, each a fresh process", repetitions);
    put_fact(page, "drawn by", book->rows_count ? book->rows[0].seen->renderer : NULL);
    put_fact(page, "on", from->cpu);
    put_fact(page, "started", plain_date(page->arena, from->started));
    put(page, "</dl>\n<nav aria-label=\"sections\"><a href=\"#trade\">error and time</a>"
              "<a href=\"#growth\">more trees</a><a href=\"#distance\">distance</a>"
              "<a href=\"#pictures\">pictures</a><a href=\"#results\">results</a>"
              "<a href=\"#cost\">memory and build</a><a href=\"#failures\">failures</a>"
              "<a href=\"#provenance\">provenance</a><a href=\"#redo\">redo</a></nav>\n");
    if (book->run->torn_lines)
        fprintf(page->out,
                "<p class=\"notice\">The run's file ended in a line that was cut; it was left "
                "out.</p>\n");
    if (page->no_plots) {
        put(page, "<p class=\"notice\">This page has no plots: ");
        put_safe(page, page->no_plots);
        put(page, "</p>\n");
    }
    put(page, "</header>\n<main>\n");
}

static void put_figure(const struct page *page, const struct figure *figure, const char *caption)
{
    if (!figure->svg)
        return;
    put(page, "<figure class=\"figure\"><div class=\"wide\">");
    put(page, figure->svg);
    put(page, "</div><div class=\"narrow\">");
    put(page, figure->svg_narrow ? figure->svg_narrow : "");
    put(page, "</div><figcaption>");
    put(page, caption);
    fprintf(page->out,
            " <span class=\"no-print\"><a href=\"plots/%s.svg\">svg</a> \u00b7 "
            "<a href=\"plots/%s.png\">png</a> \u00b7 <a href=\"plots/%s.dat\">data</a></span>"
            "</figcaption></figure>\n",
            figure->name, figure->name, figure->name);
}

/* Open sections: the most trees of each family. */
static bool is_last_of_family(const struct book *book, size_t g)
{
    return g + 1 == book->groups_count || book->groups[g + 1].family != book->groups[g].family;
}

static void put_trade(const struct page *page)
{
    const struct book *book = page->book;
    put(page, "<h2 id=\"trade\">Error against time</h2>\n");
    answer_fronts(book, page->out);
    put(page, book->effects_differ
                  ? "<p>Left: the error of the representation (reference with the same effects as "
                    "the method). Right: the total error (reference with all effects that the "
                    "scene asks for).</p>\n"
                  : "<p>Every method drew all the effects that its scene asks for, so the error of "
                    "the representation and the total error are the same.</p>\n");
    for (size_t g = 0; g < book->groups_count && page->plots; g++) {
        const struct group *group = &book->groups[g];
        fprintf(page->out, "<details class=\"plots\" id=\"trade-%s\"%s><summary>", group->slug,
                is_last_of_family(book, g) ? " open" : "");
        put_safe(page, group->title);
        put(page, "</summary><div class=\"inside\"><div class=\"figures\">\n");
        for (size_t k = 0; k < 4; k++) {
            static const char *const captions[] = {
                "FLIP, error of the representation.", "FLIP, total error.",
                "RMSE, error of the representation.", "RMSE, total error."};
            put_figure(page, &page->plots->trade[g][k], captions[k]);
        }
        put(page, page->plots->trade[g][0].svg
                      ? "</div></div></details>\n"
                      : "<p class=\"soft\">No plot: no cell has both a frame time and an error."
                        "</p></div></div></details>\n");
    }
    put(page, "<h3>How to read the plots</h3>\n");
    put(page, page->reading);
    put(page, "<h3>Each method over all scenes and tree counts</h3>\n");
    answer_overall(book, page->out);
    put(page, "<p class=\"soft\">Times are ratios to the fastest method of the same scene and tree "
              "count, combined by their geometric mean over the cells that succeeded; frame rates "
              "are never averaged. Mind the last column before comparing.</p>\n");
}

static size_t put_figures(const struct page *page, const struct figure *figures, size_t count,
                          const char *caption)
{
    size_t shown = 0;
    for (size_t i = 0; i < count; i++)
        shown += figures[i].svg != NULL;
    if (shown == 0)
        return 0;
    put(page, "<div class=\"figures\">\n");
    for (size_t i = 0; i < count; i++)
        put_figure(page, &figures[i], caption);
    put(page, "</div>\n");
    return shown;
}

static void put_growth_and_distance(const struct page *page)
{
    const struct book *book = page->book;
    put(page, "<h2 id=\"growth\">Frame rate against trees</h2>\n");
    if (page->plots && put_figures(page, page->plots->growth, book->families_count,
                                   "Bars: 95 % intervals. Lines: a power law fitted to three or "
                                   "more tree counts."))
        put(page, "<p>In the legend, N^(\u22121) means that twice the trees take twice the time; "
                  "an exponent near 0 means that the trees hardly matter.</p>\n");
    else
        put(page, "<p class=\"soft\">No scene was drawn with two tree counts or more.</p>\n");
    put(page, "<h2 id=\"distance\">Error against distance</h2>\n");
    if (!page->plots || !put_figures(page, page->plots->distance, book->groups_count,
                                     "One point a view; error of the representation."))
        put(page, "<p class=\"soft\">In every scene of this run the camera keeps its distance to "
                  "the trees; a scene that walks or flies in shows how errors grow near by.</p>\n");
}

static void put_pictures(const struct page *page)
{
    const struct book *book = page->book;
    struct gallery gallery;
    gallery_start(&gallery, book, page->out_folder);
    put(page,
        "<h2 id=\"pictures\">Pictures</h2>\n<p>For every view: the ray-traced reference, what "
        "each method drew, and below it the FLIP map against the reference with the same "
        "effects: dark where nobody would see a difference "
        "<span class=\"scale\" role=\"img\" aria-label=\"colour scale, 0 to 1\"></span> "
        "bright where everybody would. A click opens the picture in full size.</p>\n");
    for (size_t g = 0; g < book->groups_count; g++) {
        fprintf(page->out, "<details id=\"pictures-%s\"><summary>", book->groups[g].slug);
        put_safe(page, book->groups[g].title);
        put(page, "</summary><div class=\"inside\">\n");
        gallery_group(&gallery, &book->groups[g], page->out);
        put(page, "</div></details>\n");
    }
    if (gallery.missing)
        fprintf(page->out,
                "<p class=\"notice\">%zu picture%s could not be shown; each place says why.</p>\n",
                gallery.missing, plural(gallery.missing));
}

static void put_number_cell(const struct page *page, const struct row *row,
                            const struct shown *shown)
{
    double value = row->values[shown->column] * shown->scale;
    fprintf(page->out, "<td class=\"n\" data-v=\"%s\">", number_exact(value).text);
    if (!row->ok && shown->column == COLUMN_frame_seconds)
        fprintf(page->out, "<span class=\"bad\">%s</span>", status_word(row->seen->status));
    else
        put(page, value >= 1e5 ? number_short(value, 3).text : number_plain(value, 3).text);
    if (row->ok && shown->column == COLUMN_frame_seconds)
        fprintf(page->out, "<span class=\"range\">%s to %s</span>",
                number_plain(row->values[COLUMN_frame_seconds_low] * shown->scale, 3).text,
                number_plain(row->values[COLUMN_frame_seconds_high] * shown->scale, 3).text);
    put(page, "</td>");
}

static void put_results(const struct page *page)
{
    const struct book *book = page->book;
    put(page,
        "<h2 id=\"results\">Results</h2>\n<p>A heading sorts. Tinted rows are on the front of "
        "frame time and FLIP. Under the frame time (median over repetitions of each one's "
        "median) stands its 95 % bootstrap interval, with fewer than three repetitions their "
        "range. Errors are means over the views. Every number, and many more: "
        "<a href=\"tables/results.csv\">CSV</a>, <a href=\"tables/results.md\">Markdown</a>, "
        "<a href=\"tables/results.tex\">LaTeX</a>.</p>\n<div class=\"scroll\">"
        "<table class=\"results\"><thead><tr><th scope=\"col\"><button>scene</button></th>"
        "<th scope=\"col\" class=\"n\"><button>trees</button></th>"
        "<th scope=\"col\"><button>method</button></th>");
    for (size_t c = 0; c < shown_count; c++) {
        put(page, "<th scope=\"col\" class=\"n\"><button title=\"");
        put_safe(page, column_table[shown_table[c].column].doc);
        put(page, "\">");
        put_safe(page, shown_table[c].heading);
        fprintf(page->out, *shown_table[c].unit ? " [%s]</button></th>" : "%s</button></th>",
                shown_table[c].unit);
    }
    put(page, "</tr></thead><tbody>\n");
    for (size_t i = 0; i < book->rows_count; i++) {
        const struct row *row = &book->rows[i];
        fprintf(page->out, "<tr%s><td class=\"scene\">",
                !row->ok                 ? " class=\"failed\""
                : row->summary->on_front ? " class=\"front\""
                                         : "");
        put_safe(page, book->families[book->groups[row->group].family]);
        fprintf(page->out, "</td><td class=\"n\" data-v=\"%zu\">%s</td><td>", row->trees,
                number_plain((double)row->trees, 15).text);
        put_label(page, row);
        put(page, "</td>");
        for (size_t c = 0; c < shown_count; c++)
            put_number_cell(page, row, &shown_table[c]);
        put(page, "</tr>\n");
    }
    put(page, "</tbody></table></div>\n");
}

/* Columns of the cost table; a bar shows the share of the column's largest value. */
static const struct shown cost_table[] = {
    {COLUMN_build_seconds, "prepare, cold", "s", 1},
    {COLUMN_plant_seconds, "plants built", "s", 1},
    {COLUMN_scene_seconds, "scene loaded", "s", 1},
    {COLUMN_first_frame_seconds, "first frame", "ms", 1e3},
    {COLUMN_relight_seconds, "sun moved", "ms", 1e3},
    {COLUMN_host_bytes, "method's memory", "MB", 1e-6},
    {COLUMN_device_bytes, "GL objects", "MB", 1e-6},
    {COLUMN_plant_bytes, "plants", "MB", 1e-6},
    {COLUMN_peak_bytes, "peak of the process", "MB", 1e-6},
};
enum { COSTS_COUNT = sizeof cost_table / sizeof *cost_table };

static double largest(const struct book *book, enum column_index column)
{
    double most = 0;
    for (size_t i = 0; i < book->rows_count; i++)
        most = fmax(most, book->rows[i].values[column]);
    return most;
}

static void put_cost(const struct page *page)
{
    const struct book *book = page->book;
    put(page, "<h2 id=\"cost\">Memory and build time</h2>\n<p>What a method needs before its first "
              "picture, measured once and cold, and what it keeps. Bars are shares of the largest "
              "value of the column.</p>\n<div class=\"scroll\"><table class=\"cost\"><thead><tr>"
              "<th scope=\"col\">scene</th><th scope=\"col\" class=\"n\">trees</th>"
              "<th scope=\"col\">method</th>");
    for (size_t c = 0; c < COSTS_COUNT; c++)
        fprintf(page->out, "<th scope=\"col\" class=\"n\">%s [%s]</th>", cost_table[c].heading,
                cost_table[c].unit);
    put(page, "</tr></thead><tbody>\n");
    for (size_t i = 0; i < book->rows_count; i++) {
        const struct row *row = &book->rows[i];
        if (!row->ok)
            continue;
        put(page, "<tr><td class=\"scene\">");
        put_safe(page, book->families[book->groups[row->group].family]);
        fprintf(page->out, "</td><td class=\"n\">%s</td><td>",
                number_plain((double)row->trees, 15).text);
        put_label(page, row);
        put(page, "</td>");
        for (size_t c = 0; c < COSTS_COUNT; c++) {
            double value = row->values[cost_table[c].column];
            double most = largest(book, cost_table[c].column);
            double part = value > 0 && most > 0 ? 100 * value / most : 0;
            fprintf(page->out, "<td class=\"n bar\" style=\"--part:%.1f%%\">%s</td>", part,
                    number_plain(value * cost_table[c].scale, 3).text);
        }
        put(page, "</tr>\n");
    }
    put(page, "</tbody></table></div>\n");
}

static void put_failures(const struct page *page)
{
    const struct run *run = page->book->run;
    size_t failures = 0;
    put(page, "<h2 id=\"failures\">Failures</h2>\n");
    for (size_t i = 0; i < run->results_count; i++) {
        const struct result *result = &run->results[i];
        if (result->status == STATUS_OK)
            continue;
        put(page, failures++ ? ""
                             : "<p>A failed repetition gives no number to any table or ratio. "
                               "Its command draws it again alone.</p>\n");
        put(page, "<h4><span class=\"bad\">");
        put(page, status_word(result->status));
        fprintf(page->out, "</span> <span class=\"soft\">repetition %d", result->repetition);
        if (result->signal)
            fprintf(page->out, ", signal %d (%s)", result->signal, strsignal(result->signal));
        put(page, "</span></h4>\n<p>");
        put_safe(page, result->message);
        put(page, "</p>\n<pre>./treeline run --cell '");
        put_safe(page, result->cell.name);
        put(page, "' ");
        html_put(page->out, run->provenance.settings);
        put(page, "</pre>\n");
    }
    if (failures == 0)
        put(page, "<p>None: every repetition of every cell succeeded.</p>\n");
}

static void put_pair(const struct page *page, const char *what, const char *value)
{
    put(page, "<dt>");
    put_safe(page, what);
    put(page, "</dt><dd>");
    put_safe(page, value);
    put(page, "</dd>\n");
}

static void put_provenance(const struct page *page)
{
    const struct book *book = page->book;
    const struct provenance *from = &book->run->provenance;
    const struct result *seen = book->rows_count ? book->rows[0].seen : NULL;
    struct arena *arena = page->arena;
    put(page, "<h2 id=\"provenance\">Provenance</h2>\n<dl class=\"kv\">\n");
    put_pair(page, "run", book->run->folder);
    put_pair(page, "plan", from->plan);
    put_pair(page, "command", from->command);
    put_pair(page, "started", from->started);
    put_pair(page, "host", from->host);
    put_pair(page, "CPU",
             arena_printf(arena, "%s, %d core%s", from->cpu ? from->cpu : "unknown", from->cores,
                          plural((size_t)from->cores)));
    put_pair(page, "memory",
             arena_printf(arena, "%s GB", number_plain(from->memory_bytes * 1e-9, 3).text));
    put_pair(page, "system", from->os);
    put_pair(page, "kernel", from->kernel);
    put_pair(page, "GL",
             seen ? arena_printf(arena, "%s; %s; %s", seen->backend ? seen->backend : "none",
                                 seen->renderer ? seen->renderer : "\u2013",
                                 seen->gl_version ? seen->gl_version : "\u2013")
                  : NULL);
    put_pair(page, "threads", seen ? arena_printf(arena, "%d", seen->threads) : NULL);
    put_pair(page, "libraries", from->libraries);
    put_pair(page, "compiler", from->compiler);
    put_pair(page, "flags", from->flags);
    put_pair(page, "revision", from->revision);
    put_pair(page, "seed", arena_printf(arena, "%llu", (unsigned long long)from->seed));
    put_pair(page, "rounds", number_plain(from->rounds, 6).text);
    put_pair(page, "measured per repetition",
             arena_printf(arena, "%s s", number_plain(from->frame_seconds, 3).text));
    put_pair(page, "standard error asked of references",
             number_plain(from->reference_error, 3).text);
    put(page, "</dl>\n");
}

static void put_redo(const struct page *page)
{
    const struct book *book = page->book;
    put(page, "<h2 id=\"redo\">How to do it again</h2>\n<p>The whole benchmark, from a clean "
              "clone:</p>\n<pre>make bench</pre>\n<p>This run, on another machine or after a "
              "change:</p>\n<pre>");
    put_safe(page, book->run->provenance.command);
    put(page, "</pre>\n<p>This page and its tables from the stored results alone; nothing is "
              "measured:</p>\n<pre>./treeline report ");
    put_safe(page, book->run->folder);
    put(page, "</pre>\n");
    if (book->rows_count) {
        put(page, "<p>One cell alone, by the name that the CSV gives it:</p>\n<pre>./treeline run "
                  "--cell '");
        put_safe(page, book->rows[0].seen->cell.name);
        put(page, "' ");
        html_put(page->out, book->run->provenance.settings);
        put(page, "</pre>\n");
    }
    put(page, "<p>A plot, after editing its script: <code>cd plots; gnuplot NAME.gp</code>.</p>\n");
}

static void put_page(const struct page *page)
{
    put_head(page);
    put_facts(page);
    put_trade(page);
    put_growth_and_distance(page);
    put_pictures(page);
    put_results(page);
    put_cost(page);
    put_failures(page);
    put_provenance(page);
    put_redo(page);
    put(page, "</main>\n<footer><p>Made by <code>treeline report</code> from the run's stored "
              "results.</p></footer>\n<script>\n");
    put(page, page->script);
    put(page, "</script>\n</body>\n</html>\n");
}

enum status page_write(const struct book *book, const struct plots *plots, const char *no_plots,
                       const char *out_folder, struct error *error)
{
    struct page page = {.book = book,
                        .plots = plots,
                        .no_plots = no_plots,
                        .out_folder = out_folder,
                        .arena = book->arena};
    enum status status = load_template(&page, "page.css", &page.style, error);
    if (status == STATUS_OK)
        status = load_template(&page, "page.js", &page.script, error);
    if (status == STATUS_OK)
        status = load_template(&page, "reading.html", &page.reading, error);
    if (status == STATUS_OK)
        status = file_make_folder(arena_printf(page.arena, "%s/pictures", out_folder), error);
    if (status != STATUS_OK)
        return status;
    char *text = NULL;
    size_t size = 0;
    const char *path = arena_printf(page.arena, "%s/index.html", out_folder);
    page.out = open_memstream(&text, &size);
    if (!page.out)
        return error_errno(error, STATUS_MEMORY, "%s", path);
    put_page(&page);
    return sheet_write(page.out, &text, &size, path, error);
}
