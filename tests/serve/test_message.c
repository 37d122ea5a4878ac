/* tests/serve/test_message.c - what a page may say. */
#include "support/support.h"

#include "message.h"

static message read_good(const char *text) {
    message m;
    const char *wrong = message_read(text, strlen(text), &m);
    if (wrong)
        fail_msg("%s: %s", text, wrong);
    return m;
}

static void assert_refused(const char *text, size_t length) {
    message m;
    if (!message_read(text, length, &m))
        fail_msg("'%.60s' is taken", text);
    assert_null(m.tree);
}

static void messages_are_read(void **state) {
    (void)state;
    message m = read_good("{\"t\":\"hello\",\"token\":\"abc\","
                          "\"wants\":[\"jpeg\",\"webp\"]}");
    assert_int_equal(m.kind, MESSAGE_HELLO);
    assert_string_equal(m.token, "abc");
    assert_true(m.webp);
    message_free(&m);
    m = read_good("{\"t\":\"set\",\"step\":4294967295,\"keys\":"
                  "{\"azimuth\":30,\"preset\":null,\"size\":[640,480]}}");
    assert_int_equal(m.kind, MESSAGE_SET);
    assert_int_equal(m.n, UINT32_MAX);
    assert_int_equal(json_object_size(m.keys), 3);
    message_free(&m);
    m = read_good("{\"t\":\"moving\",\"on\":true}");
    assert_true(m.kind == MESSAGE_MOVING && m.on);
    message_free(&m);
    m = read_good("{\"t\":\"ack\",\"n\":17,\"took\":6}");
    assert_true(m.kind == MESSAGE_ACK && m.n == 17 && m.took == 6);
    message_free(&m);
    m = read_good("{\"t\":\"part\"}");
    assert_int_equal(m.kind, MESSAGE_PART);
    message_free(&m);
    m = read_good("{\"t\":\"ask\",\"what\":\"histogram\"}");
    assert_int_equal(m.kind, MESSAGE_ASK);
    assert_string_equal(m.what, "histogram");
    message_free(&m);
}

