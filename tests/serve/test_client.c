/* tests/serve/test_client.c - what waits for one page. */
#include "support/support.h"

#include "message.h"
#include "net/client.h"

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

/* A clock that the test moves. */
static lws_usec_t now = 1000000;

lws_usec_t lws_now_usecs(void) {
    return now;
}

static void wake_nobody(void *user) {
    (void)user;
}

/* The page, and what it is sent through, of each test. */
static outbox *box;
static client c;

static int begin_client(void **state) {
    (void)state;
    box = outbox_new(wake_nobody, NULL);
    c = (client){.id = 1};
    return 0;
}

static int end_client(void **state) {
    (void)state;
    client_free(&c, box);
    outbox_free(box);
    return 0;
}

static void queue_long(client *to, message_topic topic, int level,
                       size_t length) {
    outgoing *p = outgoing_new(length);
    assert_non_null(p);
    memset(p->bytes, 0, length);
    p->topic = topic;
    p->bytes[8] = (unsigned char)level;
    client_queue(to, box, p);
    outgoing_release(box, p);
}

static void queue(client *to, message_topic topic, int level) {
    queue_long(to, topic, level, FRAME_HEAD_BYTES);
}

/* Sends what waits. */
static void send_all(client *to) {
    while (client_has_more(to))
        assert_true(client_send(to, box));
}

/* The quality after pictures of a length, each of which takes a time. */
static int quality_after(client *to, int pictures, size_t length, int ms) {
    for (int i = 0; i < pictures; i++) {
        queue_long(to, MESSAGE_PICTURE, 0, length);
        send_all(to);
        now += 1000 * ms;
        client_acknowledge(to, 0);
    }
    return client_quality(to);
}

static void quality_follows_the_trips(void **state) {
    (void)state;
    static const struct {
        size_t length;
        int ms, quality;
    } rows[] = {
        {20000, 10, 90},  /* this machine */
        {50000, 10, 75},  /* more would have more than 60 kB */
        {35000, 10, 90},  /* until the pictures are larger */
        {90000, 10, 75},  /* as those of a large window are */
        {20000, 60, 75},  /* a link of some length */
        {20000, 200, 75}, /* between two steps: none is taken */
        {20000, 300, 50}, /* a slow one */
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        c = (client){.id = 1};
        assert_int_equal(client_quality(&c), 75);
        assert_int_equal(quality_after(&c, 100, rows[i].length, rows[i].ms),
                         rows[i].quality);
    }
}

