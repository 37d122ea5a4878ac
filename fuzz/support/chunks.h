/* fuzz/support/chunks.h - check sums of PNG that are right whatever was
 * changed. */
#ifndef SNOW_FUZZ_CHUNKS_H
#define SNOW_FUZZ_CHUNKS_H

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

/* Writes the CRC of every chunk that is whole. */
static void seal_chunks(uint8_t *bytes, size_t size) {
    size_t at = 8; /* behind the signature */
    while (size >= 12 && at <= size - 12) {
        size_t length = (size_t)bytes[at] << 24 | (size_t)bytes[at + 1] << 16 |
                        (size_t)bytes[at + 2] << 8 | bytes[at + 3];
        if (length > size - 12 - at)
            return;
        uLong crc = crc32(0, bytes + at + 4, (uInt)(length + 4));
        for (int i = 0; i < 4; i++)
            bytes[at + 8 + length + (size_t)i] =
                (uint8_t)(crc >> (24 - 8 * i) & 255);
        at += 12 + length;
    }
}

/* A copy of the bytes with the right CRC in every chunk, to be freed; NULL
 * without memory. */
static uint8_t *sealed_copy(const uint8_t *bytes, size_t size) {
    uint8_t *copy = malloc(size + 1);
    if (!copy)
        return NULL;
    if (size)
        memcpy(copy, bytes, size);
    seal_chunks(copy, size);
    return copy;
}

#endif
