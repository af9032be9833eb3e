/* Mesh files through assimp's C interface: the only file that knows assimp. */
#include "base/color.h"
#include "base/file.h"
#include "wall/mesh_import_check.h"
#include "wall/mesh_import_parts.h"

#include <assimp/GltfMaterial.h>
#include <assimp/cimport.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

struct import {
    struct arena *arena;
    const char *path;
    const struct aiScene *scene;
    struct import_soup *soup;
    unsigned *uv_channels; /* of each material's colour texture */
    bool colors_encoded;   /* vertex colours are sRGB */
    struct error *error;
};

/* NaN becomes 0. */
static float clamp01(float x)
{
    return fminf(1, fmaxf(0, x));
}

static const struct import_texture *texture(struct import *import, const struct aiMaterial *from,
                                            enum aiTextureType type, unsigned *uv_channel)
{
    struct aiString path;
    unsigned channel = 0;
    if (aiGetMaterialTextureCount(from, type) == 0 ||
        aiGetMaterialTexture(from, type, 0, &path, NULL, &channel, NULL, NULL, NULL, NULL) !=
            aiReturn_SUCCESS)
        return NULL;
    struct import_texture *to = ARENA_NEW(import->arena, struct import_texture);
    if (uv_channel)
        *uv_channel = channel;
    unsigned index = 0;
    if (sscanf(path.data, "*%u", &index) != 1 || index >= import->scene->mNumTextures) {
        to->path = arena_strdup(import->arena, path.data);
        return to;
    }
    const struct aiTexture *embedded = import->scene->mTextures[index];
    to->bytes_size = embedded->mWidth;
    if (embedded->mHeight > 0) {
        to->width_px = (int)embedded->mWidth;
        to->height_px = (int)embedded->mHeight;
        to->bytes_size = (size_t)embedded->mWidth * embedded->mHeight * sizeof(struct aiTexel);
    } else {
        snprintf(to->format, sizeof to->format, "%.8s", embedded->achFormatHint);
    }
    void *bytes = arena_alloc(import->arena, to->bytes_size, 1);
    to->bytes = memcpy(bytes, embedded->pcData, to->bytes_size);
    return to;
}

static void read_material(struct import *import, unsigned i)
{
    const struct aiMaterial *from = import->scene->mMaterials[i];
    struct import_material *to = &import->soup->materials[i];
    struct aiString text;
    bool named = aiGetMaterialString(from, AI_MATKEY_NAME, &text) == aiReturn_SUCCESS;
    to->name = arena_strdup(import->arena, named ? text.data : "");
    struct aiColor4D color = {1, 1, 1, 1};
    if (aiGetMaterialColor(from, AI_MATKEY_BASE_COLOR, &color) != aiReturn_SUCCESS)
        aiGetMaterialColor(from, AI_MATKEY_COLOR_DIFFUSE, &color);
    to->albedo[0] = clamp01(color.r);
    to->albedo[1] = clamp01(color.g);
    to->albedo[2] = clamp01(color.b);
    to->color = texture(import, from, aiTextureType_BASE_COLOR, &import->uv_channels[i]);
    if (!to->color)
        to->color = texture(import, from, aiTextureType_DIFFUSE, &import->uv_channels[i]);
    to->opacity =
        texture(import, from, aiTextureType_OPACITY, to->color ? NULL : &import->uv_channels[i]);
    to->alpha_cutoff = 0.5f;
    if (aiGetMaterialString(from, AI_MATKEY_GLTF_ALPHAMODE, &text) == aiReturn_SUCCESS)
        to->alpha_ignored = strcmp(text.data, "OPAQUE") == 0;
    float cutoff;
    unsigned one = 1;
    if (aiGetMaterialFloatArray(from, AI_MATKEY_GLTF_ALPHACUTOFF, &cutoff, &one) ==
            aiReturn_SUCCESS &&
        cutoff > 0 && cutoff <= 1)
        to->alpha_cutoff = cutoff;
}

