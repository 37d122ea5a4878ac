/* tests/formats/test_nrrd.c - NRRD files in all their forms: the same voxels
 * and the same place in space, or a refusal. */
#include "support/files.h"

#include "volume/volume.h"

#include <float.h>
#include <math.h>

/* Room for a header and 48 bytes of data, packed at worst. */
#define ROOM 4096

#define MAGIC "NRRD0004\n"
#define SIZES "dimension: 3\nsizes: 4 3 2\n"
#define PLAIN MAGIC "type: unsigned short\nendian: little\n"
#define SHORTS PLAIN SIZES
#define RAW SHORTS "encoding: raw\n"
#define COUNT(table) (sizeof(table) / sizeof *(table))

/* 24 little-endian values 0x0100, 0x0302, ... */
static const unsigned char *counting(void) {
    static unsigned char bytes[48];
    for (int i = 0; i < 48; i++)
        bytes[i] = (unsigned char)i;
    return bytes;
}

/* Writes a header with bytes behind it, whose path is told. */
static const char *write_nrrd(support_files *files, const char *header,
                              const void *data, size_t size) {
    unsigned char all[ROOM];
    size_t length = strlen(header);
    assert_true(length + size <= ROOM);
    memcpy(all, header, length);
    memcpy(all + length, data, size);
    return support_write(files, "a.nrrd", all, length + size);
}

/* Opens a header with the 48 counting bytes behind it. */
static snow_volume *opened(support_files *files, const char *header) {
    return support_opened(files, write_nrrd(files, header, counting(), 48),
                          NULL);
}

/* A header alone. */
static snow_volume *opened_text(support_files *files, const char *text) {
    return support_opened(files, support_write_text(files, "a.nhdr", text),
                          NULL);
}

/* Headers with the counting bytes behind them are refused in these words. */
static void refused(support_files *files, const char *const (*cases)[2],
                    size_t count) {
    for (size_t i = 0; i < count; i++)
        support_bad_file(files, write_nrrd(files, cases[i][0], counting(), 48),
                         cases[i][1]);
}

static void refused_text(support_files *files, const char *text,
                         const char *part) {
    support_bad_file(files, support_write_text(files, "a.nhdr", text), part);
}

static void expect_counting(snow_volume *volume) {
    const uint16_t *voxels = snow_volume_voxels(volume);
    for (int i = 0; i < 24; i++)
        assert_int_equal(voxels[i], (2 * i + 1) << 8 | 2 * i);
    snow_volume_close(volume);
}

static void a_plain_file_is_read(void **state) {
    support_files *files = *state;
    snow_volume *volume = opened(files, RAW "\n");
    const snow_volume_info *info = snow_volume_get_info(volume);
    assert_string_equal(info->format, "nrrd");
    assert_true(info->dims[0] == 4 && info->dims[1] == 3 && info->dims[2] == 2);
    assert_false(info->medical);
    assert_string_equal(info->unit, "");
    expect_counting(volume);
    assert_string_equal(files->warnings, "");
}

static void headers_are_read_in_any_order_and_style(void **state) {
    support_files *files = *state;
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
    for (size_t i = 0; i < COUNT(headers); i++)
        expect_counting(opened(files, headers[i]));
}

static void every_spelling_of_a_type_is_known(void **state) {
    support_files *files = *state;
    static const char *const types[][2] = {
        {"signed char", "int8"},
        {"int8_t", "int8"},
        {"uchar", "uint8"},
        {"unsigned char", "uint8"},
        {"signed short int", "int16"},
        {"short", "int16"},
        {"unsigned short int", "uint16"},
        {"int", "int32"},
        {"signed int", "int32"},
        {"unsigned int", "uint32"},
        {"uint32", "uint32"},
        {"long long int", "int64"},
        {"longlong", "int64"},
        {"unsigned long long int", "uint64"},
        {"uint64_t", "uint64"},
        {"float", "float32"},
        {"double", "float64"},
    };
    for (size_t i = 0; i < COUNT(types); i++) {
        char header[200];
        snprintf(header, sizeof header,
                 MAGIC "type: %s\ndimension: 1\nsizes: 6\nendian: little\n"
                       "encoding: raw\n\n",
                 types[i][0]);
        snow_volume *volume = opened(files, header);
        assert_string_equal(snow_type_name(snow_volume_get_info(volume)->type),
                            types[i][1]);
        snow_volume_close(volume);
    }
}

static void both_byte_orders_are_read(void **state) {
    support_files *files = *state;
    snow_volume *volume =
        opened(files, MAGIC "type: ushort\n" SIZES "endian: big\n"
                            "encoding: raw\n\n");
    const uint16_t *voxels = snow_volume_voxels(volume);
    for (int i = 0; i < 24; i++)
        assert_int_equal(voxels[i], (2 * i) << 8 | (2 * i + 1));
    snow_volume_close(volume);
}

static void gzip_data_are_unpacked(void **state) {
    support_files *files = *state;
    unsigned char packed[200];
    size_t size = support_gzip(counting(), 48, packed, sizeof packed);
    static const char header[] = SHORTS "encoding: gz\n\n";
    expect_counting(
        support_opened(files, write_nrrd(files, header, packed, size), NULL));
    support_bad_file(files, write_nrrd(files, header, packed, size - 3),
                     "truncated");
    packed[size > 7 ? size - 7 : 0] ^= 1;
    support_bad_file(files, write_nrrd(files, header, packed, size), "damaged");
    support_bad_file(files, write_nrrd(files, header, "plain", 5), "damaged");
}

/* Two digits for each byte, of either case, with blanks anywhere. */
static void hexadecimal_data_are_read(void **state) {
    support_files *files = *state;
    char text[300] = "";
    size_t used = 0;
    for (int i = 0; i < 48; i++)
        used += (size_t)snprintf(text + used, sizeof text - used,
                                 i % 5 ? "%02x" : "%X\n %X", i % 5 ? i : i / 16,
                                 i % 16);
    static const char header[] = SHORTS "encoding: hex\n\n";
    expect_counting(
        support_opened(files, write_nrrd(files, header, text, used), NULL));
    text[used++] = '7';
    text[used++] = '7';
    expect_counting(
        support_opened(files, write_nrrd(files, header, text, used), NULL));
    assert_non_null(strstr(files->warnings, "1 byte after the data"));
    support_bad_file(files, write_nrrd(files, header, text, used - 3), "");
    support_bad_file(files, write_nrrd(files, header, text, used - 1),
                     "within a byte");
    text[7] = 'g';
    support_bad_file(files, write_nrrd(files, header, text, used), "no digit");
}

