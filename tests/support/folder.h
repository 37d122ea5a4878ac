/* tests/support/folder.h - a temporary folder of a test's own, and its files.
 */
#ifndef SNOW_TEST_SUPPORT_FOLDER_H
#define SNOW_TEST_SUPPORT_FOLDER_H

#include <stddef.h>

#define SUPPORT_FOLDER_BYTES 64

/* Makes an empty folder and gives its path; removes it with all its files.
 * The test fails when either does. */
void support_folder_make(char folder[SUPPORT_FOLDER_BYTES]);
void support_folder_remove(const char *folder);

/* How many files are in it, hidden ones included. */
int support_folder_files(const char *folder);

/* cmocka's set-up and tear-down of such a folder: *state is its path. */
int support_folder_setup(void **state);
int support_folder_teardown(void **state);

/* The path of a name in it; lasts until the next call but three. */
const char *support_folder_path(const char *folder, const char *name);

/* Writes a whole file; the test fails when that does. */
void support_write_file(const char *path, const void *bytes, size_t size);

#endif
