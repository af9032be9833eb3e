/* L-systems: a grammar from its JSON, and its parameters. */
#include "plant/lsystem.h"

#include "base/file.h"
#include "base/hash.h"
#include "plant/lsystem_parts.h"
#include "wall/json.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

const struct symbol_look symbols[SYMBOLS_COUNT] = {
    [SYMBOL_PUSH] = {'[', 0},  [SYMBOL_POP] = {']', 0},   [SYMBOL_BRANCH] = {'F', 3},
    [SYMBOL_MOVE] = {'f', 1},  [SYMBOL_TWIG] = {'T', 9},  [SYMBOL_LEFT] = {'+', 1},
    [SYMBOL_RIGHT] = {'-', 1}, [SYMBOL_DOWN] = {'&', 1},  [SYMBOL_UP] = {'^', 1},
    [SYMBOL_ROLL] = {'/', 1},  [SYMBOL_LEVEL] = {'$', 0},
};

static const double REQUIRED = (double)NAN;

/* The length of the name that stands at text; 0: none. */
static size_t name_length(const char *text)
{
    size_t length = 0;
    while (isalnum((unsigned char)text[length]) || (length && text[length] == '_'))
        length++;
    return length && isalpha((unsigned char)*text) ? length : 0;
}

static const char *after_blanks(const char *text)
{
    while (*text == ' ')
        text++;
    return text;
}

static void read_parameter(struct arena *arena, struct json *object, struct lsystem *lsystem)
{
    struct option *option = &lsystem->table[lsystem->parameters_count];
    const char *name = json_text(object, "name", "");
    size_t length = name_length(name);
    if (length == 0 || length >= NAME_SIZE || name[length] || strcmp(name, "seed") == 0)
        json_fail(object, "name",
                  "value is '%.40s'; allowed: letters and digits, at most %d, not seed", name,
                  NAME_SIZE - 1);
    for (size_t k = 0; k < lsystem->parameters_count; k++)
        if (strcmp(lsystem->table[k].name, name) == 0)
            json_fail(object, "name", "value is '%s', as an earlier one", name);
    bool whole = json_bool(object, "whole", false);
    option->name = arena_strdup(arena, name);
    option->type = whole ? OPTION_INT : OPTION_DOUBLE;
    option->offset = lsystem->parameters_count * sizeof(double);
    option->minimum = json_number(object, "minimum", REQUIRED, -1e9, 1e9);
    option->maximum = json_number(object, "maximum", REQUIRED, option->minimum, 1e9);
    option->fallback = json_number(object, "value", REQUIRED, option->minimum, option->maximum);
    option->unit = json_text(object, "unit", "");
    option->doc = json_text(object, "doc", "");
    if (whole && option->fallback != floor(option->fallback))
        json_fail(object, "value", "value is %g; allowed: a whole number", option->fallback);
    lsystem->parameters_count++;
}

static void read_parameters(struct arena *arena, struct json *root, struct lsystem *lsystem)
{
    size_t count = json_array(root, "parameters");
    if (count > PARAMETERS_MAX - 1) {
        json_fail(root, "parameters", "has %zu elements; allowed: 0..%d", count,
                  PARAMETERS_MAX - 1);
        count = 0;
    }
    lsystem->table = ARENA_ARRAY(arena, struct option, count + 2);
    lsystem->slots = ARENA_ARRAY(arena, double, count + 1);
    for (size_t k = 0; k < count; k++) {
        struct json *object = json_element(root, "parameters", k);
        if (object)
            read_parameter(arena, object, lsystem);
    }
    lsystem->table[lsystem->parameters_count] =
        (struct option){.name = "seed",
                        .type = OPTION_INT,
                        .offset = lsystem->parameters_count * sizeof(double),
                        .fallback = (double)json_integer(root, "seed", 1, 0, 1000000),
                        .maximum = 1000000,
                        .unit = "",
                        .doc = "another plant for each, where the grammar draws at random"};
    lsystem->parameters_count++;
    options_default(lsystem->table, lsystem->slots);
}

/* The head of a rule: a name and its arguments' names. False when it is none. */
static bool read_head(const char *text, struct name *name, char (*arguments)[NAME_SIZE])
{
    size_t length = name_length(text);
    if (length == 0 || length >= NAME_SIZE || (length == 1 && strchr("FfT", *text)))
        return false;
    memset(name, 0, sizeof *name);
    memcpy(name->text, text, length);
    text = after_blanks(text + length);
    if (*text == '\0')
        return true;
    do {
        text = after_blanks(text + 1);
        length = name_length(text);
        if (length == 0 || length >= NAME_SIZE || name->arguments_count == LSYSTEM_ARGUMENTS_MAX)
            return false;
        memset(arguments[name->arguments_count], 0, NAME_SIZE);
        memcpy(arguments[name->arguments_count], text, length);
        for (int k = 0; k < name->arguments_count; k++)
            if (strcmp(arguments[k], arguments[name->arguments_count]) == 0)
                return false;
        name->arguments_count++;
        text = after_blanks(text + length);
    } while (*text == ',');
    return *text == ')' && text[1] == '\0';
}

