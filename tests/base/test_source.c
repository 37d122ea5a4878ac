/* tests/base/test_source.c - bytes from files, memory and gzip come whole or
 * not at all. */
#include "support/files.h"

#include "io/source.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/* Some bytes that do not pack well, and room for them packed. */
#define SIZE 200000
static unsigned char plain[SIZE];
static unsigned char packed[2 * SIZE + 1000];

static void fill_plain(void) {
    uint64_t random = 7;
    for (size_t i = 0; i < SIZE; i++)
        plain[i] = (unsigned char)(support_random(&random) >> 60);
}

/* Reads a source of known name to its end in pieces of `step`. */
static snow_status read_through(snow_source *source, size_t step,
                                size_t *total) {
    static unsigned char back[SIZE + 100];
    size_t got = 1;
    for (*total = 0; got && *total < sizeof back; *total += got) {
        size_t room = sizeof back - *total;
        snow_status status = snow_source_read(source, back + *total,
                                              step < room ? step : room, &got);
        if (status != SNOW_STATUS_OK)
            return status;
    }
    assert_memory_equal(back, plain, *total < SIZE ? *total : SIZE);
    return SNOW_STATUS_OK;
}

static snow_source *opened(support_files *files, const char *path) {
    snow_source *source = NULL;
    if (snow_source_open(files->context, path, &source) != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(files->context));
    return source;
}

static void a_file_reads_as_it_was_written(void **state) {
    support_files *files = *state;
    const char *path = support_write(files, "a", plain, SIZE);
    static const size_t steps[] = {1, 7, 4096, 65535, 65536, SIZE + 50};
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        snow_source *source = opened(files, path);
        size_t total;
        assert_int_equal(snow_source_remaining(source), SIZE);
        assert_int_equal(read_through(source, steps[i], &total),
                         SNOW_STATUS_OK);
        assert_int_equal(total, SIZE);
        assert_int_equal(snow_source_remaining(source), 0);
        snow_source_close(source);
    }
}

static void gzip_is_undone_whatever_the_name(void **state) {
    support_files *files = *state;
    size_t size = support_gzip(plain, SIZE, packed, sizeof packed), total;
    snow_source *source =
        opened(files, support_write(files, "a.raw", packed, size));
    assert_int_equal(snow_source_remaining(source), -1);
    assert_int_equal(read_through(source, 1000, &total), SNOW_STATUS_OK);
    assert_int_equal(total, SIZE);
    assert_int_equal(snow_source_finish(source), SNOW_STATUS_OK);
    assert_string_equal(files->warnings, "");
    snow_source_close(source);
}

static void members_of_gzip_are_joined(void **state) {
    support_files *files = *state;
    size_t size = support_gzip(plain, 1000, packed, sizeof packed), total;
    size += support_gzip(plain, 0, packed + size, sizeof packed - size);
    size += support_gzip(plain + 1000, SIZE - 1000, packed + size,
                         sizeof packed - size);
    snow_source *source = NULL;
    assert_int_equal(
        snow_source_open_memory(files->context, "m", packed, size, &source),
        SNOW_STATUS_OK);
    assert_int_equal(read_through(source, 999, &total), SNOW_STATUS_OK);
    assert_int_equal(total, SIZE);
    snow_source_close(source);
}

/* Reads `size` packed bytes; the status of the first call that fails. */
static snow_status read_packed(support_files *files, size_t size) {
    snow_source *source = NULL;
    size_t total;
    snow_status status =
        snow_source_open_memory(files->context, "m", packed, size, &source);
    if (status == SNOW_STATUS_OK)
        status = read_through(source, 4096, &total);
    snow_source_close(source);
    return status;
}

static void a_cut_gzip_stream_is_an_error_at_every_length(void **state) {
    support_files *files = *state;
    size_t size = support_gzip(plain, 500, packed, sizeof packed);
    for (size_t cut = 4; cut < size; cut++) {
        assert_int_equal(read_packed(files, cut), SNOW_STATUS_BAD_INPUT);
        assert_non_null(strstr(snow_context_message(files->context), "m: "));
        assert_non_null(
            strstr(snow_context_message(files->context), "truncated"));
    }
    assert_int_equal(read_packed(files, size), SNOW_STATUS_OK);
}

static void a_wrong_check_sum_or_length_is_an_error(void **state) {
    support_files *files = *state;
    size_t size = support_gzip(plain, 500, packed, sizeof packed);
    for (size_t i = size - 8; i < size; i++) {
        packed[i] ^= 1;
        assert_int_equal(read_packed(files, size), SNOW_STATUS_BAD_INPUT);
        assert_non_null(
            strstr(snow_context_message(files->context), "damaged"));
        packed[i] ^= 1;
    }
}

