/* mpi_comm - the messages and collective calls of test_comm, over MPI; run
 * under mpirun by mpi_comm.sh.  Exit status 1 and a line where one fails. */
#define _XOPEN_SOURCE 700 /* kill */
#include "support/comm.h"

#include <signal.h>
#include <snowglass/extend.h>
#include <snowglass/mpi.h>

static int run_bodies(snow_comm *comm) {
    for (const comm_body *b = comm_bodies; b->body; b++)
        if (b->body(comm, NULL) != SNOW_STATUS_OK) {
            fprintf(stderr, "mpi_comm: rank %d: %s: %s\n", snow_comm_rank(comm),
                    b->name, snow_context_message(snow_comm_context(comm)));
            return 1;
        }
    return 0;
}

static int complain(const char *what) {
    fprintf(stderr, "mpi_comm: %s\n", what);
    return 1;
}

/* All ranks have rank 0's sum. */
static int compare_sums(snow_comm *comm) {
    rank_sums sums;
    const int rank = snow_comm_rank(comm);
    if (reduce_doubles(comm, &sums) != SNOW_STATUS_OK)
        return complain("reduce_doubles");
    double first = sums.sums[rank];
    return snow_comm_broadcast(comm, &first, sizeof first, 0) !=
                       SNOW_STATUS_OK ||
                   memcmp(&first, &sums.sums[rank], sizeof first)
               ? complain("sums have other bits on other ranks")
               : 0;
}

/* A failure is everybody's; and the group lives on. */
static int agree(snow_comm *comm) {
    const int last = snow_comm_size(comm) - 1;
    snow_context *context = snow_comm_context(comm);
    snow_status status = SNOW_STATUS_OK;
    char text[64];
    snprintf(text, sizeof text, "rank %d: it is so", last);
    if (snow_comm_rank(comm) == last)
        status = snow_fail(context, SNOW_STATUS_BAD_INPUT, "it is so");
    if (snow_comm_agree_status(comm, status) != SNOW_STATUS_BAD_INPUT ||
        strcmp(snow_context_message(context), last ? text : text + 8))
        return complain(snow_context_message(context));
    return snow_comm_agree_status(comm, SNOW_STATUS_OK) == SNOW_STATUS_OK
               ? 0
               : complain("no peace");
}

/* Half of the ranks, in reverse order, by the handle that Fortran has: a group
 * that is not the world's.  The others stay out of it. */
static int run_half(snow_context *context) {
    int rank, ranks, wrong = 0;
    MPI_Comm half;
    snow_comm *comm;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    MPI_Comm_split(MPI_COMM_WORLD, rank % 2 ? 0 : MPI_UNDEFINED, -rank, &half);
    if (half == MPI_COMM_NULL)
        return 0;
    if (snow_comm_new_mpi_fortran(context, MPI_Comm_c2f(half), &comm) !=
        SNOW_STATUS_OK)
        return complain(snow_context_message(context));
    wrong = snow_comm_size(comm) != ranks / 2 ||
            snow_comm_rank(comm) != (ranks - 1 - rank) / 2;
    if (wrong)
        complain("another order of ranks");
    wrong |= run_bodies(comm);
    snow_comm_free(comm);
    MPI_Comm_free(&half);
    return wrong;
}

/* A message too long for its room breaks the receiver's side, with a message;
 * rank 1 sends it, and rank 0 has the room. */
static int send_too_much(snow_context *context) {
    snow_comm *comm;
    char bytes[20] = {0};
    snow_message message = {0};
    int ranks, wrong = 0;
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    if (ranks == 1)
        return 0;
    if (snow_comm_new_mpi(context, MPI_COMM_WORLD, &comm) != SNOW_STATUS_OK)
        return complain(snow_context_message(context));
    if (snow_comm_rank(comm) == 0)
        wrong =
            snow_comm_receive(comm, bytes, 9, 1, 1, &message) !=
                SNOW_STATUS_OK ||
            snow_comm_wait_all(comm, &message, 1) != SNOW_STATUS_FAILED ||
            !strstr(snow_context_message(context), "exceeds its buffer") ||
            !snow_comm_broken(comm) ||
            snow_comm_agree_status(comm, SNOW_STATUS_OK) != SNOW_STATUS_FAILED;
    if (snow_comm_rank(comm) == 1)
        wrong =
            snow_comm_send(comm, bytes, 10, 0, 1, &message) != SNOW_STATUS_OK ||
            snow_comm_wait_all(comm, &message, 1) != SNOW_STATUS_OK;
    MPI_Barrier(MPI_COMM_WORLD);
    snow_comm_free(comm);
    return wrong ? complain("a message that is too long") : 0;
}

