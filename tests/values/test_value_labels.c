/* tests/values/test_value_labels.c - method shear-warp with volumes of labels,
 * beside the float64 reference of the value model. */
#include "values/pictures.h"

#include <math.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const snow_color_point colors[] = {
    {0.5, 0, 0, 0},     {0.5, 1, 0.2, 0.1}, {1.5, 1, 0.2, 0.1},
    {1.5, 0.1, 0.9, 0}, {2.5, 0.1, 0.9, 0}, {2.5, 0.2, 0.3, 1},
    {4, 0.2, 0.3, 1},   {4, 1, 1, 0.5}};
static const snow_opacity_point solid[] = {{0.5, 0}, {0.5, 1}};
static const snow_opacity_point clear[] = {{0.5, 0}, {0.5, 0.1}, {1.5, 0.1},
                                           {1.5, 0}, {2.5, 0},   {2.5, 0.4}};
static const snow_opacity_point all[] = {{0.5, 0.05}, {0.5, 0.3}};
static const snow_opacity_point curve[] = {{0, 0.2}, {1, 1}};

static void set_native(const reference_scene *s, size_t at, double native) {
    void *voxels = (void *)(uintptr_t)s->voxels;
    switch (s->info.type) {
#define STORE(name, type, text)              \
    case SNOW_TYPE_##name:                   \
        ((type *)voxels)[at] = (type)native; \
        break;
        SNOW_TYPE_MAP(STORE)
#undef STORE
    case SNOW_TYPE_NONE:
        break;
    }
}

/* Layers of the scene's structure have a label each. */
static void name_layers(const reference_scene *s) {
    static const double labels[] = {0, 1, 2, 3, 5};
    const int64_t *dims = s->info.dims;
    size_t at = 0;
    for (int64_t k = 0; k < dims[2]; k++)
        for (int64_t j = 0; j < dims[1]; j++)
            for (int64_t i = 0; i < dims[0]; i++, at++) {
                double value = s->info.slope * reference_native(s, i, j, k) +
                               s->info.intercept;
                double layer = fmin(fmax(floor((value - 20) / 15), 0), 4);
                set_native(s, at,
                           (labels[(int)layer] - s->info.intercept) /
                               s->info.slope);
            }
}

static value_scene labelled(int n) {
    static const struct {
        const snow_opacity_point *points;
        size_t count;
    } looks[] = {
        {solid, COUNT(solid)}, {clear, COUNT(clear)}, {all, COUNT(all)}};
    value_scene scene = {.base = value_picture_scene(n), .labels = true};
    name_layers(&scene.base);
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

static void bits_are_the_same(void **state) {
    (void)state;
    model_stage stage = model_open();
    for (int n = 3; n < VALUE_PICTURES; n += 23 * (int)support_stride(8)) {
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
        cmocka_unit_test(bits_are_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
