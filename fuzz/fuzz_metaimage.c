/* fuzz/fuzz_metaimage.c - an input is a MetaImage with its voxels behind the
 * header; other files are refused where they would be opened. */
#include "support/capped.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    const snow_volume_options second = {.size = sizeof second, .time = 1};
    look_at("fuzz.mha", bytes, size, NULL);
    look_at("fuzz.mha", bytes, size, &second);
    return 0;
}
