/* classify/tally.h - interesting voxels counted by blocks, for cuts
 * (decompose/cut.h). */
#ifndef SNOW_TALLY_H
#define SNOW_TALLY_H

#include "classify/classify.h"
#include "decompose/cut.h"

/* Adds the interesting voxels that a volume answers for to the counts of a
 * tally of the grid that it is, or is a part of.  Errors: SNOW_BAD_USAGE (a row
 * of 2^32 voxels or more), SNOW_NO_MEMORY. */
snow_status snow_tally_count(const snow_volume *volume,
                             const snow_transfer *transfer, double threshold,
                             snow_isa isa, snow_tally *tally);

/* How many there are in all.  Errors: the same. */
snow_status snow_count_interesting(const snow_volume *volume,
                                   const snow_transfer *transfer,
                                   double threshold, snow_isa isa,
                                   int64_t *out);

#endif
