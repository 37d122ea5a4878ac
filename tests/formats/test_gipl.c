/* tests/formats/test_gipl.c - GIPL volumes: types, byte orders, and the places
 * that ITK and MIRTK give them. */
#include "support/files.h"

#define HEADER 256
#define COUNT(table) (sizeof(table) / sizeof *(table))

typedef struct gipl_file {
    unsigned char bytes[HEADER + 400];
    size_t size;
    bool little;
} gipl_file;

static void put(gipl_file *file, int at, int size, uint64_t value) {
    for (int i = 0; i < size; i++)
        file->bytes[at + (file->little ? i : size - 1 - i)] =
            (unsigned char)(value >> (8 * i));
}

static void put_real(gipl_file *file, int at, int size, double value) {
    const float narrow = (float)value;
    uint64_t bits = 0;
    uint32_t few = 0;
    memcpy(&bits, &value, sizeof bits);
    memcpy(&few, &narrow, sizeof few);
    put(file, at, size, size == 8 ? bits : few);
}

/* 4 x 3 x 2 voxels of 1 x 2 x 3 mm and a type, with two time steps of counting
 * bytes; the origin is (10, 20, 30). */
static gipl_file make(bool little, uint64_t type, size_t bytes) {
    gipl_file file = {.size = HEADER + 48 * bytes, .little = little};
    static const uint64_t sizes[] = {4, 3, 2, 2};
    for (int i = 0; i < 4; i++)
        put(&file, 2 * i, 2, sizes[i]);
    put(&file, 8, 2, type);
    for (int i = 0; i < 3; i++) {
        put_real(&file, 10 + 4 * i, 4, 1 + i);
        put_real(&file, 204 + 8 * i, 8, 10 * (1 + i));
    }
    put(&file, 252, 4, little ? 719555000 : 4026526128);
    for (size_t i = 0; i < 48 * bytes; i++)
        file.bytes[HEADER + i] = (unsigned char)i;
    return file;
}

static const char *put_file(support_files *files, const gipl_file *file) {
    return support_write(files, "a.gipl", file->bytes, file->size);
}

static void every_type_is_read_in_both_byte_orders(void **state) {
    support_files *files = *state;
    static const struct {
        uint64_t code;
        snow_type type;
    } types[] = {{1, SNOW_TYPE_UINT8},   {7, SNOW_TYPE_INT8},
                 {8, SNOW_TYPE_UINT8},   {15, SNOW_TYPE_INT16},
                 {16, SNOW_TYPE_UINT16}, {31, SNOW_TYPE_UINT32},
                 {32, SNOW_TYPE_INT32},  {64, SNOW_TYPE_FLOAT32},
                 {65, SNOW_TYPE_FLOAT64}};
    for (size_t i = 0; i < 2 * COUNT(types); i++) {
        const size_t size = snow_type_size(types[i / 2].type);
        gipl_file file = make(i % 2, types[i / 2].code, size);
        const snow_volume_options options = {
            .size = sizeof options, .time = 1, .crop = {{1, 3}, {2, 3}}};
        snow_volume *volume =
            support_opened(files, put_file(files, &file), &options);
        const unsigned char *voxels = snow_volume_voxels(volume);
        assert_int_equal(snow_volume_get_info(volume)->type, types[i / 2].type);
        for (size_t n = 0; n < 4 * size; n++) {
            const size_t voxel = 24 + n / size / 2 * 12 + 8 + 1 + n / size % 2,
                         byte = n % size;
            assert_int_equal(voxels[n],
                             (voxel * size + (i % 2 ? byte : size - 1 - byte)) &
                                 255);
        }
        snow_volume_close(volume);
    }
}

/* As ITK has it: the first voxel, in LPS. */
static void the_origin_is_the_first_voxel(void **state) {
    support_files *files = *state;
    gipl_file file = make(false, 8, 1);
    snow_volume *volume = support_opened(files, put_file(files, &file), NULL);
    support_expect_matrix(
        volume, (double[]){-1, 0, 0, -10, 0, -2, 0, -20, 0, 0, 3, 30});
    assert_false(snow_volume_get_info(volume)->medical);
    assert_string_equal(snow_volume_get_info(volume)->unit, "mm");
    snow_volume_close(volume);
    put_real(&file, 14, 4, 0);
    put(&file, 6, 2, 0);
    *files->warnings = 0;
    volume = support_opened(files, put_file(files, &file), NULL);
    assert_true(snow_volume_get_info(volume)->spacing[1] == 1);
    assert_non_null(strstr(files->warnings, "taken as 1"));
    snow_volume_close(volume);
}

/* As MIRTK has it: the centre, in RAS; x runs along y and y along z. */
static void the_origin_of_mirtk_is_the_centre(void **state) {
    support_files *files = *state;
    gipl_file file = make(false, 8, 1);
    put(&file, 244, 4, 815);
    put_real(&file, 110, 4, 1);
    put_real(&file, 130, 4, 1);
    snow_volume *volume = support_opened(files, put_file(files, &file), NULL);
    support_expect_matrix(volume,
                          (double[]){0, 0, 3, 8.5, 1, 0, 0, 18.5, 0, 2, 0, 28});
    assert_true(snow_volume_get_info(volume)->medical);
    snow_volume_close(volume);
    put_real(&file, 110, 4, 0);
    support_bad_file(files, put_file(files, &file), "in one plane");
}

static void damaged_files_are_refused(void **state) {
    support_files *files = *state;
    gipl_file file = make(false, 192, 1);
    support_bad_file(files, put_file(files, &file), "type 192");
    file = make(false, 64, 1);
    support_bad_file(files, put_file(files, &file), "truncated");
    file.bytes[255] ^= 1;
    support_bad_file(files, put_file(files, &file), "not a GIPL header");
    file.size = 200;
    support_bad_file(files, put_file(files, &file), "too early");
    file = make(false, 65, 1);
    for (int i = 0; i < 8; i++)
        file.bytes[i] = 255;
    support_bad_file(files, put_file(files, &file), "");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        SUPPORT_TEST(every_type_is_read_in_both_byte_orders),
        SUPPORT_TEST(the_origin_is_the_first_voxel),
        SUPPORT_TEST(the_origin_of_mirtk_is_the_centre),
        SUPPORT_TEST(damaged_files_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
