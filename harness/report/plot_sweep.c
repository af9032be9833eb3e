/* The static plots of a swept option: error, frame time, memory and wrong shadows against its
 * value; and of error against memory. */
#include "report/plot.h"
#include "report/sweep.h"

#include <math.h>

/* What stands on the y axis; low and high are its interval. */
static struct interval figure_of(const struct row *row, enum sweep_axis axis)
{
    double value = row->values[COLUMN_same_flip];
    if (axis == SWEEP_TIME)
        return (struct interval){1e3 * row->values[COLUMN_frame_seconds],
                                 1e3 * row->values[COLUMN_frame_seconds_low],
                                 1e3 * row->values[COLUMN_frame_seconds_high]};
    if (axis == SWEEP_MEMORY)
        value = row_megabytes(row);
    if (axis == SWEEP_MASK)
        value = 100 * row->values[COLUMN_mask_wrong];
    return (struct interval){value, value, value};
}

static void put_curve(struct plot *plot, const struct sweep_curve *curve, enum sweep_axis axis,
                      int variant)
{
    const struct book *book = plot->book;
    const struct row *first = &book->rows[curve->points->row];
    unsigned color = tint_rgb(tint_method(book, first->method_index));
    int type = symbol_gnuplot(book, first->method_index, variant == 0);
    int block = plot_block(plot, curve->label);
    size_t count = 0;
    for (size_t i = 0; i < curve->points_count; i++) {
        struct interval y = figure_of(&book->rows[curve->points[i].row], axis);
        if (!(y.value > 0))
            continue;
        fprintf(plot->dat, "%.9g %.9g %.9g %.9g\n", curve->points[i].value, y.value, y.low, y.high);
        count++;
    }
    if (!count)
        return;
    plot_curve(plot);
    fprintf(plot->gp,
            "\"%s.dat\" index %d with yerrorbars pointtype %d pointsize 0.8 linewidth 1 linecolor "
            "rgb \"#%06x\" notitle, \\\n    \"\" index %d with linespoints pointtype %d pointsize "
            "0.8 linewidth 1.2 dashtype %d linecolor rgb \"#%06x\" title ",
            plot->name, block, type, color, block, type, 1 + variant % 5, color);
    plot_text(plot->gp, curve->label);
    plot->key_rows++;
}

/* How many curves of the same method come before. */
static int variant_of(const struct book *book, const struct sweep *sweep, size_t index)
{
    int before = 0;
    size_t method = book->rows[sweep->curves[index].points->row].method_index;
    for (size_t i = 0; i < index; i++)
        before += book->rows[sweep->curves[i].points->row].method_index == method;
    return before;
}

enum status plot_sweep(const struct book *book, const struct sweep *sweep, enum sweep_axis axis,
                       const char *folder, struct figure *figure, struct error *error)
{
    static const char *const labels[] = {
        [SWEEP_ERROR] = "FLIP, reference with same effects",
        [SWEEP_TIME] = "frame time [ms]",
        [SWEEP_MEMORY] = "memory and GL objects [MB]",
        [SWEEP_MASK] = "surface in wrong shadow [%]",
    };
    static const char *const words[] = {[SWEEP_ERROR] = "error",
                                        [SWEEP_TIME] = "time",
                                        [SWEEP_MEMORY] = "memory",
                                        [SWEEP_MASK] = "shadow"};
    const struct group *group = &book->groups[sweep->group];
    struct axis x = axis_empty(), y = axis_empty();
    for (size_t c = 0; c < sweep->curves_count; c++)
        for (size_t i = 0; i < sweep->curves[c].points_count; i++) {
            const struct sweep_point *point = &sweep->curves[c].points[i];
            struct interval value = figure_of(&book->rows[point->row], axis);
            axis_add(&x, point->value);
            axis_add(&y, value.low);
            axis_add(&y, value.high);
        }
    if (!(y.low <= y.high) || sweep->curves_count > PLOT_LINES_MAX)
        return STATUS_OK;
    axis_widen(&x, 0.05, 0.05);
    axis_widen(&y, 0.08, 0.08);
    struct plot plot;
    struct arena *arena = book->arena;
    figure->kind = FIGURE_SWEEP;
    plot_open(&plot, book, folder,
              arena_printf(arena, "sweep-%s-%s-%s", sweep->option, words[axis], group->slug),
              group->title);
    plot_axes(&plot, &x, &y,
              *sweep->unit ? arena_printf(arena, "%s [%s]", sweep->option, sweep->unit)
                           : sweep->option,
              labels[axis]);
    fputs("set key maxcols 1\n", plot.gp);
    for (size_t c = 0; c < sweep->curves_count; c++)
        put_curve(&plot, &sweep->curves[c], axis, variant_of(book, sweep, c));
    return plot_close(&plot, figure, error);
}

/* The rows of a method in a group: megabytes, error. */
static void put_memories(struct plot *plot, const struct group *group, size_t method)
{
    const struct book *book = plot->book;
    int block = -1;
    for (size_t i = 0; i < group->rows_count; i++) {
        const struct row *row = &book->rows[group->rows[i]];
        double memory = row_megabytes(row), error = row->values[COLUMN_same_flip];
        if (row->method_index != method || row->is_floor || !(memory > 0) || !(error > 0))
            continue;
        if (block < 0)
            block = plot_block(plot, "MB, FLIP");
        fprintf(plot->dat, "%.9g %.9g # %s\n", memory, error, row->label);
    }
    if (block < 0)
        return;
    plot_points(plot, block, "with points", method, true, book->methods[method]);
}

enum status plot_memory(const struct book *book, const struct group *group, const char *folder,
                        struct figure *figure, struct error *error)
{
    struct axis x = axis_empty(), y = axis_empty();
    for (size_t i = 0; i < group->rows_count; i++) {
        const struct row *row = &book->rows[group->rows[i]];
        double memory = row_megabytes(row);
        if (row->is_floor || !(memory > 0) || !(row->values[COLUMN_same_flip] > 0))
            continue;
        axis_add(&x, memory);
        axis_add(&y, row->values[COLUMN_same_flip]);
    }
    if (!(x.low < x.high))
        return STATUS_OK;
    axis_widen(&x, 0.08, 0.08);
    axis_widen(&y, 0.08, 0.08);
    struct plot plot;
    figure->kind = FIGURE_MEMORY;
    plot_open(&plot, book, folder, arena_printf(book->arena, "memory-%s", group->slug),
              group->title);
    plot_axes(&plot, &x, &y, "memory and GL objects [MB]", "FLIP, reference with same effects");
    fputs("set key maxcols 1\n", plot.gp);
    for (size_t method = 0; method < book->methods_count; method++)
        put_memories(&plot, group, method);
    return plot_close(&plot, figure, error);
}
