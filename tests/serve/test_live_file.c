/* tests/serve/test_live_file.c - which of a simulation's files is the newest,
 * and what stands in it. */
#include "support/support.h"

#include "live_file.h"

#include <fcntl.h>

/* The least PNG that is one for this reader: a head, perhaps a text, data. */
static size_t make_png(unsigned char out[256], const char *text) {
    static const unsigned char head[33] = {
        0x89, 'P', 'N', 'G', 13, 10, 26, 10,  0, 0, 0, 13,
        'I',  'H', 'D', 'R', 0,  0,  2,  128, 0, 0, 1, 224};
    static const unsigned char end[12] = {0, 0, 0, 0, 'I', 'D', 'A', 'T'};
    size_t length = text ? 10 + strlen(text) : 0, at = sizeof head;
    memcpy(out, head, sizeof head);
    if (text) {
        memcpy(out + at, (const unsigned char[]){0, 0, 0}, 3);
        out[at + 3] = (unsigned char)length;
        memcpy(out + at + 4, "tEXtSnowglass", 14);
        memcpy(out + at + 18, text, strlen(text));
        memset(out + at + 8 + length, 0, 4);
        at += 12 + length;
    }
    memcpy(out + at, end, sizeof end);
    return at + sizeof end;
}

static void a_comment_is_read(void **state) {
    (void)state;
    unsigned char bytes[256];
    uint32_t size[2] = {0};
    json_t *told;
    size_t length = make_png(bytes, "{\"step\": 7}");
    assert_true(live_file_read(bytes, length, size, &told));
    assert_int_equal(size[0], 640);
    assert_int_equal(size[1], 480);
    assert_int_equal(json_integer_value(json_object_get(told, "step")), 7);
    json_decref(told);
    length = make_png(bytes, "{\"step\": ");
    assert_true(live_file_read(bytes, length, size, &told));
    assert_null(told);
    length = make_png(bytes, NULL);
    assert_true(live_file_read(bytes, length, size, &told));
    assert_null(told);
}

/* Each is in a block of its own, so that a sanitizer sees what is beyond. */
static void a_file_cut_anywhere_is_no_harm(void **state) {
    (void)state;
    unsigned char bytes[256];
    uint32_t size[2];
    size_t length = make_png(bytes, "{\"step\": 7}");
    for (size_t cut = 0; cut < length; cut++) {
        json_t *told;
        unsigned char *own = memcpy(malloc(cut ? cut : 1), bytes, cut);
        assert_true(live_file_read(own, cut, size, &told) == (cut >= 33));
        json_decref(told);
        free(own);
    }
    for (int byte = 33; byte < 37; byte++) { /* the length of the text */
        json_t *told;
        length = make_png(bytes, "{\"step\": 7}");
        bytes[byte] = 0xff;
        assert_true(live_file_read(bytes, length, size, &told));
        json_decref(told);
    }
}

static void write_file(const char *folder, const char *name, long second) {
    char path[512];
    const struct timespec times[2] = {{.tv_sec = second}, {.tv_sec = second}};
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fputs(name, file);
    fclose(file);
    assert_int_equal(utimensat(AT_FDCWD, path, times, 0), 0);
}

/* Looks at once, whatever the last look took. */
static void next_is(live_files *f, const char *name) {
    size_t length = 0;
    f->next = 0;
    unsigned char *bytes = live_files_next(f, &length);
    if (!name) {
        assert_null(bytes);
        return;
    }
    assert_non_null(bytes);
    assert_int_equal(length, strlen(name));
    assert_memory_equal(bytes, name, length);
    free(bytes);
}

static void the_newest_file_counts(void **state) {
    (void)state;
    char folder[] = "/tmp/snowglass-live-XXXXXX", pattern[64];
    live_files f;
    assert_non_null(mkdtemp(folder));
    snprintf(pattern, sizeof pattern, "%s/u_%%03d.png", folder);
    assert_true(live_files_open(&f, pattern));
    next_is(&f, NULL);
    write_file(folder, "u_005.png", 100);
    write_file(folder, "v_009.png", 200);
    write_file(folder, "u_10.png", 200);
    write_file(folder, "u_010.png.part", 200);
    write_file(folder, "u_-01.png", 200);
    next_is(&f, "u_005.png");
    next_is(&f, NULL);
    write_file(folder, "u_007.png", 100);
    write_file(folder, "u_006.png", 100);
    next_is(&f, "u_007.png");
    write_file(folder, "u_1000.png", 101);
    next_is(&f, "u_1000.png");
    write_file(folder, "u_001.png", 102); /* it has begun again */
    next_is(&f, "u_001.png");
    live_files_close(&f);
    snprintf(pattern, sizeof pattern, "rm -r %s", folder);
    assert_int_equal(system(pattern), 0);
}

static void only_patterns_of_pngs_are_taken(void **state) {
    (void)state;
    static const char *const wrong[] = {"u.png",     "u_%d.jpg", "u_%s.png",
                                        "u_%4d.png", "u_%",      "u_%04",
                                        "%d/u.png",  "",         "u_%099d.png"};
    static const char *const right[] = {"u_%d.png", "%04d.png",
                                        "a/b/u_%01d.png"};
    live_files f;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        assert_false(live_files_open(&f, wrong[i]));
        live_files_close(&f);
    }
    for (size_t i = 0; i < sizeof right / sizeof *right; i++) {
        assert_true(live_files_open(&f, right[i]));
        live_files_close(&f);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_comment_is_read),
        cmocka_unit_test(a_file_cut_anywhere_is_no_harm),
        cmocka_unit_test(the_newest_file_counts),
        cmocka_unit_test(only_patterns_of_pngs_are_taken),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
