/* tests/parallel/test_trim.c - parts that lack what the look of their opening
 * shows nothing of: pictures have the same bits, and other looks are refused.
 */
#include "support/ball.h"

#include "classify/hidden.h"
#include "decompose/partition.h"
#include "parallel/part.h"
#include "parallel/trim.h"
#include "render/ghosts.h"
#include "transfer/transfer.h"

#include <math.h>
#include <snowglass/ranks.h>

#define MOST_RANKS 8
#define SIDE 40
#define PICTURES 4

static const snow_opacity_point ball_alone[] = {
    {70, 0}, {100, 0.1}, {160, 0.7}, {230, 0.9}};
static const snow_opacity_point all_seen[] = {{0, 0.01}, {255, 0.9}};

/* What ranks are asked to draw, and what comes of it. */
typedef struct request {
    const char *path;
    snow_look look;
    snow_settings settings;
    snow_ranks_options how;
    snow_view views[PICTURES];
    int pictures;
    float *made; /* all pictures */
    bool trims;  /* parts lack what the look does not show: checked */
    int64_t rings[MOST_RANKS][3];
    int cuts[MOST_RANKS]; /* that gave a rank another part */
    int64_t stored[MOST_RANKS], owned[MOST_RANKS];
    int64_t voxels[MOST_RANKS], interesting[MOST_RANKS];
} request;

/* On threads of their own nothing can be asserted. */
#define REQUIRE(comm, condition)                                             \
    do {                                                                     \
        if (!(condition))                                                    \
            return snow_fail(snow_comm_context(comm), SNOW_STATUS_BAD_INPUT, \
                             "line %d: not " #condition, __LINE__);          \
    } while (0)

static size_t floats_of(const request *r) {
    return (size_t)r->pictures * SIDE * SIDE * 4;
}

static void set_view(support_files *place, const char *name, snow_view *view) {
    assert_int_equal(snow_view_from_name(place->context, name, view),
                     SNOW_STATUS_OK);
    view->width = view->height = SIDE;
}

static void begin_request(support_files *place, const char *path, request *r) {
    *r = (request){.path = path, .pictures = 1, .how.size = sizeof r->how};
    snow_look_init(&r->look);
    r->look.preset = "linear";
    r->look.colormap = "viridis";
    r->look.opacities = ball_alone;
    r->look.opacity_count = sizeof ball_alone / sizeof *ball_alone;
    snow_settings_init(&r->settings);
    r->settings.threads = 1;
    for (int n = 0; n < PICTURES; n++) {
        snow_view_init(&r->views[n]);
        set_view(place, "+z", &r->views[n]);
        r->views[n].azimuth = 65.0 * n;
        r->views[n].elevation = 25.0 * (n & 1);
    }
}

static int64_t product(const int64_t n[3]) {
    return n[0] * n[1] * n[2];
}

/* A part holds what it must by its box, the ring of the opening and the layers
 * of its view, and nothing else. */
static snow_status check_part(snow_comm *comm, request *r,
                              const snow_view *view,
                              const snow_transfer *transfer,
                              const snow_volume *volume) {
    const int rank = snow_comm_rank(comm);
    int64_t layers[3], *ring = r->rings[rank];
    snow_volume_info whole;
    snow_extent part;
    snow_extent_init(&part);
    snow_volume_whole(volume, &whole);
    r->stored[rank] = product(volume->info.dims);
    r->cuts[rank]++;
    if (!r->trims)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_volume_get_extent(volume, &part));
    SNOW_TRY(snow_ghosts_needed(
        snow_comm_context(comm), &whole, view, &r->settings,
        snow_transfer_slopes(transfer, &whole), r->how.turns, layers));
    for (int i = 0; i < 3 && r->cuts[rank] == 1; i++)
        ring[i] = 2 * layers[i];
    const snow_box wanted = support_ball_stored(volume, layers);
    REQUIRE(comm, volume->left_out.any);
    REQUIRE(comm, !memcmp(volume->left_out.ring, ring, 3 * sizeof *ring));
    REQUIRE(comm, !memcmp(part.stored, wanted.first, sizeof wanted.first));
    REQUIRE(comm,
            !memcmp(volume->info.dims, wanted.count, sizeof wanted.count));
    return SNOW_STATUS_OK;
}

