/* tests/reference/model_scene.c - scenes that the model's rules are tested on:
 * small volumes that look different from every side. */
#include "reference/model.h"

#include <math.h>

#define THIRD 0.57735026918962576 /* 1 / sqrt(3) */
#define SIXTH 0.40824829046386302 /* 1 / sqrt(6) */

void model_near(double actual, double expected, double bound, const char *what,
                const char *file, int line) {
    if (fabs(actual - expected) <= bound)
        return;
    print_error("%s is %.17g, not %.17g within %g\n", what, actual, expected,
                bound);
    _fail(file, line);
}

static const double matrices[MODEL_MATRICES][4][4] = {
    [MODEL_PLAIN] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}},
    [MODEL_ANISOTROPIC] = {{0.7, 0, 0, 5},
                           {0, 1.1, 0, -3},
                           {0, 0, 2, 40},
                           {0, 0, 0, 1}},
    /* Columns of lengths 0.9, 0.9 and 1.4 at right angles to each other. */
    [MODEL_OBLIQUE] = {{0.6, -0.6, 0.466666666666666667, -80},
                       {0.6, 0.3, -0.933333333333333333, 15},
                       {0.3, 0.6, 0.933333333333333333, 7},
                       {0, 0, 0, 1}},
    [MODEL_SHEARED] = {{1, 0.3, 0.1, 2},
                       {0, 0.9, -0.35, 0},
                       {0.2, 0, 1.3, -1},
                       {0, 0, 0, 1}},
    [MODEL_MIRRORED] = {{-1, 0, 0, 0},
                        {0, 1, 0, 0},
                        {0, 0, 1.25, 0},
                        {0, 0, 0, 1}},
};

static const snow_color_point colored[] = {{20, 0.9, 0.3, 0.1},
                                           {45, 0.2, 0.8, 0.5},
                                           {45, 0.4, 0.1, 0.9},
                                           {90, 1.0, 0.9, 0.2}};
static const snow_color_point greys[] = {{10, 0.1, 0.1, 0.1},
                                         {90, 0.95, 0.95, 0.95}};
static const snow_color_point white[] = {{0, 1, 1, 1}};
static const snow_opacity_point steep[] = {
    {3, 0}, {9, 0.5}, {9, 0.8}, {14, 0.3}, {30, 1}};
static const snow_opacity_point ramp[] = {
    {40, 0}, {60, 0.12}, {60, 0.3}, {85, 0.05}, {99, 0.8}};

/* Data values are slope * native + intercept with slopes that are powers of
 * two, so that no rounding decides on which side of a step a voxel falls. */
static void scale_type(snow_volume_info *info) {
    switch (info->type) {
    case SNOW_TYPE_INT8:
        info->slope = 1;
        info->intercept = 50;
        break;
    case SNOW_TYPE_UINT8:
        info->slope = 0.5;
        break;
    case SNOW_TYPE_INT16:
        info->slope = -0.0078125;
        info->intercept = 50;
        break;
    case SNOW_TYPE_UINT16:
    case SNOW_TYPE_UINT32:
        info->slope = 0.0078125;
        break;
    case SNOW_TYPE_INT64:
    case SNOW_TYPE_UINT64:
        info->slope = 0x1p-20;
        break;
    default:
        info->slope = 1;
        break;
    }
}

/* A ball with ripples and some noise, different along every axis. */
static double structure(const int64_t dims[3], const int64_t at[3],
                        double noise) {
    double p[3];
    for (int n = 0; n < 3; n++)
        p[n] = ((double)at[n] + 0.5) / (double)dims[n] - 0.5;
    double ball =
        1.1 - 2.3 * sqrt(p[0] * p[0] + 1.3 * p[1] * p[1] + p[2] * p[2]);
    double ripple = sin(9 * p[0] + 5 * p[1] * p[1] - 7 * p[2]);
    double value = 50 + 35 * ball + 20 * ripple + 16 * (noise - 0.5);
    return fmin(fmax(value, 0), 100);
}

static void store(void *voxels, snow_type type, size_t at, double native) {
    bool real = type == SNOW_TYPE_FLOAT32 || type == SNOW_TYPE_FLOAT64;
    double value = real ? native : rint(native);
    switch (type) {
#define STORE(name, ctype, text)              \
    case SNOW_TYPE_##name:                    \
        ((ctype *)voxels)[at] = (ctype)value; \
        break;
        SNOW_TYPE_MAP(STORE)
#undef STORE
    case SNOW_TYPE_NONE:
        break;
    }
}

