/* One palette for plots and page, in light and dark, and gnuplot's SVG made to follow it.
 *
 * The method colours follow Okabe and Ito 2008, "Color Universal Design", darkened or lightened
 * until each has a contrast of at least 3 with its ground; every method has a symbol of its own
 * besides. */
#include "report/book.h"

#include <stdlib.h>
#include <string.h>

static const struct {
    const char *variable;
    unsigned light, dark;
} tints[] = {
    {"ink", 0x1d2733, 0xe7ebf0},    {"muted", 0x5d6875, 0x9aa5b1},  {"faint", 0xdfe3e8, 0x333c46},
    {"m0", 0x0072b2, 0x56b4e9},     {"m1", 0xd55e00, 0xff8a3d},     {"m2", 0x00866a, 0x2fc79b},
    {"m3", 0xb0458f, 0xe79acb},     {"m4", 0x9a7400, 0xf0cf4a},     {"m5", 0x4b4fb5, 0xa9acf5},
    {"m6", 0x8a3b12, 0xd3a07f},     {"m7", 0x4f6f00, 0xb3d35c},     {"page", 0xfbfbf9, 0x12171d},
    {"panel", 0xfefefe, 0x1a2027},  {"accent", 0x0a5c8f, 0x7cc4f2}, {"bad", 0xa32020, 0xff8f86},
    {"raised", 0xf2f4f3, 0x222a33}, {"line", 0xc3c9d0, 0x4a5561},
};
enum { TINTS_COUNT = sizeof tints / sizeof *tints, SYMBOLS_COUNT = 6 };

/* gnuplot's filled point type (the open one is one less) and the same as an SVG path. */
static const struct {
    int type;
    const char *svg;
} symbols[SYMBOLS_COUNT] = {
    {7, "<circle r=\"1\"/>"},
    {5, "<rect x=\"-.95\" y=\"-.95\" width=\"1.9\" height=\"1.9\"/>"},
    {9, "<path d=\"M0-1.25 1.2.85H-1.2z\"/>"},
    {13, "<path d=\"M0-1.35 1.35 0 0 1.35-1.35 0z\"/>"},
    {11, "<path d=\"M0 1.25 1.2-.85H-1.2z\"/>"},
    {15, "<path d=\"M0-1.25 1.19-.39.73 1.01H-.73L-1.19-.39z\"/>"},
};

unsigned tint_rgb(size_t tint)
{
    return tints[tint < TINTS_COUNT ? tint : TINT_INK].light;
}

/* A method's place among those that draw trees; null has none. */
static size_t place_of(const struct book *book, size_t method_index)
{
    size_t place = 0;
    for (size_t i = 0; i < method_index; i++)
        place += strcmp(book->methods[i], "null") != 0;
    return place;
}

size_t tint_method(const struct book *book, size_t method_index)
{
    if (strcmp(book->methods[method_index], "null") == 0)
        return TINT_MUTED;
    return TINT_METHOD + place_of(book, method_index) % TINT_METHODS;
}

const char *tint_variable(size_t tint)
{
    return tints[tint < TINTS_COUNT ? tint : TINT_INK].variable;
}

static bool draws_nothing(const struct book *book, size_t method_index)
{
    return strcmp(book->methods[method_index], "null") == 0;
}

const char *symbol_html(const struct book *book, size_t method_index)
{
    if (draws_nothing(book, method_index))
        return "<path d=\"M-.25-1.2h.5v.95h.95v.5h-.95v.95h-.5v-.95h-.95v-.5h.95z\"/>";
    return symbols[place_of(book, method_index) % SYMBOLS_COUNT].svg;
}

int symbol_gnuplot(const struct book *book, size_t method_index, bool filled)
{
    if (draws_nothing(book, method_index))
        return 1; /* + */
    return symbols[place_of(book, method_index) % SYMBOLS_COUNT].type - !filled;
}

static void put_tints(bool dark, FILE *out)
{
    fprintf(out, "{color-scheme:%s", dark ? "dark" : "light");
    for (size_t i = 0; i < TINTS_COUNT; i++)
        fprintf(out, ";--%s:#%06x", tints[i].variable, dark ? tints[i].dark : tints[i].light);
    fputc('}', out);
}

/* The page's switch sets data-theme; without it the reader's system decides. Paper is light. */
void theme_css(FILE *out)
{
    fputs(":root", out);
    put_tints(false, out);
    fputs("\n@media screen and (prefers-color-scheme:dark){:root:not([data-theme=light])", out);
    put_tints(true, out);
    fputs("}\n@media screen{:root[data-theme=dark]", out);
    put_tints(true, out);
    fputs("}\n", out);
}

