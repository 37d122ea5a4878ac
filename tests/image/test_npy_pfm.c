/* tests/image/test_npy_pfm.c - the two formats of plain floats: exact bytes,
 * every layout that is read, damage. */
#include "support/image.h"

#include <math.h>
#include <zlib.h>

/* A file in memory. */
typedef struct file {
    unsigned char bytes[4096];
    size_t size;
} file;

static void put(file *data, const void *bytes, size_t size) {
    assert_true(data->size + size <= sizeof data->bytes);
    memcpy(data->bytes + data->size, bytes, size);
    data->size += size;
}

/* Appends numbers as floats of `size` bytes, in either byte order. */
static void put_floats(file *data, const double *numbers, int count, int size,
                       bool big_endian) {
    for (int i = 0; i < count; i++) {
        float narrow = (float)numbers[i];
        unsigned char native[8];
        memcpy(native, size == 4 ? (const void *)&narrow : &numbers[i],
               (size_t)size);
        const uint16_t one = 1;
        bool reverse = big_endian == (*(const unsigned char *)&one == 1);
        for (int k = 0; k < size; k++)
            put(data, &native[reverse ? size - 1 - k : k], 1);
    }
}

/* An NPY file of version 1 with that header, not padded, and no samples. */
static file npy(const char *header) {
    file data = {.size = 0};
    size_t length = strlen(header);
    put(&data, "\x93NUMPY\1\0", 8);
    put(&data,
        (unsigned char[]){(unsigned char)(length & 255),
                          (unsigned char)(length >> 8)},
        2);
    put(&data, header, length);
    return data;
}

static file npy_of(const char *type, const char *shape) {
    char header[256];
    snprintf(header, sizeof header,
             "{'descr': '%s', 'fortran_order': False, 'shape': %s, }\n", type,
             shape);
    return npy(header);
}

static file pfm(const char *header) {
    file data = {.size = 0};
    put(&data, header, strlen(header));
    return data;
}

static void assert_refused(image_fixture *f, const file *data,
                           const char *reason) {
    support_assert_refused(f->context, data->bytes, data->size);
    if (!strstr(snow_context_message(f->context), reason))
        fail_msg("\"%s\" lacks \"%s\"", snow_context_message(f->context),
                 reason);
}

static void assert_pixels(image_fixture *f, const file *data, int width,
                          int height, const float *wanted) {
    snow_image *image = support_load(f->context, data->bytes, data->size);
    assert_int_equal(snow_image_width(image), width);
    assert_int_equal(snow_image_height(image), height);
    assert_memory_equal(snow_image_pixels(image), wanted,
                        (size_t)(width * height) * 16);
    snow_image_free(image);
}

/* A grey and a colour picture of 2 x 2. */
static snow_image *grey_picture(snow_context *context) {
    snow_image *image = support_blank(context, 2, 2, 2);
    memcpy(snow_image_pixels(image), ((float[]){1, 2, 3, 4, 5, 6, 7, 8}), 32);
    return image;
}

/* A picture's file has those bytes; the picture is freed. */
static void assert_saved(image_fixture *f, snow_image *image, const char *name,
                         const file *wanted) {
    const char *path = support_image_path(f, name);
    assert_int_equal(snow_image_save(image, path, NULL), SNOW_STATUS_OK);
    support_bytes got = support_read_file(path);
    assert_int_equal(got.size, wanted->size);
    assert_memory_equal(got.bytes, wanted->bytes, got.size);
    free(got.bytes);
    snow_image_free(image);
}

/* --- NPY ------------------------------------------------------------------ */

static void npy_bytes_are_as_numpy_writes_them(void **state) {
    image_fixture *f = *state;
    char header[128];
    snprintf(header, sizeof header, "%-117s\n",
             "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2, 4), }");
    file wanted = npy(header);
    put_floats(&wanted,
               (double[]){1, 1, 1, 2, 3, 3, 3, 4, 5, 5, 5, 6, 7, 7, 7, 8}, 16,
               4, false);
    assert_int_equal(wanted.size, 128 + 64);
    assert_saved(f, grey_picture(f->context), "a.npy", &wanted);
}

