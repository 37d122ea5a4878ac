/* tests/formats/test_nrrd.c - NRRD files in all their forms: the same voxels
 * and the same place in space, or a refusal. */
#include "support/files.h"

#include <float.h>
#include <math.h>

/* Room for a header and 48 bytes of data, packed at worst. */
#define ROOM 4096

#define MAGIC "NRRD0004\n"
#define SIZES "dimension: 3\nsizes: 4 3 2\n"
#define SHORTS MAGIC "type: unsigned short\n" SIZES "endian: little\n"

/* The most memory that a refusal may ask for at once: the buffers of source
 * and header, whatever the header says. */
#define MOST ((size_t)300 * 1024)

/* 24 little-endian values 0x0100, 0x0302, ... */
static const unsigned char *counting(void) {
    static unsigned char bytes[48];
    for (int i = 0; i < 48; i++)
        bytes[i] = (unsigned char)i;
    return bytes;
}

/* Writes a header with bytes behind it. */
static const char *write_nrrd(support_files *files, const char *name,
                              const char *header, const void *data,
                              size_t size) {
    unsigned char all[ROOM];
    size_t length = strlen(header);
    assert_true(length + size <= ROOM);
    memcpy(all, header, length);
    if (size)
        memcpy(all + length, data, size);
    return support_write(files, name, all, length + size);
}

/* Opens a header with the 48 counting bytes behind it. */
static snow_volume *opened(support_files *files, const char *header) {
    return support_opened(
        files, write_nrrd(files, "a.nrrd", header, counting(), 48), NULL);
}

/* The same must be refused. */
static void refused(support_files *files, const char *header,
                    const char *part) {
    support_refused(files, write_nrrd(files, "a.nrrd", header, counting(), 48),
                    NULL, SNOW_STATUS_BAD_INPUT, part, MOST);
}

static void expect_counting(snow_volume *volume) {
    const uint16_t *voxels = snow_volume_voxels(volume);
    for (int i = 0; i < 24; i++)
        assert_int_equal(voxels[i], (2 * i + 1) << 8 | 2 * i);
    snow_volume_close(volume);
}

static void expect_matrix(const snow_volume *volume,
                          const double wanted[3][4]) {
    const snow_volume_info *info = snow_volume_get_info(volume);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            if (!(fabs(info->matrix[i][j] - wanted[i][j]) < 1e-12))
                fail_msg("matrix[%d][%d] is %g, not %g", i, j,
                         info->matrix[i][j], wanted[i][j]);
}

static void a_plain_file_is_read(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    snow_volume *volume = opened(&files, SHORTS "encoding: raw\n\n");
    const snow_volume_info *info = snow_volume_get_info(volume);
    assert_string_equal(info->format, "nrrd");
    assert_true(info->dims[0] == 4 && info->dims[1] == 3 && info->dims[2] == 2);
    assert_false(info->medical);
    assert_string_equal(info->unit, "");
    expect_counting(volume);
    assert_int_equal(files.warnings, 0);
    support_files_end(&files);
}

static void headers_are_read_in_any_order_and_style(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    static const char *const headers[] = {
        "NRRD0001\nsizes: 4 3 2\nendian: little\ntype: ushort\nencoding: raw\n"
        "dimension: 3\n\n",
        "NRRD00.01\ntype: uint16\n" SIZES "endian: little\nencoding: raw\n\n",
        "NRRD0005\r\ntype: uint16_t\r\ndimension: 3\r\nsizes: 4 3 2\r\n"
        "endian: little\r\nencoding: raw\r\n\r\n",
        "NRRD0003\n# sizes: 1 1 1\nTYPE: Unsigned Short Int\nDimension: 3 \n"
        "sizes:  4   3\t2  \nEndian: LITTLE\nencoding: RAW\ncontent: a: b\n"
        "key:=value: 1\nsizes:=9 9 9\nunknown key:= \nlabels: \"x\" \"y\" "
        "\"z\"\ncenters: cell cell node\nthicknesses: 1 nan 2\n\n",
    };
    for (size_t i = 0; i < sizeof headers / sizeof *headers; i++)
        expect_counting(opened(&files, headers[i]));
    support_files_end(&files);
}

static void every_spelling_of_a_type_is_known(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    static const struct {
        const char *name;
        snow_type type;
    } types[] = {
        {"signed char", SNOW_TYPE_INT8},
        {"int8_t", SNOW_TYPE_INT8},
        {"uchar", SNOW_TYPE_UINT8},
        {"unsigned char", SNOW_TYPE_UINT8},
        {"signed short int", SNOW_TYPE_INT16},
        {"short", SNOW_TYPE_INT16},
        {"unsigned short int", SNOW_TYPE_UINT16},
        {"int", SNOW_TYPE_INT32},
        {"signed int", SNOW_TYPE_INT32},
        {"unsigned int", SNOW_TYPE_UINT32},
        {"uint32", SNOW_TYPE_UINT32},
        {"long long int", SNOW_TYPE_INT64},
        {"longlong", SNOW_TYPE_INT64},
        {"unsigned long long int", SNOW_TYPE_UINT64},
        {"uint64_t", SNOW_TYPE_UINT64},
        {"float", SNOW_TYPE_FLOAT32},
        {"double", SNOW_TYPE_FLOAT64},
    };
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        char header[200];
        snprintf(header, sizeof header,
                 MAGIC "type: %s\ndimension: 1\nsizes: %zu\n"
                       "endian: little\nencoding: raw\n\n",
                 types[i].name, 48 / snow_type_size(types[i].type));
        snow_volume *volume = opened(&files, header);
        assert_int_equal(snow_volume_get_info(volume)->type, types[i].type);
        snow_volume_close(volume);
    }
    support_files_end(&files);
}

static void both_byte_orders_are_read(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    snow_volume *volume =
        opened(&files, MAGIC "type: ushort\n" SIZES "endian: big\n"
                             "encoding: raw\n\n");
    const uint16_t *voxels = snow_volume_voxels(volume);
    for (int i = 0; i < 24; i++)
        assert_int_equal(voxels[i], (2 * i) << 8 | (2 * i + 1));
    snow_volume_close(volume);
    support_files_end(&files);
}

