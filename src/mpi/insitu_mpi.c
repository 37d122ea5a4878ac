/* mpi/insitu_mpi.c - pictures of a running simulation over a communicator of
 * MPI: a few calls of snowglass/insitu.h in one. */
#include <snowglass/mpi.h>

/* All ranks of the group succeed, or none. */
static int all_are(MPI_Comm group, int mine) {
    int all = 0;
    return MPI_Allreduce(&mine, &all, 1, MPI_INT, MPI_MIN, group) ==
               MPI_SUCCESS &&
           all;
}

snow_status snow_insitu_new_mpi(snow_context *context, MPI_Comm group,
                                snow_insitu **out) {
    snow_context *own = NULL;
    snow_comm *comm = NULL;
    snow_insitu *insitu = NULL;
    if (!context)
        snow_context_new(NULL, &own);
    if (!all_are(group, context || own)) {
        snow_context_free(own);
        return SNOW_NO_MEMORY;
    }
    snow_status status = snow_comm_mpi(own ? own : context, group, &comm);
    if (status == SNOW_OK)
        status = snow_insitu_new(comm, &insitu);
    if (status != SNOW_OK) {
        snow_comm_free(comm);
        snow_context_free(own);
        return status;
    }
    snow_insitu_adopt_comm(insitu, own != NULL);
    *out = insitu;
    return SNOW_OK;
}

snow_status snow_insitu_new_fortran(MPI_Fint group, snow_insitu **out) {
    return snow_insitu_new_mpi(NULL, MPI_Comm_f2c(group), out);
}
