/* tests/transfer/test_transfer.c - control points, ranges, presets, colour
 * maps, and the look that the histogram suggests. */
#include "support/looks.h"

#include <float.h>
#include <math.h>

static const snow_color_point black[] = {{0, 0, 0, 0}};

static double opacity_at(const snow_transfer *transfer, double value) {
    double rgba[4];
    snow_transfer_evaluate(transfer, value, rgba);
    assert_true(rgba[3] == snow_transfer_opacity(transfer, value));
    return rgba[3];
}

static snow_transfer *opacities_only(snow_context *context,
                                     const snow_opacity_point *points,
                                     size_t count) {
    snow_transfer *transfer = NULL;
    if (snow_transfer_new(context, black, 1, points, count, &transfer) !=
        SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(context));
    return transfer;
}

static bool near(double a, double b) {
    return fabs(a - b) < 1e-12;
}

/* --- control points ------------------------------------------------------- */

static void values_between_points_are_interpolated(void **state) {
    (void)state;
    const snow_color_point colors[] = {{10, 0, 0.5, 1}, {20, 1, 0.5, 0}};
    const snow_opacity_point opacities[] = {{0, 0}, {40, 0.8}};
    snow_context *context = support_context();
    snow_transfer *transfer;
    double rgba[4];
    assert_int_equal(
        snow_transfer_new(context, colors, 2, opacities, 2, &transfer),
        SNOW_STATUS_OK);
    snow_transfer_evaluate(transfer, 15, rgba);
    assert_true(rgba[0] == 0.5 && rgba[1] == 0.5 && rgba[2] == 0.5);
    assert_true(near(rgba[3], 0.3));
    assert_false(snow_transfer_is_grey(transfer));
    snow_transfer_free(transfer);
    snow_context_free(context);
}

static void beyond_the_ends_all_is_constant(void **state) {
    (void)state;
    const snow_opacity_point points[] = {{10, 0.25}, {20, 0.75}};
    snow_context *context = support_context();
    snow_transfer *transfer = opacities_only(context, points, 2);
    assert_true(opacity_at(transfer, -1e300) == 0.25);
    assert_true(opacity_at(transfer, -INFINITY) == 0.25);
    assert_true(opacity_at(transfer, 10) == 0.25);
    assert_true(opacity_at(transfer, 20) == 0.75);
    assert_true(opacity_at(transfer, INFINITY) == 0.75);
    assert_true(snow_transfer_is_grey(transfer));
    snow_transfer_free(transfer);
    snow_context_free(context);
}

static void a_steps_value_belongs_to_the_later_point(void **state) {
    (void)state;
    const snow_opacity_point points[] = {{0, 0}, {5, 0}, {5, 1}, {9, 1}};
    const snow_color_point colors[] = {{5, 0, 0, 0}, {5, 1, 1, 1}};
    snow_context *context = support_context();
    snow_transfer *transfer;
    double rgba[4];
    assert_int_equal(
        snow_transfer_new(context, colors, 2, points, 4, &transfer),
        SNOW_STATUS_OK);
    assert_true(opacity_at(transfer, nextafter(5, 0)) == 0);
    assert_true(opacity_at(transfer, 5) == 1);
    snow_transfer_evaluate(transfer, 5, rgba);
    assert_true(rgba[0] == 1);
    snow_transfer_evaluate(transfer, 4.999, rgba);
    assert_true(rgba[0] == 0);
    snow_transfer_free(transfer);
    snow_context_free(context);
}

static void nan_is_transparent_and_black(void **state) {
    (void)state;
    const snow_opacity_point points[] = {{0, 1}};
    snow_context *context = support_context();
    snow_transfer *transfer = opacities_only(context, points, 1);
    double rgba[4] = {9, 9, 9, 9};
    snow_transfer_evaluate(transfer, NAN, rgba);
    for (int i = 0; i < 4; i++)
        assert_true(rgba[i] == 0);
    assert_true(opacity_at(transfer, 3) == 1);
    snow_transfer_free(transfer);
    snow_context_free(context);
}

static void points_as_far_apart_as_doubles_go_do_not_overflow(void **state) {
    (void)state;
    const snow_opacity_point points[] = {{-DBL_MAX, 0}, {DBL_MAX, 1}};
    snow_context *context = support_context();
    snow_transfer *transfer = opacities_only(context, points, 2);
    assert_true(near(opacity_at(transfer, 0), 0.5));
    assert_true(near(opacity_at(transfer, DBL_MAX / 2), 0.75));
    snow_transfer_free(transfer);
    snow_context_free(context);
}

static void bad_points_are_refused(void **state) {
    (void)state;
    static const snow_opacity_point falling[] = {{5, 0}, {4, 1}};
    static const snow_opacity_point beyond[] = {{5, 1.5}};
    static const snow_opacity_point endless[] = {{INFINITY, 1}};
    static const snow_opacity_point unknown[] = {{5, NAN}};
    static const snow_opacity_point good[] = {{5, 1}};
    static const snow_color_point bright[] = {{5, 2, 0, 0}};
    static const snow_color_point backwards[] = {{5, 0, 0, 0}, {4, 0, 0, 0}};
    snow_context *context = support_context();
    snow_transfer *transfer = NULL;
#define REFUSED(colors, n, opacities, m, text)                          \
    assert_int_equal(                                                   \
        snow_transfer_new(context, colors, n, opacities, m, &transfer), \
        SNOW_STATUS_BAD_USAGE);                                         \
    assert_non_null(strstr(snow_context_message(context), text))
    REFUSED(black, 1, falling, 2, "point 2 at 4 comes after 5");
    REFUSED(black, 1, beyond, 1, "1.5");
    REFUSED(black, 1, endless, 1, "inf");
    REFUSED(black, 1, unknown, 1, "nan");
    REFUSED(black, 1, good, 0, "at least one");
    REFUSED(black, 0, good, 1, "at least one");
    REFUSED(bright, 1, good, 1, "colour point 1");
    REFUSED(backwards, 2, good, 1, "colour point 2");
#undef REFUSED
    assert_null(transfer);
    snow_context_free(context);
}

