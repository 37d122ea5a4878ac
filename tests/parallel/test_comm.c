/* test_comm - communicators of one process: messages, what ranks do together,
 * and what becomes of the others when one fails. */
#include "support/comm.h"
#include "support/failing.h"

static const int sizes[] = {1, 2, 3, 4, 5, 7, 8, 11, 13, 16, 17, 31, 32, 33};

static snow_status run(snow_context *context, int ranks,
                       snow_comm_body_fn *body, void *user) {
    snow_status status = snow_comm_run_threads(context, ranks, body, user);
    if (status != SNOW_STATUS_OK)
        print_message("%d ranks: %s\n", ranks, snow_context_message(context));
    return status;
}

/* Runs a body that fails, and compares the status and the message, which some
 * rank or other tells where it is NULL. */
static void run_failing(int ranks, snow_comm_body_fn *body, snow_status status,
                        const char *message) {
    snow_context *context = support_context();
    assert_int_equal(snow_comm_run_threads(context, ranks, body, NULL), status);
    if (message)
        assert_string_equal(snow_context_message(context), message);
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
}

/* --- messages ------------------------------------------------------------- */

/* With all numbers of ranks, and nothing is kept. */
static void any_number_of_ranks_exchanges_messages(void **state) {
    (void)state;
    snow_context *context = support_context();
    for (size_t n = 0; comm_bodies[n].body; n++)
        for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
            if (run(context, sizes[i], comm_bodies[n].body, NULL) !=
                SNOW_STATUS_OK)
                fail_msg("%s fails", comm_bodies[n].name);
            assert_int_equal(snow_context_bytes(context), 0);
        }
    snow_context_free(context);
}

static void messages_that_nobody_fetches_are_freed(void **state) {
    (void)state;
    snow_context *context = support_context();
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        assert_int_equal(run(context, sizes[i], leave_much_undone, NULL),
                         SNOW_STATUS_OK);
        assert_int_equal(snow_context_bytes(context), 0);
    }
    snow_context_free(context);
}

static void a_group_of_one_sends_to_itself(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_comm *comm;
    assert_int_equal(snow_comm_new_self(context, &comm), SNOW_STATUS_OK);
    assert_int_equal(send_all_to_all(comm, NULL), SNOW_STATUS_OK);
    assert_int_equal(mix_tags(comm, NULL), SNOW_STATUS_OK);
    assert_int_equal(snow_comm_rank(comm), 0);
    assert_int_equal(snow_comm_size(comm), 1);
    assert_true(snow_comm_seconds(comm) > 0);
    snow_comm_work(comm, 1);
    snow_comm_free(comm);
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
}

/* --- what ranks do together ----------------------------------------------- */

static void sums_have_the_same_bits_on_all_ranks_and_in_all_runs(void **state) {
    (void)state;
    snow_context *context = support_context();
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        rank_sums first, again;
        double right = 0;
        for (int rank = 0; rank < sizes[i]; rank++)
            right += 1.0 / (rank + 1);
        for (int run_number = 0; run_number < 10; run_number++) {
            rank_sums *into = run_number ? &again : &first;
            assert_int_equal(run(context, sizes[i], reduce_doubles, into),
                             SNOW_STATUS_OK);
            for (int rank = 0; rank < sizes[i]; rank++)
                assert_memory_equal(&into->sums[rank], &first.sums[0],
                                    sizeof(double));
        }
        assert_float_equal(first.sums[0], right, 1e-14);
    }
    snow_context_free(context);
}

/* --- failures ------------------------------------------------------------- */

static void all_ranks_agree_on_the_lowest_that_failed(void **state) {
    (void)state;
    for (size_t i = 3; i < sizeof sizes / sizeof sizes[0]; i++)
        run_failing(sizes[i], agree_on_failure, SNOW_STATUS_FAILED,
                    "rank 2: file 2 is broken");
}

static snow_status fail_alone(snow_comm *comm, void *user) {
    (void)user;
    snow_context *context = snow_comm_context(comm);
    CHECK(snow_comm_agree_status(comm, SNOW_STATUS_OK) == SNOW_STATUS_OK);
    snow_fail(context, SNOW_STATUS_BAD_INPUT, "this is so");
    CHECK(snow_comm_agree_status(comm, SNOW_STATUS_BAD_INPUT) ==
          SNOW_STATUS_BAD_INPUT);
    CHECK(!strcmp(snow_context_message(context), "this is so"));
    return SNOW_STATUS_OK;
}

