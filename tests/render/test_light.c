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

/* Shear-warp rounds light to 15 bits for each slab. */
#define ROUNDING 1e-3

/* Pictures of a scene with lights by name and by angles. */
static void check_lights(model_stage *stage, int n) {
    reference_scene scene = scene_of(n);
    const snow_settings *settings = &scene.settings;
    float *head = picture_with(stage, &scene, SNOW_LIGHT_HEAD, 40, 50);
    float *side = picture_with(stage, &scene, SNOW_LIGHT_DIRECTION, -25, 35);
    static const struct {
        snow_light light;
        double azimuth, elevation, of_side, of_head;
    } lights[] = {
        {SNOW_LIGHT_KEY, 40, 50, 0.65, 0.35},
        {SNOW_LIGHT_AUTO, 0, 0, 0.65, 0.35},
        {SNOW_LIGHT_AUTO, -25, 35, 1, 0},
        {SNOW_LIGHT_DIRECTION, 0, 0, 0, 1},
    };
    assert_true(difference(head, side) > 0.02);
    for (size_t i = 0; i < sizeof lights / sizeof *lights; i++) {
        const bool mean = lights[i].of_side > 0 && lights[i].of_head > 0;
        float wanted[PIXELS * PIXELS * 4];
        for (int at = 0; at < PIXELS * PIXELS * 4; at++)
            wanted[at] = (float)(lights[i].of_side * (double)side[at] +
                                 lights[i].of_head * (double)head[at]);
        float *picture = picture_with(stage, &scene, lights[i].light,
                                      lights[i].azimuth, lights[i].elevation);
        if (!(difference(picture, wanted) <= (mean ? ROUNDING : 0)))
            fail_msg("scene %d, light %d at %g: off by %g", n,
                     (int)settings->light, settings->light_azimuth,
                     difference(picture, wanted));
        free(picture);
    }
    free(head);
    free(side);
    model_free(&scene);
}

/* Of a key light angles do not matter, and without angles light is one: 0.65
 * from 25 degrees at the left and 35 above, and 0.35 from the viewer.  With
 * angles it is from there; from 0 degrees it is a head light. */
static void lights_have_names_and_angles(void **state) {
    for (int n = 0; n < 12; n++)
        check_lights(*state, n);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        MODEL_TEST(lights_have_names_and_angles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
