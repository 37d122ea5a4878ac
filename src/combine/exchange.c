/* combine/exchange.c - the combining stage (lines 14 to 18 of figure 8), with
 * any of the methods of rounds.h.
 *
 * Before the first round each rank's combined image is its local image. In a
 * round it is divided into parts. Each part is scanned (or, later, merged from
 * what was received in the round before) only when it is sent, so that
 * computing and sending overlap. The parts of the first round are sent as soon
 * as the caller has drawn them; the order of sending changes no bit. Pixels are
 * read and written once a round, packed; only the last round unpacks them. */
#include "base/thread_pool.h"
#include "combine/combiner.h"

#include <string.h>

/* --- parts ---------------------------------------------------------------- */

static snow_stretch stretch_of(const snow_combiner *combiner,
                               const snow_share *share) {
    if (share->region < 0)
        return (snow_stretch){0, 0};
    return (snow_stretch){
        snow_region_begin(&combiner->bounds, share->region, share->regions),
        snow_region_begin(&combiner->bounds, share->region + 1,
                          share->regions)};
}

static snow_stretch overlap(snow_stretch a, snow_stretch b) {
    snow_stretch both = {a.first > b.first ? a.first : b.first,
                         a.last < b.last ? a.last : b.last};
    return both.last > both.first ? both : (snow_stretch){0, 0};
}

static void clip_drawn(snow_exchange_params *order) {
    snow_rectangle *drawn = &order->drawn;
    drawn->x0 = drawn->x0 > 0 ? drawn->x0 : 0;
    drawn->y0 = drawn->y0 > 0 ? drawn->y0 : 0;
    drawn->x1 = drawn->x1 < order->width ? drawn->x1 : order->width;
    drawn->y1 = drawn->y1 < order->height ? drawn->y1 : order->height;
    if (drawn->x0 >= drawn->x1 || drawn->y0 >= drawn->y1)
        *drawn = (snow_rectangle){0, 0, 0, 0};
}

static snow_stretch whole_picture(const snow_combiner *combiner) {
    const snow_exchange_params *order = &combiner->exchange.order;
    return (snow_stretch){0, (int64_t)order->width * order->height};
}

/* --- threads -------------------------------------------------------------- */

/* Pixels that are worth waking a thread. */
#define PIXELS_OF_THREAD 16384

