/* paint.h - paints pictures of values (modes mean and sum) with colours, for
 * formats that hold only colours. */
#ifndef PAINT_H
#define PAINT_H

#include "options/options.h"

#include <snowglass/snowglass.h>

/* How a picture was painted. */
typedef struct paint_given {
    char words[96];
    double range[2]; /* range of values; both 0: not painted */
} paint_given;

/* Refuses what cannot be painted, before anything is read: a movie of sums
 * needs a given range, since each frame has another.  Returns CONTINUE or an
 * exit code. */
int paint_check(const options *opts, bool movie);

/* Sets the background of a file: the requested one; by default that of the mode
 * and the look (NULL: not known yet) in formats that show it, and none in files
 * of values. */
void paint_background(const options *opts, const snow_transfer *transfer,
                      snow_image_options *form);

/* Replaces a picture of values by one of colours, unless the output holds
 * values, and makes the lowest value transparent on no background. The look's
 * colours are spread over the requested range; otherwise, in a movie of means,
 * over the look's own, or over the values of the picture; a list of colours
 * stays at its values. `given` gets the range and the words that report it.
 * Returns CONTINUE or an exit code. */
int paint_values(const options *opts, snow_context *context,
                 const snow_transfer *transfer, bool movie, snow_image **image,
                 paint_given *given);

/* Makes the picture of colours of one of values, which stays.  Returns CONTINUE
 * or an exit code. */
int paint_copy(const options *opts, snow_context *context,
               const snow_transfer *transfer, bool movie,
               const snow_image *image, snow_image **out, paint_given *given);

#endif