static void floats_survive_npy_bit_for_bit(void **state) {
    image_fixture *f = *state;
    static const int sizes[][2] = {
        {1, 1}, {1, 40}, {40, 1}, {32768, 1}, {1, 32768}};
    for (int i = 0; i < 5; i++) {
        snow_image *image =
            support_picture(f->context, sizes[i][0], sizes[i][1], 4, 3);
        float *pixels = snow_image_pixels(image);
        pixels[0] = NAN, pixels[1] = -INFINITY, pixels[2] = -0.0f;
        pixels[3] = 1e-44f;
        snow_image *again = support_round_trip(f, image, "a.npy", NULL);
        assert_int_equal(snow_image_width(again), sizes[i][0]);
        assert_int_equal(snow_image_height(again), sizes[i][1]);
        assert_memory_equal(pixels, snow_image_pixels(again),
                            (size_t)sizes[i][0] * (size_t)sizes[i][1] * 16);
        snow_image_free(image);
        snow_image_free(again);
    }
}

static void every_float_type_of_npy_is_read(void **state) {
    image_fixture *f = *state;
    static const char *const types[] = {"<f4", ">f4", "<f8", ">f8"};
    for (int i = 0; i < 4; i++) {
        file data = npy_of(types[i], "(1, 2, 4)");
        put_floats(&data, (double[]){1, 2, 3, 4, -5, 0.5, NAN, 8}, 8,
                   i < 2 ? 4 : 8, i % 2 == 1);
        assert_pixels(f, &data, 2, 1, (float[]){1, 2, 3, 4, -5, 0.5f, NAN, 8});
    }
}

static void fewer_channels_are_spread_over_four(void **state) {
    image_fixture *f = *state;
    static const char *const shapes[] = {"(2, 1)", "(2, 1, 1)", "(2, 1, 2)",
                                         "(2, 1, 3)"};
    static const int channels[] = {1, 1, 2, 3};
    static const float wanted[][8] = {{1, 1, 1, 1, 2, 2, 2, 1},
                                      {1, 1, 1, 1, 2, 2, 2, 1},
                                      {1, 1, 1, 2, 3, 3, 3, 4},
                                      {1, 2, 3, 1, 4, 5, 6, 1}};
    for (int i = 0; i < 4; i++) {
        file data = npy_of("<f4", shapes[i]);
        put_floats(&data, (double[]){1, 2, 3, 4, 5, 6}, 2 * channels[i], 4,
                   false);
        assert_pixels(f, &data, 1, 2, wanted[i]);
    }
}

static void keys_may_come_in_any_order_and_style(void **state) {
    image_fixture *f = *state;
    static const char *const headers[] = {
        "{'shape': (1, 1), 'descr': '<f4', 'fortran_order': False}",
        "{\"shape\":(1L,1L),\"fortran_order\":False,\"descr\":\"<f4\"}\n",
        "  { 'descr' : '<f4' ,\n 'fortran_order' : False , 'shape' : ( 1 , 1 "
        ",) "
        ", }  ",
    };
    for (int i = 0; i < 3; i++) {
        file data = npy(headers[i]);
        put_floats(&data, (double[]){9}, 1, 4, false);
        assert_pixels(f, &data, 1, 1, (float[]){9, 9, 9, 1});
    }
}

static void version_2_has_a_longer_length(void **state) {
    image_fixture *f = *state;
    file data = npy_of("<f4", "(1, 1)");
    file longer = {.size = 0};
    put(&longer, data.bytes, 10);
    put(&longer, "\0\0", 2);
    put(&longer, data.bytes + 10, data.size - 10);
    longer.bytes[6] = 2;
    put_floats(&longer, (double[]){9}, 1, 4, false);
    assert_pixels(f, &longer, 1, 1, (float[]){9, 9, 9, 1});
    longer.bytes[6] = 4;
    assert_refused(f, &longer, "version");
    longer.bytes[6] = 2;
    longer.bytes[11] = 0xff;
    assert_refused(f, &longer, "too long");
}

