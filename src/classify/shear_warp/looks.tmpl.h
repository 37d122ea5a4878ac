/* classify/shear_warp/looks.tmpl.h - loops over ALPHAS numbers, of which a
 * compiler makes vectors of an instruction set.  Include simd/select.h first.
 * No sum is fused, so all have the same bits. */

/* Opacities of the reference length to logarithms of what shines through. */
TARGET static void NAME(logs_of)(double x[ALPHAS]) {
    for (size_t n = 0; n < ALPHAS; n++) {
        const double clear = x[n] < 1 ? 1 - x[n] : 1;
        x[n] = x[n] < 1 ? snow_log(clear) : -INFINITY;
    }
}

/* These to alphas of so many reference lengths. */
TARGET static void NAME(alphas_of)(double exponent, double x[ALPHAS]) {
    for (size_t n = 0; n < ALPHAS; n++)
        x[n] = -snow_exp_less_1(exponent * x[n]);
}
