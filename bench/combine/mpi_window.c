/* bench/combine/mpi_window.c - two ranks of a node give each other pixels and
 * lay them over their own: by messages, as the exchange does, and out of a
 * window of shared memory (MPI-3).  A program of its own:
 *
 *   mpicc -O3 -march=native -Iinclude bench/combine/mpi_window.c -o window
 *   mpirun -n 2 ./window */
#include <snowglass/mpi.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define RUNS 60

typedef struct side {
    size_t floats;
    float *local, *region; /* what is given, and laid over */
    float *out, *in;       /* messages */
    MPI_Win shared;
    float *window, *other; /* mine, the other rank's */
    int peer;
} side;

static void lay_over(float *region, const float *pixels, size_t floats) {
    for (size_t i = 0; i < floats; i += 4) {
        const float through = 1 - region[i + 3];
        for (size_t c = 0; c < 4; c++)
            region[i + c] += through * pixels[i + c];
    }
}

static void by_message(side *s) {
    const int count = (int)s->floats;
    memcpy(s->out, s->local, s->floats * sizeof(float));
    MPI_Sendrecv(s->out, count, MPI_FLOAT, s->peer, 0, s->in, count, MPI_FLOAT,
                 s->peer, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    lay_over(s->region, s->in, s->floats);
}

static void by_window(side *s) {
    memcpy(s->window, s->local, s->floats * sizeof(float));
    MPI_Win_sync(s->shared);
    MPI_Barrier(MPI_COMM_WORLD);
    MPI_Win_sync(s->shared);
    lay_over(s->region, s->other, s->floats);
}

/* Seconds until both are done, the least of all runs. */
static double measure(side *s, void (*give)(side *)) {
    double least = 1;
    for (int run = 0; run < RUNS; run++) {
        memset(s->region, 0, s->floats * sizeof(float));
        MPI_Barrier(MPI_COMM_WORLD);
        const double start = MPI_Wtime();
        give(s);
        MPI_Barrier(MPI_COMM_WORLD);
        const double took = MPI_Wtime() - start;
        least = took < least ? took : least;
    }
    return least;
}

static void compare(size_t bytes, int rank) {
    side s = {.floats = bytes / sizeof(float), .peer = !rank};
    float **const all[] = {&s.local, &s.region, &s.out, &s.in};
    MPI_Aint size;
    int unit;
    for (int i = 0; i < 4; i++) {
        *all[i] = malloc(bytes);
        if (!*all[i])
            MPI_Abort(MPI_COMM_WORLD, 4);
        for (size_t n = 0; n < s.floats; n++)
            (*all[i])[n] = 0.01F;
    }
    MPI_Win_allocate_shared((MPI_Aint)bytes, sizeof(float), MPI_INFO_NULL,
                            MPI_COMM_WORLD, &s.window, &s.shared);
    MPI_Win_shared_query(s.shared, s.peer, &size, &unit, &s.other);
    const double message = measure(&s, by_message);
    MPI_Win_lock_all(MPI_MODE_NOCHECK, s.shared);
    const double shared = measure(&s, by_window);
    MPI_Win_unlock_all(s.shared);
    if (!rank)
        printf("%5zu KB: message %.3f ms, window %.3f ms\n", bytes / 1024,
               1e3 * message, 1e3 * shared);
    MPI_Win_free(&s.shared);
    for (int i = 0; i < 4; i++)
        free(*all[i]);
}

int main(int argc, char **argv) {
    int rank, ranks;
    MPI_Init(&argc, &argv);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    for (size_t bytes = (size_t)64 << 10;
         ranks == 2 && bytes <= (size_t)4 << 20; bytes *= 4)
        compare(bytes, rank);
    if (ranks != 2 && !rank)
        fprintf(stderr, "window: start two ranks: mpirun -n 2 ./window\n");
    MPI_Finalize();
    return ranks == 2 ? 0 : 2;
}
