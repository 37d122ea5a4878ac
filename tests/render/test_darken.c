/* tests/render/test_darken.c - depth darkening against its formula in float64
 * (docs/model.md, "The value model" 7). */
#include "image/image.h"
#include "reference/model.h"
#include "support/support.h"

#include <math.h>

#define WIDTH 130
#define HEIGHT 90
#define COUNT (WIDTH * HEIGHT)

static reference_scene scene_of(int n) {
    reference_scene scene =
        model_scene((int64_t[]){24, 21, 19}, SNOW_TYPE_UINT8, n % 3 == 2,
                    (model_matrix)(n % MODEL_MATRICES), 3);
    scene.settings.method =
        n % 2 ? SNOW_METHOD_RAYCAST : SNOW_METHOD_SHEAR_WARP;
    scene.settings.mode = n >= 8 ? SNOW_MODE_ISO : SNOW_MODE_OVER;
    scene.settings.iso = 71;
    scene.view.fov = n / 4 % 2 ? 30 : 0;
    scene.view.width = WIDTH;
    scene.view.height = HEIGHT;
    model_turn(&scene, 25, 35, 10, 1.6);
    return scene;
}

static int within(int n, int count) {
    return n < 0 ? 0 : n < count ? n : count - 1;
}

/* One box along x, then along y; both go on beyond the picture's ends. */
static void box(const double *in, double *out, int reach) {
    static double rows[COUNT];
    for (int n = 0; n < COUNT; n++) {
        rows[n] = 0;
        for (int by = -reach; by <= reach; by++)
            rows[n] += in[n / WIDTH * WIDTH + within(n % WIDTH + by, WIDTH)] /
                       (2 * reach + 1);
    }
    for (int n = 0; n < COUNT; n++) {
        out[n] = 0;
        for (int by = -reach; by <= reach; by++)
            out[n] += rows[within(n / WIDTH + by, HEIGHT) * WIDTH + n % WIDTH] /
                      (2 * reach + 1);
    }
}

/* The factor of each pixel's colours. */
static void factors(const float *depth, double pitch, double strength,
                    double factor[COUNT]) {
    static double filled[COUNT], mean[COUNT];
    const double share[] = {1.0 / 128, 1.0 / 43}, unit = HEIGHT * pitch / 21;
    double far = -INFINITY;
    for (int n = 0; n < COUNT; n++)
        far = fmax(far, (double)depth[n]);
    for (int n = 0; n < COUNT; n++) {
        filled[n] = isnan(depth[n]) ? far : (double)depth[n];
        factor[n] = 0;
    }
    for (int i = 0; i < 2; i++) {
        double deviation = share[i] * HEIGHT;
        int reach = (int)((sqrt(4 * deviation * deviation + 1) - 1) / 2 + 0.5);
        memcpy(mean, filled, sizeof mean);
        for (int pass = 0; pass < 3; pass++)
            box(mean, mean, reach);
        for (int n = 0; n < COUNT; n++)
            factor[n] += fmin(fmax((filled[n] - mean[n]) / unit, 0), 3);
    }
    for (int n = 0; n < COUNT; n++) {
        double left = fmax(1 - 0.9 * factor[n], 0.35);
        factor[n] = isnan(depth[n]) ? 1 : 1 - strength * (1 - left);
    }
}

static double check_factors(const float *plain, const float *dark,
                            const double factor[COUNT]) {
    double least = 1;
    for (int n = 0; n < COUNT; n++) {
        for (int c = 0; c < 3; c++) {
            double wanted = (double)plain[4 * n + c] * factor[n];
            assert_true(fabs((double)dark[4 * n + c] - wanted) < 1e-4);
        }
        assert_true(dark[4 * n + 3] == plain[4 * n + 3]);
        least = fmin(least, factor[n]);
    }
    return least;
}

static void what_lies_behind_is_darker_by_the_formula(void **state) {
    (void)state;
    for (int n = 0; n < 12; n++) {
        const double strength = n % 2 ? 1 : 0.6;
        static double factor[COUNT];
        reference_camera camera;
        model_stage stage = model_open();
        reference_scene scene = scene_of(n);
        scene.settings.depth = true;
        float *plain = model_picture(&stage, &scene);
        const snow_image *depth = snow_frame_depth(stage.frame);
        reference_camera_of(&scene, &camera);
        factors(depth->pixels, camera.pitch, strength, factor);
        scene.settings.depth = n % 4 < 2;
        scene.settings.depth_darkening = strength;
        float *dark = model_picture(&stage, &scene);
        double least = check_factors(plain, dark, factor);
        if (!(least < 0.9))
            fail_msg("scene %d: %g at least", n, least);
        free(plain);
        free(dark);
        model_free(&scene);
        model_close(&stage);
    }
}

/* By depths and by occlusion: both. */
static void threads_darken_alike(void **state) {
    (void)state;
    model_stage stage = model_open();
    reference_scene scene = scene_of(0);
    scene.settings.depth_darkening = scene.settings.occlusion = 1;
    scene.settings.threads = 1;
    float *one = model_picture(&stage, &scene);
    scene.settings.threads = 3;
    float *three = model_picture(&stage, &scene);
    assert_memory_equal(one, three, COUNT * 4 * sizeof *one);
    free(one);
    free(three);
    model_free(&scene);
    model_close(&stage);
}

static void projections_have_nothing_behind(void **state) {
    (void)state;
    model_stage stage = model_open();
    reference_scene scene = scene_of(0);
    scene.settings.mode = SNOW_MODE_MIP;
    float *plain = model_picture(&stage, &scene);
    scene.settings.depth_darkening = scene.settings.occlusion = 1;
    float *dark = model_picture(&stage, &scene);
    assert_memory_equal(plain, dark, COUNT * 4 * sizeof *plain);
    free(plain);
    free(dark);
    model_free(&scene);
    model_close(&stage);
}

static void a_strength_is_from_0_to_1(void **state) {
    (void)state;
    model_stage stage = model_open();
    reference_scene scene = scene_of(0);
    snow_transfer *transfer = model_transfer(stage.context, &scene);
    snow_volume *volume = NULL;
    assert_int_equal(
        snow_volume_wrap(stage.context, &scene.info, scene.voxels, &volume),
        SNOW_STATUS_OK);
    const double wrong[] = {-0.1, 1.1, NAN, INFINITY};
    for (int n = 0; n < 4; n++) {
        snow_image *image;
        scene.settings.depth_darkening = wrong[n];
        assert_int_equal(snow_frame_render(stage.frame, volume, transfer,
                                           &scene.view, &scene.settings,
                                           &image),
                         SNOW_STATUS_BAD_USAGE);
        assert_non_null(
            strstr(snow_context_message(stage.context), "depth darkening"));
    }
    snow_volume_close(volume);
    snow_transfer_free(transfer);
    model_free(&scene);
    model_close(&stage);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_lies_behind_is_darker_by_the_formula),
        cmocka_unit_test(threads_darken_alike),
        cmocka_unit_test(projections_have_nothing_behind),
        cmocka_unit_test(a_strength_is_from_0_to_1),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
