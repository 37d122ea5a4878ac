/* tests/render/test_modes.c - pictures in modes other than over equal the
 * reference's.
 */
#include "image/image.h"
#include "reference/model.h"
#include "simd/isa.h"

#include <math.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const snow_mode modes[] = {SNOW_MODE_MIP, SNOW_MODE_MINIP,
                                  SNOW_MODE_MEAN, SNOW_MODE_SUM};
static const snow_type types[] = {
    SNOW_TYPE_INT8,    SNOW_TYPE_UINT8,   SNOW_TYPE_INT16, SNOW_TYPE_UINT16,
    SNOW_TYPE_INT32,   SNOW_TYPE_UINT32,  SNOW_TYPE_INT64, SNOW_TYPE_UINT64,
    SNOW_TYPE_FLOAT32, SNOW_TYPE_FLOAT64,
};
static const snow_kernel kernels[] = {SNOW_KERNEL_BSPLINE, SNOW_KERNEL_TENT,
                                      SNOW_KERNEL_GAUSS, SNOW_KERNEL_BOX};
static const model_stand stands[] = {
    {{0, 0, 1}, {0, 1, 0}, 0, 0, 0},
    {{0, 0, -1}, {0, 1, 0}, 0, 0, 0},
    {{0, 1, 0}, {0, 0, 1}, 0, 0, 0},
    {{1, 0, 0}, {0, 0, 1}, 0, 0, 90},
    {{0, 0, 1}, {0, 1, 0}, 30, 20, 0},
    {{0, 0, 1}, {0, 1, 0}, 45, 0, 0},
    {{0, 1, 0}, {0, 0, 1}, -120, -35, 25},
    {{1, 0, 0}, {0, 0, 1}, 90, 45, 0},
    {MODEL_ISO, 0, 0, 0},
};
static const double zooms[] = {0.3, 1, 4}, fovs[] = {5, 30, 60};
static const int64_t dims[3] = {13, 10, 15};

/* One colour map without steps, whose colours tell values apart. */
static const snow_color_point smooth[] = {
    {0, 0, 0.1, 0.9}, {50, 0.5, 0.8, 0.3}, {100, 1, 0.2, 0}};

static bool has_values(snow_mode mode) {
    return mode == SNOW_MODE_MEAN || mode == SNOW_MODE_SUM;
}

static size_t draw(uint64_t *state, size_t count) {
    return (size_t)(support_random(state) >> 33) % count;
}

/* A scene in a mode; every tenth of real numbers has holes. */
static reference_scene mode_scene(uint64_t *state, size_t n, snow_mode mode) {
    reference_scene scene = model_scene(
        dims, types[n % COUNT(types)], false,
        (model_matrix)(n / COUNT(types) % MODEL_MATRICES), draw(state, 99));
    scene.colors = smooth;
    scene.color_count = COUNT(smooth);
    scene.settings.mode = mode;
    scene.settings.kernel = kernels[draw(state, COUNT(kernels))];
    scene.settings.encoding = (snow_encoding)draw(state, 4);
    scene.view.width = 24, scene.view.height = 18;
    model_stand_at(&scene, &stands[draw(state, COUNT(stands))],
                   zooms[draw(state, COUNT(zooms))]);
    if (scene.info.type == SNOW_TYPE_FLOAT32 && draw(state, 2)) {
        float *voxels = (float *)(uintptr_t)scene.voxels;
        for (int at = 0; at < 13 * 10 * 15; at++)
            if (draw(state, 20) == 0)
                voxels[at] = draw(state, 2) ? NAN : INFINITY;
    }
    return scene;
}

/* How a picture differs from the reference.  Where a sum of weights is about
 * 1/2, rounding decides whether there is a pixel. */
typedef struct mode_summary {
    size_t pixels, missing, shown;
    double largest, total;
} mode_summary;

static double size_of_value(const reference_scene *scene, double reference) {
    return scene->settings.mode == SNOW_MODE_SUM ? fmax(100, fabs(reference))
                                                 : 100;
}