/* By Python's bz2: a stream, and two of which the second is behind a skip. */
static void bzip2_data_are_unpacked(void **state) {
    support_files *files = *state;
    static const unsigned char packed[] = {
        66,  90,  104, 57,  49,  65,  89,  38,  83,  89,  50,  124, 191, 6,
        0,   0,   0,   112, 0,   127, 255, 255, 255, 255, 255, 160, 0,   35,
        0,   105, 161, 147, 70,  35,  32,  209, 160, 3,   70,  134, 6,   65,
        144, 0,   98,  52,  25,  12,  128, 198, 188, 252, 16,  197, 24,  36,
        12,  179, 78,  33,  208, 74,  106, 41,  143, 93,  136, 77,  183, 95,
        130, 177, 201, 121, 233, 174, 219, 241, 207, 93,  248, 207, 126, 111,
        226, 238, 72,  167, 10,  18,  6,   79,  151, 224, 192};
    const size_t size = sizeof packed;
    unsigned char two[2 * sizeof packed];
    static const char header[] = SHORTS "encoding: bz2\n\n",
                      second[] = SHORTS "encoding: bzip2\nbyte skip: -1\n\n";
    memcpy(two, packed, size);
    memcpy(two + size, packed, size);
    if (!SNOW_HAVE_BZIP2) {
        support_bad_file(files, write_nrrd(files, header, packed, size),
                         "libbz2-dev");
        return;
    }
    expect_counting(
        support_opened(files, write_nrrd(files, header, packed, size), NULL));
    expect_counting(
        support_opened(files, write_nrrd(files, second, two, 2 * size), NULL));
    assert_string_equal(files->warnings, "");
    const snow_volume_options none = {.size = sizeof none};
    support_refused(files, write_nrrd(files, header, packed, size - 3), &none,
                    SNOW_STATUS_BAD_INPUT, "truncated", (size_t)8 << 20);
    two[size - 10] ^= 1;
    support_refused(files, write_nrrd(files, header, two, size), &none,
                    SNOW_STATUS_BAD_INPUT, "damaged", (size_t)8 << 20);
}

/* Lines are skipped before unpacking, bytes after it. */
static void skips_apply_on_their_side_of_the_packing(void **state) {
    support_files *files = *state;
    unsigned char packed[200] = "one\ntwo\n", plain[60] = "1\n2\nxy";
    memcpy(plain + 6, counting(), 48);
    size_t size = 8 + support_gzip(plain + 4, 50, packed + 8, 192);
    static const char *const headers[] = {
        SHORTS "encoding: gzip\nline skip: 2\nbyte skip: 2\n\n",
        SHORTS "encoding: gzip\nlineskip: 2\nbyte skip: -1\n\n",
        RAW "line skip: 2\nbyte skip: 2\n\n",
        RAW "byte skip: -1\n\n",
    };
    for (size_t i = 0; i < COUNT(headers); i++)
        expect_counting(
            support_opened(files,
                           write_nrrd(files, headers[i], i < 2 ? packed : plain,
                                      i < 2 ? size : 54),
                           NULL));
    assert_string_equal(files->warnings, "");
}

static void a_whole_file_may_be_packed(void **state) {
    support_files *files = *state;
    unsigned char inner[ROOM], packed[ROOM];
    static const char header[] = RAW "byte skip: -1\n\nzz";
    memcpy(inner, header, sizeof header - 1);
    memcpy(inner + sizeof header - 1, counting(), 48);
    size_t size =
        support_gzip(inner, sizeof header + 47, packed, sizeof packed);
    expect_counting(support_opened(
        files, support_write(files, "a.nrrd.gz", packed, size), NULL));
}

/* The last bytes of a stream, of which one time step is wanted. */
static void a_step_among_the_last_bytes_of_gzip_is_found(void **state) {
    support_files *files = *state;
    unsigned char data[60] = "head", packed[200];
    memcpy(data + 4, counting(), 48);
    static const char header[] =
        MAGIC "type: uint8\nencoding: gzip\ndimension: 4\nsizes: 4 2 2 3\n"
              "kinds: domain domain domain time\nbyte skip: -1\n\n";
    size_t size = support_gzip(data, 52, packed, sizeof packed);
    const snow_volume_options options = {.size = sizeof options, .time = 1};
    snow_volume *volume = support_opened(
        files, write_nrrd(files, header, packed, size), &options);
    assert_memory_equal(snow_volume_voxels(volume), counting() + 16, 16);
    snow_volume_close(volume);
    size = support_gzip(data, 47, packed, sizeof packed);
    support_bad_file(files, write_nrrd(files, header, packed, size),
                     "47 bytes");
}

#define TEXT(type, sizes, numbers)                      \
    MAGIC "type: " type "\ndimension: 1\nsizes: " sizes \
          "\nencoding: ascii\n\n" numbers

static void numbers_in_text_are_read(void **state) {
    support_files *files = *state;
    static const struct {
        const char *text;
        double wanted[6];
        int count;
    } cases[] = {
        {MAGIC "type: double\ndimension: 2\nsizes: 3 2\nencoding: text\n\n"
               "1 -2.5e3,nan\n\n\tinf 4 5",
         {1, -2500, NAN, INFINITY, 4, 5},
         6},
        {TEXT("uint", "1", "4294967295"), {UINT32_MAX}, 1},
        {TEXT("float", "1", "3.4028235e38"), {FLT_MAX}, 1},
        {TEXT("float", "2", "0.5 -1e2 and more"), {0.5, -100}, 2},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        assert_string_equal(files->warnings, "");
        snow_volume *volume = opened_text(files, cases[i].text);
        const snow_type type = snow_volume_get_info(volume)->type;
        const void *voxels = snow_volume_voxels(volume);
        for (int n = 0; n < cases[i].count; n++) {
            double is = type == SNOW_TYPE_FLOAT64 ? ((const double *)voxels)[n]
                        : type == SNOW_TYPE_FLOAT32
                            ? (double)((const float *)voxels)[n]
                            : ((const uint32_t *)voxels)[n];
            double wanted = cases[i].wanted[n];
            assert_true(is == wanted || (isnan(is) && isnan(wanted)));
        }
        snow_volume_close(volume);
    }
    assert_int_equal(support_warned(files), 1);
    snow_volume *volume =
        opened_text(files, TEXT("uint64", "2", "18446744073709551615 0\n"));
    assert_true(*(const uint64_t *)snow_volume_voxels(volume) == UINT64_MAX);
    snow_volume_close(volume);
}

