/* tests/render/test_progress.c - progress never falls within a call, ends at 1,
 * is reported at most 20 times a second by the thread that called, and can end
 * the call.
 *
 * The clock is the test's own (the linker's --wrap): each question of the
 * thread that called makes it go on by `tick`, so that nothing depends on how
 * fast the machine is, and small volumes take long. */
#include "support/folder.h"
#include "support/support.h"

#include "base/clear.h"
#include "base/monitor.h"

#include <pthread.h>
#include <snowglass/ranks.h>
#include <snowglass/render.h>

#define CALLS_MOST 5000

/* The library's questions come here. */
double __wrap_snow_seconds(void);

static pthread_t caller;
static double now, tick;

double __wrap_snow_seconds(void) {
    if (!pthread_equal(caller, pthread_self()))
        return 0; /* of other threads, for figures that nobody looks at */
    return now += tick;
}

static int set_clock(void **state) {
    (void)state;
    caller = pthread_self();
    now = 0;
    tick = 0.03;
    return 0;
}

typedef struct listener {
    int calls;
    double when[CALLS_MOST];
    snow_stage stages[CALLS_MOST];
    double fractions[CALLS_MOST];
    pthread_t thread;
    bool foreign;
    int stop_at; /* the call that asks for a stop; 0: none */
} listener;

static bool hear(void *user, snow_stage stage, double fraction) {
    listener *l = user;
    l->foreign |= !pthread_equal(l->thread, pthread_self());
    if (l->calls < CALLS_MOST) {
        l->when[l->calls] = now;
        l->stages[l->calls] = stage;
        l->fractions[l->calls] = fraction;
    }
    return ++l->calls == l->stop_at;
}

static void listen_to(snow_context *context, listener *l, int stop_at) {
    *l = (listener){.thread = pthread_self(), .stop_at = stop_at};
    snow_context_set_progress(context, hear, l);
}

/* What holds for the calls of any number of calls to the library. */
static void check_rate(const listener *l) {
    assert_true(l->calls < CALLS_MOST);
    assert_false(l->foreign);
    for (int n = 20; n < l->calls; n++)
        assert_true(l->when[n] - l->when[n - 20] >= 1);
}

/* What holds for one call: how often a stage was reported. */
static int check_stage(const listener *l, snow_stage stage) {
    double last = 0;
    int calls = 0;
    for (int n = 0; n < l->calls; n++) {
        if (l->stages[n] != stage)
            continue;
        assert_true(l->fractions[n] >= last && l->fractions[n] <= 1);
        last = l->fractions[n];
        calls++;
    }
    if (calls)
        assert_true(last == 1);
    return calls;
}

/* No other stage was reported, and this one so often at least. */
static void check_alone(const listener *l, snow_stage stage, int least) {
    check_rate(l);
    assert_true(l->calls >= least);
    assert_int_equal(check_stage(l, stage), l->calls);
}

/* --- volumes -------------------------------------------------------------- */

#define SIDE 96

static const char *write_volume(const char *folder, const char *name) {
    const char *path = support_folder_path(folder, name);
    snow_context *context = support_context();
    snow_volume *volume;
    assert_int_equal(snow_volume_open_phantom(
                         context, "turbulence",
                         (const int64_t[3]){SIDE, SIDE, SIDE}, 0, &volume),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_volume_save(volume, path, true), SNOW_STATUS_OK);
    snow_volume_close(volume);
    snow_context_free(context);
    return path;
}

static void a_phantom_is_reported_while_it_is_made(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_volume *volume;
    listener l;
    listen_to(context, &l, 0);
    assert_int_equal(snow_volume_open_phantom(context, "turbulence",
                                              (const int64_t[3]){64, 64, 64}, 0,
                                              &volume),
                     SNOW_STATUS_OK);
    check_alone(&l, SNOW_STAGE_READ, 2);
    assert_true(l.fractions[0] < 1);
    snow_volume_close(volume);
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
}

