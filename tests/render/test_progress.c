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
#include "volume/volume.h"

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

/* Each test has a clock that begins anew, and a context. */
static int begin(void **state) {
    caller = pthread_self();
    now = 0;
    tick = 0.03;
    *state = support_context();
    return 0;
}

static int end(void **state) {
    snow_context *context = *state;
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
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

/* --- work of one stage ---------------------------------------------------- */

#define SIDE 96

static snow_volume *phantom(snow_context *context, const char *name,
                            int64_t side) {
    snow_volume *volume;
    assert_int_equal(snow_volume_open_phantom(context, name,
                                              (int64_t[3]){side, side, side}, 0,
                                              &volume),
                     SNOW_STATUS_OK);
    return volume;
}

/* What is done, with what was there before. */
typedef struct work {
    snow_context *context;
    snow_volume *volume, *grid;
    snow_image *image;
    const char *path;
} work;

typedef snow_status work_fn(work *w);

static snow_status make_phantom(work *w) {
    snow_volume *made = NULL;
    snow_status status = snow_volume_open_phantom(
        w->context, "turbulence", (int64_t[3]){64, 64, 64}, 0, &made);
    snow_volume_close(made);
    return status;
}

static snow_status open_file(work *w) {
    snow_volume_options options = {.size = sizeof options};
    snow_volume *opened = NULL;
    if (strstr(w->path, ".raw")) {
        options.type = SNOW_TYPE_FLOAT32;
        for (int axis = 0; axis < 3; axis++)
            options.dims[axis] = SIDE;
    }
    snow_status status =
        snow_volume_open(w->context, w->path, &options, &opened);
    snow_volume_close(opened);
    return status;
}

/* No file is in the way of the second. */
static snow_status save_volume(work *w) {
    return snow_volume_save(w->volume, w->path, false);
}

static snow_status save_image(work *w) {
    return snow_image_save(w->image, w->path, NULL);
}

static snow_status take_statistics(work *w) {
    snow_volume_statistics figures = {.size = sizeof figures};
    return snow_volume_get_statistics(w->volume, &figures);
}

static snow_status count_values(work *w) {
    uint64_t counts[16];
    return snow_volume_histogram(w->volume, 0, 1, 16, counts);
}

static snow_status choose_look(work *w) {
    snow_transfer *transfer = NULL;
    snow_status status =
        snow_transfer_new_for_volume(w->volume, NULL, &transfer);
    snow_transfer_free(transfer);
    return status;
}

static snow_status cut(work *w) {
    const double plane[4] = {1, 0, 0, 40};
    snow_volume *made = NULL;
    snow_status status = snow_volume_clip(w->volume, plane, 1, &made);
    snow_volume_close(made);
    return status;
}

static snow_status resample(work *w) {
    snow_volume *made = NULL;
    snow_status status =
        snow_volume_resample(w->volume, w->grid, false, "overlay", &made);
    snow_volume_close(made);
    return status;
}

/* The stage alone is reported, often enough; stopped at its first call, and at
 * some later ones, the work ends there, and leaves nothing. */
static void check_work(work *w, work_fn *run, snow_stage stage, bool later) {
    const uint64_t held = snow_context_bytes(w->context);
    int all = 2;
    listener l;
    for (int at = 1; at < all; at += later ? 1 + all / 8 : all) {
        listen_to(w->context, &l, at);
        assert_int_equal(run(w), SNOW_STATUS_STOPPED);
        assert_int_equal(l.calls, at); /* nobody is asked again */
        assert_int_equal(snow_context_bytes(w->context), held);
        if (at > 1)
            continue;
        listen_to(w->context, &l, 0);
        assert_int_equal(run(w), SNOW_STATUS_OK);
        check_rate(&l);
        all = l.calls;
        assert_true(all >= 3);
        if (!later) /* else it has several passes */
            assert_int_equal(check_stage(&l, stage), all);
    }
    snow_context_set_progress(w->context, NULL, NULL);
}

static void files_and_measures_are_reported_and_can_be_stopped(void **state) {
    static const struct {
        const char *name; /* of a file, or NULL */
        work_fn *run;
        snow_stage stage;
    } works[] = {
        {NULL, make_phantom, SNOW_STAGE_READ},
        {"w.nrrd", save_volume, SNOW_STAGE_WRITE},
        {"w.nii.gz", save_volume, SNOW_STAGE_WRITE},
        {"w.npy", save_volume, SNOW_STAGE_WRITE},
        {"v.nrrd", open_file, SNOW_STAGE_READ},
        {"v.nii.gz", open_file, SNOW_STAGE_READ},
        {"v.mha", open_file, SNOW_STAGE_READ},
        {"v.raw.gz", open_file, SNOW_STAGE_READ},
        {NULL, take_statistics, SNOW_STAGE_READ},
        {NULL, count_values, SNOW_STAGE_READ},
        {NULL, choose_look, SNOW_STAGE_READ},
        {NULL, cut, SNOW_STAGE_READ},
        {NULL, resample, SNOW_STAGE_READ},
    };
    char folder[SUPPORT_FOLDER_BYTES];
    work w = {.context = *state, .volume = phantom(*state, "turbulence", SIDE)};
    w.grid = phantom(*state, "turbulence", SIDE);
    for (int axis = 0; axis < 3; axis++)
        w.grid->info.matrix[axis][3] = 0.4;
    w.volume->info.medical = w.grid->info.medical = true; /* of one world */
    support_folder_make(folder);
    for (size_t n = 0; n < sizeof works / sizeof *works; n++) {
        if (works[n].name)
            w.path = support_folder_path(folder, works[n].name);
        if (works[n].run == open_file)
            assert_int_equal(snow_volume_save(w.volume, w.path, true),
                             SNOW_STATUS_OK);
        check_work(&w, works[n].run, works[n].stage, false);
    }
    support_folder_remove(folder);
    snow_volume_close(w.volume);
    snow_volume_close(w.grid);
}

/* In each format that is built. */
static void saving_a_picture_is_reported_and_can_be_stopped(void **state) {
    char folder[SUPPORT_FOLDER_BYTES], name[32];
    const char *suffix;
    bool built;
    work w = {.context = *state};
    support_folder_make(folder);
    assert_int_equal(snow_image_new(w.context, 40, 200, 4, &w.image),
                     SNOW_STATUS_OK);
    for (int i = 0; i < 4 * 40 * 200; i++)
        snow_image_pixels(w.image)[i] = (float)(i * 7919 % 1001) / 1000;
    for (size_t n = 0; (suffix = snow_image_format_suffix(n, &built)); n++) {
        if (!built)
            continue;
        snprintf(name, sizeof name, "p%s", suffix);
        w.path = support_folder_path(folder, name);
        check_work(&w, save_image, SNOW_STAGE_WRITE, false);
    }
    snow_image_free(w.image);
    support_folder_remove(folder);
}

/* Values of any type are counted in passes, each of which can be ended. */
static void a_look_can_be_stopped_while_it_is_chosen(void **state) {
    static const snow_type types[] = {SNOW_TYPE_UINT8, SNOW_TYPE_INT16,
                                      SNOW_TYPE_FLOAT32};
    static float voxels[SIDE * SIDE * SIDE];
    work w = {.context = *state};
    for (int n = 0; n < SIDE * SIDE * SIDE; n++)
        voxels[n] = (float)(n % 977) / 977;
    for (size_t n = 0; n < sizeof types / sizeof *types; n++) {
        const snow_volume_info info = {
            .size = sizeof info, .dims = {SIDE, SIDE, SIDE}, .type = types[n]};
        assert_int_equal(snow_volume_wrap(w.context, &info, voxels, &w.volume),
                         SNOW_STATUS_OK);
        check_work(&w, choose_look, SNOW_STAGE_READ, true);
        snow_volume_close(w.volume);
    }
}

/* --- pictures ------------------------------------------------------------- */

static bool refuse(void *user) {
    (*(int *)user)++;
    return true;
}

static void a_view_can_be_stopped_while_it_is_fitted(void **state) {
    snow_context *context = *state;
    snow_volume *volume = phantom(context, "head", 48);
    snow_transfer *transfer;
    snow_view view;
    snow_settings settings;
    listener l;
    int asked = 0;
    snow_view_init(&view);
    snow_settings_init(&settings);
    settings.threads = 1; /* of several the others may do all that there is */
    assert_int_equal(snow_transfer_new_for_volume(volume, NULL, &transfer),
                     SNOW_STATUS_OK);
    const snow_view before = view;
    listen_to(context, &l, 1);
    for (int way = 0; way < 3; way++) { /* by progress, by its own, not */
        if (way == 1) {
            snow_context_set_progress(context, NULL, NULL);
            settings.stop = refuse;
            settings.stop_user = &asked;
        } else if (way == 2)
            settings.stop = NULL;
        assert_int_equal(
            snow_view_fit(NULL, volume, transfer, &settings, NULL, 0, &view),
            way < 2 ? SNOW_STATUS_STOPPED : SNOW_STATUS_OK);
        if (way < 2)
            assert_memory_equal(&view, &before, sizeof view);
    }
    assert_true(l.calls == 1 && asked == 1);
    assert_int_equal(check_stage(&l, SNOW_STAGE_ENCODE), 0);
    assert_true(view.has_target);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
}

static void clearing_can_be_stopped(void **state) {
    static unsigned char block[(5 << 20) + 3];
    const size_t last = sizeof block - 1;
    snow_context *context = *state;
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
}

static void a_picture_is_reported(void **state) {
    static const snow_method methods[] = {
        SNOW_METHOD_SHEAR_WARP, SNOW_METHOD_FOOTPRINT, SNOW_METHOD_ORIGINAL};
    snow_context *context = *state;
    snow_volume *volume = phantom(context, "head", 48);
    snow_transfer *transfer;
    snow_view view = {.size = sizeof view};
    listener l;
    assert_int_equal(snow_transfer_new_for_volume(volume, NULL, &transfer),
                     SNOW_STATUS_OK);
    snow_view_default(volume, &view);
    view.azimuth = 41;
    for (int n = 0; n < 12; n++) { /* each is stopped, in the same frame */
        const bool stops = n % 2;
        static snow_frame *frame;
        snow_settings settings;
        snow_image *image = NULL;
        snow_settings_init(&settings);
        settings.method = methods[n / 4];
        settings.quality = n / 2 % 2 ? SNOW_QUALITY_HIGH : SNOW_QUALITY_NORMAL;
        settings.threads = 1 + n / 2 % 2;
        if (!stops)
            assert_int_equal(snow_frame_new(context, &frame), SNOW_STATUS_OK);
        listen_to(context, &l, stops);
        assert_int_equal(snow_frame_render(frame, volume, transfer, &view,
                                           &settings, &image),
                         stops ? SNOW_STATUS_STOPPED : SNOW_STATUS_OK);
        assert_int_equal(image == NULL, stops);
        snow_image_free(image);
        if (stops) {
            assert_int_equal(l.calls, 1);
            snow_frame_free(frame);
            continue;
        }
        check_rate(&l);
        assert_int_equal(check_stage(&l, SNOW_STAGE_READ), 0);
        assert_int_equal(check_stage(&l, SNOW_STAGE_ENCODE) +
                             check_stage(&l, SNOW_STAGE_RENDER),
                         l.calls);
        assert_true(l.calls >= 3);
    }
    snow_transfer_free(transfer);
    snow_volume_close(volume);
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
    snow_context *context = *state;
    snow_volume *volume = phantom(context, "head", 48);
    snow_transfer *transfer;
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
}

/* Work of one long item, or before the first batch, can be ended, too. */
static void a_long_item_can_be_stopped(void **state) {
    snow_context *context = *state;
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
}

/* What was too early to be reported is not lost to the next look. */
static void a_look_reports_how_far_the_work_is(void **state) {
    snow_context *context = *state;
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
}

/* Calls of many short works, each of which reports its end. */
static void many_calls_are_not_reported_more_often(void **state) {
    snow_context *context = *state;
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
}

static void nothing_is_reported_of_what_is_short(void **state) {
    snow_context *context = *state;
    listener l;
    tick = 0.0005;
    listen_to(context, &l, 0);
    for (int n = 0; n < 20; n++)
        snow_volume_close(phantom(context, "cube", 8));
    assert_int_equal(l.calls, 0);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, begin, end)

int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(files_and_measures_are_reported_and_can_be_stopped),
        TEST(saving_a_picture_is_reported_and_can_be_stopped),
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
