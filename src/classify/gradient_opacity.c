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

void snow_gradient_opacity_factors(
    const snow_gradient_opacity *gradient_opacity,
    const snow_gradient_opacity_row *row, const uint32_t *columns, size_t count,
    double *factors) {
    const snow_transfer *transfer = gradient_opacity->transfer;
    const gradient_opacity_kernels *kernels = kernels_of(gradient_opacity->isa);
    double gradients[3][BLOCK], magnitudes[BLOCK];
    const snow_placement *p = row->placement;
    snow_gradient_row from = {.volume = gradient_opacity->volume,
                              .axis = p->u_axis};
    from.at[p->slice_axis] = row->slice;
    from.at[p->v_axis] = row->row;
    snow_gradients_of_row(&from, columns, count, BLOCK, gradients[0]);
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
