/* tests/parallel/test_load_balance.c - slabs that are cut by the time that
 * pictures took: what is noted, what is learned of it, when a cut pays, and
 * that pictures of a turning volume stay those of one process. */
#include "support/support.h"

#include "image/image.h"
#include "parallel/load_balance.h"
#include "parallel/part.h"
#include "render/picture.h"
#include "volume/volume.h"

#include <math.h>
#include <snowglass/ranks.h>
#include <stdlib.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

#define RANKS_MOST 33

/* --- what is noted -------------------------------------------------------- */

static void pictures_of_the_present_part_are_noted(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_load_balance work = {0};
    snow_load_balance_record(context, &work, 5, 0, true,
                             9); /* of another part */
    assert_int_equal(work.pictures, 0);
    snow_load_balance_record(context, &work, 5, 1, true,
                             9); /* none is finished */
    assert_int_equal(work.pictures, 0);
    assert_true(work.encoding == 0);
    snow_load_balance_record(context, &work, 5, 1, true,
                             9); /* that which encoded */
    assert_int_equal(work.pictures, 0);
    assert_true(work.encoding == 9);
    assert_true(snow_load_balance_seconds(&work) == 0);
    for (int n = 0; n < 20; n++) {
        const double took = 2 + n % 3;
        snow_load_balance_record(context, &work, 5, 1, false, took);
    }
    assert_int_equal(work.pictures, 20);
    assert_true(snow_load_balance_seconds(&work) == 2);
    for (int n = 0; n < SNOW_LOAD_BALANCE_PICTURES; n++) {
        const double took = 7;
        snow_load_balance_record(context, &work, 5, 1, false, took);
    }
    assert_true(snow_load_balance_seconds(&work) == 7); /* the last ones only */
    snow_load_balance_record(context, &work, 6, 1, false, 7);
    assert_int_equal(work.pictures, 0);
    assert_true(work.encoding == 0);
    snow_load_balance_fini(context, &work);
    snow_context_free(context);
}

/* --- what is learned ------------------------------------------------------ */

/* A volume's cost along an axis that no count tells. */
static double cost_at(int kind, double at) {
    switch (kind) {
    case 0: /* a hundredth of the slices costs as much as a third of them */
        return fabs(at - 0.7) < 0.05 ? 8 : 1;
    case 1:
        return 1 + 4 * at * at;
    default:
        return 1 + sin(20 * at) * sin(20 * at);
    }
}

/* Ranks' seconds with the present slabs. */
static void measure(int kind, int64_t slices, const snow_box *boxes, int axis,
                    int ranks, snow_load_balance_message *words) {
    for (int rank = 0; rank < ranks; rank++) {
        const snow_box *box = &boxes[rank];
        words[rank] =
            (snow_load_balance_message){.first = box->first[axis],
                                        .count = box->count[axis],
                                        .pictures = SNOW_LOAD_BALANCE_LEAST};
        for (int64_t n = 0; n < box->count[axis]; n++)
            words[rank].seconds +=
                1e-4 *
                cost_at(kind, (double)(box->first[axis] + n) / (double)slices);
    }
}

/* From equal counts, so many cuts later. */
static void a_few_cuts_even_out_what_counts_do_not_tell(void **state) {
    (void)state;
    static const int rank_counts[] = {2, 4, 8, 16, 32};
    snow_context *context = support_context();
    for (size_t i = 0; i < 3 * COUNT(rank_counts); i++) {
        int kind = (int)i % 3, ranks = rank_counts[i / 3], axis = (int)i % 3;
        snow_partition_params order = {
            .cut = SNOW_PARTITION_COUNTED,
            .ranks = ranks,
            .grid = {.dims = {640, 640, 640}, .axis = axis}};
        int64_t slices = snow_partition_slices(&order);
        double costs[640], first = 0, last = 0;
        snow_box boxes[RANKS_MOST];
        snow_load_balance_message words[RANKS_MOST];
        assert_int_equal(slices, 640);
        for (int n = 0; n < 640; n++)
            costs[n] = 100;
        for (int cut = 0; cut <= SNOW_LOAD_BALANCE_CUTS; cut++) {
            assert_int_equal(
                snow_partition_costs(context, &order, costs, boxes),
                SNOW_STATUS_OK);
            measure(kind, slices, boxes, axis, ranks, words);
            last = snow_load_balance_imbalance(words, ranks);
            first = cut ? first : last;
            snow_load_balance_learn(words, ranks, costs);
            double sum = 0, seconds = 0;
            for (int n = 0; n < 640; n++)
                sum += costs[n];
            for (int rank = 0; rank < ranks; rank++)
                seconds += words[rank].seconds;
            assert_true(fabs(sum / seconds - 1) < 1e-9);
        }
        print_message("             cost %d, %2d ranks: imbalance %.2f, then "
                      "%.3f\n",
                      kind, ranks, first, last);
        assert_true(last < (ranks > 8 ? 1.25 : 1.08));
        assert_true(last <= first * 1.01);
    }
    snow_context_free(context);
}

