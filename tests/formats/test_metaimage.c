/* tests/formats/test_metaimage.c - MetaImage files are read right or refused.
 */
#include "support/files.h"

#include <sys/stat.h>

#include <math.h>

#define COUNT(table) (sizeof(table) / sizeof *(table))

/* A header with its voxels: 3 x 2 x 2 of int16, 100, 101, ..., or packed. */
typedef struct file {
    unsigned char bytes[8192];
    size_t size;
} file;

static const unsigned char *sample_voxels(void) {
    static unsigned char voxels[48];
    for (int i = 0; i < 12; i++)
        voxels[2 * i] = (unsigned char)(100 + i);
    return voxels;
}

static file make_file(const char *header, const void *voxels, size_t size) {
    file f;
    size_t length = strlen(header);
    assert_true(length + size <= sizeof f.bytes);
    memcpy(f.bytes, header, length);
    memcpy(f.bytes + length, voxels, size);
    f.size = length + size;
    return f;
}

/* A text with its first `old` replaced; lasts until the next call but three. */
static const char *replaced(const char *text, const char *old,
                            const char *new) {
    static char made[4][4096];
    static int next;
    char *out = made[next++ % 4];
    const char *at = strstr(text, old);
    assert_non_null(at);
    snprintf(out, sizeof *made, "%.*s%s%s", (int)(at - text), text, new,
             at + strlen(old));
    return out;
}

/* The usual header with more lines put in. */
static const char *header_with(const char *lines) {
    return replaced("ObjectType = Image\nNDims = 3\nBinaryData = True\n"
                    "BinaryDataByteOrderMSB = False\nCompressedData = False\n"
                    "@ElementSpacing = 1 2 3\nDimSize = 3 2 2\n"
                    "ElementType = MET_SHORT\nElementDataFile = LOCAL\n",
                    "@", lines);
}

/* The usual header with one word replaced. */
static const char *header_of(const char *old, const char *new) {
    return replaced(header_with(""), old, new);
}

static const char *packed_header(void) {
    return replaced(header_with("CompressedDataSize = 28\n"),
                    "CompressedData = False", "CompressedData = True");
}

static snow_volume *open_file(support_files *files, const file *f) {
    return support_opened_bytes(files, "a.mha", f->bytes, f->size, NULL);
}

static snow_volume *open_header(support_files *files, const char *header) {
    file f = make_file(header, sample_voxels(), 24);
    return open_file(files, &f);
}

static void refuse(support_files *files, const file *f, const char *part) {
    support_bad_bytes(files, "a.mha", f->bytes, f->size, part);
}

static void refuse_header(support_files *files, const char *header,
                          const char *part) {
    file f = make_file(header, sample_voxels(), 24);
    refuse(files, &f, part);
}

static void expect_sample(snow_volume *volume) {
    for (int i = 0; i < 12; i++)
        assert_int_equal(((const int16_t *)snow_volume_voxels(volume))[i],
                         100 + i);
    snow_volume_close(volume);
}

/* A header whose voxels lie there. */
static void expect_place(support_files *files, const char *header, bool medical,
                         const double rows[12]) {
    snow_volume *volume = open_header(files, header);
    support_expect_matrix(volume, rows);
    assert_int_equal(snow_volume_get_info(volume)->medical, medical);
    expect_sample(volume);
}

static void a_plain_file_is_read_and_turned_from_lps(void **state) {
    support_files *files = *state;
    const char *header = header_with("Offset = 10 20 30\n");
    snow_volume *volume = open_header(files, header);
    const snow_volume_info *info = snow_volume_get_info(volume);
    assert_string_equal(info->format, "metaimage");
    assert_string_equal(info->unit, "mm");
    assert_int_equal(info->type, SNOW_TYPE_INT16);
    assert_int_equal(info->dims[0], 3);
    snow_volume_close(volume);
    expect_place(files, header, false,
                 (double[]){-1, 0, 0, -10, 0, -2, 0, -20, 0, 0, 3, 30});
    assert_string_equal(files->warnings, "");
}

