/* tests/values/test_value_faint.c - method shear-warp with looks of which each
 * slab shows next to nothing, beside the float64 reference of the value model.
 */
#include "values/pictures.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const snow_opacity_point fog[] = {{0, 0}, {100, 0.002}};
static const snow_opacity_point thin[] = {{0, 3e-7}, {50, 1e-6}, {90, 0}};
static const snow_opacity_point band[] = {{40, 0}, {60, 1e-4}, {70, 0}};
static const snow_opacity_point curve[] = {{0, 0.2}, {10, 1}};

static value_scene faint(int n) {
    static const struct {
        const snow_opacity_point *points;
        size_t count;
    } looks[] = {{fog, COUNT(fog)}, {thin, COUNT(thin)}, {band, COUNT(band)}};
    value_scene scene = {.base = value_picture_scene(n)};
    scene.base.settings.threshold = 0;
    scene.base.opacities = looks[n % 3].points;
    scene.base.opacity_count = looks[n % 3].count;
    if (n / 3 % 3 == 1) {
        scene.base.gradients = curve;
        scene.base.gradient_count = COUNT(curve);
    }
    if (n % 2)
        scene.base.view.fov = 40;
    return scene;
}

static void pictures_are_the_references(void **state) {
    (void)state;
    model_stage stage = model_open();
    for (int n = 2; n < VALUE_PICTURES; n += 7 * (int)support_stride(23)) {
        value_scene scene = faint(n);
        value_picture_check_faint(&stage, n, &scene);
        value_picture_free(&scene.base);
    }
    model_close(&stage);
}

static void bits_are_the_same(void **state) {
    (void)state;
    model_stage stage = model_open();
    for (int n = 3; n < VALUE_PICTURES; n += 23 * (int)support_stride(6)) {
        value_scene scene = faint(n);
        double planes[2][4];
        if (scene.base.view.fov == 0)
            value_picture_clip(&scene, 1, planes);
        value_picture_check_bits(&stage, n, &scene);
        value_picture_free(&scene.base);
    }
    model_close(&stage);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_are_the_references),
        cmocka_unit_test(bits_are_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