static void compare(const reference_scene *scene, snow_image *image,
                    const double *reference, mode_summary *t) {
    bool values = has_values(scene->settings.mode);
    int channels = snow_image_channels(image);
    assert_int_equal(channels, values ? 1 : 4);
    const float *pixels = snow_image_pixels(image);
    size_t count = (size_t)scene->view.width * (size_t)scene->view.height;
    for (size_t n = 0; n < count; n++, pixels += channels) {
        const double *wanted = reference + n * (size_t)channels;
        bool here = values ? !isnan(pixels[0]) : pixels[3] == 1;
        bool there = values ? !isnan(wanted[0]) : wanted[3] == 1;
        t->pixels++;
        t->shown += there;
        t->missing += here != there;
        double most = 0;
        for (int c = 0; here && there && c < channels; c++)
            most =
                fmax(most, fabs((double)pixels[c] - wanted[c]) /
                               (values ? size_of_value(scene, wanted[c]) : 1));
        t->largest = fmax(t->largest, most);
        t->total += most;
    }
}

static void add_picture(const model_stage *stage, const reference_scene *scene,
                        mode_summary *t) {
    snow_image *image = model_image(stage, scene);
    double *reference = reference_mode(scene);
    compare(scene, image, reference, t);
    snow_image_free(image);
    free(reference);
}

static void report(const char *what, const mode_summary *t) {
    print_message("             %s: %zu of %zu pixels shown, differ by up to "
                  "%.2g, %.2g in the mean; %zu on one side only\n",
                  what, t->shown, t->pixels, t->largest,
                  t->total / (double)t->shown, t->missing);
}

/* In units of colour, or of a hundredth of the data's range. */
static void exact_pictures(double fov_share) {
    model_stage stage = model_open();
    for (size_t m = 0; m < COUNT(modes); m++) {
        mode_summary t = {0};
        for (size_t n = 0; n < COUNT(types) * MODEL_MATRICES * 3; n++) {
            if (!support_takes(n + 7 * m, 13))
                continue;
            uint64_t random = support_scene_random(11 + m, n);
            reference_scene scene = mode_scene(&random, n, modes[m]);
            if (fov_share > 0)
                scene.view.fov = fovs[draw(&random, COUNT(fovs))];
            else if (n % 4 == 0)
                scene.settings.method = SNOW_METHOD_ORIGINAL;
            add_picture(&stage, &scene, &t);
            model_free(&scene);
        }
        report(snow_mode_name(modes[m]), &t);
        assert_true(t.largest < 1e-3);
        assert_true(t.shown > t.pixels / 5);
        assert_true(t.missing * 1000 <= t.pixels);
    }
    model_close(&stage);
}

static void every_type_and_matrix_from_every_side(void **state) {
    (void)state;
    exact_pictures(0);
}

static void every_type_and_matrix_in_perspective(void **state) {
    (void)state;
    exact_pictures(1);
}

/* --- depth ---------------------------------------------------------------- */

static void compare_depth(const model_stage *stage,
                          const reference_scene *scene, mode_summary *t) {
    const snow_image *depth = snow_frame_depth(stage->frame);
    assert_non_null(depth);
    assert_int_equal(snow_image_channels(depth), 1);
    const float *pixels = depth->pixels;
    double *wanted = reference_depth(scene);
    for (int n = 0; n < scene->view.width * scene->view.height; n++) {
        bool here = !isnan(pixels[n]), there = !isnan(wanted[n]);
        t->pixels++;
        t->shown += there;
        t->missing += here != there;
        if (!here || !there)
            continue;
        double most = fabs((double)pixels[n] - wanted[n]);
        t->largest = fmax(t->largest, most);
        t->total += most;
    }
    free(wanted);
}

/* Opacity is as steep as the tables of weights let it be. */
static void depths_of_over(void **state) {
    (void)state;
    model_stage stage = model_open();
    mode_summary t = {0};
    for (size_t n = 0; n < COUNT(types) * MODEL_MATRICES * 3; n++) {
        if (!support_takes(n, 13))
            continue;
        uint64_t random = support_scene_random(31, n);
        reference_scene scene = mode_scene(&random, n, SNOW_MODE_OVER);
        scene.settings.depth = 1;
        if (n % 3 == 1) /* its depths are those of footprints, too */
            scene.settings.method = SNOW_METHOD_SHEAR_WARP;
        if (n % 4 == 0)
            scene.view.fov = fovs[draw(&random, COUNT(fovs))];
        snow_image_free(model_image(&stage, &scene));
        compare_depth(&stage, &scene, &t);
        model_free(&scene);
    }
    report("depth of over", &t);
    assert_true(t.shown > t.pixels / 20);
    assert_true(t.largest < 0.05);
    assert_true(t.total / (double)t.shown < 1e-3);
    assert_true(t.missing * 1000 <= t.pixels);
    model_close(&stage);
}

