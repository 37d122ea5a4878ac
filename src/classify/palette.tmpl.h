/* classify/palette.tmpl.h - clarities of opacities, and opacities of a view
 * from clarities, in loops that the compiler vectorizes, for one instruction
 * set. Include simd/select.h first. All instruction sets give the same bits. */

TARGET static void NAME(clear)(const double *restrict opacities, size_t count,
                               double *restrict clarities) {
    for (size_t i = 0; i < count; i++)
        clarities[i] = snow_clarity(opacities[i]);
}

TARGET static void NAME(correct)(const double *restrict clarities, size_t count,
                                 double exponent, float *restrict opacities) {
    for (size_t i = 0; i < count; i++)
        opacities[i] = (float)snow_opacity_of(clarities[i], exponent);
}

static const palette_kernels NAME(kernels) = {NAME(clear), NAME(correct)};
