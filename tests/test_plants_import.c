/* Imported plants: small OBJ, PLY, glTF and GLB files are written and read back. */
#include "plant_imports.h"

#include "plant/normals.h"

#include <math.h>

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

static void test_glb__holds_its_buffer_and_its_texture(void **state)
{
    (void)state;
    struct arena *arena = arena_create(0);
    put_glb(arena, "square.glb", 0);
    check_squares(imported(arena, "square.glb", NULL));
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
        cmocka_unit_test(test_degenerate_triangles__are_dropped),
    };
    return cmocka_run_group_tests(tests, enter_folder, leave_folder);
}
