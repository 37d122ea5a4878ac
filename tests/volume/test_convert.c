/* tests/volume/test_convert.c - values in another scalar type: kept, rounded
 * with a word, spread over a range, or refused. */
#include "support/files.h"
#include "volume/volume.h"

#include <math.h>

static snow_volume *shared(support_files *place, snow_type type, int64_t count,
                           const void *voxels, double slope, double intercept) {
    snow_volume_info info = {.size = sizeof info,
                             .dims = {count, 1, 1},
                             .type = type,
                             .slope = slope,
                             .intercept = intercept};
    snow_volume *volume = NULL;
    assert_int_equal(snow_volume_wrap(place->context, &info, voxels, &volume),
                     SNOW_STATUS_OK);
    return volume;
}

/* Converts and closes the volume. */
static snow_volume *converted(support_files *place, snow_volume *volume,
                              snow_type type, const double range[2]) {
    snow_volume *out = NULL;
    place->warnings[0] = 0;
    if (snow_volume_convert(volume, type, range, &out) != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(place->context));
    snow_volume_close(volume);
    return out;
}

static void check(snow_volume *volume, snow_type type, const void *voxels,
                  size_t bytes) {
    const snow_volume_info *info = snow_volume_get_info(volume);
    assert_int_equal(info->type, type);
    assert_true(info->slope == 1 && info->intercept == 0);
    assert_memory_equal(snow_volume_voxels(volume), voxels, bytes);
    snow_volume_close(volume);
}

static void refused(support_files *place, snow_volume *volume, snow_type type,
                    const double range[2], const char *part) {
    snow_volume *out = NULL;
    assert_int_equal(snow_volume_convert(volume, type, range, &out),
                     SNOW_STATUS_BAD_USAGE);
    assert_null(out);
    if (!strstr(snow_context_message(place->context), part))
        fail_msg("\"%s\" lacks \"%s\"", snow_context_message(place->context),
                 part);
    snow_volume_close(volume);
}

static void values_that_fit_are_kept(void **state) {
    support_files *place = *state;
    static const int16_t from[] = {-128, 0, 127};
    static const int8_t to[] = {-128, 0, 127};
    static const double wide[] = {-128, 0, 127};
    check(converted(place, shared(place, SNOW_TYPE_INT16, 3, from, 1, 0),
                    SNOW_TYPE_INT8, NULL),
          SNOW_TYPE_INT8, to, sizeof to);
    check(converted(place, shared(place, SNOW_TYPE_INT8, 3, to, 1, 0),
                    SNOW_TYPE_FLOAT64, NULL),
          SNOW_TYPE_FLOAT64, wide, sizeof wide);
    assert_string_equal(place->warnings, "");
}

static void integers_of_64_bits_stay_whole(void **state) {
    support_files *place = *state;
    static const int64_t from[] = {INT64_MAX, INT64_MIN, (1LL << 53) + 1};
    check(converted(place, shared(place, SNOW_TYPE_INT64, 3, from, 1, 0),
                    SNOW_TYPE_INT64, NULL),
          SNOW_TYPE_INT64, from, sizeof from);
    snow_volume_close(
        converted(place, shared(place, SNOW_TYPE_INT64, 1, from + 2, 1, 0),
                  SNOW_TYPE_UINT64, NULL));
    assert_non_null(strstr(place->warnings, "1 values were rounded"));
    refused(place, shared(place, SNOW_TYPE_INT64, 3, from, 1, 0),
            SNOW_TYPE_INT32, NULL,
            "3 values such as 9.22337e+18 do not fit int32");
}

static void fractions_are_rounded_with_a_word(void **state) {
    support_files *place = *state;
    static const float from[] = {-1.25F, 0, 2.75F, 255.4F};
    static const int16_t to[] = {-1, 0, 3, 255};
    check(converted(place, shared(place, SNOW_TYPE_FLOAT32, 4, from, 1, 0),
                    SNOW_TYPE_INT16, NULL),
          SNOW_TYPE_INT16, to, sizeof to);
    assert_non_null(strstr(place->warnings, "3 values were rounded to int16"));
}

