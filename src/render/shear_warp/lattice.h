/* render/shear_warp/lattice.h - where shear-warp takes its samples: resampled
 * slices, lattice, and how the lattice is warped. */
#ifndef SNOW_RENDER_SHEAR_WARP_LATTICE_H
#define SNOW_RENDER_SHEAR_WARP_LATTICE_H

#include "splat/shear_warp/splat.h"
#include "warp/warp.h"

#include <snowglass/render.h>

/* Samples are cells[0] x cells[1] a voxel; in a quincunx there is one more in
 * the middle of each cell, and the plane of the image is turned by 45 degrees:
 * cell (i, j) is pixel (i + j, i - j). */
typedef struct snow_value_lattice {
    int cells[2];
    bool quincunx;
    int phases;         /* of a voxel */
    int64_t first[2];   /* voxel of the image's first sample */
    int64_t voxels[2];  /* of the image */
    double slope[2];    /* voxels a slice */
    double front;       /* slice of the front resampled slice, whose voxels have
                           samples */
    bool nearest_first; /* slice 0 is the nearest to the eye */
    bool perspective;
    double eye[3]; /* perspective: position along u, v and slices */
    int per_slice; /* resampled slices: 1, or an even number */
    int resampled_count;
    double path; /* world length of a ray between two resampled slices */
    /* The image. */
    int width, height;
    int top;          /* of a quincunx: pixel of cell (0, 0) down */
    bool empty;       /* nothing is in view */
    snow_shear shear; /* picture to image, as snow_warp_row takes it */
    snow_perspective_shear scaled; /* the same in perspective */
    snow_filter filter;
    int means;    /* bi-linear samples a side of a pixel; 1: `filter` */
    int halvings; /* of the image, before */
} snow_value_lattice;

/* Errors: SNOW_STATUS_BAD_USAGE (spacings or a view that it cannot draw). */
snow_status
snow_value_lattice_make(snow_context *context, const snow_volume_info *info,
                        const snow_view *view, const snow_placement *placement,
                        snow_quality quality, snow_value_lattice *out);

/* The most voxels that a ray moves aside from one resampled slice to the next,
 * whatever the size of a voxel in the picture; more than SNOW_VALUE_REACH_MOST
 * where spacings differ too much. */
double snow_value_lattice_reach(const snow_volume_info *info,
                                const snow_placement *placement,
                                snow_quality quality);

/* Moves the image by pixels along an axis. */
void snow_value_lattice_move(snow_value_lattice *lattice, int axis, double by);

/* --- perspective: eye.c --------------------------------------------------- */

/* Returns whether the eye is outside of the slices, and not too near: samples
 * of the last resampled slice and rays are as far apart as encodings provide
 * for. */
bool snow_value_eye_fits(const snow_placement *placement, int per_slice);

/* The most voxels along u or v that rays move aside from one slice to the next
 * where they meet the volume. */
double snow_value_eye_slope(const snow_placement *placement, int axis);

/* Returns whether rays move aside by no more voxels from one resampled slice to
 * the next than encodings provide for, whatever the view; in perspective, as
 * above. */
bool snow_value_fits(const snow_volume_info *info,
                     const snow_placement *placement,
                     const snow_settings *settings);

/* The image, of so many phases a voxel along u and v.  Errors:
 * SNOW_STATUS_BAD_USAGE (too large). */
snow_status snow_value_eye_image(snow_context *context,
                                 const snow_placement *placement,
                                 const int phases[2], snow_value_lattice *out);

/* Lattice pixels a pixel where the volume's middle is seen. */
double snow_value_eye_density(const snow_value_lattice *lattice,
                              const snow_placement *placement);

/* Voxels of a resampled slice for one of the front resampled slice. */
static inline double snow_value_eye_step(const snow_value_lattice *l,
                                         double slice) {
    return (slice - l->eye[2]) / (l->front - l->eye[2]);
}

/* How many voxels a ray moves aside from one resampled slice to the next, and
 * how much farther than one voxel its gradient looks. */
double snow_value_eye_reach(const snow_value_lattice *lattice,
                            const snow_placement *placement);

/* How samples are spread on a resampled slice, and lanes along an axis of it
 * for each phase and tile, in voxels from `stored` on. */
snow_value_spread snow_value_eye_spread(const snow_value_lattice *lattice,
                                        const snow_resampled_slice *resampled);
void snow_value_eye_lanes(const snow_value_lattice *lattice,
                          const snow_resampled_slice *resampled, int axis,
                          int tiles, int64_t stored, int margin,
                          snow_value_lanes *lanes);

/* The resampled slices, front to back, and the places of all phases on them. */
void snow_value_lattice_slices(const snow_value_lattice *lattice,
                               const snow_placement *placement,
                               snow_resampled_slice *resampled_slices,
                               snow_value_place *places);

/* The pixel of a phase of cell (0, 0) of the image, and the steps to the next
 * cells along u and v. */
typedef struct snow_value_pixels {
    int at[2], along_u[2], along_v[2];
} snow_value_pixels;
snow_value_pixels snow_value_lattice_pixels(const snow_value_lattice *lattice,
                                            int phase);

#endif
