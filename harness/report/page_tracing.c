/* The page's table of what the references cost to trace, beside what the machine can do. */
#include "report/page.h"

#include "results/limit.h"

#include <math.h>
#include <string.h>

/* References of one scene, size and set of effects: medians. */
struct traced {
    const struct tracing *first;
    size_t count, from_cache;
    double *build_seconds, *trace_seconds, *samples, *rates, *fractions;
};

static bool traced_alike(const struct tracing *a, const struct tracing *b)
{
    return strcmp(a->scene, b->scene) == 0 && a->trees == b->trees && a->width_px == b->width_px &&
           a->height_px == b->height_px && a->effects == b->effects && a->threads == b->threads;
}

static void traced_add(struct traced *traced, const struct run *run, const struct tracing *one)
{
    size_t i = traced->count++;
    double rays = one->primary_rays + one->shadow_rays + one->occlusion_rays;
    traced->from_cache += one->from_cache;
    traced->build_seconds[i] = one->build_seconds;
    traced->trace_seconds[i] = one->trace_seconds;
    traced->samples[i] = one->primary_rays / one->width_px / one->height_px;
    traced->rates[i] = rays / one->trace_seconds;
    traced->fractions[i] = limit_of_tracing(run, one).fraction.value;
}

static void put_cell(const struct page *page, struct number number)
{
    fprintf(page->out, "</td><td class=\"n\">%s", number.text);
}

static void put_traced(const struct page *page, const struct traced *traced)
{
    const struct tracing *first = traced->first;
    const char *comma = "";
    page_text(page, "<tr><td>");
    page_safe(page, first->scene);
    put_cell(page, number_plain((double)first->trees, 3));
    fprintf(page->out, "</td><td class=\"n\">%d \u00d7 %d</td><td>", first->width_px,
            first->height_px);
#define EFFECT_PUT(name, bit, word, meaning)                                                       \
    if (first->effects & (name)) {                                                                 \
        fprintf(page->out, "%s" word, comma);                                                      \
        comma = ", ";                                                                              \
    }
    EFFECT_LIST(EFFECT_PUT)
#undef EFFECT_PUT
    put_cell(page, number_plain((double)traced->count, 3));
    put_cell(page, number_plain((double)traced->from_cache, 3));
    put_cell(page, number_seconds(stats_median(traced->build_seconds, traced->count)));
    put_cell(page, number_seconds(stats_median(traced->trace_seconds, traced->count)));
    put_cell(page, number_plain(stats_median(traced->samples, traced->count), 3));
    put_cell(page, number_plain(1e-6 * stats_median(traced->rates, traced->count), 3));
    put_cell(page, number_plain(100 * stats_median(traced->fractions, traced->count), 3));
    page_text(page, "</td></tr>\n");
}

void page_tracings(const struct page *page)
{
    const struct run *run = page->book->run;
    size_t most = run->tracings_count;
    if (!most)
        return;
    page_text(page,
              "<details><summary>What the ray-traced references cost</summary>"
              "<div class=\"inside\"><p>Medians over the pictures. The limit is what this "
              "machine's calibrated rates of rays (one tree, neighbouring rays) leave as the least "
              "time of as many; what a picture took from the cache cost was measured by the run "
              "that made it.</p><div class=\"scroll\"><table><thead><tr>"
              "<th scope=\"col\">scene</th><th scope=\"col\" class=\"n\">trees</th>"
              "<th scope=\"col\" class=\"n\">size [px]</th><th scope=\"col\">effects</th>"
              "<th scope=\"col\" class=\"n\">pictures</th>"
              "<th scope=\"col\" class=\"n\">from the cache</th>"
              "<th scope=\"col\" class=\"n\">build</th><th scope=\"col\" class=\"n\">trace</th>"
              "<th scope=\"col\" class=\"n\">samples a pixel</th>"
              "<th scope=\"col\" class=\"n\">rays [M/s]</th>"
              "<th scope=\"col\" class=\"n\">of limit [%]</th></tr></thead><tbody>\n");
    double *values = ARENA_ARRAY(page->arena, double, 5 * most);
    bool *told = ARENA_ARRAY(page->arena, bool, most);
    for (size_t i = 0; i < most; i++) {
        struct traced traced = {.first = &run->tracings[i],
                                .build_seconds = values,
                                .trace_seconds = values + most,
                                .samples = values + 2 * most,
                                .rates = values + 3 * most,
                                .fractions = values + 4 * most};
        for (size_t k = i; k < most && !told[i]; k++)
            if (k == i || (!told[k] && traced_alike(traced.first, &run->tracings[k]))) {
                traced_add(&traced, run, &run->tracings[k]);
                told[k] = k != i;
            }
        if (traced.count)
            put_traced(page, &traced);
    }
    page_text(page, "</tbody></table></div></div></details>\n");
}
