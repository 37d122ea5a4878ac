/* tests/shear_warp/smooth.c - sums of Gaussians and of low sinusoids. */
#include "shear_warp/smooth.h"

#include <math.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))
#define PARTS 6

/* Of each part: a Gaussian's middle, deviation and height; a sinusoid's
 * frequencies in radians a voxel, phase and height. */
typedef struct parts {
    double at[PARTS][3], width[PARTS], height[PARTS];
} parts;

static const snow_opacity_point rising[] = {
    {6, 0}, {30, 0.04}, {60, 0.16}, {100, 0.4}};
static const snow_color_point tints[] = {
    {0, 0.9, 0.2, 0.1}, {40, 0.3, 0.8, 0.3}, {100, 0.4, 0.5, 1}};
/* Of another volume: where two are dense in one place, it counts which of them
 * is in front of the other in how thick a slab. */
static const snow_opacity_point thin[] = {{6, 0}, {50, 0.04}, {100, 0.1}};
static const snow_color_point other_tints[] = {{0, 0.1, 0.4, 1},
                                               {100, 1, 1, 0.3}};
static const snow_opacity_point both_rising[] = {
    {-100, 0.18}, {-5, 0}, {5, 0}, {40, 0.03}, {100, 0.2}};
static const snow_color_point both_tints[] = {
    {-100, 0.2, 0.4, 1}, {0, 0.5, 0.5, 0.5}, {100, 1, 0.5, 0.1}};

/* Seen from within, so that no pixel sees a side. */
static bool is_everywhere(smooth_field field) {
    return field == SMOOTH_WAVES || field == SMOOTH_HILLS;
}

static double between(uint64_t *random, double low, double high) {
    return low + (high - low) * support_uniform(random);
}

static parts draw_parts(smooth_field field, const int64_t dims[3],
                        uint64_t *random) {
    parts p;
    for (int n = 0; n < PARTS; n++) {
        bool falls = field == SMOOTH_SIGNS && n % 2;
        for (int c = 0; c < 3; c++)
            p.at[n][c] = is_everywhere(field) ? between(random, -0.3, 0.3)
                                              : between(random, 0.32, 0.68) *
                                                    (double)(dims[c] - 1);
        p.width[n] = is_everywhere(field) ? between(random, 0, 6.28)
                                          : between(random, 2.8, 3.8);
        p.height[n] = between(random, 0.4, 1) * (falls ? -1 : 1);
    }
    return p;
}

static double value_at(smooth_field field, const parts *p,
                       const int64_t dims[3], const int64_t at[3]) {
    const double rise = field == SMOOTH_HILLS ? 20 : 5;
    double sum =
        is_everywhere(field) ? rise * (double)at[2] / (double)(dims[2] - 1) : 0;
    for (int n = 0; n < PARTS; n++) {
        double square = 0, phase = p->width[n];
        for (int c = 0; c < 3; c++) {
            double x = (double)at[c] - p->at[n][c];
            square += x * x;
            phase += p->at[n][c] * (double)at[c];
        }
        sum += p->height[n] *
               (is_everywhere(field)
                    ? 0.5 * sin(phase)
                    : exp(-square / (2 * p->width[n] * p->width[n])));
    }
    return sum;
}

/* Values are spread over the whole range. */
static void fill(smooth_field field, const reference_scene *s,
                 uint64_t *random) {
    const int64_t *n = s->info.dims;
    size_t count = (size_t)(n[0] * n[1] * n[2]), at = 0;
    double *values = calloc(count, sizeof *values), low = 0, high = 0;
    const parts p = draw_parts(field, n, random);
    assert_non_null(values);
    for (int64_t k = 0; k < n[2]; k++)
        for (int64_t j = 0; j < n[1]; j++)
            for (int64_t i = 0; i < n[0]; i++, at++) {
                values[at] = value_at(field, &p, n, (int64_t[]){i, j, k});
                low = fmin(low, values[at]);
                high = fmax(high, values[at]);
            }
    for (at = 0; at < count; at++)
        warp_scene_store(s, at,
                         field == SMOOTH_SIGNS
                             ? 100 * values[at] / fmax(high, -low)
                             : 100 * (values[at] - low) / (high - low));
    free(values);
}

/* Bytes have their whole range, so that their steps are as small as may be. */
static void scale_bytes(snow_volume_info *info) {
    if (snow_type_size(info->type) > 1)
        return;
    info->slope = 100.0 / 255;
    info->intercept = info->type == SNOW_TYPE_INT8 ? 128 * info->slope : 0;
}

warp_scene smooth_scene(smooth_field field, snow_type type, model_matrix matrix,
                        uint64_t *random) {
    int64_t dims[3];
    for (int c = 0; c < 3; c++)
        dims[c] = 26 + (int64_t)(support_random(random) % 8);
    reference_scene s = model_scene(dims, type, false, matrix, 1);
    scale_bytes(&s.info);
    fill(field, &s, random);
    s.settings.method = SNOW_METHOD_SHEAR_WARP;
    s.settings.quality = SNOW_QUALITY_HIGH;
    s.settings.kernel = SNOW_KERNEL_TENT;
    s.settings.footprint = 2;
    if (matrix != MODEL_PLAIN) /* where the first voxels hide the rest, the
                                  normals of a few decide */
        s.settings.opacity_length = 6;
    bool both = field == SMOOTH_SIGNS;
    s.colors = both ? both_tints : tints;
    s.color_count = both ? COUNT(both_tints) : COUNT(tints);
    s.opacities = both ? both_rising : rising;
    s.opacity_count = both ? COUNT(both_rising) : COUNT(rising);
    model_turn(&s, between(random, -30, 30), between(random, -30, 30),
               between(random, 0, 360), is_everywhere(field) ? 3.4 : 1.3);
    s.view.width = 72;
    s.view.height = 64;
    return (warp_scene){.base = s};
}

warp_scene smooth_scene_beside(const warp_scene *scene, uint64_t *random) {
    warp_scene other = *scene;
    const snow_volume_info *info = &scene->base.info;
    other.base.voxels =
        calloc((size_t)(info->dims[0] * info->dims[1] * info->dims[2]),
               snow_type_size(info->type));
    assert_non_null(other.base.voxels);
    fill(SMOOTH_BUMPS, &other.base, random);
    other.base.colors = other_tints;
    other.base.color_count = COUNT(other_tints);
    other.base.opacities = thin;
    other.base.opacity_count = COUNT(thin);
    return other;
}
