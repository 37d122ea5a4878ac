/* tests/render/test_shear_warp_quality.c - how far the sheared method is from
 * the exact picture of the model, which the float64 reference renders: peak
 * signal to noise over all four channels, for a peak of 1. */
#include <math.h>

#include "reference/shear_warp.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* What pictures of smooth volumes reach in normal quality, decibels. */
#define TRANSLUCENT_LEAST 55
#define OPAQUE_LEAST 45

static const double turns[][3] = {
    {0, 0, 1}, {10, 5, 1}, {25, 20, 1.3}, {44, 10, 0.8}, {-60, 30, 2}};

static const snow_color_point colors[] = {
    {0, 0.9, 0.3, 0.2}, {90, 0.9, 0.8, 0.6}, {255, 1, 1, 0.9}};
static const snow_opacity_point translucent[] = {
    {20, 0}, {60, 0.03}, {140, 0.06}, {255, 0.12}};
static const snow_opacity_point opaque[] = {
    {40, 0}, {70, 0.3}, {110, 0.9}, {255, 1}};

/* A phantom as a scene; free the volume, which owns the voxels. */
static reference_scene phantom_scene(snow_context *context, const char *name,
                                     snow_volume **volume) {
    const int64_t dims[3] = {48, 48, 48};
    reference_scene scene = model_phantom(context, name, dims, volume);
    scene.colors = colors;
    scene.color_count = COUNT(colors);
    scene.view.width = 100;
    scene.view.height = 90;
    return scene;
}

static double psnr(const reference_scene *scene, const float *picture,
                   const double *exact) {
    size_t count = (size_t)scene->view.width * (size_t)scene->view.height * 4;
    double sum = 0;
    for (size_t n = 0; n < count; n++) {
        double gap = (double)picture[n] - exact[n];
        sum += gap * gap;
    }
    return 10 * log10((double)count / sum);
}

/* The worst and the mean of all turns, for each quality. */
static void measure(const model_stage *stage, reference_scene *scene,
                    double least[3], double mean[3]) {
    static const snow_quality qualities[] = {
        SNOW_QUALITY_DRAFT, SNOW_QUALITY_NORMAL, SNOW_QUALITY_HIGH};
    for (int q = 0; q < 3; q++) {
        least[q] = INFINITY;
        mean[q] = 0;
    }
    for (size_t n = 0; n < COUNT(turns); n += support_stride(5)) {
        model_turn(scene, turns[n][0], turns[n][1], 5, turns[n][2]);
        scene->settings.quality = SNOW_QUALITY_NORMAL;
        double *exact = reference_render(scene);
        for (int q = 0; q < 3; q++) {
            scene->settings.quality = qualities[q];
            float *picture = model_picture(stage, scene);
            assert_int_equal(snow_frame_stats(stage->frame)->method,
                             SNOW_METHOD_SHEAR_WARP);
            double figure = psnr(scene, picture, exact);
            least[q] = fmin(least[q], figure);
            mean[q] += figure / COUNT(turns);
            free(picture);
        }
        free(exact);
    }
}

static void check_phantoms(const snow_opacity_point *opacities, size_t count,
                           const char *class, double bound) {
    static const char *const names[] = {"shells", "head", "engine"};
    model_stage stage = model_open();
    for (size_t n = 0; n < 2 * COUNT(names); n++) {
        snow_volume *volume = NULL;
        double least[3], mean[3];
        reference_scene scene =
            phantom_scene(stage.context, names[n / 2], &volume);
        scene.opacities = opacities;
        scene.opacity_count = count;
        scene.settings.method = SNOW_METHOD_SHEAR_WARP;
        scene.settings.shade = n % 2 ? SNOW_SHADE_PHONG : SNOW_SHADE_NONE;
        measure(&stage, &scene, least, mean);
        print_message("             %s %s %s: least (mean) dB: draft %.1f "
                      "(%.1f), normal %.1f (%.1f), high %.1f (%.1f)\n",
                      class, names[n / 2], n % 2 ? "shaded" : "unshaded",
                      least[0], mean[0], least[1], mean[1], least[2], mean[2]);
        snow_volume_close(volume);
        if (!(least[1] >= bound))
            fail_msg("%.1f dB are below %.1f", least[1], bound);
    }
    model_close(&stage);
}

static void translucent_pictures_are_close_to_exact_ones(void **state) {
    (void)state;
    check_phantoms(translucent, COUNT(translucent), "translucent",
                   TRANSLUCENT_LEAST);
}

static void opaque_pictures_are_close_to_exact_ones(void **state) {
    (void)state;
    check_phantoms(opaque, COUNT(opaque), "opaque", OPAQUE_LEAST);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(translucent_pictures_are_close_to_exact_ones),
        cmocka_unit_test(opaque_pictures_are_close_to_exact_ones),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
