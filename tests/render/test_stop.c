/* tests/render/test_stop.c - a picture that is stopped ends with its status,
 * leaves nothing behind, and the next one has the bits of one that was never
 * stopped. */
#include "support/folder.h"
#include "support/support.h"

#include "base/monitor.h"
#include "base/thread_pool.h"
#include "comm/comm.h"
#include "image/image.h"
#include "render/picture.h"
#include "render/tested.h"

#include <sched.h>
#include <snowglass/ranks.h>
#include <stdatomic.h>

/* A way to draw. */
typedef struct way {
    const char *name;
    snow_method method;
    snow_mode mode;
    snow_quality quality;
    double fov;
    int depth, deterministic;
    double gradient; /* opacity depends on gradients up to this */
    double zoom;     /* 0: 1 */
    bool alone;      /* by one process, in memory */
    double darkened; /* by depths, and by occlusion */
} way;

#define SHEAR_WARP .method = SNOW_METHOD_SHEAR_WARP
static const way ways[] = {
    {"parallel", SHEAR_WARP},
    {"parallel, draft", SHEAR_WARP, .quality = SNOW_QUALITY_DRAFT},
    {"few pixels, draft", SHEAR_WARP, .quality = SNOW_QUALITY_DRAFT,
     .zoom = 0.2},
    {"parallel, high", SHEAR_WARP, .quality = SNOW_QUALITY_HIGH},
    {"parallel, groups", SHEAR_WARP, .deterministic = 1},
    {"gradient opacity", SHEAR_WARP, .gradient = 20},
    {"perspective", SHEAR_WARP, .fov = 30},
    {"perspective, high", SHEAR_WARP, .fov = 30, .quality = SNOW_QUALITY_HIGH},
    {"depth", SHEAR_WARP, .depth = 1},
    {"mip", SHEAR_WARP, .mode = SNOW_MODE_MIP},
    {"minip", SHEAR_WARP, .mode = SNOW_MODE_MINIP},
    {"mean", SHEAR_WARP, .mode = SNOW_MODE_MEAN},
    {"sum", SHEAR_WARP, .mode = SNOW_MODE_SUM},
    {"mip, perspective", SHEAR_WARP, .mode = SNOW_MODE_MIP, .fov = 30},
    {"iso", SHEAR_WARP, .mode = SNOW_MODE_ISO},
    {"iso, perspective", SHEAR_WARP, .mode = SNOW_MODE_ISO, .fov = 30},
    {"depth of iso", SHEAR_WARP, .mode = SNOW_MODE_ISO, .depth = 1,
     .alone = true},
    {"darkened", SHEAR_WARP, .darkened = 0.7},
    {"ray cast", .method = SNOW_METHOD_RAYCAST, .alone = true},
    {"original", .method = SNOW_METHOD_ORIGINAL},
    {"tested", .method = SNOW_METHOD_TESTED},
    {"footprint", .method = SNOW_METHOD_FOOTPRINT},
    {"footprint, groups", .method = SNOW_METHOD_FOOTPRINT, .deterministic = 1},
    {"footprint, mip", .method = SNOW_METHOD_FOOTPRINT, .mode = SNOW_MODE_MIP},
    {"footprint, perspective", .method = SNOW_METHOD_FOOTPRINT, .fov = 30},
    {"original, perspective", .method = SNOW_METHOD_ORIGINAL, .fov = 30},
};
#define WAYS (sizeof ways / sizeof *ways)

/* A small volume in a file of a folder, whose path is *state. */
static char folder[SUPPORT_FOLDER_BYTES];

static int write_volume(void **state) {
    static char path[512];
    snow_context *context = support_context();
    snow_volume *volume;
    support_folder_make(folder);
    snprintf(path, sizeof path, "%s", support_folder_path(folder, "v.nrrd"));
    assert_int_equal(snow_volume_open_phantom(context, "head",
                                              (const int64_t[3]){26, 30, 22}, 0,
                                              &volume),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_volume_save(volume, path, true), SNOW_STATUS_OK);
    snow_volume_close(volume);
    snow_context_free(context);
    *state = path;
    return 0;
}

static int remove_volume(void **state) {
    (void)state;
    support_folder_remove(folder);
    return 0;
}

/* --- who asks for a stop -------------------------------------------------- */

typedef struct question {
    int asked, at;    /* so far; that is answered with a stop, 0: none */
    pthread_t thread; /* that may ask */
    bool foreign;     /* another one has */
} question;

static bool answer(void *user) {
    question *q = user;
    q->foreign |= !pthread_equal(q->thread, pthread_self());
    return ++q->asked == q->at;
}

/* --- items of a batch ----------------------------------------------------- */

