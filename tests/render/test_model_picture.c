/* tests/render/test_model_picture.c - pictures of the library equal the
 * reference's.
 *
 * Small volumes through every kernel, footprint, view, zoom, size, scalar
 * type, matrix, shading and threshold.  Where all combinations would be too
 * many, one factor runs through all its values while the others are drawn. */
#include "reference/model.h"

#include <math.h>

/* The largest difference that a float path may have. */
#define BOUND 1e-3

static const model_stand stands[] = {
    {{0, 0, 1}, {0, 1, 0}, 0, 0, 0},
    {{0, 0, -1}, {0, 1, 0}, 0, 0, 0},
    {{0, 1, 0}, {0, 0, 1}, 0, 0, 0},
    {{0, -1, 0}, {0, 0, 1}, 0, 0, 0},
    {{1, 0, 0}, {0, 0, 1}, 0, 0, 0},
    {{-1, 0, 0}, {0, 0, 1}, 0, 0, 0},
    {{0, 0, 1}, {0, 1, 0}, 0, 0, 90},
    {{0, 1, 0}, {0, 0, 1}, 0, 0, 180},
    {{-1, 0, 0}, {0, 0, 1}, 0, 0, -90},
    {{0, 0, 1}, {0, 1, 0}, 30, 20, 0},
    {{0, 0, 1}, {0, 1, 0}, 45, 0, 0},
    {{0, 0, 1}, {0, 1, 0}, 10, 80, 0},
    {{0, 1, 0}, {0, 0, 1}, -120, -35, 25},
    {{1, 0, 0}, {0, 0, 1}, 90, 45, 0},
    {MODEL_ISO, 0, 0, 0},
};

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const snow_type types[] = {
    SNOW_TYPE_INT8,    SNOW_TYPE_UINT8,   SNOW_TYPE_INT16, SNOW_TYPE_UINT16,
    SNOW_TYPE_INT32,   SNOW_TYPE_UINT32,  SNOW_TYPE_INT64, SNOW_TYPE_UINT64,
    SNOW_TYPE_FLOAT32, SNOW_TYPE_FLOAT64,
};
static const snow_kernel kernels[] = {SNOW_KERNEL_BSPLINE, SNOW_KERNEL_TENT,
                                      SNOW_KERNEL_GAUSS, SNOW_KERNEL_BOX};
static const double zooms[] = {0.3, 1, 4};
static const double thresholds[] = {0, 10, 30};
static const int64_t dims[3] = {13, 10, 15};

static void stand_at(reference_scene *scene, size_t n, double zoom) {
    model_stand_at(scene, &stands[n % COUNT(stands)], zoom);
}

static size_t draw(uint64_t *state, size_t count) {
    return (size_t)(support_random(state) >> 33) % count;
}

/* A scene that is drawn but for what the caller sets afterwards. */
static reference_scene drawn_scene(uint64_t *state) {
    reference_scene scene =
        model_scene(dims, types[draw(state, COUNT(types))], draw(state, 2) == 0,
                    (model_matrix)draw(state, MODEL_MATRICES), draw(state, 99));
    scene.view.width = 24;
    scene.view.height = 18;
    stand_at(&scene, draw(state, COUNT(stands)),
             zooms[draw(state, COUNT(zooms))]);
    scene.settings.shade =
        draw(state, 2) == 0 ? SNOW_SHADE_NONE : SNOW_SHADE_PHONG;
    scene.settings.threshold = thresholds[draw(state, COUNT(thresholds))];
    if (scene.settings.threshold == 0 && draw(state, 3) == 0)
        scene.settings.method = SNOW_METHOD_ORIGINAL;
    else if (draw(state, 3) == 0)
        scene.settings.method = SNOW_METHOD_TESTED;
    scene.settings.encoding = (snow_encoding)draw(state, 4);
    return scene;
}

static void every_kernel_and_footprint_from_every_side(void **state) {
    (void)state;
    model_stage stage = model_open();
    model_summary summary = {0};
    for (size_t k = 0; k < COUNT(kernels); k++)
        for (int footprint = 2; footprint <= 9; footprint++)
            for (size_t n = 0; n < COUNT(stands) * COUNT(zooms); n++) {
                if (!support_takes(n + k + (size_t)footprint, 19))
                    continue;
                uint64_t random =
                    support_scene_random(1, n + k + (size_t)footprint);
                reference_scene scene = drawn_scene(&random);
                scene.settings.kernel = kernels[k];
                scene.settings.footprint = footprint;
                stand_at(&scene, n, zooms[n / COUNT(stands)]);
                model_check(&stage, &scene, BOUND, &summary);
                model_free(&scene);
            }
    model_report(&summary);
    model_close(&stage);
}

