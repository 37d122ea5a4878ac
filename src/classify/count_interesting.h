/* classify/count_interesting.h - visits interesting voxels, and counts them by
 * blocks for the partition of a volume (decompose/partition.h). */
#ifndef SNOW_CLASSIFY_COUNT_INTERESTING_H
#define SNOW_CLASSIFY_COUNT_INTERESTING_H

#include "classify/classify.h"
#include "decompose/partition.h"

/* Those of row (y, z) of the whole that a volume owns. */
typedef struct snow_interesting_row {
    int64_t y, z, stored; /* the column of the whole that is 0 here */
    int worker;           /* below the walk's threads */
    size_t count, stride; /* of opacities, from one to the next */
    const uint32_t *columns;
    const float *opacities;
} snow_interesting_row;

/* A walk over all rows that have any.  Errors: as below; stopped. */
typedef struct snow_interesting_walk {
    const snow_volume *volume;
    const snow_transfer *transfer;
    double threshold, exponent; /* as snow_classify_options */
    snow_isa isa;
    bool only_counts; /* opacities are not looked at, and may be 0 */
    int threads;      /* 0: one, which visits rows in order */
    int64_t step;     /* of slices along z of the whole; 0: all are visited */
} snow_interesting_walk;
typedef void snow_interesting_fn(void *user, const snow_interesting_row *row);
snow_status snow_visit_interesting(const snow_interesting_walk *walk,
                                   snow_interesting_fn *visit, void *user);

/* Adds the interesting voxels that a volume owns to block counts. The grid of
 * the counts is the volume's own, or that of the volume it is a part of. Each
 * thread but the first has counts of its own meanwhile.
 * Errors: SNOW_STATUS_BAD_USAGE (a row of 2^32 voxels or more),
 * SNOW_STATUS_NO_MEMORY. */
snow_status snow_count_interesting_blocks(const snow_volume *volume,
                                          const snow_transfer *transfer,
                                          double threshold, snow_isa isa,
                                          int threads,
                                          snow_block_counts *block_counts);

/* The total number of interesting voxels. Errors: as above. */
snow_status snow_count_interesting(const snow_volume *volume,
                                   const snow_transfer *transfer,
                                   double threshold, snow_isa isa, int threads,
                                   int64_t *out);

/* Native values first .. last. */
typedef struct snow_native_range {
    int32_t first, last;
} snow_native_range;

/* The ranges of interesting native values of a type of 8 or 16 bits, of first
 * .. last, without a gradient opacity; returns their number, -1 where they are
 * more than `most`. */
int snow_interesting_ranges(const snow_volume_info *info,
                            const snow_transfer *transfer, double threshold,
                            int32_t first, int32_t last, snow_native_range *out,
                            int most);

#endif
