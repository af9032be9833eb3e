/* Plants in files for the tests of the import, read or refused, in a folder of the tests' own. */
#ifndef TREELINE_TESTS_PLANT_IMPORTS_H
#define TREELINE_TESTS_PLANT_IMPORTS_H

#include "testing.h"

#include "plant_files.h"

#include "plant/plant.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

/* A trunk (a box of 0.2 x 2 x 0.2 that stands at x = 5) and leaves: two quads and one triangle. */
static const char tree_obj[] = "mtllib tree.mtl\n"
                               "v 4.9 1 -0.1\nv 5.1 1 -0.1\nv 5.1 1 0.1\nv 4.9 1 0.1\n"
                               "v 4.9 3 -0.1\nv 5.1 3 -0.1\nv 5.1 3 0.1\nv 4.9 3 0.1\n"
                               "v 5 3 0\nv 6 3 0\nv 6 3.5 0\nv 5 3.5 0\n"
                               "v 4 4 0\nv 5 4 0\nv 5 5 0\nv 4 5 0\n"
                               "v 7 4 1\nv 8 4 1\nv 8 4 2\n"
                               "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                               "usemtl Blatt_Leaf\n"
                               "f 9/1 10/2 11/3 12/4\nf 17/1 18/2 19/3\nf 13/1 14/2 15/3 16/4\n"
                               "usemtl trunk\n"
                               "f 1 4 8 5\nf 2 6 7 3\nf 1 5 6 2\nf 4 3 7 8\nf 1 2 3 4\nf 5 8 7 6\n";
static const char tree_mtl[] = "newmtl trunk\nKd 0.3 0.2 0.1\n"
                               "newmtl Blatt_Leaf\nKd 0.5 0.5 0.5\nmap_Kd leaf.png\n";

static inline void put_tree(void)
{
    put_text("tree.obj", tree_obj);
    put_text("tree.mtl", tree_mtl);
    struct bytes *png = leaf_png();
    put("leaf.png", png->at, png->size);
}

static inline const struct mesh *imported(struct arena *arena, const char *path,
                                          const struct plant_import *import)
{
    struct error error = {0};
    struct plant *plant;
    const struct mesh *mesh = NULL;
    if (plant_file(arena, path, import, &plant, &error) != STATUS_OK ||
        plant_mesh(plant, &mesh, &error) != STATUS_OK || mesh_check(mesh, &error) != STATUS_OK)
        fail_msg("%s: %s", path, error.text);
    return mesh;
}

static inline void refused(const char *path, const struct plant_import *import, enum status status,
                           const char *words)
{
    struct arena *arena = arena_create(0);
    struct error error = {0};
    struct plant *plant;
    const struct mesh *mesh;
    enum status got = plant_file(arena, path, import, &plant, &error);
    if (got == STATUS_OK)
        got = plant_mesh(plant, &mesh, &error);
    if (got != status || !strstr(error.text, words) || !strstr(error.text, path))
        fail_msg("%s: '%s' (%d) does not say '%s'", path, error.text, (int)got, words);
    arena_destroy(arena);
}

static inline void assert_vector(const float *got, double x, double y, double z)
{
    assert_float_equal(got[0], x, 1e-5);
    assert_float_equal(got[1], y, 1e-5);
    assert_float_equal(got[2], z, 1e-5);
}

