/* tests/render/test_darken.c - depth darkening and occlusion against their
 * formulas in float64 (docs/model.md, section 10). */
#include "image/image.h"
#include "reference/model.h"
#include "support/support.h"

#include <math.h>

#define WIDTH 90
#define HEIGHT 70
#define COUNT (WIDTH * HEIGHT)
#define MARGIN 30 /* cells around those of the box */

/* --- means of pixels ------------------------------------------------------ */

static int within(int n, int count) {
    return n < 0 ? 0 : n < count ? n : count - 1;
}

/* Three boxes along both axes, near to a Gaussian of that deviation; they go
 * on beyond the picture's ends. */
static void smooth(double plane[COUNT], double deviation) {
    static double before[COUNT];
    int reach = (int)((sqrt(4 * deviation * deviation + 1) - 1) / 2 + 0.5);
    for (int pass = 0; pass < 6; pass++) {
        memcpy(before, plane, sizeof before);
        for (int n = 0; n < COUNT; n++) {
            plane[n] = 0;
            for (int by = -reach; by <= reach; by++) {
                int x = within(n % WIDTH + (pass % 2 ? 0 : by), WIDTH);
                int y = within(n / WIDTH + (pass % 2 ? by : 0), HEIGHT);
                plane[n] += before[y * WIDTH + x] / (2 * reach + 1);
            }
        }
    }
}

/* --- depth darkening ------------------------------------------------------ */

/* What is left of the light of each pixel. */
static void left_by_depths(const reference_scene *scene, const float *depth,
                           double left[COUNT]) {
    static double filled[COUNT], mean[COUNT];
    static const double share[] = {1.0 / 128, 1.0 / 43};
    reference_camera camera;
    reference_camera_of(scene, &camera);
    double unit = HEIGHT * camera.pitch / 21, far = -INFINITY;
    for (int n = 0; n < COUNT; n++)
        far = fmax(far, (double)depth[n]);
    for (int n = 0; n < COUNT; n++) {
        filled[n] = isnan(depth[n]) ? far : (double)depth[n];
        left[n] = 0;
    }
    for (int i = 0; i < 2; i++) {
        memcpy(mean, filled, sizeof mean);
        smooth(mean, share[i] * HEIGHT);
        for (int n = 0; n < COUNT; n++)
            left[n] += fmin(fmax((filled[n] - mean[n]) / unit, 0), 3);
    }
    for (int n = 0; n < COUNT; n++)
        left[n] = isnan(depth[n]) ? 1 : fmax(1 - 0.9 * left[n], 0.35);
}

/* --- occlusion: a slow field ---------------------------------------------- */

/* Means of cells of opacities, and after them blurs of these. */
typedef struct field {
    int low[3], cell[3], dims[3];
    double spacing[3], deviation[2];
    double *blurred[2];
} field;

static double *cell_at(const field *f, double *cells, int x, int y, int z) {
    return &cells[((size_t)z * (size_t)f->dims[1] + (size_t)y) *
                      (size_t)f->dims[0] +
                  (size_t)x];
}

static double opacity_at(const reference_scene *scene, int x, int y, int z) {
    const int64_t at[] = {x, y, z};
    double rgba[4], gradient[3];
    double value = scene->info.slope * reference_native(scene, x, y, z) +
                   scene->info.intercept;
    if (scene->settings.mode == SNOW_MODE_ISO)
        return value >= scene->settings.iso;
    reference_classify(scene, value, rgba);
    if (scene->gradient_count) {
        reference_gradient(scene, at, gradient);
        rgba[3] *= reference_fade(scene, gradient);
    }
    return 255 * rgba[3] > scene->settings.threshold ? rgba[3] : 0;
}

/* The box of the voxels that are shown. */
static void bound(const reference_scene *scene, int low[3], int high[3]) {
    const int64_t *dims = scene->info.dims;
    for (int n = 0; n < 3; n++) {
        low[n] = INT32_MAX;
        high[n] = -1;
    }
    for (int n = 0; n < dims[0] * dims[1] * dims[2]; n++) {
        int at[] = {(int)(n % dims[0]), (int)(n / dims[0] % dims[1]),
                    (int)(n / dims[0] / dims[1])};
        if (opacity_at(scene, at[0], at[1], at[2]) > 0)
            for (int i = 0; i < 3; i++) {
                low[i] = at[i] < low[i] ? at[i] : low[i];
                high[i] = at[i] > high[i] ? at[i] : high[i];
            }
    }
}

