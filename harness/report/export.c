/* Tables as CSV (every column, SI units), Markdown and LaTeX (the columns people read). */
#include "report/book.h"

#include "base/file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum status sheet_write(FILE *sheet, char **data, const size_t *size, const char *path,
                        struct error *error)
{
    bool whole = !ferror(sheet);
    whole = fclose(sheet) == 0 && whole;
    enum status status = whole
                             ? file_write(path, *data, *size, error)
                             : error_set(error, STATUS_MEMORY, "%s: no memory for the text", path);
    free(*data);
    return status;
}

void csv_text(FILE *out, const char *text)
{
    bool quote = strpbrk(text, ",\"\r\n") != NULL;
    if (!quote) {
        fputs(text, out);
        return;
    }
    fputc('"', out);
    for (const char *c = text; *c; c++) {
        if (*c == '"')
            fputc('"', out);
        fputc(*c, out);
    }
    fputc('"', out);
}

static const char *state_word(const struct row *row)
{
    return row->ok ? "ok" : status_word(row->seen->status);
}

static void write_csv(const struct book *book, FILE *out)
{
    fputs("cell,scene,trees,width_px,height_px,seed,method,options,lod,target,status,on_front,"
          "bound_by",
          out);
    for (size_t c = 0; c < COLUMNS_COUNT; c++)
        fprintf(out, ",%s", column_table[c].key);
    fputs(",message\n", out);
    for (size_t i = 0; i < book->rows_count; i++) {
        const struct row *row = &book->rows[i];
        const struct cell *cell = &row->seen->cell;
        csv_text(out, cell->name);
        fputc(',', out);
        csv_text(out, cell->scene);
        fprintf(out, ",%zu,%d,%d,%llu,", row->trees, cell->width_px, cell->height_px,
                (unsigned long long)cell->seed);
        csv_text(out, cell->method_name);
        fputc(',', out);
        csv_text(out, cell->options);
        fprintf(out, ",%s,%s,%s,%d,%s", lod_word(cell->lod), target_format_word(cell->format),
                state_word(row), row->summary->on_front, limit_word(row->summary->limit.resource));
        for (size_t c = 0; c < COLUMNS_COUNT; c++)
            fprintf(out, ",%s", number_exact(row->values[c]).text);
        fputc(',', out);
        csv_text(out, row->ok ? "" : row->seen->message);
        fputc('\n', out);
    }
}

static struct number shown_number(const struct row *row, const struct shown *shown)
{
    double value = row->values[shown->column] * shown->scale;
    return value >= 1e5 ? number_short(value, 3) : number_plain(value, 3);
}

void markdown_text(FILE *out, const char *text)
{
    for (const char *c = text; *c; c++) {
        if (strchr("|\\`*_<>[]", *c))
            fputc('\\', out);
        fputc(*c == '\n' ? ' ' : *c, out);
    }
}

static void write_markdown(const struct book *book, FILE *out)
{
    fputs("| scene | trees | method |", out);
    for (size_t c = 0; c < book->shown_count; c++) {
        const struct shown *shown = &book->shown[c];
        fprintf(out, *shown->unit ? " %s [%s] |" : " %s |", shown->heading, shown->unit);
        if (shown->column == COLUMN_frame_seconds)
            fputs(" 95 % interval [ms] |", out);
        if (shown->column == COLUMN_limit_fraction)
            fputs(" bound by |", out);
    }
    fputs(" front |\n|:--|--:|:--|", out);
    size_t columns = book->shown_count + 1 + book_knows(book, COLUMN_limit_fraction);
    for (size_t c = 0; c < columns; c++)
        fputs("--:|", out);
    fputs(":-:|\n", out);
    for (size_t i = 0; i < book->rows_count; i++) {
        const struct row *row = &book->rows[i];
        fputs("| ", out);
        markdown_text(out, book->families[book->groups[row->group].family]);
        fprintf(out, " | %zu | ", row->trees);
        markdown_text(out, row->label);
        fputs(" |", out);
        for (size_t c = 0; c < book->shown_count; c++) {
            const struct shown *shown = &book->shown[c];
            bool first = shown->column == COLUMN_frame_seconds;
            if (first && !row->ok)
                fprintf(out, " %s |", state_word(row));
            else
                fprintf(out, " %s |", shown_number(row, shown).text);
            if (first && row->ok)
                fprintf(out, " %s to %s |",
                        number_plain(row->values[COLUMN_frame_seconds_low] * 1e3, 3).text,
                        number_plain(row->values[COLUMN_frame_seconds_high] * 1e3, 3).text);
            else if (first)
                fputs(" \u2013 |", out);
            if (shown->column == COLUMN_limit_fraction)
                fprintf(out, " %s |", limit_word(row->summary->limit.resource));
        }
        fprintf(out, " %s |\n", row->summary->on_front ? "*" : "");
    }
}