static void other_arrays_are_refused_with_the_reason(void **state) {
    image_fixture *f = *state;
    static const char *const cases[][3] = {
        {"<i4", "(1, 1, 4)", "float32"},
        {"|u1", "(1, 1, 4)", "float32"},
        {"<f2", "(1, 1, 4)", "float32"},
        {"<f44", "(1, 1, 4)", "float32"},
        {"=f4", "(1, 1, 4)", "float32"},
        {"<f4", "(4,)", "shape"},
        {"<f4", "()", "shape"},
        {"<f4", "(1, 1, 5)", "shape"},
        {"<f4", "(1, 1, 0)", "shape"},
        {"<f4", "(1, 1, 1, 4)", "shape"},
        {"<f4", "(1, 2, 3, 4, 5)", "shape"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        file data = npy_of(cases[i][0], cases[i][1]);
        put(&data, (char[64]){0}, 64);
        assert_refused(f, &data, cases[i][2]);
    }
    file data = npy("{'descr': '<f4', 'fortran_order': True, 'shape': (1, 1)}");
    put(&data, (char[64]){0}, 64);
    assert_refused(f, &data, "Fortran");
}

static void damaged_npy_headers_are_refused(void **state) {
    image_fixture *f = *state;
    static const char *const headers[] = {
        "",
        "{}",
        "{'descr': '<f4', 'fortran_order': False}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1)",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (1 1)}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (-1, 1)}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (1.5, 1)}",
        "{'descr': '<f4', 'fortran_order': 0, 'shape': (1, 1)}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1)} x",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1), 'a': 1}",
        "{'descr': '<f4 'fortran_order': False, 'shape': (1, 1)}",
        "{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': (1, 1)}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': "
        "(1, 99999999999999999999)}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': "
        "(1, 9999999999999999999)}",
    };
    for (size_t i = 0; i < sizeof headers / sizeof *headers; i++) {
        file data = npy(headers[i]);
        put(&data, (char[64]){0}, 64);
        assert_refused(f, &data, "header");
    }
    file data = npy_of("<f4", "(1, 1)");
    data.bytes[data.size - 1] = 0; /* the newline */
    put(&data, (char[4]){0}, 4);
    assert_refused(f, &data, "header");
}

/* --- PFM ------------------------------------------------------------------ */

static void pfm_rows_go_from_the_bottom_up(void **state) {
    image_fixture *f = *state;
    snow_image *image = support_blank(f->context, 2, 2, 4);
    for (int i = 0; i < 16; i++)
        snow_image_pixels(image)[i] = (float)i;
    file wanted = pfm("PF\n2 2\n-1.0\n");
    put_floats(&wanted, (double[]){8, 9, 10, 12, 13, 14, 0, 1, 2, 4, 5, 6}, 12,
               4, false);
    assert_saved(f, image, "a.pfm", &wanted);
    assert_pixels(
        f, &wanted, 2, 2,
        (float[]){0, 1, 2, 1, 4, 5, 6, 1, 8, 9, 10, 1, 12, 13, 14, 1});
}

static void grey_pictures_become_colour_in_pfm(void **state) {
    image_fixture *f = *state;
    snow_image *image = grey_picture(f->context);
    snow_image *again = support_round_trip(f, image, "a.pfm", NULL);
    const float wanted[] = {1, 1, 1, 1, 3, 3, 3, 1, 5, 5, 5, 1, 7, 7, 7, 1};
    assert_memory_equal(snow_image_pixels(again), wanted, sizeof wanted);
    snow_image_free(image);
    snow_image_free(again);
}

static void both_kinds_and_byte_orders_of_pfm_are_read(void **state) {
    image_fixture *f = *state;
    static const char *const headers[] = {"PF 1 2 -1\n", "PF\n1 2\n1.0\n",
                                          "Pf\n1\n2\n-1\n",
                                          "Pf\t1 2\r\n+1.0e0 "};
    for (int i = 0; i < 4; i++) {
        file data = pfm(headers[i]);
        put_floats(&data, (double[]){1, 2, 3, 4, 5, 6}, i < 2 ? 6 : 2, 4,
                   i % 2 == 1);
        assert_pixels(f, &data, 1, 2,
                      i < 2 ? (float[]){4, 5, 6, 1, 1, 2, 3, 1}
                            : (float[]){2, 2, 2, 1, 1, 1, 1, 1});
        assert_string_equal(f->warning, "");
    }
}

static void a_scale_of_pfm_is_told_not_applied(void **state) {
    image_fixture *f = *state;
    file data = pfm("Pf\n1 1\n-2.5\n");
    put_floats(&data, (double[]){3}, 1, 4, false);
    assert_pixels(f, &data, 1, 1, (float[]){3, 3, 3, 1});
    assert_non_null(strstr(f->warning, "2.5"));
}

static void damaged_pfm_headers_are_refused(void **state) {
    image_fixture *f = *state;
    static const char *const headers[] = {
        "PF\n",
        "PF\n1",
        "PF\n1 1\n",
        "PF\n1 1\n0\n",
        "PF\n1 1\nnan\n",
        "PF\n1 1\n-1.0x\n",
        "PF\n1,1\n-1\n",
        "PF\nx 1\n-1\n",
        "PF\n99999999999999999999 1\n-1\n",
        "PF\n1 1\n-1.00000000000000000000000000000000000000\n",
    };
    for (size_t i = 0; i < sizeof headers / sizeof *headers; i++) {
        file data = pfm(headers[i]);
        assert_refused(f, &data, "PFM header");
    }
}

/* --- both ----------------------------------------------------------------- */

