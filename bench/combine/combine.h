/* bench/combine/combine.h - how fast, and how evenly, local images are
 * combined.
 *
 *   combine.c          options; the plain tool, whose ranks are threads
 *   combine_pattern.c  local images of a benchmark: slabs of a cube
 *   combine_file.c     local images that are pictures in files
 *   combine_run.c      one exchange and one gather, verified and counted
 *   combine_rates.c    what a processor takes for a pixel
 *   combine_print.c    a line of key=value, or JSON
 *   mpi_combine.c      the same as a program of its own, for MPI
 *   simulate/          builds that one for simulated networks, and runs it
 *
 * The stage that is measured is inside the library: unlike other benchmarks
 * this one sees its headers. */
#ifndef SNOW_BENCH_COMBINE_H
#define SNOW_BENCH_COMBINE_H

#include "combine/exchange.h"
#include "hosts.h"

#include <snowglass/image.h>

#include <stdio.h>

typedef struct combine_options {
    int ranks;         /* of the plain tool */
    int threads;       /* of a rank */
    int width, height; /* of the picture, in pixels; of --pattern FILE, told by
                          the files */
    const char *pattern; /* NULL: a cube's slabs; else the files' name */
    int channels;        /* 2 or 4 */
    int bits;            /* of a gathered channel: 8, or 0 for floats */
    snow_combine method;
    int radix, gather; /* 0: chosen */
    snow_image_partition regions;
    bool whole;
    bool sizes_only; /* no pixels: messages of the right length */
    bool check;
    bool rates; /* only measure one rank's processors */
    bool json;
    int runs; /* of which the fastest counts */
    double azimuth, elevation, fill, cube;
    int grain;          /* of the pattern: pixels that are active together */
    double alpha, beta; /* seconds a message, seconds a byte: of the bound */
    /* Seconds a pixel, of a simulated processor: to look at one, to lay one
     * over another, to round one, and to move 16 bytes. */
    double scan, blend, round, move;
    const char *profile; /* of bench frame, or NULL */
    bool simulated;
} combine_options;

/* Reads the options after the verb's name; an exit code, or -1 to go on.
 * `said` may be NULL: ranks but the first say nothing. */
int combine_parse(int argc, char **argv, combine_options *out, FILE *said);

/* The verb: `argv[0]` is "combine".  All ranks of `comm` call it; NULL: the
 * ranks are threads.  Returns the tool's exit code. */
int combine_main(int argc, char **argv, snow_comm *comm);

/* One rank's local image. */
typedef struct combine_pattern {
    int width, height, channels;
    int slab, slabs, grain;
    uint32_t threshold; /* active below it, of 2^16 */
    snow_rectangle drawn;
    int *spans; /* of each line: its first column, and that after its last */
    /* Of a file: its picture (NULL where sizes alone are asked for), and a bit
     * for each pixel, so many words for each line. */
    snow_image *image;
    uint64_t *mask;
    size_t line_words;
} combine_pattern;

/* A slab of the cube.  Memory of the caller's: 2 * height numbers in `spans`.
 */
void combine_pattern_make(const combine_options *options, int slab, int slabs,
                          int *spans, combine_pattern *out);

/* As snow_rehearsal's: bits of pixels of line y. */
uint64_t combine_pattern_active(void *pattern, int y, int x, int count);

/* A pixel's channels, all 0 where it is not active. */
void combine_pattern_pixel(const combine_pattern *pattern, int x, int y,
                           float *out);

/* A file's picture, of a name that is one.  Errors: SNOW_STATUS_BAD_INPUT,
 * SNOW_STATUS_NO_MEMORY.  Nothing is to be closed of a cube's slab. */
snow_status combine_file_open(snow_context *context,
                              const combine_options *options, int slab,
                              combine_pattern *out);
void combine_file_close(snow_context *context, combine_pattern *pattern);

/* The name of a rank's file; false where it is none. */
#define COMBINE_NAME_BYTES 4096
bool combine_file_name(const char *name, int slab, char *out, size_t room);

uint64_t combine_file_active(const combine_pattern *pattern, int y, int x,
                             int count);
void combine_file_pixel(const combine_pattern *pattern, int x, int y,
                        float *out);

/* Times of one run in seconds on this rank; counters of it. */
typedef struct combine_figures {
    double exchange, gather, total; /* wall, or simulated */
    double exchange_cpu, gather_cpu;
    int64_t bytes_sent, messages, bytes_lent, active, scanned, laid;
    int64_t exchange_bytes, exchange_messages;
    int64_t shown;     /* pixels of the piece that are not nothing */
    double difference; /* from the serial picture; -1: not looked at */
} combine_figures;

/* Over all ranks. */
typedef struct combine_result {
    int ranks, width, height;
    bench_hosts hosts;
    snow_exchange_figures given;
    combine_figures most, sum;
} combine_result;

/* A body for snow_comm_run_threads and the like; `user` is a combine_session.
 */
typedef struct combine_session {
    const combine_options *options;
    combine_result result; /* filled in by rank 0 */
} combine_session;
snow_status combine_body(snow_comm *comm, void *user);

/* Runs the body on every rank of a communicator, the first of which prints;
 * the exit code. */
int combine_run(snow_comm *comm, combine_session *session);

/* Measures what the threads of a rank take for a pixel; the exit code. */
int combine_rates(const combine_options *options);

/* Prints the line; the exit code. */
int combine_print(const combine_session *session);

/* The active pixels of a region, in memory that is used again. */
typedef struct combine_gather {
    snow_pixel_run *runs;
    unsigned char *packed;
    int64_t packed_capacity;
    size_t packed_bytes; /* of a pixel */
} combine_gather;

/* Collective. Gathers the regions of the last exchange: with `bits` 8 channels
 * are rounded to steps of 1/255, one byte each; with 0 they are floats. Errors:
 * as for snow_gather. */
snow_status combine_gather_region(snow_combiner *combiner,
                                  combine_gather *state,
                                  const snow_image_region *region, int bits,
                                  double round_seconds, void *picture);
void combine_round_pixels(const float *pixels, int64_t floats,
                          unsigned char *out);
void combine_gather_free(snow_context *context, combine_gather *state);

#endif
