/* tests/formats/test_png_slice.c - PNG pictures as slices of a volume. Pillow's
 * are compared in oracle_tiff.py; what the pictures' reader refuses is in
 * test_png.c. */
#include "support/files.h"

#include <png.h>

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

/* A warning tells of the other channels, unless the user knows of them. */
static void one_of_many_channels_is_told(void **state) {
    support_files *files = *state;
    const char *path = write_png(files, "a.png", 4, 2, 8, 3, 0);
    const snow_volume_options known[] = {
        {.size = sizeof *known, .channel = 2},
        {.size = sizeof *known, .channel_given = true}};
    for (int i = 0; i < 2; i++)
        snow_volume_close(support_opened(files, path, &known[i]));
    assert_string_equal(files->warnings, "");
    snow_volume_close(support_opened(files, path, NULL));
    assert_int_equal(support_warned(files), 1);
}

static void a_folder_tells_of_its_channels_once(void **state) {
    support_files *files = *state;
    for (int z = 0; z < 12; z++) {
        char name[16];
        snprintf(name, sizeof name, "z%d.png", z);
        write_png(files, name, 4, 2, 8, 4, z);
    }
    snow_volume *volume = support_opened(files, files->folder, NULL);
    const uint8_t *voxels = snow_volume_voxels(volume);
    for (int z = 0; z < 12; z++)
        assert_int_equal(voxels[8 * z], z);
    assert_int_equal(support_warned(files), 1);
    snow_volume_close(volume);
}

static void a_damaged_slice_is_named(void **state) {
    support_files *files = *state;
    unsigned char bytes[2000];
    for (int z = 0; z < 3; z++) {
        char name[16];
        snprintf(name, sizeof name, "z%d.png", z);
        write_png(files, name, 40, 2, 8, 1, z);
    }
    FILE *file = fopen(support_path(files, "z1.png"), "rb");
    size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    bytes[size - 20] ^= 1; /* in the last of the pixels' bytes */
    support_write(files, "z1.png", bytes, size);
    support_bad_file(files, files->folder, "z1.png");
    support_write(files, "z1.png", bytes, 30);
    support_bad_file(files, files->folder, "z1.png");
}

/* A box of the smaller size lies in the larger slice too. */
static void a_slice_of_another_size_is_named(void **state) {
    support_files *files = *state;
    static const int sizes[][2] = {{50, 30}, {40, 31}, {30, 20}};
    const snow_volume_options part = {.size = sizeof part,
                                      .crop = {{1, 9}, {2, 9}, {0, 0}}};
    for (int i = 0; i < 3; i++) {
        write_png(files, "z0.png", 40, 30, 8, 1, 0);
        write_png(files, "z1.png", sizes[i][0], sizes[i][1], 8, 1, 0);
        write_png(files, "z2.png", 40, 30, 8, 1, 0);
        support_bad_file(files, files->folder, "z1.png: has ");
        support_refused(files, files->folder, &part, SNOW_STATUS_BAD_INPUT,
                        "z1.png: has ", SUPPORT_MOST);
    }
    write_png(files, "z1.png", 40, 30, 8, 1, 0);
    snow_volume_close(support_opened(files, files->folder, &part));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        SUPPORT_TEST(one_of_many_channels_is_told),
        SUPPORT_TEST(a_folder_tells_of_its_channels_once),
        SUPPORT_TEST(a_damaged_slice_is_named),
        SUPPORT_TEST(a_slice_of_another_size_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
