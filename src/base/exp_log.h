/* base/exp_log.h - logarithm and exponential by plain arithmetic.
 *
 * Addition, multiplication, division and bit shifts are exact to the last bit
 * on every machine, but a C library's pow() is not; and a compiler vectorizes
 * these functions in loops. The reductions are the usual ones (Muller,
 * Elementary Functions, 2016, chapters 6 and 11); relative errors are below
 * 1e-11, far below the single precision of samples. */
#ifndef SNOW_BASE_EXP_LOG_H
#define SNOW_BASE_EXP_LOG_H

#include <stdint.h>
#include <string.h>

#define SNOW_LN2 0x1.62e42fefa39efp-1

static inline uint64_t snow_bits_of(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static inline double snow_double_of(uint64_t bits) {
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* The natural logarithm of a positive number that is not subnormal. */
static inline double snow_log(double x) {
    /* x = 2^k m with m from sqrt(1/2) to sqrt(2). The exponent is converted to
     * a double by placing it in the last bits of 2^52: older vector units have
     * no instruction for this conversion. */
    const uint64_t root = 0x3fe6a09e667f3bcdu; /* bits of sqrt(1/2) */
    uint64_t bits = snow_bits_of(x) - root + ((uint64_t)1023 << 52);
    double k =
        snow_double_of(bits >> 52 | 0x4330000000000000u) - (0x1p52 + 1023);
    double f = snow_double_of((bits & 0x000fffffffffffffu) + root) - 1;
    /* log(1 + f) = 2 artanh(s) for s = f / (2 + f), |s| < 0.1716 */
    double s = f / (2 + f), q = s * s;
    double series = 1.0 / 13;
    series = series * q + 1.0 / 11;
    series = series * q + 1.0 / 9;
    series = series * q + 1.0 / 7;
    series = series * q + 1.0 / 5;
    series = series * q + 1.0 / 3;
    return k * SNOW_LN2 + (2 * s + 2 * s * q * series);
}

/* The binary logarithm of a positive number, including subnormal ones and
 * infinity (1024). It is monotone in rounded arithmetic too: m = x / 2^k of 1
 * to 2 gives s = (m - 1) / (m + 1), written as 1 - 2 / (m + 1), and all that
 * follows are sums and products of positive, rising terms. The error is less
 * than 1e-15 plus the rounding of k. */
static inline double snow_log2_rising(double x) {
    double k = -1023, series = 1.0 / 35;
    if (x < 0x1p-1022) {
        x *= 0x1p54;
        k -= 54;
    }
    uint64_t bits = snow_bits_of(x);
    k += (double)(bits >> 52);
    double m =
        snow_double_of((bits & 0x000fffffffffffffu) | (uint64_t)1023 << 52);
    double s = 1 - 2 / (m + 1), q = s * s;
    for (int odd = 33; odd > 0; odd -= 2)
        series = series * q + 1.0 / odd;
    double part = s * series * (2 / SNOW_LN2);
    return k + (part < 1 ? part : 1);
}

/* exp(x) - 1 for x <= 0, with a small relative error near 0 too. Values below
 * -700 count as -700. */
static inline double snow_exp_less_1(double x) {
    /* x = k ln 2 + r, |r| <= ln 2 / 2; adding 1.5 * 2^52 rounds to an integer,
     * in the last bits of the sum. */
    x = x > -700 ? x : -700;
    double shifted = x * (1 / SNOW_LN2) + 0x1.8p52;
    double r = x - (shifted - 0x1.8p52) * SNOW_LN2;
    double power = snow_double_of((snow_bits_of(shifted) + 1023) << 52);
    double series = 1.0 / 39916800;
    series = series * r + 1.0 / 3628800;
    series = series * r + 1.0 / 362880;
    series = series * r + 1.0 / 40320;
    series = series * r + 1.0 / 5040;
    series = series * r + 1.0 / 720;
    series = series * r + 1.0 / 120;
    series = series * r + 1.0 / 24;
    series = series * r + 1.0 / 6;
    series = series * r + 1.0 / 2;
    double less_1 = r + r * r * series;
    return power * less_1 + (power - 1);
}

/* x^exponent for x of 0 to 1 and an exponent of at least 0; subnormal x count
 * as 0, and 0^0 is 1 as with pow(). */
static inline double snow_pow(double x, double exponent) {
    double some = x >= 0x1p-1022 ? x : 1;
    double power = snow_exp_less_1(exponent * snow_log(some)) + 1;
    return x >= 0x1p-1022 || exponent == 0 ? power : 0;
}

/* 2^x, with a relative error of 1e-11; out of range it is the nearest normal
 * number. */
static inline double snow_exp2(double x) {
    x = x > -1022 ? x : -1022;
    x = x < 1023 ? x : 1023;
    double above = (double)(int)x + (x > (double)(int)x); /* x rounded up */
    double part = snow_exp_less_1((x - above) * SNOW_LN2) + 1;
    return part * snow_double_of((uint64_t)(int64_t)(above + 1023) << 52);
}

/* --- opacities of other lengths (model, section 6) ------------------------
 *
 * a' = 1 - (1 - a)^e = -(exp(e log(1 - a)) - 1): the logarithm belongs to the
 * voxel, the exponent to the view.  0 stays 0 and 1 stays 1, exactly. */

/* log(1 - opacity); for opacity 1 a number low enough for any e. */
static inline double snow_clarity(double opacity) {
    double clear = 1 - opacity;
    return clear > 0 ? snow_log(clear > 0 ? clear : 1) : -1e100;
}

/* Clamps an exponent to the range that keeps 1 at 1 and 0 at 0. */
static inline double snow_exponent_within(double exponent) {
    exponent = exponent > 1e-50 ? exponent : 1e-50;
    return exponent < 1e50 ? exponent : 1e50;
}

/* The opacity of a clarity; `exponent` is within the range above. */
static inline double snow_opacity_of(double clarity, double exponent) {
    return -snow_exp_less_1(clarity * exponent);
}

#endif
