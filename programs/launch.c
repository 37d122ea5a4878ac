/* launch.c - what main told, and agreement between ranks. */
#include "launch.h"
#include "interrupt.h"
#include "report.h"

#include <limits.h>
#include <snowglass/snowglass.h>
#include <stdlib.h>

static launch now;

/* 0: it is not told, or makes no sense. */
static int number_told(const char *name) {
    const char *text = getenv(name);
    char *end = NULL;
    long number = text ? strtol(text, &end, 10) : 0;
    return end && !*end && number > 0 && number < INT_MAX ? (int)number : 0;
}

/* What Slurm has given to a task, or to a job on this machine, holds where it
 * binds no processes as well. */
static void heed_slurm(void) {
    int limit = number_told("SLURM_CPUS_PER_TASK");
    if (!limit && !now.comm)
        limit = number_told("SLURM_CPUS_ON_NODE");
    if (limit && limit < launch_processors())
        now.threads = limit;
}

void launch_begin(const launch *how) {
    now = *how;
    heed_slurm();
    if (!launch_talks())
        interrupt_mute();
}

int launch_rank(void) {
    return now.comm ? snow_comm_rank(now.comm) : 0;
}

int launch_ranks(void) {
    return now.comm ? snow_comm_ranks(now.comm) : 1;
}

snow_comm *launch_comm(void) {
    return now.comm;
}

int launch_threads(void) {
    return now.threads;
}

int launch_processors(void) {
    return now.threads ? now.threads : snow_processors();
}

const char *launch_mpi(void) {
    return now.mpi;
}

bool launch_talks(void) {
    return launch_rank() == 0;
}

bool launch_broken(void) {
    return launch_ranks() > 1 && snow_comm_broken(now.comm);
}

/* What has broken the communicator was told when it did.  A rank that does not
 * talk has kept what it would have said. */
int launch_agree(int done) {
    if (launch_ranks() == 1)
        return done;
    snow_context *context = snow_comm_context(now.comm);
    const bool told = snow_comm_broken(now.comm);
    snow_status mine = done == GO_ON ? SNOW_OK : (snow_status)done;
    if (mine != SNOW_OK && !launch_talks() && !told)
        snow_context_fail(context, mine, "%s", last_said());
    snow_status all = snow_comm_agree(now.comm, mine);
    if (all == SNOW_OK)
        return done;
    if (mine == SNOW_OK && launch_talks() && !told)
        return fail_status(context, all);
    return (int)all;
}

int launch_share(int word) {
    int shared = word;
    if (launch_ranks() == 1)
        return word;
    const bool told = snow_comm_broken(now.comm);
    snow_status status =
        snow_comm_broadcast(now.comm, &shared, sizeof shared, 0);
    if (status == SNOW_OK)
        return shared;
    return told ? (int)status
                : fail_status(snow_comm_context(now.comm), status);
}
