/* combine/exchange.h - the exchange step: the local images of many processors
 * (combination, Cb in figure 7) become one picture.
 *
 * There are two steps. The exchange leaves every rank with a region of the
 * picture, in which all local images are composited; the gather sends regions
 * to the display processor. Between the two a rank may process its region: warp
 * it, or round it to 8 bits.
 *
 *   local images   ranks[0] nearest         regions          the picture
 *   +-------+ +-------+ +-------+           +-------+        +-------+
 *   |  ##   | | ###   | |       |  exchange |   0   | gather |       |
 *   |  ##   | |   ##  | |   ### | --------> |---1---| -----> |       |
 *   |       | |       | |   ### |           |   2   |        |       |
 *   +-------+ +-------+ +-------+           +-------+        +-------+
 *
 * Pixels are numbered line by line, beginning with line 0; a region is a run of
 * these numbers. */
#ifndef SNOW_EXCHANGE_H
#define SNOW_EXCHANGE_H

#include "combine/pixels.h"
#include "comm/comm.h"

#include <snowglass/ranks.h>

/* Columns x0 .. x1 - 1 of lines y0 .. y1 - 1; empty if x0 >= x1. */
typedef struct snow_rectangle {
    int x0, y0, x1, y1;
} snow_rectangle;

/* The partition of the picture into regions. */
typedef enum snow_image_partition {
    SNOW_IMAGE_PARTITION_AUTO = 0, /* counted if that is faster, else even */
    SNOW_IMAGE_PARTITION_EVEN,     /* equal numbers of pixels */
    SNOW_IMAGE_PARTITION_COUNTED /* about equal numbers of active pixels of all
                                    local images together, but at most four
                                    times an even region; costs a reduction
                                    among the ranks */
} snow_image_partition;

/* The parameters of an exchange. All except `pixels`, `stride` and `drawn` are
 * the same on all ranks. */
typedef struct snow_exchange_params {
    int width, height, channels; /* of the picture; 2 (grey, a) or 4 (r, g, b,
                                    a), premultiplied */
    const float *pixels;         /* the local image: its line 0, column 0 */
    size_t stride;               /* floats from line to line */
    snow_rectangle drawn; /* pixels outside are transparent and not read */
    const int *ranks;     /* from front to back */
    snow_combine method;
    int radix; /* of RADIX, at least 2; 0: chosen */
    int grain; /* regions are whole runs of this many pixels: 1, or width */
    snow_image_partition
        regions; /* for all methods except the tree, which has one */
    snow_composite_op composite_op; /* for 2 channels if it is not over */
    int threads; /* of the communicator's context, that look at pixels and
                    composite them; 0: 1. Ranks may have different numbers */
    /* snow_exchange_counts, summed over all ranks: the borders of counted
     * regions; NULL: from the local images. */
    const int64_t *counts;
    int count_groups;
} snow_exchange_params;

/* This rank's region of the picture: pixels first .. first + count - 1; count
 * may be 0. Owned by the combiner until its next exchange. Bit i % 64 of
 * active[i / 64 - first / 64] is set if pixel i is active. */
typedef struct snow_image_region {
    int64_t first, count;
    float *pixels;
    const uint64_t *active;
} snow_image_region;

/* Figures of the last exchange, for benchmarks. */
#define SNOW_ROUNDS_MOST 32
typedef struct snow_exchange_figures {
    snow_combine method; /* as chosen by AUTO */
    int rounds, radices[SNOW_ROUNDS_MOST];
    bool counted;          /* whether regions were counted */
    int64_t active;        /* active pixels of the local image */
    int64_t scanned, laid; /* pixels examined; pixels composited */
    int64_t early;         /* bytes sent before the local image was finished */
    double begin_at; /* fraction of the picture's pixels after which a rank
                        should begin to draw, so that it can send more of them
                        early: its own are drawn last */
} snow_exchange_figures;

/* A combiner's buffers are reused from picture to picture. Free it before its
 * communicator. */
typedef struct snow_combiner snow_combiner;
snow_status snow_combiner_new(snow_comm *comm, snow_combiner **out);
void snow_combiner_free(snow_combiner *combiner);

