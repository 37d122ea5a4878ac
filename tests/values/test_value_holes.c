/* tests/values/test_value_holes.c - method shear-warp where voxels have no
 * value or are cut off, beside the float64 reference of the value model. */
#include <math.h>

#include "values/pictures.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* Scenes of floats are every fifth. */
#define FLOATS(k) (5 * (k) + 2)
#define SCENES 36

static void holes_are_the_references(void **state) {
    (void)state;
    model_stage stage = model_open();
    for (int k = (int)support_sweep(0, 10); k < SCENES;
         k += (int)support_stride(37)) {
        int n = FLOATS(k);
        value_scene scene = {.base = value_picture_scene(n)};
        value_picture_punch(&scene.base, k);
        value_picture_check(&stage, n, &scene);
        value_picture_free(&scene.base);
    }
    model_close(&stage);
}

static void clip_planes_are_the_references(void **state) {
    (void)state;
    model_stage stage = model_open();
    for (int n = 1; n < VALUE_PICTURES; n += 7 * (int)support_stride(9)) {
        value_scene scene = {.base = value_picture_scene(n)};
        double planes[2][4];
        value_picture_clip(&scene, n % 2 ? 2 : 1, planes);
        value_picture_check(&stage, n, &scene);
        value_picture_free(&scene.base);
    }
    model_close(&stage);
}

static value_scene logarithmic(int n) {
    static const snow_opacity_point decades[] = {
        {1, 0}, {4, 0.02}, {20, 0.3}, {20, 0.1}, {90, 0.8}};
    static const snow_opacity_point everything[] = {{1, 0.1}, {100, 0.5}};
    value_scene scene = {.base = value_picture_scene(n)};
    scene.base.log = true;
    scene.base.opacities = n % 3 ? decades : everything;
    scene.base.opacity_count = n % 3 ? COUNT(decades) : COUNT(everything);
    return scene;
}

static void logarithmic_looks_are_the_references(void **state) {
    (void)state;
    value_pictures_check(0, 11 * (int)support_stride(9), logarithmic);
}

static void bits_are_the_same(void **state) {
    (void)state;
    model_stage stage = model_open();
    for (int k = 0; k < SCENES; k += 2 * (int)support_stride(9)) {
        int n = FLOATS(k);
        value_scene scene = {.base = value_picture_scene(n)};
        const double plane[1][4] = {{0.3, 0.5, 0.2, 12}};
        value_picture_punch(&scene.base, k);
        scene.clips = plane;
        scene.clip_count = 1;
        value_picture_check_bits(&stage, n, &scene);
        value_picture_free(&scene.base);
    }
    model_close(&stage);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(holes_are_the_references),
        cmocka_unit_test(clip_planes_are_the_references),
        cmocka_unit_test(logarithmic_looks_are_the_references),
        cmocka_unit_test(bits_are_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