/* The zoom at which a pixel is as wide as `length` in the world. */
static double zoom_for(const reference_scene *scene, double length) {
    reference_camera camera;
    reference_scene plain = *scene;
    plain.view.zoom = 1;
    reference_camera_of(&plain, &camera);
    return camera.pitch / length;
}

/* Here every distance of a voxel and a pixel is a round number, and edges of
 * kernels fall on voxels. */
static void pixels_that_lie_on_the_grid(void **state) {
    (void)state;
    static const double lengths[] = {1, 0.5, 2, 0.25, 4};
    model_stage stage = model_open();
    model_summary summary = {0};
    size_t pictures = COUNT(kernels) * 8 * COUNT(lengths) * 9;
    for (size_t n = 0; n < pictures; n++) {
        if (!support_takes(n, 19))
            continue;
        uint64_t random = support_scene_random(7, n);
        reference_scene scene = drawn_scene(&random);
        size_t rest = n / 9;
        /* Odd and even sizes move pixels by half a voxel. */
        scene.view.width = 21 + (int)draw(&random, 2);
        scene.view.height = 18 + (int)draw(&random, 2);
        scene.settings.kernel = kernels[rest % COUNT(kernels)];
        scene.settings.footprint = 2 + (int)(rest / COUNT(kernels) % 8);
        scene.info.matrix[0][0] = scene.info.matrix[1][1] = 1;
        scene.info.matrix[2][2] = n % 2 == 0 ? 1 : 2;
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 4; c++)
                scene.info.matrix[r][c] *= r == c;
        double length = lengths[rest / COUNT(kernels) / 8];
        stand_at(&scene, n % 9, zoom_for(&scene, length));
        model_check(&stage, &scene, BOUND, &summary);
        model_free(&scene);
    }
    model_report(&summary);
    model_close(&stage);
}

static void every_type_matrix_threshold_and_shading(void **state) {
    (void)state;
    model_stage stage = model_open();
    model_summary summary = {0};
    for (size_t n = 0; n < COUNT(types) * MODEL_MATRICES * 12; n++) {
        if (!support_takes(n, 13))
            continue;
        uint64_t random = support_scene_random(2, n);
        reference_scene drawn = drawn_scene(&random);
        size_t rest = n / COUNT(types) / MODEL_MATRICES;
        reference_scene scene =
            model_scene(dims, types[n % COUNT(types)], rest % 2 == 0,
                        (model_matrix)(n / COUNT(types) % MODEL_MATRICES), n);
        scene.view = drawn.view;
        scene.settings.shade =
            rest / 2 % 2 == 0 ? SNOW_SHADE_NONE : SNOW_SHADE_PHONG;
        scene.settings.threshold = thresholds[rest / 4];
        model_check(&stage, &scene, BOUND, &summary);
        model_free(&scene);
        model_free(&drawn);
    }
    model_report(&summary);
    model_close(&stage);
}

static void every_size_of_picture(void **state) {
    (void)state;
    static const int sizes[][2] = {{1, 1},  {7, 5}, {64, 48}, {48, 64}, {1, 30},
                                   {30, 1}, {2, 2}, {17, 33}, {100, 3}, {8, 8}};
    model_stage stage = model_open();
    uint64_t random = 3;
    model_summary summary = {0};
    for (size_t s = 0; s < COUNT(sizes); s++)
        for (size_t n = 0; n < COUNT(stands); n++) {
            reference_scene scene = drawn_scene(&random);
            stand_at(&scene, n, zooms[draw(&random, COUNT(zooms))]);
            scene.view.width = sizes[s][0];
            scene.view.height = sizes[s][1];
            scene.settings.kernel = kernels[draw(&random, COUNT(kernels))];
            model_check(&stage, &scene, BOUND, &summary);
            model_free(&scene);
        }
    model_report(&summary);
    model_close(&stage);
}

