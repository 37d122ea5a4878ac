/* tests/parallel/test_trim.c - parts that lack what the look of their opening
 * shows nothing of: pictures have the same bits, and other looks are refused.
 */
#include "support/files.h"
#include "support/opened.h"

#include "classify/hidden.h"
#include "decompose/partition.h"
#include "parallel/part.h"
#include "parallel/trim.h"
#include "transfer/transfer.h"
#include "volume/volume.h"

#include <math.h>

/* --- a ball in air with noise ----------------------------------------------
 */

/* Air is 20 to 40, the ball 90 to 230. */
static const int64_t ball_dims[3] = {72, 60, 80};
static const double middle[3] = {28, 33, 51};
#define RADIUS 13

/* How deep in the ball a voxel lies; below 0: in the air. */
static double depth_of(const int64_t at[3]) {
    double square = 0;
    for (int i = 0; i < 3; i++)
        square += ((double)at[i] - middle[i]) * ((double)at[i] - middle[i]);
    return RADIUS - sqrt(square);
}

static double value_of(const int64_t at[3], uint64_t *seed, bool hole) {
    const double depth = depth_of(at);
    const double noise = support_uniform(seed);
    if (depth < 0)
        return floor(20 + 20 * noise);
    return hole && depth > RADIUS - 2 ? (double)NAN
                                      : floor(90 + 9 * depth + 20 * noise);
}

static void write_voxels(char *to, snow_type type) {
    const int64_t *dims = ball_dims;
    const size_t size = snow_type_size(type);
    uint64_t seed = 5;
    int64_t at[3];
    for (at[2] = 0; at[2] < dims[2]; at[2]++)
        for (at[1] = 0; at[1] < dims[1]; at[1]++)
            for (at[0] = 0; at[0] < dims[0]; at[0]++, to += size) {
                const double value =
                    value_of(at, &seed, type == SNOW_TYPE_FLOAT32);
                const uint8_t byte = isnan(value) ? 0 : (uint8_t)value;
                const int16_t word = (int16_t)(-10 * byte);
                const float real = (float)(value / 7);
                memcpy(to,
                       type == SNOW_TYPE_UINT8   ? (const void *)&byte
                       : type == SNOW_TYPE_INT16 ? (const void *)&word
                                                 : (const void *)&real,
                       size);
            }
}

/* Writes it into a file of bytes, of words with a negative slope, or of floats
 * with a shell of NaN in the ball; the path lasts as support_path's. */
static const char *put_ball(support_files *place, snow_type type) {
    const int64_t *dims = ball_dims;
    char *voxels =
        malloc((size_t)(dims[0] * dims[1] * dims[2]) * snow_type_size(type));
    assert_non_null(voxels);
    write_voxels(voxels, type);
    snow_volume_info info;
    snow_volume_info_init(&info);
    memcpy(info.dims, dims, sizeof info.dims);
    info.type = type;
    info.slope = type == SNOW_TYPE_INT16     ? -0.1
                 : type == SNOW_TYPE_FLOAT32 ? 7
                                             : 1;
    snow_volume *volume;
    assert_int_equal(snow_volume_wrap(place->context, &info, voxels, &volume),
                     SNOW_STATUS_OK);
    const char *path = support_path(place, "ball.nii");
    assert_int_equal(snow_volume_save(volume, path, true), SNOW_STATUS_OK);
    snow_volume_close(volume);
    free(voxels);
    return path;
}

/* --- pictures by ranks ------------------------------------------------------
 */

#define MOST_RANKS 8
#define SIDE 40
#define PICTURES 4

static const snow_opacity_point ball_alone[] = {
    {70, 0}, {100, 0.1}, {160, 0.7}, {230, 0.9}};
static const snow_opacity_point all_seen[] = {{0, 0.01}, {255, 0.9}};

/* What ranks are asked to draw, and what comes of it. */
typedef struct request {
    opened_request open;
    snow_view views[PICTURES]; /* the first is that of opening */
    int pictures;
    float *made;          /* all pictures */
    int cuts[MOST_RANKS]; /* that gave a rank another part */
    int64_t stored[MOST_RANKS], owned[MOST_RANKS];
    int64_t voxels[MOST_RANKS], interesting[MOST_RANKS];
} request;

static size_t floats_of(const request *r) {
    return (size_t)r->pictures * SIDE * SIDE * 4;
}

static void set_view(support_files *place, const char *name, snow_view *view) {
    assert_int_equal(snow_view_from_name(place->context, name, view),
                     SNOW_STATUS_OK);
    view->width = view->height = SIDE;
}