static void reading_is_reported_and_can_be_stopped(void **state) {
    static const char *const names[] = {"v.nrrd", "v.nii.gz", "v.mha",
                                        "v.raw.gz"};
    char folder[SUPPORT_FOLDER_BYTES];
    (void)state;
    support_folder_make(folder);
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        const char *path = write_volume(folder, names[n]);
        snow_context *context = support_context();
        snow_volume_options options = {.size = sizeof options};
        snow_volume *volume = NULL;
        listener l;
        if (n == 3) {
            options.type = SNOW_TYPE_FLOAT32;
            for (int axis = 0; axis < 3; axis++)
                options.dims[axis] = SIDE;
        }
        listen_to(context, &l, 0);
        assert_int_equal(snow_volume_open(context, path, &options, &volume),
                         SNOW_STATUS_OK);
        check_rate(&l);
        int calls = check_stage(&l, SNOW_STAGE_READ);
        assert_int_equal(calls, l.calls);
        snow_volume_close(volume);
        volume = NULL;
        assert_true(calls >= 3);
        listen_to(context, &l, 1);
        assert_int_equal(snow_volume_open(context, path, &options, &volume),
                         SNOW_STATUS_STOPPED);
        assert_int_equal(l.calls, 1);
        assert_null(volume);
        assert_int_equal(snow_context_bytes(context), 0);
        snow_context_set_progress(context, NULL, NULL);
        assert_int_equal(snow_volume_open(context, path, &options, &volume),
                         SNOW_STATUS_OK);
        snow_volume_close(volume);
        snow_context_free(context);
    }
    support_folder_remove(folder);
}

static void saving_is_reported_and_can_be_stopped(void **state) {
    static const char *const names[] = {"v.nrrd", "v.nii.gz", "v.npy"};
    char folder[SUPPORT_FOLDER_BYTES];
    (void)state;
    support_folder_make(folder);
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        const char *path = support_folder_path(folder, names[n]);
        snow_context *context = support_context();
        snow_volume *volume;
        listener l;
        assert_int_equal(snow_volume_open_phantom(
                             context, "turbulence",
                             (const int64_t[3]){SIDE, SIDE, SIDE}, 0, &volume),
                         SNOW_STATUS_OK);
        listen_to(context, &l, 1);
        assert_int_equal(snow_volume_save(volume, path, false),
                         SNOW_STATUS_STOPPED);
        assert_int_equal(l.calls, 1);
        listen_to(context, &l, 0); /* no file is in the way */
        assert_int_equal(snow_volume_save(volume, path, false), SNOW_STATUS_OK);
        check_alone(&l, SNOW_STAGE_WRITE, 3);
        snow_volume_close(volume);
        snow_context_free(context);
    }
    support_folder_remove(folder);
}

/* In each format that is built. */
static void saving_a_picture_is_reported_and_can_be_stopped(void **state) {
    char folder[SUPPORT_FOLDER_BYTES], name[32];
    const char *suffix;
    bool built;
    (void)state;
    support_folder_make(folder);
    for (size_t n = 0; (suffix = snow_image_format_suffix(n, &built)); n++) {
        snow_context *context = support_context();
        snow_image *image;
        listener l;
        if (!built)
            continue;
        snprintf(name, sizeof name, "p%s", suffix);
        const char *path = support_folder_path(folder, name);
        assert_int_equal(snow_image_new(context, 40, 200, 4, &image),
                         SNOW_STATUS_OK);
        for (int i = 0; i < 4 * 40 * 200; i++)
            snow_image_pixels(image)[i] = (float)(i * 7919 % 1001) / 1000;
        listen_to(context, &l, 2);
        assert_int_equal(snow_image_save(image, path, NULL),
                         SNOW_STATUS_STOPPED);
        assert_int_equal(l.calls, 2);
        listen_to(context, &l, 0); /* no file is in the way */
        assert_int_equal(snow_image_save(image, path, NULL), SNOW_STATUS_OK);
        check_alone(&l, SNOW_STAGE_WRITE, 3);
        snow_image_free(image);
        assert_int_equal(snow_context_bytes(context), 0);
        snow_context_free(context);
    }
    support_folder_remove(folder);
}

static snow_status measure(const snow_volume *volume, int what) {
    uint64_t counts[16];
    snow_volume_statistics figures = {.size = sizeof figures};
    snow_transfer *transfer = NULL;
    if (what == 2) {
        snow_status status =
            snow_transfer_new_for_volume(volume, NULL, &transfer);
        snow_transfer_free(transfer);
        return status;
    }
    return what ? snow_volume_histogram(volume, 0, 1, 16, counts)
                : snow_volume_get_statistics(volume, &figures);
}

