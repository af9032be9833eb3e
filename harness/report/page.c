/* The page: one HTML file that holds its style, its script, its data, its plots and its pictures.
 */
#include "report/page.h"

#include "base/file.h"
#include "base/plural.h"

#include <stdlib.h>
#include <string.h>

/* The script's parts, in this order. */
static const char *const scripts[] = {"kit.js",  "chart.js",   "plots.js", "limits.js", "bars.js",
                                      "cell.js", "compare.js", "table.js", "page.js"};

static enum status load_template(const struct page *page, const char *name, const char **text,
                                 struct error *error)
{
    char *data = NULL;
    size_t size = 0;
    const char *path = arena_printf(page->arena, "%s/reports/template/%s", data_folder(), name);
    enum status status = file_read(page->arena, path, (size_t)1 << 20, &data, &size, error);
    *text = data;
    return status;
}

static enum status load_templates(struct page *page, struct error *error)
{
    enum status status = load_template(page, "page.css", &page->style, error);
    if (status == STATUS_OK)
        status = load_template(page, "reading.html", &page->reading, error);
    page->script = "";
    for (size_t i = 0; i < sizeof scripts / sizeof *scripts && status == STATUS_OK; i++) {
        const char *part = NULL;
        status = load_template(page, scripts[i], &part, error);
        page->script = arena_printf(page->arena, "%s%s", page->script, part ? part : "");
    }
    return status;
}

void page_text(const struct page *page, const char *html)
{
    fputs(html, page->out);
}

void page_safe(const struct page *page, const char *text)
{
    html_put(page->out, text && *text ? text : "\u2013");
}

void page_live(const struct page *page, const char *id)
{
    fprintf(page->out, "<div class=\"live\" id=\"%s\"></div>\n", id);
}

static void put_fact(const struct page *page, const char *what, const char *value)
{
    page_text(page, "<div><dt>");
    page_safe(page, what);
    page_text(page, "</dt><dd>");
    page_safe(page, value);
    page_text(page, "</dd></div>\n");
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
    page_text(page, "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                    "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
                    "<meta name=\"color-scheme\" content=\"light dark\">\n<title>treeline: ");
    page_safe(page, page->book->run_name);
    page_text(page, "</title>\n<link rel=\"icon\" href=\"data:,\">\n<style>\n");
    theme_css(out);
    page_text(page, page->style);
    page_text(page,
              "</style>\n</head>\n<body>\n<header>\n<p class=\"kicker\">treeline report \u00b7 ");
    page_safe(page, page->book->run_name);
    page_text(page, "</p>\n<h1>Which way of drawing a forest is the fastest, at which error?</h1>\n"
                    "<p class=\"answer\">");
    answer_headline(page->book, out);
    page_text(page, "</p>\n");
}

static bool page_has(const struct page *page, enum figure_kind kind)
{
    for (size_t i = 0; i < page->figures->count; i++)
        if (page->figures->list[i].svg && page->figures->list[i].kind == kind)
            return true;
    return false;
}

