/* tests/formats/test_dicom.c - DICOM: what a file says of its values, what
 * damaged files say, and what they may cost.  Which frames make a volume, where
 * it lies, and its values are compared with pydicom in oracle_dicom.py. */
#include "formats/dicom/dicom.h"
#include "support/files.h"

#include <zlib.h>

typedef struct file {
    unsigned char bytes[4096];
    size_t size;
} file;

static void put(file *f, const void *bytes, size_t size) {
    if (size)
        memcpy(f->bytes + f->size, bytes, size);
    f->size += size;
}

static void put_number(file *f, uint32_t value, int bytes) {
    for (int i = 0; i < bytes; i++)
        f->bytes[f->size++] = (unsigned char)(value >> 8 * i);
}

/* An element, explicit and little endian. */
static void element(file *f, uint32_t tag, const char *vr, const void *value,
                    size_t size) {
    put_number(f, tag >> 16, 2);
    put_number(f, tag & 0xffff, 2);
    put(f, vr, 2);
    bool is_long = strstr("OB OW SQ UN", vr) != NULL;
    put_number(f, 0, is_long ? 2 : 0);
    put_number(f, (uint32_t)size, is_long ? 4 : 2);
    put(f, value, value ? size : 0);
}

static void text(file *f, uint32_t tag, const char *vr, const char *value) {
    char padded[128];
    snprintf(padded, sizeof padded, "%s%s", value,
             strlen(value) % 2 ? " " : "");
    element(f, tag, vr, padded, strlen(padded));
}

static void number(file *f, uint32_t tag, unsigned value) {
    const unsigned char bytes[2] = {(unsigned char)value,
                                    (unsigned char)(value >> 8)};
    element(f, tag, "US", bytes, 2);
}

/* All before the pixels of a slice of 4 x 2 words at a height. */
static void begin(file *f, const char *syntax, double height) {
    char place[64], instance[32];
    memset(f, 0, sizeof *f);
    f->size = 128;
    put(f, "DICM", 4);
    text(f, 0x00020010, "UI", syntax);
    snprintf(instance, sizeof instance, "1.9.%d", (int)height + 100);
    text(f, 0x00080018, "UI", instance);
    text(f, 0x00100010, "PN", "Hidden^Name");
    text(f, 0x0020000e, "UI", "1.2.3");
    snprintf(place, sizeof place, "0\\0\\%g", height);
    text(f, 0x00200032, "DS", place);
    text(f, 0x00200037, "DS", "1\\0\\0\\0\\1\\0");
    number(f, 0x00280002, 1);
    text(f, 0x00280004, "CS", "MONOCHROME2");
    number(f, 0x00280010, 2);
    number(f, 0x00280011, 4);
    text(f, 0x00280030, "DS", "1\\1");
    number(f, 0x00280100, 16);
    number(f, 0x00280101, 16);
    number(f, 0x00280102, 15);
    number(f, 0x00280103, 0);
}

static const char explicit_little[] = "1.2.840.10008.1.2.1";

static void slice(file *f, double height, unsigned first) {
    unsigned char words[16] = {0};
    begin(f, explicit_little, height);
    for (unsigned i = 0; i < 8; i++)
        words[2 * i] = (unsigned char)(first + i);
    element(f, 0x7fe00010, "OW", words, sizeof words);
}

/* The tag and the kind of an element, 6 bytes, in a file that has it. */
static unsigned char *found(file *f, const char *bytes) {
    unsigned char *tag = f->bytes;
    while (memcmp(tag, bytes, 6) != 0)
        tag++;
    return tag;
}

static const char *write_file(support_files *files, const file *f) {
    return support_write(files, "a.dcm", f->bytes, f->size);
}

/* No other file lies beside it. */
static void refuse(support_files *files, const file *f, const char *part) {
    const char *path = write_file(files, f);
    support_bad_file(files, path, part);
    assert_int_equal(remove(path), 0);
}

