/* A run on disk: FOLDER/cells.jsonl, its first line the provenance, then one line a repetition. */
#include "results/run.h"

#include "base/file.h"
#include "results/calibration.h"
#include "wall/json.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* X(field, kind) of struct provenance: texts and numbers, keys as the fields are named. */
#define PROVENANCE_TEXTS(X)                                                                        \
    X(host)                                                                                        \
    X(cpu)                                                                                         \
    X(kernel)                                                                                      \
    X(os) X(compiler) X(flags) X(revision) X(libraries) X(plan) X(command) X(settings) X(started)
#define PROVENANCE_NUMBERS(X) X(memory_bytes) X(rounds) X(frame_seconds) X(reference_error)

char *provenance_to_json(struct arena *arena, const struct provenance *provenance)
{
    struct json_out *out = json_out(arena);
    json_open(out, NULL, '{');
    json_put_number(out, "version", RESULT_VERSION);
    json_put_text(out, "kind", "treeline-run");
#define TEXT_PUT(field) json_put_text(out, #field, provenance->field);
    PROVENANCE_TEXTS(TEXT_PUT)
#undef TEXT_PUT
    json_put_number(out, "cores", provenance->cores);
#define NUMBER_PUT(field) json_put_number(out, #field, provenance->field);
    PROVENANCE_NUMBERS(NUMBER_PUT)
#undef NUMBER_PUT
    json_put_u64(out, "seed", provenance->seed);
    json_put_u64(out, "plan_hash", provenance->plan_hash);
    json_close(out);
    return json_out_text(out);
}

static enum status provenance_from_json(struct arena *arena, const char *text, const char *where,
                                        struct provenance *provenance, struct error *error)
{
    struct json_doc *doc = json_parse(arena, text, where, error);
    if (!doc)
        return STATUS_INVALID;
    struct json *root = json_root(doc);
    const char *kind = json_text(root, "kind", "");
    if (strcmp(kind, "treeline-run") != 0)
        json_fail(root, "kind", "value is '%s'; the first line of a run says treeline-run", kind);
    if (result_version_check(root))
        return json_end(doc);
#define TEXT_GET(field) provenance->field = json_text(root, #field, "");
    PROVENANCE_TEXTS(TEXT_GET)
#undef TEXT_GET
    provenance->cores = (int)json_integer(root, "cores", 1, 0, 1 << 20);
#define NUMBER_GET(field) provenance->field = json_number(root, #field, 0, 0, 1e300);
    PROVENANCE_NUMBERS(NUMBER_GET)
#undef NUMBER_GET
    provenance->seed = json_u64(root, "seed");
    provenance->plan_hash = json_u64(root, "plan_hash");
    return json_end(doc);
}

/* FOLDER/cells.jsonl, or the path itself when it is a file. */
static const char *run_file(struct arena *arena, const char *path)
{
    struct stat info;
    if (!stat(path, &info) && S_ISREG(info.st_mode))
        return path;
    return arena_printf(arena, "%s/cells.jsonl", path);
}

static const char *folder_of(struct arena *arena, const char *file)
{
    const char *slash = strrchr(file, '/');
    return slash ? arena_printf(arena, "%.*s", (int)(slash - file), file) : ".";
}

/* One more behind count elements; place for twice as many each time. */
static void *list_add(struct arena *arena, void *list, size_t *count, size_t size)
{
    size_t before = *count;
    if (!(before & (before - 1))) {
        void *more = arena_alloc(arena, before ? 2 * before : 1, size);
        if (before)
            memcpy(more, list, before * size);
        list = more;
    }
    ++*count;
    return list;
}

/* One line behind the first: a result, or one that says its kind. */
static enum status line_read(struct arena *arena, const char *line, const char *where,
                             struct run *run, struct error *error)
{
    if (strstr(line, "\"kind\":\"" CALIBRATION_KIND "\"")) {
        run->measured = list_add(arena, run->measured, &run->measured_count, sizeof *run->measured);
        return calibration_from_json(arena, line, where, &run->measured[run->measured_count - 1],
                                     error);
    }
    if (strstr(line, "\"kind\":\"" TRACING_KIND "\"")) {
        run->tracings = list_add(arena, run->tracings, &run->tracings_count, sizeof *run->tracings);
        return tracing_from_json(arena, line, where, &run->tracings[run->tracings_count - 1],
                                 error);
    }
    return result_from_json(arena, line, where, &run->results[run->results_count++], error);
}

