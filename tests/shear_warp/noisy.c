/* tests/shear_warp/noisy.c - scenes of every kind with noise, in which no two
 * voxels are alike: for pictures that must have the same bits. */
#include "shear_warp/scenes.h"

#include <math.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const snow_type types[] = {SNOW_TYPE_UINT8, SNOW_TYPE_INT16,
                                  SNOW_TYPE_FLOAT32, SNOW_TYPE_INT8,
                                  SNOW_TYPE_UINT16};
static const snow_quality qualities[] = {
    SNOW_QUALITY_DRAFT, SNOW_QUALITY_NORMAL, SNOW_QUALITY_HIGH};
static const model_matrix matrices[] = {MODEL_PLAIN, MODEL_ANISOTROPIC,
                                        MODEL_OBLIQUE, MODEL_MIRRORED};

/* Looks with none, one and several invisible ranges; a steep one. */
static const snow_opacity_point all[] = {{0, 0.05}, {100, 0.5}};
static const snow_opacity_point above[] = {
    {0, 0}, {35, 0}, {70, 0.6}, {100, 0.9}};
static const snow_opacity_point bands[] = {{0, 0},    {20, 0}, {28, 0.4},
                                           {36, 0},   {55, 0}, {64, 0.7},
                                           {72, 0.1}, {80, 0}, {100, 0}};
static const snow_opacity_point steep[] = {
    {0, 0}, {50, 0}, {51.5, 0.9}, {100, 0.9}};
static const struct {
    const snow_opacity_point *points;
    size_t count;
} looks[] = {{all, COUNT(all)},
             {above, COUNT(above)},
             {bands, COUNT(bands)},
             {steep, COUNT(steep)}};

/* Slices so far apart that there are many resampled slices between them. */
static void thicken(reference_scene *s, int axis, double times) {
    for (int row = 0; row < 3; row++)
        s->info.matrix[row][axis] *= times;
    s->info.spacing[axis] *= times;
}

static void light(reference_scene *s, int n) {
    s->settings.light = SNOW_LIGHT_KEY;
    if (n / 4 % 3 == 1) {
        s->settings.light = SNOW_LIGHT_DIRECTION;
        s->settings.light_azimuth = 50;
        s->settings.light_elevation = -25;
        s->settings.shininess = 7.5;
    } else if (n / 4 % 3 == 2) {
        s->settings.light = SNOW_LIGHT_HEAD;
    }
    if (n / 6 % 5 == 2)
        s->settings.ambient = s->settings.diffuse = 0.9;
}

static void look(reference_scene *s, int n) {
    static const double backs[][3] = {{0, 0, 1},  {0, 1, 0},  {1, 0, 0},
                                      {0, 0, -1}, {0, -1, 0}, {-1, 0, 0}};
    static const double ups[][3] = {{0, 1, 0}, {0, 0, 1}, {0, 0, 1}};
    static const double zooms[] = {1.1, 2.6, 0.35, 5};
    model_look(s, backs[n / 2 % 6], ups[n / 2 % 3]);
    model_turn(s, n % 2 ? 25 : -33, n * 37 % 70 - 35, n % 4 ? 0 : 15,
               zooms[n / 9 % 4]);
    s->view.width = 44;
    s->view.height = 36;
}

warp_scene noisy_scene(int n) {
    static const int64_t sizes[][3] = {{23, 19, 21}, {40, 9, 12}, {1, 14, 17},
                                       {13, 1, 9},   {12, 15, 1}, {9, 12, 2}};
    static const double apart[] = {2.7, 5.5, 11, 21};
    reference_scene s =
        model_scene(sizes[n / 5 % 9 < 6 ? 0 : n % 6], types[n % 5], n / 2 % 2,
                    matrices[n / 7 % 4], (uint64_t)n);
    s.settings.method = SNOW_METHOD_SHEAR_WARP;
    s.settings.threads = 2;
    s.settings.quality = qualities[n % 3];
    s.settings.shade = n / 3 % 4 == 3 ? SNOW_SHADE_NONE : SNOW_SHADE_PHONG;
    light(&s, n);
    if (n / 11 % 4 == 3)
        s.settings.threshold = 40;
    s.opacities = looks[(size_t)n / 3 % COUNT(looks)].points;
    s.opacity_count = looks[(size_t)n / 3 % COUNT(looks)].count;
    if (n % 7 == 3)
        thicken(&s, 2 - n / 2 % 3, apart[n / 7 % 4]);
    look(&s, n);
    return (warp_scene){.base = s};
}

warp_scene noisy_scene_from_an_eye(int n) {
    static const double fovs[] = {45, 20, 3, 75};
    static const double off[3] = {0.3, 0.6, 0.4}, middle[3] = {0.5, 0.5, 0.5};
    warp_scene scene = noisy_scene(n);
    snow_view *view = &scene.base.view;
    view->fov = fovs[(size_t)n / 5 % COUNT(fovs)];
    if (n % 6 == 4) {
        view->has_target = true;
        warp_scene_place(&scene.base, off, view->target);
    }
    if (n % 4 == 3 && scene.base.info.dims[0] == 23) {
        double eye[3] = {0.48, 0.5, 0.51};
        eye[n / 4 % 3] = n / 4 % 2 ? -0.25 : 1.6;
        view->has_target = view->has_position = true;
        warp_scene_place(&scene.base, middle, view->target);
        warp_scene_place(&scene.base, eye, view->position);
        view->azimuth = view->elevation = 0;
    }
    return scene;
}

void noisy_scene_name(const reference_scene *s) {
    static const double labels[] = {0, 1, 2, 3, 5};
    const int64_t *dims = s->info.dims;
    size_t at = 0;
    for (int64_t k = 0; k < dims[2]; k++)
        for (int64_t j = 0; j < dims[1]; j++)
            for (int64_t i = 0; i < dims[0]; i++, at++) {
                double value = s->info.slope * reference_native(s, i, j, k) +
                               s->info.intercept;
                double layer = fmin(fmax(floor((value - 20) / 15), 0), 4);
                warp_scene_store(s, at, labels[(int)layer]);
            }
}

void noisy_scene_punch(reference_scene *s, int n) {
    const int64_t *dims = s->info.dims;
    float *voxel = (float *)(uintptr_t)s->voxels;
    uint64_t state = (uint64_t)n * 2 + 1;
    assert_int_equal(s->info.type, SNOW_TYPE_FLOAT32);
    for (int64_t k = 0; k < dims[2]; k++)
        for (int64_t j = 0; j < dims[1]; j++)
            for (int64_t i = 0; i < dims[0]; i++, voxel++) {
                double noise = support_uniform(&state);
                double at = (double)i / (double)dims[0] +
                            0.7 * (double)j / (double)dims[1] -
                            0.8 * (double)k / (double)dims[2];
                bool hole = n % 3 == 0   ? noise < 0.15
                            : n % 3 == 1 ? at > 0.5
                                         : at > 0.6 || noise < 0.02;
                if (hole)
                    *voxel = NAN;
            }
    s->masked = n % 4 != 3;
}
