/* tests/formats/test_metaimage.c - MetaImage files are read right or refused.
 */
#include "support/volumes.h"

#include <math.h>
#include <zlib.h>

/* What a refused file may cost: the header's text, layers' buffers, zlib. */
#define LITTLE 250000

/* A header with its voxels: 3 x 2 x 2 of int16, 100, 101, ..., or packed. */
typedef struct file {
    unsigned char bytes[8192];
    size_t size;
} file;

static const unsigned char *sample_voxels(void) {
    static unsigned char voxels[24];
    for (int i = 0; i < 12; i++) {
        voxels[2 * i] = (unsigned char)(100 + i);
        voxels[2 * i + 1] = 0;
    }
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

/* The usual header with more lines put in and one word replaced. */
static const char *header_with(const char *lines, const char *old,
                               const char *new) {
    static char text[4096], changed[4096];
    snprintf(text, sizeof text,
             "ObjectType = Image\nNDims = 3\nBinaryData = True\n"
             "BinaryDataByteOrderMSB = False\nCompressedData = False\n%s"
             "ElementSpacing = 1 2 3\nDimSize = 3 2 2\n"
             "ElementType = MET_SHORT\nElementDataFile = LOCAL\n",
             lines);
    const char *at = old ? strstr(text, old) : NULL;
    if (!at)
        return text;
    snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - text), text, new,
             at + strlen(old));
    return changed;
}

static snow_volume *open_file(support_place *place, const file *f) {
    snow_volume *volume = NULL;
    if (snow_volume_open_memory(place->context, "a.mha", f->bytes, f->size,
                                NULL, &volume) != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(place->context));
    return volume;
}

static snow_volume *open_header(support_place *place, const char *header) {
    file f = make_file(header, sample_voxels(), 24);
    return open_file(place, &f);
}

static void refuse_header(support_place *place, const char *header,
                          const char *part) {
    file f = make_file(header, sample_voxels(), 24);
    support_place_refuse(place, "a.mha", f.bytes, f.size, part, LITTLE);
}

static void assert_first(const snow_volume *volume, int value) {
    assert_int_equal(*(const int16_t *)snow_volume_voxels(volume), value);
}

static void assert_sample(const snow_volume *volume) {
    for (int i = 0; i < 12; i++)
        assert_int_equal(((const int16_t *)snow_volume_voxels(volume))[i],
                         100 + i);
}

static void assert_matrix(const snow_volume *volume, const double rows[12]) {
    double wanted[4][4] = {{0}};
    memcpy(wanted, rows, 12 * sizeof *rows);
    wanted[3][3] = 1;
    support_same_matrix(snow_volume_get_info(volume)->matrix,
                        (const double(*)[4])wanted, 1e-12);
}

static void a_plain_file_is_read_and_turned_from_lps(void **state) {
    support_place *place = *state;
    snow_volume *volume =
        open_header(place, header_with("Offset = 10 20 30\n", NULL, NULL));
    const snow_volume_info *info = snow_volume_get_info(volume);
    assert_string_equal(info->format, "metaimage");
    assert_string_equal(info->unit, "mm");
    assert_int_equal(info->type, SNOW_TYPE_INT16);
    assert_int_equal(info->dims[0], 3);
    assert_false(info->medical);
    assert_sample(volume);
    assert_matrix(volume,
                  (double[]){-1, 0, 0, -10, 0, -2, 0, -20, 0, 0, 3, 30});
    assert_string_equal(place->warnings, "");
    snow_volume_close(volume);
}

static void directions_are_one_group_for_each_axis(void **state) {
    support_place *place = *state;
    static const char *const synonyms[] = {"TransformMatrix", "Rotation",
                                           "Orientation"};
    for (int i = 0; i < 3; i++) {
        char lines[128];
        /* x runs to posterior, y to superior, z to left */
        snprintf(lines, sizeof lines,
                 "%s = 0 1 0 0 0 1 1 0 0\nPosition=1 2 3\n", synonyms[i]);
        snow_volume *volume =
            open_header(place, header_with(lines, NULL, NULL));
        assert_true(snow_volume_get_info(volume)->medical);
        assert_matrix(volume,
                      (double[]){0, 0, -3, -1, -1, 0, 0, -2, 0, 2, 0, 3});
        snow_volume_close(volume);
    }
}

