/* tests/catalyst/driver.c - a simulation that calls Catalyst, with the least of
 * a loader: it opens an implementation by its path.
 *
 * driver PLUGIN RECIPE CASE FIELD
 *
 * tells a smooth field on a 30 x 26 x 22 grid, cut along z, one domain for each
 * rank of MPI (where it is built with it), in one of several ways, and writes
 * the field as raw float64 to FIELD.  CASE:
 *
 *   vertex    values at points, those of the border in both domains
 *   element   values of cells
 *   ghosts    cells with two layers of ghosts, flagged
 *   multi     three domains a rank
 *   strided   the second of three interleaved components
 *   empty     the last rank has no channel
 *   wrong     a curvilinear mesh
 *   mixed     such a one on the last rank only */
#include "catalyst.h"

#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef DRIVER_MPI
#include <mpi.h>
#endif

static const int64_t dims[3] = {30, 26, 22};

static int is(const char *text, const char *word) {
    return strcmp(text, word) == 0;
}

static double field(int64_t x, int64_t y, int64_t z) {
    double u = (double)x / 30 - 0.45, v = (double)y / 26 - 0.5,
           w = (double)z / 22 - 0.4;
    return 100 * exp(-12 * (u * u + v * v + w * w)) +
           30 * sin(11 * u) * cos(9 * w + v);
}

/* Memory that a domain's node points into, until the step is done. */
#define BLOCKS_MOST 100
static void *blocks[BLOCKS_MOST];
static int block_count;

static void *block(size_t count, size_t size) {
    return blocks[block_count++] = calloc(count, size);
}

static void describe_points(conduit_node *domain, int64_t first, int64_t count,
                            int cells) {
    conduit_node_set_path_char8_str(domain, "coordsets/coords/type", "uniform");
    conduit_node_set_path_int32(domain, "coordsets/coords/dims/i",
                                (int32_t)(dims[0] + cells));
    conduit_node_set_path_int64(domain, "coordsets/coords/dims/j",
                                dims[1] + cells);
    conduit_node_set_path_int32(domain, "coordsets/coords/dims/k",
                                (int32_t)(count + cells));
    conduit_node_set_path_float64(domain, "coordsets/coords/origin/x", -3);
    conduit_node_set_path_float64(domain, "coordsets/coords/origin/y", 7);
    conduit_node_set_path_float64(domain, "coordsets/coords/origin/z",
                                  0.25 * (double)first);
    conduit_node_set_path_float64(domain, "coordsets/coords/spacing/dx", 0.2);
    conduit_node_set_path_float64(domain, "coordsets/coords/spacing/dy", 0.2);
    conduit_node_set_path_float64(domain, "coordsets/coords/spacing/dz", 0.25);
    conduit_node_set_path_char8_str(domain, "topologies/mesh/type", "uniform");
    conduit_node_set_path_char8_str(domain, "topologies/mesh/coordset",
                                    "coords");
}

/* Slices first .. first + count - 1, of which those outside of own .. own_end -
 * 1 are flagged as ghosts. */
static void describe_domain(conduit_node *domain, const char *way,
                            int64_t first, int64_t count, int64_t own,
                            int64_t own_end) {
    int cells = !is(way, "vertex") && !is(way, "strided");
    int64_t step = is(way, "strided") ? 3 : 1;
    int64_t all = dims[0] * dims[1] * count;
    double *values = block((size_t)(all * step), sizeof *values);
    for (int64_t i = 0; i < all * step; i++)
        values[i] = 1e30; /* nobody's */
    for (int64_t i = 0; i < all; i++)
        values[i * step + (step > 1)] = field(
            i % dims[0], i / dims[0] % dims[1], first + i / dims[0] / dims[1]);
    describe_points(domain, first, count, cells);
    conduit_node_set_path_char8_str(domain, "fields/other/association",
                                    "vertex");
    conduit_node_set_path_char8_str(domain, "fields/v/association",
                                    cells ? "element" : "vertex");
    conduit_node_set_path_char8_str(domain, "fields/v/topology", "mesh");
    conduit_node_set_path_external_float64_ptr_detailed(
        domain, "fields/v/values", values, all, step > 1 ? 8 : 0, 8 * step, 8,
        0);
    if (!is(way, "ghosts"))
        return;
    uint8_t *flags = block((size_t)all, 1);
    for (int64_t i = 0; i < all; i++) {
        int64_t z = first + i / dims[0] / dims[1];
        flags[i] = z < own || z >= own_end;
    }
    conduit_node_set_path_char8_str(domain, "fields/vtkGhostType/association",
                                    "element");
    conduit_node_set_path_char8_str(domain, "fields/vtkGhostType/topology",
                                    "mesh");
    conduit_node_set_path_external_uint8_ptr(
        domain, "fields/vtkGhostType/values", flags, all);
}