static void gzip_data_are_unpacked(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    unsigned char packed[200];
    size_t size = support_gzip(counting(), 48, packed, sizeof packed);
    static const char header[] = SHORTS "encoding: gz\n\n";
    expect_counting(support_opened(
        &files, write_nrrd(&files, "a.nrrd", header, packed, size), NULL));
    support_refused(&files,
                    write_nrrd(&files, "b.nrrd", header, packed, size - 3),
                    NULL, SNOW_STATUS_BAD_INPUT, "truncated", MOST);
    packed[size > 7 ? size - 7 : 0] ^= 1;
    support_refused(&files, write_nrrd(&files, "c.nrrd", header, packed, size),
                    NULL, SNOW_STATUS_BAD_INPUT, "damaged", MOST);
    support_refused(&files, write_nrrd(&files, "d.nrrd", header, "plain", 5),
                    NULL, SNOW_STATUS_BAD_INPUT, "damaged", MOST);
    support_files_end(&files);
}

/* Lines are skipped before unpacking, bytes after it. */
static void skips_apply_on_their_side_of_the_packing(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    unsigned char data[200] = "one\ntwo\n", plain[50] = "xy";
    memcpy(plain + 2, counting(), 48);
    size_t size = 8 + support_gzip(plain, 50, data + 8, sizeof data - 8);
    expect_counting(support_opened(
        &files,
        write_nrrd(&files, "a.nrrd",
                   SHORTS "encoding: gzip\nline skip: 2\nbyte skip: 2\n\n",
                   data, size),
        NULL));
    expect_counting(support_opened(
        &files,
        write_nrrd(&files, "b.nrrd",
                   SHORTS "encoding: gzip\nlineskip: 2\nbyte skip: -1\n\n",
                   data, size),
        NULL));
    memcpy(data, "1\n2\nxy", 6);
    memcpy(data + 6, counting(), 48);
    expect_counting(support_opened(
        &files,
        write_nrrd(&files, "c.nrrd",
                   SHORTS "encoding: raw\nline skip: 2\nbyte skip: 2\n\n", data,
                   54),
        NULL));
    expect_counting(support_opened(
        &files,
        write_nrrd(&files, "d.nrrd", SHORTS "encoding: raw\nbyte skip: -1\n\n",
                   data, 54),
        NULL));
    assert_int_equal(files.warnings, 0);
    support_files_end(&files);
}

static void a_whole_file_may_be_packed(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    unsigned char inner[ROOM], packed[ROOM];
    static const char header[] = SHORTS "encoding: raw\nbyte skip: -1\n\n";
    memcpy(inner, header, sizeof header - 1);
    memcpy(inner + sizeof header - 1, "zz", 2);
    memcpy(inner + sizeof header + 1, counting(), 48);
    size_t size =
        support_gzip(inner, sizeof header + 49, packed, sizeof packed);
    expect_counting(support_opened(
        &files, support_write(&files, "a.nrrd.gz", packed, size), NULL));
    support_files_end(&files);
}

/* The last bytes of a stream, of which one time step is wanted. */
static void a_step_among_the_last_bytes_of_gzip_is_found(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    unsigned char data[60] = "head", packed[200];
    memcpy(data + 4, counting(), 48);
    static const char header[] =
        MAGIC "type: uint8\nencoding: gzip\ndimension: 4\nsizes: 4 2 2 3\n"
              "kinds: domain domain domain time\nbyte skip: -1\n\n";
    size_t size = support_gzip(data, 52, packed, sizeof packed);
    const snow_volume_options options = {.size = sizeof options, .time = 1};
    snow_volume *volume = support_opened(
        &files, write_nrrd(&files, "a.nrrd", header, packed, size), &options);
    assert_memory_equal(snow_volume_voxels(volume), counting() + 16, 16);
    snow_volume_close(volume);
    size = support_gzip(data, 47, packed, sizeof packed);
    support_refused(&files, write_nrrd(&files, "b.nrrd", header, packed, size),
                    NULL, SNOW_STATUS_BAD_INPUT, "47 bytes", MOST);
    support_files_end(&files);
}

static void numbers_in_text_are_read(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    snow_volume *volume = support_opened(
        &files,
        support_write_text(&files, "a.nrrd",
                           MAGIC "type: double\ndimension: 2\nsizes: 3 2\n"
                                 "encoding: text\n\n1 -2.5e3,nan\n\n\tinf 4 5"),
        NULL);
    const double *voxels = snow_volume_voxels(volume);
    assert_true(voxels[0] == 1 && voxels[1] == -2500 && isnan(voxels[2]) &&
                isinf(voxels[3]) && voxels[5] == 5);
    snow_volume_close(volume);
    volume = support_opened(
        &files,
        support_write_text(&files, "b.nrrd",
                           MAGIC "type: uint64\ndimension: 1\nsizes: 2\n"
                                 "encoding: ascii\n\n18446744073709551615 0\n"),
        NULL);
    assert_true(*(const uint64_t *)snow_volume_voxels(volume) == UINT64_MAX);
    snow_volume_close(volume);
    assert_int_equal(files.warnings, 0);
    volume = support_opened(
        &files,
        support_write_text(&files, "c.nrrd",
                           MAGIC "type: float\ndimension: 1\nsizes: 2\n"
                                 "encoding: ascii\n\n0.5 -1e2 and more"),
        NULL);
    assert_true(((const float *)snow_volume_voxels(volume))[1] == -100);
    snow_volume_close(volume);
    assert_int_equal(files.warnings, 1);
    volume = support_opened(
        &files,
        support_write_text(&files, "d.nrrd",
                           MAGIC "type: uint\ndimension: 1\nsizes: 1\n"
                                 "encoding: ascii\n\n4294967295"),
        NULL);
    assert_true(*(const uint32_t *)snow_volume_voxels(volume) == UINT32_MAX);
    snow_volume_close(volume);
    volume = support_opened(
        &files,
        support_write_text(&files, "e.nrrd",
                           MAGIC "type: float\ndimension: 1\nsizes: 1\n"
                                 "encoding: ascii\n\n3.4028235e38"),
        NULL);
    assert_true(*(const float *)snow_volume_voxels(volume) == FLT_MAX);
    snow_volume_close(volume);
    support_files_end(&files);
}

