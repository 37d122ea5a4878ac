/* tests/formats/test_raw.c - raw volumes: told by options or by the name, whole
 * or refused. */
#include "support/files.h"

#include <math.h>

static const snow_volume_options given = {.size = sizeof given,
                                          .dims = {4, 3, 2},
                                          .type = SNOW_TYPE_UINT16,
                                          .endian = SNOW_ENDIAN_BIG};

/* 24 values 0x0100, 0x0302, ... as little endian, 48 bytes. */
static const unsigned char *counting(void) {
    static unsigned char bytes[64];
    for (int i = 0; i < 64; i++)
        bytes[i] = (unsigned char)i;
    return bytes;
}

static void refused(support_files *files, const char *path,
                    const snow_volume_options *options, const char *part) {
    support_refused(files, path, options, SNOW_STATUS_BAD_INPUT, part,
                    SUPPORT_MOST);
}

static void options_describe_the_bytes(void **state) {
    support_files *files = *state;
    const char *path = support_write(files, "a.raw", counting(), 48);
    snow_volume_options options = given;
    options.spacing[0] = 0.5;
    options.spacing[2] = 2;
    snow_volume *volume = support_opened(files, path, &options);
    const snow_volume_info *info = snow_volume_get_info(volume);
    const uint16_t *voxels = snow_volume_voxels(volume);
    for (int i = 0; i < 24; i++)
        assert_int_equal(voxels[i], (2 * i) << 8 | (2 * i + 1));
    assert_string_equal(info->format, "raw");
    assert_true(info->spacing[0] == 0.5 && info->spacing[1] == 1 &&
                info->spacing[2] == 2 && info->matrix[2][2] == 2);
    assert_string_equal(files->warnings, "");
    snow_volume_close(volume);
}

/* Writes 1, 2, 3 of a type in one byte order and expects them back. */
static void check_type(support_files *files, snow_type type, bool big,
                       const void *values, size_t size) {
    unsigned char bytes[24];
    const uint16_t one = 1;
    bool machine_big = *(const unsigned char *)&one == 0;
    for (size_t i = 0; i < 3 * size; i++) {
        size_t turned = i / size * size + size - 1 - i % size;
        bytes[i] =
            ((const unsigned char *)values)[big != machine_big ? turned : i];
    }
    snow_volume_options options = {
        .size = sizeof options,
        .dims = {1, 3, 1},
        .type = type,
        .endian = big ? SNOW_ENDIAN_BIG : SNOW_ENDIAN_LITTLE,
    };
    const char *path = support_write(files, "t.raw", bytes, 3 * size);
    snow_volume *volume = support_opened(files, path, &options);
    assert_memory_equal(snow_volume_voxels(volume), values, 3 * size);
    snow_volume_statistics m = {.size = sizeof m};
    snow_volume_get_statistics(volume, &m);
    assert_true(m.sum == 6 && m.wsum == 14);
    snow_volume_close(volume);
}

