/* tests/values/test_value_fade.c - method shear-warp with gradient opacity,
 * beside the float64 reference of the value model. */
#include "values/pictures.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const snow_opacity_point curve[] = {{0, 0}, {1, 0.05}, {15, 0.9}};
static const snow_opacity_point narrow[] = {{3, 1}, {6, 0.2}, {9, 0}};

/* Scenes with and without light, of all spacings, one in three logarithmic. */
static value_scene faded(int n) {
    static const snow_opacity_point decades[] = {{1, 0}, {20, 0.3}, {90, 0.8}};
    value_scene scene = {.base = value_picture_scene(n)};
    scene.base.gradients = n % 2 ? curve : narrow;
    scene.base.gradient_count = n % 2 ? COUNT(curve) : COUNT(narrow);
    if (n % 3 == 2) {
        scene.base.log = true;
        scene.base.opacities = decades;
        scene.base.opacity_count = COUNT(decades);
    }
    return scene;
}

static void pictures_are_the_references(void **state) {
    (void)state;
    value_pictures_check(1, 7 * (int)support_stride(29), faded);
}

/* A cut takes a part of the length, and the gradient is that of the field. */
static void cut_slabs_are_the_references(void **state) {
    (void)state;
    model_stage stage = model_open();
    for (int n = 0; n < VALUE_PICTURES; n += 17 * (int)support_stride(6)) {
        value_scene scene = faded(n);
        double planes[2][4];
        value_picture_clip(&scene, 2, planes);
        value_picture_check(&stage, n, &scene);
        value_picture_free(&scene.base);
    }
    model_close(&stage);
}

static void bits_are_the_same(void **state) {
    (void)state;
    value_pictures_check_bits(3, 19 * (int)support_stride(6), faded);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_are_the_references),
        cmocka_unit_test(cut_slabs_are_the_references),
        cmocka_unit_test(bits_are_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