static void a_file_says_how_to_show_it(void **state) {
    static const struct {
        const char *photometric, *level, *width;
        double low, high;
    } rows[] = {
        {"MONOCHROME2", "40\\-600", "400\\1500", -160, 240},
        {"MONOCHROME2", "40", "0", 0, 0},
        {"MONOCHROME2", "40", "many", 0, 0},
        {"MONOCHROME1", "100", "50", 65535 - 125, 65535 - 75},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        static const unsigned char words[16];
        file f;
        begin(&f, explicit_little, 0);
        text(&f, 0x00080060, "CS", "CT");
        text(&f, 0x0008103e, "LO", "Thorax  1mm");
        text(&f, 0x00281050, "DS", rows[n].level);
        text(&f, 0x00281051, "DS", rows[n].width);
        found(&f, "\x28\0\x04\0CS")[8 + 10] =
            (unsigned char)rows[n].photometric[10];
        element(&f, 0x7fe00010, "OW", words, sizeof words);
        snow_volume *volume =
            support_opened(*state, write_file(*state, &f), NULL);
        const snow_volume_info *info = snow_volume_get_info(volume);
        assert_string_equal(info->modality, "CT");
        assert_string_equal(info->description, "Thorax  1mm");
        assert_true(info->window[0] == rows[n].low);
        assert_true(info->window[1] == rows[n].high);
        snow_volume_close(volume);
    }
}

/* The unit of values: of a CT with a rescale, unless another one is named. */
static void hounsfield_units_are_those_of_a_ct(void **state) {
    static const struct {
        const char *modality, *intercept, *type;
        bool hounsfield;
    } table[] = {{"CT", "-1024", NULL, true}, {"CT", "-1024", "HU", true},
                 {"CT", "0", "HU", true},     {"CT", "-1024", "US", false},
                 {"CT", NULL, NULL, false},   {"MR", "-1024", NULL, false},
                 {NULL, "-1024", NULL, false}};
    for (size_t n = 0; n < sizeof table / sizeof *table; n++) {
        file f;
        const unsigned char words[16] = {1};
        begin(&f, explicit_little, 0);
        if (table[n].intercept) {
            text(&f, 0x00281052, "DS", table[n].intercept);
            text(&f, 0x00281053, "DS", "1");
        }
        if (table[n].type)
            text(&f, 0x00281054, "LO", table[n].type);
        if (table[n].modality)
            text(&f, 0x00080060, "CS", table[n].modality);
        element(&f, 0x7fe00010, "OW", words, sizeof words);
        snow_volume *volume =
            support_opened(*state, write_file(*state, &f), NULL);
        assert_true(snow_volume_get_info(volume)->hounsfield ==
                    table[n].hounsfield);
        snow_volume_close(volume);
    }
}

/* Siemens' header of named texts, in its second version. */
static void put_csa(file *f, const char *normal) {
    static const char *const names[] = {"NumberOfImagesInMosaic",
                                        "SliceNormalVector"};
    file csa = {.size = 0};
    put(&csa, "SV10\4\3\2\1\2\0\0\0\115\0\0\0", 16);
    for (int n = 0; n < 2; n++) {
        char name[64] = "";
        const char *values[3] = {n ? "0" : "3", "0 ", normal};
        memcpy(name, names[n], strlen(names[n]));
        put(&csa, name, 64);
        put_number(&csa, n ? 3 : 1, 4);
        put(&csa, "FD\0", 4);
        put_number(&csa, 4, 4);
        put_number(&csa, n ? 3 : 1, 4);
        put_number(&csa, 77, 4);
        for (int i = 0; i < (n ? 3 : 1); i++) {
            const size_t size = strlen(values[i]);
            for (int k = 0; k < 4; k++)
                put_number(&csa, (uint32_t)size, 4);
            put(&csa, values[i], size);
            put_number(&csa, 0, (int)(4 - size % 4) % 4);
        }
    }
    text(f, 0x00290011, "LO", "SIEMENS CSA HEADER");
    element(f, 0x00291110, "OB", csa.bytes, csa.size);
}

