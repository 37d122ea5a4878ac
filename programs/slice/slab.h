/* slab.h - slices with thickness: the maximum, mean or minimum of the slices
 * that lie within half of it on either side (--slab).
 *
 * Values of voxels are projected along the axis of the grid, before a picture
 * is made of them: so a slab is a volume of one slice, with the data values,
 * the place and the look of one. */
#ifndef SLAB_H
#define SLAB_H

#include "options/options.h"

#include <snowglass/snowglass.h>

typedef enum slab_kind { SLAB_MAX, SLAB_MEAN, SLAB_MIN } slab_kind;

typedef struct slab {
    slab_kind kind;
    int64_t half; /* slices on either side; 0: there is none but the middle */
} slab;

/* Slices of a volume, which are in it. */
typedef struct slab_slices {
    int axis;
    int64_t first, count;
} slab_slices;

/* What --slab asks for, NULL: nothing, across an axis of the grid.  Returns
 * CONTINUE or an exit code, as slab_check does. */
int slab_read(const char *text, const snow_volume_info *info, int axis,
              slab *out);

/* Labels have no mean. */
int slab_check(const slab *s, const snow_transfer *transfer);

/* The slices around a middle one. */
slab_slices slab_around(const slab *s, const snow_volume_info *info, int axis,
                        int64_t index);

/* Volumes of one slice each, in the place of slice `index` of others, which
 * are the channels of a picture; their voxels are theirs. */
typedef struct slab_volumes {
    snow_volume *volumes[SNOW_CHANNELS_MAX];
    void *voxels[SNOW_CHANNELS_MAX];
} slab_volumes;

snow_status slab_project(snow_context *context, const slab *s,
                         snow_volume *const *volumes, int count, int axis,
                         int64_t index, slab_volumes *out);
void slab_free(slab_volumes *made);

/* The view of a slab at the scale that a view has of its volume: zooms count in
 * the size of what is there. */
snow_status slab_see(snow_context *context, const snow_volume *volume,
                     const slab_volumes *made, int axis, const snow_view *view,
                     snow_view *out);

/* "maximum of 5 slices". */
void slab_describe(const slab *s, int64_t count, char *out, size_t size);

#endif
