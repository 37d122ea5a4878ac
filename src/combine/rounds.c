/* combine/rounds.c - the scheme of rounds.h: near-equal splits, and which
 * pieces of two cuts overlap. */
#include "combine/rounds.h"

#include <math.h>
#include <string.h>

/* A run of seats. */
typedef struct group {
    int start, count;
} group;

static int least(int a, int b) {
    return a < b ? a : b;
}

/* --- splits ---------------------------------------------------------------
 */

/* Subset i of a group split into at most `radix` near-equal ones; the first
 * ones have the odd seats. */
static group subset_of(group whole, int radix, int i) {
    int parts = least(whole.count, radix);
    int size = whole.count / parts, larger = whole.count % parts;
    return (group){whole.start + i * size + least(i, larger),
                   size + (i < larger)};
}

/* Which subset a seat is in. */
static int subset_at(group whole, int radix, int seat) {
    int parts = least(whole.count, radix);
    int size = whole.count / parts, larger = whole.count % parts;
    int place = seat - whole.start;
    return place < larger * (size + 1)
               ? place / (size + 1)
               : larger + (place - larger * (size + 1)) / size;
}

/* The group that a seat is in after `level` rounds. */
static group group_at(const snow_rounds *rounds, int level, int seat) {
    group g = {0, rounds->seats};
    for (int i = rounds->count - 1; i >= level; i--)
        g = subset_of(g, rounds->radices[i],
                      subset_at(g, rounds->radices[i], seat));
    return g;
}

/* --- pieces ---------------------------------------------------------------
 */

/* How many of `size` equal pieces have their middle before that of piece a of
 * `of`; or at it, where `also`. */
static int pieces_before(int a, int of, int size, bool also) {
    int64_t over = (int64_t)(2 * a + 1) * size - of, step = 2 * (int64_t)of;
    if (over < 0)
        return 0;
    int64_t count = also ? over / step + 1 : (over + step - 1) / step;
    return (int)(count < size ? count : size);
}

/* The piece that a seat gets when its group is made: pieces are given out by
 * the middles of what the seats had before, so that most of it stays. */
static int piece_in(const snow_rounds *rounds, int level, group whole,
                    int seat) {
    if (level == 0)
        return 0;
    int radix = rounds->radices[level - 1];
    int i = subset_at(whole, radix, seat);
    group own = subset_of(whole, radix, i);
    int a = piece_in(rounds, level - 1, own, seat);
    int parts = least(whole.count, radix);
    int size = whole.count / parts, larger = whole.count % parts;
    /* Subsets before and after this one, of the two sizes. */
    int big_before = least(i, larger), small_before = i - big_before;
    int big_after = larger - big_before - (i < larger);
    int small_after = parts - larger - small_before - (i >= larger);
    return a + big_before * pieces_before(a, own.count, size + 1, true) +
           small_before * pieces_before(a, own.count, size, true) +
           big_after * pieces_before(a, own.count, size + 1, false) +
           small_after * pieces_before(a, own.count, size, false);
}

/* Who has the picture of a group in the tree. */
static int holder(const snow_rounds *rounds, group g) {
    bool displays =
        rounds->display >= g.start && rounds->display < g.start + g.count;
    return displays ? rounds->display : g.start;
}

static int pieces_of(const snow_rounds *rounds, group g) {
    return rounds->tree ? 1 : g.count;
}

static int piece_at(const snow_rounds *rounds, int level, group g, int seat) {
    if (rounds->tree)
        return holder(rounds, g) == seat ? 0 : -1;
    return piece_in(rounds, level, g, seat);
}

/* owners[piece] of a group, filled in; `owners` begins at the group. */
static void list_owners(const snow_rounds *rounds, int level, group g,
                        int *owners) {
    if (rounds->tree) {
        owners[0] = holder(rounds, g);
        return;
    }
    for (int s = g.start; s < g.start + g.count; s++)
        owners[piece_in(rounds, level, g, s)] = s;
}

/* --- lists ----------------------------------------------------------------
 */

size_t snow_rounds_room(const snow_rounds *rounds) {
    size_t room = 0;
    for (int i = 0; i < rounds->count; i++) /* of either list, and spare */
        room += 2 * (size_t)(2 * least(rounds->radices[i], rounds->seats) + 4);
    return room;
}

static int append(snow_rounds *rounds, int seat, int piece, int pieces) {
    rounds->shares[rounds->share_count] = (snow_share){seat, piece, pieces};
    return ++rounds->share_count;
}

/* Appends the pieces (of `to`) that piece `piece` of `of` overlaps; owners are
 * told by piece. */
static void append_overlaps(snow_rounds *rounds, int piece, int of, int to,
                            const int *owners) {
    int64_t first = (int64_t)piece * to / of;
    int64_t end = ((int64_t)(piece + 1) * to + of - 1) / of;
    for (int64_t t = first; t < end; t++)
        append(rounds, owners[t], (int)t, to);
}

