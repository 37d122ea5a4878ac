/* fuzz/fuzz_jpeg.c - an input is a JPEG file as a slice. */
#include "support/capped.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    const snow_volume_options box = {
        .size = sizeof box, .channel = 1, .crop = {{1, 2}, {1, 0}, {0, 0}}};
    look_at("fuzz.jpg", bytes, size, NULL);
    look_at("fuzz.jpg", bytes, size, &box);
    return 0;
}