static void measuring_is_reported_and_can_be_stopped(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_volume *volume;
    listener l;
    assert_int_equal(snow_volume_open_phantom(
                         context, "turbulence",
                         (const int64_t[3]){SIDE, SIDE, SIDE}, 0, &volume),
                     SNOW_STATUS_OK);
    for (int what = 0; what < 3; what++) {
        listen_to(context, &l, 1);
        assert_int_equal(measure(volume, what), SNOW_STATUS_STOPPED);
        assert_int_equal(l.calls, 1);
        listen_to(context, &l, 0);
        assert_int_equal(measure(volume, what), SNOW_STATUS_OK);
        check_alone(&l, SNOW_STAGE_READ, 3);
    }
    snow_volume_close(volume);
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
}

/* A volume over voxels of the caller. */
static snow_volume *wrap(snow_context *context, snow_type type,
                         const void *voxels) {
    snow_volume_info info;
    snow_volume *volume;
    snow_volume_info_init(&info);
    info.type = type;
    for (int axis = 0; axis < 3; axis++)
        info.dims[axis] = SIDE;
    assert_int_equal(snow_volume_wrap(context, &info, voxels, &volume),
                     SNOW_STATUS_OK);
    return volume;
}

/* Values of any type are counted in passes, each of which can be ended. */
static void a_look_can_be_stopped_while_it_is_chosen(void **state) {
    (void)state;
    static const snow_type types[] = {SNOW_TYPE_UINT8, SNOW_TYPE_INT16,
                                      SNOW_TYPE_FLOAT32};
    static float voxels[SIDE * SIDE * SIDE];
    for (int n = 0; n < SIDE * SIDE * SIDE; n++)
        voxels[n] = (float)(n % 977) / 977;
    for (size_t n = 0; n < sizeof types / sizeof *types; n++) {
        snow_context *context = support_context();
        snow_volume *volume = wrap(context, types[n], voxels);
        snow_transfer *transfer = NULL;
        listener l;
        listen_to(context, &l, 0);
        assert_int_equal(snow_transfer_new_for_volume(volume, NULL, &transfer),
                         SNOW_STATUS_OK);
        snow_transfer_free(transfer);
        check_rate(&l);
        const int calls = l.calls;
        assert_true(calls >= 3);
        for (int at = 1; at < calls; at += 1 + calls / 8) {
            listen_to(context, &l, at);
            assert_int_equal(
                snow_transfer_new_for_volume(volume, NULL, &transfer),
                SNOW_STATUS_STOPPED);
            assert_int_equal(l.calls, at); /* nobody is asked again */
        }
        snow_volume_close(volume);
        assert_int_equal(snow_context_bytes(context), 0);
        snow_context_free(context);
    }
}

/* --- pictures ------------------------------------------------------------- */

static bool refuse(void *user) {
    (*(int *)user)++;
    return true;
}

static void a_view_can_be_stopped_while_it_is_fitted(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_volume *volume;
    snow_transfer *transfer;
    snow_view view;
    snow_settings settings;
    listener l;
    int asked = 0;
    snow_view_init(&view);
    snow_settings_init(&settings);
    settings.threads = 1; /* of several the others may do all that there is */
    assert_int_equal(snow_volume_open_phantom(context, "head",
                                              (const int64_t[3]){48, 48, 48}, 0,
                                              &volume),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_transfer_new_for_volume(volume, NULL, &transfer),
                     SNOW_STATUS_OK);
    const snow_view before = view;
    listen_to(context, &l, 1);
    assert_int_equal(
        snow_view_fit(NULL, volume, transfer, &settings, NULL, 0, &view),
        SNOW_STATUS_STOPPED);
    assert_int_equal(l.calls, 1);
    assert_int_equal(check_stage(&l, SNOW_STAGE_ENCODE), 0);
    snow_context_set_progress(context, NULL, NULL);
    settings.stop = refuse;
    settings.stop_user = &asked;
    assert_int_equal(
        snow_view_fit(NULL, volume, transfer, &settings, NULL, 0, &view),
        SNOW_STATUS_STOPPED);
    assert_int_equal(asked, 1);
    assert_memory_equal(&view, &before, sizeof view);
    settings.stop = NULL;
    assert_int_equal(
        snow_view_fit(NULL, volume, transfer, &settings, NULL, 0, &view),
        SNOW_STATUS_OK);
    assert_true(view.has_target);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
}

