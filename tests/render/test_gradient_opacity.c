/* tests/render/test_gradient_opacity.c - gradient opacity: pictures of all
 * methods equal the reference's, what is even vanishes, and stored factors are
 * as good as said.
 *
 * Bits (encodings, threads, levels) are test_shear_warp_bits.c's, perspective
 * is test_shear_warp_perspective.c's, parts and ranks are
 * test_deterministic.c's and test_ranks.c's. */
#include "reference/shear_warp.h"

#include "classify/count_interesting.h"
#include "classify/gradient_opacity.h"
#include "classify/sample/sample.h"

#include <math.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const snow_type types[] = {
    SNOW_TYPE_INT8,    SNOW_TYPE_UINT8,   SNOW_TYPE_INT16, SNOW_TYPE_UINT16,
    SNOW_TYPE_INT32,   SNOW_TYPE_UINT32,  SNOW_TYPE_INT64, SNOW_TYPE_UINT64,
    SNOW_TYPE_FLOAT32, SNOW_TYPE_FLOAT64,
};
static const snow_method methods[] = {SNOW_METHOD_ORIGINAL, SNOW_METHOD_TESTED,
                                      SNOW_METHOD_FOOTPRINT,
                                      SNOW_METHOD_SHEAR_WARP};
static const model_stand stands[] = {
    {{0, 0, 1}, {0, 1, 0}, 0, 0, 0},      {{0, -1, 0}, {0, 0, 1}, 0, 0, 0},
    {{1, 0, 0}, {0, 0, 1}, 0, 0, 0},      {{0, 0, 1}, {0, 1, 0}, 30, 20, 0},
    {{0, 0, 1}, {0, 1, 0}, 10, 80, 0},    {{0, 1, 0}, {0, 0, 1}, -120, -35, 25},
    {{-1, 0, 0}, {0, 0, 1}, 20, -15, 90}, {MODEL_ISO, 0, 0, 0},
};
static const double thresholds[] = {0, 10, 30};
static const int64_t dims[3] = {13, 10, 15};

/* A scene of some type and matrix, with a curve; `n` decides the rest. */
static reference_scene numbered_scene(size_t n, const int64_t size[3]) {
    reference_scene scene =
        model_scene(size, types[n % COUNT(types)], n / 2 % 2 == 0,
                    (model_matrix)(n / 3 % MODEL_MATRICES), n);
    model_fade(&scene);
    scene.view.width = 24;
    scene.view.height = 18;
    model_stand_at(&scene, &stands[n % COUNT(stands)], n % 5 == 4 ? 2 : 1);
    scene.settings.shade = n / 7 % 2 ? SNOW_SHADE_NONE : SNOW_SHADE_PHONG;
    scene.settings.encoding = (snow_encoding)(n % 4);
    scene.settings.threads = 1 + (int)(n % 3);
    return scene;
}

/* --- pictures ------------------------------------------------------------- */

static void the_exact_methods_make_the_references_picture(void **state) {
    (void)state;
    model_stage stage = model_open();
    model_tally tally = {0};
    for (size_t n = 0; n < 240; n += support_stride(7)) {
        reference_scene scene = numbered_scene(n, dims);
        scene.settings.method = methods[n % 3];
        if (scene.settings.method != SNOW_METHOD_ORIGINAL)
            scene.settings.threshold = thresholds[n / 3 % 3];
        scene.view.fov = n / 11 % 3 == 2 ? 35 : 0;
        model_check(&stage, &scene, 1e-3, &tally);
        model_free(&scene);
    }
    model_report(&tally);
    model_close(&stage);
}

