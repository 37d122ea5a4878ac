/* classify/gradient_opacity.c - gradient opacity: see
 * classify/gradient_opacity.h. */
#include "classify/gradient_opacity.h"
#include "base/exp_log.h"
#include "base/vec3.h"
#include "classify/classify.h"

#include <math.h>

#define BLOCK SNOW_GRADIENT_OPACITY_BLOCK

/* Up to this many points are tested one after another for all voxels of a
 * block; more are searched for each voxel. */
#define STRETCHES_MOST 16

/* The loops of one instruction set, in classify/gradient_opacity.tmpl.h. */
typedef struct gradient_opacity_kernels {
    void (*magnitudes)(const snow_gradient_opacity *gradient_opacity,
                       double gradients[3][BLOCK], size_t count, double *out);
    void (*factors)(const snow_opacity_point *points, size_t point_count,
                    size_t count, const double *magnitudes, double *factors);
    void (*correct)(double exponent, size_t count, double *opacities);
    void (*encode)(const double *factors, size_t count, uint16_t *codes);
} gradient_opacity_kernels;

#define TEMPLATE "classify/gradient_opacity.tmpl.h"
#include "simd/each_isa.h"

static const gradient_opacity_kernels *kernels_of(snow_isa isa) {
    return SNOW_OF_ISA(isa, &kernels);
}

snow_status snow_gradient_opacity_init(snow_context *context,
                                       const snow_volume *volume,
                                       const snow_transfer *transfer,
                                       double threshold, snow_isa isa,
                                       snow_gradient_opacity *out) {
    double inverse[3][3];
    if (!snow_matrix_invert3(volume->info.matrix, inverse))
        return snow_fail(
            context, SNOW_STATUS_BAD_USAGE,
            "the volume's matrix is singular: it must be invertible for "
            "gradient opacity; correct the volume's orientation and spacing");
    *out = (snow_gradient_opacity){.volume = volume,
                                   .transfer = transfer,
                                   .scale = fabs(volume->info.slope),
                                   .threshold = threshold,
                                   .isa = isa};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out->metric[i][j] = snow_dot(inverse[i], inverse[j]);
    return SNOW_STATUS_OK;
}

/* Gradients between two slices are the means of theirs. */
static void find_gradients(const snow_gradient_opacity *gradient_opacity,
                           const snow_gradient_opacity_row *row,
                           const uint32_t *columns, size_t count,
                           double gradients[3][BLOCK]) {
    const snow_placement *p = row->placement;
    snow_gradient_row from = {.volume = gradient_opacity->volume,
                              .axis = p->u_axis};
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

void snow_gradient_opacity_factors(
    const snow_gradient_opacity *gradient_opacity,
    const snow_gradient_opacity_row *row, const uint32_t *columns, size_t count,
    double *factors) {
    const snow_transfer *transfer = gradient_opacity->transfer;
    const gradient_opacity_kernels *kernels = kernels_of(gradient_opacity->isa);
    double gradients[3][BLOCK], magnitudes[BLOCK];
    find_gradients(gradient_opacity, row, columns, count, gradients);
    kernels->magnitudes(gradient_opacity, gradients, count, magnitudes);
    if (transfer->gradient_count <= STRETCHES_MOST)
        kernels->factors(transfer->gradients, transfer->gradient_count, count,
                         magnitudes, factors);
    else
        for (size_t n = 0; n < count; n++)
            factors[n] =
                snow_transfer_evaluate_gradient(transfer, magnitudes[n]);
}

void snow_gradient_opacity_correct(
    const snow_gradient_opacity *gradient_opacity, double exponent,
    size_t count, double *opacities) {
    if (exponent != 1) /* it is 1 along an axis of a cubic grid */
        kernels_of(gradient_opacity->isa)
            ->correct(snow_exponent_within(exponent), count, opacities);
}

/* --- codes ---------------------------------------------------------------- */

/* Value n of an array of native values. */
static double native_of(snow_type type, const void *natives, size_t n) {
    switch (type) {
#define NATIVE(name, ctype, text) \
    case SNOW_TYPE_##name:        \
        return (double)((const ctype *)natives)[n];
        SNOW_TYPE_MAP(NATIVE)
#undef NATIVE
    default:
        return (double)NAN;
    }
}

/* Whether a voxel with an interesting value stays interesting. */
static bool is_kept(const snow_gradient_opacity *gradient_opacity,
                    const void *natives, uint32_t column, double factor) {
    const snow_volume_info *info = &gradient_opacity->volume->info;
    double native = native_of(info->type, natives, column);
    double opacity = snow_transfer_opacity(
        gradient_opacity->transfer, info->slope * native + info->intercept);
    return snow_is_interesting((double)(float)opacity * factor,
                               gradient_opacity->threshold);
}

void snow_gradient_opacity_codes(const snow_gradient_opacity *gradient_opacity,
                                 const snow_gradient_opacity_row *row,
                                 const void *natives, const uint32_t *columns,
                                 size_t count, uint16_t *codes) {
    const gradient_opacity_kernels *kernels = kernels_of(gradient_opacity->isa);
    for (size_t first = 0; first < count; first += BLOCK) {
        size_t some = count - first < BLOCK ? count - first : BLOCK;
        double factors[BLOCK];
        snow_gradient_opacity_factors(gradient_opacity, row, columns + first,
                                      some, factors);
        kernels->encode(factors, some, codes + first);
        /* Without a threshold any opacity above 0 suffices. */
        for (size_t n = 0; n < some && gradient_opacity->threshold > 0; n++)
            if (!is_kept(gradient_opacity, natives, columns[first + n],
                         factors[n]))
                codes[first + n] = SNOW_NO_GRADIENT_OPACITY;
    }
}
