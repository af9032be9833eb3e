/* Papers' printed tables beside ours, and their claims, as CSV and Markdown. */
#include "report/paper.h"

#include "base/file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *state_of(const struct paper_line *line)
{
    return !line->ours    ? "not measured"
           : line->rounds ? "ok"
                          : status_word(line->ours->seen->status);
}

static void put_csv_number(FILE *out, double value)
{
    fprintf(out, ",%s", number_exact(value).text);
}

static void write_csv(const struct book *book, FILE *out)
{
    static const char *const statistics[] = {"median", "worst", "best"};
    fputs("paper,table,unit,trees,lod,effects,statistic,printed,printed_ratio,cell,state,rounds,"
          "ours,ours_low,ours_high,ratio,ratio_low,ratio_high\n",
          out);
    for (size_t p = 0; p < book->besides_count; p++)
        for (size_t b = 0; b < book->besides[p].blocks_count; b++) {
            const struct paper_block *block = &book->besides[p].blocks[b];
            for (size_t i = 0; i < block->lines_count; i++) {
                const struct paper_line *line = &block->lines[i];
                const struct paper_row *printed = line->printed;
                csv_text(out, book->besides[p].paper->name);
                fputc(',', out);
                csv_text(out, block->table->title);
                fprintf(out, ",%s,%zu,%s,", paper_unit_word(block->table->unit),
                        printed->cell.trees, lod_word(printed->cell.lod));
                csv_text(out, printed->effects);
                fprintf(out, ",%s", statistics[printed->statistic]);
                put_csv_number(out, printed->value);
                put_csv_number(out, line->printed_ratio);
                fputc(',', out);
                csv_text(out, line->ours ? line->ours->seen->cell.name : "");
                fprintf(out, ",%s,%zu", state_of(line), line->rounds);
                const struct interval *figures[] = {&line->value, &line->ratio};
                for (size_t k = 0; k < 2; k++) {
                    put_csv_number(out, figures[k]->value);
                    put_csv_number(out, figures[k]->low);
                    put_csv_number(out, figures[k]->high);
                }
                fputc('\n', out);
            }
        }
}

static void put_interval(FILE *out, const struct interval *interval)
{
    fprintf(out, " %s", number_plain(interval->value, 3).text);
    if (interval->low < interval->high)
        fprintf(out, " (%s to %s)", number_plain(interval->low, 3).text,
                number_plain(interval->high, 3).text);
    fputs(" |", out);
}

static void write_laws(const struct book *book, const struct paper_block *block, FILE *out)
{
    if (!block->table->law || isnan(block->fits[GROWTH_LINEAR].residual))
        return;
    fputs("\nSeconds against N, the ", out);
    markdown_text(out, block->table->law);
    fputs(":\n\n| law | printed [s] | residual [%] | ours [s] | residual [%] |\n"
          "|:--|--:|--:|--:|--:|\n",
          out);
    for (int law = 0; law < GROWTH_LAWS; law++) {
        const struct growth_fit *fits[] = {&block->printed_fits[law], &block->fits[law]};
        fprintf(out, "| %s |", growth_word((enum growth_law)law));
        for (int side = 0; side < 2; side++)
            fprintf(out, " %s | %s |", paper_law(book->arena, (enum growth_law)law, fits[side]),
                    number_plain(100 * fits[side]->residual, 3).text);
        fputc('\n', out);
    }
}

static void write_block(const struct book *book, const struct paper_block *block, FILE *out)
{
    const char *unit = paper_unit_word(block->table->unit);
    fputs("\n### ", out);
    markdown_text(out, block->table->title);
    fputs(", ours: ", out);
    markdown_text(out, paper_variant(book->arena, block->example));
    fprintf(out,
            "\n\n| trees | level | effects | printed [%s] | ours [%s] | printed ratio | our ratio "
            "| rounds |\n|--:|:--|:--|--:|--:|--:|--:|--:|\n",
            unit, unit);
    for (size_t i = 0; i < block->lines_count; i++) {
        const struct paper_line *line = &block->lines[i];
        fprintf(out, "| %zu | %s | ", line->printed->cell.trees, lod_word(line->printed->cell.lod));
        markdown_text(out, line->printed->effects);
        fprintf(out, " | %s |", number_exact(line->printed->value).text);
        if (line->rounds)
            put_interval(out, &line->value);
        else
            fprintf(out, " %s |", state_of(line));
        fprintf(out, " %s |", number_plain(line->printed_ratio, 3).text);
        put_interval(out, &line->ratio);
        fprintf(out, " %zu |\n", line->rounds);
    }
    write_laws(book, block, out);
}

static void write_findings(const struct book *book, const struct paper_beside *beside, FILE *out)
{
    fputs("\n### Claims\n\n| claim | of ours | printed | ours | band | verdict | why |\n"
          "|:--|:--|--:|--:|:--|:--|:--|\n",
          out);
    for (size_t i = 0; i < beside->findings_count; i++) {
        const struct paper_finding *finding = &beside->findings[i];
        const struct paper_claim *claim = finding->claim;
        fputs("| ", out);
        markdown_text(out, arena_printf(book->arena, "%s: %s", claim->id, claim->claim));
        fputs(" | ", out);
        markdown_text(out,
                      finding->example ? paper_variant(book->arena, finding->example) : "\u2013");
        fprintf(out, " | %s |", number_plain(finding->printed.value, 3).text);
        put_interval(out, &finding->ours);
        fprintf(out, " %s | %s | ",
                claim->kind == PAPER_UNTESTED ? "\u2013" : paper_band(book->arena, claim),
                paper_verdict_word(finding->verdict));
        markdown_text(out, finding->reason);
        fputs(" |\n", out);
    }
}

static void write_markdown(const struct book *book, FILE *out)
{
    fputs("# Beside the paper\n\nRates of two machines are not comparable; ratios to each one's "
          "base row are. In brackets: 95 % intervals over the rounds, with fewer than three "
          "rounds their range.\n",
          out);
    for (size_t p = 0; p < book->besides_count; p++) {
        const struct paper_beside *beside = &book->besides[p];
        fputs("\n## ", out);
        markdown_text(out, beside->paper->title);
        fputs("\n\n", out);
        markdown_text(out, arena_printf(book->arena, "%s; %s; %s", beside->paper->authors,
                                        beside->paper->source, beside->paper->machine));
        fputs(".\n", out);
        for (size_t b = 0; b < beside->blocks_count; b++)
            write_block(book, &beside->blocks[b], out);
        write_findings(book, beside, out);
    }
}

enum status export_papers(const struct book *book, const char *folder, struct error *error)
{
    static const struct export_table tables[] = {{"papers.csv", write_csv},
                                                 {"papers.md", write_markdown}};
    return book->besides_count ? export_write(book, folder, tables, 2, error) : STATUS_OK;
}
