/* snowglass/mpi.h - communicators of MPI processes, and pictures over them.
 *
 * A library of its own, libsnowglass-mpi (pkg-config: snowglass-mpi), built
 * for one MPI; the caller's program is built with the same one.  It neither
 * starts nor ends MPI, and ends no process.  Threads that render make no MPI
 * calls: MPI_THREAD_FUNNELED is enough. */
#ifndef SNOWGLASS_MPI_H
#define SNOWGLASS_MPI_H

#include <mpi.h>
#include <snowglass/insitu.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Collective over `group`, an intracommunicator: a communicator of the same
 * ranks over a duplicate of it, so that messages never meet the caller's.  All
 * ranks succeed, or none.  Free it (collective) before MPI_Finalize.  Errors:
 * SNOW_STATUS_BAD_USAGE (MPI is not running, no such group),
 * SNOW_STATUS_NO_MEMORY, SNOW_STATUS_FAILED (of MPI).
 *
 * Errors of MPI come back as SNOW_STATUS_FAILED where it tells them to the
 * communicator that they happen on; some (MPICH, in waits) tell
 * MPI_COMM_WORLD's error handler, which is the caller's business. */
SNOW_API snow_status snow_comm_new_mpi(snow_context *context, MPI_Comm group,
                                       snow_comm **out);

/* The same for a communicator's handle in Fortran: comm%MPI_VAL, or the integer
 * of the module mpi. */
SNOW_API snow_status snow_comm_new_mpi_fortran(snow_context *context,
                                               MPI_Fint group, snow_comm **out);

/* Collective over `group`: pictures of a running simulation over such a
 * communicator, which goes with them (snow_insitu_free is collective, and comes
 * before MPI_Finalize).  `context` NULL: a context of their own.  Errors: as
 * snow_comm_new_mpi; the message is in the context. */
SNOW_API snow_status snow_insitu_new_mpi(snow_context *context, MPI_Comm group,
                                         snow_insitu **out);

/* The same for a communicator's handle in Fortran, with a context of their own.
 */
SNOW_API snow_status snow_insitu_new_mpi_fortran(MPI_Fint group,
                                                 snow_insitu **out);

#ifdef __cplusplus
}
#endif
#endif
