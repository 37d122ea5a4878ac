/* volume/field.c - see field.h. */
#include "volume/field.h"

#include <string.h>

bool snow_volume_may_be_field(const snow_volume_info *info) {
    static const char *const images[] = {"mrc", "tiff", "zarr"};
    bool found =
        !info->whole && !info->eight_bits && !info->medical && !*info->modality;
    /* A record that a caller has filled may name no format. */
    for (size_t n = 0; n < sizeof images / sizeof *images && info->format; n++)
        found =
            found && (*info->quantity || strcmp(info->format, images[n]) != 0);
    return found;
}
