/* bench/combine/mpi_combine.c - `bench combine` as a program of MPI: the ranks
 * are its processes.  Built by smpicc it runs on networks that SimGrid
 * simulates, by any other MPI's compiler on real ones.
 *
 * Nobody has memory for a thousand whole pictures: where sizes alone are asked
 * for and whole pictures travel, large blocks of all simulated ranks are one,
 * which SimGrid then does not copy either.  Other pictures of sizes alone take
 * small pages, since a huge one is cleared whole for the few bytes in use. */
#include "combine.h"

#include <snowglass/mpi.h>

#include <stdlib.h>

#ifdef SMPI_H
#define LARGE ((size_t)1 << 20)

static void *allocate_folded(void *user, size_t bytes) {
    (void)user;
    if (bytes < LARGE)
        return malloc(bytes);
    return SMPI_SHARED_MALLOC(bytes);
}

/* What is folded is left to the end of the process: SimGrid releases only what
 * it knows, and malloc's blocks are not. */
static void release_folded(void *user, void *block) {
    (void)user;
    (void)block;
}

static void *allocate_small_pages(void *user, size_t bytes) {
    (void)user;
    return malloc(bytes);
}

static void release_small_pages(void *user, void *block) {
    (void)user;
    free(block);
}
#endif

static snow_status new_context(const combine_options *options,
                               snow_context **out) {
#ifdef SMPI_H
    const snow_allocator folded = {allocate_folded, release_folded, NULL};
    const snow_allocator small_pages = {allocate_small_pages,
                                        release_small_pages, NULL};
    if (options->sizes_only)
        return snow_context_new(options->whole ? &folded : &small_pages, out);
#endif
    (void)options;
    return snow_context_new(NULL, out);
}

static int run(const combine_options *options) {
    snow_context *context;
    snow_comm *comm = NULL;
    combine_session session = {.options = options};
    int code = (int)new_context(options, &context);
    if (code != SNOW_STATUS_OK)
        return code;
    code = (int)snow_comm_new_mpi(context, MPI_COMM_WORLD, &comm);
    if (code == SNOW_STATUS_OK)
        code = combine_run(comm, &session);
    else
        fprintf(stderr, "bench combine: %s\n", snow_context_message(context));
    snow_comm_free(comm);
    snow_context_free(context);
    return code;
}

int main(int argc, char **argv) {
    combine_options options;
    int rank = 0;
    MPI_Init(&argc, &argv);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    int code = combine_parse(argc, argv, &options, rank ? NULL : stderr);
#ifdef SMPI_H
    options.simulated = true;
    options.runs = 1; /* all are alike */
#endif
    if (code < 0)
        code = run(&options);
    MPI_Finalize();
    return code;
}
