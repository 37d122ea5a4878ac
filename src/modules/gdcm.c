/* modules/gdcm.c - libsnowglass-gdcm.so: packed frames of DICOM by GDCM. */
#include "base/module.h"
#include "formats/dicom/gdcm_bridge.h"

extern SNOW_API const snow_module SNOW_MODULE_SYMBOL;

const snow_module SNOW_MODULE_SYMBOL = {.stamp = snow_module_stamp,
                                        .unpack = snow_gdcm_unpack};