static void tex_text(FILE *out, const char *text)
{
    for (const char *c = text; *c; c++) {
        if (*c == '\\')
            fputs("\\textbackslash{}", out);
        else if (*c == '~' || *c == '^')
            fprintf(out, "\\%c{}", *c);
        else if (strchr("#$%&_{}", *c))
            fprintf(out, "\\%c", *c);
        else if (strncmp(c, "\u2013", 3) == 0) {
            fputs("--", out);
            c += 2;
        } else
            fputc(*c == '\n' ? ' ' : *c, out);
    }
}

static void write_latex(const struct book *book, FILE *out)
{
    fputs("% Needs \\usepackage{booktabs}. Bold: on the front of frame time and FLIP.\n", out);
    fputs("\\begin{tabular}{lrl", out);
    for (size_t c = 0; c < book->shown_count; c++)
        fputs(book->shown[c].column == COLUMN_limit_fraction ? "rl" : "r", out);
    fputs("}\n\\toprule\nscene & trees & method", out);
    for (size_t c = 0; c < book->shown_count; c++) {
        fputs(" & ", out);
        tex_text(out, book->shown[c].heading);
        if (*book->shown[c].unit)
            fprintf(out, *book->shown[c].unit == '%' ? " [\\%s]" : " [%s]", book->shown[c].unit);
        if (book->shown[c].column == COLUMN_limit_fraction)
            fputs(" & bound by", out);
    }
    fputs(" \\\\\n\\midrule\n", out);
    for (size_t i = 0; i < book->rows_count; i++) {
        const struct row *row = &book->rows[i];
        tex_text(out, book->families[book->groups[row->group].family]);
        fprintf(out, " & %zu & ", row->trees);
        fputs(row->summary->on_front ? "\\textbf{" : "", out);
        tex_text(out, row->label);
        fputs(row->summary->on_front ? "}" : "", out);
        for (size_t c = 0; c < book->shown_count; c++) {
            fputs(" & ", out);
            bool failed = !row->ok && book->shown[c].column == COLUMN_frame_seconds;
            tex_text(out, failed ? state_word(row) : shown_number(row, &book->shown[c]).text);
            if (book->shown[c].column == COLUMN_limit_fraction)
                fprintf(out, " & %s", limit_word(row->summary->limit.resource));
        }
        fputs(" \\\\\n", out);
    }
    fputs("\\bottomrule\n\\end{tabular}\n", out);
}

enum status export_write(const struct book *book, const char *folder,
                         const struct export_table *tables, size_t count, struct error *error)
{
    enum status status = file_make_folder(folder, error);
    for (size_t i = 0; i < count && status == STATUS_OK; i++) {
        char *text = NULL;
        size_t size = 0;
        FILE *out = open_memstream(&text, &size);
        if (!out)
            return error_errno(error, STATUS_MEMORY, "%s/%s", folder, tables[i].name);
        tables[i].write(book, out);
        status = sheet_write(out, &text, &size,
                             arena_printf(book->arena, "%s/%s", folder, tables[i].name), error);
    }
    return status;
}

enum status export_tables(const struct book *book, const char *folder, struct error *error)
{
    static const struct export_table tables[] = {
        {"results.csv", write_csv}, {"results.md", write_markdown}, {"results.tex", write_latex}};
    enum status status = export_write(book, folder, tables, 3, error);
    return status == STATUS_OK ? export_papers(book, folder, error) : status;
}