static void directions_are_one_group_for_each_axis(void **state) {
    static const char *const synonyms[] = {"TransformMatrix", "Rotation",
                                           "Orientation"};
    for (int i = 0; i < 3; i++)
        /* x runs to posterior, y to superior, z to left */
        expect_place(*state,
                     replaced(header_with("@ = 0 1 0 0 0 1 1 0 0\n"
                                          "Position=1 2 3\n"),
                              "@", synonyms[i]),
                     true, (double[]){0, 0, -3, -1, -1, 0, 0, -2, 0, 2, 0, 3});
}

static void only_what_speaks_of_a_patient_is_medical(void **state) {
    static const struct {
        const char *lines;
        bool medical;
    } cases[] = {
        {"", false},
        {"AnatomicalOrientation = RAI\n", true},
        {"AnatomicalOrientation = ???\n", false},
        {"TransformMatrix = 1 0 0 0 1 0 0 0 1\n", true},
        {"TransformMatrix = 1 0 0 0 1 0 0 0 1\n"
         "AnatomicalOrientation = ???\n",
         false},
    };
    for (size_t i = 0; i < COUNT(cases); i++)
        expect_place(*state, header_with(cases[i].lines), cases[i].medical,
                     (double[]){-1, 0, 0, 0, 0, -2, 0, 0, 0, 0, 3, 0});
}

static void every_element_type_has_its_size(void **state) {
    support_files *files = *state;
    static const char *const types[][2] = {
        {"MET_CHAR", "int8"},       {"MET_UCHAR", "uint8"},
        {"MET_SHORT", "int16"},     {"MET_USHORT", "uint16"},
        {"MET_INT", "int32"},       {"MET_UINT", "uint32"},
        {"MET_LONG", "int32"},      {"MET_ULONG", "uint32"},
        {"MET_LONG_LONG", "int64"}, {"MET_ULONG_LONG", "uint64"},
        {"MET_FLOAT", "float32"},   {"MET_DOUBLE", "float64"}};
    unsigned char voxels[96], turned[96];
    for (size_t i = 0; i < COUNT(types); i++) {
        const snow_type type = snow_type_from_name(types[i][1]);
        size_t size = snow_type_size(type);
        for (size_t k = 0; k < 12 * size; k++) {
            voxels[k] = (unsigned char)(7 * k + i);
            turned[k - k % size + size - 1 - k % size] = voxels[k];
        }
        const char *header = header_of("MET_SHORT", types[i][0]);
        file f = make_file(header, voxels, 12 * size);
        snow_volume *little = open_file(files, &f);
        assert_int_equal(snow_volume_get_info(little)->type, type);
        f = make_file(replaced(header, "MSB = False", "MSB = True"), turned,
                      12 * size);
        snow_volume *big = open_file(files, &f);
        support_same_voxels(little, big);
        snow_volume_close(little);
        snow_volume_close(big);
    }
}

static void headers_may_be_written_in_many_ways(void **state) {
    static const char *const headers[] = {
        /* any order, synonyms, an unknown key, comments, blanks, colons */
        "# made by hand\n\nElementType: MET_SHORT\nSomething = else\n"
        "Comment = a = b\n  DimSize =  3\t2 2  \nNDims = 3\n"
        "ElementByteOrderMSB = 0\nElementSize = 1 2 3\n"
        "Origin = 0 0 0\nElementDataFile = LOCAL\n",
        /* the ends of lines of other systems */
        "ObjectType = Image\r\nNDims = 3\r\nDimSize = 3 2 2\r\n"
        "ElementSpacing = 1 2 3\r\nElementType = MET_SHORT\r\n"
        "ElementDataFile = LOCAL\r\n",
    };
    for (size_t i = 0; i < COUNT(headers); i++)
        expect_place(*state, headers[i], false,
                     (double[]){-1, 0, 0, 0, 0, -2, 0, 0, 0, 0, 3, 0});
}