/* Some scene shows how the error depends on the angle of view. */
static bool page_turns(const struct page *page)
{
    const struct book *book = page->book;
    for (size_t g = 0; g < book->groups_count; g++)
        if (views_go(book, &book->groups[g], VIEW_ELEVATION) ||
            views_go(book, &book->groups[g], VIEW_AZIMUTH))
            return true;
    return false;
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
    page_text(page, "<dl class=\"facts\">\n");
    put_fact(page, "measured", cells);
    put_fact(page, "repetitions, each a fresh process", repetitions);
    put_fact(page, "drawn by", book->rows_count ? book->rows[0].seen->renderer : NULL);
    put_fact(page, "on", from->cpu);
    put_fact(page, "started", plain_date(page->arena, from->started));
    page_text(page, "</dl>\n<nav aria-label=\"sections\"><a href=\"#trade\">error and time</a>"
                    "<a href=\"#growth\">more trees</a><a href=\"#distance\">distance</a>");
    page_text(page, page_turns(page) ? "<a href=\"#angle\">view angle</a>" : "");
    page_text(page, page_has(page, FIGURE_SWEEP) ? "<a href=\"#options\">options</a>" : "");
    page_text(page, "<a href=\"#cost\">memory and build</a>");
    page_text(page, book->run->calibrations_count ? "<a href=\"#limit\">limits</a>" : "");
    page_text(page, book->besides_count ? "<a href=\"#papers\">beside the paper</a>" : "");
    page_text(page, "<a href=\"#pictures\">pictures</a>"
                    "<a href=\"#results\">results</a><a href=\"#failures\">failures</a>"
                    "<a href=\"#provenance\">provenance</a><a href=\"#cite\">cite</a>"
                    "<a href=\"#redo\">redo</a></nav>\n");
    if (book->run->torn_lines)
        fprintf(page->out,
                "<p class=\"notice\">The run's file ended in a line that was cut; it was left "
                "out.</p>\n");
    if (page->no_plots) {
        page_text(page, "<p class=\"notice\">This page has no plots: ");
        page_safe(page, page->no_plots);
        page_text(page, "</p>\n");
    }
    page_text(page, "</header>\n<main>\n");
}

static void put_figure(const struct page *page, const struct figure *figure, const char *caption)
{
    page_text(page, "<figure class=\"figure\"><div class=\"wide\">");
    page_text(page, figure->svg);
    page_text(page, "</div><div class=\"narrow\">");
    page_text(page, figure->svg_narrow ? figure->svg_narrow : "");
    page_text(page, "</div><figcaption>");
    page_text(page, caption);
    fprintf(page->out,
            " <span class=\"no-print\"><a href=\"plots/%s.svg\">svg</a> \u00b7 "
            "<a href=\"plots/%s.png\">png</a> \u00b7 <a href=\"plots/%s.dat\">data</a> \u00b7 "
            "again: <code>cd plots &amp;&amp; gnuplot %s.gp</code></span></figcaption></figure>\n",
            figure->name, figure->name, figure->name, figure->name);
}

size_t page_figures(const struct page *page, enum figure_kind first, enum figure_kind last)
{
    static const char *const captions[] = {
        [FIGURE_TRADE_SAME] = "Error of the representation.",
        [FIGURE_TRADE_FULL] = "Total error.",
        [FIGURE_MASKS] = "Bars: across, from the best view to the worst; up, 95 % intervals. To "
                         "the left and below is better.",
        [FIGURE_MASKS_DISTANCE] = "One point a view; mask against rays.",
        [FIGURE_PAIRS] = "Open: without the sun's shadows; filled: with them.",
        [FIGURE_GROWTH] = ("Bars: 95 % intervals. Lines: a power law fitted to three or more tree "
                           "counts; N^(\u22121) means that twice the trees take twice the time."),
        [FIGURE_DISTANCE] = "One point a view; error of the representation.",
        [FIGURE_PACE] = "One point a view: the median over the rounds.",
        [FIGURE_ELEVATION] = "0: from the side, 90: from straight above. One point a view; error "
                             "of the representation.",
        [FIGURE_AZIMUTH] = "One point a view; error of the representation.",
        [FIGURE_LIMIT] = ("On the line a cell does all that the machine can of the resource that "
                          "binds it, which stands beside its method; on the line 1/10, a tenth."),
        [FIGURE_ROOFLINE] = ("The nearer the line, the nearer the limit; left of a bend that is "
                             "memory. Bars: 95 % intervals. A "
                             "point above it mixes large and small triangles."),
        [FIGURE_PAPER] = "On the line: the same ratio as printed. Bars: 95 % intervals.",
        [FIGURE_LAW] = "Times over each one's base row; lines: of three laws the one that fits "
                       "best.",
        [FIGURE_SWEEP] = "Along a line nothing else changes. Bars: 95 % intervals.",
        [FIGURE_MEMORY] = "What a method keeps, against its error: to the left is less.",
    };
    size_t shown = 0;
    for (size_t i = 0; i < page->figures->count; i++) {
        const struct figure *figure = &page->figures->list[i];
        if (!figure->svg || figure->kind < first || figure->kind > last)
            continue;
        if (!shown++)
            fprintf(page->out, "<div%s><div class=\"figures%s\">\n",
                    figure->kind >= FIGURE_ROOFLINE || figure->kind == FIGURE_PACE ||
                            (figure->kind >= FIGURE_MASKS && figure->kind <= FIGURE_PAIRS)
                        ? ""
                        : " class=\"still\"",
                    figure->kind == FIGURE_SWEEP ? " three" : "");
        put_figure(page, figure, captions[figure->kind]);
    }
    page_text(page, shown ? "</div></div>\n" : "");
    return shown;
}

