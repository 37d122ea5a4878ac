/* fuzz/fuzz_hdf5.c - an input is an HDF5 file. */
#include "support/capped.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    const snow_volume_options box = {.size = sizeof box,
                                     .time = 1,
                                     .dataset = "v",
                                     .crop = {{1, 2}, {0, 0}, {1, 0}}};
    look_at("fuzz.h5", bytes, size, NULL);
    look_at("fuzz.h5", bytes, size, &box);
    return 0;
}
