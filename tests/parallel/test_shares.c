/* tests/parallel/test_shares.c - ranks read their shares in turn: all hear of
 * each turn, of what fails in it, and that progress is to stop. */
#include "support/comm.h"

#include "parallel/shares.h"

#include <stdatomic.h>

#define RANKS 6
#define READERS 5 /* the last rank has no share */

typedef struct race {
    /* Asked: */
    bool in_turn;
    int late;    /* from this rank on there is a point to enter at */
    int failing; /* a rank; -1: none */
    int stop_at; /* the call of rank 0's progress that stops; 0: none */
    /* Found: */
    atomic_int order; /* of reading */
    int place[RANKS]; /* in it, from 1; 0: did not read */
    uint64_t from[RANKS];
    bool last[RANKS];
    int heard;
    double fractions[READERS + 2];
} race;

/* A rank of a race. */
typedef struct racer {
    race *race;
    snow_comm *comm;
} racer;

/* The next call is due at once, so that nothing depends on the time. */
static snow_status read_one(void *user, snow_relay *relay) {
    racer *r = user;
    race *all = r->race;
    const int rank = snow_comm_rank(r->comm);
    snow_comm_context(r->comm)->progress_due = 0;
    all->place[rank] = ++all->order;
    if (!relay)
        return SNOW_STATUS_OK;
    all->from[rank] = relay->from.unpacked;
    all->last[rank] = relay->last;
    relay->skips = all->in_turn;
    if (rank >= all->late)
        relay->from.unpacked = 100 * ((uint64_t)rank + 1);
    return rank == all->failing
               ? snow_fail(snow_comm_context(r->comm), SNOW_STATUS_BAD_INPUT,
                           "share %d is damaged", rank)
               : SNOW_STATUS_OK;
}

static bool hear(void *user, snow_stage stage, double fraction) {
    racer *r = user;
    snow_comm_context(r->comm)->progress_due = 0;
    if (stage == SNOW_STAGE_READ && r->race->heard < READERS + 2)
        r->race->fractions[r->race->heard] = fraction;
    return ++r->race->heard == r->race->stop_at;
}

static snow_status run_race(snow_comm *comm, void *user) {
    racer r = {user, comm};
    if (snow_comm_rank(comm) == 0)
        snow_context_set_progress(snow_comm_context(comm), hear, &r);
    const snow_status status =
        snow_shares_in_turn(comm, READERS, "file", read_one, &r);
    snow_context_set_progress(snow_comm_context(comm), NULL, NULL);
    return snow_comm_agree_status(comm, status);
}

static snow_status start(snow_context *context, race *all) {
    return snow_comm_run_threads(context, RANKS, run_race, all);
}

/* The rank without a share reads beside the first one. */
static void check_order(const race *all) {
    for (int rank = 1; rank < READERS; rank++)
        assert_true(all->place[rank] > all->place[rank - 1]);
    assert_in_range(all->place[READERS], 1, RANKS);
}

static void each_goes_on_where_the_one_before_ended(void **state) {
    (void)state;
    snow_context *context = support_context();
    race all = {.in_turn = true, .failing = -1};
    assert_int_equal(start(context, &all), SNOW_STATUS_OK);
    check_order(&all);
    for (int rank = 0; rank < READERS; rank++) {
        assert_int_equal(all.from[rank], 100 * rank);
        assert_int_equal(all.last[rank], rank == READERS - 1);
    }
    snow_context_free(context);
}

/* A block of deflate may be longer than shares. */
static void a_share_without_a_point_keeps_the_turns(void **state) {
    (void)state;
    snow_context *context = support_context();
    race all = {.in_turn = true, .failing = -1, .late = 2};
    assert_int_equal(start(context, &all), SNOW_STATUS_OK);
    check_order(&all);
    for (int rank = 0; rank < READERS; rank++)
        assert_int_equal(all.from[rank], rank < 3 ? 0 : 100 * rank);
    snow_context_free(context);
}

/* Rank 0 waits anew in each turn, and says so. */
static void progress_counts_turns(void **state) {
    (void)state;
    snow_context *context = support_context();
    race all = {.in_turn = true, .failing = -1};
    assert_int_equal(start(context, &all), SNOW_STATUS_OK);
    assert_int_equal(all.heard, READERS + 1);
    for (int turn = 0; turn < READERS - 1; turn++)
        assert_float_equal(all.fractions[turn], (turn + 1.0) / READERS, 1e-9);
    assert_true(all.fractions[READERS - 1] < 1);
    assert_float_equal(all.fractions[READERS], 1, 0);
    snow_context_free(context);
}

