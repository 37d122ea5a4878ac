/* tests/formats/test_png_slice.c - PNG pictures as slices of a volume. Pillow's
 * are compared in oracle_tiff.py; what the pictures' reader refuses is in
 * test_png.c. */
#include "support/files.h"

#include <png.h>

/* The most memory that a refusal may ask for at once: zlib's and libpng's. */
#define MOST ((size_t)200 * 1024)

/* Writes a picture of `samples` values of `depth` bits: value i of a row is
 * first + i. */
static const char *write_png(const support_files *files, const char *name,
                             int width, int height, int depth, int samples,
                             int first) {
    static const int types[] = {0, PNG_COLOR_TYPE_GRAY,
                                PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                                PNG_COLOR_TYPE_RGB_ALPHA};
    const char *path = support_path(files, name);
    FILE *file = fopen(path, "wb");
    png_structp png =
        png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    png_set_IHDR(png, info, (png_uint_32)width, (png_uint_32)height, depth,
                 types[samples], PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info);
    for (int y = 0; y < height; y++) {
        unsigned char row[256] = {0};
        for (int i = 0; i < width * samples; i++) {
            row[i * depth / 8] = (unsigned char)(first + i);
            if (depth == 16)
                row[2 * i + 1] = (unsigned char)y;
        }
        png_write_row(png, row);
    }
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    fclose(file);
    return path;
}

static void samples_stay_as_they_are(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    snow_volume *volume = support_opened(
        &files, write_png(&files, "a.png", 5, 3, 16, 1, 7), NULL);
    const uint16_t *voxels = snow_volume_voxels(volume);
    const snow_volume_info *info = snow_volume_get_info(volume);
    assert_true(info->dims[0] == 5 && info->dims[1] == 3 && info->dims[2] == 1);
    for (int i = 0; i < 15; i++)
        assert_int_equal(voxels[i], (7 + i % 5) << 8 | i / 5);
    assert_int_equal(files.warnings, 0);
    snow_volume_close(volume);
    support_files_end(&files);
}

static void colours_are_channels(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    const snow_volume_options options = {.size = sizeof options, .channel = 2};
    snow_volume *volume = support_opened(
        &files, write_png(&files, "a.png", 4, 2, 8, 3, 0), &options);
    const uint8_t *voxels = snow_volume_voxels(volume);
    for (int x = 0; x < 4; x++)
        assert_int_equal(voxels[x], 3 * x + 2);
    assert_int_equal(files.warnings, 0); /* the user knows of the others */
    snow_volume_close(volume);
    const snow_volume_options first = {.size = sizeof first,
                                       .channel_given = true};
    const char *path = support_path(&files, "a.png");
    snow_volume_close(support_opened(&files, path, &first));
    assert_int_equal(files.warnings, 0);
    snow_volume_close(support_opened(&files, path, NULL));
    assert_int_equal(files.warnings, 1);
    support_files_end(&files);
}

static void a_folder_tells_of_its_channels_once(void **state) {
    (void)state;
    support_files files;
    support_files_begin(&files);
    for (int z = 0; z < 12; z++) {
        char name[16];
        snprintf(name, sizeof name, "z%d.png", z);
        write_png(&files, name, 4, 2, 8, 4, z);
    }
    snow_volume *volume = support_opened(&files, files.folder, NULL);
    const uint8_t *voxels = snow_volume_voxels(volume);
    for (int z = 0; z < 12; z++)
        assert_int_equal(voxels[8 * z], z);
    assert_int_equal(files.warnings, 1);
    snow_volume_close(volume);
    support_files_end(&files);
}

static void a_damaged_slice_is_named(void **state) {
    (void)state;
    support_files files;
    unsigned char bytes[2000];
    support_files_begin(&files);
    for (int z = 0; z < 3; z++) {
        char name[16];
        snprintf(name, sizeof name, "z%d.png", z);
        write_png(&files, name, 40, 2, 8, 1, z);
    }
    FILE *file = fopen(support_path(&files, "z1.png"), "rb");
    size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    bytes[size - 20] ^= 1; /* in the last of the pixels' bytes */
    support_write(&files, "z1.png", bytes, size);
    support_refused(&files, files.folder, NULL, SNOW_STATUS_BAD_INPUT, "z1.png",
                    MOST);
    support_write(&files, "z1.png", bytes, 30);
    support_refused(&files, files.folder, NULL, SNOW_STATUS_BAD_INPUT, "z1.png",
                    MOST);
    support_files_end(&files);
}

/* A box of the smaller size lies in the larger slice too. */
static void a_slice_of_another_size_is_named(void **state) {
    (void)state;
    static const int sizes[][2] = {{50, 30}, {40, 31}, {30, 20}};
    const snow_volume_options part = {.size = sizeof part,
                                      .crop = {{1, 9}, {2, 9}, {0, 0}}};
    support_files files;
    support_files_begin(&files);
    for (int i = 0; i < 3; i++) {
        write_png(&files, "z0.png", 40, 30, 8, 1, 0);
        write_png(&files, "z1.png", sizes[i][0], sizes[i][1], 8, 1, 0);
        write_png(&files, "z2.png", 40, 30, 8, 1, 0);
        support_refused(&files, files.folder, NULL, SNOW_STATUS_BAD_INPUT,
                        "z1.png: has ", MOST);
        support_refused(&files, files.folder, &part, SNOW_STATUS_BAD_INPUT,
                        "z1.png: has ", MOST);
    }
    write_png(&files, "z1.png", 40, 30, 8, 1, 0);
    snow_volume_close(support_opened(&files, files.folder, &part));
    support_files_end(&files);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(samples_stay_as_they_are),
        cmocka_unit_test(colours_are_channels),
        cmocka_unit_test(a_folder_tells_of_its_channels_once),
        cmocka_unit_test(a_damaged_slice_is_named),
        cmocka_unit_test(a_slice_of_another_size_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