static void *allocate_voxels(const int64_t dims[3], snow_type type,
                             size_t more) {
    size_t count = (size_t)dims[0] * (size_t)dims[1] * (size_t)dims[2];
    void *voxels = calloc(1, count * snow_type_size(type) + more);
    assert_non_null(voxels);
    return voxels;
}

static void fill_voxels(reference_scene *scene, uint64_t seed) {
    const snow_volume_info *info = &scene->info;
    void *voxels = allocate_voxels(info->dims, info->type, 0);
    uint64_t state = (seed + support_voxel_seed() * 65537) * 2 + 1;
    size_t at = 0;
    for (int64_t k = 0; k < info->dims[2]; k++)
        for (int64_t j = 0; j < info->dims[1]; j++)
            for (int64_t i = 0; i < info->dims[0]; i++) {
                double value = structure(info->dims, (int64_t[]){i, j, k},
                                         support_uniform(&state));
                store(voxels, info->type, at++,
                      (value - info->intercept) / info->slope);
            }
    scene->voxels = voxels;
}

static void place(reference_scene *scene, model_matrix matrix) {
    memcpy(scene->info.matrix, matrices[matrix], sizeof scene->info.matrix);
    for (int c = 0; c < 3; c++)
        scene->info.spacing[c] =
            hypot(hypot(scene->info.matrix[0][c], scene->info.matrix[1][c]),
                  scene->info.matrix[2][c]);
}

static reference_scene plain_scene(const int64_t dims[3], snow_type type) {
    reference_scene scene = {
        .info = {.size = sizeof(snow_volume_info),
                 .dims = {dims[0], dims[1], dims[2]},
                 .type = type,
                 .slope = 1,
                 .format = "memory",
                 .times = 1},
        .view = {.size = sizeof(snow_view),
                 .width = 64,
                 .height = 48,
                 .back = {0, 0, 1},
                 .up = {0, 1, 0},
                 .zoom = 1},
    };
    place(&scene, MODEL_PLAIN);
    snow_settings_init(&scene.settings);
    /* Whole numbers have gradients that are square to the line of sight: by
     * another light rounding would decide which way they are turned. */
    scene.settings.light = SNOW_LIGHT_HEAD;
    scene.settings.method = SNOW_METHOD_FOOTPRINT; /* the exact one */
    return scene;
}

reference_scene model_scene(const int64_t dims[3], snow_type type, bool grey,
                            model_matrix matrix, uint64_t seed) {
    reference_scene scene = plain_scene(dims, type);
    place(&scene, matrix);
    scale_type(&scene.info);
    fill_voxels(&scene, seed);
    scene.colors = grey ? greys : colored;
    scene.color_count =
        grey ? sizeof greys / sizeof *greys : sizeof colored / sizeof *colored;
    scene.opacities = ramp;
    scene.opacity_count = sizeof ramp / sizeof *ramp;
    return scene;
}

void model_fade(reference_scene *scene) {
    scene->gradients = steep;
    scene->gradient_count = sizeof steep / sizeof *steep;
}

/* The points of its opacity lie behind its voxels, and are freed with them. */
reference_scene model_blank(const int64_t dims[3], double opacity) {
    reference_scene scene = plain_scene(dims, SNOW_TYPE_FLOAT32);
    size_t bytes = (size_t)((dims[0] * dims[1] * dims[2] * 4 + 15) / 16 * 16);
    const snow_opacity_point points[2] = {{0.5, 0}, {0.5, opacity}};
    char *voxels = allocate_voxels(dims, SNOW_TYPE_FLOAT32, sizeof points + 15);
    memcpy(voxels + bytes, points, sizeof points);
    scene.voxels = voxels;
    scene.opacities = (const void *)(voxels + bytes);
    scene.opacity_count = 2;
    scene.colors = white;
    scene.color_count = 1;
    scene.settings.shade = SNOW_SHADE_NONE;
    return scene;
}

void model_free(reference_scene *scene) {
    free((void *)(uintptr_t)scene->voxels);
}

float *model_voxels(const reference_scene *scene) {
    return (float *)(uintptr_t)scene->voxels;
}