/* How many threads share the work on so many pixels. */
static int workers_for(const snow_combiner *combiner, int64_t pixels) {
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
static void copy_layers(snow_combiner *combiner) {
    const int workers = workers_for(combiner, INT64_MAX);
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

static const snow_share *share_at(const snow_combiner *combiner, int index) {
    return &combiner->rounds.shares[index];
}

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
    const snow_exchange_params *order = &run->order;
    snow_part_to_send *what = &combiner->parts[item];
    const snow_stretch part = what->part;
    uint64_t *words = mask_of(combiner, what);
    float *pixels = order->rehearsal ? NULL : (float *)(void *)what->message;
    if (run->level == 0)
        what->active = snow_active_scan(combiner->loops, order, combiner->lines,
                                        part.first, part.last, words, pixels,
                                        &what->scanned);
    else
        what->active =
            merge(combiner, worker, part, words, pixels, true, &what->laid);
    what->bytes =
        order->whole
            ? (size_t)what->active * run->pixel_bytes
            : snow_active_close(what->message, words, part.first, part.last,
                                what->active, run->pixel_bytes);
}

/* Writes the messages of the first `count` awaited parts. */
static void write_parts(snow_combiner *combiner, int count, int workers) {
    snow_exchange_state *run = &combiner->exchange;
    for (int i = 0; i < count; i++) {
        snow_part_to_send *what = &combiner->parts[i];
        what->message = combiner->out[run->level & 1].bytes + run->used;
        run->used += snow_align(snow_active_room(
            what->part.last - what->part.first, run->pixel_bytes));
    }
    share_work(combiner, workers, count, write_part, combiner);
}

/* --- rounds --------------------------------------------------------------- */

/* The pixels that this rank holds before a round. */
static snow_stretch held_before(const snow_combiner *combiner, int level) {
    const snow_share all = {combiner->rounds.rank_position, 0, 1};
    return stretch_of(combiner,
                      level ? &combiner->rounds.rounds[level - 1].mine : &all);
}

/* Starts the receives of a round: messages have the numbers of the list; those
 * that are not received stay done. */
static snow_status begin_receives(snow_combiner *combiner) {
    const int level = combiner->exchange.level;
    const snow_round *round = &combiner->rounds.rounds[level];
    snow_traffic *in = &combiner->in[level & 1];
    const snow_stretch mine = stretch_of(combiner, &round->mine);
    size_t at = 0;
    in->count = round->receives;
    for (int i = 0; i < round->receives; i++) {
        const snow_share *share = share_at(combiner, round->first_receive + i);
        snow_stretch part = overlap(mine, stretch_of(combiner, share));
        in->messages[i] = (snow_message){0};
        if (part.first >= part.last ||
            share->rank_position == combiner->rounds.rank_position)
            continue;
        size_t capacity = snow_active_room(part.last - part.first,
                                           combiner->exchange.pixel_bytes);
        SNOW_TRY(snow_comm_receive(
            combiner->comm, in->bytes + at, capacity,
            combiner->exchange.order.ranks[share->rank_position],
            SNOW_TAG_COMBINE, &in->messages[i]));
        at += snow_align(capacity);
    }
    return SNOW_STATUS_OK;
}

/* Lists what this rank sends or keeps in a round. Ranks begin with different
 * parts, so that not all send to the same one; merged parts come in rising
 * order. */
static void list_parts(snow_combiner *combiner) {
    snow_exchange_state *run = &combiner->exchange;
    const snow_round *round = &combiner->rounds.rounds[run->level];
    const snow_stretch holds = held_before(combiner, run->level);
    int from = 0;
    for (int i = 0; i < round->sends && run->level == 0; i++)
        if (share_at(combiner, round->first_send + i)->rank_position ==
            combiner->rounds.rank_position)
            from = i + 1;
    run->awaited = 0;
    for (int i = 0; i < round->sends; i++) {
        int share = round->first_send + (from + i) % round->sends;
        snow_stretch part =
            overlap(holds, stretch_of(combiner, share_at(combiner, share)));
        if (part.first < part.last)
            combiner->parts[run->awaited++] =
                (snow_part_to_send){.part = part, .share = share};
    }
}

/* What a part that is written took. */
static void count_part(snow_combiner *combiner, const snow_part_to_send *what) {
    const snow_exchange_params *order = &combiner->exchange.order;
    snow_exchange_figures *figures = &combiner->figures;
    if (combiner->exchange.level == 0) {
        figures->active += what->active;
        if (combiner->counted_bins)
            snow_counts_add(combiner, what->part, mask_of(combiner, what));
    }
    figures->scanned += what->scanned;
    figures->laid += what->laid;
    snow_comm_work(combiner->comm,
                   (double)what->scanned * order->scan_seconds +
                       (double)what->laid * order->blend_seconds);
}

/* Sends a written part of what this rank holds to the owner of the new region,
 * or keeps it. */
static snow_status send_part(snow_combiner *combiner,
                             const snow_part_to_send *what) {
    snow_exchange_state *run = &combiner->exchange;
    snow_traffic *out = &combiner->out[run->level & 1];
    const int position = what->share == SNOW_SHARE_NONE
                             ? combiner->rounds.rank_position
                             : share_at(combiner, what->share)->rank_position;
    count_part(combiner, what);
    if (position == combiner->rounds.rank_position) {
        run->own = what->message;
        run->own_bytes = what->bytes;
        return SNOW_STATUS_OK;
    }
    run->sent += run->level == 0 ? (int64_t)what->bytes : 0;
    return snow_comm_send(combiner->comm, what->message, what->bytes,
                          run->order.ranks[position], SNOW_TAG_COMBINE,
                          &out->messages[out->count++]);
}

static snow_status begin_round(snow_combiner *combiner) {
    snow_exchange_state *run = &combiner->exchange;
    snow_traffic *out = &combiner->out[run->level & 1];
    SNOW_TRY(begin_receives(combiner));
    SNOW_TRY(snow_comm_wait_all(combiner->comm, out->messages, out->count));
    out->count = 0;
    run->used = 0;
    run->own_bytes = 0;
    list_parts(combiner);
    return SNOW_STATUS_OK;
}

/* Makes a message into a layer. */
static bool open_layer(const snow_combiner *combiner,
                       const unsigned char *bytes, size_t count,
                       snow_stretch part, uint64_t *words, snow_active *out) {
    bool good = true;
    if (combiner->exchange.order.whole) {
        *out = (snow_active){
            .first = part.first, .last = part.last, .at = part.first};
        out->pixels = out->next = (const float *)(const void *)bytes;
        good = count == (size_t)(part.last - part.first) *
                            combiner->exchange.pixel_bytes;
    } else {
        good = snow_active_open(bytes, count, part.first, part.last,
                                combiner->exchange.pixel_bytes, words, out);
    }
    if (combiner->exchange.order.rehearsal)
        out->pixels = NULL;
    return good;
}

/* Waits for the messages of a round, and makes layers of them. */
static snow_status end_receives(snow_combiner *combiner) {
    const int level = combiner->exchange.level;
    const snow_round *round = &combiner->rounds.rounds[level];
    snow_traffic *in = &combiner->in[level & 1];
    const snow_stretch mine = stretch_of(combiner, &round->mine);
    uint64_t *words = combiner->words;
    size_t at = 0;
    combiner->exchange.layer_count = 0;
    SNOW_TRY(snow_comm_wait_all(combiner->comm, in->messages, in->count));
    for (int i = 0; i < round->receives; i++) {
        const snow_share *share = share_at(combiner, round->first_receive + i);
        snow_stretch part = overlap(mine, stretch_of(combiner, share));
        if (part.first >= part.last)
            continue;
        const unsigned char *bytes = in->bytes + at;
        size_t count = in->messages[i].bytes;
        if (share->rank_position == combiner->rounds.rank_position) {
            bytes = combiner->exchange.own;
            count = combiner->exchange.own_bytes;
        } else {
            at += snow_align(snow_active_room(part.last - part.first,
                                              combiner->exchange.pixel_bytes));
        }
        if ((int64_t)count > combiner->figures.receive_largest)
            combiner->figures.receive_largest = (int64_t)count;
        snow_active *layer =
            &combiner->layers[combiner->exchange.layer_count++];
        bool good = open_layer(combiner, bytes, count, part, words, layer);
        layer->own = share->rank_position == combiner->rounds.rank_position;
        if (!good)
            return snow_fail(
                combiner->comm->context, SNOW_STATUS_FAILED,
                "rank %d sent data of another picture: all ranks "
                "must combine the same picture",
                combiner->exchange.order.ranks[share->rank_position]);
        words += snow_active_words(part.first, part.last);
    }
    copy_layers(combiner);
    return SNOW_STATUS_OK;
}

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
    const snow_stretch chunk =
        overlap(job->region, (snow_stretch){first, first + CHUNK_WORDS * 64});
    float *out =
        combiner->region + (chunk.first - job->region.first) * order->channels;
    merge(combiner, worker, chunk, combiner->part + item * CHUNK_WORDS, out,
          false, &job->laid[worker]);
}