/* More bytes than MPI counts to in an int, to oneself; asked for by "large". */
static int send_large(snow_comm *comm) {
    const size_t bytes = ((size_t)1 << 31) + 12345;
    snow_context *context = snow_comm_context(comm);
    unsigned char *out = snow_allocate_clear(context, bytes);
    unsigned char *in = snow_allocate_clear(context, bytes + 1);
    if (!out || !in)
        return complain("no memory");
    memset(out + bytes - 12346, 7, 12346);
    snow_message messages[2] = {{0}};
    snow_status status =
        snow_comm_receive(comm, in, bytes + 1, 0, 1, &messages[0]);
    if (status == SNOW_STATUS_OK)
        status = snow_comm_send(comm, out, bytes, 0, 1, &messages[1]);
    if (status == SNOW_STATUS_OK)
        status = snow_comm_wait_all(comm, messages, 2);
    int wrong = status != SNOW_STATUS_OK || messages[0].bytes != bytes ||
                memcmp(in, out, bytes) || in[bytes];
    snow_release(context, in);
    snow_release(context, out);
    return wrong ? complain("a large message") : 0;
}

/* The last rank is stopped, and the others, of which rank 0 waits for one, work
 * on and answer nothing; asked for by "stopped".  Rank 0 prints whom it holds
 * for the reason, and ends all. */
static int wait_beside_stopped(snow_comm *comm) {
    char byte;
    snow_message message = {0};
    if (snow_comm_rank(comm) == snow_comm_size(comm) - 1)
        raise(SIGSTOP);
    while (snow_comm_rank(comm) != 0)
        continue;
    snow_comm_set_timeout(comm, 4); /* the last one stops before */
    if (snow_comm_receive(comm, &byte, 1, 1, 1, &message) != SNOW_STATUS_OK ||
        snow_comm_wait_all(comm, &message, 1) == SNOW_STATUS_OK)
        return complain("a message that nobody sent");
    return complain(snow_context_message(snow_comm_context(comm)));
}

static int refuse(snow_context *context) {
    snow_comm *comm = NULL;
    return snow_comm_new_mpi(context, MPI_COMM_NULL, &comm) ==
                       SNOW_STATUS_BAD_USAGE &&
                   !comm
               ? 0
               : complain("MPI_COMM_NULL is taken");
}

int main(int argc, char **argv) {
    int level, wrong;
    snow_context *context;
    snow_comm *comm = NULL;
    if (snow_context_new(NULL, &context) != SNOW_STATUS_OK)
        return complain("no context");
    if (snow_comm_new_mpi(context, MPI_COMM_WORLD, &comm) !=
        SNOW_STATUS_BAD_USAGE)
        return complain("MPI is not running, and that was not seen");
    MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);
    /* Whom MPICH asks about errors of waits. */
    MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
    if (snow_comm_new_mpi(context, MPI_COMM_WORLD, &comm) != SNOW_STATUS_OK)
        return complain(snow_context_message(context));
    if (argc > 1)
        wrong = strcmp(argv[1], "stopped") == 0 ? wait_beside_stopped(comm)
                                                : send_large(comm);
    else
        wrong = run_bodies(comm) || compare_sums(comm) || agree(comm) ||
                run_half(context) || send_too_much(context) || refuse(context);
    snow_comm_free(comm);
    if (snow_context_bytes(context))
        wrong = complain("memory is kept");
    snow_context_free(context);
    if (wrong)
        MPI_Abort(MPI_COMM_WORLD, 1);
    return MPI_Finalize() != MPI_SUCCESS;
}
