/* volume/length_unit.h - lengths along three axes in one unit. */
#ifndef SNOW_VOLUME_LENGTH_UNIT_H
#define SNOW_VOLUME_LENGTH_UNIT_H

#include "base/base.h"

/* Brings lengths along x, y and z into one unit, the first known one of the
 * three; if none is known, the first text is taken as it is.  A text may be ""
 * (the file names no unit) or NULL (no such axis).  Sets the factors of the
 * lengths.  Notes an axis whose unit is not known while another's is. */
void snow_length_join(snow_context *context, const char *const texts[3],
                      double factors[3], char unit[16]);

#endif
