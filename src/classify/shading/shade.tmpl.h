/* classify/shading/shade.tmpl.h - Phong's model for a block of gradients, in
 * loops that the compiler vectorizes, for one instruction set. Include
 * simd/select.h first. No sum is fused or reordered, so all instruction sets
 * give the same bits.
 *
 * NAME(shade_block) shades at most SHADE_BLOCK samples. */

/* Cosines of normals, turned to the viewer, with the light and the half-way
 * vector; 0 if negative, or if there is no gradient. */
TARGET static void NAME(cosines)(const snow_shader *s,
                                 const double g[3][SHADE_BLOCK], int count,
                                 double *lambert, double *highlight) {
    const double(*m)[3] = s->metric;
    const double *v = s->viewer, *l = s->light, *h = s->half;
    for (int i = 0; i < count; i++) {
        double x = g[0][i], y = g[1][i], z = g[2][i];
        /* Only the direction counts; the square of a tiny or huge difference
         * could vanish or overflow. */
        double most = fabs(x);
        most = fabs(y) > most ? fabs(y) : most;
        most = fabs(z) > most ? fabs(z) : most;
        double inverse = most < 0x1p300 ? 1 : 1 / most;
        inverse = most > 0x1p-300 ? inverse : 1 / most;
        x *= inverse, y *= inverse, z *= inverse;
        double square = (m[0][0] * x + m[0][1] * y + m[0][2] * z) * x +
                        (m[1][0] * x + m[1][1] * y + m[1][2] * z) * y +
                        (m[2][0] * x + m[2][1] * y + m[2][2] * z) * z;
        double scale = 1 / sqrt(square);
        scale = v[0] * x + v[1] * y + v[2] * z < 0 ? -scale : scale;
        double lit = scale * (l[0] * x + l[1] * y + l[2] * z);
        double glint = scale * (h[0] * x + h[1] * y + h[2] * z);
        lit = square > 0 ? lit : 0;
        lit = square < INFINITY ? lit : 0;
        lambert[i] = lit > 0 ? lit : 0;
        glint = lit > 0 ? glint : 0;
        highlight[i] = glint > 0 ? glint : 0;
    }
}

/* x^shininess in place; whole exponents (the default is one) by squaring. */
TARGET static void NAME(to_power)(const snow_shader *s, int count, double *x) {
    double power[SHADE_BLOCK], base[SHADE_BLOCK];
    for (int i = 0; i < count; i++) {
        base[i] = x[i];
        power[i] = s->whole < 0 ? snow_pow(x[i], s->shininess) : 1;
    }
    for (unsigned n = s->whole < 0 ? 0 : (unsigned)s->whole; n; n /= 2) {
        if (n % 2)
            for (int i = 0; i < count; i++)
                power[i] *= base[i];
        for (int i = 0; i < count; i++)
            base[i] *= base[i];
    }
    /* x^0 is 1 even for a highlight of 0, which must stay black. */
    for (int i = 0; i < count; i++)
        x[i] = x[i] > 0 ? power[i] : 0;
}

TARGET static void NAME(shade_block)(const snow_shader *s,
                                     const double g[3][SHADE_BLOCK], int count,
                                     int channels, float *samples) {
    double lambert[SHADE_BLOCK], highlight[SHADE_BLOCK];
    int whole = (count + 7) & -8; /* whole vectors; SHADE_BLOCK at most */
    NAME(cosines)(s, g, whole, lambert, highlight);
    if (s->specular > 0)
        NAME(to_power)(s, whole, highlight);
    if (channels == 2)
        for (int i = 0; i < count; i++) {
            float *c = samples + 2 * i;
            c[0] = shaded(c[0], s->ambient + s->diffuse * lambert[i],
                          s->specular * highlight[i]) *
                   c[1];
        }
    else
        for (int i = 0; i < count; i++) {
            float *c = samples + 4 * i;
            double factor = s->ambient + s->diffuse * lambert[i];
            double white = s->specular * highlight[i];
            for (int n = 0; n < 3; n++)
                c[n] = shaded(c[n], factor, white) * c[3];
        }
}