static void only_what_speaks_of_a_patient_is_medical(void **state) {
    support_place *place = *state;
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
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        snow_volume *volume =
            open_header(place, header_with(cases[i].lines, NULL, NULL));
        assert_int_equal(snow_volume_get_info(volume)->medical,
                         cases[i].medical);
        snow_volume_close(volume);
    }
}

static void every_element_type_has_its_size(void **state) {
    support_place *place = *state;
    static const struct {
        const char *name;
        snow_type type;
    } types[] = {{"MET_CHAR", SNOW_TYPE_INT8},
                 {"MET_UCHAR", SNOW_TYPE_UINT8},
                 {"MET_SHORT", SNOW_TYPE_INT16},
                 {"MET_USHORT", SNOW_TYPE_UINT16},
                 {"MET_INT", SNOW_TYPE_INT32},
                 {"MET_UINT", SNOW_TYPE_UINT32},
                 {"MET_LONG", SNOW_TYPE_INT32},
                 {"MET_ULONG", SNOW_TYPE_UINT32},
                 {"MET_LONG_LONG", SNOW_TYPE_INT64},
                 {"MET_ULONG_LONG", SNOW_TYPE_UINT64},
                 {"MET_FLOAT", SNOW_TYPE_FLOAT32},
                 {"MET_DOUBLE", SNOW_TYPE_FLOAT64}};
    unsigned char voxels[96], turned[96];
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        size_t size = snow_type_size(types[i].type);
        for (size_t k = 0; k < 12 * size; k++) {
            voxels[k] = (unsigned char)(7 * k + i);
            turned[k - k % size + size - 1 - k % size] = voxels[k];
        }
        const char *header = header_with("", "MET_SHORT", types[i].name);
        file f = make_file(header, voxels, 12 * size);
        snow_volume *little = open_file(place, &f);
        assert_int_equal(snow_volume_get_info(little)->type, types[i].type);
        char big_header[4096];
        const char *order = strstr(header, "MSB = False");
        snprintf(big_header, sizeof big_header, "%.*sMSB = True%s",
                 (int)(order - header), header, order + strlen("MSB = False"));
        f = make_file(big_header, turned, 12 * size);
        snow_volume *big = open_file(place, &f);
        support_same_voxels(little, big);
        snow_volume_close(little);
        snow_volume_close(big);
    }
    refuse_header(place, header_with("", "MET_SHORT", "MET_STRING"),
                  "ElementType");
    refuse_header(place,
                  header_with("ElementNumberOfChannels = 3\n", NULL, NULL),
                  "channels");
}

static void headers_may_be_written_in_many_ways(void **state) {
    support_place *place = *state;
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
    for (size_t i = 0; i < 2; i++) {
        snow_volume *volume = open_header(place, headers[i]);
        assert_sample(volume);
        assert_matrix(volume, (double[]){-1, 0, 0, 0, 0, -2, 0, 0, 0, 0, 3, 0});
        snow_volume_close(volume);
    }
}

static void one_to_four_axes_are_read(void **state) {
    support_place *place = *state;
    snow_volume *volume =
        open_header(place, "NDims = 1\nDimSize = 12\nElementType = MET_SHORT\n"
                           "ElementDataFile = LOCAL\n");
    assert_int_equal(snow_volume_get_info(volume)->dims[0], 12);
    snow_volume_close(volume);
    volume = open_header(place, "NDims = 2\nDimSize = 4 3\nElementSpacing = 5 "
                                "6\nTransformMatrix = 0 1 1 0\nElementType = "
                                "MET_SHORT\nElementDataFile = LOCAL\n");
    assert_matrix(volume, (double[]){0, -6, 0, 0, -5, 0, 0, 0, 0, 0, 1, 0});
    snow_volume_close(volume);
    const char *header =
        "NDims = 4\nDimSize = 2 1 2 3\nElementSpacing = 1 1 1 0\n"
        "TransformMatrix = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n"
        "ElementType = MET_SHORT\nElementDataFile = LOCAL\n";
    file f = make_file(header, sample_voxels(), 24);
    for (int time = 0; time < 3; time++) {
        const snow_volume_options options = {.size = sizeof options,
                                             .time = time};
        assert_int_equal(snow_volume_open_memory(place->context, "a.mha",
                                                 f.bytes, f.size, &options,
                                                 &volume),
                         SNOW_STATUS_OK);
        assert_int_equal(snow_volume_get_info(volume)->times, 3);
        assert_first(volume, 100 + 4 * time);
        snow_volume_close(volume);
    }
    refuse_header(place, header_with("", "NDims = 3", "NDims = 5"), "NDims");
}

