/* What the files of the L-system share: expressions, rules, modules. */
#ifndef TREELINE_PLANT_LSYSTEM_PARTS_H
#define TREELINE_PLANT_LSYSTEM_PARTS_H

#include "base/random.h"
#include "plant/lsystem.h"

enum {
    NAME_SIZE = 32,
    PARAMETERS_MAX = 64, /* of a grammar, the seed included */
    RULES_MAX = 256,
    WRITTEN_MAX = 4096, /* modules in one text */
    CODE_MAX = 256,     /* operations of an expression */
    STACK_MAX = 32,     /* of values while it is computed */
};

/* The names that an expression may use: the arguments of the rule's head, then the grammar's
 * parameters. */
struct scope {
    const char (*arguments)[NAME_SIZE];
    size_t arguments_count;
    const struct option *parameters; /* ends with NULL */
};

/* One operation on a stack of values. */
struct code {
    enum { CODE_NUMBER, CODE_ARGUMENT, CODE_PARAMETER, CODE_CALL } kind;
    int which; /* argument, parameter or function */
    double value;
};

struct expression {
    size_t count; /* of operations */
    const struct code *code;
};

/* Where an expression takes its values from. */
struct values {
    const double *arguments, *parameters;
    struct random *random;
};

/* Reads an expression from *text up to a ',' or ')' outside of parentheses, or the end; *text is
 * moved there. NULL, or what is wrong with it, in the arena. */
const char *expression_read(struct arena *arena, const char **text, const struct scope *scope,
                            struct expression *expression);
double expression_value(const struct expression *expression, const struct values *values);

/* The turtle's symbols. A module's symbol is one of them, or SYMBOLS_COUNT + the number of a name.
 */
enum symbol {
    SYMBOL_PUSH,
    SYMBOL_POP,
    SYMBOL_BRANCH,
    SYMBOL_MOVE,
    SYMBOL_TWIG,
    SYMBOL_LEFT,
    SYMBOL_RIGHT,
    SYMBOL_DOWN,
    SYMBOL_UP,
    SYMBOL_ROLL,
    SYMBOL_LEVEL,
    SYMBOLS_COUNT
};
extern const struct symbol_look {
    char letter;
    int arguments;
} symbols[SYMBOLS_COUNT];

/* A module as it is written in the axiom or in a rule. */
struct written {
    int symbol;
    int arguments_count;
    struct expression arguments[LSYSTEM_ARGUMENTS_MAX];
};

struct text {
    size_t count;
    struct written *modules;
};

struct rule {
    int symbol;
    double weight;
    struct expression condition; /* count 0: always */
    struct text to;
};

struct name {
    char text[NAME_SIZE];
    int arguments_count;
    size_t first_rule, rules_count;
};

struct lsystem {
    const char *where;
    uint64_t file_hash;
    size_t parameters_count; /* the seed is the last */
    struct option *table;    /* parameters_count + the end */
    double *slots;           /* as the table fills them: an int or a double each */
    struct text axiom;
    size_t names_count;
    struct name *names;
    size_t rules_count;
    struct rule *rules;  /* those of a name stand together */
    struct conifer look; /* colours, lobe, sides of prisms */
};

/* The parameters as numbers. values: parameters_count. */
void lsystem_values(const struct lsystem *lsystem, double *values);

/* A module of a derived string. */
struct module {
    int symbol, arguments_count;
    double arguments[LSYSTEM_ARGUMENTS_MAX];
};

struct modules {
    size_t count;
    struct module *modules;
};

/* Rewrites the axiom until no rule matches. */
enum status lsystem_derive(struct arena *arena, const struct lsystem *lsystem,
                           struct modules *modules, struct error *error);

#endif