static void clearing_can_be_stopped(void **state) {
    (void)state;
    static unsigned char block[(5 << 20) + 3];
    const size_t last = sizeof block - 1;
    snow_context *context = support_context();
    snow_monitor monitor;
    listener l;
    memset(block, 7, sizeof block);
    assert_int_equal(snow_clear(context, block, last), SNOW_STATUS_OK);
    for (size_t n = 0; n < last; n += 4093)
        assert_int_equal(block[n], 0);
    assert_int_equal(block[last - 1], 0);
    assert_int_equal(block[last], 7);
    listen_to(context, &l, 1);
    snow_monitor_begin(context, &monitor, NULL, NULL);
    assert_int_equal(snow_clear(context, block, sizeof block),
                     SNOW_STATUS_STOPPED);
    assert_int_equal(block[last], 7);
    snow_monitor_leave(&monitor);
    snow_context_free(context);
}

static void a_picture_is_reported(void **state) {
    (void)state;
    static const snow_quality qualities[] = {SNOW_QUALITY_NORMAL,
                                             SNOW_QUALITY_HIGH};
    static const snow_method methods[] = {
        SNOW_METHOD_SHEAR_WARP, SNOW_METHOD_FOOTPRINT, SNOW_METHOD_ORIGINAL};
    snow_context *context = support_context();
    snow_volume *volume;
    snow_transfer *transfer;
    snow_view view = {.size = sizeof view};
    listener l;
    assert_int_equal(snow_volume_open_phantom(context, "head",
                                              (const int64_t[3]){48, 48, 48}, 0,
                                              &volume),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_transfer_new_for_volume(volume, NULL, &transfer),
                     SNOW_STATUS_OK);
    snow_view_default(volume, &view);
    view.azimuth = 41;
    for (int n = 0; n < 6; n++) {
        snow_settings settings;
        snow_frame *frame;
        snow_image *image = NULL;
        snow_settings_init(&settings);
        settings.method = methods[n / 2];
        settings.quality = qualities[n % 2];
        settings.threads = 1 + n % 2;
        assert_int_equal(snow_frame_new(context, &frame), SNOW_STATUS_OK);
        listen_to(context, &l, 0);
        assert_int_equal(snow_frame_render(frame, volume, transfer, &view,
                                           &settings, &image),
                         SNOW_STATUS_OK);
        snow_image_free(image);
        check_rate(&l);
        assert_int_equal(check_stage(&l, SNOW_STAGE_READ), 0);
        int all = check_stage(&l, SNOW_STAGE_ENCODE) +
                  check_stage(&l, SNOW_STAGE_RENDER);
        assert_int_equal(all, l.calls);
        assert_true(l.calls >= 3);
        image = NULL;
        listen_to(context, &l, 1);
        assert_int_equal(snow_frame_render(frame, volume, transfer, &view,
                                           &settings, &image),
                         SNOW_STATUS_STOPPED);
        assert_int_equal(l.calls, 1);
        assert_null(image);
        snow_frame_free(frame);
    }
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
}

/* Calls of one thread for a picture that is darkened so much; it is stopped at
 * call `stop_at`. */
static int darken(snow_context *context, const snow_volume *volume,
                  const snow_transfer *transfer, double occlusion,
                  double depth_darkening, int stop_at) {
    snow_view view = {.size = sizeof view};
    snow_settings settings;
    snow_frame *frame;
    snow_image *image = NULL;
    listener l;
    snow_view_default(volume, &view);
    view.width = view.height = 100;
    snow_settings_init(&settings);
    settings.threads = 1;
    settings.depth = true;
    settings.occlusion = occlusion;
    settings.depth_darkening = depth_darkening;
    assert_int_equal(snow_frame_new(context, &frame), SNOW_STATUS_OK);
    listen_to(context, &l, stop_at);
    assert_int_equal(
        snow_frame_render(frame, volume, transfer, &view, &settings, &image),
        stop_at ? SNOW_STATUS_STOPPED : SNOW_STATUS_OK);
    assert_int_equal(image != NULL, !stop_at);
    snow_context_set_progress(context, NULL, NULL);
    snow_image_free(image);
    snow_frame_free(frame);
    return l.calls;
}