static void text_that_is_no_number_of_the_type_is_refused(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    static const char *const texts[][2] = {
        {"uint8", "1 256"},    {"uint8", "1 -1"},    {"int8", "1 128"},
        {"short", "1 2.5"},    {"uint64", "1 -1"},   {"int", "1 x"},
        {"double", "1 1e"},    {"int64", "1 1e999"}, {"uint", "1 -1"},
        {"short", "1 0x10"},   {"short", "1 1e1"},   {"double", "1 0x10"},
        {"float", "1 3.5e38"}, {"uint64", "1 +-1"},  {"uint64", "1 1."},
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        char text[200];
        snprintf(text, sizeof text,
                 MAGIC "type: %s\ndimension: 1\nsizes: 2\nencoding: "
                       "txt\n\n%s",
                 texts[i][0], texts[i][1]);
        support_refused(&files, support_write_text(&files, "a.nrrd", text),
                        NULL, SNOW_STATUS_BAD_INPUT, "is no", MOST);
    }
    /* One number that would be two if it were cut where room ends. */
    char digits[1000] = MAGIC "type: double\ndimension: 1\nsizes: 2\n"
                              "encoding: txt\n\n0.";
    size_t used = strlen(digits);
    memset(digits + used, '3', sizeof digits - 1 - used);
    support_refused(&files, support_write_text(&files, "c.nrrd", digits), NULL,
                    SNOW_STATUS_BAD_INPUT, "is no", MOST);
    support_refused(&files,
                    support_write_text(&files, "b.nrrd",
                                       MAGIC "type: int\ndimension: 1\n"
                                             "sizes: 3\nencoding: "
                                             "ascii\n\n10 20   "),
                    NULL, SNOW_STATUS_BAD_INPUT, "2 of 3", MOST);
    support_files_end(&files);
}

static void spaces_are_turned_to_ras(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    static const struct {
        const char *space;
        double x, y;
    } spaces[] = {
        {"RAS", 1, 1},   {"right-anterior-superior", 1, 1},
        {"LAS", -1, 1},  {"left-anterior-superior", -1, 1},
        {"lps", -1, -1}, {"left-posterior-superior", -1, -1},
    };
    for (size_t i = 0; i < sizeof spaces / sizeof *spaces; i++) {
        char header[400];
        snprintf(header, sizeof header,
                 SHORTS "encoding: raw\nspace: %s\nspace directions: "
                        "(1,0,0) ( 0, 0.5, 0.1 ) (0,-0.1,2)\n"
                        "space origin: (10,20,30)\n\n",
                 spaces[i].space);
        snow_volume *volume = opened(&files, header);
        double x = spaces[i].x, y = spaces[i].y;
        const double wanted[3][4] = {
            {x, 0, 0, 10 * x}, {0, 0.5 * y, -0.1 * y, 20 * y}, {0, 0.1, 2, 30}};
        expect_matrix(volume, wanted);
        assert_true(snow_volume_get_info(volume)->medical);
        assert_string_equal(snow_volume_get_info(volume)->unit, "mm");
        expect_counting(volume);
    }
    support_files_end(&files);
}

static void other_worlds_are_not_medical(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    snow_volume *volume =
        opened(&files, SHORTS "encoding: raw\nspace: scanner-xyz\n"
                              "space directions: (2,0,0) (0,2,0) (0,0,2)\n"
                              "space units: \"\xc2\xb5m\" \"um\" \"um\"\n\n");
    static const double plain[3][4] = {
        {2, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 2, 0}};
    expect_matrix(volume, plain);
    assert_false(snow_volume_get_info(volume)->medical);
    assert_string_equal(snow_volume_get_info(volume)->unit, "um");
    snow_volume_close(volume);
    volume = opened(&files, SHORTS "encoding: raw\nspace: 3D-left-handed\n"
                                   "spacings: 1 2 3\nunits: \"\" \"nm\" \"\"\n"
                                   "space origin: (1,1,1)\n\n");
    static const double turned[3][4] = {
        {1, 0, 0, 1}, {0, 2, 0, 1}, {0, 0, -3, -1}};
    expect_matrix(volume, turned);
    assert_string_equal(snow_volume_get_info(volume)->unit, "nm");
    assert_int_equal(files.warnings, 1);
    snow_volume_close(volume);
    support_files_end(&files);
}

static void the_users_spacing_replaces_the_files(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    const char *path = write_nrrd(&files, "a.nrrd",
                                  SHORTS "encoding: raw\nspacings: 1 -2 3\n\n",
                                  counting(), 48);
    const snow_volume_options options = {.size = sizeof options,
                                         .spacing = {0, 4, 5}};
    snow_volume *volume = support_opened(&files, path, &options);
    static const double wanted[3][4] = {
        {1, 0, 0, 0}, {0, -4, 0, 0}, {0, 0, 5, 0}};
    expect_matrix(volume, wanted);
    assert_true(snow_volume_get_info(volume)->spacing[1] == 4);
    snow_volume_close(volume);
    support_files_end(&files);
}

static void fewer_axes_than_three_are_filled_up(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    snow_volume *volume =
        opened(&files, MAGIC "type: ushort\ndimension: 2\nsizes: 4 6\n"
                             "endian: little\nencoding: raw\n"
                             "space dimension: 3\nspace directions: "
                             "(0,3,0) (0,0,-2)\n\n");
    static const double wanted[3][4] = {
        {0, 0, -1, 0}, {3, 0, 0, 0}, {0, -2, 0, 0}};
    expect_matrix(volume, wanted);
    assert_int_equal(snow_volume_get_info(volume)->dims[2], 1);
    expect_counting(volume);
    volume = opened(&files, MAGIC "type: ushort\ndimension: 1\nsizes: 24\n"
                                  "endian: little\nencoding: raw\n"
                                  "space dimension: 2\nspace directions: "
                                  "(0,3)\n\n");
    assert_true(snow_volume_get_info(volume)->spacing[0] == 3);
    expect_counting(volume);
    support_files_end(&files);
}

#define TIMES MAGIC "type: uint8\nencoding: raw\ndimension: 4\nsizes: 4 2 2 3\n"

