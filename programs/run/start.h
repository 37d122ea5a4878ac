/* start.h - how the tool runs: as one process, or as many ranks of which the
 * first writes and prints.
 *
 * The main function passes this once (main_alone.c, mpi_main.c).  All other
 * code asks here, and would work with any other kind of ranks as well.
 *
 * All ranks read the same command line.  A condition that a rank finds alone (a
 * file that it cannot read, memory that it lacks) is agreed on before they
 * continue, since a rank that waits for one that has given up waits for
 * ever. */
#ifndef START_H
#define START_H

#include <snowglass/comm.h>

typedef struct process_start {
    snow_comm *comm; /* of all ranks; NULL: a single process */
    int threads;     /* per rank if not given; 0: all */
    const char *mpi; /* the MPI library and its version, NULL: none */
} process_start;

/* Runs the tool; returns an exit code, the same on all ranks. */
int tool_run(int argc, char **argv, const process_start *how);

/* Called by tool_run, first of all. */
void process_begin(const process_start *how);

int process_rank(void);  /* from 0 */
int process_ranks(void); /* at least 1 */
snow_comm *process_comm(void);
int process_threads(void);

/* The default number of threads of a process: `threads` above, or all
 * processors that it may use (snow_processors, and Slurm's limit). */
int process_processors(void);

const char *process_mpi(void);

/* Whether this rank prints: the first one. */
bool process_talks(void);

/* Whether ranks can no longer agree because one is lost. */
bool process_broken(void);

/* Collective.  `done` is CONTINUE, SNOW_STATUS_OK or another exit code of this
 * rank. Returns it if all are well, otherwise the code of the lowest failed
 * rank, whose message the printing rank has then printed. */
int process_agree(int done);

/* Collective, first of all.  process_agree on a command line that was read,
 * whose verb, and word for its options, must be those of all ranks;
 * SNOW_STATUS_OK on all where the first rank has nothing more to do. */
int process_meet(int done, int verb, int word);

/* Collective.  Returns the first rank's word. */
int process_share(int word);

#endif