static void quality_goes_step_by_step_and_stays(void **state) {
    (void)state;
    static const struct {
        int pictures, ms, quality;
    } rows[] = {
        {7, 400, 75},  {1, 400, 62},  {7, 400, 62}, {1, 400, 50},
        {40, 200, 50}, {40, 130, 50}, /* not quick enough for more */
        {40, 100, 75}, {40, 240, 75}, /* as between all steps */
        {1, 2000, 62},                /* very late */
        {60, 20, 90},  {40, 90, 90},  {8, 200, 85},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        assert_int_equal(quality_after(&c, rows[i].pictures, 20000, rows[i].ms),
                         rows[i].quality);
    quality_after(&c, 40, 20000, 10);
    assert_int_equal(quality_after(&c, 8, 70000, 10), 85);
    assert_int_equal(quality_after(&c, 40, 70000, 10), 75);
}

/* The picture at rest is large, and what waits behind it is late. */
static void pictures_at_rest_do_not_count(void **state) {
    (void)state;
    for (int i = 0; i < 40; i++) {
        queue(&c, MESSAGE_PICTURE, 2);
        send_all(&c);
        queue(&c, MESSAGE_PICTURE, 0);
        send_all(&c);
        now += 900000;
        client_acknowledge(&c, 0);
        queue(&c, MESSAGE_PICTURE, 0); /* counts, behind one that does not */
        send_all(&c);
        client_acknowledge(&c, 0);
        now += 60000;
        client_acknowledge(&c, 0);
        client_acknowledge(&c, 0); /* of nothing */
    }
    assert_int_equal(client_quality(&c), 75);
    assert_true(c.trip > 0.059 && c.trip < 0.061);
    assert_int_equal(c.under_way, 0);
}

/* Whether pictures have to be packed in another way is known at once. */
static void a_change_of_quality_is_told(void **state) {
    (void)state;
    for (int i = 1; i <= 16; i++) {
        queue(&c, MESSAGE_PICTURE, 0);
        send_all(&c);
        now += 400000;
        assert_int_equal(client_acknowledge(&c, 0), i % 8 == 0);
    }
}

static void of_pictures_the_newest_waits(void **state) {
    (void)state;
    c.thin = true;
    queue(&c, MESSAGE_PICTURE, 2);
    queue(&c, MESSAGE_STATE, 0);
    queue(&c, MESSAGE_THIN_PICTURE, 0);
    queue(&c, MESSAGE_PICTURE, 0); /* for other links */
    assert_int_equal(c.count, 2);
    assert_int_equal(c.queue[0]->topic, MESSAGE_STATE);
    assert_int_equal(c.queue[1]->topic, MESSAGE_THIN_PICTURE);
    queue(&c, MESSAGE_PICTURE, 2);
    assert_int_equal(c.count, 2);
    assert_int_equal(c.queue[1]->bytes[8], 2);
}

static void texts_with_a_topic_replace_in_place(void **state) {
    (void)state;
    queue(&c, MESSAGE_INFO, 0);
    queue(&c, MESSAGE_STATE, 0);
    queue(&c, MESSAGE_INFO, 1);
    queue(&c, MESSAGE_PLAIN, 0);
    queue(&c, MESSAGE_PLAIN, 0);
    assert_int_equal(c.count, 4);
    assert_int_equal(c.queue[0]->bytes[8], 1);
}

/* The page forgets a state and a look that come before the volume's name. */
static void of_another_volume_its_name_comes_first(void **state) {
    (void)state;
    queue(&c, MESSAGE_LOOK, 0);
    queue(&c, MESSAGE_STATE, 0);
    queue(&c, MESSAGE_INFO, 1);
    queue(&c, MESSAGE_LOOK, 1);
    queue(&c, MESSAGE_STATE, 1);
    assert_int_equal(c.count, 3);
    assert_int_equal(c.queue[0]->topic, MESSAGE_INFO);
    assert_int_equal(c.queue[1]->topic, MESSAGE_LOOK);
    assert_int_equal(c.queue[2]->topic, MESSAGE_STATE);
    for (int i = 0; i < c.count; i++)
        assert_int_equal(c.queue[i]->bytes[8], 1);
}

static void n_is_the_newest_that_a_revision_has(void **state) {
    (void)state;
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
    for (int i = 1; i <= CLIENT_UNDER_WAY; i++) {
        queue(&c, MESSAGE_PICTURE, 0);
        assert_true(client_has_more(&c));
        assert_true(client_send(&c, box));
        assert_int_equal(c.under_way, i);
    }
    queue(&c, MESSAGE_PICTURE, 0);
    queue(&c, MESSAGE_PICTURE, 1);
    assert_false(client_has_more(&c));
    int before = written.count;
    assert_true(client_send(&c, box));
    assert_int_equal(written.count, before);
    queue(&c, MESSAGE_PLAIN, 0); /* which waits for no picture */
    assert_true(client_has_more(&c));
    assert_true(client_send(&c, box));
    assert_int_equal(written.count, before + 1);
    assert_int_equal(c.under_way, CLIENT_UNDER_WAY);
    client_acknowledge(&c, 0);
    assert_true(client_has_more(&c));
    assert_true(client_send(&c, box));
    assert_int_equal(written.head[8], 1); /* the newer one */
    assert_int_equal(c.under_way, CLIENT_UNDER_WAY);
    for (int i = 0; i < 5; i++)
        client_acknowledge(&c, 0);
    assert_int_equal(c.under_way, 0);
}

/* On a thin link: a few at a time, and the rest not at all where another
 * picture follows. */
static void
the_picture_at_rest_goes_in_parts_that_can_be_dropped(void **state) {
    (void)state;
    const size_t bytes = 5 * CLIENT_PART_BYTES + 100;
    c = (client){.id = 1, .webp = true, .thin = true, .blocked = 1};
    queue_long(&c, MESSAGE_PICTURE, 2, FRAME_HEAD_BYTES + bytes);
    int before = written.count;
    send_all(&c);
    assert_int_equal(written.count, before + CLIENT_PARTS_MOST);
    assert_int_equal(written.how, LWS_WRITE_BINARY);
    assert_int_equal(written.head[11], FRAME_NEXT);
    assert_int_equal(written.head[12] | written.head[13] << 8 |
                         written.head[14] << 16,
                     bytes);
    queue(&c, MESSAGE_STATE, 0);
    assert_false(client_has_more(&c));
    for (int i = CLIENT_PARTS_MOST; i < 6; i++) {
        client_note_part(&c);
        send_all(&c);
    }
    assert_int_equal(written.count, before + 6 + 1); /* the state behind it */
    assert_int_equal(c.under_way, 1);
    client_acknowledge(&c, 0);
    for (int i = 0; i < 9; i++)
        client_note_part(&c);

    queue_long(&c, MESSAGE_PICTURE, 2, FRAME_HEAD_BYTES + bytes);
    before = written.count;
    assert_true(client_send(&c, box));
    assert_int_equal(written.head[11], FRAME_FIRST);
    queue(&c, MESSAGE_THIN_PICTURE, 0);
    send_all(&c);
    assert_int_equal(written.count, before + 2);
    assert_int_equal(written.head[11], 0);
    assert_int_equal(c.under_way, 1);
    assert_false(client_has_more(&c));
}

static void a_picture_goes_in_pieces_with_the_own_n(void **state) {
    (void)state;
    outgoing *p = outgoing_new(2 * CLIENT_PIECE_BYTES + 100);
    assert_non_null(p);
    memset(p->bytes, 0, p->length);
    p->topic = MESSAGE_PICTURE;
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
        queue(&c, MESSAGE_PLAIN, 0); /* which comes between no pieces */
    }
    assert_int_equal(written.all, p->length);
    assert_int_equal(written.length, 100);
    assert_int_equal(p->bytes[4], 0); /* others share it */
    assert_null(c.sending);
    outgoing_release(box, p);
}

