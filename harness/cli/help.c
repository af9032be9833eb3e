/* treeline help: verbs, methods, plants, settings of a plan, exit codes, version. */
#include "build_facts.h"
#include "cli/cli.h"
#include "plan/settings.h"
#include "plant/plant.h"

#include <stdio.h>
#include <string.h>

static error_t parse(int key, char *text, struct argp_state *state)
{
    const char **topic = state->input;
    if (key != ARGP_KEY_ARG)
        return ARGP_ERR_UNKNOWN;
    if (*topic)
        argp_failure(state, STATUS_USAGE, 0, "one topic at a time: '%s' is too much", text);
    *topic = text;
    return 0;
}

static void options_explain(const struct option *table, const char *none)
{
    if (!table || !table->name)
        printf("%s\n", none);
    else
        printf("  %-24s %-10s %-28s %s\n", "option", "default", "allowed", "meaning");
    for (const struct option *option = table; option && option->name; option++) {
        char fallback[64], allowed[256];
        option_fallback(option, fallback, sizeof fallback);
        option_allowed(option, allowed, sizeof allowed);
        printf("  %-24s %-10s %-28s %s%s%s%s\n", option->name, fallback, allowed, option->doc,
               option->unit && *option->unit ? " [" : "", option->unit ? option->unit : "",
               option->unit && *option->unit ? "]" : "");
    }
}

static void method_explain(const struct method *method)
{
    printf("%s: %s\n", method->name, method->summary);
    if (method->source && *method->source)
        printf("source: %s\n", method->source);
    printf("kind: %s%s\neffects:", method->traits & TRAIT_CPU ? "CPU" : "GL",
           method->traits & TRAIT_STOCHASTIC ? ", stochastic" : "");
    bool any = false;
#define EFFECT_SAY(name, bit, word, meaning)                                                       \
    if (method->traits & (name)) {                                                                 \
        printf(" %s", word);                                                                       \
        any = true;                                                                                \
    }
    EFFECT_LIST(EFFECT_SAY)
#undef EFFECT_SAY
    printf("%s\n\n", any ? "" : " none");
    options_explain(method->options, "no options");
}

static void exit_codes_print(void)
{
    printf("%4s  %-13s %s\n", "code", "word", "meaning");
#define STATUS_PRINT(name, code, word, meaning) printf("%4d  %-13s %s\n", code, word, meaning);
    STATUS_LIST(STATUS_PRINT)
#undef STATUS_PRINT
}

static int topics_print(void)
{
    printf("treeline compares ways to draw a tree and a forest against a ray-traced reference.\n\n"
           "verbs (`treeline help VERB`):\n");
    for (const struct verb *verb = verbs; verb->name; verb++)
        printf("  %-11s%s\n", verb->name, verb->summary);
    printf("\nmethods (`treeline help METHOD`):\n");
    for (const struct method *const *each = methods_builtin; *each; each++)
        printf("  %-14s%s\n", (*each)->name, (*each)->summary);
    printf("\nother topics: plan (settings of a plan), exit (exit codes), methods (all of them, as "
           "Markdown),\n"
           "man (the manual page), version, and the name of a generated plant\n");
    return STATUS_OK;
}

static int topic_print(const char *topic)
{
    if (!strcmp(topic, "exit")) {
        exit_codes_print();
        return STATUS_OK;
    }
    if (!strcmp(topic, "man"))
        return man_page();
    if (!strcmp(topic, "methods"))
        return methods_page();
    if (!strcmp(topic, "version")) {
        printf("treeline %s\n", TREELINE_REVISION);
        return STATUS_OK;
    }
    if (!strcmp(topic, "plan")) {
        printf("Settings of a plan file and, with - for _, of `run` (harness/plan/README.md):\n\n");
        options_explain(plan_settings_table, "");
        return STATUS_OK;
    }
    for (const struct verb *verb = verbs; verb->name; verb++)
        if (!strcmp(topic, verb->name)) {
            char name[64];
            snprintf(name, sizeof name, "treeline %s", verb->name);
            return verb->run(2, (char *[]){name, "--help", NULL});
        }
    if (plant_options(topic)) {
        printf("%s: a generated plant\n\n", topic);
        options_explain(plant_options(topic), "no options");
        return STATUS_OK;
    }
    const struct method *method;
    struct error error = {0};
    if (method_find(topic, &method, &error)) {
        if (error.status == STATUS_NOT_FOUND && !strchr(topic, '/'))
            error_set(&error, STATUS_NOT_FOUND,
                      "help: '%s' is no verb, method, plant or topic; "
                      "`treeline help` lists them",
                      topic);
        return cli_fail(&error);
    }
    method_explain(method);
    return STATUS_OK;
}

int verb_help(int argc, char **argv)
{
    const struct argp argp = {
        NULL,
        parse,
        "[VERB|METHOD|PLANT|plan|exit|methods|man|version]",
        "Explains a verb, a method with its options, a plant, the settings of a "
        "plan, or the exit codes.",
        NULL,
        NULL,
        NULL};
    const char *topic = NULL;
    argp_parse(&argp, argc, argv, 0, NULL, &topic);
    return topic ? topic_print(topic) : topics_print();
}
