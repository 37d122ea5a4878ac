/* combine/counts.c - counted regions: borders by the numbers of active pixels
 * in groups of lines, from this picture or from the one before. */
#include "combine/combiner.h"

#include <string.h>

/* Counts active pixels, in every line of a small picture and in some lines of a
 * large one: exact counts would take longer than they save. */
#define LINES_COUNTED 128

static void count_lines(snow_combiner *combiner,
                        const snow_exchange_params *order, int64_t *counts) {
    const snow_region_bounds *bounds = &combiner->bounds;
    int64_t scanned = 0;
    int step =
        order->height / LINES_COUNTED > 1 ? order->height / LINES_COUNTED : 1;
    int bin = 0;
    for (int y = step / 2; y < order->height; y += step) {
        while (y >= snow_region_bounds_line(bounds, bin + 1))
            bin++;
        counts[bin] += snow_active_in_line(combiner->loops, order, y);
        if (y >= order->drawn.y0 && y < order->drawn.y1)
            scanned += order->drawn.x1 - order->drawn.x0;
    }
    combiner->figures.scanned += scanned;
}

bool snow_counts_given(const snow_combiner *combiner) {
    const snow_exchange_params *order = &combiner->exchange.order;
    return order->counts && order->count_groups == combiner->bounds.bins;
}

snow_status snow_counts_divide(snow_combiner *combiner) {
    const snow_exchange_params *order = &combiner->exchange.order;
    snow_region_bounds *bounds = &combiner->bounds;
    const size_t bins = (size_t)bounds->bins;
    int64_t counts[SNOW_BINS_MOST] = {0};
    if (snow_counts_given(combiner)) {
        memcpy(counts, order->counts, bins * sizeof *counts);
    } else {
        count_lines(combiner, order, counts);
        SNOW_TRY(snow_comm_reduce_ints(combiner->comm, counts, bins,
                                       SNOW_REDUCE_SUM));
    }
    snow_region_bounds_count(bounds, counts);
    memset(combiner->counts, 0, sizeof combiner->counts);
    combiner->counted_bins = bounds->bins;
    return SNOW_STATUS_OK;
}

void snow_counts_add(snow_combiner *combiner, snow_stretch part,
                     const uint64_t *words) {
    const snow_region_bounds *bounds = &combiner->bounds;
    int64_t end;
    int bin = 0;
    for (int64_t at = part.first; at < part.last; at = end) {
        int64_t line = at / bounds->width, next = (line + 1) * bounds->width;
        end = next < part.last ? next : part.last;
        while (line >= snow_region_bounds_line(bounds, bin + 1))
            bin++;
        combiner->counts[bin] += snow_active_count(words, part.first, at, end);
    }
}

int snow_exchange_counts(const snow_combiner *combiner,
                         const int64_t **counts) {
    *counts = combiner->counts;
    return combiner->counted_bins;
}
