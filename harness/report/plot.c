/* Scripts and data for gnuplot: one .gp draws the SVG, a narrow SVG for phones, and a PNG. */
#include "report/plot.h"

#include "base/file.h"
#include "wall/gnuplot.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    WIDTH_PX = 560,
    HEIGHT_PX = 350,
    NARROW_WIDTH_PX = 340,
    NARROW_HEIGHT_PX = 300,
    KEY_PX = 17
};
static const double timeout_seconds = 120;

void plot_open(struct plot *plot, const struct book *book, const char *folder, const char *name,
               const char *title)
{
    *plot = (struct plot){.book = book, .folder = folder, .name = name, .title = title};
    plot->gp = open_memstream(&plot->script, &plot->script_size);
    plot->dat = open_memstream(&plot->data, &plot->data_size);
}

void plot_text(FILE *out, const char *text)
{
    fputc('"', out);
    for (const char *c = text; *c; c++) {
        if (*c == '"' || *c == '\\')
            fputc('\\', out);
        fputc((unsigned char)*c < 0x20 ? ' ' : *c, out);
    }
    fputc('"', out);
}

void plot_axes(struct plot *plot, const struct axis *x, const struct axis *y, const char *x_label,
               const char *y_label)
{
    FILE *gp = plot->gp;
    plot->x = *x;
    plot->y = *y;
    fputs("# ", gp);
    plot_text(gp, plot->title);
    fprintf(gp, ". Draws it again: gnuplot %s.gp\n", plot->name);
    fprintf(gp, "set encoding utf8\nset logscale %s\nset border 3 linecolor rgb \"#5d6875\"\n",
            x->is_degrees ? "y" : "xy");
    axis_put(x, "x", gp);
    axis_put(y, "y", gp);
    fprintf(gp, "set tics nomirror scale 0.6 textcolor rgb \"#%06x\"\n", tint_rgb(TINT_MUTED));
    fprintf(gp, "set grid linecolor rgb \"#%06x\" linewidth 0.7 dashtype solid\n",
            tint_rgb(TINT_FAINT));
    const char *const texts[][2] = {
        {"title", plot->title}, {"xlabel", x_label}, {"ylabel", y_label}};
    static const char *const offsets[] = {" offset 0,-0.5", " offset 0,0.4", " offset 0,0"};
    for (size_t i = 0; i < 3; i++) {
        fprintf(gp, "set %s ", texts[i][0]);
        plot_text(gp, texts[i][1]);
        if (i == 1)
            fputs(".\"\\n \"", gp); /* room between the label and the key */
        fprintf(gp, " noenhanced textcolor rgb \"#%06x\"%s\n", tint_rgb(i ? TINT_MUTED : TINT_INK),
                offsets[i]);
    }
    fprintf(gp,
            "set key below left Left reverse noenhanced samplen 1.6 textcolor rgb "
            "\"#%06x\"\n"
            "set bars 0.6\nset pointintervalbox 0\n",
            tint_rgb(TINT_INK));
}

int plot_block(struct plot *plot, const char *what)
{
    fprintf(plot->dat, "%s# %s\n", plot->blocks ? "\n\n" : "", what);
    return plot->blocks++;
}

void plot_curve(struct plot *plot)
{
    fputs(plot->curves++ ? ", \\\n    " : "plot ", plot->gp);
}

void plot_points(struct plot *plot, int block, const char *how, size_t method, bool filled,
                 const char *title)
{
    const struct book *book = plot->book;
    plot_curve(plot);
    fprintf(plot->gp,
            "\"%s.dat\" index %d %s pointtype %d pointsize 0.9 linewidth 1 linecolor rgb "
            "\"#%06x\" ",
            plot->name, block, how, symbol_gnuplot(book, method, filled),
            tint_rgb(tint_method(book, method)));
    fputs(title ? "title " : "notitle", plot->gp);
    if (!title)
        return;
    plot_text(plot->gp, title);
    plot->key_rows++;
}