static void scaling_and_units_are_understood(void **state) {
    support_place *place = *state;
    snow_volume *volume =
        open_header(place, header_with("ElementToIntensityFunctionSlope = 0.5\n"
                                       "ElementToIntensityFunctionOffset = -7\n"
                                       "DistanceUnits = um\n",
                                       NULL, NULL));
    assert_true(snow_volume_get_info(volume)->slope == 0.5);
    assert_true(snow_volume_get_info(volume)->intercept == -7);
    assert_matrix(volume,
                  (double[]){-.001, 0, 0, 0, 0, -.002, 0, 0, 0, 0, .003, 0});
    snow_volume_close(volume);
    refuse_header(
        place,
        header_with("ElementToIntensityFunctionSlope = nan\n", NULL, NULL),
        "slope");
}

static void bytes_before_the_voxels_are_skipped(void **state) {
    support_place *place = *state;
    unsigned char voxels[30] = "before";
    memcpy(voxels + 6, sample_voxels(), 24);
    static const char *const lines[] = {"HeaderSize = 6\n",
                                        "HeaderSize = -1\n"};
    for (int i = 0; i < 2; i++) {
        file f = make_file(header_with(lines[i], NULL, NULL), voxels, 30);
        snow_volume *volume = open_file(place, &f);
        assert_sample(volume);
        snow_volume_close(volume);
    }
    refuse_header(place, header_with("HeaderSize = -2\n", NULL, NULL),
                  "HeaderSize");
    refuse_header(place,
                  header_with("HeaderSize = 9223372036854775807\n", NULL, NULL),
                  "HeaderSize");
}

/* The sample packed by zlib (15) or gzip (31). */
static size_t pack_sample(int window, unsigned char packed[256], size_t size) {
    z_stream stream = {0};
    unsigned char voxels[48] = {0};
    memcpy(voxels, sample_voxels(), 24);
    assert_int_equal(deflateInit2(&stream, 9, Z_DEFLATED, window, 8, 0), Z_OK);
    stream.next_in = voxels;
    stream.avail_in = (uInt)size;
    stream.next_out = packed;
    stream.avail_out = 256;
    assert_int_equal(deflate(&stream, Z_FINISH), Z_STREAM_END);
    size_t made = stream.total_out;
    deflateEnd(&stream);
    return made;
}

static const char *packed_header(void) {
    return header_with("CompressedDataSize = 28\n", "CompressedData = False",
                       "CompressedData = True");
}

static void compressed_voxels_are_verified_to_their_last_byte(void **state) {
    support_place *place = *state;
    unsigned char packed[256];
    for (int window = 15; window <= 31; window += 16) {
        size_t size = pack_sample(window, packed, 24);
        file f = make_file(packed_header(), packed, size);
        snow_volume *volume = open_file(place, &f);
        assert_sample(volume);
        snow_volume_close(volume);
        size_t whole = f.size;
        for (f.size = whole - size; f.size < whole; f.size++)
            support_place_refuse(place, "a.mha", f.bytes, f.size, "", LITTLE);
        for (size_t i = 1; i <= 4; i++) {
            f.bytes[whole - i] ^= 1;
            support_place_refuse(place, "a.mha", f.bytes, whole, "damaged",
                                 LITTLE);
            f.bytes[whole - i] ^= 1;
        }
    }
}

static void a_compressed_stream_of_another_size_is_noticed(void **state) {
    support_place *place = *state;
    unsigned char packed[256];
    size_t size = pack_sample(15, packed, 23);
    file f = make_file(packed_header(), packed, size);
    support_place_refuse(place, "a.mha", f.bytes, f.size, "too early", LITTLE);
    size = pack_sample(15, packed, 30);
    f = make_file(packed_header(), packed, size);
    snow_volume_close(open_file(place, &f));
    assert_non_null(strstr(place->warnings, "6 bytes after the data"));
}

