/* tests/render/test_gradient_opacity.c - gradient opacity: pictures of
 * footprints equal the reference's, what is even vanishes, and a magnitude is
 * in data units a millimetre.
 *
 * Those of shear-warp are test_truth.c's, their bits test_same_bits.c's; parts
 * and ranks are test_deterministic.c's and test_ranks.c's. */
#include "reference/model.h"

#include "classify/count_interesting.h"

#include <math.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const snow_method methods[] = {SNOW_METHOD_ORIGINAL, SNOW_METHOD_TESTED,
                                      SNOW_METHOD_FOOTPRINT,
                                      SNOW_METHOD_SHEAR_WARP};
static const double thresholds[] = {0, 10, 30};
static const int64_t dims[3] = {13, 10, 15};

/* A scene of some type and matrix, with a curve; `n` decides the rest. */
static reference_scene numbered_scene(size_t n) {
    reference_scene scene =
        model_scene(dims, model_type(n), n / 2 % 2 == 0,
                    (model_matrix)(n / 3 % MODEL_MATRICES), n);
    model_fade(&scene);
    scene.view.width = 24;
    scene.view.height = 18;
    model_stand_at(&scene, n, n % 5 == 4 ? 2 : 1);
    scene.settings.shade = n / 7 % 2 ? SNOW_SHADE_NONE : SNOW_SHADE_PHONG;
    scene.settings.encoding = (snow_encoding)(n % 4);
    scene.settings.threads = 1 + (int)(n % 3);
    return scene;
}

/* --- pictures ------------------------------------------------------------- */

static void the_footprint_methods_make_the_references_picture(void **state) {
    model_stage *stage = *state;
    for (size_t n = 0; n < 240; n++) {
        if (!support_takes(n, 13))
            continue;
        reference_scene scene = numbered_scene(n);
        scene.settings.method = methods[n % 3];
        if (scene.settings.method != SNOW_METHOD_ORIGINAL)
            scene.settings.threshold = thresholds[n / 3 % 3];
        scene.view.fov = n / 11 % 3 == 2 ? 35 : 0;
        model_check(stage, &scene, 1e-3);
        model_free(&scene);
    }
}

static void curves_of_any_shape(void **state) {
    static const snow_opacity_point one[] = {{5, 0.4}};
    static const snow_opacity_point tooth[] = {{4, 0}, {8, 1}, {12, 0}};
    static const snow_opacity_point last[] = {{-3, 0}, {10, 0}, {10, 1}};
    static snow_opacity_point many[200];
    static const struct {
        const snow_opacity_point *points;
        size_t count;
    } curves[] = {{one, 1}, {tooth, 3}, {last, 3}, {many, COUNT(many)}};
    for (size_t n = 0; n < COUNT(many); n++)
        many[n] = (snow_opacity_point){(double)n / 7, (double)(n % 5) / 4};
    model_stage *stage = *state;
    for (size_t n = 0; n < 48; n++) {
        if (!support_takes(n, 5))
            continue;
        reference_scene scene = numbered_scene(n);
        scene.gradients = curves[n % 4].points;
        scene.gradient_count = curves[n % 4].count;
        model_check(stage, &scene, 1e-3);
        model_free(&scene);
    }
}

/* Beside voxels that are no numbers differences are one-sided. */
static void voxels_that_are_no_numbers_or_infinite(void **state) {
    static const float odd[] = {NAN, INFINITY, -INFINITY};
    model_stage *stage = *state;
    uint64_t random = 5;
    for (size_t n = 0; n < 24; n++) {
        reference_scene scene = numbered_scene(n), like = scene;
        scene = model_scene(dims, SNOW_TYPE_FLOAT32, false, MODEL_OBLIQUE, n);
        model_fade(&scene);
        scene.view = like.view;
        scene.settings = like.settings;
        model_free(&like);
        for (int i = 0; i < 300; i++)
            model_voxels(&scene)[support_random(&random) % 1950] = odd[i % 3];
        scene.settings.method = methods[n % 3];
        model_check(stage, &scene, 1e-3);
        model_free(&scene);
    }
}

/* --- what is even --------------------------------------------------------- */

/* Two halves, of value 1 and 2, of one opacity, seen along their border's
 * normal: two slices have a gradient, of 1/2, and the others none. */
