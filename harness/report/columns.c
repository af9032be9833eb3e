/* The columns of all tables, and how numbers are written. */
#include "report/book.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const struct column column_table[COLUMNS_COUNT] = {
#define COLUMN_ROW(field, unit, better, doc) {#field, unit, doc, better},
    FRAME_COLUMNS(COLUMN_ROW) RESULT_COLUMNS(COLUMN_ROW)
#undef COLUMN_ROW
#define COLUMN_ROW(field, word, better, domain, doc)                                               \
    {"same_" #field, "", doc ", reference with the same effects", better},
        METRIC_LIST(COLUMN_ROW)
#undef COLUMN_ROW
#define COLUMN_ROW(field, word, better, domain, doc)                                               \
    {"full_" #field, "", doc ", reference with all effects", better},
            METRIC_LIST(COLUMN_ROW)
#undef COLUMN_ROW
#define COLUMN_ROW(field, word, better, domain, doc)                                               \
    {"floor_" #field, "", doc ", of noise alone, same effects", 0},
                METRIC_LIST(COLUMN_ROW)
#undef COLUMN_ROW
};

const struct shown shown_table[] = {
    {COLUMN_frame_seconds, "frame", "ms", 1e3},
    {COLUMN_fps, "rate", "fps", 1},
    {COLUMN_limit_fraction, "of limit", "%", 100},
    {COLUMN_same_flip, "FLIP, same effects", "", 1},
    {COLUMN_full_flip, "FLIP, all effects", "", 1},
    {COLUMN_same_rmse, "RMSE", "", 1},
    {COLUMN_same_rmse_box8, "RMSE-8", "", 1},
    {COLUMN_full_rmse, "RMSE, all effects", "", 1},
    {COLUMN_same_coverage, "coverage error", "", 1},
    {COLUMN_flicker_mean, "flicker", "", 1},
    {COLUMN_flicker_peak, "flicker peak", "", 1},
    {COLUMN_mask_wrong, "wrong shadow", "%", 100},
    {COLUMN_mask_leak, "lit, should be dark", "%", 100},
    {COLUMN_mask_acne, "dark, should be lit", "%", 100},
    {COLUMN_mask_stray, "far from an edge", "%", 100},
    {COLUMN_mask_edge_px, "from the true edge", "px", 1},
    {COLUMN_mask_shimmer, "shadow shimmer", "%", 100},
    {COLUMN_shadow_seconds, "shadows made in", "ms", 1e3},
    {COLUMN_shadow_bytes, "shadows hold", "MB", 1e-6},
    {COLUMN_floor_rmse, "noise floor (RMSE)", "", 1},
    {COLUMN_host_bytes, "memory", "MB", 1e-6},
    {COLUMN_device_bytes, "GL", "MB", 1e-6},
    {COLUMN_build_seconds, "build", "s", 1},
    {COLUMN_triangles, "triangles", "", 1},
    {COLUMN_draw_calls, "draw calls", "", 1},
    {COLUMN_fragments, "fragments", "", 1},
    {COLUMN_trees_per_second, "trees", "1/s", 1},
    {COLUMN_triangles_per_second, "triangles", "M/s", 1e-6},
    {COLUMN_fragments_per_second, "fragments", "Mpx/s", 1e-6},
    {COLUMN_rays_per_second, "rays", "M/s", 1e-6},
    {COLUMN_lookups_per_second, "lookups", "M/s", 1e-6},
    {COLUMN_samples_per_second, "samples", "M/s", 1e-6},
};
const size_t shown_table_count = sizeof shown_table / sizeof *shown_table;

double row_megabytes(const struct row *row)
{
    double host = row->values[COLUMN_host_bytes], device = row->values[COLUMN_device_bytes];
    if (isnan(host) && isnan(device))
        return NAN;
    return 1e-6 * ((isnan(host) ? 0 : host) + (isnan(device) ? 0 : device));
}

static const char not_measured[] = "\u2013";

/* Puts a comma between thousands of the whole part. */
static void separate_thousands(struct number *number)
{
    char *text = number->text + (*number->text == '-');
    size_t whole = strcspn(text, "."), length = strlen(text);
    for (size_t at = whole; at > 3 && length + 2 < sizeof number->text - 1; length++) {
        at -= 3;
        memmove(text + at + 1, text + at, length - at + 1);
        text[at] = ',';
    }
}

struct number number_plain(double value, int digits)
{
    struct number number = {""};
    if (!isfinite(value)) {
        snprintf(number.text, sizeof number.text, "%s", not_measured);
        return number;
    }
    double magnitude = fabs(value);
    if (value != 0 && (magnitude < 1e-5 || magnitude >= 1e13)) {
        snprintf(number.text, sizeof number.text, "%.*e", digits - 1, value);
        return number;
    }
    char rounded[40]; /* the power of ten after rounding: 0.9996 is 1.00 */
    snprintf(rounded, sizeof rounded, "%.*e", digits - 1, value);
    int decimals = digits - 1 - atoi(strchr(rounded, 'e') + 1);
    decimals = value == 0 || decimals < 0 ? 0 : decimals;
    if (value == floor(value) && magnitude >= 1)
        decimals = 0; /* counts have no decimals */
    snprintf(number.text, sizeof number.text, "%.*f", decimals, value);
    separate_thousands(&number);
    return number;
}

struct number number_short(double value, int digits)
{
    static const char *const suffixes[] = {"", " k", " M", " G", " T"};
    size_t step = 0;
    while (isfinite(value) && fabs(value) >= 9999.5 && step < 4) {
        value /= 1000;
        step++;
    }
    if (isfinite(value) && step && fabs(value) >= 999.5 && step < 4) {
        value /= 1000;
        step++;
    }
    struct number number = number_plain(value, digits);
    strncat(number.text, suffixes[step], sizeof number.text - strlen(number.text) - 1);
    return number;
}

struct number number_exact(double value)
{
    struct number number = {""};
    if (!isfinite(value))
        return number;
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(number.text, sizeof number.text, "%.*g", digits, value);
        if (strtod(number.text, NULL) == value)
            break;
    }
    return number;
}

struct number number_seconds(double seconds)
{
    bool is_short = !(fabs(seconds) >= 1);
    struct number number = number_plain(is_short ? seconds * 1e3 : seconds, 3);
    if (isfinite(seconds))
        strncat(number.text, is_short ? " ms" : " s", sizeof number.text - strlen(number.text) - 1);
    return number;
}

void html_put(FILE *out, const char *text)
{
    for (const char *c = text ? text : ""; *c; c++) {
        if (*c == '<')
            fputs("&lt;", out);
        else if (*c == '>')
            fputs("&gt;", out);
        else if (*c == '&')
            fputs("&amp;", out);
        else if (*c == '"')
            fputs("&quot;", out);
        else if ((unsigned char)*c >= 0x20 || *c == '\n')
            fputc(*c, out);
    }
}
