/* tests/parallel/test_pipeline.c - pictures by many ranks that overlap are
 * those made one after another, to the bit, and what goes wrong with one is
 * told in its turn.
 */
#include "support/folder.h"
#include "support/opened.h"

#include "image/image.h"
#include "simulated_network.h"

#include <stdatomic.h>

#define PICTURES 5

/* Pictures of one volume, turned by `step` degrees each. */
typedef struct pipeline {
    opened_request open;
    double step;
    double hidden;              /* of rank 0 */
    atomic_uint_fast64_t early; /* of all ranks, one after another */
    float *pixels[PICTURES];    /* one after another */
} pipeline;

typedef struct seat {
    opened o;
    snow_comm *comm;
    pipeline *f;
} seat;

/* Opens the volume, does something with it, and closes it. */
typedef snow_status seat_fn(seat *s);

static snow_status sit(snow_comm *comm, pipeline *f, seat_fn *act) {
    seat s = {.comm = comm, .f = f};
    SNOW_TRY(opened_enter(comm, &f->open, &s.o));
    const snow_status status = act(&s);
    opened_leave(&s.o);
    return status;
}

static snow_status begin_with(seat *s, const snow_view *view,
                              const snow_settings *settings) {
    return snow_ranks_begin(s->o.frame, s->comm, s->o.volume, s->o.transfer,
                            view, settings, &s->f->open.how);
}

/* The volume that a picture was begun with may go. */
static snow_status begin(seat *s, int number) {
    pipeline *f = s->f;
    snow_view view = f->open.view;
    view.azimuth += f->step * number;
    SNOW_TRY(opened_cut(&s->o, &view));
    return begin_with(s, &view, &f->open.settings);
}

/* Finishes a picture; keeps it on rank 0, or compares it. */
static snow_status finish(seat *s, int number, bool keep) {
    snow_image *image = NULL;
    SNOW_TRY(snow_ranks_finish(s->o.frame, &image));
    float *pixels = s->f->pixels[number];
    bool good = (snow_comm_rank(s->comm) == 0) == (image != NULL);
    if (image) {
        size_t bytes =
            (size_t)(image->width * image->height * image->channels) *
            sizeof *pixels;
        if (keep)
            memcpy(pixels, image->pixels, bytes);
        else
            good = memcmp(pixels, image->pixels, bytes) == 0;
        s->f->hidden += snow_frame_ranks_stats(s->o.frame)->seconds_hidden;
    }
    if (keep)
        atomic_fetch_add(&s->f->early,
                         snow_frame_ranks_stats(s->o.frame)->bytes_early);
    snow_image_free(image);
    snow_comm *comm = s->comm;
    CHECK(good);
    return SNOW_STATUS_OK;
}

static snow_status fly(seat *s, int ahead, bool keep) {
    for (int i = 0; i < PICTURES + ahead; i++) {
        if (i < PICTURES)
            SNOW_TRY(begin(s, i));
        if (i >= ahead)
            SNOW_TRY(finish(s, i - ahead, keep));
    }
    return SNOW_STATUS_OK;
}

static snow_status fly_both_ways(seat *s) {
    SNOW_TRY(fly(s, 0, true));
    if (snow_comm_rank(s->comm) == 0)
        s->f->hidden = 0;
    return fly(s, 1, false);
}

static snow_status compare_ways(snow_comm *comm, void *user) {
    return sit(comm, user, fly_both_ways);
}

/* --- what is flown -------------------------------------------------------- */

static char folder[SUPPORT_FOLDER_BYTES];

static pipeline *pipeline_of(const int64_t dims[3], int side) {
    pipeline *f = calloc(1, sizeof *f);
    opened_request *o = &f->open;
    for (int n = 0; n < PICTURES; n++)
        f->pixels[n] = calloc((size_t)(side * side) * 4, sizeof(float));
    o->path = support_folder_path(folder, "v.nrrd");
    snow_context *context = support_context();
    snow_volume *volume;
    assert_int_equal(
        snow_volume_open_phantom(context, "head", dims, 0, &volume),
        SNOW_STATUS_OK);
    assert_int_equal(snow_volume_save(volume, o->path, true), SNOW_STATUS_OK);
    snow_view_init(&o->view);
    snow_view_default(volume, &o->view);
    snow_volume_close(volume);
    snow_context_free(context);
    snow_volume_options_init(&o->options);
    o->look = (snow_look){.size = sizeof o->look, .colormap = "viridis"};
    o->view.width = o->view.height = side;
    snow_settings_init(&o->settings);
    o->settings.threads = 1;
    o->how = (snow_ranks_options){.size = sizeof o->how, .turns = 1};
    f->step = 7;
    return f;
}

