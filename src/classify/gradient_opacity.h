/* classify/gradient_opacity.h - gradient opacity: a factor on a voxel's opacity
 * that depends on the magnitude of its gradient, so that boundaries stand out
 * (Levoy, "Display of Surfaces from Volume Data", 1988).
 *
 *   opacity = a(value) g(|gradient|)
 *
 * The gradient is that of shading (model, point 4), in data units per unit of
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

/* IA holds a factor g as a code of 16 bits, finer towards 0 and towards 1:
 *
 *   g = 2 x^2             x = code / 65535 up to 1/2
 *   g = 1 - 2 (1 - x)^2   beyond
 *
 * This is because the relative error of g counts, and that of 1 - g where rays
 * through a slice are short. The error of g is at most sqrt(2 min(g, 1 - g)) /
 * 65535. A stack of voxels of one g and one a is off by less than a quarter of
 * an 8-bit step for g above 7e-5, and below that for up to 5,400 voxels. Code 0
 * is a voxel that is not interesting. */
#define SNOW_GRADIENT_OPACITY_ONE 65535
#define SNOW_NO_GRADIENT_OPACITY 0

/* The factor that a code stands for. */
static inline float snow_gradient_opacity_of(uint32_t code) {
    uint32_t rest = SNOW_GRADIENT_OPACITY_ONE - code;
    uint32_t least = code < rest ? code : rest;
    float x = (float)(int32_t)least * (1.0F / SNOW_GRADIENT_OPACITY_ONE);
    float square = 2 * x * x;
    return code < rest ? square : 1 - square;
}

/* A gradient opacity prepared for one volume. */
typedef struct snow_gradient_opacity {
    const snow_volume *volume;
    const snow_transfer *transfer;
    double metric[3][3]; /* W^T W: |W d|^2 = d . metric d */
    double scale;        /* |slope|: native to data values */
    double threshold;    /* opacity 0 to 255 */
    snow_isa isa;        /* resolved; all instruction sets give the same bits */
} snow_gradient_opacity;

/* A row of voxels of a slice, or half-way between it and the next slice;
 * gradients there are the means of those of the two slices. */
typedef struct snow_gradient_opacity_row {
    const snow_placement *placement;
    int64_t slice, row;
    bool between;
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

/* a' = 1 - (1 - a)^exponent in place (model, point 6). */
void snow_gradient_opacity_correct(
    const snow_gradient_opacity *gradient_opacity, double exponent,
    size_t count, double *opacities);

/* Codes of any number of voxels of a row whose native values are contiguous
 * from column 0 on; SNOW_NO_GRADIENT_OPACITY for those that are not
 * interesting. */
void snow_gradient_opacity_codes(const snow_gradient_opacity *gradient_opacity,
                                 const snow_gradient_opacity_row *row,
                                 const void *natives, const uint32_t *columns,
                                 size_t count, uint16_t *codes);

#endif
