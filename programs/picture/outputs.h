/* outputs.h - where outputs go, and the writer of the --stats file, which the
 * tool writes itself. */
#ifndef OUTPUTS_H
#define OUTPUTS_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

/* Whether a path is standard output, a pipe or a device: a rename must not
 * replace it, and a write may wait for its reader for ever. */
bool is_special(const char *path);

/* Whether two paths name the same file, even one that does not exist yet; NULL
 * names none. */
bool same_output(const char *a, const char *b);

/* Refuses paths that name one file with `fault`, if it is not NULL, and paths
 * that cannot be compared.  Returns CONTINUE or an exit code. */
int check_apart(const char *a, const char *b, const char *fault);

/* Refuses a folder where a file is to be written, also one that is named with
 * a slash but does not exist.  Returns CONTINUE or an exit code. */
int check_no_folder(const char *path);

/* Whether nothing stands in the way of a new file of this name, as far as a
 * look at its folder shows. */
bool is_free(const char *path, bool overwrite);

/* Checks before rendering whether the file of --stats can be written.  Returns
 * CONTINUE or an exit code. */
int check_stats_path(const char *path, bool overwrite);

/* Writes an object to a file, aside and renamed, or directly if it is not a
 * regular file; "-" is standard output.  Frees the object.  Returns an exit
 * code. */
int write_json(json_t *object, const char *path, bool overwrite);

/* The same for any text. */
int write_text(const char *bytes, size_t count, const char *path,
               bool overwrite);

/* Opens a file, which programs that are started do not inherit; a signal does
 * no harm.  Returns -1 with errno where that fails. */
int open_bytes(const char *path, int how);

/* Writes bytes to an open file, or in the place of those at `at`, or makes what
 * was written survive a power failure where that is possible.  A signal does no
 * harm.  Returns 0 or an error number. */
int write_bytes(int file, const void *bytes, size_t count);
int write_bytes_at(int file, const void *bytes, size_t count, int64_t at);
int sync_bytes(int file);

/* Closes a file, of which some systems say only now that it is not whole. */
int close_bytes(int file);

/* The offset of the last part of a path. */
size_t folder_length(const char *path);

/* Renames a finished file to its final name, in the same folder or at least on
 * the same file system; an existing file is replaced only with `overwrite`.
 * Makes file and name survive a power failure.  Returns 0 or an error
 * number. */
int place_output(const char *aside, const char *path, bool overwrite);

/* The same for a file that is synced already, without waiting for the disk. */
int name_output(const char *aside, const char *path, bool overwrite);

#endif
