/* volume/region.h - which bytes of a file are wanted: a box of voxels of one
 * time step, whichever files the array of all of them lies in.
 *
 *   array   | step 0 | step 1 ......................... | step 2 |
 *           0        before                                      all
 *   box               .. ====== .... ====== .... ====== ..
 *                        run 0       run 1       run 2
 *
 * A run is a row of the box.  Rows that follow one another without a gap, since
 * the box is as wide as the volume, are one run, and so are slices. */
#ifndef SNOW_VOLUME_REGION_H
#define SNOW_VOLUME_REGION_H

#include "io/source.h"

#include <snowglass/volume.h>

typedef struct snow_region {
    uint64_t before, all; /* bytes: before the time step; of the whole array */
    uint64_t value;       /* bytes of a voxel */
    int64_t dims[3];      /* of a time step */
    int64_t first[3], count[3]; /* the box */
} snow_region;

/* Lays the window of what `info` (sizes, type, time step) and the crop of
 * the options say, and makes info->dims those of the box.  The matrix stays
 * that of the whole; formats/formats.c moves it for all readers.
 * Errors: SNOW_STATUS_BAD_INPUT (info: as snow_volume_info_check; time steps
 * beyond all measure), SNOW_STATUS_BAD_USAGE (a box that does not lie in the
 * volume). */
snow_status snow_region_lay_out(snow_context *context,
                                const snow_volume_options *options,
                                snow_volume_info *info, snow_region *out);

/* For the readers of files that are packed in blocks: so large ones. */
static inline void snow_region_in_blocks(snow_context *context,
                                         const snow_region *region,
                                         const int64_t size[3]) {
    for (int i = 0; i < 3; i++) {
        context->blocks.size[i] = size[i];
        context->blocks.cut[i] = region->first[i] % size[i];
    }
}

/* The runs of the box, from 0; their places in the array, in bytes. */
int64_t snow_region_runs(const snow_region *region);
void snow_region_run(const snow_region *region, int64_t run, uint64_t *begin,
                     uint64_t *end);

/* The first run that ends behind byte `at`; how many there are if none does. */
int64_t snow_region_run_at(const snow_region *region, uint64_t at);

/* What one file has of the array: bytes begin .. end - 1, whole voxels. */
typedef struct snow_file_part {
    const snow_region *region;
    uint64_t begin, end;
} snow_file_part;

/* Returns whether some of them are wanted; whether all are, and nothing
 * else. */
bool snow_file_part_wanted(const snow_file_part *part);
bool snow_file_part_is_all(const snow_file_part *part);

/* Takes the bytes of a part, which the source stands before, and puts the
 * wanted ones where they belong in `voxels`, the memory of the box.  Of a file
 * little more than the wanted bytes is read.
 * Errors: as snow_source_read_all. */
snow_status snow_file_part_read(snow_source *source, const snow_file_part *part,
                                void *voxels);

/* The same with the part's bytes in memory. */
void snow_file_part_copy(const snow_file_part *part, const void *bytes,
                         void *voxels);

#endif
