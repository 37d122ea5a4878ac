/* classify/shade.c - Phong's model on gradients of the native values, for the
 * voxels that are kept only (the paper's outlook in section 6; model, point 4).
 *
 *   colour = min(1, c (ambient + diffuse n.l) + specular (n.h)^shininess)
 *
 * The normal n is W g / |W g| for an index gradient g, so n.l is
 * g.(W^T l) / |W g|: only scalars leave index space. */
#include "base/power.h"
#include "base/vec3.h"
#include "classify/classify.h"

#include <math.h>
#include <string.h>

/* out = W^T v, where W is the inverse transpose and `inverse` the inverse. */
static void to_index(double inverse[3][3], const double v[3], double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = snow_dot(inverse[i], v);
}

bool snow_light_of(const snow_placement *placement,
                   const snow_settings *settings, double light[3],
                   double half[3]) {
    double right[3], up[3];
    memcpy(right, placement->right, sizeof right);
    memcpy(up, placement->up, sizeof up);
    memcpy(light, placement->back, 3 * sizeof *light);
    snow_frame_turn(right, up, light, settings->light_azimuth,
                    settings->light_elevation, 0);
    for (int i = 0; i < 3; i++)
        half[i] = light[i] + placement->back[i];
    if (!(snow_length(half) > 1e-9))
        return false;
    snow_normalize(half);
    return true;
}

int snow_whole_shininess(double shininess) {
    bool whole = shininess <= 1024 && shininess == floor(shininess);
    return whole ? (int)shininess : -1;
}

snow_status snow_shader_init(snow_context *context, const snow_volume *volume,
                             const snow_placement *placement,
                             const snow_settings *settings, snow_shader *out) {
    snow_shader shader = {
        .volume = volume,
        .placement = placement,
        .ambient = settings->ambient,
        .diffuse = settings->diffuse,
        .specular = settings->specular,
        .shininess = settings->shininess,
        .whole = snow_whole_shininess(settings->shininess),
    };
    double inverse[3][3], light[3], half[3];
    if (!snow_matrix_invert3(volume->info.matrix, inverse))
        return snow_fail(context, SNOW_BAD_USAGE,
                         "the volume's matrix cannot be inverted");
    if (!snow_light_of(placement, settings, light, half))
        shader.specular = 0;
    to_index(inverse, light, shader.light);
    to_index(inverse, half, shader.half);
    to_index(inverse, placement->back, shader.viewer);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            shader.metric[i][j] = snow_dot(inverse[i], inverse[j]);
    *out = shader;
    return SNOW_OK;
}

/* x^shininess.  Whole exponents (the default is one) by squaring. */
static double power(const snow_shader *shader, double x) {
    if (shader->whole < 0)
        return snow_power(x, shader->shininess);
    double result = 1;
    for (unsigned n = (unsigned)shader->whole; n; n /= 2, x *= x)
        if (n % 2)
            result *= x;
    return result;
}

/* The factor of the colour and the white added to it, for a gradient. */
static void reflect(const snow_shader *shader, const double gradient[3],
                    double *factor, double *white) {
    /* Only the direction counts; the square of a tiny or huge difference could
     * vanish or overflow. */
    double most = fabs(gradient[0]), g[3];
    for (int i = 1; i < 3; i++)
        most = fabs(gradient[i]) > most ? fabs(gradient[i]) : most;
    double inverse = most > 0x1p-300 && most < 0x1p300 ? 1 : 1 / most;
    for (int i = 0; i < 3; i++)
        g[i] = gradient[i] * inverse;
    double carried[3] = {snow_dot(shader->metric[0], g),
                         snow_dot(shader->metric[1], g),
                         snow_dot(shader->metric[2], g)};
    double square = snow_dot(carried, g);
    *factor = shader->ambient;
    *white = 0;
    if (!(square > 0) || !isfinite(square))
        return;
    double scale = 1 / sqrt(square);
    if (snow_dot(g, shader->viewer) < 0)
        scale = -scale;
    double lambert = scale * snow_dot(g, shader->light);
    if (lambert <= 0)
        return;
    double highlight = scale * snow_dot(g, shader->half);
    *factor += shader->diffuse * lambert;
    if (highlight > 0 && shader->specular > 0)
        *white = shader->specular * power(shader, highlight);
}

/* Shades one sample, and multiplies its colour by its opacity. */
static void shade_sample(const snow_shader *shader, const double gradient[3],
                         int channels, float *sample) {
    double factor, white;
    reflect(shader, gradient, &factor, &white);
    float opacity = sample[channels - 1];
    for (int i = 0; i < channels - 1; i++) {
        double shaded = factor * (double)sample[i] + white;
        sample[i] = (float)(shaded < 1 ? shaded : 1) * opacity;
    }
}

void snow_shade_strip(const snow_shader *shader, int channels,
                      snow_strip *strip) {
    const snow_placement *p = shader->placement;
    const snow_volume *volume = shader->volume;
    snow_gradient_fn *gradient_of = snow_gradient_of(volume->info.type);
    int64_t at[3];
    at[p->slice_axis] = strip->slice;
    size_t n = 0;
    for (int64_t row = 0; row < strip->rows; row++) {
        at[p->v_axis] = strip->first_row + row;
        for (; n < strip->row_end[row]; n++) {
            float *sample = strip->samples + n * (size_t)channels;
            if (!(sample[channels - 1] > 0))
                continue;
            double gradient[3];
            at[p->u_axis] = strip->columns[n];
            gradient_of(volume->voxels, volume->info.dims, at, gradient);
            shade_sample(shader, gradient, channels, sample);
        }
    }
}
