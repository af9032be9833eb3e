/* A picture in memory, and its raw file. */
#include "truth/frame.h"

#include "base/file.h"
#include "base/hash.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

enum {
    MAGIC_BYTES = sizeof FRAME_FILE_MAGIC - 1,
    HEADER_BYTES = MAGIC_BYTES + 3 * 4,
    HASH_BYTES = 8,
    FLAG_VARIANCE = 1
};

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the file is little endian, as written");

static size_t plane_bytes(int width_px, int height_px)
{
    return (size_t)width_px * (size_t)height_px * 4 * sizeof(float);
}

static int clamp_side(int side_px, int limit_px)
{
    return side_px < 1 ? 1 : side_px > limit_px ? limit_px : side_px;
}

struct frame *frame_create(struct arena *arena, int width_px, int height_px, bool with_variance)
{
    struct frame *frame = ARENA_NEW(arena, struct frame);
    frame->width_px = clamp_side(width_px, FRAME_SIDE_MAX_PX);
    int rows_max = FRAME_PIXELS_MAX / frame->width_px;
    frame->height_px =
        clamp_side(height_px, rows_max < FRAME_SIDE_MAX_PX ? rows_max : FRAME_SIDE_MAX_PX);
    size_t count = plane_bytes(frame->width_px, frame->height_px) / sizeof(float);
    frame->rgba = ARENA_ARRAY(arena, float, count);
    if (with_variance)
        frame->variance = ARENA_ARRAY(arena, float, count);
    return frame;
}

void *frame_pack(struct arena *arena, const struct frame *frame, size_t *size)
{
    size_t plane = plane_bytes(frame->width_px, frame->height_px);
    int32_t header[3] = {frame->width_px, frame->height_px, frame->variance ? FLAG_VARIANCE : 0};
    *size = HEADER_BYTES + plane * (frame->variance ? 2 : 1) + HASH_BYTES;
    unsigned char *data = arena_alloc(arena, *size, 1);
    memcpy(data, FRAME_FILE_MAGIC, MAGIC_BYTES);
    memcpy(data + MAGIC_BYTES, header, sizeof header);
    memcpy(data + HEADER_BYTES, frame->rgba, plane);
    if (frame->variance)
        memcpy(data + HEADER_BYTES + plane, frame->variance, plane);
    uint64_t hash = hash_bytes(0, data, *size - HASH_BYTES);
    memcpy(data + *size - HASH_BYTES, &hash, HASH_BYTES);
    return data;
}

/* Magic, size and length; width, height and flags into header. */
static enum status check_header(const unsigned char *data, size_t size, const char *name,
                                int32_t header[3], struct error *error)
{
    if (size < HEADER_BYTES + HASH_BYTES)
        return error_set(error, STATUS_INVALID, "%s: %zu bytes are too few for a frame file", name,
                         size);
    if (memcmp(data, FRAME_FILE_MAGIC, MAGIC_BYTES) != 0)
        return error_set(error, STATUS_INVALID, "%s: not a frame file (no %s at its start)", name,
                         FRAME_FILE_MAGIC);
    memcpy(header, data + MAGIC_BYTES, 3 * sizeof *header);
    if (header[0] < 1 || header[1] < 1 || header[0] > FRAME_SIDE_MAX_PX ||
        header[1] > FRAME_SIDE_MAX_PX || header[0] > FRAME_PIXELS_MAX / header[1])
        return error_set(error, STATUS_INVALID,
                         "%s: size %d x %d is outside 1..%d px a side, %d px in all", name,
                         header[0], header[1], FRAME_SIDE_MAX_PX, FRAME_PIXELS_MAX);
    if (header[2] & ~FLAG_VARIANCE)
        return error_set(error, STATUS_INVALID, "%s: flags %d are not 0 or %d", name, header[2],
                         FLAG_VARIANCE);
    size_t planes = header[2] & FLAG_VARIANCE ? 2 : 1;
    size_t expected = HEADER_BYTES + planes * plane_bytes(header[0], header[1]) + HASH_BYTES;
    if (size != expected)
        return error_set(error, STATUS_INVALID,
                         "%s: %zu bytes; a frame of %d x %d has %zu (cut off, or padded)", name,
                         size, header[0], header[1], expected);
    return STATUS_OK;
}

