/* tests/parallel/test_trim.c - parts that lack what the look of their opening
 * shows nothing of: pictures have the same bits, and other looks are refused.
 */
#include "support/volumes.h"

#include "classify/hidden.h"
#include "transfer/transfer.h"
#include "volume/volume.h"

#include <math.h>
#include <snowglass/ranks.h>

#define MOST_RANKS 8
#define SIDE 40
#define PICTURES 4

/* A ball in air with noise. */
static const int64_t dims[3] = {72, 60, 80};
static const double middle[3] = {28, 33, 51};
#define RADIUS 13

/* Air is 20 to 40, the ball 90 to 230; of a hole in it nothing is known. */
static double value_of(const int64_t at[3], uint64_t *seed, bool hole) {
    double square = 0;
    for (int i = 0; i < 3; i++)
        square += ((double)at[i] - middle[i]) * ((double)at[i] - middle[i]);
    const double depth = RADIUS - sqrt(square);
    const double noise = support_uniform(seed);
    if (depth < 0)
        return floor(20 + 20 * noise);
    return hole && depth > RADIUS - 2 ? (double)NAN
                                      : floor(90 + 9 * depth + 20 * noise);
}

static const char *put_ball(support_place *place, snow_type type) {
    const size_t size = snow_type_size(type);
    char *voxels = malloc((size_t)(dims[0] * dims[1] * dims[2]) * size);
    assert_non_null(voxels);
    uint64_t seed = 5;
    char *to = voxels;
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
    snow_volume_info info;
    snow_volume_info_init(&info);
    memcpy(info.dims, dims, sizeof dims);
    info.type = type;
    info.slope = type == SNOW_TYPE_INT16     ? -0.1
                 : type == SNOW_TYPE_FLOAT32 ? 7
                                             : 1;
    snow_volume *volume;
    assert_int_equal(snow_volume_wrap(place->context, &info, voxels, &volume),
                     SNOW_STATUS_OK);
    const char *path = support_place_path(place, "ball.nii");
    assert_int_equal(snow_volume_save(volume, path, true), SNOW_STATUS_OK);
    snow_volume_close(volume);
    free(voxels);
    return path;
}

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
    int64_t stored[MOST_RANKS], owned[MOST_RANKS];
    int64_t voxels[MOST_RANKS], interesting[MOST_RANKS];
} request;

static size_t floats_of(const request *r) {
    return (size_t)r->pictures * SIDE * SIDE * 4;
}

static void set_view(support_place *place, const char *name, snow_view *view) {
    assert_int_equal(snow_view_from_name(place->context, name, view),
                     SNOW_STATUS_OK);
    view->width = view->height = SIDE;
}

