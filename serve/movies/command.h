/* command.h - the command of the tool that makes a movie of a drawing. */
#ifndef MOVIES_COMMAND_H
#define MOVIES_COMMAND_H

#include "draw/drawing.h"
#include "movies/order.h"

/* The command that makes what is ordered of the present recipe, to be freed,
 * and the file that it writes; NULL: no memory. */
char *movie_command(const drawing *d, const movie_order *order,
                    char output[100]);

#endif
