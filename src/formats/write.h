/* formats/write.h - the `write` functions of the formats, and what they share.
 * All write little-endian, so that a volume gives the same bytes on every
 * machine. */
#ifndef SNOW_FORMATS_WRITE_H
#define SNOW_FORMATS_WRITE_H

#include "formats/format.h"

/* Appends the voxels, low byte first. */
snow_status snow_write_voxels(const snow_volume *volume, snow_writer *writer);

/* Prints `count` numbers with 17 digits and `between` between them, with a
 * decimal point in every locale.  Returns the number of characters; the buffer
 * must have 25 for each number. */
int snow_print_numbers(char *text, size_t capacity, const double *values,
                       int count, const char *between);

/* The info with lengths in a unit that the format can name: its own, if that is
 * among `units` (ended by NULL) or is no length, else millimetres. */
snow_volume_info snow_write_in_units(const snow_volume_info *info,
                                     const char *const *units);

/* Writes as a snow_format does. Errors: SNOW_STATUS_BAD_USAGE when the format
 * cannot say what the volume is (a scaling of values, say), those of the
 * writer. */
snow_status snow_nrrd_write(const snow_volume *volume, const char *path,
                            snow_writer *writer);
snow_status snow_nifti_write(const snow_volume *volume, const char *path,
                             snow_writer *writer);
snow_status snow_metaimage_write(const snow_volume *volume, const char *path,
                                 snow_writer *writer);
snow_status snow_npy_write(const snow_volume *volume, const char *path,
                           snow_writer *writer);

#endif
