/* bench/frame/frame.h - one whole picture of a volume by many ranks: how long,
 * how even, and whether it is the picture of one.
 *
 *   frame.c        options; ranks that are threads, simulated or MPI's
 *   frame_run.c    what every rank does, measures and tells the others
 *   frame_turn.c   pictures of a turning volume, with and without overlap
 *   frame_print.c  a line of key=value, or JSON
 *
 * It stands on the public headers only. */
#ifndef SNOW_BENCH_FRAME_H
#define SNOW_BENCH_FRAME_H

#include "metered_comm.h"
#include "simulated_network.h"

#include <snowglass/snowglass.h>

#include <snowglass/ranks.h>
#include <time.h>

/* Beyond so many ranks the picture of one is asked for with --check: a volume
 * that many share may be more than one can hold. */
#define FRAME_CHECKED_RANKS 64

/* Rounds of the exchange that are told. */
#define FRAME_ROUNDS_MOST 16

/* What cuts by time are told: they pay off always. */
#define FRAME_PICTURES_LEFT 1000000

typedef struct frame_options {
    const char *path;
    snow_volume_options data;
    int ranks; /* of the plain tool */
    int width, height;
    double threshold, azimuth, elevation;
    snow_partition cut;
    snow_combine combining;
    int radix; /* 0: chosen */
    int runs;  /* further pictures, of which the fastest counts */
    int turn;  /* pictures of a turning volume; 0: none */
    bool check, no_check, json;
    const char *profile;  /* a file for what each rank works, or NULL */
    double alpha, beta;   /* seconds a message, a byte, of the bound; below 0:
                             those of the network */
    bool simulated;       /* whether `network` is, and time with it */
    snow_network network; /* one processor a node */
} frame_options;

/* Stages in seconds of wall time, but those in which messages travel, and
 * totals: these are of the communicator's clock, and simulated where it is. */
typedef enum frame_stage {
    FRAME_READ,   /* opened, cut and counted; with the transfer function */
    FRAME_ENCODE, /* of the first picture: classified, shaded, encoded */
    FRAME_SPLAT,  /* splatted and composited */
    FRAME_EXCHANGE,
    FRAME_WARP,
    FRAME_GATHER,
    FRAME_TOTAL, /* a picture of what is encoded already */
    FRAME_FIRST, /* the first picture */
    /* The same in processor time. */
    FRAME_READ_CPU,
    FRAME_ENCODE_CPU, /* what the first picture took more than a later one */
    FRAME_SPLAT_CPU,
    FRAME_EXCHANGE_CPU,
    FRAME_WARP_CPU,
    FRAME_GATHER_CPU,
    FRAME_TOTAL_CPU,
    FRAME_FIRST_CPU,
    FRAME_WORK_CPU, /* of a later picture, beside the transport's */
    FRAME_STAGES
} frame_stage;

/* What one rank did. */
typedef struct frame_figures {
    double seconds[FRAME_STAGES];
    uint64_t messages, bytes; /* that it sent for a later picture */
    int64_t voxels;     /* interesting ones that it encodes: its own, and of
                           bricks those at the borders that neighbours own */
    int64_t slices;     /* of its part, along the view's slice axis */
    int64_t active;     /* pixels of its local image */
    uint64_t early;     /* bytes that it sent before that was drawn */
    double first_local; /* processor time of the first local image */
    int rounds, radices[FRAME_ROUNDS_MOST];
    snow_method method;
    double hidden; /* seconds a picture of a turning volume */
} frame_figures;

/* Over all ranks. */
typedef struct frame_result {
    int ranks, nodes, node_ranks; /* the most that a node has */
    int channels, rounds, radices[FRAME_ROUNDS_MOST];
    snow_method method;
    double most[FRAME_STAGES], mean[FRAME_STAGES];
    uint64_t messages_most, bytes_most, bytes_sum, early_sum;
    int64_t voxels_most, voxels_sum, slices_least, active_most;
    /* Processor time of local images after the last cut by time, if there is
     * one: medians of the pictures, of the slowest rank and in the mean. */
    double splat_most, splat_mean;
    double work_most, work_mean; /* the same of all work on a picture */
    int cuts;
    int64_t shown; /* pixels of the picture that are not transparent */
    bool checked;
    double difference; /* from the picture of one rank, if checked */
    /* Processor time of one rank, if checked: of a later picture, and of the
     * first one. */
    double alone, alone_first;
    int64_t voxels_whole; /* interesting ones of the volume, if checked */
    /* Of a turning volume: seconds a picture, one after another and
     * overlapping; of these what was drawn in waits, in the mean of all ranks;
     * whether the pictures are the same. */
    double apart, overlapped, hidden;
    bool same;
} frame_result;

typedef struct frame_session {
    const frame_options *options;
    bool threads;        /* whether ranks are threads of one process */
    frame_result result; /* filled in by rank 0 */
} frame_session;

/* What a rank has. */
typedef struct frame_rank {
    const frame_options *options;
    snow_comm *comm;
    snow_context *context;
    clockid_t cpu_clock;
    snow_view view;
    snow_settings settings;
    snow_ranks_options how;
    snow_volume *volume;
    snow_transfer *transfer;
    snow_frame *frame;
    snow_image *image; /* rank 0's */
    frame_figures mine, *all;
    /* Processor time of runs of each rank: of local images, of all work. */
    double *splats, *works;
    bench_meter meter; /* of `comm`, unless that is simulated */
    int cuts;          /* by time */
    int cut_before; /* the number of the run before which the last was made */
} frame_rank;

/* Collective: the figures of a turning volume. */
snow_status frame_turn(frame_rank *rank, frame_result *out);

/* A body for snow_comm_run_threads and the like; `user` is a frame_session. */
snow_status frame_body(snow_comm *comm, void *user);

/* A line for each rank: seconds of work before the exchange, between it and the
 * gather, and in the gather.  False: it cannot be written. */
bool frame_write_profile(const char *path, const frame_figures *all, int ranks);

/* Prints the line; the exit code, SNOW_STATUS_FAILED for a wrong picture. */
int frame_print(const frame_options *options, const frame_result *result);

/* The verb: `argv[0]` is "frame".  Its ranks are those of `comm`, or, where
 * that is NULL, threads.  Returns the tool's exit code. */
int frame_main(int argc, char **argv, snow_comm *comm);

#endif
