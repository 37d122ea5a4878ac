/* formats/raw/raw.h - the parts of the reader of raw voxels. */
#ifndef SNOW_FORMATS_RAW_RAW_H
#define SNOW_FORMATS_RAW_RAW_H

#include "formats/write.h"

/* Capacity for what snow_raw_list_fitting writes: four times three numbers of
 * 19 digits and types. */
#define RAW_ADVICE_BYTES 512

/* Words that a name is split into, and what separates them. */
#define RAW_BETWEEN "_.- "

/* Parses a word "256x256x110". */
bool snow_raw_parse_dims(const char *word, size_t length, int64_t dims[3]);

/* Parses a type with or without byte order: "uint8", "u16be", "f32". */
bool snow_raw_parse_type(const char *word, size_t length, snow_type *type,
                         snow_endian *endian);

/* Writes which dims and types hold `bytes` bytes exactly, as a clause that
 * begins with "; ", or nothing.  `options` has what is known: dims or type may
 * be 0. */
void snow_raw_list_fitting(uint64_t bytes, const snow_volume_options *options,
                           char out[RAW_ADVICE_BYTES]);

#endif
