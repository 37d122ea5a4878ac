/* classify/opacity_power.tmpl.h - opacities of another length at splat time, in
 * a loop that the compiler vectorizes, for one instruction set.  Include
 * simd/select.h first. No sum is fused or reordered, so all instruction sets
 * give the same bits.
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
