/* volume/field.h - which volumes may be computed fields, as far as a header
 * says. */
#ifndef SNOW_FIELD_H
#define SNOW_FIELD_H

#include <snowglass/volume.h>

/* Returns whether values may be those of a computed field rather than of a
 * scan: they are in no patient and in no format of microscopes, unless it names
 * their quantity, as data sets in Zarr do. */
bool snow_volume_may_be_field(const snow_volume_info *info);

#endif
