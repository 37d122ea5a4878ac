/* fuzz/fuzz_png.c - an input is a PNG file.  It is looked at as it is, and
 * again with the right CRC in every chunk: changed bytes would hardly ever get
 * past the check sums otherwise. */
#include "support/chunks.h"
#include "support/picture.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    look_at_picture(bytes, size);
    uint8_t *copy = sealed_copy(bytes, size);
    if (!copy)
        return 0;
    look_at_picture(copy, size);
    free(copy);
    return 0;
}
