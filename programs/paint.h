/* paint.h - pictures of values (modes mean and sum) as colours, for files that
 * hold nothing else. */
#ifndef PAINT_H
#define PAINT_H

#include "options.h"

#include <snowglass/snowglass.h>

/* What was painted. */
typedef struct paint_told {
    char words[96];
    double range[2]; /* of values; both 0: nothing was */
} paint_told;

/* Refuses what cannot be painted, before anything is read: a movie of sums must
 * tell its range, for each frame has another.  Answers GO_ON or an exit code.
 */
int paint_check(const options *asked, bool movie);

/* Replaces a picture of values by one of colours, unless the output keeps
 * values.  The look's colours are spread over the range that was asked for, of
 * a movie of means over the look's own, else over what the picture holds;
 * `told` gets the range, and the words that say so.  Answers GO_ON or an exit
 * code. */
int paint_values(const options *asked, snow_context *context,
                 const snow_transfer *transfer, bool movie, snow_image **image,
                 paint_told *told);

#endif