static void the_sheared_method_makes_its_models_picture(void **state) {
    (void)state;
    model_stage stage = model_open();
    sheared_tally tally = {0};
    for (size_t n = 0; n < 360; n += support_stride(7)) {
        reference_scene scene = numbered_scene(n, dims);
        scene.settings.method = SNOW_METHOD_SHEAR_WARP;
        scene.settings.quality = (snow_quality)(n / 5 % 3);
        scene.settings.threshold = thresholds[n / 2 % 3];
        /* Half of them stay translucent all through. */
        scene.settings.opacity_length = n % 2 ? 4 : 0;
        sheared_check(&stage, &scene, NULL, SHEARED_BOUND, &tally);
        model_free(&scene);
    }
    sheared_report("gradient opacity", &tally);
    assert_true(tally.clear * support_sweep(1, 7) > 100);
    model_close(&stage);
}

/* Between slabs a gradient reaches across, too. */
static void slabs_have_the_gradients_of_the_whole(void **state) {
    (void)state;
    model_stage stage = model_open();
    sheared_tally tally = {0};
    for (size_t n = 0; n < 40; n++) {
        reference_scene scene = numbered_scene(n, (int64_t[]){20, 17, 26});
        scene.settings.method = SNOW_METHOD_SHEAR_WARP;
        scene.settings.quality = (snow_quality)(n % 3);
        sheared_options options = {.parts = 3, .part = (int)(n % 3)};
        sheared_check(&stage, &scene, &options, SHEARED_BOUND, &tally);
        model_free(&scene);
    }
    sheared_report("slabs", &tally);
    model_close(&stage);
}

static void curves_of_any_shape(void **state) {
    (void)state;
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
    model_stage stage = model_open();
    model_tally exact = {0};
    sheared_tally sheared = {0};
    for (size_t n = 0; n < 48; n++) {
        reference_scene scene = numbered_scene(n, dims);
        scene.gradients = curves[n % 4].points;
        scene.gradient_count = curves[n % 4].count;
        model_check(&stage, &scene, 1e-3, &exact);
        scene.settings.method = SNOW_METHOD_SHEAR_WARP;
        sheared_check(&stage, &scene, NULL, SHEARED_BOUND, &sheared);
        model_free(&scene);
    }
    model_report(&exact);
    sheared_report("curves", &sheared);
    model_close(&stage);
}

/* Beside voxels that are no numbers differences are one-sided. */
static void voxels_that_are_no_numbers_or_infinite(void **state) {
    (void)state;
    static const float odd[] = {NAN, INFINITY, -INFINITY};
    model_stage stage = model_open();
    model_tally tally = {0};
    uint64_t random = 5;
    for (size_t n = 0; n < 24; n++) {
        reference_scene scene = numbered_scene(n, dims);
        reference_scene real =
            model_scene(dims, SNOW_TYPE_FLOAT32, false, MODEL_OBLIQUE, n);
        scene.info = real.info;
        free((void *)(uintptr_t)scene.voxels);
        scene.voxels = real.voxels;
        for (int i = 0; i < 300; i++)
            model_voxels(&scene)[support_random(&random) % 1950] = odd[i % 3];
        scene.settings.method = methods[n % 3];
        model_check(&stage, &scene, 1e-3, &tally);
        model_free(&scene);
    }
    model_report(&tally);
    model_close(&stage);
}

/* --- what is even --------------------------------------------------------- */

/* Two halves, of value 1 and 2, of one opacity, seen along their border's
 * normal: two slices have a gradient, of 1/2, and the others none. */
static void what_is_even_vanishes_and_a_border_stays(void **state) {
    (void)state;
    static const snow_opacity_point curve[] = {{0, 0}, {0.5, 1}};
    const double opacity = 0.3, seen = 1 - 0.7 * 0.7;
    model_stage stage = model_open();
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
            float *picture = model_picture(&stage, &scene);
            const snow_stats *stats = snow_frame_stats(stage.frame);
            assert_int_equal(stats->interesting, border ? 800 : 0);
            float middle = picture[4 * (24 * 64 + 32) + 3];
            assert_near((double)middle, border ? seen : 0, 1e-6);
            for (int n = 0; !border && n < 64 * 48 * 4; n++)
                assert_true(picture[n] == 0);
            free(picture);
            model_free(&scene);
        }
    model_close(&stage);
}

