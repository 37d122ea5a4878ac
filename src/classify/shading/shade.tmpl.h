/* classify/shading/shade.tmpl.h - Phong's model for a block of gradients, in
 * loops that the compiler vectorizes, for one instruction set. Include
 * simd/select.h first. No sum is fused or reordered, so all instruction sets
 * give the same bits.
 *
 * NAME(shade_block) shades at most SHADE_BLOCK samples. */

/* Normals of unit length, turned to the viewer, in index space; 0 where there
 * is no gradient. */
TARGET static void NAME(normals)(const snow_shader *s,
                                 const double g[3][SHADE_BLOCK], int count,
                                 double normal[3][SHADE_BLOCK]) {
    const double(*m)[3] = s->metric;
    const double *v = s->viewer;
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
        bool known = square > 0 && square < INFINITY;
        normal[0][i] = known ? scale * x : 0;
        normal[1][i] = known ? scale * y : 0;
        normal[2][i] = known ? scale * z : 0;
    }
}

/* Cosines of normals with a light and its half-way vector; 0 if negative. */
TARGET static void NAME(cosines)(const double l[3], const double h[3],
                                 const double normal[3][SHADE_BLOCK], int count,
                                 double *lambert, double *highlight) {
    for (int i = 0; i < count; i++) {
        double x = normal[0][i], y = normal[1][i], z = normal[2][i];
        double lit = l[0] * x + l[1] * y + l[2] * z;
        double glint = h[0] * x + h[1] * y + h[2] * z;
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

/* What all lights give: factors of the colour, and white. */
TARGET static void NAME(light_block)(const snow_shader *s,
                                     const double g[3][SHADE_BLOCK], int count,
                                     double *factor, double *white) {
    double normal[3][SHADE_BLOCK], lambert[SHADE_BLOCK], highlight[SHADE_BLOCK];
    NAME(normals)(s, g, count, normal);
    for (int i = 0; i < count; i++) {
        factor[i] = s->ambient;
        white[i] = 0;
    }
    for (int n = 0; n < s->lights.count; n++) {
        const double diffuse = s->diffuse * s->lights.share[n];
        const double specular = s->specular * s->lights.share[n];
        NAME(cosines)(s->to[n], s->half[n],
                      (const double(*)[SHADE_BLOCK])normal, count, lambert,
                      highlight);
        if (specular > 0)
            NAME(to_power)(s, count, highlight);
        for (int i = 0; i < count; i++) {
            factor[i] += diffuse * lambert[i];
            white[i] += specular * highlight[i];
        }
    }
}

TARGET static void NAME(shade_block)(const snow_shader *s,
                                     const double g[3][SHADE_BLOCK],
                                     const float *flat, int count, int channels,
                                     float *samples) {
    double factor[SHADE_BLOCK], white[SHADE_BLOCK];
    int whole = (count + 7) & -8; /* whole vectors; SHADE_BLOCK at most */
    NAME(light_block)(s, g, whole, factor, white);
    for (int i = 0; flat && i < count; i++) {
        factor[i] += (double)flat[i] * (1 - factor[i]);
        white[i] *= 1 - (double)flat[i];
    }
    if (channels == 2)
        for (int i = 0; i < count; i++) {
            float *c = samples + 2 * i;
            c[0] = shaded(c[0], factor[i], white[i]) * c[1];
        }
    else
        for (int i = 0; i < count; i++) {
            float *c = samples + 4 * i;
            for (int n = 0; n < 3; n++)
                c[n] = shaded(c[n], factor[i], white[i]) * c[3];
        }
}
