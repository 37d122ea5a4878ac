/* The snippet of docs/insitu.md: this rank's part is a corner of the grid. */
INCLUDES
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

int main(int argc, char **argv) {
    MPI_Init(&argc, &argv);
    MPI_Comm comm = MPI_COMM_WORLD;
    int rank, step = 7;
    MPI_Comm_rank(comm, &rank);
    const int64_t first[3] = {0, 0, 0}, count[3] = {64, 64, 64};
    double *u = calloc(64 * 64 * 64, sizeof *u);
    for (int i = 0; i < 64 * 64 * 64; i++)
        u[i] = i % 64 > 20 && i % 64 < 40 ? i / (64. * 64 * 64) : 0;
    SNIPPET
    MPI_Finalize();
    free(u);
    FILE *picture = fopen("u_0007.png", "rb");
    return picture == NULL;
}
