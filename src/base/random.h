/* base/random.h - the bytes of a source in any order, for formats whose parts
 * point to one another. */
#ifndef SNOW_RANDOM_H
#define SNOW_RANDOM_H

#include "base/source.h"

typedef struct snow_random snow_random;

/* The bytes of a source from which none was taken, which must outlive it.  A
 * plain file and memory are looked at in place; a packed stream and a pipe are
 * read to their end first, and held.  Errors: those of reading. */
snow_status snow_random_open(snow_source *source, snow_random **out);

/* NULL is accepted. */
void snow_random_close(snow_random *store);

uint64_t snow_random_size(const snow_random *store);

/* The bytes where they are held; NULL where they are looked at in place, and
 * the source still stands before them. */
const void *snow_random_held(const snow_random *store);

/* Copies up to `size` bytes from `from` on; fewer where the data end or cannot
 * be read. */
size_t snow_random_read(snow_random *store, uint64_t from, void *bytes,
                        size_t size);

#endif
