/* tests/shear_warp/test_truth_edges.c - method shear-warp beside method raycast
 * where fields or looks have edges: surfaces, holes, labels, noise.
 *
 * There neither is sharp, and few pixels decide.  So the scenes are fixed, and
 * the decibels of each are what they were when it was written, less 0.3. */
#include "shear_warp/formulas.h"
#include "shear_warp/smooth.h"
#include "shear_warp/truth.h"

#include <math.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))
#define SLACK 0.3

static const int64_t dims[3] = {30, 28, 32};

static double soft_ball(const double at[3]) {
    double x = at[0] - 14.2, y = at[1] - 13.6, z = at[2] - 15.9;
    return 128 + 12 * (9 - sqrt(x * x + y * y + z * z));
}

static double layers(const double at[3]) {
    return fmin(fmax(floor((soft_ball(at) - 110) / 40), 0), 3);
}

static warp_scene ball_scene(void) {
    static const snow_color_point tints[] = {{100, 0.9, 0.5, 0.3},
                                             {200, 0.4, 0.6, 1}};
    static const snow_opacity_point ramp[] = {{110, 0}, {200, 0.3}};
    warp_scene scene = formula_scene(dims, soft_ball, 1);
    scene.base.opacities = ramp;
    scene.base.opacity_count = COUNT(ramp);
    scene.base.colors = tints;
    scene.base.color_count = COUNT(tints);
    scene.base.settings.shade = SNOW_SHADE_PHONG;
    scene.base.settings.quality = SNOW_QUALITY_HIGH;
    scene.base.view.width = 80;
    scene.base.view.height = 72;
    formula_scene_look(&scene, 2, 20, 25, 0);
    scene.base.view.zoom = 1.4;
    return scene;
}

/* --- surfaces ------------------------------------------------------------- */

static void show_step(warp_scene *scene) {
    static const snow_opacity_point edge[] = {{128, 0}, {128, 1}};
    scene->base.opacities = edge;
    scene->base.opacity_count = COUNT(edge);
}

static warp_scene sphere(void) {
    warp_scene scene = ball_scene();
    show_step(&scene);
    return scene;
}

static warp_scene sphere_normally(void) {
    warp_scene scene = sphere();
    scene.base.settings.quality = SNOW_QUALITY_NORMAL;
    scene.base.settings.light = SNOW_LIGHT_KEY;
    return scene;
}

static warp_scene sphere_from_an_eye(void) {
    warp_scene scene = sphere();
    formula_scene_look(&scene, 1, -30, 15, 40);
    return scene;
}

static warp_scene isosurface(void) {
    warp_scene scene = ball_scene();
    scene.base.settings.mode = SNOW_MODE_ISO;
    scene.base.settings.iso = 140;
    return scene;
}

static warp_scene threshold(void) {
    warp_scene scene = ball_scene();
    scene.base.settings.threshold = 20;
    return scene;
}

static warp_scene cut_block(void) {
    warp_scene scene = ball_scene();
    static const snow_opacity_point all[] = {{0, 0.6}};
    scene.base.opacities = all;
    scene.base.opacity_count = 1;
    warp_scene_cut(&scene, 2);
    return scene;
}

static warp_scene thick_slices(void) {
    warp_scene scene = ball_scene();
    formula_scene_space(&scene, (double[]){1, 1, 6});
    return scene;
}

static warp_scene a_far_value(void) {
    static const snow_opacity_point to_the_end[] = {{110, 0}, {200, 0.5}};
    warp_scene scene = ball_scene();
    scene.base.opacities = to_the_end;
    model_voxels(&scene.base)[0] = 3e38F;
    return scene;
}

/* --- holes ---------------------------------------------------------------- */

static warp_scene bitten(void) {
    warp_scene scene = ball_scene();
    float *voxel = model_voxels(&scene.base);
    for (int64_t k = 0; k < dims[2]; k++)
        for (int64_t j = 0; j < dims[1]; j++)
            for (int64_t i = 0; i < dims[0]; i++, voxel++)
                if (i + j / 2 + k > 38)
                    *voxel = NAN;
    return scene;
}

static warp_scene bitten_by_a_mask(void) {
    warp_scene scene = bitten();
    scene.base.masked = true;
    return scene;
}

static warp_scene bitten_from_an_eye(void) {
    warp_scene scene = bitten_by_a_mask();
    formula_scene_look(&scene, 0, 25, -20, 35);
    return scene;
}

static warp_scene bitten_splines(void) {
    warp_scene scene = bitten();
    scene.base.settings.kernel = SNOW_KERNEL_BSPLINE;
    scene.base.settings.footprint = 4;
    return scene;
}

static warp_scene bitten_mip(void) {
    static const snow_color_point grey[] = {{0, 0, 0, 0}, {240, 1, 1, 1}};
    warp_scene scene = bitten();
    scene.base.settings.mode = SNOW_MODE_MIP;
    scene.base.colors = grey;
    return scene;
}