#define LOCAL "ElementType = MET_SHORT\nElementDataFile = LOCAL\n"

static void one_to_four_axes_are_read(void **state) {
    support_files *files = *state;
    snow_volume *volume = open_header(files, "NDims = 1\nDimSize = 12\n" LOCAL);
    assert_int_equal(snow_volume_get_info(volume)->dims[0], 12);
    expect_sample(volume);
    expect_place(files,
                 "NDims = 2\nDimSize = 4 3\nElementSpacing = 5 6\n"
                 "TransformMatrix = 0 1 1 0\n" LOCAL,
                 true, (double[]){0, -6, 0, 0, -5, 0, 0, 0, 0, 0, 1, 0});
    file f =
        make_file("NDims = 4\nDimSize = 2 1 2 3\nElementSpacing = 1 1 1 0\n"
                  "TransformMatrix = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n" LOCAL,
                  sample_voxels(), 24);
    for (int time = 0; time < 3; time++) {
        const snow_volume_options options = {.size = sizeof options,
                                             .time = time};
        volume =
            support_opened_bytes(files, "a.mha", f.bytes, f.size, &options);
        assert_int_equal(snow_volume_get_info(volume)->times, 3);
        assert_int_equal(*(const int16_t *)snow_volume_voxels(volume),
                         100 + 4 * time);
        snow_volume_close(volume);
    }
}

static void scaling_and_units_are_understood(void **state) {
    snow_volume *volume =
        open_header(*state, header_with("ElementToIntensityFunctionSlope = 0.5"
                                        "\nElementToIntensityFunctionOffset = "
                                        "-7\nDistanceUnits = um\n"));
    assert_true(snow_volume_get_info(volume)->slope == 0.5);
    assert_true(snow_volume_get_info(volume)->intercept == -7);
    support_expect_matrix(
        volume, (double[]){-.001, 0, 0, 0, 0, -.002, 0, 0, 0, 0, .003, 0});
    snow_volume_close(volume);
    volume = open_header(*state, header_with("DistanceUnits = parsec\n"));
    assert_non_null(strstr(((support_files *)*state)->warnings, "parsec"));
    support_expect_matrix(volume,
                          (double[]){-1, 0, 0, 0, 0, -2, 0, 0, 0, 0, 3, 0});
    snow_volume_close(volume);
}

static void bytes_before_the_voxels_are_skipped(void **state) {
    unsigned char voxels[30] = "before";
    memcpy(voxels + 6, sample_voxels(), 24);
    static const char *const lines[] = {"HeaderSize = 6\n",
                                        "HeaderSize = -1\n"};
    for (int i = 0; i < 2; i++) {
        file f = make_file(header_with(lines[i]), voxels, 30);
        expect_sample(open_file(*state, &f));
        unsigned char packed[1024]; /* of a length that is not known before */
        const size_t size =
            support_deflate(31, f.bytes, f.size, packed, sizeof packed);
        expect_sample(
            support_opened_bytes(*state, "a.mha.gz", packed, size, NULL));
    }
}

static void compressed_voxels_are_verified_to_their_last_byte(void **state) {
    unsigned char packed[256];
    for (int window = 15; window <= 31; window += 16) { /* zlib and gzip */
        size_t size =
            support_deflate(window, sample_voxels(), 24, packed, sizeof packed);
        file f = make_file(packed_header(), packed, size);
        expect_sample(open_file(*state, &f));
        size_t whole = f.size;
        for (f.size = whole - size; f.size < whole; f.size++)
            refuse(*state, &f, "");
        for (size_t i = 1; i <= 4; i++) {
            f.bytes[whole - i] ^= 1;
            refuse(*state, &f, "damaged");
            f.bytes[whole - i] ^= 1;
        }
    }
}

