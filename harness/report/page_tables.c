/* The page's tables: all cells, memory and build time, growth laws. */
#include "report/page.h"

#include <math.h>

static void put_number_cell(const struct page *page, const struct row *row,
                            const struct shown *shown)
{
    double value = row->values[shown->column] * shown->scale;
    fprintf(page->out, "<td class=\"n\" data-v=\"%s\">", number_exact(value).text);
    if (!row->ok && shown->column == COLUMN_frame_seconds)
        fprintf(page->out, "<span class=\"bad\">%s</span>", status_word(row->seen->status));
    else
        page_text(page, value >= 1e5 ? number_short(value, 3).text : number_plain(value, 3).text);
    if (row->ok && shown->column == COLUMN_frame_seconds)
        fprintf(page->out, "<span class=\"range\">%s to %s</span>",
                number_plain(row->values[COLUMN_frame_seconds_low] * shown->scale, 3).text,
                number_plain(row->values[COLUMN_frame_seconds_high] * shown->scale, 3).text);
    if (shown->column == COLUMN_limit_fraction && row->summary->limit.resource)
        fprintf(page->out, "<span class=\"range\">%s</span>",
                limit_word(row->summary->limit.resource));
    page_text(page, "</td>");
}

/* Rows that stand on the page without its script. */
enum { ROWS_MAX = 300 };

/* All rows of a short run; of a long one those of the overview, as many as may. */
static bool is_static(const struct page *page, size_t row, size_t *count)
{
    const struct book *book = page->book;
    bool wanted = book->rows_count <= ROWS_MAX || book_is_overview(book, book->rows[row].group);
    if (!wanted || *count == ROWS_MAX)
        return false;
    *count += 1;
    return true;
}

static void put_left_out(const struct page *page, size_t count)
{
    if (count < page->book->rows_count)
        fprintf(page->out,
                "<p class=\"still\">%zu of %zu cells stand here, those with the most trees; "
                "<a href=\"tables/results.csv\">the CSV</a> has all, and so has this page with "
                "JavaScript.</p>\n",
                count, page->book->rows_count);
}

static void put_results_head(const struct page *page)
{
    page_text(page, "<div class=\"scroll\"><table class=\"results\"><thead><tr>"
                    "<th scope=\"col\"><button>scene</button></th>"
                    "<th scope=\"col\" class=\"n\"><button>trees</button></th>"
                    "<th scope=\"col\"><button>method</button></th>");
    for (size_t c = 0; c < page->book->shown_count; c++) {
        page_text(page, "<th scope=\"col\" class=\"n\"><button title=\"");
        page_safe(page, column_table[page->book->shown[c].column].doc);
        page_text(page, "\">");
        page_safe(page, page->book->shown[c].heading);
        fprintf(page->out, *page->book->shown[c].unit ? " [%s]</button></th>" : "%s</button></th>",
                page->book->shown[c].unit);
    }
    page_text(page, "</tr></thead><tbody>\n");
}

static void put_row_start(const struct page *page, const struct row *row)
{
    page_safe(page, page->book->families[page->book->groups[row->group].family]);
    fprintf(page->out, "</td><td class=\"n\" data-v=\"%zu\">%s</td><td>", row->trees,
            number_plain((double)row->trees, 15).text);
}