void model_look(reference_scene *scene, const double back[3],
                const double up[3]) {
    memcpy(scene->view.back, back, sizeof scene->view.back);
    memcpy(scene->view.up, up, sizeof scene->view.up);
}

void model_turn(reference_scene *scene, double azimuth, double elevation,
                double roll, double zoom) {
    scene->view.azimuth = azimuth;
    scene->view.elevation = elevation;
    scene->view.roll = roll;
    scene->view.zoom = zoom;
}

const char *model_words(const reference_scene *scene) {
    static char words[512];
    const snow_view *view = &scene->view;
    const snow_settings *settings = &scene->settings;
    const snow_volume_info *info = &scene->info;
    snprintf(words, sizeof words,
             "%dx%dx%d %s%s, %s footprint %d, threshold %g, shade %s, light "
             "%g/%g, method %d encoding %d; from (%.3g %.3g %.3g) turned "
             "%g/%g/%g, zoom %g, %dx%d; spacing %.3g %.3g %.3g, axes %.3g "
             "%.3g %.3g",
             (int)info->dims[0], (int)info->dims[1], (int)info->dims[2],
             snow_type_name(info->type), scene->colors == greys ? " grey" : "",
             snow_kernel_name(settings->kernel), settings->footprint,
             settings->threshold,
             settings->shade == SNOW_SHADE_PHONG ? "phong" : "none",
             settings->light_azimuth, settings->light_elevation,
             (int)settings->method, (int)settings->encoding, view->back[0],
             view->back[1], view->back[2], view->azimuth, view->elevation,
             view->roll, view->zoom, view->width, view->height,
             info->spacing[0], info->spacing[1], info->spacing[2],
             info->matrix[0][0], info->matrix[1][1], info->matrix[2][2]);
    return words;
}

void model_stand_at(reference_scene *scene, size_t n, double zoom) {
    static const struct {
        double back[3], up[3], azimuth, elevation, roll;
    } stands[MODEL_STANDS] = {
        {{0, 0, 1}, {0, 1, 0}, 0, 0, 0},
        {{0, 0, -1}, {0, 1, 0}, 0, 0, 0},
        {{0, 1, 0}, {0, 0, 1}, 0, 0, 0},
        {{0, -1, 0}, {0, 0, 1}, 0, 0, 0},
        {{1, 0, 0}, {0, 0, 1}, 0, 0, 0},
        {{-1, 0, 0}, {0, 0, 1}, 0, 0, 0},
        {{0, 0, 1}, {0, 1, 0}, 0, 0, 90},
        {{0, 1, 0}, {0, 0, 1}, 0, 0, 180},
        {{-1, 0, 0}, {0, 0, 1}, 0, 0, -90},
        {{0, 0, 1}, {0, 1, 0}, 30, 20, 0},
        {{0, 0, 1}, {0, 1, 0}, 45, 0, 0},
        {{0, 0, 1}, {0, 1, 0}, 10, 80, 0},
        {{0, 1, 0}, {0, 0, 1}, -120, -35, 25},
        {{1, 0, 0}, {0, 0, 1}, 90, 45, 0},
        {{THIRD, THIRD, THIRD}, {-SIXTH, -SIXTH, 2 * SIXTH}, 0, 0, 0},
    };
    n %= MODEL_STANDS;
    model_look(scene, stands[n].back, stands[n].up);
    model_turn(scene, stands[n].azimuth, stands[n].elevation, stands[n].roll,
               zoom);
}

snow_type model_type(size_t n) {
    return (snow_type)(SNOW_TYPE_INT8 + n % MODEL_TYPES);
}

snow_kernel model_kernel(size_t n) {
    return (snow_kernel)(SNOW_KERNEL_BSPLINE + n % MODEL_KERNELS);
}

size_t model_draw(uint64_t *random, size_t count) {
    return (size_t)(support_random(random) >> 33) % count;
}

reference_scene model_phantom(snow_context *context, const char *name,
                              const int64_t dims[3], snow_volume **volume) {
    reference_scene scene = {.view = {.size = sizeof(snow_view),
                                      .back = {0, 0, 1},
                                      .up = {0, 1, 0},
                                      .zoom = 1}};
    assert_int_equal(snow_volume_open_phantom(context, name, dims, 1, volume),
                     SNOW_STATUS_OK);
    scene.info = *snow_volume_get_info(*volume);
    scene.voxels = snow_volume_voxels(*volume);
    snow_settings_init(&scene.settings);
    return scene;
}
