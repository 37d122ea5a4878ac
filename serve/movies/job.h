/* job.h - a movie that the viewer writes: one at a time, by the tool's own
 * command, in a private folder, until pages have fetched it.  Another one takes
 * its place only where that is ordered.
 *
 *   none -> writing -> done | failed | cancelled -> writing ...
 *
 * Pages hear of each change and each second, and so do those that come later:
 *
 *   {"t": "movie", "state": "writing", "name": "head.mp4", "tag": "k3f9",
 *    "frame": 12, "frames": 120, "text": "reading"}
 *   {"t": "movie", "state": "done", ..., "bytes": 123456}
 *
 * Nothing is left when the program ends, or when no page has looked for some
 * seconds. */
#ifndef MOVIES_JOB_H
#define MOVIES_JOB_H

#include "movies/order.h"
#include "net/outbox.h"

#include <jansson.h>

#define JOB_ALONE_SECONDS 20

typedef struct movie_job movie_job;

/* NULL: no memory. */
movie_job *job_new(outbox *box);

/* Ends what is under way; the job stays for those who know it.  Both accept
 * NULL. */
void job_end(movie_job *j);
void job_free(movie_job *j);

/* What pages can order: {"formats": ["mp4", ...], "note": "..."}, of which the
 * note says what is missing, or is empty. */
json_t *job_offer(void);

/* Begins what a command writes into a file of that name, and takes the command
 * over.  What is wrong, or NULL. */
const char *job_begin(movie_job *j, char *command, const char *name,
                      const movie_order *order);

/* From any thread.  Ends the writing, or takes the movie away. */
void job_cancel(movie_job *j);

/* How many pages look. */
void job_note_pages(movie_job *j, int count);

/* Opens the movie that is done: its descriptor, or -1. */
int job_open(movie_job *j, char name[100]);

#endif