/* This rank's domain, or domains. */
static void describe_mesh(conduit_node *channel, const char *way, int rank,
                          int ranks) {
    int parts = is(way, "multi") ? 3 : 1;
    conduit_node_set_path_char8_str(channel, "type",
                                    parts > 1 ? "multimesh" : "mesh");
    for (int part = 0; part < parts; part++) {
        char path[40] = "data";
        int n = rank * parts + part, all = ranks * parts;
        int64_t own = dims[2] * n / all, end = dims[2] * (n + 1) / all;
        int64_t first = own, last = end;
        if (is(way, "vertex") && n + 1 < all)
            last++;
        if (is(way, "ghosts")) {
            first = first > 2 ? first - 2 : 0;
            last = last + 2 < dims[2] ? last + 2 : dims[2];
        }
        if (parts > 1)
            snprintf(path, sizeof path, "data/domain%d", part);
        describe_domain(conduit_node_fetch(channel, path), way, first,
                        last - first, own, end);
    }
    if (is(way, "wrong") || (is(way, "mixed") && rank == ranks - 1))
        conduit_node_set_path_char8_str(channel, "data/coordsets/coords/type",
                                        "explicit");
}

static const struct catalyst_impl *load(const char *path) {
    void *library = dlopen(path, RTLD_LAZY | RTLD_GLOBAL);
    const struct catalyst_impl *impl =
        library ? dlsym(library, "catalyst_api_impl") : NULL;
    if (!impl)
        fprintf(stderr, "driver: %s\n", dlerror());
    else if (impl->version != 1 || !impl->initialize || !impl->execute ||
             !impl->finalize || !impl->about || !impl->results)
        fprintf(stderr, "driver: %s is incomplete\n", path);
    else
        return impl;
    return NULL;
}

static void write_field(const char *path) {
    FILE *file = fopen(path, "wb");
    for (int64_t i = 0; file && i < dims[0] * dims[1] * dims[2]; i++) {
        double value =
            field(i % dims[0], i / dims[0] % dims[1], i / dims[0] / dims[1]);
        fwrite(&value, sizeof value, 1, file);
    }
    if (file)
        fclose(file);
}

static int run(const struct catalyst_impl *impl, char **argv, int rank,
               int ranks, int handle) {
    const char *way = argv[3];
    conduit_node *node = conduit_node_create();
    conduit_node_set_path_char8_str(node, "catalyst/scripts/a/filename",
                                    "ignored.py");
    conduit_node_set_path_char8_str(node, "catalyst/scripts/b/filename",
                                    argv[2]);
    if (ranks > 1)
        conduit_node_set_path_int32(node, "catalyst/mpi_comm", handle);
    int bad = impl->initialize(node) != catalyst_status_ok;
    for (int step = 0; step < 2; step++) {
        conduit_node *params = conduit_node_create();
        conduit_node_set_path_int64(params, "catalyst/state/timestep", step);
        conduit_node_set_path_float64(params, "catalyst/state/time", step);
        if (!is(way, "empty") || rank < ranks - 1)
            describe_mesh(conduit_node_fetch(params, "catalyst/channels/grid"),
                          way, rank,
                          is(way, "empty") && ranks > 1 ? ranks - 1 : ranks);
        bad |= impl->execute(params) != catalyst_status_ok;
        conduit_node_destroy(params);
        while (block_count > 0)
            free(blocks[--block_count]);
    }
    conduit_node *about = conduit_node_create();
    bad |= impl->about(about) != catalyst_status_ok ||
           !conduit_node_has_path(about, "catalyst/implementation");
    bad |= impl->finalize(node) != catalyst_status_ok;
    conduit_node_destroy(about);
    conduit_node_destroy(node);
    return bad;
}

int main(int argc, char **argv) {
    int rank = 0, ranks = 1, handle = 0, bad = 1;
    if (argc != 5)
        return 2;
#ifdef DRIVER_MPI
    MPI_Comm own; /* not MPI_COMM_WORLD */
    MPI_Init(&argc, &argv);
    MPI_Comm_dup(MPI_COMM_WORLD, &own);
    MPI_Comm_rank(own, &rank);
    MPI_Comm_size(own, &ranks);
    handle = MPI_Comm_c2f(own);
#endif
    const struct catalyst_impl *impl = load(argv[1]);
    if (impl)
        bad = run(impl, argv, rank, ranks, handle);
    if (rank == 0)
        write_field(argv[4]);
#ifdef DRIVER_MPI
    MPI_Comm_free(&own);
    MPI_Finalize();
#endif
    return bad;
}
