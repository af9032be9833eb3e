/* Imported plants: small OBJ, PLY, glTF and GLB files are written and read back; bad ones refused.
 */
#include "testing.h"

#include "plant_files.h"

#include "base/file.h"
#include "plant/import_steps.h"
#include "plant/normals.h"
#include "plant/plant.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
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

static void put_tree(void)
{
    put_text("tree.obj", tree_obj);
    put_text("tree.mtl", tree_mtl);
    struct bytes *png = leaf_png();
    put("leaf.png", png->at, png->size);
}

/* Reading them */

static const struct mesh *imported(struct arena *arena, const char *path,
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

static void refused(const char *path, const struct plant_import *import, enum status status,
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

static double area_of_part(const struct mesh *mesh, size_t part)
{
    double area = 0;
    for (uint32_t i = 0; i < mesh->parts[part].triangles_count; i++) {
        const uint32_t *t = mesh->triangles[mesh->parts[part].first_triangle + i];
        double c[3];
        triangle_cross(mesh->positions[t[0]], mesh->positions[t[1]], mesh->positions[t[2]], c);
        area += sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]) / 2;
    }
    return area;
}

static void assert_vector(const float *got, double x, double y, double z)
{
    assert_float_equal(got[0], x, 1e-5);
    assert_float_equal(got[1], y, 1e-5);
    assert_float_equal(got[2], z, 1e-5);
}

static void test_obj__keeps_its_parts_leaves_areas_and_colours(void **state)
{
    (void)state;
    put_tree();
    struct arena *arena = arena_create(0);
    const struct mesh *mesh = imported(arena, "tree.obj", NULL);
    assert_int_equal(mesh->triangles_count, 12 + 5);
    assert_int_equal(mesh->parts_count, 2);
    const struct mesh_part *bark = &mesh->parts[0], *leaves = &mesh->parts[1];
    assert_int_equal(mesh->materials[bark->material].kind, MATERIAL_BARK);
    assert_int_equal(mesh->materials[leaves->material].kind, MATERIAL_LEAF);
    assert_string_equal(mesh->materials[leaves->material].name, "Blatt_Leaf");
    assert_vector(mesh->materials[bark->material].albedo, 0.3, 0.2, 0.1);
    assert_float_equal(area_of_part(mesh, 0), 4 * 0.2 * 2 + 2 * 0.2 * 0.2, 1e-5);
    assert_float_equal(area_of_part(mesh, 1), 0.5 + 1 + 0.5, 1e-5);
    const uint32_t first[] = {12, 14, 15, 17};
    assert_int_equal(leaves->elements_count, 3);
    assert_memory_equal(leaves->element_first, first, sizeof first);
    assert_vector(mesh->minimum_m, -1, 0, -0.1);
    assert_vector(mesh->maximum_m, 3, 4, 2);
    assert_float_equal(mesh->radius_m, sqrt(13), 1e-5);
    arena_destroy(arena);
}

static void test_obj__has_smooth_bark_and_flat_leaves_where_the_file_has_no_normals(void **state)
{
    (void)state;
    put_tree();
    struct arena *arena = arena_create(0);
    const struct mesh *mesh = imported(arena, "tree.obj", NULL);
    assert_int_equal(mesh->vertices_count, 8 + 4 + 3 + 4);
    for (uint32_t i = 0; i < 12; i++)
        for (int k = 0; k < 3; k++) {
            const uint32_t v = mesh->triangles[i][k];
            const float *p = mesh->positions[v], *n = mesh->normals[v];
            /* Outward at a corner: along x, y and z at once. */
            assert_true(p[0] * n[0] > 0 && p[2] * n[2] > 0 && (p[1] - 1) * n[1] > 0);
        }
    for (int k = 0; k < 3; k++) {
        assert_vector(mesh->normals[mesh->triangles[12][k]], 0, 0, 1);
        assert_vector(mesh->normals[mesh->triangles[14][k]], 0, -1, 0);
    }
    arena_destroy(arena);
}