static void a_slab_without_cost_or_slices_teaches_nothing(void **state) {
    (void)state;
    double costs[] = {0, 0, 3, 1};
    const snow_load_balance_message words[] = {
        {.first = 0, .count = 2, .seconds = 5},
        {.first = 2, .count = 0, .seconds = 1},
        {.first = 2, .count = 2, .seconds = 8}};
    snow_load_balance_learn(words, 3, costs);
    assert_true(costs[0] == 0 && costs[1] == 0);
    assert_true(costs[2] == 6 && costs[3] == 2);
    assert_true(snow_load_balance_imbalance(words, 0) == 1);
}

/* --- when it pays --------------------------------------------------------- */

static void a_cut_pays_where_time_is_saved_in_the_end(void **state) {
    (void)state;
    snow_load_balance_message words[4];
    for (int n = 0; n < 4; n++)
        words[n] =
            (snow_load_balance_message){.pictures = SNOW_LOAD_BALANCE_LEAST,
                                        .seconds = n ? 0.010 : 0.020,
                                        .encoding = 0.05};
    assert_true(fabs(snow_load_balance_imbalance(words, 4) - 1.6) < 1e-12);
    assert_true(snow_load_balance_is_uneven(words, 4));
    /* 7.5 ms a picture are saved, of which half is hoped for, against 100. */
    assert_true(snow_load_balance_is_worthwhile(words, 4, 0.0125, 27));
    assert_false(snow_load_balance_is_worthwhile(words, 4, 0.0125, 26));
    /* Less than noise. */
    assert_false(snow_load_balance_is_worthwhile(words, 4, 0.0197, 1000000));
    words[3].pictures--;
    assert_false(snow_load_balance_is_uneven(words, 4));
    for (int n = 0; n < 4; n++)
        words[n] = (snow_load_balance_message){
            .pictures = SNOW_LOAD_BALANCE_LEAST, .seconds = n ? 0.010 : 0.0102};
    assert_false(snow_load_balance_is_uneven(words, 4));
}

/* --- a turning volume ----------------------------------------------------- */

typedef struct turning {
    const char *path;
    snow_settings settings;
    snow_ranks_options how;
    double step; /* degrees from picture to picture */
    int pictures;
    int64_t left;   /* of the first one's call */
    int ahead;      /* pictures begun before one is finished */
    int cuts;       /* parts that were new, as rank 0 saw it */
    int by_time;    /* of these, cuts of the same axis */
    int64_t least;  /* slices of the expensive slab in the end */
    double largest; /* difference from the pictures of one process */
} turning;

static snow_view view_at(snow_context *context, const turning *t, int n) {
    snow_view view = {.size = sizeof view};
    assert_int_equal(snow_view_from_name(context, "+z", &view), SNOW_STATUS_OK);
    view.width = view.height = 80;
    view.azimuth = 10 + t->step * n;
    view.elevation = 12;
    return view;
}

static void compare(turning *t, int n, const snow_image *image) {
    snow_context *context = support_context();
    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL;
    snow_frame *frame = NULL;
    snow_image *generation = NULL;
    snow_image_difference difference = {.size = sizeof difference};
    const snow_volume_options options = {.size = sizeof options,
                                         .dims = {48, 44, 60}};
    snow_view view = view_at(context, t, n);
    assert_int_equal(
        snow_volume_open(context, "phantom:shells", &options, &volume),
        SNOW_STATUS_OK);
    assert_int_equal(snow_transfer_new_for_volume(volume, NULL, &transfer),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_frame_new(context, &frame), SNOW_STATUS_OK);
    assert_int_equal(snow_frame_render(frame, volume, transfer, &view,
                                       &t->settings, &generation),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_image_compare(image, generation, &difference),
                     SNOW_STATUS_OK);
    t->largest = fmax(t->largest, difference.largest);
    snow_image_free(generation);
    snow_frame_free(frame);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
}