static void a_last_axis_of_time_or_list_has_steps(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    static const char *const headers[] = {
        TIMES "kinds: domain domain domain time\nspacings: 1 1 1 nan\n\n",
        TIMES "kinds: space space space list\nspace: RAS\n"
              "space directions: (1,0,0) (0,1,0) (0,0,1) none\n\n",
        TIMES "space: RAST\nspace directions: "
              "(1,0,0,0) (0,1,0,0) (0,0,1,0) (0,0,0,2)\n\n",
    };
    for (size_t i = 0; i < sizeof headers / sizeof *headers; i++) {
        const char *path =
            write_nrrd(&files, "a.nrrd", headers[i], counting(), 48);
        for (int64_t time = 0; time < 3; time++) {
            snow_volume_options options = {.size = sizeof options,
                                           .time = time};
            files.warnings = 0;
            snow_volume *volume = support_opened(&files, path, &options);
            assert_int_equal(*(const uint8_t *)snow_volume_voxels(volume),
                             16 * time);
            assert_int_equal(snow_volume_get_info(volume)->times, 3);
            assert_int_equal(snow_volume_get_info(volume)->time, time);
            assert_int_equal(files.warnings, time == 0); /* unasked */
            snow_volume_close(volume);
        }
        snow_volume_options beyond = {.size = sizeof beyond, .time = 3};
        support_refused(&files, path, &beyond, SNOW_STATUS_BAD_USAGE,
                        "time step 3", MOST);
    }
    support_files_end(&files);
}

static void axes_of_one_sample_are_left_out(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    snow_volume *volume =
        opened(&files, MAGIC "type: ushort\ndimension: 5\nendian: little\n"
                             "sizes: 1 4 1 3 2\nencoding: raw\n"
                             "kinds: stub domain domain domain domain\n\n");
    const int64_t *dims = snow_volume_get_info(volume)->dims;
    assert_true(dims[0] == 4 && dims[1] == 3 && dims[2] == 2);
    expect_counting(volume);
    support_files_end(&files);
}

#define COLORS                                                      \
    MAGIC "type: uint8\ndimension: 4\nsizes: 3 4 2 2\nspace: RAS\n" \
          "space directions: none (1,0,0) (0,1,0) (0,0,2)\n"

/* Value `channel` of voxels of `count` counting bytes from x on. */
static void expect_values(support_files *files, const char *path, int count,
                          int64_t channel, int x) {
    snow_volume_options options = {.size = sizeof options};
    options.channel = channel;
    options.channel_given = true;
    options.crop[0][0] = x;
    snow_volume *volume = support_opened(files, path, &options);
    const snow_volume_info *info = snow_volume_get_info(volume);
    const unsigned char *voxels = snow_volume_voxels(volume);
    assert_int_equal(info->dims[0], 4 - x);
    for (int n = 0; n < 16 * 3 / count; n++)
        if (n % 4 >= x)
            assert_int_equal(*voxels++, count * n + channel);
    snow_volume_close(volume);
}

static void colours_are_channels(void **state) {
    (void)state;
    static const char *const kinds[] = {"RGB-color", "3-color", "vector"};
    support_files files;
    support_files_begin(&files);
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        char header[400];
        snprintf(header, sizeof header,
                 COLORS "kinds: %s domain domain domain\nencoding: raw\n\n",
                 kinds[i]);
        const char *path = write_nrrd(&files, "c.nrrd", header, counting(), 48);
        for (int channel = 0; channel < 3; channel++)
            expect_values(&files, path, 3, channel, channel);
        snow_volume *volume = support_opened(&files, path, NULL);
        const snow_volume_info *info = snow_volume_get_info(volume);
        assert_int_equal(info->channels, 3);
        assert_string_equal(info->channel[1].name, "green");
        assert_true(info->channel[2].own && info->channel[2].shown);
        assert_true(info->spacing[2] > 1.99 && info->spacing[2] < 2.01);
        snow_volume_close(volume);
    }
    write_nrrd(&files, "c.raw", "", counting(), 48);
    expect_values(&files,
                  write_nrrd(&files, "c.nhdr",
                             COLORS "kinds: RGB-color domain domain domain\n"
                                    "encoding: raw\ndata file: c.raw\n\n",
                             NULL, 0),
                  3, 2, 1);
    expect_values(&files,
                  write_nrrd(&files, "d.nrrd",
                             MAGIC "type: uint8\ndimension: 4\n"
                                   "sizes: 4 4 3 1\nencoding: raw\n"
                                   "kinds: RGBA-color domain domain domain\n\n",
                             counting(), 48),
                  4, 3, 0);
    snow_volume_options second = {.size = sizeof second, .channel = 1};
    support_refused(&files,
                    write_nrrd(&files, "e.nrrd",
                               MAGIC "type: uint8\ndimension: 3\n"
                                     "sizes: 4 4 3\nencoding: raw\n\n",
                               counting(), 48),
                    &second, SNOW_STATUS_BAD_USAGE, "the voxels have 1", MOST);
    support_files_end(&files);
}

/* (3, 4), a zero, and their lengths. */
static void vectors_have_components(void **state) {
    (void)state;
    const float data[] = {3, 4, 0, 0};
    static const char *const names[] = {"x", "y", "magnitude"};
    const float wanted[] = {3, 4, 5};
    support_files files;
    support_files_begin(&files);
    const char *path = write_nrrd(
        &files, "v.nrrd",
        MAGIC "type: float\nendian: little\ndimension: 4\nsizes: 2 2 1 1\n"
              "encoding: raw\nkinds: vector domain domain domain\n\n",
        data, sizeof data);
    for (int n = 0; n < 3; n++) {
        snow_volume_options options = {.size = sizeof options,
                                       .component = names[n]};
        snow_volume *volume = support_opened(&files, path, &options);
        const float *voxels = snow_volume_voxels(volume);
        assert_true(fabsf(voxels[0] - wanted[n]) < 1e-6F);
        assert_true(fabsf(voxels[1]) < 1e-6F);
        assert_int_equal(snow_volume_get_info(volume)->components, 2);
        snow_volume_close(volume);
    }
    support_files_end(&files);
}

