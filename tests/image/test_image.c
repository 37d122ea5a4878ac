/* tests/image/test_image.c - pictures in memory, and the saving and loading
 * that all formats share. */
#include "support/image.h"

#include <fcntl.h>
#include <math.h>
#include <unistd.h>

static const char *const suffixes[] = {".png", ".npy", ".pfm"};

static void a_new_picture_is_transparent(void **state) {
    image_fixture *f = *state;
    snow_image *image = support_blank(f->context, 3, 2, 4);
    assert_int_equal(snow_image_width(image), 3);
    assert_int_equal(snow_image_height(image), 2);
    assert_int_equal(snow_image_channels(image), 4);
    for (int i = 0; i < 24; i++)
        assert_true(snow_image_pixels(image)[i] == 0);
    snow_image_free(image);
    snow_image_free(NULL);
}

static void impossible_pictures_are_refused(void **state) {
    image_fixture *f = *state;
    static const int bad[][3] = {{0, 1, 4},  {1, 0, 4},     {-5, 3, 4},
                                 {1, 1, 3},  {1, 1, 0},     {32769, 1, 4},
                                 {1, 1, -2}, {1, 32769, 4}, {1, 1, 5}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        snow_image *image = NULL;
        assert_int_equal(
            snow_image_new(f->context, bad[i][0], bad[i][1], bad[i][2], &image),
            SNOW_STATUS_BAD_USAGE);
        assert_null(image);
    }
}

static void the_longest_sides_are_possible(void **state) {
    image_fixture *f = *state;
    snow_image *image = support_blank(f->context, 32768, 1, 2);
    snow_image_free(image);
    assert_int_equal(snow_image_new(f->context, 1, 32768, 4, &image),
                     SNOW_STATUS_OK);
    snow_image_free(image);
}

/* The sums were computed by a few lines of Python from FNV's definition. */
static void check_sums_are_fnv_1a(void **state) {
    image_fixture *f = *state;
    snow_image *image = support_blank(f->context, 2, 1, 2);
    memcpy(snow_image_pixels(image), (float[]){0.5f, 1, 0, -2.25f},
           4 * sizeof(float));
    assert_true(snow_image_checksum(image) == UINT64_C(0xab3124db87522db4));
    snow_image_free(image);
    assert_int_equal(snow_image_new(f->context, 1, 1, 4, &image),
                     SNOW_STATUS_OK);
    snow_image_pixels(image)[1] = NAN;
    assert_true(snow_image_checksum(image) == UINT64_C(0x375c5ca5bfc5f72c));
    snow_image_free(image);
}

static void equal_pictures_have_equal_sums(void **state) {
    image_fixture *f = *state;
    snow_image *a = support_picture(f->context, 5, 4, 4, 7);
    snow_image *b = support_picture(f->context, 5, 4, 4, 7);
    uint64_t sum = snow_image_checksum(a);
    assert_true(sum == snow_image_checksum(b));
    snow_image_pixels(a)[0] = 0.0f;
    snow_image_pixels(b)[0] = -0.0f;
    assert_true(snow_image_checksum(a) == snow_image_checksum(b));
    snow_image_pixels(a)[4] = NAN;
    snow_image_pixels(b)[4] = -NAN;
    assert_true(snow_image_checksum(a) == snow_image_checksum(b));
    snow_image_pixels(b)[79] += 1e-7f;
    assert_true(snow_image_checksum(a) != snow_image_checksum(b));
    snow_image_free(a);
    snow_image_free(b);
}

static void the_shape_enters_the_check_sum(void **state) {
    image_fixture *f = *state;
    snow_image *wide = support_blank(f->context, 4, 2, 2);
    snow_image *high = support_blank(f->context, 2, 4, 2);
    assert_true(snow_image_checksum(wide) != snow_image_checksum(high));
    snow_image_free(wide);
    snow_image_free(high);
}

