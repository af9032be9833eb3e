/* ray-texels: rays marched through the plants' voxels on the CPU, front to back, in packets. */
#include "bake/march.h"

struct options {
    int resolution, model, tile, cells, isa, shadows;
    float stop, step, bias, smooth, slab, far;
};

/* clang-format off */
static const struct option table[] = {
    OPTION(struct options, resolution, 128, 1, 512, "", "voxels along a plant's longest extent"),
    OPTION_WORD(struct options, model, 0, "sggx|isotropic|noma|visible",
                "how leaves hide: by second moments in every direction; by a scalar density "
                "(Kajiya-Kay), lit alike on all sides; by Noma's opacities along three axes; by the "
                "mean of their normals, which lights them too"),
    OPTION(struct options, stop, 0.02, 0, 0.5, "", "a ray ends when it lets through no more"),
    OPTION(struct options, step, 1, 0.125, 4, "voxels",
           "along a ray, where voxels are not empty; the first step into them is one voxel at most"),
    OPTION(struct options, bias, 0, -4, 4, "", "added to the level of detail that a pixel asks for"),
    OPTION(struct options, smooth, 0, 0, 1, "levels",
           "over which a level of detail turns into the next, both being drawn, and voxels into far "
           "pictures and these into cells; 0: at once"),
    OPTION(struct options, slab, 0, 0, 16, "voxels",
           "where crowns interlock they are drawn together, in slabs so deep: when thin, Chiba's sum "
           "of densities; 0: each tree whole, the nearer first"),
    OPTION(struct options, far, 4, 0, 8, "px",
           "trees of so large a radius are drawn from small pictures of the plants from far away, "
           "larger ones marched; not with slabs"),
    OPTION(struct options, shadows, 64, 0, 512, "",
           "cells of the sun's shadows along a plant's longest extent; 0: the sun casts none"),
    OPTION(struct options, tile, 48, 8, 64, "px", "side of the tiles that trees are binned to"),
    OPTION_WORD(struct options, cells, 0, "auto|off",
                "trees are culled by cells of many, and drawn so where they are below a pixel; off: "
                "each by itself"),
    OPTION_WORD(struct options, isa, 0, "auto|plain|avx2|avx512",
                "the processor's vectors; another set than it has is drawn with plain C"),
    OPTION_END,
};
/* clang-format on */

static unsigned effects(const void *values)
{
    const struct options *options = values;
    return EFFECTS_ALL & ~(unsigned)(options->shadows ? 0 : EFFECT_SUN_SHADOWS);
}

static enum status prepare(struct workspace *workspace, const struct scene *scene,
                           const void *values, void **state)
{
    static const char *const isas[] = {NULL, "plain", "avx2", "avx512"};
    const struct options *options = values;
    /* the level of detail is the volumes' resolution */
    int divisor = workspace->lod == LOD_LOW ? 4 : workspace->lod == LOD_INTERMEDIATE ? 2 : 1;
    struct march_options march = {
        .resolution = (options->resolution + divisor - 1) / divisor,
        .model = (enum march_model)options->model,
        .stop = options->stop,
        .step = options->step,
        .bias = options->bias,
        .smooth = options->smooth,
        .slab = options->slab,
        .tile_px = options->tile,
        .far_px = options->far,
        .cells = options->cells == 0,
        .shadow_resolution = options->shadows,
        .isa = isas[options->isa],
    };
    return march_prepare(workspace, scene, &march, (struct march **)state);
}

static enum status draw(struct workspace *workspace, void *state, const struct view *view,
                        struct target *target)
{
    return march_draw(workspace, state, view, target);
}

extern const struct method ray_texels_method;
const struct method ray_texels_method = {
    .abi = METHOD_ABI,
    .name = "ray-texels",
    .summary = "rays marched through voxels of the plants, on the CPU",
    .source = "Kajiya and Kay 1989, doi:10.1145/74334.74361; Neyret 1998, doi:10.1109/2945.675652; "
              "Noma 1995; Chiba et al. 1997; "
              "Heitz et al. 2015, doi:10.1145/2766988; Senegas 2001",
    .traits = TRAIT_CPU | EFFECT_TWO_SIDED | EFFECT_AMBIENT | EFFECT_SUN_SHADOWS | EFFECT_FOG,
    .options = table,
    .options_size = sizeof(struct options),
    .effects = effects,
    .prepare = prepare,
    .draw = draw,
};
