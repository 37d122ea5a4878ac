/* io/lookup.h - whether a file is there, and what could not be read.
 *
 * A look-up that fails is no answer: a failing disk, a closed folder or a link
 * that leads nowhere must not look like a file that nobody has written.
 *
 *   who gave the name             what means that it is not there
 *   a user, a header, a listing   nothing: it is opened, and that may fail
 *   a reader (a chunk, say)       the system says that there is no such name
 *
 * The first failure is kept in the context until the file that is being opened
 * is closed, so that there is no volume even where its reader has gone on
 * without the bytes. */
#ifndef SNOW_IO_LOOKUP_H
#define SNOW_IO_LOOKUP_H

#include "base/base.h"

#include <sys/stat.h>

/* Forgets earlier failures: when a file is opened, and where the user has asked
 * to go on without some of its files. */
void snow_lookup_begin(snow_context *context);

/* The status of reading: where a look-up or a read has failed since the
 * beginning that failure, with its message, even if reading succeeded. */
snow_status snow_lookup_end(snow_context *context, snow_status status);

/* Keeps the message of a read that has failed with SNOW_STATUS_BAD_INPUT;
 * passes the status on. */
snow_status snow_lookup_keep(snow_context *context, snow_status status);

/* Fails with SNOW_STATUS_BAD_INPUT: `path` cannot be `done` ("opened", "read"),
 * for the reason of errno; keeps that. */
snow_status snow_lookup_fail(snow_context *context, const char *path,
                             const char *done);

/* True for a link that leads nowhere. */
bool snow_is_dangling(const char *path);

/* The mode of what is at a path, which somebody has given or which a reader has
 * made up: *mode is 0 if nothing is there.  Errors: SNOW_STATUS_BAD_INPUT. */
snow_status snow_look_at_given(snow_context *context, const char *path,
                               mode_t *mode);
snow_status snow_look_for(snow_context *context, const char *path,
                          mode_t *mode);

#endif