enum status frame_unpack(struct arena *arena, const void *data, size_t size, const char *name,
                         struct frame **frame, struct error *error)
{
    const unsigned char *bytes = data;
    int32_t header[3];
    enum status status = check_header(bytes, size, name, header, error);
    if (status)
        return status;
    uint64_t stored;
    memcpy(&stored, bytes + size - HASH_BYTES, HASH_BYTES);
    if (stored != hash_bytes(0, bytes, size - HASH_BYTES))
        return error_set(error, STATUS_INVALID,
                         "%s: its bytes are not those it was written with "
                         "(the hash differs)",
                         name);
    *frame = frame_create(arena, header[0], header[1], header[2] & FLAG_VARIANCE);
    size_t plane = plane_bytes(header[0], header[1]);
    memcpy((*frame)->rgba, bytes + HEADER_BYTES, plane);
    if ((*frame)->variance)
        memcpy((*frame)->variance, bytes + HEADER_BYTES + plane, plane);
    return STATUS_OK;
}

enum status frame_save(const struct frame *frame, const char *path, struct error *error)
{
    struct arena *scratch = arena_create(0);
    size_t size;
    void *data = frame_pack(scratch, frame, &size);
    enum status status = file_write(path, data, size, error);
    arena_destroy(scratch);
    return status;
}

enum status frame_load(struct arena *arena, const char *path, struct frame **frame,
                       struct error *error)
{
    struct arena *scratch = arena_create(0);
    size_t limit = HEADER_BYTES + 2 * (size_t)FRAME_PIXELS_MAX * 4 * sizeof(float) + HASH_BYTES;
    size_t size;
    char *data;
    enum status status = file_read(scratch, path, limit, &data, &size, error);
    if (status == STATUS_OK)
        status = frame_unpack(arena, data, size, path, frame, error);
    arena_destroy(scratch);
    return status;
}

uint64_t frame_hash(const struct frame *frame)
{
    uint64_t hash = hash_u64(hash_u64(0, (uint64_t)frame->width_px), (uint64_t)frame->height_px);
    return hash_bytes(hash, frame->rgba, plane_bytes(frame->width_px, frame->height_px));
}

static enum status bad_value(const struct frame *frame, size_t index, const char *what,
                             const char *allowed, const float *values, struct error *error)
{
    size_t pixel = index / 4;
    return error_set(error, STATUS_BAD_PICTURE, "pixel x %zu, y %zu: %s%s is %g, not %s",
                     pixel % (size_t)frame->width_px, pixel / (size_t)frame->width_px, what,
                     (const char *const[]){"red", "green", "blue", "alpha"}[index % 4],
                     (double)values[index], allowed);
}

enum status frame_check(const struct frame *frame, struct error *error)
{
    size_t count = plane_bytes(frame->width_px, frame->height_px) / sizeof(float);
    for (size_t i = 0; i < count; i++) {
        float value = frame->rgba[i];
        if (!isfinite(value))
            return bad_value(frame, i, "", "finite", frame->rgba, error);
        if (i % 4 == 3 && (value < -FRAME_ALPHA_TOLERANCE || value > 1 + FRAME_ALPHA_TOLERANCE))
            return bad_value(frame, i, "", "in 0..1", frame->rgba, error);
        if (frame->variance && !(isfinite(frame->variance[i]) && frame->variance[i] >= 0))
            return bad_value(frame, i, "variance of ", "finite and >= 0", frame->variance, error);
    }
    return STATUS_OK;
}
