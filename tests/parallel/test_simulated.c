/* test_simulated - ranks on a simulated cluster: messages arrive as ever, and
 * take the time that the network's figures say. */
#include "support/comm.h"

#include "comm/comm.h"
#include "simulated_network.h"

#include <math.h>
#include <string.h>

/* So slow that the processor's own time is nothing beside it. */
static const snow_network slow = {
    .latency = 10, .bandwidth = 1000, .overhead = 1, .slowness = 1};

static bool near(double a, double b) {
    return fabs(a - b) < 0.5;
}

static void run(int ranks, snow_comm_body_fn *body) {
    snow_context *context = support_context();
    snow_status status =
        snow_comm_run_simulated(context, ranks, &slow, body, NULL);
    if (status != SNOW_STATUS_OK)
        print_message("%s\n", snow_context_message(context));
    assert_int_equal(status, SNOW_STATUS_OK);
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
}

static snow_status send_one(snow_comm *comm, void *user) {
    (void)user;
    unsigned char bytes[2000] = {7};
    snow_message message = {0};
    double start = snow_comm_seconds(comm);
    if (snow_comm_rank(comm) == 0)
        SNOW_TRY(snow_comm_send(comm, bytes, sizeof bytes, 1, 3, &message));
    else
        SNOW_TRY(snow_comm_receive(comm, bytes, sizeof bytes, 0, 3, &message));
    SNOW_TRY(snow_comm_wait_all(comm, &message, 1));
    double took = snow_comm_seconds(comm) - start;
    CHECK(message.bytes == 2000 && bytes[0] == 7);
    /* Overhead 1, 2 s on the wire; then latency 10 and the receiver's 1. */
    CHECK(near(took, snow_comm_rank(comm) == 0 ? 3 : 14));
    return SNOW_STATUS_OK;
}

static void a_message_takes_overhead_latency_and_bytes(void **state) {
    (void)state;
    run(2, send_one);
}

/* All but rank 0 send it 1000 bytes at once: its port takes them one by one. */
static snow_status crowd(snow_comm *comm, void *user) {
    (void)user;
    unsigned char bytes[5][1000] = {{0}};
    snow_message messages[5] = {{0}};
    int others = snow_comm_size(comm) - 1;
    if (snow_comm_rank(comm) > 0) {
        SNOW_TRY(snow_comm_send(comm, bytes[0], 1000, 0, 3, messages));
        return snow_comm_wait_all(comm, messages, 1);
    }
    for (int i = 0; i < others; i++)
        SNOW_TRY(
            snow_comm_receive(comm, bytes[i], 1000, i + 1, 3, &messages[i]));
    SNOW_TRY(snow_comm_wait_all(comm, messages, others));
    CHECK(near(snow_comm_seconds(comm), 1 + 10 + others * 1 + 1));
    return SNOW_STATUS_OK;
}

static void a_port_takes_one_message_after_another(void **state) {
    (void)state;
    run(6, crowd);
}

static snow_status work_alone(snow_comm *comm, void *user) {
    (void)user;
    double start = snow_comm_seconds(comm);
    snow_comm_work(comm, 100);
    CHECK(near(snow_comm_seconds(comm) - start, 100));
    int64_t sum = 1;
    SNOW_TRY(snow_comm_reduce_ints(comm, &sum, 1, SNOW_REDUCE_SUM));
    CHECK(sum == snow_comm_size(comm));
    return SNOW_STATUS_OK;
}

static void work_passes_time_and_collectives_work(void **state) {
    (void)state;
    for (int ranks = 1; ranks < 8; ranks++)
        run(ranks, work_alone);
}

/* A message to oneself, and one that is waited for by wait_any. */
static snow_status send_to_myself(snow_comm *comm, void *user) {
    (void)user;
    int in = 0, out = 5, which;
    snow_message messages[2] = {{0}};
    double start = snow_comm_seconds(comm);
    SNOW_TRY(snow_comm_receive(comm, &in, sizeof in, 0, 1, &messages[0]));
    SNOW_TRY(snow_comm_send(comm, &out, sizeof out, 0, 1, &messages[1]));
    for (int i = 0; i < 2; i++) {
        SNOW_TRY(snow_comm_wait_any(comm, messages, 2, &which));
        CHECK(which >= 0);
    }
    SNOW_TRY(snow_comm_wait_any(comm, messages, 2, &which));
    CHECK(which == -1 && in == 5);
    CHECK(near(snow_comm_seconds(comm) - start, 2)); /* twice the overhead */
    return SNOW_STATUS_OK;
}

