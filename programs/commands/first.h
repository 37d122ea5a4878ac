/* first.h - what a picture is where nothing was asked for that decides it.  The
 * library says which mode suits a file. */
#ifndef COMMANDS_FIRST_H
#define COMMANDS_FIRST_H

#include "options/options.h"

/* Takes the mode of a first picture, unless options decide it, and the range of
 * a channel of light that is drawn alone. */
void first_take(options *opts, const snow_volume_info *info);

/* A folder of slices whose picture is to be made, which is read at once: it
 * would be listed twice.  Who takes the volume takes its context. */
typedef struct first_volume {
    snow_context *context;
    snow_volume *volume;
    double seconds; /* of reading */
} first_volume;
void first_volume_free(first_volume *first);

/* The same of the input, or of the first of its time steps.  What is wrong with
 * it is said where it is read. */
void first_settle(options *opts);

#endif
