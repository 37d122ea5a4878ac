/* tests/volume/test_box.c - a box of a volume: equal to that of the whole for
 * every format that crops (DEN's boxes are in tests/formats/test_den.c), and
 * little more than it is read. */
#include "support/files.h"

#include "volume/volume.h"

#include <fcntl.h>
#include <math.h>
#include <unistd.h>

/* Sizes that differ along the axes, 11 x 9 x 7, and time steps. */
#define VOXELS (11 * 9 * 7)
#define TIMES 3

/* Boxes of every kind of run: rows, whole rows, whole slices, all; ends left
 * out; the last voxel. */
static const int64_t boxes[][3][2] = {
    {{2, 5}, {3, 7}, {1, 6}},   {{0, 11}, {2, 5}, {1, 4}},
    {{0, 11}, {0, 9}, {2, 6}},  {{0, 11}, {0, 9}, {0, 7}},
    {{10, 11}, {8, 9}, {6, 7}}, {{0, 1}, {0, 1}, {0, 1}},
    {{4, 0}, {0, 0}, {5, 0}},   {{0, 6}, {8, 9}, {0, 7}},
};
#define BOXES (sizeof boxes / sizeof *boxes)

/* Every voxel of the box is that voxel of the whole, and lies where it lay. */
static void compare(const snow_volume *whole, const snow_volume *box,
                    const int64_t crop[3][2]) {
    const snow_volume_info *a = snow_volume_get_info(whole);
    const snow_volume_info *b = snow_volume_get_info(box);
    size_t size = snow_type_size(a->type);
    const char *from = snow_volume_voxels(whole), *to = snow_volume_voxels(box);
    assert_int_equal(a->type, b->type);
    assert_int_equal(a->time, b->time);
    assert_int_equal(a->times, b->times);
    for (int i = 0; i < 3; i++) {
        int64_t end = crop[i][1] ? crop[i][1] : a->dims[i];
        double place = a->matrix[i][3];
        assert_int_equal(b->dims[i], end - crop[i][0]);
        assert_true(a->spacing[i] == b->spacing[i]);
        for (int j = 0; j < 3; j++)
            place += a->matrix[i][j] * (double)crop[j][0];
        assert_true(fabs(b->matrix[i][3] - place) <= 1e-9 * (1 + fabs(place)));
    }
    for (int64_t z = 0; z < b->dims[2]; z++)
        for (int64_t y = 0; y < b->dims[1]; y++) {
            int64_t row =
                ((crop[2][0] + z) * a->dims[1] + crop[1][0] + y) * a->dims[0] +
                crop[0][0];
            size_t bytes = (size_t)b->dims[0] * size;
            assert_memory_equal(from + (size_t)row * size, to, bytes);
            to += bytes;
        }
}

/* All boxes of a file, at every time step, and what inspect tells of them. */
static void check_file(support_files *files, const char *name,
                       const snow_volume_options *given, int64_t times) {
    char path[256];
    snprintf(path, sizeof path, "%s",
             strchr(name, ':') ? name : support_path(files, name));
    snow_volume_options options = {.size = sizeof options};
    if (given)
        options = *given;
    for (options.time = 0; options.time < times; options.time++) {
        memset(options.crop, 0, sizeof options.crop);
        snow_volume *whole = support_opened(files, path, &options);
        assert_int_equal(snow_volume_get_info(whole)->times, times);
        for (size_t i = 0; i < BOXES; i++) {
            memcpy(options.crop, boxes[i], sizeof options.crop);
            snow_volume *box = support_opened(files, path, &options);
            compare(whole, box, boxes[i]);
            snow_volume_info info = {.size = sizeof info};
            assert_int_equal(
                snow_volume_inspect(files->context, path, &options, &info),
                SNOW_STATUS_OK);
            const snow_volume_info *own = snow_volume_get_info(box);
            assert_memory_equal(info.dims, own->dims, sizeof info.dims);
            assert_memory_equal(info.matrix, own->matrix, sizeof info.matrix);
            assert_memory_equal(info.spacing, own->spacing,
                                sizeof info.spacing);
            assert_int_equal(info.type, own->type);
            assert_int_equal(info.times, own->times);
            assert_string_equal(info.format, own->format);
            snow_volume_close(box);
        }
        snow_volume_close(whole);
    }
}