static void magnitudes_are_in_data_units_a_millimetre(void **state) {
    (void)state;
    /* 3 native units from voxel to voxel along y, 1.5 mm apart, times 4. */
    static const snow_opacity_point below[] = {{8.001, 0}, {8.001, 1}};
    static const snow_opacity_point above[] = {{7.999, 0}, {7.999, 1}};
    model_stage stage = model_open();
    for (int n = 0; n < 2; n++) {
        reference_scene scene = model_blank((int64_t[]){6, 6, 6}, 0.5);
        for (int at = 0; at < 216; at++)
            model_voxels(&scene)[at] = (float)(10 + 3 * (at / 6 % 6));
        scene.info.slope = -4;
        scene.info.intercept = 1000;
        scene.info.matrix[1][1] = 1.5;
        scene.gradients = n ? above : below;
        scene.gradient_count = 2;
        free(model_picture(&stage, &scene));
        assert_int_equal(snow_frame_stats(stage.frame)->interesting,
                         n ? 216 : 0);
        model_free(&scene);
    }
    model_close(&stage);
}

/* A curve of ones is none: not a bit changes, and nothing is stored for it. */
static void a_curve_of_ones_changes_nothing(void **state) {
    (void)state;
    static const snow_opacity_point ones[] = {{0, 1}, {255, 1}};
    model_stage stage = model_open();
    for (size_t n = 0; n < 24; n++) {
        reference_scene scene = numbered_scene(n, dims);
        size_t bytes =
            (size_t)scene.view.width * (size_t)scene.view.height * 16;
        scene.settings.method = methods[n % 4];
        scene.gradient_count = 0;
        float *without = model_picture(&stage, &scene);
        snow_stats before = *snow_frame_stats(stage.frame);
        scene.gradients = ones;
        scene.gradient_count = 2;
        float *with = model_picture(&stage, &scene);
        assert_memory_equal(with, without, bytes);
        assert_int_equal(snow_frame_stats(stage.frame)->ia_bytes,
                         before.ia_bytes);
        free(with);
        free(without);
        model_free(&scene);
    }
    model_close(&stage);
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
    (void)state;
    model_stage stage = model_open();
    for (size_t n = 0; n < 60; n += support_stride(7)) {
        reference_scene scene = numbered_scene(n, dims);
        scene.settings.threshold = thresholds[n % 3];
        int64_t expected = count_samples(&scene);
        assert_true(expected > 20 && expected < 1500);
        for (size_t m = 0; m < COUNT(methods); m++) {
            scene.settings.method = methods[m];
            free(model_picture(&stage, &scene));
            const snow_stats *stats = snow_frame_stats(stage.frame);
            assert_int_equal(stats->interesting, expected);
        }
        snow_volume *volume = NULL;
        double ratio;
        snow_transfer *transfer = model_transfer(stage.context, &scene);
        assert_int_equal(
            snow_volume_wrap(stage.context, &scene.info, scene.voxels, &volume),
            SNOW_STATUS_OK);
        assert_int_equal(snow_transfer_sparse_ratio(transfer, volume,
                                                    scene.settings.threshold,
                                                    &ratio),
                         SNOW_STATUS_OK);
        assert_near(ratio, 1 - (double)expected / (13 * 10 * 15), 1e-12);
        snow_transfer_free(transfer);
        snow_volume_close(volume);
        model_free(&scene);
    }
    model_close(&stage);
}

/* --- stored factors ------------------------------------------------------- */

/* A stack of voxels of one opacity and one small factor is where a stored
 * factor's error adds up most. */
