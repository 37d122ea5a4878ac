/* tests/support/image.h - pictures, files and failing memory for the tests of
 * the picture formats. */
#ifndef SNOW_TEST_SUPPORT_IMAGE_H
#define SNOW_TEST_SUPPORT_IMAGE_H

#include "support/folder.h"
#include "support/support.h"

#include "image/image.h"
#include "image/overlay.h"

/* A context and an empty folder; cmocka's setup and teardown.  The teardown
 * fails the test when memory or files other than `path` are left. */
typedef struct image_fixture {
    snow_context *context;
    char folder[SUPPORT_FOLDER_BYTES];
    char path[128]; /* told by support_image_path last */
    char warning[SNOW_MESSAGE_BYTES];
} image_fixture;

int support_image_setup(void **state);
int support_image_teardown(void **state);

/* The path of a file in the fixture's folder. */
const char *support_image_path(image_fixture *fixture, const char *name);

/* A patient whose voxels lie as given, a named view, what is drawn over a
 * picture of a size. */
snow_volume_info support_patient(void);
snow_view support_view(snow_context *context, const char *name);
snow_overlay *support_overlay(snow_context *context, int width, int height);

typedef struct support_bytes {
    unsigned char *bytes;
    size_t size;
} support_bytes;

/* A whole file; free the bytes. */
support_bytes support_read_file(const char *path);

/* A transparent picture; what comes back of one that is written to a file of
 * that name; the largest difference of two. */
snow_image *support_blank(snow_context *context, int width, int height,
                          int channels);
snow_image *support_round_trip(image_fixture *fixture, const snow_image *image,
                               const char *name,
                               const snow_image_options *options);
double support_apart(const snow_image *a, const snow_image *b);

/* A picture of smooth and random premultiplied pixels with transparent ones. */
snow_image *support_picture(snow_context *context, int width, int height,
                            int channels, uint64_t seed);

/* Asserts that bytes are refused as bad input in one line that begins with the
 * name, and that no memory is held afterwards. */
void support_assert_refused(snow_context *context, const void *bytes,
                            size_t size);

/* Loads bytes that must be a picture. */
snow_image *support_load(snow_context *context, const void *bytes, size_t size);

/* malloc, whose n-th call from now on fails, alone or with all that follow. */
typedef struct support_memory {
    int64_t left; /* calls until one fails; INT64_MAX: none does */
    bool once;
} support_memory;

snow_context *support_failing_context(support_memory *memory);

#endif
