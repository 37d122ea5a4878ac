/* movie_steps.h - the time steps of a movie, from its operands, and one
 * transfer function for all of them. */
#ifndef MOVIE_STEPS_H
#define MOVIE_STEPS_H

#include "movie/movie_files.h"
#include "movie/movie_render.h"

/* Makes one shot for each file.  A single file gives one shot for each time
 * step in it, unless --time selects one; the file is then inspected.  Returns
 * CONTINUE or an exit code. */
int steps_list(const step_files *files, shot_renderer *shots, shot_list *out);

/* Makes the transfer function from the values of all steps, if it depends on
 * values and there are several steps; otherwise the first step decides.  Reads
 * every step once; each of many ranks reads some of them.  Returns CONTINUE or
 * an exit code. */
int steps_look(const shot_list *list, shot_renderer *shots);

#endif
