/* volume/matrix.c - the linear part of the index-to-world matrix. */
#include "volume/volume.h"

#include <math.h>
#include <string.h>

/* Axes whose directions span less than this share of a box are taken for
 * lying in one plane: no scanner shears that much, while what single precision
 * leaves of a plane is smaller. */
#define FLATTEST 1e-6

/* hypot, because squares of tiny spacings vanish. */
static double column_length(const double m[4][4], int column) {
    return hypot(hypot(m[0][column], m[1][column]), m[2][column]);
}

void snow_volume_info_measure(snow_volume_info *info) {
    const snow_volume_info *known = info; /* C11 wants the const */
    for (int i = 0; i < 3; i++)
        info->spacing[i] = column_length(known->matrix, i);
}

bool snow_matrix_invert3(const double m[4][4], double inverse[3][3]) {
    /* The columns are scaled to length 1 first, so that tiny and huge spacings
     * neither vanish nor overflow in the products. */
    double u[3][3], length[3], adjugate[3][3];
    for (int j = 0; j < 3; j++) {
        length[j] = column_length(m, j);
        if (!(length[j] > 0) || !isfinite(length[j]) ||
            !isfinite(1 / length[j]))
            return false;
        for (int i = 0; i < 3; i++)
            u[i][j] = m[i][j] / length[j];
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int a = (j + 1) % 3, b = (j + 2) % 3;
            int c = (i + 1) % 3, d = (i + 2) % 3;
            adjugate[i][j] = u[a][c] * u[b][d] - u[a][d] * u[b][c];
        }
    double determinant = u[0][0] * adjugate[0][0] + u[0][1] * adjugate[1][0] +
                         u[0][2] * adjugate[2][0];
    if (!(fabs(determinant) > FLATTEST))
        return false;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            inverse[i][j] = adjugate[i][j] / determinant / length[i];
    return true;
}

bool snow_volume_is_scan(const snow_volume_info *info) {
    const bool scan =
        strcmp(info->modality, "MR") == 0 || strcmp(info->modality, "CT") == 0;
    const bool fractions =
        !*info->modality && !info->whole && info->type >= SNOW_TYPE_FLOAT32;
    return info->medical && (scan || fractions) && !info->estimate &&
           info->channels <= 1;
}

/* Slices that are fewer, and at least so many pixels apart: their cuts are
 * sharp, and what lies between them is a guess. */
#define FEW_SLICES 32
#define APART 3

static bool has_few_slices(const snow_volume_info *info, int axis) {
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    const int64_t *n = info->dims;
    const double pixel = fmax(info->spacing[a], info->spacing[b]);
    return n[axis] > 1 && n[axis] < FEW_SLICES && n[axis] < n[a] &&
           n[axis] < n[b] && info->spacing[axis] >= APART * pixel &&
           snow_volume_is_scan(info);
}

int snow_volume_thin_axis(const snow_volume_info *info) {
    double side[3];
    for (int axis = 0; axis < 3; axis++)
        side[axis] = info->dims[axis] > 1
                         ? (double)info->dims[axis] * info->spacing[axis]
                         : 0; /* a slice has no thickness to be seen */
    for (int axis = 0; axis < 3; axis++)
        if (side[axis] <
                0.25 * fmin(side[(axis + 1) % 3], side[(axis + 2) % 3]) ||
            has_few_slices(info, axis))
            return axis;
    return -1;
}

void snow_volume_stretch(snow_volume_info *info, double times) {
    double *scale = &info->axis_scale[2];
    for (int i = 0; i < 4; i++)
        info->matrix[2][i] *= times;
    *scale = (fabs(*scale) > 0 ? *scale : 1) * times;
    snow_volume_info_measure(info);
}

void snow_volume_unstretch(snow_volume_info *info) {
    for (int axis = 0; axis < 3; axis++) {
        const double scale = info->axis_scale[axis];
        for (int i = 0; i < 4 && fabs(scale) > 0; i++)
            info->matrix[axis][i] /= scale;
        info->axis_scale[axis] = 0;
    }
    snow_volume_info_measure(info);
}
