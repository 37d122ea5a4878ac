/* classify/fade.h - gradient opacity: the factor that a voxel's opacity is
 * multiplied with, by the magnitude of its gradient, so that boundaries stand
 * out (Levoy, "Display of Surfaces from Volume Data", 1988).
 *
 *   opacity = a(value) g(|gradient|)
 *
 * The gradient is that of shading (model, point 4), in data units per unit of
 * the world: |slope| |W d| for differences d of native values, with W the
 * inverse transpose of the matrix' linear part.  A voxel is interesting by the
 * product, which is taken in double precision from a float a, so that all
 * methods decide alike. */
#ifndef SNOW_FADE_H
#define SNOW_FADE_H

#include "classify/transfer.h"
#include "simd/isa.h"
#include "transform/transform.h"
#include "volume/volume.h"

/* IA holds a factor g as a code of 16 bits, finer towards 0 and towards 1:
 *
 *   g = 2 x^2             x = code / 65535 up to 1/2
 *   g = 1 - 2 (1 - x)^2   beyond
 *
 * For what counts is how much g is off in parts of itself, and 1 - g in parts
 * of itself where rays through a slice are short.  g is off by no more than
 * sqrt(2 min(g, 1 - g)) / 65535.  A stack of voxels of one g and one a is off
 * by less than a quarter of an 8-bit step for g above 7e-5, and below that for
 * up to 5,600 of them.  Code 0 is a voxel that is not interesting. */
#define SNOW_FADE_ONE 65535
#define SNOW_NO_FADE 0

/* The factor that a code stands for. */
static inline float snow_fade_of(uint32_t code) {
    uint32_t rest = SNOW_FADE_ONE - code;
    uint32_t least = code < rest ? code : rest;
    float x = (float)(int32_t)least * (1.0F / SNOW_FADE_ONE);
    float square = 2 * x * x;
    return code < rest ? square : 1 - square;
}

/* A gradient opacity made ready for one volume. */
typedef struct snow_fader {
    const snow_volume *volume;
    const snow_transfer *transfer;
    double metric[3][3]; /* W^T W: |W d|^2 = d . metric d */
    double scale;        /* |slope|: native to data values */
    double threshold;    /* opacity 0 to 255 */
    snow_isa isa;        /* resolved; all give the same bits */
} snow_fader;

/* A row of voxels of a slice, or of the one half-way between it and the next,
 * whose gradients are the means of theirs. */
typedef struct snow_fade_row {
    const snow_placement *placement;
    int64_t slice, row;
    bool between;
} snow_fade_row;

/* Whether a transfer function has a gradient opacity. */
static inline bool snow_transfer_fades(const snow_transfer *transfer) {
    return transfer->gradient_count > 0;
}

/* `isa` is resolved, or AUTO for the plain loops.  Errors: SNOW_BAD_USAGE (a
 * singular matrix). */
snow_status snow_fader_init(snow_context *context, const snow_volume *volume,
                            const snow_transfer *transfer, double threshold,
                            snow_isa isa, snow_fader *out);

/* Factors of the voxels of a row; `columns` are rising.  At most
 * SNOW_FADE_BLOCK of them. */
#define SNOW_FADE_BLOCK 128
void snow_fade_factors(const snow_fader *fader, const snow_fade_row *row,
                       const uint32_t *columns, size_t count, double *factors);

/* a' = 1 - (1 - a)^exponent in place (model, point 6). */
void snow_fade_correct(const snow_fader *fader, double exponent, size_t count,
                       double *opacities);

/* Codes of any number of voxels of a row, whose native values lie one after
 * another from column 0 on; SNOW_NO_FADE of those that are not interesting. */
void snow_fade_codes(const snow_fader *fader, const snow_fade_row *row,
                     const void *natives, const uint32_t *columns, size_t count,
                     uint16_t *codes);

#endif