static void check_leaf_texture(const struct texture *texture)
{
    assert_non_null(texture);
    assert_int_equal(texture->width_px, 2);
    assert_int_equal(texture->height_px, 2);
    /* Row 0 is v = 0, the picture's lowest row. sRGB 188 is linear 0.50289 (IEC 61966-2-1). */
    assert_float_equal(texture->rgba[0], 0.50289, 1e-4);
    assert_float_equal(texture->rgba[3], 1, 1e-6);
    assert_float_equal(texture->rgba[7], 0, 1e-6);
    assert_vector(texture->rgba + 8, 0, 1, 0);
    assert_vector(texture->rgba + 12, 1, 0, 0);
}

static void test_obj__texture_is_decoded_and_stands_upright(void **state)
{
    (void)state;
    put_tree();
    struct arena *arena = arena_create(0);
    const struct mesh *mesh = imported(arena, "tree.obj", NULL);
    check_leaf_texture(mesh->materials[mesh->parts[1].material].texture);
    assert_null(mesh->materials[mesh->parts[0].material].texture);
    for (uint32_t i = 12; i < 17; i++)
        for (int k = 0; k < 3; k++) {
            /* The first leaf spans x 0..1, y 2..2.5. */
            const uint32_t v = mesh->triangles[i][k];
            if (i < 14)
                assert_float_equal(mesh->uvs[v][0], mesh->positions[v][0], 1e-5);
            if (i < 14)
                assert_float_equal(mesh->uvs[v][1], (mesh->positions[v][1] - 2) * 2, 1e-5);
        }
    arena_destroy(arena);
}

static void test_obj__opacity_map_makes_holes_and_marks_leaves(void **state)
{
    (void)state;
    const unsigned char grey[16] = {255, 255, 255, 255, 255, 255, 255, 255,
                                    0,   0,   0,   255, 255, 255, 255, 255};
    put_tree();
    put_text("mask.obj", "mtllib mask.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
                         "usemtl plain\nf 1/1 2/2 3/3\n");
    put_text("mask.mtl", "newmtl plain\nmap_Kd leaf2.png\nmap_d mask.png\n");
    struct bytes *png = png_of(grey, 2, 2);
    put("leaf2.png", png->at, png->size);
    put("mask.png", png->at, png->size);
    struct arena *arena = arena_create(0);
    const struct mesh *mesh = imported(arena, "mask.obj", NULL);
    const struct material *material = &mesh->materials[mesh->parts[0].material];
    assert_int_equal(material->kind, MATERIAL_LEAF);
    /* The mask's alpha is opaque everywhere, so its grey counts. */
    assert_float_equal(material->texture->rgba[3], 0, 1e-6);
    assert_float_equal(material->texture->rgba[7], 1, 1e-6);
    arena_destroy(arena);
}

static void test_import__scales_turns_and_recolours(void **state)
{
    (void)state;
    put_text("z.obj", "v 1 1 10\nv 3 1 10\nv 1 3 10\nv 1.5 1.5 15\nusemtl leafy\nf 1 2 4\n"
                      "usemtl stem\nf 2 3 4\nf 3 1 4\nf 1 3 2\n");
    const float green[3] = {0.1f, 0.2f, 0.05f}, brown[3] = {0.3f, 0.2f, 0.1f};
    struct plant_import import = {.height_m = 20,
                                  .z_up = true,
                                  .leaf = " twig, LEAF",
                                  .leaf_albedo = green,
                                  .bark_albedo = brown};
    struct arena *arena = arena_create(0);
    const struct mesh *mesh = imported(arena, "z.obj", &import);
    assert_int_equal(mesh->parts_count, 2);
    assert_vector(mesh->materials[mesh->parts[0].material].albedo, 0.3, 0.2, 0.1);
    assert_vector(mesh->materials[mesh->parts[1].material].albedo, 0.1, 0.2, 0.05);
    assert_int_equal(mesh->parts[1].triangles_count, 1);
    /* 5 high becomes 20; the foot's middle (5/3, 5/3) moves to the axis; +z turns up, +y turns to
     * -z. */
    assert_float_equal(mesh->minimum_m[1], 0, 1e-5);
    for (size_t i = 0; i < mesh->vertices_count; i++)
        if (mesh->positions[i][1] > 1)
            assert_vector(mesh->positions[i], -2.0 / 3, 20, 2.0 / 3);
    assert_float_equal(mesh->minimum_m[2], -(3 - 5.0 / 3) * 4, 1e-5);
    arena_destroy(arena);
}