/* As if slices near one end of the volume were five times as dear. */
static void pretend(snow_frame *frame, const snow_volume *volume) {
    snow_extent part = {.size = sizeof part};
    snow_volume_get_extent(volume, &part);
    int axis = frame->stats.slice_axis;
    double cost = 0;
    for (int64_t n = 0; n < part.count[axis]; n++)
        cost += part.first[axis] + n < part.dims[axis] / 4 ? 5e-3 : 1e-3;
    frame->ranks_stats.cpu_splat = cost;
}

static snow_status finish(snow_frame *frame, const snow_volume *volume,
                          turning *t, int n) {
    snow_image *image = NULL;
    SNOW_TRY(snow_ranks_finish(frame, &image));
    if (image)
        compare(t, n, image);
    snow_image_free(image);
    pretend(frame, volume);
    return SNOW_STATUS_OK;
}

static snow_status turn_volume(snow_frame *frame, snow_comm *comm,
                               const snow_transfer *transfer,
                               snow_volume **volume, turning *t) {
    int axis = -1;
    bool talks = snow_comm_rank(comm) == 0;
    for (int n = 0; n < t->pictures + t->ahead; n++) {
        snow_view view = view_at(snow_comm_context(comm), t, n);
        uint64_t before = (*volume)->generation;
        if (n < t->pictures) {
            SNOW_TRY(snow_ranks_rebalance(frame, comm, transfer, &view,
                                          &t->settings, &t->how, t->left - n,
                                          volume));
            SNOW_TRY(snow_ranks_begin(frame, comm, *volume, transfer, &view,
                                      &t->settings, &t->how));
        }
        if (talks && (*volume)->generation != before) {
            t->cuts++;
            t->by_time += axis == frame->stats.slice_axis &&
                          t->step == 0; /* no other reason */
        }
        if (n >= t->ahead)
            SNOW_TRY(finish(frame, *volume, t, n - t->ahead));
        axis = frame->stats.slice_axis;
    }
    snow_extent part = {.size = sizeof part};
    snow_volume_get_extent(*volume, &part);
    if (talks)
        t->least = part.count[axis];
    return SNOW_STATUS_OK;
}

static snow_status perform(snow_comm *comm, void *user) {
    turning *t = user;
    snow_context *context = snow_comm_context(comm);
    snow_volume_options options = {.size = sizeof options,
                                   .dims = {48, 44, 60}};
    snow_view view = view_at(context, t, 0);
    const snow_look look = {.size = sizeof look};
    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL;
    snow_frame *frame = NULL;
    SNOW_TRY(snow_ranks_open(comm, "phantom:shells", &options, &look, &view,
                             &t->settings, &t->how, &volume, &transfer));
    snow_status status =
        snow_comm_agree_status(comm, snow_frame_new(context, &frame));
    if (status == SNOW_STATUS_OK)
        status = turn_volume(frame, comm, transfer, &volume, t);
    snow_frame_free(frame);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    return status;
}

static turning play(turning t, int ranks) {
    snow_context *context = support_context();
    snow_settings settings = t.settings;
    snow_settings_init(&t.settings);
    t.settings.threads = 1;
    t.settings.deterministic = settings.deterministic;
    t.how.size = sizeof t.how;
    t.how.turns = 1;
    if (snow_comm_run_threads(context, ranks, perform, &t) != SNOW_STATUS_OK)
        fail_msg("%d ranks: %s", ranks, snow_context_message(context));
    snow_context_free(context);
    return t;
}

/* By parts pixels are given up a little later: docs/model.md. */
#define BOUND (1.0 / 255)

static void parts_are_cut_anew_and_pictures_stay(void **state) {
    (void)state;
    static const int rank_counts[] = {2, 3, 5, 8, 12};
    for (size_t n = 0; n < COUNT(rank_counts); n += support_stride(3))
        for (int ahead = 0; ahead < 2; ahead++) {
            turning t =
                play((turning){.how = {.size = sizeof(snow_ranks_options),
                                       .cut = SNOW_PARTITION_MEASURED},
                               .pictures = 24,
                               .left = 100000,
                               .ahead = ahead},
                     rank_counts[n]);
            turning counted =
                play((turning){.how = {.size = sizeof(snow_ranks_options),
                                       .cut = SNOW_PARTITION_COUNTED},
                               .pictures = 1,
                               .left = 100000},
                     rank_counts[n]);
            assert_true(t.largest <= BOUND);
            assert_in_range(t.by_time, 1, SNOW_LOAD_BALANCE_CUTS);
            assert_true(t.least < counted.least);
        }
}

