/* tests/mpi/live_simulation.c - a simulation that draws each of its steps by a
 * recipe until the file `stop` is there: a ball that moves through slabs.  Rank
 * 0 prints the steps, and the longest of them in seconds. */
#include <snowglass/mpi.h>
#include <snowglass/recipe.h>

#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#define SIDE 24
#define SLABS 30 /* divided by 1, 2 and 3 ranks */
#define STEPS_MOST 5000

static void fill(float *u, int64_t first, int64_t count, int step) {
    const double middle = SIDE / 2.0, far = 4 + 14.0 * (step % 100) / 100;
    for (int64_t z = 0; z < count; z++)
        for (int y = 0; y < SIDE; y++)
            for (int x = 0; x < SIDE; x++) {
                const double a = x - far, b = y - middle,
                             c = (double)(z + first) - middle;
                *u++ = (float)(1 / (1 + (a * a + b * b + c * c) / 20));
            }
}

int main(int argc, char **argv) {
    const int64_t dims[3] = {SIDE, SIDE, SLABS};
    const struct timespec pause = {.tv_nsec = 20000000};
    const double origin[3] = {100, 50, -20}, spacing[3] = {0.5, 0.5, 2};
    int rank = 0, ranks = 1, step = 0, ended = 0, failed = 0;
    double longest = 0;
    snow_insitu *movie = NULL;
    MPI_Init(&argc, &argv);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    const int64_t count[3] = {SIDE, SIDE, SLABS / ranks};
    const int64_t first[3] = {0, 0, rank * count[2]};
    float *u = malloc(sizeof *u * SIDE * SIDE * (size_t)count[2]);
    if (argc != 2 || !u ||
        snow_insitu_new_mpi(NULL, MPI_COMM_WORLD, &movie) != SNOW_STATUS_OK)
        MPI_Abort(MPI_COMM_WORLD, 1);
    snow_insitu_set_grid(movie, dims, origin, spacing);
    snow_insitu_set_brick(movie, 0, first, count, NULL);
    snow_insitu_set_voxels(movie, 0, SNOW_TYPE_FLOAT32, u, NULL);
    snow_recipe_apply_file(movie, argv[1]);
    for (; !ended && !failed && step < STEPS_MOST; step++) {
        const double begin = MPI_Wtime();
        fill(u, first[2], count[2], step);
        nanosleep(&pause, NULL);
        failed = snow_insitu_step(movie, step) != SNOW_STATUS_OK;
        ended = rank == 0 && access("stop", F_OK) == 0;
        MPI_Bcast(&ended, 1, MPI_INT, 0, MPI_COMM_WORLD);
        longest = longest > MPI_Wtime() - begin ? longest : MPI_Wtime() - begin;
    }
    if (rank == 0)
        printf("%d %.3f %s\n", step, longest, snow_insitu_message(movie));
    snow_insitu_free(movie);
    free(u);
    MPI_Finalize();
    return failed;
}
