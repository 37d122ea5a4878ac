/* mixed.h - the channels of a file that a drawing shows together. */
#ifndef MIXED_H
#define MIXED_H

#include "draw/drawing.h"

/* How many volumes are drawn, the number of the first channel, and the n-th
 * volume. */
int mixed_count(const drawing *d);
int64_t mixed_first(const drawing *d);
snow_volume **mixed_volume(drawing *d, int n);

/* Takes the channels that the options choose of those that are in memory.
 * *anew: another one is needed, and all are to be opened.  *other: they are not
 * those before. */
int mixed_follow(drawing *d, bool *anew, bool *other);

/* Notes what was opened; forgets what was put away. */
int mixed_note(drawing *d);
void mixed_forget(drawing *d);

/* The look of each anew, of which there are some. */
int mixed_restyle(drawing *d);

/* The numbers of what is meant. */
json_t *mixed_tree(const drawing *d);

/* Names in the options the one channel to which the others gave way. */
void mixed_settle(const drawing *d, options *opts);

/* The list of a slice: with the ranges that are drawn; false: one alone is
 * drawn. */
bool mixed_text(const drawing *d, char *out, size_t size);

#endif
