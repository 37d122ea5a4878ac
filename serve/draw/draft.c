/* draft.c - implements draft.h. */
#include "draw/draft.h"

int draft_shrink(int shrink, int level, double took, bool encoded) {
    if (level == 1 && took <= DRAFT_SECONDS_MOST)
        return 0;
    if (level > 0 || encoded)
        return shrink;
    if (took > DRAFT_SECONDS_MOST && shrink < DRAFT_SHRINK_MOST)
        return shrink + 1;
    return took < DRAFT_SECONDS_LEAST && shrink > 0 ? shrink - 1 : shrink;
}

int draft_follow(draft_times *times, int shrink, int level, double took,
                 bool encoded) {
    const bool far = took > DRAFT_FAR * DRAFT_SECONDS_MOST;
    if (level > 0 || encoded)
        return draft_shrink(shrink, level, took, encoded);
    if (times->count < DRAFT_LARGER)
        times->count++;
    times->mean += (took - times->mean) / times->count;
    const bool slow = times->mean > DRAFT_SECONDS_MOST;
    if (!far && times->count < (slow ? DRAFT_SMALLER : DRAFT_LARGER))
        return shrink;
    const int next = draft_shrink(shrink, 0, far ? took : times->mean, false);
    if (next != shrink)
        *times = (draft_times){.count = 0};
    return next;
}
