/* base/tiff.h - TIFF files by libtiff, for volumes and pictures.
 *
 * libtiff sees bytes through functions and tells its complaints to the file's
 * own handler: nothing is printed and no state is shared.  What it allocates by
 * itself is limited to what the file can be worth. */
#ifndef SNOW_TIFF_FILE_H
#define SNOW_TIFF_FILE_H

#include "base/random.h"
#include "base/store.h"

/* Whether a file begins as TIFF and BigTIFF of either byte order do. */
static inline bool snow_tiff_probe(const unsigned char *bytes, size_t size) {
    static const unsigned char magic[4][4] = {{'I', 'I', 42, 0},
                                              {'M', 'M', 0, 42},
                                              {'I', 'I', 43, 0},
                                              {'M', 'M', 0, 43}};
    for (int i = 0; i < 4 && size >= 4; i++)
        if (!memcmp(bytes, magic[i], 4))
            return true;
    return false;
}

#if SNOW_HAVE_TIFF

#include <tiffio.h>

typedef struct snow_tiff {
    snow_context *context;
    snow_random *bytes; /* of a file that is read */
    snow_store store;   /* one that is written */
    uint64_t at;        /* where libtiff reads or writes next */
    snow_status status; /* of the store */
    TIFF *tiff;
    char complaint[200]; /* of libtiff, the first: later ones follow from it */
} snow_tiff;

/* Opens a file at its first page; to be closed whatever the status.
 * Errors: SNOW_BAD_INPUT, SNOW_NO_MEMORY. */
snow_status snow_tiff_open(snow_source *source, snow_tiff *file);

/* Begins a file, of which file->store holds the bytes in the end; alike.
 * Errors: SNOW_NO_MEMORY. */
snow_status snow_tiff_create(snow_context *context, snow_tiff *file);

/* Ends with libtiff: a written file's bytes are whole then, and stay. */
void snow_tiff_end(snow_tiff *file);
void snow_tiff_close(snow_tiff *file);

/* "is a damaged TIFF file" with libtiff's complaint. */
snow_status snow_tiff_fail(const snow_tiff *file);

#endif
#endif