static void text_that_is_no_number_of_the_type_is_refused(void **state) {
    support_files *files = *state;
    static const char *const texts[][2] = {
        {"uint8", "1 256"},    {"uint8", "1 -1"},    {"int8", "1 128"},
        {"short", "1 2.5"},    {"uint64", "1 -1"},   {"int", "1 x"},
        {"double", "1 1e"},    {"int64", "1 1e999"}, {"uint", "1 -1"},
        {"short", "1 0x10"},   {"short", "1 1e1"},   {"double", "1 0x10"},
        {"float", "1 3.5e38"}, {"uint64", "1 +-1"},  {"uint64", "1 1."},
    };
    for (size_t i = 0; i < COUNT(texts); i++) {
        char text[200];
        snprintf(text, sizeof text, TEXT("%s", "2", "%s"), texts[i][0],
                 texts[i][1]);
        refused_text(files, text, "is no");
    }
    /* One number that would be two if it were cut where room ends. */
    char digits[1000] = TEXT("double", "2", "0.");
    size_t used = strlen(digits);
    memset(digits + used, '3', sizeof digits - 1 - used);
    refused_text(files, digits, "is no");
    refused_text(files, TEXT("int", "3", "10 20   "), "2 of 3");
}

/* Where the voxels lie, in which unit; millimetres are those of a patient. */
static void expect_place(support_files *files, const char *unit,
                         const char *header, const double rows[12]) {
    snow_volume *volume = opened(files, header);
    const snow_volume_info *info = snow_volume_get_info(volume);
    support_expect_matrix(volume, rows);
    assert_string_equal(info->unit, unit);
    assert_int_equal(info->medical, !strcmp(unit, "mm"));
    expect_counting(volume);
}

static void spaces_are_turned_to_ras(void **state) {
    static const struct {
        const char *space;
        double x, y;
    } spaces[] = {
        {"RAS", 1, 1},   {"right-anterior-superior", 1, 1},
        {"LAS", -1, 1},  {"left-anterior-superior", -1, 1},
        {"lps", -1, -1}, {"left-posterior-superior", -1, -1},
    };
    for (size_t i = 0; i < COUNT(spaces); i++) {
        char header[400];
        double x = spaces[i].x, y = spaces[i].y;
        snprintf(header, sizeof header,
                 RAW "space: %s\nspace directions: (1,0,0) ( 0, 0.5, 0.1 ) "
                     "(0,-0.1,2)\nspace origin: (10,20,30)\n\n",
                 spaces[i].space);
        expect_place(*state, "mm", header,
                     (double[]){x, 0, 0, 10 * x, 0, 0.5 * y, -0.1 * y, 20 * y,
                                0, 0.1, 2, 30});
    }
}

static void other_worlds_are_not_medical(void **state) {
    support_files *files = *state;
    expect_place(files, "um",
                 RAW "space: scanner-xyz\nspace directions: (2,0,0) (0,2,0) "
                     "(0,0,2)\nspace units: \"\xc2\xb5m\" \"um\" \"um\"\n\n",
                 (double[]){2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0});
    expect_place(files, "nm",
                 RAW "space: 3D-left-handed\nspacings: 1 2 3\nunits: \"\" "
                     "\"nm\" \"\"\nspace origin: (1,1,1)\n\n",
                 (double[]){1, 0, 0, 1, 0, 2, 0, 1, 0, 0, -3, -1});
    /* The world is left-handed, and two axes have no unit. */
    assert_int_equal(support_warned(files), 3);
}

/* Format.html of teem: units belong to spacings, space units to directions and
 * the origin. */
static void axes_in_several_units_are_brought_into_one(void **state) {
    support_files *files = *state;
    const double rows[] = {.2, 0, 0, 0, 0, .2, 0, 0, 0, 0, .8, 0};
    expect_place(files, "um",
                 RAW "spacings: 0.2 0.2 800\nunits: \"\xc2\xb5m\" \"microns\" "
                     "\"nm\"\n\n",
                 rows);
    expect_place(files, "um",
                 RAW
                 "space dimension: 3\nspace directions: (0.2,0,0) (0,2e-4,0)"
                 " (0,0,800)\nspace origin: (1,0.002,3000)\nspace units: "
                 "\"Micrometer\" \"mm\" \"nm\"\n\n",
                 (double[]){.2, 0, 0, 1, 0, .2, 0, 2, 0, 0, .8, 3});
    assert_int_equal(support_warned(files), 0);
    expect_place(files, "um",
                 RAW "spacings: 0.2 0.2 0.8\nunits: \"um\" \"um\" \"furlong\""
                     "\n\n",
                 rows);
    assert_non_null(strstr(files->warnings, "furlong"));
}

static void fewer_axes_than_three_are_filled_up(void **state) {
    support_files *files = *state;
    expect_place(files, "",
                 PLAIN "dimension: 2\nsizes: 4 6\nencoding: raw\nspace "
                       "dimension: 3\nspace directions: (0,3,0) (0,0,-2)\n\n",
                 (double[]){0, 0, -1, 0, 3, 0, 0, 0, 0, -2, 0, 0});
    snow_volume *volume =
        opened(files, PLAIN "dimension: 1\nsizes: 24\nencoding: raw\n"
                            "space dimension: 2\nspace directions: (0,3)\n\n");
    assert_true(snow_volume_get_info(volume)->spacing[0] == 3);
    expect_counting(volume);
}

