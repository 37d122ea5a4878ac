/* The snippet of docs/insitu.md on levels: one brick of wide cells is all. */
#include <snowglass/mpi.h>

#include <stdio.h>

int main(int argc, char **argv) {
    MPI_Init(&argc, &argv);
    const int64_t dims[3] = {64, 64, 64}, first[3] = {0, 0, 0};
    const int64_t *count = dims;
    const snow_halo halo = {{0, 0, 0}, {0, 0, 0}};
    static double rho[16 * 16 * 16];
    for (int i = 0; i < 16 * 16 * 16; i++)
        rho[i] = i % 16 > 4 && i % 16 < 11 ? i : 0;
    snow_insitu *movie = NULL;
    snow_insitu_new_mpi(NULL, MPI_COMM_WORLD, &movie);
    snow_insitu_set_grid(movie, dims, NULL, NULL);
    const snow_insitu_settings how = {.size = sizeof how,
                                      .output = "u_%04d.png"};
    snow_insitu_set(movie, &how);
    SNIPPET
    const snow_status status = snow_insitu_step(movie, 7);
    fprintf(stderr, "%s\n", snow_insitu_message(movie));
    snow_insitu_free(movie);
    MPI_Finalize();
    return status;
}
