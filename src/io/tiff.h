/* io/tiff.h - TIFF files with libtiff, for volumes and pictures.
 *
 * libtiff reads and writes bytes through functions and reports errors to the
 * file's own handler: nothing is printed and no state is shared. Its own
 * allocations are limited by the size of the file. Damage that it only warns
 * of, or passes over in silence, is found here. */
#ifndef SNOW_IO_TIFF_H
#define SNOW_IO_TIFF_H

#include "io/memory_file.h"
#include "io/seekable.h"

/* Returns whether a file begins like TIFF or BigTIFF of either byte order. */
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
    snow_seekable *bytes;   /* of a file being read */
    snow_memory_file store; /* a file being written */
    uint64_t at;            /* position of libtiff's next read or write */
    snow_status status;     /* of the memory file */
    TIFF *tiff;
    bool decoding; /* samples, so that a warning means damage */
    bool cut; /* the file ends where the place of the next page should be */
    char complaint[200]; /* libtiff's first error: later ones follow from it */
} snow_tiff;

/* Opens a file at its first page; must be ended whatever the status. Errors:
 * SNOW_STATUS_BAD_INPUT, SNOW_STATUS_NO_MEMORY. */
snow_status snow_tiff_open(snow_source *source, snow_tiff *file);

/* Begins a file, whose bytes will be in file->store; must be ended too. Errors:
 * SNOW_STATUS_NO_MEMORY. */
snow_status snow_tiff_create(snow_context *context, snow_tiff *file);

/* Ends with libtiff: a written file's bytes are complete then, and remain. */
void snow_tiff_end(snow_tiff *file);
void snow_tiff_close(snow_tiff *file);

/* Advances to the next page; *got is false after the last. Errors:
 * SNOW_STATUS_BAD_INPUT. */
snow_status snow_tiff_next(snow_tiff *file, bool *got);

/* Decodes strip or tile number `part` of the page to `size` bytes at `out`; the
 * rows of a part have `row_bytes`. What libtiff only warns of is an error too,
 * since the bytes would be invented. Errors: SNOW_STATUS_BAD_INPUT,
 * SNOW_STATUS_NO_MEMORY. */
snow_status snow_tiff_decode(snow_tiff *file, uint32_t part, void *out,
                             uint64_t size, uint64_t row_bytes);

/* "is a damaged TIFF file" with libtiff's error. */
snow_status snow_tiff_fail(const snow_tiff *file);

#endif
#endif