/* The voxels may end where the check sum has not been seen yet. */
static void finish_sees_a_wrong_check_sum_after_all_bytes(void **state) {
    support_files *files = *state;
    size_t size = support_gzip(plain, 500, packed, sizeof packed);
    packed[size - 8] ^= 1;
    char back[500];
    snow_source *source = NULL;
    assert_int_equal(
        snow_source_open_memory(files->context, "m", packed, size, &source),
        SNOW_STATUS_OK);
    snow_status status = snow_source_read_all(source, back, 499, "the bytes");
    if (status == SNOW_STATUS_OK)
        status = snow_source_finish(source);
    assert_int_equal(status, SNOW_STATUS_BAD_INPUT);
    snow_source_close(source);
}

static void garbage_after_gzip_is_one_warning(void **state) {
    support_files *files = *state;
    size_t size = support_gzip(plain, 500, packed, sizeof packed);
    memcpy(packed + size, "garbage", 7);
    assert_int_equal(read_packed(files, size + 7), SNOW_STATUS_OK);
    assert_int_equal(support_warned(files), 1);
    assert_non_null(strstr(files->warnings, "ignored"));
}

static void left_over_bytes_are_one_warning(void **state) {
    support_files *files = *state;
    snow_source *source = opened(files, support_write(files, "a", "abc", 3));
    assert_int_equal(snow_source_skip(source, 1, "it"), SNOW_STATUS_OK);
    assert_int_equal(snow_source_finish(source), SNOW_STATUS_OK);
    assert_int_equal(support_warned(files), 1);
    assert_non_null(strstr(files->warnings, "2 bytes"));
    snow_source_close(source);
}

static void peeking_takes_nothing(void **state) {
    support_files *files = *state;
    snow_source *source = opened(files, support_write(files, "a", plain, SIZE));
    unsigned char bytes[SNOW_PEEK_BYTES];
    size_t got;
    /* The buffer's end lies within the second peek. */
    assert_int_equal(snow_source_skip(source, 65536 - 10, "it"),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_source_peek(source, bytes, 4096, &got),
                     SNOW_STATUS_OK);
    assert_int_equal(got, 4096);
    assert_memory_equal(bytes, plain + 65536 - 10, 4096);
    assert_int_equal(snow_source_remaining(source), SIZE - 65536 + 10);
    assert_int_equal(snow_source_skip(source, (uint64_t)SIZE - 65536 + 5, "it"),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_source_peek(source, bytes, 4096, &got),
                     SNOW_STATUS_OK);
    assert_int_equal(got, 5);
    snow_source_close(source);
}

static void skipping_beyond_the_end_is_an_error(void **state) {
    support_files *files = *state;
    snow_source *source = opened(files, support_write(files, "a", plain, SIZE));
    unsigned char byte;
    size_t got;
    assert_int_equal(snow_source_skip(source, SIZE - 1, "it"), SNOW_STATUS_OK);
    assert_int_equal(snow_source_read(source, &byte, 1, &got), SNOW_STATUS_OK);
    assert_int_equal(byte, plain[SIZE - 1]);
    assert_int_equal(snow_source_skip(source, 5, "the rest"),
                     SNOW_STATUS_BAD_INPUT);
    assert_non_null(strstr(snow_context_message(files->context), "the rest"));
    snow_source_close(source);
}

static void lines_end_with_lf_crlf_or_the_file(void **state) {
    support_files *files = *state;
    snow_source *source =
        opened(files, support_write(files, "a", "one\r\n\ntwo", 9));
    char line[8];
    bool got;
    static const char *const wanted[] = {"one", "", "two"};
    for (int i = 0; i < 3; i++) {
        assert_int_equal(snow_source_read_line(source, line, 8, &got),
                         SNOW_STATUS_OK);
        assert_true(got);
        assert_string_equal(line, wanted[i]);
    }
    assert_int_equal(snow_source_read_line(source, line, 8, &got),
                     SNOW_STATUS_OK);
    assert_false(got);
    snow_source_close(source);
}

static void long_lines_and_nul_bytes_are_refused(void **state) {
    support_files *files = *state;
    char line[8];
    bool got;
    snow_source *source =
        opened(files, support_write(files, "a", "1234567\n12345678\n", 17));
    assert_int_equal(snow_source_read_line(source, line, 8, &got),
                     SNOW_STATUS_OK);
    assert_string_equal(line, "1234567");
    assert_int_equal(snow_source_read_line(source, line, 8, &got),
                     SNOW_STATUS_BAD_INPUT);
    snow_source_close(source);
    source = opened(files, support_write(files, "b", "a\0b\n", 4));
    assert_int_equal(snow_source_read_line(source, line, 8, &got),
                     SNOW_STATUS_BAD_INPUT);
    snow_source_close(source);
}