void page_results(const struct page *page)
{
    const struct book *book = page->book;
    page_text(
        page,
        "<h2 id=\"results\">Results</h2>\n<p>A heading sorts, a name leads to all that is known "
        "of the cell. Tinted rows are on the front of frame time and FLIP. Under the frame time "
        "(median over repetitions of each one's median) stands its 95 % bootstrap interval, with "
        "fewer than three repetitions their range. Errors are means over the views. Every number, "
        "and many more: <a href=\"tables/results.csv\">CSV</a>, "
        "<a href=\"tables/results.md\">Markdown</a>, <a href=\"tables/results.tex\">LaTeX</a>.</p>"
        "\n");
    page_live(page, "live-filter");
    put_results_head(page);
    size_t count = 0;
    for (size_t i = 0; i < book->rows_count; i++) {
        const struct row *row = &book->rows[i];
        if (!is_static(page, i, &count))
            continue;
        fprintf(page->out, "<tr id=\"cell-%zu\"%s><td class=\"scene\">", i + 1,
                !row->ok                 ? " class=\"failed\""
                : row->summary->on_front ? " class=\"front\""
                                         : "");
        put_row_start(page, row);
        fprintf(page->out, "<a class=\"cell\" href=\"#cell-%zu\">", i + 1);
        html_put_label(page->out, book, row);
        page_text(page, "</a></td>");
        for (size_t c = 0; c < book->shown_count; c++)
            put_number_cell(page, row, &book->shown[c]);
        page_text(page, "</tr>\n");
    }
    page_text(page, "</tbody></table></div>\n");
    put_left_out(page, count);
    page_live(page, "live-more");
    page_live(page, "live-cell");
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

void page_cost(const struct page *page)
{
    const struct book *book = page->book;
    page_text(page, "<h2 id=\"cost\">Memory and build time</h2>\n<p>What a method needs before its "
                    "first picture, measured once and cold, and what it keeps.</p>\n");
    page_live(page, "live-cost");
    page_figures(page, FIGURE_MEMORY, FIGURE_MEMORY);
    page_text(page, "<div class=\"still\"><p>Bars are shares of the largest value of the "
                    "column.</p><div class=\"scroll\"><table class=\"cost\"><thead><tr>"
                    "<th scope=\"col\">scene</th><th scope=\"col\" class=\"n\">trees</th>"
                    "<th scope=\"col\">method</th>");
    for (size_t c = 0; c < COSTS_COUNT; c++)
        fprintf(page->out, "<th scope=\"col\" class=\"n\">%s [%s]</th>", cost_table[c].heading,
                cost_table[c].unit);
    page_text(page, "</tr></thead><tbody>\n");
    double most[COSTS_COUNT];
    for (size_t c = 0; c < COSTS_COUNT; c++)
        most[c] = largest(book, cost_table[c].column);
    size_t count = 0;
    for (size_t i = 0; i < book->rows_count; i++) {
        const struct row *row = &book->rows[i];
        if (!row->ok || !is_static(page, i, &count))
            continue;
        page_text(page, "<tr><td class=\"scene\">");
        put_row_start(page, row);
        html_put_label(page->out, book, row);
        page_text(page, "</td>");
        for (size_t c = 0; c < COSTS_COUNT; c++) {
            double value = row->values[cost_table[c].column];
            double part = value > 0 && most[c] > 0 ? 100 * value / most[c] : 0;
            fprintf(page->out, "<td class=\"n bar\" style=\"--part:%.1f%%\">%s</td>", part,
                    number_plain(value * cost_table[c].scale, 3).text);
        }
        page_text(page, "</tr>\n");
    }
    page_text(page, "</tbody></table></div></div>\n");
}

/* Two decimals, a true minus, no negative zero. */
static struct number exponent(double value)
{
    struct number number;
    bool below = value <= -0.005;
    snprintf(number.text, sizeof number.text, "%s%.2f", below ? "\u2212" : "", fabs(value));
    return number;
}

void page_laws(const struct page *page)
{
    const struct book *book = page->book;
    size_t count = 0;
    for (size_t i = 0; i < book->laws_count; i++) {
        const struct law *law = &book->laws[i];
        if (!law->is_fitted || count++ == ROWS_MAX)
            continue;
        if (count == 1)
            page_text(page,
                      "<h3>Growth laws</h3>\n<p>Frame time = a N<sup>b</sup>, fitted by least "
                      "squares of logarithms to three or more tree counts N; the interval of b is "
                      "Student's, 95 %. b = 1 means that twice the trees take twice the time, near "
                      "0 that the trees hardly matter. A small R<sup>2</sup> says that one power "
                      "law does not describe the series: often a fixed cost at few trees.</p>\n"
                      "<div class=\"scroll\"><table class=\"laws\"><thead><tr>"
                      "<th scope=\"col\">scene</th><th scope=\"col\">method</th>"
                      "<th scope=\"col\" class=\"n\">b</th><th scope=\"col\" class=\"n\">95 % "
                      "interval</th><th scope=\"col\" class=\"n\">R<sup>2</sup></th>"
                      "<th scope=\"col\" class=\"n\">tree counts</th></tr></thead><tbody>\n");
        page_text(page, "<tr><td class=\"scene\">");
        page_safe(page, book->families[law->points->family]);
        page_text(page, "</td><td>");
        html_put_label(page->out, book, &book->rows[law->points->row]);
        fprintf(page->out, "</td><td class=\"n\">%s</td><td class=\"n\">%s to %s</td>",
                exponent(law->time.b.value).text, exponent(law->time.b.low).text,
                exponent(law->time.b.high).text);
        fprintf(page->out, "<td class=\"n\">%.2f</td><td class=\"n\">%zu</td></tr>\n", law->time.r2,
                law->points_count);
    }
    page_text(page, count ? "</tbody></table></div>\n" : "");
}