/* Random bytes that are no NaN in any type, for TIMES steps. */
static const unsigned char *noise(size_t size) {
    static unsigned char bytes[VOXELS * TIMES * 8];
    uint64_t state = 7;
    for (size_t i = 0; i < size; i++)
        bytes[i] = (unsigned char)(support_random(&state) % 120);
    return bytes;
}

/* A file of a text and the voxels behind it, packed or not, in one piece. */
static void put(support_files *files, const char *name, const char *header,
                size_t size, bool packed) {
    static char bytes[VOXELS * TIMES * 8 + 1000];
    size_t used = strlen(header);
    memcpy(bytes, header, used);
    if (packed)
        used +=
            support_gzip(noise(size), size, bytes + used, sizeof bytes - used);
    else {
        memcpy(bytes + used, noise(size), size);
        used += size;
    }
    support_write(files, name, bytes, used);
}

static void check_raw(support_files *files, snow_type type, bool big) {
    size_t size = VOXELS * snow_type_size(type) + 5;
    snow_volume_options given = {
        .size = sizeof given, .dims = {11, 9, 7}, .type = type, .offset = 5};
    given.endian = big ? SNOW_ENDIAN_BIG : SNOW_ENDIAN_LITTLE;
    put(files, "a.raw", "", size, false);
    put(files, "a.raw.gz", "", size, true);
    check_file(files, "a.raw", &given, 1);
    check_file(files, "a.raw.gz", &given, 1);
}

static void check_nrrd(support_files *files, snow_type type, bool big) {
    static const char *const encodings[] = {"raw", "gzip"};
    size_t size = VOXELS * TIMES * snow_type_size(type);
    for (int i = 0; i < 4; i++) {
        char header[512];
        snprintf(header, sizeof header,
                 "NRRD0004\ntype: %s\ndimension: 4\nsizes: 11 9 7 %d\n"
                 "kinds: domain domain domain time\nspacings: 1 2 0.5 1\n"
                 "endian: %s\nencoding: %s\n%s\n",
                 snow_type_name(type), TIMES, big ? "big" : "little",
                 encodings[i % 2], i < 2 ? "" : "byte skip: -1\n");
        char name[32];
        snprintf(name, sizeof name, "n%d.nrrd", i);
        put(files, name, header, size, i % 2);
        check_file(files, name, NULL, TIMES);
    }
}

static void check_metaimage(support_files *files, snow_type type, bool big) {
    static const char *const names[] = {
        "?",         "MET_CHAR",      "MET_UCHAR",
        "MET_SHORT", "MET_USHORT",    "MET_INT",
        "MET_UINT",  "MET_LONG_LONG", "MET_ULONG_LONG",
        "MET_FLOAT", "MET_DOUBLE"};
    size_t size = VOXELS * TIMES * snow_type_size(type);
    for (int packed = 0; packed < 2; packed++) {
        char header[512];
        snprintf(header, sizeof header,
                 "NDims = 4\nDimSize = 11 9 7 %d\nElementSpacing = 1 2 0.5 1\n"
                 "Offset = 3 -4 5 0\nElementType = %s\n"
                 "BinaryDataByteOrderMSB = %s\nCompressedData = %s\n"
                 "ElementDataFile = LOCAL\n",
                 TIMES, names[type], big ? "True" : "False",
                 packed ? "True" : "False");
        put(files, "m.mha", header, size, packed);
        check_file(files, "m.mha", NULL, TIMES);
    }
}

/* Turns the bytes of a NIfTI-1 header's fields. */
static void turn(unsigned char *at, size_t size, int count) {
    for (int n = 0; n < count; n++, at += size)
        for (size_t i = 0; i < size / 2; i++) {
            unsigned char byte = at[i];
            at[i] = at[size - 1 - i];
            at[size - 1 - i] = byte;
        }
}