static void take_means(const reference_scene *scene, const field *f,
                       const int high[3], double *cells) {
    double share = 1.0 / (f->cell[0] * f->cell[1] * f->cell[2]);
    double exponent = f->deviation[0] / reference_opacity_length(scene);
    for (int z = f->low[2]; z <= high[2]; z++)
        for (int y = f->low[1]; y <= high[1]; y++)
            for (int x = f->low[0]; x <= high[0]; x++)
                *cell_at(f, cells, (x - f->low[0]) / f->cell[0] + MARGIN,
                         (y - f->low[1]) / f->cell[1] + MARGIN,
                         (z - f->low[2]) / f->cell[2] + MARGIN) +=
                    share * (1 - pow(1 - opacity_at(scene, x, y, z), exponent));
}

/* One pass of three weights, `apart` cells apart; nothing is beyond the ends.
 */
static void pass(const field *f, double *cells, int axis, int apart, double w) {
    size_t count = (size_t)f->dims[0] * (size_t)f->dims[1] * (size_t)f->dims[2];
    double *before = malloc(count * sizeof *before);
    assert_non_null(before);
    memcpy(before, cells, count * sizeof *before);
    for (size_t n = 0; n < count; n++) {
        int at[] = {(int)n % f->dims[0], (int)n / f->dims[0] % f->dims[1],
                    (int)n / f->dims[0] / f->dims[1]};
        double beside = 0;
        for (int side = -apart; side <= apart; side += 2 * apart) {
            int there[] = {at[0], at[1], at[2]};
            there[axis] += side;
            if (there[axis] >= 0 && there[axis] < f->dims[axis])
                beside += *cell_at(f, before, there[0], there[1], there[2]);
        }
        cells[n] = (1 - 2 * w) * before[n] + w * beside;
    }
    free(before);
}

static void blur(const field *f, double *cells, int apart,
                 const double variance[3]) {
    double most = fmax(variance[0], fmax(variance[1], variance[2]));
    int passes = (int)ceil(most / (2.0 / 3 * apart * apart));
    for (int n = 0; n < passes; n++)
        for (int axis = 0; axis < 3; axis++)
            pass(f, cells, axis, apart,
                 variance[axis] / passes / (2 * apart * apart));
}

static field field_of(const reference_scene *scene) {
    field f;
    int high[3];
    double side = 0, variance[2][3];
    bound(scene, f.low, high);
    for (int n = 0; n < 3; n++) {
        f.spacing[n] = scene->info.spacing[n];
        side = fmax(side, (high[n] - f.low[n] + 1) * f.spacing[n]);
    }
    f.deviation[0] = side / 60;
    f.deviation[1] = side / 25;
    for (int n = 0; n < 3; n++) {
        f.cell[n] = (int)fmax(1, floor(side / 60 / f.spacing[n]));
        f.dims[n] = (high[n] - f.low[n]) / f.cell[n] + 1 + 2 * MARGIN;
        for (int i = 0; i < 2; i++) {
            double cells = f.deviation[i] / f.spacing[n] / f.cell[n];
            variance[i][n] = fmax(0, cells * cells - 5.0 / 12);
        }
        variance[1][n] -= variance[0][n];
    }
    size_t count = (size_t)f.dims[0] * (size_t)f.dims[1] * (size_t)f.dims[2];
    for (int i = 0; i < 2; i++) {
        f.blurred[i] = calloc(count, sizeof(double));
        assert_non_null(f.blurred[i]);
    }
    take_means(scene, &f, high, f.blurred[0]);
    blur(&f, f.blurred[0], 1, variance[0]);
    memcpy(f.blurred[1], f.blurred[0], count * sizeof(double));
    blur(&f, f.blurred[1], 2, variance[1]);
    return f;
}

static double spline(double x) {
    x = fabs(x);
    if (x < 1)
        return 2.0 / 3 - x * x + x * x * x / 2;
    return x < 2 ? pow(2 - x, 3) / 6 : 0;
}

static double value_at(const field *f, int i, const double voxel[3]) {
    double at[3], sum = 0;
    for (int n = 0; n < 3; n++) {
        at[n] = (voxel[n] + 0.5 - f->low[n]) / f->cell[n] - 0.5 + MARGIN;
        if (!(at[n] >= 2 && at[n] < f->dims[n] - 3))
            return 0;
    }
    int first[] = {(int)at[0] - 1, (int)at[1] - 1, (int)at[2] - 1};
    for (int n = 0; n < 64; n++) {
        int x = first[0] + n % 4, y = first[1] + n / 4 % 4,
            z = first[2] + n / 16;
        sum += spline(at[0] - x) * spline(at[1] - y) * spline(at[2] - z) *
               *cell_at(f, f->blurred[i], x, y, z);
    }
    return sum;
}

/* --- occlusion: factors --------------------------------------------------- */

/* `t` is where on the ray a pixel's depth lies, and `below` how far below a
 * surface that may be. */
