/* modules/tiff.c - libsnowglass-tiff.so: TIFF files by libtiff. */
#include "base/module.h"
#include "formats/format.h"
#include "image/image.h"

extern SNOW_API const snow_module SNOW_MODULE_SYMBOL;

const snow_module SNOW_MODULE_SYMBOL = {.stamp = snow_module_stamp,
                                        .volume = &snow_format_tiff,
                                        .picture = &snow_image_tiff};
