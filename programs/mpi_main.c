/* mpi_main.c - the tool as ranks of an MPI job: snowglass-mpi.
 *
 * MPI is started and ended here and nowhere else.  Rank 0 writes and talks; a
 * rank whose connection to the others has failed says so itself, and ends the
 * job, since the others may wait for it. */
#define _GNU_SOURCE /* sched_getaffinity */
#include "launch.h"
#include "report.h"

#include <sched.h>
#include <signal.h>
#include <snowglass/mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* More than thousands of processes take to start. */
#ifndef MPI_SECONDS
#define MPI_SECONDS 300
#endif

/* Where launchers tell how many processes they started, and which one this is.
 */
static const struct {
    const char *name, *ranks, *rank;
} launchers[] = {
    {"Open MPI's mpirun", "OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"},
    {"MPICH's mpirun or srun", "PMI_SIZE", "PMI_RANK"},
    {"srun", "SLURM_STEP_NUM_TASKS", "SLURM_PROCID"}};

static long number_of(const char *name) {
    const char *text = getenv(name);
    return text ? strtol(text, NULL, 10) : 0;
}

/* A program of one MPI under the launcher of another is as many programs of one
 * rank, all of which would write the one output. */
static int check_launcher(const char *library) {
    int ranks = 1;
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    if (ranks > 1)
        return GO_ON;
    for (size_t i = 0; i < sizeof launchers / sizeof *launchers; i++) {
        long told = number_of(launchers[i].ranks);
        if (told <= 1)
            continue;
        /* The others wait until it was told: the launcher may end all with
         * the first one that fails. */
        if (number_of(launchers[i].rank) != 0)
            sleep(1);
        else
            fprintf(stderr,
                    "snowglass: started as one of %ld processes by %s, but "
                    "alone for %s; use the mpirun of the MPI that "
                    "snowglass-mpi was built with\n",
                    told, launchers[i].name, library);
        return SNOW_BAD_USAGE;
    }
    return GO_ON;
}

/* Its name and version end with the first comma or line. */
static void name_library(char out[MPI_MAX_LIBRARY_VERSION_STRING]) {
    int length = 0;
    MPI_Get_library_version(out, &length);
    out[strcspn(out, ",\n")] = '\0';
    for (char *at = out; *at; at++)
        if (*at == '\t')
            *at = ' ';
}

/* Threads for each rank where nobody tells how many: the processors of a
 * machine by its ranks, if they are not bound to some each already. */
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

/* A broken communicator leaves nobody to agree with.  The rank that talks has
 * said why already. */
static void end_job(const launch *how, int code) {
    if (!launch_talks())
        fprintf(stderr, "snowglass: rank %d: %s\n", launch_rank(),
                snow_context_message(snow_comm_context(how->comm)));
    MPI_Abort(MPI_COMM_WORLD, code ? code : SNOW_FAILED);
}

/* Where MPI itself begins and ends, all ranks wait in it for one that is
 * stopped, and nothing but a signal comes between. */
static void give_up(int number) {
    static const char text[] =
        "snowglass: another rank does not come to MPI's start or end; look "
        "whether all processes still run\n";
    (void)number;
    ssize_t told = write(STDERR_FILENO, text, sizeof text - 1);
    (void)told;
    _exit(SNOW_FAILED);
}

/* The first that gives up ends the job: not all at the same time. */
static void limit_seconds(unsigned seconds) {
    long rank = 0;
    for (size_t i = 0; i < sizeof launchers / sizeof *launchers && !rank; i++)
        rank = number_of(launchers[i].rank);
    alarm(seconds + (unsigned)(rank < 30 ? rank : 30));
}

static int run(int argc, char **argv) {
    char library[MPI_MAX_LIBRARY_VERSION_STRING];
    snow_context *context = NULL;
    launch how = {.mpi = library};
    name_library(library);
    int done = check_launcher(library);
    if (done != GO_ON)
        return done;
    how.threads = share_processors();
    if (snow_context_new(NULL, &context) != SNOW_OK)
        MPI_Abort(MPI_COMM_WORLD, SNOW_NO_MEMORY);
    snow_status status = snow_comm_mpi(context, MPI_COMM_WORLD, &how.comm);
    alarm(0);
    if (status == SNOW_OK) {
        done = tool_run(argc, argv, &how);
        if (snow_comm_broken(how.comm))
            end_job(&how, done);
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
    signal(SIGALRM, give_up);
    limit_seconds(MPI_SECONDS);
    if (MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level) !=
        MPI_SUCCESS)
        return SNOW_FAILED;
    MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
    MPI_Comm_set_errhandler(MPI_COMM_SELF, MPI_ERRORS_RETURN);
    int done = run(argc, argv);
    MPI_Finalize();
    alarm(0);
    return done;
}
