/* image/compare.c - measures how far two pictures differ.
 *
 * Absolute differences and the peak signal-to-noise ratio use all four
 * premultiplied channels, but not alpha if a file omits it.  Structural
 * similarity follows Wang, Bovik, Sheikh and Simoncelli, "Image quality
 * assessment: from error visibility to structural similarity" (2004), equation
 * 13, over every 8 x 8 window (smaller if the picture is) of the luma over
 * black, with equal weights, K1 = 0.01, K2 = 0.03 and L = 1.
 *
 * Samples that are not finite: equal ones (NaN and NaN, or the same infinity)
 * do not differ.  Others differ infinitely, and a window with such a pixel has
 * no similarity. */
#include "image/image.h"

#include <math.h>

#define WINDOW 8

/* The sums of differences, in row order. */
typedef struct difference_sums {
    int channels; /* number of channels compared */
    double largest, absolute, squared;
    int x, y;
} difference_sums;

static bool are_equal(double a, double b) {
    return a == b || (isnan(a) && isnan(b));
}

/* The level of a sample of 8 or 16 bits, whose float is rounded: a multiple of
 * 1/65535, as those of 1/255 are; NaN for other samples. */
static double level_of(float sample) {
    double level = rint((double)sample * 65535);
    return (float)(level / 65535) == sample ? level : (double)NAN;
}

/* Pictures that are one level apart differ by 1/255 or 1/65535, not by the
 * difference of two rounded floats.  In double precision the difference of two
 * floats cannot overflow. */
static double absolute_difference(float a, float b) {
    if (are_equal(a, b))
        return 0;
    double levels = fabs(level_of(a) - level_of(b));
    if (isfinite(levels))
        return levels / 65535;
    return isfinite(a) && isfinite(b) ? fabs((double)a - (double)b) : INFINITY;
}

/* Adds row y.  Each row is summed on its own first, which keeps the rounding
 * errors of large pictures small. */
static void add_row(const snow_image *a, const snow_image *b, int y,
                    difference_sums *sums) {
    size_t first = (size_t)y * (size_t)a->width;
    double absolute = 0, squared = 0;
    for (int x = 0; x < a->width; x++) {
        float p[4], q[4];
        snow_image_rgba(a, first + (size_t)x, p);
        snow_image_rgba(b, first + (size_t)x, q);
        for (int c = 0; c < sums->channels; c++) {
            double difference = absolute_difference(p[c], q[c]);
            absolute += difference;
            squared += difference * difference;
            if (difference > sums->largest) {
                sums->largest = difference;
                sums->x = x;
                sums->y = y;
            }
        }
    }
    sums->absolute += absolute;
    sums->squared += squared;
}

/* The luma (Rec. 709 weights) of premultiplied samples is that over black. */
static double luma_of(const snow_image *image, size_t index) {
    float p[4];
    snow_image_rgba(image, index, p);
    return 0.2126 * (double)p[0] + 0.7152 * (double)p[1] +
           0.0722 * (double)p[2];
}

/* Sums over a window, or over one of its columns. */
typedef struct moments {
    double a, b, aa, bb, ab;
} moments;

static void add_moments(moments *sum, const moments *part) {
    sum->a += part->a;
    sum->b += part->b;
    sum->aa += part->aa;
    sum->bb += part->bb;
    sum->ab += part->ab;
}

/* Column sums over `rows` stored rows.  They are computed anew for each row of
 * windows: differences of running sums would keep the rounding errors of a
 * bright spot long after it has left the window. */
static void sum_columns(const double *lumas_a, const double *lumas_b, int width,
                        int rows, moments *columns) {
    for (int x = 0; x < width; x++)
        columns[x] = (moments){0};
    for (int y = 0; y < rows; y++) {
        const double *a = lumas_a + (size_t)y * (size_t)width;
        const double *b = lumas_b + (size_t)y * (size_t)width;
        for (int x = 0; x < width; x++)
            add_moments(&columns[x], &(moments){a[x], b[x], a[x] * a[x],
                                                b[x] * b[x], a[x] * b[x]});
    }
}