static void a_compressed_stream_of_another_size_is_noticed(void **state) {
    support_files *files = *state;
    unsigned char packed[256];
    size_t size = support_deflate(15, sample_voxels(), 23, packed, 256);
    file f = make_file(packed_header(), packed, size);
    refuse(files, &f, "too early");
    size = support_deflate(15, sample_voxels(), 30, packed, 256);
    f = make_file(packed_header(), packed, size);
    snow_volume_close(open_file(files, &f));
    assert_non_null(strstr(files->warnings, "6 bytes after the data"));
    size = support_deflate(15, sample_voxels(), 24, packed, 256);
    f = make_file(replaced(packed_header(), "3 2 2", "4000 4000 4000"), packed,
                  size);
    refuse(files, &f, "at most");
}

#define ELEVEN "1 2 3 4 5 6 7 8 9 10 11 "

static void voxels_may_be_written_as_text(void **state) {
    const char *text = "100 101\n102\r\n\t103 +104 105 106 107 108 109 110 "
                       "111";
    const char *header = header_of("BinaryData = True", "BinaryData = False");
    file f = make_file(header, text, strlen(text));
    expect_sample(open_file(*state, &f));
    static const char *const bad[][2] = {
        {ELEVEN, "11 of 12"},          {ELEVEN "x", "\"x\""},
        {ELEVEN "1.5", "\"1.5\""},     {ELEVEN "nan", "\"nan\""},
        {ELEVEN "0x10", "\"0x10\""},   {ELEVEN "1e1", "\"1e1\""},
        {ELEVEN "2.0", "\"2.0\""},     {ELEVEN "1,2", "\"1,2\""},
        {ELEVEN "40000", "\"40000\""},
    };
    for (size_t i = 0; i < COUNT(bad); i++) {
        f = make_file(header, bad[i][0], strlen(bad[i][0]));
        refuse(*state, &f, bad[i][1]);
    }
}

static snow_volume *open_text(support_files *files, const char *type,
                              const char *numbers) {
    const char *header = replaced("NDims = 1\nDimSize = 2\nBinaryData = False\n"
                                  "ElementType = @\nElementDataFile = LOCAL\n",
                                  "@", type);
    file f = make_file(header, numbers, strlen(numbers));
    return open_file(files, &f);
}

static void numbers_in_text_keep_all_digits(void **state) {
    static const struct {
        const char *type, *text;
        uint64_t wanted;
    } whole[] = {{"MET_LONG_LONG", "-9007199254740993 2",
                  (uint64_t)-INT64_C(9007199254740993)},
                 {"MET_ULONG_LONG", "18446744073709551615 2", UINT64_MAX}};
    static const char *const real[] = {"MET_FLOAT", "MET_DOUBLE"};
    for (int i = 0; i < 2; i++) {
        snow_volume *volume = open_text(*state, whole[i].type, whole[i].text);
        assert_true(*(const uint64_t *)snow_volume_voxels(volume) ==
                    whole[i].wanted);
        snow_volume_close(volume);
        volume = open_text(*state, real[i], "-1.5e-3 nan");
        snow_volume_statistics m = {.size = sizeof m};
        snow_volume_get_statistics(volume, &m);
        assert_int_equal(m.finite, 1);
        assert_true(m.min == (i ? -1.5e-3 : (double)-1.5e-3f));
        snow_volume_close(volume);
    }
}

static void cut_files_are_refused_at_every_length(void **state) {
    file f = make_file(header_with(""), sample_voxels(), 24);
    size_t whole = f.size;
    for (f.size = 1; f.size < whole; f.size++)
        refuse(*state, &f, "");
    support_bad_bytes(*state, "a.mha", "", 0, "empty");
    const char *cut = header_of("LOCAL\n", "LOC");
    support_bad_bytes(*state, "a.mha", cut, strlen(cut), "may be truncated");
}