static void other_values_of_voxels_are_refused(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    refused(&files,
            MAGIC "type: uint8\nencoding: raw\ndimension: 4\nsizes: 6 2 2 2\n"
                  "kinds: 3D-symmetric-matrix domain domain domain\n\n",
            "axis 0 has 6 values");
    refused(&files,
            MAGIC "type: uint8\nencoding: raw\ndimension: 4\nsizes: 4 2 2 3\n"
                  "kinds: domain domain domain RGB-color\n\n",
            "axis 3 has 3 values");
    refused(&files,
            MAGIC "type: uint8\nencoding: raw\ndimension: 4\nsizes: 2 4 2 3\n"
                  "kinds: RGB-color domain domain domain\n\n",
            "axis 0 has 2 values");
    refused(&files,
            COLORS "kinds: RGB-color domain domain domain\nencoding: ascii\n\n",
            "in text or in several files");
    refused(&files,
            MAGIC "type: uint8\nencoding: raw\ndimension: 4\nsizes: 3 4 4 2\n"
                  "kinds: RGB-color domain domain domain\n\n",
            "");
    refused(&files,
            MAGIC "type: double\nendian: little\nencoding: raw\ndimension: 4\n"
                  "sizes: 3 4000000000 4000000000 4000000000\n"
                  "kinds: vector domain domain domain\n\n",
            "");
    refused(&files,
            MAGIC "type: uint8\nencoding: raw\ndimension: 4\nsizes: 3 4 2 2\n"
                  "space: RAS\nspace directions: none (1,0,0) (0,1,0) "
                  "(0,0,1)\n\n",
            "axis 0 has 3 values");
    refused(&files, TIMES "\n", "the meaning of the 4th is unknown");
    refused(&files, TIMES "kinds: time domain domain domain\n\n",
            "not the last");
    support_files_end(&files);
}

/* 4 x 3 x 2 samples: cells unless told, nodes, NaN, ends in either order. */
static void axes_may_be_told_by_their_ends(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
#define RAW SHORTS "encoding: raw\n"
    static const struct {
        const char *header;
        double matrix[3][4];
    } cases[] = {
        {RAW "axis mins: 0 -3 10\naxis maxs: 8 0 14\n\n",
         {{2, 0, 0, 1}, {0, 1, 0, -2.5}, {0, 0, 2, 11}}},
        {RAW "axismins: 0 -3 10\naxismaxs: 6 1 14\ncenterings: node node cell"
             "\n\n",
         {{2, 0, 0, 0}, {0, 2, 0, -3}, {0, 0, 2, 11}}},
        {RAW "axis mins: nan 0 5\naxis maxs: 8 nan 1\ncenters: none ??? cell"
             "\n\n",
         {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, -2, 4}}},
        {RAW "axis mins: 0 0 0\naxis maxs: 8 6 4\nspacings: 1 1 3\n\n",
         {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 3, 0}}},
        {RAW "axis mins: 0 0 0\n\n",
         {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}},
        {RAW "space: LPS\nspace origin: (1,2,3)\naxis mins: 0 0 0\n"
             "axis maxs: 8 6 4\n\n",
         {{-2, 0, 0, -1}, {0, -2, 0, -2}, {0, 0, 2, 3}}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        snow_volume *volume = opened(&files, cases[i].header);
        expect_matrix(volume, cases[i].matrix);
        expect_counting(volume);
    }
    refused(&files, RAW "axis mins: 0 0 0\naxis maxs: 0 1 1\n\n", "zero");
    refused(&files, RAW "axis mins: 0 0\naxis maxs: 1 1 1\n\n", "axis mins");
    refused(&files, RAW "axis mins: 0 0 0\naxis maxs: 1 1 1 1\n\n", "more");
#undef RAW
    support_files_end(&files);
}

static void long_words_are_not_cut(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    char header[500];
    /* The 63 first letters would be a good size. */
    snprintf(header, sizeof header,
             MAGIC "type: uint8\ndimension: 3\nsizes: 4 3 %062d21\n"
                   "encoding: raw\n\n",
             0);
    refused(&files, header, "sizes");
    snprintf(header, sizeof header,
             MAGIC "type: uint8\ndimension: 3\nsizes: 4 3 2 %090d\n"
                   "encoding: raw\n\n",
             0);
    refused(&files, header, "more numbers");
    support_files_end(&files);
}

static void contradictions_are_refused(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
#define RAW SHORTS "encoding: raw\n"
    static const char *const headers[][2] = {
        {RAW "type: float\n\n", "occurs twice"},
        {MAGIC SIZES "encoding: raw\n\n", "\"type\""},
        {MAGIC "type: block\n" SIZES "encoding: raw\nblock size: 4\n\n",
         "block"},
        {MAGIC "type: char\n" SIZES "encoding: raw\n\n", "char"},
        {MAGIC "type: short\n" SIZES "encoding: raw\n\n", "\"endian\""},
        {MAGIC "type: short\n" SIZES "endian: middle\nencoding: raw\n\n",
         "middle"},
        {SHORTS "\n", "\"encoding\""},
        {SHORTS "encoding: bzip2\n\n", "gzip"},
        {SHORTS "encoding: hex\n\n", "gzip"},
        {MAGIC "type: uint8\nencoding: raw\nsizes: 4 3 2\n\n", "dimension"},
        {MAGIC "type: uint8\nencoding: raw\ndimension: 3\n\n", "sizes"},
        {MAGIC "type: uint8\nencoding: raw\ndimension: 17\nsizes: 1\n\n", "17"},
        {MAGIC "type: uint8\nencoding: raw\ndimension: 3\nsizes: 4 3\n\n",
         "sizes"},
        {MAGIC "type: uint8\nencoding: raw\ndimension: 3\nsizes: 1 2 3 4\n\n",
         "more numbers"},
        {RAW "spacings: 1 1\n\n", "spacings"},
        {RAW "spacings: 1 1 1 1\n\n", "spacings"},
        {RAW "kinds: domain domain domain time\n\n", "kinds"},
        {RAW "space dimension: 9\n\n", "space dimension"},
        {RAW "space: RAS\nspace directions: (1,0,0) (0,1,0) (0,0,1) none\n\n",
         "directions"},
        {RAW "spacings: 1 1 1\x1b[31m\n\n", "1?[31m"},
        {MAGIC "type: uint8\nencoding: raw\ndimension: 4\n"
               "kinds: domain domain domain time\n"
               "sizes: 2000000000 2000000000 2 9000000000\n\n",
         "time steps"},
        {RAW "kinds: domain domain\n\n", "kinds"},
        {RAW "space: nowhere\n\n", "nowhere"},
        {RAW "space: RAS\nspace dimension: 2\n\n", "contradicts"},
        {RAW "space: RAS\nspace directions: (1,0) (0,1) (1,1)\n\n",
         "directions"},
        {RAW "space: RAS\nspace directions: (1,0,0) (0,1,0)\n\n", "directions"},
        {RAW "space origin: (1,2)\n\n", "origin"},
        {RAW "byte skip: -2\n\n", "byte skip"},
        {RAW "line skip: -1\n\n", "line skip"},
        {RAW "line skip: 9\n\n", "fewer lines"},
        {RAW "byte skip: 1\n\n", "the voxels"},
        {RAW "spacing: 1 1 1\n\n", "is not a field"},
        {"NRRD0006\n\n", "NRRD0006"},
        {"NRRX0004\n\n", "NRRD000"},
    };
#undef RAW
    for (size_t i = 0; i < sizeof headers / sizeof *headers; i++)
        refused(&files, headers[i][0], headers[i][1]);
    support_files_end(&files);
}

