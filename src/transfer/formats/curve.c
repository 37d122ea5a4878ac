/* transfer/formats/curve.c - opacities that are interpolated with midpoint and
 * sharpness, as in the piecewise functions of VTK and ParaView.
 *
 * The midpoint is the share of the interval at which half of the rise is done.
 * The sharpness ranges from 0, two straight lines, over smooth curves to 1, a
 * step at the midpoint.  Curves are approximated by straight lines. */
#include "transfer/formats/tf.h"

#include <math.h>

#define PIECES 32

/* Below and above these sharpnesses a curve counts as lines and as a step. */
#define LINES 0.01
#define STEP 0.99

/* The share of the rise that is done at a share of the interval. */
static double risen(double part, double middle, double sharpness) {
    double s = part < middle ? 0.5 * part / middle
                             : 0.5 + 0.5 * (part - middle) / (1 - middle);
    double power = 1 + 10 * sharpness;
    if (s < 0.5)
        s = 0.5 * pow(2 * s, power);
    else if (s > 0.5)
        s = 1 - 0.5 * pow(2 * (1 - s), power);
    double square = s * s, cube = square * s;
    double rise =
        3 * square - 2 * cube + (1 - sharpness) * (2 * cube - 3 * square + s);
    return rise < 0 ? 0 : rise > 1 ? 1 : rise;
}

/* `a` and `b` are value, opacity, midpoint and sharpness; the curve uses a's.
 * The point b itself is not added. */
snow_status tf_join_opacity(const tf_input *in, snow_look_file *tf,
                            const double a[4], const double b[4]) {
    double middle = fmin(fmax(a[2], 0.00001), 0.99999);
    double sharpness = a[3], rise = b[1] - a[1];
    double at = a[0] * (1 - middle) + b[0] * middle;
    if (!(a[0] < b[0]) || (sharpness < LINES && middle == 0.5))
        return SNOW_STATUS_OK;
    if (sharpness > STEP) {
        TF_TRY(tf_add_opacity(in, tf, &tf->opacities, "opacity", at, a[1]));
        return tf_add_opacity(in, tf, &tf->opacities, "opacity", at, b[1]);
    }
    if (sharpness < LINES)
        return tf_add_opacity(in, tf, &tf->opacities, "opacity", at,
                              a[1] + rise / 2);
    for (int n = 1; n < PIECES; n++) {
        double part = (double)n / PIECES;
        TF_TRY(tf_add_opacity(in, tf, &tf->opacities, "opacity",
                              a[0] * (1 - part) + b[0] * part,
                              a[1] + rise * risen(part, middle, sharpness)));
    }
    return SNOW_STATUS_OK;
}
