/* combine/parts.c - the work on pixels between messages, by the threads of a
 * rank: parts of its combined image are written into messages, and received
 * layers are composited.
 *
 *   a round:   | part | part | part | part |    each into its message, whose
 *                 0      1      0      1        place is known before
 *   the region of the last round:
 *              |chunk|chunk|chunk|chunk|chunk|  each thread has its own places
 *                 0     1     1     0     1     in the layers
 *
 * No thread needs what another one makes, so that no bit depends on them. */
#include "base/thread_pool.h"
#include "combine/combiner.h"

#include <string.h>

/* --- threads -------------------------------------------------------------- */

/* Pixels that are worth waking a thread. */
#define PIXELS_OF_THREAD 16384

/* How many threads share the work on so many pixels. */
int snow_parts_workers(const snow_combiner *combiner, int64_t pixels) {
    int64_t most = combiner->exchange.order.threads;
    if (most > SNOW_COMBINE_THREADS)
        most = SNOW_COMBINE_THREADS;
    if (most > pixels / PIXELS_OF_THREAD)
        most = pixels / PIXELS_OF_THREAD;
    return most > 1 ? (int)most : 1;
}

/* Does items of work; none is skipped, since other ranks wait for all. */
static void share_work(snow_combiner *combiner, int workers, int64_t items,
                       snow_work_fn *work, void *job) {
    snow_batch batch = {0};
    snow_parallel_begin(combiner->comm->context, workers, items, work, job,
                        &batch);
    snow_parallel_end(combiner->comm->context, &batch);
}

/* Gives every thread its own places in the layers. */
void snow_parts_copy_layers(snow_combiner *combiner) {
    const int workers = snow_parts_workers(combiner, INT64_MAX);
    for (int i = 1; i < workers; i++)
        memcpy(combiner->layers + i * combiner->layer_room, combiner->layers,
               (size_t)combiner->exchange.layer_count *
                   sizeof *combiner->layers);
}

/* Composites the layers of the last round (snow_active_merge). */
static int64_t merge(const snow_combiner *combiner, int worker,
                     snow_stretch part, uint64_t *words, float *out,
                     bool packed, int64_t *laid) {
    const snow_exchange_state *run = &combiner->exchange;
    return snow_active_merge(combiner->loops,
                             combiner->layers + worker * combiner->layer_room,
                             run->layer_count, run->order.channels, part.first,
                             part.last, words, out, packed, laid);
}

/* --- messages ------------------------------------------------------------- */

/* The mask of a part: parts that share a word of the picture have words of
 * their own. */
static uint64_t *mask_of(const snow_combiner *combiner,
                         const snow_part_to_send *what) {
    const snow_exchange_state *run = &combiner->exchange;
    const int index =
        what->share == SNOW_SHARE_NONE
            ? 0
            : what->share - combiner->rounds.rounds[run->level].first_send;
    return combiner->part + what->part.first / 64 + index;
}

/* Writes the message of an awaited part of this rank's combined image. */
static void write_part(void *of, int64_t item, int worker) {
    const snow_combiner *combiner = of;
    const snow_exchange_state *run = &combiner->exchange;
    snow_part_to_send *what = &combiner->parts[item];
    const snow_stretch part = what->part;
    uint64_t *words = mask_of(combiner, what);
    float *pixels = (float *)(void *)what->message;
    if (run->level == 0)
        what->active =
            snow_active_scan(combiner->loops, &run->order, part.first,
                             part.last, words, pixels, &what->scanned);
    else
        what->active =
            merge(combiner, worker, part, words, pixels, true, &what->laid);
    what->bytes = snow_active_close(what->message, words, part.first, part.last,
                                    what->active, run->pixel_bytes);
}

/* Writes the messages of the first `count` awaited parts. */
void snow_parts_write(snow_combiner *combiner, int count, int workers) {
    snow_exchange_state *run = &combiner->exchange;
    for (int i = 0; i < count; i++) {
        snow_part_to_send *what = &combiner->parts[i];
        what->message = combiner->out[run->level & 1].bytes + run->used;
        run->used += snow_align(snow_active_capacity(
            what->part.last - what->part.first, run->pixel_bytes));
    }
    share_work(combiner, workers, count, write_part, combiner);
    for (int i = 0; i < count; i++) {
        snow_exchange_figures *figures = &combiner->figures;
        if (combiner->exchange.level == 0) {
            figures->active += combiner->parts[i].active;
            if (combiner->counted_bins)
                snow_counts_add(combiner, combiner->parts[i].part,
                                mask_of(combiner, &combiner->parts[i]));
        }
        figures->scanned += combiner->parts[i].scanned;
        figures->laid += combiner->parts[i].laid;
    }
}

/* --- the region ----------------------------------------------------------- */

/* A region that threads composite: so many words of its mask each time. */
#define CHUNK_WORDS 128
typedef struct region_job {
    const snow_combiner *combiner;
    snow_stretch region;
    int64_t laid[SNOW_COMBINE_THREADS];
} region_job;

static void composite_chunk(void *of, int64_t item, int worker) {
    region_job *job = of;
    const snow_combiner *combiner = job->combiner;
    const snow_exchange_params *order = &combiner->exchange.order;
    const int64_t first = job->region.first / 64 * 64 + item * CHUNK_WORDS * 64;
    const int64_t last = first + CHUNK_WORDS * 64;
    const snow_stretch chunk = {
        first > job->region.first ? first : job->region.first,
        last < job->region.last ? last : job->region.last};
    float *out =
        combiner->region + (chunk.first - job->region.first) * order->channels;
    merge(combiner, worker, chunk, combiner->part + item * CHUNK_WORDS, out,
          false, &job->laid[worker]);
}

/* Composites and unpacks the layers of the last round. */
void snow_parts_composite(snow_combiner *combiner, snow_stretch region) {
    region_job job = {combiner, region, {0}};
    const int64_t words = snow_active_words(region.first, region.last);
    share_work(combiner,
               snow_parts_workers(combiner, region.last - region.first),
               (words + CHUNK_WORDS - 1) / CHUNK_WORDS, composite_chunk, &job);
    int64_t laid = 0;
    for (int i = 0; i < SNOW_COMBINE_THREADS; i++)
        laid += job.laid[i];
    combiner->figures.laid += laid;
}
