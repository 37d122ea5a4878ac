/* ranks.h - the viewer on many ranks: the first serves the pages, and what it
 * does with its drawing the others do with theirs, as the library's calls for
 * many ranks need.
 *
 * A function that all ranks call begins with ranks_tell. */
#ifndef VIEWER_RANKS_H
#define VIEWER_RANKS_H

#include "draw/drawing.h"
#include "run/start.h"

typedef enum ranks_call {
    RANKS_END,
    RANKS_APPLY,     /* a recipe */
    RANKS_FIT,       /* nothing */
    RANKS_RENDER,    /* [quality, shrink] */
    RANKS_THUMBNAIL, /* [preset, colormap, mip, side] */
    RANKS_DEPTH,     /* [x, y, width, height] */
    RANKS_ENDS,      /* nothing */
    RANKS_WINDOW,    /* nothing */
    RANKS_HISTOGRAM  /* [low, high] */
} ranks_call;

/* Tells the others to make a call, with a tree that is freed. */
void ranks_broadcast(ranks_call call, json_t *arguments, double timeout);

/* The same before a call of this rank's own, if it is the first of many. */
static inline void ranks_tell(const drawing *d, ranks_call call,
                              json_t *arguments) {
    if (process_ranks() > 1 && process_talks())
        ranks_broadcast(call, arguments, d->first.timeout);
    else
        json_decref(arguments);
}

/* On the other ranks: makes the calls that the first tells, until the end.
 * Returns CONTINUE or, where ranks are lost, an exit code. */
int ranks_follow(drawing *d);

#endif