/* The library's own .nii as a start; one more axis makes it a series. */
static void check_nifti(support_files *files, snow_type type, bool big) {
    static unsigned char bytes[VOXELS * TIMES * 8 + 352];
    size_t size = VOXELS * TIMES * snow_type_size(type);
    snow_volume_info info = {
        .size = sizeof info, .dims = {11, 9, 7}, .type = type};
    snow_volume *volume;
    char path[256];
    snprintf(path, sizeof path, "%s", support_path(files, "a.nii"));
    assert_int_equal(
        snow_volume_wrap(files->context, &info, noise(size), &volume),
        SNOW_STATUS_OK);
    assert_int_equal(snow_volume_save(volume, path, true), SNOW_STATUS_OK);
    snow_volume_close(volume);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    assert_int_equal(fread(bytes, 1, 352, file), 352);
    fclose(file);
    const int16_t dim[5] = {4, 11, 9, 7, TIMES};
    memcpy(bytes + 40, dim, sizeof dim);
    if (big) {
        turn(bytes, 4, 1);
        turn(bytes + 40, 2, 8);
        turn(bytes + 70, 2, 2);
        turn(bytes + 76, 4, 11);
        turn(bytes + 252, 2, 2);
        turn(bytes + 256, 4, 18);
    }
    memcpy(bytes + 352, noise(size), size);
    support_write(files, "t.nii", bytes, 352 + size);
    check_file(files, "t.nii", NULL, TIMES);
    static unsigned char packed[sizeof bytes + 1000];
    support_write(files, "t.nii.gz", packed,
                  support_gzip(bytes, 352 + size, packed, sizeof packed));
    check_file(files, "t.nii.gz", NULL, TIMES);
}

static void a_box_equals_that_of_the_whole(void **state) {
    static void (*const checks[])(support_files *, snow_type, bool) = {
        check_raw, check_nrrd, check_metaimage, check_nifti};
    for (int type = SNOW_TYPE_INT8; type <= SNOW_TYPE_FLOAT64; type++)
        for (int way = 0; way < 8; way++)
            checks[way / 2](*state, (snow_type)type, way % 2);
}

static void a_box_of_numbers_in_text_equals_that_of_the_whole(void **state) {
    support_files *files = *state;
    char text[VOXELS * 8], line[VOXELS * 8 + 300];
    size_t used = 0;
    for (int i = 0; i < VOXELS; i++)
        used += (size_t)snprintf(text + used, sizeof text - used, "%d%c",
                                 i * 3 - 500, i % 11 == 10 ? '\n' : ' ');
    snprintf(line, sizeof line,
             "NRRD0001\ntype: short\ndimension: 3\nsizes: 11 9 7\n"
             "encoding: ascii\n\n%s",
             text);
    support_write_text(files, "t.nrrd", line);
    check_file(files, "t.nrrd", NULL, 1);
    snprintf(line, sizeof line,
             "NDims = 3\nDimSize = 11 9 7\nElementType = MET_SHORT\n"
             "BinaryData = False\nElementDataFile = LOCAL\n%s",
             text);
    support_write_text(files, "t.mha", line);
    check_file(files, "t.mha", NULL, 1);
}

#define NRRD_OF_FILES                                                     \
    "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 11 9 7\nencoding: raw\n" \
    "data file: "
#define META_OF_FILES \
    "NDims = 3\nDimSize = 11 9 7\nElementType = MET_UCHAR\nElementDataFile = "
#define LIST "LIST\ns0.raw\ns1.raw\ns2.raw\ns3.raw\ns4.raw\ns5.raw\ns6.raw\n"
#define PATTERN "s%d.raw 0 6 1\n"

/* A file for each row of slice 0 and each whole slice: pieces of one array. */
static void write_slices(support_files *files) {
    for (int z = 0; z < 7; z++) {
        char name[32];
        snprintf(name, sizeof name, "s%d.raw", z);
        support_write(files, name, noise(VOXELS) + 99 * z, 99);
    }
}

