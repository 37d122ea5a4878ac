/* combine/exchange.c - the combining stage (lines 14 to 18 of figure 8), with
 * any of the methods of rounds.h.
 *
 * Before the first round each rank's combined image is its local image. In a
 * round it is divided into parts. Each part is scanned (or, later, merged from
 * what was received in the round before) only when it is sent, so that
 * computing and sending overlap. The parts of the first round are sent as soon
 * as the caller has drawn them; the order of sending changes no bit. Pixels are
 * read and written once a round, packed; only the last round unpacks them. */
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

/* --- rounds --------------------------------------------------------------- */

static const snow_share *share_at(const snow_combiner *combiner, int index) {
    return &combiner->rounds.shares[index];
}

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
        size_t capacity = snow_active_capacity(part.last - part.first,
                                               combiner->exchange.pixel_bytes);
        SNOW_TRY(snow_traffic_receive(
            combiner, in, i,
            combiner->exchange.order.ranks[share->rank_position],
            in->bytes + at, capacity));
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

/* Sends a written part of what this rank holds to the owner of the new region,
 * or keeps it. */
static snow_status send_part(snow_combiner *combiner,
                             const snow_part_to_send *what) {
    snow_exchange_state *run = &combiner->exchange;
    snow_traffic *out = &combiner->out[run->level & 1];
    const int position = what->share == SNOW_SHARE_NONE
                             ? combiner->rounds.rank_position
                             : share_at(combiner, what->share)->rank_position;
    if (position == combiner->rounds.rank_position) {
        run->own = what->message;
        run->own_bytes = what->bytes;
        return SNOW_STATUS_OK;
    }
    run->sent += run->level == 0 ? (int64_t)what->bytes : 0;
    return snow_traffic_send(combiner, out, what->message, what->bytes,
                             run->order.ranks[position]);
}

static snow_status begin_round(snow_combiner *combiner) {
    snow_exchange_state *run = &combiner->exchange;
    snow_traffic *out = &combiner->out[run->level & 1];
    SNOW_TRY(begin_receives(combiner));
    SNOW_TRY(snow_traffic_await_sent(combiner, out));
    SNOW_TRY(snow_traffic_await_return(combiner, out));
    run->used = 0;
    run->own_bytes = 0;
    list_parts(combiner);
    return SNOW_STATUS_OK;
}

/* Makes a message into a layer. */
static bool open_layer(const snow_combiner *combiner,
                       const unsigned char *bytes, size_t count,
                       snow_stretch part, uint64_t *words, snow_active *out) {
    return snow_active_open(bytes, count, part.first, part.last,
                            combiner->exchange.pixel_bytes, words, out);
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
        const unsigned char *bytes = combiner->exchange.own;
        size_t count = combiner->exchange.own_bytes;
        if (share->rank_position != combiner->rounds.rank_position) {
            bytes = snow_traffic_message(
                combiner, in, i,
                combiner->exchange.order.ranks[share->rank_position],
                in->bytes + at, &count);
            at += snow_align(snow_active_capacity(
                part.last - part.first, combiner->exchange.pixel_bytes));
        }
        snow_active *layer =
            &combiner->layers[combiner->exchange.layer_count++];
        bool good =
            bytes && open_layer(combiner, bytes, count, part, words, layer);
        layer->own = share->rank_position == combiner->rounds.rank_position;
        if (!good) {
            SNOW_TRY(snow_traffic_return(combiner, level));
            return snow_fail(
                combiner->comm->context, SNOW_STATUS_FAILED,
                "rank %d sent data of another picture: all ranks "
                "must combine the same picture",
                combiner->exchange.order.ranks[share->rank_position]);
        }
        words += snow_active_words(part.first, part.last);
    }
    snow_parts_copy_layers(combiner);
    return SNOW_STATUS_OK;
}

/* --- the exchange --------------------------------------------------------- */

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
    /* The end of this rank's part of the first round, which it keeps. */
    const snow_stretch mine =
        held_before(combiner, combiner->rounds.count ? 1 : 0);
    int64_t pixels = whole_picture(combiner).last;
    combiner->figures.begin_at =
        mine.last < pixels ? (double)mine.last / (double)pixels : 0;
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
    *y0 = (int)(part.first / run->order.width);
    *y1 = (int)((part.last - 1) / run->order.width) + 1;
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
    snow_parts_write(combiner, count, workers);
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
    const int workers = snow_parts_workers(combiner, pixels);
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
        if (run->level)
            SNOW_TRY(snow_traffic_return(combiner, run->level - 1));
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
        snow_parts_copy_layers(combiner);
    }
    snow_parts_composite(combiner, mine);
    if (run->level)
        SNOW_TRY(snow_traffic_return(combiner, run->level - 1));
    for (int i = 0; i < 2; i++)
        SNOW_TRY(snow_traffic_await_sent(combiner, &combiner->out[i]));
    *out = (snow_image_region){mine.first, mine.last - mine.first,
                               combiner->region, combiner->part};
    run->ended = true;
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
    for (int i = 0; i < rounds->rank_count; i++) {
        snow_share share = {i, snow_rounds_last(rounds, i),
                            rounds->tree ? 1 : rounds->rank_count};
        snow_stretch region = stretch_of(combiner, &share);
        firsts[combiner->ranks[i]] = region.first;
        counts[combiner->ranks[i]] = region.last - region.first;
    }
}
