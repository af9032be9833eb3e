/* What the numbers say, in words: the headline, the front of each group, each method over all
 * groups. */
#include "report/book.h"

#include "base/plural.h"
#include "stats/stats.h"

#include <math.h>
#include <string.h>

static double seconds_of(const struct row *row)
{
    return row->values[COLUMN_frame_seconds];
}

static double flip_of(const struct row *row)
{
    return row->values[COLUMN_same_flip];
}

static void put_method(const struct book *book, const struct row *row, FILE *out)
{
    fputs("<span class=\"name\">", out);
    html_put_label(out, book, row);
    fputs("</span>", out);
}

static void put_speed(const struct row *row, FILE *out)
{
    fprintf(out, "%s a frame, %s fps", number_seconds(seconds_of(row)).text,
            number_plain(row->values[COLUMN_fps], 3).text);
}

const struct group *answer_group(const struct book *book, size_t *front, size_t *front_count)
{
    const struct group *chosen = NULL;
    size_t best = 0;
    for (size_t g = 0; g < book->groups_count; g++) {
        const struct group *group = &book->groups[g];
        size_t count = book_front(book, group, front), told = count < 3 ? count : 3;
        bool wins = told > best ||
                    (told > 0 && told == best &&
                     (group->trees > chosen->trees ||
                      (group->trees == chosen->trees && group->rows_count >= chosen->rows_count)));
        if (wins) {
            chosen = group;
            best = told;
        }
    }
    *front_count = chosen ? book_front(book, chosen, front) : 0;
    return chosen;
}

/* A cell that is as good as asked (FLIP below bound) and whose interval reaches the front cell's;
 * NULL: none. */
static const struct row *rival_of(const struct book *book, const struct group *group,
                                  const struct row *row, double bound)
{
    for (size_t i = 0; i < group->rows_count; i++) {
        const struct row *other = &book->rows[group->rows[i]];
        if (other == row || other->is_floor || isnan(seconds_of(other)) || isnan(flip_of(other)))
            continue;
        if (flip_of(other) < bound && seconds_of(other) >= seconds_of(row) &&
            other->values[COLUMN_frame_seconds_low] <= row->values[COLUMN_frame_seconds_high])
            return other;
    }
    return NULL;
}

static void put_clause(const struct book *book, const struct group *group, const struct row *row,
                       const struct row *before, FILE *out)
{
    double bound = before ? flip_of(before) : INFINITY;
    if (!before)
        fprintf(out, "where a FLIP error of %s is good enough, ",
                number_plain(flip_of(row), 3).text);
    else
        fprintf(out, "; below %s, ", number_plain(bound, 3).text);
    put_method(book, row, out);
    fputs(before ? " (" : " is the fastest (", out);
    put_speed(row, out);
    const struct row *rival = rival_of(book, group, row, bound);
    if (rival && row->values[COLUMN_repetitions] >= 3) {
        fputs(", though within the interval of ", out);
        put_method(book, rival, out);
    }
    fputs(")", out);
}

void answer_headline(const struct book *book, FILE *out)
{
    size_t *front = ARENA_ARRAY(book->arena, size_t, book->rows_count + 1), count;
    const struct group *group = answer_group(book, front, &count);
    if (!group) {
        fputs("No method that draws trees has both a frame time and an error, so nothing can be "
              "said about which is the fastest.",
              out);
        return;
    }
    /* Three points tell the story: the fastest, the one in the middle, the most exact. */
    size_t told[3] = {0, count / 2, count - 1};
    fputs("In ", out);
    html_put(out, book->families[group->family]);
    fprintf(out, " with %s tree%s, ", number_plain((double)group->trees, 15).text,
            plural(group->trees));
    for (size_t k = 0; k < 3; k++) {
        if (k > 0 && told[k] <= told[k - 1])
            continue;
        const struct row *before = told[k] ? &book->rows[front[told[k] - 1]] : NULL;
        put_clause(book, group, &book->rows[front[told[k]]], before, out);
    }
    const struct row *last = &book->rows[front[count - 1]];
    fprintf(out, ". No error below %s was reached.", number_plain(flip_of(last), 3).text);
}

/* Rows of the tables of answers. */
enum { GROUPS_MAX = 60, SERIES_MAX = 60 };