/* --- gradient opacity ----------------------------------------------------- */

static void a_gradient_opacity_is_a_curve_of_its_own(void **state) {
    (void)state;
    const snow_opacity_point points[] = {{0, 0.5}};
    const snow_opacity_point curve[] = {{2, 0}, {4, 0.5}, {4, 0.75}, {9, 1}};
    snow_context *context = support_context();
    snow_transfer *transfer = opacities_only(context, points, 1);
    assert_true(snow_transfer_evaluate_gradient(transfer, 0) == 1);
    assert_null(strstr(snow_transfer_description(transfer), "gradient"));
    assert_int_equal(snow_transfer_set_gradient_opacity(transfer, curve, 4),
                     SNOW_STATUS_OK);
    assert_true(snow_transfer_evaluate_gradient(transfer, 0) == 0);
    assert_true(near(snow_transfer_evaluate_gradient(transfer, 3), 0.25));
    assert_true(snow_transfer_evaluate_gradient(transfer, 4) == 0.75);
    assert_true(snow_transfer_evaluate_gradient(transfer, INFINITY) == 1);
    assert_true(snow_transfer_evaluate_gradient(transfer, NAN) == 1);
    assert_true(opacity_at(transfer, 3) == 0.5); /* that of the value alone */
    assert_non_null(strstr(snow_transfer_description(transfer),
                           "; gradient opacity 0 at 2, 0.5 at 4, 0.75 at 4, 1 "
                           "at 9"));
    snow_transfer_free(transfer);
    snow_context_free(context);
}

static void a_gradient_opacity_is_taken_away_by_none_and_by_ones(void **state) {
    (void)state;
    const snow_opacity_point points[] = {{0, 0.5}};
    const snow_opacity_point curve[] = {{2, 0}, {4, 1}};
    const snow_opacity_point ones[] = {{0, 1}, {255, 1}};
    snow_context *context = support_context();
    snow_transfer *transfer = opacities_only(context, points, 1);
    char before[SNOW_TRANSFER_TEXT_BYTES];
    snprintf(before, sizeof before, "%s", snow_transfer_description(transfer));
    for (size_t count = 0; count <= 2; count += 2) {
        assert_int_equal(snow_transfer_set_gradient_opacity(transfer, curve, 2),
                         SNOW_STATUS_OK);
        assert_int_equal(
            snow_transfer_set_gradient_opacity(transfer, ones, count),
            SNOW_STATUS_OK);
        assert_true(snow_transfer_evaluate_gradient(transfer, 2) == 1);
        assert_int_equal(transfer->gradient_count, 0);
        assert_string_equal(snow_transfer_description(transfer), before);
    }
    snow_transfer_free(transfer);
    snow_context_free(context);
}

static void a_bad_gradient_opacity_changes_nothing(void **state) {
    (void)state;
    const snow_opacity_point points[] = {{0, 0.5}};
    const snow_opacity_point curve[] = {{2, 0}, {4, 1}};
    const snow_opacity_point falling[] = {{5, 0}, {4, 1}};
    const snow_opacity_point beyond[] = {{5, 1.5}};
    snow_context *context = support_context();
    snow_transfer *transfer = opacities_only(context, points, 1);
    assert_int_equal(snow_transfer_set_gradient_opacity(transfer, curve, 2),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_transfer_set_gradient_opacity(transfer, falling, 2),
                     SNOW_STATUS_BAD_USAGE);
    assert_non_null(strstr(snow_context_message(context),
                           "gradient opacity point 2 at 4 comes after 5"));
    assert_int_equal(snow_transfer_set_gradient_opacity(transfer, beyond, 1),
                     SNOW_STATUS_BAD_USAGE);
    assert_non_null(strstr(snow_context_message(context), "1.5"));
    assert_true(near(snow_transfer_evaluate_gradient(transfer, 3), 0.5));
    snow_transfer_free(transfer);
    snow_context_free(context);
}

static void a_look_has_a_gradient_opacity(void **state) {
    (void)state;
    const uint8_t bytes[] = {0, 7, 200};
    const snow_opacity_point curve[] = {{2, 0}, {4, 1}};
    snow_opacity_point many[256];
    for (int i = 0; i < 256; i++)
        many[i] = (snow_opacity_point){-1.23456e-100 / (i + 1), 0.12345};
    snow_context *context = support_context();
    snow_volume *volume = support_row(context, SNOW_TYPE_UINT8, bytes, 3);
    snow_look look = {.size = sizeof look,
                      .preset = "linear",
                      .gradient_opacities = curve,
                      .gradient_opacity_count = 2};
    snow_transfer *transfer = support_look(volume, look), *none = NULL;
    assert_true(near(snow_transfer_evaluate_gradient(transfer, 3), 0.5));
    assert_non_null(strstr(snow_transfer_description(transfer),
                           "); gradient opacity 0 at 2, 1 at 4"));
    snow_transfer_free(transfer);
    look.gradient_opacities = look.opacities = many;
    look.gradient_opacity_count = look.opacity_count = 256;
    transfer = support_look(volume, look); /* more than there is room to tell */
    assert_non_null(strstr(snow_transfer_description(transfer), ", ... ("));
    assert_non_null(
        strstr(snow_transfer_description(transfer), "; gradient opacity"));
    snow_transfer_free(transfer);
    look.gradient_opacity_count = 0;
    assert_int_equal(snow_transfer_new_for_volume(volume, &look, &none),
                     SNOW_STATUS_BAD_USAGE);
    assert_non_null(
        strstr(snow_context_message(context), "0 gradient opacities"));
    snow_volume_close(volume);
    snow_context_free(context);
}

