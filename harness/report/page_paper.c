/* The page's section beside the papers: printed tables with our cells in the same lines, and the
 * papers' claims with what this run says to them. */
#include "report/page.h"
#include "report/paper.h"

#include "base/plural.h"

#include <math.h>

static void put_variant(const struct page *page, const struct row *row)
{
    html_put_mark(page->out, page->book, row->method_index);
    page_safe(page, paper_variant(page->arena, row));
}

static void put_interval(const struct page *page, const struct interval *interval, size_t rounds)
{
    fprintf(page->out, "<td class=\"n\">%s", number_plain(interval->value, 3).text);
    if (!isnan(interval->value) && interval->low < interval->high)
        fprintf(page->out, "<span class=\"range\">%s to %s</span>",
                number_plain(interval->low, 3).text, number_plain(interval->high, 3).text);
    if (!isnan(interval->value) && rounds < 3)
        fprintf(page->out, "<span class=\"range\">%zu round%s</span>", rounds, plural(rounds));
    page_text(page, "</td>");
}

static void put_ours(const struct page *page, const struct paper_line *line)
{
    if (!line->ours)
        page_text(page, "<td class=\"n soft\">not measured</td>");
    else if (!line->rounds)
        fprintf(page->out, "<td class=\"n\"><a href=\"#failures\" class=\"bad\">%s</a></td>",
                status_word(line->ours->seen->status));
    else
        put_interval(page, &line->value, line->rounds);
}

static void put_line(const struct page *page, const struct paper_line *line)
{
    static const char *const statistics[] = {
        [PAPER_MEDIAN] = "", [PAPER_WORST] = ", slowest 5 %", [PAPER_BEST] = ", fastest 5 %"};
    const struct paper_row *printed = line->printed;
    fprintf(page->out, "<tr><td class=\"n\">%s</td><td>%s</td><td>",
            number_plain((double)printed->cell.trees, 15).text, lod_word(printed->cell.lod));
    page_safe(page, printed->effects);
    page_text(page, statistics[printed->statistic]);
    fprintf(page->out, "</td><td class=\"n\">%s</td>", number_exact(printed->value).text);
    put_ours(page, line);
    fprintf(page->out, "<td class=\"n\">%s</td>", number_plain(line->printed_ratio, 3).text);
    put_interval(page, &line->ratio, line->rounds);
    fprintf(page->out, "<td class=\"n\">%s</td></tr>\n",
            number_plain(line->ratio.value / line->printed_ratio, 3).text);
}

/* Which laws fit: that of the least residual, and those whose residual is within a tenth of it. */
static void put_best_laws(const struct page *page, const char *side, const struct growth_fit *fits)
{
    const char *words[GROWTH_LAWS];
    double least = INFINITY;
    int count = 0;
    for (int law = 0; law < GROWTH_LAWS; law++)
        least = fmin(least, fits[law].residual);
    for (int law = 0; law < GROWTH_LAWS; law++)
        if (fits[law].residual <= 1.1 * least)
            words[count++] = growth_word((enum growth_law)law);
    fprintf(page->out, "%s ", side);
    for (int i = 0; i < count; i++)
        fprintf(page->out, "%s<b>%s</b>", i == 0 ? "" : i == count - 1 ? " or " : ", ", words[i]);
    page_text(page, count > 1 ? " alike, within a tenth of the least residual. " : ". ");
}

