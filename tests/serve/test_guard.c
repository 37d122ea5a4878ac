/* tests/serve/test_guard.c - who may talk to the viewer. */
#include "support/support.h"

#include "net/guard.h"

static guard guard_of(int port, const char *list) {
    guard g = {.token = "0123456789abcdef0123456789abcdef"};
    guard_allow_own(&g, port);
    if (list)
        assert_true(guard_allow(&g, list));
    return g;
}

static void a_host_is_one_of_the_names(void **state) {
    (void)state;
    static const struct {
        const char *host;
        bool good;
    } rows[] = {{"127.0.0.1:8000", true},
                {"localhost:8000", true},
                {"LOCALHOST:8000", true},
                {"[::1]:8000", true},
                {"viewer.example.org", true},
                {"node7:9000", true},
                {NULL, false},
                {"", false},
                {"127.0.0.1", false},
                {"localhost", false},
                {"127.0.0.1:8001", false},
                {"127.0.0.1:80000", false},
                {"127.0.0.1:8000 ", false},
                {" 127.0.0.1:8000", false},
                {"127.0.0.1:8000.evil.org", false},
                {"evil.org", false},
                {"evil.org:8000", false},
                {"localhost.evil.org:8000", false},
                {"::1:8000", false},
                {"0.0.0.0:8000", false},
                {"2130706433:8000", false},
                {"node7", false},
                {"node7:9001", false},
                {"viewer.example.org:80", false},
                {"viewer.example.org.", false}};
    guard g = guard_of(8000, "viewer.example.org,node7:9000");
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (guard_host(&g, rows[i].host) != rows[i].good)
            fail_msg("'%s' is judged wrongly", rows[i].host);
}

static void port_80_is_left_out(void **state) {
    (void)state;
    guard g = guard_of(80, NULL);
    assert_true(guard_host(&g, "127.0.0.1"));
    assert_true(guard_host(&g, "localhost:80"));
    assert_true(guard_origin(&g, "http://[::1]", "[::1]"));
    assert_false(guard_origin(&g, "https://localhost", "localhost"));
    assert_false(guard_host(&g, "localhost:8000"));
    assert_false(guard_host(&g, "evil.org"));
}

static void an_origin_is_that_of_an_allowed_page(void **state) {
    (void)state;
    static const struct {
        const char *origin;
        bool good;
    } rows[] = {{"http://127.0.0.1:8000", true},
                {"http://localhost:8000", true},
                {"http://[::1]:8000", true},
                {"http://viewer.example.org", true},
                {"https://viewer.example.org", true},
                {NULL, false},
                {"", false},
                {"null", false},
                {"https://127.0.0.1:8000", false},
                {"http://127.0.0.1", false},
                {"http://127.0.0.1:8001", false},
                {"http://127.0.0.1:8000/", false},
                {"http://evil.org", false},
                {"http://127.0.0.1:8000@evil.org", false},
                {"http://viewer.example.org.evil.org", false},
                {"ws://127.0.0.1:8000", false},
                {"file://", false},
                {"127.0.0.1:8000", false}};
    guard g = guard_of(8000, "viewer.example.org");
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (guard_origin(&g, rows[i].origin, "127.0.0.1:8000") != rows[i].good)
            fail_msg("'%s' is judged wrongly", rows[i].origin);
}

static void a_unix_socket_has_any_port_but_one_page(void **state) {
    (void)state;
    guard g = guard_of(0, NULL);
    assert_true(guard_host(&g, "localhost:1234"));
    assert_true(guard_host(&g, "localhost"));
    assert_true(guard_host(&g, "[::1]:1234"));
    assert_false(guard_host(&g, "evil.org:1234"));
    assert_false(guard_host(&g, "localhost:evil"));
    assert_true(guard_origin(&g, "http://localhost:1234", "localhost:1234"));
    assert_false(guard_origin(&g, "http://localhost:1235", "localhost:1234"));
    assert_false(guard_origin(&g, "http://127.0.0.1:1234", "localhost:1234"));
    assert_false(guard_origin(&g, "http://localhost:1234", NULL));
}

static void only_the_whole_secret_opens(void **state) {
    (void)state;
    guard g = guard_of(8000, NULL);
    const char *token = "0123456789abcdef0123456789abcdef";
    char longer[300];
    assert_true(guard_token(&g, token, 32));
    assert_false(guard_token(&g, token, 31));
    assert_false(guard_token(&g, "", 0));
    assert_false(guard_token(&g, "1123456789abcdef0123456789abcdef", 32));
    assert_false(guard_token(&g, "0123456789abcdef0123456789abcdeF", 32));
    memset(longer, '0', sizeof longer);
    memcpy(longer, token, 32);
    assert_false(guard_token(&g, longer, sizeof longer));
    assert_false(guard_token(&g, longer, 33));
    memcpy(longer + 32, token, 32); /* the secret twice */
    assert_false(guard_token(&g, longer, 64));
    g.token[0] = '\0'; /* no secret opens nothing */
    assert_false(guard_token(&g, "", 0));
}

