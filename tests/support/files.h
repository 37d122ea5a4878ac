/* tests/support/files.h - for tests of readers: a folder of files of their own,
 * and a context that notes what it is asked for and what it says. */
#ifndef SNOW_TEST_SUPPORT_FILES_H
#define SNOW_TEST_SUPPORT_FILES_H

#include "support/folder.h"
#include "support/support.h"

typedef struct support_files {
    snow_context *context;
    char folder[SUPPORT_FOLDER_BYTES]; /* of temporary files */
    size_t largest;                    /* request for memory so far */
    int warnings;                      /* heard so far */
    char warning[1024];                /* the last one */
} support_files;

/* Group fixtures are not needed: a test begins and ends its own.  The end
 * fails when memory is still held, and removes the folder. */
void support_files_begin(support_files *files);
void support_files_end(support_files *files);

/* The path of a name in the folder; lasts until the next but three call. */
const char *support_path(const support_files *files, const char *name);

/* Writes a file and returns its path, as above. */
const char *support_write(const support_files *files, const char *name,
                          const void *bytes, size_t size);

/* Text of the format as a file. */
const char *support_write_text(const support_files *files, const char *name,
                               const char *text);

/* Packs as gzip into `out`, which has room for `room` bytes; the packed
 * size. */
size_t support_gzip(const void *bytes, size_t size, void *out, size_t room);

/* Opens a volume that must open. */
snow_volume *support_opened(support_files *files, const char *path,
                            const snow_volume_options *options);

/* Opens one that must not: the status, and a message of one line that begins
 * with the path and contains `part`.  No request for memory may have been
 * larger than `most` bytes. */
void support_refused(support_files *files, const char *path,
                     const snow_volume_options *options, snow_status status,
                     const char *part, size_t most);

#endif
