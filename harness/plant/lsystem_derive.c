/* Rewriting: all modules at once, step by step, until no rule matches. */
#include "plant/lsystem_parts.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

struct derivation {
    struct arena *scratch;
    const struct lsystem *lsystem;
    struct random random;
    double parameters[PARAMETERS_MAX];
    struct modules from, to;
    size_t from_capacity, to_capacity, rewrites, operations;
    int step;
};

static enum status too_much(const struct derivation *d, const char *what, int limit,
                            struct error *error)
{
    return error_set(error, STATUS_INVALID,
                     "%s: more than %d %s at step %d; a smaller parameter or another rule ends it",
                     d->lsystem->where, limit, what, d->step);
}

static struct module *module_new(struct derivation *d)
{
    if (d->to.count == d->to_capacity) {
        size_t capacity = 2 * d->to_capacity + 256;
        struct module *grown = ARENA_ARRAY(d->scratch, struct module, capacity);
        if (d->to.count)
            memcpy(grown, d->to.modules, d->to.count * sizeof *grown);
        d->to.modules = grown;
        d->to_capacity = capacity;
    }
    return &d->to.modules[d->to.count++];
}

static double value_of(struct derivation *d, const struct expression *expression,
                       const double *arguments)
{
    const struct values values = {arguments, d->parameters, &d->random};
    d->operations += expression->count;
    return expression_value(expression, &values);
}

/* Writes the modules of a text, the axiom's or that of a name's rule, with the values of the rule's
 * arguments. */
static enum status write_text(struct derivation *d, const struct text *text, const char *of,
                              const double *arguments, struct error *error)
{
    for (size_t k = 0; k < text->count; k++) {
        const struct written *from = &text->modules[k];
        if (d->to.count == LSYSTEM_MODULES_MAX)
            return too_much(d, "modules", LSYSTEM_MODULES_MAX, error);
        struct module *to = module_new(d);
        to->symbol = from->symbol;
        to->arguments_count = from->arguments_count;
        for (int i = 0; i < from->arguments_count; i++) {
            double value = to->arguments[i] = value_of(d, &from->arguments[i], arguments);
            if (!isfinite(value))
                return error_set(error, STATUS_INVALID,
                                 "%s: %s: argument %d of module %zu is %s at step %d; allowed: "
                                 "finite numbers",
                                 d->lsystem->where, of, i + 1, k + 1,
                                 isnan(value) ? "no number" : "infinite", d->step);
        }
    }
    return STATUS_OK;
}

/* *found: a name's rule for a module, drawn by weight among those whose condition holds; NULL:
 * none. */
static enum status rule_for(struct derivation *d, const struct name *name,
                            const struct module *module, const struct rule **found,
                            struct error *error)
{
    const struct rule *rules = d->lsystem->rules + name->first_rule;
    double total = 0;
    *found = NULL;
    for (size_t k = 0; k < name->rules_count; k++) {
        const struct expression *condition = &rules[k].condition;
        if (rules[k].weight <= 0)
            continue;
        double holds = condition->count ? value_of(d, condition, module->arguments) : 1;
        if (isnan(holds))
            return error_set(error, STATUS_INVALID,
                             "%s: %s: the condition of its rule %zu is no number at step %d; "
                             "allowed: 0 for no, others for yes",
                             d->lsystem->where, name->text, k + 1, d->step);
        if (holds == 0)
            continue;
        total += rules[k].weight;
        /* One draw a candidate keeps each with its share; none is drawn for a single one. */
        if (!*found || random_double(&d->random) * total < rules[k].weight)
            *found = &rules[k];
    }
    return STATUS_OK;
}