static void a_box_reaches_over_the_files_of_a_series(void **state) {
    static const char *const series[][2] = {{"l.nhdr", NRRD_OF_FILES LIST},
                                            {"p.nhdr", NRRD_OF_FILES PATTERN},
                                            {"l.mhd", META_OF_FILES LIST},
                                            {"p.mhd", META_OF_FILES PATTERN}};
    support_files *files = *state;
    write_slices(files);
    for (size_t n = 0; n < 4; n++) {
        support_write_text(files, series[n][0], series[n][1]);
        check_file(files, series[n][0], NULL, 1);
    }
}

static void files_outside_the_box_are_not_opened(void **state) {
    static const char *const series[][2] = {{"p.nhdr", NRRD_OF_FILES PATTERN},
                                            {"p.mhd", META_OF_FILES PATTERN}};
    support_files *files = *state;
    write_slices(files);
    unlink(support_path(files, "s1.raw"));
    for (size_t n = 0; n < 2; n++) {
        const char *path =
            support_write_text(files, series[n][0], series[n][1]);
        snow_volume_options options = {.size = sizeof options,
                                       .crop = {{0, 3}, {0, 3}, {2, 7}}};
        snow_volume_close(support_opened(files, path, &options));
        options.crop[2][0] = 1;
        support_refused(files, path, &options, SNOW_STATUS_BAD_INPUT, "s1.raw",
                        300000);
    }
}

static void a_box_of_a_phantom_equals_that_of_the_whole(void **state) {
    support_files *files = *state;
    const snow_volume_options given = {
        .size = sizeof given, .dims = {11, 9, 7}, .spacing = {0.5, 0, 3}};
    for (size_t i = 0; snow_phantom_name(i); i++) {
        char name[64];
        snprintf(name, sizeof name, "phantom:%s", snow_phantom_name(i));
        check_file(files, name, &given, 1);
    }
}

static void the_box_moves_by_the_spacing_that_was_given(void **state) {
    support_files *files = *state;
    put(files, "a.raw", "", VOXELS, false);
    const snow_volume_options options = {.size = sizeof options,
                                         .dims = {11, 9, 7},
                                         .type = SNOW_TYPE_UINT8,
                                         .spacing = {2, 3, 4},
                                         .crop = {{1, 3}, {2, 4}, {3, 5}}};
    snow_volume *volume =
        support_opened(files, support_path(files, "a.raw"), &options);
    const snow_volume_info *info = snow_volume_get_info(volume);
    assert_true(info->matrix[0][3] == 2 && info->matrix[1][3] == 6 &&
                info->matrix[2][3] == 12);
    snow_volume_close(volume);
}

static void a_box_outside_the_volume_is_refused_with_its_sizes(void **state) {
    support_files *files = *state;
    put(files, "a.raw", "", VOXELS, false);
    static const int64_t bad[][3][2] = {
        {{0, 12}, {0, 9}, {0, 7}},         {{3, 3}, {0, 9}, {0, 7}},
        {{5, 3}, {0, 9}, {0, 7}},          {{0, 11}, {-1, 9}, {0, 7}},
        {{0, 11}, {0, 9}, {7, 0}},         {{0, 11}, {0, 9}, {0, INT64_MAX}},
        {{0, 11}, {INT64_MIN, 9}, {0, 7}}, {{0, 11}, {0, -9}, {0, 7}}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        snow_volume_options options = {.size = sizeof options,
                                       .dims = {11, 9, 7},
                                       .type = SNOW_TYPE_UINT8};
        memcpy(options.crop, bad[i], sizeof options.crop);
        support_refused(files, support_path(files, "a.raw"), &options,
                        SNOW_STATUS_BAD_USAGE, "11x9x7", 70000);
        options.type = SNOW_TYPE_NONE;
        snow_volume *volume;
        assert_int_equal(
            snow_volume_open(files->context, "phantom:cube", &options, &volume),
            SNOW_STATUS_BAD_USAGE);
        assert_non_null(strstr(snow_context_message(files->context), "11x9x7"));
    }
}

