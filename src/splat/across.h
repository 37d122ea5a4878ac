/* splat/across.h - reconstruction in the sheared method, first half: a row of
 * samples through the kernel along u (R in figure 7).
 *
 * A sheared slice has one footprint for all of its voxels, up to the phase of
 * the pixel, and it is separable: each row is filtered along u once, and lines
 * of the image are then weighted sums of such rows (composite/down.h). */
#ifndef SNOW_ACROSS_H
#define SNOW_ACROSS_H

#include "simd/isa.h"
#include "splat/kernel.h"
#include "transform/shear.h"

/* Pixels that are computed, or skipped, together.  A mask has a bit for each
 * chunk of a line. */
#define SNOW_CHUNK 16

/* The most voxels that a pixel sums along one axis: support 9, pixels of 64
 * voxels, and one for the ends. */
#define SNOW_TAPS_MOST 512

/* The kernel of one slice along one axis of the lattice: pixel P, of phase
 * P mod phases, sums the voxels
 *
 *   P / phases * stride + offset[phase] + m,   m = 0 .. taps - 1
 *
 * with weights[phase * taps + m]. */
typedef struct snow_across {
    int phases, stride, taps;
    int64_t first; /* lattice pixel of pixel 0 */
    int64_t offset[2];
    const float *weights;
} snow_across;

/* How many voxels a pixel can have in reach: taps of a lattice. */
int snow_taper_taps(const snow_taper *taper);

/* The kernel of slice k; `weights` gets phases * taps floats that add up to 1
 * per phase. */
void snow_across_place(const snow_taper *taper, const snow_lattice *lattice,
                       double slice, float *weights, snow_across *out);

/* Filters a row: `row` is its voxel 0, with zeros wherever there is no
 * interesting voxel, also before and after, as far as chunks of the mask
 * reach: SNOW_CHUNK * stride + taps voxels.  The chunks of the mask are written
 * to `line`. */
typedef void snow_across_fn(const snow_across *across, const float *row,
                            const uint64_t *mask, size_t words, float *line);

/* The function of a level, for 2 or 4 channels. */
snow_across_fn *snow_across_of(snow_isa isa, int channels);

/* The pixels that a run of voxels reaches: *low to *high, both included, from
 * the image's pixel 0 on; perhaps beyond the image. */
static inline void snow_across_reach(const snow_across *a, int64_t first,
                                     int64_t last, int64_t *low,
                                     int64_t *high) {
    bool rising = a->phases == 2 && a->offset[1] > a->offset[0];
    int64_t least = rising ? a->offset[0] : a->offset[a->phases - 1];
    int64_t most = rising ? a->offset[1] : a->offset[0];
    int64_t from = first - most - a->taps + 1, to = last - least;
    if (a->stride > 1) {
        /* Rounded down; a pixel more on either side does no harm. */
        from = from / a->stride - 1;
        to = to / a->stride + 1;
    }
    *low = from * a->phases - a->first;
    *high = to * a->phases + a->phases - 1 - a->first;
}

#endif