static void the_name_decides_the_format(void **state) {
    image_fixture *f = *state;
    snow_image *image = support_picture(f->context, 3, 3, 4, 1);
    static const char *const names[] = {"a.PNG", "a.Npy", "a.pfm"};
    static const char *const starts[] = {"\x89PNG", "\x93NUM", "PF\n3"};
    for (int i = 0; i < 3; i++) {
        const char *path = support_image_path(f, names[i]);
        assert_int_equal(snow_image_save(image, path, NULL), SNOW_STATUS_OK);
        support_bytes file = support_read_file(path);
        assert_memory_equal(file.bytes, starts[i], 4);
        free(file.bytes);
    }
    snow_image_free(image);
}

static snow_status check_path(snow_context *context, const char *path,
                              bool overwrite) {
    const snow_image_options options = {.size = sizeof options,
                                        .overwrite = overwrite};
    return snow_image_check(context, path, 1, 1, &options);
}

static void an_unknown_suffix_is_bad_usage(void **state) {
    image_fixture *f = *state;
    snow_image *image = support_picture(f->context, 3, 3, 4, 1);
    static const char *const names[] = {"a.bmp",    "a", "png",
                                        "a.png.gz", "",  "-x"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        assert_int_equal(snow_image_save(image, names[i], NULL),
                         SNOW_STATUS_BAD_USAGE);
        assert_int_equal(check_path(f->context, names[i], true),
                         SNOW_STATUS_BAD_USAGE);
        assert_non_null(strstr(snow_context_message(f->context), ".npy"));
    }
    snow_image_free(image);
}

static void options_that_cannot_be_heeded_are_refused(void **state) {
    image_fixture *f = *state;
    snow_image *image = support_picture(f->context, 3, 3, 4, 1);
    const snow_image_options flat = {.size = sizeof flat, .flatten = true};
    const snow_image_options deep = {.size = sizeof deep, .bits = 16};
    const snow_image_options wrong[] = {
        {.size = sizeof(snow_image_options), .bits = 1},
        {.size = sizeof(snow_image_options), .bits = -8},
        {.size = sizeof(snow_image_options), .bits = 32},
        {.size = sizeof(snow_image_options),
         .flatten = true,
         .background = {0, 1.5, 0}},
        {.size = sizeof(snow_image_options),
         .flatten = true,
         .background = {-0.1, 0, 0}},
        {.size = sizeof(snow_image_options),
         .flatten = true,
         .background = {0, 0, NAN}},
    };
    for (int i = 1; i < 3; i++) {
        const char *path = support_image_path(f, suffixes[i]);
        assert_int_equal(snow_image_save(image, path, &flat),
                         SNOW_STATUS_BAD_USAGE);
        assert_int_equal(snow_image_save(image, path, &deep),
                         SNOW_STATUS_BAD_USAGE);
    }
    const char *path = support_image_path(f, "a.png");
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        assert_int_equal(snow_image_save(image, path, &wrong[i]),
                         SNOW_STATUS_BAD_USAGE);
    assert_int_equal(support_folder_files(f->folder), 0);
    snow_image_free(image);
}

static void an_existing_file_is_kept_unless_told(void **state) {
    image_fixture *f = *state;
    snow_image *image = support_picture(f->context, 3, 3, 4, 1);
    for (int i = 0; i < 3; i++) {
        const char *path = support_image_path(f, suffixes[i]);
        support_write_file(path, "precious", 8);
        assert_int_equal(snow_image_save(image, path, NULL),
                         SNOW_STATUS_BAD_OUTPUT);
        assert_int_equal(check_path(f->context, path, false),
                         SNOW_STATUS_BAD_OUTPUT);
        support_bytes file = support_read_file(path);
        assert_int_equal(file.size, 8);
        assert_memory_equal(file.bytes, "precious", 8);
        free(file.bytes);
        assert_int_equal(check_path(f->context, path, true), SNOW_STATUS_OK);
        const snow_image_options over = {.size = sizeof over,
                                         .overwrite = true};
        assert_int_equal(snow_image_save(image, path, &over), SNOW_STATUS_OK);
        file = support_read_file(path);
        assert_true(file.size > 8);
        free(file.bytes);
        assert_int_equal(support_folder_files(f->folder), 1);
    }
    snow_image_free(image);
}

