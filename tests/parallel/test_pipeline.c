/* tests/parallel/test_pipeline.c - pictures by many ranks that overlap are
 * those made one after another, to the bit, and what goes wrong with one is
 * told in its turn.
 */
#include "support/folder.h"
#include "support/support.h"

#include "comm/comm.h"
#include "image/image.h"
#include "simulated_network.h"

#include <snowglass/ranks.h>
#include <stdatomic.h>

#define PICTURES 5

/* On threads of their own nothing can be asserted. */
#define REQUIRE(comm, condition)                                             \
    do {                                                                     \
        if (!(condition))                                                    \
            return snow_fail(snow_comm_context(comm), SNOW_STATUS_BAD_INPUT, \
                             "line %d: not " #condition, __LINE__);          \
    } while (0)

/* Pictures of one volume, turned by `step` degrees each. */
typedef struct pipeline {
    const char *path;
    snow_view view;
    snow_settings settings;
    snow_ranks_options how;
    double step;
    double hidden;              /* of rank 0 */
    atomic_uint_fast64_t early; /* of all ranks, one after another */
    float *pixels[PICTURES];    /* one after another */
} pipeline;

typedef struct seat {
    snow_comm *comm;
    pipeline *f;
    snow_volume *volume;
    snow_transfer *transfer;
    snow_frame *frame;
} seat;

static void leave(seat *s) {
    snow_frame_free(s->frame);
    snow_transfer_free(s->transfer);
    snow_volume_close(s->volume);
}

static snow_status sit_down(snow_comm *comm, pipeline *f, seat *s) {
    const snow_look look = {.size = sizeof look, .colormap = "viridis"};
    *s = (seat){.comm = comm, .f = f};
    SNOW_TRY(snow_ranks_open(comm, f->path, NULL, &look, &f->view, &f->settings,
                             &f->how, &s->volume, &s->transfer));
    snow_status status = snow_frame_new(snow_comm_context(comm), &s->frame);
    if (status != SNOW_STATUS_OK)
        leave(s);
    return status;
}

/* The volume that a picture was begun with may go. */
static snow_status begin(seat *s, int number) {
    pipeline *f = s->f;
    snow_view view = f->view;
    view.azimuth += f->step * number;
    SNOW_TRY(snow_ranks_repartition(s->comm, s->transfer, &view, &f->settings,
                                    &f->how, &s->volume));
    return snow_ranks_begin(s->frame, s->comm, s->volume, s->transfer, &view,
                            &f->settings, &f->how);
}

/* Finishes a picture; keeps it on rank 0, or compares it. */
static snow_status finish(seat *s, int number, bool keep) {
    snow_image *image = NULL;
    SNOW_TRY(snow_ranks_finish(s->frame, &image));
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
        s->f->hidden += snow_frame_ranks_stats(s->frame)->seconds_hidden;
    }
    if (keep)
        atomic_fetch_add(&s->f->early,
                         snow_frame_ranks_stats(s->frame)->bytes_early);
    snow_image_free(image);
    REQUIRE(s->comm, good);
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

static snow_status compare_ways(snow_comm *comm, void *user) {
    seat s;
    SNOW_TRY(sit_down(comm, user, &s));
    snow_status status = fly(&s, 0, true);
    if (snow_comm_rank(comm) == 0)
        s.f->hidden = 0;
    if (status == SNOW_STATUS_OK)
        status = fly(&s, 1, false);
    leave(&s);
    return status;
}

/* --- what is flown -------------------------------------------------------- */

static void pipeline_free(pipeline *f) {
    for (int n = 0; n < PICTURES; n++)
        free(f->pixels[n]);
    free(f);
}

static pipeline *pipeline_of(const char *folder, const int64_t dims[3],
                             int side) {
    pipeline *f = calloc(1, sizeof *f);
    assert_non_null(f);
    for (int n = 0; n < PICTURES; n++)
        f->pixels[n] = calloc((size_t)(side * side) * 4, sizeof(float));
    f->path = support_folder_path(folder, "v.nrrd");
    snow_context *context = support_context();
    snow_volume *volume;
    assert_int_equal(
        snow_volume_open_phantom(context, "head", dims, 0, &volume),
        SNOW_STATUS_OK);
    assert_int_equal(snow_volume_save(volume, f->path, true), SNOW_STATUS_OK);
    snow_view_init(&f->view);
    snow_view_default(volume, &f->view);
    snow_volume_close(volume);
    snow_context_free(context);
    f->view.width = f->view.height = side;
    snow_settings_init(&f->settings);
    f->settings.threads = 1;
    f->how = (snow_ranks_options){.size = sizeof f->how, .turns = 1};
    f->step = 7;
    return f;
}

static pipeline *pipeline_new(const char *folder) {
    return pipeline_of(folder, (const int64_t[3]){34, 30, 38}, 72);
}

static void run(pipeline *f, int ranks, snow_comm_body_fn *body) {
    snow_context *context = support_context();
    if (snow_comm_run_threads(context, ranks, body, f) != SNOW_STATUS_OK)
        fail_msg("%d ranks, azimuth %g, elevation %g, fov %g, %d threads: %s",
                 ranks, f->view.azimuth, f->view.elevation, f->view.fov,
                 f->settings.threads, snow_context_message(context));
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
}

static const int rank_counts[] = {1, 2, 3, 5, 8, 16};
#define COUNTS (int)(sizeof rank_counts / sizeof *rank_counts)

/* The three axes from both sides, between them, and steps that change the axis,
 * so that voxels change hands while a picture is under way. */
static void pictures_that_overlap_have_the_same_bits(void **state) {
    (void)state;
    static const double sides[][3] = {
        {0, 0, 7},   {180, 0, 3}, {90, 0, 1},     {-90, 0, 11}, {0, 80, 5},
        {0, -80, 5}, {25, 20, 7}, {-130, -50, 9}, {10, 5, 50}};
    char folder[SUPPORT_FOLDER_BYTES];
    support_folder_make(folder);
    pipeline *f = pipeline_new(folder);
    for (int n = 0; n < (int)(sizeof sides / sizeof *sides); n++)
        for (int seen = 0; seen < 2; seen++)
            for (int i = 0; i < COUNTS; i++) {
                if (!support_takes((size_t)(i + 2 * n + seen), 4))
                    continue;
                f->view.azimuth = sides[n][0];
                f->view.elevation = sides[n][1];
                f->step = sides[n][2];
                f->view.fov = seen ? 40 : 0;
                f->settings.threads = 1 + (n + i) % 3;
                f->how.pixel_bits = (n + i) % 2 ? 8 : 0;
                f->how.combining = (snow_combine)((n + seen + i) % 5);
                run(f, rank_counts[i], compare_ways);
            }
    pipeline_free(f);
    support_folder_remove(folder);
}

/* Among them those that cannot be drawn ahead: exact ones and blends. */
static void pictures_of_every_method_may_be_begun(void **state) {
    (void)state;
    char folder[SUPPORT_FOLDER_BYTES];
    support_folder_make(folder);
    pipeline *f = pipeline_new(folder);
    for (int way = 0; way < 5; way++)
        for (int i = 0; i < 4; i++) {
            f->view.azimuth = 38;
            f->settings.method =
                way == 3 ? SNOW_METHOD_FOOTPRINT : SNOW_METHOD_AUTO;
            f->settings.quality = way == 1   ? SNOW_QUALITY_HIGH
                                  : way == 2 ? SNOW_QUALITY_DRAFT
                                             : SNOW_QUALITY_NORMAL;
            f->settings.deterministic = way == 0 || way == 3;
            f->how.scattered = 0;
            f->step = way == 4 ? 0 : 6;
            run(f, rank_counts[i], compare_ways);
        }
    pipeline_free(f);
    support_folder_remove(folder);
}

/* A picture that no other follows is sent while it is drawn; one that another
 * follows was drawn before.  Fewer lines than ranks are shared as well. */
static void pictures_sent_early_have_the_same_bits(void **state) {
    (void)state;
    char folder[SUPPORT_FOLDER_BYTES];
    support_folder_make(folder);
    pipeline *f = pipeline_new(folder);
    for (int ranks = 2; ranks <= 33; ranks++) {
        if (!support_takes_ranks(ranks, 33))
            continue;
        f->view.azimuth = 11 * ranks;
        f->view.elevation = 5 * (ranks % 7);
        f->view.zoom = ranks % 4 ? 1 : 0.1;
        f->view.fov = ranks % 3 ? 0 : 50;
        f->settings.threads = 1 + ranks % 2;
        f->how.combining = (snow_combine)(ranks % 5);
        run(f, ranks, compare_ways);
    }
    pipeline_free(f);
    support_folder_remove(folder);
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
    char folder[SUPPORT_FOLDER_BYTES];
    support_folder_make(folder);
    pipeline *f = pipeline_of(folder, (const int64_t[3]){150, 160, 170}, 300);
    f->step = 2;
    for (int ranks = 2; ranks <= 4; ranks++) {
        f->early = 0;
        run_simulated(f, ranks, 0);
        assert_true(f->early > 0);
    }
    pipeline_free(f);
    support_folder_remove(folder);
}

/* Messages take so long that the next picture is drawn before they come. */
static void pictures_are_drawn_while_messages_travel(void **state) {
    (void)state;
    char folder[SUPPORT_FOLDER_BYTES];
    support_folder_make(folder);
    pipeline *f = pipeline_new(folder);
    run_simulated(f, 3, 1);
    assert_true(f->hidden > 0);
    pipeline_free(f);
    support_folder_remove(folder);
}

/* --- what goes wrong ------------------------------------------------------ */

static bool says(const seat *s, const char *text) {
    return strstr(snow_context_message(snow_comm_context(s->comm)), text) !=
           NULL;
}

static snow_status misuse_seat(seat *s) {
    snow_image *image = NULL;
    pipeline *f = s->f;
    REQUIRE(s->comm,
            snow_ranks_finish(s->frame, &image) == SNOW_STATUS_BAD_USAGE);
    REQUIRE(s->comm, says(s, "no picture is in flight"));
    SNOW_TRY(begin(s, 0)); /* asks for the range of values: it is not ahead */
    SNOW_TRY(finish(s, 0, true));
    SNOW_TRY(begin(s, 0));
    REQUIRE(s->comm,
            snow_ranks_render(s->frame, s->comm, s->volume, s->transfer,
                              &f->view, &f->settings, &f->how,
                              &image) == SNOW_STATUS_BAD_USAGE);
    REQUIRE(s->comm, says(s, "a picture in flight"));
    if (snow_comm_size(s->comm) > 1)
        REQUIRE(s->comm, snow_frame_render(s->frame, s->volume, s->transfer,
                                           &f->view, &f->settings,
                                           &image) == SNOW_STATUS_BAD_USAGE);
    SNOW_TRY(begin(s, 1));
    REQUIRE(s->comm, begin(s, 2) == SNOW_STATUS_BAD_USAGE);
    REQUIRE(s->comm, says(s, "two pictures are in flight"));
    SNOW_TRY(finish(s, 0, true));
    SNOW_TRY(finish(s, 1, true));
    SNOW_TRY(begin(s, 2)); /* left to the frame */
    return begin(s, 3);
}

static snow_status misuse(snow_comm *comm, void *user) {
    seat s;
    SNOW_TRY(sit_down(comm, user, &s));
    snow_status status = misuse_seat(&s);
    leave(&s);
    return status;
}

static void too_many_pictures_are_refused_and_those_begun_end(void **state) {
    (void)state;
    char folder[SUPPORT_FOLDER_BYTES];
    support_folder_make(folder);
    pipeline *f = pipeline_new(folder);
    for (int i = 0; i < COUNTS; i++) {
        f->settings.threads = 1 + i % 3;
        run(f, rank_counts[i], misuse);
    }
    pipeline_free(f);
    support_folder_remove(folder);
}

/* The second picture is wrong, on one rank or on all; the others are not. */
static snow_status spoil_seat(seat *s, bool all) {
    snow_image *image = NULL;
    pipeline *f = s->f;
    snow_settings other = f->settings;
    bool wrong = all || snow_comm_rank(s->comm) == 1;
    if (all)
        other.footprint = 77;
    else
        other.threshold = 33;
    SNOW_TRY(begin(s, 0));
    SNOW_TRY(snow_ranks_begin(s->frame, s->comm, s->volume, s->transfer,
                              &f->view, wrong ? &other : &f->settings,
                              &f->how));
    SNOW_TRY(finish(s, 0, false));
    REQUIRE(s->comm,
            snow_ranks_finish(s->frame, &image) == SNOW_STATUS_BAD_USAGE);
    REQUIRE(s->comm, says(s, all ? "77" : "differ between ranks"));
    REQUIRE(s->comm, !image);
    SNOW_TRY(begin(s, 1));
    return finish(s, 1, false);
}

static snow_status spoil(snow_comm *comm, void *user) {
    seat s;
    SNOW_TRY(sit_down(comm, user, &s));
    snow_status status = fly(&s, 0, true);
    for (int all = 0; all < 2 && status == SNOW_STATUS_OK; all++)
        status = spoil_seat(&s, all != 0);
    leave(&s);
    return status;
}

static void a_wrong_picture_is_told_in_its_turn(void **state) {
    (void)state;
    char folder[SUPPORT_FOLDER_BYTES];
    support_folder_make(folder);
    pipeline *f = pipeline_new(folder);
    for (int i = 1; i < 5; i++)
        run(f, rank_counts[i], spoil);
    pipeline_free(f);
    support_folder_remove(folder);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_that_overlap_have_the_same_bits),
        cmocka_unit_test(pictures_of_every_method_may_be_begun),
        cmocka_unit_test(pictures_sent_early_have_the_same_bits),
        cmocka_unit_test(pictures_are_sent_while_they_are_drawn),
        cmocka_unit_test(pictures_are_drawn_while_messages_travel),
        cmocka_unit_test(too_many_pictures_are_refused_and_those_begun_end),
        cmocka_unit_test(a_wrong_picture_is_told_in_its_turn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
