/* io/seekable.h - random access to the bytes of a source, for formats whose
 * parts refer to each other. */
#ifndef SNOW_IO_SEEKABLE_H
#define SNOW_IO_SEEKABLE_H

#include "io/source.h"

typedef struct snow_seekable snow_seekable;

/* Random access to a source that nothing was read from; close it before the
 * source. A plain file and memory are read in place; a packed stream and a pipe
 * are first read to their end, and held in memory. Errors: those of reading. */
snow_status snow_seekable_open(snow_source *source, snow_seekable **out);

/* NULL is accepted. */
void snow_seekable_close(snow_seekable *store);

uint64_t snow_seekable_size(const snow_seekable *store);

/* The bytes if they are held; NULL if they are read in place, and the source is
 * still at its beginning. */
const void *snow_seekable_held(const snow_seekable *store);

/* Copies up to `size` bytes from `from` on; fewer if the data end or cannot be
 * read. */
size_t snow_seekable_read(snow_seekable *store, uint64_t from, void *bytes,
                          size_t size);

#endif
