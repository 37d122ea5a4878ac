/* tests/support/image.c - see support_image.h. */
#include "support/image.h"

#include <unistd.h>

static void hear_warning(void *user, const char *text) {
    image_fixture *fixture = user;
    snprintf(fixture->warning, sizeof fixture->warning, "%s", text);
}

int support_image_setup(void **state) {
    image_fixture *fixture = calloc(1, sizeof *fixture);
    fixture->context = support_context();
    snow_context_set_warning(fixture->context, hear_warning, fixture);
    support_folder_make(fixture->folder);
    *state = fixture;
    return 0;
}

int support_image_teardown(void **state) {
    image_fixture *fixture = *state;
    if (fixture->path[0])
        unlink(fixture->path);
    assert_int_equal(rmdir(fixture->folder), 0);
    assert_int_equal(snow_context_bytes(fixture->context), 0);
    snow_context_free(fixture->context);
    free(fixture);
    return 0;
}

const char *support_image_path(image_fixture *fixture, const char *name) {
    if (fixture->path[0])
        unlink(fixture->path);
    snprintf(fixture->path, sizeof fixture->path, "%s/%s", fixture->folder,
             name);
    return fixture->path;
}

snow_volume_info support_patient(void) {
    return (snow_volume_info){
        .size = sizeof(snow_volume_info),
        .dims = {20, 30, 40},
        .matrix = {{-1, 0, 0, 3}, {0, 2, 0, 4}, {0, 0, 1, 5}, {0, 0, 0, 1}},
        .spacing = {1, 2, 1},
        .medical = true,
        .unit = "mm"};
}

snow_view support_view(snow_context *context, const char *name) {
    snow_view view = {.size = sizeof view};
    assert_int_equal(snow_view_from_name(context, name, &view), SNOW_STATUS_OK);
    return view;
}

snow_overlay *support_overlay(snow_context *context, int width, int height) {
    snow_overlay *overlay = NULL;
    assert_int_equal(snow_overlay_new(context, width, height, &overlay),
                     SNOW_STATUS_OK);
    return overlay;
}

support_bytes support_read_file(const char *path) {
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    support_bytes data = {NULL, (size_t)ftell(file)};
    rewind(file);
    data.bytes = malloc(data.size + 1);
    assert_int_equal(fread(data.bytes, 1, data.size, file), data.size);
    fclose(file);
    return data;
}

snow_image *support_blank(snow_context *context, int width, int height,
                          int channels) {
    snow_image *image = NULL;
    assert_int_equal(snow_image_new(context, width, height, channels, &image),
                     SNOW_STATUS_OK);
    return image;
}

snow_image *support_round_trip(image_fixture *fixture, const snow_image *image,
                               const char *name,
                               const snow_image_options *options) {
    snow_image *read = NULL;
    const char *path = support_image_path(fixture, name);
    assert_int_equal(snow_image_save(image, path, options), SNOW_STATUS_OK);
    assert_int_equal(snow_image_load(fixture->context, path, &read),
                     SNOW_STATUS_OK);
    unlink(path);
    return read;
}

double support_apart(const snow_image *a, const snow_image *b) {
    snow_image_difference difference = {.size = sizeof difference};
    assert_int_equal(snow_image_compare(a, b, &difference), SNOW_STATUS_OK);
    return difference.largest;
}

snow_image *support_picture(snow_context *context, int width, int height,
                            int channels, uint64_t seed) {
    snow_image *image = support_blank(context, width, height, channels);
    float *pixel = snow_image_pixels(image);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++, pixel += channels) {
            double alpha = (x + y) % 5 == 0 ? 0 : support_uniform(&seed);
            for (int c = 0; c < channels - 1; c++)
                pixel[c] =
                    (float)(alpha * (x + y * c) / (width + 3.0 * height));
            pixel[channels - 1] = (float)alpha;
        }
    return image;
}

void support_assert_refused(snow_context *context, const void *bytes,
                            size_t size) {
    snow_image *image = NULL;
    assert_int_equal(
        snow_image_load_memory(context, "pic.bin", bytes, size, &image),
        SNOW_STATUS_BAD_INPUT);
    assert_null(image);
    const char *message = snow_context_message(context);
    assert_int_equal(strncmp(message, "pic.bin: ", 9), 0);
    assert_null(strchr(message, '\n'));
    assert_non_null(strchr(message, ';'));
    assert_int_equal(snow_context_bytes(context), 0);
}

snow_image *support_load(snow_context *context, const void *bytes,
                         size_t size) {
    snow_image *image = NULL;
    if (snow_image_load_memory(context, "pic.bin", bytes, size, &image) !=
        SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(context));
    assert_int_equal(snow_image_channels(image), 4);
    return image;
}

static void *allocate_some(void *user, size_t bytes) {
    support_memory *memory = user;
    memory->left--;
    bool fails = memory->once ? memory->left == 0 : memory->left <= 0;
    return fails ? NULL : malloc(bytes);
}

static void release_some(void *user, void *block) {
    (void)user;
    free(block);
}

snow_context *support_failing_context(support_memory *memory) {
    snow_allocator allocator = {allocate_some, release_some, memory};
    snow_context *context = NULL;
    memory->left = INT64_MAX;
    assert_int_equal(snow_context_new(&allocator, &context), SNOW_STATUS_OK);
    return context;
}
