/* volume/wrap.c - a volume over the caller's voxels: the part of its info that
 * counts. */
#include "volume/volume.h"

#include <string.h>

/* Of voxels without a matrix: 0s are 1. */
static snow_status take_spacing(snow_context *context, const double spacing[3],
                                snow_volume_info *own) {
    for (int axis = 0; axis < 3; axis++) {
        if (spacing[axis] != 0 && !(spacing[axis] > 0))
            return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                             "the spacing along %c is %g; it must be above 0",
                             "xyz"[axis], spacing[axis]);
        own->matrix[axis][axis] = spacing[axis] > 0 ? spacing[axis] : 1;
    }
    return SNOW_STATUS_OK;
}

/* Voxels of the caller come without a file: no source is checked against the
 * sizes, whose truth is the caller's word. */
snow_status snow_volume_wrap(snow_context *context,
                             const snow_volume_info *given, const void *voxels,
                             snow_volume **out) {
    snow_volume_info info;
    SNOW_TRY(SNOW_RECORD_READ(context, snow_volume_info, given, &info));
    if (!voxels)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "the address of the voxels is NULL");
    static const double zero[4][4];
    snow_volume_info own = snow_volume_info_default("memory");
    memcpy(own.dims, info.dims, sizeof own.dims);
    own.type = info.type;
    if (memcmp(info.matrix, zero, sizeof zero) != 0) {
        memcpy(own.matrix, info.matrix, sizeof own.matrix);
        /* Its last row may be left at zeros. */
        if (memcmp(own.matrix[3], zero[3], sizeof zero[3]) == 0)
            own.matrix[3][3] = 1;
    } else
        SNOW_TRY(take_spacing(context, info.spacing, &own));
    own.slope = info.slope == 0 ? 1 : info.slope;
    own.intercept = info.intercept;
    own.medical = info.medical;
    own.hounsfield = info.hounsfield;
    own.eight_bits = info.eight_bits;
    own.whole = info.whole;
    memcpy(own.unit, info.unit, sizeof own.unit);
    own.unit[sizeof own.unit - 1] = 0;
    memcpy(own.modality, info.modality, sizeof own.modality - 1);
    memcpy(own.quantity, info.quantity, sizeof own.quantity - 1);
    memcpy(own.value_unit, info.value_unit, sizeof own.value_unit - 1);
    memcpy(own.description, info.description, sizeof own.description - 1);
    memcpy(own.window, info.window, sizeof own.window);
    snow_status status = snow_volume_info_check(context, &own);
    if (status != SNOW_STATUS_OK)
        return SNOW_STATUS_BAD_USAGE; /* the caller's, not a file's */
    return snow_volume_over(context, &own, voxels, out);
}