/* Totals over the node tree, an instanced mesh once for each use. */
static void count_node(const struct import *import, const struct aiNode *node, size_t *vertices,
                       size_t *triangles)
{
    for (unsigned i = 0; i < node->mNumMeshes; i++) {
        *vertices += import->scene->mMeshes[node->mMeshes[i]]->mNumVertices;
        *triangles += import->scene->mMeshes[node->mMeshes[i]]->mNumFaces;
    }
    for (unsigned i = 0; i < node->mNumChildren; i++)
        count_node(import, node->mChildren[i], vertices, triangles);
}

static void transform_point(const struct aiMatrix4x4 *m, const struct aiVector3D *p, float to[3])
{
    to[0] = m->a1 * p->x + m->a2 * p->y + m->a3 * p->z + m->a4;
    to[1] = m->b1 * p->x + m->b2 * p->y + m->b3 * p->z + m->b4;
    to[2] = m->c1 * p->x + m->c2 * p->y + m->c3 * p->z + m->c4;
}

/* By the cofactors, which is the inverse transpose times the determinant; its sign is put right. */
static void transform_normal(const struct aiMatrix4x4 *m, float sign, const struct aiVector3D *n,
                             float to[3])
{
    to[0] =
        sign * ((m->b2 * m->c3 - m->b3 * m->c2) * n->x + (m->b3 * m->c1 - m->b1 * m->c3) * n->y +
                (m->b1 * m->c2 - m->b2 * m->c1) * n->z);
    to[1] =
        sign * ((m->c2 * m->a3 - m->c3 * m->a2) * n->x + (m->c3 * m->a1 - m->c1 * m->a3) * n->y +
                (m->c1 * m->a2 - m->c2 * m->a1) * n->z);
    to[2] =
        sign * ((m->a2 * m->b3 - m->a3 * m->b2) * n->x + (m->a3 * m->b1 - m->a1 * m->b3) * n->y +
                (m->a1 * m->b2 - m->a2 * m->b1) * n->z);
    for (int k = 0; k < 3; k++)
        if (!isfinite(to[k]))
            to[0] = to[1] = to[2] = 0;
}

static float determinant(const struct aiMatrix4x4 *m)
{
    return m->a1 * (m->b2 * m->c3 - m->b3 * m->c2) - m->a2 * (m->b1 * m->c3 - m->b3 * m->c1) +
           m->a3 * (m->b1 * m->c2 - m->b2 * m->c1);
}

static enum status read_vertices(struct import *import, const struct aiMesh *mesh,
                                 const struct aiMatrix4x4 *matrix)
{
    struct import_soup *soup = import->soup;
    const struct aiVector3D *uvs = mesh->mTextureCoords[import->uv_channels[mesh->mMaterialIndex]];
    const struct aiColor4D *colors = mesh->mColors[0];
    float sign = determinant(matrix) < 0 ? -1.0f : 1.0f;
    for (unsigned i = 0; i < mesh->mNumVertices; i++) {
        size_t to = soup->vertices_count + i;
        float *p = soup->positions[to];
        transform_point(matrix, &mesh->mVertices[i], p);
        if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2]))
            return error_set(import->error, STATUS_INVALID,
                             "%s: vertex %u of mesh '%s': position (%g, %g, %g) is not finite",
                             import->path, i, mesh->mName.data, (double)p[0], (double)p[1],
                             (double)p[2]);
        if (mesh->mNormals)
            transform_normal(matrix, sign, &mesh->mNormals[i], soup->normals[to]);
        if (soup->uvs && uvs) {
            soup->uvs[to][0] = uvs[i].x, soup->uvs[to][1] = uvs[i].y;
            if (!isfinite(uvs[i].x) || !isfinite(uvs[i].y))
                return error_set(
                    import->error, STATUS_INVALID,
                    "%s: vertex %u of mesh '%s': texture coordinate (%g, %g) is not finite",
                    import->path, i, mesh->mName.data, (double)uvs[i].x, (double)uvs[i].y);
        }
        for (int k = 0; soup->colors && k < 3; k++) {
            float c = !colors ? 1
                              : clamp01(k == 0   ? colors[i].r
                                        : k == 1 ? colors[i].g
                                                 : colors[i].b);
            soup->colors[to][k] = colors && import->colors_encoded ? srgb_decode(c) : c;
        }
    }
    return STATUS_OK;
}