static snow_status draw_all(snow_comm *comm, request *r,
                            const snow_transfer *transfer, snow_frame *frame,
                            snow_volume **volume) {
    for (int n = 0; n < r->pictures; n++) {
        snow_image *image = NULL;
        const uint64_t before = (*volume)->generation;
        SNOW_TRY(snow_ranks_repartition(comm, transfer, &r->views[n],
                                        &r->settings, &r->how, volume));
        if ((*volume)->generation != before)
            SNOW_TRY(check_part(comm, r, &r->views[n], transfer, *volume));
        SNOW_TRY(snow_ranks_render(frame, comm, *volume, transfer, &r->views[n],
                                   &r->settings, &r->how, &image));
        if (image)
            memcpy(r->made + (size_t)n * SIDE * SIDE * 4,
                   snow_image_pixels(image), sizeof(float) * SIDE * SIDE * 4);
        snow_image_free(image);
    }
    const int rank = snow_comm_rank(comm);
    r->voxels[rank] = snow_frame_stats(frame)->voxels;
    r->interesting[rank] = snow_frame_stats(frame)->interesting;
    return SNOW_STATUS_OK;
}

static snow_status open_parts(snow_comm *comm, request *r, snow_volume **volume,
                              snow_transfer **transfer) {
    const int rank = snow_comm_rank(comm);
    snow_extent part;
    snow_extent_init(&part);
    SNOW_TRY(snow_ranks_open(comm, r->path, NULL, &r->look, &r->views[0],
                             &r->settings, &r->how, volume, transfer));
    SNOW_TRY(snow_volume_get_extent(*volume, &part));
    r->owned[rank] = product(part.count);
    return check_part(comm, r, &r->views[0], *transfer, *volume);
}

static snow_status draw(snow_comm *comm, void *user) {
    request *r = user;
    snow_volume *volume;
    snow_transfer *transfer;
    snow_frame *frame;
    SNOW_TRY(open_parts(comm, r, &volume, &transfer));
    snow_status status = snow_frame_new(snow_comm_context(comm), &frame);
    if (status == SNOW_STATUS_OK) {
        status = draw_all(comm, r, transfer, frame, &volume);
        snow_frame_free(frame);
    }
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    return status;
}

static void draw_by(support_files *place, request *r, int ranks) {
    r->made = calloc(floats_of(r), sizeof(float));
    assert_non_null(r->made);
    if (snow_comm_run_threads(place->context, ranks, draw, r) != SNOW_STATUS_OK)
        fail_msg("%d ranks: %s", ranks, snow_context_message(place->context));
}

static int64_t sum_of(const int64_t *of, int ranks) {
    int64_t sum = 0;
    for (int n = 0; n < ranks; n++)
        sum += of[n];
    return sum;
}

/* Draws with all voxels, and with those of the look. */
typedef struct comparison {
    request all, one;
} comparison;

static comparison compare(support_files *place, const request *asked,
                          int ranks) {
    comparison c = {*asked, *asked};
    c.one.how.one_look = c.one.trims = true;
    draw_by(place, &c.all, ranks);
    draw_by(place, &c.one, ranks);
    double sum = 0;
    for (size_t n = 0; n < floats_of(asked); n++)
        sum += (double)c.all.made[n];
    assert_true(sum > 10); /* something is seen */
    assert_memory_equal(c.all.made, c.one.made,
                        floats_of(asked) * sizeof(float));
    assert_int_equal(sum_of(c.all.owned, ranks), product(support_ball_dims));
    assert_true(2 * sum_of(c.one.stored, ranks) < sum_of(c.all.stored, ranks));
    assert_int_equal(sum_of(c.one.voxels, ranks), sum_of(c.all.voxels, ranks));
    assert_int_equal(sum_of(c.one.interesting, ranks),
                     sum_of(c.all.interesting, ranks));
    free(c.all.made);
    free(c.one.made);
    return c;
}

/* Each number of ranks meets each cut, and each type. */
static void pictures_need_no_air(void **state) {
    support_files *place = *state;
    static const snow_type types[] = {SNOW_TYPE_UINT8, SNOW_TYPE_INT16,
                                      SNOW_TYPE_FLOAT32};
    static const char *const views[] = {"+z", "-x", "+y"};
    static const snow_partition cuts[] = {
        SNOW_PARTITION_AUTO, SNOW_PARTITION_COUNTED, SNOW_PARTITION_BRICKS};
    static const int ranks[] = {2, 3, 5, 8};
    for (int n = 0; n < 24; n++) {
        request r;
        begin_request(place, support_ball_put(place, types[n % 3]), &r);
        set_view(place, views[n / 3 % 3], &r.views[0]);
        r.views[0].azimuth = n / 9 % 2 * 20.0;
        r.how.cut = cuts[(n / 4 + n) % 3];
        r.settings.quality = (snow_quality)(n / 2 % 3);
        r.settings.kernel =
            n % 5 == 4 ? SNOW_KERNEL_BSPLINE : r.settings.kernel;
        (void)compare(place, &r, ranks[n % 4]);
    }
}

