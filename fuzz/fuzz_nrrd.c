/* fuzz/fuzz_nrrd.c - an input is an NRRD file with its data attached. */
#include "support/capped.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    const snow_volume_options second = {.size = sizeof second, .time = 1};
    look_at("fuzz.nrrd", bytes, size, NULL);
    look_at("fuzz.nrrd", bytes, size, &second);
    return 0;
}
