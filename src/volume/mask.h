/* volume/mask.h - volumes without voxels that a mask or planes leave out. */
#ifndef SNOW_MASK_H
#define SNOW_MASK_H

#include "volume/volume.h"

/* What is left out of a volume: by a mask on its grid, NULL where there is
 * none, and by planes. */
typedef struct snow_cuts {
    const snow_volume *mask;
    const snow_label_range *labels;
    size_t label_count;
    const double *planes; /* four numbers each */
    size_t plane_count;
    bool keeps_clipped; /* voxels next to the planes, for methods that end
                           exactly there (clip_planes.h); they take memory */
} snow_cuts;

/* The type that holds all values of another, and NaN. */
snow_type snow_masked_type(snow_type type);

/* Gives a volume that type. */
void snow_mask_info(snow_volume_info *info);

/* Whether a volume's values can be picked as labels; makes voxels of other
 * labels 0: whether any are left.  Errors: SNOW_STATUS_BAD_USAGE (fractions).
 */
snow_status snow_labels_check(snow_context *context,
                              const snow_volume_info *info);
bool snow_labels_pick(snow_volume *volume, const snow_label_range *labels,
                      size_t count);

/* The volume without what is cut off; *any: whether a voxel is left. */
snow_status snow_mask_apply(const snow_volume *volume, const snow_cuts *by,
                            bool *any, snow_volume **out);

/* Cuts a volume of its own clip planes, whose type is a floating-point one,
 * once more: its voxels have come from elsewhere. */
snow_status snow_mask_cut_again(snow_volume *volume);

/* Returns whether the options name a mask, labels of one, or planes; options
 * may be NULL. */
bool snow_mask_asked(const snow_volume_options *options);

/* Notifies that no voxel is left of a volume that was opened with these
 * options, by a mask of these values, or by planes alone. */
void snow_mask_warn(snow_context *context, const snow_volume_options *options,
                    const double mask_range[2]);

#endif
