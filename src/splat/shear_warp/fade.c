/* splat/shear_warp/fade.c - gradient opacity: as if a slab had one opacity,
 * whose factor is that of its gradient. */
#include "splat/shear_warp/scratch.h"

#include <math.h>

/* Of a logarithmic scale: the data's for one of the logarithm, or of the
 * place. */
static double steepness(const snow_value_fade *fade, int front, int back,
                        int place) {
    if (!fade->log)
        return 1;
    double v = front + (back - front) * (place / 32768.0);
    const double value = snow_value_of(fade->scale, v);
    return fade->scale->linear > 0 ? fmax(fabs(value), fade->scale->linear)
                                   : log(10) * value;
}

void snow_value_fade_colors(const snow_value_fade *fade,
                            const snow_value_table *table,
                            int16_t slopes[3][32], const int16_t *front,
                            const int16_t *back, const int16_t places[32],
                            int16_t color[4][32]) {
    const float *m = fade->metric;
    for (int n = 0; n < 32; n++) {
        float alpha = (float)color[3][n] * table->unit;
        if (!(alpha > 0))
            continue;
        const float u = slopes[0][n], v = slopes[1][n], p = slopes[2][n];
        double square = m[0] * u * u + m[1] * v * v + m[2] * p * p +
                        (m[3] * u * v + m[4] * u * p + m[5] * v * p);
        double magnitude = sqrt(fmax(square, 0)) *
                           steepness(fade, front[n], back[n], places[n]);
        double factor =
            snow_transfer_evaluate_gradient(fade->transfer, magnitude);
        float share = 1;
        if (factor < 1 && fade->share == 1) {
            share = (float)factor * alpha / alpha;
        } else if (factor < 1) {
            float opacity = value_lengthen(table, alpha, 1 / fade->share);
            opacity =
                value_lengthen(table, (float)factor * opacity, fade->share);
            share = opacity / alpha;
        }
        for (int c = 0; c < 4; c++)
            color[c][n] = (int16_t)((float)color[c][n] * share + 0.5F);
    }
}
