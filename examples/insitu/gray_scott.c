/* examples/insitu/gray_scott.c - a simulation that makes a movie of itself.
 *
 * The reaction-diffusion system of P. Gray and S. K. Scott (see J. E. Pearson,
 * "Complex patterns in a simple system", Science 261, 1993) on a periodic grid
 * that is cut into boxes along all three axes, one for each rank of MPI:
 *
 *   u' = Du lap u - u v^2 + F (1 - u)
 *   v' = Dv lap v + u v^2 - (F + k) v
 *
 * What the pictures add to the simulation stands between lines of dashes.
 *
 * mpicc gray_scott.c $(pkg-config --cflags --libs snowglass-mpi) -lm
 * mpirun -n 4 ./a.out 64 400 40 v_%04d.png [FIELD]
 *
 * makes 400 steps on a 64^3 grid, a picture of v after every 40, and writes the
 * last v as raw float64 to FIELD. */
#include <snowglass/mpi.h>
#include <snowglass/snowglass.h>
#include <stdio.h>
#include <stdlib.h>

#define DU (0.2 / 6)
#define DV (0.1 / 6)
#define FEED 0.02
#define KILL 0.048
#define STEP 1.0

/* A rank's box of the grid, with one layer of ghosts around it. */
typedef struct box {
    MPI_Comm comm;       /* a periodic Cartesian one */
    int64_t dims[3];     /* of the grid */
    int64_t first[3];    /* of the grid's cells, the first one here */
    int64_t count[3];    /* cells here */
    int64_t step[3];     /* in memory, from cell to cell: ghosts included */
    int low[3], high[3]; /* neighbours */
    double *u, *v;       /* from the first ghost on */
    double *next_u, *next_v;
    MPI_Datatype face[3];
} box;

static int64_t at(const box *b, int64_t x, int64_t y, int64_t z) {
    return (x + 1) * b->step[0] + (y + 1) * b->step[1] + (z + 1) * b->step[2];
}

/* Deals the grid out.  Ranks are numbered with z fastest, as MPI does. */
static void make_box(box *b, int64_t side) {
    int ranks, rank, cut[3] = {0}, place[3], wrap[3] = {1, 1, 1};
    int64_t cells = 1;
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    MPI_Dims_create(ranks, 3, cut);
    MPI_Cart_create(MPI_COMM_WORLD, 3, cut, wrap, 1, &b->comm);
    MPI_Comm_rank(b->comm, &rank);
    MPI_Cart_coords(b->comm, rank, 3, place);
    for (int i = 0; i < 3; i++) {
        b->dims[i] = side;
        b->first[i] = side * place[i] / cut[i];
        b->count[i] = side * (place[i] + 1) / cut[i] - b->first[i];
        b->step[i] = cells;
        cells *= b->count[i] + 2;
        MPI_Cart_shift(b->comm, i, 1, &b->low[i], &b->high[i]);
    }
    double **fields[4] = {&b->u, &b->v, &b->next_u, &b->next_v};
    for (int i = 0; i < 4; i++)
        *fields[i] = calloc((size_t)cells, sizeof(double));
    for (int i = 0; i < 3; i++) {
        int size[3], part[3], origin[3] = {0, 0, 0};
        for (int k = 0; k < 3; k++) /* MPI's last axis is the fastest */
            size[2 - k] = part[2 - k] = (int)b->count[k] + 2;
        part[2 - i] = 1;
        MPI_Type_create_subarray(3, size, part, origin, MPI_ORDER_C, MPI_DOUBLE,
                                 &b->face[i]);
        MPI_Type_commit(&b->face[i]);
    }
}

static void free_box(box *b) {
    for (int i = 0; i < 3; i++)
        MPI_Type_free(&b->face[i]);
    free(b->u);
    free(b->v);
    free(b->next_u);
    free(b->next_v);
    MPI_Comm_free(&b->comm);
}

/* Ghosts from the neighbours, one axis after the other, so that edges and
 * corners come too. */
static void exchange(const box *b, double *f) {
    for (int i = 0; i < 3; i++) {
        double *last = f + b->count[i] * b->step[i];
        MPI_Sendrecv(last, 1, b->face[i], b->high[i], i, f, 1, b->face[i],
                     b->low[i], i, b->comm, MPI_STATUS_IGNORE);
        MPI_Sendrecv(f + b->step[i], 1, b->face[i], b->low[i], i,
                     last + b->step[i], 1, b->face[i], b->high[i], i, b->comm,
                     MPI_STATUS_IGNORE);
    }
}

/* u = 1 and v = 0, but for a few cubes in which the reaction starts. */
static void start(box *b) {
    static const double seeds[][3] = {
        {0.5, 0.5, 0.5}, {0.3, 0.4, 0.6}, {0.65, 0.6, 0.35}, {0.4, 0.7, 0.45}};
    for (int64_t z = 0; z < b->count[2]; z++)
        for (int64_t y = 0; y < b->count[1]; y++)
            for (int64_t x = 0; x < b->count[0]; x++) {
                const int64_t cell[3] = {x, y, z};
                int inside = 0;
                for (int n = 0; n < 4; n++) {
                    int near = 0;
                    for (int i = 0; i < 3; i++) {
                        double d = (double)(b->first[i] + cell[i]) /
                                       (double)b->dims[i] -
                                   seeds[n][i];
                        near += d * d < 0.06 * 0.06;
                    }
                    inside |= near == 3;
                }
                b->u[at(b, x, y, z)] = inside ? 0.5 : 1;
                b->v[at(b, x, y, z)] = inside ? 0.25 : 0;
            }
}

