/* fuzz/fuzz_vtk.c - an input is a legacy file of VTK. */
#include "support/capped.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    const snow_volume_options box = {.size = sizeof box,
                                     .channel = 1,
                                     .dataset = "v",
                                     .crop = {{1, 2}, {0, 0}, {1, 0}}};
    look_at("fuzz.vtk", bytes, size, NULL);
    look_at("fuzz.vtk", bytes, size, &box);
    return 0;
}
