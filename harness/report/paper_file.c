/* A paper's printed tables and claims from its JSON file; strict. */
#include "report/paper.h"

#include "base/file.h"
#include "base/nearest.h"
#include "plan/names.h"
#include "wall/json.h"

#include <glob.h>
#include <math.h>
#include <string.h>

static const char statistic_words[] = "median|worst|best", unit_words[] = "fps|s";
static const char lod_words[] = "low|intermediate|high|auto"; /* in the order of enum lod */

static const char *text_needed(struct json *object, const char *key)
{
    const char *text = json_text(object, key, NULL);
    if (!text && object)
        json_fail(object, key, "is missing; a text is required");
    return text ? text : "";
}

static void read_size(struct json *object, struct paper_side *side)
{
    float size[2] = {0, 0};
    if (!json_vector(object, "size", size, 2, 1, CELL_SIDE_MAX_PX))
        return;
    if (size[0] != floorf(size[0]) || size[1] != floorf(size[1]))
        json_fail(object, "size", "value is %g x %g; allowed: whole numbers 1..%d", (double)size[0],
                  (double)size[1], CELL_SIDE_MAX_PX);
    side->width_px = (int)size[0];
    side->height_px = (int)size[1];
}

/* The keys that a table's row and a claim's side share. */
static void read_cell(struct json *object, struct paper_side *side)
{
    side->method = json_text(object, "method", NULL);
    side->options = json_text(object, "options", NULL);
    side->has_lod = json_has(object, "lod");
    side->lod = (enum lod)json_word(object, "lod", lod_words, LOD_AUTO);
    int64_t trees = json_integer(object, "trees", -1, -1, CELL_TREES_MAX);
    if (trees < 0 && json_has(object, "trees"))
        json_fail(object, "trees", "value is -1; allowed: 0..%d", CELL_TREES_MAX);
    side->trees = trees < 0 ? SIZE_MAX : (size_t)trees;
}

/* The scene that stands for what the paper calls its effects. */
static const char *scene_of(struct json *table, struct json *row, const char *effects)
{
    size_t count = json_array(table, "scenes");
    for (size_t i = 0; i < count; i++) {
        struct json *entry = json_element(table, "scenes", i);
        const char *word = text_needed(entry, "effects"), *scene = text_needed(entry, "scene");
        if (strcmp(word, effects) == 0)
            return scene;
    }
    if (row)
        json_fail(row, "effects", "value is '%.64s'; allowed: those that scenes names", effects);
    return "";
}

static void read_row(struct json *table, struct json *object, const struct paper_side *size,
                     struct paper_row *row)
{
    row->cell = *size;
    read_cell(object, &row->cell);
    if (object && (!row->cell.method || !row->cell.has_lod || row->cell.trees == SIZE_MAX))
        json_fail(object, NULL, "a row needs method, lod and trees");
    row->effects = text_needed(object, "effects");
    row->cell.scene = scene_of(table, object, row->effects);
    row->statistic = (enum paper_statistic)json_word(object, "statistic", statistic_words, 0);
    row->value = json_number(object, "value", NAN, 1e-9, 1e9);
    row->size = json_number(object, "size", (double)row->cell.trees, 1e-9, 1e12);
    row->note = json_text(object, "note", "");
}

static void read_table(struct arena *arena, struct json *object, struct paper_table *table)
{
    struct paper_side size = {0};
    table->title = text_needed(object, "title");
    table->unit = (enum paper_unit)json_word(object, "unit", unit_words, -1);
    table->law = json_text(object, "law", NULL);
    read_size(object, &size);
    table->rows_count = json_array(object, "rows");
    table->rows = ARENA_ARRAY(arena, struct paper_row, table->rows_count + 1);
    size_t bases = 0;
    for (size_t i = 0; i < table->rows_count; i++) {
        struct json *row = json_element(object, "rows", i);
        read_row(object, row, &size, &table->rows[i]);
        if (json_bool(row, "base", false)) {
            table->base = i;
            bases++;
        }
    }
    if (object && bases != 1)
        json_fail(object, "rows", "%zu have base; allowed: exactly one", bases);
}

static void read_side(struct json *object, struct paper_side *side)
{
    side->scene = json_text(object, "scene", NULL);
    read_cell(object, side);
    read_size(object, side);
    side->has_azimuth = json_vector(object, "azimuth_deg", side->azimuth_deg, 2, 0, 360);
    if (object && !side->method)
        json_fail(object, "method", "is missing; a text is required");
}

