/* tests/base/test_out_of_memory.c - each allocation of load, render and write
 * is made to fail once, and from there on: an error, no leak, no half file. */
#include "render/tested.h"
#include "support/failing.h"

#include <unistd.h>

typedef struct test_paths {
    char input[64], output[64];
    bool fades; /* a gradient opacity is asked for */
} test_paths;

/* A picture of a file, as a program would make it. */
static snow_status make_picture(snow_context *context, const test_paths *paths,
                                const snow_settings *settings, double fov) {
    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL;
    snow_frame *frame = NULL;
    snow_image *image = NULL;
    static const snow_opacity_point curve[] = {{0, 0.1}, {30, 1}};
    snow_look look = {.size = sizeof look,
                      .colormap = "viridis",
                      .gradient_opacities = paths->fades ? curve : NULL,
                      .gradient_opacity_count = 2};
    snow_view view = {.size = sizeof view};
    snow_status status = snow_volume_open(context, paths->input, NULL, &volume);
    if (status == SNOW_STATUS_OK)
        status = snow_transfer_new_for_volume(volume, &look, &transfer);
    if (status == SNOW_STATUS_OK)
        status = snow_frame_new(context, &frame);
    if (status == SNOW_STATUS_OK) {
        snow_view_default(volume, &view);
        view.width = view.height = 32;
        view.azimuth = 30;
        view.fov = fov;
        status =
            snow_frame_render(frame, volume, transfer, &view, settings, &image);
    }
    if (status == SNOW_STATUS_OK)
        status = snow_image_save(image, paths->output, NULL);
    snow_image_free(image);
    snow_frame_free(frame);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    return status;
}

/* Runs make_picture under an allocator; nothing may stay behind. */
static snow_status run(support_failing *allocator, const test_paths *paths,
                       const snow_settings *settings, double fov) {
    snow_allocator functions = support_failing_allocator(allocator);
    snow_context *context;
    if (snow_context_new(&functions, &context) != SNOW_STATUS_OK)
        return SNOW_STATUS_NO_MEMORY;
    snow_status status = make_picture(context, paths, settings, fov);
    snow_context_free(context);
    assert_int_equal(allocator->held, 0);
    return status;
}

static void write_input(const test_paths *paths) {
    snow_context *context = support_context();
    snow_volume *volume;
    int64_t dims[3] = {12, 13, 14};
    assert_int_equal(
        snow_volume_open_phantom(context, "shells", dims, 0, &volume),
        SNOW_STATUS_OK);
    assert_int_equal(snow_volume_save(volume, paths->input, true),
                     SNOW_STATUS_OK);
    snow_volume_close(volume);
    snow_context_free(context);
}

/* Every allocation fails in turn; only then does the picture come out. */
static void fail_each_seen(const char *suffix, snow_method method,
                           snow_encoding encoding, bool for_good, int threads,
                           double fov) {
    char folder[] = "/tmp/snow-memory-XXXXXX";
    assert_non_null(mkdtemp(folder));
    test_paths paths;
    paths.fades =
        encoding == SNOW_ENCODING_CRS || encoding == SNOW_ENCODING_RLE;
    snprintf(paths.input, sizeof paths.input, "%s/in%s", folder, suffix);
    snprintf(paths.output, sizeof paths.output, "%s/out.png", folder);
    write_input(&paths);
    snow_settings settings;
    snow_settings_init(&settings);
    settings.method = method;
    settings.encoding = encoding;
    settings.threads = threads;
    support_failing whole = {.failing = -1};
    assert_int_equal(run(&whole, &paths, &settings, fov), SNOW_STATUS_OK);
    assert_int_equal(unlink(paths.output), 0);
    assert_true(whole.allocations > 20);
    for (long n = 0; n < whole.allocations; n++) {
        support_failing allocator = {.failing = n, .for_good = for_good};
        snow_status status = run(&allocator, &paths, &settings, fov);
        /* Without memory for threads the calling one does it all. */
        if (status == SNOW_STATUS_OK && threads > 1)
            assert_int_equal(unlink(paths.output), 0);
        else
            assert_int_equal(status, SNOW_STATUS_NO_MEMORY);
        assert_int_equal(access(paths.output, F_OK), -1);
    }
    assert_int_equal(unlink(paths.input), 0);
    /* Temporary files would keep the folder from going. */
    assert_int_equal(rmdir(folder), 0);
}

static void fail_each(const char *suffix, snow_method method,
                      snow_encoding encoding, bool for_good, int threads) {
    fail_each_seen(suffix, method, encoding, for_good, threads, 0);
}

static void perspective_fails_cleanly_at_every_allocation(void **state) {
    (void)state;
    for (int for_good = 0; for_good < 2; for_good++) {
        fail_each_seen(".nrrd", SNOW_METHOD_FOOTPRINT, SNOW_ENCODING_CRS,
                       for_good, 1, 30);
        fail_each_seen(".mha", SNOW_METHOD_TESTED, SNOW_ENCODING_AUTO, for_good,
                       1, 60);
        fail_each_seen(".nrrd", SNOW_METHOD_SHEAR_WARP, SNOW_ENCODING_AUTO,
                       for_good, 1, 30);
        fail_each_seen(".nrrd", SNOW_METHOD_SHEAR_WARP, SNOW_ENCODING_RLE,
                       for_good, 3, 30);
    }
}

static void a_picture_fails_cleanly_at_every_allocation(void **state) {
    (void)state;
    fail_each(".nrrd", SNOW_METHOD_FOOTPRINT, SNOW_ENCODING_CRS, false, 1);
    fail_each(".nii.gz", SNOW_METHOD_FOOTPRINT, SNOW_ENCODING_RLE, false, 1);
    fail_each(".mha", SNOW_METHOD_ORIGINAL, SNOW_ENCODING_AUTO, false, 1);
    fail_each(".nrrd", SNOW_METHOD_SHEAR_WARP, SNOW_ENCODING_CRS, false, 1);
    fail_each(".nrrd", SNOW_METHOD_SHEAR_WARP, SNOW_ENCODING_AUTO, false, 3);
    fail_each(".mha", SNOW_METHOD_FOOTPRINT, SNOW_ENCODING_AUTO, false, 3);
    fail_each(".mha", SNOW_METHOD_RAYCAST, SNOW_ENCODING_AUTO, false, 1);
}

static void a_picture_fails_cleanly_when_memory_ends_for_good(void **state) {
    (void)state;
    fail_each(".nrrd", SNOW_METHOD_FOOTPRINT, SNOW_ENCODING_BITMAP, true, 1);
    fail_each(".nii.gz", SNOW_METHOD_FOOTPRINT, SNOW_ENCODING_AUTO, true, 1);
    fail_each(".mha", SNOW_METHOD_TESTED, SNOW_ENCODING_AUTO, true, 1);
    fail_each(".nrrd", SNOW_METHOD_SHEAR_WARP, SNOW_ENCODING_RLE, true, 1);
    fail_each(".nrrd", SNOW_METHOD_SHEAR_WARP, SNOW_ENCODING_BITMAP, true, 3);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_picture_fails_cleanly_at_every_allocation),
        cmocka_unit_test(perspective_fails_cleanly_at_every_allocation),
        cmocka_unit_test(a_picture_fails_cleanly_when_memory_ends_for_good),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