/* A unit square of two triangles: positions, texture coordinates (v down), colours, indices. */
static inline struct bytes *square(float first_x)
{
    static struct bytes buffer;
    const float positions[12] = {first_x, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    const float uvs[8] = {0, 1, 1, 1, 1, 0, 0, 0};
    const float colors[12] = {0.5f, 1, 1, 0.5f, 1, 1, 0.5f, 1, 1, 0.5f, 1, 1};
    const uint16_t indices[6] = {0, 1, 2, 0, 2, 3};
    buffer.size = 0;
    add(&buffer, positions, sizeof positions);
    add(&buffer, uvs, sizeof uvs);
    add(&buffer, colors, sizeof colors);
    add(&buffer, indices, sizeof indices);
    return &buffer;
}

/* glTF text; buffer, image: what stands in their objects; alpha: the material's alpha members. The
 * square stands twice: as it is, and twice as large, mirrored in x, at x = 5. */
static inline const char *gltf(struct arena *arena, const char *buffer, const char *image,
                               const char *more_views, const char *alpha)
{
    return arena_printf(
        arena,
        "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
        "\"nodes\":[{\"children\":[1,2]},{\"mesh\":0},"
        "{\"mesh\":0,\"scale\":[-2,2,2],\"translation\":[5,0,0]}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1,\"COLOR_0\":"
        "2},"
        "\"indices\":3,\"material\":0}]}],"
        "\"materials\":[{\"name\":\"needles\",%s\"pbrMetallicRoughness\":{"
        "\"baseColorFactor\":[0.2,0.4,0.1,1],\"baseColorTexture\":{\"index\":0}}}],"
        "\"textures\":[{\"source\":0}],\"images\":[{%s}],\"buffers\":[{%s}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteOffset\":0,\"byteLength\":48},"
        "{\"buffer\":0,\"byteOffset\":48,\"byteLength\":32},"
        "{\"buffer\":0,\"byteOffset\":80,\"byteLength\":48},"
        "{\"buffer\":0,\"byteOffset\":128,\"byteLength\":12}%s],"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\","
        "\"min\":[0,0,0],\"max\":[1,1,0]},"
        "{\"bufferView\":1,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"},"
        "{\"bufferView\":2,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
        "{\"bufferView\":3,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"}]}",
        alpha, image, buffer, more_views);
}

static inline void put_gltf(struct arena *arena, const char *path, const char *alpha, float first_x)
{
    const char *buffer = arena_printf(
        arena, "\"byteLength\":140,\"uri\":\"data:application/octet-stream;base64,%s\"",
        base64(square(first_x)));
    const char *image =
        arena_printf(arena, "\"uri\":\"data:image/png;base64,%s\"", base64(leaf_png()));
    put_text(path, gltf(arena, buffer, image, "", alpha));
}

static inline void put_glb(struct arena *arena, const char *path, size_t truncate)
{
    static struct bytes glb, buffer;
    buffer = *square(0);
    struct bytes *png = leaf_png();
    add(&buffer, png->at, png->size);
    const char *views =
        arena_printf(arena, ",{\"buffer\":0,\"byteOffset\":140,\"byteLength\":%zu}", png->size);
    while (buffer.size % 4)
        add(&buffer, "", 1);
    const char *json =
        gltf(arena, arena_printf(arena, "\"byteLength\":%zu", buffer.size),
             "\"bufferView\":4,\"mimeType\":\"image/png\"", views, "\"alphaMode\":\"MASK\",");
    json = arena_printf(arena, "%s%s", json, &"   "[strlen(json) % 4 ? strlen(json) % 4 - 1 : 3]);
    uint32_t json_size = (uint32_t)strlen(json), binary_size = (uint32_t)buffer.size;
    uint32_t head[3] = {0x46546c67, 2, 12 + 8 + json_size + 8 + binary_size};
    uint32_t json_head[2] = {json_size, 0x4e4f534a}, binary_head[2] = {binary_size, 0x004e4942};
    glb.size = 0;
    add(&glb, head, sizeof head);
    add(&glb, json_head, sizeof json_head);
    add(&glb, json, json_size);
    add(&glb, binary_head, sizeof binary_head);
    add(&glb, buffer.at, buffer.size);
    put(path, glb.at, glb.size - truncate);
}

static inline int enter_folder(void **state)
{
    (void)state;
    static char folder[] = "/tmp/treeline-test-XXXXXX";
    if (!mkdtemp(folder) || chdir(folder) != 0)
        return -1;
    *state = folder;
    return setenv("TREELINE_CACHE", "cache", 1);
}

static inline int leave_folder(void **state)
{
    char command[128];
    snprintf(command, sizeof command, "rm -rf %s", (const char *)*state);
    return chdir("/") != 0 || system(command) != 0 ? -1 : 0;
}

#endif