/* Three tiles of 2 x 1 voxels in a sheet of 4 x 2, and the numbers that say so;
 * values are 0, 1, ... in the order of the sheet. */
static void a_mosaic_is_its_tiles(void **state) {
    static const struct {
        const char *normal;
        unsigned number;
        uint16_t values[6];
        double bottom; /* z of the first slice */
    } rows[] = {{NULL, 3, {0, 1, 2, 3, 4, 5}, 0},
                {"1", 3, {0, 1, 2, 3, 4, 5}, 0},
                {"-1", 0, {4, 5, 2, 3, 0, 1}, -6}};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        file f;
        unsigned char words[16] = {0};
        begin(&f, explicit_little, 0);
        text(&f, 0x00080008, "CS", "ORIGINAL\\PRIMARY\\M\\MOSAIC");
        text(&f, 0x00180088, "DS", "3");
        if (rows[n].number) {
            text(&f, 0x00190010, "LO", "SIEMENS MR HEADER");
            number(&f, 0x0019100a, rows[n].number);
        }
        if (rows[n].normal)
            put_csa(&f, rows[n].normal);
        for (unsigned i = 0; i < 8; i++)
            words[2 * i] = (unsigned char)(i < 6 ? i : 9);
        element(&f, 0x7fe00010, "OW", words, sizeof words);
        snow_volume *volume =
            support_opened(*state, write_file(*state, &f), NULL);
        const snow_volume_info *info = snow_volume_get_info(volume);
        assert_int_equal(info->dims[0], 2);
        assert_int_equal(info->dims[1], 1);
        assert_int_equal(info->dims[2], 3);
        assert_true(info->matrix[0][3] == -1 && info->matrix[1][3] == -0.5);
        assert_true(info->matrix[2][3] == rows[n].bottom);
        assert_true(info->matrix[2][2] == 3);
        assert_memory_equal(snow_volume_voxels(volume), rows[n].values,
                            sizeof rows[n].values);
        assert_int_equal(support_warned(*state), 1); /* the first has none */
        snow_volume_close(volume);
    }
    file f;
    begin(&f, explicit_little, 0);
    text(&f, 0x00080008, "CS", "ORIGINAL\\PRIMARY\\M\\MOSAIC");
    element(&f, 0x7fe00010, "OW", f.bytes, 16);
    refuse(*state, &f, "without the number of its slices");
}

/* Programs that remove names may give all images one UID. */
static void images_of_one_uid_are_told_apart(void **state) {
    support_files *files = *state;
    static const char *const names[] = {"0", "1", "2", "3"};
    for (unsigned z = 0; z < 4; z++) {
        file f;
        slice(&f, z % 3, 10 * (z % 3)); /* the last is a copy */
        memcpy(found(&f, "\x08\0\x18\0UI") + 8, "1.9.7", 5);
        support_write(files, names[z], f.bytes, f.size);
    }
    snow_volume *volume = support_opened(files, support_path(files, "1"), NULL);
    assert_int_equal(snow_volume_get_info(volume)->dims[2], 3);
    assert_int_equal(((const uint16_t *)snow_volume_voxels(volume))[16], 20);
    snow_volume_close(volume);
}

/* Without numbers of their own files are not copies, but the given one is. */
static void a_slice_without_a_number_is_there_once(void **state) {
    support_files *files = *state;
    static const char *const names[] = {"0", "1", "2"};
    for (unsigned z = 0; z < 3; z++) {
        file f;
        slice(&f, z, 10 * z);
        found(&f, "\x08\0\x18\0UI")[2] = 0x19; /* no one looks for this one */
        support_write(files, names[z], f.bytes, f.size);
    }
    snow_volume *volume = support_opened(files, support_path(files, "1"), NULL);
    assert_int_equal(snow_volume_get_info(volume)->dims[2], 3);
    assert_int_equal(support_warned(files), 1);
    assert_non_null(strstr(files->warnings, "one of 3 slices"));
    snow_volume_close(volume);
}