/* Of cells unless told, of nodes, with NaN, ends in either order. */
static void axes_may_be_told_by_their_ends(void **state) {
    support_files *files = *state;
    expect_place(files, "", RAW "axis mins: 0 -3 10\naxis maxs: 8 0 14\n\n",
                 (double[]){2, 0, 0, 1, 0, 1, 0, -2.5, 0, 0, 2, 11});
    expect_place(files, "",
                 RAW "axismins: 0 -3 10\naxismaxs: 6 1 14\ncenterings: node "
                     "node cell\n\n",
                 (double[]){2, 0, 0, 0, 0, 2, 0, -3, 0, 0, 2, 11});
    expect_place(files, "",
                 RAW "axis mins: nan 0 5\naxis maxs: 8 nan 1\ncenters: none "
                     "??? cell\n\n",
                 (double[]){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -2, 4});
    expect_place(files, "",
                 RAW "axis mins: 0 0 0\naxis maxs: 8 6 4\nspacings: 1 1 3\n\n",
                 (double[]){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 3, 0});
    expect_place(files, "", RAW "axis mins: 0 0 0\n\n",
                 (double[]){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0});
    expect_place(files, "mm",
                 RAW "space: LPS\nspace origin: (1,2,3)\naxis mins: 0 0 0\n"
                     "axis maxs: 8 6 4\n\n",
                 (double[]){-2, 0, 0, -1, 0, -2, 0, -2, 0, 0, 2, 3});
}

static void the_users_spacing_replaces_the_files(void **state) {
    support_files *files = *state;
    const snow_volume_options options = {.size = sizeof options,
                                         .spacing = {0, 4, 5}};
    snow_volume *volume = support_opened(
        files, write_nrrd(files, RAW "spacings: 1 -2 3\n\n", counting(), 48),
        &options);
    support_expect_matrix(volume,
                          (double[]){1, 0, 0, 0, 0, -4, 0, 0, 0, 0, 5, 0});
    assert_true(snow_volume_get_info(volume)->spacing[1] == 4);
    snow_volume_close(volume);
}

#define BYTES(sizes) \
    MAGIC "type: uint8\nencoding: raw\ndimension: 4\nsizes: " sizes "\n"
#define TIMES BYTES("4 2 2 3")

static void a_last_axis_of_time_or_list_has_steps(void **state) {
    support_files *files = *state;
    static const char *const headers[] = {
        TIMES "kinds: domain domain domain time\nspacings: 1 1 1 nan\n\n",
        TIMES "kinds: space space space list\nspace: RAS\n"
              "space directions: (1,0,0) (0,1,0) (0,0,1) none\n\n",
        TIMES "space: RAST\nspace directions: "
              "(1,0,0,0) (0,1,0,0) (0,0,1,0) (0,0,0,2)\n\n",
    };
    for (size_t i = 0; i < 3 * COUNT(headers); i++) {
        const char *path = write_nrrd(files, headers[i / 3], counting(), 48);
        const int64_t time = (int64_t)i % 3;
        snow_volume_options options = {.size = sizeof options, .time = time};
        *files->warnings = 0;
        snow_volume *volume = support_opened(files, path, &options);
        assert_int_equal(*(const uint8_t *)snow_volume_voxels(volume),
                         16 * time);
        assert_int_equal(snow_volume_get_info(volume)->times, 3);
        assert_int_equal(snow_volume_get_info(volume)->time, time);
        assert_int_equal(support_warned(files), time == 0); /* unasked */
        snow_volume_close(volume);
        options.time = 3;
        support_refused(files, path, &options, SNOW_STATUS_BAD_USAGE,
                        i / 3 == 1 ? "no volume 3" : "no time step 3",
                        SUPPORT_MOST);
    }
}

static void axes_of_one_sample_are_left_out(void **state) {
    support_files *files = *state;
    snow_volume *volume =
        opened(files, PLAIN "dimension: 5\nsizes: 1 4 1 3 2\nencoding: raw\n"
                            "kinds: stub domain domain domain domain\n\n");
    const int64_t *dims = snow_volume_get_info(volume)->dims;
    assert_true(dims[0] == 4 && dims[1] == 3 && dims[2] == 2);
    expect_counting(volume);
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
    support_files *files = *state;
    static const char *const kinds[] = {"RGB-color", "3-color", "vector"};
    for (size_t i = 0; i < COUNT(kinds); i++) {
        char header[400];
        snprintf(header, sizeof header,
                 COLORS "kinds: %s domain domain domain\nencoding: raw\n\n",
                 kinds[i]);
        const char *path = write_nrrd(files, header, counting(), 48);
        for (int channel = 0; channel < 3; channel++)
            expect_values(files, path, 3, channel, channel);
        snow_volume *volume = support_opened(files, path, NULL);
        const snow_volume_info *info = snow_volume_get_info(volume);
        assert_int_equal(info->channels, 3);
        assert_string_equal(info->channel[1].name, "green");
        assert_true(info->channel[2].own && info->channel[2].shown);
        assert_true(info->spacing[2] > 1.99 && info->spacing[2] < 2.01);
        snow_volume_close(volume);
    }
    support_write(files, "c.raw", counting(), 48);
    expect_values(files,
                  support_write_text(files, "c.nhdr",
                                     COLORS
                                     "kinds: RGB-color domain domain domain\n"
                                     "encoding: raw\ndata file: c.raw\n\n"),
                  3, 2, 1);
    expect_values(files,
                  write_nrrd(files,
                             BYTES("4 4 3 1") "kinds: RGBA-color domain "
                                              "domain domain\n\n",
                             counting(), 48),
                  4, 3, 0);
    snow_volume_options second = {.size = sizeof second, .channel = 1};
    support_refused(files, write_nrrd(files, RAW "\n", counting(), 48), &second,
                    SNOW_STATUS_BAD_USAGE, "the voxels have 1", SUPPORT_MOST);
}

/* (3, 4), a zero, and their lengths. */
static void vectors_have_components(void **state) {
    support_files *files = *state;
    const float data[] = {3, 4, 0, 0};
    static const char *const names[] = {"x", "y", "magnitude"};
    const float wanted[] = {3, 4, 5};
    const char *path = write_nrrd(
        files,
        MAGIC "type: float\nendian: little\ndimension: 4\nsizes: 2 2 1 1\n"
              "encoding: raw\nkinds: vector domain domain domain\n\n",
        data, sizeof data);
    for (int n = 0; n < 3; n++) {
        snow_volume_options options = {.size = sizeof options,
                                       .component = names[n]};
        snow_volume *volume = support_opened(files, path, &options);
        const float *voxels = snow_volume_voxels(volume);
        assert_true(fabsf(voxels[0] - wanted[n]) < 1e-6F);
        assert_true(fabsf(voxels[1]) < 1e-6F);
        assert_int_equal(snow_volume_get_info(volume)->components, 2);
        snow_volume_close(volume);
    }
}

