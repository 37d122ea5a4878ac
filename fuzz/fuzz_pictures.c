/* fuzz/fuzz_pictures.c - an input is a picture: PFM, NPY, and EXR, TIFF, JPEG
 * and WebP where the build has them.  PNG has a target of its own. */
#include "support/picture.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    look_at_picture(bytes, size);
    return 0;
}