/* Similarity of one window of n pixels, -1 to 1. */
static double window_similarity(const moments *sum, double n) {
    const double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
    double mean_a = sum->a / n, mean_b = sum->b / n;
    double variance_a = sum->aa / n - mean_a * mean_a;
    double variance_b = sum->bb / n - mean_b * mean_b;
    double covariance = sum->ab / n - mean_a * mean_b;
    /* Rounding errors, which are large for large values, must not break two
     * facts: variances are not negative, and the inequality of Cauchy and
     * Schwarz. */
    variance_a = variance_a < 0 ? 0 : variance_a;
    variance_b = variance_b < 0 ? 0 : variance_b;
    double most = sqrt(variance_a * variance_b);
    covariance = covariance > most    ? most
                 : covariance < -most ? -most
                                      : covariance;
    double likeness = (2 * mean_a * mean_b + c1) * (2 * covariance + c2);
    double spread = (mean_a * mean_a + mean_b * mean_b + c1) *
                    (variance_a + variance_b + c2);
    double score = likeness / spread;
    if (isnan(score))
        return 0;
    return score > 1 ? 1 : score < -1 ? -1 : score;
}

/* Adds the similarities of a row of windows, each `side` columns wide and with
 * that many pixels in all. */
static double add_windows(const moments *columns, int width, int side,
                          double pixels) {
    double total = 0;
    for (int x = 0; x + side <= width; x++) {
        moments sum = {0};
        for (int i = 0; i < side; i++)
            add_moments(&sum, &columns[x + i]);
        total += window_similarity(&sum, pixels);
    }
    return total;
}

/* Mean similarity over all windows.  Only the rows under the windows are kept;
 * row y is stored at y modulo the window's height. */
static snow_status measure_similarity(const snow_image *a, const snow_image *b,
                                      double *out) {
    int width = a->width;
    int wide = width < WINDOW ? width : WINDOW;
    int high = a->height < WINDOW ? a->height : WINDOW;
    size_t stored = (size_t)width * (size_t)high;
    double *lumas = snow_allocate_array(a->context, 2 * stored, sizeof *lumas);
    moments *columns =
        snow_allocate_array(a->context, (uint64_t)width, sizeof *columns);
    double total = 0;
    for (int y = 0; lumas && columns && y < a->height; y++) {
        double *row = lumas + (size_t)(y % high) * (size_t)width;
        /* The lumas of row y.  Equal ones that are not finite become 0 in both;
         * unequal ones become NaN, which spreads to the sums of a window. */
        size_t first = (size_t)y * (size_t)a->width;
        for (int x = 0; x < a->width; x++) {
            double p = luma_of(a, first + (size_t)x);
            double q = luma_of(b, first + (size_t)x);
            if (!isfinite(p) || !isfinite(q))
                p = q = are_equal(p, q) ? 0 : NAN;
            row[x] = p;
            (row + stored)[x] = q;
        }
        if (y + 1 < high)
            continue;
        sum_columns(lumas, lumas + stored, width, high, columns);
        total += add_windows(columns, width, wide, (double)wide * high);
    }
    bool done = lumas && columns;
    snow_release(a->context, columns);
    snow_release(a->context, lumas);
    if (!done)
        return SNOW_STATUS_NO_MEMORY;
    *out = total / ((double)(width - wide + 1) * (a->height - high + 1));
    return SNOW_STATUS_OK;
}

snow_status snow_image_compare(const snow_image *a, const snow_image *b,
                               snow_image_difference *out) {
    if (a->width != b->width || a->height != b->height)
        return snow_fail(a->context, SNOW_STATUS_DIFFERENT,
                         "the pictures have %d x %d and %d x %d pixels; "
                         "compare pictures of one size",
                         a->width, a->height, b->width, b->height);
    double ssim = 0;
    SNOW_TRY(measure_similarity(a, b, &ssim));
    difference_sums sums = {.channels =
                                a->alpha_unknown || b->alpha_unknown ? 3 : 4};
    for (int y = 0; y < a->height; y++)
        add_row(a, b, y, &sums);
    double samples = (double)sums.channels * a->width * a->height;
    const snow_image_difference difference = {
        .largest = sums.largest,
        .mean = sums.absolute / samples,
        .psnr = 10 * log10(samples / sums.squared),
        .ssim = ssim,
        .x = sums.x,
        .y = sums.y,
    };
    return SNOW_RECORD_FILL(a->context, snow_image_difference, &difference,
                            out);
}
