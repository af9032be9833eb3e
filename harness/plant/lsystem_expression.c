/* Expressions of an L-system: read into operations on a stack, and computed.
 *
 *     a ? b : c is written if(a, b, c); then, binding ever tighter: || && < <= > >= == != + - * / %
 *     ! - and numbers, names, parentheses, functions. Angles of sin and cos are degrees. Nothing
 *     that a mathematical library may round in its own way: a plant has the same bytes everywhere.
 */
#include "plant/grow.h"
#include "plant/lsystem_parts.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

/* clang-format off */
enum function {
    DO_OR, DO_AND, DO_LESS, DO_LESS_EQUAL, DO_MORE, DO_MORE_EQUAL, DO_EQUAL, DO_UNEQUAL,
    DO_ADD, DO_SUBTRACT, DO_MULTIPLY, DO_DIVIDE, DO_REMAINDER, DO_NOT, DO_NEGATE,
    DO_SIN, DO_COS, DO_SQRT, DO_ABS, DO_FLOOR, DO_MIN, DO_MAX, DO_RANDOM, DO_IF,
    FUNCTIONS_COUNT
};

static const struct {
    const char *word;
    int level; /* of a binary operator, 0 the loosest; -1: not one */
    int arguments;
} functions[FUNCTIONS_COUNT] = {
    {"||", 0, 2}, {"&&", 1, 2}, {"<", 2, 2}, {"<=", 2, 2}, {">", 2, 2}, {">=", 2, 2},
    {"==", 2, 2}, {"!=", 2, 2}, {"+", 3, 2}, {"-", 3, 2}, {"*", 4, 2}, {"/", 4, 2}, {"%", 4, 2},
    {"!", -1, 1}, {"-", -1, 1}, {"sin", -1, 1}, {"cos", -1, 1}, {"sqrt", -1, 1}, {"abs", -1, 1},
    {"floor", -1, 1}, {"min", -1, 2}, {"max", -1, 2}, {"random", -1, 2}, {"if", -1, 3},
};
/* clang-format on */
enum { LEVELS = 5, DEPTH_MAX = 24 };

struct reader {
    struct arena *arena;
    const char *at;
    const struct scope *scope;
    struct code code[CODE_MAX];
    size_t count;
    int stack, depth;
    const char *wrong; /* NULL: nothing yet */
};

static void fail(struct reader *reader, const char *what)
{
    if (!reader->wrong)
        reader->wrong = arena_printf(reader->arena, "%s near '%.20s'", what, reader->at);
}

static void emit(struct reader *reader, struct code code)
{
    if (reader->wrong)
        return;
    int pops = code.kind == CODE_CALL ? functions[code.which].arguments : 0;
    reader->stack += 1 - pops;
    if (reader->count == CODE_MAX || reader->stack > STACK_MAX) {
        fail(reader, "the expression is too long");
        return;
    }
    reader->code[reader->count++] = code;
}

static void blanks(struct reader *reader)
{
    while (*reader->at == ' ')
        reader->at++;
}

static bool take(struct reader *reader, const char *word)
{
    blanks(reader);
    size_t length = strlen(word);
    if (strncmp(reader->at, word, length) != 0)
        return false;
    reader->at += length;
    return true;
}

static void read_level(struct reader *reader, int level);

static void read_call(struct reader *reader, const char *word)
{
    int f = DO_SIN;
    while (f < FUNCTIONS_COUNT && strcmp(functions[f].word, word) != 0)
        f++;
    if (f == FUNCTIONS_COUNT) {
        fail(reader, "no such function; functions are sin, cos, sqrt, abs, floor, min, max, "
                     "random, if,");
        return;
    }
    for (int k = 0; k < functions[f].arguments && !reader->wrong; k++) {
        if (k > 0 && !take(reader, ","))
            fail(reader, "too few arguments");
        read_level(reader, 0);
    }
    if (!take(reader, ")"))
        fail(reader, "')' is missing");
    emit(reader, (struct code){CODE_CALL, f, 0});
}

static void read_name(struct reader *reader)
{
    char word[NAME_SIZE];
    size_t length = 0;
    while (isalnum((unsigned char)reader->at[length]) || reader->at[length] == '_')
        length++;
    if (length == 0 || length >= sizeof word) {
        fail(reader, "a number or a name is missing");
        return;
    }
    memcpy(word, reader->at, length);
    word[length] = '\0';
    const struct scope *scope = reader->scope;
    for (size_t k = 0; k < scope->arguments_count; k++)
        if (strcmp(scope->arguments[k], word) == 0) {
            reader->at += length;
            emit(reader, (struct code){CODE_ARGUMENT, (int)k, 0});
            return;
        }
    for (int k = 0; scope->parameters[k].name; k++)
        if (strcmp(scope->parameters[k].name, word) == 0) {
            reader->at += length;
            emit(reader, (struct code){CODE_PARAMETER, k, 0});
            return;
        }
    if (reader->at[length] != '(') {
        fail(reader, "no such name");
        return;
    }
    reader->at += length + 1;
    read_call(reader, word);
}

