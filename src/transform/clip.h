/* transform/clip.h - clips every slice to a processor's part of the volume.
 *
 * A part of the volume is a box of voxels.  A sample of a sheet is the
 * contribution of one slice to one pixel. It belongs to the part whose box
 * contains its grid position. Boxes meet half-way between voxels, and those at
 * the volume's ends reach as far as kernels do:
 *
 *   voxels      0   1   2   3   4   5        two parts, of 3 voxels each
 *   samples   <- - - - - - -|- - - - - - ->
 *   belong to     part 0       part 1
 *
 * Positions refer to the whole grid, and both parts compute the border between
 * them by the same operations: every sample is made exactly once. */
#ifndef SNOW_CLIP_H
#define SNOW_CLIP_H

#include "decompose/order.h"
#include "transform/shear.h"
#include "transform/shear_perspective.h"
#include "volume/clip_planes.h"

/* Along u, v and the slice axis of a placement, in voxels of the whole. */
typedef struct snow_clip {
    bool cuts; /* other parts own samples of its slices, along u or v */
    int64_t stored[3], size[3]; /* voxels that the part has */
    int64_t first[3], count[3]; /* voxels that it owns; 0 if none */
    double low[2], high[2]; /* grid positions along u and v that it owns: from
                               low on, below high; infinite at the ends */
} snow_clip;

/* The clip of a volume's part under a placement of the whole. */
void snow_clip_make(const snow_volume *volume, const snow_placement *whole,
                    snow_clip *out);

/* A placement of the stored voxels: that of the whole, with the first stored
 * voxel as the origin. */
void snow_clip_placement(const snow_clip *clip, const snow_placement *whole,
                         snow_placement *out);

/* Clears those of `count` pixels from (x, y) of the picture for which the part
 * has no sample of the sheet. */
void snow_clip_pixels(const snow_clip *clip, const snow_placement *whole,
                      int64_t slice, int x, int y, int count, int channels,
                      float *pixels);

/* The direction in which the rays of a placement cross the grid. It uses the
 * same numbers as above, so that rounding cannot make a ray alternate between
 * two parts. */
void snow_clip_viewer(const snow_placement *whole, snow_viewer *out);

/* --- cut faces of clip planes ---------------------------------------------
 *
 * They are flat: next to them the gradient, which knows of no cut, lights
 * nothing but noise.  So many voxels along a ray from where it enters through a
 * plane colours are unlit, and lit as elsewhere from twice as many on. */
#define SNOW_FLAT_DEPTH 2

/* How much of the light at a place is that of cut faces, 0 to 1. */
float snow_clip_flatness(const snow_clip_planes *clip,
                         const snow_viewer *viewer, const double at[3]);

#endif
