/* bench/ranks/ranks.h - what a picture takes many ranks, and whether it is the
 * picture of one.
 *
 *   ranks.c        options, and who the ranks are: threads, simulated or MPI's
 *   ranks_draw.c   the picture of one rank, and what every rank does
 *   ranks_print.c  a table, or JSON
 */
#ifndef SNOW_BENCH_RANKS_H
#define SNOW_BENCH_RANKS_H

#include "bench.h"
#include "simulated_network.h"

#include <snowglass/ranks.h>
#include <time.h>

#define RANKS_ROUNDS_MOST 16

typedef struct ranks_options {
    const char *path;
    snow_volume_options data;
    bench_list counts; /* of ranks that are threads */
    int side;          /* of the picture, in pixels */
    int runs;          /* pictures after the first, which also encodes */
    double threshold, azimuth, elevation;
    snow_partition cut;
    snow_combine combining;
    bool json;
    bool simulated;       /* whether `network` is, and time with it */
    snow_network network; /* one processor a rank */
} ranks_options;

/* The picture of one rank that is alone, and the seconds that it takes. */
typedef struct ranks_alone {
    snow_image *image;
    double seconds;
} ranks_alone;

/* Of each rank's pictures the least counts, for what disturbs a rank is not its
 * work.  Seconds of processor time for the splat, of the communicator's clock
 * for the rest: simulated where that is. */
typedef struct ranks_row {
    int ranks, rounds, radices[RANKS_ROUNDS_MOST];
    double splat_slowest, splat_mean;       /* up to the local image */
    double exchange_slowest, exchange_mean; /* combined, and gathered */
    double picture;                         /* until the last rank is done */
    uint64_t bytes_sent, bytes_in_place;    /* by all for one picture; of it
                                               read in the sender's memory */
    double difference; /* the largest from the picture of one rank */
} ranks_row;

/* A body for snow_comm_run_threads and the like; `user` is a ranks_session. */
typedef struct ranks_session {
    const ranks_options *options;
    const ranks_alone *alone; /* rank 0 needs it */
    ranks_row row;            /* filled in by rank 0 */
} ranks_session;
snow_status ranks_body(snow_comm *comm, void *user);

/* Draws the picture of one rank.  Errors: those of the library. */
snow_status ranks_draw_alone(snow_context *context,
                             const ranks_options *options, ranks_alone *out);

/* Prints all rows on stdout; the exit code. */
int ranks_print(const ranks_options *options, const char *of, double alone,
                const ranks_row *rows, int count);

#endif
