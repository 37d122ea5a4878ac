/* parallel/load_balance.h - slabs that are cut anew by the time that pictures
 * took.
 *
 * Interesting voxels of one rank may cost more than those of another: their
 * kernels fall on more pixels, or hide one another less.  So each slice has a
 * cost, at first its count (decompose/partition.h).  Where a slab took longer
 * than its slices should have, all of them get that much dearer, and the next
 * cut is by the costs.  What was learned of thinner or other slabs stays in
 * them, so that a few cuts find costs that change within a slab (the
 * multiplicative algebraic reconstruction of R. Gordon, R. Bender and G. T.
 * Herman, 1970, along one axis).  Bricks keep their partition: voxels of their
 * borders are drawn by several ranks, so no cost per voxel fits their times. */
#ifndef SNOW_PARALLEL_LOAD_BALANCE_H
#define SNOW_PARALLEL_LOAD_BALANCE_H

#include "base/base.h"

/* Pictures whose times are kept, the last ones; fewer than
 * SNOW_LOAD_BALANCE_LEAST say nothing. */
#define SNOW_LOAD_BALANCE_PICTURES 8
#define SNOW_LOAD_BALANCE_LEAST 4

/* Cuts by time, from one that the view asked for to the next. */
#define SNOW_LOAD_BALANCE_CUTS 4

/* What a frame knows of its last pictures.  Zeros at first. */
typedef struct snow_load_balance {
    uint64_t generation; /* of the part that they are of; 0: of none */
    int64_t calls;       /* since that is the part */
    int pictures;        /* whose seconds are known */
    double seconds[SNOW_LOAD_BALANCE_PICTURES];
    double encoding;  /* seconds of the picture that encoded */
    int cuts;         /* by time */
    double *costs[3]; /* of the slices along an axis; NULL: not known.  The same
                         on all ranks */
} snow_load_balance;

/* A record that a frame keeps.  Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_load_balance_new(snow_context *context,
                                  snow_load_balance **out);
void snow_load_balance_free(snow_context *context, snow_load_balance *work);

/* Makes one zeros again. */
void snow_load_balance_fini(snow_context *context, snow_load_balance *work);

/* What each rank sends to the others. */
typedef struct snow_load_balance_message {
    int64_t fault;        /* 0, its part serves; 1, it does not; 2, it failed */
    int64_t known;        /* whether it has the costs of the axis */
    int64_t first, count; /* its slices, along the axis of the cut */
    int64_t pictures;     /* whose seconds it knows */
    double seconds;       /* of one */
    double encoding;
} snow_load_balance_message;

/* Before the next picture is begun: notes what the last one that was finished
 * took, where it was of the part that the next will be of.  `in_flight` have
 * been begun since. */
void snow_load_balance_record(snow_context *context, snow_load_balance *work,
                              uint64_t generation, int in_flight, bool encoded,
                              double seconds);

/* The least of the seconds that are known: what disturbs a rank now and then is
 * not its part's.  0 where none are. */
double snow_load_balance_seconds(const snow_load_balance *work);

/* The longest seconds over the mean ones; 1 where there are none. */
double snow_load_balance_imbalance(const snow_load_balance_message *words,
                                   int ranks);

/* Whether there is anything to be won by another cut: all have seconds, and
 * some much longer ones than others. */
bool snow_load_balance_is_uneven(const snow_load_balance_message *words,
                                 int ranks);

/* Makes slices dearer or cheaper, so that slabs cost what they took. */
void snow_load_balance_learn(const snow_load_balance_message *words, int ranks,
                             double *costs);

/* Whether slabs with so many pictures to come are worth their cut: by what was
 * learned the dearest would take so long, `dearest`. */
bool snow_load_balance_is_worthwhile(const snow_load_balance_message *words,
                                     int ranks, double dearest, int64_t left);

#endif
