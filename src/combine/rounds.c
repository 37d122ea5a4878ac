/* combine/rounds.c - the communication pattern of rounds.h: near-equal splits,
 * and overlaps of the regions of two divisions. */
#include "combine/rounds.h"
#include "base/minmax.h"

#include <math.h>
#include <string.h>

/* A run of rank positions. */
typedef struct group {
    int start, count;
} group;

/* --- splits --------------------------------------------------------------- */

/* Subset i of a group split into at most `radix` near-equal ones; the first
 * ones are one larger if it does not divide evenly. */
static group subset_of(group whole, int radix, int i) {
    int parts = SNOW_MIN(whole.count, radix);
    int size = whole.count / parts, larger = whole.count % parts;
    return (group){whole.start + i * size + SNOW_MIN(i, larger),
                   size + (i < larger)};
}

/* The subset of a rank position. */
static int subset_at(group whole, int radix, int rank_position) {
    int parts = SNOW_MIN(whole.count, radix);
    int size = whole.count / parts, larger = whole.count % parts;
    int place = rank_position - whole.start;
    return place < larger * (size + 1)
               ? place / (size + 1)
               : larger + (place - larger * (size + 1)) / size;
}

/* The group of a rank position after `level` rounds. */
static group group_at(const snow_rounds *rounds, int level, int rank_position) {
    group g = {0, rounds->rank_count};
    for (int i = rounds->count - 1; i >= level; i--)
        g = subset_of(g, rounds->radices[i],
                      subset_at(g, rounds->radices[i], rank_position));
    return g;
}

/* --- regions -------------------------------------------------------------- */

/* How many of `size` equal regions have their middle before that of region a of
 * `of`; or at it, with `also`. */
static int regions_before(int a, int of, int size, bool also) {
    int64_t over = (int64_t)(2 * a + 1) * size - of, step = 2 * (int64_t)of;
    if (over < 0)
        return 0;
    int64_t count = also ? over / step + 1 : (over + step - 1) / step;
    return (int)(count < size ? count : size);
}

/* The region that a rank position gets when its group is made: regions are
 * assigned by the middles of those before, so that most pixels stay. */
static int region_in(const snow_rounds *rounds, int level, group whole,
                     int rank_position) {
    if (level == 0)
        return 0;
    int radix = rounds->radices[level - 1];
    int i = subset_at(whole, radix, rank_position);
    group own = subset_of(whole, radix, i);
    int a = region_in(rounds, level - 1, own, rank_position);
    int parts = SNOW_MIN(whole.count, radix);
    int size = whole.count / parts, larger = whole.count % parts;
    /* Subsets before and after this one, of the two sizes. */
    int big_before = SNOW_MIN(i, larger), small_before = i - big_before;
    int big_after = larger - big_before - (i < larger);
    int small_after = parts - larger - small_before - (i >= larger);
    return a + big_before * regions_before(a, own.count, size + 1, true) +
           small_before * regions_before(a, own.count, size, true) +
           big_after * regions_before(a, own.count, size + 1, false) +
           small_after * regions_before(a, own.count, size, false);
}

/* The rank position that holds a group's picture in the tree. */
static int holder(const snow_rounds *rounds, group g) {
    bool displays =
        rounds->display >= g.start && rounds->display < g.start + g.count;
    return displays ? rounds->display : g.start;
}

static int regions_of(const snow_rounds *rounds, group g) {
    return rounds->tree ? 1 : g.count;
}

static int region_at(const snow_rounds *rounds, int level, group g,
                     int rank_position) {
    if (rounds->tree)
        return holder(rounds, g) == rank_position ? 0 : -1;
    return region_in(rounds, level, g, rank_position);
}

/* Fills in owners[region] of a group; `owners` begins at the group. */
static void list_owners(const snow_rounds *rounds, int level, group g,
                        int *owners) {
    if (rounds->tree) {
        owners[0] = holder(rounds, g);
        return;
    }
    for (int s = g.start; s < g.start + g.count; s++)
        owners[region_in(rounds, level, g, s)] = s;
}

/* --- lists ---------------------------------------------------------------- */

size_t snow_rounds_capacity(const snow_rounds *rounds) {
    size_t capacity = 0;
    for (int i = 0; i < rounds->count; i++) /* in either list, and spare */
        capacity +=
            2 *
            (size_t)(2 * SNOW_MIN(rounds->radices[i], rounds->rank_count) + 4);
    return capacity;
}

/* Appends the regions (of `to`) that region `region` of `of` overlaps, with
 * their owners. */
static void append_overlaps(snow_rounds *rounds, int region, int of, int to,
                            const int *owners) {
    int64_t first = (int64_t)region * to / of;
    int64_t end = ((int64_t)(region + 1) * to + of - 1) / of;
    for (int64_t t = first; t < end; t++)
        rounds->shares[rounds->share_count++] =
            (snow_share){owners[t], (int)t, to};
}

