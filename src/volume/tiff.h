/* volume/tiff.h - the parts of the TIFF reader; for tiff*.c alone.
 *
 *   tiff.c        the file -> which pages are slices, the volume
 *   tiff_text.c   descriptions by ImageJ and OME -> tiff_shape
 *   tiff_page.c   a page -> voxels of a slice, by libtiff */
#ifndef SNOW_TIFF_H
#define SNOW_TIFF_H

#include "base/tiff.h"
#include "volume/volume.h"

/* What a description says of all pages together; 0 and "" where it says
 * nothing. */
typedef struct tiff_shape {
    bool imagej;    /* written by ImageJ */
    int64_t images; /* ... which may tell of more than there are pages */
    int64_t channels, slices, frames;
    char order[6];     /* which of C, Z and T run first, "XYCZT" */
    double spacing[3]; /* x and y stand elsewhere in ImageJ's files */
    char unit[16];
} tiff_shape;

/* Reads the text of the ImageDescription, which may be NULL. */
void snow_tiff_read_text(const char *text, tiff_shape *out);

#if SNOW_HAVE_TIFF

/* How a value is stored; what is no type of ours becomes a larger one. */
typedef enum tiff_coding {
    TIFF_PLAIN,
    TIFF_BIT,   /* uint8 of 0 and 1 */
    TIFF_HALF,  /* float32 */
    TIFF_TRIPLE /* 24 bits; 32 */
} tiff_coding;

/* What all pages of a volume must have in common. */
typedef struct tiff_page {
    int64_t width, height, samples;
    snow_type type;
    tiff_coding coding;
    uint16_t bits, compression;
    bool separate; /* samples lie in planes, not beside one another */
} tiff_page;

/* What the current page is.  Errors: SNOW_BAD_INPUT for what is not read. */
snow_status snow_tiff_describe(snow_tiff *file, tiff_page *out);

/* The least bytes of a file that holds so many bytes of pixels, as far as the
 * compression tells. */
uint64_t snow_tiff_least(const tiff_page *page, uint64_t bytes);

/* Reads the window's columns and rows of one sample of the current page into
 * the voxels of a slice. */
snow_status snow_tiff_read_page(snow_tiff *file, const tiff_page *page,
                                int64_t sample, const snow_window *window,
                                unsigned char *slice);

/* The same for image `index` of those that lie one behind the other where the
 * first page's are, which is how ImageJ writes more than 4 GB. */
snow_status snow_tiff_read_raw(snow_tiff *file, const tiff_page *page,
                               int64_t index, int64_t sample,
                               const snow_window *window, unsigned char *slice);

#endif
#endif
