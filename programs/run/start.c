/* start.c - how the tool was started, and agreement between ranks. */
#include "run/start.h"
#include "run/interrupt.h"
#include "run/log.h"

#include <limits.h>
#include <snowglass/extend.h>
#include <snowglass/snowglass.h>
#include <stdlib.h>

static process_start now;

/* 0 if the variable is not set or not valid. */
static int number_given(const char *name) {
    const char *text = getenv(name);
    char *end = NULL;
    long number = text ? strtol(text, &end, 10) : 0;
    return end && !*end && number > 0 && number < INT_MAX ? (int)number : 0;
}

/* The processors that Slurm has assigned to a task, or to a job on this
 * machine, count even if Slurm does not bind the processes. */
void process_begin(const process_start *how) {
    now = *how;
    int limit = number_given("SLURM_CPUS_PER_TASK");
    if (!limit && !now.comm)
        limit = number_given("SLURM_CPUS_ON_NODE");
    if (limit && limit < process_processors())
        now.threads = limit;
    if (!process_talks())
        interrupt_mute();
}

int process_rank(void) {
    return now.comm ? snow_comm_rank(now.comm) : 0;
}

int process_ranks(void) {
    return now.comm ? snow_comm_size(now.comm) : 1;
}

snow_comm *process_comm(void) {
    return now.comm;
}

int process_threads(void) {
    return now.threads;
}

int process_processors(void) {
    return now.threads ? now.threads : snow_processors();
}

const char *process_mpi(void) {
    return now.mpi;
}

bool process_talks(void) {
    return process_rank() == 0;
}

bool process_broken(void) {
    return process_ranks() > 1 && snow_comm_broken(now.comm);
}

/* The reason why the communicator broke was printed when it happened.  A rank
 * that does not print has kept its last message. */
int process_agree(int done) {
    if (process_ranks() == 1)
        return done;
    snow_context *context = snow_comm_context(now.comm);
    const bool given = snow_comm_broken(now.comm);
    snow_status mine = done == CONTINUE ? SNOW_STATUS_OK : (snow_status)done;
    if (mine != SNOW_STATUS_OK && !process_talks() && !given)
        snow_context_fail(context, mine, "%s", last_said());
    snow_status all = snow_comm_agree_status(now.comm, mine);
    if (all == SNOW_STATUS_OK)
        return done;
    if (mine == SNOW_STATUS_OK && process_talks() && !given)
        return fail_status(context, all);
    return (int)all;
}

int process_share(int word) {
    int shared = word;
    if (process_ranks() == 1)
        return word;
    const bool given = snow_comm_broken(now.comm);
    snow_status status =
        snow_comm_broadcast(now.comm, &shared, sizeof shared, 0);
    if (status == SNOW_STATUS_OK)
        return shared;
    return given ? (int)status
                 : fail_status(snow_comm_context(now.comm), status);
}

/* Refuses what is not as on the first rank, in a few words. */
static int refuse_other(const char *what) {
    return fail_usage("this rank was given %s; start all ranks with the same "
                      "command",
                      what);
}

int process_meet(int done, int verb, int word) {
    if (process_ranks() == 1)
        return done;
    done = process_agree(done);
    if (done != CONTINUE && done != SNOW_STATUS_OK)
        return done;
    const int first = process_share(done == CONTINUE ? verb : -verb);
    const bool same = first == verb ? done == CONTINUE : first == -verb;
    const bool alike = process_share(word) == word || first < 0;
    done = process_agree(!same    ? refuse_other("another verb or --help")
                         : !alike ? refuse_other("other options or files")
                                  : CONTINUE);
    return done == CONTINUE && first < 0 ? SNOW_STATUS_OK : done;
}
