/* formats/ascii.h - voxels as decimal numbers in text, for the readers of
 * formats that use them. */
#ifndef SNOW_FORMATS_ASCII_H
#define SNOW_FORMATS_ASCII_H

#include "formats/format.h"

/* Copies the next word between blanks or tabs, and moves behind it; returns
 * false at the end, and for a word for which there is no room, which could
 * match another if shortened. */
bool snow_next_word(const char **at, char *word, size_t size);

/* Returns whether a word is among those of a list, which are shorter than 64
 * letters. */
bool snow_has_word(const char *words, const char *word);

/* Reads the numbers of a part, as if each stood in its bytes, and the blanks
 * after them, and stores those of the box in `voxels`.  With `commas`, commas
 * separate like blanks.  Errors: SNOW_STATUS_BAD_INPUT for too few numbers, and
 * for words that are not a number of the type. */
snow_status snow_read_numbers(snow_source *source, snow_type type, bool commas,
                              const snow_file_part *part, void *voxels);

/* A grid of numbers in text, nested axes with the fastest one first. */
typedef struct snow_text_grid {
    int64_t values; /* of a voxel, of which one is wanted; the fastest axis */
    int64_t value;
    int order[3]; /* axis x, y or z (0 to 2) that is next fastest, and so on */
    int64_t dims[3]; /* of the file */
    bool closed;     /* the volume has one more along each axis: the first */
} snow_text_grid;

/* Where a source is, in which numbers of such grids follow one another: passes
 * one, whose words may be any.  Errors: SNOW_STATUS_BAD_INPUT (fewer). */
snow_status snow_skip_grid(snow_source *source, const snow_text_grid *grid);

/* Makes the volume of one, of type float64, in the box of the options, unless
 * `out` is NULL; info->dims are those of the volume.  Numbers may be written as
 * by C or Fortran (1.5D+03, 1.5-103).  Errors: SNOW_STATUS_BAD_INPUT (fewer, a
 * word that is none), SNOW_STATUS_BAD_USAGE, SNOW_STATUS_NO_MEMORY. */
snow_status snow_read_grid(snow_source *source, const snow_text_grid *grid,
                           const snow_volume_options *options,
                           snow_volume_info *info, snow_volume **out);

/* Numbers of a text between blanks and the letters `between`: how many there
 * are, or -1 if something else is there, or more than `most`. */
int snow_text_reals(const char *text, const char *between, double *out,
                    int most);
int snow_text_integers(const char *text, const char *between, int64_t *out,
                       int most);

#endif