static void volumes_thin_along_some_axes(void **state) {
    (void)state;
    static const int64_t thin[][3] = {
        {1, 1, 1}, {9, 1, 1}, {1, 9, 1},   {1, 1, 9},   {7, 5, 1},  {7, 1, 5},
        {1, 7, 5}, {2, 2, 2}, {300, 2, 3}, {3, 270, 2}, {2, 3, 260}};
    model_stage stage = model_open();
    uint64_t random = 4;
    model_summary summary = {0};
    for (size_t t = 0; t < COUNT(thin); t++)
        for (size_t n = 0; n < COUNT(stands); n++) {
            model_matrix matrix = (model_matrix)draw(&random, MODEL_MATRICES);
            reference_scene scene =
                model_scene(thin[t], types[draw(&random, COUNT(types))],
                            draw(&random, 2) == 0, matrix, n);
            const snow_opacity_point opacities[] = {{0, 0.01}, {100, 0.9}};
            scene.opacities = opacities;
            scene.opacity_count = 2;
            scene.view.width = 24;
            scene.view.height = 18;
            stand_at(&scene, n, zooms[draw(&random, COUNT(zooms))]);
            scene.settings.kernel = kernels[draw(&random, COUNT(kernels))];
            model_check(&stage, &scene, BOUND, &summary);
            free((void *)(uintptr_t)scene.voxels);
        }
    model_report(&summary);
    model_close(&stage);
}

/* A pixel a little wider than a voxel widens a small kernel so that its weight
 * has kinks near its peak; single opaque voxels show the weights bare.  Tables
 * as fine as for wider kernels pass half the bound here, and the bound itself
 * now and then. */
static void small_kernels_that_are_widened_a_little(void **state) {
    (void)state;
    model_stage stage = model_open();
    model_summary summary = {0};
    for (int n = 0; n < 600; n++) {
        if (!support_takes((size_t)n, 13))
            continue;
        uint64_t random = support_scene_random(5, (size_t)n);
        reference_scene scene = model_blank((int64_t[]){40, 40, 1}, 1);
        for (int at = 0; at < 40 * 40; at++)
            model_voxels(&scene)[at] = support_uniform(&random) < 0.1;
        scene.view.width = scene.view.height = 40;
        scene.settings.kernel = kernels[n % 3]; /* not the box, which jumps */
        scene.settings.footprint = n % 10 == 0 ? 3 : 2;
        double length = 1 + 0.03 * support_uniform(&random);
        double roll = 45 * support_uniform(&random);
        model_turn(&scene, 0, 0, roll, zoom_for(&scene, length));
        model_check(&stage, &scene, BOUND / 2, &summary);
        model_free(&scene);
    }
    model_report(&summary);
    model_close(&stage);
}

/* Slices of more than 16384 voxels are classified in parts, rows longer than
 * that one by one. */
static void slices_and_rows_that_are_large(void **state) {
    (void)state;
    static const int64_t large[][3] = {
        {210, 150, 3}, {4, 190, 170}, {200, 5, 160}, {17000, 3, 2}};
    static const double oblique[] = {0, 25};
    model_stage stage = model_open();
    model_summary summary = {0};
    for (size_t n = 0; n < COUNT(large) * COUNT(oblique); n++) {
        reference_scene scene =
            model_scene(large[n / 2], SNOW_TYPE_UINT16, n == 3, MODEL_PLAIN, n);
        scene.view.width = scene.view.height = 40;
        /* From along the shortest side. */
        model_look(&scene,
                   n / 2 == 1 ? (double[]){-1, 0, 0} : (double[]){0, -1, 0},
                   (double[]){0, 0, 1});
        if (n / 2 == 0)
            model_look(&scene, (double[]){0, 0, 1}, (double[]){0, 1, 0});
        model_turn(&scene, oblique[n % 2], -oblique[n % 2], 0, 1);
        scene.settings.method =
            n % 3 == 0 ? SNOW_METHOD_TESTED : SNOW_METHOD_FOOTPRINT;
        model_check(&stage, &scene, BOUND, &summary);
        model_free(&scene);
    }
    model_report(&summary);
    model_close(&stage);
}

/* Puts NaN and infinities among the voxels of a real type. */
static void spoil(reference_scene *scene, uint64_t *random) {
    static const double odd[] = {(double)NAN, (double)INFINITY,
                                 -(double)INFINITY};
    for (int n = 0; n < 13 * 10 * 15 / 6; n++) {
        size_t at = draw(random, 13 * 10 * 15);
        double value = odd[draw(random, 3)];
        void *voxels = (void *)(uintptr_t)scene->voxels;
        if (scene->info.type == SNOW_TYPE_FLOAT32)
            ((float *)voxels)[at] = (float)value;
        else
            ((double *)voxels)[at] = value;
    }
}