static void what_cannot_be_there_is_not_expected(void **state) {
    support_files *files = *state;
    snow_source *source = opened(files, support_write(files, "a", "abc", 3));
    assert_int_equal(snow_source_expect(source, 3, "it"), SNOW_STATUS_OK);
    assert_int_equal(snow_source_expect(source, 4, "it"),
                     SNOW_STATUS_BAD_INPUT);
    snow_source_close(source);
    /* Zeros pack best, but no better than deflate's limit. */
    static const unsigned char zeros[SIZE];
    size_t size = support_gzip(zeros, SIZE, packed, sizeof packed);
    source = opened(files, support_write(files, "b", packed, size));
    assert_int_equal(snow_source_expect(source, SIZE, "it"), SNOW_STATUS_OK);
    assert_int_equal(snow_source_expect(source, (uint64_t)1 << 40, "it"),
                     SNOW_STATUS_BAD_INPUT);
    snow_source_close(source);
}

static void folders_devices_and_missing_files_are_refused(void **state) {
    support_files *files = *state;
    static const char *const paths[] = {"/tmp", "/dev/null", "/no/such/file"};
    for (int i = 0; i < 3; i++) {
        snow_source *source = NULL;
        assert_int_equal(snow_source_open(files->context, paths[i], &source),
                         SNOW_STATUS_BAD_INPUT);
        assert_null(source);
        assert_memory_equal(snow_context_message(files->context), paths[i],
                            strlen(paths[i]));
    }
}

/* Puts a descriptor in the place of standard input and reads "-" from it. */
static void read_standard_input(support_files *files, int descriptor,
                                int64_t size) {
    int kept = dup(STDIN_FILENO);
    dup2(descriptor, STDIN_FILENO);
    close(descriptor);
    snow_source *source = opened(files, "-");
    char back[8];
    size_t got;
    assert_int_equal(snow_source_remaining(source), size);
    assert_int_equal(snow_source_read(source, back, 8, &got), SNOW_STATUS_OK);
    assert_int_equal(got, 3);
    assert_memory_equal(back, "abc", 3);
    snow_source_close(source);
    dup2(kept, STDIN_FILENO);
    close(kept);
}

static void a_dash_is_standard_input(void **state) {
    support_files *files = *state;
    int ends[2];
    assert_int_equal(pipe(ends), 0);
    assert_int_equal(write(ends[1], "abc", 3), 3);
    close(ends[1]);
    read_standard_input(files, ends[0], -1);
    /* A file from which something was read already. */
    int descriptor = open(support_write(files, "a", "12abc", 5), O_RDONLY);
    assert_int_equal(lseek(descriptor, 2, SEEK_SET), 2);
    read_standard_input(files, descriptor, 3);
}

static void standard_input_has_no_siblings(void **state) {
    support_files *files = *state;
    int kept = dup(STDIN_FILENO);
    int file = open(support_write(files, "h", "x", 1), O_RDONLY);
    dup2(file, STDIN_FILENO);
    close(file);
    snow_source *header = opened(files, "-"), *data = NULL;
    dup2(kept, STDIN_FILENO);
    close(kept);
    assert_int_equal(
        snow_source_open_sibling(header, support_path(files, "h"), &data),
        SNOW_STATUS_BAD_INPUT);
    assert_null(data);
    assert_non_null(
        strstr(snow_context_message(files->context), "another file"));
    snow_source_close(header);
}

static void siblings_lie_beside_the_header(void **state) {
    support_files *files = *state;
    support_write(files, "data", "abc", 3);
    snow_source *header = opened(files, support_write(files, "h", "x", 1));
    snow_source *data = NULL;
    assert_int_equal(snow_source_open_sibling(header, "data", &data),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_source_remaining(data), 3);
    snow_source_close(data);
    const char *absolute = support_path(files, "data");
    assert_int_equal(snow_source_open_sibling(header, absolute, &data),
                     SNOW_STATUS_OK);
    snow_source_close(data);
    snow_source_close(header);
}

/* A header is untrusted: it may not make us wait at a pipe, read a device, or
 * fetch something. */
static void siblings_are_regular_files_only(void **state) {
    support_files *files = *state;
    assert_int_equal(mkfifo(support_path(files, "pipe"), 0600), 0);
    snow_source *header = opened(files, support_write(files, "h", "x", 1));
    static const char *const names[] = {"pipe", "/dev/zero",         "", ".",
                                        "-",    "http://localhost/a"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        snow_source *data = NULL;
        assert_int_equal(snow_source_open_sibling(header, names[i], &data),
                         SNOW_STATUS_BAD_INPUT);
        assert_null(data);
    }
    snow_source_close(header);
}