static void a_missing_folder_is_bad_output(void **state) {
    image_fixture *f = *state;
    snow_image *image = support_picture(f->context, 3, 3, 4, 1);
    char path[256];
    snprintf(path, sizeof path, "%s/none/a.png", f->folder);
    assert_int_equal(snow_image_save(image, path, NULL),
                     SNOW_STATUS_BAD_OUTPUT);
    assert_int_equal(check_path(f->context, path, false),
                     SNOW_STATUS_BAD_OUTPUT);
    assert_non_null(strstr(snow_context_message(f->context), path));
    snow_image_free(image);
}

/* /proc takes no files from anybody, root included. */
static void a_folder_that_takes_no_files_is_bad_output(void **state) {
    image_fixture *f = *state;
    if (access("/proc/self", F_OK) != 0)
        skip();
    snow_image *image = support_picture(f->context, 3, 3, 4, 1);
    assert_int_equal(snow_image_save(image, "/proc/snow.png", NULL),
                     SNOW_STATUS_BAD_OUTPUT);
    assert_int_equal(check_path(f->context, "/proc/snow.png", true),
                     SNOW_STATUS_BAD_OUTPUT);
    snow_image_free(image);
}

static void checking_a_path_leaves_nothing(void **state) {
    image_fixture *f = *state;
    const char *path = support_image_path(f, "a.png");
    assert_int_equal(check_path(f->context, path, false), SNOW_STATUS_OK);
    assert_int_equal(check_path(f->context, "-", false), SNOW_STATUS_OK);
    assert_int_equal(support_folder_files(f->folder), 0);
}

/* Saves to standard output while that is another file. */
static snow_status save_to_stdout(const snow_image *image, const char *path) {
    fflush(stdout);
    int kept = dup(STDOUT_FILENO);
    int file = open(path, O_WRONLY | O_CREAT, 0600);
    assert_true(kept >= 0 && file >= 0);
    assert_true(dup2(file, STDOUT_FILENO) >= 0);
    snow_status status = snow_image_save(image, "-", NULL);
    assert_true(dup2(kept, STDOUT_FILENO) >= 0);
    close(kept);
    close(file);
    return status;
}

static void standard_output_gets_a_png(void **state) {
    image_fixture *f = *state;
    snow_image *image = support_picture(f->context, 20, 10, 4, 1);
    const char *path = support_image_path(f, "stdout");
    assert_int_equal(save_to_stdout(image, path), SNOW_STATUS_OK);
    snow_image *again = NULL;
    assert_int_equal(snow_image_load(f->context, path, &again), SNOW_STATUS_OK);
    assert_true(support_apart(image, again) < 1.01 / 255);
    snow_image_free(image);
    snow_image_free(again);
}

/* From a pipe, of whose size nothing is known, into the context's memory. */
static void standard_input_is_a_picture(void **state) {
    image_fixture *f = *state;
    static const char *const names[] = {"a.png", "a.npy", "a.pfm"};
    snow_image *image = support_picture(f->context, 20, 10, 4, 1);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const char *path = support_image_path(f, names[i]);
        assert_int_equal(snow_image_save(image, path, NULL), SNOW_STATUS_OK);
        static char bytes[20000]; /* less than a pipe holds */
        FILE *file = fopen(path, "rb");
        assert_non_null(file);
        size_t size = fread(bytes, 1, sizeof bytes, file);
        fclose(file);
        int ends[2], kept = dup(STDIN_FILENO);
        assert_int_equal(pipe(ends), 0);
        assert_int_equal(write(ends[1], bytes, size), size);
        close(ends[1]);
        dup2(ends[0], STDIN_FILENO);
        close(ends[0]);
        snow_image *again = NULL;
        snow_status status = snow_image_load(f->context, "-", &again);
        dup2(kept, STDIN_FILENO);
        close(kept);
        assert_int_equal(status, SNOW_STATUS_OK);
        assert_int_equal(snow_image_width(again), 20);
        snow_image_free(again);
    }
    snow_image_free(image);
}

