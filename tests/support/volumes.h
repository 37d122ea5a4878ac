/* tests/support/volumes.h - for tests of volume files: a context that remembers
 * its largest allocation, folders of files, comparisons. */
#ifndef SNOW_TEST_SUPPORT_VOLUMES_H
#define SNOW_TEST_SUPPORT_VOLUMES_H

#include "support/files.h"

typedef struct support_place {
    snow_context *context;
    size_t largest;  /* bytes of the largest allocation since it was set 0 */
    int64_t fail_at; /* this allocation and all later ones fail; 0: none */
    int64_t allocations;               /* so far */
    char warnings[4096];               /* all remarks, one a line */
    char folder[SUPPORT_FOLDER_BYTES]; /* an empty folder, removed with its
                                          files at the end */
} support_place;

/* cmocka set-up and tear-down; *state is the place.  The tear-down fails when
 * the context still holds memory. */
int support_place_begin(void **state);
int support_place_end(void **state);

/* The path of a file in the folder; lasts until the next call but three. */
const char *support_place_path(const support_place *place, const char *name);

/* Writes a file into the folder and gives its path. */
const char *support_place_put(const support_place *place, const char *name,
                              const void *bytes, size_t size);

/* Opens a file (time step 0); the test fails when that does. */
snow_volume *support_place_open(support_place *place, const char *path);

/* Opens bytes, which must be refused as SNOW_STATUS_BAD_INPUT with a message of
 * one line that contains `part`, without an allocation above `most` bytes. */
void support_place_refuse(support_place *place, const char *name,
                          const void *bytes, size_t size, const char *part,
                          size_t most);

#endif