/* Three volumes of 4x2x2 voxels that lie apart, as each of these headers says,
 * in text and in files of one voxel or row: value 16 * time + n. */
static void volumes_that_lie_apart_are_found(void **state) {
    support_files *files = *state;
    static const struct {
        const char *header;
        int64_t outer, inner; /* voxels inside and outside of the axis */
        bool component;
    } cases[] = {
        {BYTES("3 4 2 2") "kinds: list domain domain domain\n\n", 16, 1, false},
        {BYTES("4 3 2 2") "kinds: space time space space\n\n", 4, 4, false},
        {BYTES("4 2 3 2") "space: RAS\nspace directions: (1,0,0) (0,1,0) none "
                          "(0,0,1)\n\n",
         2, 8, false},
        {BYTES("3 4 2 2") "space: RAS\nspace directions: none (1,0,0) (0,1,0) "
                          "(0,0,1)\n\n",
         16, 1, true},
        {BYTES("4 2 2 3") "kinds: domain domain domain covariant-vector\n\n", 1,
         16, true},
        {BYTES("4 2 2 3") "space: RAS\nspace directions: (1,0,0) (0,1,0) "
                          "(0,0,1) none\n\n",
         1, 16, false},
        {BYTES("4 2 2 3") "kinds: domain domain domain domain\n\n", 1, 16,
         false},
        {BYTES("3 4 2 2") "kinds: list domain domain domain\nbyte skip: -1\n\n",
         16, 1, false},
    };
    unsigned char bytes[48];
    for (size_t i = 0; i < COUNT(cases); i++)
        for (int64_t time = 0; time < 3; time++) {
            for (int64_t n = 0; n < 48; n++) {
                const int64_t at = n % cases[i].inner,
                              t = n / cases[i].inner % 3,
                              high = n / cases[i].inner / 3;
                bytes[n] = (unsigned char)(16 * t + high * cases[i].inner + at);
            }
            const snow_volume_options options = {
                .size = sizeof options,
                .time = cases[i].component ? 0 : time,
                .channel = cases[i].component ? time : 0,
                .channel_given = true,
                .crop = {{1, 3}, {0, 0}, {1, 2}}};
            snow_volume *volume = support_opened(
                files, write_nrrd(files, cases[i].header, bytes, 48), &options);
            const unsigned char *voxels = snow_volume_voxels(volume);
            static const int wanted[] = {9, 10, 13, 14};
            for (int n = 0; n < 4; n++)
                assert_int_equal(voxels[n], 16 * time + wanted[n]);
            snow_volume_close(volume);
        }
}

/* In text and in files of two voxels with three values each. */
static void values_of_voxels_may_be_in_text_and_files(void **state) {
    support_files *files = *state;
    expect_values(
        files,
        support_write_text(files, "t.nrrd",
                           COLORS
                           "kinds: 3-color domain domain domain\n"
                           "encoding: ascii\n\n"
                           "0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 "
                           "20 21 22 23 24 25 26 27 28 29 30 31 32 33 34 35 "
                           "36 37 38 39 40 41 42 43 44 45 46 47\n"),
        3, 1, 1);
    support_write(files, "s0", counting(), 24);
    support_write(files, "s1", counting() + 24, 24);
    expect_values(files,
                  support_write_text(files, "t.nhdr",
                                     COLORS
                                     "kinds: 3-color domain domain domain\n"
                                     "encoding: raw\ndata file: s%d 0 1 1\n"),
                  3, 2, 0);
}

/* A label of 3D Slicer's in each of two layers; the same of its files from
 * before 2020, which count no layers. */
static void layers_of_segments_have_labels_of_their_own(void **state) {
    support_files *files = *state;
    static const char *const headers[] = {
        BYTES("2 3 4 2") "kinds: list domain domain domain\n"
                         "Segment0_Name:=liver\nSegment0_LabelValue:="
                         "7\nSegment0_Layer:=0\n"
                         "Segment1_Name:=tumour\nSegment1_LabelValue:="
                         "7\nSegment1_Layer:=1\n"
                         "\n",
        BYTES("2 3 4 2") "kinds: list domain domain domain\n"
                         "Segment0_Name:=liver\nSegment1_Name:=tumour\n\n",
    };
    for (int i = 0; i < 4; i++) {
        const snow_volume_options options = {.size = sizeof options,
                                             .time = i % 2};
        snow_volume *volume = support_opened(
            files, write_nrrd(files, headers[i / 2], counting(), 48), &options);
        assert_int_equal(volume->label_count, 1);
        assert_string_equal(volume->labels[0].name, i % 2 ? "tumour" : "liver");
        assert_true(volume->labels[0].value > (i < 2 ? 6.5 : 0.5) &&
                    volume->labels[0].value < (i < 2 ? 7.5 : 1.5));
        snow_volume_close(volume);
    }
}

/* As 3D Slicer and pynrrd have written them: a field twice, no direction. */
static void fields_that_say_nothing_more_are_no_matter(void **state) {
    support_files *files = *state;
    expect_place(files, "mm",
                 RAW "space: RAS\nspace: RAS\nspace directions: none none "
                     "none\nkinds: domain domain domain\nspacings: 2 1 3\n\n",
                 (double[]){2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 3, 0});
    assert_string_equal(files->warnings, "");
}

static void unknown_spacings_are_one(void **state) {
    support_files *files = *state;
    expect_place(files, "", RAW "spacings: 2 nan 1\n\n",
                 (double[]){2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0});
    assert_non_null(strstr(files->warnings, "axis 1 is not known"));
}

static void other_values_of_voxels_are_refused(void **state) {
    static const char *const cases[][2] = {
        {BYTES("3 4 4 2") "kinds: RGB-color domain domain domain\n\n", ""},
        {MAGIC "type: double\nendian: little\nencoding: raw\ndimension: 4\n"
               "sizes: 3 4000000000 4000000000 4000000000\n"
               "kinds: vector domain domain domain\n\n",
         ""},
        {TIMES "\n", "the meaning of the 4th is unknown"},
        {TIMES "kinds: time domain domain list\n\n",
         "axes 0 and 3 are both time"},
        {TIMES "kinds: vector domain domain 3-color\n\n",
         "axes 0 and 3 are both values"},
    };
    refused(*state, cases, COUNT(cases));
}

