/* tests/formats/test_jpeg.c - JPEG pictures as slices of a volume.  Pillow's
 * are compared in oracle_tiff.py. */
#include "support/files.h"

static void previews_are_no_slices(void **state);

#if SNOW_HAVE_JPEG

#include <jpeglib.h>

typedef struct jpeg_kind {
    int width, height;
    J_COLOR_SPACE colors;
    bool progressive, arithmetic, refined;
} jpeg_kind;

/* Each coefficient by itself, bit by bit: the most scans there are. */
static void refine(struct jpeg_compress_struct *info) {
    static jpeg_scan_info scans[1 + 63 * 11];
    int count = 0;
    scans[count++] = (jpeg_scan_info){.comps_in_scan = 1};
    for (int k = 1; k < 64; k++)
        for (int bit = 10; bit >= 0; bit--)
            scans[count++] = (jpeg_scan_info){.comps_in_scan = 1,
                                              .Ss = k,
                                              .Se = k,
                                              .Ah = bit == 10 ? 0 : bit + 1,
                                              .Al = bit};
    info->scan_info = scans;
    info->num_scans = count;
}

/* Quality 100, so that values change by little: sample c of a pixel is
 * 4 y + x + 60 c + first. */
static const char *write_jpeg(const support_files *files, const char *name,
                              const jpeg_kind *kind, int first) {
    const char *path = support_path(files, name);
    FILE *file = fopen(path, "wb");
    struct jpeg_error_mgr fault;
    struct jpeg_compress_struct info = {.err = jpeg_std_error(&fault)};
    int samples = kind->colors == JCS_GRAYSCALE ? 1
                  : kind->colors == JCS_CMYK    ? 4
                                                : 3;
    unsigned char *row = malloc((size_t)(kind->width * samples));
    jpeg_create_compress(&info);
    jpeg_stdio_dest(&info, file);
    info.image_width = (JDIMENSION)kind->width;
    info.image_height = (JDIMENSION)kind->height;
    info.input_components = samples;
    info.in_color_space = kind->colors;
    jpeg_set_defaults(&info);
    jpeg_set_quality(&info, 100, TRUE);
    info.arith_code = kind->arithmetic;
    if (kind->progressive)
        jpeg_simple_progression(&info);
    if (kind->refined)
        refine(&info);
    jpeg_start_compress(&info, TRUE);
    for (int y = 0; y < kind->height; y++) {
        for (int i = 0; i < kind->width * samples; i++)
            row[i] = (unsigned char)((4 * y + i / samples + 60 * (i % samples) +
                                      first) %
                                     200);
        jpeg_write_scanlines(&info, &row, 1);
    }
    jpeg_finish_compress(&info);
    jpeg_destroy_compress(&info);
    free(row);
    fclose(file);
    return path;
}

static const jpeg_kind grey = {
    .width = 21, .height = 13, .colors = JCS_GRAYSCALE};

static void one_of_many_channels_is_told(void **state) {
    support_files *files = *state;
    jpeg_kind kind = grey;
    kind.colors = JCS_RGB;
    const char *path = write_jpeg(files, "a.jpg", &kind, 5);
    const snow_volume_options options = {.size = sizeof options, .channel = 1};
    snow_volume_close(support_opened(files, path, &options));
    assert_string_equal(files->warnings, ""); /* the user knows of the others */
    snow_volume_close(support_opened(files, path, NULL));
    assert_int_equal(support_warned(files), 1);
}

static void write_stack(const support_files *files, int count) {
    for (int z = 0; z < count; z++) {
        char name[16];
        snprintf(name, sizeof name, "z%d.jpg", z);
        write_jpeg(files, name, &grey, 3 * z);
    }
}

static size_t read_back(const support_files *files, const char *name,
                        unsigned char *bytes, size_t room) {
    FILE *file = fopen(support_path(files, name), "rb");
    size_t size = fread(bytes, 1, room, file);
    fclose(file);
    assert_true(size < room);
    return size;
}

/* At every length, and with a wrong code among the pixels. */
static void a_damaged_slice_is_named(void **state) {
    support_files *files = *state;
    static unsigned char bytes[4000];
    write_stack(files, 3);
    size_t size = read_back(files, "z1.jpg", bytes, sizeof bytes);
    for (size_t cut = 0; cut < size; cut += cut < size - 20 ? 7 : 1) {
        support_write(files, "z1.jpg", bytes, cut);
        support_bad_file(files, files->folder, "z1.jpg");
    }
    memset(bytes + size - 60, 0x55, 30);
    support_write(files, "z1.jpg", bytes, size);
    support_bad_file(files, files->folder, "z1.jpg");
    support_bad_file(files, support_write_text(files, "n.jpg", "no picture"),
                     "Not a JPEG file");
}

