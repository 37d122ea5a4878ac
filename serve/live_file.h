/* live_file.h - the newest of a simulation's pictures, as a file. */
#ifndef LIVE_FILE_H
#define LIVE_FILE_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/stat.h>

/* Where pictures are, and which was the newest. */
typedef struct live_files {
    char *folder, *before, *after; /* of the number in the name */
    int digits;                    /* the least; 0: as many as it has */
    struct timespec folder_at, newest_at;
    int64_t newest; /* -1: none yet */
    double next;    /* when the folder may be read again, in seconds */
} live_files;

/* Of a pattern with one %d or %04d; false where it is none, or not of PNGs. */
bool live_files_open(live_files *f, const char *pattern);
void live_files_close(live_files *f);

/* Looks for a picture that is newer than the last one.  Its bytes are the
 * caller's; NULL: there is none. */
unsigned char *live_files_next(live_files *f, size_t *length);

/* The sizes of a PNG, and what the simulation says of it (a new reference, or
 * NULL); false where it is no PNG. */
bool live_file_read(const unsigned char *bytes, size_t length, uint32_t size[2],
                    json_t **comment);

#endif