/* Composites and unpacks the layers of the last round. */
static void composite_region(snow_combiner *combiner, snow_stretch region) {
    region_job job = {combiner, region, {0}};
    const int64_t words = snow_active_words(region.first, region.last);
    share_work(combiner, workers_for(combiner, region.last - region.first),
               (words + CHUNK_WORDS - 1) / CHUNK_WORDS, composite_chunk, &job);
    int64_t laid = 0;
    for (int i = 0; i < SNOW_COMBINE_THREADS; i++)
        laid += job.laid[i];
    combiner->figures.laid += laid;
    snow_comm_work(combiner->comm,
                   (double)laid * combiner->exchange.order.blend_seconds);
}

/* --- the exchange --------------------------------------------------------- */

/* The end of this rank's part of the first round, which it keeps. */
static double where_to_begin(const snow_combiner *combiner) {
    const snow_stretch mine =
        held_before(combiner, combiner->rounds.count ? 1 : 0);
    int64_t pixels = whole_picture(combiner).last;
    return mine.last < pixels ? (double)mine.last / (double)pixels : 0;
}

/* All of the local image, for one rank or to be counted. */
static void await_all(snow_combiner *combiner) {
    combiner->parts[0] = (snow_part_to_send){.part = whole_picture(combiner),
                                             .share = SNOW_SHARE_NONE};
    combiner->exchange.awaited = 1;
}

/* Divides the picture, and begins the first round. */
static snow_status begin_rounds(snow_combiner *combiner) {
    snow_exchange_state *run = &combiner->exchange;
    run->divided = true;
    if (combiner->bounds.counted)
        SNOW_TRY(snow_counts_divide(combiner));
    SNOW_TRY(snow_combiner_fit(combiner));
    combiner->figures.begin_at = where_to_begin(combiner);
    if (combiner->rounds.count)
        return begin_round(combiner);
    await_all(combiner);
    return SNOW_STATUS_OK;
}

snow_status snow_exchange_begin(snow_combiner *combiner,
                                const snow_exchange_params *params) {
    snow_exchange_state *run = &combiner->exchange;
    *run = (snow_exchange_state){.order = *params};
    run->pixel_bytes = (size_t)params->channels * sizeof(float);
    combiner->counted_bins = 0;
    SNOW_TRY(snow_combiner_plan(combiner, &run->order));
    if (!combiner->bounds.counted || snow_counts_given(combiner))
        return begin_rounds(combiner);
    await_all(combiner);
    return SNOW_STATUS_OK;
}