/* --- ranges --------------------------------------------------------------- */

static void linear_on_8_bits_is_the_value_itself(void **state) {
    (void)state;
    uint8_t bytes[256];
    for (int i = 0; i < 256; i++)
        bytes[i] = (uint8_t)i;
    snow_context *context = support_context();
    snow_volume *volume = support_row(context, SNOW_TYPE_UINT8, bytes, 256);
    snow_transfer *transfer = support_look(
        volume, (snow_look){.size = sizeof(snow_look), .preset = "linear"});
    for (int i = 0; i < 256; i++) {
        double rgba[4];
        snow_transfer_evaluate(transfer, i, rgba);
        assert_true(rgba[3] == i / 255.0);
        assert_true(rgba[0] == i / 255.0);
    }
    assert_true(snow_transfer_is_grey(transfer));
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
}

static void table_1_of_the_real_engine_comes_out(void **state) {
    (void)state;
    const char *path = support_data("classic/engine_256x256x110_u8.raw.gz");
    if (!path)
        skip();
    static const double thresholds[] = {0, 10, 30},
                        wanted[] = {27.9, 77.5, 81.7};
    snow_context *context = support_context();
    const snow_volume_options options = {.size = sizeof options,
                                         .dims = {256, 256, 110},
                                         .type = SNOW_TYPE_UINT8};
    snow_volume *volume;
    assert_int_equal(snow_volume_open(context, path, &options, &volume),
                     SNOW_STATUS_OK);
    snow_transfer *transfer = support_look(
        volume, (snow_look){.size = sizeof(snow_look), .preset = "linear"});
    for (int i = 0; i < 3; i++) {
        double found = -1;
        assert_int_equal(
            snow_transfer_sparse_ratio(transfer, volume, thresholds[i], &found),
            SNOW_STATUS_OK);
        assert_true(fabs(100 * found - wanted[i]) < 0.05);
    }
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
}

static void a_range_of_values_spreads_any_look(void **state) {
    (void)state;
    const int16_t values[] = {-1000, 0, 100, 3000};
    snow_context *context = support_context();
    snow_volume *volume = support_row(context, SNOW_TYPE_INT16, values, 4);
    snow_look look = {.size = sizeof look,
                      .preset = "linear",
                      .range = SNOW_RANGE_VALUES,
                      .low = 20,
                      .high = 60};
    snow_transfer *linear = support_look(volume, look);
    assert_true(opacity_at(linear, 20) == 0 && opacity_at(linear, 60) == 1);
    assert_true(near(opacity_at(linear, 30), 0.25));
    look.preset = "ct-bone"; /* its own span is 150 to 1500 */
    snow_transfer *bone = support_look(volume, look);
    assert_true(opacity_at(bone, 20) == 0);
    assert_true(near(opacity_at(bone, 60), 0.85));
    look.preset = NULL;
    snow_transfer *automatic = support_look(volume, look);
    assert_true(opacity_at(automatic, 20) == 0);
    assert_true(near(opacity_at(automatic, 60), 0.8));
    snow_transfer_free(linear);
    snow_transfer_free(bone);
    snow_transfer_free(automatic);
    snow_volume_close(volume);
    snow_context_free(context);
}

static void percentiles_are_of_finite_values(void **state) {
    (void)state;
    float values[204];
    for (int i = 0; i < 200; i++)
        values[i] = (float)((i * 37) % 200 + 1); /* 1 to 200, mixed */
    values[200] = NAN, values[201] = INFINITY, values[202] = -INFINITY;
    values[203] = NAN;
    snow_context *context = support_context();
    snow_volume *volume = support_row(context, SNOW_TYPE_FLOAT32, values, 204);
    snow_transfer *transfer =
        support_look(volume, (snow_look){.size = sizeof(snow_look),
                                         .preset = "linear",
                                         .range = SNOW_RANGE_PERCENTILES,
                                         .low = 10,
                                         .high = 90});
    /* 10 % of 200 values are at most 20. */
    assert_true(opacity_at(transfer, 20) == 0);
    assert_true(opacity_at(transfer, 21) > 0);
    assert_true(opacity_at(transfer, 180) == 1);
    assert_true(opacity_at(transfer, 179) < 1);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
}

static int ascending(const void *a, const void *b) {
    double p = *(const double *)a, q = *(const double *)b;
    return (p > q) - (p < q);
}

