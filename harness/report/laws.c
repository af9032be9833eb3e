/* How the frame time of a series grows with the trees: a power law a family and series. */
#include "report/book.h"

#include <math.h>
#include <stdlib.h>

static int compare_points(const void *a, const void *b)
{
    const struct law_point *x = a, *y = b;
    int order = (x->family > y->family) - (x->family < y->family);
    if (!order)
        order = (x->series > y->series) - (x->series < y->series);
    return order ? order : (x->row > y->row) - (x->row < y->row);
}

static struct power_law fit(const struct book *book, const struct law *law)
{
    struct arena *arena = arena_create(0);
    double *trees = ARENA_ARRAY(arena, double, law->points_count);
    double *seconds = ARENA_ARRAY(arena, double, law->points_count);
    for (size_t i = 0; i < law->points_count; i++) {
        const struct row *row = &book->rows[law->points[i].row];
        trees[i] = (double)row->trees;
        seconds[i] = row->values[COLUMN_frame_seconds];
    }
    struct power_law result = stats_power_law(trees, seconds, law->points_count);
    arena_destroy(arena);
    return result;
}

/* Rows are sorted by trees within a family, so a law's points are too. */
void book_find_laws(struct book *book)
{
    struct law_point *points = ARENA_ARRAY(book->arena, struct law_point, book->rows_count + 1);
    size_t count = 0;
    for (size_t i = 0; i < book->rows_count; i++) {
        const struct row *row = &book->rows[i];
        if (row->trees > 0 && row->values[COLUMN_frame_seconds] > 0)
            points[count++] = (struct law_point){book->groups[row->group].family, row->series, i};
    }
    qsort(points, count, sizeof *points, compare_points);
    book->laws = ARENA_ARRAY(book->arena, struct law, count + 1);
    for (size_t start = 0, end; start < count; start = end) {
        struct law law = {.points = points + start};
        for (end = start; end < count && points[end].family == points[start].family &&
                          points[end].series == points[start].series;)
            end++;
        law.points_count = end - start;
        law.time = fit(book, &law);
        law.is_fitted = law.points_count >= 3 && !isnan(law.time.b.value);
        book->laws[book->laws_count++] = law;
    }
}