static request request_of(support_files *place, snow_type type) {
    request r = {.pictures = 1};
    r.open.path = put_ball(place, type);
    r.open.how.size = sizeof r.open.how;
    snow_volume_options_init(&r.open.options);
    snow_look_init(&r.open.look);
    r.open.look.preset = "linear";
    r.open.look.colormap = "viridis";
    r.open.look.opacities = ball_alone;
    r.open.look.opacity_count = sizeof ball_alone / sizeof *ball_alone;
    snow_settings_init(&r.open.settings);
    r.open.settings.threads = 1;
    for (int n = 0; n < PICTURES; n++) {
        snow_view_init(&r.views[n]);
        set_view(place, "+z", &r.views[n]);
        r.views[n].azimuth = 65.0 * n;
        r.views[n].elevation = 25.0 * (n & 1);
    }
    r.open.view = r.views[0];
    return r;
}

static int64_t product(const int64_t n[3]) {
    return n[0] * n[1] * n[2];
}

static snow_status open_parts(snow_comm *comm, request *r, opened *o) {
    const int rank = snow_comm_rank(comm);
    snow_extent part;
    snow_extent_init(&part);
    SNOW_TRY(opened_enter(comm, &r->open, o));
    r->owned[rank] = snow_volume_get_extent(o->volume, &part) == SNOW_STATUS_OK
                         ? product(part.count)
                         : 0;
    r->stored[rank] = product(o->volume->info.dims);
    r->cuts[rank] = 1;
    return SNOW_STATUS_OK;
}

static snow_status draw_all(request *r, opened *o) {
    const int rank = snow_comm_rank(o->comm);
    for (int n = 0; n < r->pictures; n++) {
        snow_image *image = NULL;
        const uint64_t before = o->volume->generation;
        SNOW_TRY(opened_cut(o, &r->views[n]));
        r->cuts[rank] += o->volume->generation != before;
        SNOW_TRY(opened_draw(o, &r->views[n], &image));
        if (image)
            memcpy(r->made + (size_t)n * SIDE * SIDE * 4,
                   snow_image_pixels(image), sizeof(float) * SIDE * SIDE * 4);
        snow_image_free(image);
    }
    r->voxels[rank] = snow_frame_stats(o->frame)->voxels;
    r->interesting[rank] = snow_frame_stats(o->frame)->interesting;
    return SNOW_STATUS_OK;
}

/* Opens parts, does something with them, and closes them. */
typedef snow_status with_parts_fn(request *r, opened *o);

static snow_status with_parts(snow_comm *comm, request *r, with_parts_fn *act) {
    opened o;
    SNOW_TRY(open_parts(comm, r, &o));
    const snow_status status = act(r, &o);
    opened_leave(&o);
    return status;
}

static snow_status draw(snow_comm *comm, void *user) {
    return with_parts(comm, user, draw_all);
}

static void run(support_files *place, int ranks, snow_comm_body_fn *body,
                request *r) {
    if (snow_comm_run_threads(place->context, ranks, body, r) != SNOW_STATUS_OK)
        fail_msg("%d ranks: %s", ranks, snow_context_message(place->context));
}

static void draw_by(support_files *place, request *r, int ranks) {
    r->made = calloc(floats_of(r), sizeof(float));
    assert_non_null(r->made);
    run(place, ranks, draw, r);
}

static int64_t sum_of(const int64_t *of, int ranks) {
    int64_t sum = 0;
    for (int n = 0; n < ranks; n++)
        sum += of[n];
    return sum;
}

/* Draws with all voxels, and with those of the look; returns how often the
 * first rank got a part. */
static int compare(support_files *place, const request *asked, int ranks) {
    request all = *asked, one = *asked;
    one.open.how.one_look = true;
    draw_by(place, &all, ranks);
    draw_by(place, &one, ranks);
    double sum = 0;
    for (size_t n = 0; n < floats_of(asked); n++)
        sum += (double)all.made[n];
    assert_true(sum > 10); /* something is seen */
    assert_memory_equal(all.made, one.made, floats_of(asked) * sizeof(float));
    assert_int_equal(sum_of(all.owned, ranks), product(ball_dims));
    /* The ball with what kernels and gradients need around it, and turns. */
    const bool wide = asked->open.settings.kernel == SNOW_KERNEL_BSPLINE ||
                      asked->open.how.turns;
    assert_true((double)sum_of(one.stored, ranks) <
                (wide ? 0.45 : 0.28) * (double)sum_of(all.stored, ranks));
    assert_int_equal(sum_of(one.voxels, ranks), sum_of(all.voxels, ranks));
    assert_int_equal(sum_of(one.interesting, ranks),
                     sum_of(all.interesting, ranks));
    free(all.made);
    free(one.made);
    return one.cuts[0];
}

