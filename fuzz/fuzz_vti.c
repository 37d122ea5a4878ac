/* fuzz/fuzz_vti.c - an input is a VTI file. */
#include "support/capped.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    const snow_volume_options box = {.size = sizeof box,
                                     .channel = 1,
                                     .dataset = "v",
                                     .crop = {{1, 2}, {0, 0}, {1, 0}}};
    look_at("fuzz.vti", bytes, size, NULL);
    look_at("fuzz.vti", bytes, size, &box);
    return 0;
}
