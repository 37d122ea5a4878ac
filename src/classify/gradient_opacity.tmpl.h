/* classify/gradient_opacity.tmpl.h - gradients to factors, in loops that the
 * compiler vectorizes, for one instruction set. Include simd/select.h first. No
 * sum is fused or reordered, so all instruction sets give the same bits.
 *
 * NAME(magnitudes) takes differences of native values along x, y and z.
 * NAME(factors) looks magnitudes up in the curve, as
 * snow_transfer_evaluate_gradient does. NAME(correct) corrects opacities for
 * another length. */

TARGET static void NAME(magnitudes)(const snow_gradient_opacity *f,
                                    double g[3][SNOW_GRADIENT_OPACITY_BLOCK],
                                    size_t count, double *restrict out) {
    const double(*m)[3] = f->metric;
    const double slope = f->scale;
    for (size_t i = 0; i < count; i++) {
        double x = g[0][i], y = g[1][i], z = g[2][i];
        /* Scale first: the square of a tiny or huge difference could vanish or
         * overflow. */
        double most = fabs(x);
        most = fabs(y) > most ? fabs(y) : most;
        most = fabs(z) > most ? fabs(z) : most;
        double scale = most < 0x1p300 ? 1 : 0x1p-600;
        double back = most < 0x1p300 ? 1 : 0x1p600;
        scale = most > 0x1p-300 ? scale : 0x1p600;
        back = most > 0x1p-300 ? back : 0x1p-600;
        x *= scale, y *= scale, z *= scale;
        double square = (m[0][0] * x + m[0][1] * y + m[0][2] * z) * x +
                        (m[1][0] * x + m[1][1] * y + m[1][2] * z) * y +
                        (m[2][0] * x + m[2][1] * y + m[2][2] * z) * z;
        square = square > 0 ? square : square * 0; /* rounding; NaN stays */
        out[i] = sqrt(square) * back * slope;
    }
}

/* One stretch after another; a later one overwrites the result of an earlier
 * one. NaN is not below any point, so it ends beyond the last. */
TARGET static void NAME(factors)(const snow_opacity_point *points,
                                 size_t point_count, size_t count,
                                 const double *restrict magnitudes,
                                 double *restrict factors) {
    for (size_t i = 0; i < count; i++)
        factors[i] = points[0].opacity;
    for (size_t n = 0; n + 1 < point_count; n++) {
        double a = points[n].value, b = points[n + 1].value;
        double low = points[n].opacity, high = points[n + 1].opacity;
        double half = isfinite(b - a) ? 1 : 0.5;
        double from = a * half, way = b * half - a * half;
        for (size_t i = 0; i < count; i++) {
            double part = (magnitudes[i] * half - from) / way;
            double factor = low + (high - low) * part;
            factors[i] = magnitudes[i] < a ? factors[i] : factor;
        }
    }
    double end = points[point_count - 1].value;
    double last = points[point_count - 1].opacity;
    for (size_t i = 0; i < count; i++)
        factors[i] = magnitudes[i] < end ? factors[i] : last;
}

TARGET static void NAME(correct)(double exponent, size_t count,
                                 double *restrict opacities) {
    for (size_t i = 0; i < count; i++)
        opacities[i] = snow_opacity_of(snow_clarity(opacities[i]), exponent);
}

static const gradient_opacity_kernels NAME(kernels) = {
    NAME(magnitudes), NAME(factors), NAME(correct)};