static double open_at(const field *f, const reference_ray *ray, double t,
                      double below) {
    double at[3], toward[3], slope[3];
    double length = 0, steep = 0, dot = 0, open = 1;
    for (int n = 0; n < 3; n++) {
        at[n] = ray->start[n] + t * ray->step[n];
        toward[n] = -ray->step[n] * f->spacing[n];
        length += toward[n] * toward[n];
    }
    for (int n = 0; n < 3; n++) {
        double beside[] = {at[0], at[1], at[2]};
        toward[n] /= sqrt(length);
        beside[n] += 1e-4;
        slope[n] = value_at(f, 1, beside);
        beside[n] -= 2e-4;
        slope[n] = (slope[n] - value_at(f, 1, beside)) / f->spacing[n];
        steep += slope[n] * slope[n];
        dot += slope[n] * toward[n];
    }
    double facing = steep > 0 ? fabs(dot) / sqrt(steep) : 0;
    for (int i = 0; i < 2; i++) {
        double front[3];
        for (int n = 0; n < 3; n++)
            front[n] = at[n] + f->deviation[i] * toward[n] / f->spacing[n];
        double above = facing * fmax(0, 1 - below / f->deviation[i]);
        double flat = 0.5 + erf(above / sqrt(2.0)) / 2;
        open *= pow(fmin(1, (1 - value_at(f, i, front)) / (0.97 * flat)), 4);
    }
    return open;
}

/* What is left of the light of each pixel. */
static void left_by_occlusion(const reference_scene *scene, const float *depth,
                              const float *picture, double left[COUNT]) {
    reference_camera camera;
    field f = field_of(scene);
    reference_camera_of(scene, &camera);
    double middle[3];
    for (int n = 0; n < 3; n++)
        middle[n] = (double)(scene->info.dims[n] - 1) / 2;
    double below =
        reference_slice_step(scene, &camera,
                             reference_slice_axis(scene, &camera), middle) /
        2;
    for (int n = 0; n < COUNT; n++) {
        reference_ray ray =
            reference_ray_at(scene, &camera, n % WIDTH + 0.5, n / WIDTH + 0.5);
        double next[3], from = reference_behind(scene, &camera, ray.start);
        for (int i = 0; i < 3; i++)
            next[i] = ray.start[i] + ray.step[i];
        double cosine = reference_behind(scene, &camera, next) - from;
        left[n] =
            isnan(depth[n])
                ? 1
                : open_at(&f, &ray, ((double)depth[n] - from) / cosine, below);
    }
    smooth(left,
           fmin(f.spacing[0], fmin(f.spacing[1], f.spacing[2])) / camera.pitch);
    for (int n = 0; n < COUNT; n++) {
        double seen = fmin(fmax(2 * (double)picture[4 * n + 3] - 1, 0), 1);
        left[n] = 1 - 0.85 * seen * (1 - left[n]);
    }
    free(f.blurred[0]);
    free(f.blurred[1]);
}

/* --- pictures ------------------------------------------------------------- */

static const snow_opacity_point gentle[] = {{0, 0.8}, {20, 1}};
static const snow_opacity_point solid[] = {{50, 0}, {60, 0.9}, {200, 0.9}};

static reference_scene scene_of(int n) {
    reference_scene scene =
        model_scene((int64_t[]){n % 2 ? 130 : 70, 60, 50}, SNOW_TYPE_UINT8,
                    n % 3 == 2, (model_matrix)(n % MODEL_MATRICES), 3);
    scene.settings.method =
        n % 4 == 3 ? SNOW_METHOD_RAYCAST : SNOW_METHOD_SHEAR_WARP;
    scene.settings.mode = n % 5 == 4 ? SNOW_MODE_ISO : SNOW_MODE_OVER;
    scene.settings.iso = 71.3;
    scene.opacities = solid;
    scene.opacity_count = 3;
    scene.settings.threshold = n % 3 ? 0 : 20;
    scene.view.fov = n / 2 % 2 ? 30 : 0;
    scene.view.width = WIDTH;
    scene.view.height = HEIGHT;
    if (n % 4 == 1) {
        scene.gradients = gentle;
        scene.gradient_count = sizeof gentle / sizeof *gentle;
    }
    model_turn(&scene, 25, 35, 10, 1.6);
    return scene;
}

/* A darkened picture of a scene; the least light that is left of it. */
static double check_scene(reference_scene *scene, bool occludes,
                          double strength, bool keeps_depth) {
    static double left[COUNT];
    model_stage stage = model_open();
    snow_settings *settings = &scene->settings;
    double least = 1;
    settings->depth = true;
    float *plain = model_picture(&stage, scene);
    const float *depth = snow_frame_depth(stage.frame)->pixels;
    if (occludes)
        left_by_occlusion(scene, depth, plain, left);
    else
        left_by_depths(scene, depth, left);
    settings->depth = keeps_depth;
    *(occludes ? &settings->occlusion : &settings->depth_darkening) = strength;
    float *dark = model_picture(&stage, scene);
    for (int n = 0; n < COUNT; n++) {
        double factor = 1 - strength * (1 - left[n]);
        for (int c = 0; c < 3; c++)
            assert_near((double)dark[4 * n + c],
                        (double)plain[4 * n + c] * factor, 2e-4);
        assert_true(dark[4 * n + 3] == plain[4 * n + 3]);
        least = fmin(least, factor);
    }
    free(plain);
    free(dark);
    model_close(&stage);
    return least;
}

