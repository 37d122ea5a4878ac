/* fuzz/fuzz_vasp.c - an input is a grid of VASP. */
#include "support/capped.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    const snow_volume_options box = {
        .size = sizeof box, .channel = 1, .crop = {{1, 2}, {0, 0}, {1, 0}}};
    look_at("CHGCAR", bytes, size, NULL);
    look_at("CHGCAR", bytes, size, &box);
    return 0;
}