static const snow_partition cuts[] = {
    SNOW_PARTITION_AUTO, SNOW_PARTITION_COUNTED, SNOW_PARTITION_BRICKS};

/* Each number of ranks meets each cut, and each type. */
static void pictures_need_no_air(void **state) {
    support_files *place = *state;
    static const snow_type types[] = {SNOW_TYPE_UINT8, SNOW_TYPE_INT16,
                                      SNOW_TYPE_FLOAT32};
    static const char *const views[] = {"+z", "-x", "+y"};
    static const int ranks[] = {2, 3, 5, 8};
    for (int n = 0; n < 24; n++) {
        if (!support_takes((size_t)n, 5))
            continue;
        request r = request_of(place, types[n % 3]);
        set_view(place, views[n / 3 % 3], &r.views[0]);
        r.views[0].azimuth = n / 9 % 2 * 20.0;
        r.open.view = r.views[0];
        r.open.how.cut = cuts[(n / 4 + n) % 3];
        r.open.settings.quality = (snow_quality)(n / 2 % 3);
        if (n % 7 == 4)
            r.open.settings.kernel = SNOW_KERNEL_BSPLINE;
        (void)compare(place, &r, ranks[n % 4]);
    }
}

static void so_does_a_turntable(void **state) {
    support_files *place = *state;
    for (int n = 0; n < 6; n++) {
        request r = request_of(place, SNOW_TYPE_UINT8);
        r.pictures = PICTURES;
        r.open.how.cut = cuts[n % 3];
        r.open.how.turns = n > 2;
        /* Auto cuts bricks or slabs that serve all sides, with ghosts. */
        assert_int_equal(compare(place, &r, 4),
                         r.open.how.turns && n != 4 ? 1 : 3);
    }
}

static void a_look_that_shows_air_keeps_it(void **state) {
    support_files *place = *state;
    request r = request_of(place, SNOW_TYPE_UINT8);
    r.open.look.opacities = all_seen;
    r.open.look.opacity_count = sizeof all_seen / sizeof *all_seen;
    r.open.how.one_look = true;
    draw_by(place, &r, 4);
    assert_int_equal(sum_of(r.owned, 4), product(ball_dims));
    free(r.made);
}

/* --- what is refused --------------------------------------------------------
 */

/* Settings or a view that the look's voxels do not suffice for. */
static snow_status try_pictures(request *r, opened *o) {
    snow_comm *comm = o->comm;
    for (int n = 0; n < 4; n++) {
        snow_image *image = NULL;
        snow_settings settings = r->open.settings;
        snow_view view = r->views[0];
        settings.mode = n == 0 ? SNOW_MODE_MIP : SNOW_MODE_OVER;
        settings.depth = n == 1;
        view.fov = n == 2 ? 20 : 0;
        const snow_status status =
            snow_ranks_render(o->frame, comm, o->volume, o->transfer, &view,
                              &settings, &r->open.how, &image);
        snow_image_free(image);
        CHECK(status == (n < 3 ? SNOW_STATUS_BAD_USAGE : SNOW_STATUS_OK));
        CHECK(n != 2 || strstr(snow_context_message(snow_comm_context(comm)),
                               "without one_look"));
    }
    return SNOW_STATUS_OK;
}

static snow_status try_others(request *r, opened *o) {
    snow_comm *comm = o->comm;
    snow_context *context = snow_comm_context(comm);
    snow_transfer *usual = o->transfer, *other = NULL;
    snow_image *image = NULL;
    CHECK(snow_ranks_new_transfer(comm, o->volume, &r->open.look, &other) ==
          SNOW_STATUS_BAD_USAGE);
    SNOW_TRY(snow_transfer_new(context, usual->colors, usual->color_count,
                               all_seen, 2, &other));
    o->transfer = other;
    snow_status status = opened_draw(o, &r->views[0], &image);
    o->transfer = usual;
    snow_transfer_free(other);
    CHECK(status == SNOW_STATUS_BAD_USAGE);
    CHECK(strstr(snow_context_message(context), "without one_look"));
    static const double plane[4] = {1, 0, 0, 30};
    snow_volume *cut = NULL;
    CHECK(snow_volume_clip(o->volume, plane, 1, &cut) == SNOW_STATUS_BAD_USAGE);
    CHECK(snow_volume_mask(o->volume, o->volume, NULL, 0, &cut) ==
          SNOW_STATUS_BAD_USAGE);
    return try_pictures(r, o);
}

static snow_status draw_others(snow_comm *comm, void *user) {
    return with_parts(comm, user, try_others);
}

static void what_needs_the_air_is_refused(void **state) {
    support_files *place = *state;
    request r = request_of(place, SNOW_TYPE_UINT8);
    r.open.how.one_look = true;
    run(place, 3, draw_others, &r);
    assert_true(sum_of(r.owned, 3) < product(ball_dims));
}