/* The symbol of the module that stands at *text, which moves behind it; -1: none. */
static int read_symbol(const struct lsystem *lsystem, const char **text, int *arguments)
{
    size_t length = name_length(*text);
    for (int k = 0; k < SYMBOLS_COUNT && length <= 1; k++)
        if (**text == symbols[k].letter) {
            (*text)++;
            *arguments = symbols[k].arguments;
            return k;
        }
    for (size_t k = 0; k < lsystem->names_count && length; k++)
        if (strlen(lsystem->names[k].text) == length &&
            memcmp(lsystem->names[k].text, *text, length) == 0) {
            *text += length;
            *arguments = lsystem->names[k].arguments_count;
            return SYMBOLS_COUNT + (int)k;
        }
    return -1;
}

/* One module; what is wrong with it, or NULL. */
static const char *read_module(struct arena *arena, const struct lsystem *lsystem,
                               const struct scope *scope, const char **text, struct written *module)
{
    const char *begin = *text;
    int wanted = 0;
    module->symbol = read_symbol(lsystem, text, &wanted);
    if (module->symbol < 0)
        return arena_printf(arena, "'%.20s' is no symbol and has no rule", begin);
    if (**text == '(') {
        do {
            (*text)++;
            if (module->arguments_count == LSYSTEM_ARGUMENTS_MAX)
                return arena_printf(arena, "'%.20s' has more than %d arguments", begin,
                                    LSYSTEM_ARGUMENTS_MAX);
            const char *wrong =
                expression_read(arena, text, scope, &module->arguments[module->arguments_count++]);
            if (wrong)
                return wrong;
        } while (**text == ',');
        if (*(*text)++ != ')')
            return arena_printf(arena, "')' is missing after '%.20s'", begin);
    }
    if (module->arguments_count != wanted)
        return arena_printf(arena, "'%.20s' has %d arguments; allowed: %d", begin,
                            module->arguments_count, wanted);
    return NULL;
}

/* The modules of the axiom or of a rule. */
static void read_text(struct arena *arena, struct json *object, const char *key,
                      const struct lsystem *lsystem, const struct scope *scope, struct text *to)
{
    const char *text = json_text(object, key, NULL);
    if (!text) {
        json_fail(object, key, "is missing; allowed: a text of modules");
        return;
    }
    size_t size = strlen(text);
    if (size > WRITTEN_MAX) {
        json_fail(object, key, "has %zu letters; allowed: at most %d", size, WRITTEN_MAX);
        return;
    }
    struct written *modules = ARENA_ARRAY(arena, struct written, size);
    int depth = 0;
    for (text = after_blanks(text); *text; text = after_blanks(text)) {
        const char *wrong = read_module(arena, lsystem, scope, &text, &modules[to->count]);
        if (wrong) {
            json_fail(object, key, "%s", wrong);
            return;
        }
        int symbol = modules[to->count++].symbol;
        depth += (symbol == SYMBOL_PUSH) - (symbol == SYMBOL_POP);
        if (depth < 0)
            break;
    }
    if (depth != 0)
        json_fail(object, key, "brackets do not pair; allowed: a ']' for each '['");
    to->modules = ARENA_ARRAY(arena, struct written, to->count);
    memcpy(to->modules, modules, to->count * sizeof *modules);
}

/* Names in the order of their first rule, with as many arguments in each. */
static void find_names(struct arena *arena, struct json *root, size_t count,
                       struct lsystem *lsystem)
{
    char arguments[LSYSTEM_ARGUMENTS_MAX][NAME_SIZE];
    lsystem->names = ARENA_ARRAY(arena, struct name, count);
    for (size_t k = 0; k < count; k++) {
        struct json *object = json_element(root, "rules", k);
        const char *head = json_text(object, "of", "");
        struct name name;
        if (!object)
            return;
        if (!read_head(head, &name, arguments)) {
            json_fail(object, "of",
                      "value is '%.60s'; allowed: a name, not F, f or T, and the "
                      "names of its arguments, each another",
                      head);
            return;
        }
        size_t n = 0;
        while (n < lsystem->names_count && strcmp(lsystem->names[n].text, name.text) != 0)
            n++;
        if (n == lsystem->names_count)
            lsystem->names[lsystem->names_count++] = name;
        else if (lsystem->names[n].arguments_count != name.arguments_count)
            json_fail(object, "of", "value is '%.60s'; allowed: %d arguments, as before", head,
                      lsystem->names[n].arguments_count);
        lsystem->names[n].rules_count++;
    }
    for (size_t n = 1; n < lsystem->names_count; n++)
        lsystem->names[n].first_rule =
            lsystem->names[n - 1].first_rule + lsystem->names[n - 1].rules_count;
}