/* A tube, a closed box and a bent leaf of one material: the leaf alone is flat and open. */
static void test_import__flat_open_pieces_are_leaves_where_no_material_is(void **state)
{
    (void)state;
    put_text("parts.mtl", "newmtl stuff\nKd 0.3 0.2 0.1\n");
    put_text("parts.obj", "mtllib parts.mtl\nusemtl stuff\n"
                          "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nv 0 3 0\nv 1 3 0\nv 1 3 1\nv 0 3 1\n"
                          "v 2 3 0\nv 3 3 0\nv 3 3 1\nv 2 3 1\nv 2 4 0\nv 3 4 0\nv 3 4 1\nv 2 4 1\n"
                          "v 4 4 0\nv 5 4.5 0\nv 6 4 0\nv 4 4 1\nv 5 4.5 1\nv 6 4 1\n"
                          "f 17 20 21 18\n"
                          "f 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\n"
                          "f 9 13 14 10\nf 10 14 15 11\nf 11 15 16 12\nf 12 16 13 9\n"
                          "f 9 10 11 12\nf 16 15 14 13\n"
                          "f 18 21 22 19\n");
    const float green[3] = {0.1f, 0.2f, 0.05f};
    struct plant_import import = {.leaf_albedo = green};
    struct arena *arena = arena_create(0);
    const struct mesh *mesh = imported(arena, "parts.obj", &import);
    assert_int_equal(mesh->parts_count, 2);
    const struct mesh_part *bark = &mesh->parts[0], *leaf = &mesh->parts[1];
    assert_int_equal(mesh->materials[bark->material].kind, MATERIAL_BARK);
    assert_int_equal(mesh->materials[leaf->material].kind, MATERIAL_LEAF);
    assert_vector(mesh->materials[bark->material].albedo, 0.3, 0.2, 0.1);
    assert_vector(mesh->materials[leaf->material].albedo, 0.1, 0.2, 0.05);
    assert_int_equal(bark->triangles_count, 8 + 12);
    assert_int_equal(leaf->triangles_count, 4);
    assert_int_equal(leaf->elements_count, 1);
    /* Who says that there are no leaves is believed. */
    mesh = imported(arena, "parts.obj", &(struct plant_import){.leaf = ""});
    assert_int_equal(mesh->parts_count, 1);
    assert_int_equal(mesh->materials[mesh->parts[0].material].kind, MATERIAL_BARK);
    arena_destroy(arena);
}

static void test_ply__integer_colours_are_decoded_and_float_ones_are_linear(void **state)
{
    (void)state;
    const char *const kinds[] = {"uchar", "float"}, *const values[] = {"188 0 255", "0.5 0 1"};
    const double red[] = {0.50289, 0.5};
    for (int i = 0; i < 2; i++) {
        struct arena *arena = arena_create(0);
        put_text("c.ply", arena_printf(arena,
                                       "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\n"
                                       "property float y\nproperty float z\nproperty %s red\n"
                                       "property %s green\nproperty %s blue\nelement face 1\n"
                                       "property list uchar int vertex_indices\nend_header\n"
                                       "0 0 0 %s\n1 0 0 %s\n1 1 0 %s\n0 1 0 %s\n4 0 1 2 3\n",
                                       kinds[i], kinds[i], kinds[i], values[i], values[i],
                                       values[i], values[i]));
        const struct mesh *mesh = imported(arena, "c.ply", NULL);
        assert_int_equal(mesh->triangles_count, 2);
        assert_int_equal(mesh->vertices_count, 4);
        assert_vector(mesh->materials[mesh->parts[0].material].albedo, 1, 1, 1);
        assert_float_equal(mesh->colors[0][0], red[i], 1e-4);
        assert_float_equal(mesh->colors[0][1], 0, 1e-6);
        assert_float_equal(mesh->colors[0][2], 1, 1e-6);
        arena_destroy(arena);
    }
}