static enum status read_mesh(struct import *import, unsigned index,
                             const struct aiMatrix4x4 *matrix)
{
    struct import_soup *soup = import->soup;
    const struct aiMesh *mesh = import->scene->mMeshes[index];
    const struct import_material *material = &soup->materials[mesh->mMaterialIndex];
    if ((material->color || material->opacity) &&
        !mesh->mTextureCoords[import->uv_channels[mesh->mMaterialIndex]])
        return error_set(
            import->error, STATUS_INVALID,
            "%s: material '%s' has a texture, but mesh '%s' has no texture coordinates",
            import->path, material->name, mesh->mName.data);
    if (read_vertices(import, mesh, matrix) != STATUS_OK)
        return STATUS_INVALID;
    bool mirrored = determinant(matrix) < 0;
    for (unsigned i = 0; i < mesh->mNumFaces; i++) {
        const struct aiFace *face = &mesh->mFaces[i];
        if (face->mNumIndices != 3)
            continue;
        uint32_t *to = soup->triangles[soup->triangles_count];
        for (int k = 0; k < 3; k++) {
            unsigned vertex = face->mIndices[mirrored ? 2 - k : k];
            if (vertex >= mesh->mNumVertices)
                return error_set(import->error, STATUS_INVALID,
                                 "%s: face %u of mesh '%s': vertex %u is outside 0..%u",
                                 import->path, i, mesh->mName.data, vertex, mesh->mNumVertices - 1);
            to[k] = (uint32_t)(soup->vertices_count + vertex);
        }
        soup->triangle_material[soup->triangles_count++] = mesh->mMaterialIndex;
    }
    soup->vertices_count += mesh->mNumVertices;
    return STATUS_OK;
}

static enum status read_node(struct import *import, const struct aiNode *node,
                             const struct aiMatrix4x4 *parent)
{
    struct aiMatrix4x4 matrix = *parent;
    aiMultiplyMatrix4(&matrix, &node->mTransformation);
    for (unsigned i = 0; i < node->mNumMeshes; i++)
        if (read_mesh(import, node->mMeshes[i], &matrix) != STATUS_OK)
            return STATUS_INVALID;
    for (unsigned i = 0; i < node->mNumChildren; i++)
        if (read_node(import, node->mChildren[i], &matrix) != STATUS_OK)
            return STATUS_INVALID;
    return STATUS_OK;
}

/* A material that the file does not have (assimp makes up a grey one) must not darken vertex
 * colours. */
static void whiten_default(struct import *import)
{
    for (size_t i = 0; i < import->soup->materials_count; i++) {
        struct import_material *material = &import->soup->materials[i];
        if (strcmp(material->name, AI_DEFAULT_MATERIAL_NAME) == 0 || material->name[0] == '\0')
            material->albedo[0] = material->albedo[1] = material->albedo[2] = 1;
    }
}