static void read_rule(struct arena *arena, struct json *object, struct lsystem *lsystem,
                      size_t *taken)
{
    char arguments[LSYSTEM_ARGUMENTS_MAX][NAME_SIZE];
    struct name name;
    if (!object || !read_head(json_text(object, "of", ""), &name, arguments))
        return;
    size_t n = 0;
    while (n < lsystem->names_count && strcmp(lsystem->names[n].text, name.text) != 0)
        n++;
    if (n == lsystem->names_count)
        return; /* the document has an error already */
    struct rule *rule = &lsystem->rules[lsystem->names[n].first_rule + taken[n]++];
    const struct scope scope = {(const char(*)[NAME_SIZE])arguments, (size_t)name.arguments_count,
                                lsystem->table};
    rule->symbol = SYMBOLS_COUNT + (int)n;
    rule->weight = json_number(object, "weight", 1, 0, 1e6);
    const char *when = json_text(object, "when", NULL);
    const char *wrong = when ? expression_read(arena, &when, &scope, &rule->condition) : NULL;
    if (wrong || (when && *when))
        json_fail(object, "when", "%s", wrong ? wrong : "more than an expression");
    read_text(arena, object, "to", lsystem, &scope, &rule->to);
}

static void read_look(struct json *root, struct conifer *look)
{
    struct json *needle = json_object(root, "needle"), *bark = json_object(root, "bark");
    const float green[3] = {0.06f, 0.13f, 0.05f}, brown[3] = {0.2f, 0.16f, 0.12f};
    memcpy(look->needle_albedo, green, sizeof green);
    memcpy(look->bark_albedo, brown, sizeof brown);
    json_vector(needle, "albedo", look->needle_albedo, 3, 0, 1);
    json_vector(bark, "albedo", look->bark_albedo, 3, 0, 1);
    look->needle_specular = (float)json_number(needle, "specular", 0, 0, 1);
    look->needle_exponent = (float)json_number(needle, "exponent", 20, 1, 1000);
    look->needle_sides = (uint32_t)json_integer(needle, "sides", 3, 3, 64);
    look->branch_sides = (uint32_t)json_integer(bark, "sides", 6, 3, 64);
}

static enum status read_grammar(struct arena *arena, struct json_doc *doc, struct lsystem *lsystem)
{
    struct json *root = json_root(doc);
    json_text(root, "doc", "");
    read_parameters(arena, root, lsystem);
    size_t count = json_array(root, "rules");
    if (count > RULES_MAX) {
        json_fail(root, "rules", "has %zu elements; allowed: 0..%d", count, RULES_MAX);
        return json_end(doc);
    }
    lsystem->rules_count = count;
    lsystem->rules = ARENA_ARRAY(arena, struct rule, count);
    size_t *taken = ARENA_ARRAY(arena, size_t, count);
    find_names(arena, root, count, lsystem);
    for (size_t k = 0; k < count; k++)
        read_rule(arena, json_element(root, "rules", k), lsystem, taken);
    const struct scope scope = {NULL, 0, lsystem->table};
    read_text(arena, root, "axiom", lsystem, &scope, &lsystem->axiom);
    read_look(root, &lsystem->look);
    return json_end(doc);
}

enum status lsystem_parse(struct arena *arena, const char *text, const char *where,
                          struct lsystem **lsystem, struct error *error)
{
    struct error local = {STATUS_OK, ""};
    error = error ? error : &local;
    struct lsystem *made = ARENA_NEW(arena, struct lsystem);
    made->where = arena_strdup(arena, where);
    made->file_hash = hash_text(hash_text(0, "lsystem 5"), text);
    struct json_doc *doc = json_parse(arena, text, made->where, error);
    if (!doc)
        return error->status;
    *lsystem = made;
    return read_grammar(arena, doc, made);
}

enum status lsystem_load(struct arena *arena, const char *path, struct lsystem **lsystem,
                         struct error *error)
{
    char *bytes = NULL;
    size_t size = 0;
    enum status status = file_read(arena, path, 1 << 20, &bytes, &size, error);
    return status == STATUS_OK ? lsystem_parse(arena, bytes, path, lsystem, error) : status;
}

const struct option *lsystem_options(const struct lsystem *lsystem)
{
    return lsystem->table;
}

enum status lsystem_set(struct lsystem *lsystem, const char *options, struct error *error)
{
    options_default(lsystem->table, lsystem->slots);
    return options_parse(lsystem->table, options, lsystem->slots, error);
}

void lsystem_values(const struct lsystem *lsystem, double *values)
{
    for (size_t k = 0; k < lsystem->parameters_count; k++) {
        int whole;
        memcpy(&whole, &lsystem->slots[k], sizeof whole);
        values[k] = lsystem->table[k].type == OPTION_INT ? whole : lsystem->slots[k];
    }
}

uint64_t lsystem_hash(const struct lsystem *lsystem)
{
    double values[PARAMETERS_MAX];
    lsystem_values(lsystem, values);
    uint64_t hash = lsystem->file_hash;
    for (size_t k = 0; k < lsystem->parameters_count; k++)
        hash = hash_double(hash, values[k]);
    return hash;
}