static void a_file_cut_anywhere_is_refused(void **state) {
    support_files *files = *state;
    file f;
    slice(&f, 0, 0);
    size_t whole = f.size;
    for (f.size = 132; f.size < whole; f.size++)
        refuse(files, &f, f.size + 1 < whole ? "" : "is truncated");
    assert_null(strstr(snow_context_message(files->context), "Hidden"));
}

static const char run_lengths[] = "1.2.840.10008.1.2.5";

/* A sequence of items, each of the same bytes. */
static void items(file *f, uint32_t tag, const char *vr, int count,
                  const void *bytes, size_t size) {
    element(f, tag, vr, NULL, 0xffffffff);
    for (int i = 0; i < count; i++) {
        put_number(f, 0xe000fffe, 4);
        put_number(f, (uint32_t)size, 4);
        put(f, bytes, size);
    }
    put_number(f, 0xe0ddfffe, 4);
    put_number(f, 0, 4);
}

/* Packed pixels of one fragment behind an empty table. */
static void fragment(file *f, const void *bytes, size_t size) {
    element(f, 0x7fe00010, "OB", NULL, 0xffffffff);
    put_number(f, 0xe000fffe, 4);
    put_number(f, 0, 4);
    put_number(f, 0xe000fffe, 4);
    put_number(f, (uint32_t)size, 4);
    put(f, bytes, size);
    put_number(f, 0xe0ddfffe, 4);
    put_number(f, 0, 4);
}

static void lengths_that_lie_cost_no_memory(void **state) {
    support_files *files = *state;
    file f;
    begin(&f, explicit_little, 0);
    element(&f, 0x7fe00010, "OW", NULL, 0xfffffff0);
    put_number(&f, 0, 4);
    refuse(files, &f, "claims 4294967280 bytes, of which 4 exist");
    begin(&f, explicit_little, 0);
    for (int i = 0; i < 60; i++) {
        element(&f, 0x00400000, "SQ", NULL, 0xffffffff);
        put_number(&f, 0xe000fffe, 4);
        put_number(&f, 0xffffffff, 4);
    }
    refuse(files, &f, "nests sequences");
}

/* Frames that their file does not have, enough to fill the memory. */
static void frames_that_lie_cost_no_memory(void **state) {
    static const struct {
        const char *frames;
        size_t bytes;
    } plain[] = {{"100000000", 2}, {"999999999", 0}, {"2", 31}};
    file f;
    for (int i = 0; i < 3; i++) {
        begin(&f, explicit_little, 0);
        text(&f, 0x00280008, "IS", plain[i].frames);
        element(&f, 0x7fe00010, "OW", f.bytes, plain[i].bytes);
        refuse(*state, &f, "cannot hold");
    }
    begin(&f, run_lengths, 0);
    text(&f, 0x00280008, "IS", "99999");
    fragment(&f, "ab", 2);
    refuse(*state, &f, "cannot hold");
    /* A pixel whose bits are more than an int can count. */
    memset(&f, 0, sizeof f);
    f.size = 128;
    put(&f, "DICM", 4);
    text(&f, 0x00020010, "UI", explicit_little);
    number(&f, 0x00280002, 65535);
    number(&f, 0x00280010, 1);
    number(&f, 0x00280011, 1);
    number(&f, 0x00280100, 65535);
    element(&f, 0x7fe00010, "OW", "ab", 2);
    refuse(*state, &f, "cannot hold");
}

/* A slice whose pixels are packed so. */
static file packed_slice(const char *syntax, const void *bytes, size_t size) {
    file f;
    begin(&f, syntax, 0);
    fragment(&f, bytes, size);
    return f;
}

/* Segments of the high bytes, all 1, and of the low ones, 0 to 7. */
static size_t runs(unsigned char *out) {
    static const unsigned char segments[] = {0xf9, 1, 7, 0, 1, 2,
                                             3,    4, 5, 6, 7, 0x80};
    memset(out, 0, 64);
    out[0] = 2;
    out[4] = 64;
    out[8] = 66;
    memcpy(out + 64, segments, sizeof segments);
    return 64 + sizeof segments;
}