void plot_upright(struct plot *plot, int number, double x, const char *text)
{
    unsigned muted = tint_rgb(TINT_MUTED);
    fprintf(plot->gp,
            "set arrow %d from first %.9g, graph 0 to first %.9g, graph 1 nohead dashtype 3 "
            "linecolor rgb \"#%06x\"\nset label %d ",
            number, x, x, muted, number);
    plot_text(plot->gp, text);
    fprintf(plot->gp,
            " at first %.9g, graph 0.98 right rotate by 90 offset 0.8,0 font \",10\" textcolor rgb "
            "\"#%06x\"\n",
            x, muted);
}

/* The plotting area of the wide version, about, and of its small letters. */
static const double area_width_px = 440, area_height_px = 245, letter_px = 7.4, line_px = 12;

static bool boxes_touch(const struct plot_box *a, const struct plot_box *b)
{
    return a->left < b->right && b->left < a->right && a->bottom < b->top && b->bottom < a->top;
}

static bool box_is_free(const struct plot *plot, const struct plot_box *box)
{
    if (box->left < 2 || box->right > area_width_px || box->bottom < 2 || box->top > area_height_px)
        return false;
    for (size_t i = 0; i < plot->boxes_count; i++)
        if (boxes_touch(box, &plot->boxes[i]))
            return false;
    return true;
}

static double place_px(const struct axis *axis, double value, double length_px)
{
    return length_px * log(value / axis->low) / log(axis->high / axis->low);
}

void plot_keep_clear(struct plot *plot, double x, double y)
{
    double at_x = place_px(&plot->x, x, area_width_px);
    double at_y = place_px(&plot->y, y, area_height_px);
    if (plot->boxes_count < sizeof plot->boxes / sizeof *plot->boxes)
        plot->boxes[plot->boxes_count++] =
            (struct plot_box){at_x - 5, at_x + 5, at_y - 5, at_y + 5};
}

void plot_keep_clear_line(struct plot *plot, double x, double y, double to_x, double to_y)
{
    double from[2] = {place_px(&plot->x, x, area_width_px), place_px(&plot->y, y, area_height_px)};
    double to[2] = {place_px(&plot->x, to_x, area_width_px),
                    place_px(&plot->y, to_y, area_height_px)};
    if (plot->boxes_count < sizeof plot->boxes / sizeof *plot->boxes)
        plot->boxes[plot->boxes_count++] =
            (struct plot_box){fmin(from[0], to[0]) - 1, fmax(from[0], to[0]) + 1,
                              fmin(from[1], to[1]) - 1, fmax(from[1], to[1]) + 1};
}

/* The value at so many pixels of an axis. */
static double value_at(const struct axis *axis, double px, double length_px)
{
    return axis->low * pow(axis->high / axis->low, px / length_px);
}

void plot_number(struct plot *plot, double x, double y, int number)
{
    static const double steps_px[] = {11, 15, 20, 26, 33, 41, 50}, beside_px = 15;
    enum { TURNS = 16 };
    double at[2] = {place_px(&plot->x, x, area_width_px), place_px(&plot->y, y, area_height_px)};
    double half = number < 10 ? 4 : 7;
    struct plot_box box = {0};
    for (size_t step = 0; step < sizeof steps_px / sizeof *steps_px; step++)
        for (int turn = 0; turn < TURNS; turn++) {
            /* up and to the right first */
            double angle = M_PI / 4 + 2 * M_PI * turn / TURNS;
            double middle[2] = {at[0] + steps_px[step] * cos(angle),
                                at[1] + steps_px[step] * sin(angle)};
            box = (struct plot_box){middle[0] - half, middle[0] + half, middle[1] - line_px / 2,
                                    middle[1] + line_px / 2};
            if (!box_is_free(plot, &box) ||
                plot->boxes_count == sizeof plot->boxes / sizeof *plot->boxes)
                continue;
            plot->boxes[plot->boxes_count++] = box;
            double to_x = value_at(&plot->x, middle[0], area_width_px);
            double to_y = value_at(&plot->y, middle[1], area_height_px);
            fprintf(plot->gp,
                    "set label %d \"%d\" at %.9g,%.9g center font \",10\" textcolor rgb "
                    "\"#%06x\" front\n",
                    1000 + plot->numbers, number, to_x, to_y, tint_rgb(TINT_MUTED));
            if (steps_px[step] > beside_px)
                fprintf(plot->gp,
                        "set arrow %d from %.9g,%.9g to %.9g,%.9g nohead linewidth 0.5 "
                        "linecolor rgb \"#%06x\"\n",
                        1000 + plot->numbers, x, y,
                        value_at(&plot->x, middle[0] - (half + 1) * cos(angle), area_width_px),
                        value_at(&plot->y, middle[1] - 6 * sin(angle), area_height_px),
                        tint_rgb(TINT_MUTED));
            plot->numbers++;
            return;
        }
}

