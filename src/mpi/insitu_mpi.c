/* mpi/insitu_mpi.c - pictures of a running simulation over an MPI communicator:
 * combines a few calls of snowglass/insitu.h. */
#include <snowglass/mpi.h>

snow_status snow_insitu_new_mpi(snow_context *context, MPI_Comm group,
                                snow_insitu **out) {
    snow_context *own = NULL;
    snow_comm *comm = NULL;
    snow_insitu *insitu = NULL;
    if (!context)
        snow_context_new(NULL, &own);
    const int mine = context || own;
    int all = 0; /* 1 where all ranks succeeded */
    if (MPI_Allreduce(&mine, &all, 1, MPI_INT, MPI_MIN, group) != MPI_SUCCESS ||
        !all) {
        snow_context_free(own);
        return SNOW_STATUS_NO_MEMORY;
    }
    snow_status status = snow_comm_new_mpi(own ? own : context, group, &comm);
    if (status == SNOW_STATUS_OK)
        status = snow_insitu_new(comm, &insitu);
    if (status != SNOW_STATUS_OK) {
        snow_comm_free(comm);
        snow_context_free(own);
        return status;
    }
    snow_insitu_own_comm(insitu, own != NULL);
    *out = insitu;
    return SNOW_STATUS_OK;
}

snow_status snow_insitu_new_mpi_fortran(MPI_Fint group, snow_insitu **out) {
    return snow_insitu_new_mpi(NULL, MPI_Comm_f2c(group), out);
}
