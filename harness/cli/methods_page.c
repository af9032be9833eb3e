/* methods/README.md: every method with its source, effects and options, from its struct. */
#include "cli/cli.h"

#include <stdio.h>
#include <string.h>

/* A table's cell: bars would end it. */
static void cell_print(const char *text)
{
    for (const char *c = text; *c; c++)
        printf(*c == '|' ? "\\|" : "%c", *c);
}

static void options_table(const struct option *table)
{
    printf("| option | default | allowed | unit | meaning |\n|---|---|---|---|---|\n");
    for (const struct option *option = table; option->name; option++) {
        char fallback[64], allowed[256];
        option_fallback(option, fallback, sizeof fallback);
        option_allowed(option, allowed, sizeof allowed);
        printf("| `%s` | %s | ", option->name, fallback);
        cell_print(allowed);
        printf(" | %s | ", option->unit);
        cell_print(option->doc);
        printf(" |\n");
    }
    printf("\n");
}

static void method_print(const struct method *method)
{
    const char *comma = "";
    printf("## %s\n\n%s. %s\n\nSource: %s.\n\nEffects: ", method->name, method->summary,
           method->traits & TRAIT_CPU ? "Draws on the CPU." : "Draws with OpenGL.", method->source);
#define EFFECT_SAY(name, bit, word, meaning)                                                       \
    if (method->traits & (name)) {                                                                 \
        printf("%s%s", comma, word);                                                               \
        comma = ", ";                                                                              \
    }
    EFFECT_LIST(EFFECT_SAY)
#undef EFFECT_SAY
    printf("%s.\n\n", *comma ? "" : "none");
    if (method->options && method->options->name)
        options_table(method->options);
    else
        printf("No options.\n\n");
}

int methods_page(void)
{
    printf(
        "# Methods\n\nMade by `treeline help methods` (`make docs`); do not edit. How to add one: "
        "[CONTRIBUTING.md](../CONTRIBUTING.md).\n\nAn option is written behind the name, and a "
        "list sweeps it: `--method billboards:views=8,16,alpha=test`.\n\n"
        "| method | summary |\n|---|---|\n");
    for (const struct method *const *each = methods_builtin; *each; each++)
        printf("| [%s](#%s) | %s |\n", (*each)->name, (*each)->name, (*each)->summary);
    printf("\nEffects that a scene may ask for (`harness/scene/effects.h`); what a method does not "
           "model is part of its total error:\n\n| effect | meaning |\n|---|---|\n");
#define EFFECT_ROW(name, bit, word, meaning)                                                       \
    printf("| %s | ", word);                                                                       \
    cell_print(meaning);                                                                           \
    printf(" |\n");
    EFFECT_LIST(EFFECT_ROW)
#undef EFFECT_ROW
    printf("\n");
    for (const struct method *const *each = methods_builtin; *each; each++)
        method_print(*each);
    return STATUS_OK;
}
