/* tests/formats/test_npy.c - NumPy arrays as volumes: their shape and order,
 * and what is refused.  Every type and order is compared with NumPy in
 * oracle_npy.py. */
#include "support/files.h"

#include <math.h>

/* The most memory that a refusal may ask for at once. */
#define MOST ((size_t)100 * 1024)

/* Writes an array with that header and `size` bytes of 0, 1, 2, ... */
static const char *write_npy(support_files *files, const char *type,
                             const char *order, const char *shape,
                             size_t size) {
    char bytes[2048] = "\x93NUMPY\1";
    int length = snprintf(bytes + 10, 500,
                          "{'descr': '%s', 'fortran_order': %s, 'shape': %s, "
                          "}\n",
                          type, order, shape);
    bytes[8] = (char)length;
    for (size_t i = 0; i < size; i++)
        bytes[10 + (size_t)length + i] = (char)i;
    return support_write(files, "a.npy", bytes, 10 + (size_t)length + size);
}

static void refused(support_files *files, const char *path, const char *part) {
    support_refused(files, path, NULL, SNOW_STATUS_BAD_INPUT, part, MOST);
}

static void the_last_index_is_x(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    snow_volume *volume = support_opened(
        &files, write_npy(&files, "|u1", "False", "(2, 3, 4)", 24), NULL);
    const snow_volume_info *info = snow_volume_get_info(volume);
    const uint8_t *voxels = snow_volume_voxels(volume);
    assert_string_equal(info->format, "npy");
    assert_true(info->dims[0] == 4 && info->dims[1] == 3 && info->dims[2] == 2);
    for (int i = 0; i < 24; i++)
        assert_int_equal(voxels[i], i);
    assert_int_equal(files.warnings, 0);
    snow_volume_close(volume);
    support_files_end(&files);
}

static void fortran_order_is_the_same_array(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    snow_volume *volume = support_opened(
        &files, write_npy(&files, "|u1", "True", "(2, 3, 4)", 24), NULL);
    const snow_volume_info *info = snow_volume_get_info(volume);
    const uint8_t *voxels = snow_volume_voxels(volume);
    assert_true(info->dims[0] == 4 && info->dims[1] == 3 && info->dims[2] == 2);
    for (int z = 0; z < 2; z++)
        for (int y = 0; y < 3; y++)
            for (int x = 0; x < 4; x++)
                assert_int_equal(voxels[(z * 3 + y) * 4 + x],
                                 z + 2 * (y + 3 * x));
    snow_volume_close(volume);
    support_files_end(&files);
}

static void time_comes_before_channel_before_z(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    const snow_volume_options options = {
        .size = sizeof options, .time = 1, .channel = 2};
    snow_volume *volume = support_opened(
        &files, write_npy(&files, "|u1", "False", "(2, 3, 1, 2, 4)", 48),
        &options);
    const uint8_t *voxels = snow_volume_voxels(volume);
    assert_int_equal(snow_volume_get_info(volume)->times, 2);
    assert_int_equal(voxels[0], (3 + 2) * 8);
    assert_int_equal(files.warnings, 0); /* both were given */
    snow_volume_close(volume);
    support_files_end(&files);
}

/* Voxel i has the bytes 3 i, 3 i + 1 and 3 i + 2. */
static void a_short_last_axis_holds_components(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    const char *path = write_npy(&files, "|u1", "False", "(2, 3, 5, 3)", 90);
    snow_volume_options options = {.size = sizeof options};
    snow_volume *volume = support_opened(&files, path, &options);
    const snow_volume_info *info = snow_volume_get_info(volume);
    assert_true(info->dims[0] == 5 && info->dims[1] == 3 && info->dims[2] == 2);
    assert_true(info->times == 1 && info->components == 3 && !info->magnitude);
    assert_int_equal(((const uint8_t *)snow_volume_voxels(volume))[7], 21);
    assert_int_equal(files.warnings, 1);
    snow_volume_close(volume);
    options.component = "z";
    volume = support_opened(&files, path, &options);
    assert_int_equal(((const uint8_t *)snow_volume_voxels(volume))[7], 23);
    assert_int_equal(files.warnings, 1);
    snow_volume_close(volume);
    options.component = "magnitude";
    volume = support_opened(&files, path, &options);
    info = snow_volume_get_info(volume);
    assert_true(info->type == SNOW_TYPE_FLOAT32 && info->magnitude);
    const float *lengths = snow_volume_voxels(volume);
    for (int i = 0; i < 30; i++) {
        double x = 3 * i, y = x + 1, z = x + 2;
        assert_true(fabs((double)lengths[i] - sqrt(x * x + y * y + z * z)) <
                    1e-5);
    }
    snow_volume_close(volume);
    options.component = "w";
    support_refused(&files, path, &options, SNOW_STATUS_BAD_USAGE,
                    "component 3 does not exist", MOST);
    support_files_end(&files);
}