static void what_lies_behind_is_darker_by_the_formula(void **state) {
    (void)state;
    for (int n = 0; n < 12; n++) {
        if (!support_takes((size_t)n, 5))
            continue;
        reference_scene scene = scene_of(n);
        double least = check_scene(&scene, false, n % 2 ? 1 : 0.6, n % 4 < 2);
        if (!(least < 0.9))
            fail_msg("scene %d: %g at least", n, least);
        model_free(&scene);
    }
}

static void what_has_much_around_it_is_darker_by_the_formula(void **state) {
    double darkest = 1;
    int dark_scenes = 0;
    (void)state;
    for (int n = 0; n < 10; n++) {
        if (!support_takes((size_t)n, 3))
            continue;
        reference_scene scene = scene_of(n);
        double least = check_scene(&scene, true, n % 2 ? 1 : 0.6, n % 4 < 2);
        dark_scenes += least < 0.99;
        darkest = fmin(darkest, least);
        model_free(&scene);
    }
    assert_true((darkest < 0.5 && dark_scenes >= 3) || support_is_sanitized());
}

/* A block with a groove across it, seen obliquely. */
static reference_scene grooved(void) {
    reference_scene scene = model_blank((int64_t[]){120, 120, 60}, 1);
    float *voxels = model_voxels(&scene);
    for (int n = 0; n < 120 * 120 * 60; n++) {
        int x = n % 120, z = n / (120 * 120);
        voxels[n] = z < 50 && (z < 44 || x < 57 || x > 62);
    }
    scene.view.width = WIDTH;
    scene.view.height = HEIGHT;
    model_turn(&scene, 5, 10, 0, 3);
    return scene;
}

static void a_groove_is_dark_in_a_face_that_is_not(void **state) {
    model_stage *stage = *state;
    reference_scene scene = grooved();
    scene.settings.occlusion = 1;
    float *dark = model_picture(stage, &scene);
    const float *row = dark + (size_t)HEIGHT / 2 * WIDTH * 4;
    float least = 1;
    for (int x = WIDTH / 2 - 6; x < WIDTH / 2 + 7; x++)
        least = fminf(least, row[4 * x]);
    assert_true(least < 0.5F);
    for (int x = 0; x < 20; x++) {
        assert_near((double)row[4 * x], 1, 0.02);
        assert_near((double)row[4 * (WIDTH - 1 - x)], 1, 0.02);
    }
    free(dark);
    model_free(&scene);
}

static void nothing_is_not_darkened(void **state) {
    model_stage *stage = *state;
    reference_scene scene = grooved();
    memset(model_voxels(&scene), 0, 120 * 120 * 60 * sizeof(float));
    scene.settings.occlusion = 1;
    float *dark = model_picture(stage, &scene);
    for (int n = 0; n < COUNT * 4; n++)
        assert_true(dark[n] == 0);
    free(dark);
    model_free(&scene);
}

/* By depths and by occlusion: both. */
static void threads_darken_alike(void **state) {
    model_stage *stage = *state;
    reference_scene scene = scene_of(0);
    scene.settings.depth_darkening = scene.settings.occlusion = 1;
    scene.settings.threads = 1;
    float *one = model_picture(stage, &scene);
    scene.settings.threads = 3;
    float *three = model_picture(stage, &scene);
    assert_memory_equal(one, three, COUNT * 4 * sizeof *one);
    free(one);
    free(three);
    model_free(&scene);
}

static void projections_have_nothing_behind(void **state) {
    model_stage *stage = *state;
    reference_scene scene = scene_of(0);
    scene.settings.mode = SNOW_MODE_MIP;
    float *plain = model_picture(stage, &scene);
    scene.settings.depth_darkening = scene.settings.occlusion = 1;
    float *dark = model_picture(stage, &scene);
    assert_memory_equal(plain, dark, COUNT * 4 * sizeof *plain);
    free(plain);
    free(dark);
    model_free(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_lies_behind_is_darker_by_the_formula),
        cmocka_unit_test(what_has_much_around_it_is_darker_by_the_formula),
        MODEL_TEST(a_groove_is_dark_in_a_face_that_is_not),
        MODEL_TEST(nothing_is_not_darkened),
        MODEL_TEST(threads_darken_alike),
        MODEL_TEST(projections_have_nothing_behind),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
