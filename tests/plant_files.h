/* Writes the files that the import test reads: texts, PNG pictures, base64. */
#ifndef TREELINE_TESTS_PLANT_FILES_H
#define TREELINE_TESTS_PLANT_FILES_H

#include "base/file.h"

#include <string.h>

static inline void put(const char *path, const void *bytes, size_t size)
{
    struct error error = {0};
    if (file_write(path, bytes, size, &error) != STATUS_OK)
        fail_msg("%s", error.text);
}

static inline void put_text(const char *path, const char *text)
{
    put(path, text, strlen(text));
}

struct bytes {
    unsigned char at[65536];
    size_t size;
};

static inline void add(struct bytes *bytes, const void *from, size_t size)
{
    assert_true(bytes->size + size <= sizeof bytes->at);
    memcpy(bytes->at + bytes->size, from, size);
    bytes->size += size;
}

static inline void add_u32_big(struct bytes *bytes, uint32_t x)
{
    unsigned char b[4] = {(unsigned char)(x >> 24), (unsigned char)(x >> 16),
                          (unsigned char)(x >> 8), (unsigned char)x};
    add(bytes, b, 4);
}

static inline uint32_t crc32_of(const unsigned char *bytes, size_t size)
{
    uint32_t crc = 0xffffffff;
    for (size_t i = 0; i < size; i++) {
        crc ^= bytes[i];
        for (int k = 0; k < 8; k++)
            crc = crc & 1 ? crc >> 1 ^ 0xedb88320 : crc >> 1;
    }
    return ~crc;
}

static inline void add_chunk(struct bytes *png, const char *type, const void *data, size_t size)
{
    add_u32_big(png, (uint32_t)size);
    size_t start = png->size;
    add(png, type, 4);
    add(png, data, size);
    add_u32_big(png, crc32_of(png->at + start, size + 4));
}

/* A PNG of 8-bit RGBA texels, row 0 on top: one stored (uncompressed) deflate block. */
static inline struct bytes *png_of(const unsigned char *rgba, uint32_t width, uint32_t height)
{
    static struct bytes png, raw, header, stream;
    png.size = raw.size = header.size = stream.size = 0;
    add(&png, "\x89PNG\r\n\x1a\n", 8);
    add_u32_big(&header, width);
    add_u32_big(&header, height);
    add(&header, "\x08\x06\0\0\0", 5);
    for (uint32_t y = 0; y < height; y++) {
        add(&raw, "", 1);
        add(&raw, rgba + (size_t)4 * width * y, (size_t)4 * width);
    }
    uint32_t a = 1, b = 0;
    for (size_t i = 0; i < raw.size; i++) {
        a = (a + raw.at[i]) % 65521;
        b = (b + a) % 65521;
    }
    unsigned char block[7] = {0x78,
                              0x01,
                              0x01,
                              (unsigned char)raw.size,
                              (unsigned char)(raw.size >> 8),
                              (unsigned char)~raw.size,
                              (unsigned char)(~raw.size >> 8)};
    add(&stream, block, 7);
    add(&stream, raw.at, raw.size);
    add_u32_big(&stream, b << 16 | a);
    add_chunk(&png, "IHDR", header.at, header.size);
    add_chunk(&png, "IDAT", stream.at, stream.size);
    add_chunk(&png, "IEND", "", 0);
    return &png;
}

/* 2 x 2 texels: on top a green and a red one, below a grey one and a hole. */
static const unsigned char leaf_texels[16] = {0,   255, 0,   255, 255, 0, 0, 255,
                                              188, 188, 188, 255, 0,   0, 0, 0};

static inline struct bytes *leaf_png(void)
{
    return png_of(leaf_texels, 2, 2);
}

static inline const char *base64(const struct bytes *bytes)
{
    static char text[90000];
    const char *letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    size_t n = 0;
    for (size_t i = 0; i < bytes->size; i += 3) {
        uint32_t v = 0;
        for (size_t k = 0; k < 3; k++)
            v = v << 8 | (i + k < bytes->size ? bytes->at[i + k] : 0);
        for (size_t k = 0; k < 4; k++)
            text[n++] = i + k > bytes->size ? '=' : letters[v >> (18 - 6 * k) & 63];
    }
    text[n] = '\0';
    return text;
}

#endif