typedef struct batch {
    snow_monitor monitor;
    int items; /* of the thread that asks */
} batch;

/* The other thread leaves all items but one to it. */
static void count_item(void *job, int64_t item, int worker) {
    batch *b = job;
    (void)item;
    while (worker && !atomic_load(&b->monitor.stopped))
        sched_yield();
    b->items += worker == 0;
}

static void no_item_is_begun_after_a_stop(void **state) {
    (void)state;
    snow_context *context = support_context();
    for (int threads = 1; threads <= 2; threads++)
        for (int at = 1; at <= 5; at++) {
            question q = {.at = at, .thread = pthread_self()};
            batch b = {.items = 0};
            snow_monitor_begin(context, &b.monitor, answer, &q);
            snow_status status =
                snow_parallel(context, threads, 10, count_item, &b);
            assert_int_equal(snow_monitor_end(&b.monitor, status),
                             SNOW_STATUS_STOPPED);
            assert_int_equal(b.items, at - 1);
        }
    snow_context_free(context);
}

/* --- what is drawn -------------------------------------------------------- */

typedef struct scene {
    snow_context *context;
    snow_volume *volume;
    snow_transfer *transfer;
    snow_view view;
    snow_settings settings;
} scene;

static void fill_settings(const way *w, int threads, scene *s) {
    snow_settings_init(&s->settings);
    s->settings.method = w->method;
    s->settings.mode = w->mode;
    s->settings.quality = w->quality;
    s->settings.depth = w->depth;
    s->settings.deterministic = w->deterministic;
    s->settings.threads = threads;
    s->settings.iso = 60;
    s->settings.depth_darkening = s->settings.occlusion = w->darkened;
    s->view.fov = w->fov;
    s->view.zoom *= w->zoom > 0 ? w->zoom : 1;
}

static snow_look look_of(const way *w, const snow_opacity_point *gradients) {
    bool fades = w->gradient > 0;
    return (snow_look){.size = sizeof(snow_look),
                       .colormap = "viridis",
                       .gradient_opacities = fades ? gradients : NULL,
                       .gradient_opacity_count = fades ? 2 : 0};
}

static snow_status fill_look(const way *w, scene *s) {
    const snow_opacity_point gradients[] = {{0, 0.1}, {w->gradient, 1}};
    const snow_look look = look_of(w, gradients);
    return snow_transfer_new_for_volume(s->volume, &look, &s->transfer);
}

static void scene_free(scene *s) {
    snow_transfer_free(s->transfer);
    snow_volume_close(s->volume);
    assert_int_equal(snow_context_bytes(s->context), 0);
    snow_context_free(s->context);
}

static void fill_view(const snow_volume *volume, int side, snow_view *view) {
    snow_view_init(view);
    snow_view_default(volume, view);
    view->azimuth = 25;
    view->elevation = 10;
    view->width = view->height = side;
}

static void scene_new(const char *path, const way *w, int threads,
                      bool streamed, int side, scene *s) {
    snow_volume *volume;
    *s = (scene){.context = support_context()};
    assert_int_equal(snow_volume_open(s->context, path, NULL, &volume),
                     SNOW_STATUS_OK);
    s->volume = volume;
    assert_int_equal(fill_look(w, s), SNOW_STATUS_OK);
    if (streamed) {
        snow_volume_close(volume);
        assert_int_equal(snow_volume_open_streamed(s->context, path, NULL,
                                                   1 << 14, &s->volume),
                         SNOW_STATUS_OK);
    }
    fill_view(s->volume, side, &s->view);
    fill_settings(w, threads, s);
}

static snow_status draw(const scene *s, snow_frame *frame, question *q,
                        snow_image **image) {
    snow_settings settings = s->settings;
    q->thread = pthread_self();
    q->foreign = false;
    settings.stop = q->at || q->asked < 0 ? answer : NULL;
    settings.stop_user = q;
    return snow_frame_render(frame, s->volume, s->transfer, &s->view, &settings,
                             image);
}

static size_t image_bytes(const snow_image *image) {
    return (size_t)image->width * (size_t)image->height *
           (size_t)image->channels * sizeof *image->pixels;
}

static void assert_same(const snow_image *a, const snow_image *b) {
    assert_int_equal(image_bytes(a), image_bytes(b));
    assert_memory_equal(a->pixels, b->pixels, image_bytes(a));
}

static snow_image *draw_whole(const scene *s, snow_frame *frame) {
    question none = {0};
    snow_image *image = NULL;
    assert_int_equal(draw(s, frame, &none, &image), SNOW_STATUS_OK);
    return image;
}

/* --- one process ---------------------------------------------------------- */