static void so_does_a_turntable(void **state) {
    support_files *place = *state;
    static const snow_partition cuts[] = {
        SNOW_PARTITION_AUTO, SNOW_PARTITION_COUNTED, SNOW_PARTITION_BRICKS};
    for (int n = 0; n < 6; n++) {
        request r;
        begin_request(place, support_ball_put(place, SNOW_TYPE_UINT8), &r);
        r.pictures = PICTURES;
        r.how.cut = cuts[n % 3];
        r.how.turns = n > 2;
        const comparison c = compare(place, &r, 4);
        /* Auto cuts bricks or slabs that serve all sides, with ghosts. */
        assert_true(c.one.cuts[0] == (r.how.turns && n != 4 ? 1 : 3));
    }
}

static void a_look_that_shows_air_keeps_it(void **state) {
    support_files *place = *state;
    request r;
    begin_request(place, support_ball_put(place, SNOW_TYPE_UINT8), &r);
    r.look.opacities = all_seen;
    r.look.opacity_count = sizeof all_seen / sizeof *all_seen;
    r.how.one_look = true;
    draw_by(place, &r, 4);
    assert_int_equal(sum_of(r.owned, 4), product(support_ball_dims));
    free(r.made);
}

static snow_status try_others(snow_comm *comm, const request *r,
                              const snow_transfer *transfer, snow_frame *frame,
                              const snow_volume *volume) {
    snow_image *image = NULL;
    snow_context *context = snow_comm_context(comm);
    snow_transfer *other = NULL;
    snow_settings settings = r->settings;
    snow_look look = r->look;
    REQUIRE(comm, snow_ranks_new_transfer(comm, volume, &look, &other) ==
                      SNOW_STATUS_BAD_USAGE);
    SNOW_TRY(snow_transfer_new(context, transfer->colors, transfer->color_count,
                               all_seen, 2, &other));
    snow_status status = snow_ranks_render(
        frame, comm, volume, other, &r->views[0], &settings, &r->how, &image);
    snow_transfer_free(other);
    REQUIRE(comm, status == SNOW_STATUS_BAD_USAGE);
    REQUIRE(comm, strstr(snow_context_message(context), "without one_look"));
    settings.mode = SNOW_MODE_MIP;
    REQUIRE(comm, snow_ranks_render(frame, comm, volume, transfer, &r->views[0],
                                    &settings, &r->how,
                                    &image) == SNOW_STATUS_BAD_USAGE);
    settings.mode = SNOW_MODE_OVER;
    settings.depth = true;
    REQUIRE(comm, snow_ranks_render(frame, comm, volume, transfer, &r->views[0],
                                    &settings, &r->how,
                                    &image) == SNOW_STATUS_BAD_USAGE);
    settings.depth = false;
    snow_view near = r->views[0];
    near.fov = 20;
    REQUIRE(comm,
            snow_ranks_render(frame, comm, volume, transfer, &near, &settings,
                              &r->how, &image) == SNOW_STATUS_BAD_USAGE);
    REQUIRE(comm, strstr(snow_context_message(context), "without one_look"));
    static const double plane[4] = {1, 0, 0, 30};
    snow_volume *cut = NULL;
    REQUIRE(comm,
            snow_volume_clip(volume, plane, 1, &cut) == SNOW_STATUS_BAD_USAGE);
    REQUIRE(comm, snow_volume_mask(volume, volume, NULL, 0, &cut) ==
                      SNOW_STATUS_BAD_USAGE);
    SNOW_TRY(snow_ranks_render(frame, comm, volume, transfer, &r->views[0],
                               &settings, &r->how, &image));
    snow_image_free(image);
    return SNOW_STATUS_OK;
}

static snow_status draw_others(snow_comm *comm, void *user) {
    request *r = user;
    snow_volume *volume;
    snow_transfer *transfer;
    snow_frame *frame;
    SNOW_TRY(open_parts(comm, r, &volume, &transfer));
    snow_status status = snow_frame_new(snow_comm_context(comm), &frame);
    if (status == SNOW_STATUS_OK)
        status = try_others(comm, r, transfer, frame, volume);
    snow_frame_free(frame);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    return status;
}

