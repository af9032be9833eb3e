/* Where the page's numbers come from: failures, provenance, how to cite, how to do it again. */
#include "report/page.h"

#include "base/plural.h"
#include "method/method.h"

#include <string.h>

/* Failed repetitions that are told one by one. */
enum { FAILURES_MAX = 200 };

/* Of this cell, the first that failed in this way; later ones are counted with it. */
static bool is_told_before(const struct summary *summary, size_t k)
{
    const struct result *result = summary->results[k];
    for (size_t i = 0; i < k; i++)
        if (summary->results[i]->status == result->status &&
            strcmp(summary->results[i]->message, result->message) == 0)
            return true;
    return false;
}

static void put_failure(const struct page *page, size_t row, size_t k)
{
    const struct summary *summary = page->book->rows[row].summary;
    size_t total = summary->repetitions + summary->failures, alike = 0;
    const struct result *result = summary->results[k];
    for (size_t i = k; i < total; i++)
        alike += summary->results[i]->status == result->status &&
                 strcmp(summary->results[i]->message, result->message) == 0;
    page_text(page, "<h4><span class=\"bad\">");
    page_text(page, status_word(result->status));
    fprintf(page->out, "</span> <span class=\"soft\">%zu of %zu repetition%s, first in %d", alike,
            total, plural(total), result->repetition);
    if (result->signal)
        fprintf(page->out, ", signal %d (%s)", result->signal, strsignal(result->signal));
    page_text(page, "</span></h4>\n<p>");
    page_safe(page, result->message);
    page_text(page, "</p>\n<pre>./treeline run --cell '");
    page_safe(page, result->cell.name);
    page_text(page, "' ");
    html_put(page->out, page->book->run->provenance.settings);
    page_text(page, "</pre>\n");
}

void page_failures(const struct page *page)
{
    const struct book *book = page->book;
    size_t told = 0;
    page_text(page, "<h2 id=\"failures\">Failures</h2>\n");
    for (size_t r = 0; r < book->rows_count; r++) {
        const struct summary *summary = book->rows[r].summary;
        for (size_t k = 0; summary->failures && k < summary->repetitions + summary->failures; k++) {
            if (summary->results[k]->status == STATUS_OK || is_told_before(summary, k))
                continue;
            page_text(page, told ? ""
                                 : "<p>A failed repetition gives no number to any table or ratio. "
                                   "Its command draws it again alone.</p>\n");
            if (told++ < FAILURES_MAX)
                put_failure(page, r, k);
        }
    }
    if (told > FAILURES_MAX)
        fprintf(page->out,
                "<p>And %zu more; <a href=\"tables/results.csv\">the CSV</a> has the cells that "
                "never succeeded.</p>\n",
                told - FAILURES_MAX);
    if (told == 0)
        page_text(page, "<p>None: every repetition of every cell succeeded.</p>\n");
}

static void put_pair(const struct page *page, const char *what, const char *value)
{
    page_text(page, "<dt>");
    page_safe(page, what);
    page_text(page, "</dt><dd>");
    page_safe(page, value);
    page_text(page, "</dd>\n");
}

void page_provenance(const struct page *page)
{
    const struct book *book = page->book;
    const struct provenance *from = &book->run->provenance;
    const struct result *seen = book->rows_count ? book->rows[0].seen : NULL;
    struct arena *arena = page->arena;
    page_text(page, "<h2 id=\"provenance\">Provenance</h2>\n<dl class=\"kv\">\n");
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
    page_text(page, "</dl>\n");
}

/* The sources that the used methods name, each once. */
static void put_sources(const struct page *page)
{
    for (size_t m = 0; methods_builtin[m]; m++)
        for (size_t i = 0; i < page->book->methods_count; i++) {
            const char *source = methods_builtin[m]->source;
            if (!source || !*source ||
                strcmp(methods_builtin[m]->name, page->book->methods[i]) != 0)
                continue;
            page_text(page, "<li><b>");
            page_safe(page, methods_builtin[m]->name);
            page_text(page, "</b> ");
            page_safe(page, source);
            page_text(page, "</li>\n");
        }
}

void page_cite(const struct page *page)
{
    const struct provenance *from = &page->book->run->provenance;
    page_text(page, "<h2 id=\"cite\">How to cite</h2>\n<p>The numbers of this page:</p>\n"
                    "<pre>@misc{treeline-");
    page_safe(page, page->book->run_name);
    page_text(page, ",\n  title = {treeline: ways of drawing a forest, measured against a "
                    "ray-traced reference},\n  year = {");
    fprintf(page->out, "%.4s", from->started ? from->started : "");
    page_text(page, "},\n  note = {run ");
    page_safe(page, page->book->run_name);
    page_text(page, ", revision ");
    page_safe(page, from->revision);
    page_text(page, ", ");
    page_safe(page, from->cpu);
    page_text(page, ", ");
    page_safe(page, from->started);
    page_text(page, "}\n}</pre>\n<p>The methods and metrics that stand behind them:</p>\n<ul>\n");
    put_sources(page);
    page_text(
        page,
        "<li><b>FLIP</b> Andersson, Nilsson, Akenine-M\u00f6ller, Oskarsson, \u00c5str\u00f6m, "
        "Fairchild: FLIP: A Difference Evaluator for Alternating Images. 2020, "
        "doi:10.1145/3406183</li>\n<li><b>SSIM</b> Wang, Bovik, Sheikh, Simoncelli: Image "
        "Quality Assessment: From Error Visibility to Structural Similarity. 2004, "
        "doi:10.1109/TIP.2003.819861</li>\n<li><b>intervals</b> Efron: Better Bootstrap "
        "Confidence Intervals. 1987, doi:10.2307/2289144</li>\n</ul>\n");
}

void page_redo(const struct page *page)
{
    const struct book *book = page->book;
    page_text(page, "<h2 id=\"redo\">How to do it again</h2>\n<p>The whole benchmark, from a clean "
                    "clone:</p>\n<pre>make bench</pre>\n<p>This run, on another machine or after a "
                    "change:</p>\n<pre>");
    page_safe(page, book->run->provenance.command);
    page_text(page, "</pre>\n<p>This page, its figures and tables from the stored results alone; "
                    "nothing is measured:</p>\n<pre>./treeline report ");
    page_safe(page, book->run->folder);
    page_text(page, "</pre>\n");
    if (book->rows_count) {
        page_text(page,
                  "<p>One cell alone, by the name that the CSV gives it:</p>\n<pre>./treeline "
                  "run --cell '");
        page_safe(page, book->rows[0].seen->cell.name);
        page_text(page, "' ");
        html_put(page->out, book->run->provenance.settings);
        page_text(page, "</pre>\n");
    }
    if (page->figures->count)
        page_text(page, "<p>The static plots, after editing their scripts (one of them: "
                        "<code>gnuplot NAME.gp</code>):</p>\n<pre>cd plots &amp;&amp; gnuplot "
                        "all.gp</pre>\n");
    page_text(page, "<p class=\"live\">Under each interactive figure stands the command that "
                    "measures its cells again.</p>\n");
}
