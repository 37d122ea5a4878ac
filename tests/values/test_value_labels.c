/* tests/values/test_value_labels.c - method shear-warp with volumes of labels,
 * beside the float64 reference of the value model. */
#include "values/pictures.h"

#include <stdlib.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const snow_color_point colors[] = {
    {0.5, 0, 0, 0},     {0.5, 1, 0.2, 0.1}, {1.5, 1, 0.2, 0.1},
    {1.5, 0.1, 0.9, 0}, {2.5, 0.1, 0.9, 0}, {2.5, 0.2, 0.3, 1},
    {4, 0.2, 0.3, 1},   {4, 1, 1, 0.5}};
static const snow_opacity_point solid[] = {{0.5, 0}, {0.5, 1}};
static const snow_opacity_point clear[] = {{0.5, 0}, {0.5, 0.1}, {1.5, 0.1},
                                           {1.5, 0}, {2.5, 0},   {2.5, 0.4}};
static const snow_opacity_point all[] = {{0.5, 0.05}, {0.5, 0.3}};
static const snow_opacity_point faint[] = {
    {0.5, 0}, {0.5, 1e-5}, {1.5, 1e-5}, {1.5, 3e-4}};
static const snow_opacity_point curve[] = {{0, 0.2}, {0.2, 1}};

static value_scene labelled(int n) {
    static const struct {
        const snow_opacity_point *points;
        size_t count;
    } looks[] = {
        {solid, COUNT(solid)}, {clear, COUNT(clear)}, {all, COUNT(all)}};
    value_scene scene = {.base = value_picture_scene(n), .labels = true};
    value_picture_name(&scene.base);
    scene.base.colors = colors;
    scene.base.color_count = COUNT(colors);
    scene.base.opacities = looks[n / 2 % 3].points;
    scene.base.opacity_count = looks[n / 2 % 3].count;
    if (n / 8 % 2 == 1)
        scene.base.view.fov = 45;
    if (n % 7 == 3) {
        scene.base.gradients = curve;
        scene.base.gradient_count = COUNT(curve);
    }
    return scene;
}

/* Floats are no labels. */
static bool has_labels(int n) {
    return n % 5 != 2;
}

static void pictures_are_the_references(void **state) {
    (void)state;
    model_stage stage = model_open();
    for (int n = (int)support_sweep(1, 10); n < VALUE_PICTURES;
         n += 8 * (int)support_stride(10)) {
        value_scene scene;
        if (!has_labels(n))
            continue;
        scene = labelled(n);
        value_picture_check(&stage, n, &scene);
        value_picture_free(&scene.base);
    }
    model_close(&stage);
}

/* All of a label's slabs have one alpha: what rounding it takes away adds up.
 */
static void faint_labels_are_the_references(void **state) {
    (void)state;
    model_stage stage = model_open();
    for (int n = 4; n < VALUE_PICTURES; n += 17 * (int)support_stride(17)) {
        if (!has_labels(n))
            continue;
        value_scene scene = labelled(n);
        scene.base.settings.threshold = 0;
        scene.base.opacities = faint;
        scene.base.opacity_count = COUNT(faint);
        value_picture_check_faint(&stage, n, &scene);
        value_picture_free(&scene.base);
    }
    model_close(&stage);
}

static void bits_are_the_same(void **state) {
    (void)state;
    model_stage stage = model_open();
    for (int n = 3; n < VALUE_PICTURES; n += 23 * (int)support_stride(17)) {
        value_scene scene;
        if (!has_labels(n))
            continue;
        scene = labelled(n);
        value_picture_check_bits(&stage, n, &scene);
        value_picture_free(&scene.base);
    }
    model_close(&stage);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_are_the_references),
        cmocka_unit_test(faint_labels_are_the_references),
        cmocka_unit_test(bits_are_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