static void quantiles_are_those_of_sorted_values(void **state) {
    (void)state;
    enum { N = 3001 };
    static double values[N], sorted[N];
    uint64_t random = 7;
    for (int i = 0; i < N; i++) {
        double magnitude = pow(10, 80 * support_uniform(&random) - 40);
        values[i] = support_uniform(&random) < 0.4 ? -magnitude : magnitude;
    }
    memcpy(sorted, values, sizeof values);
    qsort(sorted, N, sizeof *sorted, ascending);
    snow_context *context = support_context();
    snow_volume *volume = support_row(context, SNOW_TYPE_FLOAT64, values, N);
    const double shares[4] = {0, 0.01, 0.5, 1};
    double found[4];
    snow_histogram census;
    assert_int_equal(snow_histogram_new(volume, NULL, (snow_scale){0},
                                        SNOW_NEED_COUNTS, &census),
                     SNOW_STATUS_OK);
    assert_int_equal(
        snow_quantiles(&census, SNOW_HISTOGRAM_EXACT, shares, 4, found),
        SNOW_STATUS_OK);
    snow_histogram_free(&census);
    assert_true(found[0] == sorted[0]);
    assert_true(found[1] == sorted[30]); /* the 31st: 0.01 * 3001 rounded up */
    assert_true(found[2] == sorted[1500]);
    assert_true(found[3] == sorted[N - 1]);
    snow_volume_close(volume);
    snow_context_free(context);
}

/* 8 and 16 bit values are counted, others searched for: one answer. */
static void all_types_give_one_look(void **state) {
    (void)state;
    enum { N = 5000 };
    static int16_t shorts[N];
    static float floats[N];
    uint64_t random = 11;
    for (int i = 0; i < N; i++) {
        double u = support_uniform(&random);
        shorts[i] = (int16_t)(u < 0.7 ? -900 + 100 * u : 3000 * u * u * u);
        floats[i] = shorts[i];
    }
    snow_context *context = support_context();
    snow_volume_info info = {
        .size = sizeof info, .dims = {N, 1, 1}, .slope = -2, .intercept = 50};
    for (int range = SNOW_RANGE_AUTO; range <= SNOW_RANGE_PERCENTILES;
         range++) {
        const snow_look look = {.size = sizeof look,
                                .range = (snow_range)range,
                                .low = 3,
                                .high = 97};
        snow_volume *a, *b;
        info.type = SNOW_TYPE_INT16;
        assert_int_equal(snow_volume_wrap(context, &info, shorts, &a),
                         SNOW_STATUS_OK);
        info.type = SNOW_TYPE_FLOAT32;
        assert_int_equal(snow_volume_wrap(context, &info, floats, &b),
                         SNOW_STATUS_OK);
        snow_transfer *p = support_look(a, look), *q = support_look(b, look);
        assert_string_equal(snow_transfer_description(p),
                            snow_transfer_description(q));
        snow_transfer_free(p);
        snow_transfer_free(q);
        snow_volume_close(a);
        snow_volume_close(b);
    }
    snow_context_free(context);
}

static void the_full_range_is_from_smallest_to_largest(void **state) {
    (void)state;
    const float values[] = {NAN, -3, 5, 1, INFINITY};
    snow_context *context = support_context();
    snow_volume *volume = support_row(context, SNOW_TYPE_FLOAT32, values, 5);
    snow_transfer *transfer =
        support_look(volume, (snow_look){.size = sizeof(snow_look),
                                         .preset = "linear",
                                         .range = SNOW_RANGE_FULL});
    assert_true(opacity_at(transfer, -3) == 0);
    assert_true(near(opacity_at(transfer, 1), 0.5));
    assert_true(opacity_at(transfer, 5) == 1);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
}

static void slope_and_intercept_count(void **state) {
    (void)state;
    const uint8_t bytes[] = {0, 1, 2, 3, 4};
    const snow_volume_info info = {.size = sizeof info,
                                   .dims = {5, 1, 1},
                                   .type = SNOW_TYPE_UINT8,
                                   .slope = -10,
                                   .intercept = 100};
    snow_context *context = support_context();
    snow_volume *volume;
    assert_int_equal(snow_volume_wrap(context, &info, bytes, &volume),
                     SNOW_STATUS_OK);
    snow_transfer *transfer = support_look(
        volume, (snow_look){.size = sizeof(snow_look), .preset = "linear"});
    assert_true(opacity_at(transfer, 60) == 0);
    assert_true(opacity_at(transfer, 100) == 1);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
}

/* --- presets, colour maps, opacities -------------------------------------- */

static void presets_and_maps_are_listed_and_all_work(void **state) {
    (void)state;
    const int16_t values[] = {-1000, -50, 40, 300, 1200, 40, 40, -1000};
    static const char *const presets[] = {"linear", "ct-aaa", "ct-aaa2",
                                          "ct-bone"};
    static const char *const maps[] = {"grey", "viridis", "inferno",
                                       "cool-warm", "turbo"};
    snow_context *context = support_context();
    snow_volume *volume = support_row(context, SNOW_TYPE_INT16, values, 8);
    for (size_t i = 0; i < 4; i++)
        assert_string_equal(snow_preset_name(i), presets[i]);
    for (size_t i = 0; i < 5; i++)
        assert_string_equal(snow_colormap_name(i), maps[i]);
    size_t count = 0;
    for (; snow_preset_name(count); count++) {
        assert_non_null(snow_preset_description(count));
        snow_transfer_free(support_look(
            volume, (snow_look){.size = sizeof(snow_look),
                                .preset = snow_preset_name(count)}));
    }
    assert_null(snow_preset_description(count));
    for (size_t i = 0; snow_colormap_name(i); i++)
        snow_transfer_free(support_look(
            volume, (snow_look){.size = sizeof(snow_look),
                                .colormap = snow_colormap_name(i)}));
    snow_volume_close(volume);
    snow_context_free(context);
}

