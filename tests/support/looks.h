/* tests/support/looks.h - looks of values in memory. */
#ifndef SNOW_TEST_SUPPORT_LOOKS_H
#define SNOW_TEST_SUPPORT_LOOKS_H

#include "support/support.h"

#include "transfer/look.h"

/* A volume over n values, along x, which have to outlive it. */
snow_volume *support_row(snow_context *context, snow_type type,
                         const void *values, int64_t n);

/* What a look makes of a volume; the test fails when it makes nothing. */
snow_transfer *support_look(const snow_volume *volume, snow_look look);

/* --- a test's own context, whose *state is a looks_fixture -----------------
 */

/* The volumes and transfer functions of the functions below are freed at the
 * test's end, which fails when other memory is left. */
typedef struct looks_fixture {
    snow_context *context;
    char warning[1024]; /* the last one; "": none */
    int warnings;
    snow_volume **volumes;
    snow_transfer **transfers;
    size_t volume_count, transfer_count;
} looks_fixture;

#define LOOKS_TEST(name) \
    cmocka_unit_test_setup_teardown(name, looks_begin, looks_end)
int looks_begin(void **state);
int looks_end(void **state);

snow_volume *looks_volume(looks_fixture *f, snow_volume_info info,
                          const void *voxels);
snow_volume *looks_row(looks_fixture *f, snow_type type, const void *values,
                       int64_t n);

/* Records' sizes are filled in here. */
snow_transfer *looks_of(looks_fixture *f, const snow_volume *volume,
                        snow_look look);
snow_transfer *looks_of_points(looks_fixture *f, const snow_color_point *colors,
                               size_t color_count,
                               const snow_opacity_point *opacities,
                               size_t opacity_count);

/* A look that is bad usage, by a message with some words. */
void looks_refused(looks_fixture *f, const snow_volume *volume, snow_look look,
                   const char *words);

/* Opacity, and red, at a value; whether the description has some words. */
double looks_opacity(const snow_transfer *transfer, double value);
double looks_red(const snow_transfer *transfer, double value);
bool looks_say(const snow_transfer *transfer, const char *words);

#endif