static void what_is_no_object_is_refused(void **state) {
    (void)state;
    static const char *const bad[] = {"",
                                      "{",
                                      "[]",
                                      "17",
                                      "null",
                                      "\"x\"",
                                      "{}",
                                      "{\"t\":1}",
                                      "{\"t\":\"ack\",\"n\":1}x",
                                      "{\"t\":\"ack\",\"n\":1,\"n\":2}",
                                      "{\"t\":\"ack\",\"n\":NaN}"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_refused(bad[i], strlen(bad[i]));
    assert_refused("{\"t\":\"ask\",\"what\":\"\xff\xfe\"}", 23);
    assert_refused("{\"t\":\"ack\",\"n\":1}\0", 18);
}

/* Nothing is done, and the page gets to know why. */
static void what_says_nothing_is_named(void **state) {
    (void)state;
    static const char *const odd[] = {
        "{\"t\":\"nothing\"}",
        "{\"t\":\"hello\"}",
        "{\"t\":\"hello\",\"token\":1}",
        "{\"t\":\"set\",\"step\":1}",
        "{\"t\":\"set\",\"step\":1,\"keys\":[]}",
        "{\"t\":\"set\",\"step\":-1,\"keys\":{}}",
        "{\"t\":\"set\",\"step\":4294967296,\"keys\":{}}",
        "{\"t\":\"set\",\"step\":1.5,\"keys\":{}}",
        "{\"t\":\"set\",\"keys\":{}}",
        "{\"t\":\"moving\"}",
        "{\"t\":\"moving\",\"on\":1}",
        "{\"t\":\"ack\"}",
        "{\"t\":\"ack\",\"n\":\"1\"}",
        "{\"t\":\"ack\",\"n\":1,\"took\":-1}",
        "{\"t\":\"ack\",\"n\":1,\"took\":0.5}",
        "{\"t\":\"ask\"}",
        "{\"t\":\"ask\",\"what\":1}"};
    for (size_t i = 0; i < sizeof odd / sizeof *odd; i++) {
        message m = read_good(odd[i]);
        if (m.kind != MESSAGE_NONE || !*m.left_out)
            fail_msg("%s is taken", odd[i]);
        message_free(&m);
    }
}

/* Of a key and one that is good, only the other is left. */
static void assert_left_out(const char *key, const char *value) {
    char text[256], wanted[256];
    snprintf(text, sizeof text,
             "{\"t\":\"set\",\"step\":1,\"keys\":{\"zoom\":2,\"%s\":%s}}", key,
             value);
    snprintf(wanted, sizeof wanted, "Left out, as a page cannot set it: %s",
             key);
    message m = read_good(text);
    assert_int_equal(m.kind, MESSAGE_SET);
    assert_string_equal(m.left_out, wanted);
    assert_int_equal(json_object_size(m.keys), 1);
    assert_non_null(json_object_get(m.keys, "zoom"));
    message_free(&m);
}

static void a_page_names_no_file(void **state) {
    (void)state;
    static const char *const foreign[] = {
        "input",   "output",    "depth",   "raw",        "tf",   "dataset",
        "series",  "overwrite", "threads", "isa",        "dims", "type",
        "offset",  "endian",    "spacing", "allow-gaps", "verb", "version",
        "quality", "method",    "config",  "",           "x"};
    for (size_t i = 0; i < sizeof foreign / sizeof *foreign; i++) {
        assert_false(message_may_set(foreign[i]));
        assert_left_out(foreign[i], "null");
    }
    assert_true(message_may_set("azimuth"));
    static const char *const masks[] = {"\"m.nrrd\"", "\"\"", "[]",
                                        "{}",         "1",    "false"};
    for (size_t i = 0; i < 2 * (sizeof masks / sizeof *masks); i++)
        assert_left_out(i % 2 ? "mask" : "overlay", masks[i / 2]);
    message m = read_good("{\"t\":\"set\",\"step\":1,\"keys\":"
                          "{\"mask\":true,\"overlay\":null}}");
    assert_int_equal(json_object_size(m.keys), 2);
    message_free(&m);
}

static void many_names_that_are_left_out_end_in_dots(void **state) {
    (void)state;
    static char text[40000];
    size_t at = (size_t)sprintf(text, "{\"t\":\"set\",\"step\":1,\"keys\":{");
    for (int i = 0; i < 2000; i++)
        at += (size_t)sprintf(text + at, "\"key %d\":0,", i);
    sprintf(text + at, "\"zoom\":3}}");
    message m = read_good(text);
    assert_non_null(strstr(m.left_out, "key 0, key 1, key 2"));
    assert_string_equal(m.left_out + strlen(m.left_out) - 5, ", ...");
    assert_int_equal(json_object_size(m.keys), 1);
    message_free(&m);
    snprintf(text, sizeof text,
             "{\"t\":\"set\",\"step\":1,\"keys\":{\"%0300d\":1}}", 7);
    m = read_good(text);
    assert_string_equal(m.left_out, "Left out, as a page cannot set it: ...");
    message_free(&m);
}

static void pictures_have_a_largest_size(void **state) {
    (void)state;
    static const char *const sizes[] = {"[0,10]", "[10,4097]", "[4097,10]",
                                        "[10]",   "[1,2,3]",   "\"10x10\"",
                                        "512",    "[1.5,2]",   "null"};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        assert_left_out("size", sizes[i]);
    message m =
        read_good("{\"t\":\"set\",\"step\":1,\"keys\":{\"size\":[4096,4096]}}");
    assert_int_equal(json_object_size(m.keys), 1);
    message_free(&m);
}

/* A message with arrays of a depth in an unknown key. */
static size_t write_deep(char *text, int depth) {
    size_t at = (size_t)sprintf(text, "{\"t\":\"ack\",\"n\":1,\"x\":");
    for (int i = 0; i < depth; i++)
        text[at++] = '[';
    for (int i = 0; i < depth; i++)
        text[at++] = ']';
    text[at++] = '}';
    return at;
}

static void nesting_has_a_limit(void **state) {
    (void)state;
    static char text[200000];
    message m;
    assert_null(message_read(text, write_deep(text, 8 - 1), &m));
    message_free(&m);
    assert_refused(text, write_deep(text, 8));
    memset(text, '{', 3000);
    assert_refused(text, 3000);
    /* Brackets in texts do not count. */
    const char *quoted = "{\"t\":\"ask\",\"what\":\"[[[[[[[[[[[\\\"[[{{\"}";
    m = read_good(quoted);
    message_free(&m);
}

static void length_has_a_limit(void **state) {
    (void)state;
    static char text[MESSAGE_BYTES + 2];
    message m;
    size_t at = (size_t)sprintf(text, "{\"t\":\"ask\",\"what\":\"");
    memset(text + at, 'x', sizeof text - at);
    memcpy(text + MESSAGE_BYTES - 2, "\"}", 2);
    assert_null(message_read(text, MESSAGE_BYTES, &m));
    message_free(&m);
    memcpy(text + MESSAGE_BYTES - 2, "x\"}", 3);
    assert_refused(text, MESSAGE_BYTES + 1);
}

static void the_head_of_a_picture_is_little_endian(void **state) {
    (void)state;
    unsigned char head[FRAME_HEAD_BYTES];
    const frame_head from = {.n = 0x01020304,
                             .level = 2,
                             .kind = FRAME_PNG,
                             .pane = 7,
                             .width = 640,
                             .height = 480,
                             .render_us = 70000,
                             .pack_us = 5};
    static const unsigned char wanted[FRAME_HEAD_BYTES] = {
        'S',  'N', 'W', '1', 4,    3,    2, 1, 2,    2,    7, 0, 0, 0, 0, 0,
        0x80, 2,   0,   0,   0xe0, 0x01, 0, 0, 0x70, 0x11, 1, 0, 5, 0, 0, 0};
    frame_head_write(&from, head);
    assert_memory_equal(head, wanted, sizeof head);
    frame_head_set_n(head, 9);
    assert_int_equal(head[4] | head[5] | head[6] | head[7], 9);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(messages_are_read),
        cmocka_unit_test(what_is_no_object_is_refused),
        cmocka_unit_test(what_says_nothing_is_named),
        cmocka_unit_test(a_page_names_no_file),
        cmocka_unit_test(many_names_that_are_left_out_end_in_dots),
        cmocka_unit_test(pictures_have_a_largest_size),
        cmocka_unit_test(nesting_has_a_limit),
        cmocka_unit_test(length_has_a_limit),
        cmocka_unit_test(the_head_of_a_picture_is_little_endian),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
