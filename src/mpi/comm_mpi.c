/* mpi/comm_mpi.c - makes communicators of MPI's groups.
 *
 * The files of this folder use public headers only. */
#include "mpi/messages.h"

static snow_status check_group(snow_context *context, MPI_Comm group) {
    int initialized = 0, finalized = 0, between = 0;
    MPI_Initialized(&initialized);
    MPI_Finalized(&finalized);
    if (!initialized || finalized)
        return snow_context_fail(context, SNOW_STATUS_BAD_USAGE,
                                 "MPI is not running: create communicators "
                                 "between MPI_Init and MPI_Finalize");
    if (group == MPI_COMM_NULL)
        return snow_context_fail(context, SNOW_STATUS_BAD_USAGE,
                                 "MPI_COMM_NULL is not a group: give the "
                                 "communicator of the rendering ranks");
    int error = MPI_Comm_test_inter(group, &between);
    if (error != MPI_SUCCESS)
        return snow_mpi_fail(context, error, "query the group", -1);
    if (between)
        return snow_context_fail(context, SNOW_STATUS_BAD_USAGE,
                                 "an intercommunicator is not a single group: "
                                 "merge it with MPI_Intercomm_merge");
    return SNOW_STATUS_OK;
}

static void warn_threads(snow_context *context) {
    int level = MPI_THREAD_SINGLE;
    MPI_Query_thread(&level);
    if (level < MPI_THREAD_FUNNELED)
        snow_context_warn(context, "this MPI was started without support "
                                   "for threads; if it misbehaves, start it "
                                   "with MPI_Init_thread and "
                                   "MPI_THREAD_FUNNELED");
}

/* This rank's objects over `ours`. */
static snow_status make_communicator(snow_context *context, MPI_Comm ours,
                                     mpi_side **out_side, snow_comm **out) {
    int rank = 0, ranks = 1;
    MPI_Comm_rank(ours, &rank);
    MPI_Comm_size(ours, &ranks);
    mpi_side *side = snow_context_allocate(context, sizeof *side);
    if (!side)
        return SNOW_STATUS_NO_MEMORY;
    *side = (mpi_side){.context = context, .group = ours};
    snow_status status =
        snow_comm_new(context, &snow_mpi_ops, side, rank, ranks, out);
    if (status != SNOW_STATUS_OK)
        snow_context_release(context, side);
    else
        *out_side = side;
    return status;
}

/* Agrees on the status, so that no rank continues without the others. */
static snow_status agree(snow_context *context, MPI_Comm ours,
                         snow_status status) {
    int worst = (int)status;
    int error = MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_INT, MPI_MAX, ours);
    if (error != MPI_SUCCESS)
        return snow_mpi_fail(context, error, "agree on a new communicator", -1);
    if (status == SNOW_STATUS_OK && worst != SNOW_STATUS_OK)
        return snow_context_fail(context, (snow_status)worst,
                                 "another rank: %s",
                                 snow_status_description((snow_status)worst));
    return (snow_status)worst;
}

snow_status snow_comm_new_mpi(snow_context *context, MPI_Comm group,
                              snow_comm **out) {
    MPI_Comm ours;
    mpi_side *side = NULL;
    snow_comm *comm = NULL;
    snow_status status = check_group(context, group);
    if (status != SNOW_STATUS_OK)
        return status;
    /* A duplicate separates our messages from the caller's. */
    int error = MPI_Comm_dup(group, &ours);
    if (error != MPI_SUCCESS)
        return snow_mpi_fail(context, error, "duplicate the group", -1);
    MPI_Comm_set_errhandler(ours, MPI_ERRORS_RETURN);
    status =
        agree(context, ours, make_communicator(context, ours, &side, &comm));
    if (status == SNOW_STATUS_OK)
        status = agree(context, ours,
                       snow_watchdog_new(context, ours, &side->watchdog));
    if (status == SNOW_STATUS_OK)
        status = snow_mpi_node_new(context, ours, &side->node);
    if (status != SNOW_STATUS_OK) {
        if (comm)
            snow_comm_free(comm); /* frees the duplicate too */
        else
            MPI_Comm_free(&ours);
        return status;
    }
    warn_threads(context);
    *out = comm;
    return SNOW_STATUS_OK;
}

snow_status snow_comm_new_mpi_fortran(snow_context *context, MPI_Fint group,
                                      snow_comm **out) {
    return snow_comm_new_mpi(context, MPI_Comm_f2c(group), out);
}