/* What the 63 first letters are would be a good size. */
#define ZEROS "0000000000000000000000000000000000000000"

#define SIZED MAGIC "type: uint8\nencoding: raw\n"

static void contradictions_are_refused(void **state) {
    static const char *const cases[][2] = {
        {RAW "type: float\n\n", "twice with different"},
        {MAGIC SIZES "encoding: raw\n\n", "\"type\""},
        {MAGIC "type: block\n" SIZES "encoding: raw\nblock size: 4\n\n",
         "block"},
        {MAGIC "type: char\n" SIZES "encoding: raw\n\n", "char"},
        {MAGIC "type: short\n" SIZES "encoding: raw\n\n", "\"endian\""},
        {MAGIC "type: short\n" SIZES "endian: middle\nencoding: raw\n\n",
         "middle"},
        {SHORTS "\n", "\"encoding\""},
        {SHORTS "encoding: zrl\n\n", "gzip"},
        {SIZED "sizes: 4 3 2\n\n", "dimension"},
        {SIZED "dimension: 3\n\n", "sizes"},
        {SIZED "dimension: 17\nsizes: 1\n\n", "17"},
        {SIZED "dimension: 3\nsizes: 4 3\n\n", "sizes"},
        {SIZED "dimension: 3\nsizes: 1 2 3 4\n\n", "more numbers"},
        {SIZED "dimension: 3\nsizes: 4 3 " ZEROS "000000000000000000000021\n\n",
         "sizes"},
        {SIZED "dimension: 3\nsizes: 4 3 2 " ZEROS ZEROS ZEROS "\n\n",
         "more numbers"},
        {SIZED "dimension: 4\nkinds: domain domain domain time\n"
               "sizes: 2000000000 2000000000 2 9000000000\n\n",
         "time steps"},
        {RAW "spacings: 1 1\n\n", "spacings"},
        {RAW "spacings: 1 1 1 1\n\n", "spacings"},
        {RAW "spacings: 1 1 1\x1b[31m\n\n", "1\\033[31m"},
        {RAW "spacing: 1 1 1\n\n", "is not a field"},
        {RAW "kinds: domain domain domain time\n\n", "kinds"},
        {RAW "kinds: domain domain\n\n", "kinds"},
        {RAW "byte skip: -2\n\n", "byte skip"},
        {RAW "line skip: -1\n\n", "line skip"},
        {RAW "line skip: 9\n\n", "fewer lines"},
        {RAW "byte skip: 1\n\n", "the voxels"},
        {"NRRD0006\n\n", "NRRD0006"},
        {"NRRX0004\n\n", "NRRD000"},
    };
    refused(*state, cases, COUNT(cases));
}

#define NO_PLACE "zero, not finite, or in one plane"

static void places_that_are_none_are_refused(void **state) {
    static const char *const cases[][2] = {
        {RAW "space dimension: 9\n\n", "space dimension"},
        {RAW "space: nowhere\n\n", "nowhere"},
        {RAW "space: RAS\nspace dimension: 2\n\n", "contradicts"},
        {RAW "space: RAS\nspace directions: (1,0,0) (0,1,0) (0,0,1) none\n\n",
         "directions"},
        {RAW "space: RAS\nspace directions: (1,0) (0,1) (1,1)\n\n",
         "directions"},
        {RAW "space: RAS\nspace directions: (1,0,0) (0,1,0)\n\n", "directions"},
        {RAW "space origin: (1,2)\n\n", "origin"},
        {RAW "axis mins: 0 0 0\naxis maxs: 0 1 1\n\n", "zero"},
        {RAW "axis mins: 0 0\naxis maxs: 1 1 1\n\n", "axis mins"},
        {RAW "axis mins: 0 0 0\naxis maxs: 1 1 1 1\n\n", "more"},
        {RAW "spacings: 1 0 1\n\n", NO_PLACE},
        {RAW "spacings: inf 1 1\n\n", NO_PLACE},
        {RAW "space dimension: 3\nspace directions: (1,0,0) (2,0,0) (0,0,1)"
             "\n\n",
         NO_PLACE},
        {RAW "space dimension: 3\nspace directions: (1,0,0) (0,0,0) (0,0,1)"
             "\n\n",
         NO_PLACE},
        {RAW "space dimension: 3\nspace directions: (1,0,nan) (0,1,0) (0,0,1)"
             "\n\n",
         NO_PLACE},
        {RAW "space origin: (nan,0,0)\n\n", NO_PLACE},
    };
    refused(*state, cases, COUNT(cases));
}

static void data_that_are_nowhere_are_refused(void **state) {
    static const char *const cases[][2] = {
        {RAW, "within its header"},
        {RAW "data file: LIST\n", "number of files"},
        {RAW "data file: LIST x\na\nb\n", "LIST"},
        {RAW "data file: LIST 4\na\n", "number of files"},
        {RAW "data file: s%d 1 9 -1\n", "number of files"},
        {RAW "data file: s%d 1 9 0\n", "number of files"},
        {RAW "data file: none.raw\n", "none.raw"},
        {RAW "data file: /dev/zero\n", "a device"},
        {RAW "data file: LIST\nnone.raw\nnone.raw\n", "none.raw"},
    };
    for (size_t i = 0; i < COUNT(cases); i++)
        refused_text(*state, cases[i][0], cases[i][1]);
}

static void sizes_that_lie_are_refused_before_their_memory(void **state) {
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
    static const char *const encodings[] = {"raw", "gzip", "ascii", "hex"};
    unsigned char data[200];
    size_t size = support_gzip(counting(), 48, data, sizeof data);
    for (size_t i = 0; i < 4 * COUNT(sizes); i++) {
        char header[300];
        snprintf(header, sizeof header,
                 MAGIC "type: double\nendian: little\ndimension: 3\n"
                       "sizes: %s\nencoding: %s\n\n",
                 sizes[i / 4], encodings[i % 4]);
        support_bad_file(*state, write_nrrd(*state, header, data, size), "");
    }
}