static void voxels_that_are_no_numbers_or_infinite(void **state) {
    (void)state;
    model_stage stage = model_open();
    uint64_t random = 5;
    model_summary summary = {0};
    for (size_t n = 0; n < 2 * COUNT(stands); n++) {
        reference_scene scene = model_scene(
            dims, n % 2 == 0 ? SNOW_TYPE_FLOAT32 : SNOW_TYPE_FLOAT64,
            n % 3 == 0, MODEL_OBLIQUE, n);
        spoil(&scene, &random);
        scene.view.width = 24;
        scene.view.height = 18;
        stand_at(&scene, n, 1);
        static const snow_method methods[] = {
            SNOW_METHOD_ORIGINAL, SNOW_METHOD_TESTED, SNOW_METHOD_FOOTPRINT};
        scene.settings.method = methods[n % 3];
        model_check(&stage, &scene, BOUND, &summary);
        model_free(&scene);
    }
    model_report(&summary);
    model_close(&stage);
}

static void lights_from_all_sides_and_every_coefficient(void **state) {
    (void)state;
    model_stage stage = model_open();
    uint64_t random = 6;
    model_summary summary = {0};
    /* Real numbers with noise: no gradient is square to the line of sight, so
     * that rounding does not decide which way it is turned. */
    for (size_t n = 0; n < 60; n++) {
        reference_scene scene =
            model_scene(dims, SNOW_TYPE_FLOAT32, false,
                        (model_matrix)(n % MODEL_MATRICES), n);
        snow_settings *settings = &scene.settings;
        scene.view.width = 24;
        scene.view.height = 18;
        stand_at(&scene, n, 1);
        settings->light = (snow_light)(n % (SNOW_LIGHT_DIRECTION + 1));
        settings->light_azimuth = 360 * support_uniform(&random) - 180;
        settings->light_elevation = 180 * support_uniform(&random) - 90;
        settings->ambient = support_uniform(&random);
        settings->diffuse = support_uniform(&random);
        settings->specular = support_uniform(&random);
        settings->shininess = n % 5 == 0 ? 0 : 100 * support_uniform(&random);
        model_check(&stage, &scene, BOUND, &summary);
        model_free(&scene);
    }
    model_report(&summary);
    model_close(&stage);
}

static void opacities_of_other_lengths_than_a_voxel(void **state) {
    (void)state;
    model_stage stage = model_open();
    static const double lengths[] = {0.1, 0.9, 3, 40};
    model_summary summary = {0};
    for (size_t n = 0; n < 2 * COUNT(stands); n++) {
        reference_scene scene = model_scene(
            dims, SNOW_TYPE_UINT8, true, (model_matrix)(n % MODEL_MATRICES), n);
        stand_at(&scene, n, 1);
        scene.view.width = 24;
        scene.view.height = 18;
        scene.settings.opacity_length = lengths[n % COUNT(lengths)];
        scene.settings.threshold = thresholds[n % COUNT(thresholds)];
        model_check(&stage, &scene, BOUND, &summary);
        model_free(&scene);
    }
    model_report(&summary);
    model_close(&stage);
}

/* Less shear than a pixel over all slices, yet more than the footprint tables
 * may leave out of account from one slice to the next. */
static void slices_that_are_shifted_a_little(void **state) {
    (void)state;
    model_stage stage = model_open();
    model_summary summary = {0};
    for (size_t n = 0; n < COUNT(kernels); n++) {
        reference_scene scene = model_scene(
            (int64_t[]){9, 8, 64}, SNOW_TYPE_UINT8, true, MODEL_PLAIN, n);
        scene.info.matrix[0][2] = 0.003;
        scene.settings.kernel = kernels[n];
        scene.settings.footprint = 3;
        model_turn(&scene, 0, 0, 0, 3);
        model_check(&stage, &scene, 1e-5, &summary);
        model_free(&scene);
    }
    model_report(&summary);
    model_close(&stage);
}

