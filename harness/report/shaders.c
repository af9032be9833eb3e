/* Error maps of twigs of needles: the shaders against many nodes of the integrals that they stand
 * for. */
#include "report/shaders.h"

#include "bake/needles_double.h"
#include "base/arena.h"
#include "base/file.h"
#include "wall/gnuplot.h"

#include <stdio.h>
#include <stdlib.h>

#define PI 3.14159265358979324

enum { LINES = 120, PLACES = 120 };

/* 2 N r/(pi dh): sparse, the paper's own, dense. */
static const double densities[] = {0.1, 0.4, 1.2};
enum { DENSITIES_COUNT = sizeof densities / sizeof *densities };

/* Of all that is seen, what is hidden and how it shines: opacity times the means of N.L and of
 * (N.H)^n, shadows in both. */
struct point {
    double opacity, light, shine;
};
static const double exponent = 20;

static void fine_depths(const struct needles_twig_double *twig, double density,
                        const double direction[3], double depths[2])
{
    struct needles_sight_double sight = needles_sight_of_double(direction, direction, -1, false);
    struct needles_sums_double sums = needles_converged_sums_double(twig, &sight);
    double flat = sqrt(direction[0] * direction[0] + direction[1] * direction[1]);
    for (int half = 0; half < 2; half++)
        depths[half] = density * sums.seen[half] / (PI * twig->sine * flat);
}

/* Places in the disc one after the other along lines of sight. */
static void fine_lit(const struct needles_disc_double *disc, double seen[2], double lit[2])
{
    seen[0] = seen[1] = lit[0] = lit[1] = 0;
    for (int i = 0; i < LINES; i++) {
        double turn = PI * ((i + 0.5) / LINES - 0.5), aside = sin(turn), edge = cos(turn);
        double depth = 0, step = 2 * edge / PLACES, weight = PI / 2 / LINES * edge;
        for (int j = 0; j < PLACES; j++) {
            double toward = edge - (j + 0.5) * step;
            int half = toward < 0;
            double share = weight * exp(-depth) * -expm1(-disc->eye[half] * step);
            seen[half] += share;
            lit[half] +=
                share *
                exp(-needles_disc_shadow_double(disc, toward * disc->cosine + aside * disc->sine,
                                                aside * disc->cosine - toward * disc->sine));
            depth += disc->eye[half] * step;
        }
    }
}

static struct point truth_of(const struct needles_twig_double *twig,
                             const struct needles_sight_double *sight, double density)
{
    struct needles_disc_double disc = needles_disc_of_double(twig, sight);
    fine_depths(twig, density, sight->eye, disc.eye);
    fine_depths(twig, density, sight->light, disc.light);
    double seen[2], lit[2];
    fine_lit(&disc, seen, lit);
    struct needles_sums_double sums = needles_converged_sums_double(twig, sight);
    struct point point = {seen[0] + seen[1], 0, 0};
    for (int half = 0; half < 2; half++) {
        point.light += lit[half] * sums.diffuse[half] / sums.seen[half];
        point.shine += lit[half] * sums.specular[half] / sums.seen[half];
    }
    return point;
}

static void write_point(FILE *out, double density, int phi_deg, int eye_deg)
{
    const double phi = phi_deg * PI / 180, polar = eye_deg * PI / 180, needles = 16, radius = 1e-3;
    const double eye[3] = {sin(polar), 0, cos(polar)};
    const double light[3] = {sin(PI / 3) * cos(1), sin(PI / 3) * sin(1), cos(PI / 3)};
    struct needles_twig_double twig =
        needles_twig_of_double(phi, needles, 1, radius, 2 * needles * radius / (PI * density));
    struct needles_sight_double sight = needles_sight_of_double(light, eye, exponent, false);
    struct point truth = truth_of(&twig, &sight, density);
    const struct needles_shade_double shades[2] = {
        needles_twig_shade_double(&twig, &sight, true).all,
        needles_paper_twig_shade_double(&twig, &sight).all};
    fprintf(out, "%d %d %.6g %.6g %.6g", eye_deg, phi_deg, truth.opacity, truth.light, truth.shine);
    for (int i = 0; i < 2; i++)
        fprintf(out, " %.6g %.6g %.6g", shades[i].opacity, shades[i].opacity * shades[i].diffuse,
                shades[i].opacity * shades[i].specular);
    fputc('\n', out);
}