/* The laws that the times may grow by, each with its residual: the least is marked. */
static void put_laws(const struct page *page, const struct paper_block *block)
{
    const struct growth_fit *sides[] = {block->printed_fits, block->fits};
    if (!block->table->law || isnan(block->fits[GROWTH_LINEAR].residual))
        return;
    fprintf(page->out, "<p>By which law do the seconds grow with N, the ");
    page_safe(page, block->table->law);
    page_text(page, "? Each is fitted by least squares of relative residuals to the rows that both "
                    "have; the residual is their root mean square (n \u2212 2).</p>\n"
                    "<div class=\"scroll\"><table class=\"paper\"><thead><tr>"
                    "<th scope=\"col\">law</th><th scope=\"col\" class=\"n\">printed [s]</th>"
                    "<th scope=\"col\" class=\"n\">residual [%]</th>"
                    "<th scope=\"col\" class=\"n\">ours [s]</th>"
                    "<th scope=\"col\" class=\"n\">residual [%]</th></tr></thead><tbody>\n");
    for (int law = 0; law < GROWTH_LAWS; law++) {
        fprintf(page->out, "<tr><td>%s</td>", growth_word((enum growth_law)law));
        for (int side = 0; side < 2; side++) {
            const struct growth_fit *fits = sides[side], *fit = &fits[law];
            bool least = true;
            for (int other = 0; other < GROWTH_LAWS; other++)
                least = least && fit->residual <= fits[other].residual;
            fprintf(page->out, "<td class=\"n\">%s</td><td class=\"n\">%s%s%s</td>",
                    paper_law(page->arena, (enum growth_law)law, fit), least ? "<b>" : "",
                    number_plain(100 * fit->residual, 3).text, least ? "</b>" : "");
        }
        page_text(page, "</tr>\n");
    }
    page_text(page, "</tbody></table></div>\n<p>");
    put_best_laws(page, "Printed times are fitted best by", block->printed_fits);
    put_best_laws(page, "Ours by", block->fits);
    page_text(page, "</p>\n");
}

static void put_block(const struct page *page, const struct paper_block *block)
{
    const char *unit = paper_unit_word(block->table->unit);
    page_text(page, "<h4>");
    page_safe(page, block->table->title);
    page_text(page, " \u00b7 ours: ");
    put_variant(page, block->example);
    fprintf(page->out,
            "</h4>\n<div class=\"scroll\"><table class=\"paper\"><thead><tr>"
            "<th scope=\"col\" class=\"n\">trees</th><th scope=\"col\">level</th>"
            "<th scope=\"col\">effects</th><th scope=\"col\" class=\"n\">printed [%s]</th>"
            "<th scope=\"col\" class=\"n\">ours [%s]</th>"
            "<th scope=\"col\" class=\"n\">printed ratio</th>"
            "<th scope=\"col\" class=\"n\">our ratio</th>"
            "<th scope=\"col\" class=\"n\">our ratio over the printed</th></tr></thead><tbody>\n",
            unit, unit);
    for (size_t i = 0; i < block->lines_count; i++)
        put_line(page, &block->lines[i]);
    page_text(page, "</tbody></table></div>\n");
    put_laws(page, block);
    for (size_t i = 0; i < block->lines_count; i++)
        if (*block->lines[i].printed->note) {
            fprintf(page->out, "<p class=\"soft\">%s tree%s, %s, ",
                    number_plain((double)block->lines[i].printed->cell.trees, 15).text,
                    plural(block->lines[i].printed->cell.trees),
                    lod_word(block->lines[i].printed->cell.lod));
            page_safe(page, block->lines[i].printed->effects);
            page_text(page, ": ");
            page_safe(page, block->lines[i].printed->note);
            page_text(page, ".</p>\n");
        }
}

/* A figure, and the range over the pairs that it is the mean of. */
static void put_figure(const struct page *page, const struct interval *figure)
{
    fprintf(page->out, "<td class=\"n\">%s", number_plain(figure->value, 3).text);
    if (figure->low < figure->high)
        fprintf(page->out, "<span class=\"range\">pairs: %s to %s</span>",
                number_plain(figure->low, 3).text, number_plain(figure->high, 3).text);
    page_text(page, "</td>");
}

static void put_claim(const struct page *page, const struct paper_claim *claim, size_t findings)
{
    fprintf(page->out, "<th scope=\"row\" class=\"claim\" rowspan=\"%zu\">", findings);
    page_safe(page, claim->claim);
    fprintf(page->out, "<span class=\"range\"><code>%s</code>: ", claim->id);
    page_safe(page, claim->figure);
    if (claim->kind != PAPER_UNTESTED) {
        fprintf(page->out, "; band %s: ", paper_band(page->arena, claim));
        page_safe(page, claim->why);
    }
    page_text(page, "</span></th>");
}

