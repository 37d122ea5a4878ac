/* formats/nifti/geometry.c - the position of a NIfTI volume in the world.
 *
 * nifti1.h has three methods: sform, a matrix; qform, a rotation as a
 * quaternion with spacings; or spacings alone.  The first one that is given and
 * valid is used.  World axes are RAS+, as ours. */
#include "formats/nifti/nifti.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A singular matrix would draw nothing, and its inverse is needed. */
static bool is_usable(const double m[4][4]) {
    double inverse[3][3];
    for (int i = 0; i < 12; i++)
        if (!isfinite(m[i / 4][i % 4]))
            return false;
    return snow_matrix_invert3(m, inverse);
}

/* Spacings that are not lengths become 1 with a warning: such files are common.
 * The sign has no meaning here; qfac marks mirrored axes. */
static void read_spacing(snow_context *context, const nifti_header *header,
                         const snow_volume_options *options,
                         double spacing[3]) {
    bool replaced = false;
    for (int i = 0; i < 3; i++) {
        spacing[i] = fabs(header->pixdim[i + 1]);
        if (spacing[i] > 0 && isfinite(spacing[i]))
            continue;
        spacing[i] = 1;
        replaced |= header->dim[i + 1] > 1;
    }
    if (replaced && !snow_spacing_given(options))
        snow_notify(context,
                    "spacing %g %g %g (pixdim) is not possible; 1 is used "
                    "where it is wrong",
                    header->pixdim[1], header->pixdim[2], header->pixdim[3]);
}

/* The rotation of the quaternion (a, b, c, d) with implied a >= 0: nifti1.h,
 * section "QUATERNION REPRESENTATION OF ROTATION MATRIX".  Rounding may make b,
 * c, d a little too long; then a is 0 and they are scaled to length 1. */
static void rotate_by_quaternion(const double quatern[3], double r[3][3]) {
    double b = quatern[0], c = quatern[1], d = quatern[2];
    double square = b * b + c * c + d * d, a = 0;
    if (1 - square < 1e-7) {
        double length = sqrt(square);
        b /= length;
        c /= length;
        d /= length;
    } else {
        a = sqrt(1 - square);
    }
    const double rotation[3][3] = {
        {a * a + b * b - c * c - d * d, 2 * (b * c - a * d),
         2 * (b * d + a * c)},
        {2 * (b * c + a * d), a * a + c * c - b * b - d * d,
         2 * (c * d - a * b)},
        {2 * (b * d - a * c), 2 * (c * d + a * b),
         a * a + d * d - b * b - c * c},
    };
    memcpy(r, rotation, sizeof rotation);
}

/* Millimetres of the header's unit of length; an unknown one counts as 1. */
static double millimetres(int units) {
    switch (units) {
    case 1:
        return 1000; /* metre */
    case 3:
        return 0.001; /* micron */
    default:
        return 1;
    }
}

/* nifti1.h, method 3; code 0 means that its fields are not set. */
static bool try_sform(snow_context *context, const nifti_header *header,
                      double m[4][4]) {
    if (header->sform_code <= 0)
        return false;
    memcpy(m, header->srow, sizeof header->srow);
    if (is_usable((const double(*)[4])m))
        return true;
    snow_notify(context, "its matrix (sform) is singular or not finite; %s",
                header->qform_code > 0 ? "its quaternion (qform) is used"
                                       : "only its spacing is used");
    return false;
}

/* nifti1.h, method 2, likewise. */
static bool try_qform(snow_context *context, const nifti_header *header,
                      const double spacing[3], double m[4][4]) {
    if (header->qform_code <= 0)
        return false;
    /* nifti1.h, method 2: the third column takes the sign that mirrors. */
    double r[3][3];
    rotate_by_quaternion(header->quatern, r);
    double qfac = header->pixdim[0] < 0 ? -1 : 1;
    for (int i = 0; i < 3; i++) {
        m[i][0] = r[i][0] * spacing[0];
        m[i][1] = r[i][1] * spacing[1];
        m[i][2] = r[i][2] * spacing[2] * qfac;
        m[i][3] = header->qoffset[i];
    }
    if (is_usable((const double(*)[4])m))
        return true;
    snow_notify(context, "its quaternion (qform) is not finite; only its "
                         "spacing is used");
    return false;
}

/* Spacings alone (method 1) give no orientation: left and right are unknown, so
 * the volume is not medical. */
void nifti_geometry(snow_context *context, const nifti_header *header,
                    const snow_volume_options *options,
                    snow_volume_info *info) {
    double m[4][4] = {{0}};
    bool placed = try_sform(context, header, m);
    if (!placed) {
        double spacing[3];
        read_spacing(context, header, options, spacing);
        placed = try_qform(context, header, spacing, m);
        if (!placed) {
            memset(m, 0, sizeof m);
            for (int i = 0; i < 3; i++)
                m[i][i] = spacing[i];
        }
    }
    for (int i = 0; i < 12; i++)
        info->matrix[i / 4][i % 4] =
            m[i / 4][i % 4] * millimetres(header->units) + 0.0; /* no -0 */
    info->medical = placed && !header->no_patient;
    bool unknown = header->no_patient && header->units == 0;
    snprintf(info->unit, sizeof info->unit, "%s", unknown ? "" : "mm");
}
