/* Where a run was made: machine, system, build. */
#include "results/result.h"

#include "base/clock.h"
#include "build_facts.h"

#include <gnu/libc-version.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <time.h>
#include <unistd.h>

/* The rest of the first line of a file that begins with the key, behind ':' or '=', without blanks
 * and quotes. */
static const char *line_value(struct arena *arena, const char *path, const char *key)
{
    FILE *file = fopen(path, "re");
    char line[512];
    const char *found = NULL;
    while (file && !found && fgets(line, sizeof line, file)) {
        if (strncmp(line, key, strlen(key)) != 0)
            continue;
        char *value = line + strlen(key);
        value += strspn(value, " \t:=\"");
        value[strcspn(value, "\"\n")] = 0;
        found = arena_strdup(arena, value);
    }
    if (file)
        fclose(file);
    return found ? found : "unknown";
}

static const char *now_iso(struct arena *arena)
{
    time_t now = time(NULL);
    struct tm parts;
    char text[32];
    gmtime_r(&now, &parts);
    strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
    return arena_strdup(arena, text);
}

void provenance_here(struct arena *arena, const struct plan *plan, const char *command,
                     const char *settings, struct provenance *provenance)
{
    struct utsname system;
    uname(&system);
    bool clang = strstr(__VERSION__, "lang") != NULL;
    *provenance = (struct provenance){
        .host = arena_strdup(arena, system.nodename),
        .cpu = line_value(arena, "/proc/cpuinfo", "model name"),
        .kernel = arena_printf(arena, "%s %s %s", system.sysname, system.release, system.machine),
        .os = line_value(arena, "/etc/os-release", "PRETTY_NAME"),
        .compiler = arena_printf(arena, "%s%s", clang ? "" : "gcc ", __VERSION__),
        .flags = TREELINE_FLAGS,
        .revision = TREELINE_REVISION,
        .libraries =
            arena_printf(arena, "%s, glibc %s", TREELINE_LIBRARIES, gnu_get_libc_version()),
        .plan = plan->name,
        .command = command,
        .settings = settings,
        .started = now_iso(arena),
        .cores = clock_cpu_count(),
        .memory_bytes = strtod(line_value(arena, "/proc/meminfo", "MemTotal"), NULL) * 1024,
        .seed = plan->cells_count ? plan->cells[0].seed : 0,
        .plan_hash = plan->hash,
        .rounds = plan->rounds,
        .frame_seconds = plan->frame_seconds,
        .reference_error = plan->reference_error,
    };
}