static void put_finding(const struct page *page, const struct paper_finding *finding)
{
    fprintf(page->out, "<td class=\"verdict\"><b class=\"verdict%d\">%s</b><span class=\"range\">",
            (int)finding->verdict, paper_verdict_word(finding->verdict));
    page_safe(page, finding->reason);
    page_text(page, "</span></td><td>");
    if (finding->example)
        put_variant(page, finding->example);
    else
        page_safe(page, NULL);
    page_text(page, "</td>");
    put_figure(page, &finding->printed);
    put_interval(page, &finding->ours, finding->claim->column ? SIZE_MAX : finding->rounds);
    page_text(page, "<td class=\"n\">");
    if (finding->usable > 1)
        fprintf(page->out, "%s to %s<span class=\"range\">%zu of them</span>",
                number_plain(finding->smallest, 3).text, number_plain(finding->largest, 3).text,
                finding->usable);
    else
        page_safe(page, NULL);
    page_text(page, "</td></tr>\n");
}

static void put_findings(const struct page *page, const struct paper_beside *beside)
{
    page_text(page,
              "<h4>What the paper claims</h4>\n<div class=\"scroll\"><table class=\"paper\">"
              "<thead><tr><th scope=\"col\">claim, and what decides it</th>"
              "<th scope=\"col\">verdict</th><th scope=\"col\">of ours</th>"
              "<th scope=\"col\" class=\"n\">printed</th><th scope=\"col\" class=\"n\">ours</th>"
              "<th scope=\"col\" class=\"n\">our pairs</th></tr></thead><tbody>\n");
    for (size_t i = 0, end; i < beside->findings_count; i = end) {
        for (end = i + 1; end < beside->findings_count &&
                          beside->findings[end].claim == beside->findings[i].claim;)
            end++;
        for (size_t k = i; k < end; k++) {
            page_text(page, "<tr>");
            if (k == i)
                put_claim(page, beside->findings[i].claim, end - i);
            put_finding(page, &beside->findings[k]);
        }
    }
    page_text(page, "</tbody></table></div>\n");
}

static void put_beside(const struct page *page, const struct paper_beside *beside)
{
    const struct paper *paper = beside->paper;
    fprintf(page->out, "<h3 id=\"paper-%s\">", paper->name);
    page_safe(page, paper->title);
    page_text(page, "</h3>\n<p>");
    page_safe(page, paper->authors);
    if (paper->year)
        fprintf(page->out, ", %d", paper->year);
    page_text(page, ", ");
    page_safe(page, paper->source);
    page_text(page, "; measured on ");
    page_safe(page, paper->machine);
    page_text(page, ". ");
    page_text(page, *paper->note ? "" : "</p>\n");
    if (*paper->note) {
        page_safe(page, paper->note);
        page_text(page, "</p>\n");
    }
    put_findings(page, beside);
    for (size_t i = 0; i < beside->blocks_count; i++)
        put_block(page, &beside->blocks[i]);
}

void page_papers(const struct page *page)
{
    const struct book *book = page->book;
    if (!book->besides_count)
        return;
    page_text(
        page,
        "<h2 id=\"papers\">Beside the paper</h2>\n<p>What a paper printed, and the same cells of "
        "this run. Rates of two machines are not comparable: each is divided by its own base row, "
        "where the ratio is 1, and these ratios are compared. Ratios are formed round by round, "
        "so that a drift of the machine cancels; their medians stand with 95 % bootstrap "
        "intervals. A claim holds where the interval of its figure lies within the band, does not "
        "hold where it lies outside, and stays open where it crosses the band's end or the run "
        "has fewer than three rounds. As numbers: "
        "<a href=\"tables/papers.csv\">CSV</a>, <a href=\"tables/papers.md\">Markdown</a>.</p>\n");
    page_figures(page, FIGURE_PAPER, FIGURE_LAW);
    for (size_t i = 0; i < book->besides_count; i++)
        put_beside(page, &book->besides[i]);
}