static void fill_round(snow_rounds *rounds, int level, int *table) {
    snow_round *round = &rounds->rounds[level];
    const int radix = rounds->radices[level];
    const group g = group_at(rounds, level + 1, rounds->seat);
    const int before = subset_at(g, radix, rounds->seat);
    const group own = subset_of(g, radix, before);
    const int had = piece_at(rounds, level, own, rounds->seat);
    round->mine =
        (snow_share){rounds->seat, piece_at(rounds, level + 1, g, rounds->seat),
                     pieces_of(rounds, g)};
    round->first_send = rounds->share_count;
    list_owners(rounds, level + 1, g, table);
    if (had >= 0)
        append_overlaps(rounds, had, pieces_of(rounds, own),
                        pieces_of(rounds, g), table);
    round->sends = rounds->share_count - round->first_send;
    round->first_receive = rounds->share_count;
    for (int i = 0; i < least(g.count, radix) && round->mine.piece >= 0; i++) {
        group other = subset_of(g, radix, i);
        list_owners(rounds, level, other, table);
        append_overlaps(rounds, round->mine.piece, round->mine.pieces,
                        pieces_of(rounds, other), table);
    }
    round->receives = rounds->share_count - round->first_receive;
}

void snow_rounds_fill(snow_rounds *rounds, int seat, int display, int *table) {
    rounds->seat = seat;
    rounds->display = display;
    rounds->share_count = 0;
    for (int level = 0; level < rounds->count; level++)
        fill_round(rounds, level, table);
}

int snow_rounds_last(const snow_rounds *rounds, int seat) {
    return piece_at(rounds, rounds->count, (group){0, rounds->seats}, seat);
}

/* --- the choice -----------------------------------------------------------
 */

/* What the choice takes a network for: seconds for a message to arrive, for a
 * processor to start or end one, and for a byte.  On a slower network all grow
 * together, and the choice is about the same. */
#define LATENCY 1.0e-6
#define OVERHEAD 0.3e-6
#define SECONDS_A_BYTE 0.0825e-9

/* What it takes pictures for: a volume's footprint is so much of the picture,
 * and a 32nd of the volume hides so much of that. */
#define FOOTPRINT 0.4
#define HIDDEN 0.3

#define RADIX_MOST 64

/* The part of the picture's pixels that `parts` of all parts of the volume
 * make active when they are combined. */
static double active_part(double parts) {
    return FOOTPRINT * (1 - pow(1 - HIDDEN, 32 * parts));
}

/* All sequences of radices, cut off where they cannot be the best. */
typedef struct search {
    double seats, bytes, best;
    int radices[SNOW_ROUNDS_MOST], count; /* under way */
    snow_rounds *found;
} search;

/* Seconds for a round that makes groups out of `radix` subsets each, when there
 * are `left` subsets.  A rank starts its messages one after another while the
 * first are on their way, and ends what comes one after another. */
static double round_seconds(const search *s, int left, int radix) {
    double messages = (left % radix ? 1.6 : 1) * (radix - 1);
    double held = s->bytes * active_part(1.0 / left) * left / s->seats;
    double start = OVERHEAD * messages;
    double travel = SECONDS_A_BYTE * held * (radix - 1) / radix;
    return LATENCY + OVERHEAD * messages + (start > travel ? start : travel);
}

/* Whether there are radices that divide it. */
static bool divides(int left) {
    for (int factor = 2; factor <= 16; factor++)
        while (left % factor == 0)
            left /= factor;
    return left == 1;
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
    const bool even = divides(left);
    for (int radix = least(left, RADIX_MOST); radix >= 2; radix--) {
        if (even && left % radix)
            continue;
        s->radices[s->count++] = radix;
        search_rounds(s, (left + radix - 1) / radix,
                      seconds + round_seconds(s, left, radix));
        s->count--;
    }
}

/* As many rounds of one radix as it takes, the last with what is left. */
static void repeat_radix(snow_rounds *rounds, int seats, int radix) {
    rounds->count = 0;
    for (int left = seats; left > 1; left = (left + radix - 1) / radix)
        rounds->radices[rounds->count++] = least(radix, left);
}

void snow_rounds_choose(snow_rounds *rounds, snow_combining method, int radix,
                        int seats, int64_t pixels, size_t pixel_bytes) {
    rounds->seats = seats;
    rounds->tree = method == SNOW_COMBINE_TREE;
    rounds->count = 0;
    if (method == SNOW_COMBINE_TREE || method == SNOW_COMBINE_SWAP)
        repeat_radix(rounds, seats, 2);
    else if (method == SNOW_COMBINE_DIRECT)
        repeat_radix(rounds, seats, seats > 2 ? seats : 2);
    else if (method == SNOW_COMBINE_RADIX && radix)
        repeat_radix(rounds, seats, radix);
    else if (seats > 1)
        search_rounds(&(search){.seats = seats,
                                .bytes = (double)pixels * (double)pixel_bytes,
                                .best = HUGE_VAL,
                                .found = rounds},
                      seats, 0);
}