/* What comes in place of a part of the usual header, or of its end. */
static void headers_that_lie_are_refused(void **state) {
    static const char *const cases[][3] = {
        {"3 2 2", "3000000000 3000000000 3000000000", "DimSize"},
        {"3 2 2", "9223372036854775807 1 1", "DimSize"},
        {"3 2 2", "99999999999999999999 1 1", "DimSize"},
        {"3 2 2", "3 4 99999999999999999999", "too large"},
        {"3 2 2", "3 -2 2", "DimSize"},
        {"3 2 2", "3 0 2", "at least 1"},
        {"3 2 2", "3 2", "DimSize"},
        {"3 2 2", "3 2 2 2", "DimSize"},
        {"3 2 2", "3 2 2.5", "DimSize"},
        {"3 2 2", "3 2 x", "DimSize"},
        {"3 2 2", "", "DimSize"},
        {"3 2 2", "3000 2000 2000", "bytes left"},
        {"3 2 2", "30000 20000 20000", ""},
        {"NDims = 3", "NDims = 5", "NDims"},
        {"MET_SHORT", "MET_STRING", "ElementType"},
        {"Spacing = 1 2 3", "Spacing = 1 0 3", ""},
        {"Spacing = 1 2 3", "Spacing = 1 nan 3", ""},
        {"Spacing = 1 2 3", "Spacing = 1 inf 3", ""},
        {"Spacing = 1 2 3", "Spacing = 1 2", ""},
        {"CompressedData = False", "CompressedData = perhaps", ""},
        {"ObjectType = Image", "ObjectType = Tube", ""},
        {"NDims = 3\n", "", ""},
        {"DimSize = 3 2 2\n", "", ""},
        {"ElementType = MET_SHORT\n", "", ""},
        {"ElementDataFile = LOCAL\n", "", ""},
        {"LOCAL", "a.raw", "another file"},
        {"LOCAL", "/dev/zero", ""},
        {NULL, "ElementNumberOfChannels = 3", "bytes left"},
        {NULL, "ElementNumberOfChannels = 0", "at least 1"},
        {NULL, "ElementNumberOfChannels = 999999999999999999", "too large"},
        {"MET_SHORT", "MET_SHORT_ARRAY_", "ElementType"},
        {NULL, "ElementNumberOfChannels = x", "whole number"},
        {NULL, "ElementToIntensityFunctionSlope = nan", "slope"},
        {NULL, "ElementToIntensityFunctionOffset = x", "one number"},
        {NULL, "HeaderSize = -2", "HeaderSize"},
        {NULL, "HeaderSize = 9223372036854775807", "HeaderSize"},
        {NULL, "TransformMatrix = 1 0 0 1 0 0 0 0 1", "directions"},
        {NULL, "TransformMatrix = 1 0 0", "TransformMatrix"},
        {NULL, "Offset = 1 2", "Offset"},
        {NULL, "Offset = 1 2 inf", "not finite"},
        {NULL, "NDims = 2", "contradict"},
        {NULL, "ElementByteOrderMSB = True", "contradict"},
        {NULL, "no key here", "without \"=\""},
        {"BinaryData = True", "BinaryData = False", ""},
    };
    for (size_t i = 0; i < COUNT(cases); i++)
        refuse_header(*state,
                      cases[i][0]
                          ? header_of(cases[i][0], cases[i][1])
                          : header_with(replaced("@\n", "@", cases[i][1])),
                      cases[i][2]);
}

static const char *write_header(support_files *files, const char *header) {
    return support_write_text(files, "a.mhd", header);
}

static void voxels_may_lie_in_another_file(void **state) {
    support_files *files = *state;
    unsigned char packed[256];
    support_write(files, "a b.raw", sample_voxels(), 24);
    support_write(files, "a.zraw", packed,
                  support_deflate(15, sample_voxels(), 24, packed, 256));
    support_write(files, "a.raw.gz", packed,
                  support_gzip(sample_voxels(), 24, packed, 256));
    static const char *const names[] = {"a b.raw", "a.raw.gz", "a.zraw",
                                        "a.raw.gz"};
    for (int i = 0; i < 4; i++) {
        const char *usual = i < 2 ? header_with("") : packed_header();
        expect_sample(support_opened(
            files, write_header(files, replaced(usual, "LOCAL", names[i])),
            NULL));
    }
    support_bad_file(files,
                     write_header(files, header_of("LOCAL", "missing.raw")),
                     "missing.raw");
}

