/* tests/render/test_modes.c - pictures in modes other than over equal the
 * reference's.
 */
#include "image/image.h"
#include "reference/model.h"

#include <math.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const snow_mode modes[] = {SNOW_MODE_MIP, SNOW_MODE_MINIP,
                                  SNOW_MODE_MEAN, SNOW_MODE_SUM};
static const double zooms[] = {0.3, 1, 4}, fovs[] = {5, 30, 60};
static const int64_t dims[3] = {13, 10, 15};

/* One colour map without steps, whose colours tell values apart. */
static const snow_color_point smooth[] = {
    {0, 0, 0.1, 0.9}, {50, 0.5, 0.8, 0.3}, {100, 1, 0.2, 0}};

static bool has_values(snow_mode mode) {
    return mode == SNOW_MODE_MEAN || mode == SNOW_MODE_SUM;
}

/* A scene in a mode; every tenth of real numbers has holes. */
static reference_scene mode_scene(uint64_t *state, size_t n, snow_mode mode) {
    reference_scene scene =
        model_scene(dims, model_type(n), false,
                    (model_matrix)(n / MODEL_TYPES % MODEL_MATRICES),
                    model_draw(state, 99));
    scene.colors = smooth;
    scene.color_count = COUNT(smooth);
    scene.settings.mode = mode;
    scene.settings.kernel = model_kernel(model_draw(state, MODEL_KERNELS));
    scene.settings.encoding = (snow_encoding)model_draw(state, 4);
    scene.view.width = 24, scene.view.height = 18;
    model_stand_at(&scene, model_draw(state, MODEL_STANDS),
                   zooms[model_draw(state, COUNT(zooms))]);
    if (scene.info.type == SNOW_TYPE_FLOAT32 && model_draw(state, 2)) {
        float *voxels = (float *)(uintptr_t)scene.voxels;
        for (int at = 0; at < 13 * 10 * 15; at++)
            if (model_draw(state, 20) == 0)
                voxels[at] = model_draw(state, 2) ? NAN : INFINITY;
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
        for (size_t n = 0; n < MODEL_TYPES * MODEL_MATRICES * 3; n++) {
            if (!support_takes(n + 7 * m, 13))
                continue;
            uint64_t random = support_scene_random(11 + m, n);
            reference_scene scene = mode_scene(&random, n, modes[m]);
            if (fov_share > 0)
                scene.view.fov = fovs[model_draw(&random, COUNT(fovs))];
            else if (n % 4 == 0)
                scene.settings.method = SNOW_METHOD_ORIGINAL;
            add_picture(&stage, &scene, &t);
            model_free(&scene);
        }
        report(snow_mode_name(modes[m]), &t);
        assert_true(t.largest < 1e-3);
        assert_true(t.shown > t.pixels / 20 || support_is_sanitized());
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
    model_stage *stage = *state;
    mode_summary t = {0};
    for (size_t n = 0; n < MODEL_TYPES * MODEL_MATRICES * 3; n++) {
        if (!support_takes(n, 13))
            continue;
        uint64_t random = support_scene_random(31, n);
        reference_scene scene = mode_scene(&random, n, SNOW_MODE_OVER);
        scene.settings.depth = 1;
        if (n % 3 == 1) /* its depths are those of footprints, too */
            scene.settings.method = SNOW_METHOD_SHEAR_WARP;
        if (n % 4 == 0)
            scene.view.fov = fovs[model_draw(&random, COUNT(fovs))];
        snow_image_free(model_image(stage, &scene));
        compare_depth(stage, &scene, &t);
        model_free(&scene);
    }
    report("depth of over", &t);
    assert_true(t.shown > t.pixels / 20);
    assert_true(t.largest < 0.05);
    assert_true(t.total / (double)t.shown < 1e-3);
    assert_true(t.missing * 1000 <= t.pixels);
}

static snow_volume *open_head(const model_stage *stage) {
    snow_volume *volume = NULL;
    assert_int_equal(snow_volume_open_phantom(stage->context, "head",
                                              (const int64_t[]){61, 50, 43}, 0,
                                              &volume),
                     SNOW_STATUS_OK);
    return volume;
}

/* The check sum of a picture of it. */
static uint64_t sum_of(const model_stage *stage, const snow_volume *volume,
                       const snow_settings *settings, double fov) {
    const snow_look look = {.size = sizeof look, .preset = "linear"};
    snow_transfer *transfer = NULL;
    snow_image *image = NULL;
    snow_view view;
    snow_view_init(&view);
    view.width = view.height = 128;
    view.azimuth = 30, view.elevation = 20, view.fov = fov;
    assert_int_equal(snow_transfer_new_for_volume(volume, &look, &transfer),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_frame_render(stage->frame, volume, transfer, &view,
                                       settings, &image),
                     SNOW_STATUS_OK);
    uint64_t sum = snow_image_checksum(image);
    snow_image_free(image);
    snow_transfer_free(transfer);
    return sum;
}

/* Footprints have no isosurface: values draw it. */
static void isosurfaces_are_of_values(void **state) {
    static const snow_method methods[] = {
        SNOW_METHOD_ORIGINAL, SNOW_METHOD_TESTED, SNOW_METHOD_FOOTPRINT};
    model_stage *stage = *state;
    snow_volume *volume = open_head(stage);
    snow_settings settings;
    snow_settings_init(&settings);
    settings.mode = SNOW_MODE_ISO;
    settings.iso = 90;
    settings.kernel = SNOW_KERNEL_TENT;
    uint64_t sum = sum_of(stage, volume, &settings, 0);
    for (size_t n = 0; n < COUNT(methods); n++) {
        settings.method = methods[n];
        assert_true(sum_of(stage, volume, &settings, 0) == sum);
        assert_int_equal(snow_frame_stats(stage->frame)->method,
                         SNOW_METHOD_SHEAR_WARP);
    }
    snow_volume_close(volume);
}

/* --- what must not change a bit ------------------------------------------- */

/* Those of shear-warp are test_same_bits.c's. */
static void threads_and_encodings_change_no_bit(void **state) {
    model_stage *stage = *state;
    snow_volume *volume = open_head(stage);
    for (size_t m = 0; m < COUNT(modes); m++)
        for (int eye = 0; eye < 2; eye++) {
            snow_settings settings;
            snow_settings_init(&settings);
            settings.mode = modes[m];
            settings.method = SNOW_METHOD_FOOTPRINT;
            settings.threads = 1;
            uint64_t first = sum_of(stage, volume, &settings, 40 * eye);
            for (size_t way = 0; way < 9; way++) {
                if (!support_takes(way + 2 * m + (size_t)eye, 7))
                    continue;
                settings.threads = 1 + (int)way % 3;
                settings.encoding = (snow_encoding)(1 + way / 3);
                assert_true(sum_of(stage, volume, &settings, 40 * eye) ==
                            first);
            }
        }
    snow_volume_close(volume);
}

/* --- values and refusals -------------------------------------------------- */

static void means_become_colours_over_a_range(void **state) {
    model_stage *stage = *state;
    static const snow_color_point colors[] = {{10, 0, 0, 0}, {20, 1, 0.5, 0}};
    static const snow_opacity_point opaque[] = {{0, 1}};
    snow_transfer *transfer = NULL;
    snow_image *values = NULL, *painted = NULL;
    double low, high;
    assert_int_equal(
        snow_transfer_new(stage->context, colors, 2, opaque, 1, &transfer),
        SNOW_STATUS_OK);
    assert_int_equal(snow_image_new(stage->context, 4, 1, 1, &values),
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
    assert_non_null(strstr(snow_context_message(stage->context), "not values"));
    snow_image_free(values);
    snow_image_free(painted);
    snow_transfer_free(transfer);
}

/* Nothing finite, one value, and numbers too far apart. */
static void odd_volumes(void **state) {
    model_stage *stage = *state;
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
            snow_image *image = model_image(stage, &scene);
            const float *pixels = snow_image_pixels(image);
            assert_true(values ? isnan(pixels[middle])
                               : pixels[2 * middle + 1] == 0);
            snow_image_free(image);
            for (int n = 0; n < 60; n++)
                model_voxels(&scene)[n] = 7;
            image = model_image(stage, &scene);
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
}

static void refusals(void **state) {
    static const struct {
        int mode;
        double iso;
        int depth;
        const char *words;
    } wrong[] = {{-1, 0, 0, "invalid mode -1"},
                 {6, 0, 0, "invalid mode 6"},
                 {SNOW_MODE_ISO, NAN, 0, "invalid iso nan"},
                 {SNOW_MODE_MIP, 0, 1, "mode mip has no depth"}};
    model_stage *stage = *state;
    reference_scene scene =
        model_scene(dims, SNOW_TYPE_UINT8, true, MODEL_PLAIN, 1);
    for (size_t n = 0; n < COUNT(wrong); n++) {
        scene.settings.mode = (snow_mode)wrong[n].mode;
        scene.settings.iso = wrong[n].iso;
        scene.settings.depth = wrong[n].depth;
        model_refused(stage, &scene, wrong[n].words);
    }
    model_free(&scene);
}

static void no_settings_are_the_usual_ones(void **state) {
    model_stage *stage = *state;
    snow_settings usual;
    snow_settings_init(&usual);
    snow_volume *volume = open_head(stage);
    assert_true(sum_of(stage, volume, &usual, 0) ==
                sum_of(stage, volume, NULL, 0));
    snow_volume_close(volume);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_type_and_matrix_from_every_side),
        cmocka_unit_test(every_type_and_matrix_in_perspective),
        MODEL_TEST(depths_of_over),
        MODEL_TEST(isosurfaces_are_of_values),
        MODEL_TEST(threads_and_encodings_change_no_bit),
        MODEL_TEST(means_become_colours_over_a_range),
        MODEL_TEST(odd_volumes),
        MODEL_TEST(refusals),
        MODEL_TEST(no_settings_are_the_usual_ones),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
