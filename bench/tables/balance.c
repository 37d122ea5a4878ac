/* bench/tables/balance.c - how equal the work of many processors is:
 * interesting voxels of the one that has most, over the mean, for three ways to
 * cut.
 *
 * All ranks wait for the slowest, so that with equal slabs of a head a third of
 * the machine stands idle however fast its network is.  Nothing is timed, so
 * nothing depends on the machine, and no ranks are needed: the library plans
 * the cuts on one. */
#include "bench.h"

#include <snowglass/ranks.h>

#include <stdio.h>
#include <stdlib.h>

#define RANKS_MOST 1024

static const int rank_counts[] = {8, 32, 128, RANKS_MOST};
static const double thresholds[] = {10, 30};
static const bench_set sets[] = {BENCH_HEAD, BENCH_ENGINE};

/* Slabs lie along z, the axis of the scan's slices. */
#define SLICE_AXIS 2

#define COUNT(array) (sizeof(array) / sizeof *(array))

enum { CUTS = 3 };
static const struct {
    snow_partition cut;
    const char *name;
} cuts[CUTS] = {{SNOW_PARTITION_EQUAL, "equal"},
                {SNOW_PARTITION_COUNTED, "counted"},
                {SNOW_PARTITION_BRICKS, "bricks"}};

typedef struct balance_row {
    double threshold;
    int ranks;
    int64_t interesting;
    double ratio[CUTS]; /* largest load over the mean one */
} balance_row;

static snow_status measure(const bench_volume *volume, balance_row *row) {
    static int64_t loads[RANKS_MOST];
    for (int i = 0; i < CUTS; i++) {
        snow_status status = snow_ranks_partition(
            volume->volume, volume->transfer, row->threshold, cuts[i].cut,
            SLICE_AXIS, row->ranks, NULL, loads);
        if (status != SNOW_STATUS_OK)
            return status;
        int64_t most = 0;
        row->interesting = 0;
        for (int rank = 0; rank < row->ranks; rank++) {
            row->interesting += loads[rank];
            most = loads[rank] > most ? loads[rank] : most;
        }
        row->ratio[i] = row->interesting ? (double)most * row->ranks /
                                               (double)row->interesting
                                         : 1;
    }
    return SNOW_STATUS_OK;
}

static json_t *row_json(const bench_volume *volume, const balance_row *row) {
    const int64_t *dims = snow_volume_get_info(volume->volume)->dims;
    json_t *json =
        json_pack("{s:s, s:s, s:[I,I,I], s:f, s:I, s:i}", "dataset",
                  volume->name, "source", volume->source, "dims",
                  (json_int_t)dims[0], (json_int_t)dims[1], (json_int_t)dims[2],
                  "threshold", row->threshold, "interesting_voxels",
                  (json_int_t)row->interesting, "ranks", row->ranks);
    for (int i = 0; i < CUTS; i++)
        json_object_set_new(json, cuts[i].name, json_real(row->ratio[i]));
    return json;
}

static void print_row(const bench_volume *volume, const balance_row *row) {
    printf("%-7s %4.0f %11lld %6d", volume->name, row->threshold,
           (long long)row->interesting, row->ranks);
    for (int i = 0; i < CUTS; i++)
        printf(" %8.3f", row->ratio[i]);
    printf("   %s\n", volume->source);
}

/* All lines of one volume. */
static snow_status do_volume(snow_context *context,
                             const bench_options *options, bench_set set,
                             json_t *list) {
    bench_volume volume;
    snow_status status = bench_volume_open(context, set, options, &volume);
    if (status != SNOW_STATUS_OK)
        return status;
    for (size_t t = 0; t < COUNT(thresholds); t++)
        for (size_t n = 0; n < COUNT(rank_counts) && status == SNOW_STATUS_OK;
             n++) {
            balance_row row = {.threshold = thresholds[t],
                               .ranks = rank_counts[n]};
            status = measure(&volume, &row);
            if (status == SNOW_STATUS_OK && list)
                json_array_append_new(list, row_json(&volume, &row));
            else if (status == SNOW_STATUS_OK)
                print_row(&volume, &row);
        }
    bench_volume_close(&volume);
    return status;
}

int bench_balance(snow_context *context, const bench_options *options) {
    json_t *list = options->json ? json_array() : NULL;
    if (!list)
        printf("Balance: interesting voxels of the rank that has most, over "
               "the mean\n(1: perfect; slabs along z; bricks are cut along "
               "all axes)\n\n"
               "volume     T interesting  ranks    equal  counted   bricks\n");
    for (size_t i = 0; i < COUNT(sets); i++) {
        snow_status status = do_volume(context, options, sets[i], list);
        if (status != SNOW_STATUS_OK) {
            json_decref(list);
            return bench_fail(context, status);
        }
    }
    if (!list)
        return SNOW_STATUS_OK;
    return bench_print_json(json_pack("{s:s, s:s, s:o}", "bench", "balance",
                                      "version", snow_version(), "rows", list));
}