/* Only the direction of a gradient counts, however small or large it is. */
static void values_of_any_magnitude_are_shaded_alike(void **state) {
    (void)state;
    static const double scales[] = {1, 0x1p-560, 0x1p900};
    model_stage stage = model_open();
    float *first = NULL;
    for (size_t n = 0; n < COUNT(scales); n++) {
        reference_scene scene =
            model_scene(dims, SNOW_TYPE_FLOAT64, true, MODEL_OBLIQUE, 5);
        size_t voxels = (size_t)(dims[0] * dims[1] * dims[2]);
        double *scaled = malloc(voxels * sizeof *scaled);
        assert_non_null(scaled);
        for (size_t i = 0; i < voxels; i++)
            scaled[i] = ((const double *)scene.voxels)[i] * scales[n];
        const void *own = scene.voxels;
        scene.voxels = scaled;
        scene.info.slope /= scales[n];
        model_turn(&scene, 30, 20, 0, 1);
        float *picture = model_picture(&stage, &scene);
        for (int i = 0; first && i < 64 * 48 * 4; i++)
            assert_near((double)picture[i], (double)first[i], 1e-6);
        if (first)
            free(picture);
        else
            first = picture;
        free(scaled);
        scene.voxels = own;
        model_free(&scene);
    }
    free(first);
    model_close(&stage);
}

static void transfer_functions_of_any_shape(void **state) {
    (void)state;
    static const snow_opacity_point one[] = {{50, 0.4}};
    static const snow_opacity_point teeth[] = {{10, 0}, {20, 1}, {20, 0},
                                               {50, 1}, {50, 0}, {50, 0.3},
                                               {90, 0}, {90, 1}};
    static const snow_color_point red[] = {{1e9, 1, 0, 0}};
    static const snow_color_point steps[] = {
        {30, 1, 0, 0}, {30, 0, 1, 0}, {60, 0, 0, 1}, {60, 1, 1, 1}};
    model_stage stage = model_open();
    model_summary summary = {0};
    for (size_t n = 0; n < 4 * COUNT(types); n++) {
        reference_scene scene = model_scene(
            dims, types[n / 4], false, (model_matrix)(n % MODEL_MATRICES), n);
        scene.opacities = n % 2 == 0 ? one : teeth;
        scene.opacity_count = n % 2 == 0 ? COUNT(one) : COUNT(teeth);
        scene.colors = n / 2 % 2 == 0 ? red : steps;
        scene.color_count = n / 2 % 2 == 0 ? COUNT(red) : COUNT(steps);
        scene.view.width = 24;
        scene.view.height = 18;
        stand_at(&scene, n, 1);
        model_check(&stage, &scene, BOUND, &summary);
        free((void *)(uintptr_t)scene.voxels);
    }
    model_report(&summary);
    model_close(&stage);
}

/* Values of 0 and below among them; int8 has a negative intercept here. */
static void logarithmic_scales(void **state) {
    (void)state;
    static const snow_opacity_point points[] = {
        {0.5, 0.1}, {4, 0}, {40, 0.3}, {40, 0}, {95, 0.8}};
    static const snow_color_point colors[] = {
        {1, 1, 0, 0}, {10, 0, 1, 0.5}, {100, 0, 0.3, 1}};
    model_stage stage = model_open();
    model_summary summary = {0};
    for (size_t n = 0; n < 3 * COUNT(types); n++) {
        reference_scene scene = model_scene(
            dims, types[n / 3], false, (model_matrix)(n % MODEL_MATRICES), n);
        scene.log = true;
        scene.opacities = points;
        scene.opacity_count = COUNT(points);
        scene.colors = colors;
        scene.color_count = COUNT(colors);
        scene.info.intercept -= n % 3 == 2 ? 30 : 0;
        scene.view.width = 24;
        scene.view.height = 18;
        stand_at(&scene, n, 1);
        model_check(&stage, &scene, BOUND, &summary);
        free((void *)(uintptr_t)scene.voxels);
    }
    model_report(&summary);
    model_close(&stage);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kernel_and_footprint_from_every_side),
        cmocka_unit_test(pixels_that_lie_on_the_grid),
        cmocka_unit_test(every_type_matrix_threshold_and_shading),
        cmocka_unit_test(every_size_of_picture),
        cmocka_unit_test(volumes_thin_along_some_axes),
        cmocka_unit_test(small_kernels_that_are_widened_a_little),
        cmocka_unit_test(slices_and_rows_that_are_large),
        cmocka_unit_test(voxels_that_are_no_numbers_or_infinite),
        cmocka_unit_test(lights_from_all_sides_and_every_coefficient),
        cmocka_unit_test(opacities_of_other_lengths_than_a_voxel),
        cmocka_unit_test(slices_that_are_shifted_a_little),
        cmocka_unit_test(values_of_any_magnitude_are_shaded_alike),
        cmocka_unit_test(transfer_functions_of_any_shape),
        cmocka_unit_test(logarithmic_scales),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
