/* tests/image/test_pictures.c - EXR, TIFF, WebP and JPEG: what is written is
 * read again, and what is damaged is refused; where this build lacks a library
 * both are refused in words. */
#include "support/image.h"

#include <math.h>
#include <string.h>

#if SNOW_HAVE_EXR
#include <openexr.h>
#include <stdlib.h>
#include <unistd.h>
#endif

/* Asserts that saving fails with words of the message, and leaves no file. */
static void refuse_save(image_fixture *f, const snow_image *image,
                        const char *name, const snow_image_options *options,
                        const char *words) {
    assert_int_equal(
        snow_image_save(image, support_image_path(f, name), options),
        SNOW_STATUS_BAD_USAGE);
    if (!strstr(snow_context_message(f->context), words))
        fail_msg("%s", snow_context_message(f->context));
    assert_int_equal(support_folder_files(f->folder), 0);
}

static bool is_built(const char *wanted) {
    const char *suffix;
    bool built = false;
    for (size_t i = 0; (suffix = snow_image_format_suffix(i, &built)); i++)
        if (strcmp(suffix, wanted) == 0)
            return built;
    fail_msg("%s is no format", wanted);
    return false;
}

static void a_build_without_a_library_says_so(void **state) {
    static const char *const names[][2] = {{".exr", "libopenexr-dev"},
                                           {".tif", "libtiff-dev"},
                                           {".webp", "libwebp-dev"},
                                           {".jpg", "libjpeg62-turbo-dev"}};
    static const char magic[][13] = {"\x76\x2f\x31\x01", "II*", "RIFF1234WEBP",
                                     "\xff\xd8\xff\xe0"};
    image_fixture *f = *state;
    for (size_t n = 0; n < 4; n++) {
        snow_image *image = support_picture(f->context, 5, 4, 4, 1);
        char name[8];
        snprintf(name, sizeof name, "a%s", names[n][0]);
        assert_int_equal(snow_image_format_bits(name), n >= 2 ? 8 : 0);
        snow_image *read = NULL;
        snow_status status = snow_image_load_memory(f->context, "it", magic[n],
                                                    sizeof magic[n], &read);
        assert_int_equal(status, SNOW_STATUS_BAD_INPUT);
        bool given = strstr(snow_context_message(f->context), names[n][1]);
        assert_true(given == !is_built(names[n][0]));
        if (!is_built(names[n][0]))
            refuse_save(f, image, name, NULL, names[n][1]);
        snow_image_free(image);
    }
}

/* Sizes of one chunk, of many, and of a part of one. */
static const int sizes[][2] = {{1, 1},   {1, 100}, {100, 1},
                               {17, 33}, {64, 48}, {300, 200}};
#define SIZES (sizeof sizes / sizeof *sizes)

/* Values in data units, some missing. */
static snow_image *values_of(snow_context *context, int width, int height) {
    snow_image *image = support_blank(context, width, height, 1);
    for (int i = 0; i < width * height; i++)
        snow_image_pixels(image)[i] = i % 7 ? 1000.5f * (float)i : NAN;
    return image;
}

static void floats_come_back_bit_for_bit(void **state) {
    image_fixture *f = *state;
    static const char *const names[] = {"a.exr", "a.tif", "a.tiff"};
    for (size_t n = 0; n < 3; n++)
        for (size_t s = 0; s < SIZES; s++)
            for (int channels = 1; channels <= 4; channels *= 2) {
                if (!is_built(n ? ".tif" : ".exr"))
                    continue;
                snow_image *image =
                    channels == 1
                        ? values_of(f->context, sizes[s][0], sizes[s][1])
                        : support_picture(f->context, sizes[s][0], sizes[s][1],
                                          channels, s);
                float *pixels = snow_image_pixels(image);
                pixels[0] = INFINITY;
                if (channels > 1)
                    pixels[1] = -1e-30f;
                snow_image *read = support_round_trip(f, image, names[n], NULL);
                assert_int_equal(snow_image_channels(read), 4);
                assert_true(support_apart(image, read) == 0);
                snow_image_free(read);
                snow_image_free(image);
            }
}

/* What Z holds is read by tests/oracles/oracle_pictures.py: no reader here
 * takes it. */
static void a_depth_lies_beside_an_exr_picture_only(void **state) {
    image_fixture *f = *state;
    assert_true(snow_image_format_has_depth("a.exr"));
    assert_false(snow_image_format_has_depth("a.tif"));
    assert_false(snow_image_format_has_depth("-"));
    assert_false(snow_image_format_has_depth("a"));
    for (int channels = 1; channels <= 4 && is_built(".exr"); channels *= 2) {
        snow_image *image =
            channels == 1 ? values_of(f->context, 33, 20)
                          : support_picture(f->context, 33, 20, channels, 1);
        snow_image *depth = values_of(f->context, 33, 20);
        snow_image *other = values_of(f->context, 20, 33);
        const snow_image_options beside = {.size = sizeof beside,
                                           .depth = depth},
                                 wrong = {.size = sizeof wrong, .depth = other};
        refuse_save(f, image, "a.npy", &beside, "cannot hold depth");
        refuse_save(f, image, "a.exr", &wrong, "the depth has 20 x 33");
        snow_image *read = support_round_trip(f, image, "a.exr", &beside);
        assert_true(support_apart(image, read) == 0);
        snow_image_free(read);
        snow_image_free(other);
        snow_image_free(depth);
        snow_image_free(image);
    }
}

