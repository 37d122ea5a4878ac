/* fuzz/fuzz_nifti.c - an input is a NIfTI file of one piece; pairs end where
 * the other file would be opened. */
#include "support/capped.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    const snow_volume_options second = {.size = sizeof second, .time = 1};
    look_at("fuzz.nii", bytes, size, NULL);
    look_at("fuzz.nii", bytes, size, &second);
    return 0;
}