static warp_scene bitten_surface(void) {
    warp_scene scene = bitten_by_a_mask();
    scene.base.settings.mode = SNOW_MODE_ISO;
    scene.base.settings.iso = 140;
    return scene;
}

/* --- labels --------------------------------------------------------------- */

static const snow_color_point names[] = {{0.5, 0, 0, 0},     {0.5, 1, 0.2, 0.1},
                                         {1.5, 1, 0.2, 0.1}, {1.5, 0.1, 0.9, 0},
                                         {2.5, 0.1, 0.9, 0}, {2.5, 0.2, 0.3, 1},
                                         {4, 0.2, 0.3, 1},   {4, 1, 1, 0.5}};

static warp_scene labels_of(const snow_opacity_point *opacities, size_t count) {
    warp_scene scene = ball_scene();
    int8_t *bytes = (int8_t *)(uintptr_t)scene.base.voxels;
    for (int64_t at = 0; at < dims[0] * dims[1] * dims[2]; at++) {
        double index[] = {(double)(at % dims[0]),
                          (double)(at / dims[0] % dims[1]),
                          (double)(at / dims[0] / dims[1])};
        bytes[at] = (int8_t)layers(index);
    }
    scene.base.info.type = SNOW_TYPE_INT8;
    scene.base.colors = names;
    scene.base.color_count = COUNT(names);
    scene.base.opacities = opacities;
    scene.base.opacity_count = count;
    return scene;
}

static const snow_opacity_point solid[] = {{0.5, 0}, {0.5, 1}};
static const snow_opacity_point clear[] = {
    {0.5, 0}, {0.5, 0.05}, {1.5, 0.05}, {1.5, 0.15}, {2.5, 0.15}, {2.5, 0.5}};

static warp_scene opaque_labels(void) {
    return labels_of(solid, COUNT(solid));
}

static warp_scene clear_labels(void) {
    return labels_of(clear, COUNT(clear));
}

static warp_scene labels_from_an_eye(void) {
    static const snow_opacity_point curve[] = {{0, 0.2}, {0.2, 1}};
    warp_scene scene = labels_of(clear, COUNT(clear));
    formula_scene_look(&scene, 1, 25, -20, 35);
    scene.base.gradients = curve;
    scene.base.gradient_count = COUNT(curve);
    return scene;
}

/* --- noise ---------------------------------------------------------------- */

static warp_scene noisy(int n, snow_quality quality) {
    warp_scene scene = noisy_scene(n);
    scene.base.settings.quality = quality;
    scene.base.view.zoom = 1.2;
    return scene;
}

static warp_scene noise(void) {
    return noisy(0, SNOW_QUALITY_HIGH);
}

static warp_scene noise_of_words(void) {
    return noisy(6, SNOW_QUALITY_NORMAL);
}

static warp_scene noise_with_a_steep_look(void) {
    return noisy(22, SNOW_QUALITY_HIGH);
}

/* -------------------------------------------------------------------------- */

static void edges_are_as_near_the_truth_as_they_were(void **state) {
    static const struct {
        const char *name;
        warp_scene (*make)(void);
        double decibels;
    } scenes[] = {
        {"sphere", sphere, 37.70},
        {"sphere, normal", sphere_normally, 33.11},
        {"sphere, perspective", sphere_from_an_eye, 41.11},
        {"isosurface", isosurface, 36.82},
        {"threshold", threshold, 55.39},
        {"cut block", cut_block, 43.39},
        {"thick slices", thick_slices, 48.39},
        {"far value", a_far_value, 47.95},
        {"holes", bitten, 46.08},
        {"mask", bitten_by_a_mask, 37.25},
        {"mask, perspective", bitten_from_an_eye, 42.82},
        {"holes, B-spline", bitten_splines, 44.96},
        {"holes, mip", bitten_mip, 44.37},
        {"mask, isosurface", bitten_surface, 23.85},
        {"labels, opaque", opaque_labels, 35.59},
        {"labels, translucent", clear_labels, 51.87},
        {"labels, perspective", labels_from_an_eye, 54.17},
        {"noise", noise, 39.09},
        {"noise of words", noise_of_words, 31.72},
        {"noise, steep look", noise_with_a_steep_look, 31.75},
    };
    model_stage *stage = *state;
    for (size_t n = 0; n < COUNT(scenes); n += support_stride(3)) {
        warp_scene scene = scenes[n].make();
        closeness found = closeness_of(stage, &scene);
        print_message("%-24s %5.2f dB\n", scenes[n].name, found.decibels);
        assert_true(found.pixels > 100);
        if (!(found.decibels >= scenes[n].decibels - SLACK))
            fail_msg("%s: %.2f dB, not %.2f", scenes[n].name, found.decibels,
                     scenes[n].decibels);
        warp_scene_free(&scene);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        MODEL_TEST(edges_are_as_near_the_truth_as_they_were),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
