/* modules/hdf5.c - libsnowglass-hdf5.so: HDF5 and NetCDF-4 by libhdf5. */
#include "base/module.h"
#include "formats/format.h"

extern SNOW_API const snow_module SNOW_MODULE_SYMBOL;

const snow_module SNOW_MODULE_SYMBOL = {.stamp = snow_module_stamp,
                                        .volume = &snow_format_hdf5};