static void pipeline_free(pipeline *f) {
    for (int n = 0; n < PICTURES; n++)
        free(f->pixels[n]);
    free(f);
}

/* Of a small volume, for each test. */
static int begin_pipeline(void **state) {
    support_folder_make(folder);
    *state = pipeline_of((const int64_t[3]){34, 30, 38}, 72);
    return 0;
}

static int end_pipeline(void **state) {
    pipeline_free(*state);
    support_folder_remove(folder);
    return 0;
}

static void run(pipeline *f, int ranks, snow_comm_body_fn *body) {
    snow_context *context = support_context();
    if (snow_comm_run_threads(context, ranks, body, f) != SNOW_STATUS_OK)
        fail_msg("%d ranks, azimuth %g, elevation %g, fov %g, %d threads: %s",
                 ranks, f->open.view.azimuth, f->open.view.elevation,
                 f->open.view.fov, f->open.settings.threads,
                 snow_context_message(context));
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
}

static const int rank_counts[] = {1, 2, 3, 5, 8, 16};
#define COUNTS (int)(sizeof rank_counts / sizeof *rank_counts)

/* The three axes from both sides, between them, and steps that change the axis,
 * so that voxels change hands while a picture is under way. */
static void pictures_that_overlap_have_the_same_bits(void **state) {
    pipeline *f = *state;
    static const double sides[][3] = {
        {0, 0, 7},   {180, 0, 3}, {90, 0, 1},     {-90, 0, 11}, {0, 80, 5},
        {0, -80, 5}, {25, 20, 7}, {-130, -50, 9}, {10, 5, 50}};
    for (int n = 0; n < (int)(sizeof sides / sizeof *sides); n++)
        for (int seen = 0; seen < 2; seen++)
            for (int i = 0; i < COUNTS; i++) {
                if (!support_takes((size_t)((2 * n + seen) * COUNTS + i), 13))
                    continue;
                f->open.view.azimuth = sides[n][0];
                f->open.view.elevation = sides[n][1];
                f->step = sides[n][2];
                f->open.view.fov = seen ? 40 : 0;
                f->open.settings.threads = 1 + (n + i) % 3;
                f->open.how.pixel_bits = (n + i) % 2 ? 8 : 0;
                f->open.how.combining = (snow_combine)((n + seen + i) % 5);
                run(f, rank_counts[i], compare_ways);
            }
}

/* Among them those that cannot be drawn ahead: exact ones and blends. */
static void pictures_of_every_method_may_be_begun(void **state) {
    pipeline *f = *state;
    for (int way = 0; way < 5; way++)
        for (int i = 0; i < 4; i++) {
            if (!support_takes((size_t)(4 * way + i), 3))
                continue;
            f->open.view.azimuth = 38;
            f->open.settings.method =
                way == 3 ? SNOW_METHOD_FOOTPRINT : SNOW_METHOD_AUTO;
            f->open.settings.quality = way == 1   ? SNOW_QUALITY_HIGH
                                       : way == 2 ? SNOW_QUALITY_DRAFT
                                                  : SNOW_QUALITY_NORMAL;
            f->open.settings.deterministic = way == 0 || way == 3;
            f->open.how.scattered = 0;
            f->step = way == 4 ? 0 : 6;
            run(f, rank_counts[i], compare_ways);
        }
}

/* A picture that no other follows is sent while it is drawn; one that another
 * follows was drawn before.  Fewer lines than ranks are shared as well. */
static void pictures_sent_early_have_the_same_bits(void **state) {
    pipeline *f = *state;
    for (int ranks = 2; ranks <= 33; ranks++) {
        if (!support_takes_ranks(ranks, 33))
            continue;
        f->open.view.azimuth = 11 * ranks;
        f->open.view.elevation = 5 * (ranks % 7);
        f->open.view.zoom = ranks % 4 ? 1 : 0.1;
        f->open.view.fov = ranks % 3 ? 0 : 50;
        f->open.settings.threads = 1 + ranks % 2;
        f->open.how.combining = (snow_combine)(ranks % 5);
        run(f, ranks, compare_ways);
    }
}

static void run_simulated(pipeline *f, int ranks, double latency) {
    const snow_network network = {
        .latency = latency, .bandwidth = 1e9, .slowness = 1};
    snow_context *context = support_context();
    if (snow_comm_run_simulated(context, ranks, &network, compare_ways, f) !=
        SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(context));
    snow_context_free(context);
}

/* Pieces of so large a picture are counted, from the second one on before it is
 * drawn. */
