/* classify/hidden.h - data values of which a look shows nothing, whatever the
 * view. */
#ifndef SNOW_CLASSIFY_HIDDEN_H
#define SNOW_CLASSIFY_HIDDEN_H

#include "transfer/transfer.h"
#include "volume/volume.h"

/* Data values low .. high, whose ends may be infinite. */
typedef struct snow_hidden_range {
    double low, high;
} snow_hidden_range;

/* The most ranges of a look; those of higher values are not looked for. */
#define SNOW_HIDDEN_MOST 8

/* The ranges, rising, that are at least `spare` away from every value that is
 * interesting; how many there are.  A look of labels, and one whose points lie
 * on a logarithmic scale, have none. */
int snow_hidden_ranges(const snow_transfer *transfer,
                       const snow_volume_info *info, double threshold,
                       double spare, snow_hidden_range out[SNOW_HIDDEN_MOST]);

/* Returns whether one of them has all values low .. high. */
bool snow_is_hidden(const snow_transfer *transfer, const snow_volume_info *info,
                    double threshold, double spare, double low, double high);

#endif
