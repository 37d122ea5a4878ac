/* tests/stages/test_data_range.c - the range of a volume's values is found, by
 * many threads and vectors, at its first and its last voxel. */
#include "classify/shear_warp/range.h"
#include "support/support.h"
#include "volume/volume.h"

#include <math.h>

/* Of 700,000 voxels in several items of work, all 0 but for two. */
static void check_measured(snow_type type, int low, int high) {
    enum { COUNT = 700000 };
    const size_t size = snow_type_size(type);
    const int ends[2] = {low, high};
    unsigned char *voxels = calloc(COUNT, size);
    snow_volume volume = {.info = {.dims = {COUNT, 1, 1},
                                   .type = type,
                                   .slope = -2,
                                   .intercept = 1},
                          .voxels = voxels};
    snow_data_range range;
    assert_non_null(voxels);
    assert_int_equal(snow_context_new(NULL, &volume.context), SNOW_STATUS_OK);
    for (int n = 0; n < 2; n++) {
        int16_t native = (int16_t)ends[n];
        int8_t narrow = (int8_t)ends[n];
        memcpy(voxels + (size_t)(n ? COUNT - 1 : 5) * size,
               size == 1 ? (void *)&narrow : (void *)&native, size);
    }
    assert_int_equal(
        snow_data_range_measure(&volume, (snow_scale){0}, 2, &range),
        SNOW_STATUS_OK);
    assert_true(range.low == 1 - 2 * fmax(high, 0));
    assert_true(range.high == 1 - 2 * fmin(low, 0));
    snow_context_free(volume.context);
    free(voxels);
}

static void the_range_of_integers_is_found(void **state) {
    (void)state;
    check_measured(SNOW_TYPE_UINT8, 3, 255);
    check_measured(SNOW_TYPE_UINT8, 3, 200);
    check_measured(SNOW_TYPE_INT8, -128, 127);
    check_measured(SNOW_TYPE_INT8, -100, 90);
    check_measured(SNOW_TYPE_INT16, -32768, 20000);
    check_measured(SNOW_TYPE_UINT16, 40000, 65535);
    check_measured(SNOW_TYPE_UINT16, 1, 32768);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_range_of_integers_is_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
