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
