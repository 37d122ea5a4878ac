/* comm/mailbox.h - mailboxes: messages between ranks of one process.
 *
 * Every rank has a queue for copies of messages sent to it. A send completes
 * only when it is asked for, though the copy would allow it at once: code that
 * works here then works with any MPI. For comm/ only. */
#ifndef SNOW_COMM_MAILBOX_H
#define SNOW_COMM_MAILBOX_H

#include "comm/comm.h"

typedef struct snow_mailbox snow_mailbox;

/* Mailboxes for `ranks` ranks. Messages are memory of `context`, on any thread.
 * Errors: SNOW_STATUS_NO_MEMORY. Free after its communicators. */
snow_status snow_mailbox_new(snow_context *context, int ranks,
                             snow_mailbox **out);
void snow_mailbox_free(snow_mailbox *mailbox);

/* A rank's communicator, for the thread that `context` belongs to. If it `owns`
 * the mailbox, that is freed with it. */
snow_status snow_mailbox_comm(snow_mailbox *mailbox, snow_context *context,
                              int rank, bool owns, snow_comm **out);

/* Declares that a rank will send nothing more. Waits for its messages fail,
 * unless they have arrived already. */
void snow_mailbox_leave(snow_mailbox *mailbox, int rank);

/* The number of ranks that left before a rank that has left. */
int snow_mailbox_left_before(const snow_mailbox *mailbox, int rank);

#endif
