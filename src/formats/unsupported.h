/* formats/unsupported.h - files that are recognised but not supported. */
#ifndef SNOW_FORMATS_UNSUPPORTED_H
#define SNOW_FORMATS_UNSUPPORTED_H

#include <stddef.h>

/* What the file is and what to do with it, as the end of a message: "is a tar
 * archive; unpack it ...".  NULL for an unknown file.  `bytes` are its first
 * ones. */
const char *snow_stranger(const unsigned char *bytes, size_t size);

#endif