static void a_stack_is_off_by_less_than_a_quarter_step(void **state) {
    (void)state;
    enum { SLICES = 2000 };
    model_stage stage = model_open();
    double largest = 0;
    for (double factor = 1e-7; factor < 1; factor *= 1.3)
        for (int n = 0; n < 3; n++) {
            reference_scene scene =
                model_blank((int64_t[]){5, 5, SLICES}, n ? 0.2 * n : 1);
            snow_opacity_point curve[] = {{0, factor}};
            for (int at = 0; at < 25 * SLICES; at++)
                model_voxels(&scene)[at] = 1;
            scene.gradients = curve;
            scene.gradient_count = 1;
            scene.settings.method = SNOW_METHOD_SHEAR_WARP;
            /* Thin slices: all of them together are a few voxels deep. */
            scene.info.matrix[2][2] = 0.01;
            scene.settings.opacity_length = n == 2 ? 0.05 : 0;
            double opacity = (n ? 0.2 * n : 1) * factor;
            double exact = 1 - pow(1 - opacity, SLICES * (n == 2 ? 0.2 : 1));
            scene.view.width = scene.view.height = 32;
            float *picture = model_picture(&stage, &scene);
            double off = fabs((double)picture[4 * (16 * 32 + 16) + 3] - exact);
            largest = fmax(largest, off);
            if (!(off < SHEARED_BOUND + (exact > 0.99 ? 0.5 / 255 : 0)))
                fail_msg("off by %g of %g with factor %g, opacity %d", off,
                         exact, factor, n);
            free(picture);
            model_free(&scene);
        }
    print_message("             stacks of %d are off by up to %.2g\n", SLICES,
                  largest);
    model_close(&stage);
}

/* As classify/gradient_opacity.h draws it. */
static double factor_of(uint16_t code) {
    double x = code / 65535.0;
    return x < 0.5 ? 2 * x * x : 1 - 2 * (1 - x) * (1 - x);
}

/* Over a row whose gradient grows evenly from 0 to 1. */
static void stored_factors_are_as_near_as_said(void **state) {
    (void)state;
    static const snow_opacity_point curve[] = {{0, 0}, {1, 1}};
    enum { VOXELS = 4001 };
    float values[VOXELS];
    uint32_t columns[VOXELS];
    uint16_t codes[VOXELS];
    snow_context *context = support_context();
    snow_volume_info info = {
        .size = sizeof info, .dims = {VOXELS, 1, 1}, .type = SNOW_TYPE_FLOAT32};
    reference_scene scene = model_blank((int64_t[]){2, 2, 2}, 0.5);
    scene.gradients = curve;
    scene.gradient_count = COUNT(curve);
    snow_transfer *transfer = model_transfer(context, &scene);
    snow_volume *volume = NULL;
    snow_gradient_opacity fader;
    /* Differences grow from voxel to voxel: the gradient is n / VOXELS. */
    double value = 1;
    for (uint32_t n = 0; n < VOXELS; n++) {
        values[n] = (float)value;
        value += (n + 0.5) / VOXELS;
        columns[n] = n;
    }
    assert_int_equal(snow_volume_wrap(context, &info, values, &volume),
                     SNOW_STATUS_OK);
    snow_placement placement = {.slice_axis = 2,
                                .u_axis = 0,
                                .v_axis = 1,
                                .columns = VOXELS,
                                .rows = 1,
                                .slices = 1};
    snow_gradient_opacity_row row = {.placement = &placement};
    assert_int_equal(snow_gradient_opacity_init(context, volume, transfer, 0,
                                                SNOW_ISA_AUTO, &fader),
                     SNOW_STATUS_OK);
    snow_gradient_opacity_codes(&fader, &row, values, columns, VOXELS, codes);
    for (int n = 1; n + 1 < VOXELS; n++) {
        double g = fmin(((double)values[n + 1] - (double)values[n - 1]) / 2, 1);
        double least = fmin(g, 1 - g) + 1e-9; /* 1: of half a step */
        assert_near(factor_of(codes[n]), g, sqrt(2 * least) / 65535);
        assert_near((double)snow_gradient_opacity_of(codes[n]),
                    factor_of(codes[n]), 1e-7);
    }
    assert_true(snow_gradient_opacity_of(65535) == 1);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
    model_free(&scene);
}