static void ct_presets_keep_their_hounsfield_values(void **state) {
    (void)state;
    const int16_t values[] = {-1000, 40, 900};
    snow_context *context = support_context();
    snow_volume *volume = support_row(context, SNOW_TYPE_INT16, values, 3);
    snow_transfer *bone = support_look(
        volume, (snow_look){.size = sizeof(snow_look), .preset = "ct-bone"});
    assert_true(opacity_at(bone, 60) == 0); /* muscle */
    assert_true(opacity_at(bone, 700) > 0.4);
    snow_transfer *soft = support_look(
        volume, (snow_look){.size = sizeof(snow_look), .preset = "ct-soft"});
    assert_true(opacity_at(soft, -900) == 0); /* lung and air */
    assert_true(opacity_at(soft, 40) > 0.1);
    assert_false(snow_transfer_is_grey(bone));
    snow_transfer_free(bone);
    snow_transfer_free(soft);
    snow_volume_close(volume);
    snow_context_free(context);
}

static void count_warning(void *user, const char *text) {
    assert_non_null(strstr(text, "Hounsfield"));
    ++*(int *)user;
}

static void ct_presets_warn_of_values_with_an_offset(void **state) {
    (void)state;
    const uint16_t values[] = {0, 1040, 1900};
    snow_context *context = support_context();
    int warnings = 0;
    snow_context_set_warning(context, count_warning, &warnings);
    snow_volume *volume = support_row(context, SNOW_TYPE_UINT16, values, 3);
    snow_transfer_free(support_look(
        volume, (snow_look){.size = sizeof(snow_look), .preset = "ct-soft"}));
    assert_int_equal(warnings, 1);
    snow_transfer_free(
        support_look(volume, (snow_look){.size = sizeof(snow_look),
                                         .preset = "ct-soft",
                                         .range = SNOW_RANGE_VALUES,
                                         .low = 674,
                                         .high = 1524}));
    assert_int_equal(warnings, 1);
    snow_volume_close(volume);
    snow_context_free(context);
}

