/* bench/speed/speed.h - how fast pictures are made today: every method against
 * `original` (each voxel), `original-table` (the same by a footprint table) and
 * `tested` (each voxel asked for its opacity).
 *
 *   speed.c          what was asked, which cases, the sweeps
 *   speed_ways.c     the methods that are compared, and the words of --only
 *   speed_table.c    original splatting by a footprint table, only here
 *   speed_volumes.c  volumes and their looks
 *   speed_verify.c   no time of a wrong picture
 *   speed_time.c     times, taken in turns
 *   speed_print.c    text and JSON
 */
#ifndef SNOW_BENCH_SPEED_H
#define SNOW_BENCH_SPEED_H

#include "bench.h"
#include "machine.h"

#define SPEED_ROWS_MOST 128
#define SPEED_WAYS_MOST 20
#define SPEED_POWERS_MOST (BENCH_LIST_MOST + 1)

typedef enum speed_look { SPEED_TRANSLUCENT, SPEED_OPAQUE } speed_look;

/* A way to make a picture. */
typedef struct speed_way {
    const char *name;
    snow_method method;
    bool tabled;            /* original by a footprint table */
    snow_encoding encoding; /* AUTO where there is none, too */
    snow_quality quality;   /* of sheared */
    snow_kernel kernel;
    int footprint;
    /* Beyond these, against the exact picture with the same kernel, nothing is
     * timed: PSNR in dB at least, unshaded and with Phong's model, for each
     * look; largest difference at most. */
    double psnr[2][2], largest;
    const char *charted; /* its line in charts, NULL for none */
} speed_way;

extern const speed_way speed_ways[];
extern const int speed_way_count; /* at most SPEED_WAYS_MOST */

/* `original`, `original-table` and `tested`: what the others are compared with;
 * one thread. */
bool speed_is_baseline(const speed_way *way);

/* The kinds of words that --only knows.  Words of one kind add up, kinds
 * restrict each other; a kind without words restricts nothing. */
typedef enum speed_kind {
    SPEED_LOOK,
    SPEED_COLOR,
    SPEED_SHADE,
    SPEED_METHOD,
    SPEED_ENCODING,
    SPEED_QUALITY,
    SPEED_KERNEL,
    SPEED_KINDS
} speed_kind;

typedef struct speed_filter {
    unsigned taken[SPEED_KINDS]; /* a bit for each value; 0: all of them */
} speed_filter;

/* Reads the words of --only (NULL: none).  False for a word that is none, of
 * which stderr was told. */
bool speed_filter_read(const char *words, speed_filter *out);
bool speed_filter_takes(const speed_filter *filter, speed_kind kind, int value);

/* Whether a way is measured: it passes the filter, and a baseline has others
 * with its kernel to compare with, or all alone.  In sweeps only ways with a
 * line in the chart. */
bool speed_way_taken(const speed_filter *filter, bool sweep, int way);

/* One picture that all ways make. */
typedef struct speed_case {
    const bench_volume *volume; /* with the look's transfer function */
    speed_look look;
    bool color; /* four channels, else two */
    snow_shade shade;
    int side; /* of the picture, in pixels */
    double threshold;
    bool sweep;
    bool original_known; /* verified before: it knows no threshold */
} speed_case;

/* A way's figures for a number of threads.  Milliseconds; a figure that there
 * is none of is -1. */
typedef struct speed_row {
    const speed_way *way;
    int threads;
    int frames;         /* that were timed */
    int encoded_frames; /* of these, so many encoded the volume anew */
    snow_stats stats;   /* of the last one */
    double median, least, cpu;
    double serial, longest; /* of one thread, least: what more would not share,
                               and the longest items of what they would */
    double encode;          /* classification and writing of EA, IA, PA */
    double new_threshold;   /* the whole frame in which that happens */
    double psnr, largest;   /* against the exact picture; psnr -1: equal */
} speed_row;

typedef struct speed_result {
    double sparse_ratio; /* 0 to 1 */
    int64_t interesting; /* voxels */
    double load, others; /* machine_load, machine_others */
    int count;
    speed_row rows[SPEED_ROWS_MOST];
} speed_result;

/* What original-table keeps from picture to picture; one thread. */
typedef struct speed_table speed_table;

/* A picture; *table begins as NULL.  Errors: SNOW_STATUS_BAD_USAGE (the view or
 * a setting), SNOW_STATUS_NO_MEMORY. */
snow_status speed_table_render(snow_context *context, speed_table **table,
                               const snow_volume *volume,
                               const snow_transfer *transfer,
                               const snow_view *view,
                               const snow_settings *settings, snow_stats *stats,
                               snow_image **image);
void speed_table_free(snow_context *context, speed_table *table);

/* All that verifying and timing of one case share. */
typedef struct speed_session {
    snow_context *context;
    const speed_case *job;
    const bench_options *options;
    snow_view view;
    /* That is drawn, and the same as voxels that may change, so that each
     * picture encodes them. */
    const snow_volume *volume;
    snow_volume *changing;
    snow_frame *frames[SPEED_WAYS_MOST]; /* each way keeps its encoding */
    speed_table *table;                  /* of original-table; NULL: none yet */
    snow_stats table_stats;
} speed_session;

/* The view at the n-th step of the turn; owned by the session. */
const snow_view *speed_view(speed_session *session, int step);

/* Renders a way at the n-th step of the turn; threads 0 means one.  *image may
 * be NULL, and is the caller's otherwise. */
snow_status speed_render(speed_session *session, int way, snow_isa isa,
                         int threads, double threshold, int step,
                         snow_image **image);

/* Of the last picture of a way. */
const snow_stats *speed_stats(const speed_session *session, int way);

/* Verifies the ways of the result's rows, fills in psnr and largest, and takes
 * out the rows that this library draws by another method.  Errors: of the
 * library; SNOW_STATUS_DIFFERENT when a picture is wrong, told on stderr. */
snow_status speed_verify(speed_session *session, speed_result *result);

/* Times the rows.  Errors: those of the library. */
snow_status speed_time(speed_session *session, speed_result *result);

/* All of a case: rows made, verified, timed. */
snow_status speed_measure(snow_context *context, const bench_options *options,
                          const speed_filter *filter, const speed_case *job,
                          speed_result *out);

/* Volumes by index, NULL past the end; whether one is measured, by what was
 * asked. */
const bench_source *speed_source(const bench_options *options, int index);
bool speed_source_taken(const bench_options *options, int index);

/* False when --volumes names one that is not there; stderr was told. */
bool speed_volumes_known(const bench_options *options);

/* The look's transfer function into volume->transfer, anew.  Errors: those of
 * snow_transfer_new. */
snow_status speed_dress(snow_context *context, bench_volume *volume,
                        speed_look look, bool color);

/* Opacity for one step of the value: 0.2/255 or 2/255. */
double speed_slope(speed_look look);

/* The machine's line; text, or the object of JSON. */
typedef struct speed_machine {
    int count; /* of measured thread numbers */
    machine_power power[SPEED_POWERS_MOST];
} speed_machine;

void speed_print_machine(const speed_machine *machine);
json_t *speed_machine_json(const speed_machine *machine);

/* A case and its rows: printed, or appended to `list`. */
void speed_print_case(const speed_machine *machine, const speed_case *job,
                      const speed_result *result, json_t *list);

#endif