static void data_too_short_or_too_long_are_told(void **state) {
    support_files *files = *state;
    unsigned char longer[50] = {0};
    memcpy(longer, counting(), 48);
    support_bad_file(files, write_nrrd(files, RAW "\n", longer, 47), "47");
    expect_counting(
        support_opened(files, write_nrrd(files, RAW "\n", longer, 50), NULL));
    assert_int_equal(support_warned(files), 1);
}

static void data_may_be_in_another_file(void **state) {
    support_files *files = *state;
    support_write(files, "the data.raw", counting(), 48);
    /* With and without an empty line at the end; an absolute path. */
    expect_counting(opened_text(files, "NRRD0004\ndata file: the data.raw\n"
                                       "type: ushort\n" SIZES
                                       "endian: little\nencoding: raw"));
    char header[400];
    snprintf(header, sizeof header, RAW "datafile: %s\n\nnot read",
             support_path(files, "the data.raw"));
    expect_counting(opened_text(files, header));
}

/* Raw data may begin with the bytes of gzip by chance. */
static void raw_data_are_never_unpacked(void **state) {
    support_files *files = *state;
    static const unsigned char bytes[4] = {0x1f, 0x8b, 8, 0};
    support_write(files, "a.raw", bytes, 4);
    snow_volume *volume =
        opened_text(files, SIZED "dimension: 1\nsizes: 4\ndata file: a.raw\n");
    assert_memory_equal(snow_volume_voxels(volume), bytes, 4);
    snow_volume_close(volume);
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
    support_files *files = *state;
    write_pieces(files, "slice", 24, false);
    write_pieces(files, "packed", 24, true);
    write_pieces(files, "row", 8, false);
    support_write(files, "blank  1.x", counting(), 24);
    support_write(files, "blank  2.x", counting() + 24, 24);
    static const char *const headers[] = {
        RAW "data file: LIST\nslice10\nslice09\n",
        RAW "data file: LIST 2\nslice10\nslice09",
        RAW "data file: LIST 3\nslice10\nslice09\n",
        SHORTS "encoding: gzip\ndata file: LIST\npacked10\npacked09\n",
        RAW "data file: LIST 1\nrow10\nrow09\nrow08\nrow07\nrow06\nrow05\n",
        RAW "data file: slice%02d 10 9 -1\n",
        RAW "data file: row%02u 10 5 -1 1\n",
        RAW "data file: blank%3d.x 1 2 1\n",
    };
    for (size_t i = 0; i < COUNT(headers); i++)
        expect_counting(opened_text(files, headers[i]));
    refused_text(files,
                 SHORTS "encoding: gzip\ndata file: packed%02d 10 8 -1 2\n",
                 "number of files");
}

static void slices_of_wrong_size_are_refused_before_memory(void **state) {
    support_files *files = *state;
    support_write(files, "s1", counting(), 48);
    support_write(files, "s2", counting(), 48);
    refused_text(files,
                 SIZED "dimension: 3\nsizes: 100000 100000 2\n"
                       "data file: s%d 1 2 1\n",
                 "s1");
    support_write(files, "s2", counting(), 23);
    refused_text(files, RAW "data file: s%d 1 2 1\n", "s2");
}

/* Of a series in files only those of the time step are opened. */
static void a_time_step_needs_its_own_files_only(void **state) {
    support_files *files = *state;
    support_write(files, "t1", counting(), 16);
    const char *path = support_write_text(
        files, "a.nhdr",
        TIMES "kinds: domain domain domain time\ndata file: t%d 0 2 1 3\n");
    const snow_volume_options options = {.size = sizeof options, .time = 1};
    snow_volume *volume = support_opened(files, path, &options);
    assert_memory_equal(snow_volume_voxels(volume), counting(), 16);
    snow_volume_close(volume);
    support_bad_file(files, path, "t0");
}

static void odd_patterns_are_names(void **state) {
    support_files *files = *state;
    static const char *const names[] = {
        "%s 1 2 1", "%n", "a%d%d 1 2 1", "%100d 1 2 1",
        "%d 1 2",   "%",  "%d x 2 1",    "%d 111111111111111111111111 1 1"};
    for (size_t i = 0; i < COUNT(names); i++) {
        char header[300];
        support_write(files, names[i], counting(), 48);
        snprintf(header, sizeof header, RAW "data file: %s\n", names[i]);
        expect_counting(opened_text(files, header));
    }
}

/* Nor is a name one, where there are no bytes. */
static void memory_has_no_other_files(void **state) {
    static const char header[] = RAW "data file: LIST\na\nb\n";
    support_bad_bytes(*state, "a.nhdr", header, sizeof header - 1,
                      "cannot be opened from here");
    support_bad_bytes(*state, "phantom:head", NULL, 0, "");
}

static void options_for_raw_data_do_not_fit(void **state) {
    const snow_volume_options options = {.size = sizeof options,
                                         .type = SNOW_TYPE_UINT8};
    support_refused(*state, write_nrrd(*state, RAW "\n", counting(), 48),
                    &options, SNOW_STATUS_BAD_USAGE, "nrrd", SUPPORT_MOST);
}

static void a_cut_file_is_refused_at_every_length(void **state) {
    unsigned char packed[200], all[ROOM];
    static const char header[] = SHORTS "encoding: gzip\nspacings: 1 1 2\n\n";
    size_t length = sizeof header - 1;
    size_t size = support_gzip(counting(), 48, packed, sizeof packed);
    memcpy(all, header, length);
    memcpy(all + length, packed, size);
    for (size_t cut = 1; cut < length + size; cut++)
        support_bad_bytes(*state, "a.nrrd", all, cut, "");
}

#define BALL "formats/nrrd/pynrrd/BallBinary30x30x30"

static void the_real_balls_are_one_ball(void **state) {
    support_files *files = *state;
    const char *path = support_data(BALL ".nrrd");
    if (!path)
        skip();
    snow_volume *ball = support_opened(files, path, NULL);
    static const char *const names[] = {BALL ".nhdr",
                                        BALL "_byteskip_minus_one.nhdr",
                                        BALL "_byteskip_minus_one_nifti.nhdr",
                                        BALL "_gz.nrrd",
                                        BALL "_bz2.nrrd",
                                        BALL "_gz_byteskip_minus_one.nrrd",
                                        BALL "_gz_lineskip.nrrd"};
    for (size_t i = 0; i < COUNT(names); i++) {
        if (!SNOW_HAVE_BZIP2 && strstr(names[i], "bz2"))
            continue;
        snow_volume *other =
            support_opened(files, support_data(names[i]), NULL);
        assert_memory_equal(snow_volume_voxels(other), snow_volume_voxels(ball),
                            54000);
        assert_memory_equal(snow_volume_get_info(other)->matrix,
                            snow_volume_get_info(ball)->matrix,
                            sizeof(double[4][4]));
        snow_volume_close(other);
    }
    assert_string_equal(files->warnings, "");
    snow_volume_close(ball);
}

