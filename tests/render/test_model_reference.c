/* tests/render/test_model_reference.c - the reference obeys the model's own
 * rules.
 *
 * What everything else is held against is itself held against closed forms
 * that need no renderer: laws of the kernel, of the constant volume, of the
 * single voxel, of turned data. */
#include "reference/model.h"

#include <math.h>

static const snow_kernel kernels[] = {SNOW_KERNEL_BSPLINE, SNOW_KERNEL_TENT,
                                      SNOW_KERNEL_GAUSS, SNOW_KERNEL_BOX};

static void kernels_have_the_shapes_of_their_names(void **state) {
    (void)state;
    /* Values of the linear, quadratic and cubic B-spline from their closed
     * forms. */
    assert_near(reference_kernel(SNOW_KERNEL_BSPLINE, 2, 1, 0.25), 0.75, 1e-12);
    assert_near(reference_kernel(SNOW_KERNEL_BSPLINE, 3, 1, 0.5), 0.5, 1e-12);
    assert_near(reference_kernel(SNOW_KERNEL_BSPLINE, 3, 1, 0), 0.75, 1e-12);
    assert_near(reference_kernel(SNOW_KERNEL_BSPLINE, 4, 1, 0), 2.0 / 3, 1e-12);
    assert_near(reference_kernel(SNOW_KERNEL_BSPLINE, 4, 1, -1), 1.0 / 6,
                1e-12);
    assert_near(reference_kernel(SNOW_KERNEL_TENT, 4, 1, -1), 0.5, 1e-12);
    assert_near(reference_kernel(SNOW_KERNEL_GAUSS, 4, 1, 0.5), exp(-0.5),
                1e-12);
    assert_true(reference_kernel(SNOW_KERNEL_BOX, 3, 1, -1.5) == 1);
    assert_true(reference_kernel(SNOW_KERNEL_BOX, 3, 1, 1.5) == 0);
}

static double moment(snow_kernel kernel, int support, int power) {
    double sum = 0, step = 1 / 512.0;
    for (double t = -5 + step / 2; t < 5; t += step)
        sum += step * pow(t, power) * reference_kernel(kernel, support, 1, t);
    return sum;
}

static void widening_adds_the_variance_of_a_pixel(void **state) {
    (void)state;
    for (int n = 0; n < 4; n++)
        for (int support = 2; support <= 9; support++) {
            double variance =
                moment(kernels[n], support, 2) / moment(kernels[n], support, 0);
            double w = reference_widening(kernels[n], support, 3);
            /* The model takes Gauss' variance without its cut: 0.13 % more. */
            assert_near(w * w * variance / (variance + (9 - 1) / 12.0), 1,
                        2e-3);
            assert_true(reference_widening(kernels[n], support, 0.5) == 1);
        }
}

static void weights_add_up_to_one_anywhere_inside(void **state) {
    (void)state;
    double weights[64];
    for (int n = 0; n < 4; n++)
        for (int support = 2; support <= 9; support++)
            for (double u = 30; u < 31; u += 0.0625) {
                int64_t first, last;
                double sum = 0, w = 1 + 2 * (u - 30);
                reference_weights(kernels[n], support, w, u, 64, weights,
                                  &first, &last);
                for (int64_t i = first; i <= last; i++)
                    sum += weights[i];
                assert_near(sum, 1, 1e-12);
            }
}

static void a_constant_volume_has_the_opacity_of_its_slices(void **state) {
    (void)state;
    reference_scene scene = model_blank((int64_t[]){12, 13, 5}, 0.3);
    for (int n = 0; n < 12 * 13 * 5; n++)
        model_voxels(&scene)[n] = 1;
    double *picture = reference_render(&scene);
    double alpha = picture[4 * (24 * 64 + 32) + 3];
    assert_near(alpha, 1 - pow(0.7, 5), 1e-12);
    free(picture);
    model_free(&scene);
}

static void front_to_back_equals_back_to_front(void **state) {
    (void)state;
    reference_scene scene = model_scene((int64_t[]){9, 12, 7}, SNOW_TYPE_UINT8,
                                        false, MODEL_OBLIQUE, 3);
    model_turn(&scene, 30, 20, 10, 1);
    double *front = reference_render(&scene);
    double *back = reference_render_back_to_front(&scene);
    for (int n = 0; n < 64 * 48 * 4; n++)
        assert_near(front[n], back[n], 1e-13);
    free(front);
    free(back);
    model_free(&scene);
}

/* The sum of a picture's alpha over that of a single opaque voxel, in voxels:
 * the share of the voxel's projected area. */
static double area_of_one_voxel(reference_scene *scene, int at) {
    model_voxels(scene)[at] = 1;
    double *picture = reference_render(scene), sum = 0;
    for (int n = 0; n < scene->view.width * scene->view.height; n++)
        sum += picture[4 * n + 3];
    free(picture);
    model_voxels(scene)[at] = 0;
    return sum;
}

static void a_voxel_weighs_its_projected_area_in_the_mean(void **state) {
    (void)state;
    reference_scene scene = model_blank((int64_t[]){20, 20, 1}, 1);
    reference_camera camera;
    model_turn(&scene, 30, 20, 5, 1);
    reference_camera_of(&scene, &camera);
    double sum = 0, area = camera.back[2] / (camera.pitch * camera.pitch);
    for (int j = 6; j < 14; j++)
        for (int i = 6; i < 14; i++)
            sum += area_of_one_voxel(&scene, 20 * j + i) / 64;
    assert_near(sum / area, 1, 1e-3);
    model_free(&scene);
}

static void the_nearest_voxel_lies_in_front(void **state) {
    (void)state;
    /* Two opaque voxels in a row along +z, of different brightness. */
    reference_scene scene = model_blank((int64_t[]){5, 5, 5}, 1);
    const snow_color_point colors[] = {{1, 1, 0, 0}, {2, 0, 1, 0}};
    scene.colors = colors;
    scene.color_count = 2;
    model_voxels(&scene)[12] = 1;
    model_voxels(&scene)[12 + 100] = 2;
    scene.settings.kernel = SNOW_KERNEL_BOX;
    scene.view.width = scene.view.height = 1;
    scene.view.zoom = 100;
    double *picture = reference_render(&scene);
    /* The box of 2 x 2 leaves a quarter of each at its own place. */
    assert_near(picture[1], 0.25, 1e-12);
    assert_near(picture[0], 0.75 * 0.25, 1e-12);
    free(picture);
    model_free(&scene);
}

static void the_ray_caster_absorbs_like_the_exponential_law(void **state) {
    (void)state;
    reference_scene scene = model_blank((int64_t[]){6, 7, 8}, 0.2);
    for (int n = 0; n < 6 * 7 * 8; n++)
        model_voxels(&scene)[n] = 1;
    double *picture = reference_raycast(&scene);
    assert_near(picture[4 * (24 * 64 + 32) + 3], 1 - pow(0.8, 7), 1e-9);
    free(picture);
    model_free(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(kernels_have_the_shapes_of_their_names),
        cmocka_unit_test(widening_adds_the_variance_of_a_pixel),
        cmocka_unit_test(weights_add_up_to_one_anywhere_inside),
        cmocka_unit_test(a_constant_volume_has_the_opacity_of_its_slices),
        cmocka_unit_test(front_to_back_equals_back_to_front),
        cmocka_unit_test(a_voxel_weighs_its_projected_area_in_the_mean),
        cmocka_unit_test(the_nearest_voxel_lies_in_front),
        cmocka_unit_test(the_ray_caster_absorbs_like_the_exponential_law),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