static void every_type_is_read_in_both_byte_orders(void **state) {
    support_files *files = *state;
#define CHECK_BOTH(name, c_type, text)                                      \
    {                                                                       \
        const c_type values[3] = {1, 2, 3};                                 \
        check_type(files, SNOW_TYPE_##name, false, values, sizeof(c_type)); \
        check_type(files, SNOW_TYPE_##name, true, values, sizeof(c_type));  \
    }
    SNOW_TYPE_MAP(CHECK_BOTH)
#undef CHECK_BOTH
}

static void an_offset_skips_bytes(void **state) {
    support_files *files = *state;
    const char *path = support_write(files, "a.raw", counting(), 50);
    snow_volume_options options = given;
    options.offset = 2;
    snow_volume *volume = support_opened(files, path, &options);
    assert_int_equal(*(const uint16_t *)snow_volume_voxels(volume), 0x0203);
    snow_volume_close(volume);
    options.offset = 3;
    refused(files, path, &options, "the voxels");
    options.offset = UINT64_MAX;
    refused(files, path, &options, "the voxels");
}

static void a_short_file_is_refused_before_its_memory(void **state) {
    support_files *files = *state;
    snow_volume_options options = given;
    const char *path = support_write(files, "a.raw", counting(), 47);
    refused(files, path, &options, "47");
    options.dims[2] = 1000000000;
    refused(files, path, &options, "the voxels");
    options.dims[0] = options.dims[1] = 4000000000;
    refused(files, path, &options, "larger than any");
}

static void a_long_file_is_read_with_one_warning(void **state) {
    support_files *files = *state;
    const char *path = support_write(files, "a.raw", counting(), 49);
    snow_volume_close(support_opened(files, path, &given));
    assert_int_equal(support_warned(files), 1);
    assert_non_null(strstr(files->warnings, "1 byte after"));
}

static void a_cut_damaged_or_small_gzip_is_refused(void **state) {
    support_files *files = *state;
    unsigned char packed[200];
    size_t size = support_gzip(counting(), 48, packed, sizeof packed);
    const char *path = support_write(files, "a.raw.gz", packed, size);
    snow_volume_close(support_opened(files, path, &given));
    snow_volume_options lying = given;
    lying.dims[2] = 100000;
    refused(files, path, &lying, "at most");
    path = support_write(files, "cut.raw.gz", packed, size - 5);
    refused(files, path, &given, "truncated");
    packed[size - 6] ^= 16;
    path = support_write(files, "sum.raw.gz", packed, size);
    refused(files, path, &given, "damaged");
    packed[0] ^= 1; /* no gzip any more: bytes like any others */
    path = support_write(files, "magic.raw.gz", packed, size);
    snow_volume_options tiny = {
        .size = sizeof tiny, .dims = {2, 2, 2}, .type = SNOW_TYPE_UINT8};
    refused(files, path, &tiny, "is not gzip");
}

static void the_name_tells_what_options_leave_out(void **state) {
    support_files *files = *state;
    static const char *const names[] = {"a_4x3x2_uint16.raw",
                                        "a-4x3x2-u16le.bin", "u16_4x3x2",
                                        "A.4x3x2.ushort"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const char *path = support_write(files, names[i], counting(), 48);
        snow_volume *volume = support_opened(files, path, NULL);
        assert_int_equal(*(const uint16_t *)snow_volume_voxels(volume), 0x0100);
        assert_int_equal(snow_volume_get_info(volume)->dims[1], 3);
        assert_int_equal(support_warned(files), (int)i + 1);
        assert_non_null(strstr(files->warnings, "4x3x2 uint16, little"));
        snow_volume_close(volume);
    }
    const char *path =
        support_write(files, "a_4x3x2_u16be.raw", counting(), 48);
    snow_volume *volume = support_opened(files, path, NULL);
    assert_int_equal(*(const uint16_t *)snow_volume_voxels(volume), 1);
    snow_volume_close(volume);
}

static void options_win_over_the_name(void **state) {
    support_files *files = *state;
    const char *path =
        support_write(files, "a_9x9x9_float64.raw", counting(), 48);
    snow_volume *volume = support_opened(files, path, &given);
    assert_int_equal(snow_volume_get_info(volume)->dims[0], 4);
    assert_string_equal(files->warnings, "");
    snow_volume_close(volume);
}

static void nothing_told_is_a_matter_of_usage(void **state) {
    support_files *files = *state;
    const char *path = support_write(files, "a.raw", counting(), 48);
    support_refused(files, path, NULL, SNOW_STATUS_BAD_USAGE, "--dims",
                    SUPPORT_MOST);
    snow_volume_options options = {
        .size = sizeof options, .dims = {4, 3, 0}, .type = SNOW_TYPE_UINT16};
    support_refused(files, path, &options, SNOW_STATUS_BAD_USAGE, "--dims",
                    SUPPORT_MOST);
}

static void options_out_of_range_are_refused(void **state) {
    support_files *files = *state;
    const char *path = support_write(files, "a.raw", counting(), 48);
    snow_volume_options bad[5] = {given, given, given, given, given};
    bad[0].dims[1] = -3;
    bad[1].spacing[0] = NAN;
    bad[2].spacing[1] = -1;
    bad[3].time = 1;
    bad[4].time = -2; /* one step: -1 is it */
    for (int i = 0; i < 5; i++)
        support_refused(files, path, &bad[i], SNOW_STATUS_BAD_USAGE, "",
                        SUPPORT_MOST);
}

/* The figures were computed with numpy from the same files. */
static void the_real_engine_and_head_have_their_figures(void **state) {
    support_files *files = *state;
    snow_volume_statistics m = {.size = sizeof m};
    const char *path = support_data("classic/engine_256x256x110_u8.raw.gz");
    if (!path)
        skip();
    const snow_volume_options engine = {.size = sizeof engine,
                                        .dims = {256, 256, 110},
                                        .type = SNOW_TYPE_UINT8};
    snow_volume *volume = support_opened(files, path, &engine);
    snow_volume_get_statistics(volume, &m);
    assert_true(m.min == 0 && m.max == 255 && m.sum == 187475047 &&
                m.wsum == 94688151341);
    snow_volume_close(volume);
    const snow_volume_options head = {.size = sizeof head,
                                      .dims = {256, 256, 113},
                                      .type = SNOW_TYPE_UINT16,
                                      .endian = SNOW_ENDIAN_BIG,
                                      .spacing = {1, 1, 2}};
    path = support_data("classic/CThead_256x256x113_u16be.raw.gz");
    volume = support_opened(files, path, &head);
    snow_volume_get_statistics(volume, &m);
    assert_true(m.min == 0 && m.max == 3272 && m.sum == 2810724494 &&
                m.wsum == 1419355380335);
    assert_true(snow_volume_get_info(volume)->spacing[2] == 2);
    snow_volume_close(volume);
    assert_string_equal(files->warnings, "");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        SUPPORT_TEST(options_describe_the_bytes),
        SUPPORT_TEST(every_type_is_read_in_both_byte_orders),
        SUPPORT_TEST(an_offset_skips_bytes),
        SUPPORT_TEST(a_short_file_is_refused_before_its_memory),
        SUPPORT_TEST(a_long_file_is_read_with_one_warning),
        SUPPORT_TEST(a_cut_damaged_or_small_gzip_is_refused),
        SUPPORT_TEST(the_name_tells_what_options_leave_out),
        SUPPORT_TEST(options_win_over_the_name),
        SUPPORT_TEST(nothing_told_is_a_matter_of_usage),
        SUPPORT_TEST(options_out_of_range_are_refused),
        SUPPORT_TEST(the_real_engine_and_head_have_their_figures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
