/* combine/exchange.c - the combining stage (lines 14 to 18 of figure 8), with
 * any of the methods of rounds.h.
 *
 * Before the first round each rank's combined image is its local image. In a
 * round it is divided into parts. Each part is scanned (or, later, merged from
 * what was received in the round before) only when it is sent, so that
 * computing and sending overlap. An unfinished local image is drawn further
 * until a part is ready; the order of sending changes no bit. Pixels are read
 * and written once a round, packed; only the last round unpacks them.
 *
 * Memory is allocated when the shape of the params changes, or when counted
 * regions are larger than any before. All ranks know that, and agree on the
 * status: a rank that failed alone would leave the others waiting. There is
 * room for parts all of whose pixels are active; only the memory of received
 * pixels is touched, so the system provides no more pages. */
#include "combine/combiner.h"

#include <string.h>

/* --- memory --------------------------------------------------------------- */

/* Messages begin at a multiple of this many bytes. */
#define ALIGNMENT 64

static size_t align(size_t bytes) {
    return (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

snow_status snow_combiner_new(snow_comm *comm, snow_combiner **out) {
    snow_combiner *combiner =
        snow_allocate_clear(comm->context, sizeof *combiner);
    if (!combiner)
        return SNOW_STATUS_NO_MEMORY;
    combiner->comm = comm;
    *out = combiner;
    return SNOW_STATUS_OK;
}

static void drop_buffers(snow_combiner *combiner) {
    snow_context *context = combiner->comm->context;
    for (int i = 0; i < 2; i++) {
        snow_traffic *both[] = {&combiner->in[i], &combiner->out[i]};
        for (int k = 0; k < 2; k++) {
            snow_release(context, both[k]->bytes);
            snow_release(context, both[k]->messages);
            *both[k] = (snow_traffic){0};
        }
    }
    snow_release(context, combiner->rounds.shares);
    snow_release(context, combiner->lines);
    snow_release(context, combiner->ranks);
    snow_release(context, combiner->table);
    snow_release(context, combiner->layers);
    snow_release(context, combiner->packed_messages);
    snow_release(context, combiner->words);
    snow_release(context, combiner->part);
    snow_release(context, combiner->region);
    combiner->rounds.shares = NULL;
    combiner->lines = combiner->ranks = combiner->table = NULL;
    combiner->layers = NULL;
    combiner->packed_messages = NULL;
    combiner->words = combiner->part = NULL;
    combiner->region = NULL;
    combiner->needs = (snow_exchange_needs){0};
    combiner->shape = (snow_exchange_shape){0};
}

void snow_combiner_free(snow_combiner *combiner) {
    if (!combiner)
        return;
    drop_buffers(combiner);
    snow_gather_free(combiner);
    snow_release(combiner->comm->context, combiner);
}

static int64_t most(int64_t a, int64_t b) {
    return a > b ? a : b;
}

static size_t more(size_t a, size_t b) {
    return a > b ? a : b;
}

/* The most pixels that a rank holds after `level` rounds. Groups have at most
 * two sizes, and regions are largest in one of them. */
static int64_t held(const snow_combiner *combiner, int level) {
    const snow_rounds *rounds = &combiner->rounds;
    const snow_borders *borders = &combiner->borders;
    int group = rounds->rank_order;
    for (int i = rounds->count - 1; i >= level && group > 1; i--)
        group = group / rounds->radices[i] > 1 ? group / rounds->radices[i] : 1;
    if (rounds->tree || level == 0)
        return snow_border_room(borders, 1);
    return most(snow_border_room(borders, group),
                snow_border_room(borders, group + 1));
}

/* The most messages of a rank in a round (snow_rounds_room). */
static size_t peers_in(const snow_rounds *rounds, int level) {
    int radix = rounds->radices[level];
    return 2 * (size_t)(radix < rounds->rank_order ? radix
                                                   : rounds->rank_order) +
           4;
}

static void count_round(const snow_combiner *combiner, int level,
                        snow_exchange_needs *out) {
    const snow_rounds *rounds = &combiner->rounds;
    const size_t pixel_bytes = (size_t)combiner->shape.channels * sizeof(float);
    const int64_t before = held(combiner, level),
                  after = held(combiner, level + 1);
    const size_t peers = peers_in(rounds, level), radix = (peers - 4) / 2;
    const int parity = level & 1;
    size_t spare = peers * (ALIGNMENT + snow_active_room(0, pixel_bytes));
    size_t sent = snow_active_room(before, pixel_bytes) + spare;
    size_t came = (radix - 1) * snow_active_room(after, pixel_bytes) + spare;
    size_t words = radix * ((size_t)after / 64 + 2) + 2 * peers;
    out->out[parity] = more(out->out[parity], sent);
    out->in[parity] = more(out->in[parity], came);
    out->words = more(out->words, words * sizeof(uint64_t));
}

static void count_needs(const snow_combiner *combiner,
                        snow_exchange_needs *out) {
    const snow_rounds *rounds = &combiner->rounds;
    const size_t channels = (size_t)combiner->shape.channels;
    *out = (snow_exchange_needs){0};
    if (!rounds->count) {
        out->out[0] = align(
            snow_active_room(held(combiner, 0), channels * sizeof(float)));
        out->words = ((size_t)held(combiner, 0) / 64 + 2) * sizeof(uint64_t);
    }
    for (int i = 0; i < rounds->count; i++)
        count_round(combiner, i, out);
    out->region =
        (size_t)held(combiner, rounds->count) * channels * sizeof(float);
}

/* Allocates what does not depend on the borders of regions. */
static snow_status take_lists(snow_combiner *combiner) {
    snow_context *context = combiner->comm->context;
    const size_t rank_order = (size_t)combiner->comm->ranks;
    size_t peers = 8;
    bool fine = true;
    for (int i = 0; i < combiner->rounds.count; i++)
        peers = more(peers, peers_in(&combiner->rounds, i));
    for (int i = 0; i < 2; i++) {
        snow_traffic *in = &combiner->in[i], *out = &combiner->out[i];
        fine = fine &&
               (in->messages = snow_allocate_array(context, peers,
                                                   sizeof *in->messages)) &&
               (out->messages =
                    snow_allocate_array(context, peers, sizeof *out->messages));
    }
    fine =
        fine &&
        (combiner->rounds.shares =
             snow_allocate_array(context, snow_rounds_room(&combiner->rounds),
                                 sizeof(snow_share))) &&
        (combiner->ranks =
             snow_allocate_array(context, rank_order, sizeof(int))) &&
        (combiner->table =
             snow_allocate_array(context, rank_order, sizeof(int))) &&
        (combiner->layers =
             snow_allocate_array(context, peers, sizeof(snow_active))) &&
        (combiner->packed_messages = snow_allocate_array(
             context, peers, sizeof(snow_packed_message))) &&
        (combiner->part = snow_allocate_array(
             context, (uint64_t)held(combiner, 0) / 64 + 2, sizeof(uint64_t)));
    if (fine && combiner->shape.regions == SNOW_IMAGE_PARTITION_INTERLACED)
        fine = (combiner->lines = snow_allocate_array(
                    context, (uint64_t)combiner->shape.height, sizeof(int)));
    return fine ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
}

/* Replaces a block by one of another size; its contents are lost. */
static bool take_block(snow_context *context, void *block_pointer,
                       size_t bytes) {
    void *block;
    memcpy(&block, block_pointer, sizeof block);
    snow_release(context, block);
    block = bytes ? snow_allocate(context, bytes) : NULL;
    memcpy(block_pointer, &block, sizeof block);
    return block || !bytes;
}

static snow_status take_buffers(snow_combiner *combiner,
                                const snow_exchange_needs *need) {
    snow_context *context = combiner->comm->context;
    const bool shown = !combiner->rounds.tree || combiner->comm->rank == 0;
    bool fine = true;
    for (int i = 0; i < 2; i++)
        fine = fine &&
               take_block(context, &combiner->in[i].bytes, need->in[i]) &&
               take_block(context, &combiner->out[i].bytes, need->out[i]);
    fine = fine && take_block(context, &combiner->words, need->words) &&
           take_block(context, &combiner->region, shown ? need->region : 0);
    return fine ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
}

/* Allocates buffers for the current regions. Needs are the same on all ranks,
 * so either all ranks call snow_comm_agree_status or none does. */
static snow_status fit_buffers(snow_combiner *combiner) {
    snow_exchange_needs *had = &combiner->needs, need;
    size_t *now = need.bytes, *before = had->bytes;
    bool fits = true;
    count_needs(combiner, &need);
    for (int i = 0; i < SNOW_NEEDS; i++)
        fits = fits && now[i] <= before[i];
    if (fits)
        return SNOW_STATUS_OK;
    for (int i = 0; i < SNOW_NEEDS; i++) {
        /* Counted regions of the next view may be a little larger. */
        if (combiner->borders.counted)
            now[i] += now[i] / 8;
        now[i] = more(now[i], before[i]);
    }
    snow_status status =
        snow_comm_agree_status(combiner->comm, take_buffers(combiner, &need));
    if (status != SNOW_STATUS_OK)
        drop_buffers(combiner);
    else
        *had = need;
    return status;
}

/* --- the plan ------------------------------------------------------------- */

/* AUTO counts if messages are so large that unequal regions cost more than the
 * reduction: about 2 us for each doubling of ranks, against a tenth of the
 * picture's pixels at 12 GB/s, a third of which can be saved. */
static bool counts_regions(const snow_exchange_params *order, int ranks) {
    double bytes = (double)order->width * order->height * order->channels * 4;
    int doublings = 0;
    while (((int64_t)1 << doublings) < ranks)
        doublings++;
    if (order->method == SNOW_COMBINE_TREE || ranks < 3)
        return false;
    if (order->regions == SNOW_IMAGE_PARTITION_AUTO)
        return !order->whole && bytes > 720e3 * doublings;
    return order->regions == SNOW_IMAGE_PARTITION_COUNTED;
}

static snow_combine chosen_method(const snow_exchange_params *order) {
    return order->method == SNOW_COMBINE_AUTO ? SNOW_COMBINE_RADIX
                                              : order->method;
}

static snow_exchange_shape shape_of(const snow_exchange_params *order) {
    return (snow_exchange_shape){.width = order->width,
                                 .height = order->height,
                                 .channels = order->channels,
                                 .radix = order->radix,
                                 .grain = order->grain,
                                 .method = order->method,
                                 .regions = order->regions,
                                 .whole = order->whole};
}

static bool same_shape(const snow_exchange_shape *a,
                       const snow_exchange_shape *b) {
    return a->width == b->width && a->height == b->height &&
           a->channels == b->channels && a->radix == b->radix &&
           a->grain == b->grain && a->method == b->method &&
           a->regions == b->regions && a->whole == b->whole;
}

/* Makes a plan for the params; all ranks call it together. */
static snow_status take_shape(snow_combiner *combiner,
                              const snow_exchange_params *order) {
    snow_comm *comm = combiner->comm;
    drop_buffers(combiner);
    combiner->filled = false;
    combiner->shape = shape_of(order);
    snow_borders_even(&combiner->borders, order->width, order->height,
                      order->grain);
    combiner->borders.counted = counts_regions(order, comm->ranks);
    snow_rounds_choose(&combiner->rounds, chosen_method(order), order->radix,
                       comm->ranks, (int64_t)order->width * order->height,
                       (size_t)order->channels * sizeof(float));
    snow_status status = snow_comm_agree_status(comm, take_lists(combiner));
    if (status != SNOW_STATUS_OK)
        drop_buffers(combiner);
    else if (combiner->lines)
        snow_order_lines(combiner->lines, order->height);
    return status;
}

static snow_status check_params(const snow_combiner *combiner,
                                const snow_exchange_params *order) {
    snow_context *context = combiner->comm->context;
    if (order->width < 1 || order->height < 1 ||
        (order->channels != 2 &&
         (order->channels != 4 || order->composite_op != SNOW_COMPOSITE_OVER)))
        return snow_fail(
            context, SNOW_STATUS_BAD_USAGE,
            "cannot combine a picture of %d x %d pixels and %d channels: sides "
            "must be at least 1, and channels 2 or 4",
            order->width, order->height, order->channels);
    if (order->grain < 1 || order->width % order->grain != 0 ||
        order->radix < 0 || order->radix == 1)
        return snow_fail(
            context, SNOW_STATUS_BAD_USAGE,
            "cannot divide the picture into regions of %d pixels by radix %d: "
            "grain must be 1 or the width, radix 0 or at least 2",
            order->grain, order->radix);
    return SNOW_STATUS_OK;
}

/* Fills in the lists for this rank's position. */
static snow_status take_rank_order(snow_combiner *combiner,
                                   const snow_exchange_params *order) {
    snow_rounds *rounds = &combiner->rounds;
    int rank_position = -1, display = -1;
    for (int i = 0; i < rounds->rank_order; i++) {
        if (order->ranks[i] == combiner->comm->rank)
            rank_position = i;
        if (order->ranks[i] == 0)
            display = i;
    }
    if (rank_position < 0 || display < 0)
        return snow_fail(combiner->comm->context, SNOW_STATUS_BAD_USAGE,
                         "rank %d is missing in the order from front to back: "
                         "name every rank once",
                         rank_position < 0 ? combiner->comm->rank : 0);
    bool same = combiner->filled && rounds->rank_position == rank_position &&
                (rounds->display == display || !rounds->tree);
    if (!same)
        snow_rounds_fill(rounds, rank_position, display, combiner->table);
    combiner->filled = true;
    memcpy(combiner->ranks, order->ranks,
           (size_t)rounds->rank_order * sizeof *order->ranks);
    return SNOW_STATUS_OK;
}

/* Counts active pixels, in every line of a small picture and in some lines of a
 * large one: exact counts would take longer than they save. */
#define LINES_COUNTED 128

static void count_lines(snow_combiner *combiner,
                        const snow_exchange_params *order, int64_t *counts) {
    const snow_borders *borders = &combiner->borders;
    int64_t scanned = 0;
    int step =
        order->height / LINES_COUNTED > 1 ? order->height / LINES_COUNTED : 1;
    int bin = 0;
    for (int y = step / 2; y < order->height; y += step) {
        while (y >= snow_borders_line(borders, bin + 1))
            bin++;
        counts[bin] += snow_active_in_line(combiner->loops, order, y);
        if (y >= order->drawn.y0 && y < order->drawn.y1)
            scanned += order->drawn.x1 - order->drawn.x0;
    }
    combiner->figures.scanned += scanned;
    snow_comm_work(combiner->comm, (double)scanned * order->scan_seconds);
}

/* --- one part ------------------------------------------------------------- */

/* Pixels first .. last - 1. */
typedef struct stretch {
    int64_t first, last;
} stretch;

static stretch stretch_of(const snow_combiner *combiner,
                          const snow_share *share) {
    if (share->region < 0)
        return (stretch){0, 0};
    return (stretch){
        snow_border(&combiner->borders, share->region, share->regions),
        snow_border(&combiner->borders, share->region + 1, share->regions)};
}

static stretch overlap(stretch a, stretch b) {
    stretch both = {most(a.first, b.first), a.last < b.last ? a.last : b.last};
    return both.last > both.first ? both : (stretch){0, 0};
}

/* The state of one exchange. */
typedef struct exchange {
    snow_combiner *combiner;
    snow_exchange_params *order; /* `unfinished` until the image is finished */
    size_t pixel_bytes;
    bool tallies;             /* counts for the next picture */
    int64_t sent;             /* bytes, in the first round */
    int layer_count;          /* of combiner->layers, to merge */
    const unsigned char *own; /* the message to oneself */
    size_t own_bytes;
} exchange;

static void clip_drawn(snow_exchange_params *order) {
    snow_rectangle *drawn = &order->drawn;
    drawn->x0 = drawn->x0 > 0 ? drawn->x0 : 0;
    drawn->y0 = drawn->y0 > 0 ? drawn->y0 : 0;
    drawn->x1 = drawn->x1 < order->width ? drawn->x1 : order->width;
    drawn->y1 = drawn->y1 < order->height ? drawn->y1 : order->height;
    if (drawn->x0 >= drawn->x1 || drawn->y0 >= drawn->y1)
        *drawn = (snow_rectangle){0, 0, 0, 0};
}

/* Whether a part of the local image is finished. */
static bool is_there(exchange *run, stretch part) {
    snow_exchange_params *order = run->order;
    const snow_unfinished *unfinished = order->unfinished;
    bool all = run->combiner->lines != NULL; /* of all regions */
    int y0 = all ? 0 : (int)(part.first / order->width);
    int y1 = all ? order->height : (int)((part.last - 1) / order->width) + 1;
    if (!unfinished)
        return true;
    if (!unfinished->look(unfinished->user, y0, y1, &order->drawn))
        return false;
    clip_drawn(order);
    return true;
}

static void end_drawing(exchange *run) {
    const snow_unfinished *unfinished = run->order->unfinished;
    if (!unfinished)
        return;
    unfinished->end(unfinished->user);
    is_there(run,
             (stretch){0, (int64_t)run->order->width * run->order->height});
    run->order->unfinished = NULL;
}

/* Continues drawing while messages are in flight. */
static void draw_on(exchange *run) {
    const snow_unfinished *unfinished = run->order->unfinished;
    if (unfinished->step(unfinished->user))
        run->combiner->figures.early = run->sent;
    else
        end_drawing(run);
    snow_comm_progress(run->combiner->comm);
}

/* Adds a part of the local image, whose mask is complete, to the counts. */
static void tally(snow_combiner *combiner, stretch part) {
    const snow_borders *borders = &combiner->borders;
    int64_t end;
    int bin = 0;
    for (int64_t at = part.first; at < part.last; at = end) {
        int64_t line = at / borders->width, next = (line + 1) * borders->width;
        end = next < part.last ? next : part.last;
        while (line >= snow_borders_line(borders, bin + 1))
            bin++;
        combiner->counts[bin] +=
            snow_active_count(combiner->part, part.first, at, end);
    }
}

/* Divides the picture by counts: given ones, or its own, for which it must be
 * finished. */
static snow_status count_regions(exchange *run) {
    snow_combiner *combiner = run->combiner;
    const snow_exchange_params *order = run->order;
    snow_borders *borders = &combiner->borders;
    const size_t bins = (size_t)borders->bins;
    int64_t counts[SNOW_BINS_MOST] = {0};
    if (order->counts && order->count_groups == borders->bins) {
        memcpy(counts, order->counts, bins * sizeof *counts);
    } else {
        end_drawing(run);
        count_lines(combiner, order, counts);
        SNOW_TRY(snow_comm_reduce_ints(combiner->comm, counts, bins, SNOW_SUM));
    }
    snow_borders_count(borders, counts);
    memset(combiner->counts, 0, sizeof combiner->counts);
    run->tallies = !order->whole;
    combiner->counted_bins = run->tallies ? borders->bins : 0;
    return SNOW_STATUS_OK;
}

/* Writes the part of this rank's combined image in `part` as a message to
 * `out`; returns its length. */
static size_t write_part(exchange *run, int level, stretch part,
                         unsigned char *out) {
    snow_combiner *combiner = run->combiner;
    const snow_exchange_params *order = run->order;
    snow_exchange_figures *figures = &combiner->figures;
    float *pixels = order->rehearsal ? NULL : (float *)(void *)out;
    int64_t scanned = 0, laid = 0, count;
    if (level == 0) {
        count = snow_active_scan(combiner->loops, order, combiner->lines,
                                 part.first, part.last, combiner->part, pixels,
                                 &scanned);
        figures->active += count;
        if (run->tallies)
            tally(combiner, part);
    } else {
        count =
            snow_active_merge(combiner->loops, combiner->layers,
                              run->layer_count, order->channels, part.first,
                              part.last, combiner->part, pixels, true, &laid);
    }
    figures->scanned += scanned;
    figures->laid += laid;
    snow_comm_work(combiner->comm, (double)scanned * order->scan_seconds +
                                       (double)laid * order->blend_seconds);
    if (order->whole)
        return (size_t)count * run->pixel_bytes;
    return snow_active_close(out, combiner->part, part.first, part.last, count,
                             run->pixel_bytes);
}

/* --- rounds --------------------------------------------------------------- */

static const snow_share *share_at(const snow_combiner *combiner, int index) {
    return &combiner->rounds.shares[index];
}

/* The pixels that this rank holds before a round. */
static stretch held_before(const snow_combiner *combiner, int level) {
    const snow_share all = {combiner->rounds.rank_position, 0, 1};
    return stretch_of(combiner,
                      level ? &combiner->rounds.rounds[level - 1].mine : &all);
}

/* Starts the receives of a round: messages have the numbers of the list; those
 * that are not received stay done. */
static snow_status begin_receives(exchange *run, int level) {
    snow_combiner *combiner = run->combiner;
    const snow_round *round = &combiner->rounds.rounds[level];
    snow_traffic *in = &combiner->in[level & 1];
    const stretch mine = stretch_of(combiner, &round->mine);
    size_t at = 0;
    in->count = round->receives;
    for (int i = 0; i < round->receives; i++) {
        const snow_share *share = share_at(combiner, round->first_receive + i);
        stretch part = overlap(mine, stretch_of(combiner, share));
        in->messages[i] = (snow_message){0};
        if (part.first >= part.last ||
            share->rank_position == combiner->rounds.rank_position)
            continue;
        size_t capacity =
            snow_active_room(part.last - part.first, run->pixel_bytes);
        SNOW_TRY(snow_comm_receive(combiner->comm, in->bytes + at, capacity,
                                   run->order->ranks[share->rank_position],
                                   SNOW_TAG_COMBINE, &in->messages[i]));
        at += align(capacity);
    }
    return SNOW_STATUS_OK;
}

/* Lists what this rank sends or keeps in a round; returns the number. Ranks
 * begin with different parts, so that not all send to the same one; merged
 * parts come in rising order. */
static int list_packed_messages(const snow_combiner *combiner, int level) {
    const snow_round *round = &combiner->rounds.rounds[level];
    const stretch holds = held_before(combiner, level);
    int from = 0, count = 0;
    for (int i = 0; i < round->sends && level == 0; i++)
        if (share_at(combiner, round->first_send + i)->rank_position ==
            combiner->rounds.rank_position)
            from = i + 1;
    for (int i = 0; i < round->sends; i++) {
        int share = round->first_send + (from + i) % round->sends;
        stretch part =
            overlap(holds, stretch_of(combiner, share_at(combiner, share)));
        if (part.first < part.last)
            combiner->packed_messages[count++] =
                (snow_packed_message){part.first, part.last, share};
    }
    return count;
}

/* Sends a part of what this rank holds to the owner of the new region, or keeps
 * it; `at` is its offset in the buffer, and then that of the next one. */
static snow_status send_part(exchange *run, int level, int index, stretch part,
                             size_t *at) {
    snow_combiner *combiner = run->combiner;
    const snow_share *share = share_at(combiner, index);
    snow_traffic *out = &combiner->out[level & 1];
    unsigned char *message = out->bytes + *at;
    size_t bytes = write_part(run, level, part, message);
    *at += align(snow_active_room(part.last - part.first, run->pixel_bytes));
    if (share->rank_position == combiner->rounds.rank_position) {
        run->own = message;
        run->own_bytes = bytes;
        return SNOW_STATUS_OK;
    }
    run->sent += (int64_t)bytes;
    return snow_comm_send(combiner->comm, message, bytes,
                          run->order->ranks[share->rank_position],
                          SNOW_TAG_COMBINE, &out->messages[out->count++]);
}

/* Sends what this rank holds; parts of an unfinished image when finished. */
static snow_status send_round(exchange *run, int level) {
    snow_combiner *combiner = run->combiner;
    snow_packed_message *packed_messages = combiner->packed_messages;
    snow_traffic *out = &combiner->out[level & 1];
    size_t at = 0;
    SNOW_TRY(snow_comm_wait_all(combiner->comm, out->messages, out->count));
    out->count = 0;
    run->own_bytes = 0;
    for (int left = list_packed_messages(combiner, level); left;) {
        int absent = 0;
        for (int i = 0; i < left; i++) {
            stretch part = {packed_messages[i].first, packed_messages[i].last};
            if (is_there(run, part))
                SNOW_TRY(
                    send_part(run, level, packed_messages[i].share, part, &at));
            else
                packed_messages[absent++] = packed_messages[i];
        }
        left = absent;
        if (left)
            draw_on(run);
    }
    end_drawing(run);
    return SNOW_STATUS_OK;
}

/* Makes a message into a layer. */
static bool open_layer(const exchange *run, const unsigned char *bytes,
                       size_t count, stretch part, uint64_t *words,
                       snow_active *out) {
    bool good = true;
    if (run->order->whole) {
        *out = (snow_active){.first = part.first, .last = part.last};
        out->pixels = out->next = (const float *)(const void *)bytes;
        good = count == (size_t)(part.last - part.first) * run->pixel_bytes;
    } else {
        good = snow_active_open(bytes, count, part.first, part.last,
                                run->pixel_bytes, words, out);
    }
    if (run->order->rehearsal)
        out->pixels = NULL;
    return good;
}

/* Waits for the messages of a round, and makes layers of them. */
static snow_status end_receives(exchange *run, int level) {
    snow_combiner *combiner = run->combiner;
    const snow_round *round = &combiner->rounds.rounds[level];
    snow_traffic *in = &combiner->in[level & 1];
    const stretch mine = stretch_of(combiner, &round->mine);
    uint64_t *words = combiner->words;
    size_t at = 0;
    run->layer_count = 0;
    SNOW_TRY(snow_comm_wait_all(combiner->comm, in->messages, in->count));
    for (int i = 0; i < round->receives; i++) {
        const snow_share *share = share_at(combiner, round->first_receive + i);
        stretch part = overlap(mine, stretch_of(combiner, share));
        if (part.first >= part.last)
            continue;
        const unsigned char *bytes = in->bytes + at;
        size_t count = in->messages[i].bytes;
        if (share->rank_position == combiner->rounds.rank_position) {
            bytes = run->own;
            count = run->own_bytes;
        } else {
            at += align(
                snow_active_room(part.last - part.first, run->pixel_bytes));
        }
        if ((int64_t)count > combiner->figures.receive_largest)
            combiner->figures.receive_largest = (int64_t)count;
        snow_active *layer = &combiner->layers[run->layer_count++];
        bool good = open_layer(run, bytes, count, part, words, layer);
        layer->own = share->rank_position == combiner->rounds.rank_position;
        if (!good)
            return snow_fail(combiner->comm->context, SNOW_STATUS_FAILED,
                             "rank %d sent data of another picture: all ranks "
                             "must combine the same picture",
                             run->order->ranks[share->rank_position]);
        words += snow_active_words(part.first, part.last);
    }
    return SNOW_STATUS_OK;
}

/* Composites and unpacks the layers of the last round. */
static void composite_region(exchange *run, stretch region) {
    snow_combiner *combiner = run->combiner;
    const snow_exchange_params *order = run->order;
    float *out = order->rehearsal ? NULL : combiner->region;
    int64_t laid = 0;
    snow_active_merge(combiner->loops, combiner->layers, run->layer_count,
                      order->channels, region.first, region.last,
                      combiner->part, out, false, &laid);
    combiner->figures.laid += laid;
    snow_comm_work(combiner->comm, (double)laid * order->blend_seconds);
}

static snow_status run_rounds(exchange *run) {
    snow_combiner *combiner = run->combiner;
    const int count = combiner->rounds.count;
    for (int level = 0; level < count; level++) {
        SNOW_TRY(begin_receives(run, level));
        SNOW_TRY(send_round(run, level));
        SNOW_TRY(end_receives(run, level));
    }
    return SNOW_STATUS_OK;
}

/* One rank: its local image is the picture. */
static snow_status run_alone(exchange *run, stretch all) {
    snow_combiner *combiner = run->combiner;
    unsigned char *out = combiner->out[0].bytes;
    end_drawing(run);
    size_t bytes = write_part(run, 0, all, out);
    run->layer_count = 1;
    open_layer(run, out, bytes, all, combiner->words, combiner->layers);
    return SNOW_STATUS_OK;
}

static void begin_figures(snow_combiner *combiner,
                          const snow_exchange_params *order) {
    snow_exchange_figures *figures = &combiner->figures;
    *figures = (snow_exchange_figures){.method = chosen_method(order),
                                       .rounds = combiner->rounds.count,
                                       .counted = combiner->borders.counted};
    memcpy(figures->radices, combiner->rounds.radices, sizeof figures->radices);
}

/* The end of this rank's part of the first round, which it keeps. */
static double where_to_begin(const snow_combiner *combiner) {
    const snow_borders *borders = &combiner->borders;
    const stretch mine = held_before(combiner, combiner->rounds.count ? 1 : 0);
    int64_t pixels = (int64_t)borders->width * borders->height;
    return mine.last < pixels ? (double)mine.last / (double)pixels : 0;
}

static snow_status combine(exchange *run, stretch *mine) {
    snow_combiner *combiner = run->combiner;
    snow_exchange_params *order = run->order;
    const snow_exchange_shape shape = shape_of(order);
    SNOW_TRY(check_params(combiner, order));
    clip_drawn(order);
    if (!same_shape(&shape, &combiner->shape))
        SNOW_TRY(take_shape(combiner, order));
    combiner->loops =
        snow_pixels_pick(SNOW_ISA_AUTO, order->channels, order->composite_op);
    SNOW_TRY(take_rank_order(combiner, order));
    begin_figures(combiner, order);
    run->tallies = false;
    combiner->counted_bins = 0;
    if (combiner->borders.counted)
        SNOW_TRY(count_regions(run));
    SNOW_TRY(fit_buffers(combiner));
    combiner->figures.begin_at = where_to_begin(combiner);
    *mine = held_before(combiner, combiner->rounds.count);
    SNOW_TRY(combiner->rounds.count ? run_rounds(run) : run_alone(run, *mine));
    composite_region(run, *mine);
    for (int i = 0; i < 2; i++) {
        snow_traffic *sent = &combiner->out[i];
        SNOW_TRY(
            snow_comm_wait_all(combiner->comm, sent->messages, sent->count));
        sent->count = 0;
    }
    return SNOW_STATUS_OK;
}

snow_status snow_exchange(snow_combiner *combiner,
                          const snow_exchange_params *asked,
                          snow_image_region *out) {
    snow_exchange_params order = *asked;
    exchange run = {.combiner = combiner,
                    .order = &order,
                    .pixel_bytes = (size_t)order.channels * sizeof(float)};
    stretch mine;
    snow_status status = combine(&run, &mine);
    if (order.unfinished) /* after a failure */
        order.unfinished->end(order.unfinished->user);
    SNOW_TRY(status);
    combiner->scan_seconds = order.scan_seconds;
    combiner->blend_seconds = order.blend_seconds;
    *out = (snow_image_region){mine.first, mine.last - mine.first,
                               order.rehearsal ? NULL : combiner->region,
                               combiner->part};
    return SNOW_STATUS_OK;
}

/* --- figures -------------------------------------------------------------- */

const snow_exchange_figures *
snow_exchange_get_figures(const snow_combiner *combiner) {
    return &combiner->figures;
}

void snow_exchange_regions(const snow_combiner *combiner, int64_t *firsts,
                           int64_t *counts) {
    const snow_rounds *rounds = &combiner->rounds;
    for (int i = 0; i < rounds->rank_order; i++) {
        snow_share share = {i, snow_rounds_last(rounds, i),
                            rounds->tree ? 1 : rounds->rank_order};
        stretch region = stretch_of(combiner, &share);
        firsts[combiner->ranks[i]] = region.first;
        counts[combiner->ranks[i]] = region.last - region.first;
    }
}

int snow_exchange_counts(const snow_combiner *combiner,
                         const int64_t **counts) {
    *counts = combiner->counts;
    return combiner->counted_bins;
}

int snow_exchange_line(const snow_combiner *combiner, int place) {
    return combiner->lines ? combiner->lines[place] : place;
}