void plot_note(struct plot *plot, double x, double y, const char *text)
{
    /* Below a front nothing stands, so there first. Sides: -1 ends at the point, +1 begins there.
     */
    static const struct {
        int side, up;
    } places[] = {{-1, -1}, {+1, +1}, {-1, 0}, {+1, 0}, {+1, -1}, {-1, +1}};
    double width = letter_px * (double)strlen(text);
    double at_x = place_px(&plot->x, x, area_width_px);
    double at_y = place_px(&plot->y, y, area_height_px);
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        double start = at_x + places[i].side * 9.0, middle = at_y + places[i].up * 10.0;
        struct plot_box box = {fmin(start, start + places[i].side * width),
                               fmax(start, start + places[i].side * width), middle - line_px / 2,
                               middle + line_px / 2};
        if (!box_is_free(plot, &box) ||
            plot->boxes_count == sizeof plot->boxes / sizeof *plot->boxes)
            continue;
        plot->boxes[plot->boxes_count++] = box;
        fprintf(plot->gp, "set label %d ", 10 + plot->notes++);
        plot_text(plot->gp, text);
        fprintf(plot->gp,
                " at %.9g,%.9g %s offset %.2f,%.2f noenhanced font \",10\" textcolor rgb "
                "\"#%06x\" front\n",
                x, y, places[i].side < 0 ? "right" : "left", places[i].side * 1.2,
                places[i].up * 0.75, tint_rgb(TINT_MUTED));
        return;
    }
}

void plot_line_note(struct plot *plot, double y, const char *text)
{
    double at_y = place_px(&plot->y, y, area_height_px);
    if (plot->boxes_count < sizeof plot->boxes / sizeof *plot->boxes)
        plot->boxes[plot->boxes_count++] = (struct plot_box){
            area_width_px - letter_px * (double)strlen(text), area_width_px, at_y, at_y + line_px};
    fputs("set label 1 ", plot->gp);
    plot_text(plot->gp, text);
    fprintf(plot->gp,
            " at graph 0.99, first %.9g right offset 0,0.5 noenhanced font \",10\" textcolor rgb "
            "\"#%06x\"\n",
            y, tint_rgb(TINT_MUTED));
}

static void put_terminals(struct plot *plot)
{
    const char *name = plot->name;
    FILE *gp = plot->gp;
    int extra_px = (plot->key_rows + 1) * KEY_PX;
    fprintf(gp,
            "\nset terminal pngcairo size %d,%d font \"sans,12\" fontscale 2 linewidth 2 "
            "pointscale 2 background \"#ffffff\"\nset output \"%s.png\"\nreplot\n",
            2 * WIDTH_PX, 2 * (HEIGHT_PX + extra_px), name);
    for (int i = 0; i < plot->notes; i++)
        fprintf(gp, "unset label %d\n", 10 + i);
    fprintf(gp,
            "set key maxcols 1\nset terminal svg size %d,%d dynamic font \"sans-serif,12\"\n"
            "set output \"%s-narrow.svg\"\nreplot\nset output\n",
            NARROW_WIDTH_PX, NARROW_HEIGHT_PX + (plot->columns > 1 ? plot->columns : 1) * extra_px,
            name);
}

