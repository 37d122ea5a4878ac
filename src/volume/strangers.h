/* volume/strangers.h - files that are not read but known. */
#ifndef SNOW_STRANGERS_H
#define SNOW_STRANGERS_H

#include <stddef.h>

/* What the file is, and what to do with it, as the end of a message: "is a tar
 * archive; unpack it ...".  NULL for one that is not known.  `bytes` are its
 * first ones. */
const char *snow_stranger(const unsigned char *bytes, size_t size);

#endif
