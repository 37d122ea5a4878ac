/* io/writer.h - output: the only way in which files are created.
 *
 * A writer fills a file without a name, or with a hidden one, beside the final
 * one; commit syncs it and names it. A replaced file passes on its permissions.
 * Whatever happens before, no incomplete file ever has the final name. */
#ifndef SNOW_IO_WRITER_H
#define SNOW_IO_WRITER_H

#include "base/base.h"

typedef struct snow_writer snow_writer;

/* Begins a file. "-" is standard output, which is written directly. A path that
 * exists is SNOW_STATUS_BAD_OUTPUT unless `overwrite`; so is a folder that is
 * missing or not writable. */
snow_status snow_writer_open(snow_context *context, const char *path,
                             bool overwrite, snow_writer **out);

/* Appends bytes.  Errors: SNOW_STATUS_BAD_OUTPUT (disk full, say). */
snow_status snow_writer_write(snow_writer *writer, const void *bytes,
                              size_t size);

/* Declares that commit is not to wait for the disk: after a power failure the
 * file may be empty.  The name still comes last. */
void snow_writer_hurry(snow_writer *writer);

/* Declares that the bytes from here on are to be packed with gzip (level 6).
 * Only before the first write. */
snow_status snow_writer_pack(snow_writer *writer);

/* Ends the file: flushes, syncs, names it, frees the writer. On failure nothing
 * is left, and the writer is freed too. */
snow_status snow_writer_commit(snow_writer *writer);

/* Cancels: leaves nothing and frees the writer; NULL is accepted. */
void snow_writer_abandon(snow_writer *writer);

#endif
