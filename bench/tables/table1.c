/* bench/tables/table1.c - Table 1 of the paper: the test volumes and their
 * sparse ratios, the share of voxels that are not above an opacity threshold.
 *
 * Nothing is timed, so nothing depends on the machine.  The paper publishes
 * neither its Cube nor how it put Head on 8 bits: there ours are models. */
#include "bench.h"

#include <stdio.h>

#define COLUMNS 3

static const double thresholds[COLUMNS] = {0, 10, 30};

/* The paper's percentages, as printed there. */
static const struct {
    bench_set set;
    int paper_dims[3];
    double paper[COLUMNS]; /* percent */
} rows[] = {
    {BENCH_CUBE, {256, 256, 110}, {98, 98, 98}},
    {BENCH_HEAD, {256, 256, 113}, {0, 47, 70}},
    {BENCH_ENGINE, {256, 256, 110}, {27, 77, 81}},
};

#define ROW_COUNT (sizeof rows / sizeof rows[0])

/* Three lists side by side: threshold, the paper's percentage, ours. */
static json_t *row_json(const bench_volume *volume, const int64_t *dims,
                        const double *paper, const double *ours) {
    json_t *json =
        json_pack("{s:s, s:s, s:[I,I,I], s:[], s:[], s:[]}", "dataset",
                  volume->name, "source", volume->source, "dims",
                  (json_int_t)dims[0], (json_int_t)dims[1], (json_int_t)dims[2],
                  "threshold", "paper_percent", "percent");
    for (int i = 0; i < COLUMNS; i++) {
        json_array_append_new(json_object_get(json, "threshold"),
                              json_real(thresholds[i]));
        json_array_append_new(json_object_get(json, "paper_percent"),
                              json_real(paper[i]));
        json_array_append_new(json_object_get(json, "percent"),
                              json_real(ours[i]));
    }
    return json;
}

/* With the source last, since its length varies: a phantom's figures must not
 * be taken for the real volume's. */
static void print_row(const bench_volume *volume, const int64_t *dims,
                      const double *paper, const double *ours) {
    printf("%-7s %3lldx%lldx%-5lld", volume->name, (long long)dims[0],
           (long long)dims[1], (long long)dims[2]);
    for (int i = 0; i < COLUMNS; i++)
        printf("  %5.0f %6.1f", paper[i], ours[i]);
    printf("   %s\n", volume->source);
}

/* Measures one row and prints or appends it. */
static snow_status do_row(snow_context *context, const bench_options *options,
                          size_t index, json_t *list) {
    bench_volume volume;
    double ours[COLUMNS];
    snow_status status =
        bench_volume_open(context, rows[index].set, options, &volume);
    if (status != SNOW_STATUS_OK)
        return status;
    for (int i = 0; i < COLUMNS && status == SNOW_STATUS_OK; i++) {
        status = snow_transfer_sparse_ratio(volume.transfer, volume.volume,
                                            thresholds[i], &ours[i]);
        ours[i] *= 100;
    }
    if (status == SNOW_STATUS_OK) {
        const int64_t *dims = snow_volume_get_info(volume.volume)->dims;
        if (list)
            json_array_append_new(
                list, row_json(&volume, dims, rows[index].paper, ours));
        else
            print_row(&volume, dims, rows[index].paper, ours);
    }
    bench_volume_close(&volume);
    return status;
}

int bench_table1(snow_context *context, const bench_options *options) {
    json_t *list = options->json ? json_array() : NULL;
    if (!list)
        printf("Table 1: sparse ratio, percent of voxels whose opacity "
               "(0-255) is not above T\n\n"
               "volume  dimensions        T = 0          T = 10         "
               "T = 30\n"
               "                        paper   ours   paper   ours   "
               "paper   ours\n");
    for (size_t i = 0; i < ROW_COUNT; i++) {
        snow_status status = do_row(context, options, i, list);
        if (status != SNOW_STATUS_OK) {
            json_decref(list);
            return bench_fail(context, status);
        }
    }
    if (!list)
        return SNOW_STATUS_OK;
    return bench_print_json(json_pack("{s:i, s:o, s:o}", "table", 1, "machine",
                                      bench_machine(), "rows", list));
}