/* Bits of halves and the floats that they are. */
static void halves_become_the_same_floats(void **state) {
    (void)state;
    static const struct {
        unsigned char bytes[2];
        double value;
    } cases[] = {{{0x00, 0x3c}, 1},         {{0x00, 0xc0}, -2},
                 {{0xff, 0x7b}, 65504},     {{0x01, 0x00}, 0x1p-24},
                 {{0xff, 0x03}, 0x3ffp-24}, {{0x00, 0x04}, 0x1p-14},
                 {{0x00, 0x7c}, INFINITY},  {{0x55, 0x35}, 0x1.554p-2}};
    support_files files;
    support_files_begin(&files);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char bytes[128] = "\x93NUMPY\1";
        const char header[] =
            "{'descr': '<f2', 'fortran_order': False, 'shape': (1,)}";
        bytes[8] = sizeof header - 1;
        memcpy(bytes + 10, header, sizeof header - 1);
        memcpy(bytes + 10 + sizeof header - 1, cases[i].bytes, 2);
        snow_volume *volume = support_opened(
            &files,
            support_write(&files, "h.npy", bytes, 12 + sizeof header - 1),
            NULL);
        const float *voxels = snow_volume_voxels(volume);
        assert_true((double)voxels[0] == cases[i].value);
        snow_volume_close(volume);
    }
    support_files_end(&files);
}

static void truth_is_one(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    snow_volume *volume = support_opened(
        &files, write_npy(&files, "|b1", "False", "(4,)", 4), NULL);
    const uint8_t *voxels = snow_volume_voxels(volume);
    assert_int_equal(snow_volume_get_info(volume)->type, SNOW_TYPE_UINT8);
    assert_true(voxels[0] == 0 && voxels[1] == 1 && voxels[3] == 1);
    snow_volume_close(volume);
    support_files_end(&files);
}

static void what_is_no_volume_is_refused(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    refused(&files, write_npy(&files, "<c8", "False", "(2, 3, 4)", 192),
            "astype");
    refused(&files, write_npy(&files, "|O", "False", "(2, 3, 4)", 192),
            "astype");
    refused(&files, write_npy(&files, "|u1", "False", "()", 1), "0 axes");
    refused(&files, write_npy(&files, "|u1", "False", "(1,1,1,1,1,1)", 1),
            "6 axes");
    refused(&files, write_npy(&files, "|u1", "False", "(2, 0, 4)", 9), "empty");
    refused(&files, support_write(&files, "a.npz", "PK\3\4....", 8), "unzip");
    refused(&files, support_write(&files, "b.npy", "not of NumPy, no", 16),
            "not an NPY file");
    support_files_end(&files);
}

static void sizes_that_the_file_cannot_hold_cost_nothing(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    refused(&files, write_npy(&files, "|u1", "False", "(2, 3, 4)", 23),
            "is truncated");
    refused(&files,
            write_npy(&files, "<f8", "False", "(99999, 99999, 99999)", 23),
            "is truncated");
    refused(&files,
            write_npy(&files, "<f8", "True",
                      "(9223372036854775807, 9223372036854775807, 9)", 23),
            "too large for any file");
    support_files_end(&files);
}

/* A box in the middle of 64^3, whichever axis is the fastest. */
static void a_box_costs_little_more_than_its_bytes(void **state) {
    (void)state;
    static const char *const orders[] = {"False", "True"};
    const snow_volume_options box = {.size = sizeof box,
                                     .crop = {{20, 30}, {0, 64}, {40, 44}}};
    support_files files;
    support_files_begin(&files);
    for (int i = 0; i < 2; i++) {
        static char bytes[200 + 64 * 64 * 64] = "\x93NUMPY\1";
        int length = snprintf(bytes + 10, 150,
                              "{'descr': '|u1', 'fortran_order': %s, "
                              "'shape': (64, 64, 64)}",
                              orders[i]);
        bytes[8] = (char)length;
        for (int k = 0; k < 64 * 64 * 64; k++)
            bytes[10 + length + k] = (char)(k / 64 + k % 64);
        const char *path = support_write(&files, "b.npy", bytes,
                                         10 + (size_t)length + 64 * 64 * 64);
        uint64_t before = snow_context_bytes_read(files.context);
        snow_volume *volume = support_opened(&files, path, &box);
        const uint8_t *voxels = snow_volume_voxels(volume);
        int k = i ? 20 * 64 * 64 + 40 : 40 * 64 * 64 + 20;
        assert_int_equal(voxels[0], (k / 64 + k % 64) & 255);
        /* 4 or 10 slices, and what a layer reads ahead for the header. */
        assert_true(snow_context_bytes_read(files.context) - before <
                    (i ? 10 : 4) * 64 * 64 + 70000);
        snow_volume_close(volume);
    }
    support_files_end(&files);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_last_index_is_x),
        cmocka_unit_test(fortran_order_is_the_same_array),
        cmocka_unit_test(time_comes_before_channel_before_z),
        cmocka_unit_test(a_short_last_axis_holds_components),
        cmocka_unit_test(halves_become_the_same_floats),
        cmocka_unit_test(truth_is_one),
        cmocka_unit_test(a_box_costs_little_more_than_its_bytes),
        cmocka_unit_test(what_is_no_volume_is_refused),
        cmocka_unit_test(sizes_that_the_file_cannot_hold_cost_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