void plot_discard(struct plot *plot)
{
    fclose(plot->gp);
    fclose(plot->dat);
    free(plot->script);
    free(plot->data);
}

enum status plot_close(struct plot *plot, struct figure *figure, struct error *error)
{
    struct arena *arena = plot->book->arena;
    put_terminals(plot);
    const char *script = arena_printf(arena, "%s.gp", plot->name);
    enum status status =
        sheet_write(plot->dat, &plot->data, &plot->data_size,
                    arena_printf(arena, "%s/%s.dat", plot->folder, plot->name), error);
    /* The first terminal must stand before "plot"; the rest replots. */
    fflush(plot->gp);
    char *text = NULL;
    size_t size = 0;
    FILE *whole = open_memstream(&text, &size);
    fprintf(whole,
            "set terminal svg size %d,%d dynamic font \"sans-serif,13\"\nset output \"%s.svg\"\n",
            WIDTH_PX, HEIGHT_PX + (plot->key_rows + 1) * KEY_PX, plot->name);
    if (plot->columns > 1)
        fprintf(whole, "set key maxcols %d\n", plot->columns);
    fputs(plot->script, whole);
    fclose(plot->gp);
    free(plot->script);
    enum status written =
        sheet_write(whole, &text, &size, arena_printf(arena, "%s/%s", plot->folder, script),
                    status == STATUS_OK ? error : NULL);
    status = status == STATUS_OK ? written : status;
    figure->name = plot->name;
    figure->title = plot->title;
    return status;
}

/* Rereads an SVG that gnuplot wrote, themes the file, and returns the form for inclusion. */
static enum status adopt_svg(struct arena *arena, const char *folder, const struct figure *figure,
                             const char *suffix, char **inlined, struct error *error)
{
    struct arena *scratch = arena_create(0);
    const char *path = arena_printf(scratch, "%s/%s%s.svg", folder, figure->name, suffix);
    const char *prefix = arena_printf(scratch, "%s%s", figure->name, suffix);
    char *svg = NULL;
    size_t size = 0;
    enum status status = file_read(scratch, path, (size_t)1 << 26, &svg, &size, error);
    for (int alone = 1; alone >= 0 && status == STATUS_OK; alone--) {
        char *text = NULL;
        size_t text_size = 0;
        FILE *out = open_memstream(&text, &text_size);
        theme_svg(svg, prefix, figure->title, alone, out);
        if (alone) {
            status = sheet_write(out, &text, &text_size, path, error);
        } else {
            fclose(out);
            *inlined = arena_strdup(arena, text);
            free(text);
        }
    }
    arena_destroy(scratch);
    return status;
}

enum status plot_draw(const struct book *book, const char *folder, const struct figures *figures,
                      struct error *error)
{
    if (figures->count == 0)
        return STATUS_OK;
    char *text = NULL;
    size_t size = 0;
    FILE *all = open_memstream(&text, &size);
    fputs("# Draws every plot of this folder again: gnuplot all.gp\n", all);
    for (size_t i = 0; i < figures->count; i++)
        fprintf(all, "reset\nload \"%s.gp\"\n", figures->list[i].name);
    const char *path = arena_printf(book->arena, "%s/all.gp", folder);
    enum status status = sheet_write(all, &text, &size, path, error);
    if (status == STATUS_OK)
        status = gnuplot_run(folder, "all.gp", timeout_seconds, error);
    for (size_t i = 0; i < figures->count && status == STATUS_OK; i++) {
        struct figure *figure = &figures->list[i];
        status = adopt_svg(book->arena, folder, figure, "", &figure->svg, error);
        if (status == STATUS_OK)
            status = adopt_svg(book->arena, folder, figure, "-narrow", &figure->svg_narrow, error);
    }
    return status;
}
