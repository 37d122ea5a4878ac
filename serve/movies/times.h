/* times.h - the times of a file's steps, as texts for people: "12 h", or dates.
 */
#ifndef MOVIES_TIMES_H
#define MOVIES_TIMES_H

#include "draw/drawing.h"

/* Of more steps the page shows numbers alone. */
#define TIMES_MOST 4096

/* Reads some headers more, of some milliseconds, and returns VALUES_MORE until
 * all are known; then CONTINUE, and *out is a list of texts that stays the
 * drawing's: empty where the file has no times. */
int times_read(drawing *d, json_t **out);

#endif