static void write_data(FILE *out)
{
    fputs(
        "# Twigs of regular cones, light at 60 degrees to the twig and 57 around it from the eye.\n"
        "# degrees of eye and of needles to the twig; opacity, brightness and shine of an exponent "
        "of 20: converged, exact, paper\n",
        out);
    for (int d = 0; d < DENSITIES_COUNT; d++) {
        fprintf(out, "%s# density A R/dh = %g\n", d ? "\n\n" : "", densities[d]);
        for (int phi = 6; phi <= 86; phi += 4)
            for (int eye = 6; eye <= 174; eye += 4)
                write_point(out, densities[d], phi, eye);
    }
}

static void write_script(FILE *out)
{
    static const struct {
        const char *title;
        int value, truth;
        double least; /* below it errors are of it */
    } columns[] = {{"opacity, paper", 9, 3, 0.01},     {"opacity, exact", 6, 3, 0.01},
                   {"brightness, paper", 10, 4, 0.01}, {"brightness, exact", 7, 4, 0.01},
                   {"shine, paper", 11, 5, 0.001},     {"shine, exact", 8, 5, 0.001}};
    enum { COLUMNS = sizeof columns / sizeof *columns };
    fputs("# Error maps of the shaders of needles. Draws it again: gnuplot shaders.gp\n"
          "set terminal pngcairo size 1800,900 font 'sans,11'\nset output 'shaders.png'\n"
          "set palette defined (0 '#f7f7f7', 1 '#c6dbef', 2 '#6baed6', 3 '#2171b5', 4 '#08306b')\n"
          "set logscale cb\nset cbrange [0.001:1]\nset format cb '%g'\nunset key\nset tics out "
          "nomirror\n"
          "set xrange [4:176]\nset yrange [4:88]\nset xtics 45\nset ytics 30\n"
          "off(x, t, least) = abs(x - t) / (t > least ? t : least)\n"
          "shown(e) = e < 0.001 ? 0.001 : e > 1 ? 1 : e\n"
          "set multiplot layout 3,6 margins 0.08,0.92,0.08,0.9 spacing 0.015,0.06 title "
          "'Relative error of the light of twigs of needles, against converged quadrature'\n"
          "set colorbox user origin 0.94,0.15 size 0.015,0.65\nset cblabel 'relative error'\n",
          out);
    for (int d = 0; d < DENSITIES_COUNT; d++)
        for (int c = 0; c < COLUMNS; c++) {
            fprintf(out, "set title '%s' offset 0,-0.6\n", d ? "" : columns[c].title);
            fprintf(out, "set xlabel '%s' offset 0,0.4\nset format x '%s'\n",
                    d == DENSITIES_COUNT - 1 ? "eye to twig [degrees]" : "",
                    d == DENSITIES_COUNT - 1 ? "%g" : "");
            fprintf(out, "set format y '%s'\n", c ? "" : "%g");
            if (c)
                fputs("set ylabel ''\n", out);
            else
                fprintf(out,
                        "set ylabel \"density %g\\nneedles to twig [degrees]\" offset -2.5,0\n",
                        densities[d]);
            fprintf(out,
                    "plot 'shaders.dat' index %d using 1:2:(shown(off($%d, $%d, %g))) with image\n",
                    d, columns[c].value, columns[c].truth, columns[c].least);
            if (d == 0 && c == 0)
                fputs("unset colorbox\n", out);
        }
    fputs("unset multiplot\n", out);
}

static enum status put_file(struct arena *arena, const char *folder, const char *name,
                            void (*write)(FILE *), struct error *error)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    write(out);
    fclose(out);
    enum status status = file_write(arena_printf(arena, "%s/%s", folder, name), text, size, error);
    free(text);
    return status;
}

enum status shaders_draw(const char *folder, struct error *error)
{
    struct arena *arena = arena_create(0);
    enum status status = file_make_folder(folder, error);
    if (status == STATUS_OK)
        status = put_file(arena, folder, "shaders.dat", write_data, error);
    if (status == STATUS_OK)
        status = put_file(arena, folder, "shaders.gp", write_script, error);
    if (status == STATUS_OK)
        status = gnuplot_run(folder, "shaders.gp", 60, error);
    arena_destroy(arena);
    return status;
}
