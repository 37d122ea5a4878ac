/* modules/blosc.c - libsnowglass-blosc.so: chunks of Zarr by libblosc. */
#include "base/module.h"
#include "formats/zarr/zarr.h"

extern SNOW_API const snow_module SNOW_MODULE_SYMBOL;

const snow_module SNOW_MODULE_SYMBOL = {.stamp = snow_module_stamp,
                                        .expect_blosc = snow_zarr_blosc_expect,
                                        .unpack_blosc = snow_zarr_blosc_unpack};
