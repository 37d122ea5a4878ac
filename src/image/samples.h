/* image/samples.h - converts float pixels to integers of 8 and 16 bits: divides
 * by alpha or places them on a background, clamps, rounds.  PNG files and
 * snow_image_to_rgb8 both use it, so their results are identical. */
#ifndef SNOW_SAMPLES_H
#define SNOW_SAMPLES_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

/* Clamps to 0..1; NaN becomes 0. */
static inline double snow_clamp_unit(double x) {
    return x > 0 ? (x < 1 ? x : 1) : 0;
}

/* One NaN sample makes the whole pixel invalid: the others were computed from
 * the same input. */
static inline bool snow_has_nan(const float *pixel, int channels) {
    bool found = false;
    for (int c = 0; c < channels; c++)
        found |= isnan(pixel[c]) != 0;
    return found;
}

/* Divides a row by alpha; transparent and NaN pixels become 0 in all
 * channels. */
static inline void snow_straighten_row(const float *row, int width,
                                       int channels, double *out) {
    for (int x = 0; x < width; x++, row += channels, out += channels) {
        double alpha = snow_clamp_unit((double)row[channels - 1]);
        if (snow_has_nan(row, channels))
            alpha = 0;
        for (int c = 0; c < channels - 1; c++)
            out[c] = alpha > 0 ? snow_clamp_unit((double)row[c] / alpha) : 0;
        out[channels - 1] = alpha;
    }
}

/* Places a row on a background of `kept` channels (1 grey, 3 colour), by Porter
 * and Duff's "over" on premultiplied samples; NaN pixels show only the
 * background. */
static inline void snow_flatten_row(const float *row, int width, int channels,
                                    const double *background, int kept,
                                    double *out) {
    int step = channels == 2 ? 0 : 1; /* grey serves for all three */
    for (int x = 0; x < width; x++, row += channels, out += kept) {
        bool missing = snow_has_nan(row, channels);
        double rest =
            missing ? 1 : 1 - snow_clamp_unit((double)row[channels - 1]);
        for (int c = 0; c < kept; c++)
            out[c] = snow_clamp_unit((missing ? 0 : (double)row[c * step]) +
                                     rest * background[c]);
    }
}

/* round(255 x), halves up.  In double precision the product of a float and 255
 * is exact, so the result is always the nearest level. */
static inline void snow_quantise_8(const double *samples, size_t count,
                                   unsigned char *bytes) {
    for (size_t i = 0; i < count; i++)
        bytes[i] = (unsigned char)(int)(samples[i] * 255 + 0.5);
}

/* round(65535 x), the high byte first */
static inline void snow_quantise_16(const double *samples, size_t count,
                                    unsigned char *bytes) {
    for (size_t i = 0; i < count; i++) {
        int level = (int)(samples[i] * 65535 + 0.5);
        bytes[2 * i] = (unsigned char)(level >> 8);
        bytes[2 * i + 1] = (unsigned char)(level & 255);
    }
}

#endif
