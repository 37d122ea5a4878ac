/* combine/rounds.h - who sends which piece to whom.
 *
 * One scheme holds all methods.  Ranks in visibility order ("seats") are split
 * into subsets of neighbours, these again, until each is one rank.  Rounds go
 * the other way: before a round each subset has its own combined image, cut
 * into one piece for each of its ranks; in the round the subsets of a group
 * become one, and its image is cut anew, finer, into one piece for each of the
 * group's ranks.  Whoever holds pixels of such a piece sends them to its new
 * owner:
 *
 *   seats       0     1     2     3     4        radices 3, 2: groups of 3
 *             [ all   all   all ] [ all   all ]  and 2, then of 5
 *   round 0   [ 1st   2nd   3rd ] [ 1st   2nd ]  thirds; halves
 *   round 1   [ 1st   3rd   5th     2nd   4th ]  fifths
 *
 * With radix 2 this is binary swap (Ma, Painter, Hansen, Krogh 1994), with as
 * many as there are ranks direct send (Hsu 1993), between them radix-k
 * (Peterka, Goodell, Ross, Shen, Thakur 2009), for any number of ranks: subsets
 * need not be equal, since pieces are told by fractions of the picture (piece t
 * of n), whose borders may be any rising function.  In the paper's tree each
 * group has one piece, the whole picture, at its first rank, or at the display
 * processor when that is one of them. */
#ifndef SNOW_ROUNDS_H
#define SNOW_ROUNDS_H

#include "combine/exchange.h"

/* Piece `piece` of `pieces`, and whose it is. */
typedef struct snow_share {
    int seat, piece, pieces;
} snow_share;

/* What one seat does in one round.  Lists include the seat itself. */
typedef struct snow_round {
    int first_send, sends;       /* new pieces that its old one overlaps */
    int first_receive, receives; /* old pieces that its new one overlaps,
                                    from front to back */
    snow_share mine;             /* its new one; piece -1: none (tree) */
} snow_round;

typedef struct snow_rounds {
    int count, radices[SNOW_ROUNDS_MOST]; /* in the order of rounds */
    int seats, seat, display;             /* display: rank 0's seat */
    bool tree;
    snow_round rounds[SNOW_ROUNDS_MOST];
    snow_share *shares; /* the lists, one after another */
    int share_count;
} snow_rounds;

/* How many shares the lists may need. */
size_t snow_rounds_room(const snow_rounds *rounds);

/* Chooses radices for `method`: `pixels` of `pixel_bytes` in the picture;
 * `radix` as in snow_exchange_order.  Sets count, radices and tree. */
void snow_rounds_choose(snow_rounds *rounds, snow_combining method, int radix,
                        int seats, int64_t pixels, size_t pixel_bytes);

/* Fills in the lists for a seat; `shares` has the room told, and `table` room
 * for `seats` numbers. */
void snow_rounds_fill(snow_rounds *rounds, int seat, int display, int *table);

/* The piece that a seat has after the last round; -1 where it has none. */
int snow_rounds_last(const snow_rounds *rounds, int seat);

#endif