static void webp_holds_what_png_holds(void **state) {
    image_fixture *f = *state;
    if (!is_built(".webp"))
        skip();
    for (size_t s = 0; s < SIZES; s++)
        for (int n = 0; n < 6; n++) {
            snow_image *image = support_picture(f->context, sizes[s][0],
                                                sizes[s][1], n % 2 ? 2 : 4, s);
            const snow_image_options options = {
                .size = sizeof options,
                .flatten = n / 2 > 0,
                .background = {0.2, n / 2 == 1 ? 0.2 : 0.7, 0.2}};
            snow_image *png = support_round_trip(f, image, "a.png", &options);
            snow_image *webp = support_round_trip(f, image, "a.webp", &options);
            assert_true(snow_image_checksum(png) == snow_image_checksum(webp));
            snow_image_free(png);
            snow_image_free(webp);
            snow_image_free(image);
        }
}

/* Smooth enough that a lossy file stays near: half is transparent. */
static snow_image *slope(snow_context *context, int channels) {
    snow_image *image = support_blank(context, 60, 44, channels);
    float *at = snow_image_pixels(image);
    for (int i = 0; i < 60 * 44; i++, at += channels) {
        float alpha = i % 60 < 30 ? 0.5f : 0.9f;
        for (int c = 0; c + 1 < channels; c++)
            at[c] = alpha * (float)(i / 60 + 4 * c) / 60;
        at[channels - 1] = alpha;
    }
    return image;
}

/* Bounds for lossy files: four levels in the mean would be seen. */
static void jpeg_is_laid_on_the_background(void **state) {
    image_fixture *f = *state;
    if (!is_built(".jpg"))
        skip();
    for (int n = 0; n < 6; n++) {
        snow_image *image = slope(f->context, n % 2 ? 2 : 4);
        snow_image_options options = {
            .size = sizeof options,
            .flatten = true,
            .background = {n / 2 ? 0.2 : 0, n / 2 == 1 ? 0.2 : 0, 0}};
        snow_image *png = support_round_trip(f, image, "a.png", &options);
        snow_image *jpeg = support_round_trip(
            f, image, n % 2 ? "a.jpg" : "a.jpeg", n / 2 ? &options : NULL);
        snow_image_difference difference = {.size = sizeof difference};
        assert_int_equal(snow_image_compare(png, jpeg, &difference),
                         SNOW_STATUS_OK);
        assert_true(difference.mean < 1 / 255.0);
        assert_true(difference.largest < 12 / 255.0);
        snow_image_free(png);
        snow_image_free(jpeg);
        snow_image_free(image);
    }
}

static void what_a_format_cannot_hold_is_refused(void **state) {
    image_fixture *f = *state;
    const snow_image_options deep = {.size = sizeof deep, .bits = 16},
                             flat = {.size = sizeof flat, .flatten = true};
    snow_image *image = support_picture(f->context, 9, 9, 4, 1);
    snow_image *wide = support_picture(f->context, 16384, 1, 2, 1);
    if (is_built(".webp")) {
        refuse_save(f, image, "a.webp", &deep, "8 bits per channel");
        refuse_save(f, wide, "a.webp", NULL, "at most 16383 pixels");
        assert_int_equal(snow_image_check(f->context,
                                          support_image_path(f, "a.webp"),
                                          16384, 1, NULL),
                         SNOW_STATUS_BAD_USAGE);
        assert_int_equal(snow_image_check(f->context,
                                          support_image_path(f, "a.webp"),
                                          16383, 1, NULL),
                         SNOW_STATUS_OK);
    }
    if (is_built(".exr"))
        refuse_save(f, image, "a.exr", &flat, "neither a background");
    if (is_built(".tif"))
        refuse_save(f, image, "a.tif", &deep, "neither a background");
    snow_image_free(wide);
    snow_image_free(image);
}

/* Cut anywhere, and changed anywhere: refused in one line or read, never worse.
 */
