/* splat/shear_warp/ray.tmpl.h - in perspective each sample has its own way to
 * the eye.  Include simd/select.h first. */

/* Opacities of another length, in a loop that the compiler vectorizes.  No sum
 * is fused or reordered, so all instruction sets give the same bits.
 *
 * NAME(power16) takes 16 opacities a and exponents e. It replaces each a by
 *
 *   1 - (1 - a)^e = 1 - 2^(e log2(1 - a))
 *
 * The error is less than 4e-7, and less than 1e-6 relative to the result. The
 * logarithm is that of base/exp_log.h in single precision. 1 - a is rounded to
 * u; the rounding error is added again as (1 - u - a) log2(e), for u near 1,
 * where it counts. */
static inline TARGET void NAME(power16)(const float *restrict exponents,
                                        float *restrict opacities) {
    const float log2_e = 1.44269504F;
    for (int i = 0; i < 16; i++) {
        const uint32_t root = 0x3f3504f3; /* bits of sqrt(1/2) */
        float p = opacities[i];
        float u = 1 - p;
        float lost = p < 0.5F ? (1 - u) - p : 0;
        uint32_t bits;
        memcpy(&bits, &u, sizeof bits);
        bits = bits - root + (127U << 23);
        float k = (float)((int32_t)(bits >> 23) - 127), m;
        bits = (bits & 0x7fffff) + root;
        memcpy(&m, &bits, sizeof m);
        /* log(m) = 2 artanh(s) for s = f / (2 + f), |s| < 0.1716 */
        float f = m - 1, s = f / (2 + f), q = s * s;
        float series = ((q * (1.0F / 9) + 1.0F / 7) * q + 1.0F / 5) * q;
        series = (series + 1.0F / 3) * q;
        float log2_u = k + 2 * log2_e * (s + s * series);
        float power = exponents[i] * (log2_u + log2_e * lost);
        power = u > 0 ? power : -126; /* opaque, whatever the exponent */
        power = power > -126 ? power : -126;
        /* 2^power as 2^n 2^r with |r| <= 1/2; 2^r - 1 by its series. */
        float shifted = power + 0x1.8p23F, r = power - (shifted - 0x1.8p23F);
        memcpy(&bits, &shifted, sizeof bits);
        bits = (bits + 127) << 23;
        float scale;
        memcpy(&scale, &bits, sizeof scale);
        float less = 0.000154035303934F;
        less = less * r + 0.00133335581464F;
        less = less * r + 0.00961812910763F;
        less = less * r + 0.0555041086648F;
        less = less * r + 0.240226506959F;
        less = less * r + 0.693147180560F;
        opacities[i] = (1 - scale) - scale * r * less;
    }
}

/* a . (uu vv 11 uv u1 v1) of LANES ways (u, v, 1). */
TARGET VALUE_INLINE V(vec) NAME(square_of)(const float a[6], V(vec) u,
                                           V(vec) v) {
    V(vec) sum = V(add)(V(mul)(V(set1)(a[0]), V(mul)(u, u)), V(set1)(a[2]));
    sum = V(add)(sum, V(mul)(V(set1)(a[1]), V(mul)(v, v)));
    sum = V(add)(sum, V(mul)(V(set1)(a[3]), V(mul)(u, v)));
    sum = V(add)(sum, V(mul)(V(set1)(a[4]), u));
    return V(add)(sum, V(mul)(V(set1)(a[5]), v));
}

/* Ways of LANES samples along u (`axis` 0) or v. */
TARGET VALUE_INLINE V(vec) NAME(ways_of)(const float slope[2], V(vec) phases) {
    return V(add)(V(set1)(slope[0]), V(mul)(V(set1)(slope[1]), phases));
}

/* n . eye, light and half for LANES gradients, times their length. */
TARGET VALUE_INLINE void NAME(face_eye)(const snow_value_light *l,
                                        const snow_value_rays *rays,
                                        V(vec) across, V(vec) down, V(vec) u,
                                        V(vec) v, V(vec) p, V(vec) out[3]) {
    V(vec) inverse = V(row_rsqrt)(NAME(square_of)(rays->metric, across, down));
    V(vec) eye = V(add)(V(add)(V(mul)(across, u), V(mul)(down, v)), p);
    eye = V(mul)(V(mul)(eye, V(set1)(rays->toward)), inverse);
    out[0] = eye;
    if (!l->distant)
        return;
    V(vec) aside =
        V(mul)(NAME(dot)(rays->aside, across, down, V(set1)(1)), inverse);
    /* |l + e|^2 = 2 + 2 l . e */
    V(vec) way =
        V(max)(V(add)(V(add)(aside, aside), V(set1)(2)), V(set1)(1e-9F));
    out[1] = NAME(dot)(l->light, u, v, p);
    out[2] = V(mul)(V(add)(out[1], eye), V(row_rsqrt)(way));
}

/* How much longer than the table's the parts of slabs are that 32 samples are
 * of. */
TARGET VALUE_INLINE void NAME(shares)(const snow_value_rays *rays,
                                      float slope[2][2], const value_queue *q,
                                      int n, bool cuts, float out[32]) {
    for (int at = 0; at < 32; at += LANES) {
        V(vec) way = V(sqrt)(NAME(square_of)(
            rays->metric,
            NAME(ways_of)(slope[0], V(row_floats)(q->ray[0] + n + at)),
            NAME(ways_of)(slope[1], V(row_floats)(q->ray[1] + n + at))));
        V(store)(out + at, V(mul)(way, V(set1)(rays->usual)));
    }
    for (int i = 0; cuts && i < 32; i++)
        out[i] *= q->part[n + i] == INT16_MAX
                      ? 1
                      : (float)q->part[n + i] * (1.0F / 32768);
}

/* Alpha and colours of 32 samples, for so much longer a way. */
TARGET VALUE_INLINE void NAME(lengthen)(const snow_value_table *table,
                                        const float shares[32],
                                        const int channels, V(row) color[4]) {
    float alphas[32], factors[32];
    int16_t words[32];
    V(row_store)(words, color[3]);
    for (int i = 0; i < 32; i++)
        alphas[i] = (float)words[i] * table->unit;
    NAME(power16)(shares, alphas);
    NAME(power16)(shares + 16, alphas + 16);
    for (int i = 0; i < 32; i++) {
        float alpha = (float)words[i], longer = alphas[i] / table->unit;
        longer = longer < 32767 ? longer : 32767;
        factors[i] = longer / (alpha > 1 ? alpha : 1);
    }
    for (int c = channels == 2 ? 2 : 0; c < 4; c++) {
        int plane = channels == 2 && c == 2 ? 0 : c;
        V(row_store)(words, color[plane]);
        for (int i = 0; i < 32; i++)
            words[i] = (int16_t)((float)words[i] * factors[i] + 0.5F);
        color[plane] = V(row_load)(words);
    }
}
