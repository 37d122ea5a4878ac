/* splat/perspective.h - footprints in perspective: every voxel throws the
 * square of its two kernels through its slice's projective map, a quadrangle.
 * Footprints differ from voxel to voxel, so nothing is tabulated but the
 * kernel: the exact picture (model, point 7), not a fast one. */
#ifndef SNOW_SPLAT_PERSPECTIVE_H
#define SNOW_SPLAT_PERSPECTIVE_H

#include "splat/splat.h"
#include "transform/eye.h"

/* What the ray of a pixel meets: on a slice at height h above the eye (model,
 * point 2; transform/eye.h) the place eye + h slope, where h has the sign of
 * `side`. */
typedef struct snow_pixel_ray {
    double slope[2];
    double side; /* 1 or -1; 0: the ray runs along the slices */
} snow_pixel_ray;

typedef struct snow_eye_splatter {
    const snow_placement *placement;
    snow_kernel kernel;
    int support, channels;
    snow_pixel_ray *rays; /* of all pixels */
    snow_taper taper[2];  /* of the slice, along u and v */
    snow_taper_table table[2];
    double height; /* of the slice above the eye, slices */
} snow_eye_splatter;

/* Errors: SNOW_NO_MEMORY.  Free with snow_eye_splatter_fini. */
snow_status snow_eye_splatter_init(snow_context *context,
                                   const snow_placement *placement,
                                   snow_kernel kernel, int support,
                                   int channels, snow_eye_splatter *out);
void snow_eye_splatter_fini(snow_context *context, snow_eye_splatter *splatter);

/* Makes `slice` the current one; *seen is false where it is seen from its edge
 * and shows nothing.  Errors: SNOW_NO_MEMORY. */
snow_status snow_eye_splatter_begin_slice(snow_context *context,
                                          snow_eye_splatter *splatter,
                                          int64_t slice, bool *seen);

/* As snow_splat_row. */
void snow_eye_splat_row(const snow_eye_splatter *splatter, snow_sheet *sheet,
                        int64_t row, const snow_span *spans, size_t count,
                        const float *samples);

#endif