static void a_message_to_oneself_takes_no_network(void **state) {
    (void)state;
    run(1, send_to_myself);
}

/* Work of a second a piece, `left` of them. */
typedef struct chores {
    snow_comm *comm;
    int left;
} chores;

static bool do_chore(void *user) {
    chores *c = user;
    if (!c->left)
        return false;
    c->left--;
    snow_comm_work(c->comm, 1);
    return true;
}

/* A message takes more than 10 seconds: five of work are hidden wholly, of 25
 * some are left, and it is not they that the message is waited for with. */
static snow_status work_meanwhile(snow_comm *comm, void *user) {
    (void)user;
    unsigned char bytes[2000] = {7};
    for (int any = 0; any < 2; any++)
        for (int all = 5; all < 30; all += 20) {
            chores c = {comm, all};
            int which;
            snow_message message = {0};
            SNOW_TRY(snow_comm_agree_status(comm, SNOW_STATUS_OK));
            double start = snow_comm_seconds(comm);
            if (snow_comm_rank(comm) == 0) {
                SNOW_TRY(snow_comm_send(comm, bytes, 2000, 1, 3, &message));
                SNOW_TRY(snow_comm_wait_all(comm, &message, 1));
                continue;
            }
            SNOW_TRY(snow_comm_receive(comm, bytes, 2000, 0, 3, &message));
            snow_comm_occupy(comm, do_chore, &c);
            SNOW_TRY(any ? snow_comm_wait_any(comm, &message, 1, &which)
                         : snow_comm_wait_all(comm, &message, 1));
            snow_comm_occupy(comm, NULL, NULL);
            double took = snow_comm_seconds(comm) - start;
            /* Ranks leave the agreement at times that differ by some seconds.
             */
            CHECK(took > 2 && took < 30);
            CHECK(all == 5 ? c.left == 0 : c.left > 0 && c.left < 25);
            CHECK(all == 5 || took < 25 - c.left + 2.5);
        }
    return SNOW_STATUS_OK;
}

static void waits_leave_time_for_other_work(void **state) {
    (void)state;
    run(2, work_meanwhile);
}

static snow_status fail_on_one(snow_comm *comm, void *user) {
    (void)user;
    snow_status status = SNOW_STATUS_OK;
    if (snow_comm_rank(comm) == 2)
        status = snow_fail(snow_comm_context(comm), SNOW_STATUS_BAD_INPUT,
                           "no file");
    return snow_comm_agree_status(comm, status);
}

/* Rank 1 goes without a word while the others wait for it. */
static snow_status leave_early(snow_comm *comm, void *user) {
    (void)user;
    if (snow_comm_rank(comm) == 1)
        return snow_fail(snow_comm_context(comm), SNOW_STATUS_NO_MEMORY,
                         "full");
    int in;
    snow_message message = {0};
    SNOW_TRY(snow_comm_receive(comm, &in, sizeof in, 1, 1, &message));
    return snow_comm_wait_all(comm, &message, 1);
}

static void a_rank_that_fails_ends_all(void **state) {
    (void)state;
    snow_context *context = support_context();
    assert_int_equal(
        snow_comm_run_simulated(context, 5, &slow, fail_on_one, NULL),
        SNOW_STATUS_BAD_INPUT);
    assert_non_null(strstr(snow_context_message(context), "rank 2: no file"));
    assert_int_equal(
        snow_comm_run_simulated(context, 5, &slow, leave_early, NULL),
        SNOW_STATUS_NO_MEMORY);
    assert_non_null(strstr(snow_context_message(context), "rank 1: full"));
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
}

static void a_network_without_bandwidth_is_refused(void **state) {
    (void)state;
    snow_context *context = support_context();
    const snow_network none = {.slowness = 1};
    assert_int_equal(
        snow_comm_run_simulated(context, 2, &none, work_alone, NULL),
        SNOW_STATUS_BAD_USAGE);
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_message_takes_overhead_latency_and_bytes),
        cmocka_unit_test(a_port_takes_one_message_after_another),
        cmocka_unit_test(work_passes_time_and_collectives_work),
        cmocka_unit_test(a_message_to_oneself_takes_no_network),
        cmocka_unit_test(waits_leave_time_for_other_work),
        cmocka_unit_test(a_rank_that_fails_ends_all),
        cmocka_unit_test(a_network_without_bandwidth_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
