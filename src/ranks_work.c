/* ranks_work.c - see ranks_work.h. */
#include "ranks_work.h"

#include "classify/fade.h"
#include "frame.h"
#include "ranks_open.h"
#include "ranks_parts.h"
#include "volume/volume.h"

#include <math.h>

/* Less is noise. */
#define LEAST_IMBALANCE 1.04

/* What a slab costs at least: clocks may tell of nothing. */
#define LEAST_SECONDS 1e-6

/* Of the time that a cut should save, so much is hoped for; and no cut is made
 * for less than a share of a picture's. */
#define HOPE 0.5
#define LEAST_GAIN 0.02

/* What a cut takes over the encoding of its voxels: that they are moved. */
#define MOVING 1.0

/* --- one rank's record ----------------------------------------------------
 */

void snow_work_fini(snow_context *context, snow_work *w) {
    for (int axis = 0; axis < 3; axis++)
        snow_release(context, w->costs[axis]);
    *w = (snow_work){0};
}

/* Another part of the same volume. */
static void start_anew(snow_work *w, uint64_t serial) {
    w->serial = serial;
    w->calls = w->pictures = 0;
    w->encoding = 0;
}

void snow_work_note(snow_context *context, snow_work *w, uint64_t serial,
                    int under_way, const snow_stats *last) {
    if (w->serial != serial) { /* another volume, for all that is known */
        snow_work_fini(context, w);
        start_anew(w, serial);
        return;
    }
    w->calls++;
    if (!serial || w->calls <= under_way)
        return;
    if (last->encoded) {
        w->encoding = last->cpu_splat;
        return;
    }
    w->seconds[w->pictures % SNOW_WORK_PICTURES] = last->cpu_splat;
    w->pictures++;
}

double snow_work_seconds(const snow_work *w) {
    int count =
        w->pictures < SNOW_WORK_PICTURES ? w->pictures : SNOW_WORK_PICTURES;
    double least = count ? w->seconds[0] : 0;
    for (int n = 1; n < count; n++)
        least = fmin(least, w->seconds[n]);
    return least;
}

/* --- what all said --------------------------------------------------------
 */

static double sum_of(const snow_work_word *words, int ranks) {
    double sum = 0;
    for (int rank = 0; rank < ranks; rank++)
        sum += words[rank].seconds;
    return sum;
}

static double most_of(const snow_work_word *words, int ranks) {
    double most = 0;
    for (int rank = 0; rank < ranks; rank++)
        most = fmax(most, words[rank].seconds);
    return most;
}

double snow_work_imbalance(const snow_work_word *words, int ranks) {
    double sum = sum_of(words, ranks);
    return sum > 0 ? most_of(words, ranks) * ranks / sum : 1;
}

bool snow_work_uneven(const snow_work_word *words, int ranks) {
    for (int rank = 0; rank < ranks; rank++)
        if (words[rank].pictures < SNOW_WORK_LEAST)
            return false;
    return snow_work_imbalance(words, ranks) >= LEAST_IMBALANCE;
}

bool snow_work_pays(const snow_work_word *words, int ranks, double dearest,
                    int64_t left) {
    double encoding = 0, most = most_of(words, ranks), saved = most - dearest;
    for (int rank = 0; rank < ranks; rank++)
        encoding = fmax(encoding, words[rank].encoding);
    return saved > LEAST_GAIN * most &&
           HOPE * saved * (double)left > (1 + MOVING) * encoding;
}

void snow_work_learn(const snow_work_word *words, int ranks, double *costs) {
    for (int rank = 0; rank < ranks; rank++) {
        const snow_work_word *word = &words[rank];
        double *own = costs + word->first, sum = 0;
        /* Not 0, which no later picture could make more of. */
        double seconds = fmax(word->seconds, LEAST_SECONDS);
        for (int64_t n = 0; n < word->count; n++)
            sum += own[n];
        for (int64_t n = 0; n < word->count && sum > 0; n++)
            own[n] *= seconds / sum;
    }
}

/* --- the cut --------------------------------------------------------------
 */

/* One call of snow_ranks_balance. */
typedef struct balancing {
    snow_comm *comm;
    snow_context *context;
    snow_work *work;
    const snow_transfer *transfer;
    snow_volume **volume;
    snow_volume_info whole;
    snow_cut_order order;
    snow_work_word *words; /* of all ranks */
    snow_box *boxes;
    int ranks;
} balancing;

/* What this rank says; `status`, whether it knows what to cut. */
static snow_work_word own_word(const balancing *b, snow_status status) {
    const snow_work *w = b->work;
    const int axis = b->order.grid.axis;
    snow_part part;
    snow_volume_get_part(*b->volume, &part);
    if (status != SNOW_OK)
        return (snow_work_word){.fault = 2};
    return (snow_work_word){.fault = !snow_part_serves(*b->volume, &b->order),
                            .known = w->costs[axis] != NULL,
                            .first = part.first[axis],
                            .count = part.count[axis],
                            .pictures = w->pictures,
                            .seconds = snow_work_seconds(w),
                            .encoding = w->encoding};
}