/* A picture of the engine of the paper, or of the test's caller. */
static snow_image *engine_picture(snow_context *context, snow_frame *frame,
                                  const snow_volume *volume,
                                  const snow_settings *settings, double fov) {
    const snow_look look = {.size = sizeof look, .preset = "linear"};
    snow_transfer *transfer = NULL;
    snow_image *image = NULL;
    snow_view view = {.size = sizeof view};
    assert_int_equal(snow_view_from_name(context, "+z", &view), SNOW_STATUS_OK);
    view.width = view.height = 128;
    view.azimuth = 30, view.elevation = 20, view.fov = fov;
    assert_int_equal(snow_transfer_new_for_volume(volume, &look, &transfer),
                     SNOW_STATUS_OK);
    assert_int_equal(
        snow_frame_render(frame, volume, transfer, &view, settings, &image),
        SNOW_STATUS_OK);
    snow_transfer_free(transfer);
    return image;
}

static snow_volume *open_phantom(snow_context *context, snow_type type) {
    static const int64_t sides[3] = {61, 50, 43};
    snow_volume_info info = {.size = sizeof info,
                             .dims = {61, 50, 43},
                             .type = type,
                             .slope = 1,
                             .spacing = {1, 1, 1.5},
                             .format = "memory",
                             .times = 1};
    snow_volume *volume = NULL;
    size_t count = 61 * 50 * 43;
    static float voxels[61 * 50 * 43];
    static unsigned char bytes[61 * 50 * 43];
    for (size_t n = 0; n < count; n++) {
        double p[3] = {(double)(n % 61) / (double)sides[0] - 0.5,
                       (double)(n / 61 % 50) / (double)sides[1] - 0.5,
                       (double)(n / 61 / 50) / (double)sides[2] - 0.5};
        double r = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        double ball = 1 / (1 + exp(40 * (r - 0.35)));
        double value = ball * (120 + 100 * sin(11 * p[0] + 7 * p[1]) *
                                         cos(9 * p[2] - 5 * p[0]));
        voxels[n] = (float)value;
        bytes[n] = (unsigned char)value;
    }
    info.matrix[0][0] = info.matrix[1][1] = info.matrix[3][3] = 1;
    info.matrix[2][2] = 1.5;
    assert_int_equal(snow_volume_wrap(context, &info,
                                      type == SNOW_TYPE_UINT8 ? (void *)bytes
                                                              : (void *)voxels,
                                      &volume),
                     SNOW_STATUS_OK);
    return volume;
}

/* The root of the mean square of differences, as a part of the largest value.
 */
static double distance_of(snow_image *a, snow_image *b) {
    int channels = snow_image_channels(a);
    size_t count = (size_t)(128 * 128);
    const float *p = snow_image_pixels(a), *q = snow_image_pixels(b);
    double squares = 0, most = 0, shown = 0;
    for (size_t n = 0; n < count; n++, p += channels, q += channels) {
        if (isnan(p[0]) || isnan(q[0]) || p[channels - 1] == 0 ||
            q[channels - 1] == 0)
            continue;
        double difference = (double)p[0] - (double)q[0];
        squares += difference * difference;
        most = fmax(most, fabs((double)q[0]));
        shown++;
    }
    assert_true(shown > 128 * 128 / 30);
    /* Colours are of 0 to 1, however dark a picture is. */
    return sqrt(squares / shown) / (channels > 1 ? 1 : most);
}

/* Of an object that ends within its volume, as most do: PSNR of 50 and 61 dB.
 */
