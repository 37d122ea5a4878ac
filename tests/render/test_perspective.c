/* tests/render/test_perspective.c - pictures in perspective, by the reference's
 * rules and against the reference. */
#include "reference/model.h"
#include "transform/perspective.h"

#include <math.h>
#include <string.h>

#define BOUND 1e-3
#define COUNT(array) (sizeof(array) / sizeof *(array))
static const int64_t dims[3] = {13, 10, 15};
static const double fovs[] = {5, 30, 60, 100};
static const double zooms[] = {0.3, 1, 2, 8};

static const model_stand stands[] = {
    {{0, 0, 1}, {0, 1, 0}, 0, 0, 0},
    {{0, 0, -1}, {0, 1, 0}, 0, 0, 0},
    {{0, 1, 0}, {0, 0, 1}, 0, 0, 0},
    {{0, -1, 0}, {0, 0, 1}, 0, 0, 0},
    {{1, 0, 0}, {0, 0, 1}, 0, 0, 0},
    {{-1, 0, 0}, {0, 0, 1}, 0, 0, 90},
    {{0, 0, 1}, {0, 1, 0}, 30, 20, 0},
    {{0, 0, 1}, {0, 1, 0}, 45, 0, 0},
    {{0, 1, 0}, {0, 0, 1}, -120, -35, 25},
    {{1, 0, 0}, {0, 0, 1}, 90, 45, 0},
    {MODEL_ISO, 0, 0, 0},
};

static void stand_at(reference_scene *scene, size_t n, double zoom) {
    model_stand_at(scene, &stands[n % COUNT(stands)], zoom);
}

/* --- the reference's own rules -------------------------------------------- */

static double distance_of(const reference_scene *scene, const double *a,
                          const double *b) {
    double largest = 0;
    for (int n = 0; n < scene->view.width * scene->view.height * 4; n++)
        largest = fmax(largest, fabs(a[n] - b[n]));
    return largest;
}

static void a_narrow_field_of_view_is_nearly_parallel(void **state) {
    (void)state;
    for (size_t n = 0; n < COUNT(stands); n++) {
        reference_scene scene =
            model_scene(dims, SNOW_TYPE_UINT8, false,
                        (model_matrix)(n % MODEL_MATRICES), n);
        scene.view.width = 24, scene.view.height = 18;
        stand_at(&scene, n, 1);
        double *parallel = reference_render(&scene);
        scene.view.fov = 1;
        double *near = reference_render(&scene);
        scene.view.fov = 0.01;
        double *far = reference_render(&scene);
        double wide = distance_of(&scene, parallel, near);
        double narrow = distance_of(&scene, parallel, far);
        assert_true(narrow < 1e-3);
        assert_true(narrow < wide / 20);
        free(parallel);
        free(near);
        free(far);
        model_free(&scene);
    }
}

/* Through the middle of slices seen from the front every ray stays 1 / cos of
 * its angle in each. */