static void pictures_are_sent_while_they_are_drawn(void **state) {
    (void)state;
    pipeline *f = pipeline_of((const int64_t[3]){150, 160, 170}, 300);
    f->step = 2;
    for (int ranks = 2; ranks <= 4; ranks++) {
        if (!support_takes((size_t)ranks, 3))
            continue;
        f->early = 0;
        run_simulated(f, ranks, 0);
        assert_true(f->early > 0);
    }
    pipeline_free(f);
}

/* Messages take so long that the next picture is drawn before they come. */
static void pictures_are_drawn_while_messages_travel(void **state) {
    pipeline *f = *state;
    run_simulated(f, 3, 1);
    assert_true(f->hidden > 0);
}

/* --- what goes wrong ------------------------------------------------------ */

static bool says(const seat *s, const char *text) {
    return strstr(snow_context_message(snow_comm_context(s->comm)), text) !=
           NULL;
}

static snow_status misuse_seat(seat *s) {
    snow_comm *comm = s->comm;
    snow_image *image = NULL;
    const snow_view *view = &s->f->open.view;
    CHECK(snow_ranks_finish(s->o.frame, &image) == SNOW_STATUS_BAD_USAGE);
    CHECK(says(s, "no picture is in flight"));
    SNOW_TRY(begin(s, 0)); /* asks for the range of values: it is not ahead */
    SNOW_TRY(finish(s, 0, true));
    SNOW_TRY(begin(s, 0));
    CHECK(opened_draw(&s->o, view, &image) == SNOW_STATUS_BAD_USAGE);
    CHECK(says(s, "a picture in flight"));
    if (snow_comm_size(comm) > 1)
        CHECK(snow_frame_render(s->o.frame, s->o.volume, s->o.transfer, view,
                                &s->f->open.settings,
                                &image) == SNOW_STATUS_BAD_USAGE);
    SNOW_TRY(begin(s, 1));
    CHECK(begin(s, 2) == SNOW_STATUS_BAD_USAGE);
    CHECK(says(s, "two pictures are in flight"));
    SNOW_TRY(finish(s, 0, true));
    SNOW_TRY(finish(s, 1, true));
    SNOW_TRY(begin(s, 2)); /* left to the frame */
    return begin(s, 3);
}

static snow_status misuse(snow_comm *comm, void *user) {
    return sit(comm, user, misuse_seat);
}

static void too_many_pictures_are_refused_and_those_begun_end(void **state) {
    pipeline *f = *state;
    for (int i = 0; i < COUNTS; i++) {
        f->open.settings.threads = 1 + i % 3;
        run(f, rank_counts[i], misuse);
    }
}

/* The second picture is wrong, on one rank or on all; the others are not. */
static snow_status spoil_seat(seat *s, bool all) {
    snow_comm *comm = s->comm;
    snow_image *image = NULL;
    pipeline *f = s->f;
    snow_settings other = f->open.settings;
    bool wrong = all || snow_comm_rank(comm) == 1;
    if (all)
        other.footprint = 77;
    else
        other.threshold = 33;
    SNOW_TRY(begin(s, 0));
    SNOW_TRY(begin_with(s, &f->open.view, wrong ? &other : &f->open.settings));
    SNOW_TRY(finish(s, 0, false));
    CHECK(snow_ranks_finish(s->o.frame, &image) == SNOW_STATUS_BAD_USAGE);
    CHECK(says(s, all ? "77" : "differ between ranks"));
    CHECK(!image);
    SNOW_TRY(begin(s, 1));
    return finish(s, 1, false);
}

static snow_status spoil_both_ways(seat *s) {
    SNOW_TRY(fly(s, 0, true));
    SNOW_TRY(spoil_seat(s, false));
    return spoil_seat(s, true);
}

static snow_status spoil(snow_comm *comm, void *user) {
    return sit(comm, user, spoil_both_ways);
}

static void a_wrong_picture_is_told_in_its_turn(void **state) {
    pipeline *f = *state;
    for (int i = 1; i < 5; i++)
        run(f, rank_counts[i], spoil);
}

#define TEST(name) \
    cmocka_unit_test_setup_teardown(name, begin_pipeline, end_pipeline)

int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(pictures_that_overlap_have_the_same_bits),
        TEST(pictures_of_every_method_may_be_begun),
        TEST(pictures_sent_early_have_the_same_bits),
        TEST(pictures_are_sent_while_they_are_drawn),
        TEST(pictures_are_drawn_while_messages_travel),
        TEST(too_many_pictures_are_refused_and_those_begun_end),
        TEST(a_wrong_picture_is_told_in_its_turn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