static void headers_alone_that_promise_no_data_are_refused(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    static const char *const headers[][2] = {
        {SHORTS "encoding: raw\n", "within its header"},
        {SHORTS "encoding: raw\ndata file: LIST\n", "number of files"},
        {SHORTS "encoding: raw\ndata file: LIST x\na\nb\n", "LIST"},
        {SHORTS "encoding: raw\ndata file: LIST 4\na\n", "number of files"},
        {SHORTS "encoding: raw\ndata file: s%d 1 9 -1\n", "number of files"},
        {SHORTS "encoding: raw\ndata file: s%d 1 9 0\n", "number of files"},
    };
    for (size_t i = 0; i < sizeof headers / sizeof *headers; i++)
        support_refused(&files,
                        support_write_text(&files, "a.nhdr", headers[i][0]),
                        NULL, SNOW_STATUS_BAD_INPUT, headers[i][1], MOST);
    support_files_end(&files);
}

static void spacings_that_are_none_are_refused(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    static const char *const fields[] = {
        "spacings: 1 nan 1",
        "spacings: 1 0 1",
        "spacings: inf 1 1",
        "space dimension: 3\nspace directions: (1,0,0) (2,0,0) (0,0,1)",
        "space dimension: 3\nspace directions: (1,0,0) (0,0,0) (0,0,1)",
        "space dimension: 3\nspace directions: (1,0,nan) (0,1,0) (0,0,1)",
        "space origin: (nan,0,0)",
    };
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
        char header[300];
        snprintf(header, sizeof header, SHORTS "encoding: raw\n%s\n\n",
                 fields[i]);
        refused(&files, header, "zero, not finite, or in one plane");
    }
    support_files_end(&files);
}

static void sizes_that_lie_are_refused_before_their_memory(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    static const char *const sizes[] = {
        "4 3 3",
        "1000 1000 1000",
        "4000000000 4000000000 4000000000",
        "9223372036854775807 9223372036854775807 2",
        "99999999999999999999 1 1",
        "-4 3 2",
        "0 3 2",
        "4 3 2x",
    };
    static const char *const encodings[] = {"raw", "gzip", "ascii"};
    for (size_t i = 0; i < 3 * sizeof sizes / sizeof *sizes; i++) {
        char header[300];
        unsigned char data[200];
        size_t size = support_gzip(counting(), 48, data, sizeof data);
        snprintf(header, sizeof header,
                 MAGIC "type: double\nendian: little\ndimension: 3\n"
                       "sizes: %s\nencoding: %s\n\n",
                 sizes[i / 3], encodings[i % 3]);
        support_refused(&files,
                        write_nrrd(&files, "a.nrrd", header, data, size), NULL,
                        SNOW_STATUS_BAD_INPUT, "", MOST);
    }
    support_files_end(&files);
}

static void data_too_short_or_too_long_are_told(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    static const char header[] = SHORTS "encoding: raw\n\n";
    support_refused(&files,
                    write_nrrd(&files, "a.nrrd", header, counting(), 47), NULL,
                    SNOW_STATUS_BAD_INPUT, "47", MOST);
    unsigned char longer[50] = {0};
    memcpy(longer, counting(), 48);
    expect_counting(support_opened(
        &files, write_nrrd(&files, "b.nrrd", header, longer, 50), NULL));
    assert_int_equal(files.warnings, 1);
    support_files_end(&files);
}

static void data_may_be_in_another_file(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    support_write(&files, "the data.raw", counting(), 48);
    /* With and without an empty line at the end; an absolute path. */
    expect_counting(
        support_opened(&files,
                       support_write_text(&files, "a.nhdr",
                                          "NRRD0004\ndata file: the data.raw\n"
                                          "type: ushort\n" SIZES
                                          "endian: little\nencoding: raw"),
                       NULL));
    char header[400];
    snprintf(header, sizeof header,
             SHORTS "encoding: raw\ndatafile: %s\n\nnot read",
             support_path(&files, "the data.raw"));
    expect_counting(support_opened(
        &files, support_write_text(&files, "b.nhdr", header), NULL));
    support_files_end(&files);
}

/* Raw data may begin with the bytes of gzip by chance. */
static void raw_data_are_never_unpacked(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    static const unsigned char bytes[4] = {0x1f, 0x8b, 8, 0};
    support_write(&files, "a.raw", bytes, 4);
    snow_volume *volume = support_opened(
        &files,
        support_write_text(&files, "a.nhdr",
                           MAGIC "type: uint8\ndimension: 1\nsizes: 4\n"
                                 "encoding: raw\ndata file: a.raw\n"),
        NULL);
    assert_memory_equal(snow_volume_voxels(volume), bytes, 4);
    snow_volume_close(volume);
    support_files_end(&files);
}

static void a_missing_data_file_is_named(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    const char *path = support_write_text(
        &files, "a.nhdr", SHORTS "encoding: raw\ndata file: none.raw\n");
    support_refused(&files, path, NULL, SNOW_STATUS_BAD_INPUT, "none.raw",
                    MOST);
    path = support_write_text(&files, "b.nhdr",
                              SHORTS "encoding: raw\ndata file: /dev/zero\n");
    support_refused(&files, path, NULL, SNOW_STATUS_BAD_INPUT, "a device",
                    MOST);
    path = support_write_text(&files, "c.nhdr",
                              SHORTS "encoding: raw\ndata file: LIST\n"
                                     "none.raw\nnone.raw\n");
    support_refused(&files, path, NULL, SNOW_STATUS_BAD_INPUT, "none.raw",
                    MOST);
    support_files_end(&files);
}

