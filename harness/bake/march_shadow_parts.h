/* The steps of the march's sun shadows: volumes of plants, the map of the forest, the terrain. */
#ifndef TREELINE_BAKE_MARCH_SHADOW_PARTS_H
#define TREELINE_BAKE_MARCH_SHADOW_PARTS_H

#include "bake/march_shadow.h"

/* The array, or a larger one; a larger one's contents are not kept. */
static inline void *shadow_room(struct arena *arena, void *array, size_t count, size_t *capacity,
                                size_t size)
{
    if (count <= *capacity)
        return array;
    *capacity = count + count / 4;
    return arena_alloc(arena, *capacity, size);
}

/* Axes of the light: right and up across it, down along it, away from the sun. Unit. */
struct shadow_axes {
    float axes[3][3];
};
struct shadow_axes shadow_axes_of(const float toward_sun[3]);

/* A plant of scale 1 seen from the sun: per pixel of this plate the mean over its area. */
struct shadow_plate {
    float cover;           /* share of the light that the plant takes */
    float first_m, last_m; /* times cover: the depths between which it does */
};
enum { SHADOW_PLATES_MAX = 10 };

/* Lengths in the plant's axes at scale 1, turned to the light. */
struct shadow_volume {
    /* A place in the plant's axes and height times frame is one along the light; that times back is
     * the place. They differ where the tree is stretched. */
    struct shadow_axes frame, back;
    float low_m[3], cell_m; /* lowest corner along the frame's axes; a cell's side */
    int32_t size[3];        /* columns right and up, layers down */
    /* up, right, down (fastest): the share of the light that reaches the upper side of each layer
     * in the middle of its column, 0..255; room for four more. */
    uint8_t *passes;
    size_t capacity; /* of passes */
    /* Each half as fine; rows up of columns right. */
    int plates_count;
    int32_t plates_size[SHADOW_PLATES_MAX][2];
    struct shadow_plate *plates[SHADOW_PLATES_MAX];
    size_t plates_capacity;
};
/* frame: in the plant's axes. The arrays grow by the arena, which serves one thread at a time. */
void shadow_volume_size(struct arena *arena, const struct voxels *voxels,
                        const struct shadow_axes *frame, float stretch, float cell_m,
                        struct shadow_volume *volume);
void shadow_volume_sweep(const struct voxels *voxels, enum march_model model,
                         struct shadow_volume *volume);
/* Room for plates of the volume's size; the coarser ones from the finest. */
void shadow_volume_lay_plates(struct arena *arena, struct shadow_volume *volume);
void shadow_volume_halve_plates(const struct shadow_volume *volume);
/* At a place across the light, m, averaged over about width_m; nothing outside. */
struct shadow_plate shadow_volume_plate(const struct shadow_volume *volume, const float across_m[2],
                                        float width_m);

/* A tree as the map wants it: its place along the light's axes. */
struct shadow_caster {
    float place_m[3], scale;
    const struct shadow_volume *volume;
};

/* Between two depths, evenly, some optical depth; packed. */
struct shadow_box {
    uint16_t first; /* in units of the map's depth_m */
    uint8_t length; /* the same */
    uint8_t depth;  /* optical, 1 / 32; 0: none from here on */
};
enum { SHADOW_BOXES = 4 };
struct shadow_texel {
    struct shadow_box boxes[SHADOW_BOXES];
};

struct shadow_map {
    float low_m[3], texel_m, depth_m; /* along the light's axes */
    int32_t size[2];
    struct shadow_texel *texels; /* rows up of columns right */
    size_t capacity;
};
/* casters: sorted by depth. texel_m: at least so large. */
void shadow_map_fill(struct arena *arena, struct shadow_map *map,
                     const struct shadow_caster *casters, size_t count, size_t texels_max,
                     float texel_m, int threads);
/* Share of the light that reaches a place along the light's axes, m. */
float shadow_map_at(const struct shadow_map *map, const float place_m[3]);

/* At each of the terrain's samples the height up to which the terrain takes the sun. */
void shadow_terrain_sweep(const struct terrain *terrain, const float toward_sun[3],
                          float *heights_m);
/* 1 where the sun reaches a place over the terrain. */
float shadow_terrain_at(const struct terrain *terrain, const float *heights_m,
                        const float place_m[3]);

/* What a march elsewhere takes along. A kind: a species as it is turned by a step. */
size_t march_shadows_kinds(const struct march_shadows *shadows);
uint32_t march_shadows_kind(const struct march_shadows *shadows, const struct march_tree *tree);
/* NULL: no tree is of the kind. */
const struct shadow_volume *march_shadows_volume(const struct march_shadows *shadows, size_t kind);
/* From voxels of a level of the kind's species to the cells of its volume. */
void march_shadows_to_cells(const struct march_shadows *shadows, size_t kind, uint32_t level,
                            float to_cells[3][4]);
/* A tree's side x side shares 0..255 over its volume, one tree behind the other. */
const uint8_t *march_shadows_gains(const struct march_shadows *shadows, int *side);
struct shadow_light;
const struct shadow_light *march_shadows_sun(const struct march_shadows *shadows);
struct shadow_ground;
const struct shadow_ground *march_shadows_ground(const struct march_shadows *shadows);
/* What is all bark takes its light so many cells nearer the sun. */
static const float march_shadows_bark_cells = 2;

#endif
