/* Which static plots the overview has: of the first families, with the most trees. */
#include "report/plot.h"

#include "base/file.h"
#include "report/paper.h"
#include "report/sweep.h"

enum {
    FAMILIES_MAX = 6,
    KINDS_COUNT = 8 + ROOFLINES_COUNT,
    SHADOWS_MAX = 24, /* of all groups */
    SWEEPS_MAX = 6
};

/* Keeps the figure if something was drawn. */
static void keep(struct figures *figures)
{
    figures->count += figures->list[figures->count].name != NULL;
}

static enum status plan_group(const struct book *book, size_t g, const char *folder,
                              struct figures *figures, struct error *error)
{
    const struct group *group = &book->groups[g];
    enum status status = STATUS_OK;
    for (int full = 0; full <= (int)book->effects_differ && status == STATUS_OK; full++) {
        status = plot_trade(book, group, full, folder, &figures->list[figures->count], error);
        keep(figures);
    }
    if (status == STATUS_OK)
        status = plot_masks_distance(book, group, folder, &figures->list[figures->count], error);
    keep(figures);
    if (status == STATUS_OK)
        status = plot_growth(book, group->family, folder, &figures->list[figures->count], error);
    keep(figures);
    for (int axis = 0; axis < VIEW_AXES && status == STATUS_OK; axis++) {
        status = plot_views(book, group, (enum view_axis)axis, folder,
                            &figures->list[figures->count], error);
        keep(figures);
    }
    if (status == STATUS_OK)
        status = plot_pace(book, group, folder, &figures->list[figures->count], error);
    keep(figures);
    for (int kind = 0; kind < ROOFLINES_COUNT && status == STATUS_OK; kind++) {
        status = plot_roofline(book, group, (enum roofline_kind)kind, folder,
                               &figures->list[figures->count], error);
        keep(figures);
    }
    return status;
}

/* Of every group, since what casts is what differs between those of a family: wrong shadows against
 * their price; errors without and with shadows. */
static enum status plan_shadows(const struct book *book, const char *folder,
                                struct figures *figures, struct error *error)
{
    enum status status = STATUS_OK;
    size_t first = figures->count;
    for (size_t g = 0; g < book->groups_count && status == STATUS_OK; g++) {
        if (figures->count + 2 > first + SHADOWS_MAX)
            break;
        status = plot_masks(book, &book->groups[g], folder, &figures->list[figures->count], error);
        keep(figures);
        if (status == STATUS_OK)
            status =
                plot_pairs(book, &book->groups[g], folder, &figures->list[figures->count], error);
        keep(figures);
    }
    return status;
}

/* Error, time, memory and wrong shadows against the options that are swept; error against memory of
 * the group that the headline speaks about. */
static enum status plan_options(const struct book *book, const char *folder,
                                struct figures *figures, struct error *error)
{
    enum status status = STATUS_OK;
    size_t count, front_count;
    const struct sweep *sweeps = sweeps_find(book, &count);
    for (size_t i = 0; i < count && i < SWEEPS_MAX; i++)
        for (int axis = 0; axis < SWEEP_AXES && status == STATUS_OK; axis++) {
            status = plot_sweep(book, &sweeps[i], (enum sweep_axis)axis, folder,
                                &figures->list[figures->count], error);
            keep(figures);
        }
    size_t *front = ARENA_ARRAY(book->arena, size_t, book->rows_count + 1);
    const struct group *group = answer_group(book, front, &front_count);
    if (group && status == STATUS_OK)
        status = plot_memory(book, group, folder, &figures->list[figures->count], error);
    keep(figures);
    return status;
}

static size_t papers_figures(const struct book *book)
{
    size_t count = 0;
    for (size_t i = 0; i < book->besides_count; i++)
        count += 1 + book->besides[i].paper->tables_count;
    return count;
}

enum status plots_draw(const struct book *book, const char *folder, struct figures *figures,
                       struct error *error)
{
    *figures = (struct figures){.list = ARENA_ARRAY(book->arena, struct figure,
                                                    FAMILIES_MAX * KINDS_COUNT + SHADOWS_MAX +
                                                        SWEEPS_MAX * SWEEP_AXES +
                                                        papers_figures(book) + 2)};
    enum status status = file_make_folder(folder, error);
    for (size_t g = 0; g < book->groups_count && status == STATUS_OK; g++)
        if (book_is_overview(book, g) && book->groups[g].family < FAMILIES_MAX)
            status = plan_group(book, g, folder, figures, error);
    if (status == STATUS_OK)
        status = plan_shadows(book, folder, figures, error);
    if (status == STATUS_OK)
        status = plan_options(book, folder, figures, error);
    for (size_t i = 0; i < book->besides_count && status == STATUS_OK; i++) {
        status = plot_paper(book, &book->besides[i], folder, &figures->list[figures->count], error);
        keep(figures);
        for (size_t t = 0; t < book->besides[i].paper->tables_count && status == STATUS_OK; t++) {
            status =
                plot_law(book, &book->besides[i], t, folder, &figures->list[figures->count], error);
            keep(figures);
        }
    }
    return status == STATUS_OK ? plot_draw(book, folder, figures, error) : status;
}
