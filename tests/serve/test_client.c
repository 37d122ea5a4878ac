/* tests/serve/test_client.c - what waits for one page. */
#include "support/support.h"

#include "message.c"
#include "outbox.c"

#include "net/client.c"

/* No socket is written to here: what would be is noted. */
static struct {
    unsigned char head[FRAME_HEAD_BYTES];
    size_t length, all;
    int how, count;
} written;

int lws_write(struct lws *wsi, unsigned char *bytes, size_t length,
              enum lws_write_protocol how) {
    (void)wsi;
    memcpy(written.head, bytes, length < 32 ? length : 32);
    written.length = length;
    written.all += length;
    written.how = (int)how;
    written.count++;
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

static void two_pictures_are_under_way(void **state) {
    (void)state;
    outbox *box = outbox_new(wake_nobody, NULL);
    client c = {.id = 1};
    for (int i = 1; i <= CLIENT_UNDER_WAY; i++) {
        queue(&c, box, PARCEL_PICTURE, 0);
        assert_true(client_has_more(&c));
        assert_true(client_send(&c, box));
        assert_int_equal(c.under_way, i);
    }
    queue(&c, box, PARCEL_PICTURE, 0);
    queue(&c, box, PARCEL_PICTURE, 1);
    assert_false(client_has_more(&c));
    int before = written.count;
    assert_true(client_send(&c, box));
    assert_int_equal(written.count, before);
    queue(&c, box, PARCEL_PLAIN, 0); /* which waits for no picture */
    assert_true(client_has_more(&c));
    assert_true(client_send(&c, box));
    assert_int_equal(written.count, before + 1);
    assert_int_equal(c.under_way, CLIENT_UNDER_WAY);
    client_acknowledge(&c);
    assert_true(client_has_more(&c));
    assert_true(client_send(&c, box));
    assert_int_equal(written.head[8], 1); /* the newer one */
    assert_int_equal(c.under_way, CLIENT_UNDER_WAY);
    for (int i = 0; i < 5; i++)
        client_acknowledge(&c);
    assert_int_equal(c.under_way, 0);
    client_free(&c, box);
    outbox_free(box);
}

static void a_picture_goes_in_pieces_with_the_own_n(void **state) {
    (void)state;
    outbox *box = outbox_new(wake_nobody, NULL);
    client c = {.id = 1};
    parcel *p = parcel_new(2 * PIECE_BYTES + 100);
    assert_non_null(p);
    memset(p->bytes, 0, p->length);
    p->topic = PARCEL_PICTURE;
    p->revision = 7;
    set_log_note(&c.sets, 42, 7);
    client_queue(&c, box, p);
    written.all = 0;
    static const int wanted[] = {LWS_WRITE_BINARY | LWS_WRITE_NO_FIN,
                                 LWS_WRITE_CONTINUATION | LWS_WRITE_NO_FIN,
                                 LWS_WRITE_CONTINUATION};
    for (int i = 0; i < 3; i++) {
        assert_true(client_has_more(&c));
        assert_true(client_send(&c, box));
        assert_int_equal(written.how, wanted[i]);
        if (i == 0)
            assert_int_equal(written.head[4], 42);
        queue(&c, box, PARCEL_PLAIN, 0); /* which comes between no pieces */
    }
    assert_int_equal(written.all, p->length);
    assert_int_equal(written.length, 100);
    assert_int_equal(p->bytes[4], 0); /* others share it */
    assert_null(c.sending);
    parcel_release(box, p);
    client_free(&c, box);
    outbox_free(box);
}

static void a_link_is_thin_while_pictures_wait(void **state) {
    (void)state;
    outbox *box = outbox_new(wake_nobody, NULL);
    client c = {.id = 1, .webp = true}, plain = {.id = 2};
    int changes = 0;
    for (int i = 0; i < 10; i++) {
        queue(&c, box, c.thin ? PARCEL_THIN_PICTURE : PARCEL_PICTURE, 0);
        queue(&plain, box, PARCEL_PICTURE, 0);
        changes += client_acknowledge(&c);
        assert_false(client_acknowledge(&plain)); /* it cannot show WebP */
    }
    assert_true(c.thin);
    forget_pictures(&c, box);
    for (int i = 0; i < 40; i++)
        changes += client_acknowledge(&c);
    assert_false(c.thin);
    assert_int_equal(changes, 2);
    client_free(&c, box);
    client_free(&plain, box);
    outbox_free(box);
}

static void too_much_that_waits_is_noted(void **state) {
    (void)state;
    outbox *box = outbox_new(wake_nobody, NULL);
    client c = {.id = 1};
    for (int i = 0; i < CLIENT_QUEUE_MOST; i++)
        queue(&c, box, PARCEL_PLAIN, 0);
    assert_false(c.too_slow);
    queue(&c, box, PARCEL_PLAIN, 0);
    assert_true(c.too_slow);
    assert_int_equal(c.count, CLIENT_QUEUE_MOST);
    client_free(&c, box);
    outbox_free(box);
}

static void a_message_in_pieces_has_a_limit(void **state) {
    (void)state;
    outbox *box = outbox_new(wake_nobody, NULL);
    client c = {.id = 1};
    static const char piece[MESSAGE_BYTES / 2];
    assert_int_equal(client_collect(&c, "ab", 2, false), 0);
    assert_int_equal(client_collect(&c, "cd", 2, true), 1);
    assert_int_equal(c.used, 4);
    assert_memory_equal(c.text, "abcd", 4);
    c.used = 0;
    assert_int_equal(client_collect(&c, piece, sizeof piece, false), 0);
    assert_int_equal(client_collect(&c, piece, sizeof piece, false), 0);
    assert_int_equal(client_collect(&c, "x", 1, true), -1);
    client_free(&c, box);
    outbox_free(box);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(of_pictures_the_newest_waits),
        cmocka_unit_test(texts_with_a_topic_replace_in_place),
        cmocka_unit_test(n_is_the_newest_that_a_revision_has),
        cmocka_unit_test(two_pictures_are_under_way),
        cmocka_unit_test(a_picture_goes_in_pieces_with_the_own_n),
        cmocka_unit_test(a_link_is_thin_while_pictures_wait),
        cmocka_unit_test(too_much_that_waits_is_noted),
        cmocka_unit_test(a_message_in_pieces_has_a_limit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
