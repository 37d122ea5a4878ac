/* base/writer.h - bytes out: the one way in which files come into being.
 *
 * A writer fills a file without a name, or of a hidden one, beside the final
 * one; commit syncs it and names it.  A file that is replaced hands on its
 * permissions.  Whatever happens before, nothing stands under the final name
 * that is not whole. */
#ifndef SNOW_WRITER_H
#define SNOW_WRITER_H

#include "base/base.h"

typedef struct snow_writer snow_writer;

/* Begins a file.  "-" is standard output, which is written through.  A path
 * that exists is SNOW_BAD_OUTPUT unless `overwrite`; so is a folder that is
 * missing or not writable. */
snow_status snow_writer_open(snow_context *context, const char *path,
                             bool overwrite, snow_writer **out);

snow_context *snow_writer_context(const snow_writer *writer);

/* Appends bytes.  Errors: SNOW_BAD_OUTPUT (disk full, say). */
snow_status snow_writer_write(snow_writer *writer, const void *bytes,
                              size_t size);

/* Says that the bytes from here on are to be packed with gzip (level 6).  Only
 * before the first write. */
snow_status snow_writer_pack(snow_writer *writer);

/* Ends the file: flushes, syncs, names it, frees the writer.  On failure
 * nothing is left, and the writer is freed as well. */
snow_status snow_writer_commit(snow_writer *writer);

/* Gives up: leaves nothing and frees the writer; NULL is accepted. */
void snow_writer_abandon(snow_writer *writer);

#endif
