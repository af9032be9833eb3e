/* Which cells are a method without and with the sun's shadows, from the effects that they drew and
 * the methods' tables. */
#include "report/pairs.h"

#include "base/hash.h"
#include "report/paper.h"

#include <math.h>
#include <string.h>

/* An option's value in both rows. */
static bool is_alike(const struct option *option, void *const values[2])
{
    char texts[2][64];
    for (int i = 0; i < 2; i++)
        option_value(option, values[i], texts[i], sizeof texts[i]);
    return strcmp(texts[0], texts[1]) == 0;
}

static bool depends_on(const struct option *option, const struct option *other)
{
    size_t length = strlen(other->name);
    return strncmp(option->doc, other->name, length) == 0 && option->doc[length] == '=';
}

/* Whether some option differs that all others which do depend on. */
static bool differ_by_a_switch(const struct method *method, void *const values[2])
{
    for (const struct option *on = method->options; on->name; on++) {
        bool alone = !is_alike(on, values);
        for (const struct option *other = method->options; other->name && alone; other++)
            alone = other == on || is_alike(other, values) || depends_on(other, on);
        if (alone)
            return true;
    }
    return false;
}

static bool is_pair(struct arena *arena, const struct row *without, const struct row *with)
{
    const struct cell *cells[2] = {&without->seen->cell, &with->seen->cell};
    const struct method *method = cells[0]->method;
    void *values[2];
    if (!without->ok || !with->ok || !method || !method->options || method != cells[1]->method ||
        cells[0]->lod != cells[1]->lod || cells[0]->format != cells[1]->format ||
        (with->seen->effects & ~without->seen->effects) != EFFECT_SUN_SHADOWS)
        return false;
    for (int i = 0; i < 2; i++) {
        values[i] = arena_alloc(arena, 1, method->options_size);
        options_default(method->options, values[i]);
        if (options_parse(method->options, cells[i]->options, values[i], NULL) != STATUS_OK)
            return false;
    }
    return differ_by_a_switch(method, values);
}

/* The row of the group that is this one without shadows, or rows_count. */
static size_t partner_of(const struct book *book, const struct group *group, size_t with)
{
    for (size_t i = 0; i < group->rows_count; i++)
        if (is_pair(book->arena, &book->rows[group->rows[i]], &book->rows[with]))
            return group->rows[i];
    return book->rows_count;
}

struct shadow_pair *shadow_pairs(const struct book *book, const struct group *group, size_t *count)
{
    size_t rounds;
    struct shadow_pair *pairs = ARENA_ARRAY(book->arena, struct shadow_pair, group->rows_count + 1);
    const struct paper_sample *times = paper_samples(book, PAPER_SECONDS, PAPER_MEDIAN, &rounds);
    *count = 0;
    for (size_t i = 0; i < group->rows_count; i++) {
        size_t with = group->rows[i], without = partner_of(book, group, with);
        if (without == book->rows_count)
            continue;
        pairs[(*count)++] = (struct shadow_pair){
            .without = without,
            .with = with,
            .price = stats_ratio_interval(times[with].values, times[without].values, rounds,
                                          hash_text(0, book->rows[with].seen->cell.name))};
    }
    return pairs;
}
