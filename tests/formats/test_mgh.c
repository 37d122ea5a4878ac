/* tests/formats/test_mgh.c - FreeSurfer's volumes: types, frames, places, and
 * what stands behind the voxels.  oracle_nibabel.py compares with nibabel. */
#include "support/files.h"

#include <math.h>

#define HEADER 284
#define COUNT(table) (sizeof(table) / sizeof *(table))

typedef struct mgh_file {
    unsigned char bytes[HEADER + 200];
    size_t size;
} mgh_file;

static void put(mgh_file *file, int at, uint32_t value) {
    for (int i = 0; i < 4; i++)
        file->bytes[at + i] = (unsigned char)(value >> (24 - 8 * i));
}

static void put_real(mgh_file *file, int at, float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put(file, at, bits);
}

/* 4 x 3 x 2 voxels of a type in two frames, counting bytes; voxels of
 * 1 x 2 x 3 mm, x to the back, y down, z to the left, around (10, 20, 30). */
static mgh_file make(uint32_t type, size_t bytes) {
    mgh_file file = {.size = HEADER + 48 * bytes};
    static const uint32_t sizes[] = {1, 4, 3, 2, 2};
    static const float place[] = {1,  2,  3, 0, -1, 0,  0, 0,
                                  -1, -1, 0, 0, 10, 20, 30};
    for (int i = 0; i < 5; i++)
        put(&file, 4 * i, sizes[i]);
    put(&file, 20, type);
    file.bytes[29] = 1;
    for (int i = 0; i < 15; i++)
        put_real(&file, 30 + 4 * i, place[i]);
    for (size_t i = 0; i < 48 * bytes; i++)
        file.bytes[HEADER + i] = (unsigned char)i;
    return file;
}

static const char *put_file(support_files *files, const mgh_file *file) {
    return support_write(files, "a.mgh", file->bytes, file->size);
}

static void every_type_and_frame_is_read(void **state) {
    support_files *files = *state;
    static const struct {
        uint32_t code;
        snow_type type;
    } types[] = {
        {0, SNOW_TYPE_UINT8}, {4, SNOW_TYPE_INT16}, {10, SNOW_TYPE_UINT16}};
    for (size_t i = 0; i < 2 * COUNT(types); i++) {
        const size_t size = snow_type_size(types[i / 2].type);
        mgh_file file = make(types[i / 2].code, size);
        const int64_t frame = (int64_t)i % 2;
        const snow_volume_options options = {
            .size = sizeof options, .time = frame, .crop = {{1, 3}, {2, 3}}};
        snow_volume *volume =
            support_opened(files, put_file(files, &file), &options);
        const snow_volume_info *info = snow_volume_get_info(volume);
        const unsigned char *voxels = snow_volume_voxels(volume);
        assert_int_equal(info->type, types[i / 2].type);
        assert_int_equal(info->times, 2);
        for (int n = 0; n < 4; n++) {
            const int at = (int)frame * 24 + n / 2 * 12 + 8 + 1 + n % 2;
            const int first =
                size == 1 ? voxels[n] : ((const uint16_t *)voxels)[n];
            assert_int_equal(first,
                             size == 1 ? at : 2 * at << 8 | (2 * at + 1));
        }
        snow_volume_close(volume);
    }
}

/* The centre is 2, 1.5 and 1 voxels from the first one, by nibabel too. */
static void the_place_is_that_of_the_centre(void **state) {
    support_files *files = *state;
    mgh_file file = make(0, 1);
    snow_volume *volume = support_opened(files, put_file(files, &file), NULL);
    support_expect_matrix(volume,
                          (double[]){0, 0, -3, 13, -1, 0, 0, 22, 0, -2, 0, 33});
    assert_true(snow_volume_get_info(volume)->medical);
    snow_volume_close(volume);
    for (int i = 0; i < 3; i++) { /* no place, or none that is one */
        file = make(0, 1);
        if (i == 0)
            file.bytes[29] = 0;
        else
            put_real(&file, 30, i == 1 ? 0 : NAN);
        *files->warnings = 0;
        volume = support_opened(files, put_file(files, &file), NULL);
        support_expect_matrix(
            volume, (double[]){-1, 0, 0, 2, 0, 0, 1, -1, 0, -1, 0, 1.5});
        assert_non_null(strstr(files->warnings, "no valid place"));
        snow_volume_close(volume);
    }
}

static void what_stands_behind_the_voxels_is_no_matter(void **state) {
    support_files *files = *state;
    const snow_volume_options last = {.size = sizeof last, .time = -1};
    unsigned char packed[600];
    mgh_file file = make(0, 1);
    file.size += 20;
    const size_t size = support_gzip(file.bytes, file.size, packed, 600);
    for (int i = 0; i < 2; i++) {
        const char *path = i ? support_write(files, "a.mgz", packed, size)
                             : put_file(files, &file);
        snow_volume_close(support_opened(files, path, &last));
        assert_string_equal(files->warnings, "");
    }
    packed[size - 6] ^= 1; /* the check sum */
    support_bad_file(files, support_write(files, "a.mgz", packed, size),
                     "damaged");
}

/* Without zeros in its middle it is known by its name alone. */
static void raw_data_are_no_header(void **state) {
    support_files *files = *state;
    const snow_volume_options last = {.size = sizeof last, .time = -1};
    mgh_file file = make(0, 1);
    file.bytes[200] = 1;
    snow_volume_close(support_opened(files, put_file(files, &file), &last));
    support_bad_file(files,
                     support_write(files, "a.bin", file.bytes, file.size),
                     "unknown format");
}

static void damaged_files_are_refused(void **state) {
    support_files *files = *state;
    static const struct {
        int at;
        uint32_t value;
        const char *part;
    } cases[] = {
        {0, 2, "not a header"},
        {4, 0, "not a header"},
        {16, UINT32_MAX, "not a header"},
        {20, 11, "not a header"},
        {20, 9, "type 9"},
        {4, INT32_MAX, "truncated"},
        {16, 3, "truncated"},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        mgh_file file = make(0, 1);
        put(&file, cases[i].at, cases[i].value);
        support_bad_file(files, put_file(files, &file), cases[i].part);
    }
    mgh_file file = make(3, 1); /* a fourth of its bytes */
    support_bad_file(files, put_file(files, &file), "truncated");
    for (int i = 4; i < 20; i += 4)
        put(&file, i, INT32_MAX);
    support_bad_file(files, put_file(files, &file), "larger than any file");
    file.size = 280;
    support_bad_file(files, put_file(files, &file), "too early");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        SUPPORT_TEST(every_type_and_frame_is_read),
        SUPPORT_TEST(the_place_is_that_of_the_centre),
        SUPPORT_TEST(what_stands_behind_the_voxels_is_no_matter),
        SUPPORT_TEST(raw_data_are_no_header),
        SUPPORT_TEST(damaged_files_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