static void voxels_may_lie_in_many_files(void **state) {
    support_files *files = *state;
    const unsigned char *voxels = sample_voxels();
    support_write(files, "s3.raw", voxels, 12);
    support_write(files, "s5.raw", voxels + 12, 12);
    support_write(files, "q1.raw", voxels, 12);
    support_write(files, "q2.raw", voxels + 12, 12);
    for (int i = 0; i < 4; i++) {
        char name[16];
        snprintf(name, sizeof name, "r%03d.raw", i);
        support_write(files, name, voxels + 6 * i, 6);
    }
    static const char *const data[] = {
        "LIST\ns3.raw\ns5.raw",
        "LIST 2D\r\n\r\ns3.raw \r\n  s5.raw\r",
        "LIST 1\nr000.raw\nr001.raw\nr002.raw\nr003.raw",
        "s%d.raw 3 5 2",
        "s%01d.raw 3 6 2",
        "q%d.raw",
        "q%d.raw 1",
    };
    for (size_t i = 0; i < COUNT(data); i++)
        expect_sample(support_opened(
            files, write_header(files, header_of("LOCAL", data[i])), NULL));
    static const char *const bad[] = {
        "LIST\ns3.raw",
        "LIST\ns3.raw\nmissing.raw",
        "LIST 4\ns3.raw",
        "LIST 0\ns3.raw",
        "s%d.raw 3 5 1",
        "s%d.raw 3 3 1",
        "s%s.raw 3 5 2",
        "s%n%d.raw 3 5 2",
        "s%d%d.raw 3 5 2",
        "s%999d.raw 3 5 2",
        "s%d.raw 5 7 2",
        "s%d.raw 3 5 0",
        "s%d.raw 5 3 -2",
        "LIST\nr000.raw\nr001.raw",
        "LIST\n/dev/zero\n/dev/zero",
    };
    for (size_t i = 0; i < COUNT(bad); i++)
        support_bad_file(files, write_header(files, header_of("LOCAL", bad[i])),
                         "");
}

/* Names of Windows and of another machine, each with one note; a file that is
 * where the name says comes first, and what is in no folder is not looked for.
 */
static void headers_that_were_moved_find_their_files(void **state) {
    support_files *files = *state;
    char folder[600];
    snprintf(folder, sizeof folder, "%s/d", files->folder);
    assert_int_equal(mkdir(folder, 0700), 0);
    support_write(files, "d/a.raw", sample_voxels(), 24);
    support_write(files, "b.raw", sample_voxels(), 24);
    support_write(files, "c1.raw", sample_voxels(), 12);
    support_write(files, "c2.raw", sample_voxels() + 12, 12);
    support_write(files, "c\\a.raw", sample_voxels(), 24);
    support_write(files, "a.raw", "no voxels", 9);
    static const char *const moved[] = {
        "d\\a.raw",       ".\\b.raw", "C:\\x\\b.raw",
        "/nowhere/b.raw", "x/b.raw",  "LIST\nC:/x/c1.raw\nC:/x/c2.raw",
        "x\\c%d.raw 1 2", "c\\a.raw"};
    for (size_t i = 0; i < COUNT(moved); i++) {
        *files->warnings = 0;
        expect_sample(support_opened(
            files, write_header(files, header_of("LOCAL", moved[i])), NULL));
        assert_int_equal(support_warned(files), i + 1 < COUNT(moved));
        assert_true(!*files->warnings || strstr(files->warnings, "is taken"));
    }
    static const char *const gone[] = {"B.RAW", "\"b.raw\"",    "x/c.raw",
                                       "x/d",   "file://b.raw", "x/"};
    for (size_t i = 0; i < COUNT(gone); i++)
        support_bad_file(
            files, write_header(files, header_of("LOCAL", gone[i])), gone[i]);
}