static void shear_warp_pictures_of_smooth_data_are_near_to_rays(void **state) {
    (void)state;
    static const double bounds[] = {0.0032, 0.0032, 0.0009, 0.0009};
    model_stage stage = model_open();
    for (int n = 0; n < 4; n++) {
        snow_volume *volume = open_phantom(
            stage.context, n % 2 ? SNOW_TYPE_FLOAT32 : SNOW_TYPE_UINT8);
        double fov = n / 2 ? 30 : 0;
        for (size_t m = 0; m < COUNT(modes); m++) {
            snow_settings settings;
            snow_settings_init(&settings);
            settings.mode = modes[m];
            snow_image *fast = engine_picture(stage.context, stage.frame,
                                              volume, &settings, fov);
            assert_int_equal(snow_frame_stats(stage.frame)->method,
                             SNOW_METHOD_SHEAR_WARP);
            settings.method = SNOW_METHOD_RAYCAST;
            snow_image *exact = engine_picture(stage.context, stage.frame,
                                               volume, &settings, fov);
            double distance = distance_of(fast, exact);
            print_message("             %s, %g degrees: %.1f dB\n",
                          snow_mode_name(modes[m]), fov, -20 * log10(distance));
            assert_true(distance < bounds[m]);
            snow_image_free(fast);
            snow_image_free(exact);
        }
        snow_volume_close(volume);
    }
    model_close(&stage);
}

static uint64_t sum_of(const model_stage *stage, const snow_volume *volume,
                       const snow_settings *settings, double fov) {
    snow_image *image =
        engine_picture(stage->context, stage->frame, volume, settings, fov);
    uint64_t sum = snow_image_checksum(image);
    snow_image_free(image);
    return sum;
}

/* Footprints have no isosurface: values draw it. */
static void isosurfaces_are_of_values(void **state) {
    (void)state;
    static const snow_method methods[] = {
        SNOW_METHOD_ORIGINAL, SNOW_METHOD_TESTED, SNOW_METHOD_FOOTPRINT};
    model_stage stage = model_open();
    snow_volume *volume = open_phantom(stage.context, SNOW_TYPE_FLOAT32);
    snow_settings settings;
    snow_settings_init(&settings);
    settings.mode = SNOW_MODE_ISO;
    settings.iso = 90;
    settings.kernel = SNOW_KERNEL_TENT;
    uint64_t sum = sum_of(&stage, volume, &settings, 0);
    for (size_t n = 0; n < COUNT(methods); n++) {
        settings.method = methods[n];
        assert_true(sum_of(&stage, volume, &settings, 0) == sum);
        assert_int_equal(snow_frame_stats(stage.frame)->method,
                         SNOW_METHOD_SHEAR_WARP);
    }
    snow_volume_close(volume);
    model_close(&stage);
}

/* --- what must not change a bit ------------------------------------------- */

static void threads_and_encodings_change_no_bit(void **state) {
    (void)state;
    static const snow_method methods[] = {SNOW_METHOD_SHEAR_WARP,
                                          SNOW_METHOD_FOOTPRINT};
    model_stage stage = model_open();
    snow_volume *volume = open_phantom(stage.context, SNOW_TYPE_FLOAT32);
    for (int mode = SNOW_MODE_MIP; mode <= SNOW_MODE_ISO; mode++)
        for (int n = 0; n < 4; n++) { /* the last two in perspective */
            snow_settings settings;
            snow_settings_init(&settings);
            settings.mode = (snow_mode)mode;
            settings.iso = 90;
            settings.method = methods[n % 2];
            settings.threads = 1;
            double fov = n >= 2 ? 40 : 0;
            uint64_t first = sum_of(&stage, volume, &settings, fov);
            for (int way = 0; way < 9; way++) {
                if (!support_takes((size_t)(way + n + 4 * mode), 7))
                    continue;
                settings.threads = 1 + way % 3;
                settings.encoding = (snow_encoding)(1 + way / 3);
                assert_true(sum_of(&stage, volume, &settings, fov) == first);
            }
        }
    snow_volume_close(volume);
    model_close(&stage);
}

