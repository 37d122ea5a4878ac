/* mpi/messages.h - the messages of one rank, by MPI's requests. */
#ifndef SNOW_MPI_MESSAGES_H
#define SNOW_MPI_MESSAGES_H

#include <snowglass/extend.h>
#include <snowglass/mpi.h>

#include "mpi/node.h"
#include "mpi/watchdog.h"

typedef struct mpi_slot {
    MPI_Request request; /* MPI_REQUEST_NULL: the slot is spare */
    bool receives, large;
    int peer;
} mpi_slot;

/* The side of one rank. */
typedef struct mpi_side {
    snow_context *context;
    MPI_Comm group; /* a duplicate of the caller's */
    bool failed;    /* MPI's state is unknown: it is not used any more */
    mpi_slot *slots;
    int slot_count;
    /* These are the requests of the last wait. */
    MPI_Request *requests;
    int *places;    /* indices of the requests among the messages */
    int *peers;     /* of the requests */
    mpi_node *node; /* what the ranks of this node share, or NULL: nothing */
    snow_idle_fn *meanwhile; /* other work done in waits, or NULL */
    void *meanwhile_user;
    mpi_watchdog *watchdog;
} mpi_side;

/* What a communicator does by MPI. */
extern const snow_comm_ops snow_mpi_ops;

/* Reports the MPI error of a call that concerns `peer` (-1: no particular
 * rank). */
snow_status snow_mpi_fail(snow_context *context, int error, const char *what,
                          int peer);

#endif