/* Reads line by line; the text is cut in place. */
static enum status lines_read(struct arena *arena, const char *file, char *text, size_t size,
                              struct run *run, struct error *error)
{
    size_t lines = 0, number = 0;
    for (size_t i = 0; i < size; i++)
        lines += text[i] == '\n';
    run->results = ARENA_ARRAY(arena, struct result, lines);
    for (char *line = text, *end; line < text + size; line = end + 1) {
        end = memchr(line, '\n', (size_t)(text + size - line));
        number++;
        if (!end) {
            run->torn_lines = 1;
            break;
        }
        *end = 0;
        char *where = arena_printf(arena, "%s:%zu", file, number);
        if (strlen(line) != (size_t)(end - line))
            return error_set(error, STATUS_INVALID, "%s: a NUL byte in the line", where);
        enum status status = number == 1
                                 ? provenance_from_json(arena, line, where, &run->provenance, error)
                                 : line_read(arena, line, where, run, error);
        if (status)
            return status;
    }
    if (!number || (number == 1 && run->torn_lines))
        return error_set(error, STATUS_INVALID,
                         "%s: holds no whole line; a run begins with its provenance", file);
    return STATUS_OK;
}

enum status run_read(struct arena *arena, const char *path, struct run **run, struct error *error)
{
    const char *file = run_file(arena, path);
    char *text;
    size_t size;
    enum status status = file_read(arena, file, (size_t)4 << 30, &text, &size, error);
    if (status)
        return status;
    struct run *made = ARENA_NEW(arena, struct run);
    made->folder = folder_of(arena, file);
    status = lines_read(arena, file, text, size, made, error);
    if (status)
        return status;
    calibrations_merge(arena, made);
    *run = made;
    return STATUS_OK;
}

/* Cuts what stands behind the last newline: a line that a kill or a full disk left half written. */
static enum status torn_line_cut(const char *file, struct error *error)
{
    int opened = open(file, O_RDWR | O_CLOEXEC | O_NONBLOCK);
    if (opened < 0)
        return error_errno(error, STATUS_IO, "%s: cannot be opened for writing", file);
    struct stat info;
    if (fstat(opened, &info) || !S_ISREG(info.st_mode)) {
        close(opened);
        return error_set(error, STATUS_INVALID, "%s: is not a regular file", file);
    }
    off_t end = lseek(opened, 0, SEEK_END), keep = end;
    char byte = 0;
    while (keep > 0 && pread(opened, &byte, 1, keep - 1) == 1 && byte != '\n')
        keep--;
    bool bad = keep != end && (ftruncate(opened, keep) || fsync(opened));
    int number = errno;
    close(opened);
    errno = number;
    return bad ? error_errno(error, STATUS_IO, "%s: a torn last line cannot be cut", file)
               : STATUS_OK;
}

/* A run's settings without the limits of a repetition, which may be raised for those that failed.
 */
static const char *settings_kept(struct arena *arena, const char *settings)
{
    const char *kept = "";
    char *rest = arena_strdup(arena, settings), *name, *value;
    while ((name = strsep(&rest, " ")) && (value = strsep(&rest, " ")))
        if (strcmp(name, "--timeout") != 0 && strcmp(name, "--memory") != 0)
            kept = arena_printf(arena, "%s%s%s %s", kept, *kept ? " " : "", name, value);
    return *kept ? kept : "the defaults";
}

static enum status plan_check(struct arena *arena, const char *folder,
                              const struct provenance *provenance, bool resume, struct error *error)
{
    struct run *run;
    enum status status = run_read(arena, folder, &run, error);
    if (status)
        return status;
    if (!resume)
        return error_set(error, STATUS_USAGE,
                         "%s: holds a run of plan %s with %zu results; --resume continues it, or "
                         "choose another --out",
                         folder, run->provenance.plan, run->results_count);
    if (strcmp(run->provenance.flags, provenance->flags) != 0)
        return error_set(error, STATUS_INVALID,
                         "%s: was measured by a build with '%s'; this one has '%s'", folder,
                         run->provenance.flags, provenance->flags);
    if (strcmp(run->provenance.cpu, provenance->cpu) != 0)
        return error_set(error, STATUS_INVALID,
                         "%s: was measured on '%s'; this machine has '%s', choose another --out",
                         folder, run->provenance.cpu, provenance->cpu);
    const struct {
        const char *name;
        double before, now;
    } settings[] = {
        {"frame_seconds", run->provenance.frame_seconds, provenance->frame_seconds},
        {"reference_error", run->provenance.reference_error, provenance->reference_error},
    };
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++)
        if (settings[i].before != settings[i].now)
            return error_set(error, STATUS_INVALID,
                             "%s: %s: was measured with %g; %g cannot be mixed with it, choose "
                             "another --out",
                             folder, settings[i].name, settings[i].before, settings[i].now);
    const char *before = settings_kept(arena, run->provenance.settings);
    const char *now = settings_kept(arena, provenance->settings);
    if (strcmp(before, now) != 0)
        return error_set(error, STATUS_INVALID,
                         "%s: was measured with %s; %s cannot be mixed with it, choose another "
                         "--out",
                         folder, before, now);
    return STATUS_OK;
}

