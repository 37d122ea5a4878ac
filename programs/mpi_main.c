/* mpi_main.c - the tool with MPI: snowglass-mpi, and the programs beside it.
 *
 * MPI is started and ended only here.  Rank 0 writes and prints.  A rank whose
 * connection to the others has failed prints an error itself, and ends the job,
 * since the others may wait for it. */
#define _GNU_SOURCE /* sched_getaffinity */
#include "run/launcher.h"
#include "run/log.h"
#include "run/sibling.h"
#include "run/start.h"

#include <sched.h>
#include <signal.h>
#include <snowglass/mpi.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* More than thousands of processes need to start. */
#ifndef MPI_SECONDS
#define MPI_SECONDS 300
#endif

/* If a program of one MPI runs under the launcher of another, each process is a
 * job of one rank, and all would write the same output. */
static int check_launcher(const char *library) {
    int ranks = 1;
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    if (ranks > 1)
        return CONTINUE;
    const char *launcher;
    long rank, given = launcher_ranks(&launcher, &rank);
    if (given == 1)
        return CONTINUE;
    /* The others wait until rank 0 has printed: the launcher may end all with
     * the first one that fails. */
    if (rank != 0)
        sleep(1);
    else
        fprintf(stderr,
                "snowglass: %ld processes were started by %s, but %s sees "
                "only one; use the mpirun of the MPI that snowglass-mpi "
                "was built with\n",
                given, launcher, library);
    return SNOW_STATUS_BAD_USAGE;
}

/* The name and version end at the first comma or line end. */
static void name_library(char out[MPI_MAX_LIBRARY_VERSION_STRING]) {
    int length = 0;
    MPI_Get_library_version(out, &length);
    out[strcspn(out, ",\n")] = '\0';
    for (char *at = out; *at; at++)
        if (*at == '\t')
            *at = ' ';
}

/* Threads for each rank by default: the processors of a machine divided by its
 * ranks, unless they are bound to different processors already. */
static int share_processors(void) {
    MPI_Comm machine;
    cpu_set_t mine, all;
    CPU_ZERO(&mine);
    if (sched_getaffinity(0, sizeof mine, &mine) != 0 ||
        MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0,
                            MPI_INFO_NULL, &machine) != MPI_SUCCESS)
        return 0;
    int own = CPU_COUNT(&mine), sum = own, threads;
    MPI_Allreduce(&mine, &all, (int)sizeof mine, MPI_BYTE, MPI_BOR, machine);
    MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_INT, MPI_SUM, machine);
    MPI_Comm_free(&machine);
    threads = (int)((int64_t)snow_processors() * CPU_COUNT(&all) / sum);
    return threads > 1 ? threads : 1;
}

/* While MPI starts or ends, all ranks wait in it for one that is stopped; only
 * a signal can interrupt this. */
static void give_up(int number) {
    static const char text[] =
        "snowglass: another rank does not take part in MPI's start or end; "
        "check that all processes still run\n";
    (void)number;
    ssize_t given = write(STDERR_FILENO, text, sizeof text - 1);
    (void)given;
    _exit(SNOW_STATUS_FAILED);
}

/* The first rank that gives up ends the job, so the limits differ between
 * ranks. */
static void limit_seconds(unsigned seconds) {
    const long rank = launcher_rank();
    alarm(seconds + (unsigned)(rank < 30 ? rank : 30));
}

static int run_tool(int argc, char **argv) {
    char library[MPI_MAX_LIBRARY_VERSION_STRING];
    snow_context *context = NULL;
    process_start how = {.mpi = library};
    name_library(library);
    int done = check_launcher(library);
    if (done != CONTINUE)
        return done;
    how.threads = share_processors();
    if (snow_context_new(NULL, &context) != SNOW_STATUS_OK)
        MPI_Abort(MPI_COMM_WORLD, SNOW_STATUS_NO_MEMORY);
    snow_status status = snow_comm_new_mpi(context, MPI_COMM_WORLD, &how.comm);
    alarm(0);
    if (status == SNOW_STATUS_OK) {
        done = tool_run(argc, argv, &how);
        if (snow_comm_broken(how.comm)) {
            /* A broken communicator cannot agree on an exit code.  The rank
             * that prints has given the reason already. */
            if (!process_talks())
                fprintf(stderr, "snowglass: rank %d: %s\n", process_rank(),
                        snow_context_message(snow_comm_context(how.comm)));
            MPI_Abort(MPI_COMM_WORLD, done ? done : SNOW_STATUS_FAILED);
        }
        limit_seconds(MPI_SECONDS);
        snow_comm_free(how.comm);
    } else {
        done = fail_status(context, status);
    }
    snow_context_free(context);
    return done;
}

int main(int argc, char **argv) {
    int level;
#ifdef SNOW_SIBLINGS /* they become other programs before MPI is begun */
    if (argc > 1 && strcmp(argv[1], "bench") == 0)
        return sibling_become("snowglass-bench-mpi", argv + 1);
    if (argc > 1 && strcmp(argv[1], "serve") == 0)
        return sibling_become("snowglass-serve-mpi", argv + 1);
#endif
    signal(SIGALRM, give_up);
    limit_seconds(MPI_SECONDS);
    if (MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level) !=
        MPI_SUCCESS)
        return SNOW_STATUS_FAILED;
    MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
    MPI_Comm_set_errhandler(MPI_COMM_SELF, MPI_ERRORS_RETURN);
    int done = run_tool(argc, argv);
    MPI_Finalize();
    alarm(0);
    return done;
}