static void damaged_files_are_refused_or_read(void **state) {
    static const char *const names[] = {".exr", ".tif", ".webp", ".jpg"};
    image_fixture *f = *state;
    uint64_t random = 9;
    for (size_t n = 0; n < 4; n++) {
        char name[8];
        snprintf(name, sizeof name, "a%s", names[n]);
        if (!is_built(names[n]))
            continue;
        snow_image *image = support_picture(f->context, 40, 30, 4, 7);
        const char *path = support_image_path(f, name);
        assert_int_equal(snow_image_save(image, path, NULL), SNOW_STATUS_OK);
        support_bytes file = support_read_file(path);
        remove(path);
        int refused = 0;
        for (size_t cut = 16; cut < file.size; cut += file.size / 50 + 1) {
            snow_image *read = NULL;
            if (snow_image_load_memory(f->context, "it", file.bytes, cut,
                                       &read) != SNOW_STATUS_OK)
                refused++;
            else
                snow_image_free(read);
        }
        assert_true(refused >= 20);
        for (int round = 0; round < 400; round++) {
            unsigned char *copy = malloc(file.size);
            snow_image *read = NULL;
            memcpy(copy, file.bytes, file.size);
            for (int hits = 1 + round % 4; hits; hits--) {
                /* the headers, which decide most, more often than the rest */
                size_t most = round % 2 && file.size > 400 ? 400 : file.size;
                copy[8 + support_random(&random) % (most - 8)] =
                    (unsigned char)support_random(&random);
            }
            snow_status status = snow_image_load_memory(f->context, "it", copy,
                                                        file.size, &read);
            if (status != SNOW_STATUS_OK) {
                assert_true(status == SNOW_STATUS_BAD_INPUT ||
                            status == SNOW_STATUS_NO_MEMORY);
                assert_null(strchr(snow_context_message(f->context), '\n'));
            }
            snow_image_free(read);
            free(copy);
        }
        free(file.bytes);
        snow_image_free(image);
    }
}

static void they_fail_cleanly_without_memory(void **state) {
    static const char *const names[] = {".exr", ".tif", ".webp", ".jpg"};
    image_fixture *f = *state;
    for (size_t n = 0; n < 4; n++) {
        char name[8];
        snprintf(name, sizeof name, "a%s", names[n]);
        if (!is_built(names[n]))
            continue;
        const char *path = support_image_path(f, name);
        snow_status status = SNOW_STATUS_NO_MEMORY;
        for (int64_t at = 0; status != SNOW_STATUS_OK; at++) {
            support_memory memory = {.left = INT64_MAX};
            snow_context *context = support_failing_context(&memory);
            snow_image *image = support_picture(context, 40, 30, 4, 7);
            snow_image *read = NULL;
            const snow_image_options over = {.size = sizeof over,
                                             .overwrite = true};
            memory.left = at;
            status = snow_image_save(image, path, &over);
            if (status == SNOW_STATUS_OK)
                status = snow_image_load(context, path, &read);
            memory.left = INT64_MAX;
            if (status != SNOW_STATUS_OK && status != SNOW_STATUS_NO_MEMORY)
                fail_msg("%s", snow_context_message(context));
            snow_image_free(read);
            snow_image_free(image);
            assert_int_equal(snow_context_bytes(context), 0);
            snow_context_free(context);
        }
        remove(path);
    }
}

#if SNOW_HAVE_EXR

/* Allocations of OpenEXR, and the one that fails. */
static long made, failing;

static void *allocate_but_one(size_t bytes) {
    return ++made == failing ? NULL : malloc(bytes);
}

/* OpenEXR has memory of its own, which no context can refuse.  Whichever of its
 * allocations fails, writing ends. */
static void exr_ends_when_openexr_has_no_memory(void **state) {
    image_fixture *f = *state;
    snow_image *image = support_picture(f->context, 33, 20, 4, 1);
    snow_status status = SNOW_STATUS_FAILED;
    const char *path = support_image_path(f, "a.exr");
    exr_set_default_memory_routines(allocate_but_one, free);
    alarm(20); /* ends the test */
    for (failing = 1; status != SNOW_STATUS_OK; failing++) {
        made = 0;
        status = snow_image_save(image, path, NULL);
        assert_int_equal(support_folder_files(f->folder),
                         status == SNOW_STATUS_OK);
    }
    alarm(0);
    exr_set_default_memory_routines(NULL, NULL);
    assert_true(failing > 10);
    remove(path);
    snow_image_free(image);
}

#endif

#define HERE(test)                                             \
    cmocka_unit_test_setup_teardown(test, support_image_setup, \
                                    support_image_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        HERE(a_build_without_a_library_says_so),
        HERE(floats_come_back_bit_for_bit),
        HERE(a_depth_lies_beside_an_exr_picture_only),
#if SNOW_HAVE_EXR
        HERE(exr_ends_when_openexr_has_no_memory),
#endif
        HERE(webp_holds_what_png_holds),
        HERE(jpeg_is_laid_on_the_background),
        HERE(what_a_format_cannot_hold_is_refused),
        HERE(damaged_files_are_refused_or_read),
        HERE(they_fail_cleanly_without_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
