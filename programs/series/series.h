/* series.h - one step of a series, for verbs that show one: of numbered files,
 * or of the steps of a file by their physical time. */
#ifndef SERIES_H
#define SERIES_H

#include "options/options.h"

/* Replaces the pattern of an input by the file of the step that --time names,
 * and a physical time by the number of the nearest step.  A pattern of slices
 * stays, as the library reads it as a volume; those of the verb movie stay too.
 * Returns CONTINUE or an exit code. */
int series_take(options *opts, const verb_row *verb);

#endif