static void what_needs_the_air_is_refused(void **state) {
    support_files *place = *state;
    request r;
    begin_request(place, support_ball_put(place, SNOW_TYPE_UINT8), &r);
    r.how.one_look = true;
    if (snow_comm_run_threads(place->context, 3, draw_others, &r) !=
        SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(place->context));
    assert_true(sum_of(r.owned, 3) < product(support_ball_dims));
}

/* Needs of the opening: 2, 2 and 1 layers of a ring of 4, 4 and 2; then of
 * views along x, of a wider kernel, and of gradients with it, which reach too
 * far. */
static snow_status need_more(snow_comm *comm, request *r,
                             const snow_transfer *transfer,
                             snow_volume **volume) {
    snow_settings *settings = &r->settings;
    snow_ranks_options *how = &r->how;
    const uint64_t before = (*volume)->generation;
    SNOW_TRY(snow_ranks_repartition(comm, transfer, &r->views[1], settings, how,
                                    volume));
    REQUIRE(comm, (*volume)->generation != before);
    SNOW_TRY(check_part(comm, r, &r->views[1], transfer, *volume));
    settings->kernel = SNOW_KERNEL_BSPLINE;
    SNOW_TRY(snow_ranks_repartition(comm, transfer, &r->views[0], settings, how,
                                    volume));
    SNOW_TRY(check_part(comm, r, &r->views[0], transfer, *volume));
    const uint64_t last = (*volume)->generation;
    settings->shade = SNOW_SHADE_PHONG;
    REQUIRE(comm, snow_ranks_repartition(comm, transfer, &r->views[0], settings,
                                         how, volume) == SNOW_STATUS_BAD_USAGE);
    REQUIRE(comm,
            strstr(snow_context_message(snow_comm_context(comm)),
                   "needs 3 voxels around what the look shows, but only 2"));
    REQUIRE(comm, (*volume)->generation == last);
    return SNOW_STATUS_OK;
}

static snow_status open_and_need_more(snow_comm *comm, void *user) {
    request r = *(const request *)user; /* of this rank */
    snow_volume *volume;
    snow_transfer *transfer;
    SNOW_TRY(open_parts(comm, &r, &volume, &transfer));
    const snow_status status = need_more(comm, &r, transfer, &volume);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    return status;
}

static void more_than_the_first_ring_is_refused(void **state) {
    support_files *place = *state;
    for (int ranks = 2; ranks < 6; ranks++) {
        request r;
        begin_request(place, support_ball_put(place, SNOW_TYPE_UINT8), &r);
        set_view(place, "-x", &r.views[1]);
        r.settings.shade = SNOW_SHADE_NONE;
        r.how.one_look = r.trims = true;
        if (snow_comm_run_threads(place->context, ranks, open_and_need_more,
                                  &r) != SNOW_STATUS_OK)
            fail_msg("%s", snow_context_message(place->context));
    }
}

/* --- stops, and parts that do not belong together --------------------------
 */

static bool stop_at_once(void *user) {
    (void)user;
    return true;
}

/* Opens parts, and then each rank's box of all. */
static snow_status open_whole_parts(snow_comm *comm, request *r,
                                    snow_volume **volume,
                                    snow_transfer **transfer,
                                    snow_box boxes[MOST_RANKS]) {
    SNOW_TRY(open_parts(comm, r, volume, transfer));
    const snow_box box = snow_part_box(*volume);
    return snow_comm_allgather(comm, &box, sizeof box, boxes);
}

/* Each rank in turn is asked to stop, none at last. */
static snow_status stop_trimming(snow_comm *comm, void *user) {
    request *r = user;
    const int rank = snow_comm_rank(comm), ranks = snow_comm_size(comm);
    snow_volume *volume;
    snow_transfer *transfer;
    snow_box boxes[MOST_RANKS], own;
    snow_partition_params order;
    SNOW_TRY(open_whole_parts(comm, r, &volume, &transfer, boxes));
    snow_volume_info whole;
    snow_volume_whole(volume, &whole);
    snow_status status = snow_partition_params_make(
        snow_comm_context(comm), &whole, &r->views[0], &r->settings, &r->how, 0,
        ranks, &order);
    for (int n = 0; n <= ranks && status == SNOW_STATUS_OK; n++) {
        snow_left_out left = volume->left_out;
        order.stop = rank == n ? stop_at_once : NULL;
        const snow_status found =
            snow_ranks_trim(comm, &order, boxes, volume, transfer, &own, &left);
        if (found != (n < ranks ? SNOW_STATUS_STOPPED : SNOW_STATUS_OK))
            status = snow_fail(snow_comm_context(comm), SNOW_STATUS_BAD_INPUT,
                               "stop of rank %d: status %d", n, found);
        if (n == ranks)
            r->stored[rank] = snow_box_voxels(&own);
    }
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    return status;
}

