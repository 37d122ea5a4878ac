/* classify/shading/shade.c - Phong's model on gradients of the native values,
 * for kept voxels only (the paper's outlook in section 6; model, section 4).
 *
 *   colour = min(1, c (ambient + diffuse n.l) + specular (n.h)^shininess)
 *
 * with the mean of the lights' terms where there are several.
 *
 * The normal n is W g / |W g| for an index gradient g, so n.l is g.(W^T l) / |W
 * g|: only scalars leave index space. */
#include "base/exp_log.h"
#include "base/vec3.h"
#include "classify/classify.h"
#include "simd/isa.h"

#include <math.h>
#include <string.h>

/* out = W^T v, where W is the inverse transpose and `inverse` the inverse. */
static void to_index(double inverse[3][3], const double v[3], double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = snow_dot(inverse[i], v);
}

/* The key light, and its part of the light; the rest is a head light. */
#define KEY_AZIMUTH (-25)
#define KEY_ELEVATION 35
#define KEY_SHARE 0.65

/* Adds a light of so many degrees to the camera's right and up. */
static void add_distant(const snow_placement *placement, double azimuth,
                        double elevation, double share, snow_lights *lights) {
    double right[3], up[3], *to = lights->to[lights->count];
    memcpy(right, placement->right, sizeof right);
    memcpy(up, placement->up, sizeof up);
    memcpy(to, placement->back, sizeof lights->to[0]);
    snow_frame_turn(right, up, to, azimuth, elevation, 0);
    lights->share[lights->count++] = share;
}

snow_lights snow_lights_of(const snow_placement *placement,
                           const snow_settings *settings) {
    snow_lights lights = {0};
    const bool key = settings->light == SNOW_LIGHT_KEY;
    const bool ahead =
        settings->light == SNOW_LIGHT_HEAD ||
        (settings->light_azimuth == 0 && settings->light_elevation == 0);
    if (key)
        add_distant(placement, KEY_AZIMUTH, KEY_ELEVATION, KEY_SHARE, &lights);
    else if (!ahead)
        add_distant(placement, settings->light_azimuth,
                    settings->light_elevation, 1, &lights);
    if (!key && !ahead)
        return lights;
    memcpy(lights.to[lights.count], placement->back, sizeof lights.to[0]);
    lights.head[lights.count] = true;
    lights.share[lights.count++] = key ? 1 - KEY_SHARE : 1;
    return lights;
}

void snow_half_way(const double light[3], const double viewer[3],
                   double half[3]) {
    for (int i = 0; i < 3; i++)
        half[i] = light[i] + viewer[i];
    if (snow_length(half) > 1e-9)
        snow_normalize(half);
    else
        memset(half, 0, 3 * sizeof *half);
}

snow_status snow_shader_init(snow_context *context, const snow_volume *volume,
                             const snow_placement *placement,
                             const snow_settings *settings, snow_shader *out) {
    const double shininess = settings->shininess;
    const bool whole = shininess <= 1024 && shininess == floor(shininess);
    snow_shader shader = {
        .volume = volume,
        .placement = placement,
        .ambient = settings->ambient,
        .diffuse = settings->diffuse,
        .specular = settings->specular,
        .shininess = shininess,
        .whole = whole ? (int)shininess : -1,
        .isa = snow_isa_resolve(settings->isa),
        .lights = snow_lights_of(placement, settings),
    };
    double(*inverse)[3] = shader.inverse;
    if (!snow_matrix_invert3(volume->info.matrix, inverse))
        return snow_fail(
            context, SNOW_STATUS_BAD_USAGE,
            "the volume's matrix is singular: it must be invertible for "
            "shading; correct the volume's orientation and spacing");
    snow_shader_turn(&shader, placement->back);
    snow_clip_viewer(placement, &shader.eye);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            shader.metric[i][j] = snow_dot(inverse[i], inverse[j]);
    *out = shader;
    return SNOW_STATUS_OK;
}

void snow_shader_turn(snow_shader *shader, const double viewer[3]) {
    const snow_lights *lights = &shader->lights;
    for (int n = 0; n < lights->count; n++) {
        const double *to = lights->head[n] ? viewer : lights->to[n];
        double half[3];
        snow_half_way(to, viewer, half);
        to_index(shader->inverse, to, shader->to[n]);
        to_index(shader->inverse, half, shader->half[n]);
    }
    to_index(shader->inverse, viewer, shader->viewer);
}

/* Voxels shaded at once: their gradients stay in the first-level cache. */
#define SHADE_BLOCK SNOW_SHADE_BLOCK

/* Invisible contributions become 0. The far side of a highlight has powers that
 * are subnormal as floats; splatting them takes twice as long. */
#define UNSEEN 1e-20

/* A colour under a factor and white light. */
static inline float shaded(float color, double factor, double white) {
    double sum = factor * (double)color + white;
    sum = sum > UNSEEN ? sum : 0;
    return (float)(sum < 1 ? sum : 1);
}

#define TEMPLATE "classify/shading/shade.tmpl.h"
#include "simd/each_isa.h"

void snow_shade_gradients(const snow_shader *shader,
                          const double gradients[3][SHADE_BLOCK],
                          const float *flat, int count, int channels,
                          float *samples) {
    SNOW_OF_ISA(shader->isa, shade_block)(shader, gradients, flat, count,
                                          channels, samples);
}

/* Of voxels of a row, where clip planes have cut the volume. */
static void find_flatness(const snow_shader *shader,
                          const snow_gradient_row *row, const uint32_t *columns,
                          size_t count, float *flat) {
    const snow_clip_planes *clip = shader->volume->clip;
    double at[3] = {(double)row->at[0], (double)row->at[1], (double)row->at[2]};
    for (size_t n = 0; clip && n < count; n++) {
        at[row->axis] = columns[n];
        flat[n] = snow_clip_flatness(clip, &shader->eye, at);
    }
}

void snow_shade_row_block(const snow_shader *shader, int channels,
                          snow_row_block *row_block) {
    const snow_placement *p = shader->placement;
    const snow_volume *volume = shader->volume;
    double gradients[3][SHADE_BLOCK];
    float flat[SHADE_BLOCK];
    memset(gradients, 0, sizeof gradients);
    snow_gradient_row row = {.volume = volume, .axis = p->u_axis};
    row.at[p->slice_axis] = row_block->slice;
    size_t n = 0;
    for (int64_t line = 0; line < row_block->rows; line++) {
        row.at[p->v_axis] = row_block->first_row + line;
        while (n < row_block->row_end[line]) {
            size_t count = row_block->row_end[line] - n;
            count = count < SHADE_BLOCK ? count : SHADE_BLOCK;
            snow_gradients_of_row(&row, row_block->columns + n, count,
                                  SHADE_BLOCK, gradients[0]);
            find_flatness(shader, &row, row_block->columns + n, count, flat);
            snow_shade_gradients(
                shader, (const double(*)[SHADE_BLOCK])gradients,
                volume->clip ? flat : NULL, (int)count, channels,
                row_block->samples + n * (size_t)channels);
            n += count;
        }
    }
}
