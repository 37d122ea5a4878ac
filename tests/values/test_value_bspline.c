/* tests/values/test_value_bspline.c - method shear-warp with kernel bspline,
 * beside the float64 reference of the value model. */
#include "values/pictures.h"

static value_scene smoothed(int n) {
    value_scene scene = {.base = value_picture_scene(n), .cubic = true};
    scene.base.settings.kernel = SNOW_KERNEL_BSPLINE;
    scene.base.settings.footprint = 4;
    if (n / 8 % 2)
        scene.base.view.fov = 45;
    return scene;
}

static void pictures_are_the_references(void **state) {
    (void)state;
    value_pictures_check((int)support_sweep(3, 59), 8 * (int)support_stride(25),
                         smoothed);
}

static value_scene punched(int n) {
    value_scene scene = smoothed(n);
    value_picture_punch(&scene.base, n);
    return scene;
}

/* Also where holes leave less than all weights. */
static void holes_are_the_references(void **state) {
    (void)state;
    value_pictures_check(2, 15 * (int)support_stride(25), punched);
}

static void bits_are_the_same(void **state) {
    (void)state;
    value_pictures_check_bits(4, 23 * (int)support_stride(17), smoothed);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_are_the_references),
        cmocka_unit_test(holes_are_the_references),
        cmocka_unit_test(bits_are_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
