/* tests/values/test_value_views.c - the value model beside a fine ray caster,
 * along every axis, in both projections and in the modes that project values:
 * how near it is grows with the quality. */
#include "reference/raycast.h"
#include "values/scenes.h"

#include <math.h>

static double wave(const double at[3]) {
    return 50 + 30 * sin(0.35 * at[0] + 0.2 * at[1]) * cos(0.3 * at[2]) + at[1];
}

/* A soft ball that does not reach the sides, with ripples. */
static double planet(const double at[3]) {
    double x = at[0] - 9.4, y = at[1] - 10.7, z = at[2] - 10.1;
    double r = sqrt(x * x + y * y + z * z);
    return 20 + 80 / (1 + exp((r - 6) / 1.2)) *
                    (1 + 0.2 * sin(0.7 * x) * cos(0.5 * y - 0.3 * z));
}

/* How far a small picture is from the truth in the mean. */
static double far_from_truth(const value_scene *scene) {
    double *picture = value_model_render(scene), sum = 0;
    value_truth *truth = value_truth_new(scene, 24);
    int width = scene->base.view.width, height = scene->base.view.height;
    snow_mode mode = scene->base.settings.mode;
    int channels = mode == SNOW_MODE_MEAN || mode == SNOW_MODE_SUM ? 1 : 4;
    for (int n = 0; n < width * height; n++) {
        double pixel[4];
        value_truth_pixel(truth, n % width + 0.5, n / width + 0.5, pixel);
        for (int c = 0; c < channels; c++) {
            double difference = fabs(picture[n * channels + c] - pixel[c]);
            if (isnan(difference)) /* the picture's edge */
                continue;
            sum += difference / (width * height * channels);
        }
    }
    value_truth_free(truth);
    free(picture);
    return sum;
}

static const snow_opacity_point soft[] = {{30, 0}, {90, 0.5}};
static const snow_color_point tints[] = {{30, 0.9, 0.2, 0.1},
                                         {90, 0.3, 0.8, 1}};

static void every_axis_and_projection_is_near_the_truth(void **state) {
    (void)state;
    for (int n = 0; n < 36; n += (int)support_stride(11)) {
        value_scene scene = value_scene_of((int64_t[]){20, 22, 21}, planet, 0);
        free((void *)(uintptr_t)scene.base.opacities);
        scene.base.opacities = soft;
        scene.base.opacity_count = 2;
        scene.base.colors = tints;
        scene.base.color_count = 2;
        scene.base.settings.shade = SNOW_SHADE_PHONG;
        scene.base.settings.quality = value_qualities[n % 3];
        scene.base.settings.light =
            n / 9 % 2 ? SNOW_LIGHT_KEY : SNOW_LIGHT_HEAD;
        if (n % 4 == 1 && n / 9 % 2 == 0) {
            scene.base.settings.light = SNOW_LIGHT_DIRECTION;
            scene.base.settings.light_azimuth = 40;
        }
        value_scene_look(&scene, n / 3 % 3, n / 9 * 97 + 20, 25,
                         n / 18 ? 30 : 0);
        scene.base.view.zoom = 1.7;
        double mean = far_from_truth(&scene);
        static const double bounds[] = {5e-3, 2.2e-3, 7e-4};
        if (!(mean < bounds[n % 3]))
            fail_msg("view %d: %g", n, mean);
        value_scene_free(&(value_scene){.base = {.voxels = scene.base.voxels}});
    }
}

static void projections_are_near_the_truth(void **state) {
    (void)state;
    static const snow_mode modes[] = {SNOW_MODE_MIP, SNOW_MODE_MINIP,
                                      SNOW_MODE_MEAN, SNOW_MODE_SUM};
    for (int n = 0; n < 24; n += (int)support_stride(11)) {
        value_scene scene = value_scene_of((int64_t[]){20, 22, 21}, wave, 1);
        static const snow_color_point grey[] = {{0, 0, 0, 0}, {100, 1, 1, 1}};
        scene.base.colors = grey;
        scene.base.color_count = 2;
        scene.base.settings.quality = value_qualities[n % 3];
        scene.base.settings.mode = modes[n % 4];
        value_scene_look(&scene, n / 4 % 3, 20, 25, n / 12 ? 30 : 0);
        scene.base.view.zoom = 2.5; /* without the edges */
        double mean = far_from_truth(&scene);
        double unit = n % 4 == 3 ? 1000 : n % 4 == 2 ? 50 : 0.5;
        static const double bounds[] = {1.2e-2, 4e-3, 1.2e-3};
        if (!(mean < bounds[n % 3] * unit))
            fail_msg("mode %d: %g of %g", modes[n % 4], mean, unit);
        value_scene_free(&scene);
    }
}

static void two_ray_casters_agree(void **state) {
    (void)state;
    for (int n = 0; n < 6; n++) {
        value_scene scene = value_scene_of((int64_t[]){12, 13, 11}, wave, 0);
        free((void *)(uintptr_t)scene.base.opacities);
        scene.base.opacities = soft;
        scene.base.opacity_count = 2;
        scene.base.colors = tints;
        scene.base.color_count = 2;
        scene.base.settings.shade = SNOW_SHADE_PHONG;
        scene.base.settings.quality = SNOW_QUALITY_HIGH;
        scene.base.settings.kernel = SNOW_KERNEL_TENT;
        scene.base.settings.light = n % 2 ? SNOW_LIGHT_KEY : SNOW_LIGHT_AUTO;
        scene.base.settings.light_azimuth = n == 4 ? 40 : 0;
        scene.base.view.width = scene.base.view.height = 16;
        value_scene_look(&scene, n % 3, 20, 25, n < 3 ? 0 : 30);
        double *other =
            reference_cast_rays(&(reference_cast){.scene = &scene.base}, NULL);
        value_truth *truth = value_truth_new(&scene, 16);
        for (int p = 0; p < 16 * 16; p++) {
            double pixel[4];
            value_truth_pixel(truth, p % 16 + 0.5, p / 16 + 0.5, pixel);
            for (int c = 0; c < 4; c++)
                if (fabs(pixel[c] - other[4 * p + c]) > 1e-5)
                    fail_msg("view %d: %g, not %g", n, pixel[c],
                             other[4 * p + c]);
        }
        value_truth_free(truth);
        free(other);
        value_scene_free(&(value_scene){.base = {.voxels = scene.base.voxels}});
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_ray_casters_agree),
        cmocka_unit_test(every_axis_and_projection_is_near_the_truth),
        cmocka_unit_test(projections_are_near_the_truth),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