static void what_does_not_fit_is_refused(void **state) {
    support_files *place = *state;
    static const int16_t from[] = {-1, 5, 256};
    static const float holes[] = {1, NAN, INFINITY};
    static const double far[] = {1e39, 0};
    refused(place, shared(place, SNOW_TYPE_INT16, 3, from, 1, 0),
            SNOW_TYPE_UINT8, NULL,
            "2 values such as -1 do not fit uint8; convert to float32, or");
    refused(place, shared(place, SNOW_TYPE_FLOAT32, 3, holes, 1, 0),
            SNOW_TYPE_UINT8, NULL,
            "2 values such as nan do not fit uint8; convert to float32");
    refused(place, shared(place, SNOW_TYPE_FLOAT64, 2, far, 1, 0),
            SNOW_TYPE_FLOAT32, NULL,
            "1 values such as 1e+39 do not fit float32");
}

static void what_is_not_finite_stays_so_in_floats(void **state) {
    support_files *place = *state;
    static const double from[] = {NAN, INFINITY, -INFINITY, 0.1};
    snow_volume *volume =
        converted(place, shared(place, SNOW_TYPE_FLOAT64, 4, from, 1, 0),
                  SNOW_TYPE_FLOAT32, NULL);
    const float *to = snow_volume_voxels(volume);
    assert_true(isnan(to[0]) && to[1] > 0 && isinf(to[1]) && to[2] < 0 &&
                isinf(to[2]) && to[3] == 0.1F);
    assert_non_null(strstr(place->warnings, "1 values were rounded"));
    snow_volume_close(volume);
}

static void a_range_is_spread_over_the_type(void **state) {
    support_files *place = *state;
    static const int16_t from[] = {-500, 0, 60, 100, 3000};
    static const uint8_t bytes[] = {0, 0, 153, 255, 255};
    static const int8_t low[] = {-128, -128, 25, 127, 127};
    static const double range[] = {0, 100}, none[] = {5, 5};
    check(converted(place, shared(place, SNOW_TYPE_INT16, 5, from, 1, 0),
                    SNOW_TYPE_UINT8, range),
          SNOW_TYPE_UINT8, bytes, sizeof bytes);
    assert_non_null(
        strstr(place->warnings, "values 0 to 100 became 0 to 255 of uint8"));
    check(converted(place, shared(place, SNOW_TYPE_INT16, 5, from, 1, 0),
                    SNOW_TYPE_INT8, range),
          SNOW_TYPE_INT8, low, sizeof low);
    refused(place, shared(place, SNOW_TYPE_INT16, 5, from, 1, 0),
            SNOW_TYPE_UINT8, none, "invalid range 5 to 5");
    refused(place, shared(place, SNOW_TYPE_INT16, 5, from, 1, 0),
            SNOW_TYPE_FLOAT32, range, "only integers of 8, 16 and 32 bits");
    static const float holes[] = {NAN, 1};
    refused(place, shared(place, SNOW_TYPE_FLOAT32, 2, holes, 1, 0),
            SNOW_TYPE_UINT8, range, "nan do not fit uint8");
}

/* What a file says of its values is not of those that were spread. */
static void what_is_known_of_values_goes_with_them(void **state) {
    support_files *place = *state;
    static const int16_t from[] = {-1000, 0, 3000};
    static const double range[] = {-1000, 3000};
    for (int spread = 0; spread < 2; spread++) {
        snow_volume *volume = shared(place, SNOW_TYPE_INT16, 3, from, 1, 0);
        volume->info.hounsfield = true;
        volume->info.window[0] = -160;
        volume->info.window[1] = 240;
        snow_volume *out =
            converted(place, volume, SNOW_TYPE_INT32, spread ? range : NULL);
        assert_int_equal(out->info.hounsfield, !spread);
        assert_true(out->info.window[1] == (spread ? 0 : 240));
        snow_volume_close(out);
    }
}

