/* bench/ranks/ranks_print.c - what many ranks took, as a table or as JSON. */
#include "ranks.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

static double imbalance(const ranks_row *row) {
    return row->splat_mean > 0 ? row->splat_slowest / row->splat_mean : 1;
}

static double efficiency(const ranks_row *row, double alone) {
    return row->picture > 0 ? alone / (row->ranks * row->picture) : 0;
}

static void print_table(const ranks_options *options, const char *of,
                        double alone, const ranks_row *rows, int count) {
    printf("%s, %dx%d: one rank takes %.2f ms\n", options->path, options->side,
           options->side, alone * 1e3);
    if (strcmp(of, "threads") == 0)
        printf("ranks are threads, on %ld processors\n",
               sysconf(_SC_NPROCESSORS_ONLN));
    else if (strcmp(of, "mpi") == 0)
        printf("ranks are processes of MPI\n");
    else
        printf("ranks work one at a time; a network of %g s, %g bytes/s and "
               "%g s of the processor is simulated\n",
               options->network.latency, options->network.bandwidth,
               options->network.overhead);
    printf("milliseconds; splats in processor time, the least of %d pictures, "
           "which are that of one rank\n\n"
           "ranks  splat: slowest    mean  exchange: slowest    mean  "
           "picture   bytes sent  imbalance  efficiency\n",
           options->runs);
    for (int i = 0; i < count; i++) {
        const ranks_row *row = &rows[i];
        printf("%5d %15.2f %7.2f %18.2f %7.2f %8.2f %12llu %10.2f %9.0f %%\n",
               row->ranks, 1e3 * row->splat_slowest, 1e3 * row->splat_mean,
               1e3 * row->exchange_slowest, 1e3 * row->exchange_mean,
               1e3 * row->picture, (unsigned long long)row->bytes_sent,
               imbalance(row), 100 * efficiency(row, alone));
    }
}

static json_t *row_json(const ranks_row *row, double alone) {
    json_t *radices = json_array();
    for (int i = 0; i < row->rounds && i < RANKS_ROUNDS_MOST; i++)
        json_array_append_new(radices, json_integer(row->radices[i]));
    return json_pack(
        "{s:i, s:f, s:f, s:f, s:f, s:f, s:I, s:I, s:f, s:f, s:f, s:o}", "ranks",
        row->ranks, "splat_slowest_ms", 1e3 * row->splat_slowest,
        "splat_mean_ms", 1e3 * row->splat_mean, "exchange_slowest_ms",
        1e3 * row->exchange_slowest, "exchange_mean_ms",
        1e3 * row->exchange_mean, "picture_ms", 1e3 * row->picture,
        "bytes_sent", (json_int_t)row->bytes_sent, "bytes_in_place",
        (json_int_t)row->bytes_in_place, "imbalance", imbalance(row),
        "efficiency", efficiency(row, alone), "largest_difference",
        row->difference, "radices", radices);
}

int ranks_print(const ranks_options *options, const char *of, double alone,
                const ranks_row *rows, int count) {
    if (!options->json) {
        print_table(options, of, alone, rows, count);
        return SNOW_STATUS_OK;
    }
    json_t *array = json_array();
    for (int i = 0; i < count; i++)
        json_array_append_new(array, row_json(&rows[i], alone));
    return bench_print_json(
        json_pack("{s:s, s:s, s:s, s:i, s:i, s:f, s:o, s:o}", "bench", "ranks",
                  "file", options->path, "ranks_are", of, "size", options->side,
                  "runs", options->runs, "alone_ms", 1e3 * alone, "machine",
                  bench_machine(), "rows", array));
}