static enum status read_scene(struct import *import, size_t triangles_limit)
{
    const struct aiScene *scene = import->scene;
    struct import_soup *soup = import->soup;
    size_t vertices = 0, triangles = 0;
    count_node(import, scene->mRootNode, &vertices, &triangles);
    if (triangles == 0)
        return error_set(import->error, STATUS_INVALID, "%s: holds no triangles", import->path);
    if (triangles > triangles_limit || vertices > UINT32_MAX)
        return error_set(import->error, STATUS_INVALID,
                         "%s: has %zu triangles; at most %zu are allowed", import->path, triangles,
                         triangles_limit);
    bool textured = false, colored = false;
    soup->materials_count = scene->mNumMaterials;
    soup->materials = ARENA_ARRAY(import->arena, struct import_material, soup->materials_count);
    import->uv_channels = ARENA_ARRAY(import->arena, unsigned, soup->materials_count);
    for (unsigned i = 0; i < scene->mNumMaterials; i++) {
        read_material(import, i);
        if (import->uv_channels[i] >= AI_MAX_NUMBER_OF_TEXTURECOORDS)
            import->uv_channels[i] = 0;
        textured |= soup->materials[i].color || soup->materials[i].opacity;
    }
    for (unsigned i = 0; i < scene->mNumMeshes; i++) {
        colored |= scene->mMeshes[i]->mColors[0] != NULL;
        if (scene->mMeshes[i]->mMaterialIndex >= scene->mNumMaterials)
            return error_set(import->error, STATUS_INVALID, "%s: mesh '%s' has no material",
                             import->path, scene->mMeshes[i]->mName.data);
    }
    if (colored)
        whiten_default(import);
    soup->positions = arena_alloc(import->arena, vertices, sizeof(float[3]));
    soup->normals = arena_alloc(import->arena, vertices, sizeof(float[3]));
    soup->uvs = textured ? arena_alloc(import->arena, vertices, sizeof(float[2])) : NULL;
    soup->colors = colored ? arena_alloc(import->arena, vertices, sizeof(float[3])) : NULL;
    soup->triangles = arena_alloc(import->arena, triangles, sizeof(uint32_t[3]));
    soup->triangle_material = ARENA_ARRAY(import->arena, uint32_t, triangles);
    struct aiMatrix4x4 identity;
    aiIdentityMatrix4(&identity);
    return read_node(import, scene->mRootNode, &identity);
}

/* What assimp says, where that helps; it looks for another reader when a file's head is damaged. */
static const char *reason(void)
{
    const char *said = aiGetErrorString();
    if (strstr(said, "No suitable reader"))
        return "is damaged at its head, or not what its ending says";
    if (strstr(said, "bad_alloc"))
        return "is damaged: asks for more memory than there is";
    return said;
}

enum status mesh_import_assimp(struct arena *arena, const char *path, size_t triangles_limit,
                               struct import_soup **soup, struct error *error)
{
    /* OBJ has colours only by a custom that stores encoded ones; glTF's are linear. */
    bool colors_encoded = path_ends_with(path, ".obj");
    if (path_ends_with(path, ".ply") && ply_check(path, &colors_encoded, error) != STATUS_OK)
        return STATUS_INVALID;
    if (path_ends_with(path, ".glb") && glb_check(path, error) != STATUS_OK)
        return STATUS_INVALID;
    if (path_ends_with(path, ".obj") && obj_check(path, error) != STATUS_OK)
        return STATUS_INVALID;
    struct aiPropertyStore *properties = aiCreatePropertyStore();
    aiSetImportPropertyInteger(properties, AI_CONFIG_PP_SBP_REMOVE,
                               aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    const struct aiScene *scene = aiImportFileExWithProperties(
        path, aiProcess_Triangulate | aiProcess_SortByPType, NULL, properties);
    aiReleasePropertyStore(properties);
    if (!scene)
        return error_set(error, STATUS_INVALID, "%s: %s", path, reason());
    struct import import = {.arena = arena, .path = path, .scene = scene, .error = error};
    import.soup = *soup = ARENA_NEW(arena, struct import_soup);
    import.colors_encoded = colors_encoded;
    enum status status = STATUS_OK;
    if (scene->mNumMeshes == 0 || !scene->mRootNode)
        status = error_set(error, STATUS_INVALID, "%s: holds no triangles", path);
    else
        status = read_scene(&import, triangles_limit);
    if (status == STATUS_OK && import.soup->triangles_count == 0)
        status = error_set(error, STATUS_INVALID, "%s: holds no triangles", path);
    aiReleaseImport(scene);
    return status;
}
