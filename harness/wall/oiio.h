/* Between image.c and its C++ shim treeline_image.so: one table of calls, found by dlsym. */
#ifndef TREELINE_WALL_OIIO_H
#define TREELINE_WALL_OIIO_H

#include <stddef.h>
#include <stdint.h>

#define OIIO_ABI 2
#define OIIO_NAME_BYTES 64
#define OIIO_CALLS_SYMBOL "treeline_image_calls"

struct oiio_picture {
    int width_px, height_px, channels_count;
    float *values;                  /* height x width x channels, integers scaled to [0, 1] */
    char (*names)[OIIO_NAME_BYTES]; /* one a channel */
    int alpha;                      /* index of the alpha channel, or -1 */
    int srgb;                       /* read: the values are sRGB-encoded; write: say so */
    double unit; /* read: the number in the file that 1 stands for; 0 of unsigned integers */
};

/* Where memory and messages go. Calls return 0, or 1 with one line in message. */
struct oiio_context {
    void *(*allocate)(void *user, size_t bytes);
    void *user;
    char *message;
    size_t message_bytes;
};

struct oiio_calls {
    int abi;
    /* Pictures of more than values_max values, or more than channels_max channels, are refused. */
    int (*read)(const struct oiio_context *context, const char *path, uint64_t values_max,
                int channels_max, struct oiio_picture *picture);
    /* Encodes into memory. ending: "exr" or "png"; bits: 8 or 16 (png), 16 or 32 (exr). */
    int (*write)(const struct oiio_context *context, const char *ending,
                 const struct oiio_picture *picture, int bits, uint8_t **bytes, size_t *size);
};

#endif
