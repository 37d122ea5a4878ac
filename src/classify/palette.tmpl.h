/* classify/palette.tmpl.h - opacities of a view from their clarities, in a loop
 * that the compiler carries to vectors.  For one level of simd/select.h, which
 * is to be included before.  All levels make the same bits. */

TARGET static void NAME(correct)(const double *restrict clarities, size_t count,
                                 double exponent, float *restrict opacities) {
    for (size_t i = 0; i < count; i++)
        opacities[i] = (float)snow_opacity_of(clarities[i], exponent);
}