static void a_group_of_one_keeps_its_message(void **state) {
    (void)state;
    snow_context *context = support_context();
    assert_int_equal(snow_comm_run_threads(context, 1, fail_alone, NULL),
                     SNOW_STATUS_OK);
    snow_context_free(context);
}

/* One rank in the middle leaves without a word while all others go on. */
static snow_status leave_early(snow_comm *comm, void *user) {
    (void)user;
    const int ranks = snow_comm_size(comm), rank = snow_comm_rank(comm);
    SNOW_TRY(snow_comm_agree_status(comm, SNOW_STATUS_OK));
    if (rank == ranks / 2)
        return snow_fail(snow_comm_context(comm), SNOW_STATUS_NO_MEMORY,
                         "the last straw");
    for (int round = 0; round < 100; round++) {
        snow_status status = snow_comm_agree_status(comm, SNOW_STATUS_OK);
        if (status != SNOW_STATUS_OK) {
            CHECK(snow_comm_broken(comm));
            /* Whoever does not heed it gets the same answer, at once. */
            int64_t number = 0;
            CHECK(snow_comm_agree_status(comm, SNOW_STATUS_OK) == status);
            CHECK(send_number(comm, 1, rank, 1) == status);
            CHECK(snow_comm_reduce_ints(comm, &number, 1, SNOW_REDUCE_SUM) ==
                  status);
            CHECK(snow_comm_broadcast(comm, &number, 8, 0) == status);
            return status;
        }
    }
    return SNOW_STATUS_OK;
}

static void a_rank_that_leaves_releases_all_others(void **state) {
    (void)state;
    for (size_t i = 1; i < sizeof sizes / sizeof sizes[0]; i++) {
        char message[64];
        snprintf(message, sizeof message, "rank %d: the last straw",
                 sizes[i] / 2);
        run_failing(sizes[i], leave_early, SNOW_STATUS_NO_MEMORY, message);
    }
}

/* What a rank sent before it left is still received. */
static snow_status send_and_leave(snow_comm *comm, void *user) {
    (void)user;
    int64_t number = 42;
    snow_message message = {0};
    if (snow_comm_rank(comm) == 1)
        return snow_comm_send(comm, &number, sizeof number, 0, 1, &message);
    number = 0;
    rest(20000);
    SNOW_TRY(receive_number(comm, &number, 1, 1));
    CHECK(number == 42);
    return receive_number(comm, &number, 1, 1);
}

/* All in a ring wait for their neighbour. */
static snow_status wait_in_a_ring(snow_comm *comm, void *user) {
    (void)user;
    int64_t number;
    return receive_number(comm, &number,
                          (snow_comm_rank(comm) + 1) % snow_comm_size(comm), 1);
}

/* Two ranks that send and wait, and only then receive: it may work with MPI for
 * small messages, and does not for large ones. */
static snow_status send_before_all(snow_comm *comm, void *user) {
    (void)user;
    int64_t number;
    const int other = 1 - snow_comm_rank(comm);
    SNOW_TRY(send_number(comm, 1, other, 1));
    return receive_number(comm, &number, other, 1);
}

static snow_status send_too_much(snow_comm *comm, void *user) {
    (void)user;
    char bytes[20] = {0};
    snow_message message = {0};
    if (snow_comm_rank(comm) == 0) {
        SNOW_TRY(snow_comm_send(comm, bytes, 20, 1, 1, &message));
    } else {
        SNOW_TRY(snow_comm_receive(comm, bytes, 19, 0, 1, &message));
    }
    return snow_comm_wait_all(comm, &message, 1);
}

static void what_cannot_arrive_is_a_failure(void **state) {
    (void)state;
    static const char waits[] = "every rank waits for another: all ranks must "
                                "make the same calls";
    run_failing(2, send_and_leave, SNOW_STATUS_FAILED,
                "rank 0: rank 1 has ended");
    run_failing(2, send_too_much, SNOW_STATUS_FAILED,
                "rank 1: a message of 20 bytes from rank 0 exceeds its buffer "
                "of 19 bytes: all ranks must make the same calls");
    run_failing(1, wait_in_a_ring, SNOW_STATUS_FAILED, waits);
    run_failing(2, send_before_all, SNOW_STATUS_FAILED, NULL);
    for (size_t i = 1; i < sizeof sizes / sizeof sizes[0]; i++)
        run_failing(sizes[i], wait_in_a_ring, SNOW_STATUS_FAILED, NULL);
}

static snow_status work_with_little(snow_comm *comm, void *user) {
    (void)user;
    void *block = snow_allocate(snow_comm_context(comm), 1000);
    snow_status status = snow_comm_agree_status(
        comm, block ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY);
    snow_release(snow_comm_context(comm), block);
    SNOW_TRY(status);
    return mix_tags(comm, NULL);
}

