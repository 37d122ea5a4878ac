/* tests/stages/test_value_numbers.c - the numbers of 14 bits that integers of 8
 * and 16 bits become: exactly those of docs/model.md, the value model, point 2.
 */
#include "classify/values/value_coder.h"
#include "reference/model.h"
#include "values/value_model.h"

#include <math.h>

/* A converter of a range of stored values, with a look that shows all of it. */
typedef struct numbers {
    snow_context *context;
    snow_transfer *transfer;
    snow_volume volume;
    snow_value_coder coder;
} numbers;

static numbers numbers_of(snow_type type, double slope, int bottom, int top) {
    const snow_color_point colors[] = {{0, 1, 1, 1}};
    const double a = slope * bottom + 3, b = slope * top + 3;
    const snow_opacity_point opacities[] = {{fmin(a, b), 0.1},
                                            {fmax(a, b), 0.9}};
    const snow_data_range data = {.low = fmin(a, b), .high = fmax(a, b)};
    numbers n = {.volume.info = {.type = type, .slope = slope, .intercept = 3}};
    assert_int_equal(snow_context_new(NULL, &n.context), SNOW_STATUS_OK);
    n.volume.context = n.context;
    assert_int_equal(
        snow_transfer_new(n.context, colors, 1, opacities, 2, &n.transfer),
        SNOW_STATUS_OK);
    const snow_value_scale14 scale =
        snow_value_scale_of(&data, n.transfer, &n.volume.info);
    assert_true(scale.whole);
    assert_int_equal(snow_value_coder_make(&n.volume, &scale, &n.coder),
                     SNOW_STATUS_OK);
    return n;
}

static void numbers_free(numbers *n) {
    snow_value_coder_fini(n->context, &n->coder);
    snow_transfer_free(n->transfer);
    snow_context_free(n->context);
}

static int number_of(const numbers *n, int native) {
    int16_t out;
    int8_t small = (int8_t)native;
    int16_t large = (int16_t)native;
    bool narrow = snow_type_size(n->volume.info.type) == 1;
    snow_value_code_row(&n->coder, narrow ? (void *)&small : (void *)&large, 1,
                        &out);
    return out;
}

/* All stored values of a range, from the one that is V = 0 on. */
static void check_range(snow_type type, double slope, int bottom, int top) {
    numbers n = numbers_of(type, slope, bottom, top);
    const value_rule rule = value_rule_of(top - bottom);
    int before = 0, number = 0;
    for (int step = 0; step <= top - bottom; step++) {
        int native = slope < 0 ? top - step : bottom + step;
        number = number_of(&n, native);
        assert_int_equal(number, value_scale(step * rule.factor / rule.divisor,
                                             (int)rule.weight));
        assert_true(number >= before && number <= SNOW_VALUE_MOST);
        double unit =
            snow_value_of(&n.coder.scale, 1) - snow_value_of(&n.coder.scale, 0);
        assert_near(snow_value_of(&n.coder.scale, number), slope * native + 3,
                    1.01 * unit);
        before = number;
    }
    assert_true(number > SNOW_VALUE_MOST * 8 / 9);
    numbers_free(&n);
}

static void integers_become_numbers_by_the_rule(void **state) {
    (void)state;
    static const int ranges[] = {1,    2,    3,    100,   255,   1821,  2047,
                                 2048, 3272, 4095, 16384, 32767, 32768, 65535};
    for (size_t n = 0; n < sizeof ranges / sizeof *ranges; n++)
        for (int turned = 0; turned < 2; turned++) {
            double slope = turned ? -0.5 : 2;
            int r = ranges[n];
            check_range(SNOW_TYPE_UINT16, slope, 65535 - r, 65535);
            check_range(SNOW_TYPE_INT16, slope, -32768, r - 32768);
            if (r > 255)
                continue;
            check_range(SNOW_TYPE_UINT8, slope, 255 - r, 255);
            check_range(SNOW_TYPE_INT8, slope, -128, r - 128);
        }
}

static void stored_values_beyond_the_range_are_clamped(void **state) {
    (void)state;
    numbers n = numbers_of(SNOW_TYPE_INT16, 2, -1000, 3000);
    assert_int_equal(number_of(&n, -32768), 0);
    assert_int_equal(number_of(&n, 32767), number_of(&n, 3000));
    numbers_free(&n);
}

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
        cmocka_unit_test(integers_become_numbers_by_the_rule),
        cmocka_unit_test(the_range_of_integers_is_found),
        cmocka_unit_test(stored_values_beyond_the_range_are_clamped),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