/* The sizes of the first frame header are set: more than the file can hold. */
static void sizes_that_do_not_fit_cost_nothing(void **state) {
    support_files *files = *state;
    static unsigned char bytes[4000];
    for (int i = 0; i < 2; i++) {
        jpeg_kind kind = grey;
        kind.progressive = i == 1;
        write_jpeg(files, "a.jpg", &kind, 0);
        size_t size = read_back(files, "a.jpg", bytes, sizeof bytes);
        unsigned char *frame = bytes;
        while (frame[0] != 0xff || (frame[1] & 0xfd) != 0xc0)
            frame++;
        memset(frame + 5, 0x7f, 4);
        support_bad_file(files, support_write(files, "a.jpg", bytes, size),
                         "bytes left where the pixels need 2080800");
    }
}

/* Coefficients, of which a progressive file needs all, have two bytes each. */
static void coefficients_are_under_the_limit(void **state) {
    support_files *files = *state;
    jpeg_kind kind = {.width = 1000, .height = 1000, .colors = JCS_GRAYSCALE};
    snow_context_set_memory_limit(files->context, 2000000);
    snow_volume_close(
        support_opened(files, write_jpeg(files, "a.jpg", &kind, 0), NULL));
    kind.progressive = true;
    support_refused(files, write_jpeg(files, "b.jpg", &kind, 0), NULL,
                    SNOW_STATUS_NO_MEMORY, "not progressive", 1100000);
    snow_context_set_memory_limit(files->context, 4000000);
    snow_volume_close(
        support_opened(files, support_path(files, "b.jpg"), NULL));
}

static void what_is_not_read_is_named(void **state) {
    static const struct {
        jpeg_kind kind;
        const char *part;
    } cases[] = {
        {{21, 13, JCS_CMYK, false, false, false}, "(CMYK), where grey and RGB"},
        {{21, 13, JCS_GRAYSCALE, false, true, false},
         "convert it with jpegtran"},
        {{21, 13, JCS_GRAYSCALE, false, false, true}, "more than 500 scans"},
    };
    for (int i = 0; i < 3; i++)
        support_bad_file(*state, write_jpeg(*state, "a.jpg", &cases[i].kind, 0),
                         cases[i].part);
}

/* Of 12 bits a sample, which this libjpeg does not write. */
static void other_depths_are_named(void **state) {
    support_files *files = *state;
    static unsigned char bytes[4000];
    write_jpeg(files, "a.jpg", &grey, 0);
    size_t size = read_back(files, "a.jpg", bytes, sizeof bytes);
    unsigned char *frame = bytes;
    while (frame[0] != 0xff || frame[1] != 0xc0)
        frame++;
    frame[1] = 0xc1;
    frame[4] = 12;
    support_bad_file(files, support_write(files, "a.jpg", bytes, size),
                     "12 bits a sample");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        SUPPORT_TEST(one_of_many_channels_is_told),
        SUPPORT_TEST(a_damaged_slice_is_named),
        SUPPORT_TEST(sizes_that_do_not_fit_cost_nothing),
        SUPPORT_TEST(coefficients_are_under_the_limit),
        SUPPORT_TEST(what_is_not_read_is_named),
        SUPPORT_TEST(other_depths_are_named),
        SUPPORT_TEST(previews_are_no_slices),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#else

static void it_is_refused_by_name(void **state) {
    support_files *files = *state;
    support_bad_file(files, support_write(files, "a", "\xff\xd8\xff\xe0", 4),
                     "libjpeg62-turbo-dev");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        SUPPORT_TEST(it_is_refused_by_name),
        SUPPORT_TEST(previews_are_no_slices),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#endif

static void copy_from_corpus(const support_files *files, const char *from,
                             const char *name) {
    static char bytes[1 << 16];
    char path[512];
    snprintf(path, sizeof path, "%s/%s", SNOW_CORPUS, from);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    support_write(files, name, bytes, size);
}

/* Beside slices of another format, whose names are before theirs and after. */
static void previews_are_no_slices(void **state) {
    support_files *files = *state;
    static const char *const kinds[][2] = {{"png_slice/grey8.png", "png"},
                                           {"dicom/little", "dicom"}};
    for (int i = 0; i < 2; i++) {
        char name[16];
        support_write(files, "a.jpg", "\xff\xd8\xff\xe0", 4);
        support_write(files, "z.jpeg", "\xff\xd8\xff\xe0", 4);
        support_bad_file(files, files->folder, "JPEG");
        snprintf(name, sizeof name, "m.%s", kinds[i][1]);
        copy_from_corpus(files, kinds[i][0], name);
        snow_volume *volume = support_opened(files, files->folder, NULL);
        assert_string_equal(snow_volume_get_info(volume)->format, kinds[i][1]);
        snow_volume_close(volume);
        assert_int_equal(remove(support_path(files, name)), 0);
    }
}