/* Line by line, once the picture is there. */
static void darkening_can_be_stopped(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_volume *volume;
    snow_transfer *transfer;
    assert_int_equal(snow_volume_open_phantom(context, "head",
                                              (const int64_t[3]){48, 48, 48}, 0,
                                              &volume),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_transfer_new_for_volume(volume, NULL, &transfer),
                     SNOW_STATUS_OK);
    const int plain = darken(context, volume, transfer, 0, 0, 0);
    for (int way = 0; way < 2; way++) {
        const int all = darken(context, volume, transfer, way, 1 - way, 0);
        print_message("             %d calls, %d of them darken\n", all,
                      all - plain);
        assert_true(all - plain > 100);
        for (int n = 1; n <= 4; n++) {
            const int at = plain + (all - plain) * n / 5;
            assert_int_equal(
                darken(context, volume, transfer, way, 1 - way, at), at);
        }
    }
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
}

/* Work of one long item, or before the first batch, can be ended, too. */
static void a_long_item_can_be_stopped(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_monitor monitor;
    listener l;
    int looks = 0;
    listen_to(context, &l, 1);
    snow_monitor_begin(context, &monitor, NULL, NULL);
    snow_monitor_next(&monitor, SNOW_STAGE_RENDER, 0, 1);
    while (looks < 100 && !snow_monitor_look(&monitor, 0))
        looks++;
    assert_int_equal(snow_monitor_end(&monitor, snow_monitor_status(&monitor)),
                     SNOW_STATUS_STOPPED);
    assert_true(looks < 10);
    assert_int_equal(l.calls, 1);
    assert_int_equal(l.stages[0], SNOW_STAGE_RENDER);
    snow_context_free(context);
}

/* What was too early to be reported is not lost to the next look. */
static void a_look_reports_how_far_the_work_is(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_monitor monitor;
    listener l;
    listen_to(context, &l, 0);
    tick = 0.001;
    snow_monitor_begin(context, &monitor, NULL, NULL);
    snow_monitor_report(&monitor, SNOW_STAGE_RENDER, 1, 2);
    assert_int_equal(l.calls, 0);
    for (int n = 0; n < 200 && l.calls == 0; n++)
        assert_false(snow_monitor_look(&monitor, 0));
    assert_int_equal(l.calls, 1);
    assert_int_equal(l.stages[0], SNOW_STAGE_RENDER);
    assert_true(l.fractions[0] == 0.5);
    assert_int_equal(snow_monitor_end(&monitor, SNOW_STATUS_OK),
                     SNOW_STATUS_OK);
    snow_context_free(context);
}

/* Calls of many short works, each of which reports its end. */
static void many_calls_are_not_reported_more_often(void **state) {
    (void)state;
    snow_context *context = support_context();
    listener l;
    listen_to(context, &l, 0);
    tick = 0.001;
    for (int n = 0; now < 100; n++) {
        snow_monitor monitor;
        double until = now + 0.06 + 0.01 * (n % 5);
        snow_monitor_begin(context, &monitor, NULL, NULL);
        while (now < until)
            snow_monitor_report(&monitor, (snow_stage)(n % 3), 1, 2);
        assert_int_equal(snow_monitor_end(&monitor, SNOW_STATUS_OK),
                         SNOW_STATUS_OK);
    }
    check_rate(&l);
    assert_true(l.calls > 800);
    snow_context_free(context);
}

static void nothing_is_reported_of_what_is_short(void **state) {
    (void)state;
    snow_context *context = support_context();
    listener l;
    tick = 0.0005;
    listen_to(context, &l, 0);
    for (int n = 0; n < 20; n++) {
        snow_volume *volume;
        assert_int_equal(snow_volume_open_phantom(context, "cube",
                                                  (const int64_t[3]){8, 8, 8},
                                                  0, &volume),
                         SNOW_STATUS_OK);
        snow_volume_close(volume);
    }
    assert_int_equal(l.calls, 0);
    snow_context_free(context);
}

#define TEST(name) cmocka_unit_test_setup(name, set_clock)

int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(a_phantom_is_reported_while_it_is_made),
        TEST(reading_is_reported_and_can_be_stopped),
        TEST(saving_is_reported_and_can_be_stopped),
        TEST(saving_a_picture_is_reported_and_can_be_stopped),
        TEST(measuring_is_reported_and_can_be_stopped),
        TEST(a_look_can_be_stopped_while_it_is_chosen),
        TEST(a_view_can_be_stopped_while_it_is_fitted),
        TEST(clearing_can_be_stopped),
        TEST(a_picture_is_reported),
        TEST(darkening_can_be_stopped),
        TEST(a_long_item_can_be_stopped),
        TEST(a_look_reports_how_far_the_work_is),
        TEST(many_calls_are_not_reported_more_often),
        TEST(nothing_is_reported_of_what_is_short),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