/* A turn goes over other axes; what was learned of one serves again. */
static void a_whole_turn_is_that_of_one_process(void **state) {
    (void)state;
    turning t = play((turning){.how = {.size = sizeof(snow_ranks_options),
                                       .cut = SNOW_PARTITION_MEASURED},
                               .step = 15,
                               .pictures = 36,
                               .left = 100000,
                               .ahead = 1},
                     4);
    assert_true(t.largest <= BOUND);
    assert_true(t.cuts >= 4);
}

/* The parts of ranks that were opened along z and are wanted along x, or were
 * opened so. */
typedef struct new_axis {
    bool opened;
    snow_box boxes[RANKS_MOST];
} new_axis;

static snow_status change_axis(snow_comm *comm, void *user) {
    new_axis *a = user;
    snow_context *context = snow_comm_context(comm);
    snow_volume_options options = {.size = sizeof options,
                                   .dims = {64, 64, 64}};
    snow_view along_z = {.size = sizeof along_z}, along_x = along_z;
    SNOW_TRY(snow_view_from_name(context, "+z", &along_z));
    SNOW_TRY(snow_view_from_name(context, "+x", &along_x));
    snow_settings settings;
    snow_settings_init(&settings);
    snow_look look = {.size = sizeof look, .preset = "ct-bone"};
    snow_ranks_options how = {.size = sizeof how};
    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL;
    snow_frame *frame = NULL;
    SNOW_TRY(snow_frame_new(context, &frame));
    snow_status status = snow_ranks_open(comm, "phantom:head", &options, &look,
                                         a->opened ? &along_x : &along_z,
                                         &settings, &how, &volume, &transfer);
    how.cut = SNOW_PARTITION_MEASURED;
    if (status == SNOW_STATUS_OK)
        status = snow_ranks_rebalance(frame, comm, transfer, &along_x,
                                      &settings, &how, 100, &volume);
    if (status == SNOW_STATUS_OK)
        a->boxes[snow_comm_rank(comm)] = snow_part_box(volume);
    snow_frame_free(frame);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    return status;
}

static void a_new_axis_is_cut_as_if_it_were_the_first(void **state) {
    (void)state;
    for (int ranks = 2; ranks < 8; ranks++) {
        snow_context *context = support_context();
        static new_axis first, later;
        first.opened = true;
        assert_int_equal(
            snow_comm_run_threads(context, ranks, change_axis, &first),
            SNOW_STATUS_OK);
        assert_int_equal(
            snow_comm_run_threads(context, ranks, change_axis, &later),
            SNOW_STATUS_OK);
        assert_memory_equal(first.boxes, later.boxes,
                            (size_t)ranks * sizeof *first.boxes);
        snow_context_free(context);
    }
}

static void nothing_is_cut_where_time_must_not_or_cannot_tell(void **state) {
    (void)state;
    const struct {
        snow_partition cut;
        int64_t left;
        int deterministic, ranks;
    } cases[] = {
        {SNOW_PARTITION_AUTO, 100000, 0, 3},
        {SNOW_PARTITION_COUNTED, 100000, 0, 3},
        {SNOW_PARTITION_BRICKS, 100000, 0, 3},
        {SNOW_PARTITION_MEASURED, 12, 0, 3}, /* too few are left */
        {SNOW_PARTITION_MEASURED, 100000, 1,
         3}, /* bits must not depend on it */
        {SNOW_PARTITION_MEASURED, 100000, 0,
         33}, /* bricks, for slabs would be thin */
        {SNOW_PARTITION_MEASURED, 100000, 0, 1},
    };
    for (size_t n = 0; n < COUNT(cases); n++) {
        turning t = play(
            (turning){.how = {.size = sizeof(snow_ranks_options),
                              .cut = cases[n].cut},
                      .settings = {.deterministic = cases[n].deterministic},
                      .pictures = 10,
                      .left = cases[n].left,
                      .ahead = 1},
            cases[n].ranks);
        assert_int_equal(t.cuts, 0);
        assert_true(t.largest <= BOUND);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_of_the_present_part_are_noted),
        cmocka_unit_test(a_few_cuts_even_out_what_counts_do_not_tell),
        cmocka_unit_test(a_slab_without_cost_or_slices_teaches_nothing),
        cmocka_unit_test(a_cut_pays_where_time_is_saved_in_the_end),
        cmocka_unit_test(parts_are_cut_anew_and_pictures_stay),
        cmocka_unit_test(a_whole_turn_is_that_of_one_process),
        cmocka_unit_test(a_new_axis_is_cut_as_if_it_were_the_first),
        cmocka_unit_test(nothing_is_cut_where_time_must_not_or_cannot_tell),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