static void voxels_may_be_written_as_text(void **state) {
    support_place *place = *state;
    const char *text = "100 101\n102\r\n\t103 +104 105 106 107 108 109 110 "
                       "111";
    const char *header =
        header_with("", "BinaryData = True", "BinaryData = False");
    file f = make_file(header, text, strlen(text));
    snow_volume *volume = open_file(place, &f);
    assert_sample(volume);
    snow_volume_close(volume);
    static const char *const bad[][2] = {
        {"1 2 3 4 5 6 7 8 9 10 11", "11 of 12"},
        {"1 2 3 4 5 6 7 8 9 10 11 x", "\"x\""},
        {"1 2 3 4 5 6 7 8 9 10 11 40000", "\"40000\""},
        {"1 2 3 4 5 6 7 8 9 10 11 1.5", "\"1.5\""},
        {"1 2 3 4 5 6 7 8 9 10 11 nan", "\"nan\""},
        {"1 2 3 4 5 6 7 8 9 10 11 0x10", "\"0x10\""},
        {"1 2 3 4 5 6 7 8 9 10 11 1e1", "\"1e1\""},
        {"1 2 3 4 5 6 7 8 9 10 11 2.0", "\"2.0\""},
        {"1,2,3,4,5,6,7,8,9,10,11,12", "\"1,2,"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        f = make_file(header, bad[i][0], strlen(bad[i][0]));
        support_place_refuse(place, "a.mha", f.bytes, f.size, bad[i][1],
                             LITTLE);
    }
}

static void wide_whole_numbers_in_text_keep_all_digits(void **state) {
    support_place *place = *state;
    static const char *const types[] = {"MET_LONG_LONG", "MET_ULONG_LONG"};
    static const char *const texts[] = {"-9007199254740993 2",
                                        "18446744073709551615 2"};
    static const uint64_t wanted[] = {(uint64_t)-INT64_C(9007199254740993),
                                      UINT64_MAX};
    for (int i = 0; i < 2; i++) {
        char header[256];
        snprintf(header, sizeof header,
                 "NDims = 1\nDimSize = 2\nBinaryData = False\n"
                 "ElementType = %s\nElementDataFile = LOCAL\n",
                 types[i]);
        file f = make_file(header, texts[i], strlen(texts[i]));
        snow_volume *volume = open_file(place, &f);
        assert_true(*(const uint64_t *)snow_volume_voxels(volume) == wanted[i]);
        snow_volume_close(volume);
    }
}

static void real_numbers_in_text_are_read(void **state) {
    support_place *place = *state;
    static const char *const types[] = {"MET_FLOAT", "MET_DOUBLE"};
    for (int i = 0; i < 2; i++) {
        char header[256];
        const char *text = "-1.5e-3 nan";
        snprintf(header, sizeof header,
                 "NDims = 1\nDimSize = 2\nBinaryData = False\n"
                 "ElementType = %s\nElementDataFile = LOCAL\n",
                 types[i]);
        file f = make_file(header, text, strlen(text));
        snow_volume *volume = open_file(place, &f);
        snow_volume_statistics m = {.size = sizeof m};
        snow_volume_get_statistics(volume, &m);
        assert_int_equal(m.finite, 1);
        assert_true(m.min == (i ? -1.5e-3 : (double)-1.5e-3f));
        snow_volume_close(volume);
    }
}

static void cut_files_are_refused_at_every_length(void **state) {
    support_place *place = *state;
    file f = make_file(header_with("", NULL, NULL), sample_voxels(), 24);
    size_t whole = f.size;
    for (f.size = 1; f.size < whole; f.size++)
        support_place_refuse(place, "a.mha", f.bytes, f.size, "", LITTLE);
    support_place_refuse(place, "a.mha", "", 0, "empty", LITTLE);
    const char *cut = header_with("", "LOCAL\n", "LOC");
    support_place_refuse(place, "a.mha", cut, strlen(cut), "may be truncated",
                         LITTLE);
}

static void sizes_that_lie_are_refused_before_memory_is_taken(void **state) {
    support_place *place = *state;
    static const char *const sizes[] = {
        "3000000000 3000000000 3000000000",
        "9223372036854775807 1 1",
        "99999999999999999999 1 1",
        "3 -2 2",
        "3 0 2",
        "3 2",
        "3 2 2 2",
        "3 2 2.5",
        "3 2 x",
        "",
    };
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        refuse_header(place, header_with("", "3 2 2", sizes[i]), "DimSize");
    refuse_header(place, header_with("", "3 2 2", "3 4 99999999999999999999"),
                  "too large");
    refuse_header(place, header_with("", "3 2 2", "3 0 2"), "at least 1");
    refuse_header(place, header_with("", "3 2 2", "3000 2000 2000"),
                  "bytes left");
    refuse_header(place, header_with("", "3 2 2", "30000 20000 20000"), "");
    unsigned char packed[256];
    size_t size = pack_sample(15, packed, 24);
    char header[4096];
    const char *usual = packed_header(), *at = strstr(usual, "3 2 2");
    snprintf(header, sizeof header, "%.*s4000 4000 4000%s", (int)(at - usual),
             usual, at + 5);
    file f = make_file(header, packed, size);
    support_place_refuse(place, "a.mha", f.bytes, f.size, "at most", LITTLE);
}

static void contradictions_and_omissions_are_refused(void **state) {
    support_place *place = *state;
    static const char *const cases[][3] = {
        {"", "ElementSpacing = 1 2 3", "ElementSpacing = 1 0 3"},
        {"", "ElementSpacing = 1 2 3", "ElementSpacing = 1 nan 3"},
        {"", "ElementSpacing = 1 2 3", "ElementSpacing = 1 inf 3"},
        {"", "ElementSpacing = 1 2 3", "ElementSpacing = 1 -2 3"},
        {"", "ElementSpacing = 1 2 3", "ElementSpacing = 1 2"},
        {"TransformMatrix = 1 0 0 1 0 0 0 0 1\n", NULL, "directions"},
        {"TransformMatrix = 1 0 0\n", NULL, "TransformMatrix"},
        {"Offset = 1 2\n", NULL, "Offset"},
        {"Offset = 1 2 inf\n", NULL, "not finite"},
        {"NDims = 2\n", NULL, "contradict"},
        {"ElementByteOrderMSB = True\n", NULL, "contradict"},
        {"no key here\n", NULL, "without \"=\""},
        {"", "CompressedData = False", "CompressedData = perhaps"},
        {"DistanceUnits = parsec\n", NULL, "DistanceUnits"},
        {"ElementToIntensityFunctionOffset = x\n", NULL, "one number"},
        {"ElementNumberOfChannels = x\n", NULL, "whole number"},
        {"BinaryData = False\n", "BinaryData = True\nBinary", "Binary"},
        {"", "ObjectType = Image", "ObjectType = Tube"},
        {"", "NDims = 3\n", ""},
        {"", "DimSize = 3 2 2\n", ""},
        {"", "ElementType = MET_SHORT\n", ""},
        {"", "ElementDataFile = LOCAL\n", ""},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *old = cases[i][1], *part = cases[i][2];
        const char *header = header_with(cases[i][0], old, old ? part : NULL);
        refuse_header(place, header, old ? "" : part);
    }
}

static void put_text(support_place *place, const char *name,
                     const char *header) {
    support_place_put(place, name, header, strlen(header));
}

static void voxels_may_lie_in_another_file(void **state) {
    support_place *place = *state;
    unsigned char packed[256];
    support_place_put(place, "a b.raw", sample_voxels(), 24);
    size_t size = pack_sample(15, packed, 24);
    support_place_put(place, "a.zraw", packed, size);
    size = pack_sample(31, packed, 24);
    support_place_put(place, "a.raw.gz", packed, size);
    static const char *const names[] = {"a b.raw", "a.raw.gz", "a.zraw",
                                        "a.raw.gz"};
    for (int i = 0; i < 4; i++) {
        char header[4096];
        const char *usual =
            i < 2 ? header_with("", NULL, NULL) : packed_header();
        snprintf(header, sizeof header, "%.*s%s\n",
                 (int)(strstr(usual, "LOCAL") - usual), usual, names[i]);
        put_text(place, "a.mhd", header);
        snow_volume *volume =
            support_place_open(place, support_place_path(place, "a.mhd"));
        assert_sample(volume);
        snow_volume_close(volume);
    }
    put_text(place, "a.mhd", header_with("", "LOCAL", "missing.raw"));
    snow_volume *volume = NULL;
    assert_int_equal(snow_volume_open(place->context,
                                      support_place_path(place, "a.mhd"), NULL,
                                      &volume),
                     SNOW_STATUS_BAD_INPUT);
    assert_non_null(
        strstr(snow_context_message(place->context), "missing.raw"));
    refuse_header(place, header_with("", "LOCAL", "a.raw"), "another file");
    refuse_header(place, header_with("", "LOCAL", "/dev/zero"), "");
}

static void voxels_may_lie_in_many_files(void **state) {
    support_place *place = *state;
    const unsigned char *voxels = sample_voxels();
    support_place_put(place, "s3.raw", voxels, 12);
    support_place_put(place, "s5.raw", voxels + 12, 12);
    support_place_put(place, "q1.raw", voxels, 12);
    support_place_put(place, "q2.raw", voxels + 12, 12);
    for (int i = 0; i < 4; i++) {
        char name[16];
        snprintf(name, sizeof name, "r%03d.raw", i);
        support_place_put(place, name, voxels + 6 * i, 6);
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
    for (size_t i = 0; i < sizeof data / sizeof *data; i++) {
        put_text(place, "a.mhd", header_with("", "LOCAL", data[i]));
        snow_volume *volume =
            support_place_open(place, support_place_path(place, "a.mhd"));
        assert_sample(volume);
        snow_volume_close(volume);
    }
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
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        put_text(place, "a.mhd", header_with("", "LOCAL", bad[i]));
        snow_volume *volume = NULL;
        if (snow_volume_open(place->context, support_place_path(place, "a.mhd"),
                             NULL, &volume) != SNOW_STATUS_BAD_INPUT)
            fail_msg("%s was not refused", bad[i]);
        assert_null(volume);
    }
}

static void a_series_that_lies_costs_no_memory(void **state) {
    support_place *place = *state;
    static const unsigned char slice[200000];
    support_place_put(place, "s1.raw", slice, sizeof slice);
    static const char *const data[] = {"LIST\ns1.raw", "s%d.raw 1 1000 1"};
    for (int i = 0; i < 2; i++) {
        char header[256];
        snprintf(header, sizeof header,
                 "NDims = 3\nDimSize = 1000 100 1000\n"
                 "ElementType = MET_SHORT\nElementDataFile = %s\n",
                 data[i]);
        put_text(place, "a.mhd", header);
        snow_volume *volume = NULL;
        place->largest = 0;
        assert_int_equal(snow_volume_open(place->context,
                                          support_place_path(place, "a.mhd"),
                                          NULL, &volume),
                         SNOW_STATUS_BAD_INPUT);
        assert_true(place->largest < LITTLE);
    }
}

static void a_time_step_is_found_among_files(void **state) {
    support_place *place = *state;
    const unsigned char *voxels = sample_voxels();
    support_place_put(place, "t1.raw", voxels, 8);
    support_place_put(place, "t2.raw", voxels + 8, 8);
    support_place_put(place, "t3.raw", voxels + 16, 8);
    static const char *const data[] = {"t%d.raw 1 3 1",
                                       "LIST\nt1.raw\nt2.raw\nt3.raw"};
    for (int i = 0; i < 6; i++) {
        char header[512];
        snprintf(header, sizeof header,
                 "NDims = 4\nDimSize = 2 1 2 3\nElementType = MET_SHORT\n"
                 "ElementDataFile = %s\n",
                 data[i / 3]);
        put_text(place, "a.mhd", header);
        const snow_volume_options options = {.size = sizeof options,
                                             .time = i % 3};
        snow_volume *volume = NULL;
        if (snow_volume_open(place->context, support_place_path(place, "a.mhd"),
                             &options, &volume) != SNOW_STATUS_OK)
            fail_msg("%s", snow_context_message(place->context));
        assert_first(volume, 100 + 4 * (i % 3));
        snow_volume_close(volume);
    }
}

static void long_lines_are_read_and_endless_ones_refused(void **state) {
    support_place *place = *state;
    size_t size = 100000;
    char *text = malloc(size + 1000);
    assert_non_null(text);
    memset(text, 'x', size);
    memcpy(text, "Comment = ", 10);
    support_place_refuse(place, "a.mha", text, size, "line", LITTLE);
    const char *rest = header_with("", NULL, NULL);
    memcpy(text + 60000, "\n", 1);
    memcpy(text + 60001, rest, strlen(rest));
    memcpy(text + 60001 + strlen(rest), sample_voxels(), 24);
    snow_volume *volume = NULL;
    assert_int_equal(snow_volume_open_memory(place->context, "a.mha", text,
                                             60001 + strlen(rest) + 24, NULL,
                                             &volume),
                     SNOW_STATUS_OK);
    assert_sample(volume);
    snow_volume_close(volume);
    free(text);
}

static void real_files_have_their_known_figures(void **state) {
    support_place *place = *state;
    static const struct {
        const char *name;
        int64_t dims[3];
        snow_type type;
        double min, max, spacing;
        int64_t not_finite;
        bool medical;
    } files[] = {
        {"HeadMRVolume.mhd",
         {48, 62, 42},
         SNOW_TYPE_UINT8,
         0,
         255,
         4,
         0,
         false},
        {"LIDC2.mha",
         {256, 256, 133},
         SNOW_TYPE_UINT8,
         0,
         255,
         1.406249,
         0,
         true},
        {"nan.mha.gz",
         {78, 110, 64},
         SNOW_TYPE_FLOAT32,
         -5.34101,
         3.1943e38,
         1,
         1592,
         true},
    };
    if (!support_data("formats/metaimage/LIDC2.mha"))
        skip();
    for (size_t i = 0; i < 3; i++) {
        char path[128];
        snprintf(path, sizeof path, "formats/metaimage/%s", files[i].name);
        snow_volume *volume = support_place_open(place, support_data(path));
        const snow_volume_info *info = snow_volume_get_info(volume);
        assert_memory_equal(info->dims, files[i].dims, sizeof info->dims);
        assert_int_equal(info->type, files[i].type);
        assert_int_equal(info->medical, files[i].medical);
        assert_true(fabs(info->spacing[0] - files[i].spacing) < 1e-5);
        snow_volume_statistics m = {.size = sizeof m};
        snow_volume_get_statistics(volume, &m);
        assert_true(fabs(m.min - files[i].min) <= 1e-5 * fabs(m.min));
        assert_true(fabs(m.max - files[i].max) <= 1e-5 * fabs(m.max));
        assert_int_equal(m.voxels - m.finite, files[i].not_finite);
        snow_volume_close(volume);
    }
}

#define UNIT(test)                                             \
    cmocka_unit_test_setup_teardown(test, support_place_begin, \
                                    support_place_end)

int main(void) {
    const struct CMUnitTest tests[] = {
        UNIT(a_plain_file_is_read_and_turned_from_lps),
        UNIT(directions_are_one_group_for_each_axis),
        UNIT(only_what_speaks_of_a_patient_is_medical),
        UNIT(every_element_type_has_its_size),
        UNIT(headers_may_be_written_in_many_ways),
        UNIT(one_to_four_axes_are_read),
        UNIT(scaling_and_units_are_understood),
        UNIT(bytes_before_the_voxels_are_skipped),
        UNIT(compressed_voxels_are_verified_to_their_last_byte),
        UNIT(a_compressed_stream_of_another_size_is_noticed),
        UNIT(voxels_may_be_written_as_text),
        UNIT(wide_whole_numbers_in_text_keep_all_digits),
        UNIT(real_numbers_in_text_are_read),
        UNIT(cut_files_are_refused_at_every_length),
        UNIT(sizes_that_lie_are_refused_before_memory_is_taken),
        UNIT(contradictions_and_omissions_are_refused),
        UNIT(voxels_may_lie_in_another_file),
        UNIT(voxels_may_lie_in_many_files),
        UNIT(a_series_that_lies_costs_no_memory),
        UNIT(a_time_step_is_found_among_files),
        UNIT(long_lines_are_read_and_endless_ones_refused),
        UNIT(real_files_have_their_known_figures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