/* Opacities at splat time, by every level, for exponents of all sizes. */
static void opacities_of_factors_are_those_of_doubles(void **state) {
    (void)state;
    enum { CODES = 256, VOXELS = 48 };
    static snow_sample_room room;
    static float palette[(CODES + 1) * 2], first[VOXELS * 2 + 64];
    unsigned char codes[VOXELS + 128];
    uint16_t fades[VOXELS + 128];
    uint64_t random = 9;
    double largest = 0, share = 0;
    for (int n = 0; n < CODES; n++)
        palette[2 * (n + 1) + 1] = (float)(n / 255.0);
    for (int n = 0; n < 20000; n++) {
        for (int i = 0; i < VOXELS + 128; i++) {
            double root = support_uniform(&random);
            codes[i] =
                (unsigned char)(i % 9 ? support_random(&random) >> 40 : 255);
            fades[i] =
                (uint16_t)(i % 7 ? 65535 * pow(root, n % 5 + 0.2) : 65535);
        }
        uint64_t held = 1, bits[1] = {(UINT64_C(1) << VOXELS) - 1};
        uint32_t before[1] = {0};
        const unsigned char *code_rows[1] = {codes};
        const uint16_t *apply_gradient_opacity_rows[1] = {fades};
        float exponent = (float)exp(6 * (2 * support_uniform(&random) - 1));
        for (int isa = SNOW_ISA_SCALAR; isa <= SNOW_ISA_AVX512; isa++) {
            float samples[VOXELS * 2 + 64];
            if (!snow_isa_runs((snow_isa)isa))
                continue;
            snow_sample_job job = {
                held,    VOXELS,  bits,        code_rows,
                NULL,    before,  palette + 2, NULL,
                &room,   samples, VOXELS * 2,  apply_gradient_opacity_rows,
                exponent};
            snow_sample_of((snow_isa)isa, 1, 2, false, true)(&job);
            if (isa == SNOW_ISA_SCALAR)
                memcpy(first, samples, VOXELS * 2 * sizeof *first);
            assert_memory_equal(first, samples, VOXELS * 2 * sizeof *first);
            for (int i = 0; i < VOXELS && isa == SNOW_ISA_SCALAR; i++) {
                double p =
                    (double)palette[2 * codes[i] + 3] * factor_of(fades[i]);
                double e = (double)exponent, got = (double)samples[2 * i + 1];
                double exact = -expm1(e * log1p(-p));
                /* Rounding p to single precision may move it so far. */
                double low = -expm1(e * log1p(-p * (1 - 1e-7)));
                double high = -expm1(e * log1p(-fmin(p * (1 + 1e-7), 1)));
                double off = fmax(fmax(low - got, got - high), 0);
                largest = fmax(largest, off);
                if (exact > 1e-30)
                    share = fmax(share, off / exact);
            }
        }
    }
    print_message("             off by up to %.2g, %.2g of themselves\n",
                  largest, share);
    assert_true(largest < 4e-7 && share < 1e-6);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_exact_methods_make_the_references_picture),
        cmocka_unit_test(the_sheared_method_makes_its_models_picture),
        cmocka_unit_test(slabs_have_the_gradients_of_the_whole),
        cmocka_unit_test(curves_of_any_shape),
        cmocka_unit_test(voxels_that_are_no_numbers_or_infinite),
        cmocka_unit_test(what_is_even_vanishes_and_a_border_stays),
        cmocka_unit_test(magnitudes_are_in_data_units_a_millimetre),
        cmocka_unit_test(a_curve_of_ones_changes_nothing),
        cmocka_unit_test(all_methods_find_the_same_voxels_interesting),
        cmocka_unit_test(a_stack_is_off_by_less_than_a_quarter_step),
        cmocka_unit_test(stored_factors_are_as_near_as_said),
        cmocka_unit_test(opacities_of_factors_are_those_of_doubles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