static void put_trade(const struct page *page)
{
    const struct book *book = page->book;
    size_t *front = ARENA_ARRAY(book->arena, size_t, book->rows_count + 1), count;
    bool compared = answer_group(book, front, &count) != NULL;
    page_text(page, "<h2 id=\"trade\">Error against time</h2>\n");
    page_live(page, "live-trade");
    page_figures(page, FIGURE_TRADE_SAME, FIGURE_TRADE_FULL);
    answer_fronts(book, page->out);
    page_text(page, book->effects_differ || !compared
                        ? ""
                        : "<p>Every method drew all the effects that its scene asks for, so the "
                          "error of the representation and the total error are the same.</p>\n");
    page_text(page, "<details class=\"reading\"><summary>How to read the plots</summary>"
                    "<div class=\"inside\">\n");
    page_text(page, page->reading);
    page_text(page, "</div></details>\n");
    page_text(page, "<div class=\"live\"><h2 id=\"split\">Where the error comes from</h2>\n"
                    "<div id=\"live-split\"></div></div>\n");
}

static void put_masks(const struct page *page)
{
    if (!page_has(page, FIGURE_MASKS))
        return;
    page_text(page, "<h2 id=\"shadows\">Wrong shadows against their price</h2>\n<p>Of methods that "
                    "draw the sun's shadow as a mask: the share of the surface on which it is "
                    "not what rays say, whatever the light and the trees look like. Its price is "
                    "what a frame takes more than the same cell without shadows or, of methods "
                    "that always have them, than the triangles alone (method polygons), where the "
                    "run has one of them.</p>\n");
    page_figures(page, FIGURE_MASKS, FIGURE_MASKS);
    if (page_has(page, FIGURE_MASKS_DISTANCE))
        page_text(page, "<h3>Wrong shadows against distance</h3>\n");
    page_figures(page, FIGURE_MASKS_DISTANCE, FIGURE_MASKS_DISTANCE);
}

static void put_growth_and_distance(const struct page *page)
{
    page_text(page, "<h2 id=\"growth\">Frame rate against trees</h2>\n");
    page_live(page, "live-growth");
    if (!page_figures(page, FIGURE_GROWTH, FIGURE_GROWTH))
        page_text(page, "<p class=\"soft still\">No plot: no scene was drawn with two tree counts "
                        "or more.</p>\n");
    page_laws(page);
    page_text(page, "<h2 id=\"distance\">Error against distance</h2>\n");
    page_live(page, "live-distance");
    if (!page_figures(page, FIGURE_DISTANCE, FIGURE_DISTANCE))
        page_text(
            page,
            "<p class=\"soft still\">No plot: in every scene of this run the camera keeps its "
            "distance to the trees; a scene that walks or flies in shows how errors grow "
            "near by.</p>\n");
    if (page_has(page, FIGURE_PACE))
        page_text(page, "<h3>Frame time against distance</h3>\n");
    page_figures(page, FIGURE_PACE, FIGURE_PACE);
}

static void put_angles(const struct page *page)
{
    if (!page_turns(page))
        return;
    page_text(
        page,
        "<h2 id=\"angle\">Error against view angle</h2>\n<p>Of scenes whose camera goes up and "
        "around at one distance. A method with fixed directions of view errs most between "
        "them.</p>\n<div class=\"live\"><div id=\"live-elevation\"></div>"
        "<div id=\"live-azimuth\"></div></div>\n");
    page_figures(page, FIGURE_ELEVATION, FIGURE_AZIMUTH);
}