static void fill_round(snow_rounds *rounds, int level, int *table) {
    snow_round *round = &rounds->rounds[level];
    const int radix = rounds->radices[level];
    const group g = group_at(rounds, level + 1, rounds->rank_position);
    const int before = subset_at(g, radix, rounds->rank_position);
    const group own = subset_of(g, radix, before);
    const int had = region_at(rounds, level, own, rounds->rank_position);
    round->mine =
        (snow_share){rounds->rank_position,
                     region_at(rounds, level + 1, g, rounds->rank_position),
                     regions_of(rounds, g)};
    round->first_send = rounds->share_count;
    list_owners(rounds, level + 1, g, table);
    if (had >= 0)
        append_overlaps(rounds, had, regions_of(rounds, own),
                        regions_of(rounds, g), table);
    round->sends = rounds->share_count - round->first_send;
    round->first_receive = rounds->share_count;
    for (int i = 0; i < SNOW_MIN(g.count, radix) && round->mine.region >= 0;
         i++) {
        group other = subset_of(g, radix, i);
        list_owners(rounds, level, other, table);
        append_overlaps(rounds, round->mine.region, round->mine.regions,
                        regions_of(rounds, other), table);
    }
    round->receives = rounds->share_count - round->first_receive;
}

void snow_rounds_fill(snow_rounds *rounds, int rank_position, int display,
                      int *table) {
    rounds->rank_position = rank_position;
    rounds->display = display;
    rounds->share_count = 0;
    for (int level = 0; level < rounds->count; level++)
        fill_round(rounds, level, table);
}

int snow_rounds_last(const snow_rounds *rounds, int rank_position) {
    return region_at(rounds, rounds->count, (group){0, rounds->rank_count},
                     rank_position);
}

/* --- the choice ----------------------------------------------------------- */

/* The assumed network: seconds for a message to arrive, for a processor to
 * start or end one, and for a byte. If all are larger in proportion, the choice
 * is about the same. */
#define LATENCY 1.0e-6
#define OVERHEAD 0.3e-6
#define SECONDS_A_BYTE 0.0825e-9

/* The assumed pictures: the fraction of the picture that a volume's footprint
 * covers, and the fraction of that which a 32nd of the volume hides. */
#define FOOTPRINT 0.4
#define HIDDEN 0.3

#define RADIX_MOST 64

/* A search of all sequences of radices, pruned where none can be the best. */
typedef struct search {
    double rank_count, bytes, best;
    int nodes;                            /* 1: all ranks are on one */
    int radices[SNOW_ROUNDS_MOST], count; /* current */
    snow_rounds *found;
} search;

/* Seconds for a round that makes groups of `radix` subsets each, when there are
 * `left` subsets. A rank starts its messages one after another while the first
 * are in flight, and ends received ones one after another. */
static double round_seconds(const search *s, int left, int radix) {
    double messages = (left % radix ? 1.6 : 1) * (radix - 1);
    /* The fraction of the picture's pixels that are active when `parts` of all
     * parts of the volume are combined. */
    const double active_part =
        FOOTPRINT * (1 - pow(1 - HIDDEN, 32 * (1.0 / left)));
    double held = s->bytes * active_part * left / s->rank_count;
    double start = OVERHEAD * messages;
    double travel = SECONDS_A_BYTE * held * (radix - 1) / radix;
    return LATENCY + OVERHEAD * messages + (start > travel ? start : travel);
}

static void search_rounds(search *s, int left, double seconds) {
    if (seconds >= s->best || s->count == 12)
        return;
    if (left == 1) {
        s->best = seconds;
        s->found->count = s->count;
        memcpy(s->found->radices, s->radices, sizeof s->radices);
        return;
    }
    int rest = left; /* 1 if it is a product of available radices */
    for (int factor = 2; factor <= 16; factor++)
        while (rest % factor == 0)
            rest /= factor;
    const bool even = rest == 1, within = s->nodes > 1 && left > s->nodes;
    for (int radix = within ? left : SNOW_MIN(left, RADIX_MOST); radix >= 2;
         radix--) {
        /* subsets still divide nodes after a round of this radix */
        const bool keeps = left <= s->nodes || s->nodes == 1 ||
                           (left % radix == 0 && left / radix % s->nodes == 0);
        if ((even && left % radix) || !keeps)
            continue;
        s->radices[s->count++] = radix;
        search_rounds(s, (left + radix - 1) / radix,
                      seconds + round_seconds(s, left, radix));
        s->count--;
    }
}

/* Takes as many rounds of one radix as necessary, the last with the rest. */
static void repeat_radix(snow_rounds *rounds, int rank_count, int radix) {
    rounds->count = 0;
    for (int left = rank_count; left > 1; left = (left + radix - 1) / radix)
        rounds->radices[rounds->count++] = SNOW_MIN(radix, left);
}

void snow_rounds_choose(snow_rounds *rounds, snow_combine method, int radix,
                        int rank_count, int node_ranks, int64_t pixels,
                        size_t pixel_bytes) {
    rounds->rank_count = rank_count;
    rounds->tree = method == SNOW_COMBINE_TREE;
    rounds->count = 0;
    if (method == SNOW_COMBINE_TREE || method == SNOW_COMBINE_SWAP)
        repeat_radix(rounds, rank_count, 2);
    else if (method == SNOW_COMBINE_DIRECT)
        repeat_radix(rounds, rank_count, rank_count > 2 ? rank_count : 2);
    else if (method == SNOW_COMBINE_RADIX && radix)
        repeat_radix(rounds, rank_count, radix);
    else if (rank_count > 1)
        search_rounds(&(search){.rank_count = rank_count,
                                .bytes = (double)pixels * (double)pixel_bytes,
                                .best = HUGE_VAL,
                                .nodes = rank_count / node_ranks,
                                .found = rounds},
                      rank_count, 0);
}