static void run_lengths_are_unpacked(void **state) {
    support_files *files = *state;
    unsigned char packed[128];
    size_t size = runs(packed);
    file f = packed_slice(run_lengths, packed, size);
    snow_volume *volume = support_opened(files, write_file(files, &f), NULL);
    const uint16_t *voxels = snow_volume_voxels(volume);
    for (int i = 0; i < 8; i++)
        assert_int_equal(voxels[i], 256 + i);
    snow_volume_close(volume);
    for (size_t short_by = 2; short_by <= size; short_by += 3) {
        f = packed_slice(run_lengths, packed, size - short_by);
        refuse(files, &f, "be decompressed");
    }
    packed[8] = 255; /* a segment that begins behind the others */
    f = packed_slice(run_lengths, packed, size);
    refuse(files, &f, "be decompressed");
}

/* A file of 4 x 2 words, or of frames of them, in which one thing is wrong. */
static void contradiction(file *f, int kind) {
    static const unsigned char words[64];
    unsigned char packed[128];
    size_t size = runs(packed);
    begin(f, kind < 4 ? explicit_little : run_lengths, 0);
    if (kind == 0)
        number(f, 0x00280010, 3);
    if (kind == 3 || kind == 5)
        text(f, 0x00280008, "IS", "2");
    if (kind == 3)
        items(f, 0x52009230, "SQ", 3, NULL, 0);
    if (kind >= 4) { /* the first item is the table */
        items(f, 0x7fe00010, "OB", 4, packed, size);
        return;
    }
    element(f, 0x7fe00010, "OW", words, kind == 2 || kind == 3 ? 32 : 16);
    if (kind == 1)
        element(f, 0x7fe00010, "OW", words, 16);
}

static void headers_that_contradict_the_pixels_are_refused(void **state) {
    static const char *const parts[] = {"element (0028,0010) twice",
                                        "element (7fe0,0010) twice",
                                        "has 32 bytes of pixels, more than",
                                        "describes 3 frames but claims 2",
                                        "3 compressed pieces",
                                        "3 compressed pieces"};
    for (int kind = 0; kind < 6; kind++) {
        file f;
        contradiction(&f, kind);
        refuse(*state, &f, parts[kind]);
    }
}

/* Without GDCM that is said first, whatever the pixels are. */
static void packed_pixels_must_be_what_the_header_says(void **state) {
    static const struct {
        const char *syntax, *bytes;
        size_t size;
        const char *part, *without;
    } cases[] = {
        {"1.2.840.10008.1.2.4.70",
         "\xff\xd8\xff\xc3\0\x0b\x10\0\x63\0\4\1\1\x11\0", 16,
         "are 4x99 of 1 values with 16 bits but its header says 4x2",
         "this build cannot read compressed DICOM images"},
        {"1.2.840.10008.1.2.4.70", "no picture", 10, "do not begin like",
         "libgdcm-dev and g++"},
        {"1.2.840.10008.1.2.4.100", "no picture", 10, /* MPEG */
         "compressed in an unsupported way", "1.2.840.10008.1.2.4.100"},
    };
    for (int i = 0; i < 3; i++) {
        file f = packed_slice(cases[i].syntax, cases[i].bytes, cases[i].size);
        refuse(*state, &f, SNOW_HAVE_GDCM ? cases[i].part : cases[i].without);
    }
}

/* Plain pixels whose bytes may be in any order: a private syntax of GE, one
 * that is cut, one that is longer than a name can be, and one of movies. */
static void plain_pixels_in_an_unknown_syntax_are_refused(void **state) {
    static const char *const syntaxes[] = {
        "1.2.840.113619.5.2", "1.2.840.10008.1.2.1.9", "1.2.840.10008.1.2.99",
        "1.2.840.10008.1.2.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1."
        "1",
        "1.2.840.10008.1.2.7.1"};
    static const unsigned char words[16];
    for (size_t i = 0; i < sizeof syntaxes / sizeof *syntaxes; i++) {
        file f;
        char part[128];
        begin(&f, syntaxes[i], 0);
        element(&f, 0x7fe00010, "OW", words, sizeof words);
        snprintf(part, sizeof part, "unknown way (transfer syntax %.64s)",
                 syntaxes[i]);
        refuse(*state, &f, part);
    }
}