/* Makes "swapped" a file and a pipe in turn until killed. */
static pid_t keep_swapping(const support_files *files) {
    char data[128], pipe[128], swapped[128], aside[128];
    snprintf(data, sizeof data, "%s/data", files->folder);
    snprintf(pipe, sizeof pipe, "%s/pipe", files->folder);
    snprintf(swapped, sizeof swapped, "%s/swapped", files->folder);
    snprintf(aside, sizeof aside, "%s/aside", files->folder);
    pid_t child = fork();
    alarm(child == 0 ? 60 : 0); /* should the test die, it does as well */
    while (child == 0) {
        unlink(aside);
        if (link(data, aside) || rename(aside, swapped) || link(pipe, aside) ||
            rename(aside, swapped))
            _exit(1);
    }
    return child;
}

/* An open that waits for a writer at the pipe would never end. */
static void a_pipe_swapped_in_for_a_sibling_is_not_waited_at(void **state) {
    support_files *files = *state;
    support_write(files, "data", "abc", 3);
    support_write(files, "swapped", "abc", 3);
    assert_int_equal(mkfifo(support_path(files, "pipe"), 0600), 0);
    snow_source *header = opened(files, support_write(files, "h", "x", 1));
    pid_t child = keep_swapping(files);
    assert_true(child > 0);
    alarm(60);
    for (int i = 0; i < 5000; i++) {
        snow_source *data = NULL;
        if (snow_source_open_sibling(header, "swapped", &data) ==
            SNOW_STATUS_OK)
            assert_int_equal(snow_source_remaining(data), 3);
        snow_source_close(data);
    }
    alarm(0);
    kill(child, SIGKILL);
    waitpid(child, NULL, 0);
    snow_source_close(header);
}

static void an_empty_name_is_called_empty(void **state) {
    support_files *files = *state;
    snow_source *source = NULL;
    snow_volume *volume = NULL;
    assert_int_equal(snow_source_open(files->context, "", &source),
                     SNOW_STATUS_BAD_INPUT);
    assert_int_equal(snow_volume_open(files->context, "", NULL, &volume),
                     SNOW_STATUS_BAD_INPUT);
    assert_memory_equal(snow_context_message(files->context), "the file name",
                        13);
}

static void bytes_in_memory_have_no_siblings(void **state) {
    support_files *files = *state;
    snow_source *header = NULL, *data = NULL;
    assert_int_equal(
        snow_source_open_memory(files->context, "/etc/h", "x", 1, &header),
        SNOW_STATUS_OK);
    assert_int_equal(snow_source_open_sibling(header, "passwd", &data),
                     SNOW_STATUS_BAD_INPUT);
    snow_source_close(header);
}

static void unpacking_can_begin_in_the_middle(void **state) {
    support_files *files = *state;
    memcpy(packed, "head\n", 5);
    size_t size = support_gzip(plain, SIZE, packed + 5, sizeof packed - 5);
    snow_source *source =
        opened(files, support_write(files, "a", packed, size + 5));
    char line[8];
    bool got;
    size_t total;
    assert_int_equal(snow_source_read_line(source, line, 8, &got),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_source_unpack(source), SNOW_STATUS_OK);
    assert_int_equal(read_through(source, 5000, &total), SNOW_STATUS_OK);
    assert_int_equal(total, SIZE);
    snow_source_close(source);
}

int main(void) {
    fill_plain();
    const struct CMUnitTest tests[] = {
        SUPPORT_TEST(a_file_reads_as_it_was_written),
        SUPPORT_TEST(gzip_is_undone_whatever_the_name),
        SUPPORT_TEST(members_of_gzip_are_joined),
        SUPPORT_TEST(a_cut_gzip_stream_is_an_error_at_every_length),
        SUPPORT_TEST(a_wrong_check_sum_or_length_is_an_error),
        SUPPORT_TEST(finish_sees_a_wrong_check_sum_after_all_bytes),
        SUPPORT_TEST(garbage_after_gzip_is_one_warning),
        SUPPORT_TEST(left_over_bytes_are_one_warning),
        SUPPORT_TEST(peeking_takes_nothing),
        SUPPORT_TEST(skipping_beyond_the_end_is_an_error),
        SUPPORT_TEST(lines_end_with_lf_crlf_or_the_file),
        SUPPORT_TEST(long_lines_and_nul_bytes_are_refused),
        SUPPORT_TEST(what_cannot_be_there_is_not_expected),
        SUPPORT_TEST(folders_devices_and_missing_files_are_refused),
        SUPPORT_TEST(a_dash_is_standard_input),
        SUPPORT_TEST(siblings_lie_beside_the_header),
        SUPPORT_TEST(siblings_are_regular_files_only),
        SUPPORT_TEST(standard_input_has_no_siblings),
        SUPPORT_TEST(a_pipe_swapped_in_for_a_sibling_is_not_waited_at),
        SUPPORT_TEST(an_empty_name_is_called_empty),
        SUPPORT_TEST(bytes_in_memory_have_no_siblings),
        SUPPORT_TEST(unpacking_can_begin_in_the_middle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
