/* mpi/node.c - the window of the ranks of a node.
 *
 * A window is an open file in memory, in /dev/shm, which some systems make
 * small: containers often have 64 MB. Only pages that are written need room,
 * but a page for which there is none ends the program. So a window is made only
 * if another one of its size would fit beside it: MPI's messages, and other
 * jobs, have theirs there. */
#define _DEFAULT_SOURCE /* madvise */
#include "mpi/messages.h"

#include <sched.h>
#include <stdint.h>
#include <sys/mman.h>
#include <sys/statvfs.h>
#include <unistd.h>

/* A rank whose neighbours do not end with it leaves the window to the system
 * after so long. */
#define END_SECONDS 5

struct mpi_node {
    snow_context *context;
    MPI_Comm group; /* the ranks of the node */
    int members;
    int *numbers; /* of all ranks: the number of the node, the place in it */
    MPI_Win window;
    void *own; /* this rank's part, of so many bytes */
    size_t bytes;
};

/* --- which ranks ---------------------------------------------------------- */

/* A node's number is its first rank. */
static int number_nodes(mpi_node *node, MPI_Comm group, int rank) {
    int mine[2] = {rank, 0};
    MPI_Comm_rank(node->group, &mine[1]);
    MPI_Comm_size(node->group, &node->members);
    const int sent = MPI_Bcast(mine, 1, MPI_INT, 0, node->group);
    const int gathered =
        MPI_Allgather(mine, 2, MPI_INT, node->numbers, 2, MPI_INT, group);
    return sent == MPI_SUCCESS ? gathered : sent;
}

/* The smallest of the numbers of a group's ranks. */
static int least_of(MPI_Comm group, int mine) {
    int least = 0;
    return MPI_Allreduce(&mine, &least, 1, MPI_INT, MPI_MIN, group) ==
                   MPI_SUCCESS
               ? least
               : 0;
}

/* All ranks make the same calls, whichever fail. */
static bool find_members(mpi_node *node, MPI_Comm group) {
    int rank = 0;
    MPI_Comm_rank(group, &rank);
    int error = MPI_Comm_split_type(group, MPI_COMM_TYPE_SHARED, rank,
                                    MPI_INFO_NULL, &node->group);
    if (!least_of(group, error == MPI_SUCCESS))
        return false;
    MPI_Comm_set_errhandler(node->group, MPI_ERRORS_RETURN);
    return least_of(group, number_nodes(node, group, rank) == MPI_SUCCESS);
}

snow_status snow_mpi_node_new(snow_context *context, MPI_Comm group,
                              mpi_node **out) {
    int ranks = 1;
    MPI_Comm_size(group, &ranks);
    mpi_node *node = snow_context_allocate(context, sizeof *node);
    int *numbers = snow_context_allocate(context, 2 * (size_t)ranks *
                                                      sizeof *node->numbers);
    if (node)
        *node = (mpi_node){.context = context,
                           .group = MPI_COMM_NULL,
                           .numbers = numbers,
                           .window = MPI_WIN_NULL};
    *out = NULL;
    const bool has = node && numbers, all = least_of(group, has);
    if (all && find_members(node, group)) {
        *out = node;
        return SNOW_STATUS_OK;
    }
    snow_context_release(context, numbers);
    snow_context_release(context, node);
    if (has && !all)
        return snow_context_fail(
            context, SNOW_STATUS_NO_MEMORY, "another rank: %s",
            snow_status_description(SNOW_STATUS_NO_MEMORY));
    return all ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
}

static void free_window(mpi_node *node) {
    if (node->window == MPI_WIN_NULL)
        return;
    MPI_Win_unlock_all(node->window);
    MPI_Win_free(&node->window);
}

/* Returns whether the other ranks of the node come to their end as well,
 * soon. */
static bool all_end(const mpi_node *node) {
    const double begin = MPI_Wtime();
    MPI_Request request;
    int done = 0;
    if (MPI_Ibarrier(node->group, &request) != MPI_SUCCESS)
        return false;
    while (!done && MPI_Wtime() - begin < END_SECONDS)
        if (MPI_Test(&request, &done, MPI_STATUS_IGNORE) != MPI_SUCCESS)
            return false;
        else if (!done)
            sched_yield();
    return done;
}

void snow_mpi_node_free(mpi_node *node, bool orderly) {
    if (!node)
        return;
    if (orderly && (node->window == MPI_WIN_NULL || all_end(node))) {
        free_window(node);
        MPI_Comm_free(&node->group);
    }
    snow_context_release(node->context, node->numbers);
    snow_context_release(node->context, node);
}

static mpi_node *node_of(void *self) {
    return ((mpi_side *)self)->node;
}

int snow_mpi_node_of(void *self, int rank) {
    const mpi_node *node = node_of(self);
    return node ? node->numbers[2 * rank] : rank;
}

/* --- the window ----------------------------------------------------------- */

/* NULL, on all ranks of a node: it has too little room. */
static void *make_window(mpi_node *node, size_t bytes) {
    void *own = NULL;
    free_window(node);
    if (node->members < 2)
        return NULL;
    /* The windows of all members fit twice. */
    struct statvfs scratch;
    const bool fits = statvfs("/dev/shm", &scratch) == 0 && scratch.f_frsize &&
                      bytes / scratch.f_frsize <
                          scratch.f_bavail / 2 / (unsigned)node->members;
    if (!least_of(node->group, fits))
        return NULL;
    const bool made =
        MPI_Win_allocate_shared((MPI_Aint)bytes, 1, MPI_INFO_NULL, node->group,
                                &own, &node->window) == MPI_SUCCESS &&
        MPI_Win_lock_all(MPI_MODE_NOCHECK, node->window) == MPI_SUCCESS;
    if (!least_of(node->group, made)) {
        node->window = MPI_WIN_NULL;
        return NULL;
    }
    MPI_Win_set_errhandler(node->window, MPI_ERRORS_RETURN);
    node->own = own;
    node->bytes = bytes;
    return own;
}

snow_status snow_mpi_share(void *self, size_t bytes, void **own) {
    mpi_node *node = node_of(self);
    *own = node ? make_window(node, bytes) : NULL;
    return SNOW_STATUS_OK;
}

const void *snow_mpi_shared(void *self, int rank) {
    const mpi_node *node = node_of(self);
    MPI_Aint size = 0;
    int unit = 1;
    void *there = NULL;
    const bool found =
        node && node->window != MPI_WIN_NULL &&
        MPI_Win_shared_query(node->window, node->numbers[2 * rank + 1], &size,
                             &unit, (void *)&there) == MPI_SUCCESS;
    return found ? there : NULL;
}

/* The pages that are this rank's alone go back to the system; the next that
 * writes there gets others. */
void snow_mpi_unshare(void *self) {
    const mpi_node *node = node_of(self);
    if (!node || node->window == MPI_WIN_NULL)
        return;
    const uintptr_t page = (uintptr_t)sysconf(_SC_PAGESIZE),
                    own = (uintptr_t)node->own,
                    begin = (own + page - 1) / page * page,
                    end = (own + node->bytes) / page * page;
    if (begin < end)
        (void)madvise((void *)begin, end - begin, MADV_REMOVE);
}

void snow_mpi_node_sync(const mpi_node *node) {
    if (node && node->window != MPI_WIN_NULL)
        MPI_Win_sync(node->window);
}
