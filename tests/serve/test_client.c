/* tests/serve/test_client.c - what waits for one page. */
#include "support/support.h"

#include "message.c"
#include "outbox.c"

#include "net/client.c"

/* No socket is written to here. */
int lws_write(struct lws *wsi, unsigned char *bytes, size_t length,
              enum lws_write_protocol how) {
    (void)wsi;
    (void)bytes;
    (void)how;
    return (int)length;
}

static void wake_nobody(void *user) {
    (void)user;
}

static void queue(client *c, outbox *box, parcel_topic topic, int level) {
    parcel *p = parcel_new(FRAME_HEAD_BYTES);
    assert_non_null(p);
    memset(p->bytes, 0, FRAME_HEAD_BYTES);
    p->topic = topic;
    p->bytes[8] = (unsigned char)level;
    client_queue(c, box, p);
    parcel_release(box, p);
}

static void of_pictures_the_newest_waits(void **state) {
    (void)state;
    outbox *box = outbox_new(wake_nobody, NULL);
    client c = {.id = 1, .thin = true};
    queue(&c, box, PARCEL_PICTURE, 2);
    queue(&c, box, PARCEL_STATE, 0);
    queue(&c, box, PARCEL_THIN_PICTURE, 0);
    queue(&c, box, PARCEL_PICTURE, 0); /* for other links */
    assert_int_equal(c.count, 2);
    assert_int_equal(c.queue[0]->topic, PARCEL_STATE);
    assert_int_equal(c.queue[1]->topic, PARCEL_THIN_PICTURE);
    queue(&c, box, PARCEL_PICTURE, 2);
    assert_int_equal(c.count, 2);
    assert_int_equal(c.queue[1]->bytes[8], 2);
    client_free(&c, box);
    outbox_free(box);
}

static void texts_with_a_topic_replace_in_place(void **state) {
    (void)state;
    outbox *box = outbox_new(wake_nobody, NULL);
    client c = {.id = 1};
    queue(&c, box, PARCEL_INFO, 0);
    queue(&c, box, PARCEL_STATE, 0);
    queue(&c, box, PARCEL_INFO, 1);
    queue(&c, box, PARCEL_PLAIN, 0);
    queue(&c, box, PARCEL_PLAIN, 0);
    assert_int_equal(c.count, 4);
    assert_int_equal(c.queue[0]->bytes[8], 1);
    client_free(&c, box);
    outbox_free(box);
}

static void n_is_the_newest_that_a_revision_has(void **state) {
    (void)state;
    client c = {.id = 1};
    for (uint32_t i = 1; i <= 100; i++)
        set_log_note(&c.sets, i, 10 * i);
    assert_int_equal(set_log_n(&c.sets, 1000), 100);
    assert_int_equal(set_log_n(&c.sets, 999), 99);
    assert_int_equal(set_log_n(&c.sets, 371), 37);
    assert_int_equal(set_log_n(&c.sets, 9), 0);
    set_log_note(&c.sets, 101, 1000); /* a refused one */
    assert_int_equal(set_log_n(&c.sets, 1000), 101);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(of_pictures_the_newest_waits),
        cmocka_unit_test(texts_with_a_topic_replace_in_place),
        cmocka_unit_test(n_is_the_newest_that_a_revision_has),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
