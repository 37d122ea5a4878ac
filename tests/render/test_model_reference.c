/* tests/render/test_model_reference.c - what everything else is held against is
 * itself held against closed forms that need no renderer: kernels, their
 * widening, and where a point is seen.
 *
 * Laws of whole pictures are test_model_rules.c's: the library obeys them, and
 * its pictures are the reference's. */
#include "reference/model.h"

#include <math.h>

/* Values of the linear, quadratic and cubic B-spline from their closed forms.
 */
static void kernels_have_the_shapes_of_their_names(void **state) {
    static const struct {
        snow_kernel kernel;
        int support;
        double t, value;
    } known[] = {
        {SNOW_KERNEL_BSPLINE, 2, 0.25, 0.75},
        {SNOW_KERNEL_BSPLINE, 3, 0.5, 0.5},
        {SNOW_KERNEL_BSPLINE, 3, 0, 0.75},
        {SNOW_KERNEL_BSPLINE, 4, 0, 2.0 / 3},
        {SNOW_KERNEL_BSPLINE, 4, -1, 1.0 / 6},
        {SNOW_KERNEL_TENT, 4, -1, 0.5},
        {SNOW_KERNEL_GAUSS, 4, 0.5, 0.60653065971263342},
        {SNOW_KERNEL_BOX, 3, -1.5, 1},
        {SNOW_KERNEL_BOX, 3, 1.5, 0},
    };
    (void)state;
    for (size_t n = 0; n < sizeof known / sizeof *known; n++)
        assert_near(
            reference_kernel(known[n].kernel, known[n].support, 1, known[n].t),
            known[n].value, 1e-12);
}

static double moment(snow_kernel kernel, int support, int power) {
    double sum = 0, step = 1 / 512.0;
    for (double t = -5 + step / 2; t < 5; t += step)
        sum += step * pow(t, power) * reference_kernel(kernel, support, 1, t);
    return sum;
}

static void widening_adds_the_variance_of_a_pixel(void **state) {
    (void)state;
    for (size_t n = 0; n < MODEL_KERNELS; n++)
        for (int support = 2; support <= 9; support++) {
            snow_kernel kernel = model_kernel(n);
            double variance =
                moment(kernel, support, 2) / moment(kernel, support, 0);
            double w = reference_widening(kernel, support, 3);
            /* The model takes Gauss' variance without its cut: 0.13 % more. */
            assert_near(w * w * variance / (variance + (9 - 1) / 12.0), 1,
                        2e-3);
            assert_true(reference_widening(kernel, support, 0.5) == 1);
        }
}

static void a_point_is_seen_where_similar_triangles_say(void **state) {
    (void)state;
    reference_scene scene = model_blank((int64_t[]){9, 9, 9}, 1);
    scene.view.width = 90, scene.view.height = 60;
    scene.view.fov = 40;
    reference_camera camera;
    reference_camera_of(&scene, &camera);
    const double index[3] = {8, 4, 7}; /* 4 to the right, 3 nearer */
    double radius = 4.5 * sqrt(3), angle = 20 * acos(-1.0) / 180, pixel[2];
    reference_project(&scene, &camera, index, pixel);
    /* The field of view spans the 60 pixels: half of them are tan 20. */
    double distance = radius / sin(angle);
    assert_near(pixel[0], 45 + 30 * (4 / (distance - 3)) / tan(angle), 1e-9);
    assert_near(pixel[1], 30, 1e-9);
    scene.view.zoom = 3; /* scales the image about its middle */
    reference_camera_of(&scene, &camera);
    reference_project(&scene, &camera, index, pixel);
    assert_near(pixel[0], 45 + 90 * (4 / (distance - 3)) / tan(angle), 1e-9);
    /* The ray through that point meets it. */
    reference_ray ray = reference_ray_at(&scene, &camera, pixel[0], pixel[1]);
    double t = (index[2] - ray.start[2]) / ray.step[2];
    assert_true(t > 0);
    for (int n = 0; n < 3; n++)
        assert_near(ray.start[n] + t * ray.step[n], index[n], 1e-9);
    model_free(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(kernels_have_the_shapes_of_their_names),
        cmocka_unit_test(widening_adds_the_variance_of_a_pixel),
        cmocka_unit_test(a_point_is_seen_where_similar_triangles_say),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