static void read_factor(struct reader *reader)
{
    if (reader->depth++ > DEPTH_MAX)
        fail(reader, "too deep");
    if (reader->wrong)
        return;
    if (take(reader, "!")) {
        read_factor(reader);
        emit(reader, (struct code){CODE_CALL, DO_NOT, 0});
    } else if (take(reader, "-")) {
        read_factor(reader);
        emit(reader, (struct code){CODE_CALL, DO_NEGATE, 0});
    } else if (take(reader, "(")) {
        read_level(reader, 0);
        if (!take(reader, ")"))
            fail(reader, "')' is missing");
    } else if (isdigit((unsigned char)*reader->at) || *reader->at == '.') {
        char *end = NULL;
        double value = strtod(reader->at, &end);
        if (end == reader->at)
            fail(reader, "not a number");
        emit(reader, (struct code){CODE_NUMBER, 0, value});
        reader->at = end;
    } else {
        read_name(reader);
    }
    reader->depth--;
}

/* The operator of a level that stands here; -1: none. The longer one of two that begin alike. */
static int operator_at(struct reader *reader, int level)
{
    int found = -1;
    blanks(reader);
    for (int f = 0; f < DO_NOT; f++)
        if (strncmp(reader->at, functions[f].word, strlen(functions[f].word)) == 0 &&
            (found < 0 || strlen(functions[f].word) > strlen(functions[found].word)))
            found = f;
    return found >= 0 && functions[found].level == level ? found : -1;
}

static void read_level(struct reader *reader, int level)
{
    if (level == LEVELS) {
        read_factor(reader);
        return;
    }
    read_level(reader, level + 1);
    for (int f = operator_at(reader, level); f >= 0 && !reader->wrong;
         f = operator_at(reader, level)) {
        reader->at += strlen(functions[f].word);
        read_level(reader, level + 1);
        emit(reader, (struct code){CODE_CALL, f, 0});
    }
}

const char *expression_read(struct arena *arena, const char **text, const struct scope *scope,
                            struct expression *expression)
{
    struct reader reader = {.arena = arena, .at = *text, .scope = scope};
    read_level(&reader, 0);
    blanks(&reader);
    if (*reader.at && *reader.at != ',' && *reader.at != ')')
        fail(&reader, "an operator is missing");
    *text = reader.at;
    struct code *kept = ARENA_ARRAY(arena, struct code, reader.count);
    memcpy(kept, reader.code, reader.count * sizeof *kept);
    *expression = (struct expression){reader.count, kept};
    return reader.wrong;
}

static double turned(double degrees, bool sine)
{
    double s, c;
    grow_sincos(degrees / 360, &s, &c);
    return sine ? s : c;
}

/* clang-format off */
static double call(int function, const double *a, struct random *random)
{
    switch (function) {
    case DO_OR: return a[0] != 0 || a[1] != 0;
    case DO_AND: return a[0] != 0 && a[1] != 0;
    case DO_LESS: return a[0] < a[1];
    case DO_LESS_EQUAL: return a[0] <= a[1];
    case DO_MORE: return a[0] > a[1];
    case DO_MORE_EQUAL: return a[0] >= a[1];
    case DO_EQUAL: return a[0] == a[1];
    case DO_UNEQUAL: return a[0] != a[1];
    case DO_ADD: return a[0] + a[1];
    case DO_SUBTRACT: return a[0] - a[1];
    case DO_MULTIPLY: return a[0] * a[1];
    case DO_DIVIDE: return a[0] / a[1];
    case DO_REMAINDER: return a[0] - a[1] * floor(a[0] / a[1]);
    case DO_NOT: return a[0] == 0;
    case DO_NEGATE: return -a[0];
    case DO_SIN: return fabs(a[0]) < 1e9 ? turned(a[0], true) : (double)NAN;
    case DO_COS: return fabs(a[0]) < 1e9 ? turned(a[0], false) : (double)NAN;
    case DO_SQRT: return sqrt(a[0]);
    case DO_ABS: return fabs(a[0]);
    case DO_FLOOR: return floor(a[0]);
    case DO_MIN: return fmin(a[0], a[1]);
    case DO_MAX: return fmax(a[0], a[1]);
    case DO_RANDOM: return random_between(random, a[0], a[1]);
    default: return a[0] != 0 ? a[1] : a[2];
    }
}

/* clang-format on */

double expression_value(const struct expression *expression, const struct values *values)
{
    double stack[STACK_MAX + 1] = {0};
    int top = 0;
    for (size_t k = 0; k < expression->count; k++) {
        const struct code *code = &expression->code[k];
        if (code->kind == CODE_CALL) {
            top -= functions[code->which].arguments;
            stack[top] = call(code->which, stack + top, values->random);
            top++;
        } else {
            stack[top++] = code->kind == CODE_NUMBER     ? code->value
                           : code->kind == CODE_ARGUMENT ? values->arguments[code->which]
                                                         : values->parameters[code->which];
        }
    }
    return stack[0];
}