/* --- how much is read ----------------------------------------------------- */

/* A file of `size` bytes, all holes but what is written at `at`; false where
 * the disk makes none. */
static bool put_sparse(const char *path, const char *header, off_t size,
                       off_t at, const void *bytes, size_t count) {
    int file = open(path, O_CREAT | O_WRONLY, 0600);
    assert_true(file >= 0);
    bool made = ftruncate(file, size) == 0;
    if (made) {
        assert_true(pwrite(file, header, strlen(header), 0) >= 0);
        assert_true(pwrite(file, bytes, count, at) == (ssize_t)count);
    }
    close(file);
    return made;
}

/* 3000 x 1000 x 800 voxels of 16 bits: 2.4e9 of them, 4.8e9 bytes.  Of a box of
 * 20^3 the 400 rows of 40 bytes are read, and what a look at the header takes.
 */
static void check_large(support_files *files, const char *name,
                        const char *header, const snow_volume_options *given) {
    const int64_t first[3] = {2970, 970, 770};
    char path[256];
    snprintf(path, sizeof path, "%s", support_path(files, name));
    off_t begin = (off_t)strlen(header);
    off_t at = begin + 2 * ((first[2] * 1000 + first[1]) * 3000 + first[0]);
    const uint16_t marks[20] = {1, 2, 3, [19] = 777};
    if (!put_sparse(path, header, begin + (off_t)4800000000, at, marks,
                    sizeof marks))
        skip();
    snow_volume_options options = *given;
    for (int i = 0; i < 3; i++) {
        options.crop[i][0] = first[i];
        options.crop[i][1] = first[i] + 20;
    }
    uint64_t before = snow_context_bytes_read(files->context);
    snow_volume *volume = support_opened(files, path, &options);
    uint64_t read = snow_context_bytes_read(files->context) - before;
    assert_memory_equal(snow_volume_voxels(volume), marks, sizeof marks);
    snow_volume_statistics m = {.size = sizeof m};
    snow_volume_get_statistics(volume, &m);
    assert_true(m.voxels == 8000 && m.sum == 783);
    assert_in_range(read, 16000, 65536 + 16000);
    snow_volume_close(volume);
    unlink(path);
}

static void little_more_than_the_box_is_read_of_a_huge_file(void **state) {
    support_files *files = *state;
    const snow_volume_options given = {.size = sizeof given,
                                       .dims = {3000, 1000, 800},
                                       .type = SNOW_TYPE_UINT16};
    check_large(files, "big.raw", "", &given);
    check_large(files, "big.nrrd",
                "NRRD0004\ntype: ushort\ndimension: 3\nsizes: 3000 1000 800\n"
                "endian: little\nencoding: raw\n\n",
                &(snow_volume_options){.size = sizeof(snow_volume_options)});
}

/* 0.9 MB: of a box of 30 x 20 x 10 voxels the gaps between rows are read, as
 * they are small; those between slices are not. */
static void near_rows_are_read_in_one_go_and_far_slices_are_not(void **state) {
    support_files *files = *state;
    char *bytes = calloc(1, 900000);
    const char *path = support_write(files, "a.raw", bytes, 900000);
    free(bytes);
    const snow_volume_options options = {.size = sizeof options,
                                         .dims = {100, 90, 100},
                                         .type = SNOW_TYPE_UINT8,
                                         .crop = {{50, 80}, {5, 25}, {80, 90}}};
    uint64_t before = snow_context_bytes_read(files->context);
    snow_volume_close(support_opened(files, path, &options));
    uint64_t read = snow_context_bytes_read(files->context) - before;
    assert_int_equal(read, 65536 + 10 * (19 * 100 + 30));
}

