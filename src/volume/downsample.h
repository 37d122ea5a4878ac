/* volume/downsample.h - a volume of half the resolution: each voxel is made of
 * those whose boxes its own box covers.
 *
 *   along an axis of 6 voxels   | 0 | 1 | 2 | 3 | 4 | 5 |
 *   becomes 3                   |   0   |   1   |   2   |
 *
 *   of 5 voxels                 |  0  |  1  |  2  |  3  |  4  |
 *   becomes 3                   |    0    |    1    |    2    |
 *
 * The boxes together are those of the volume, also where a count is odd: then a
 * voxel is a little less than twice as long, and a voxel that lies across a
 * border has a share in both sides.  So nothing at the rim is lost or moved,
 * and a camera sees both volumes at one place. */
#ifndef SNOW_VOLUME_DOWNSAMPLE_H
#define SNOW_VOLUME_DOWNSAMPLE_H

#include "volume/volume.h"

/* A mean of values before they are classified is not what a mean of colours
 * would be: thin bright things between dark voxels become dark.  So a value may
 * lean: it is moved from the mean by this share of the way to the largest, or
 * the smallest, of the values.  Of shares in steps of a quarter this one is
 * nearest to the exact picture for vessels as for bodies (docs/fast.md). */
#define SNOW_DOWNSAMPLE_LEAN 0.25

/* An axis of fewer voxels stays as it is. */
#define SNOW_DOWNSAMPLE_LEAST 4

/* What the halved volume is like; axes of fewer than SNOW_DOWNSAMPLE_LEAST
 * voxels are taken out of `axes`, which may leave none. */
snow_volume_info snow_downsampled_info(const snow_volume_info *info,
                                       bool axes[3]);

/* Memory that halving needs, kept from one volume to the next; zeros at first.
 * Free the block with snow_release. */
typedef struct snow_downsample_buffers {
    void *block;
    size_t capacity;
} snow_downsample_buffers;

/* The part of a halved volume, of `dims` voxels, that can be made of a part of
 * the volume: of voxels that are stored, all of whose own are.  A voxel is made
 * by the owner of the first that it is made of, so that the parts of all make
 * up the halved volume; a part that owns none stores one voxel, which is not
 * made.  Returns false then. */
bool snow_downsampled_part(const snow_volume *volume, const int64_t dims[3],
                           snow_extent *part, int64_t stored[3]);

/* Layers of voxels along an axis of `dims` that a part needs on either side for
 * the halved volume to have `layers`. */
int64_t snow_downsampled_layers(int64_t dims, int64_t layers);

/* Fills the voxels of `out`, which snow_volume_new has made of
 * snow_downsampled_info with the same axes, and gives it a new serial number.
 * Where the volume is a part, `out` is its part of the whole's, see above.
 *
 * A voxel is the weighted mean of native values, which leans to the largest
 * where `lean` is above 0, to the smallest where it is below; in the volume's
 * own type, of integers rounded to the nearest, halves up.  Values that are not
 * numbers have no weight; a voxel of no others is none either.  The bytes are
 * the same on every machine and for every number of threads.  Errors:
 * SNOW_STATUS_NO_MEMORY. */
snow_status snow_volume_downsample(const snow_volume *volume,
                                   const bool axes[3], int lean, int threads,
                                   snow_downsample_buffers *room,
                                   snow_volume *out);

#endif