static void nobody_hangs_wherever_memory_ends(void **state) {
    (void)state;
    int steps = 0;
    for (int budget = 1;; steps++, budget += 1 + budget / 8) {
        support_failing memory = {.failing = budget, .for_good = true};
        const snow_allocator allocator = support_failing_allocator(&memory);
        snow_context *context;
        assert_int_equal(snow_context_new(&allocator, &context),
                         SNOW_STATUS_OK);
        snow_status status =
            snow_comm_run_threads(context, 3, work_with_little, NULL);
        assert_true(status == SNOW_STATUS_OK ||
                    status == SNOW_STATUS_NO_MEMORY);
        assert_int_equal(snow_context_bytes(context), 0);
        snow_context_free(context);
        if (status == SNOW_STATUS_OK)
            break;
    }
    assert_true(steps > 20);
}

static void wrong_arguments_are_refused(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_comm_ops ops = {.size = sizeof ops};
    snow_comm *comm = NULL;
    assert_int_equal(snow_comm_run_threads(context, 0, wait_for_none, NULL),
                     SNOW_STATUS_BAD_USAGE);
    assert_int_equal(snow_comm_new(context, &ops, NULL, 1, 1, &comm),
                     SNOW_STATUS_BAD_USAGE);
    assert_int_equal(snow_comm_new(context, &ops, NULL, 0, 0, &comm),
                     SNOW_STATUS_BAD_USAGE);
    assert_int_equal(snow_comm_new(context, &ops, NULL, 0, 1, &comm),
                     SNOW_STATUS_BAD_USAGE);
    assert_non_null(strstr(snow_context_message(context), "lacks"));
    ops.size = 0;
    assert_int_equal(snow_comm_new(context, &ops, NULL, 0, 1, &comm),
                     SNOW_STATUS_BAD_USAGE);
    assert_null(comm);
    assert_int_equal(snow_comm_new_self(context, &comm), SNOW_STATUS_OK);
    int64_t number = 1;
    snow_message message = {0};
    assert_int_equal(snow_comm_send(comm, &number, 8, 0, 32767, &message),
                     SNOW_STATUS_OK);
    assert_int_equal(send_number(comm, 1, 1, 1), SNOW_STATUS_BAD_USAGE);
    assert_int_equal(send_number(comm, 1, 0, 1), SNOW_STATUS_BAD_USAGE);
    snow_comm_free(comm);
    snow_comm_free(NULL);
    snow_context_free(context);
}

/* --- contexts ------------------------------------------------------------- */

static void count_warning(void *user, const char *text) {
    if (!strcmp(text, "from rank 0"))
        ++*(int *)user;
    else
        *(int *)user += 1000;
}

static snow_status remark(snow_comm *comm, void *user) {
    (void)user;
    snow_context_warn(snow_comm_context(comm), "from rank %d",
                      snow_comm_rank(comm));
    return SNOW_STATUS_OK;
}

static void the_caller_hears_rank_0_and_counts_the_bytes_of_all(void **state) {
    (void)state;
    int heard = 0;
    snow_context *context = support_context();
    snow_context_set_warning(context, count_warning, &heard);
    assert_int_equal(snow_comm_run_threads(context, 5, remark, NULL),
                     SNOW_STATUS_OK);
    assert_int_equal(heard, 1);
    assert_true(snow_context_peak_bytes(context) > 5 * 8 * SNOW_COMM_SCRATCH);
    assert_int_equal(
        snow_context_fail(context, SNOW_STATUS_BAD_INPUT, "%s: %d", "a", 1),
        SNOW_STATUS_BAD_INPUT);
    assert_string_equal(snow_context_message(context), "a: 1");
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_number_of_ranks_exchanges_messages),
        cmocka_unit_test(a_group_of_one_sends_to_itself),
        cmocka_unit_test(messages_that_nobody_fetches_are_freed),
        cmocka_unit_test(sums_have_the_same_bits_on_all_ranks_and_in_all_runs),
        cmocka_unit_test(all_ranks_agree_on_the_lowest_that_failed),
        cmocka_unit_test(a_group_of_one_keeps_its_message),
        cmocka_unit_test(a_rank_that_leaves_releases_all_others),
        cmocka_unit_test(what_cannot_arrive_is_a_failure),
        cmocka_unit_test(nobody_hangs_wherever_memory_ends),
        cmocka_unit_test(wrong_arguments_are_refused),
        cmocka_unit_test(the_caller_hears_rank_0_and_counts_the_bytes_of_all),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
