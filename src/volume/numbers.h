/* volume/numbers.h - voxels as decimal numbers in text; for the readers of
 * formats that have them. */
#ifndef SNOW_VOLUME_NUMBERS_H
#define SNOW_VOLUME_NUMBERS_H

#include "volume/volume.h"

/* Writes the number that the word is to `at`, which needs no alignment; false
 * when it is none of the type, exactly for whole numbers, by range for real
 * ones. */
bool snow_store_number(snow_type type, const char *word, void *at);

/* Takes the numbers of a part, as if each was written in its bytes, and the
 * blanks behind them from the source, and puts those
 * wanted where they belong in `voxels`.  `commas` separate as blanks do.
 * Errors: SNOW_BAD_INPUT for too few, and for what is no number of the type. */
snow_status snow_read_numbers(snow_source *source, snow_type type, bool commas,
                              const snow_file_part *part, void *voxels);

#endif
