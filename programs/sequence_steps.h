/* sequence_steps.h - the time steps of a movie, from its operands, and the one
 * look for all of them. */
#ifndef SEQUENCE_STEPS_H
#define SEQUENCE_STEPS_H

#include "sequence_render.h"

/* The files that are meant, in order: each operand is a file, or a pattern of
 * numbered ones (run_%04d.nrrd). */
typedef struct step_files {
    char **paths;
    int64_t count, room;
} step_files;

/* Finds the files.  A pattern stands for all that there are, and a number that
 * is missing between them is an error, as is a file that is not there.  Answers
 * GO_ON or an exit code. */
int steps_find(const options *asked, step_files *out);
void steps_free(step_files *files);

/* One shot for each file; for a file that stands alone one for each time step
 * in it, unless --time picks one: then it is looked into.  Answers GO_ON or an
 * exit code. */
int steps_list(const step_files *files, shot_renderer *shots, shot_list *out);

/* Chooses the transfer function by the values of all steps, where it depends on
 * values at all and there are several steps; else leaves it to the first one.
 * Reads every step once; of many ranks each reads some of them, whole.  Answers
 * GO_ON or an exit code. */
int steps_look(const shot_list *list, shot_renderer *shots);

#endif