/* One step; *rewritten: whether any rule matched. */
static enum status rewrite(struct derivation *d, bool *rewritten, struct error *error)
{
    *rewritten = false;
    d->to.count = 0;
    for (size_t k = 0; k < d->from.count; k++) {
        const struct module *module = &d->from.modules[k];
        const struct name *name = module->symbol < SYMBOLS_COUNT
                                      ? NULL
                                      : &d->lsystem->names[module->symbol - SYMBOLS_COUNT];
        const struct rule *rule = NULL;
        enum status status = name ? rule_for(d, name, module, &rule, error) : STATUS_OK;
        if (status != STATUS_OK)
            return status;
        if (d->operations > LSYSTEM_OPERATIONS_MAX)
            return too_much(d, "operations of expressions", LSYSTEM_OPERATIONS_MAX, error);
        if (!rule) {
            if (d->to.count == LSYSTEM_MODULES_MAX)
                return too_much(d, "modules", LSYSTEM_MODULES_MAX, error);
            *module_new(d) = *module;
            continue;
        }
        *rewritten = true;
        if (++d->rewrites > LSYSTEM_REWRITES_MAX)
            return too_much(d, "rewritings", LSYSTEM_REWRITES_MAX, error);
        status = write_text(d, &rule->to, name->text, module->arguments, error);
        if (status != STATUS_OK)
            return status;
    }
    return STATUS_OK;
}

static void swap(struct derivation *d)
{
    struct modules modules = d->from;
    size_t capacity = d->from_capacity;
    d->from = d->to, d->from_capacity = d->to_capacity;
    d->to = modules, d->to_capacity = capacity;
}

static enum status derive(struct derivation *d, struct error *error)
{
    enum status status = write_text(d, &d->lsystem->axiom, "axiom", NULL, error);
    swap(d);
    for (bool rewritten = true; status == STATUS_OK && rewritten;) {
        if (++d->step > LSYSTEM_STEPS_MAX)
            return error_set(error, STATUS_INVALID,
                             "%s: rules still match after %d steps; allowed: a grammar that ends",
                             d->lsystem->where, LSYSTEM_STEPS_MAX);
        status = rewrite(d, &rewritten, error);
        swap(d);
    }
    return status;
}

enum status lsystem_derive(struct arena *arena, const struct lsystem *lsystem,
                           struct modules *modules, struct error *error)
{
    struct arena *scratch = arena_create(0);
    struct derivation *d = ARENA_NEW(scratch, struct derivation);
    d->scratch = scratch;
    d->lsystem = lsystem;
    lsystem_values(lsystem, d->parameters);
    d->random = random_seed((uint64_t)d->parameters[lsystem->parameters_count - 1], 0x6c737973);
    enum status status = derive(d, error);
    if (status == STATUS_OK) {
        modules->count = d->from.count;
        modules->modules = ARENA_ARRAY(arena, struct module, modules->count);
        memcpy(modules->modules, d->from.modules, modules->count * sizeof *modules->modules);
    }
    arena_destroy(scratch);
    return status;
}

static void print_module(const struct lsystem *lsystem, const struct module *module, char *line,
                         size_t size)
{
    int symbol = module->symbol, used;
    if (symbol < SYMBOLS_COUNT)
        used = snprintf(line, size, "%c", symbols[symbol].letter);
    else
        used = snprintf(line, size, "%s", lsystem->names[symbol - SYMBOLS_COUNT].text);
    for (int i = 0; i < module->arguments_count; i++)
        used += snprintf(line + used, size - (size_t)used, "%c%.9g", i ? ',' : '(',
                         module->arguments[i]);
    if (module->arguments_count)
        snprintf(line + used, size - (size_t)used, ")");
}

enum status lsystem_text(struct arena *arena, const struct lsystem *lsystem, char **text,
                         struct error *error)
{
    enum { LINE = NAME_SIZE + 24 * LSYSTEM_ARGUMENTS_MAX };
    struct modules modules = {0, NULL};
    enum status status = lsystem_derive(arena, lsystem, &modules, error);
    if (status != STATUS_OK)
        return status;
    size_t used = 0;
    char *out = arena_alloc(arena, modules.count * LINE + 1, 1);
    for (size_t k = 0; k < modules.count; k++) {
        print_module(lsystem, &modules.modules[k], out + used, LINE);
        used += strlen(out + used);
    }
    *text = out;
    return STATUS_OK;
}