bool snow_exchange_awaits(const snow_combiner *combiner, int n, int *y0,
                          int *y1) {
    const snow_exchange_state *run = &combiner->exchange;
    if (n >= run->awaited)
        return false;
    const snow_stretch part = combiner->parts[n].part;
    const bool all = combiner->lines != NULL; /* lines of all regions */
    *y0 = all ? 0 : (int)(part.first / run->order.width);
    *y1 =
        all ? run->order.height : (int)((part.last - 1) / run->order.width) + 1;
    return true;
}

/* Sends the first `count` awaited parts. */
static snow_status send_parts(snow_combiner *combiner, int count, int workers,
                              snow_rectangle drawn) {
    snow_exchange_state *run = &combiner->exchange;
    run->order.drawn = drawn;
    clip_drawn(&run->order);
    if (!run->divided)
        return begin_rounds(combiner);
    write_parts(combiner, count, workers);
    for (int i = 0; i < count; i++)
        SNOW_TRY(send_part(combiner, &combiner->parts[i]));
    run->awaited -= count;
    memmove(combiner->parts, combiner->parts + count,
            (size_t)run->awaited * sizeof *combiner->parts);
    return SNOW_STATUS_OK;
}

snow_status snow_exchange_send(snow_combiner *combiner, int n,
                               snow_rectangle drawn) {
    snow_part_to_send *parts = combiner->parts, what = parts[n];
    memmove(parts + 1, parts, (size_t)n * sizeof *parts);
    parts[0] = what;
    return send_parts(combiner, 1, 1, drawn);
}

void snow_exchange_progress(snow_combiner *combiner) {
    combiner->figures.early = combiner->exchange.sent;
    snow_comm_progress(combiner->comm);
}

/* Sends what is awaited in up to four steps, so that messages travel while
 * others are written. */
static snow_status send_rest(snow_combiner *combiner, snow_rectangle drawn) {
    const snow_exchange_state *run = &combiner->exchange;
    int64_t pixels = 0;
    for (int i = 0; i < run->awaited; i++)
        pixels += combiner->parts[i].part.last - combiner->parts[i].part.first;
    const int workers = workers_for(combiner, pixels);
    int step = workers > 1 ? run->awaited / 4 : 1;
    step = step > workers ? step : workers;
    while (run->awaited)
        SNOW_TRY(send_parts(combiner, step < run->awaited ? step : run->awaited,
                            workers, drawn));
    return SNOW_STATUS_OK;
}

/* What this rank has not yet sent of the rounds. */
static snow_status end_rounds(snow_combiner *combiner, snow_rectangle drawn) {
    snow_exchange_state *run = &combiner->exchange;
    for (;;) {
        SNOW_TRY(send_rest(combiner, drawn));
        if (run->level == combiner->rounds.count)
            return SNOW_STATUS_OK;
        SNOW_TRY(end_receives(combiner));
        if (++run->level < combiner->rounds.count)
            SNOW_TRY(begin_round(combiner));
    }
}

snow_status snow_exchange_end(snow_combiner *combiner, snow_rectangle drawn,
                              snow_image_region *out) {
    snow_exchange_state *run = &combiner->exchange;
    SNOW_TRY(end_rounds(combiner, drawn));
    const snow_stretch mine = held_before(combiner, combiner->rounds.count);
    if (!combiner->rounds.count) {
        run->layer_count = 1;
        open_layer(combiner, run->own, run->own_bytes, mine, combiner->words,
                   combiner->layers);
        copy_layers(combiner);
    }
    composite_region(combiner, mine);
    for (int i = 0; i < 2; i++) {
        snow_traffic *sent = &combiner->out[i];
        SNOW_TRY(
            snow_comm_wait_all(combiner->comm, sent->messages, sent->count));
        sent->count = 0;
    }
    *out = (snow_image_region){mine.first, mine.last - mine.first,
                               run->order.rehearsal ? NULL : combiner->region,
                               combiner->part};
    return SNOW_STATUS_OK;
}

snow_status snow_exchange(snow_combiner *combiner,
                          const snow_exchange_params *params,
                          snow_image_region *out) {
    SNOW_TRY(snow_exchange_begin(combiner, params));
    return snow_exchange_end(combiner, params->drawn, out);
}

void snow_exchange_regions(const snow_combiner *combiner, int64_t *firsts,
                           int64_t *counts) {
    const snow_rounds *rounds = &combiner->rounds;
    for (int i = 0; i < rounds->rank_order; i++) {
        snow_share share = {i, snow_rounds_last(rounds, i),
                            rounds->tree ? 1 : rounds->rank_order};
        snow_stretch region = stretch_of(combiner, &share);
        firsts[combiner->ranks[i]] = region.first;
        counts[combiner->ranks[i]] = region.last - region.first;
    }
}
