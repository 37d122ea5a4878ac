/* launch.h - who runs the tool: one process, or many ranks of which the first
 * writes and talks.
 *
 * The program's main function tells it once (main_alone.c, mpi_main.c); all
 * else asks here, and would run with ranks of any other kind as well.
 *
 * Ranks read one command line.  What each finds out for itself (a file that it
 * cannot read, memory that it lacks) is agreed on before they go on together:
 * who waits for a rank that has given up, waits for ever. */
#ifndef LAUNCH_H
#define LAUNCH_H

#include <snowglass/comm.h>

typedef struct launch {
    snow_comm *comm; /* of all ranks; NULL: this process is alone */
    int threads;     /* for a rank that is not told how many; 0: all */
    const char *mpi; /* the MPI library and its version, NULL: none */
} launch;

/* The tool: a command line to an exit code, the same on all ranks. */
int tool_run(int argc, char **argv, const launch *how);

/* For tool_run, before all else. */
void launch_begin(const launch *how);

int launch_rank(void);  /* from 0 */
int launch_ranks(void); /* at least 1 */
snow_comm *launch_comm(void);
int launch_threads(void);

/* How many threads a process has where nobody says: those, or all processors
 * that it may use (snow_processors, and what Slurm says). */
int launch_processors(void);

const char *launch_mpi(void);

/* Whether this rank talks: the first one. */
bool launch_talks(void);

/* Whether ranks cannot agree any more, since one is lost. */
bool launch_broken(void);

/* Collective.  GO_ON, SNOW_OK or another exit code of this rank; answers it
 * where all are well, else the code of the lowest rank that is not, which the
 * rank that talks has told then. */
int launch_agree(int done);

/* Collective.  Answers the first rank's word. */
int launch_share(int word);

#endif
