/* comm/thread_memory.h - memory of a rank that is a thread, which the others
 * read in place: four functions of its transport. For comm/ only. */
#ifndef SNOW_COMM_THREAD_MEMORY_H
#define SNOW_COMM_THREAD_MEMORY_H

#include "comm/comm.h"

/* The first member of a rank's record, the `self` of the functions. */
typedef struct snow_thread_memory {
    snow_context *owner;   /* of the blocks, on any thread */
    snow_context *context; /* of the rank, for messages */
    pthread_mutex_t *lock; /* of the table */
    void **blocks;         /* of all ranks, or NULL */
    int rank;
} snow_thread_memory;

/* They are those of snow_comm_ops. */
int snow_thread_memory_node(void *self, int rank);
snow_status snow_thread_memory_share(void *self, size_t bytes, void **own);
const void *snow_thread_memory_shared(void *self, int rank);
void snow_thread_memory_unshare(void *self);

/* Releases the rank's block. */
void snow_thread_memory_end(void *self);

#endif
