/* volume/records.c - the initialisers of the records in snowglass/volume.h. */
#include "base/base.h"

SNOW_RECORD_OF_ZEROS(snow_volume_info);
SNOW_RECORD_OF_ZEROS(snow_volume_options);
SNOW_RECORD_OF_ZEROS(snow_extent);
SNOW_RECORD_OF_ZEROS(snow_volume_statistics);
