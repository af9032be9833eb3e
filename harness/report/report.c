/* The order of a report: read the run, write tables, draw plots, write the page. */
#include "report/report.h"

#include "base/file.h"
#include "report/book.h"
#include "report/paper.h"

#include <string.h>

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
    struct figures figures = {0};
    struct error no_plots = {.status = STATUS_OK};
    enum status drawn =
        plots_draw(book, arena_printf(arena, "%s/plots", out_folder), &figures, &no_plots);
    status =
        page_write(book, &figures, drawn == STATUS_OK ? NULL : no_plots.text, out_folder, error);
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
    struct paper *papers;
    size_t papers_count;
    enum status status = papers_read(arena, arena_printf(arena, "%s/reports/papers", data_folder()),
                                     &papers, &papers_count, error);
    if (status != STATUS_OK)
        return status;
    struct book *book = book_make(arena, run);
    book->run_name = last_name(arena, run->folder);
    book->besides = papers_beside(book, papers, papers_count, &book->besides_count);
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
