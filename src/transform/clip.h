/* transform/clip.h - a processor's part of every slice.
 *
 * A part of the volume is a box of voxels.  A sample of a sheet, which is what
 * one pixel sees of one slice, belongs to the part in whose box its grid
 * position lies; boxes are cut half-way between voxels, and those at the
 * volume's ends reach as far as kernels do:
 *
 *   voxels      0   1   2   3   4   5        two parts, of 3 voxels each
 *   samples   <- - - - - - -|- - - - - - ->
 *   belong to     part 0       part 1
 *
 * Positions are those in the whole grid, and a border between parts is computed
 * by the same operations on either side of it: every sample is made once. */
#ifndef SNOW_CLIP_H
#define SNOW_CLIP_H

#include "decompose/order.h"
#include "transform/scaled.h"
#include "transform/shear.h"

/* Along u, v and the slice axis of a placement, in voxels of the whole. */
typedef struct snow_clip {
    bool cuts; /* samples of its slices are another's: along u or v */
    int64_t stored[3], size[3]; /* voxels that the part has */
    int64_t first[3], count[3]; /* and answers for; all 0 where it is for none
                                 */
    double low[2], high[2]; /* grid positions along u and v that are its own:
                               from low on, below high; infinite at the ends */
} snow_clip;

/* The clip of a volume's part under a placement of the whole. */
void snow_clip_make(const snow_volume *volume, const snow_placement *whole,
                    snow_clip *out);

/* A placement of the stored voxels: that of the whole, counted from them. */
void snow_clip_placement(const snow_clip *clip, const snow_placement *whole,
                         snow_placement *out);

/* The part's pixels range[0] .. range[1] - 1 of the intermediate image on a
 * slice, which need not be a whole number; of axis 0 (u) or 1 (v). */
void snow_clip_lattice(const snow_clip *clip, int axis,
                       const snow_lattice *lattice, double slice, int range[2]);
void snow_clip_scaled(const snow_clip *clip, int axis,
                      const snow_scaled *scaled, double slice, int range[2]);

/* Clears those of `count` pixels from (x, y) of the picture on that a sheet has
 * no sample of the part for. */
void snow_clip_pixels(const snow_clip *clip, const snow_placement *whole,
                      int64_t slice, int x, int y, int count, int channels,
                      float *pixels);

/* How the rays of a placement cross the grid; by the same numbers as above, so
 * that rounding cannot have a ray go to and fro between two parts. */
void snow_clip_sight(const snow_placement *whole, snow_sight *out);

#endif
