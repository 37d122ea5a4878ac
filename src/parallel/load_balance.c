/* parallel/load_balance.c - see load_balance.h. */
#include "parallel/load_balance.h"

#include "parallel/internal.h"
#include "parallel/part.h"
#include "transfer/transfer.h"

#include <math.h>

/* Less is noise. */
#define LEAST_IMBALANCE 1.04

/* The least cost of a slab: a coarse clock may measure 0. */
#define LEAST_SECONDS 1e-6

/* Of the time that a cut should save, so much is hoped for; and no cut is made
 * for less than a share of a picture's. */
#define HOPE 0.5
#define LEAST_GAIN 0.02

/* What a cut takes over the encoding of its voxels: that they are moved. */
#define MOVING 1.0

/* --- one rank's record ---------------------------------------------------- */

snow_status snow_load_balance_new(snow_context *context,
                                  snow_load_balance **out) {
    *out = snow_allocate_clear(context, sizeof **out);
    return *out ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
}

void snow_load_balance_free(snow_context *context, snow_load_balance *w) {
    if (w)
        snow_load_balance_fini(context, w);
    snow_release(context, w);
}

void snow_load_balance_fini(snow_context *context, snow_load_balance *w) {
    for (int axis = 0; axis < 3; axis++)
        snow_release(context, w->costs[axis]);
    *w = (snow_load_balance){0};
}

/* Another part of the same volume. */
static void start_anew(snow_load_balance *w, uint64_t generation) {
    w->generation = generation;
    w->calls = w->pictures = 0;
    w->encoding = 0;
}

void snow_load_balance_record(snow_context *context, snow_load_balance *w,
                              uint64_t generation, int in_flight, bool encoded,
                              double seconds) {
    if (w->generation !=
        generation) { /* another volume, for all that is known */
        snow_load_balance_fini(context, w);
        start_anew(w, generation);
        return;
    }
    w->calls++;
    if (!generation || w->calls <= in_flight)
        return;
    if (encoded) {
        w->encoding = seconds;
        return;
    }
    w->seconds[w->pictures % SNOW_LOAD_BALANCE_PICTURES] = seconds;
    w->pictures++;
}

double snow_load_balance_seconds(const snow_load_balance *w) {
    int count = w->pictures < SNOW_LOAD_BALANCE_PICTURES
                    ? w->pictures
                    : SNOW_LOAD_BALANCE_PICTURES;
    double least = count ? w->seconds[0] : 0;
    for (int n = 1; n < count; n++)
        least = fmin(least, w->seconds[n]);
    return least;
}

/* --- what all said -------------------------------------------------------- */

static double sum_of(const snow_load_balance_message *words, int ranks) {
    double sum = 0;
    for (int rank = 0; rank < ranks; rank++)
        sum += words[rank].seconds;
    return sum;
}

static double most_of(const snow_load_balance_message *words, int ranks) {
    double most = 0;
    for (int rank = 0; rank < ranks; rank++)
        most = fmax(most, words[rank].seconds);
    return most;
}

double snow_load_balance_imbalance(const snow_load_balance_message *words,
                                   int ranks) {
    double sum = sum_of(words, ranks);
    return sum > 0 ? most_of(words, ranks) * ranks / sum : 1;
}

bool snow_load_balance_is_uneven(const snow_load_balance_message *words,
                                 int ranks) {
    for (int rank = 0; rank < ranks; rank++)
        if (words[rank].pictures < SNOW_LOAD_BALANCE_LEAST)
            return false;
    return snow_load_balance_imbalance(words, ranks) >= LEAST_IMBALANCE;
}

bool snow_load_balance_is_worthwhile(const snow_load_balance_message *words,
                                     int ranks, double dearest, int64_t left) {
    double encoding = 0, most = most_of(words, ranks), saved = most - dearest;
    for (int rank = 0; rank < ranks; rank++)
        encoding = fmax(encoding, words[rank].encoding);
    return saved > LEAST_GAIN * most &&
           HOPE * saved * (double)left > (1 + MOVING) * encoding;
}

