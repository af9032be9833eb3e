/* libFuzzer's way to the targets: FUZZ_TARGET=NAME build/fuzz-clang/fuzz CORPUS... */
#include "fuzz/targets.h"

int LLVMFuzzerInitialize(int *count, char ***arguments);
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

static const struct fuzz_target *chosen;
static char folder[] = "/tmp/treeline-fuzz-XXXXXX";

/* Children of the mesh target leave by _exit and do not come here. */
static void folder_remove(void)
{
    char command[64];
    snprintf(command, sizeof command, "rm -rf %s", folder);
    if (system(command) != 0)
        fprintf(stderr, "fuzz: %s stays\n", folder);
}

int LLVMFuzzerInitialize(int *count, char ***arguments)
{
    (void)count, (void)arguments;
    chosen = fuzz_target(getenv("FUZZ_TARGET"));
    if (!chosen || !mkdtemp(folder)) {
        fprintf(stderr, "fuzz: FUZZ_TARGET is none of");
        for (int i = 0; i < FUZZ_TARGETS; i++)
            fprintf(stderr, " %s", fuzz_targets[i].name);
        fprintf(stderr, "\n");
        exit(2);
    }
    atexit(folder_remove);
    return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    fuzz_run(chosen, folder, bytes, size);
    return 0;
}
