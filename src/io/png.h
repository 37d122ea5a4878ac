/* io/png.h - PNG files with libpng, for volumes and pictures.
 *
 * libpng allocates from the context, and leaves by longjmp on errors.  To lose
 * no variable, everything that must survive is in a snow_png of the function
 * above the one that calls setjmp. */
#ifndef SNOW_IO_PNG_H
#define SNOW_IO_PNG_H

#include "io/source.h"

#include <png.h>
#include <setjmp.h>

typedef struct snow_png {
    snow_context *context;
    snow_status status;  /* why libpng failed, SNOW_STATUS_OK before */
    snow_status refusal; /* the status of libpng's own errors */
    const char *prefix;  /* the beginning of their messages */
    const char *remedy;  /* and their end */
    snow_source *source; /* when reading */
    png_structp png;
    png_infop info;
    jmp_buf jump;
} snow_png;

bool snow_png_probe(const unsigned char *bytes, size_t size);

/* Width and height behind the signature, a length and the name IHDR. */
#define SNOW_PNG_HEADER_BYTES 29
void snow_png_sides(const unsigned char *header, int64_t sides[2]);

/* Leaves libpng after an error that already has its message. */
void snow_png_leave(snow_png *job, snow_status status);

/* Makes libpng's structures.  Errors: SNOW_STATUS_NO_MEMORY, SNOW_STATUS_FAILED
 * (another libpng than that of the headers). */
snow_status snow_png_make(snow_png *job, bool writes);

/* The same to read sides of at most `side` pixels: reads everything before
 * them. */
snow_status snow_png_begin(snow_png *job, uint32_t side);

#endif