static void inspect_reads_the_header_alone(void **state) {
    support_files *files = *state;
    char *bytes = calloc(1, 1000000);
    const char *path = support_write(files, "a.raw", bytes, 1000000);
    free(bytes);
    const snow_volume_options options = {.size = sizeof options,
                                         .dims = {100, 100, 100},
                                         .type = SNOW_TYPE_UINT8};
    snow_volume_info info = {.size = sizeof info};
    assert_int_equal(snow_volume_inspect(files->context, path, &options, &info),
                     SNOW_STATUS_OK);
    assert_int_equal(info.dims[2], 100);
    assert_int_equal(snow_context_bytes_read(files->context), 65536);
    assert_in_range(files->largest, 1, 70000);
    info.dims[0] = -5;
    assert_int_equal(snow_volume_inspect(files->context, "none", NULL, &info),
                     SNOW_STATUS_BAD_INPUT);
    assert_int_equal(info.dims[0], -5);
}

/* 4 MB of voxels that pack badly: of them the box alone is kept, and the check
 * sum behind them is still verified. */
static void of_packed_data_only_the_box_is_kept(void **state) {
    support_files *files = *state;
    size_t size = 160 * 160 * 160;
    unsigned char *bytes = malloc(size), *packed = malloc(size + 10000);
    uint64_t random = 3;
    for (size_t i = 0; i < size; i++)
        bytes[i] = (unsigned char)support_random(&random);
    size_t used = support_gzip(bytes, size, packed, size + 10000);
    const char *path = support_write(files, "a.raw.gz", packed, used);
    const snow_volume_options options = {.size = sizeof options,
                                         .dims = {160, 160, 160},
                                         .type = SNOW_TYPE_UINT8,
                                         .crop = {{3, 9}, {5, 8}, {100, 110}}};
    snow_volume *volume = support_opened(files, path, &options);
    const unsigned char *voxels = snow_volume_voxels(volume);
    assert_memory_equal(voxels, bytes + (100 * 160 + 5) * 160 + 3, 6);
    assert_in_range(snow_context_peak_bytes(files->context), 1, 250000);
    snow_volume_close(volume);
    packed[used - 6] ^= 16;
    path = support_write(files, "b.raw.gz", packed, used);
    support_refused(files, path, &options, SNOW_STATUS_BAD_INPUT, "damaged",
                    70000);
    path = support_write(files, "c.raw.gz", packed, used / 2);
    support_refused(files, path, &options, SNOW_STATUS_BAD_INPUT, "", 70000);
    free(bytes);
    free(packed);
}

static void a_file_cut_behind_the_box_is_refused_all_the_same(void **state) {
    support_files *files = *state;
    put(files, "a.raw", "", VOXELS - 1, false);
    const snow_volume_options options = {.size = sizeof options,
                                         .dims = {11, 9, 7},
                                         .type = SNOW_TYPE_UINT8,
                                         .crop = {{0, 2}, {0, 2}, {0, 2}}};
    support_refused(files, support_path(files, "a.raw"), &options,
                    SNOW_STATUS_BAD_INPUT, "692", 70000);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        SUPPORT_TEST(a_box_equals_that_of_the_whole),
        SUPPORT_TEST(a_box_of_numbers_in_text_equals_that_of_the_whole),
        SUPPORT_TEST(a_box_reaches_over_the_files_of_a_series),
        SUPPORT_TEST(files_outside_the_box_are_not_opened),
        SUPPORT_TEST(a_box_of_a_phantom_equals_that_of_the_whole),
        SUPPORT_TEST(the_box_moves_by_the_spacing_that_was_given),
        SUPPORT_TEST(a_box_outside_the_volume_is_refused_with_its_sizes),
        SUPPORT_TEST(little_more_than_the_box_is_read_of_a_huge_file),
        SUPPORT_TEST(near_rows_are_read_in_one_go_and_far_slices_are_not),
        SUPPORT_TEST(inspect_reads_the_header_alone),
        SUPPORT_TEST(of_packed_data_only_the_box_is_kept),
        SUPPORT_TEST(a_file_cut_behind_the_box_is_refused_all_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