void snow_load_balance_learn(const snow_load_balance_message *words, int ranks,
                             double *costs) {
    for (int rank = 0; rank < ranks; rank++) {
        const snow_load_balance_message *word = &words[rank];
        double *own = costs + word->first, sum = 0;
        /* Not 0, which no later picture could make more of. */
        double seconds = fmax(word->seconds, LEAST_SECONDS);
        for (int64_t n = 0; n < word->count; n++)
            sum += own[n];
        for (int64_t n = 0; n < word->count && sum > 0; n++)
            own[n] *= seconds / sum;
    }
}

/* --- the cut -------------------------------------------------------------- */

/* One call of snow_ranks_rebalance. */
typedef struct balancing {
    snow_comm *comm;
    snow_context *context;
    snow_load_balance *work;
    const snow_transfer *transfer;
    snow_volume **volume;
    snow_volume_info whole;
    snow_partition_params order;
    snow_load_balance_message *words; /* of all ranks */
    snow_box *boxes;
    int ranks;
} balancing;

/* What this rank says; `status`, whether it knows what to cut. */
static snow_load_balance_message own_word(const balancing *b,
                                          snow_status status) {
    const snow_load_balance *w = b->work;
    const int axis = b->order.grid.axis;
    const snow_box box = snow_part_box(*b->volume);
    if (status != SNOW_STATUS_OK)
        return (snow_load_balance_message){.fault = 2};
    return (snow_load_balance_message){
        .fault = !snow_part_serves(*b->volume, &b->order),
        .known = w->costs[axis] != NULL,
        .first = box.first[axis],
        .count = box.count[axis],
        .pictures = w->pictures,
        .seconds = snow_load_balance_seconds(w),
        .encoding = w->encoding};
}

/* Collective.  What all ranks say. */
static snow_status ask_all(balancing *b, snow_status status) {
    const snow_load_balance_message mine = own_word(b, status);
    snow_status room = SNOW_RESERVE(b->context, b->words, 0, b->ranks);
    if (room == SNOW_STATUS_OK)
        room = SNOW_RESERVE(b->context, b->boxes, 0, b->ranks);
    SNOW_TRY(snow_comm_agree_status(b->comm, room));
    return snow_comm_allgather(b->comm, &mine, sizeof mine, b->words);
}

/* Whether all ranks have costs of the axis. */
static bool are_known(const balancing *b) {
    bool known = true;
    for (int rank = 0; rank < b->ranks; rank++)
        known = known && b->words[rank].known;
    return known;
}

/* Collective.  Costs of the slices, of counts where any rank has none. */
static snow_status know_costs(balancing *b, double **out) {
    double **costs = &b->work->costs[b->order.grid.axis];
    int64_t slices = snow_partition_slices(&b->order);
    if (!are_known(b)) {
        snow_status status = snow_comm_agree_status(
            b->comm, SNOW_RESERVE(b->context, *costs, 0, slices));
        if (status == SNOW_STATUS_OK)
            status = snow_partition_count(b->comm, &b->order, *b->volume,
                                          b->transfer, *costs);
        if (status != SNOW_STATUS_OK) { /* of all ranks: nobody knows any */
            SNOW_DROP(b->context, *costs);
            return status;
        }
    }
    *out = *costs;
    return SNOW_STATUS_OK;
}

/* What the dearest of the boxes costs, which are slabs. */
static double dearest_of(const balancing *b, const double *costs) {
    const int axis = b->order.grid.axis;
    double most = 0;
    for (int rank = 0; rank < b->ranks; rank++) {
        const snow_box *box = &b->boxes[rank];
        double sum = 0;
        for (int64_t n = 0; n < box->count[axis]; n++)
            sum += costs[box->first[axis] + n];
        most = fmax(most, sum);
    }
    return most;
}

