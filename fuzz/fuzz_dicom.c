/* fuzz/fuzz_dicom.c - an input is a DICOM file.
 *
 * GDCM, whose codecs unpack pixels, leaks memory and ends the process at some
 * damaged pixels, as docs/formats.md tells.  Our own parser alone is looked at
 * in a build with -DSNOW_GDCM=OFF; with it, -detect_leaks=0 leads further. */
#include "support/capped.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    const snow_volume_options box = {.size = sizeof box,
                                     .time = 1,
                                     .channel = 1,
                                     .series = "0",
                                     .crop = {{1, 2}, {0, 0}, {1, 0}}};
    look_at("fuzz.dcm", bytes, size, NULL);
    look_at("fuzz.dcm", bytes, size, &box);
    return 0;
}