static void levels_make_the_same_picture(void **state) {
    (void)state;
    model_stage stage = model_open();
    snow_volume *volume = open_phantom(stage.context, SNOW_TYPE_UINT8);
    for (int way = 2 * SNOW_MODE_MIP; way < 2 * SNOW_MODE_ISO + 2; way++) {
        double fov = way % 2 ? 30 : 0;
        snow_settings settings;
        snow_settings_init(&settings);
        settings.mode = (snow_mode)(way / 2);
        settings.iso = 90;
        settings.isa = SNOW_ISA_SCALAR;
        snow_image *plain =
            engine_picture(stage.context, stage.frame, volume, &settings, fov);
        uint64_t sums[2] = {0, 0};
        for (int n = 0; n < 2; n++) {
            settings.isa = n ? SNOW_ISA_AVX512 : SNOW_ISA_AVX2;
            if (!snow_isa_runs(settings.isa))
                continue;
            snow_image *image = engine_picture(stage.context, stage.frame,
                                               volume, &settings, fov);
            if (!(distance_of(image, plain) < 1e-5))
                fail_msg("%s %g", snow_mode_name(settings.mode),
                         distance_of(image, plain));
            sums[n] = snow_image_checksum(image);
            snow_image_free(image);
        }
        if (sums[0] && sums[1])
            if (sums[0] != sums[1])
                fail_msg("%s: levels differ", snow_mode_name(settings.mode));
        snow_image_free(plain);
    }
    snow_volume_close(volume);
    model_close(&stage);
}

/* --- values and refusals -------------------------------------------------- */

static void means_become_colours_over_a_range(void **state) {
    (void)state;
    model_stage stage = model_open();
    static const snow_color_point colors[] = {{10, 0, 0, 0}, {20, 1, 0.5, 0}};
    static const snow_opacity_point opaque[] = {{0, 1}};
    snow_transfer *transfer = NULL;
    snow_image *values = NULL, *painted = NULL;
    double low, high;
    assert_int_equal(
        snow_transfer_new(stage.context, colors, 2, opaque, 1, &transfer),
        SNOW_STATUS_OK);
    assert_int_equal(snow_image_new(stage.context, 4, 1, 1, &values),
                     SNOW_STATUS_OK);
    const float numbers[4] = {-3, NAN, 1, 5};
    memcpy(snow_image_pixels(values), numbers, sizeof numbers);
    snow_image_value_range(values, &low, &high);
    assert_true(low == -3 && high == 5);
    assert_int_equal(
        snow_image_apply_colormap(values, transfer, low, high, &painted),
        SNOW_STATUS_OK);
    const float wanted[16] = {0,   0,    0, 1, 0, 0,   0, 0,
                              0.5, 0.25, 0, 1, 1, 0.5, 0, 1};
    assert_memory_equal(snow_image_pixels(painted), wanted, sizeof wanted);
    snow_image *none = NULL;
    assert_int_equal(
        snow_image_apply_colormap(painted, transfer, low, high, &none),
        SNOW_STATUS_BAD_USAGE);
    assert_int_equal(snow_image_apply_colormap(values, transfer, 2, 1, &none),
                     SNOW_STATUS_BAD_USAGE);
    assert_int_equal(snow_image_save(values, "values.png", NULL),
                     SNOW_STATUS_BAD_USAGE);
    assert_non_null(strstr(snow_context_message(stage.context), "not values"));
    snow_image_free(values);
    snow_image_free(painted);
    snow_transfer_free(transfer);
    model_close(&stage);
}

