/* A picture of a scene whose trees are triangles, seen and perhaps in the sun's shadows: what
 * polygons and shadow-map share. */
#ifndef TREELINE_BAKE_TRIANGLES_PICTURE_H
#define TREELINE_BAKE_TRIANGLES_PICTURE_H

#include "bake/shadow_choice.h"

struct triangles_picture_request {
    int samples;                 /* a pixel: 1, 4 or 16 */
    float error_px;              /* of triangles_tolerance_px */
    bool smooth, contrast, sift; /* of triangles_request */
    const struct sun_shadows_request
        *shadows; /* NULL: none; heeded where the workspace wants them */
};

struct triangles_picture;

/* A method's prepare, *picture its state. Errors: those of the rooms that it opens. */
enum status triangles_picture_prepare(struct workspace *workspace, const struct scene *scene,
                                      const struct triangles_picture_request *request,
                                      void **picture);
/* A method's draw. */
enum status triangles_picture_draw(struct workspace *workspace, void *picture,
                                   const struct view *view, struct target *target);

#endif