/* However many threads look for the bounds, they find the same ones. */
static void a_stop_of_any_rank_ends_trimming(void **state) {
    support_files *place = *state;
    int64_t stored = 0;
    for (int n = 0; n < 12; n++) {
        request r;
        begin_request(place, support_ball_put(place, SNOW_TYPE_FLOAT32), &r);
        r.settings.threads = 1 + n % 4;
        if (snow_comm_run_threads(place->context, 3, stop_trimming, &r) !=
            SNOW_STATUS_OK)
            fail_msg("%s", snow_context_message(place->context));
        stored = n ? stored : sum_of(r.stored, 3);
        assert_int_equal(sum_of(r.stored, 3), stored);
    }
    assert_true(stored < product(support_ball_dims) / 2);
}

/* Rank 1 answers for a slice less than it was given. */
static snow_status lose_a_slice(snow_comm *comm, void *user) {
    request *r = user;
    snow_volume *volume;
    snow_transfer *transfer;
    SNOW_TRY(open_parts(comm, r, &volume, &transfer));
    volume->left_out.box.count[2] -= snow_comm_rank(comm) == 1;
    const snow_status status = snow_ranks_repartition(
        comm, transfer, &r->views[1], &r->settings, &r->how, &volume);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    REQUIRE(comm, status == SNOW_STATUS_BAD_USAGE);
    REQUIRE(comm, strstr(snow_context_message(snow_comm_context(comm)),
                         "every voxel must belong to exactly one rank"));
    return SNOW_STATUS_OK;
}

static void a_voxel_without_a_rank_is_noticed(void **state) {
    support_files *place = *state;
    request r;
    begin_request(place, support_ball_put(place, SNOW_TYPE_UINT8), &r);
    set_view(place, "-x", &r.views[1]);
    r.how.one_look = r.trims = true;
    if (snow_comm_run_threads(place->context, 3, lose_a_slice, &r) !=
        SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(place->context));
}

static void hidden_values_are_some_way_from_seen_ones(void **state) {
    support_files *place = *state;
    static const snow_color_point grey = {1, 1, 1, 1};
    static const snow_opacity_point points[] = {{10, 0},    {20, 0}, {30, 0.5},
                                                {40, 0.01}, {60, 0}, {70, 0.9}};
    const snow_volume_info info = {.size = sizeof info,
                                   .type = SNOW_TYPE_UINT8};
    snow_hidden_range found[SNOW_HIDDEN_MOST];
    snow_transfer *t;
    assert_int_equal(snow_transfer_new(place->context, &grey, 1, points, 6, &t),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_hidden_ranges(t, &info, 0, 2, found), 1);
    assert_true(found[0].low == -(double)INFINITY && found[0].high == 18);
    assert_int_equal(snow_hidden_ranges(t, &info, 3, 2, found), 2);
    assert_true(found[1].low == 42 && found[1].high == 58);
    assert_true(snow_is_hidden(t, &info, 3, 2, 42, 58));
    assert_false(snow_is_hidden(t, &info, 3, 2, 17, 43));
    assert_false(snow_is_hidden(t, &info, 0, 2, 42, 58));
    assert_int_equal(snow_transfer_set_log(t), SNOW_STATUS_OK);
    assert_int_equal(snow_hidden_ranges(t, &info, 0, 2, found), 0);
    snow_transfer_free(t);
}

#define TEST(name)                                             \
    cmocka_unit_test_setup_teardown(name, support_files_setup, \
                                    support_files_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(pictures_need_no_air),
        TEST(so_does_a_turntable),
        TEST(a_look_that_shows_air_keeps_it),
        TEST(what_needs_the_air_is_refused),
        TEST(more_than_the_first_ring_is_refused),
        TEST(a_stop_of_any_rank_ends_trimming),
        TEST(a_voxel_without_a_rank_is_noticed),
        TEST(hidden_values_are_some_way_from_seen_ones),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
