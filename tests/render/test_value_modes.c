/* tests/render/test_value_modes.c - modes other than over by method shear-warp
 * beside the float64 reference of the value model. */
#include "values/pictures.h"

#include <math.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const snow_mode modes[] = {SNOW_MODE_MIP, SNOW_MODE_MINIP,
                                  SNOW_MODE_MEAN, SNOW_MODE_SUM};

/* The scenes of the parallel test in all modes, half of them from an eye. */
static value_scene projected(int n) {
    static const double fovs[] = {0, 45, 0, 20, 0, 70};
    value_scene scene = {.base = value_picture_scene(n)};
    scene.base.settings.mode = modes[(size_t)(n + n / 7) % COUNT(modes)];
    scene.base.view.fov = fovs[(size_t)n / 3 % COUNT(fovs)];
    scene.cubic = n % 11 == 4;
    if (scene.cubic)
        scene.base.settings.footprint = 4;
    return scene;
}

/* The same with a surface at a value, some of which are beyond the data. */
static value_scene surface(int n) {
    value_scene scene = projected(n);
    scene.base.settings.mode = SNOW_MODE_ISO;
    scene.base.settings.iso = n % 9 == 8 ? -500 + n * 8 : 30 + n * 17 % 50;
    return scene;
}

static value_scene punched_surface(int n) {
    value_scene scene = surface(n);
    value_picture_punch(&scene.base, n);
    return scene;
}

static value_scene punched(int n) {
    value_scene scene = projected(n);
    value_picture_punch(&scene.base, n);
    return scene;
}

static void projections_are_the_references(void **state) {
    (void)state;
    value_pictures_check(0, (int)support_stride(11), projected);
}

static void surfaces_are_the_references(void **state) {
    (void)state;
    value_pictures_check(0, (int)support_stride(11), surface);
    value_pictures_check(2, 5 * (int)support_stride(11), punched_surface);
}

static void holes_are_the_references(void **state) {
    (void)state;
    value_pictures_check(2, 5 * (int)support_stride(11), punched);
}

static void clip_planes_are_the_references(void **state) {
    (void)state;
    model_stage stage = model_open();
    for (int n = 0; n < VALUE_PICTURES; n += 4 * (int)support_stride(13)) {
        value_scene scene = n % 3 ? projected(n) : surface(n);
        double planes[2][4];
        value_picture_clip(&scene, n % 2 ? 2 : 1, planes);
        value_picture_check(&stage, n, &scene);
        value_picture_free(&scene.base);
    }
    model_close(&stage);
}

static void nothing_changes_a_bit(void **state) {
    (void)state;
    value_pictures_check_bits(1, 3 * (int)support_stride(23), projected);
    value_pictures_check_bits(2, 7 * (int)support_stride(23), surface);
    value_pictures_check_bits(2, 15 * (int)support_stride(23), punched);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(projections_are_the_references),
        cmocka_unit_test(surfaces_are_the_references),
        cmocka_unit_test(holes_are_the_references),
        cmocka_unit_test(clip_planes_are_the_references),
        cmocka_unit_test(nothing_changes_a_bit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
