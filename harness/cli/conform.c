/* treeline conform: what the contract promises, checked on methods and plugins. */
#include "conform/conform.h"
#include "base/pattern.h"
#include "cli/cli.h"
#include "wall/gl.h"
#include "wall/json.h"

#include <stdio.h>

enum { KEY_CHECK = 0x300, KEY_TIMEOUT, KEY_BACKEND, METHODS_MAX = 64 };

struct request {
    const char *methods[METHODS_MAX];
    size_t methods_count;
    struct conform_request conform;
    bool json;
};

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct request *request = state->input;
    switch (key) {
    case 'j':
        request->json = true;
        return 0;
    case KEY_CHECK:
        request->conform.pattern = text;
        return 0;
    case KEY_TIMEOUT:
        request->conform.timeout_seconds = cli_number(state, "timeout", text, 0.1, 1e6);
        return 0;
    case KEY_BACKEND:
        request->conform.backend = text;
        return 0;
    case ARGP_KEY_ARG:
        if (request->methods_count == METHODS_MAX)
            argp_failure(state, STATUS_USAGE, 0, "more than %d methods: '%s' is too much",
                         METHODS_MAX, text);
        request->methods[request->methods_count++] = text;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_option options[] = {
    {"check", KEY_CHECK, "REGEX", 0, "only the checks whose names match", 0},
    {"timeout", KEY_TIMEOUT, "S", 0, "limit of a check in seconds, 60 by default", 0},
    {"backend", KEY_BACKEND, "NAME", 0, "GL back end", 0},
    {"json", 'j', NULL, 0, "one JSON object instead of a table", 0},
    {0},
};

/* Where the rows go: a line each, or an element each. */
struct listener {
    struct json_out *out; /* NULL: a table */
    size_t counts[CONFORM_FAILED + 1];
};

static void heard(void *context, const struct conform_row *row)
{
    struct listener *listener = context;
    struct json_out *out = listener->out;
    listener->counts[row->result]++;
    if (!out) {
        printf("%-20s %-12s %-8s %6.1f  %s%s%s\n", row->method, row->check,
               conform_word(row->result), row->seconds, row->status ? status_word(row->status) : "",
               row->status ? ": " : "", row->message);
        fflush(stdout);
        return;
    }
    json_open(out, NULL, '{');
    json_put_text(out, "method", row->method);
    json_put_text(out, "check", row->check);
    json_put_text(out, "result",
                  row->result == CONFORM_FAILED ? "failed" : conform_word(row->result));
    json_put_text(out, "status", status_word(row->status));
    json_put_text(out, "message", row->message);
    json_put_number(out, "seconds", row->seconds);
    json_close(out);
}

static void totals_tell(struct listener *listener, const char *const keys[])
{
    if (listener->out)
        json_close(listener->out);
    for (int i = 0; i <= CONFORM_FAILED; i++)
        if (listener->out)
            json_put_number(listener->out, keys[i], (double)listener->counts[i]);
        else
            printf("%s%zu %s", i ? ", " : "", listener->counts[i], keys[i]);
    if (listener->out)
        json_close(listener->out);
    printf("%s\n", listener->out ? json_out_text(listener->out) : "");
}

/* What asks for no check at all is not passed. */
static enum status pattern_check(const char *text, struct error *error)
{
    regex_t pattern;
    const char *name, *doc;
    bool any = false;
    if (!text)
        return STATUS_OK;
    enum status status = pattern_compile(text, "--check", STATUS_USAGE, &pattern, error);
    if (status)
        return status;
    for (size_t i = 0; conform_check_at(i, &name, &doc); i++)
        any |= !regexec(&pattern, name, 0, NULL, 0);
    regfree(&pattern);
    return any ? STATUS_OK
               : error_set(error, STATUS_USAGE,
                           "--check: no check's name matches '%s'; `treeline conform --help` has "
                           "them all",
                           text);
}

/* An unknown back end is no method's failure. */
static enum status backend_check(const char *backend, struct error *error)
{
    const char *named = getenv("TREELINE_GL");
    if (backend)
        return gl_backend_check(backend, "--backend", error);
    return named && *named ? gl_backend_check(named, "TREELINE_GL", error) : STATUS_OK;
}

/* Every method in turn; the exit code is the first failure's. */
static int conform(struct arena *arena, const struct request *request)
{
    static const char *const keys[] = {"passed", "skipped", "refused", "failed"};
    struct error error = {0};
    struct listener listener = {.out = request->json ? json_out(arena) : NULL};
    enum status result = STATUS_OK, one, status = pattern_check(request->conform.pattern, &error);
    if (!status)
        status = backend_check(request->conform.backend, &error);
    if (status)
        return cli_fail(&error);
    if (listener.out) {
        json_open(listener.out, NULL, '{');
        json_put_number(listener.out, "version", 1);
        json_open(listener.out, "checks", '[');
    } else {
        printf("%-20s %-12s %-8s %6s  %s\n", "method", "check", "result", "s", "message");
    }
    struct conform_request one_method = request->conform;
    one_method.heard = heard;
    one_method.listener = &listener;
    for (size_t i = 0; i < request->methods_count && !status; i++) {
        one_method.method = request->methods[i];
        status = conform_run(arena, &one_method, &one, &error);
        result = result ? result : one;
    }
    if (status)
        return cli_fail(&error);
    totals_tell(&listener, keys);
    return (int)result;
}

/* Behind the options in --help. */
static char *help_filter(int key, const char *text, void *input)
{
    (void)input;
    if (key != ARGP_KEY_HELP_EXTRA)
        return (char *)text;
    char *all = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&all, &size);
    const char *name, *doc;
    if (!file)
        return NULL;
    fprintf(file, "Checks, each in a process of its own:\n");
    for (size_t i = 0; conform_check_at(i, &name, &doc); i++)
        fprintf(file, "  %s: %s\n", name, doc);
    fclose(file);
    return all;
}

int verb_conform(int argc, char **argv)
{
    const struct argp argp = {
        options,
        parse,
        "[METHOD|PATH]...",
        "Checks that methods, built in or plugins named by path, do what the contract "
        "(harness/method/method.h) promises; without names, all that are built in.\v"
        "A check is ok, skipped (it does not apply), refused (the method declines the scene, with "
        "a "
        "reason) or FAILED with the cause: nonconforming (the picture or the figures are wrong), "
        "crash, timeout, memory, gl-error, bad-picture. The exit code is 78 when a check failed, "
        "or, of a method that could not be loaded, that of the cause.",
        NULL,
        help_filter,
        NULL};
    struct request request = {0};
    argp_parse(&argp, argc, argv, 0, NULL, &request);
    if (!request.methods_count)
        for (const struct method *const *each = methods_builtin;
             *each && request.methods_count < METHODS_MAX; each++)
            request.methods[request.methods_count++] = (*each)->name;
    struct arena *arena = arena_create(0);
    int code = conform(arena, &request);
    arena_destroy(arena);
    return code;
}