static void a_secret_is_long_and_plain(void **state) {
    (void)state;
    char longest[GUARD_TOKEN_MOST + 2];
    assert_true(guard_is_token("abcdefghij-KLM_0"));
    assert_false(guard_is_token("abcdefghij-KLM_"));
    assert_false(guard_is_token("abcdefghij KLM_0"));
    assert_false(guard_is_token("abcdefghij&KLM_0"));
    memset(longest, 'x', sizeof longest);
    longest[GUARD_TOKEN_MOST] = '\0';
    assert_true(guard_is_token(longest));
    longest[GUARD_TOKEN_MOST] = 'x';
    longest[GUARD_TOKEN_MOST + 1] = '\0';
    assert_false(guard_is_token(longest));
}

static void lists_of_names_are_names(void **state) {
    (void)state;
    guard g = {.count = 0};
    assert_false(guard_allow(&g, ""));
    assert_false(guard_allow(&g, "a,,b"));
    assert_false(guard_allow(&g, "http://a"));
    assert_false(guard_allow(&g, "a b"));
    g.count = 0;
    assert_true(guard_allow(&g, "a,b:1,[::2]:3"));
    assert_int_equal(g.count, 3);
    for (int i = 3; i < GUARD_HOSTS_MOST; i++)
        assert_true(guard_allow(&g, "x"));
    assert_false(guard_allow(&g, "x"));
}

static void origins_of_frames_are_origins(void **state) {
    (void)state;
    static const char *const good[] = {"https://hub.example.org",
                                       "http://127.0.0.1:8888",
                                       "vscode-webview://0abc-1"};
    static const char *const bad[] = {"",
                                      "*",
                                      "https:",
                                      "https://",
                                      "//a.org",
                                      "a.org",
                                      "https://a.org/",
                                      "https://a.org/x",
                                      "https://*",
                                      "https://a b",
                                      "https://a;b",
                                      "https://a:",
                                      "https://a:x",
                                      "https://a:123456",
                                      "'self'",
                                      "https://a@b",
                                      "https://a\r\nb",
                                      "1s://a",
                                      "https://a,",
                                      "https://a,,https://b",
                                      "https://a,*",
                                      "https://a:80/",
                                      "http s://a",
                                      "https://[::1]:80"};
    guard g;
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        g = guard_of(8000, NULL);
        assert_true(guard_embed(&g, good[i]));
        assert_string_equal(g.around, good[i]);
    }
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        g = guard_of(8000, NULL);
        if (guard_embed(&g, bad[i]))
            fail_msg("%s", bad[i]);
    }
    assert_true(guard_embed(&g, "https://a.org,http://b:1"));
    assert_string_equal(g.around, "https://a.org http://b:1");
}

static void a_list_of_origins_has_an_end(void **state) {
    (void)state;
    guard g = guard_of(8000, NULL);
    char list[GUARD_AROUND_BYTES + 1];
    memset(list, 'a', sizeof list - 1);
    memcpy(list, "https://", 8);
    list[GUARD_AROUND_BYTES] = '\0';
    assert_false(guard_embed(&g, list));
    list[GUARD_AROUND_BYTES - 1] = '\0';
    assert_false(guard_embed(&g, list));
    list[GUARD_AROUND_BYTES - 2] = '\0';
    assert_true(guard_embed(&g, list));
    assert_string_equal(g.around, list);
}

static void a_page_is_the_last_part_of_a_path(void **state) {
    (void)state;
    assert_string_equal(guard_page("/"), "");
    assert_string_equal(guard_page("/viewer.js"), "viewer.js");
    assert_string_equal(guard_page("/node/n7/8000/viewer.js"), "viewer.js");
    assert_string_equal(guard_page("/../../etc/passwd"), "passwd");
    assert_null(guard_page("viewer.js"));
    assert_null(guard_page(""));
    assert_null(guard_page(NULL));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_host_is_one_of_the_names),
        cmocka_unit_test(port_80_is_left_out),
        cmocka_unit_test(an_origin_is_that_of_an_allowed_page),
        cmocka_unit_test(a_unix_socket_has_any_port_but_one_page),
        cmocka_unit_test(only_the_whole_secret_opens),
        cmocka_unit_test(a_secret_is_long_and_plain),
        cmocka_unit_test(lists_of_names_are_names),
        cmocka_unit_test(origins_of_frames_are_origins),
        cmocka_unit_test(a_list_of_origins_has_an_end),
        cmocka_unit_test(a_page_is_the_last_part_of_a_path),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