/* A first line that an end cut short, and nothing behind it: as good as no file. */
static bool first_line_is_torn(const char *file)
{
    char begun[64], bytes[8192];
    int length =
        snprintf(begun, sizeof begun, "{\"version\":%d,\"kind\":\"treeline-run\"", RESULT_VERSION);
    FILE *opened = fopen(file, "rbe");
    size_t size = opened ? fread(bytes, 1, sizeof bytes, opened) : 0;
    if (opened)
        fclose(opened);
    size_t same = size < (size_t)length ? size : (size_t)length;
    return size < sizeof bytes && !memchr(bytes, '\n', size) && memcmp(bytes, begun, same) == 0;
}

enum status run_open(const char *folder, const struct provenance *provenance, bool resume,
                     struct error *error)
{
    enum status status = file_make_folder(folder, error);
    if (status)
        return status;
    struct arena *arena = arena_create(0);
    const char *file = arena_printf(arena, "%s/cells.jsonl", folder);
    struct stat info;
    bool there = !stat(file, &info),
         begun = there && !(S_ISREG(info.st_mode) && first_line_is_torn(file));
    /* Nothing is cut before it is known to be a run that may go on. */
    if (begun)
        status = plan_check(arena, folder, provenance, resume, error);
    if (!status && there)
        status = torn_line_cut(file, error);
    if (!status && !begun) {
        const char *line = arena_printf(arena, "%s\n", provenance_to_json(arena, provenance));
        status = file_append(file, line, strlen(line), error);
    }
    arena_destroy(arena);
    return status;
}

/* The line's arena ends with it. */
static enum status line_append(struct arena *arena, const char *folder, const char *text,
                               struct error *error)
{
    const char *file = arena_printf(arena, "%s/cells.jsonl", folder);
    const char *line = arena_printf(arena, "%s\n", text);
    enum status status = file_append(file, line, strlen(line), error);
    arena_destroy(arena);
    return status;
}

enum status run_append(const char *folder, const struct result *result, struct error *error)
{
    struct arena *arena = arena_create(0);
    return line_append(arena, folder, result_to_json(arena, result), error);
}

enum status run_append_calibration(const char *folder, const struct calibration *calibration,
                                   struct error *error)
{
    struct arena *arena = arena_create(0);
    return line_append(arena, folder, calibration_to_json(arena, calibration), error);
}

enum status run_append_tracing(const char *folder, const struct tracing *tracing,
                               struct error *error)
{
    struct arena *arena = arena_create(0);
    return line_append(arena, folder, tracing_to_json(arena, tracing), error);
}

enum status run_lock(const char *folder, int *lock, struct error *error)
{
    enum status status = file_make_folder(folder, error);
    if (status)
        return status;
    char path[4096];
    snprintf(path, sizeof path, "%.4000s/.lock", folder);
    *lock = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (*lock < 0)
        return error_errno(error, STATUS_IO, "%s: cannot be written", path);
    struct flock whole = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    if (!fcntl(*lock, F_SETLK, &whole))
        return STATUS_OK;
    int number = errno;
    fcntl(*lock, F_GETLK, &whole);
    close(*lock);
    if (number == EACCES || number == EAGAIN)
        return error_set(error, STATUS_USAGE, "%s: another run (process %ld) is writing here",
                         folder, (long)whole.l_pid);
    errno = number;
    return error_errno(error, STATUS_IO, "%s: cannot be locked", path);
}

void run_unlock(int lock)
{
    close(lock);
}
