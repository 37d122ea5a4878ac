/* render/shear_warp/operators.c - the modes: a record for each.  Over makes
 * colours; projections make quantized values, which are coloured after the warp
 * (render/modes/modes.c). */
#include "render/shear_warp/internal.h"

#include <math.h>

/* --- over ----------------------------------------------------------------- */

/* Words of some planes to pixels, for a constant number of channels. */
static inline void read_words(const snow_value_plane *words, int row,
                              const int channels, float *out) {
    for (int n = 0; n < SNOW_VALUE_COLUMNS; n++)
        for (int c = 0; c < channels; c++)
            out[n * channels + c] =
                (float)(*words)[channels == 4 ? c : 3 * c][row][n + 1] *
                (1.0F / 32767);
}

static void read_over(const snow_value_splat *splat, const void *planes,
                      int phase, int row, float *out) {
    const int channels = splat->channels, step = channels == 4 ? 1 : 3;
    const snow_value_plane *words = (const snow_value_plane *)planes + phase;
    const snow_value_faint_plane *floats =
        (const snow_value_faint_plane *)planes + phase;
    if (!splat->floats && channels == 4)
        read_words(words, row, 4, out);
    else if (!splat->floats)
        read_words(words, row, 2, out);
    for (int c = 0; splat->floats && c < 4; c += step, out++)
        for (int n = 0; n < SNOW_VALUE_COLUMNS; n++)
            out[n * channels] = (*floats)[c][row][n + 1];
}

/* --- extremes ------------------------------------------------------------- */

/* The number that adds nothing to an image, which begins with it.  Beside holes
 * no number says that a ray is there. */
static void hide_idle(snow_value_path *path, const snow_value_look *look,
                      const snow_settings *settings) {
    int16_t idle = settings->mode == SNOW_MODE_MINIP ? SNOW_VALUE_MOST : 0;
    snow_value_table_begin(look, &path->table);
    if (!path->range.holes)
        snow_value_table_hide(&path->table,
                              (snow_transparent_interval){idle, idle});
}

static void read_best(const snow_value_splat *splat, const void *planes,
                      int phase, int row, float *out) {
    const int16_t *from = ((const snow_value_plane *)planes)[phase][0][row] + 1;
    (void)splat;
    for (int n = 0; n < SNOW_VALUE_COLUMNS; n++) {
        out[2 * n] = from[n] < 0 ? 0 : (float)from[n] / SNOW_VALUE_MOST;
        out[2 * n + 1] = from[n] >= 0;
    }
}

/* --- mean and sum --------------------------------------------------------- */

/* Half the sum of both ends, and the length, of all slabs. */
static void read_sums(const snow_value_splat *splat, const void *planes,
                      int phase, int row, float *out) {
    const snow_value_faint_plane *plane =
        (const snow_value_faint_plane *)planes + phase;
    (void)splat;
    for (int n = 0; n < SNOW_VALUE_COLUMNS; n++) {
        out[2 * n] = (*plane)[0][row][n + 1] / (2 * SNOW_VALUE_MOST);
        out[2 * n + 1] = (*plane)[3][row][n + 1];
    }
}

static void finish_means(const snow_value_path *path, float *pixels,
                         int count) {
    (void)path;
    for (float *end = pixels + 2 * count; pixels < end; pixels += 2)
        if (pixels[1] > 0) {
            pixels[0] /= pixels[1];
            pixels[1] = 1;
        }
}

static void finish_sums(const snow_value_path *path, float *pixels, int count) {
    const snow_value_scale scale = snow_value_projected(path, SNOW_MODE_SUM);
    const double unit = path->lattice.path / path->reference;
    const snow_value_scale14 *values = &path->table.made.scale;
    const double low = values->low, range = values->high - low;
    const double inverse = scale.step > 0 ? 1 / scale.step : 0;
    for (float *end = pixels + 2 * count; pixels < end; pixels += 2)
        if (pixels[1] > 0) {
            double sum =
                unit * (low * (double)pixels[1] + range * (double)pixels[0]);
            pixels[0] = (float)((sum - scale.from) * inverse);
            pixels[1] = 1;
        }
}

/* --- isosurfaces ------------------------------------------------------------
 *
 * Over, of slabs that are opaque where they reach a value. */

/* So much a number may be below and is on the surface, for rounding must not
 * decide where voxels have its very value. */
#define MARGIN 1e-4

/* Hides what is below the surface, and colours it. */
static void hide_below(snow_value_path *path, const snow_value_look *look,
                       const snow_settings *settings) {
    const snow_value_scale14 *scale = &look->scale;
    snow_value_surface *surface = &path->surface;
    double at = (settings->iso - scale->low) * SNOW_VALUE_MOST /
                    (scale->high - scale->low) -
                MARGIN;
    double rgba[4];
    at = settings->iso > scale->low ? fmin(at, SNOW_VALUE_MOST + 1) : 0;
    snow_value_table_begin(look, &path->table);
    if (at > 0)
        snow_value_table_hide(&path->table, (snow_transparent_interval){
                                                0, (int16_t)(ceil(at) - 1)});
    snow_transfer_evaluate(look->transfer, settings->iso, rgba);
    surface->at = (float)at;
    for (int c = 0; c < 3; c++)
        surface->color[c] = (int16_t)(rgba[c] * INT16_MAX + 0.5);
    surface->color[3] = INT16_MAX;
}

/* --- the records ---------------------------------------------------------- */

const snow_value_operator *snow_value_operator_of(snow_mode mode) {
    static const snow_value_operator over = {
        .mode = SNOW_MODE_OVER,
        .reduction = SNOW_VALUE_OVER,
        .read = read_over,
    };
    static const snow_value_operator others[] = {
        {SNOW_MODE_MIP, SNOW_VALUE_LARGEST, hide_idle, read_best,
         snow_keep_largest, NULL},
        {SNOW_MODE_MINIP, SNOW_VALUE_SMALLEST, hide_idle, read_best,
         snow_keep_largest, NULL},
        {SNOW_MODE_MEAN, SNOW_VALUE_SUM, hide_idle, read_sums, snow_add_up,
         finish_means},
        {SNOW_MODE_SUM, SNOW_VALUE_SUM, hide_idle, read_sums, snow_add_up,
         finish_sums},
        {SNOW_MODE_ISO, SNOW_VALUE_OVER, hide_below, read_over, NULL, NULL},
    };
    for (size_t n = 0; n < sizeof others / sizeof *others; n++)
        if (others[n].mode == mode)
            return &others[n];
    return &over;
}

snow_value_scale snow_value_projected(const snow_value_path *path,
                                      snow_mode mode) {
    const snow_value_scale14 *values = &path->table.made.scale;
    const double low = values->low, high = values->high;
    if (!(path->range.low <= path->range.high)) /* nothing is there */
        return (snow_value_scale){0, 0};
    if (mode == SNOW_MODE_MINIP)
        return (snow_value_scale){high, low - high};
    if (mode != SNOW_MODE_SUM)
        return (snow_value_scale){low, high - low};
    /* A ray that ends before a side has a sum nearer to 0. */
    double longest = path->longest / path->reference;
    double from = fmin(0, low) * longest;
    return (snow_value_scale){from, fmax(0, high) * longest - from};
}
