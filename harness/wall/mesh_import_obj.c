/* OBJ files that assimp would misread. */
#include "wall/mesh_import_check.h"

#include <stdio.h>
#include <string.h>

enum status obj_check(const char *path, struct error *error)
{
    char head[4] = "";
    FILE *file = fopen(path, "rbe");
    size_t size = file ? fread(head, 1, sizeof head, file) : 0;
    if (file)
        fclose(file);
    bool marked = size == sizeof head && memcmp(head, "\xef\xbb\xbf", 3) == 0;
    if (marked && !strchr("#\r\n", head[3]))
        return error_set(error, STATUS_INVALID,
                         "%s:1: a byte order mark hides the line's first word; store the file "
                         "without it, or begin with a comment",
                         path);
    return STATUS_OK;
}
