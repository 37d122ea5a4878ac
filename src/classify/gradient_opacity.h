/* classify/gradient_opacity.h - gradient opacity: a factor on a voxel's opacity
 * that depends on the magnitude of its gradient, so that boundaries stand out
 * (Levoy, "Display of Surfaces from Volume Data", 1988).
 *
 *   opacity = a(value) g(|gradient|)
 *
 * The gradient is that of shading (model, section 4), in data units per unit of
 * world space: |slope| |W d| for differences d of native values, with W the
 * inverse transpose of the matrix' linear part. The product decides whether a
 * voxel is interesting. It is computed in double precision from a float a, so
 * that all methods decide alike. */
#ifndef SNOW_CLASSIFY_GRADIENT_OPACITY_H
#define SNOW_CLASSIFY_GRADIENT_OPACITY_H

#include "simd/isa.h"
#include "transfer/transfer.h"
#include "transform/transform.h"
#include "volume/volume.h"

/* A gradient opacity prepared for one volume. */
typedef struct snow_gradient_opacity {
    const snow_volume *volume;
    const snow_transfer *transfer;
    double metric[3][3]; /* W^T W: |W d|^2 = d . metric d */
    double scale;        /* |slope|: native to data values */
    double threshold;    /* opacity 0 to 255 */
    snow_isa isa;        /* resolved; all instruction sets give the same bits */
} snow_gradient_opacity;

/* A row of voxels of a slice. */
typedef struct snow_gradient_opacity_row {
    const snow_placement *placement;
    int64_t slice, row;
} snow_gradient_opacity_row;

/* Whether a transfer function has a gradient opacity. */
static inline bool
snow_transfer_has_gradient_opacity(const snow_transfer *transfer) {
    return transfer->gradient_count > 0;
}

/* `isa` is resolved, or AUTO for the plain loops. Errors: SNOW_STATUS_BAD_USAGE
 * (a singular matrix). */
snow_status snow_gradient_opacity_init(snow_context *context,
                                       const snow_volume *volume,
                                       const snow_transfer *transfer,
                                       double threshold, snow_isa isa,
                                       snow_gradient_opacity *out);

/* Factors of the voxels of a row, at most SNOW_GRADIENT_OPACITY_BLOCK;
 * `columns` are rising. */
#define SNOW_GRADIENT_OPACITY_BLOCK 128
void snow_gradient_opacity_factors(
    const snow_gradient_opacity *gradient_opacity,
    const snow_gradient_opacity_row *row, const uint32_t *columns, size_t count,
    double *factors);

/* a' = 1 - (1 - a)^exponent in place (model, section 6). */
void snow_gradient_opacity_correct(
    const snow_gradient_opacity *gradient_opacity, double exponent,
    size_t count, double *opacities);

#endif