static double laplace(const box *b, const double *f) {
    double sum = -6 * f[0];
    for (int i = 0; i < 3; i++)
        sum += f[-b->step[i]] + f[b->step[i]];
    return sum;
}

/* One step of Euler's method. */
static void advance(box *b) {
    exchange(b, b->u);
    exchange(b, b->v);
    for (int64_t z = 0; z < b->count[2]; z++)
        for (int64_t y = 0; y < b->count[1]; y++)
            for (int64_t x = 0; x < b->count[0]; x++) {
                int64_t n = at(b, x, y, z);
                double u = b->u[n], v = b->v[n], reaction = u * v * v;
                b->next_u[n] = u + STEP * (DU * laplace(b, b->u + n) -
                                           reaction + FEED * (1 - u));
                b->next_v[n] = v + STEP * (DV * laplace(b, b->v + n) +
                                           reaction - (FEED + KILL) * v);
            }
    double *u = b->u, *v = b->v;
    b->u = b->next_u;
    b->v = b->next_v;
    b->next_u = u;
    b->next_v = v;
}

/* The whole of v, x fastest, for other programs. */
static void write_field(const box *b, const char *path) {
    int whole[3], part[3], first[3], size[3], ghosts[3] = {1, 1, 1};
    MPI_Datatype here, there;
    MPI_File file;
    for (int i = 0; i < 3; i++) {
        whole[2 - i] = (int)b->dims[i];
        part[2 - i] = (int)b->count[i];
        first[2 - i] = (int)b->first[i];
        size[2 - i] = (int)b->count[i] + 2;
    }
    MPI_Type_create_subarray(3, size, part, ghosts, MPI_ORDER_C, MPI_DOUBLE,
                             &here);
    MPI_Type_create_subarray(3, whole, part, first, MPI_ORDER_C, MPI_DOUBLE,
                             &there);
    MPI_Type_commit(&here);
    MPI_Type_commit(&there);
    MPI_File_open(b->comm, path, MPI_MODE_CREATE | MPI_MODE_WRONLY,
                  MPI_INFO_NULL, &file);
    MPI_File_set_view(file, 0, MPI_DOUBLE, there, "native", MPI_INFO_NULL);
    MPI_File_write_all(file, b->v, 1, here, MPI_STATUS_IGNORE);
    MPI_File_close(&file);
    MPI_Type_free(&here);
    MPI_Type_free(&there);
}

/* ------------------------------------------------------------------------- */

/* Pictures left out, and what all took beside the simulation. */
static void print_warning(void *user, const char *text) {
    (void)user;
    fprintf(stderr, "gray_scott: %s\n", text);
}

/* The movie: what is shown, how, and where its frames go. */
static snow_insitu *open_movie(const box *b, const char *pattern) {
    static const snow_opacity_point opacities[] = {
        {0.08, 0}, {0.15, 0.15}, {0.3, 0.6}};
    snow_look look;
    snow_look_init(&look);
    look.preset = "linear";
    look.colormap = "viridis";
    look.range = SNOW_RANGE_VALUES;
    look.low = 0.05;
    look.high = 0.35;
    look.opacities = opacities;
    look.opacity_count = 3;
    snow_insitu *movie = NULL;
    snow_view view;
    snow_view_init(&view);
    if (snow_insitu_new_mpi(NULL, b->comm, &movie) != SNOW_STATUS_OK)
        return NULL;
    snow_insitu_set_warning(movie, print_warning, NULL);
    snow_insitu_set_grid(movie, b->dims, NULL, NULL);
    snow_insitu_set_brick(movie, 0, b->first, b->count, NULL);
    snow_view_from_name(snow_comm_context(snow_insitu_comm(movie)), "iso",
                        &view);
    const snow_insitu_settings settings = {.size = sizeof settings,
                                           .output = pattern,
                                           .look = &look,
                                           .view = &view};
    snow_insitu_set(movie, &settings);
    return movie;
}

/* One frame.  The fields change places at every step, so v is told anew. */
static int show(snow_insitu *movie, const box *b, int step) {
    snow_insitu_set_voxels(movie, 0, SNOW_TYPE_FLOAT64, b->v + at(b, 0, 0, 0),
                           b->step);
    if (snow_insitu_step(movie, step) == SNOW_STATUS_OK)
        return 0;
    fprintf(stderr, "gray_scott: %s\n", snow_insitu_message(movie));
    return 1;
}
/* ------------------------------------------------------------------------- */

int main(int argc, char **argv) {
    box b = {0};
    MPI_Init(&argc, &argv);
    if (argc < 5 || atoi(argv[1]) < 8 || atoi(argv[3]) < 1) {
        fprintf(stderr, "usage: gray_scott SIDE STEPS EVERY PATTERN [FIELD]\n");
        MPI_Abort(MPI_COMM_WORLD, 2);
    }
    int steps = atoi(argv[2]), every = atoi(argv[3]), failed = 0;
    make_box(&b, atoi(argv[1]));
    start(&b);
    snow_insitu *movie = open_movie(&b, argv[4]);
    for (int step = 1; step <= steps && movie && !failed; step++) {
        advance(&b);
        if (step % every == 0)
            failed = show(movie, &b, step);
    }
    snow_insitu_free(movie);
    if (argc > 5)
        write_field(&b, argv[5]);
    free_box(&b);
    MPI_Finalize();
    return failed || !movie;
}