static const struct column *column_of(struct json *test)
{
    const char *key = json_text(test, "column", NULL), *nearest = NULL;
    if (!key)
        return NULL;
    for (size_t i = 0; i < COLUMNS_COUNT; i++) {
        if (strcmp(column_table[i].key, key) == 0)
            return &column_table[i];
        nearest = nearest_of(key, nearest, column_table[i].key);
    }
    json_fail(test, "column", "value is '%.64s'%s%s%s; allowed: the columns of results.csv", key,
              nearest ? " (did you mean '" : "", nearest ? nearest : "", nearest ? "'?)" : "");
    return NULL;
}

static void read_test(struct json *test, struct paper_claim *claim)
{
    struct json *of = json_object(test, "of"), *over = json_object(test, "over");
    claim->kind =
        (enum paper_kind)(PAPER_RATIO + json_word(test, "kind", "ratio|growth|value|law", -1));
    claim->statistic = (enum paper_statistic)json_word(test, "statistic", statistic_words, 0);
    claim->column = column_of(test);
    claim->why = text_needed(test, "why");
    claim->low = json_number(test, "low", -INFINITY, -1e9, 1e9);
    claim->high = json_number(test, "high", INFINITY, -1e9, 1e9);
    if (!(claim->low < claim->high) || (isinf(claim->low) && isinf(claim->high)))
        json_fail(test, "low", "the band is %g to %g; allowed: low below high, and one of them",
                  claim->low, claim->high);
    if (!of || (claim->kind == PAPER_RATIO) != (over != NULL))
        json_fail(test, of ? "over" : "of", "needed with kind ratio alone (of: always)");
    read_side(of, &claim->of);
    read_side(over, &claim->over);
    if ((claim->of.has_azimuth || claim->over.has_azimuth) &&
        !(claim->column >= &column_table[COLUMN_same_rmse] &&
          claim->column < &column_table[COLUMN_full_rmse]))
        json_fail(test, "column", "azimuth_deg of a side asks for a column that begins with same_");
}

static void read_claim(struct json *object, struct paper_claim *claim)
{
    claim->id = text_needed(object, "id");
    claim->claim = text_needed(object, "claim");
    claim->figure = text_needed(object, "figure");
    struct json *test = json_object(object, "test");
    if (test)
        read_test(test, claim);
}

enum status paper_read(struct arena *arena, const char *path, struct paper *paper,
                       struct error *error)
{
    struct error local = {STATUS_OK, ""};
    error = error ? error : &local;
    *paper = (struct paper){.name = path_stem(arena, path)};
    struct json_doc *doc = json_load(arena, path, error);
    if (!doc)
        return error->status;
    struct json *root = json_root(doc);
    paper->title = text_needed(root, "title");
    paper->authors = text_needed(root, "authors");
    paper->year = (int)json_integer(root, "year", 0, 0, 9999);
    paper->source = text_needed(root, "source");
    paper->machine = text_needed(root, "machine");
    paper->note = json_text(root, "note", "");
    paper->tables_count = json_array(root, "tables");
    paper->tables = ARENA_ARRAY(arena, struct paper_table, paper->tables_count + 1);
    for (size_t i = 0; i < paper->tables_count; i++)
        read_table(arena, json_element(root, "tables", i), &paper->tables[i]);
    paper->claims_count = json_array(root, "claims");
    paper->claims = ARENA_ARRAY(arena, struct paper_claim, paper->claims_count + 1);
    for (size_t i = 0; i < paper->claims_count; i++)
        read_claim(json_element(root, "claims", i), &paper->claims[i]);
    return json_end(doc);
}

enum status papers_read(struct arena *arena, const char *folder, struct paper **papers,
                        size_t *count, struct error *error)
{
    glob_t found = {0};
    glob(arena_printf(arena, "%s/*.json", folder), 0, NULL, &found);
    *papers = ARENA_ARRAY(arena, struct paper, found.gl_pathc + 1);
    *count = found.gl_pathc;
    enum status status = STATUS_OK;
    for (size_t i = 0; i < found.gl_pathc && status == STATUS_OK; i++)
        status = paper_read(arena, found.gl_pathv[i], &(*papers)[i], error);
    globfree(&found);
    return status;
}
