/* fuzz/fuzz_png_slice.c - an input is a PNG file as a slice.  It is looked at
 * as it is, and again with the right CRC in every chunk: changed bytes would
 * hardly ever get past the check sums otherwise. */
#include "capped.h"

#include <string.h>
#include <zlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

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

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    const snow_volume_options box = {.channel = 1,
                                     .crop = {{1, 2}, {1, 0}, {0, 0}}};
    look_at("fuzz.png", bytes, size, NULL);
    uint8_t *copy = malloc(size + 1);
    if (!copy)
        return 0;
    if (size)
        memcpy(copy, bytes, size);
    seal_chunks(copy, size);
    look_at("fuzz.png", copy, size, NULL);
    look_at("fuzz.png", copy, size, &box);
    free(copy);
    return 0;
}
