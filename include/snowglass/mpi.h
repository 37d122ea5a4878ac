/* snowglass/mpi.h - communicators of MPI processes, and pictures over them.
 *
 * A library of its own, libsnowglass-mpi (pkg-config: snowglass-mpi), for one
 * MPI. It neither starts nor ends MPI; MPI_THREAD_FUNNELED is enough. Some
 * errors of MPI go to the caller's error handler (MPICH, in waits). */
#ifndef SNOWGLASS_MPI_H
#define SNOWGLASS_MPI_H

#include <mpi.h>
#include <snowglass/insitu.h>

/* Collective over `group`, an intracommunicator: makes a communicator of the
 * same ranks, over a duplicate of it. All ranks succeed, or none. Free it,
 * which is collective, before MPI_Finalize. Errors: BAD_USAGE (MPI is not
 * running, no such group), FAILED (of MPI). */
SNOW_API snow_status snow_comm_new_mpi(
    snow_context *context, MPI_Comm group, snow_comm **out);

/* The same for a communicator of Fortran: comm%MPI_VAL, or the integer of the
 * module mpi. */
SNOW_API snow_status snow_comm_new_mpi_fortran(
    snow_context *context, MPI_Fint group, snow_comm **out);

/* Collective over `group`: makes the pictures of a running simulation, over
 * such a communicator, which is freed with them (snow_insitu_free, collective,
 * before MPI_Finalize). Where `context` is NULL they have one of their own.
 * Errors: as above; the message is in the context. */
SNOW_API snow_status snow_insitu_new_mpi(
    snow_context *context, MPI_Comm group, snow_insitu **out);

/* The same for a communicator of Fortran, with a context of their own. */
SNOW_API snow_status snow_insitu_new_mpi_fortran(
    MPI_Fint group, snow_insitu **out);

#endif