/* Stops at the k-th question; the same frame then draws the picture. */
static void stop_at(const scene *s, int k, const snow_image *whole,
                    bool encoded) {
    question q = {.at = k};
    snow_frame *frame;
    snow_image *image = NULL;
    assert_int_equal(snow_frame_new(s->context, &frame), SNOW_STATUS_OK);
    if (encoded)
        snow_image_free(draw_whole(s, frame));
    snow_status status = draw(s, frame, &q, &image);
    assert_false(q.foreign);
    if (q.asked >= k) {
        assert_int_equal(status, SNOW_STATUS_STOPPED);
        assert_non_null(strstr(snow_context_message(s->context), "stopped"));
        assert_null(image);
        assert_null(snow_frame_depth(frame));
        assert_int_equal(q.asked, k); /* nobody asks again */
    } else {
        assert_int_equal(status, SNOW_STATUS_OK);
        snow_image_free(image);
    }
    image = draw_whole(s, frame);
    assert_same(image, whole);
    snow_image_free(image);
    snow_frame_free(frame);
}

/* Of three kinds - by one thread, by two, and of a file - the short tier takes
 * each way in one. */
static void stop_ways(const char *path, size_t kind) {
    const int threads = kind ? 2 : 1;
    const bool streamed = kind == 2;
    for (size_t n = 0; n < WAYS; n++) {
        scene s;
        snow_frame *frame;
        snow_image *asked = NULL;
        question all = {.asked = -1000000};
        if (!support_takes(n + kind, 3) ||
            (streamed && (ways[n].deterministic || ways[n].alone)))
            continue;
        scene_new(path, &ways[n], threads, streamed, 40, &s);
        assert_int_equal(snow_frame_new(s.context, &frame), SNOW_STATUS_OK);
        snow_image *whole = draw_whole(&s, frame);
        snow_frame_free(frame);
        assert_int_equal(snow_frame_new(s.context, &frame), SNOW_STATUS_OK);
        assert_int_equal(draw(&s, frame, &all, &asked), SNOW_STATUS_OK);
        assert_same(asked, whole);
        snow_image_free(asked);
        snow_frame_free(frame);
        int count = all.asked + 1000000;
        assert_true(count >= 2);
        const int at[] = {1, 2, count / 3, 2 * count / 3, count - 1, count};
        for (size_t k = 0; k < sizeof at / sizeof *at; k++)
            if (at[k] > 0 && support_takes(k + n, 5))
                stop_at(&s, at[k], whole, k % 2);
        snow_image_free(whole);
        scene_free(&s);
    }
}

static void pictures_stop(void **state) {
    const char *path = *state;
    for (size_t kind = 0; kind < 3; kind++)
        stop_ways(path, kind);
}

/* --- ranks ---------------------------------------------------------------- */

