/* mpi/node.h - memory that the ranks of a node share: a window of MPI-3. */
#ifndef SNOW_MPI_NODE_H
#define SNOW_MPI_NODE_H

#include <snowglass/extend.h>

#include <mpi.h>

typedef struct mpi_node mpi_node;

/* Collective. Finds out which ranks of a group share memory. NULL: none; also
 * if MPI cannot tell. Errors, alike on all ranks: SNOW_STATUS_NO_MEMORY. */
snow_status snow_mpi_node_new(snow_context *context, MPI_Comm group,
                              mpi_node **out);

/* Collective if it is orderly. */
void snow_mpi_node_free(mpi_node *node, bool orderly);

/* They are those of snow_comm_ops. */
int snow_mpi_node_of(void *self, int rank);
snow_status snow_mpi_share(void *self, size_t bytes, void **own);
const void *snow_mpi_shared(void *self, int rank);
void snow_mpi_unshare(void *self);

/* What was written to the window before a message, is there for who has
 * received it: called before a send and after a receive. */
void snow_mpi_node_sync(const mpi_node *node);

#endif