/* Collective.  Slabs by what is known of costs. */
static snow_status cut_slabs(balancing *b, bool learns, double *dearest) {
    double *costs;
    SNOW_TRY(know_costs(b, &costs));
    if (learns)
        snow_load_balance_learn(b->words, b->ranks, costs);
    SNOW_TRY(snow_comm_agree_status(
        b->comm, snow_partition_costs(b->context, &b->order, costs, b->boxes)));
    *dearest = dearest_of(b, costs);
    return SNOW_STATUS_OK;
}

/* Collective.  Some part does not serve the view.  Where no times are known of
 * an axis, slabs are those of `auto`, which sees what is hidden. */
static snow_status cut_for_view(balancing *b) {
    bool slabs = b->order.cut == SNOW_PARTITION_COUNTED && are_known(b);
    double dearest;
    b->work->cuts = 0;
    if (slabs)
        SNOW_TRY(cut_slabs(b, false, &dearest));
    return snow_ranks_distribute(b->comm, &b->whole, &b->order,
                                 slabs ? b->boxes : NULL, b->transfer,
                                 b->volume);
}

/* Collective.  All parts do: they are cut anew where that pays. */
static snow_status cut_for_time(balancing *b, int64_t left) {
    double dearest;
    if (b->order.cut != SNOW_PARTITION_COUNTED ||
        b->work->cuts == SNOW_LOAD_BALANCE_CUTS ||
        !snow_load_balance_is_uneven(b->words, b->ranks))
        return SNOW_STATUS_OK;
    SNOW_TRY(cut_slabs(b, true, &dearest));
    if (!snow_load_balance_is_worthwhile(b->words, b->ranks, dearest, left))
        return SNOW_STATUS_OK;
    b->work->cuts++;
    return snow_ranks_distribute(b->comm, &b->whole, &b->order, b->boxes,
                                 b->transfer, b->volume);
}

/* Collective.  All find the same to be done. */
static snow_status drain(balancing *b, snow_status status, int64_t left) {
    int64_t fault = 0;
    for (int n = 0; n < b->ranks; n++)
        fault = b->words[n].fault > fault ? b->words[n].fault : fault;
    if (fault == 2)
        return snow_comm_agree_status(b->comm, status);
    return fault ? cut_for_view(b) : cut_for_time(b, left);
}

static bool is_measured(const snow_ranks_options *how,
                        const snow_settings *settings) {
    snow_ranks_options options;
    snow_settings known;
    /* A record that cannot be read is refused by snow_ranks_repartition. */
    return SNOW_RECORD_READ(NULL, snow_ranks_options, how, &options) ==
               SNOW_STATUS_OK &&
           SNOW_RECORD_READ(NULL, snow_settings, settings, &known) ==
               SNOW_STATUS_OK &&
           options.cut == SNOW_PARTITION_MEASURED && !known.deterministic;
}

snow_status snow_ranks_rebalance(snow_frame *frame, snow_comm *comm,
                                 const snow_transfer *transfer,
                                 const snow_view *view,
                                 const snow_settings *settings,
                                 const snow_ranks_options *how, int64_t left,
                                 snow_volume **volume) {
    balancing b = {.comm = comm,
                   .context = frame->context,
                   .work = frame->work,
                   .transfer = transfer,
                   .volume = volume,
                   .ranks = snow_comm_size(comm)};
    if (!is_measured(how, settings) || b.ranks == 1)
        return snow_ranks_repartition(comm, transfer, view, settings, how,
                                      volume);
    uint64_t before = (*volume)->generation;
    snow_load_balance_record(frame->context, b.work, before,
                             frame->ranks ? frame->ranks->in_flight : 0,
                             frame->stats.encoded,
                             frame->ranks_stats.cpu_splat);
    snow_volume_whole(*volume, &b.whole);
    snow_status status = snow_partition_params_make(
        b.context, &b.whole, view, settings, how,
        snow_transfer_slopes(transfer, &b.whole), b.ranks, &b.order);
    snow_status found = ask_all(&b, status);
    if (found == SNOW_STATUS_OK)
        found = drain(&b, status, left);
    snow_release(b.context, b.words);
    snow_release(b.context, b.boxes);
    if ((*volume)->generation != before)
        start_anew(b.work, (*volume)->generation);
    return found;
}
