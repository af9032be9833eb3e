/* Scripts and data for gnuplot: one .gp draws the SVG, a narrow SVG for phones, and a PNG. */
#include "report/plot.h"

#include "base/file.h"
#include "wall/gnuplot.h"

#include <stdlib.h>
#include <string.h>

enum {
    WIDTH_PX = 560,
    HEIGHT_PX = 380,
    NARROW_WIDTH_PX = 340,
    NARROW_HEIGHT_PX = 330,
    KEY_PX = 17
};
static const double timeout_seconds = 60;

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
    fputs("# ", gp);
    plot_text(gp, plot->title);
    fprintf(gp, ". Draws it again: gnuplot %s.gp\n", plot->name);
    fputs("set encoding utf8\nset logscale xy\nset border 3 linecolor rgb \"#5d6875\"\n", gp);
    axis_put(x, "x", gp);
    axis_put(y, "y", gp);
    fprintf(gp, "set tics nomirror scale 0.6 textcolor rgb \"#%06x\"\n", tint_rgb(TINT_MUTED));
    fprintf(gp, "set grid linecolor rgb \"#%06x\" linewidth 0.7 dashtype solid\n",
            tint_rgb(TINT_FAINT));
    const char *const texts[][2] = {
        {"title", plot->title}, {"xlabel", x_label}, {"ylabel", y_label}};
    for (size_t i = 0; i < 3; i++) {
        fprintf(gp, "set %s ", texts[i][0]);
        plot_text(gp, texts[i][1]);
        fprintf(gp, " noenhanced textcolor rgb \"#%06x\"%s\n", tint_rgb(i ? TINT_MUTED : TINT_INK),
                i ? "" : " offset 0,-0.4");
    }
    fprintf(gp,
            "set key below left Left reverse noenhanced samplen 1.6 textcolor rgb \"#%06x\"\n"
            "set bars 0.6\n",
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

void plot_note(struct plot *plot, double x, double y, const char *where, const char *text)
{
    fprintf(plot->gp, "set label %d ", 10 + plot->notes++);
    plot_text(plot->gp, text);
    fprintf(plot->gp, " at %.9g,%.9g %s noenhanced font \",10\" textcolor rgb \"#%06x\" front\n", x,
            y, where, tint_rgb(TINT_MUTED));
}

static void put_terminals(struct plot *plot)
{
    const char *name = plot->name;
    FILE *gp = plot->gp;
    int extra_px = plot->key_rows * KEY_PX;
    fprintf(gp,
            "\nset terminal pngcairo size %d,%d font \"sans,12\" fontscale 2 linewidth 2 "
            "pointscale 2 background \"#ffffff\"\nset output \"%s.png\"\nreplot\n",
            2 * WIDTH_PX, 2 * (HEIGHT_PX + extra_px), name);
    for (int i = 0; i < plot->notes; i++)
        fprintf(gp, "unset label %d\n", 10 + i);
    fprintf(gp,
            "set key maxcols 1\nset terminal svg size %d,%d dynamic font \"sans-serif,12\"\n"
            "set output \"%s-narrow.svg\"\nreplot\nset output\n",
            NARROW_WIDTH_PX, NARROW_HEIGHT_PX + 2 * extra_px, name);
}

/* Rereads an SVG that gnuplot wrote, themes the file, and returns the form for inclusion. */
static enum status adopt_svg(const struct plot *plot, const char *suffix, char **inlined,
                             struct error *error)
{
    struct arena *arena = plot->book->arena, *scratch = arena_create(0);
    const char *path = arena_printf(arena, "%s/%s%s.svg", plot->folder, plot->name, suffix);
    const char *prefix = arena_printf(arena, "%s%s", plot->name, suffix);
    char *svg = NULL;
    size_t size = 0;
    enum status status = file_read(scratch, path, (size_t)1 << 26, &svg, &size, error);
    for (int alone = 1; alone >= 0 && status == STATUS_OK; alone--) {
        char *text = NULL;
        size_t text_size = 0;
        FILE *out = open_memstream(&text, &text_size);
        theme_svg(svg, prefix, plot->title, alone, out);
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
            "set terminal svg size %d,%d dynamic font \"sans-serif,13\"\nset output \"%s.svg\"\n%s",
            WIDTH_PX, HEIGHT_PX + plot->key_rows * KEY_PX, plot->name, plot->script);
    fclose(plot->gp);
    free(plot->script);
    enum status written =
        sheet_write(whole, &text, &size, arena_printf(arena, "%s/%s", plot->folder, script),
                    status == STATUS_OK ? error : NULL);
    status = status == STATUS_OK ? written : status;
    figure->name = plot->name;
    figure->title = plot->title;
    if (status == STATUS_OK)
        status = gnuplot_run(plot->folder, script, timeout_seconds, error);
    if (status == STATUS_OK)
        status = adopt_svg(plot, "", &figure->svg, error);
    if (status == STATUS_OK)
        status = adopt_svg(plot, "-narrow", &figure->svg_narrow, error);
    return status;
}
