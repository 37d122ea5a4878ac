/* tests/serve/test_outbox.c - what waits for the pages. */
#include "support/support.h"

#include "net/outbox.h"

static void wake_nobody(void *user) {
    (void)user;
}

static void put(outbox *box, message_topic topic, uint64_t except) {
    outgoing *p = outgoing_new(0);
    assert_non_null(p);
    p->topic = topic;
    p->except = except;
    outbox_put(box, p);
}

/* The one outgoing that waits. */
static uint64_t except_of_all(outbox *box) {
    outgoing *p = outbox_take(box);
    assert_non_null(p);
    assert_null(p->next);
    uint64_t except = p->except;
    outgoing_release(box, p);
    return except;
}

static void a_state_reaches_whom_the_one_before_was_for(void **state) {
    (void)state;
    static const uint64_t rows[][3] = {
        {1, 2, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1}, {0, 0, 0}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        outbox *box = outbox_new(wake_nobody, NULL);
        put(box, MESSAGE_STATE, rows[i][0]);
        put(box, MESSAGE_STATE, rows[i][1]);
        assert_int_equal(except_of_all(box), rows[i][2]);
        outbox_free(box);
    }
}

static void other_topics_replace_nothing(void **state) {
    (void)state;
    outbox *box = outbox_new(wake_nobody, NULL);
    put(box, MESSAGE_STATE, 1);
    put(box, MESSAGE_INFO, 0);
    put(box, MESSAGE_PLAIN, 0);
    outgoing *first = outbox_take(box);
    assert_int_equal(first->except, 1);
    assert_int_equal(first->next->topic, MESSAGE_INFO);
    assert_int_equal(first->next->next->topic, MESSAGE_PLAIN);
    for (outgoing *next; first; first = next) {
        next = first->next;
        outgoing_release(box, first);
    }
    outbox_free(box);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_state_reaches_whom_the_one_before_was_for),
        cmocka_unit_test(other_topics_replace_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