static void a_full_disk_is_bad_output(void **state) {
    image_fixture *f = *state;
    if (access("/dev/full", W_OK) != 0)
        skip();
    snow_image *image = support_picture(f->context, 700, 500, 4, 1);
    assert_int_equal(save_to_stdout(image, "/dev/full"),
                     SNOW_STATUS_BAD_OUTPUT);
    assert_non_null(strstr(snow_context_message(f->context), "space"));
    snow_image_free(image);
}

static void what_is_no_picture_is_refused(void **state) {
    image_fixture *f = *state;
    support_assert_refused(f->context, "", 0);
    assert_non_null(strstr(snow_context_message(f->context), "empty"));
    support_assert_refused(f->context, "\x89", 1);
    support_assert_refused(f->context, "GIF89a..........", 16);
    support_assert_refused(f->context, "PFx", 3);
    snow_image *image = NULL;
    assert_int_equal(snow_image_load(f->context, "/tmp", &image),
                     SNOW_STATUS_BAD_INPUT);
    assert_int_equal(snow_image_load(f->context, "/none/a.png", &image),
                     SNOW_STATUS_BAD_INPUT);
    assert_null(image);
}

/* Saves, loads and compares a picture while the n-th allocation fails; false
 * when there are not that many. */
static bool survive_failure(image_fixture *f, const char *path, int64_t n,
                            bool once) {
    support_memory memory = {.once = once};
    snow_context *context = support_failing_context(&memory);
    snow_image *image = support_picture(context, 9, 7, 4, 1), *again = NULL;
    snow_image_difference difference = {.size = sizeof difference};
    memory.left = n;
    snow_status status = snow_image_save(image, path, NULL);
    if (status == SNOW_STATUS_OK)
        status = snow_image_load(context, path, &again);
    if (status == SNOW_STATUS_OK)
        status = snow_image_compare(image, again, &difference);
    bool failed = memory.left <= 0;
    if (status != SNOW_STATUS_OK) {
        assert_true(failed);
        assert_int_equal(status, SNOW_STATUS_NO_MEMORY);
        assert_non_null(strstr(snow_context_message(context), "memory"));
    }
    snow_image_free(again);
    snow_image_free(image);
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
    unlink(path);
    assert_int_equal(support_folder_files(f->folder), 0);
    return failed;
}

static void running_out_of_memory_leaves_nothing(void **state) {
    image_fixture *f = *state;
    for (int i = 0; i < 6; i++) {
        const char *path = support_image_path(f, suffixes[i / 2]);
        int64_t n = 1;
        while (survive_failure(f, path, n, i % 2 == 1))
            n++;
        assert_in_range(n, 8, 100);
    }
}

#define TEST(name)                                             \
    cmocka_unit_test_setup_teardown(name, support_image_setup, \
                                    support_image_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(a_new_picture_is_transparent),
        TEST(impossible_pictures_are_refused),
        TEST(the_longest_sides_are_possible),
        TEST(check_sums_are_fnv_1a),
        TEST(equal_pictures_have_equal_sums),
        TEST(the_shape_enters_the_check_sum),
        TEST(the_name_decides_the_format),
        TEST(an_unknown_suffix_is_bad_usage),
        TEST(options_that_cannot_be_heeded_are_refused),
        TEST(an_existing_file_is_kept_unless_told),
        TEST(a_missing_folder_is_bad_output),
        TEST(a_folder_that_takes_no_files_is_bad_output),
        TEST(checking_a_path_leaves_nothing),
        TEST(standard_output_gets_a_png),
        TEST(standard_input_is_a_picture),
        TEST(a_full_disk_is_bad_output),
        TEST(what_is_no_picture_is_refused),
        TEST(running_out_of_memory_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