static void begin_request(support_place *place, const char *path, request *r) {
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

static snow_status draw_all(snow_comm *comm, request *r,
                            const snow_transfer *transfer, snow_frame *frame,
                            snow_volume **volume) {
    for (int n = 0; n < r->pictures; n++) {
        snow_image *image = NULL;
        SNOW_TRY(snow_ranks_repartition(comm, transfer, &r->views[n],
                                        &r->settings, &r->how, volume));
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

static int64_t product(const int64_t n[3]) {
    return n[0] * n[1] * n[2];
}

static snow_status open_parts(snow_comm *comm, request *r, snow_volume **volume,
                              snow_transfer **transfer) {
    const int rank = snow_comm_rank(comm);
    snow_extent part;
    snow_extent_init(&part);
    SNOW_TRY(snow_ranks_open(comm, r->path, NULL, &r->look, &r->views[0],
                             &r->settings, &r->how, volume, transfer));
    r->stored[rank] = product(snow_volume_get_info(*volume)->dims);
    SNOW_TRY(snow_volume_get_extent(*volume, &part));
    r->owned[rank] = product(part.count);
    return SNOW_STATUS_OK;
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

static void draw_by(support_place *place, request *r, int ranks) {
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

/* Draws with all voxels, and with those of the look; what is stored then. */
static int64_t compare(support_place *place, const request *asked, int ranks) {
    request all = *asked, one = *asked;
    one.how.one_look = true;
    draw_by(place, &all, ranks);
    draw_by(place, &one, ranks);
    double sum = 0;
    for (size_t n = 0; n < floats_of(&all); n++)
        sum += (double)all.made[n];
    assert_true(sum > 10); /* something is seen */
    assert_memory_equal(all.made, one.made, floats_of(&all) * sizeof(float));
    assert_int_equal(sum_of(all.owned, ranks), product(dims));
    assert_int_equal(sum_of(one.voxels, ranks), sum_of(all.voxels, ranks));
    assert_int_equal(sum_of(one.interesting, ranks),
                     sum_of(all.interesting, ranks));
    free(all.made);
    free(one.made);
    return sum_of(one.stored, ranks);
}

static void pictures_need_no_air(void **state) {
    support_place *place = *state;
    static const snow_type types[] = {SNOW_TYPE_UINT8, SNOW_TYPE_INT16,
                                      SNOW_TYPE_FLOAT32};
    static const char *const views[] = {"+z", "-x", "+y"};
    static const int ranks[] = {2, 3, 5, 8};
    for (int n = 0; n < 24; n++) {
        request r;
        begin_request(place, put_ball(place, types[n % 3]), &r);
        set_view(place, views[n / 3 % 3], &r.views[0]);
        r.views[0].azimuth = n / 9 % 2 * 20.0;
        r.how.cut = (snow_partition)(n % 4 == 1 ? 0 : n % 4);
        r.settings.quality = (snow_quality)(n / 2 % 3);
        r.settings.kernel =
            n % 5 == 4 ? SNOW_KERNEL_BSPLINE : r.settings.kernel;
        const int count = ranks[n % 4];
        const int64_t stored = compare(place, &r, count);
        /* Layers of both sides are kept around the ball. */
        assert_true(count > 3 || stored < product(dims) / 2);
    }
}

static void so_does_a_turntable(void **state) {
    support_place *place = *state;
    static const snow_partition cuts[] = {
        SNOW_PARTITION_AUTO, SNOW_PARTITION_COUNTED, SNOW_PARTITION_BRICKS};
    for (int n = 0; n < 6; n++) {
        request r;
        begin_request(place, put_ball(place, SNOW_TYPE_UINT8), &r);
        r.pictures = PICTURES;
        r.how.cut = cuts[n % 3];
        r.how.turns = n > 2;
        (void)compare(place, &r, 4);
    }
}

static void a_look_that_shows_air_keeps_it(void **state) {
    support_place *place = *state;
    request r;
    begin_request(place, put_ball(place, SNOW_TYPE_UINT8), &r);
    r.look.opacities = all_seen;
    r.look.opacity_count = sizeof all_seen / sizeof *all_seen;
    r.how.one_look = true;
    draw_by(place, &r, 4);
    assert_int_equal(sum_of(r.owned, 4), product(dims));
    free(r.made);
}

/* On threads of their own nothing can be asserted. */
#define REQUIRE(comm, condition)                                             \
    do {                                                                     \
        if (!(condition))                                                    \
            return snow_fail(snow_comm_context(comm), SNOW_STATUS_BAD_INPUT, \
                             "line %d: not " #condition, __LINE__);          \
    } while (0)

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
    support_place *place = *state;
    request r;
    begin_request(place, put_ball(place, SNOW_TYPE_UINT8), &r);
    r.how.one_look = true;
    if (snow_comm_run_threads(place->context, 3, draw_others, &r) !=
        SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(place->context));
    assert_true(sum_of(r.owned, 3) < product(dims));
}

static void hidden_values_are_some_way_from_seen_ones(void **state) {
    support_place *place = *state;
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
    cmocka_unit_test_setup_teardown(name, support_place_begin, \
                                    support_place_end)

int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(pictures_need_no_air),
        TEST(so_does_a_turntable),
        TEST(a_look_that_shows_air_keeps_it),
        TEST(what_needs_the_air_is_refused),
        TEST(hidden_values_are_some_way_from_seen_ones),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
