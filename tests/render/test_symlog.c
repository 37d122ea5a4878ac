/* tests/render/test_symlog.c - a symmetric logarithm has room for as many
 * decades as the values have. */
#include "image/image.h"
#include "support/looks.h"
#include "support/support.h"

#include <math.h>

#define WIDE 65
#define HIGH 16
#define DEEP 8
#define LINEAR 1e-9
#define MOST 1e3

/* Values of 12 decades on either side, whose places are even steps along x. */
static snow_volume *decades(snow_context *context, float *voxels) {
    snow_volume_info info = {.size = sizeof info,
                             .dims = {WIDE, HIGH, DEEP},
                             .type = SNOW_TYPE_FLOAT32};
    snow_volume *volume = NULL;
    const double end = 1 + log(MOST / LINEAR);
    for (int n = 0; n < WIDE * HIGH * DEEP; n++) {
        double place = end * (2. * (n % WIDE) / (WIDE - 1) - 1);
        double size = fabs(place);
        voxels[n] = (float)copysign(
            size > 1 ? LINEAR * exp(size - 1) : LINEAR * size, place);
    }
    assert_int_equal(snow_volume_wrap(context, &info, voxels, &volume),
                     SNOW_STATUS_OK);
    return volume;
}

/* The share of a voxel's opacity, which `linear` makes its place: a ray meets
 * DEEP - 1 of them. */
static double share_of(const snow_image *image, int x) {
    const int channels = image->channels;
    const int at = image->height / 2 * image->width + x;
    const double alpha = (double)image->pixels[(at + 1) * channels - 1];
    return 1 - pow(1 - fmin(alpha, 1), 1. / (DEEP - 1));
}

/* Pixels whose opacity is neither nothing nor hides all. */
static void expect_a_ramp(const snow_image *image, const char *method) {
    int first = 0, last = image->width - 1;
    while (first < last && !(share_of(image, first) > 0.05))
        first++;
    for (last = first; share_of(image, last) < 0.5;)
        last++;
    assert_true(last - first > 100);
    const double from = share_of(image, first);
    const double step = (share_of(image, last) - from) / (last - first);
    for (int x = first; x < last; x++)
        if (!(fabs(share_of(image, x) - from - step * (x - first)) < 0.01))
            fail_msg("%s: %g at %d, which is no ramp", method,
                     share_of(image, x), x);
}

static void all_decades_are_told_apart(void **state) {
    (void)state;
    static float voxels[WIDE * HIGH * DEEP];
    static const snow_method methods[] = {SNOW_METHOD_SHEAR_WARP,
                                          SNOW_METHOD_RAYCAST};
    snow_context *context = support_context();
    snow_volume *volume = decades(context, voxels);
    const snow_look look = {
        .size = sizeof look, .preset = "linear", .symlog = LINEAR};
    snow_transfer *transfer = support_look(volume, look);
    for (int n = 0; n < 2; n++) {
        snow_settings settings;
        snow_view view = {.size = sizeof view};
        snow_frame *frame;
        snow_image *image = NULL;
        snow_settings_init(&settings);
        settings.shade = SNOW_SHADE_NONE;
        settings.method = methods[n];
        snow_view_init(&view);
        assert_int_equal(snow_view_from_name(context, "+z", &view),
                         SNOW_STATUS_OK);
        view.width = view.height = 400;
        assert_int_equal(snow_frame_new(context, &frame), SNOW_STATUS_OK);
        assert_int_equal(snow_frame_render(frame, volume, transfer, &view,
                                           &settings, &image),
                         SNOW_STATUS_OK);
        expect_a_ramp(image, n ? "raycast" : "shear-warp");
        snow_image_free(image);
        snow_frame_free(frame);
    }
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_decades_are_told_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
