/* io/source.h - input: bytes from a file or from memory, unpacked if they are
 * gzip.
 *
 * Readers see files only as sources, so that a fuzzer can provide the bytes. A
 * source is read once from front to back; its first bytes can be peeked at.
 * Every message of a source begins with its name. */
#ifndef SNOW_IO_SOURCE_H
#define SNOW_IO_SOURCE_H

#include "base/base.h"

typedef struct snow_source snow_source;

/* Deflate's shortest code for its longest run: 258 bytes for 2 bits. */
#define SNOW_DEFLATE_RATIO 1032

/* The most bytes that snow_source_peek can return. */
#define SNOW_PEEK_BYTES 4096

/* Opens a regular file (or a pipe, "-" for standard input; never a folder or a
 * device). A gzip stream is unpacked while reading, and its check sums
 * verified, whatever its name. Standard input is not in a folder and has no
 * siblings. Errors: SNOW_STATUS_BAD_INPUT, SNOW_STATUS_NO_MEMORY. */
snow_status snow_source_open(snow_context *context, const char *path,
                             snow_source **out);

/* Returns whether a path can be read only once: "-", a pipe. */
bool snow_source_is_stream(const char *path);

/* Bytes in memory, which must outlive the source; gzip is unpacked too. It has
 * no siblings. */
snow_status snow_source_open_memory(snow_context *context, const char *name,
                                    const void *bytes, size_t size,
                                    snow_source **out);

/* The same for bytes that a function copies from any place on
 * (snowglass/volume.h). */
typedef struct snow_bytes_behind {
    size_t (*read_at)(void *user, uint64_t at, void *bytes, size_t size);
    void *user;
    uint64_t size;
} snow_bytes_behind;
snow_status snow_source_open_with(snow_context *context, const char *name,
                                  const snow_bytes_behind *bytes,
                                  snow_source **out);

/* Opens the file `name`, given by the header that `source` reads: relative to
 * its folder, or absolute; where nothing is there, with slashes for
 * backslashes, else the file of that last name beside the header, with a note.
 * Rejected for sources without siblings, and if it is not a regular file. The
 * _as_is variant leaves gzip packed, for headers that state whether their data
 * are packed. */
snow_status snow_source_open_sibling(snow_source *source, const char *name,
                                     snow_source **out);
snow_status snow_source_open_sibling_as_is(snow_source *source,
                                           const char *name, snow_source **out);

/* The path of that file, in a block that the caller releases; of a name of
 * which only the first `length` letters are the file's. */
snow_status snow_source_find_named(snow_source *source, const char *name,
                                   size_t length, char **out);

/* Whether there is a file whose name the reader has made up, beside that of
 * `source`.  Errors: as above, and a look-up that fails (io/lookup.h). */
snow_status snow_source_look_for_sibling(const snow_source *source,
                                         const char *name, bool *is_there);

/* How many files have led to this one, each named by the one before; 0 at
 * first. */
int snow_source_depth(const snow_source *source);

/* Opens a volume by a path without a mask, to which so many files have led. */
typedef snow_status snow_open_named_fn(snow_context *context, const char *path,
                                       int depth,
                                       const snow_volume_options *options,
                                       snow_volume_info *info,
                                       snow_volume **out);

/* How files that this one names are opened, and how many have led to it. */
void snow_source_set_opener(snow_source *source, int depth,
                            snow_open_named_fn *opener);

/* Opens a file that this one names, by its whole path.  Errors: those of
 * opening; SNOW_STATUS_BAD_INPUT (a source without an opener). */
snow_status snow_source_open_named(const snow_source *source, const char *path,
                                   const snow_volume_options *options,
                                   snow_volume_info *info, snow_volume **out);

/* The path of the file `name` beside the one of `source`, in a block that the
 * caller releases. Errors: SNOW_STATUS_BAD_INPUT (no siblings, no name). */
snow_status snow_source_path_beside(const snow_source *source, const char *name,
                                    char **out);

/* Declares that from here on the bytes are a gzip or zlib stream, which all
 * later calls unpack. */
snow_status snow_source_unpack(snow_source *source);

void snow_source_close(snow_source *source);

snow_context *snow_source_context(const snow_source *source);

/* The path or name with which it was opened. */
const char *snow_source_name(const snow_source *source);

/* Returns whether it is a file in a folder, whose other files can be opened. */
bool snow_source_has_siblings(const snow_source *source);

/* Copies up to `size` (at most SNOW_PEEK_BYTES) of the next bytes without
 * consuming them; *got is smaller only at the end of the data. */
snow_status snow_source_peek(snow_source *source, void *bytes, size_t size,
                             size_t *got);

/* Reads up to `size` bytes; *got is smaller only at the end of the data. A gzip
 * stream that is truncated or damaged is an error, not an end. */
snow_status snow_source_read(snow_source *source, void *bytes, size_t size,
                             size_t *got);

/* Reads exactly `size` bytes; fewer is SNOW_STATUS_BAD_INPUT with a message
 * that says what was read ("the voxels", say) and how much is missing. */
snow_status snow_source_read_all(snow_source *source, void *bytes, size_t size,
                                 const char *what);

/* Skips `size` bytes; as snow_source_read_all if the data end before. */
snow_status snow_source_skip(snow_source *source, uint64_t size,
                             const char *what);

/* Declares that only the next `bytes` bytes are needed soon: reading ahead ends
 * there, and what is skipped beyond is not read if the source is a seekable
 * file. UINT64_MAX: all, as initially. */
void snow_source_plan(snow_source *source, uint64_t bytes);

/* Reads one line of text without its end (\n or \r\n) as a string into `line`,
 * which has room for `size` bytes. *got is false at the end of the data. A
 * longer line, or a NUL byte in it, is SNOW_STATUS_BAD_INPUT. */
snow_status snow_source_read_line(snow_source *source, char *line, size_t size,
                                  bool *got);

/* Remaining bytes if known (a plain file, memory), or -1 (gzip, a pipe). */
int64_t snow_source_remaining(const snow_source *source);

/* Rejects, before memory is allocated for them, `size` bytes that the source
 * cannot hold: more than remain, or for gzip more than 1032 times the packed
 * ones (deflate's limit). `what` as above. Pipes pass. */
snow_status snow_source_expect(const snow_source *source, uint64_t size,
                               const char *what);

/* For readers at the end of their data: verifies a gzip stream to its trailer,
 * and warns if bytes are left over. */
snow_status snow_source_finish(snow_source *source);

#endif
