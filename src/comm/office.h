/* comm/office.h - a post office: messages between ranks of one process.
 *
 * Every rank has a box for copies of what is sent to it.  A send is done when
 * it is asked for, though the copy would allow it to be at once: what works
 * here then works with any MPI.  For comm/ alone. */
#ifndef SNOW_OFFICE_H
#define SNOW_OFFICE_H

#include "comm/comm.h"

typedef struct snow_office snow_office;

/* An office of `ranks` boxes.  Letters are memory of `context`, whatever the
 * thread.  Errors: SNOW_NO_MEMORY.  Freed after its communicators. */
snow_status snow_office_new(snow_context *context, int ranks,
                            snow_office **out);
void snow_office_free(snow_office *office);

/* A rank's communicator, for the thread that `context` belongs to.  Where it
 * `owns` the office, that is freed with it. */
snow_status snow_office_comm(snow_office *office, snow_context *context,
                             int rank, bool owns, snow_comm **out);

/* Says that a rank will send nothing more.  Who waits for it fails, unless the
 * letter is there already. */
void snow_office_leave(snow_office *office, int rank);

/* How many had left before a rank that has left. */
int snow_office_left_before(const snow_office *office, int rank);

#endif
