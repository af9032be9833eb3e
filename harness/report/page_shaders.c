/* The page's error maps of the shaders of needles, where the run has cells that draw with them. */
#include "report/page.h"
#include "report/picture.h"
#include "report/shaders.h"

#include "base/file.h"

#include <string.h>

static bool has_needles(const struct book *book)
{
    for (size_t i = 0; i < book->rows_count; i++)
        if (strcmp(book->rows[i].method, "conifers") == 0 && book->rows[i].ok)
            return true;
    return false;
}

void page_shaders(const struct page *page)
{
    if (!has_needles(page->book))
        return;
    struct error error = {0};
    char *bytes = NULL;
    size_t size = 0;
    const char *folder = arena_printf(page->arena, "%s/plots", page->out_folder);
    enum status status = shaders_draw(folder, &error);
    if (!status)
        status = file_read(page->arena, arena_printf(page->arena, "%s/shaders.png", folder), 0,
                           &bytes, &size, &error);
    page_text(page,
              "<h2 id=\"shaders\">Errors of the shaders of needles</h2>\n<p>What a twig of needles "
              "hides, how bright it is and how it shines, by the formulas as the paper prints them "
              "and by the "
              "exact ones, against converged quadrature: over the angle of the eye to the twig, "
              "that of the needles to it, and three densities (needles' width over their "
              "distance). No cell was measured for it.</p>\n");
    if (status) {
        page_text(page, "<p class=\"notice\">There are no maps: ");
        page_safe(page, error.text);
        page_text(page, "</p>\n");
        return;
    }
    page_text(page,
              "<figure class=\"figure\"><img style=\"max-width:100%;height:auto\" alt=\"eighteen "
              "maps of relative error: opacity, brightness, shine, paper and exact, at three "
              "densities\" src=\"data:image/png;base64,");
    picture_base64((const uint8_t *)bytes, size, page->out);
    page_text(page,
              "\"><figcaption>Light: no error that is seen; dark: as large as the value. "
              "<span class=\"no-print\"><a href=\"plots/shaders.png\">png</a> \u00b7 "
              "<a href=\"plots/shaders.dat\">data</a> \u00b7 again: <code>cd plots &amp;&amp; "
              "gnuplot shaders.gp</code></span></figcaption></figure>\n");
}
