/* tests/test_modes.c - pictures in modes other than over equal the reference's.
 */
#include "support_model.h"

#include <math.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const snow_mode modes[] = {SNOW_MODE_MIP, SNOW_MODE_MINIP,
                                  SNOW_MODE_MEAN, SNOW_MODE_SUM};
static const snow_type types[] = {
    SNOW_INT8,   SNOW_UINT8, SNOW_INT16,  SNOW_UINT16,  SNOW_INT32,
    SNOW_UINT32, SNOW_INT64, SNOW_UINT64, SNOW_FLOAT32, SNOW_FLOAT64,
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
    if (scene.info.type == SNOW_FLOAT32 && draw(state, 2)) {
        float *voxels = (float *)(uintptr_t)scene.voxels;
        for (int at = 0; at < 13 * 10 * 15; at++)
            if (draw(state, 20) == 0)
                voxels[at] = draw(state, 2) ? NAN : INFINITY;
    }
    return scene;
}

/* How a picture differs from the reference.  Where a sum of weights is about
 * 1/2, rounding decides whether there is a pixel. */
typedef struct tally {
    size_t pixels, missing, shown;
    double largest, total;
} tally;

static double size_of_value(const reference_scene *scene, double reference) {
    return scene->settings.mode == SNOW_MODE_SUM ? fmax(100, fabs(reference))
                                                 : 100;
}

static void compare(const reference_scene *scene, snow_image *image,
                    const double *reference, tally *t) {
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
                        tally *t) {
    snow_image *image = model_image(stage, scene);
    double *reference = reference_mode(scene);
    compare(scene, image, reference, t);
    snow_image_free(image);
    free(reference);
}

static void report(const char *what, const tally *t) {
    print_message("             %s: %zu of %zu pixels shown, differ by up to "
                  "%.2g, %.2g in the mean; %zu on one side only\n",
                  what, t->shown, t->pixels, t->largest,
                  t->total / (double)t->shown, t->missing);
}

/* In units of colour, or of a hundredth of the data's range. */
static void exact_pictures(double fov_share) {
    model_stage stage = model_open();
    uint64_t random = 11;
    for (size_t m = 0; m < COUNT(modes); m++) {
        tally t = {0};
        for (size_t n = 0; n < COUNT(types) * MODEL_MATRICES * 3; n++) {
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

#define UNIT(name) cmocka_unit_test(name)

int main(void) {
    const struct CMUnitTest tests[] = {
        UNIT(every_type_and_matrix_from_every_side),
        UNIT(every_type_and_matrix_in_perspective),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