/* --- deflated files ------------------------------------------------------- */

#define BOMB_BYTES ((uint32_t)65 << 20)

/* The elements of a slice, deflated, whose last one claims BOMB_BYTES zeros and
 * has them. */
static void write_bomb(const support_files *files, const char *name,
                       double height, uint32_t last) {
    static unsigned char packed[1 << 20];
    static const unsigned char zeros[4096];
    file f;
    z_stream stream = {.avail_out = sizeof packed - 256};
    begin(&f, "1.2.840.10008.1.2.1.99", height);
    size_t meta = 132 + 8 + 22; /* the mark and the syntax */
    element(&f, last, "OB", NULL, BOMB_BYTES);
    memcpy(packed, f.bytes, meta);
    assert_int_equal(deflateInit2(&stream, 9, Z_DEFLATED, -15, 9, 0), Z_OK);
    stream.next_out = packed + meta;
    stream.next_in = f.bytes + meta;
    stream.avail_in = (uInt)(f.size - meta);
    deflate(&stream, Z_NO_FLUSH);
    for (uint32_t made = 0; made < BOMB_BYTES; made += sizeof zeros) {
        stream.next_in = (unsigned char *)(uintptr_t)zeros;
        stream.avail_in = sizeof zeros;
        deflate(&stream, Z_NO_FLUSH);
    }
    assert_int_equal(deflate(&stream, Z_FINISH), Z_STREAM_END);
    deflateEnd(&stream);
    support_write(files, name, packed, meta + stream.total_out);
}

/* A slice needs the headers of those beside it: pixels that are more than a
 * header says are not inflated. */
static void a_deflated_bomb_costs_nothing(void **state) {
    support_files *files = *state;
    file f;
    slice(&f, 0, 1);
    const char *plain = support_write(files, "a.dcm", f.bytes, f.size);
    write_bomb(files, "b.dcm", 1, DICOM_TAG_PIXELS);
    snow_volume *volume = support_opened(files, plain, NULL);
    const uint16_t *voxels = snow_volume_voxels(volume);
    assert_int_equal(snow_volume_get_info(volume)->dims[2], 1);
    for (int i = 0; i < 8; i++)
        assert_int_equal(voxels[i], 1 + i);
    snow_volume_close(volume);
    assert_true(files->largest <= SUPPORT_MOST);
}

static void a_deflated_bomb_before_the_pixels_is_refused(void **state) {
    support_files *files = *state;
    write_bomb(files, "b.dcm", 1, 0x00291010);
    support_bad_file(files, support_path(files, "b.dcm"),
                     "inflates to more than 64 MiB");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        SUPPORT_TEST(a_file_says_how_to_show_it),
        SUPPORT_TEST(hounsfield_units_are_those_of_a_ct),
        SUPPORT_TEST(a_mosaic_is_its_tiles),
        SUPPORT_TEST(images_of_one_uid_are_told_apart),
        SUPPORT_TEST(a_slice_without_a_number_is_there_once),
        SUPPORT_TEST(a_file_cut_anywhere_is_refused),
        SUPPORT_TEST(lengths_that_lie_cost_no_memory),
        SUPPORT_TEST(frames_that_lie_cost_no_memory),
        SUPPORT_TEST(run_lengths_are_unpacked),
        SUPPORT_TEST(headers_that_contradict_the_pixels_are_refused),
        SUPPORT_TEST(packed_pixels_must_be_what_the_header_says),
        SUPPORT_TEST(plain_pixels_in_an_unknown_syntax_are_refused),
        SUPPORT_TEST(a_deflated_bomb_costs_nothing),
        SUPPORT_TEST(a_deflated_bomb_before_the_pixels_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
