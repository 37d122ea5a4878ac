/* base/source.h - bytes in: from a file, from memory, through gzip.
 *
 * Readers see files only as sources, so that a fuzzer can hand them bytes.  A
 * source is read from front to back once; its first bytes can be peeked at.
 * Every message that a source makes begins with its name. */
#ifndef SNOW_SOURCE_H
#define SNOW_SOURCE_H

#include "base/base.h"

typedef struct snow_source snow_source;

/* Deflate's shortest code for its longest run: 258 bytes for 2 bits. */
#define SNOW_DEFLATE_RATIO 1032

/* The most that snow_source_peek can show. */
#define SNOW_PEEK_BYTES 4096

/* A regular file (or a pipe, "-" for standard input; never a folder or a
 * device).  A gzip stream is unpacked in passing, its check sums verified,
 * whatever its name.  Standard input lies in no folder and has no siblings.
 * Errors: SNOW_BAD_INPUT, SNOW_NO_MEMORY. */
snow_status snow_source_open(snow_context *context, const char *path,
                             snow_source **out);

/* Whether a path can be read only once, and by one: "-", a pipe. */
bool snow_source_is_stream(const char *path);

/* Bytes in memory, which must outlive the source; gzip is unpacked as well.
 * It has no siblings. */
snow_status snow_source_open_memory(snow_context *context, const char *name,
                                    const void *bytes, size_t size,
                                    snow_source **out);

/* The file `name` as told by the header that `source` is: relative to its
 * folder, or absolute.  Refused for sources without siblings, and for a name
 * that is no regular file.  "as_is" leaves gzip packed, for headers that tell
 * whether their data are. */
snow_status snow_source_open_sibling(const snow_source *source,
                                     const char *name, snow_source **out);
snow_status snow_source_open_sibling_as_is(const snow_source *source,
                                           const char *name, snow_source **out);

/* Says that from here on the bytes are a gzip or zlib stream, which all later
 * calls unpack. */
snow_status snow_source_unpack(snow_source *source);

void snow_source_close(snow_source *source);

snow_context *snow_source_context(const snow_source *source);

/* The path or name that it was opened by. */
const char *snow_source_name(const snow_source *source);

/* Whether it is a file in a folder, with others beside it. */
bool snow_source_has_siblings(const snow_source *source);

/* Copies up to `size` (at most SNOW_PEEK_BYTES) of the bytes that come next
 * without taking them; *got is smaller only where the data end. */
snow_status snow_source_peek(snow_source *source, void *bytes, size_t size,
                             size_t *got);

/* Takes up to `size` bytes; *got is smaller only where the data end.  A gzip
 * stream that is cut or damaged is an error, not an end. */
snow_status snow_source_read(snow_source *source, void *bytes, size_t size,
                             size_t *got);

/* Takes exactly `size` bytes; fewer is SNOW_BAD_INPUT with a message that says
 * what was read ("the voxels", say) and how much is missing. */
snow_status snow_source_read_all(snow_source *source, void *bytes, size_t size,
                                 const char *what);

/* Takes `size` bytes and drops them; as snow_source_read_all when they end. */
snow_status snow_source_skip(snow_source *source, uint64_t size,
                             const char *what);

/* Says that of the bytes to come only the next `bytes` are wanted before long:
 * reading ahead ends there, and what is skipped beyond is not read, where the
 * source is a file that can be jumped in.  UINT64_MAX: all, as at first. */
void snow_source_plan(snow_source *source, uint64_t bytes);

/* Takes one line of text without its end (\n or \r\n) as a string into `line`,
 * which has room for `size` bytes.  *got is false at the end of the data.
 * A longer line, and a NUL byte in it, is SNOW_BAD_INPUT. */
snow_status snow_source_read_line(snow_source *source, char *line, size_t size,
                                  bool *got);

/* Bytes still to come when that is known (a plain file, memory), or -1 (gzip,
 * a pipe). */
int64_t snow_source_remaining(const snow_source *source);

/* Refuses, before anything is allocated for them, `size` bytes that the source
 * cannot hold: more than remain, or for gzip more than 1032 times the packed
 * ones (deflate's limit).  `what` as above.  Pipes pass. */
snow_status snow_source_expect(const snow_source *source, uint64_t size,
                               const char *what);

/* For readers at the end of their data: verifies a gzip stream to its trailer,
 * and tells the listener when bytes are left over. */
snow_status snow_source_finish(snow_source *source);

#endif
