/* bench/bench.h - the paper's tables, measured again.
 *
 * Everything here stands on the public headers only.  A row is verified before
 * its times are printed: all encodings give the same bits as testing the
 * threshold voxel by voxel, and at threshold 0 the same as the original. */
#ifndef SNOW_BENCH_H
#define SNOW_BENCH_H

#include <jansson.h>
#include <snowglass/snowglass.h>

/* The verb: `argv[0]` is "bench".  Returns the tool's exit code. */
int bench_main(int argc, char **argv);

/* What the user asked for. */
typedef struct bench_options {
    const char *data; /* folder of the real volumes; NULL: phantoms */
    bool json;
    int runs;           /* alternated runs whose median is taken */
    snow_kernel kernel; /* of tables 2 and 3 */
    double azimuth, elevation;
} bench_options;

/* The paper's three test volumes. */
typedef enum bench_set { BENCH_CUBE, BENCH_HEAD, BENCH_ENGINE } bench_set;

/* A volume at 8 bits with the look of Table 1 (opacity is the value itself). */
typedef struct bench_volume {
    const char *name; /* "Cube", "Head", "Engine" */
    char source[256]; /* where it came from, and how it was mapped */
    snow_volume *file;
    unsigned char *mapped; /* voxels scaled to 8 bits, or NULL */
    snow_volume *volume;   /* what is rendered: `file`, or over `mapped` */
    snow_transfer *transfer;
} bench_volume;

/* Whether the files of --data can be read; if not, stderr was told.  Asked
 * before the first line of a table, since rows are printed as they come. */
bool bench_data_found(const bench_options *options);

/* Opens a test volume.  Errors as those of the library, told on stderr. */
snow_status bench_volume_open(snow_context *context, bench_set set,
                              const bench_options *options, bench_volume *out);
void bench_volume_close(bench_volume *volume);

/* The ways to splat that are compared. */
typedef enum bench_way {
    BENCH_ORIGINAL,
    BENCH_TESTED,
    BENCH_CRS,
    BENCH_BITMAP,
    BENCH_RLE,
    BENCH_WAYS
} bench_way;

/* Medians over the runs, in milliseconds. */
typedef struct bench_time {
    double encode; /* classification and writing of EA, IA, PA; 0 without */
    double splat;  /* footprints and compositing */
    double frame;  /* all */
    double cpu;    /* all, in processor time: beside other work it tells more */
} bench_time;

typedef struct bench_row {
    double sparse_ratio; /* 0 to 1 */
    uint64_t ea_bytes[BENCH_WAYS];
    bench_time times[BENCH_WAYS];
} bench_row;

/* Verifies, then times one row.  Errors: those of the library; SNOW_DIFFERENT
 * when pictures differ that must not. */
snow_status bench_measure(snow_context *context, const bench_volume *volume,
                          const bench_options *options, double threshold,
                          int footprint, bench_row *out);

/* The paper's performance gain in percent (section 5.3). */
double bench_gain(const bench_row *row, bench_way way);

/* The tables; each prints itself and returns an exit code. */
int bench_table1(snow_context *context, const bench_options *options);
int bench_table2(snow_context *context, const bench_options *options);
int bench_table3(snow_context *context, const bench_options *options);

/* A line of tables 2 and 3: the paper's figures, in seconds on its SP2. */
typedef struct bench_paper_row {
    bench_set set;
    const char *label;
    double threshold;
    int footprint;
    double paper_sr;            /* percent; 0 when the table does not give it */
    double seconds[BENCH_WAYS]; /* 0 where the paper gives none */
    double gain[BENCH_WAYS];    /* percent, as printed there */
} bench_paper_row;

/* Measures and prints lines of table 2 or 3. */
int bench_print_rows(snow_context *context, const bench_options *options,
                     int table, const bench_paper_row *rows, size_t count);

/* {"cpu": ..., "version": ...}: where the figures come from. */
json_t *bench_machine(void);

/* Prints a JSON object on stdout and drops it; the exit code. */
int bench_print_json(json_t *object);

/* Tells an error of the library on stderr and passes its code on. */
int bench_fail(snow_context *context, snow_status status);

#endif