static void put_options(const struct page *page)
{
    if (!page_has(page, FIGURE_SWEEP))
        return;
    page_text(page, "<h2 id=\"options\">Error, time and memory against an option</h2>\n<p>The "
                    "options that this run gave three values or more, all else being equal; of "
                    "each scene the most trees.</p>\n");
    page_figures(page, FIGURE_SWEEP, FIGURE_SWEEP);
}

static void put_pictures(const struct page *page)
{
    const struct book *book = page->book;
    struct gallery gallery;
    gallery_start(&gallery, book, page->out_folder);
    page_text(page, "<h2 id=\"pictures\">Pictures</h2>\n");
    page_live(page, "live-compare");
    page_text(
        page,
        "<p>For every view: the ray-traced reference, what each method drew, and below it two maps "
        "against the reference with the same effects. Left, FLIP: dark where nobody would see a "
        "difference <span class=\"scale\" role=\"img\" aria-label=\"colour scale, 0 to 1\"></span> "
        "bright where everybody would. Right, coverage: blue where the method's trees are missing "
        "<span class=\"scale signed\" role=\"img\" aria-label=\"colour scale, -1 to 1\"></span> "
        "orange where they cover too much. A click opens the picture in full size.</p>\n");
    if (gallery.overview_only)
        fprintf(page->out,
                "<p>To keep the page small it has the pictures of the most trees of each "
                "scene%s%s; <code>./treeline render 'CELL'</code> draws any other.</p>\n",
                gallery.first_view_only ? ", of the first view" : "",
                gallery.front_only ? ", of the cells on the front" : "");
    for (size_t g = 0; g < book->groups_count; g++) {
        if (!gallery_shows(&gallery, &book->groups[g]))
            continue;
        fprintf(page->out, "<details id=\"pictures-%s\"><summary>", book->groups[g].slug);
        page_safe(page, book->groups[g].title);
        page_text(page, "</summary><div class=\"inside\">\n");
        gallery_group(&gallery, &book->groups[g], page->out);
        page_text(page, "</div></details>\n");
    }
    if (gallery.missing)
        fprintf(page->out,
                "<p class=\"notice\">%zu picture%s could not be shown; each place says why.</p>\n",
                gallery.missing, plural(gallery.missing));
}

/* In a script element no "<" may stand; in JSON it occurs in texts alone. */
static void put_data(const struct page *page)
{
    struct arena *scratch = arena_create(0);
    page_text(page, "<script type=\"application/json\" id=\"data\">");
    for (const char *c = data_json(page->book, scratch); *c; c++)
        if (*c == '<')
            page_text(page, "\\u003c");
        else
            fputc(*c, page->out);
    page_text(page, "</script>\n");
    arena_destroy(scratch);
}

static void put_page(const struct page *page)
{
    put_head(page);
    put_facts(page);
    page_live(page, "live-controls");
    put_trade(page);
    put_masks(page);
    page_pairs(page);
    put_growth_and_distance(page);
    put_angles(page);
    put_options(page);
    page_cost(page);
    page_limit(page);
    page_papers(page);
    page_shaders(page);
    page_text(page, "<h2 id=\"overall\">Each method over all scenes and tree counts</h2>\n");
    answer_overall(page->book, page->out);
    put_pictures(page);
    page_results(page);
    page_failures(page);
    page_provenance(page);
    page_cite(page);
    page_redo(page);
    page_text(page,
              "</main>\n<footer><p>Made by <code>treeline report</code> from the run's stored "
              "results.</p></footer>\n");
    put_data(page);
    page_text(page, "<script>\n");
    page_text(page, page->script);
    page_text(page, "</script>\n</body>\n</html>\n");
}

enum status page_write(const struct book *book, const struct figures *figures, const char *no_plots,
                       const char *out_folder, struct error *error)
{
    struct page page = {.book = book,
                        .figures = figures,
                        .no_plots = no_plots,
                        .out_folder = out_folder,
                        .arena = book->arena};
    enum status status = load_templates(&page, error);
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
