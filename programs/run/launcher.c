/* launcher.c - the variables in which launchers pass the number of processes
 * and the rank.
 *
 * Of Slurm that of a step counts: SLURM_NTASKS is also set in a batch script,
 * which is one process. */
#include "run/launcher.h"

#include <stddef.h>
#include <stdlib.h>

static const struct {
    const char *name, *ranks, *rank;
} launchers[] = {
    {"Open MPI's mpirun", "OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"},
    {"MPICH's mpirun or srun", "PMI_SIZE", "PMI_RANK"},
    {"srun", "SLURM_STEP_NUM_TASKS", "SLURM_PROCID"}};

#define LAUNCHERS (sizeof launchers / sizeof *launchers)

static long number_of(const char *name) {
    const char *text = getenv(name);
    return text ? strtol(text, NULL, 10) : 0;
}

long launcher_ranks(const char **name, long *rank) {
    for (size_t i = 0; i < LAUNCHERS; i++) {
        long ranks = number_of(launchers[i].ranks);
        if (ranks <= 1)
            continue;
        *name = launchers[i].name;
        *rank = number_of(launchers[i].rank);
        return ranks;
    }
    return 1;
}

long launcher_rank(void) {
    long rank = 0;
    for (size_t i = 0; i < LAUNCHERS && !rank; i++)
        rank = number_of(launchers[i].rank);
    return rank;
}