void answer_fronts(const struct book *book, FILE *out)
{
    fputs("<div class=\"scroll\"><table class=\"fronts\"><thead><tr><th scope=\"col\">scene</th>"
          "<th scope=\"col\" class=\"n\">trees</th><th scope=\"col\">the fastest, from any error "
          "down to the lowest: frame time at FLIP error</th></tr></thead><tbody>\n",
          out);
    size_t *front = ARENA_ARRAY(book->arena, size_t, book->rows_count + 1), told = 0;
    for (size_t g = 0; g < book->groups_count && told < GROUPS_MAX; g++) {
        const struct group *group = &book->groups[g];
        size_t count = book_front(book, group, front);
        if (book->groups_count > GROUPS_MAX && !book_is_overview(book, g))
            continue;
        told++;
        fputs("<tr><th scope=\"row\" class=\"scene\">", out);
        html_put(out, book->families[group->family]);
        fprintf(out, "</th><td class=\"n\" data-unit=\" tree%s\">%s</td><td>", plural(group->trees),
                number_plain((double)group->trees, 15).text);
        for (size_t k = 0; k < count; k++) {
            const struct row *row = &book->rows[front[k]];
            fputs(k ? " <span class=\"then\">\u2192</span> <span class=\"step\">"
                    : "<span class=\"step\">",
                  out);
            put_method(book, row, out);
            fprintf(out, " %s at %s</span>", number_seconds(seconds_of(row)).text,
                    number_plain(flip_of(row), 2).text);
        }
        fputs(count ? "</td></tr>\n" : "no cell with a time and an error</td></tr>\n", out);
    }
    fputs("</tbody></table></div>\n", out);
    if (told < book->groups_count)
        fprintf(out,
                "<p class=\"soft\">%zu of %zu scenes and tree counts stand here, those with the "
                "most trees; the column on_front of <a href=\"tables/results.csv\">the CSV</a> has "
                "the fronts of all.</p>\n",
                told, book->groups_count);
}

struct standing {
    size_t groups, succeeded, on_front;
    double *slowdowns, *flips;
    size_t flips_count;
    const struct row *example;
};

/* Time over that of the group's fastest cell that draws trees; NaN for a cell that did not succeed.
 */
static double slowdown_in(const struct book *book, const struct group *group, const struct row *row)
{
    double fastest = INFINITY;
    for (size_t i = 0; i < group->rows_count; i++) {
        const struct row *other = &book->rows[group->rows[i]];
        if (!other->is_floor && !isnan(seconds_of(other)))
            fastest = fmin(fastest, seconds_of(other));
    }
    return fastest > 0 && isfinite(fastest) ? seconds_of(row) / fastest : NAN;
}

static struct standing standing_of(struct arena *arena, const struct book *book, size_t series)
{
    struct standing standing = {.slowdowns = ARENA_ARRAY(arena, double, book->rows_count),
                                .flips = ARENA_ARRAY(arena, double, book->rows_count)};
    for (size_t i = 0; i < book->rows_count; i++) {
        const struct row *row = &book->rows[i];
        if (row->series != series || row->is_floor)
            continue;
        standing.example = row;
        standing.groups++;
        standing.on_front += row->summary->on_front;
        double slowdown = slowdown_in(book, &book->groups[row->group], row);
        if (!isnan(slowdown))
            standing.slowdowns[standing.succeeded++] = slowdown;
        if (row->compared)
            standing.flips[standing.flips_count++] = flip_of(row);
    }
    return standing;
}

static void put_standing(const struct book *book, const struct standing *standing, FILE *out)
{
    fputs("<tr><th scope=\"row\">", out);
    put_method(book, standing->example, out);
    double slowdown = stats_geometric_mean(standing->slowdowns, standing->succeeded);
    fprintf(out, "</th><td class=\"n\">%s</td><td class=\"n\">",
            slowdown == 1 ? "1.00" : number_plain(slowdown, 3).text);
    size_t n = standing->flips_count;
    fputs(number_plain(stats_median(standing->flips, n), 3).text, out);
    if (n > 1)
        fprintf(out, " <span class=\"soft\">(%s to %s)</span>",
                number_plain(stats_quantile(standing->flips, n, 0), 2).text,
                number_plain(stats_quantile(standing->flips, n, 1), 2).text);
    fprintf(out, "</td><td class=\"n\">%zu of %zu</td><td class=\"n\">%zu of %zu</td></tr>\n",
            standing->on_front, standing->groups, standing->succeeded, standing->groups);
}

void answer_overall(const struct book *book, FILE *out)
{
    fputs("<div class=\"scroll\"><table class=\"overall\"><thead><tr><th scope=\"col\">method</th>"
          "<th scope=\"col\" class=\"n\">times slower than the fastest</th>"
          "<th scope=\"col\" class=\"n\">FLIP, median (smallest to largest)</th>"
          "<th scope=\"col\" class=\"n\">on the front</th>"
          "<th scope=\"col\" class=\"n\">succeeded</th></tr></thead><tbody>\n",
          out);
    for (size_t s = 0; s < book->series_count && s < SERIES_MAX; s++) {
        struct arena *scratch = arena_create(0);
        struct standing standing = standing_of(scratch, book, s);
        if (standing.example)
            put_standing(book, &standing, out);
        arena_destroy(scratch);
    }
    fputs("</tbody></table></div>\n<p class=\"soft\">Times are ratios to the fastest method of the "
          "same scene and tree count, combined by their geometric mean over the cells that "
          "succeeded; frame rates are never averaged. Mind the last column before comparing.",
          out);
    if (book->series_count > SERIES_MAX)
        fprintf(out, " Here stand the first %d of %zu methods and options.", SERIES_MAX,
                book->series_count);
    fputs("</p>\n", out);
}