#define REQUIRE(comm, condition)                                             \
    do {                                                                     \
        if (!(condition))                                                    \
            return snow_fail(snow_comm_context(comm), SNOW_STATUS_BAD_INPUT, \
                             "line %d: not " #condition, __LINE__);          \
    } while (0)

typedef struct crew {
    const char *path;
    snow_view view;
    const way *way;
    int threads;
    bool flight;
    atomic_int questions; /* of the rank that asked most */
    atomic_int stopped;
} crew;

typedef struct place {
    snow_comm *comm;
    crew *crew;
    scene s;
    snow_frame *frame;
    question q;
} place;

/* With `at` 0 nobody is asked. */
static snow_status begin(place *seat, int at) {
    snow_ranks_options how = {.size = sizeof how};
    snow_settings settings = seat->s.settings;
    if (at) {
        seat->q = (question){.at = at, .thread = pthread_self()};
        settings.stop = answer;
        settings.stop_user = &seat->q;
    }
    return snow_ranks_begin(seat->frame, seat->comm, seat->s.volume,
                            seat->s.transfer, &seat->s.view, &settings, &how);
}

/* Finishes a picture; compares it with `whole`, or keeps it. */
static snow_status finish(place *seat, snow_image **whole) {
    snow_image *image = NULL;
    SNOW_TRY(snow_ranks_finish(seat->frame, &image));
    if (!image)
        return SNOW_STATUS_OK;
    if (!*whole) {
        *whole = image;
        return SNOW_STATUS_OK;
    }
    bool same =
        image_bytes(image) == image_bytes(*whole) &&
        memcmp(image->pixels, (*whole)->pixels, image_bytes(image)) == 0;
    snow_image_free(image);
    REQUIRE(seat->comm, same);
    return SNOW_STATUS_OK;
}

/* Rank `who` stops at its question `at`: the picture ends on all ranks, or on
 * none where it is not asked so often. */
static snow_status stop_one(place *seat, int who, int at, snow_image **whole) {
    int rank = snow_comm_rank(seat->comm);
    SNOW_TRY(begin(seat, rank == who ? at : 1 << 30));
    if (seat->crew->flight) /* the next one is begun, and lives on */
        SNOW_TRY(begin(seat, 0));
    snow_status status = finish(seat, whole);
    int64_t words[2] = {status == SNOW_STATUS_STOPPED,
                        status == SNOW_STATUS_OK};
    SNOW_TRY(snow_comm_reduce_ints(seat->comm, words, 2, SNOW_REDUCE_SUM));
    int ranks = snow_comm_size(seat->comm);
    REQUIRE(seat->comm, words[0] == ranks || words[1] == ranks);
    REQUIRE(seat->comm, !seat->q.foreign);
    atomic_fetch_add(&seat->crew->stopped, words[0] == ranks);
    if (seat->crew->flight)
        return finish(seat, whole);
    SNOW_TRY(begin(seat, 0));
    return finish(seat, whole);
}

static snow_status stop_many(place *seat) {
    snow_image *whole = NULL;
    int64_t asked;
    SNOW_TRY(begin(seat, 0));
    snow_status status = finish(seat, &whole);
    if (status == SNOW_STATUS_OK)
        status = begin(seat, 1 << 30);
    if (status == SNOW_STATUS_OK)
        status = finish(seat, &whole);
    asked = seat->q.asked;
    if (status == SNOW_STATUS_OK)
        status = snow_comm_reduce_ints(seat->comm, &asked, 1, SNOW_REDUCE_MAX);
    for (int n = 0; n < 4 && status == SNOW_STATUS_OK; n++) {
        snow_frame_free(seat->frame); /* to be encoded anew, now and then */
        seat->frame = NULL;
        status = snow_frame_new(seat->s.context, &seat->frame);
        if (status == SNOW_STATUS_OK && n % 2) {
            status = begin(seat, 0);
            if (status == SNOW_STATUS_OK)
                status = finish(seat, &whole);
        }
        if (status == SNOW_STATUS_OK)
            status = stop_one(seat, n % snow_comm_size(seat->comm),
                              1 + (int)asked * n / 4, &whole);
    }
    snow_image_free(whole);
    return status;
}

static snow_status sit_down(snow_comm *comm, void *user) {
    crew *c = user;
    place seat = {.comm = comm, .crew = c};
    scene *s = &seat.s;
    snow_ranks_options how = {.size = sizeof how};
    const snow_opacity_point gradients[] = {{0, 0.1}, {c->way->gradient, 1}};
    const snow_look look = look_of(c->way, gradients);
    s->context = snow_comm_context(comm);
    s->view = c->view;
    fill_settings(c->way, c->threads, s);
    SNOW_TRY(snow_ranks_open(comm, c->path, NULL, &look, &s->view, &s->settings,
                             &how, &s->volume, &s->transfer));
    snow_status status = snow_frame_new(s->context, &seat.frame);
    if (status == SNOW_STATUS_OK)
        status = stop_many(&seat);
    snow_frame_free(seat.frame);
    snow_transfer_free(s->transfer);
    snow_volume_close(s->volume);
    return status;
}

static void view_of_file(snow_context *context, const char *path,
                         snow_view *view) {
    snow_volume *volume;
    assert_int_equal(snow_volume_open(context, path, NULL, &volume),
                     SNOW_STATUS_OK);
    fill_view(volume, 40, view);
    snow_volume_close(volume);
}

/* Three crews: of each way the short tier takes one. */
static void pictures_of_ranks_stop_on_all(void **state) {
    static const struct {
        int ranks, threads;
        bool flight; /* the next picture is under way */
    } crews[] = {{2, 1, false}, {3, 2, false}, {3, 1, true}};
    for (size_t n = 0; n < 3 * WAYS; n++) {
        const size_t kind = n / WAYS;
        const way *w = &ways[n % WAYS];
        if (w->alone || !support_takes(n % WAYS + kind, 3))
            continue;
        snow_context *context = support_context();
        crew c = {.path = *state,
                  .way = w,
                  .threads = crews[kind].threads,
                  .flight = crews[kind].flight};
        view_of_file(context, c.path, &c.view);
        if (snow_comm_run_threads(context, crews[kind].ranks, sit_down, &c) !=
            SNOW_STATUS_OK)
            fail_msg("%s: %s", w->name, snow_context_message(context));
        assert_true(atomic_load(&c.stopped) >= crews[kind].ranks);
        assert_int_equal(snow_context_bytes(context), 0);
        snow_context_free(context);
    }
}

#define TEST(name) \
    cmocka_unit_test_setup_teardown(name, write_volume, remove_volume)

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_item_is_begun_after_a_stop),
        TEST(pictures_stop),
        TEST(pictures_of_ranks_stop_on_all),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