static void a_link_is_thin_while_pictures_wait(void **state) {
    (void)state;
    client plain = {.id = 2};
    c.webp = true;
    int changes = 0;
    for (int i = 0; i < 10; i++) {
        queue(&c, c.thin ? MESSAGE_THIN_PICTURE : MESSAGE_PICTURE, 0);
        queue(&plain, MESSAGE_PICTURE, 0);
        changes += client_acknowledge(&c, 0);
        assert_false(client_acknowledge(&plain, 0)); /* it cannot show WebP */
    }
    assert_true(c.thin);
    send_all(&c);
    for (int i = 0; i < 40; i++)
        changes += client_acknowledge(&c, 0);
    assert_false(c.thin);
    assert_int_equal(changes, 2);
    client_free(&plain, box);
}

/* Trips of 60 ms, of which the page takes so many to paint; another picture
 * waits at the end of each. */
static void make_trips(int painted) {
    for (int i = 0; i < 40; i++) {
        message_topic topic = c.thin ? MESSAGE_THIN_PICTURE : MESSAGE_PICTURE;
        queue(&c, topic, 0);
        send_all(&c);
        now += 60000;
        queue(&c, topic, 0);
        client_acknowledge(&c, 1e-3 * painted);
    }
}

static void a_slow_page_has_no_thin_link(void **state) {
    (void)state;
    c.webp = true;
    make_trips(40);
    assert_false(c.thin);
    make_trips(10);
    assert_true(c.thin);
    make_trips(40);
    assert_false(c.thin);
}

/* What it cannot paint yet would grow old there. */
static void a_slow_page_has_one_picture_under_way(void **state) {
    (void)state;
    static const struct {
        int painted, most;
    } cases[] = {{55, 1}, {10, CLIENT_UNDER_WAY}};
    for (int i = 0; i < 2; i++) {
        make_trips(cases[i].painted);
        for (int k = 0; k <= CLIENT_UNDER_WAY; k++) {
            queue(&c, MESSAGE_PICTURE, 0);
            send_all(&c);
        }
        assert_int_equal(c.under_way, cases[i].most);
    }
}

static void too_much_that_waits_is_noted(void **state) {
    (void)state;
    for (int i = 0; i < CLIENT_QUEUE_MOST; i++)
        queue(&c, MESSAGE_PLAIN, 0);
    assert_false(c.too_slow);
    queue(&c, MESSAGE_PLAIN, 0);
    assert_true(c.too_slow);
    assert_int_equal(c.count, CLIENT_QUEUE_MOST);
}

static void a_message_in_pieces_has_a_limit(void **state) {
    (void)state;
    static const char piece[MESSAGE_BYTES / 2];
    assert_int_equal(client_collect(&c, "ab", 2, false), 0);
    assert_int_equal(client_collect(&c, "cd", 2, true), 1);
    assert_int_equal(c.used, 4);
    assert_memory_equal(c.text, "abcd", 4);
    c.used = 0;
    assert_int_equal(client_collect(&c, piece, sizeof piece, false), 0);
    assert_int_equal(client_collect(&c, piece, sizeof piece, false), 0);
    assert_int_equal(client_collect(&c, "x", 1, true), -1);
}

#define TEST(name) \
    cmocka_unit_test_setup_teardown(name, begin_client, end_client)

int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(of_pictures_the_newest_waits),
        TEST(texts_with_a_topic_replace_in_place),
        TEST(of_another_volume_its_name_comes_first),
        TEST(n_is_the_newest_that_a_revision_has),
        TEST(two_pictures_are_under_way),
        TEST(the_picture_at_rest_goes_in_parts_that_can_be_dropped),
        TEST(a_picture_goes_in_pieces_with_the_own_n),
        TEST(a_link_is_thin_while_pictures_wait),
        TEST(a_slow_page_has_no_thin_link),
        TEST(a_slow_page_has_one_picture_under_way),
        TEST(too_much_that_waits_is_noted),
        TEST(a_message_in_pieces_has_a_limit),
        TEST(quality_follows_the_trips),
        TEST(quality_goes_step_by_step_and_stays),
        TEST(pictures_at_rest_do_not_count),
        TEST(a_change_of_quality_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
