/* fuzz/fuzz_raw.c - an input is a file name, which may tell sizes and type, a
 * line end, and the file's bytes. */
#include "support/capped.h"

#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    char name[256] = "";
    size_t length = 0;
    while (length < size && bytes[length] != '\n' && length < sizeof name - 1)
        length++;
    if (length)
        memcpy(name, bytes, length);
    if (length < size)
        length++;
    const snow_volume_options given = {
        .size = sizeof given,
        .dims = {4, 3, 2},
        .type = SNOW_TYPE_UINT16,
        .endian = SNOW_ENDIAN_BIG,
        .spacing = {1, 2, 0.5},
        .offset = 1,
    };
    look_at(name, bytes + length, size - length, NULL);
    look_at(name, bytes + length, size - length, &given);
    return 0;
}