static void a_failure_ends_the_turns_of_all(void **state) {
    (void)state;
    for (int failing = 0; failing < READERS; failing++) {
        snow_context *context = support_context();
        race all = {.in_turn = true, .failing = failing};
        assert_int_equal(start(context, &all), SNOW_STATUS_BAD_INPUT);
        assert_non_null(strstr(snow_context_message(context), "is damaged"));
        for (int rank = 0; rank < READERS; rank++)
            assert_int_equal(all.place[rank] != 0, rank <= failing);
        snow_context_free(context);
    }
}

static void a_stop_ends_the_turns_of_all(void **state) {
    (void)state;
    snow_context *context = support_context();
    race all = {.in_turn = true, .failing = -1, .stop_at = 2};
    assert_int_equal(start(context, &all), SNOW_STATUS_STOPPED);
    /* Turn 2 has begun by then. */
    for (int rank = 0; rank < READERS; rank++)
        assert_int_equal(all.place[rank] != 0, rank <= 2);
    snow_context_free(context);
}

static void who_skips_nothing_lets_all_read(void **state) {
    (void)state;
    snow_context *context = support_context();
    race all = {.failing = -1};
    assert_int_equal(start(context, &all), SNOW_STATUS_OK);
    for (int rank = 0; rank < RANKS; rank++) {
        assert_true(all.place[rank] != 0);
        assert_int_equal(all.from[rank], 0);
        assert_int_equal(all.last[rank], rank == READERS - 1);
    }
    snow_context_free(context);
}

/* A place along an axis of a box of a file, in blocks of that. */
static int64_t block_at(const snow_file_blocks *b, int axis, int64_t at) {
    return (at + b->cut[axis]) / b->size[axis];
}

/* Shares cover the grid one behind the other; returns how many blocks more than
 * one rank unpacks, and the voxels of the largest share. */
static int64_t check_shares(const int64_t dims[3], const snow_file_blocks *b,
                            int ranks, int64_t *largest) {
    const int readers = snow_share_readers(dims, b, ranks);
    int64_t voxels = 0, pieces = 0, blocks = 1;
    *largest = 0;
    assert_in_range(readers, 1, ranks);
    for (int i = 1; i < 3; i++)
        blocks *= block_at(b, i, dims[i] - 1) + 1;
    for (int rank = 0; rank < ranks; rank++) {
        const snow_box box = snow_share_of(dims, b, rank, ranks);
        int64_t here = box.count[0], touched = 1;
        for (int i = 1; i < 3; i++) {
            here *= box.count[i];
            assert_true(box.first[i] + box.count[i] <= dims[i]);
            touched *= block_at(b, i, box.first[i] + box.count[i] - 1) -
                       block_at(b, i, box.first[i]) + 1;
        }
        assert_int_equal(here > 0, rank < readers);
        voxels += here;
        pieces += here ? touched : 0;
        *largest = here > *largest ? here : *largest;
    }
    assert_int_equal(voxels, dims[0] * dims[1] * dims[2]);
    return pieces - blocks;
}

/* Of a large volume, by ranks that are not many more than its blocks. */
static void shares_are_of_whole_blocks(void **state) {
    (void)state;
    const int64_t dims[3] = {50, 640, 500};
    const snow_file_blocks cubes = {{64, 64, 64}, {0, 0, 0}};
    const snow_file_blocks cut = {{64, 64, 64}, {0, 13, 63}};
    const snow_file_blocks slices = {{50, 640, 1}, {0, 0, 0}};
    for (int ranks = 1; ranks <= 48; ranks++) {
        const snow_file_blocks *all[] = {&cubes, &cut, &slices};
        for (int n = 0; n < 3; n++) {
            int64_t largest;
            assert_int_equal(check_shares(dims, all[n], ranks, &largest), 0);
            assert_true(largest <= SNOW_SHARE_MOST * 50 * 640 * 500 / ranks);
        }
    }
}

/* Shares of whole blocks would be too large: memory has precedence. */
static void few_blocks_are_shared(void **state) {
    (void)state;
    const int64_t dims[3] = {50, 64, 500};
    const snow_file_blocks thick = {{50, 64, 250}, {0, 0, 0}};
    int64_t largest;
    assert_int_equal(check_shares(dims, &thick, 2, &largest), 0);
    assert_true(check_shares(dims, &thick, 5, &largest) > 0);
    assert_int_equal(largest, 50 * 64 * 100);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shares_are_of_whole_blocks),
        cmocka_unit_test(few_blocks_are_shared),
        cmocka_unit_test(each_goes_on_where_the_one_before_ended),
        cmocka_unit_test(a_share_without_a_point_keeps_the_turns),
        cmocka_unit_test(progress_counts_turns),
        cmocka_unit_test(a_failure_ends_the_turns_of_all),
        cmocka_unit_test(a_stop_ends_the_turns_of_all),
        cmocka_unit_test(who_skips_nothing_lets_all_read),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
