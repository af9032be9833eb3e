/* Imported plants: bad files and values are refused, the cache and the hash know their files. */
#include "plant_imports.h"

#include "plant/import_steps.h"

#include <math.h>

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
    ((char *)bytes)[size - 1] = 'x'; /* a name without an end */
    assert_null(import_decode(arena, bytes, size));
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cache__keeps_a_mesh_whole_and_refuses_torn_bytes),
        cmocka_unit_test(test_cache__is_used_and_gives_the_same_mesh),
        cmocka_unit_test(test_hash__changes_with_any_of_the_files),
        cmocka_unit_test(test_files__that_are_missing_empty_or_folders_are_refused),
        cmocka_unit_test(test_files__that_are_torn_are_refused),
        cmocka_unit_test(test_values__that_no_plant_can_have_are_refused),
    };
    return cmocka_run_group_tests(tests, enter_folder, leave_folder);
}