/* The 48 bytes in pieces of `size` as NAME0, NAME1, ... or gzip. */
static void write_pieces(support_files *files, const char *stem, size_t size,
                         bool gzip) {
    for (size_t i = 0; i < 48 / size; i++) {
        char name[40];
        unsigned char packed[200];
        snprintf(name, sizeof name, "%s%02zu", stem, 10 - i);
        if (gzip)
            support_write(files, name, packed,
                          support_gzip(counting() + i * size, size, packed,
                                       sizeof packed));
        else
            support_write(files, name, counting() + i * size, size);
    }
}

static void slices_in_files_are_joined(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    write_pieces(&files, "slice", 24, false);
    write_pieces(&files, "packed", 24, true);
    write_pieces(&files, "row", 8, false);
    support_write(&files, "blank  1.x", counting(), 24);
    support_write(&files, "blank  2.x", counting() + 24, 24);
    static const char *const fields[] = {
        "raw\ndata file: LIST\nslice10\nslice09\n",
        "raw\ndata file: LIST 2\nslice10\nslice09",
        "raw\ndata file: LIST 3\nslice10\nslice09\n",
        "gzip\ndata file: LIST\npacked10\npacked09\n",
        "raw\ndata file: LIST 1\nrow10\nrow09\nrow08\nrow07\nrow06\nrow05\n",
        "raw\ndata file: slice%02d 10 9 -1\n",
        "raw\ndata file: row%02u 10 5 -1 1\n",
        "raw\ndata file: blank%3d.x 1 2 1\n",
        "gzip\ndata file: packed%02d 10 8 -1 2\n",
    };
    size_t count = sizeof fields / sizeof *fields;
    for (size_t i = 0; i < count; i++) {
        char header[300];
        snprintf(header, sizeof header, SHORTS "encoding: %s", fields[i]);
        const char *path = support_write_text(&files, "a.nhdr", header);
        if (i + 1 < count) /* the last pattern has a number too many */
            expect_counting(support_opened(&files, path, NULL));
        else
            support_refused(&files, path, NULL, SNOW_STATUS_BAD_INPUT,
                            "number of files", MOST);
    }
    support_files_end(&files);
}

static void slices_of_wrong_size_are_refused_before_memory(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    support_write(&files, "s1", counting(), 48);
    support_write(&files, "s2", counting(), 48);
    const char *path = support_write_text(
        &files, "a.nhdr",
        MAGIC "type: uint8\ndimension: 3\nsizes: 100000 100000 2\n"
              "encoding: raw\ndata file: s%d 1 2 1\n");
    support_refused(&files, path, NULL, SNOW_STATUS_BAD_INPUT, "s1", MOST);
    support_write(&files, "s2", counting(), 23);
    path = support_write_text(&files, "b.nhdr",
                              SHORTS "encoding: raw\ndata file: s%d 1 2 1\n");
    support_refused(&files, path, NULL, SNOW_STATUS_BAD_INPUT, "s2", MOST);
    support_files_end(&files);
}

/* Of a series in files only those of the time step are opened. */
static void a_time_step_needs_its_own_files_only(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    support_write(&files, "t1", counting(), 16);
    const char *path = support_write_text(
        &files, "a.nhdr",
        TIMES "kinds: domain domain domain time\ndata file: t%d 0 2 1 3\n");
    const snow_volume_options options = {.size = sizeof options, .time = 1};
    snow_volume *volume = support_opened(&files, path, &options);
    assert_memory_equal(snow_volume_voxels(volume), counting(), 16);
    snow_volume_close(volume);
    support_refused(&files, path, NULL, SNOW_STATUS_BAD_INPUT, "t0", MOST);
    support_files_end(&files);
}

static void odd_patterns_are_names(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    static const char *const names[] = {
        "%s 1 2 1", "%n", "a%d%d 1 2 1", "%100d 1 2 1",
        "%d 1 2",   "%",  "%d x 2 1",    "%d 111111111111111111111111 1 1"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char header[300];
        support_write(&files, names[i], counting(), 48);
        snprintf(header, sizeof header, SHORTS "encoding: raw\ndata file: %s\n",
                 names[i]);
        expect_counting(support_opened(
            &files, support_write_text(&files, "a.nhdr", header), NULL));
    }
    support_files_end(&files);
}

static void memory_has_no_other_files(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    static const char header[] =
        SHORTS "encoding: raw\ndata file: LIST\na\nb\n";
    snow_volume *volume = NULL;
    assert_int_equal(snow_volume_open_memory(files.context, "a.nhdr", header,
                                             sizeof header - 1, NULL, &volume),
                     SNOW_STATUS_BAD_INPUT);
    assert_non_null(strstr(snow_context_message(files.context),
                           "cannot be opened from here"));
    /* Nor is a name one, where there are no bytes. */
    assert_int_equal(snow_volume_open_memory(files.context, "phantom:head",
                                             NULL, 0, NULL, &volume),
                     SNOW_STATUS_BAD_INPUT);
    support_files_end(&files);
}

static void options_for_raw_data_do_not_fit(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    const char *path = write_nrrd(&files, "a.nrrd", SHORTS "encoding: raw\n\n",
                                  counting(), 48);
    const snow_volume_options options = {.size = sizeof options,
                                         .type = SNOW_TYPE_UINT8};
    support_refused(&files, path, &options, SNOW_STATUS_BAD_USAGE, "nrrd",
                    MOST);
    support_files_end(&files);
}

static void a_cut_file_is_refused_at_every_length(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    unsigned char packed[200], all[ROOM];
    static const char header[] = SHORTS "encoding: gzip\nspacings: 1 1 2\n\n";
    size_t length = sizeof header - 1;
    size_t size = support_gzip(counting(), 48, packed, sizeof packed);
    memcpy(all, header, length);
    memcpy(all + length, packed, size);
    for (size_t cut = 1; cut < length + size; cut++)
        support_refused(&files, support_write(&files, "a.nrrd", all, cut), NULL,
                        SNOW_STATUS_BAD_INPUT, "", MOST);
    support_files_end(&files);
}