static void files_cut_anywhere_are_refused(void **state) {
    image_fixture *f = *state;
    file whole[2] = {npy_of("<f4", "(2, 2, 4)"), pfm("PF\n2 2\n-1.0\n")};
    for (int i = 0; i < 2; i++) {
        put_floats(&whole[i], (double[16]){1, 2, 3}, i ? 12 : 16, 4, false);
        for (size_t size = 0; size < whole[i].size; size++) {
            unsigned char *cut = malloc(size + 1);
            memcpy(cut, whole[i].bytes, size);
            support_assert_refused(f->context, cut, size);
            free(cut);
        }
        snow_image_free(
            support_load(f->context, whole[i].bytes, whole[i].size));
        assert_string_equal(f->warning, "");
        put(&whole[i], "xyz", 3);
        snow_image_free(
            support_load(f->context, whole[i].bytes, whole[i].size));
        assert_non_null(strstr(f->warning, "3 bytes"));
        f->warning[0] = 0;
    }
}

static void sizes_the_file_cannot_hold_cost_no_memory(void **state) {
    (void)state;
    static const char *const sizes[][2] = {
        {"32768", "32768"},
        {"32769", "1"},
        {"1", "32769"},
        {"0", "1"},
        {"1", "0"},
        {"4294967297", "1"},
        {"4294967296", "4294967296"},
        {"9223372036854775807", "9223372036854775807"},
        {"3037000500", "3037000500"},
    };
    for (size_t i = 0; i < 2 * sizeof sizes / sizeof *sizes; i++) {
        const char *const *size = sizes[i / 2];
        char text[128];
        snprintf(text, sizeof text, i % 2 ? "(%s, %s, 4)" : "PF\n%s %s\n-1\n",
                 size[0], size[1]);
        file data = i % 2 ? npy_of("<f4", text) : pfm(text);
        put(&data, (char[64]){0}, 64);
        snow_context *context = support_context();
        support_assert_refused(context, data.bytes, data.size);
        assert_true(snow_context_peak_bytes(context) < 100000);
        snow_context_free(context);
    }
}

static void a_gzipped_picture_is_read(void **state) {
    image_fixture *f = *state;
    const char *path = support_image_path(f, "a.npy.gz");
    file data = npy_of("<f4", "(1, 1)");
    put_floats(&data, (double[]){9}, 1, 4, false);
    gzFile packed = gzopen(path, "wb");
    assert_int_equal(gzwrite(packed, data.bytes, (unsigned)data.size),
                     data.size);
    gzclose(packed);
    snow_image *image = NULL;
    assert_int_equal(snow_image_load(f->context, path, &image), SNOW_STATUS_OK);
    assert_true(snow_image_pixels(image)[0] == 9);
    snow_image_free(image);
}

static void a_gzip_stream_with_a_wrong_sum_is_refused(void **state) {
    image_fixture *f = *state;
    const char *path = support_image_path(f, "a.pfm.gz");
    file data = pfm("Pf\n1 1\n-1\n1234");
    gzFile packed = gzopen(path, "wb");
    assert_int_equal(gzwrite(packed, data.bytes, (unsigned)data.size),
                     data.size);
    gzclose(packed);
    support_bytes bytes = support_read_file(path);
    snow_image_free(support_load(f->context, bytes.bytes, bytes.size));
    bytes.bytes[bytes.size - 8] ^= 1; /* CRC-32, then the length */
    support_assert_refused(f->context, bytes.bytes, bytes.size);
    free(bytes.bytes);
}

#define TEST(name)                                             \
    cmocka_unit_test_setup_teardown(name, support_image_setup, \
                                    support_image_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(npy_bytes_are_as_numpy_writes_them),
        TEST(floats_survive_npy_bit_for_bit),
        TEST(every_float_type_of_npy_is_read),
        TEST(fewer_channels_are_spread_over_four),
        TEST(keys_may_come_in_any_order_and_style),
        TEST(version_2_has_a_longer_length),
        TEST(other_arrays_are_refused_with_the_reason),
        TEST(damaged_npy_headers_are_refused),
        TEST(pfm_rows_go_from_the_bottom_up),
        TEST(grey_pictures_become_colour_in_pfm),
        TEST(both_kinds_and_byte_orders_of_pfm_are_read),
        TEST(a_scale_of_pfm_is_told_not_applied),
        TEST(damaged_pfm_headers_are_refused),
        TEST(files_cut_anywhere_are_refused),
        TEST(sizes_the_file_cannot_hold_cost_no_memory),
        TEST(a_gzipped_picture_is_read),
        TEST(a_gzip_stream_with_a_wrong_sum_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