static void the_real_odd_files_are_refused(void **state) {
    static const char *const names[][2] = {
        {BALL "_nifti.nhdr", "byte skip: -1"},
        {BALL "_byteskip_minus_five.nhdr", "-5"}};
    for (size_t i = 0; i < COUNT(names); i++)
        if (support_data(names[i][0]))
            support_bad_file(*state, support_data(names[i][0]), names[i][1]);
}

#define REAL "formats/nrrd/"

/* Figures by numpy from the same files. */
static void the_real_files_have_their_figures(void **state) {
    static const struct {
        const char *name;
        double dims[3], spacing[3], figures[3]; /* max, sum, wsum */
    } real[] = {
        {REAL "avf_float_32.nrrd",
         {74, 93, 20},
         {0.7226560115814209, 0.7226560115814209, 1},
         {2509.886962890625, 25368783.287802219, 12795225902.451496}},
        {REAL "fmob-c4h.nrrd",
         {32, 40, 16},
         {0.051282064516129031, 0.05128205128205128, 0.051282000000000001},
         {1.049265265249152, 1971.1912011818745, 977637.32015209424}},
        {REAL "pynrrd/test1d_ascii.nrrd",
         {27, 1, 1},
         {1.0458, 1, 1},
         {27, 378, 6930}},
        {REAL "pynrrd/test2d_ascii.nrrd",
         {3, 9, 1},
         {1.0458, 2, 1},
         {27, 378, 6930}},
        {REAL "pynrrd/test_customFields.nrrd",
         {27, 1, 1},
         {1.0458, 1, 1},
         {27, 378, 6930}},
        {REAL "pynrrd/test_simple4d_raw.nrrd",
         {1, 1, 1},
         {1.5, 1.5, 1},
         {0.76903426, 0.76903426, 0.76903426}},
    };
    for (size_t i = 0; i < COUNT(real); i++) {
        const char *path = support_data(real[i].name);
        if (!path)
            continue;
        snow_volume *volume = support_opened(*state, path, NULL);
        const snow_volume_info *info = snow_volume_get_info(volume);
        snow_volume_statistics m = {.size = sizeof m};
        snow_volume_get_statistics(volume, &m);
        const double figures[3] = {m.max, m.sum, m.wsum};
        for (int k = 0; k < 3; k++) {
            assert_true((double)info->dims[k] == real[i].dims[k]);
            assert_true(fabs(info->spacing[k] - real[i].spacing[k]) < 1e-15);
            assert_true(fabs(figures[k] / real[i].figures[k] - 1) <
                        (k ? 1e-13 : 1e-15));
        }
        snow_volume_close(volume);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        SUPPORT_TEST(a_plain_file_is_read),
        SUPPORT_TEST(headers_are_read_in_any_order_and_style),
        SUPPORT_TEST(every_spelling_of_a_type_is_known),
        SUPPORT_TEST(both_byte_orders_are_read),
        SUPPORT_TEST(gzip_data_are_unpacked),
        SUPPORT_TEST(hexadecimal_data_are_read),
        SUPPORT_TEST(bzip2_data_are_unpacked),
        SUPPORT_TEST(skips_apply_on_their_side_of_the_packing),
        SUPPORT_TEST(a_whole_file_may_be_packed),
        SUPPORT_TEST(a_step_among_the_last_bytes_of_gzip_is_found),
        SUPPORT_TEST(numbers_in_text_are_read),
        SUPPORT_TEST(text_that_is_no_number_of_the_type_is_refused),
        SUPPORT_TEST(spaces_are_turned_to_ras),
        SUPPORT_TEST(other_worlds_are_not_medical),
        SUPPORT_TEST(axes_in_several_units_are_brought_into_one),
        SUPPORT_TEST(fewer_axes_than_three_are_filled_up),
        SUPPORT_TEST(axes_may_be_told_by_their_ends),
        SUPPORT_TEST(the_users_spacing_replaces_the_files),
        SUPPORT_TEST(a_last_axis_of_time_or_list_has_steps),
        SUPPORT_TEST(axes_of_one_sample_are_left_out),
        SUPPORT_TEST(colours_are_channels),
        SUPPORT_TEST(vectors_have_components),
        SUPPORT_TEST(volumes_that_lie_apart_are_found),
        SUPPORT_TEST(values_of_voxels_may_be_in_text_and_files),
        SUPPORT_TEST(layers_of_segments_have_labels_of_their_own),
        SUPPORT_TEST(fields_that_say_nothing_more_are_no_matter),
        SUPPORT_TEST(unknown_spacings_are_one),
        SUPPORT_TEST(other_values_of_voxels_are_refused),
        SUPPORT_TEST(contradictions_are_refused),
        SUPPORT_TEST(places_that_are_none_are_refused),
        SUPPORT_TEST(data_that_are_nowhere_are_refused),
        SUPPORT_TEST(sizes_that_lie_are_refused_before_their_memory),
        SUPPORT_TEST(data_too_short_or_too_long_are_told),
        SUPPORT_TEST(data_may_be_in_another_file),
        SUPPORT_TEST(raw_data_are_never_unpacked),
        SUPPORT_TEST(slices_in_files_are_joined),
        SUPPORT_TEST(slices_of_wrong_size_are_refused_before_memory),
        SUPPORT_TEST(a_time_step_needs_its_own_files_only),
        SUPPORT_TEST(odd_patterns_are_names),
        SUPPORT_TEST(memory_has_no_other_files),
        SUPPORT_TEST(options_for_raw_data_do_not_fit),
        SUPPORT_TEST(a_cut_file_is_refused_at_every_length),
        SUPPORT_TEST(the_real_balls_are_one_ball),
        SUPPORT_TEST(the_real_odd_files_are_refused),
        SUPPORT_TEST(the_real_files_have_their_figures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