static void the_real_balls_are_one_ball(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    const char *path =
        support_data("formats/nrrd/pynrrd/BallBinary30x30x30.nrrd");
    if (!path) {
        support_files_end(&files);
        skip();
    }
    snow_volume *ball = support_opened(&files, path, NULL);
    static const char *const names[] = {".nhdr",
                                        "_byteskip_minus_one.nhdr",
                                        "_byteskip_minus_one_nifti.nhdr",
                                        "_gz.nrrd",
                                        "_gz_byteskip_minus_one.nrrd",
                                        "_gz_lineskip.nrrd"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char name[100];
        snprintf(name, sizeof name, "formats/nrrd/pynrrd/BallBinary30x30x30%s",
                 names[i]);
        snow_volume *other = support_opened(&files, support_data(name), NULL);
        assert_memory_equal(snow_volume_voxels(other), snow_volume_voxels(ball),
                            54000);
        assert_memory_equal(snow_volume_get_info(other)->matrix,
                            snow_volume_get_info(ball)->matrix,
                            sizeof(double[4][4]));
        snow_volume_close(other);
    }
    assert_int_equal(files.warnings, 0);
    snow_volume_close(ball);
    support_files_end(&files);
}

static void the_real_odd_files_are_refused(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    static const char *const names[][2] = {{"_bz2.nrrd", "bzip2"},
                                           {"_nifti.nhdr", "byte skip: -1"},
                                           {"_byteskip_minus_five.nhdr", "-5"}};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char name[100];
        snprintf(name, sizeof name, "formats/nrrd/pynrrd/BallBinary30x30x30%s",
                 names[i][0]);
        const char *path = support_data(name);
        if (path)
            support_refused(&files, path, NULL, SNOW_STATUS_BAD_INPUT,
                            names[i][1], MOST);
    }
    support_files_end(&files);
}

/* Figures by numpy from the same files. */
static void the_real_files_have_their_figures(void **state) {
    (void)state;
    static const struct {
        const char *name;
        int64_t dims[3];
        double spacing[3], max, sum, wsum;
    } real[] = {
        {"avf_float_32.nrrd",
         {74, 93, 20},
         {0.7226560115814209, 0.7226560115814209, 1},
         2509.886962890625,
         25368783.287802219,
         12795225902.451496},
        {"fmob-c4h.nrrd",
         {32, 40, 16},
         {0.051282064516129031, 0.05128205128205128, 0.051282000000000001},
         1.049265265249152,
         1971.1912011818745,
         977637.32015209424},
        {"pynrrd/test1d_ascii.nrrd", {27, 1, 1}, {1.0458, 1, 1}, 27, 378, 6930},
        {"pynrrd/test2d_ascii.nrrd", {3, 9, 1}, {1.0458, 2, 1}, 27, 378, 6930},
        {"pynrrd/test_customFields.nrrd",
         {27, 1, 1},
         {1.0458, 1, 1},
         27,
         378,
         6930},
        {"pynrrd/test_simple4d_raw.nrrd",
         {1, 1, 1},
         {1.5, 1.5, 1},
         0.76903426,
         0.76903426,
         0.76903426},
    };
    support_files files;
    support_files_begin(&files);
    for (size_t i = 0; i < sizeof real / sizeof *real; i++) {
        char name[100];
        snprintf(name, sizeof name, "formats/nrrd/%s", real[i].name);
        const char *path = support_data(name);
        if (!path)
            continue;
        snow_volume *volume = support_opened(&files, path, NULL);
        const snow_volume_info *info = snow_volume_get_info(volume);
        snow_volume_statistics m = {.size = sizeof m};
        snow_volume_get_statistics(volume, &m);
        for (int k = 0; k < 3; k++) {
            assert_int_equal(info->dims[k], real[i].dims[k]);
            assert_true(fabs(info->spacing[k] - real[i].spacing[k]) < 1e-15);
        }
        assert_true(fabs(m.max / real[i].max - 1) < 1e-15);
        assert_true(fabs(m.sum / real[i].sum - 1) < 1e-13);
        assert_true(fabs(m.wsum / real[i].wsum - 1) < 1e-13);
        snow_volume_close(volume);
    }
    support_files_end(&files);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plain_file_is_read),
        cmocka_unit_test(headers_are_read_in_any_order_and_style),
        cmocka_unit_test(every_spelling_of_a_type_is_known),
        cmocka_unit_test(both_byte_orders_are_read),
        cmocka_unit_test(gzip_data_are_unpacked),
        cmocka_unit_test(skips_apply_on_their_side_of_the_packing),
        cmocka_unit_test(a_whole_file_may_be_packed),
        cmocka_unit_test(a_step_among_the_last_bytes_of_gzip_is_found),
        cmocka_unit_test(numbers_in_text_are_read),
        cmocka_unit_test(text_that_is_no_number_of_the_type_is_refused),
        cmocka_unit_test(spaces_are_turned_to_ras),
        cmocka_unit_test(other_worlds_are_not_medical),
        cmocka_unit_test(the_users_spacing_replaces_the_files),
        cmocka_unit_test(fewer_axes_than_three_are_filled_up),
        cmocka_unit_test(a_last_axis_of_time_or_list_has_steps),
        cmocka_unit_test(axes_of_one_sample_are_left_out),
        cmocka_unit_test(colours_are_channels),
        cmocka_unit_test(vectors_have_components),
        cmocka_unit_test(other_values_of_voxels_are_refused),
        cmocka_unit_test(axes_may_be_told_by_their_ends),
        cmocka_unit_test(long_words_are_not_cut),
        cmocka_unit_test(contradictions_are_refused),
        cmocka_unit_test(headers_alone_that_promise_no_data_are_refused),
        cmocka_unit_test(spacings_that_are_none_are_refused),
        cmocka_unit_test(sizes_that_lie_are_refused_before_their_memory),
        cmocka_unit_test(data_too_short_or_too_long_are_told),
        cmocka_unit_test(data_may_be_in_another_file),
        cmocka_unit_test(raw_data_are_never_unpacked),
        cmocka_unit_test(a_missing_data_file_is_named),
        cmocka_unit_test(slices_in_files_are_joined),
        cmocka_unit_test(slices_of_wrong_size_are_refused_before_memory),
        cmocka_unit_test(a_time_step_needs_its_own_files_only),
        cmocka_unit_test(odd_patterns_are_names),
        cmocka_unit_test(memory_has_no_other_files),
        cmocka_unit_test(options_for_raw_data_do_not_fit),
        cmocka_unit_test(a_cut_file_is_refused_at_every_length),
        cmocka_unit_test(the_real_balls_are_one_ball),
        cmocka_unit_test(the_real_odd_files_are_refused),
        cmocka_unit_test(the_real_files_have_their_figures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
