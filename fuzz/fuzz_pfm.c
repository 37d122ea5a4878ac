/* fuzz/fuzz_pfm.c - an input is a PFM file. */
#include "picture.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    look_at_picture(bytes, size);
    return 0;
}
