/* volume/clip_planes.h - the planes that have cut a volume, and the values next
 * to them.
 *
 * Voxels beyond a plane are NaN (volume/mask.h).  A method that interpolates
 * values ends exactly at the plane, between voxels, and needs those beyond it
 * that are in reach:
 *
 *             plane
 *   o   o   o | x   x   x   .   .     o  the volume's voxels
 *                                     x  NaN there, and kept here
 *                                     .  NaN
 */
#ifndef SNOW_VOLUME_CLIP_PLANES_H
#define SNOW_VOLUME_CLIP_PLANES_H

#include "base/base.h"

#include <snowglass/volume.h>

typedef struct snow_clipped_voxel {
    int64_t at;    /* linear index */
    double native; /* value */
} snow_clipped_voxel;

/* A plane over voxel indices: outside is where [0] x + [1] y + [2] z > [3]. */
typedef double snow_index_plane[4];

typedef struct snow_clip_planes {
    snow_context *context;
    snow_index_plane *planes;
    size_t plane_count;
    snow_clipped_voxel *voxels; /* in order of index */
    size_t voxel_count;
    double reach[3]; /* how far values are kept, in steps along each axis */
} snow_clip_planes;

/* Returns whether four numbers stand for a plane: four zeros are none. */
bool snow_is_plane(const double plane[4]);

/* Refuses planes without a normal or with a number that is not finite. */
snow_status snow_planes_check(snow_context *context, const double *planes,
                              size_t count);

/* Those of `before` (NULL: none), and `count` planes of the world, four numbers
 * each.  *out is NULL where there is no
 * plane at all.  Free with snow_clip_planes_free. */
snow_status snow_clip_planes_new(snow_context *context,
                                 const snow_volume_info *info,
                                 const snow_clip_planes *before,
                                 const double *planes, size_t count,
                                 snow_clip_planes **out);
void snow_clip_planes_free(snow_clip_planes *clip);

/* The same planes over the voxels of another part, whose first voxel is that at
 * `by` of theirs.  No value is kept yet. */
snow_status snow_clip_planes_move(const snow_clip_planes *clip,
                                  const int64_t by[3], snow_clip_planes **out);

/* Writes the values that are kept (`shown`), or NaN again, to voxels of a
 * floating-point type. */
void snow_clip_planes_show(const snow_clip_planes *clip, snow_type type,
                           bool shown, void *voxels);

/* Makes NaN of values beyond the planes, of voxels from linear index `first`
 * on; `keep`: those in reach are kept.  Called with rising indices. */
snow_status snow_clip_planes_apply(snow_clip_planes *clip,
                                   const int64_t dims[3], int64_t first,
                                   size_t count, bool keep, double *stored);

/* The native value of a voxel that was kept; NaN where there is none. */
double snow_clip_planes_value(const snow_clip_planes *clip, int64_t index);

/* The same by its place, which is fast where the planes are far. */
double snow_clip_planes_value_at(const snow_clip_planes *clip,
                                 const int64_t dims[3], const int64_t at[3]);

#endif
