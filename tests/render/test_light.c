/* tests/render/test_light.c - where the light comes from: names and angles, and
 * the key light as the sum of two. */
#include "reference/model.h"
#include "support/support.h"

#include <math.h>

#define PIXELS 48

static const snow_method methods[] = {
    SNOW_METHOD_SHEAR_WARP, SNOW_METHOD_FOOTPRINT, SNOW_METHOD_ORIGINAL,
    SNOW_METHOD_RAYCAST};

/* Scene `n`: each method in parallel projection and perspective, and an
 * isosurface. Light and colours never reach 1. */
static reference_scene scene_of(int n) {
    reference_scene scene = model_scene((int64_t[]){14, 11, 9}, SNOW_TYPE_UINT8,
                                        false, MODEL_ANISOTROPIC, 3);
    scene.settings.method = methods[n % 4];
    scene.settings.mode = n >= 8 ? SNOW_MODE_ISO : SNOW_MODE_OVER;
    scene.settings.iso = 71;
    scene.settings.ambient = 0.1;
    scene.settings.diffuse = 0.5;
    scene.settings.specular = 0.2;
    scene.settings.shininess = 7.5;
    scene.view.fov = n / 4 % 2 ? 30 : 0;
    scene.view.width = scene.view.height = PIXELS;
    model_turn(&scene, 25, 35, 10, 1.2);
    return scene;
}

static float *picture_with(model_stage *stage, reference_scene *scene,
                           snow_light light, double azimuth, double elevation) {
    scene->settings.light = light;
    scene->settings.light_azimuth = azimuth;
    scene->settings.light_elevation = elevation;
    return model_picture(stage, scene);
}

static double difference(const float *a, const float *b) {
    double most = 0;
    for (int i = 0; i < PIXELS * PIXELS * 4; i++)
        most = fmax(most, fabs((double)a[i] - b[i]));
    return most;
}

static void without_angles_the_light_is_a_key_light(void **state) {
    (void)state;
    for (int n = 0; n < 12; n++) {
        model_stage stage = model_open();
        reference_scene scene = scene_of(n);
        float *key = picture_with(&stage, &scene, SNOW_LIGHT_KEY, 40, 50);
        float *automatic = picture_with(&stage, &scene, SNOW_LIGHT_AUTO, 0, 0);
        float *head = picture_with(&stage, &scene, SNOW_LIGHT_HEAD, 40, 50);
        assert_memory_equal(key, automatic, PIXELS * PIXELS * 4 * sizeof *key);
        assert_true(difference(key, head) > 0.02);
        free(key);
        free(automatic);
        free(head);
        model_free(&scene);
        model_close(&stage);
    }
}

static void angles_are_those_of_a_direction(void **state) {
    (void)state;
    for (int n = 0; n < 12; n++) {
        model_stage stage = model_open();
        reference_scene scene = scene_of(n);
        float *told = picture_with(&stage, &scene, SNOW_LIGHT_DIRECTION, 40, 9);
        float *automatic = picture_with(&stage, &scene, SNOW_LIGHT_AUTO, 40, 9);
        float *ahead = picture_with(&stage, &scene, SNOW_LIGHT_DIRECTION, 0, 0);
        float *head = picture_with(&stage, &scene, SNOW_LIGHT_HEAD, 0, 0);
        assert_memory_equal(told, automatic,
                            PIXELS * PIXELS * 4 * sizeof *told);
        assert_memory_equal(ahead, head, PIXELS * PIXELS * 4 * sizeof *ahead);
        assert_true(difference(told, head) > 0.02);
        free(told);
        free(automatic);
        free(ahead);
        free(head);
        model_free(&scene);
        model_close(&stage);
    }
}

/* Shear-warp rounds light to 15 bits for each slab. */
#define ROUNDING 1e-3

static void
a_key_light_is_the_mean_of_a_distant_and_a_head_light(void **state) {
    (void)state;
    for (int n = 0; n < 12; n++) {
        model_stage stage = model_open();
        reference_scene scene = scene_of(n);
        float *key = picture_with(&stage, &scene, SNOW_LIGHT_KEY, 0, 0);
        float *head = picture_with(&stage, &scene, SNOW_LIGHT_HEAD, 0, 0);
        float *mean =
            picture_with(&stage, &scene, SNOW_LIGHT_DIRECTION, -25, 35);
        for (int i = 0; i < PIXELS * PIXELS * 4; i++)
            mean[i] = 0.65F * mean[i] + 0.35F * head[i];
        double most = difference(key, mean);
        if (!(most < ROUNDING))
            fail_msg("scene %d: %g", n, most);
        free(key);
        free(head);
        free(mean);
        model_free(&scene);
        model_close(&stage);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_angles_the_light_is_a_key_light),
        cmocka_unit_test(angles_are_those_of_a_direction),
        cmocka_unit_test(a_key_light_is_the_mean_of_a_distant_and_a_head_light),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
