/* ranks_work.h - slabs that are cut anew by the time that pictures took.
 *
 * Interesting voxels of one rank may cost more than those of another: their
 * kernels fall on more pixels, or hide one another less.  So each slice has a
 * cost, at first its interesting voxels.  Where a slab took longer than its
 * slices should have, all of them get that much dearer, and the next cut is by
 * the costs.  What was learned of thinner or other slabs stays in them, so that
 * a few cuts find costs that change within a slab (the multiplicative algebraic
 * reconstruction of R. Gordon, R. Bender and G. T. Herman, 1970, along one
 * axis).  Bricks are left as they were cut: voxels of their borders are drawn
 * by several ranks, and no cost of voxels told what they took. */
#ifndef SNOW_RANKS_WORK_H
#define SNOW_RANKS_WORK_H

#include "base/base.h"

#include <snowglass/render.h>

/* Pictures whose times are kept, the last ones; fewer than SNOW_WORK_LEAST say
 * nothing. */
#define SNOW_WORK_PICTURES 8
#define SNOW_WORK_LEAST 4

/* Cuts by time, from one that the view asked for to the next. */
#define SNOW_WORK_CUTS 4

/* What a frame knows of its last pictures.  Zeros at first. */
typedef struct snow_work {
    uint64_t serial; /* of the part that they are of; 0: of none */
    int64_t calls;   /* since that is the part */
    int pictures;    /* whose seconds are known */
    double seconds[SNOW_WORK_PICTURES];
    double encoding;  /* seconds of the picture that encoded */
    int cuts;         /* by time */
    double *costs[3]; /* of the slices along an axis; NULL: not known.  The same
                         on all ranks */
} snow_work;

void snow_work_fini(snow_context *context, snow_work *work);

/* What a rank tells the others. */
typedef struct snow_work_word {
    int64_t fault;        /* 0, its part serves; 1, it does not; 2, it failed */
    int64_t known;        /* whether it has the costs of the axis */
    int64_t first, count; /* its slices, along the axis of the cut */
    int64_t pictures;     /* whose seconds it knows */
    double seconds;       /* of one */
    double encoding;
} snow_work_word;

/* Before the next picture is begun: notes what the last one that was finished
 * took, where it was of the part that the next will be of.  `under_way` have
 * been begun since. */
void snow_work_note(snow_context *context, snow_work *work, uint64_t serial,
                    int under_way, const snow_stats *last);

/* The least of the seconds that are known: what disturbs a rank now and then is
 * not its part's.  0 where none are. */
double snow_work_seconds(const snow_work *work);

/* The longest seconds over the mean ones; 1 where there are none. */
double snow_work_imbalance(const snow_work_word *words, int ranks);

/* Whether there is anything to be won by another cut: all have seconds, and
 * some much longer ones than others. */
bool snow_work_uneven(const snow_work_word *words, int ranks);

/* Makes slices dearer or cheaper, so that slabs cost what they took. */
void snow_work_learn(const snow_work_word *words, int ranks, double *costs);

/* Whether slabs with so many pictures to come are worth their cut: by what was
 * learned the dearest would take so long, `dearest`. */
bool snow_work_pays(const snow_work_word *words, int ranks, double dearest,
                    int64_t left);

#endif