static void a_series_that_lies_costs_no_memory(void **state) {
    static const unsigned char slice[200000];
    support_write(*state, "s1.raw", slice, sizeof slice);
    static const char *const data[] = {"LIST\ns1.raw", "s%d.raw 1 1000 1"};
    for (int i = 0; i < 2; i++)
        support_bad_file(
            *state,
            write_header(*state, replaced("NDims = 3\nDimSize = 1000 100 1000\n"
                                          "ElementType = MET_SHORT\n"
                                          "ElementDataFile = @\n",
                                          "@", data[i])),
            "");
}

static void a_time_step_is_found_among_files(void **state) {
    support_files *files = *state;
    const unsigned char *voxels = sample_voxels();
    support_write(files, "t1.raw", voxels, 8);
    support_write(files, "t2.raw", voxels + 8, 8);
    support_write(files, "t3.raw", voxels + 16, 8);
    static const char *const data[] = {"t%d.raw 1 3 1",
                                       "LIST\nt1.raw\nt2.raw\nt3.raw"};
    for (int i = 0; i < 6; i++) {
        const snow_volume_options options = {.size = sizeof options,
                                             .time = i % 3};
        snow_volume *volume = support_opened(
            files,
            write_header(files,
                         replaced("NDims = 4\nDimSize = 2 1 2 3\nElementType = "
                                  "MET_SHORT\nElementDataFile = @\n",
                                  "@", data[i / 3])),
            &options);
        assert_int_equal(*(const int16_t *)snow_volume_voxels(volume),
                         100 + 4 * (i % 3));
        snow_volume_close(volume);
    }
}

/* Two values of each of six voxels, of which the rows of a box are wanted. */
static void voxels_may_have_several_values(void **state) {
    support_files *files = *state;
    unsigned char packed[256];
    const char *text = "100 101 102 103 104 105 106 107 108 109 110 111";
    const char *kept = header_of("DimSize = 3 2 2\nElementType = MET_SHORT",
                                 "DimSize = 3 1 2\nElementNumberOfChannels = 2"
                                 "\nElementType = MET_SHORT_ARRAY");
    char usual[1000], zipped[1000], written[1000];
    snprintf(usual, sizeof usual, "%s", kept);
    snprintf(
        zipped, sizeof zipped, "%s",
        replaced(usual, "CompressedData = False", "CompressedData = True"));
    snprintf(written, sizeof written, "%s",
             replaced(usual, "BinaryData = True", "BinaryData = False"));
    support_write(files, "c1.raw", sample_voxels(), 12);
    support_write(files, "c2.raw", sample_voxels() + 12, 12);
    support_write(files, "c.zraw", packed,
                  support_deflate(15, sample_voxels(), 24, packed, 256));
    support_write_text(files, "c.txt", text);
    const char *const data[][2] = {{usual, "c%d.raw"},
                                   {usual, "LIST\nc1.raw\nc2.raw"},
                                   {zipped, "c.zraw"},
                                   {written, "c.txt"}};
    for (size_t i = 0; i < 2 * COUNT(data); i++) {
        const snow_volume_options options = {.size = sizeof options,
                                             .component = i % 2 ? "1" : "0",
                                             .crop = {{1, 3}}};
        snow_volume *volume =
            support_opened(files,
                           write_header(files, replaced(data[i / 2][0], "LOCAL",
                                                        data[i / 2][1])),
                           &options);
        const int16_t *voxels = snow_volume_voxels(volume);
        static const int wanted[] = {102, 104, 108, 110};
        for (int n = 0; n < 4; n++)
            assert_int_equal(voxels[n], wanted[n] + (int)(i % 2));
        assert_int_equal(snow_volume_get_info(volume)->components, 2);
        snow_volume_close(volume);
    }
}

/* As ITK reads it: the axis is reversed. */
static void a_spacing_below_0_turns_its_axis(void **state) {
    expect_place(*state, header_of("Spacing = 1 2 3", "Spacing = 1 2 -3"),
                 false, (double[]){-1, 0, 0, 0, 0, -2, 0, 0, 0, 0, -3, 0});
}