void html_put_mark(FILE *out, const struct book *book, size_t method_index)
{
    fprintf(out,
            "<svg class=\"mark\" viewBox=\"-1.5 -1.5 3 3\" aria-hidden=\"true\" "
            "style=\"color:var(--%s)\">%s</svg>",
            tint_variable(tint_method(book, method_index)), symbol_html(book, method_index));
}

void html_put_label(FILE *out, const struct book *book, const struct row *row)
{
    html_put_mark(out, book, row->method_index);
    html_put(out, row->label);
}

/* "rgb( 29,  39,  51)" of the palette becomes "var(--ink)"; returns the characters taken, 0: not
 * one. */
static size_t put_color(const char *at, FILE *out)
{
    unsigned red, green, blue;
    int taken = 0;
    if (sscanf(at, "rgb(%u,%u,%u)%n", &red, &green, &blue, &taken) != 3 || taken <= 0)
        return 0;
    for (size_t i = 0; i < TINTS_COUNT; i++)
        if (tints[i].light == (red << 16 | green << 8 | blue)) {
            fprintf(out, "var(--%s)", tints[i].variable);
            return (size_t)taken;
        }
    return 0;
}

static bool starts(const char *at, const char *with)
{
    return strncmp(at, with, strlen(with)) == 0;
}

/* Ids and references get the prefix, so that many plots can stand on one page. */
static size_t put_id(const char *at, const char *prefix, FILE *out)
{
    static const char *const openings[] = {"id='", "id=\"", "href='#", "href=\"#", "url(#"};
    for (size_t i = 0; i < sizeof openings / sizeof *openings; i++)
        if (starts(at, openings[i])) {
            fprintf(out, "%s%s-", openings[i], prefix);
            return strlen(openings[i]);
        }
    return 0;
}

/* The two colours that gnuplot names: of the pen, and of what lies behind it. */
static size_t put_named_color(const char *at, FILE *out)
{
    static const char *const names[][2] = {{"black", "ink"}, {"white", "panel"}};
    for (size_t i = 0; i < 2; i++) {
        size_t length = strlen(names[i][0]);
        if (starts(at + 1, names[i][0]) && at[1 + length] == at[0]) {
            fprintf(out, "%cvar(--%s)%c", at[0], names[i][1], at[0]);
            return length + 2;
        }
    }
    return 0;
}

static void put_opening(const char *svg, const char *title, bool alone, FILE *out)
{
    const char *box = strstr(svg, "viewBox=\"");
    int length = box ? (int)strcspn(box + 9, "\"") : 0;
    fprintf(out, "<svg xmlns=\"http://www.w3.org/2000/svg\" "
                 "xmlns:xlink=\"http://www.w3.org/1999/xlink\" class=\"plot\" role=\"img\" ");
    fprintf(out, "viewBox=\"%.*s\" aria-label=\"", length, box ? box + 9 : "");
    html_put(out, title);
    fputs("\">\n", out);
    if (!alone)
        return;
    fputs("<title>", out);
    html_put(out, title);
    fputs("</title>\n<style>\n", out);
    theme_css(out);
    fputs("svg{background:var(--panel)}\n</style>\n", out);
}

void theme_svg(const char *svg, const char *prefix, const char *title, bool alone, FILE *out)
{
    const char *at = strstr(svg, "<svg");
    if (!at)
        return;
    if (alone)
        fputs("<?xml version=\"1.0\" encoding=\"utf-8\"?>\n", out);
    put_opening(at, title, alone, out);
    at = strchr(at, '>');
    const char *after_title = strstr(svg, "</desc>");
    at = after_title ? after_title + strlen("</desc>") : at + 1;
    for (char before = ' '; *at; before = *at, at++) {
        size_t taken = 0;
        bool word_start = !((before >= 'a' && before <= 'z') || before == '-');
        if (*at == 'r')
            taken = put_color(at, out);
        else if ((*at == 'i' && word_start) || *at == 'h' || *at == 'u')
            taken = put_id(at, prefix, out);
        else if (*at == '\'' || *at == '"')
            taken = put_named_color(at, out);
        else if (*at == '\t' || (*at == '\n' && before == '\n'))
            continue;
        if (taken)
            at += taken - 1;
        else
            fputc(*at, out);
    }
}
