/* Inside the report: one picture or error map, small on the page and in full size beside it. */
#ifndef TREELINE_REPORT_PICTURE_H
#define TREELINE_REPORT_PICTURE_H

#include "report/book.h"
#include "truth/frame.h"
#include "wall/image.h"

/* DRAWN: linear RGB. FLIP: one channel in [0, 1]. COVERAGE: one channel in [-1, 1], the method's
 * coverage less the reference's. */
enum picture_kind { PICTURE_DRAWN, PICTURE_FLIP, PICTURE_COVERAGE };

struct picture {
    struct gallery *gallery;
    struct arena *scratch;
    enum picture_kind kind;
    const char *name; /* file name without folder and ending */
    const char *alt;
    const char *attributes; /* of the img, by which the page's script finds it */
};

struct image *picture_create(struct arena *arena, int width_px, int height_px, int channels);
/* Without the coverage, which is no opacity. */
struct image *picture_of_frame(struct arena *arena, const struct frame *frame);
/* OUT/pictures/NAME.png, and the thumbnail that links to it. */
void picture_put(const struct picture *picture, struct image *image, FILE *out);
void picture_base64(const uint8_t *bytes, size_t size, FILE *out);
/* Says on the page why there is none. */
void picture_missing(struct gallery *gallery, const char *why, FILE *out);

#endif
