/* classify/shading/gloss.tmpl.h - the shading table's row loops, which the
 * compiler vectorizes, for one instruction set. Include simd/select.h first. No
 * sum is fused or reordered, so all instruction sets give the same bits.
 *
 * NAME(gloss_row) writes the entries of one row of the square of normals. */

/* x^whole in place, by squaring. */
TARGET static void NAME(power_whole)(float *x, int whole) {
    float power[SIDE];
    for (int i = 0; i < SIDE; i++)
        power[i] = 1;
    for (unsigned n = (unsigned)whole; n; n /= 2) {
        if (n % 2)
            for (int i = 0; i < SIDE; i++)
                power[i] *= x[i];
        for (int i = 0; i < SIDE; i++)
            x[i] *= x[i];
    }
    for (int i = 0; i < SIDE; i++)
        x[i] = power[i];
}

TARGET static void NAME(power_real)(float *x, double exponent) {
    for (int i = 0; i < SIDE; i++)
        x[i] = (float)snow_pow((double)x[i], exponent);
}

/* The cosines of one row of normals, turned to the viewer, with the light and
 * the half-way vector; negative ones become 0. */
TARGET static void NAME(cosines)(const gloss_job *job, int row, float *lambert,
                                 float *highlight) {
    const float *l = job->light, *h = job->half, *e = job->viewer;
    float down = (float)(row - MIDDLE) / MIDDLE;
    for (int i = 0; i < SIDE; i++) {
        float across = (float)(i - MIDDLE) / MIDDLE;
        float x = (across + down) / 2, y = (across - down) / 2;
        float z = 1 - fabsf(x) - fabsf(y);
        float scale = 1 / sqrtf(x * x + y * y + z * z);
        float facing = x * e[0] + y * e[1] + z * e[2];
        scale = facing < 0 ? -scale : scale;
        float lit = (x * l[0] + y * l[1] + z * l[2]) * scale;
        float glint = (x * h[0] + y * h[1] + z * h[2]) * scale;
        lambert[i] = lit > 0 ? lit : 0;
        highlight[i] = lit > 0 && glint > 0 ? glint : 0;
    }
}

TARGET static void NAME(gloss_row)(const gloss_job *job, int row) {
    float lambert[SIDE], white[SIDE];
    snow_gloss *out = job->table + 1 + row * SIDE;
    NAME(cosines)(job, row, lambert, white);
    if (job->whole >= 0)
        NAME(power_whole)(white, job->whole);
    else
        NAME(power_real)(white, job->shininess);
    /* x^0 is 1 even for a highlight of 0, which must stay black. */
    const float ambient = job->ambient, diffuse = job->diffuse;
    const float specular = job->specular;
    for (int i = 0; i < SIDE; i++)
        white[i] = lambert[i] > 0 ? specular * white[i] : 0;
    for (int i = 0; i < SIDE; i++)
        out[i] = gloss_of(ambient + diffuse * lambert[i], white[i]);
}
