/* The order of a report: read the run, write tables, draw plots, write the page. */
#include "report/report.h"

#include "base/file.h"
#include "report/book.h"

#include <string.h>

static enum status draw_group(const struct book *book, size_t g, const char *folder,
                              struct plots *plots, struct error *error)
{
    static const enum column_index metrics[] = {COLUMN_same_flip, COLUMN_full_flip,
                                                COLUMN_same_rmse, COLUMN_full_rmse};
    const struct group *group = &book->groups[g];
    enum status status = STATUS_OK;
    for (size_t k = 0; k < 4 && status == STATUS_OK; k++)
        if (book->effects_differ || k % 2 == 0)
            status = plot_trade(book, group, metrics[k], folder, &plots->trade[g][k], error);
    bool drawn;
    if (status == STATUS_OK)
        status = plot_distance(book, group, folder, &plots->distance[g], &drawn, error);
    return status;
}

static enum status draw_plots(const struct book *book, const char *folder, struct plots *plots,
                              struct error *error)
{
    struct arena *arena = book->arena;
    plots->trade = arena_alloc(arena, book->groups_count, sizeof *plots->trade);
    plots->distance = ARENA_ARRAY(arena, struct figure, book->groups_count);
    plots->growth = ARENA_ARRAY(arena, struct figure, book->families_count);
    enum status status = file_make_folder(folder, error);
    for (size_t g = 0; g < book->groups_count && status == STATUS_OK; g++)
        status = draw_group(book, g, folder, plots, error);
    bool drawn;
    for (size_t f = 0; f < book->families_count && status == STATUS_OK; f++)
        status = plot_growth(book, f, folder, &plots->growth[f], &drawn, error);
    return status;
}

static const char *last_name(struct arena *arena, const char *folder)
{
    char *name = arena_strdup(arena, folder);
    size_t length = strlen(name);
    while (length > 1 && name[length - 1] == '/')
        name[--length] = 0;
    char *slash = strrchr(name, '/');
    return slash && slash[1] ? slash + 1 : name;
}

/* A plot that cannot be drawn does not cost the reader the rest: the page says why, and the status
 * tells it. */
static enum status write_all(const struct book *book, const char *out_folder, struct error *error)
{
    struct arena *arena = book->arena;
    enum status status = export_tables(book, arena_printf(arena, "%s/tables", out_folder), error);
    if (status != STATUS_OK)
        return status;
    struct plots plots;
    struct error no_plots = {.status = STATUS_OK};
    enum status drawn =
        draw_plots(book, arena_printf(arena, "%s/plots", out_folder), &plots, &no_plots);
    status = page_write(book, &plots, drawn == STATUS_OK ? NULL : no_plots.text, out_folder, error);
    if (status == STATUS_OK && drawn != STATUS_OK)
        return error_set(error, drawn, "%s/index.html was written without all plots: %s",
                         out_folder, no_plots.text);
    return status;
}

enum status report_write_run(struct arena *arena, const struct run *run, const char *out_folder,
                             struct error *error)
{
    if (run->results_count == 0)
        return error_set(error, STATUS_INVALID, "%s: holds no result yet", run->folder);
    struct book *book = book_make(arena, run);
    book->run_name = last_name(arena, run->folder);
    return write_all(book, out_folder, error);
}

enum status report_write(const char *run_path, const char *out_folder, struct error *error)
{
    struct arena *arena = arena_create(0);
    struct run *run = NULL;
    enum status status = run_read(arena, run_path, &run, error);
    if (status == STATUS_OK)
        status = report_write_run(arena, run, out_folder, error);
    arena_destroy(arena);
    return status;
}
