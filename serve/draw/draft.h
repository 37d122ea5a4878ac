/* draft.h - how small drafts are: by what the last pictures took. */
#ifndef DRAFT_H
#define DRAFT_H

#include <stdbool.h>

/* A draft that takes longer, to be drawn and packed, gets half the side; one
 * that takes less gets it back.  With a quarter of the pixels it takes at least
 * a quarter of the time, so the two do not alternate. */
#define DRAFT_SECONDS_MOST 0.040
#define DRAFT_SECONDS_LEAST 0.009
#define DRAFT_SHRINK_MOST 3

/* The next draft's side is 1 / 2^shrink of the window's.  A draft for which
 * voxels were encoded anew does not count; a picture of level 1 that is as
 * quick as a draft shows that all of the window is. */
int draft_shrink(int shrink, int level, double took, bool encoded);

/* Seconds of drafts of one size: where the machine is busy with other work some
 * take longer than others, and their size would go up and down with each. */
typedef struct draft_times {
    double mean; /* of the last DRAFT_LARGER */
    int count;
} draft_times;

/* Pictures that have to be slow, and quick, until another size follows; one
 * that takes many times too long is enough. */
#define DRAFT_SMALLER 3
#define DRAFT_LARGER 8
#define DRAFT_FAR 4.0

int draft_follow(draft_times *times, int shrink, int level, double took,
                 bool encoded);

#endif