static void unknown_names_are_refused_with_a_list(void **state) {
    (void)state;
    const uint8_t bytes[] = {0, 255};
    snow_context *context = support_context();
    snow_volume *volume = support_row(context, SNOW_TYPE_UINT8, bytes, 2);
    snow_transfer *transfer = NULL;
    const snow_look preset = {.size = sizeof preset, .preset = "ct-foot"};
    const snow_look map = {.size = sizeof map, .colormap = "jet"};
    assert_int_equal(snow_transfer_new_for_volume(volume, &preset, &transfer),
                     SNOW_STATUS_BAD_USAGE);
    const char *message = snow_context_message(context);
    assert_non_null(strstr(message, "ct-foot"));
    for (size_t i = 0; snow_preset_name(i); i++)
        assert_non_null(strstr(message, snow_preset_name(i)));
    assert_int_equal(snow_transfer_new_for_volume(volume, &map, &transfer),
                     SNOW_STATUS_BAD_USAGE);
    for (size_t i = 0; snow_colormap_name(i); i++)
        assert_non_null(strstr(message, snow_colormap_name(i)));
    assert_null(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
}

static void empty_ranges_are_refused(void **state) {
    (void)state;
    static const snow_look looks[] = {
        {.size = sizeof(snow_look),
         .range = SNOW_RANGE_VALUES,
         .low = 5,
         .high = 5},
        {.size = sizeof(snow_look),
         .range = SNOW_RANGE_VALUES,
         .low = 6,
         .high = 5},
        {.size = sizeof(snow_look),
         .range = SNOW_RANGE_VALUES,
         .low = NAN,
         .high = 5},
        {.size = sizeof(snow_look),
         .range = SNOW_RANGE_VALUES,
         .low = 0,
         .high = INFINITY},
        {.size = sizeof(snow_look),
         .range = SNOW_RANGE_PERCENTILES,
         .low = -1,
         .high = 50},
        {.size = sizeof(snow_look),
         .range = SNOW_RANGE_PERCENTILES,
         .low = 1,
         .high = 101},
    };
    const uint8_t bytes[] = {0, 255};
    snow_context *context = support_context();
    snow_volume *volume = support_row(context, SNOW_TYPE_UINT8, bytes, 2);
    snow_transfer *transfer = NULL;
    for (size_t i = 0; i < sizeof looks / sizeof *looks; i++)
        assert_int_equal(
            snow_transfer_new_for_volume(volume, &looks[i], &transfer),
            SNOW_STATUS_BAD_USAGE);
    assert_null(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
}

static void a_colour_map_replaces_the_colours_only(void **state) {
    (void)state;
    const uint8_t bytes[] = {0, 255};
    snow_context *context = support_context();
    snow_volume *volume = support_row(context, SNOW_TYPE_UINT8, bytes, 2);
    snow_transfer *transfer =
        support_look(volume, (snow_look){.size = sizeof(snow_look),
                                         .preset = "linear",
                                         .colormap = "inferno"});
    double rgba[4];
    snow_transfer_evaluate(transfer, 255, rgba);
    assert_true(fabs(rgba[0] - 0.988362) < 1 / 255.0);
    assert_true(fabs(rgba[2] - 0.644924) < 1 / 255.0);
    assert_true(opacity_at(transfer, 51) == 0.2);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
}

static void given_opacities_replace_the_presets(void **state) {
    (void)state;
    const uint8_t bytes[] = {0, 255};
    const snow_opacity_point points[] = {{100, 0}, {100, 0.5}};
    const snow_opacity_point falling[] = {{100, 0}, {50, 0.5}};
    snow_context *context = support_context();
    snow_volume *volume = support_row(context, SNOW_TYPE_UINT8, bytes, 2);
    snow_look look = {.size = sizeof look,
                      .preset = "linear",
                      .opacities = points,
                      .opacity_count = 2};
    snow_transfer *transfer = support_look(volume, look);
    assert_true(opacity_at(transfer, 99) == 0);
    assert_true(opacity_at(transfer, 100) == 0.5);
    snow_transfer_free(transfer);
    look.opacities = falling;
    transfer = NULL;
    assert_int_equal(snow_transfer_new_for_volume(volume, &look, &transfer),
                     SNOW_STATUS_BAD_USAGE);
    assert_null(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
}

/* Entries of the published tables (of 256; cool-warm by its formula), at 0,
 * 64, 128, 192 and 255 of 255. */
static void colour_maps_are_the_published_ones(void **state) {
    (void)state;
    static const struct {
        const char *name;
        double rgb[5][3];
    } tables[] = {
        {"viridis",
         {{0.2670, 0.0049, 0.3294},
          {0.2297, 0.3224, 0.5457},
          {0.1276, 0.5669, 0.5506},
          {0.3692, 0.7889, 0.3829},
          {0.9932, 0.9062, 0.1439}}},
        {"inferno",
         {{0.0015, 0.0005, 0.0139},
          {0.3415, 0.0623, 0.4294},
          {0.7357, 0.2159, 0.3302},
          {0.9784, 0.5579, 0.0349},
          {0.9884, 0.9984, 0.6449}}},
        {"magma",
         {{0.0015, 0.0005, 0.0139},
          {0.3167, 0.0717, 0.4854},
          {0.7164, 0.2150, 0.4753},
          {0.9867, 0.5356, 0.3822},
          {0.9871, 0.9914, 0.7495}}},
        {"plasma",
         {{0.0504, 0.0298, 0.5280},
          {0.4949, 0.0120, 0.6579},
          {0.7982, 0.2802, 0.4695},
          {0.9734, 0.5858, 0.2515},
          {0.9400, 0.9752, 0.1313}}},
        {"cividis",
         {{0.0000, 0.1351, 0.3048},
          {0.2637, 0.3078, 0.4228},
          {0.4887, 0.4853, 0.4710},
          {0.7365, 0.6806, 0.4240},
          {0.9957, 0.9093, 0.2178}}},
        {"turbo",
         {{0.1900, 0.0718, 0.2322},
          {0.1584, 0.7355, 0.9231},
          {0.6436, 0.9900, 0.2336},
          {0.9836, 0.4929, 0.1285},
          {0.4796, 0.0158, 0.0106}}},
        {"cool-warm",
         {{0.2314, 0.2980, 0.7529},
          {0.5548, 0.6899, 0.9954},
          {0.8676, 0.8645, 0.8626},
          {0.9573, 0.5984, 0.4771},
          {0.7059, 0.0157, 0.1490}}},
    };
    static const int entries[5] = {0, 64, 128, 192, 255};
    const uint8_t bytes[] = {0, 255};
    snow_context *context = support_context();
    snow_volume *volume = support_row(context, SNOW_TYPE_UINT8, bytes, 2);
    for (size_t n = 0; n < sizeof tables / sizeof *tables; n++) {
        snow_transfer *transfer =
            support_look(volume, (snow_look){.size = sizeof(snow_look),
                                             .preset = "linear",
                                             .colormap = tables[n].name});
        for (int i = 0; i < 5; i++) {
            double rgba[4];
            snow_transfer_evaluate(transfer, entries[i], rgba);
            for (int c = 0; c < 3; c++)
                if (fabs(rgba[c] - tables[n].rgb[i][c]) > 1 / 255.0)
                    fail_msg("%s at %d: channel %d is %g", tables[n].name,
                             entries[i], c, rgba[c]);
        }
        snow_transfer_free(transfer);
    }
    snow_volume_close(volume);
    snow_context_free(context);
}

static void gray_is_grey(void **state) {
    (void)state;
    assert_int_equal(snow_colormap_from_name("gray"),
                     snow_colormap_from_name("grey"));
    assert_true(snow_colormap_from_name("grey") >= 0);
}

static void names_are_free_in_case_and_dashes(void **state) {
    (void)state;
    for (size_t i = 0; snow_colormap_name(i); i++)
        assert_int_equal(snow_colormap_from_name(snow_colormap_name(i)), i);
    for (size_t i = 0; snow_preset_name(i); i++)
        assert_int_equal(snow_preset_from_name(snow_preset_name(i)), i);
    assert_int_equal(snow_colormap_from_name("CoolWarm"),
                     snow_colormap_from_name("cool-warm"));
    assert_int_equal(snow_preset_from_name("CT_Bone"),
                     snow_preset_from_name("ct-bone"));
    assert_int_equal(snow_preset_from_name("ctbone"),
                     snow_preset_from_name("ct-bone"));
    assert_int_equal(snow_preset_from_name("ct-bon"), -1);
    assert_int_equal(snow_preset_from_name("ct-boness"), -1);
    /* As users of other viewers write them. */
    static const char *const known[] = {"CT-AAA",
                                        "CT-AAA2",
                                        "CT-Bone",
                                        "CT-Bones",
                                        "CT-Cardiac",
                                        "CT-Cardiac2",
                                        "CT-Cardiac3",
                                        "CT-Chest-Contrast-Enhanced",
                                        "CT-Chest-Vessels",
                                        "CT-Coronary-Arteries",
                                        "CT-Coronary-Arteries-2",
                                        "CT-Coronary-Arteries-3",
                                        "CT-Cropped-Volume-Bone",
                                        "CT-Fat",
                                        "CT-Liver-Vasculature",
                                        "CT-Lung",
                                        "CT-MIP",
                                        "CT-Muscle",
                                        "CT-Pulmonary-Arteries",
                                        "CT-Soft-Tissue",
                                        "MR-Angio",
                                        "MR-Default",
                                        "MR-MIP",
                                        "MR-T2-Brain",
                                        "DTI-FA-Brain"};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        assert_true(snow_preset_from_name(known[i]) >= 0);
    assert_int_equal(snow_preset_from_name("ct bone"), -1);
    assert_int_equal(snow_colormap_from_name(""), -1);
    assert_int_equal(snow_colormap_from_name("-grey"), -1);
}

static void a_view_keeps_its_sign(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_view a = {.size = sizeof a}, b = {.size = sizeof b};
    assert_int_equal(snow_view_from_name(context, "Anterior", &a),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_view_from_name(context, "+y", &b), SNOW_STATUS_OK);
    assert_memory_equal(a.back, b.back, sizeof a.back);
    assert_int_equal(snow_view_from_name(context, "-X", &a), SNOW_STATUS_OK);
    assert_true(a.back[0] < 0);
    assert_int_equal(snow_view_from_name(context, "x", &a),
                     SNOW_STATUS_BAD_USAGE);
    snow_context_free(context);
}

/* --- the automatic look --------------------------------------------------- */

/* n values around `middle`, give or take `spread`. */
static void scatter(float *values, int n, double middle, double spread,
                    uint64_t *random) {
    for (int i = 0; i < n; i++)
        values[i] =
            (float)(middle + spread * (2 * support_uniform(random) - 1));
}

static void background_is_transparent_and_the_object_is_not(void **state) {
    (void)state;
    enum { AIR = 6000, TISSUE = 3000, BONE = 500 };
    static float values[AIR + TISSUE + BONE];
    uint64_t random = 3;
    scatter(values, AIR, 30, 20, &random);
    scatter(values + AIR, TISSUE, 1000, 60, &random);
    scatter(values + AIR + TISSUE, BONE, 2000, 200, &random);
    snow_context *context = support_context();
    snow_volume *volume =
        support_row(context, SNOW_TYPE_FLOAT32, values, AIR + TISSUE + BONE);
    snow_transfer *transfer =
        support_look(volume, (snow_look){.size = sizeof(snow_look)});
    assert_true(opacity_at(transfer, 50) == 0);
    assert_true(opacity_at(transfer, 950) >= 0.2);
    assert_true(opacity_at(transfer, 2000) > opacity_at(transfer, 1000));
    assert_true(snow_transfer_is_grey(transfer));
    assert_non_null(
        strstr(snow_transfer_description(transfer), "from the histogram"));
    assert_null(strchr(snow_transfer_description(transfer), '\n'));
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
}

static void sparse_vessels_are_found_in_an_empty_volume(void **state) {
    (void)state;
    enum { ALL = 100000, VESSEL = 1000 };
    static float values[ALL];
    uint64_t random = 5;
    memset(values, 0, sizeof values);
    scatter(values, VESSEL, 150, 100, &random);
    snow_context *context = support_context();
    snow_volume *volume = support_row(context, SNOW_TYPE_FLOAT32, values, ALL);
    snow_transfer *transfer =
        support_look(volume, (snow_look){.size = sizeof(snow_look)});
    assert_true(opacity_at(transfer, 0) == 0);
    assert_true(opacity_at(transfer, 180) > 0.3);
    /* Their brightest half is not cut off. */
    assert_true(opacity_at(transfer, 180) < 0.6);
    assert_true(opacity_at(transfer, 249) > 0.75);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
}

static void a_few_wild_values_do_not_blank_the_picture(void **state) {
    (void)state;
    enum { ALL = 10000 };
    static float values[ALL];
    uint64_t random = 9;
    scatter(values, ALL / 2, 10, 5, &random);
    scatter(values + ALL / 2, ALL / 2, 100, 20, &random);
    for (int i = 0; i < 20; i++)
        values[i * 400] = i % 2 ? 3e38F : NAN;
    snow_context *context = support_context();
    snow_volume *volume = support_row(context, SNOW_TYPE_FLOAT32, values, ALL);
    snow_transfer *transfer =
        support_look(volume, (snow_look){.size = sizeof(snow_look)});
    assert_true(opacity_at(transfer, 12) == 0);
    assert_true(opacity_at(transfer, 110) > 0.2);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
}

static void a_mask_of_0_and_1_shows_its_ones(void **state) {
    (void)state;
    const uint8_t bytes[] = {0, 0, 0, 1, 1, 0, 0, 0};
    snow_context *context = support_context();
    snow_volume *volume = support_row(context, SNOW_TYPE_UINT8, bytes, 8);
    snow_transfer *transfer =
        support_look(volume, (snow_look){.size = sizeof(snow_look)});
    assert_true(opacity_at(transfer, 0) == 0);
    assert_true(opacity_at(transfer, 1) > 0.3);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
}

/* Every preset, map and range on values that leave nothing to part. */
static void check_all_looks(snow_type type, const void *values, int64_t n) {
    snow_context *context = support_context();
    snow_volume *volume = support_row(context, type, values, n);
    for (int range = SNOW_RANGE_AUTO; range <= SNOW_RANGE_PERCENTILES; range++)
        for (size_t p = 0; p == 0 || snow_preset_name(p - 1); p++) {
            snow_look look = {.size = sizeof look,
                              .preset = p ? snow_preset_name(p - 1) : NULL,
                              .range = (snow_range)range,
                              .low = 1,
                              .high = 99,
                              .colormap = "turbo"};
            if (p && !strcmp(look.preset, "labels")) /* has no range */
                continue;
            snow_transfer *transfer = support_look(volume, look);
            for (int64_t i = 0; i < n; i++) {
                double rgba[4];
                snow_transfer_evaluate(transfer, snow_volume_native(volume, i),
                                       rgba);
                for (int c = 0; c < 4; c++)
                    assert_true(rgba[c] >= 0 && rgba[c] <= 1);
            }
            snow_transfer_free(transfer);
        }
    snow_volume_close(volume);
    assert_true(snow_context_bytes(context) == 0);
    snow_context_free(context);
}

static void odd_volumes_have_a_look_too(void **state) {
    (void)state;
    const float nans[] = {NAN, NAN}, infinite[] = {INFINITY, -INFINITY};
    const double wide[] = {-DBL_MAX, 0, DBL_MAX}, one[] = {DBL_MAX};
    const double tiny[] = {0, 4.9e-324, 1e-323};
    const int64_t whole[] = {INT64_MIN, -1, INT64_MAX};
    const int64_t close[] = {INT64_MAX - 4096, INT64_MAX - 2048, INT64_MAX};
    const uint64_t large[] = {0, UINT64_MAX};
    const uint8_t zero[] = {0}, constant[] = {7, 7, 7};
    const int8_t negative[] = {-5, -5};
    check_all_looks(SNOW_TYPE_FLOAT32, nans, 2);
    check_all_looks(SNOW_TYPE_FLOAT32, infinite, 2);
    check_all_looks(SNOW_TYPE_FLOAT64, wide, 3);
    check_all_looks(SNOW_TYPE_FLOAT64, one, 1);
    check_all_looks(SNOW_TYPE_FLOAT64, tiny, 3);
    check_all_looks(SNOW_TYPE_INT64, whole, 3);
    check_all_looks(SNOW_TYPE_INT64, close, 3);
    check_all_looks(SNOW_TYPE_UINT64, large, 2);
    check_all_looks(SNOW_TYPE_UINT8, zero, 1);
    check_all_looks(SNOW_TYPE_UINT8, constant, 3);
    check_all_looks(SNOW_TYPE_INT8, negative, 2);
}

static void
a_volume_of_zeros_shows_nothing_and_one_of_sevens_does(void **state) {
    (void)state;
    const uint8_t zeros[] = {0, 0}, sevens[] = {7, 7};
    static const char *const presets[] = {NULL, "linear", "mr-default"};
    snow_context *context = support_context();
    snow_volume *empty = support_row(context, SNOW_TYPE_UINT8, zeros, 2);
    snow_volume *full = support_row(context, SNOW_TYPE_UINT8, sevens, 2);
    for (int i = 0; i < 3; i++) {
        snow_transfer *a =
            support_look(empty, (snow_look){.size = sizeof(snow_look),
                                            .preset = presets[i]});
        snow_transfer *b = support_look(
            full, (snow_look){.size = sizeof(snow_look), .preset = presets[i]});
        assert_true(opacity_at(a, 0) == 0);
        assert_true(opacity_at(b, 7) > 0.5);
        snow_transfer_free(a);
        snow_transfer_free(b);
    }
    snow_volume_close(empty);
    snow_volume_close(full);
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_between_points_are_interpolated),
        cmocka_unit_test(beyond_the_ends_all_is_constant),
        cmocka_unit_test(a_steps_value_belongs_to_the_later_point),
        cmocka_unit_test(nan_is_transparent_and_black),
        cmocka_unit_test(points_as_far_apart_as_doubles_go_do_not_overflow),
        cmocka_unit_test(bad_points_are_refused),
        cmocka_unit_test(a_gradient_opacity_is_a_curve_of_its_own),
        cmocka_unit_test(a_gradient_opacity_is_taken_away_by_none_and_by_ones),
        cmocka_unit_test(a_bad_gradient_opacity_changes_nothing),
        cmocka_unit_test(a_look_has_a_gradient_opacity),
        cmocka_unit_test(linear_on_8_bits_is_the_value_itself),
        cmocka_unit_test(table_1_of_the_real_engine_comes_out),
        cmocka_unit_test(a_range_of_values_spreads_any_look),
        cmocka_unit_test(percentiles_are_of_finite_values),
        cmocka_unit_test(quantiles_are_those_of_sorted_values),
        cmocka_unit_test(all_types_give_one_look),
        cmocka_unit_test(the_full_range_is_from_smallest_to_largest),
        cmocka_unit_test(slope_and_intercept_count),
        cmocka_unit_test(presets_and_maps_are_listed_and_all_work),
        cmocka_unit_test(ct_presets_keep_their_hounsfield_values),
        cmocka_unit_test(ct_presets_warn_of_values_with_an_offset),
        cmocka_unit_test(unknown_names_are_refused_with_a_list),
        cmocka_unit_test(empty_ranges_are_refused),
        cmocka_unit_test(a_colour_map_replaces_the_colours_only),
        cmocka_unit_test(given_opacities_replace_the_presets),
        cmocka_unit_test(colour_maps_are_the_published_ones),
        cmocka_unit_test(gray_is_grey),
        cmocka_unit_test(names_are_free_in_case_and_dashes),
        cmocka_unit_test(a_view_keeps_its_sign),
        cmocka_unit_test(background_is_transparent_and_the_object_is_not),
        cmocka_unit_test(sparse_vessels_are_found_in_an_empty_volume),
        cmocka_unit_test(a_few_wild_values_do_not_blank_the_picture),
        cmocka_unit_test(a_mask_of_0_and_1_shows_its_ones),
        cmocka_unit_test(odd_volumes_have_a_look_too),
        cmocka_unit_test(
            a_volume_of_zeros_shows_nothing_and_one_of_sevens_does),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
