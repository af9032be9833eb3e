/* Reads a mesh file in a child process: assimp crashes on some damaged files and waits for ever on
 * others, and neither may end a run. */
#include "wall/mesh_import.h"

#include "base/child.h"
#include "wall/mesh_import_parts.h"

#include <errno.h>
#include <signal.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/* A child may take this long, and a second more for each MB of the file. */
enum { LIMIT_SECONDS = 20 };

/* What the child says through shared memory. */
struct answer {
    struct error error;
};

static unsigned limit_seconds(const char *path)
{
    struct stat info;
    if (stat(path, &info) != 0)
        return LIMIT_SECONDS;
    return LIMIT_SECONDS + (unsigned)(info.st_size >> 20);
}

static _Noreturn void read_in_child(const char *path, size_t triangles_limit, int file,
                                    struct answer *answer)
{
    child_begin(limit_seconds(path));
    struct arena *arena = arena_create(0);
    struct import_soup *soup = NULL;
    struct error error = {0};
    enum status status = mesh_import_assimp(arena, path, triangles_limit, &soup, &error);
    if (status == STATUS_OK && !soup_write(file, soup))
        error_errno(&error, STATUS_IO, "%s: its triangles could not be handed over", path);
    answer->error = error;
    _exit(0);
}

static enum status ended(const char *path, pid_t child, const struct answer *answer,
                         struct error *error)
{
    int state;
    while (waitpid(child, &state, 0) < 0)
        if (errno != EINTR)
            return error_errno(error, STATUS_INTERNAL, "%s: its reader was lost", path);
    if (WIFSIGNALED(state) && WTERMSIG(state) == SIGALRM)
        return error_set(error, STATUS_INVALID,
                         "%s: is damaged or too complex: reading it took more than %u s", path,
                         limit_seconds(path));
    if (WIFEXITED(state) && WEXITSTATUS(state) == STATUS_MEMORY)
        return error_set(error, STATUS_MEMORY, "%s: does not fit into memory", path);
    if (WIFSIGNALED(state) || WEXITSTATUS(state) != 0)
        return error_set(error, STATUS_INVALID, "%s: is damaged: its reader crashed (%s %d)", path,
                         WIFSIGNALED(state) ? "signal" : "exit code",
                         WIFSIGNALED(state) ? WTERMSIG(state) : WEXITSTATUS(state));
    if (answer->error.status != STATUS_OK)
        return error_set(error, answer->error.status, "%s", answer->error.text);
    return STATUS_OK;
}

enum status mesh_import(struct arena *arena, const char *path, size_t triangles_limit,
                        struct import_soup **soup, struct error *error)
{
    struct answer *answer =
        mmap(NULL, sizeof *answer, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (answer == MAP_FAILED)
        return error_errno(error, STATUS_MEMORY, "%s: cannot be read", path);
    int file = memfd_create("treeline-mesh", MFD_CLOEXEC);
    pid_t child = file < 0 ? -1 : fork();
    if (child == 0)
        read_in_child(path, triangles_limit, file, answer);
    enum status status = child < 0 ? error_errno(error, STATUS_INTERNAL, "%s: cannot be read", path)
                                   : ended(path, child, answer, error);
    if (status == STATUS_OK && !(*soup = soup_read(arena, file)))
        status = error_set(error, STATUS_INTERNAL, "%s: its triangles were lost on the way", path);
    if (file >= 0)
        close(file);
    munmap(answer, sizeof *answer);
    return status;
}