static void long_lines_are_read_and_endless_ones_refused(void **state) {
    size_t size = 100000;
    char *text = malloc(size);
    assert_non_null(text);
    memset(text, 'x', size);
    memcpy(text, "Comment = ", 10);
    support_bad_bytes(*state, "a.mha", text, size, "line");
    file f = make_file(header_with(""), sample_voxels(), 24);
    text[60000] = '\n';
    memcpy(text + 60001, f.bytes, f.size);
    expect_sample(
        support_opened_bytes(*state, "a.mha", text, 60001 + f.size, NULL));
    free(text);
}

#define META "formats/metaimage/"

static void real_files_have_their_known_figures(void **state) {
    static const struct {
        const char *name;
        int64_t dims[3];
        const char *type;
        double min, max, spacing;
        int64_t not_finite;
        bool medical;
    } real[] = {
        {META "HeadMRVolume.mhd", {48, 62, 42}, "uint8", 0, 255, 4, 0, false},
        {META "LIDC2.mha", {256, 256, 133}, "uint8", 0, 255, 1.406249, 0, true},
        {META "nan.mha.gz",
         {78, 110, 64},
         "float32",
         -5.34101,
         3.1943e38,
         1,
         1592,
         true},
    };
    if (!support_data(META "LIDC2.mha"))
        skip();
    for (size_t i = 0; i < COUNT(real); i++) {
        snow_volume *volume =
            support_opened(*state, support_data(real[i].name), NULL);
        const snow_volume_info *info = snow_volume_get_info(volume);
        assert_memory_equal(info->dims, real[i].dims, sizeof info->dims);
        assert_string_equal(snow_type_name(info->type), real[i].type);
        assert_int_equal(info->medical, real[i].medical);
        assert_true(fabs(info->spacing[0] - real[i].spacing) < 1e-5);
        snow_volume_statistics m = {.size = sizeof m};
        snow_volume_get_statistics(volume, &m);
        assert_true(fabs(m.min - real[i].min) <= 1e-5 * fabs(m.min));
        assert_true(fabs(m.max - real[i].max) <= 1e-5 * fabs(m.max));
        assert_int_equal(m.voxels - m.finite, real[i].not_finite);
        snow_volume_close(volume);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        SUPPORT_TEST(a_plain_file_is_read_and_turned_from_lps),
        SUPPORT_TEST(directions_are_one_group_for_each_axis),
        SUPPORT_TEST(only_what_speaks_of_a_patient_is_medical),
        SUPPORT_TEST(every_element_type_has_its_size),
        SUPPORT_TEST(headers_may_be_written_in_many_ways),
        SUPPORT_TEST(one_to_four_axes_are_read),
        SUPPORT_TEST(scaling_and_units_are_understood),
        SUPPORT_TEST(bytes_before_the_voxels_are_skipped),
        SUPPORT_TEST(compressed_voxels_are_verified_to_their_last_byte),
        SUPPORT_TEST(a_compressed_stream_of_another_size_is_noticed),
        SUPPORT_TEST(voxels_may_be_written_as_text),
        SUPPORT_TEST(numbers_in_text_keep_all_digits),
        SUPPORT_TEST(cut_files_are_refused_at_every_length),
        SUPPORT_TEST(headers_that_lie_are_refused),
        SUPPORT_TEST(voxels_may_lie_in_another_file),
        SUPPORT_TEST(voxels_may_lie_in_many_files),
        SUPPORT_TEST(headers_that_were_moved_find_their_files),
        SUPPORT_TEST(a_series_that_lies_costs_no_memory),
        SUPPORT_TEST(a_time_step_is_found_among_files),
        SUPPORT_TEST(voxels_may_have_several_values),
        SUPPORT_TEST(a_spacing_below_0_turns_its_axis),
        SUPPORT_TEST(long_lines_are_read_and_endless_ones_refused),
        SUPPORT_TEST(real_files_have_their_known_figures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
