/* Plants as high as a forest's trees are stretched, for pictures of them. */
#ifndef TREELINE_BAKE_IMPOSTOR_TALL_H
#define TREELINE_BAKE_IMPOSTOR_TALL_H

#include "method/method.h"

/* The scene itself where no tree is stretched. Else one with the same trees, whose species are
 * stretched by steps of a quarter of an octave, the steps that its trees need, and whose trees are
 * stretched by what is left: at most an eighth. Normals are turned with the plant, so that light
 * that is kept with the pictures is right but for what is left. Its hash is the scene's. */
enum status impostor_tall(struct workspace *workspace, const struct scene *scene,
                          const struct scene **tall);

#endif