/* Collective.  What all ranks say. */
static snow_status ask_all(balancing *b, snow_status status) {
    const snow_work_word mine = own_word(b, status);
    b->words =
        snow_allocate_array(b->context, (uint64_t)b->ranks, sizeof *b->words);
    b->boxes =
        snow_allocate_array(b->context, (uint64_t)b->ranks, sizeof *b->boxes);
    SNOW_TRY(snow_comm_agree(b->comm,
                             b->words && b->boxes ? SNOW_OK : SNOW_NO_MEMORY));
    return snow_comm_share(b->comm, &mine, sizeof mine, b->words);
}

/* Collective.  Costs of the slices, of counts where any rank has none. */
static snow_status know_costs(balancing *b, double **out) {
    double **costs = &b->work->costs[b->order.grid.axis];
    int64_t slices = snow_cut_slices(&b->order);
    bool known = true;
    for (int rank = 0; rank < b->ranks; rank++)
        known = known && b->words[rank].known;
    if (!known) {
        if (!*costs)
            *costs = snow_allocate_array(b->context, (uint64_t)slices,
                                         sizeof **costs);
        snow_status status =
            snow_comm_agree(b->comm, *costs ? SNOW_OK : SNOW_NO_MEMORY);
        if (status == SNOW_OK)
            status = snow_cut_count(b->comm, &b->order, *b->volume, b->transfer,
                                    *costs);
        if (status != SNOW_OK) { /* of all ranks: nobody knows any */
            snow_release(b->context, *costs);
            *costs = NULL;
            return status;
        }
    }
    *out = *costs;
    return SNOW_OK;
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
        snow_work_learn(b->words, b->ranks, costs);
    SNOW_TRY(snow_comm_agree(
        b->comm, snow_cut_costs(b->context, &b->order, costs, b->boxes)));
    *dearest = dearest_of(b, costs);
    return SNOW_OK;
}

/* Collective.  Some part does not serve the view. */
static snow_status cut_for_view(balancing *b) {
    bool slabs = b->order.cut == SNOW_CUT_COUNTED;
    double dearest;
    b->work->cuts = 0;
    if (slabs)
        SNOW_TRY(cut_slabs(b, false, &dearest));
    return snow_ranks_deal(b->comm, &b->whole, &b->order,
                           slabs ? b->boxes : NULL, b->transfer, b->volume);
}

/* Collective.  All parts do: they are cut anew where that pays. */
static snow_status cut_for_time(balancing *b, int64_t left) {
    double dearest;
    if (b->order.cut != SNOW_CUT_COUNTED || b->work->cuts == SNOW_WORK_CUTS ||
        !snow_work_uneven(b->words, b->ranks))
        return SNOW_OK;
    SNOW_TRY(cut_slabs(b, true, &dearest));
    if (!snow_work_pays(b->words, b->ranks, dearest, left))
        return SNOW_OK;
    b->work->cuts++;
    return snow_ranks_deal(b->comm, &b->whole, &b->order, b->boxes, b->transfer,
                           b->volume);
}

/* Collective.  All find the same to be done. */
static snow_status settle(balancing *b, snow_status status, int64_t left) {
    int64_t fault = 0;
    for (int n = 0; n < b->ranks; n++)
        fault = b->words[n].fault > fault ? b->words[n].fault : fault;
    if (fault == 2)
        return snow_comm_agree(b->comm, status);
    return fault ? cut_for_view(b) : cut_for_time(b, left);
}

static bool is_measured(const snow_ranks_options *how,
                        const snow_settings *settings) {
    return snow_ranks_options_known(how).cut == SNOW_CUT_MEASURED &&
           !snow_settings_known(settings).deterministic;
}

snow_status snow_ranks_balance(snow_frame *frame, snow_comm *comm,
                               const snow_transfer *transfer,
                               const snow_view *view,
                               const snow_settings *settings,
                               const snow_ranks_options *how, int64_t left,
                               snow_volume **volume) {
    balancing b = {.comm = comm,
                   .context = frame->context,
                   .work = &frame->work,
                   .transfer = transfer,
                   .volume = volume,
                   .ranks = snow_comm_ranks(comm)};
    if (!is_measured(how, settings) || b.ranks == 1)
        return snow_ranks_recut(comm, transfer, view, settings, how, volume);
    uint64_t before = (*volume)->serial;
    snow_work_note(frame->context, b.work, before,
                   frame->ranks ? frame->ranks->under_way : 0, &frame->stats);
    snow_volume_whole(*volume, &b.whole);
    snow_status status =
        snow_cut_order_make(b.context, &b.whole, view, settings, how,
                            snow_transfer_fades(transfer), b.ranks, &b.order);
    snow_status found = ask_all(&b, status);
    if (found == SNOW_OK)
        found = settle(&b, status, left);
    snow_release(b.context, b.words);
    snow_release(b.context, b.boxes);
    if ((*volume)->serial != before)
        start_anew(b.work, (*volume)->serial);
    return found;
}