/* Views along x need more, and a wider kernel does; gradients with it reach too
 * far. */
static snow_status need_more(request *r, opened *o) {
    snow_comm *comm = o->comm;
    const uint64_t before = o->volume->generation;
    SNOW_TRY(opened_cut(o, &r->views[1]));
    CHECK(o->volume->generation != before);
    r->open.settings.kernel = SNOW_KERNEL_BSPLINE;
    SNOW_TRY(opened_cut(o, &r->views[0]));
    const uint64_t last = o->volume->generation;
    r->open.settings.shade = SNOW_SHADE_PHONG;
    CHECK(opened_cut(o, &r->views[0]) == SNOW_STATUS_BAD_USAGE);
    CHECK(strstr(snow_context_message(snow_comm_context(comm)),
                 "needs 3 voxels around what the look shows, but only 2"));
    CHECK(o->volume->generation == last);
    return SNOW_STATUS_OK;
}

static snow_status open_and_need_more(snow_comm *comm, void *user) {
    request r = *(const request *)user; /* of this rank */
    return with_parts(comm, &r, need_more);
}

static void more_than_the_first_ring_is_refused(void **state) {
    support_files *place = *state;
    for (int ranks = 2; ranks < 6; ranks++) {
        request r = request_of(place, SNOW_TYPE_UINT8);
        set_view(place, "-x", &r.views[1]);
        r.open.settings.shade = SNOW_SHADE_NONE;
        r.open.how.one_look = true;
        run(place, ranks, open_and_need_more, &r);
    }
}

/* --- stops, and parts that do not belong together --------------------------
 */

static bool stop_at_once(void *user) {
    (void)user;
    return true;
}

/* Each rank in turn is asked to stop, none at last. */
static snow_status stop_trimming(request *r, opened *o) {
    snow_comm *comm = o->comm;
    const int rank = snow_comm_rank(comm), ranks = snow_comm_size(comm);
    snow_box boxes[MOST_RANKS], own;
    snow_partition_params order;
    snow_volume_info whole;
    const snow_box box = snow_part_box(o->volume);
    SNOW_TRY(snow_comm_allgather(comm, &box, sizeof box, boxes));
    snow_volume_whole(o->volume, &whole);
    SNOW_TRY(snow_partition_params_make(snow_comm_context(comm), &whole,
                                        &r->views[0], &r->open.settings,
                                        &r->open.how, 0, ranks, &order));
    for (int n = 0; n <= ranks; n++) {
        snow_left_out left = o->volume->left_out;
        order.stop = rank == n ? stop_at_once : NULL;
        CHECK(snow_ranks_trim(comm, &order, boxes, o->volume, o->transfer, &own,
                              &left) ==
              (n < ranks ? SNOW_STATUS_STOPPED : SNOW_STATUS_OK));
    }
    r->stored[rank] = snow_box_voxels(&own);
    return SNOW_STATUS_OK;
}

static snow_status open_and_stop(snow_comm *comm, void *user) {
    return with_parts(comm, user, stop_trimming);
}

/* However many threads look for the bounds, they find the same ones. */
static void a_stop_of_any_rank_ends_trimming(void **state) {
    support_files *place = *state;
    int64_t stored = 0;
    for (int n = 0; n < 8; n++) {
        request r = request_of(place, SNOW_TYPE_FLOAT32);
        r.open.settings.threads = 1 + n % 4;
        run(place, 3, open_and_stop, &r);
        stored = n ? stored : sum_of(r.stored, 3);
        assert_int_equal(sum_of(r.stored, 3), stored);
    }
    assert_true(stored < product(ball_dims) / 2);
}

/* Rank 1 answers for a slice less than it was given. */
static snow_status lose_a_slice(request *r, opened *o) {
    snow_comm *comm = o->comm;
    o->volume->left_out.box.count[2] -= snow_comm_rank(comm) == 1;
    CHECK(opened_cut(o, &r->views[1]) == SNOW_STATUS_BAD_USAGE);
    CHECK(strstr(snow_context_message(snow_comm_context(comm)),
                 "every voxel must belong to exactly one rank"));
    return SNOW_STATUS_OK;
}

static snow_status open_and_lose(snow_comm *comm, void *user) {
    return with_parts(comm, user, lose_a_slice);
}

static void a_voxel_without_a_rank_is_noticed(void **state) {
    support_files *place = *state;
    request r = request_of(place, SNOW_TYPE_UINT8);
    set_view(place, "-x", &r.views[1]);
    r.open.how.one_look = true;
    run(place, 3, open_and_lose, &r);
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
