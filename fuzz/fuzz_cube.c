/* fuzz/fuzz_cube.c - an input is a volume of Gaussian. */
#include "support/capped.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    const snow_volume_options box = {
        .size = sizeof box, .channel = 1, .crop = {{1, 2}, {0, 0}, {1, 0}}};
    look_at("fuzz.cube", bytes, size, NULL);
    look_at("fuzz.cube", bytes, size, &box);
    return 0;
}
