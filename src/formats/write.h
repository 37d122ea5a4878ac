/* formats/write.h - what the `write` functions of the formats share.
 * All write little-endian, so that a volume gives the same bytes on every
 * machine. */
#ifndef SNOW_FORMATS_WRITE_H
#define SNOW_FORMATS_WRITE_H

#include "formats/format.h"

/* Appends the voxels, low byte first. */
snow_status snow_write_voxels(const snow_volume *volume, snow_writer *writer);

/* Adds numbers with 17 digits, enough to restore every double, and `between`
 * between them. */
void snow_append_numbers(char *text, size_t capacity, const double *values,
                         int count, const char *between);

/* The info with lengths in a unit that the format can name: its own, if that is
 * among `units` (ended by NULL) or is no length, else millimetres. */
snow_volume_info snow_write_in_units(const snow_volume_info *info,
                                     const char *const *units);

#endif
