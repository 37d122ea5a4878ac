/* combine/rounds.h - the rounds of the exchange: which rank sends which region
 * to which rank.
 *
 * One pattern covers all methods. Ranks in visibility order (rank positions)
 * are split into subsets of neighbours, these are split again, until each is
 * one rank. Rounds go the other way. Before a round each subset has its own
 * combined image, divided into one region for each of its ranks. In the round
 * the subsets of a group become one, and its image is divided again, finer,
 * into one region for each of the group's ranks. Each rank that holds pixels of
 * such a region sends them to its new owner:
 *
 *   positions   0     1     2     3     4        radices 3, 2: groups of 3
 *             [ all   all   all ] [ all   all ]  and 2, then of 5
 *   round 0   [ 1st   2nd   3rd ] [ 1st   2nd ]  thirds; halves
 *   round 1   [ 1st   3rd   5th     2nd   4th ]  fifths
 *
 * With radix 2 this is binary swap (Ma, Painter, Hansen, Krogh 1994), with as
 * many as there are ranks direct send (Hsu 1993), between them radix-k
 * (Peterka, Goodell, Ross, Shen, Thakur 2009), for any number of ranks: subsets
 * need not be equal, since regions are fractions of the picture (region t of
 * n), whose borders may be any rising function. In the paper's tree each group
 * has one region, the whole picture, at its first rank, or at the display
 * processor if that is one of them. */
#ifndef SNOW_ROUNDS_H
#define SNOW_ROUNDS_H

#include "combine/exchange.h"

/* Region `region` of `regions`, and its owner. */
typedef struct snow_share {
    int rank_position, region, regions;
} snow_share;

/* The part of one rank position in one round. Lists include the position
 * itself. */
typedef struct snow_round {
    int first_send, sends;       /* new regions that its old one overlaps */
    int first_receive, receives; /* old regions that its new one overlaps, from
                                    front to back */
    snow_share mine;             /* its new one; region -1: none (tree) */
} snow_round;

typedef struct snow_rounds {
    int count, radices[SNOW_ROUNDS_MOST];   /* in the order of rounds */
    int rank_count, rank_position, display; /* display: rank 0's position */
    bool tree;
    snow_round rounds[SNOW_ROUNDS_MOST];
    snow_share *shares; /* the lists, one after another */
    int share_count;
} snow_rounds;

/* The capacity that the lists may need. */
size_t snow_rounds_capacity(const snow_rounds *rounds);

/* Chooses radices for `method`: `pixels` of `pixel_bytes` in the picture;
 * `radix` as in snow_exchange_params; `node_ranks` neighbours are a node, whose
 * images the first rounds combine. Sets count, radices and tree. */
void snow_rounds_choose(snow_rounds *rounds, snow_combine method, int radix,
                        int rank_count, int node_ranks, int64_t pixels,
                        size_t pixel_bytes);

/* Fills in the lists for a rank position; `shares` has the capacity of
 * snow_rounds_capacity, and `table` that of `rank_count` numbers. */
void snow_rounds_fill(snow_rounds *rounds, int rank_position, int display,
                      int *table);

/* The region of a rank position after the last round; -1 if it has none. */
int snow_rounds_last(const snow_rounds *rounds, int rank_position);

#endif