/* A unit square of two triangles: positions, texture coordinates (v down), colours, indices. */
static struct bytes *square(float first_x)
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
static const char *gltf(struct arena *arena, const char *buffer, const char *image,
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

static void put_gltf(struct arena *arena, const char *path, const char *alpha, float first_x)
{
    const char *buffer = arena_printf(
        arena, "\"byteLength\":140,\"uri\":\"data:application/octet-stream;base64,%s\"",
        base64(square(first_x)));
    const char *image =
        arena_printf(arena, "\"uri\":\"data:image/png;base64,%s\"", base64(leaf_png()));
    put_text(path, gltf(arena, buffer, image, "", alpha));
}

static void check_squares(const struct mesh *mesh)
{
    assert_int_equal(mesh->triangles_count, 4);
    assert_int_equal(mesh->parts_count, 1);
    assert_int_equal(mesh->parts[0].elements_count, 2);
    assert_int_equal(mesh->materials[mesh->parts[0].material].kind, MATERIAL_LEAF);
    assert_vector(mesh->materials[mesh->parts[0].material].albedo, 0.2, 0.4, 0.1);
    assert_float_equal(area_of_part(mesh, 0), 1 + 4, 1e-5);
    /* Feet at x = 0, 1, 3, 5: their mean moves to the axis. */
    assert_vector(mesh->minimum_m, -2.25, 0, 0);
    assert_vector(mesh->maximum_m, 2.75, 2, 0);
    for (size_t i = 0; i < mesh->vertices_count; i++) {
        assert_vector(mesh->normals[i], 0, 0, 1); /* a mirror in x leaves the front in front */
        assert_vector(mesh->colors[i], 0.5, 1, 1);
        bool large = mesh->positions[i][0] > 0.5f;
        assert_float_equal(mesh->uvs[i][1], mesh->positions[i][1] / (large ? 2.0f : 1.0f), 1e-5);
    }
    check_leaf_texture(mesh->materials[mesh->parts[0].material].texture);
}

static void test_gltf__applies_nodes_mirrors_and_linear_colours(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    put_gltf(arena, "square.gltf", "\"alphaMode\":\"MASK\",", 0);
    check_squares(imported(arena, "square.gltf", NULL));
    arena_destroy(arena);
}

static void test_gltf__opaque_materials_have_no_holes_and_cutoffs_are_kept(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    put_gltf(arena, "opaque.gltf", "\"alphaMode\":\"OPAQUE\",", 0);
    const struct mesh *mesh = imported(arena, "opaque.gltf", NULL);
    assert_float_equal(mesh->materials[0].texture->rgba[7], 1, 1e-6);
    /* Alpha 64 / 255 passes a cut-off of 0.25 and fails one of 0.26. */
    const unsigned char texel[4] = {255, 255, 255, 64};
    struct bytes *png = png_of(texel, 1, 1);
    put("one.png", png->at, png->size);
    const char *buffer = arena_printf(
        arena, "\"byteLength\":140,\"uri\":\"data:application/octet-stream;base64,%s\"",
        base64(square(0)));
    for (int i = 0; i < 2; i++) {
        put_text("cut.gltf", gltf(arena, buffer, "\"uri\":\"one.png\"", "",
                                  i ? "\"alphaMode\":\"MASK\",\"alphaCutoff\":0.26,"
                                    : "\"alphaMode\":\"MASK\",\"alphaCutoff\":0.25,"));
        const struct texture *t = imported(arena, "cut.gltf", NULL)->materials[0].texture;
        assert_int_equal(t->rgba[3] >= 0.5f, i == 0);
    }
    arena_destroy(arena);
}

static void put_glb(struct arena *arena, const char *path, size_t truncate)
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

static void test_glb__holds_its_buffer_and_its_texture(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    put_glb(arena, "square.glb", 0);
    check_squares(imported(arena, "square.glb", NULL));
    arena_destroy(arena);
}

static bool same_mesh(const struct mesh *a, const struct mesh *b)
{
    size_t n = a->vertices_count;
    return n == b->vertices_count && a->triangles_count == b->triangles_count &&
           memcmp(a->positions, b->positions, n * sizeof(float[3])) == 0 &&
           memcmp(a->normals, b->normals, n * sizeof(float[3])) == 0 &&
           memcmp(a->uvs, b->uvs, n * sizeof(float[2])) == 0 &&
           memcmp(a->triangles, b->triangles, a->triangles_count * sizeof(uint32_t[3])) == 0 &&
           a->parts[1].elements_count == b->parts[1].elements_count &&
           memcmp(a->parts[1].element_first, b->parts[1].element_first,
                  (a->parts[1].elements_count + 1) * sizeof(uint32_t)) == 0 &&
           memcmp(a->materials[a->parts[1].material].texture->rgba,
                  b->materials[b->parts[1].material].texture->rgba, 16 * sizeof(float)) == 0;
}

static void test_cache__keeps_a_mesh_whole_and_refuses_torn_bytes(void **state)
{
    (void)state;
    put_tree();
    struct arena *arena = arena_create(0);
    setenv("TREELINE_CACHE", "off", 1);
    const struct mesh *mesh = imported(arena, "tree.obj", NULL);
    setenv("TREELINE_CACHE", "cache", 1);
    size_t size;
    void *bytes = import_encode(arena, mesh, &size);
    struct mesh *decoded = import_decode(arena, bytes, size);
    assert_non_null(decoded);
    assert_int_equal(mesh_check(decoded, NULL), STATUS_OK);
    assert_true(same_mesh(mesh, decoded));
    assert_vector(decoded->maximum_m, 3, 4, 2);
    assert_string_equal(decoded->materials[decoded->parts[1].material].name, "Blatt_Leaf");
    for (size_t torn = 0; torn < size; torn++)
        assert_null(import_decode(arena, bytes, torn));
    arena_destroy(arena);
}

static void test_cache__is_used_and_gives_the_same_mesh(void **state)
{
    (void)state;
    put_tree();
    struct arena *arena = arena_create(0);
    assert_int_equal(cache_trim(0, &(size_t){0}, NULL), STATUS_OK);
    const struct mesh *first = imported(arena, "tree.obj", NULL);
    size_t removed = 0;
    const struct mesh *second = imported(arena, "tree.obj", NULL);
    assert_true(same_mesh(first, second));
    assert_int_equal(cache_trim(0, &removed, NULL), STATUS_OK);
    assert_true(removed > 0);
    arena_destroy(arena);
}

static uint64_t hash_of(const char *path, double height_m)
{
    struct arena *arena = arena_create(0);
    struct plant_import import = {.height_m = height_m};
    struct plant *plant;
    uint64_t hash = 0;
    assert_int_equal(plant_file(arena, path, &import, &plant, NULL), STATUS_OK);
    assert_int_equal(plant_hash(plant, &hash, NULL), STATUS_OK);
    assert_false(plant_cost(plant).built);
    arena_destroy(arena);
    return hash;
}

static void test_hash__changes_with_any_of_the_files(void **state)
{
    (void)state;
    put_tree();
    uint64_t whole = hash_of("tree.obj", 0);
    assert_true(whole == hash_of("tree.obj", 0));
    assert_true(whole != hash_of("tree.obj", 3));
    put_text("tree.mtl", "newmtl trunk\nKd 0.3 0.2 0.2\nnewmtl Blatt_Leaf\nmap_Kd leaf.png\n");
    uint64_t other = hash_of("tree.obj", 0);
    assert_true(whole != other);
    struct bytes *png = png_of(leaf_texels + 4, 1, 1);
    put("leaf.png", png->at, png->size);
    assert_true(other != hash_of("tree.obj", 0));
    struct arena *arena = arena_create(0);
    put_text("file.gltf", gltf(arena, "\"byteLength\":140,\"uri\":\"file.bin\"",
                               "\"uri\":\"leaf.png\"", "", ""));
    put("file.bin", square(0)->at, 140);
    whole = hash_of("file.gltf", 0);
    put("file.bin", square(0.5f)->at, 140);
    assert_true(whole != hash_of("file.gltf", 0));
    arena_destroy(arena);
}

static void test_degenerate_triangles__are_dropped(void **state)
{
    (void)state;
    put_text("thin.obj",
             "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\nf 1 3 5\n");
    struct arena *arena = arena_create(0);
    const struct mesh *mesh = imported(arena, "thin.obj", NULL);
    assert_int_equal(mesh->triangles_count, 1);
    assert_vector(mesh->maximum_m, 0.5, 1,
                  0); /* the dropped vertex at x = 2 does not move the foot */
    arena_destroy(arena);
}

static void test_files__that_are_missing_empty_or_folders_are_refused(void **state)
{
    (void)state;
    file_make_folder("folder.obj", NULL);
    put_text("empty.ply", "");
    put_text("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    put_text("lone.obj", "mtllib nowhere.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    put_text("bare.obj",
             "mtllib bare.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n");
    put_text("bare.mtl", "newmtl a\nmap_Kd nothing.png\n");
    put_text("plain.obj", "mtllib plain.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
    put_tree();
    put_text("plain.mtl", "newmtl a\nmap_Kd leaf.png\n");
    refused("nowhere.obj", NULL, STATUS_NOT_FOUND, "No such file");
    refused("folder.obj", NULL, STATUS_INVALID, "is not a regular file");
    refused("empty.ply", NULL, STATUS_INVALID, "is empty");
    refused("tree.fbx", NULL, STATUS_INVALID, "allowed: .obj, .ply, .gltf, .glb");
    refused("points.obj", NULL, STATUS_INVALID, "points.obj: ");
    refused("lone.obj", NULL, STATUS_NOT_FOUND, "material library 'nowhere.mtl' does not exist");
    refused("bare.obj", NULL, STATUS_NOT_FOUND, "material 'a': its texture 'nothing.png'");
    refused("plain.obj", NULL, STATUS_INVALID, "material 'a' has a texture");
}

static void test_files__that_are_torn_are_refused(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    put_glb(arena, "torn.glb", 200);
    put_text("torn.gltf", "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"no");
    put_text("torn.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n");
    put_text("short.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                          "property float y\nproperty float z\nelement face 1\n"
                          "property list uchar int vertex_indices\nend_header\n"
                          "0 0 0\n1 0 0\n0 1 0\n");
    put_text("crash.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 1\n"
                          "property float x\nproperty float y\nproperty float z\nelement face 1\n"
                          "property list uchar int vertex_indices\nend_header\n"
                          "0123456789ab\3");
    put_text("torn.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
    put_text("marked.obj", "\xef\xbb\xbfv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    put_text("noise.glb", "glTF\1\2\3\4 this is not one");
    put_text("lost.gltf", gltf(arena, "\"byteLength\":140,\"uri\":\"lost.bin\"",
                               "\"uri\":\"leaf.png\"", "", ""));
    refused("torn.glb", NULL, STATUS_INVALID, "torn.glb: ");
    refused("marked.obj", NULL, STATUS_INVALID, "marked.obj:1: a byte order mark");
    refused("torn.gltf", NULL, STATUS_INVALID, "torn.gltf: ");
    refused("torn.ply", NULL, STATUS_INVALID, "torn.ply: ");
    refused("short.ply", NULL, STATUS_INVALID, "ends after 3 of 4 elements");
    refused("crash.ply", NULL, STATUS_INVALID, "crash.ply: "); /* assimp 5.2 reads past its end */
    refused("torn.obj", NULL, STATUS_INVALID, "torn.obj: ");
    refused("noise.glb", NULL, STATUS_INVALID, "noise.glb: ");
    refused("lost.gltf", NULL, STATUS_INVALID, "lost.bin");
    arena_destroy(arena);
}

static void test_values__that_no_plant_can_have_are_refused(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    put_tree();
    put_gltf(arena, "nan.gltf", "", NAN);
    put_text("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n");
    put_text("line.obj", "v 0 0 0\nv 1 1 0\nv 2 2 0\nf 1 2 3\n");
    put_text("huge.obj", "v 0 0 0\nv 1 5000 0\nv 2 2 0\nf 1 2 3\n");
    refused("nan.gltf", NULL, STATUS_INVALID, "vertex 0 of mesh '");
    refused("flat.obj", NULL, STATUS_INVALID, "is flat");
    refused("line.obj", NULL, STATUS_INVALID, "none of its 1 triangles has an area");
    refused("huge.obj", NULL, STATUS_INVALID, "is 5000 m high; allowed: 0.001..1000");
    struct plant_import import = {.leaf = "petal,straw"};
    refused("tree.obj", &import, STATUS_INVALID, "'petal,straw'; its materials are");
    import = (struct plant_import){.height_m = -1};
    refused("tree.obj", &import, STATUS_INVALID, "height_m: -1 is outside 0..1000");
    const float bright[3] = {0, 2, 0};
    import = (struct plant_import){.leaf_albedo = bright};
    refused("tree.obj", &import, STATUS_INVALID, "leaf_albedo: 2 is outside 0..1");
    arena_destroy(arena);
}

static int enter_folder(void **state)
{
    (void)state;
    static char folder[] = "/tmp/treeline-test-XXXXXX";
    if (!mkdtemp(folder) || chdir(folder) != 0)
        return -1;
    *state = folder;
    return setenv("TREELINE_CACHE", "cache", 1);
}

static int leave_folder(void **state)
{
    char command[128];
    snprintf(command, sizeof command, "rm -rf %s", (const char *)*state);
    return chdir("/") != 0 || system(command) != 0 ? -1 : 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_obj__keeps_its_parts_leaves_areas_and_colours),
        cmocka_unit_test(test_obj__has_smooth_bark_and_flat_leaves_where_the_file_has_no_normals),
        cmocka_unit_test(test_obj__texture_is_decoded_and_stands_upright),
        cmocka_unit_test(test_obj__opacity_map_makes_holes_and_marks_leaves),
        cmocka_unit_test(test_import__scales_turns_and_recolours),
        cmocka_unit_test(test_import__flat_open_pieces_are_leaves_where_no_material_is),
        cmocka_unit_test(test_ply__integer_colours_are_decoded_and_float_ones_are_linear),
        cmocka_unit_test(test_gltf__applies_nodes_mirrors_and_linear_colours),
        cmocka_unit_test(test_gltf__opaque_materials_have_no_holes_and_cutoffs_are_kept),
        cmocka_unit_test(test_glb__holds_its_buffer_and_its_texture),
        cmocka_unit_test(test_cache__keeps_a_mesh_whole_and_refuses_torn_bytes),
        cmocka_unit_test(test_cache__is_used_and_gives_the_same_mesh),
        cmocka_unit_test(test_hash__changes_with_any_of_the_files),
        cmocka_unit_test(test_degenerate_triangles__are_dropped),
        cmocka_unit_test(test_files__that_are_missing_empty_or_folders_are_refused),
        cmocka_unit_test(test_files__that_are_torn_are_refused),
        cmocka_unit_test(test_values__that_no_plant_can_have_are_refused),
    };
    return cmocka_run_group_tests(tests, enter_folder, leave_folder);
}