static void what_is_even_vanishes_and_a_border_stays(void **state) {
    static const snow_opacity_point curve[] = {{0, 0}, {0.5, 1}};
    const double opacity = 0.3, seen = 1 - 0.7 * 0.7;
    /* Slabs beside the border have half its gradient in their middle, or at 15
     * and 17 of 32, where the opacity is. */
    const double between = 1 - 0.7 * (1 - 0.3 * 15 / 32) * (1 - 0.3 * 17 / 32);
    model_stage *stage = *state;
    for (size_t m = 0; m < COUNT(methods); m++)
        for (int border = 0; border < 2; border++) {
            reference_scene scene =
                model_blank((int64_t[]){20, 20, 20}, opacity);
            for (int n = 0; n < 8000; n++)
                model_voxels(&scene)[n] = border && n >= 4000 ? 2 : 1;
            scene.gradients = curve;
            scene.gradient_count = COUNT(curve);
            scene.settings.method = methods[m];
            scene.settings.shade = m % 2 ? SNOW_SHADE_PHONG : SNOW_SHADE_NONE;
            float *picture = model_picture(stage, &scene);
            const snow_stats *stats = snow_frame_stats(stage->frame);
            assert_int_equal(stats->interesting, border ? 800 : 0);
            bool values = methods[m] == SNOW_METHOD_SHEAR_WARP;
            double wanted = values ? between : seen;
            float middle = picture[4 * (24 * 64 + 32) + 3];
            assert_near((double)middle, border ? wanted : 0,
                        values ? 0.25 / 255 : 1e-6);
            for (int n = 0; !border && n < 64 * 48 * 4; n++)
                assert_true(picture[n] == 0);
            free(picture);
            model_free(&scene);
        }
}

static void magnitudes_are_in_data_units_a_millimetre(void **state) {
    /* 3 native units from voxel to voxel along y, 1.5 mm apart, times 4. */
    static const snow_opacity_point below[] = {{8.001, 0}, {8.001, 1}};
    static const snow_opacity_point above[] = {{7.999, 0}, {7.999, 1}};
    model_stage *stage = *state;
    for (int n = 0; n < 2; n++) {
        reference_scene scene = model_blank((int64_t[]){6, 6, 6}, 0.5);
        for (int at = 0; at < 216; at++)
            model_voxels(&scene)[at] = (float)(10 + 3 * (at / 6 % 6));
        scene.info.slope = -4;
        scene.info.intercept = 1000;
        scene.info.matrix[1][1] = 1.5;
        scene.gradients = n ? above : below;
        scene.gradient_count = 2;
        free(model_picture(stage, &scene));
        assert_int_equal(snow_frame_stats(stage->frame)->interesting,
                         n ? 216 : 0);
        model_free(&scene);
    }
}

/* A curve of ones is none: not a bit changes, and nothing is stored for it. */
static void a_curve_of_ones_changes_nothing(void **state) {
    static const snow_opacity_point ones[] = {{0, 1}, {255, 1}};
    model_stage *stage = *state;
    for (size_t n = 0; n < 24; n++) {
        reference_scene scene = numbered_scene(n);
        size_t bytes =
            (size_t)scene.view.width * (size_t)scene.view.height * 16;
        scene.settings.method = methods[n % 4];
        scene.gradient_count = 0;
        float *without = model_picture(stage, &scene);
        snow_stats before = *snow_frame_stats(stage->frame);
        scene.gradients = ones;
        scene.gradient_count = 2;
        float *with = model_picture(stage, &scene);
        assert_memory_equal(with, without, bytes);
        assert_int_equal(snow_frame_stats(stage->frame)->ia_bytes,
                         before.ia_bytes);
        free(with);
        free(without);
        model_free(&scene);
    }
}

/* --- interesting voxels --------------------------------------------------- */

/* What the reference finds: voxels with a sample. */
static int64_t count_samples(const reference_scene *scene) {
    reference_camera camera;
    reference_camera_of(scene, &camera);
    double *samples = reference_samples(scene, &camera, 2);
    int64_t count = 0;
    for (int n = 0; n < 13 * 10 * 15; n++)
        count += samples[4 * n + 3] > 0;
    free(samples);
    return count;
}

static void all_methods_find_the_same_voxels_interesting(void **state) {
    model_stage *stage = *state;
    for (size_t n = 0; n < 60; n++) {
        if (!support_takes(n, 13))
            continue;
        reference_scene scene = numbered_scene(n);
        scene.settings.threshold = thresholds[n % 3];
        int64_t expected = count_samples(&scene);
        assert_true(expected > 20 && expected < 1500);
        for (size_t m = 0; m < COUNT(methods); m++) {
            scene.settings.method = methods[m];
            free(model_picture(stage, &scene));
            const snow_stats *stats = snow_frame_stats(stage->frame);
            assert_int_equal(stats->interesting, expected);
        }
        double ratio;
        snow_volume *volume = model_volume(stage->context, &scene);
        snow_transfer *transfer = model_transfer(stage->context, &scene);
        assert_int_equal(snow_transfer_sparse_ratio(transfer, volume,
                                                    scene.settings.threshold,
                                                    &ratio),
                         SNOW_STATUS_OK);
        assert_near(ratio, 1 - (double)expected / (13 * 10 * 15), 1e-12);
        snow_transfer_free(transfer);
        snow_volume_close(volume);
        model_free(&scene);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        MODEL_TEST(the_footprint_methods_make_the_references_picture),
        MODEL_TEST(curves_of_any_shape),
        MODEL_TEST(voxels_that_are_no_numbers_or_infinite),
        MODEL_TEST(what_is_even_vanishes_and_a_border_stays),
        MODEL_TEST(magnitudes_are_in_data_units_a_millimetre),
        MODEL_TEST(a_curve_of_ones_changes_nothing),
        MODEL_TEST(all_methods_find_the_same_voxels_interesting),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
