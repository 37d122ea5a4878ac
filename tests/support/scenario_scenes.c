/* tests/support/scenario_scenes.c - the scenes of scenario.h, by number. */
#include "support/scenario.h"

#include <math.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const snow_type types[] = {SNOW_TYPE_UINT8, SNOW_TYPE_INT16,
                                  SNOW_TYPE_FLOAT32, SNOW_TYPE_UINT16};

static const snow_opacity_point ramp[] = {
    {0, 0}, {35, 0}, {70, 0.5}, {100, 0.9}};
static const snow_opacity_point steep[] = {
    {0, 0}, {50, 0}, {51.5, 0.9}, {100, 0.9}};
static const snow_opacity_point bands[] = {{0, 0},    {20, 0}, {28, 0.4},
                                           {36, 0},   {55, 0}, {64, 0.7},
                                           {72, 0.1}, {80, 0}, {100, 0}};
static const snow_opacity_point thin[] = {{0, 0.02}, {100, 0.1}};
static const snow_opacity_point faint[] = {{0, 0.0002}, {100, 0.0015}};
static const snow_opacity_point some[] = {{0, 0}, {55, 0}, {75, 0.4}, {100, 1}};
static const snow_opacity_point clear[] = {
    {0, 0}, {45, 0}, {45, 0.3}, {100, 0.3}};
/* Steps between constant colours: whole numbers are labels. */
static const snow_color_point names[] = {{0, 1, 0, 0},  {30, 1, 0, 0},
                                         {30, 0, 1, 0}, {60, 0, 1, 0},
                                         {60, 0, 0, 1}, {100, 0, 0, 1}};
static const snow_color_point hot[] = {{0, 0.4, 0, 0}, {100, 1, 0.9, 0.2}};
static const struct {
    const snow_opacity_point *points;
    size_t count;
} looks[] = {{ramp, COUNT(ramp)},
             {steep, COUNT(steep)},
             {bands, COUNT(bands)},
             {thin, COUNT(thin)},
             {faint, COUNT(faint)}};

/* Takes values away here and there, from a corner and a slice. */
static void make_holes(reference_scene *s) {
    float *voxel = (float *)(uintptr_t)s->voxels;
    const int64_t *dims = s->info.dims;
    for (int64_t z = 0; z < dims[2]; z++)
        for (int64_t y = 0; y < dims[1]; y++)
            for (int64_t x = 0; x < dims[0]; x++, voxel++)
                if ((x < 9 && y < 8 && z < 10) || z == 14 ||
                    (x + 3 * y + 5 * z) % 61 == 0)
                    *voxel = NAN;
    s->masked = true;
}

static void turn(reference_scene *s, int n) {
    static const double backs[][3] = {{0, 0, 1},  {0, 1, 0},  {1, 0, 0},
                                      {0, 0, -1}, {0, -1, 0}, {-1, 0, 0}};
    static const double ups[][3] = {{0, 1, 0}, {0, 0, 1}, {0, 0, 1}};
    static const double zooms[] = {1.1, 2.6, 0.35, 5};
    model_look(s, backs[n % 6], ups[n % 3]);
    if (n % 7) /* else along the axis */
        model_turn(s, n % 2 ? 25 : -33, n * 37 % 70 - 35, n % 4 ? 0 : 15,
                   zooms[n / 5 % 4]);
    s->view.width = 50;
    s->view.height = 42;
    s->view.fov = n % 4 == 2 || n % 16 == 9 ? 25 : 0;
    if (n % 13 == 0) /* smaller images are halved, or means */
        s->view.width = s->view.height = n / 13 % 2 ? 3 : 9;
}

reference_scene scenario_scene(int n, int64_t depth) {
    static const model_matrix matrices[] = {MODEL_PLAIN, MODEL_ANISOTROPIC,
                                            MODEL_OBLIQUE, MODEL_MIRRORED};
    reference_scene s =
        model_scene((int64_t[]){25, 22, depth}, types[n % 4], n % 5 == 0,
                    matrices[n / 2 % 4], (uint64_t)n + 1);
    s.info.medical = true;
    s.settings.method = SNOW_METHOD_SHEAR_WARP;
    s.settings.threads = 1 + n % 2;
    s.settings.quality = (snow_quality)(n % 3);
    s.settings.shade = n / 3 % 3 == 2 ? SNOW_SHADE_NONE : SNOW_SHADE_PHONG;
    s.settings.encoding = (snow_encoding)(n / 2 % 4);
    s.settings.threshold = n / 4 % 3 == 2 ? 10 : 0;
    s.settings.opacity_length = n % 9 == 5 ? 15 : s.settings.opacity_length;
    s.opacities = looks[(size_t)(n + n / 4) % COUNT(looks)].points;
    s.opacity_count = looks[(size_t)(n + n / 4) % COUNT(looks)].count;
    turn(&s, n);
    if (n % 7 == 3)
        model_fade(&s);
    if (n % 8 == 1) {
        s.colors = names;
        s.color_count = COUNT(names);
    }
    if (n % 4 == 2 && n % 3 != 1)
        make_holes(&s);
    if (n % 5 == 4) {
        s.settings.kernel = SNOW_KERNEL_BSPLINE;
        s.settings.footprint = 4;
    }
    return s;
}

reference_scene scenario_front(const reference_scene *base, int n) {
    const int64_t *dims = base->info.dims;
    const bool coarse = n % 3 == 1, turned = n % 3 == 2, labels = n / 3 % 2;
    const int64_t own[3] = {dims[0] / (1 + coarse), dims[1] / (1 + coarse),
                            dims[2] / (1 + coarse)};
    reference_scene s =
        model_scene(own, labels ? SNOW_TYPE_UINT8 : types[(n + 1) % 4], false,
                    MODEL_PLAIN, (uint64_t)n + 100);
    memcpy(s.info.matrix, base->info.matrix, sizeof s.info.matrix);
    s.info.medical = true;
    for (int row = 0; row < 3; row++) {
        double *m = s.info.matrix[row];
        for (int axis = 0; axis < 3; axis++) {
            m[3] += coarse ? m[axis] / 2 : 0;
            m[axis] *= 1 + coarse;
        }
        m[3] += turned ? m[0] * (double)(dims[0] - 1) : 0;
        m[0] *= turned ? -1 : 1;
    }
    s.colors = labels ? names : hot;
    s.color_count = labels ? COUNT(names) : COUNT(hot);
    s.opacities = labels ? clear : some;
    s.opacity_count = labels ? COUNT(clear) : COUNT(some);
    return s;
}

void scenario_free_scene(reference_scene *scene) {
    free((void *)(uintptr_t)scene->voxels);
}
