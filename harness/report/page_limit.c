/* The page's section on the machine's limits: rooflines, and the calibration itself. */
#include "report/page.h"

#include "results/limit.h"

#include <math.h>

static void put_measure(const struct page *page, const struct calibration *calibration,
                        size_t index)
{
    const struct calibration_measure *measure = &calibration->measures[index];
    const struct calibration_info *info = &calibration_table[index];
    double factor, cycles = calibration->threads * calibration->core_ghz * 1e9;
    const char *unit = calibration_unit(info->kind, &factor);
    fprintf(page->out, "<tr><td><code>%s</code></td><td class=\"n\">%s", info->field,
            number_plain(factor * measure->rate.value, 3).text);
    if (!isnan(measure->rate.value))
        fprintf(page->out, "<span class=\"range\">%s to %s</span>",
                number_plain(factor * measure->rate.low, 3).text,
                number_plain(factor * measure->rate.high, 3).text);
    fprintf(page->out, "</td><td>%s</td><td class=\"n\">%s</td><td>", unit,
            number_plain(measure->rate.value / cycles, 3).text);
    page_safe(page, info->doc);
    page_text(page, "</td></tr>\n");
}

static void put_calibration(const struct page *page, const struct calibration *calibration)
{
    page_text(page, "<details><summary>What this machine can do: ");
    fprintf(page->out, "%s, %d \u00d7 %d px, %d threads", target_format_word(calibration->format),
            calibration->width_px, calibration->height_px, calibration->threads);
    page_text(page, "</summary><div class=\"inside\"><div class=\"scroll\"><table><thead><tr>"
                    "<th scope=\"col\">work</th><th scope=\"col\" class=\"n\">rate</th>"
                    "<th scope=\"col\">unit</th><th scope=\"col\" class=\"n\">per core cycle</th>"
                    "<th scope=\"col\">what is done</th></tr></thead><tbody>\n");
    for (size_t i = 0; i < CALIBRATION_COUNT; i++)
        put_measure(page, calibration, i);
    page_text(page, "</tbody></table></div></div></details>\n");
}

void page_limit(const struct page *page)
{
    const struct run *run = page->book->run;
    if (!run->calibrations_count)
        return;
    page_text(
        page,
        "<h2 id=\"limit\">How near the machine's limit</h2>\n<p>Between its rounds the run "
        "measured "
        "what this machine can do at most. Counts of a cell's draw calls, vertices, triangles and "
        "fragments, and of the rays, lookups, texture samples and bytes that a method tells, over "
        "these rates give the least time of its frame; the largest bounds it, and its share of "
        "the measured time is the fraction of the limit that the cell reaches: the column "
        "<i>of limit</i> of the results. The rest is shading, textures, and other work of the "
        "CPU.</p>\n");
    page_live(page, "live-limit");
    page_figures(page, FIGURE_LIMIT, FIGURE_LIMIT);
    page_figures(page, FIGURE_ROOFLINE, FIGURE_ROOFLINE);
    for (size_t i = 0; i < run->calibrations_count; i++)
        put_calibration(page, &run->calibrations[i]);
    page_tracings(page);
}
