/* tests/image/test_movie_names.c - names of numbered files, read from and
 * written by patterns. */
#include "support/support.h"

#include "movie/movie_names.h"

static frame_names read_names(const char *pattern) {
    frame_names names;
    const char *fault = names_read(pattern, &names);
    if (fault)
        fail_msg("%s %s", pattern, fault);
    return names;
}

static void assert_path(const char *pattern, int64_t index,
                        const char *wanted) {
    frame_names names = read_names(pattern);
    char path[PATH_MAX];
    assert_true(names_path(&names, index, path, sizeof path));
    assert_string_equal(path, wanted);
}

static void a_number_stands_where_the_pattern_says(void **state) {
    (void)state;
    assert_path("f_%04d.png", 7, "f_0007.png");
    assert_path("f_%04d.png", 12345, "f_12345.png");
    assert_path("%d", 0, "0");
    assert_path("a/b.c/%09d_x", 42, "a/b.c/000000042_x");
    assert_path("100%%_%01d%%", 3, "100%_3%");
    assert_path("/%02d.npy", 3, "/03.npy");
}

static void a_path_that_does_not_fit_is_none(void **state) {
    (void)state;
    frame_names names = read_names("f_%04d.png");
    char path[11];
    assert_false(names_path(&names, 1, path, 10));
    assert_true(names_path(&names, 1, path, 11));
}

static void what_is_no_pattern_is_refused(void **state) {
    (void)state;
    static const char *const bad[] = {
        "",    "x.png", "%",     "%%",    "%s",      "%n",
        "%4d", "%00d",  "%010d", "%-4d",  "%+d",     "% d",
        "%ld", "%04ld", "%*d",   "%1$d",  "%d%d",    "%04",
        "%x",  "%d/x",  "%%d",   "a%/%d", "%04d%04", "%d_%s.png"};
    frame_names names;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        if (!names_read(bad[i], &names))
            fail_msg("'%s' is taken for a pattern", bad[i]);
    char longest[NAME_MAX + 8];
    memset(longest, 'x', sizeof longest);
    memcpy(longest, "%d", 2);
    longest[sizeof longest - 1] = '\0';
    assert_non_null(names_read(longest, &names));
}

static void a_file_gives_back_its_number(void **state) {
    (void)state;
    frame_names names = read_names("some/f_%03d.png");
    assert_int_equal(names_index(&names, "f_000.png"), 0);
    assert_int_equal(names_index(&names, "f_012.png"), 12);
    assert_int_equal(names_index(&names, "f_1234.png"), 1234);
    static const char *const others[] = {
        "f_12.png",  "f_0123.png", "f_.png",    "f_01a.png",
        "f_012.pn",  "f_012.pngx", "g_012.png", ".f_012.png",
        "f_-12.png", "f_ 12.png",  "",          "f_99999999999999999999.png"};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        assert_int_equal(names_index(&names, others[i]), -1);
    names = read_names("%d");
    assert_int_equal(names_index(&names, "0"), 0);
    assert_int_equal(names_index(&names, "10"), 10);
    assert_int_equal(names_index(&names, "010"), -1);
    assert_int_equal(names_index(&names, ""), -1);
}

static void every_number_comes_back(void **state) {
    (void)state;
    static const char *const patterns[] = {"%d", "a%05db", "%09d", "9%d9"};
    uint64_t random = 3;
    for (size_t p = 0; p < sizeof patterns / sizeof *patterns; p++) {
        frame_names names = read_names(patterns[p]);
        for (int i = 0; i < 1000; i++) {
            int64_t index =
                (int64_t)(support_random(&random) % (UINT64_C(1) << (i % 40)));
            char path[PATH_MAX];
            assert_true(names_path(&names, index, path, sizeof path));
            assert_int_equal(names_index(&names, path), index);
        }
    }
}

static void folders_are_told_apart(void **state) {
    (void)state;
    frame_names names = read_names("%d.png");
    assert_string_equal(names_folder(&names), ".");
    names = read_names("a/b/%d.png");
    assert_string_equal(names_folder(&names), "a/b/");
    assert_true(names_are_meant("a%d"));
    assert_false(names_are_meant("a"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_number_stands_where_the_pattern_says),
        cmocka_unit_test(a_path_that_does_not_fit_is_none),
        cmocka_unit_test(what_is_no_pattern_is_refused),
        cmocka_unit_test(a_file_gives_back_its_number),
        cmocka_unit_test(every_number_comes_back),
        cmocka_unit_test(folders_are_told_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
