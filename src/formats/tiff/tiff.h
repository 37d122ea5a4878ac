/* formats/tiff/tiff.h - the parts of the TIFF reader, private to this folder.
 *
 *   tiff.c   the file -> the pages that are slices, the volume
 *   text.c   descriptions by ImageJ and OME -> tiff_shape
 *   channels.c   what it says of channels
 *   page.c   a page -> voxels of a slice, by libtiff */
#ifndef SNOW_FORMATS_TIFF_TIFF_H
#define SNOW_FORMATS_TIFF_TIFF_H

#include "formats/format.h"
#include "io/tiff.h"

/* What a description says about all pages together; 0 and "" if nothing. */
typedef struct tiff_shape {
    bool imagej;    /* written by ImageJ */
    int64_t images; /* ... which may exceed the number of pages */
    int64_t channels, slices, frames;
    char order[6];     /* the order of C, Z and T, "XYCZT" */
    double spacing[3]; /* ImageJ stores x and y elsewhere */
    char unit[16];
    snow_channel channel[SNOW_CHANNELS_MAX];
    bool colors, opacity; /* of samples of a pixel: they are; the last is */
} tiff_shape;

/* Reads the text of the ImageDescription, which may be NULL. */
void snow_tiff_read_text(const char *text, tiff_shape *out);

#if SNOW_HAVE_TIFF

/* How a value is stored; an unsupported type becomes a larger one. */
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
    bool separate; /* samples are in planes, not interleaved */
} tiff_page;

/* Describes the current page.  Errors: SNOW_STATUS_BAD_INPUT if it is not
 * supported. */
snow_status snow_tiff_describe(snow_tiff *file, tiff_page *out);

/* Adds what the current page says of channels beside its description. */
void snow_tiff_read_channels(const snow_tiff *file, const tiff_page *page,
                             tiff_shape *shape);

/* A lower bound for the size of a file with so many bytes of pixels, from the
 * compression. */
uint64_t snow_tiff_least(const tiff_page *page, uint64_t bytes);

/* Reads the box's columns and rows of one sample of the current page into the
 * voxels of a slice. */
snow_status snow_tiff_read_page(snow_tiff *file, const tiff_page *page,
                                int64_t sample, const snow_region *region,
                                unsigned char *slice);

/* The same for image `index` of those stored after the first page's, which is
 * how ImageJ writes more than 4 GB. */
snow_status snow_tiff_read_raw(snow_tiff *file, const tiff_page *page,
                               int64_t index, int64_t sample,
                               const snow_region *region, unsigned char *slice);

#endif
#endif