/* Nothing finite, one value, and numbers too far apart. */
static void odd_volumes(void **state) {
    (void)state;
    model_stage stage = model_open();
    reference_scene scene = model_blank((int64_t[]){5, 4, 3}, 1);
    for (int mode = SNOW_MODE_MIP; mode <= SNOW_MODE_ISO; mode++)
        for (int method = 0; method < 2; method++) {
            scene.settings.method =
                method ? SNOW_METHOD_SHEAR_WARP : SNOW_METHOD_FOOTPRINT;
            scene.settings.mode = (snow_mode)mode;
            scene.settings.iso = 7;
            bool values = has_values(scene.settings.mode);
            size_t middle = 24 * 64 + 32;
            for (int n = 0; n < 60; n++)
                model_voxels(&scene)[n] = n % 2 ? NAN : INFINITY;
            snow_image *image = model_image(&stage, &scene);
            const float *pixels = snow_image_pixels(image);
            assert_true(values ? isnan(pixels[middle])
                               : pixels[2 * middle + 1] == 0);
            snow_image_free(image);
            for (int n = 0; n < 60; n++)
                model_voxels(&scene)[n] = 7;
            image = model_image(&stage, &scene);
            pixels = snow_image_pixels(image);
            if (values)
                /* Three slices are two slabs of values. */
                assert_near(pixels[middle],
                            mode == SNOW_MODE_SUM ? (method ? 14 : 21) : 7,
                            1e-4);
            else
                /* The image of a surface has 15 bits. */
                for (size_t c = 0; c < 2; c++)
                    assert_near((double)pixels[2 * middle + c], 1,
                                mode == SNOW_MODE_ISO ? 1.0 / 32767 : 0);
            snow_image_free(image);
        }
    model_free(&scene);
    model_close(&stage);
}

static void refusals(void **state) {
    (void)state;
    model_stage stage = model_open();
    reference_scene scene =
        model_scene(dims, SNOW_TYPE_UINT8, true, MODEL_PLAIN, 1);
    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL;
    snow_image *image = NULL;
    assert_int_equal(
        snow_volume_wrap(stage.context, &scene.info, scene.voxels, &volume),
        SNOW_STATUS_OK);
    assert_int_equal(snow_transfer_new(stage.context, scene.colors,
                                       scene.color_count, scene.opacities,
                                       scene.opacity_count, &transfer),
                     SNOW_STATUS_OK);
    struct {
        int mode;
        double iso;
        int depth;
        const char *words;
    } wrong[] = {{-1, 0, 0, "invalid mode -1"},
                 {6, 0, 0, "invalid mode 6"},
                 {SNOW_MODE_ISO, NAN, 0, "invalid iso nan"},
                 {SNOW_MODE_MIP, 0, 1, "mode mip has no depth"}};
    for (size_t n = 0; n < COUNT(wrong); n++) {
        snow_settings settings;
        snow_settings_init(&settings);
        settings.mode = (snow_mode)wrong[n].mode;
        settings.iso = wrong[n].iso;
        settings.depth = wrong[n].depth;
        assert_int_equal(snow_frame_render(stage.frame, volume, transfer,
                                           &scene.view, &settings, &image),
                         SNOW_STATUS_BAD_USAGE);
        if (!strstr(snow_context_message(stage.context), wrong[n].words))
            fail_msg("%s", snow_context_message(stage.context));
    }
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    model_free(&scene);
    model_close(&stage);
}

static void no_settings_are_the_usual_ones(void **state) {
    (void)state;
    snow_context *context = NULL;
    snow_frame *frame = NULL;
    snow_settings usual;
    snow_settings_init(&usual);
    assert_int_equal(snow_context_new(NULL, &context), SNOW_STATUS_OK);
    assert_int_equal(snow_frame_new(context, &frame), SNOW_STATUS_OK);
    snow_volume *volume = open_phantom(context, SNOW_TYPE_UINT8);
    snow_image *a = engine_picture(context, frame, volume, &usual, 0);
    snow_image *b = engine_picture(context, frame, volume, NULL, 0);
    assert_true(snow_image_checksum(a) == snow_image_checksum(b));
    snow_image_free(a);
    snow_image_free(b);
    snow_volume_close(volume);
    snow_frame_free(frame);
    snow_context_free(context);
}

#define UNIT(name) cmocka_unit_test(name)

int main(void) {
    const struct CMUnitTest tests[] = {
        UNIT(every_type_and_matrix_from_every_side),
        UNIT(every_type_and_matrix_in_perspective),
        UNIT(depths_of_over),
        UNIT(shear_warp_pictures_of_smooth_data_are_near_to_rays),
        UNIT(isosurfaces_are_of_values),
        UNIT(threads_and_encodings_change_no_bit),
        UNIT(levels_make_the_same_picture),
        UNIT(means_become_colours_over_a_range),
        UNIT(odd_volumes),
        UNIT(refusals),
        UNIT(no_settings_are_the_usual_ones),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
