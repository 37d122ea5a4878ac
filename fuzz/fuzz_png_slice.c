/* fuzz/fuzz_png_slice.c - an input is a PNG file as a slice.  It is looked at
 * as it is, and again with the right CRC in every chunk: changed bytes would
 * hardly ever get past the check sums otherwise. */
#include "support/capped.h"
#include "support/chunks.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    const snow_volume_options box = {
        .size = sizeof box, .channel = 1, .crop = {{1, 2}, {1, 0}, {0, 0}}};
    look_at("fuzz.png", bytes, size, NULL);
    uint8_t *copy = sealed_copy(bytes, size);
    if (!copy)
        return 0;
    look_at("fuzz.png", copy, size, NULL);
    look_at("fuzz.png", copy, size, &box);
    free(copy);
    return 0;
}
