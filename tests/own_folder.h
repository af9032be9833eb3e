/* A folder for the files of a test program, with a cache of its own in it; gone at the end. */
#ifndef TREELINE_TESTS_OWN_FOLDER_H
#define TREELINE_TESTS_OWN_FOLDER_H

#include "testing.h"

#include <stdio.h>
#include <stdlib.h>

static const char *folder;

static int folder_make(void **state)
{
    (void)state;
    static char name[] = "/tmp/treeline-test-XXXXXX", cache[64];
    folder = mkdtemp(name);
    snprintf(cache, sizeof cache, "%s/cache", name);
    setenv("TREELINE_CACHE", cache, 1);
    return folder ? 0 : -1;
}

static int folder_remove(void **state)
{
    (void)state;
    char command[128];
    snprintf(command, sizeof command, "rm -rf %s", folder);
    return system(command);
}

#endif
