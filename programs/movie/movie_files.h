/* movie_files.h - the files of time steps, and what a movie makes of them. */
#ifndef MOVIE_FILES_H
#define MOVIE_FILES_H

#include "movie/movie.h"

/* The files, in order: each operand is a file, or a pattern of numbered ones
 * (run_%04d.nrrd) or of any (run_*.nrrd), with a data set in them where they
 * have several (run_%04d.h5:/rho).  A number in the name of the data set is the
 * file's (data_%T.h5:/data/%T/rho). */
typedef struct step_files {
    char **paths;
    int64_t count, room;
    bool gaps;      /* numbers may be missing between others */
    int64_t *times; /* of each path a step in its file; NULL: 0 of all */
} step_files;

/* Whether a path is a pattern of files: it has a number or a star, and no file
 * has that name. */
bool files_are_meant(const char *path);

/* Finds the files.  A pattern stands for all existing files.  A missing number
 * between them is an error, except of %T and where each file holds a time of
 * its own, as is a missing file.  A name with * or ? that nothing has stands
 * for those that match, run_2 before run_10.  Returns CONTINUE or an exit code.
 */
int steps_find(const options *opts, step_files *out);
void steps_free(step_files *files);

/* Where files hold several steps, as the first or the last one does, each of
 * these becomes an entry.  Returns CONTINUE or an exit code. */
int steps_expand(const options *opts, step_files *files);

/* Makes one shot for each file.  Files give one shot for each time step in
 * them, unless --time selects one of each; they are then inspected.  Returns
 * CONTINUE or an exit code. */
int steps_list(step_files *files, shot_renderer *shots, shot_list *out);

/* Makes the transfer function from the values of all steps, if it depends on
 * values and there are several steps; otherwise the first step decides.  Reads
 * every step once; each of many ranks reads some of them.  Returns CONTINUE or
 * an exit code. */
int steps_look(const shot_list *list, shot_renderer *shots);

/* Says that there is no memory for a list of steps. */
int steps_fail_memory(void);

#endif
