/* bench/tables/rows.c - tables 2 and 3 as text and as JSON.
 *
 * Our milliseconds and the paper's seconds are of machines decades apart: the
 * times cannot be compared, the gains can.  So text puts the paper's gain
 * beside each of ours and its seconds below; JSON gives all. */
#include "bench.h"
#include "machine.h"

#include <stdio.h>

/* Keys of JSON, in the order of the enum: a promise to scripts. */
static const char *const way_names[BENCH_WAYS] = {"original", "tested", "crs",
                                                  "bitmap", "rle"};

/* A time without its machine means nothing.  Where there is no /proc the
 * processor is "unknown", which is no reason to fail. */
json_t *bench_machine(void) {
    return json_pack("{s:s, s:s, s:s, s:s, s:i}", "cpu", machine_processor(),
                     "version", snow_version(), "compiler", machine_compiler(),
                     "isa", snow_isa_used(), "threads", 1);
}

/* Flushed here, so that a full disk ends in exit code 4. */
int bench_print_json(json_t *object) {
    int failed = json_dumpf(object, stdout, JSON_INDENT(2)) ||
                 putchar('\n') < 0 || fflush(stdout);
    json_decref(object);
    return failed ? SNOW_STATUS_BAD_OUTPUT : SNOW_STATUS_OK;
}

/* What a way has no figure for is left out: the original has no gain over
 * itself and no encoded array, and the paper does not give every line. */
static json_t *way_json(const bench_paper_row *paper, const bench_row *row,
                        int way) {
    const bench_time *time = &row->times[way];
    json_t *json = json_pack("{s:f, s:f, s:f, s:f}", "encode_ms", time->encode,
                             "splat_ms", time->splat, "total_ms", time->frame,
                             "total_cpu_ms", time->cpu);
    if (way != BENCH_ORIGINAL)
        json_object_set_new(json, "gain_percent",
                            json_real(bench_gain(row, (bench_way)way)));
    if (row->ea_bytes[way])
        json_object_set_new(json, "ea_bytes",
                            json_integer((json_int_t)row->ea_bytes[way]));
    if (paper->seconds[way] > 0) {
        json_object_set_new(json, "paper_seconds",
                            json_real(paper->seconds[way]));
        if (way != BENCH_ORIGINAL)
            json_object_set_new(json, "paper_gain_percent",
                                json_real(paper->gain[way]));
    }
    return json;
}

/* "verified" is always true: a row that fails is not printed.  The key lets a
 * script see that it was asked. */
static json_t *row_json(const bench_paper_row *paper, const bench_row *row,
                        const char *source) {
    json_t *json = json_pack(
        "{s:s, s:s, s:f, s:i, s:f, s:f, s:b}", "dataset", paper->label,
        "source", source, "threshold", paper->threshold, "footprint",
        paper->footprint, "paper_sparse_percent", paper->paper_sr,
        "sparse_percent", 100 * row->sparse_ratio, "verified", 1);
    for (int way = 0; way < BENCH_WAYS; way++)
        json_object_set_new(json, way_names[way], way_json(paper, row, way));
    return json;
}

/* All that is needed to understand the columns, above them: tables are copied
 * into mails without their manual. */
static void print_head(int table, const bench_options *options) {
    printf("Table %d: milliseconds for a 256x256 grey picture, encoding "
           "included; medians of %d alternated runs\n"
           "kernel %s, one thread, preset linear, no shading; (e + s) is "
           "encoding + splatting\n"
           "gain: (original - this) / original; in brackets the paper's gain "
           "on its SP2\n"
           "tested: original splatting that tests the threshold voxel by "
           "voxel\n\n"
           "volume  T   KxK   SR%%  original  tested gain | "
           "CRS   (e + s)        gain      | bit-map (e + s)      gain      | "
           "RLE   (e + s)        gain\n",
           table, options->runs, snow_kernel_name(options->kernel));
}

/* Flushed line by line: a table takes minutes, and who waits wants to see. */
static void print_row(const bench_paper_row *paper, const bench_row *row) {
    printf("%-7s %-3g %dx%d  %5.1f %8.1f  %6.1f %3.0f%%", paper->label,
           paper->threshold, paper->footprint, paper->footprint,
           100 * row->sparse_ratio, row->times[BENCH_ORIGINAL].frame,
           row->times[BENCH_TESTED].frame, bench_gain(row, BENCH_TESTED));
    for (int way = BENCH_CRS; way < BENCH_WAYS; way++) {
        const bench_time *time = &row->times[way];
        printf(" | %6.1f (%4.1f + %5.1f) %3.0f%% ", time->frame, time->encode,
               time->splat, bench_gain(row, (bench_way)way));
        if (paper->seconds[way] > 0)
            printf("(%2.0f%%)", paper->gain[way]);
        else
            printf("( - )");
    }
    printf("\n");
    fflush(stdout);
}

/* The paper's own seconds, below our milliseconds. */
static void print_paper(const bench_paper_row *rows, size_t count) {
    printf("\nThe paper's seconds (66.7 MHz POWER2): original, CRS, bit-map, "
           "RLE\n");
    for (size_t i = 0; i < count; i++)
        if (rows[i].seconds[BENCH_ORIGINAL] > 0)
            printf("%-7s %-3g %dx%d  %7.3f %7.3f %7.3f %7.3f\n", rows[i].label,
                   rows[i].threshold, rows[i].footprint, rows[i].footprint,
                   rows[i].seconds[BENCH_ORIGINAL], rows[i].seconds[BENCH_CRS],
                   rows[i].seconds[BENCH_BITMAP], rows[i].seconds[BENCH_RLE]);
}

/* Measures one line; it is printed, or appended to the list.  The volume is
 * opened anew for each: reading is not timed, and one at a time is in memory.
 */
static snow_status do_row(snow_context *context, const bench_options *options,
                          const bench_paper_row *paper, json_t *list) {
    bench_volume volume;
    bench_row row = {0};
    SNOW_TRY(bench_volume_open(context, paper->set, options, &volume));
    snow_status status = bench_measure(
        context, &volume, options, paper->threshold, paper->footprint, &row);
    if (status == SNOW_STATUS_OK && list)
        json_array_append_new(list, row_json(paper, &row, volume.source));
    else if (status == SNOW_STATUS_OK)
        print_row(paper, &row);
    bench_volume_close(&volume);
    return status;
}

/* SNOW_STATUS_DIFFERENT was told where it was found, and is no "comparison
 * differs" of the user's pictures (exit code 6) but a fault of ours. */
int bench_print_rows(snow_context *context, const bench_options *options,
                     int table, const bench_paper_row *rows, size_t count) {
    json_t *list = options->json ? json_array() : NULL;
    if (!list)
        print_head(table, options);
    for (size_t i = 0; i < count; i++) {
        snow_status status = do_row(context, options, &rows[i], list);
        if (status != SNOW_STATUS_OK) {
            json_decref(list);
            return status == SNOW_STATUS_DIFFERENT
                       ? SNOW_STATUS_FAILED
                       : bench_fail(context, status);
        }
    }
    if (!list) {
        print_paper(rows, count);
        return SNOW_STATUS_OK;
    }
    return bench_print_json(
        json_pack("{s:i, s:i, s:s, s:o, s:o}", "table", table, "runs",
                  options->runs, "kernel", snow_kernel_name(options->kernel),
                  "machine", bench_machine(), "rows", list));
}