static void a_scaling_goes_into_the_least_type_that_holds_it(void **state) {
    support_files *place = *state;
    static const uint8_t from[] = {0, 1, 200};
    static const int16_t shifted[] = {-1024, -1023, -824};
    static const float halves[] = {0, 0.5F, 100};
    static const double tenths[] = {0, 0.1, 0.1 * 200};
    static const uint8_t doubled[] = {0, 1, 200};
    check(converted(place, shared(place, SNOW_TYPE_UINT8, 3, from, 1, -1024), 0,
                    NULL),
          SNOW_TYPE_INT16, shifted, sizeof shifted);
    check(converted(place, shared(place, SNOW_TYPE_UINT8, 3, from, 0.5, 0), 0,
                    NULL),
          SNOW_TYPE_FLOAT32, halves, sizeof halves);
    check(converted(place, shared(place, SNOW_TYPE_UINT8, 3, from, 0.1, 0), 0,
                    NULL),
          SNOW_TYPE_FLOAT64, tenths, sizeof tenths);
    check(converted(place, shared(place, SNOW_TYPE_UINT8, 3, from, 1, 0), 0,
                    NULL),
          SNOW_TYPE_UINT8, doubled, sizeof doubled);
}

/* Rows 5 and slices 17 voxels apart, of 3x2x2. */
static void what_lies_apart_is_as_if_dense(void **state) {
    support_files *place = *state;
    static const int64_t pitch[2] = {5, 17};
    int16_t wide[34], dense[12];
    snow_volume_info info = {
        .size = sizeof info,
        .dims = {3, 2, 2},
        .type = SNOW_TYPE_INT16,
        .slope = 1,
        .matrix = {{1, 0, 0, 5}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
    snow_volume_info turned = info;
    turned.matrix[0][0] = -1;
    turned.matrix[0][3] = 7;
    snow_volume *apart, *grid, *out = NULL;
    for (int16_t n = 0; n < 34; n++)
        wide[n] = n;
    for (int n = 0; n < 12; n++)
        dense[n] = wide[n % 3 + n / 3 % 2 * 5 + n / 6 * 17];
    if (snow_volume_wrap(place->context, &info, wide, &apart) != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(place->context));
    assert_int_equal(snow_volume_wrap(place->context, &turned, dense, &grid),
                     SNOW_STATUS_OK);
    snow_volume_set_pitch(apart, pitch);
    assert_int_equal(snow_volume_convert(apart, SNOW_TYPE_NONE, NULL, &out),
                     SNOW_STATUS_OK);
    check(out, SNOW_TYPE_INT16, dense, sizeof dense);
    const char *path = support_path(place, "apart.npy");
    assert_int_equal(snow_volume_save(apart, path, false), SNOW_STATUS_OK);
    assert_int_equal(snow_volume_open(place->context, path, NULL, &out),
                     SNOW_STATUS_OK);
    check(out, SNOW_TYPE_INT16, dense, sizeof dense);
    assert_int_equal(snow_volume_regrid(&apart, grid, true), SNOW_STATUS_OK);
    const int16_t *voxels = snow_volume_voxels(apart);
    for (int n = 0; n < 12; n++)
        assert_int_equal(voxels[n], dense[n / 3 * 3 + 2 - n % 3]);
    snow_volume_close(apart);
    snow_volume_close(grid);
}

#define IN_A_PLACE(name)                                       \
    cmocka_unit_test_setup_teardown(name, support_files_setup, \
                                    support_files_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        IN_A_PLACE(values_that_fit_are_kept),
        IN_A_PLACE(integers_of_64_bits_stay_whole),
        IN_A_PLACE(fractions_are_rounded_with_a_word),
        IN_A_PLACE(what_does_not_fit_is_refused),
        IN_A_PLACE(what_is_not_finite_stays_so_in_floats),
        IN_A_PLACE(a_range_is_spread_over_the_type),
        IN_A_PLACE(what_is_known_of_values_goes_with_them),
        IN_A_PLACE(a_scaling_goes_into_the_least_type_that_holds_it),
        IN_A_PLACE(what_lies_apart_is_as_if_dense),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