/* Collective. Over is associative, so all methods give the picture of a chain
 * except for float rounding, and the same bits every time. A second exchange of
 * the same sizes, method and regions allocates nothing; with counted regions,
 * unless they are larger than before. Errors, the same on all ranks:
 * SNOW_STATUS_NO_MEMORY, SNOW_STATUS_BAD_USAGE (invalid params), those of the
 * transport. */
snow_status snow_exchange(snow_combiner *combiner,
                          const snow_exchange_params *params,
                          snow_image_region *out);

/* The same of a local image that is still drawn: its parts are sent as they are
 * finished.
 *
 *   begin
 *   while some of the image is not drawn:
 *       send each part that the exchange awaits and whose lines are finished
 *       draw a little more; progress
 *   end
 *
 * `drawn` of the params is not read; what `ranks` and `counts` point to must
 * last until the end. Regions that are counted without `counts`
 * need all of the image before anything is sent. After an error the exchange is
 * over. Begin and end are collective, with the errors of snow_exchange. */
snow_status snow_exchange_begin(snow_combiner *combiner,
                                const snow_exchange_params *params);

/* Returns whether there is an n-th part that was not sent; it needs lines y0
 * .. y1 - 1 of the local image. */
bool snow_exchange_awaits(const snow_combiner *combiner, int n, int *y0,
                          int *y1);

/* Sends the n-th part, in whose lines pixels outside `drawn` are transparent;
 * the parts behind it move up. */
snow_status snow_exchange_send(snow_combiner *combiner, int n,
                               snow_rectangle drawn);

/* Call it after drawing a little: lets messages go on, and counts what was sent
 * as early. */
void snow_exchange_progress(snow_combiner *combiner);

snow_status snow_exchange_end(snow_combiner *combiner, snow_rectangle drawn,
                              snow_image_region *out);

const snow_exchange_figures *
snow_exchange_get_figures(const snow_combiner *combiner);

/* The region of every rank after an exchange. firsts[rank + 1] need not be the
 * end of firsts[rank], so counts are given too. */
void snow_exchange_regions(const snow_combiner *combiner, int64_t *firsts,
                           int64_t *counts);

/* This rank's active pixels in groups of lines of the picture of the last
 * exchange, at most SNOW_COUNTS_MOST groups. Returns the number of groups, the
 * same on all ranks; 0 if regions were not counted. Use them for the next
 * picture, which is often similar; counts with another number of groups are
 * ignored. */
#define SNOW_COUNTS_MOST 256
int snow_exchange_counts(const snow_combiner *combiner, const int64_t **counts);

/* Consecutive pixels of one line of the picture. */
typedef struct snow_pixel_run {
    int32_t x, y, count;
} snow_pixel_run;

/* Collective. Sends runs of packed pixels of `pixel_bytes` each to rank 0,
 * where they are copied into `picture` (width * height * pixel_bytes, cleared
 * by the caller); on the other ranks it may be NULL. Runs of all ranks must not
 * overlap. Transparent runs may be omitted; a run costs SNOW_RUN_BYTES besides
 * its pixels. Runs of a line go from left to right; gaps between them of fewer
 * bytes than that must be sent.
 * Sides are at most 65535. Errors: as for snow_exchange; on one rank alone
 * SNOW_STATUS_BAD_USAGE and SNOW_STATUS_NO_MEMORY, for its own runs, which then
 * are missing in the picture. */
#define SNOW_RUN_BYTES 6
snow_status snow_gather(snow_combiner *combiner, int width, int height,
                        const snow_pixel_run *runs, size_t run_count,
                        const void *pixels, size_t pixel_bytes, void *picture);

/* Local. Reserves memory for this rank's runs, so that snow_gather need not
 * allocate where the other ranks cannot know whether that succeeds. */
snow_status snow_gather_reserve(snow_combiner *combiner, int width, int height,
                                size_t run_count, int64_t pixels,
                                size_t pixel_bytes);

/* The number of messages that a rank of the gather's tree waits for at a time:
 * from 2 to the number of ranks, which means no tree; 0: chosen. */
void snow_gather_radix(snow_combiner *combiner, int radix);

#endif
