/* tests/support/files.h - for tests of readers: a folder of files of their own,
 * a context that notes what it is asked for and what it says, comparisons. */
#ifndef SNOW_TEST_SUPPORT_FILES_H
#define SNOW_TEST_SUPPORT_FILES_H

#include "support/folder.h"
#include "support/support.h"

typedef struct support_files {
    snow_context *context;
    char folder[SUPPORT_FOLDER_BYTES]; /* of temporary files */
    size_t largest;      /* request for memory since it was set 0 */
    int64_t fail_at;     /* this request and all later ones fail; 0: none */
    int64_t allocations; /* so far */
    char warnings[4096]; /* all of them, one a line */
} support_files;

/* The end fails when memory is still held, and removes the folder. */
void support_files_begin(support_files *files);
void support_files_end(support_files *files);

/* The same as cmocka's set-up and tear-down: *state is the record. */
int support_files_setup(void **state);
int support_files_teardown(void **state);

#define SUPPORT_TEST(function)                                     \
    cmocka_unit_test_setup_teardown(function, support_files_setup, \
                                    support_files_teardown)

/* Checks all files of a fuzzer's corpus, of which there are some, by their
 * paths, as of a `name`. */
void support_each_of_corpus(const char *subject, const char *name,
                            void (*check)(const char *path, const char *name));

/* How many warnings were heard. */
int support_warned(const support_files *files);

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

/* The same with windowBits of zlib's deflateInit2: 15 for a zlib stream. */
size_t support_deflate(int window, const void *bytes, size_t size, void *out,
                       size_t room);

/* Opens a volume that must open. */
snow_volume *support_opened(support_files *files, const char *path,
                            const snow_volume_options *options);

/* Opens one that must not: the status, and a message of one line that begins
 * with the path and contains `part`.  No request for memory may have been
 * larger than `most` bytes. */
void support_refused(support_files *files, const char *path,
                     const snow_volume_options *options, snow_status status,
                     const char *part, size_t most);

/* The most that a damaged file may ask for at once, whatever its header says:
 * buffers of source, header and unpacker. */
#define SUPPORT_MOST ((size_t)300 * 1024)

/* The same of bad input, which is refused without options and with at most
 * SUPPORT_MOST bytes: a file, and bytes in memory. */
void support_bad_file(support_files *files, const char *path, const char *part);
void support_bad_bytes(support_files *files, const char *name,
                       const void *bytes, size_t size, const char *part);

/* Opens bytes that are a volume. */
snow_volume *support_opened_bytes(support_files *files, const char *name,
                                  const void *bytes, size_t size,
                                  const snow_volume_options *options);

/* Same dims, type and voxels, bit for bit. */
void support_same_voxels(const snow_volume *a, const snow_volume *b);

/* Matrices that differ by no more than `tolerance` in any entry. */
void support_same_matrix(const double a[4][4], const double b[4][4],
                         double tolerance);

/* The upper rows of the matrix are these. */
void support_expect_matrix(const snow_volume *volume, const double rows[12]);

#endif
