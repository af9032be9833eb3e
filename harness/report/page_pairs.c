/* The page's section on what the sun's shadows give and cost in each representation. */
#include "report/page.h"
#include "report/pairs.h"

/* Of both rows. */
static const struct shown both_table[] = {
    {COLUMN_full_flip, "FLIP, all effects", "", 1},
    {COLUMN_full_rmse_box4, "RMSE-4, all effects", "", 1},
    {COLUMN_frame_seconds, "frame", "ms", 1e3},
};
/* Of the row with shadows. */
static const struct shown with_table[] = {
    {COLUMN_mask_wrong, "wrong shadow", "%", 100},
    {COLUMN_shadow_seconds, "shadows made in", "ms", 1e3},
    {COLUMN_relight_seconds, "sun moved", "ms", 1e3},
};
enum {
    BOTH_COUNT = sizeof both_table / sizeof *both_table,
    WITH_COUNT = sizeof with_table / sizeof *with_table
};

static void put_heading(const struct page *page, const char *text, const char *unit)
{
    fprintf(page->out,
            *unit ? "<th scope=\"col\" class=\"n\">%s [%s]</th>"
                  : "<th scope=\"col\" class=\"n\">%s</th>",
            text, unit);
}

static void put_number(const struct page *page, double value)
{
    fprintf(page->out, "<td class=\"n\">%s</td>", number_plain(value, 3).text);
}

static void put_head(const struct page *page)
{
    page_text(page, "<div class=\"scroll\"><table class=\"pairs\"><thead><tr><th scope=\"col\">"
                    "scene</th><th scope=\"col\">method</th>");
    for (int i = 0; i < BOTH_COUNT; i++)
        put_heading(page, both_table[i].heading, both_table[i].unit);
    put_heading(page, "times the frame", "");
    for (int i = 0; i < WITH_COUNT; i++)
        put_heading(page, with_table[i].heading, with_table[i].unit);
    put_heading(page, "memory added", "MB");
    page_text(page, "</tr></thead><tbody>\n");
}

static void put_pair(const struct page *page, const struct group *group,
                     const struct shadow_pair *pair)
{
    const struct row *without = &page->book->rows[pair->without];
    const struct row *with = &page->book->rows[pair->with];
    page_text(page, "<tr><td class=\"scene\">");
    page_safe(page, group->title);
    page_text(page, "</td><td>");
    html_put_label(page->out, page->book, with);
    page_text(page, "</td>");
    for (int i = 0; i < BOTH_COUNT; i++) {
        double scale = both_table[i].scale;
        enum column_index column = both_table[i].column;
        fprintf(page->out, "<td class=\"n\">%s \u2192 %s</td>",
                number_plain(without->values[column] * scale, 3).text,
                number_plain(with->values[column] * scale, 3).text);
    }
    fprintf(page->out, "<td class=\"n\">%s<span class=\"range\">%s to %s</span></td>",
            number_plain(pair->price.value, 3).text, number_plain(pair->price.low, 3).text,
            number_plain(pair->price.high, 3).text);
    for (int i = 0; i < WITH_COUNT; i++)
        put_number(page, with->values[with_table[i].column] * with_table[i].scale);
    put_number(page, row_megabytes(with) - row_megabytes(without));
    page_text(page, "</tr>\n");
}

void page_pairs(const struct page *page)
{
    const struct book *book = page->book;
    size_t shown = 0;
    for (size_t g = 0; g < book->groups_count; g++) {
        size_t count;
        const struct shadow_pair *pairs = shadow_pairs(book, &book->groups[g], &count);
        for (size_t i = 0; i < count; i++) {
            if (!shown++) {
                page_text(
                    page,
                    "<h2 id=\"pairs\">What shadows give and cost</h2>\n<p>The same method "
                    "without \u2192 with the sun's shadows, all else being equal: its "
                    "total error, against the reference with all effects, and its price. A frame "
                    "makes its shadows anew only where the view or the sun asks for it; what "
                    "making all of them takes once stands apart, where the method counts it. "
                    "How many times as long a frame takes is a ratio of times of the same "
                    "round, with its 95 % interval.</p>\n");
                page_figures(page, FIGURE_PAIRS, FIGURE_PAIRS);
                put_head(page);
            }
            put_pair(page, &book->groups[g], &pairs[i]);
        }
    }
    page_text(page, shown ? "</tbody></table></div>\n" : "");
}
