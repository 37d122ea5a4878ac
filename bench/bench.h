/* bench/bench.h - the paper's tables, measured again, and today's speed.
 *
 * All but tested splatting and a few stages (ranks_draw.c, speed_table.c)
 * stands on the public headers.  A row is verified before its times are
 * printed: all encodings give the same bits as testing the threshold voxel by
 * voxel, and at threshold 0 the same as the original. */
#ifndef SNOW_BENCH_H
#define SNOW_BENCH_H

#include "option_table.h"

#include "base/base.h"
#include "render/tested.h"

#include <jansson.h>
#include <snowglass/comm.h>
#include <snowglass/snowglass.h>

/* The verb: `argv[0]` is "bench".  Returns the tool's exit code. */
int bench_main(int argc, char **argv);

/* Whether all ranks run it; others but the first have nothing to do with it
 * otherwise. */
bool bench_for_all(int argc, char **argv);

/* What the user asked for. */
typedef struct bench_options {
    const char *data; /* folder of the real volumes; NULL: phantoms */
    bool json;
    int runs;           /* alternated runs whose median is taken */
    snow_kernel kernel; /* of tables 2 and 3 */
    double azimuth, elevation;
    /* Of `speed` only; NULL and 0 where nothing was asked. */
    bool quick, large;
    const char *volumes, *only; /* words, separated by commas */
    const char *sweep;          /* "sparse", "size" */
    const char *chart;          /* an SVG file */
    bench_list sides;           /* of the square pictures, in pixels */
    bench_list threads;
} bench_options;

/* A thing to measure: a file, and a line in bench.c. */
typedef struct bench_entry {
    const char *name;
    int (*run)(snow_context *context, const bench_options *options);
    unsigned of;     /* BENCH_OF_...: its options beside those of every one */
    bool needs_data; /* all three volumes, when --data is given */
} bench_entry;

#define BENCH_OF_TABLES 1u
#define BENCH_OF_FIGURES 2u
#define BENCH_OF_SPEED 4u
#define BENCH_OF_ALL 8u

/* Reads the options of one, after argv[0]; an exit code, or -1 to go on. */
int bench_options_read(const bench_entry *entry, int argc, char **argv,
                       bench_options *out);
int bench_print_help(void);

/* The paper's three test volumes. */
typedef enum bench_set { BENCH_CUBE, BENCH_HEAD, BENCH_ENGINE } bench_set;

/* Where a volume comes from. */
typedef struct bench_source {
    const char *name;            /* "Cube", "Head", ... */
    const char *phantom;         /* what stands in without --data */
    const char *file;            /* below --data; NULL: always the phantom */
    snow_volume_options options; /* of a raw file; dims of a phantom */
} bench_source;

/* A volume at 8 bits with the look of Table 1 (opacity is the value itself). */
typedef struct bench_volume {
    const char *name; /* "Cube", "Head", "Engine" */
    char source[256]; /* where it came from, and how it was mapped */
    snow_volume *file;
    unsigned char *mapped; /* voxels that are ours: scaled to 8 bits, or read
                              out of a .vti file; else NULL */
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

/* The paper's look: the opacity of a voxel is its value of 0 to 255, whatever
 * values the volume happens to have. */
extern const snow_look bench_linear_look;

/* The same for any source; *out has no transfer function then. */
const bench_source *bench_source_of(bench_set set);
bool bench_source_found(const bench_source *source,
                        const bench_options *options);
snow_status bench_source_open(snow_context *context, const bench_source *source,
                              const bench_options *options, bench_volume *out);

/* Reads 8-bit voxels out of VTK's ImageData; *voxels, which the volume shares,
 * is to be freed after it.  Errors: SNOW_STATUS_BAD_INPUT,
 * SNOW_STATUS_NO_MEMORY, told on stderr. */
snow_status bench_vti_open(snow_context *context, const char *path,
                           unsigned char **voxels, snow_volume **out);

/* The ways to splat that are compared. */
typedef enum bench_way {
    BENCH_ORIGINAL,
    BENCH_TESTED,
    BENCH_CRS,
    BENCH_BITMAP,
    BENCH_RLE,
    BENCH_WAYS
} bench_way;

/* Sets method and encoding. */
void bench_way_settings(bench_way way, snow_settings *settings);

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

/* Verifies, then times one row.  Errors: those of the library;
 * SNOW_STATUS_DIFFERENT when pictures differ that must not. */
snow_status bench_measure(snow_context *context, const bench_volume *volume,
                          const bench_options *options, double threshold,
                          int footprint, bench_row *out);

/* The paper's performance gain in percent (section 5.3). */
double bench_gain(const bench_row *row, bench_way way);

/* The tables; each prints itself and returns an exit code. */
int bench_table1(snow_context *context, const bench_options *options);
int bench_table2(snow_context *context, const bench_options *options);
int bench_table3(snow_context *context, const bench_options *options);

/* Speed-ups on many nodes: see figures.h. */
int bench_figure11(snow_context *context, const bench_options *options);
int bench_figure12(snow_context *context, const bench_options *options);

/* What a picture takes many ranks: those of `comm`, or, where that is NULL,
 * threads.  `argv[0]` is "ranks".  Returns the tool's exit code. */
int bench_ranks(int argc, char **argv, snow_comm *comm);

/* Today's speed, method by method: see speed.h. */
int bench_speed(snow_context *context, const bench_options *options);

/* The name of a method, of tested splatting too. */
const char *bench_method_name(snow_method method);

/* The median of some values, which are sorted by it. */
double bench_median(double *values, int count);

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
