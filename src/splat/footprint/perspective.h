/* splat/footprint/perspective.h - footprints in perspective: the product of a
 * voxel's two kernels, mapped by its slice's projective map to a quadrangle.
 * Footprints differ from voxel to voxel, so only the kernel is tabulated: the
 * picture is exact (model, section 7), not fast. */
#ifndef SNOW_SPLAT_FOOTPRINT_PERSPECTIVE_H
#define SNOW_SPLAT_FOOTPRINT_PERSPECTIVE_H

#include "splat/footprint/splat.h"
#include "transform/perspective.h"

/* The ray of a pixel: it meets a slice at height h above the eye (model,
 * section 2; transform/perspective.h) at eye + h slope; h has the sign of
 * `side`. */
typedef struct snow_pixel_ray {
    double slope[2];
    double side; /* 1 or -1; 0: the ray is parallel to the slices */
} snow_pixel_ray;

typedef struct snow_perspective_splatter {
    const snow_placement *placement;
    snow_kernel kernel;
    int support, channels;
    snow_pixel_ray *rays;                /* for all pixels */
    snow_scaled_kernel scaled_kernel[2]; /* of the slice, along u and v */
    snow_scaled_kernel_table table[2];
    double height; /* of the slice above the eye, slices */
} snow_perspective_splatter;

/* Errors: SNOW_STATUS_NO_MEMORY.  Free with snow_perspective_splatter_fini. */
snow_status snow_perspective_splatter_init(snow_context *context,
                                           const snow_placement *placement,
                                           snow_kernel kernel, int support,
                                           int channels,
                                           snow_perspective_splatter *out);
void snow_perspective_splatter_fini(snow_context *context,
                                    snow_perspective_splatter *splatter);

/* Makes `slice` the current one; *seen is false if it is seen edge-on and shows
 * nothing. Errors: SNOW_STATUS_NO_MEMORY. */
snow_status
snow_perspective_splatter_begin_slice(snow_context *context,
                                      snow_perspective_splatter *splatter,
                                      int64_t slice, bool *seen);

/* Does what snow_splat_row does. */
void snow_perspective_splat_row(const snow_perspective_splatter *splatter,
                                snow_sheet *sheet, int64_t row,
                                const snow_span *spans, size_t count,
                                const float *samples);

#endif
