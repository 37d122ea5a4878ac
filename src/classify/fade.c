/* classify/fade.c - gradient opacity: see classify/fade.h. */
#include "classify/fade.h"
#include "base/power.h"
#include "base/vec3.h"
#include "classify/classify.h"

#include <math.h>

#define BLOCK SNOW_FADE_BLOCK

/* Up to so many points are gone through for all voxels of a block; more are
 * searched for each voxel. */
#define STRETCHES_MOST 16

/* The loops of one level, in classify/fade.tmpl.h. */
typedef struct fade_kernels {
    void (*magnitudes)(const snow_fader *fader, double gradients[3][BLOCK],
                       size_t count, double *out);
    void (*factors)(const snow_opacity_point *points, size_t point_count,
                    size_t count, const double *magnitudes, double *factors);
    void (*correct)(double exponent, size_t count, double *opacities);
} fade_kernels;

/* The order matters, so a blank line keeps the two from being sorted. */
#define SELECT_SCALAR
#include "simd/select.h"

#include "classify/fade.tmpl.h"
#if SNOW_HAS_AVX
#define SELECT_AVX2
#include "simd/select.h"

#include "classify/fade.tmpl.h"
#define SELECT_AVX512
#include "simd/select.h"

#include "classify/fade.tmpl.h"
#endif

static const fade_kernels *kernels_of(snow_isa isa) {
#if SNOW_HAS_AVX
    if (isa == SNOW_ISA_AVX512)
        return &kernels_avx512;
    if (isa == SNOW_ISA_AVX2)
        return &kernels_avx2;
#endif
    (void)isa;
    return &kernels_scalar;
}

snow_status snow_fader_init(snow_context *context, const snow_volume *volume,
                            const snow_transfer *transfer, double threshold,
                            snow_isa isa, snow_fader *out) {
    double inverse[3][3];
    if (!snow_matrix_invert3(volume->info.matrix, inverse))
        return snow_fail(context, SNOW_BAD_USAGE,
                         "the volume's matrix cannot be inverted");
    *out = (snow_fader){.volume = volume,
                        .transfer = transfer,
                        .scale = fabs(volume->info.slope),
                        .threshold = threshold,
                        .isa = isa};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out->metric[i][j] = snow_dot(inverse[i], inverse[j]);
    return SNOW_OK;
}

/* The gradients of a slice between two are the means of theirs. */
static void find_gradients(const snow_fader *fader, const snow_fade_row *row,
                           const uint32_t *columns, size_t count,
                           double gradients[3][BLOCK]) {
    const snow_placement *p = row->placement;
    snow_gradient_row from = {.volume = fader->volume, .axis = p->u_axis};
    double behind[3][BLOCK];
    from.at[p->slice_axis] = row->slice;
    from.at[p->v_axis] = row->row;
    snow_gradients_of_row(&from, columns, count, BLOCK, gradients[0]);
    if (!row->between)
        return;
    from.at[p->slice_axis]++;
    snow_gradients_of_row(&from, columns, count, BLOCK, behind[0]);
    for (int axis = 0; axis < 3; axis++)
        for (size_t n = 0; n < count; n++)
            gradients[axis][n] = gradients[axis][n] / 2 + behind[axis][n] / 2;
}

void snow_fade_factors(const snow_fader *fader, const snow_fade_row *row,
                       const uint32_t *columns, size_t count, double *factors) {
    const snow_transfer *transfer = fader->transfer;
    const fade_kernels *kernels = kernels_of(fader->isa);
    double gradients[3][BLOCK], magnitudes[BLOCK];
    find_gradients(fader, row, columns, count, gradients);
    kernels->magnitudes(fader, gradients, count, magnitudes);
    if (transfer->gradient_count <= STRETCHES_MOST)
        kernels->factors(transfer->gradients, transfer->gradient_count, count,
                         magnitudes, factors);
    else
        for (size_t n = 0; n < count; n++)
            factors[n] =
                snow_transfer_gradient_opacity(transfer, magnitudes[n]);
}

void snow_fade_correct(const snow_fader *fader, double exponent, size_t count,
                       double *opacities) {
    if (exponent != 1) /* along an axis of a cubic grid it is */
        kernels_of(fader->isa)
            ->correct(snow_exponent_within(exponent), count, opacities);
}

/* --- codes ----------------------------------------------------------------
 */

/* One of native values that lie one after another. */
static double native_of(snow_type type, const void *natives, size_t n) {
    switch (type) {
#define NATIVE(name, ctype, text) \
    case SNOW_##name:             \
        return (double)((const ctype *)natives)[n];
        SNOW_TYPE_MAP(NATIVE)
#undef NATIVE
    default:
        return (double)NAN;
    }
}

/* Whether voxels that are interesting by their values still are. */
static bool is_kept(const snow_fader *fader, const void *natives,
                    uint32_t column, double factor) {
    if (!(fader->threshold > 0))
        return factor > 0;
    const snow_volume_info *info = &fader->volume->info;
    double native = native_of(info->type, natives, column);
    double opacity = snow_transfer_opacity(
        fader->transfer, info->slope * native + info->intercept);
    return snow_is_interesting((double)(float)opacity * factor,
                               fader->threshold);
}

static uint16_t code_of(double factor) {
    double least = factor < 0.5 ? factor : 1 - factor;
    uint16_t code = (uint16_t)(sqrt(least / 2) * SNOW_FADE_ONE + 0.5);
    if (!(factor < 0.5))
        return (uint16_t)(SNOW_FADE_ONE - code);
    return code ? code : 1;
}

void snow_fade_codes(const snow_fader *fader, const snow_fade_row *row,
                     const void *natives, const uint32_t *columns, size_t count,
                     uint16_t *codes) {
    for (size_t first = 0; first < count; first += BLOCK) {
        size_t some = count - first < BLOCK ? count - first : BLOCK;
        double factors[BLOCK];
        snow_fade_factors(fader, row, columns + first, some, factors);
        for (size_t n = 0; n < some; n++)
            codes[first + n] =
                is_kept(fader, natives, columns[first + n], factors[n])
                    ? code_of(factors[n])
                    : SNOW_NO_FADE;
    }
}