static void a_constant_volume_is_denser_off_the_axis(void **state) {
    (void)state;
    reference_scene scene = model_blank((int64_t[]){40, 40, 4}, 0.1);
    for (int n = 0; n < 40 * 40 * 4; n++)
        model_voxels(&scene)[n] = 1;
    scene.view.fov = 60;
    scene.view.zoom = 2;
    reference_camera camera;
    reference_camera_of(&scene, &camera);
    double *picture = reference_render(&scene);
    for (int x = 20; x < 44; x++) {
        /* The kernel adds up samples of neighbouring voxels, whose rays differ
         * little from the pixel's. */
        double right = (x + 0.5 - 32) * camera.pitch, down = camera.pitch / 2;
        double step = sqrt(camera.distance * camera.distance + right * right +
                           down * down) /
                      camera.distance;
        assert_near(picture[4 * (24 * 64 + x) + 3], 1 - pow(0.9, 4 * step),
                    1e-4);
    }
    free(picture);
    model_free(&scene);
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

/* Data turned by 90 degrees about z, seen from where the camera then is. */
static void turning_the_camera_equals_turning_the_data(void **state) {
    (void)state;
    reference_scene scene = model_scene(
        (int64_t[]){11, 11, 7}, SNOW_TYPE_FLOAT32, false, MODEL_PLAIN, 3);
    scene.view.width = 30, scene.view.height = 24;
    scene.view.fov = 50;
    reference_scene turned = scene;
    float *voxels = malloc(11 * 11 * 7 * sizeof *voxels);
    assert_non_null(voxels);
    for (int k = 0; k < 7; k++)
        for (int j = 0; j < 11; j++)
            for (int i = 0; i < 11; i++)
                voxels[(k * 11 + i) * 11 + 10 - j] =
                    ((const float *)scene.voxels)[(k * 11 + j) * 11 + i];
    turned.voxels = voxels;
    model_look(&scene, (double[]){1, 0, 0}, (double[]){0, 0, 1});
    model_look(&turned, (double[]){0, 1, 0}, (double[]){0, 0, 1});
    double *a = reference_render(&scene), *b = reference_render(&turned);
    assert_true(distance_of(&scene, a, b) < 1e-12);
    free(a);
    free(b);
    free(voxels);
    model_free(&scene);
}

static void front_to_back_equals_back_to_front(void **state) {
    (void)state;
    reference_scene scene = model_scene((int64_t[]){9, 12, 7}, SNOW_TYPE_UINT8,
                                        false, MODEL_OBLIQUE, 3);
    model_turn(&scene, 30, 20, 10, 1);
    scene.view.fov = 100;
    double *front = reference_render(&scene);
    double *back = reference_render_back_to_front(&scene);
    assert_true(distance_of(&scene, front, back) < 1e-13);
    free(front);
    free(back);
    model_free(&scene);
}

/* --- the library ---------------------------------------------------------- */

static size_t draw(uint64_t *state, size_t count) {
    return (size_t)(support_random(state) >> 33) % count;
}

/* A scene that is drawn but for field of view, stand and zoom. */
static reference_scene drawn_scene(uint64_t *state) {
    static const snow_type types[] = {SNOW_TYPE_UINT8, SNOW_TYPE_INT16,
                                      SNOW_TYPE_FLOAT32};
    static const double thresholds[] = {0, 10, 30};
    reference_scene scene =
        model_scene(dims, types[draw(state, 3)], draw(state, 2) == 0,
                    (model_matrix)draw(state, MODEL_MATRICES), draw(state, 99));
    scene.view.width = 24;
    scene.view.height = 18;
    scene.settings.shade =
        draw(state, 2) == 0 ? SNOW_SHADE_NONE : SNOW_SHADE_PHONG;
    scene.settings.threshold = thresholds[draw(state, 3)];
    scene.settings.encoding = (snow_encoding)draw(state, 4);
    return scene;
}

static void every_kernel_and_method_from_every_side(void **state) {
    (void)state;
    model_stage stage = model_open();
    model_summary summary = {0};
    for (int kernel = 0; kernel < 4; kernel++)
        for (size_t f = 0; f < COUNT(fovs); f++)
            for (size_t n = 0; n < COUNT(stands) * COUNT(zooms); n++) {
                if (!support_takes(n + (size_t)kernel + f, 13))
                    continue;
                uint64_t random =
                    support_scene_random(1, n + (size_t)kernel + f);
                reference_scene scene = drawn_scene(&random);
                scene.settings.kernel = (snow_kernel)kernel;
                scene.settings.footprint = 2 + (int)draw(&random, 6);
                scene.settings.method =
                    scene.settings.threshold == 0 && n % 3 == 0
                        ? SNOW_METHOD_ORIGINAL
                    : n % 2 ? SNOW_METHOD_FOOTPRINT
                            : SNOW_METHOD_TESTED;
                scene.view.fov = fovs[f];
                stand_at(&scene, n, zooms[n / COUNT(stands)]);
                model_check(&stage, &scene, BOUND, &summary);
                model_free(&scene);
            }
    model_report(&summary);
    model_close(&stage);
}

/* A long volume seen at 45 degrees with a wide field of view: slices lie before
 * and behind the plane through the eye. */
static void slices_on_both_sides_of_the_eye(void **state) {
    (void)state;
    model_stage stage = model_open();
    model_summary summary = {0};
    for (int n = 0; n < 8; n++) {
        reference_scene scene =
            model_scene((int64_t[]){5, 6, 31}, SNOW_TYPE_UINT8, n % 2 == 0,
                        MODEL_PLAIN, (uint64_t)n);
        scene.view.width = 24;
        scene.view.height = 18;
        model_turn(&scene, n < 4 ? 44 : 136, 2 * n, 10 * n, 1);
        scene.view.fov = 110 + n;
        snow_placement p;
        assert_int_equal(
            snow_placement_make(stage.context, &scene.info, &scene.view, &p),
            SNOW_STATUS_OK);
        assert_true(p.eye.at[2] > 0 && p.eye.at[2] < 30);
        scene.settings.method =
            n % 2 ? SNOW_METHOD_FOOTPRINT : SNOW_METHOD_TESTED;
        model_check(&stage, &scene, BOUND, &summary);
        model_free(&scene);
    }
    model_report(&summary);
    model_close(&stage);
}

static void fields_of_view_out_of_range_are_refused(void **state) {
    (void)state;
    static const double bad[] = {-1,  1e-9,        121,
                                 180, (double)NAN, (double)INFINITY};
    model_stage stage = model_open();
    reference_scene scene = model_blank((int64_t[]){2, 2, 2}, 0.5);
    for (size_t n = 0; n < COUNT(bad); n++) {
        snow_volume *volume = NULL;
        snow_transfer *transfer = NULL;
        snow_image *image = NULL;
        scene.view.fov = bad[n];
        assert_int_equal(
            snow_volume_wrap(stage.context, &scene.info, scene.voxels, &volume),
            SNOW_STATUS_OK);
        assert_int_equal(snow_transfer_new_for_volume(volume, NULL, &transfer),
                         SNOW_STATUS_OK);
        assert_int_equal(snow_frame_render(stage.frame, volume, transfer,
                                           &scene.view, &scene.settings,
                                           &image),
                         SNOW_STATUS_BAD_USAGE);
        assert_null(image);
        assert_non_null(
            strstr(snow_context_message(stage.context), "field of view"));
        snow_transfer_free(transfer);
        snow_volume_close(volume);
    }
    model_free(&scene);
    model_close(&stage);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_narrow_field_of_view_is_nearly_parallel),
        cmocka_unit_test(a_constant_volume_is_denser_off_the_axis),
        cmocka_unit_test(a_point_is_seen_where_similar_triangles_say),
        cmocka_unit_test(turning_the_camera_equals_turning_the_data),
        cmocka_unit_test(front_to_back_equals_back_to_front),
        cmocka_unit_test(every_kernel_and_method_from_every_side),
        cmocka_unit_test(slices_on_both_sides_of_the_eye),
        cmocka_unit_test(fields_of_view_out_of_range_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
