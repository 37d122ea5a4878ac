/* tests/transfer/test_transfer.c - control points, ranges, presets, colour
 * maps, and the look that the histogram suggests. */
#include "support/looks.h"

#include <float.h>
#include <math.h>

static const snow_color_point black[] = {{0, 0, 0, 0}};

static snow_transfer *opacities_only(looks_fixture *f,
                                     const snow_opacity_point *points,
                                     size_t count) {
    return looks_of_points(f, black, 1, points, count);
}

static bool near(double a, double b) {
    return fabs(a - b) < 1e-12;
}

/* --- control points ------------------------------------------------------- */

static void values_between_points_are_interpolated(void **state) {
    static const snow_color_point colors[] = {{10, 0, 0.5, 1}, {20, 1, 0.5, 0}};
    static const snow_opacity_point opacities[] = {{0, 0}, {40, 0.8}};
    snow_transfer *transfer = looks_of_points(*state, colors, 2, opacities, 2);
    double rgba[4];
    snow_transfer_evaluate(transfer, 15, rgba);
    assert_true(rgba[0] == 0.5 && rgba[1] == 0.5 && rgba[2] == 0.5);
    assert_true(near(rgba[3], 0.3));
    assert_false(snow_transfer_is_grey(transfer));
}

static void beyond_the_ends_all_is_constant(void **state) {
    static const snow_opacity_point points[] = {{10, 0.25}, {20, 0.75}};
    snow_transfer *transfer = opacities_only(*state, points, 2);
    assert_true(looks_opacity(transfer, -1e300) == 0.25);
    assert_true(looks_opacity(transfer, -INFINITY) == 0.25);
    assert_true(looks_opacity(transfer, 10) == 0.25);
    assert_true(looks_opacity(transfer, 20) == 0.75);
    assert_true(looks_opacity(transfer, INFINITY) == 0.75);
    assert_true(snow_transfer_is_grey(transfer));
}

static void a_steps_value_belongs_to_the_later_point(void **state) {
    static const snow_opacity_point points[] = {{0, 0}, {5, 0}, {5, 1}, {9, 1}};
    static const snow_color_point colors[] = {{5, 0, 0, 0}, {5, 1, 1, 1}};
    snow_transfer *transfer = looks_of_points(*state, colors, 2, points, 4);
    assert_true(looks_opacity(transfer, nextafter(5, 0)) == 0);
    assert_true(looks_opacity(transfer, 5) == 1);
    assert_true(looks_red(transfer, 5) == 1);
    assert_true(looks_red(transfer, 4.999) == 0);
}

static void nan_is_transparent_and_black(void **state) {
    static const snow_opacity_point points[] = {{0, 1}};
    snow_transfer *transfer = opacities_only(*state, points, 1);
    double rgba[4] = {9, 9, 9, 9};
    snow_transfer_evaluate(transfer, NAN, rgba);
    for (int i = 0; i < 4; i++)
        assert_true(rgba[i] == 0);
    assert_true(looks_opacity(transfer, 3) == 1);
}

static void points_as_far_apart_as_doubles_go_do_not_overflow(void **state) {
    static const snow_opacity_point points[] = {{-DBL_MAX, 0}, {DBL_MAX, 1}};
    snow_transfer *transfer = opacities_only(*state, points, 2);
    assert_true(near(looks_opacity(transfer, 0), 0.5));
    assert_true(near(looks_opacity(transfer, DBL_MAX / 2), 0.75));
}

static void bad_points_are_refused(void **state) {
    static const struct {
        snow_color_point colors[2];
        size_t color_count;
        snow_opacity_point opacities[2];
        size_t opacity_count;
        const char *words;
    } bad[] = {
        {{{0, 0, 0, 0}}, 1, {{5, 0}, {4, 1}}, 2, "point 2 at 4 comes after 5"},
        {{{0, 0, 0, 0}}, 1, {{5, 1.5}}, 1, "1.5"},
        {{{0, 0, 0, 0}}, 1, {{INFINITY, 1}}, 1, "inf"},
        {{{0, 0, 0, 0}}, 1, {{5, NAN}}, 1, "nan"},
        {{{0, 0, 0, 0}}, 1, {{5, 1}}, 0, "at least one"},
        {{{0, 0, 0, 0}}, 0, {{5, 1}}, 1, "at least one"},
        {{{5, 2, 0, 0}}, 1, {{5, 1}}, 1, "colour point 1"},
        {{{5, 0, 0, 0}, {4, 0, 0, 0}}, 2, {{5, 1}}, 1, "colour point 2"},
    };
    looks_fixture *f = *state;
    snow_transfer *transfer = NULL;
    for (size_t n = 0; n < sizeof bad / sizeof *bad; n++) {
        assert_int_equal(snow_transfer_new(f->context, bad[n].colors,
                                           bad[n].color_count, bad[n].opacities,
                                           bad[n].opacity_count, &transfer),
                         SNOW_STATUS_BAD_USAGE);
        assert_non_null(strstr(snow_context_message(f->context), bad[n].words));
    }
    assert_null(transfer);
}

/* --- gradient opacity ----------------------------------------------------- */

static const snow_opacity_point half[] = {{0, 0.5}};
static const snow_opacity_point rise[] = {{2, 0}, {4, 1}};

static void a_gradient_opacity_is_a_curve_of_its_own(void **state) {
    static const snow_opacity_point curve[] = {
        {2, 0}, {4, 0.5}, {4, 0.75}, {9, 1}};
    snow_transfer *transfer = opacities_only(*state, half, 1);
    assert_true(snow_transfer_evaluate_gradient(transfer, 0) == 1);
    assert_false(looks_say(transfer, "gradient"));
    assert_int_equal(snow_transfer_set_gradient_opacity(transfer, curve, 4),
                     SNOW_STATUS_OK);
    assert_true(snow_transfer_evaluate_gradient(transfer, 0) == 0);
    assert_true(near(snow_transfer_evaluate_gradient(transfer, 3), 0.25));
    assert_true(snow_transfer_evaluate_gradient(transfer, 4) == 0.75);
    assert_true(snow_transfer_evaluate_gradient(transfer, INFINITY) == 1);
    assert_true(snow_transfer_evaluate_gradient(transfer, NAN) == 1);
    assert_true(looks_opacity(transfer, 3) == 0.5); /* of the value alone */
    assert_true(looks_say(transfer, "; gradient opacity 0 at 2, 0.5 at 4, 0.75 "
                                    "at 4, 1 at 9"));
}

static void a_gradient_opacity_is_taken_away_by_none_and_by_ones(void **state) {
    static const snow_opacity_point ones[] = {{0, 1}, {255, 1}};
    snow_transfer *transfer = opacities_only(*state, half, 1);
    char before[SNOW_TRANSFER_TEXT_BYTES];
    snprintf(before, sizeof before, "%s", snow_transfer_description(transfer));
    for (size_t count = 0; count <= 2; count += 2) {
        assert_int_equal(snow_transfer_set_gradient_opacity(transfer, rise, 2),
                         SNOW_STATUS_OK);
        assert_int_equal(
            snow_transfer_set_gradient_opacity(transfer, ones, count),
            SNOW_STATUS_OK);
        assert_true(snow_transfer_evaluate_gradient(transfer, 2) == 1);
        assert_int_equal(transfer->gradient_count, 0);
        assert_string_equal(snow_transfer_description(transfer), before);
    }
}

static void a_bad_gradient_opacity_changes_nothing(void **state) {
    static const snow_opacity_point falling[] = {{5, 0}, {4, 1}};
    static const snow_opacity_point beyond[] = {{5, 1.5}};
    looks_fixture *f = *state;
    snow_transfer *transfer = opacities_only(f, half, 1);
    assert_int_equal(snow_transfer_set_gradient_opacity(transfer, rise, 2),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_transfer_set_gradient_opacity(transfer, falling, 2),
                     SNOW_STATUS_BAD_USAGE);
    assert_non_null(strstr(snow_context_message(f->context),
                           "gradient opacity point 2 at 4 comes after 5"));
    assert_int_equal(snow_transfer_set_gradient_opacity(transfer, beyond, 1),
                     SNOW_STATUS_BAD_USAGE);
    assert_non_null(strstr(snow_context_message(f->context), "1.5"));
    assert_true(near(snow_transfer_evaluate_gradient(transfer, 3), 0.5));
}

static void a_look_has_a_gradient_opacity(void **state) {
    static const uint8_t bytes[] = {0, 7, 200};
    snow_opacity_point many[256];
    for (int i = 0; i < 256; i++)
        many[i] = (snow_opacity_point){-1.23456e-100 / (i + 1), 0.12345};
    looks_fixture *f = *state;
    snow_volume *volume = looks_row(f, SNOW_TYPE_UINT8, bytes, 3);
    snow_look look = {.preset = "linear",
                      .gradient_opacities = rise,
                      .gradient_opacity_count = 2};
    snow_transfer *transfer = looks_of(f, volume, look);
    assert_true(near(snow_transfer_evaluate_gradient(transfer, 3), 0.5));
    assert_true(looks_say(transfer, "); gradient opacity 0 at 2, 1 at 4"));
    look.gradient_opacities = look.opacities = many;
    look.gradient_opacity_count = look.opacity_count = 256;
    transfer = looks_of(f, volume, look); /* more than there is room to tell */
    assert_true(looks_say(transfer, ", ... ("));
    assert_true(looks_say(transfer, "; gradient opacity"));
    look.gradient_opacity_count = 0;
    looks_refused(f, volume, look, "0 gradient opacities");
}

/* --- ranges and presets --------------------------------------------------- */

static void table_1_of_the_real_engine_comes_out(void **state) {
    static const double thresholds[] = {0, 10, 30},
                        wanted[] = {27.9, 77.5, 81.7};
    const char *path = support_data("classic/engine_256x256x110_u8.raw.gz");
    looks_fixture *f = *state;
    if (!path)
        skip();
    const snow_volume_options options = {.size = sizeof options,
                                         .dims = {256, 256, 110},
                                         .type = SNOW_TYPE_UINT8};
    snow_volume *volume;
    assert_int_equal(snow_volume_open(f->context, path, &options, &volume),
                     SNOW_STATUS_OK);
    snow_transfer *transfer =
        looks_of(f, volume, (snow_look){.preset = "linear"});
    for (int i = 0; i < 3; i++) {
        double found = -1;
        assert_int_equal(
            snow_transfer_sparse_ratio(transfer, volume, thresholds[i], &found),
            SNOW_STATUS_OK);
        assert_true(fabs(100 * found - wanted[i]) < 0.05);
    }
    snow_volume_close(volume);
}

#define ROW(type, array) SNOW_TYPE_##type, array, sizeof array / sizeof *array
static const uint8_t ends[] = {0, 255}, zeros[] = {0, 0}, sevens[] = {7, 7};
static const uint8_t mask[] = {0, 0, 0, 1, 1, 0, 0, 0};
static const int16_t shorts[] = {-1000, 0, 100, 3000}, ct[] = {-1000, 40, 900};
static const float reals[] = {NAN, -3, 5, 1, INFINITY};
#define BETWEEN(from, to) \
    .range = SNOW_RANGE_VALUES, .low = (from), .high = (to)

/* What a look makes of values: three rows of a value, and the least and the
 * largest opacity there. */
static void check_look(looks_fixture *f, snow_type type, const void *values,
                       int64_t count, snow_look look, double seen[3][3]) {
    snow_volume *volume = looks_row(f, type, values, count);
    snow_transfer *transfer = looks_of(f, volume, look);
    for (int n = 0; n < 3; n++) {
        double opacity = looks_opacity(transfer, seen[n][0]);
        if (!(opacity >= seen[n][1] - 1e-12 && opacity <= seen[n][2] + 1e-12))
            fail_msg("%s: opacity %g at %g",
                     snow_transfer_description(transfer), opacity, seen[n][0]);
    }
}

static void looks_lie_where_they_say(void **state) {
    static const snow_opacity_point given[] = {{100, 0}, {100, 0.5}};
    looks_fixture *f = *state;
    check_look(f, ROW(INT16, shorts),
               (snow_look){.preset = "linear", BETWEEN(20, 60)},
               (double[3][3]){{20, 0, 0}, {30, 0.25, 0.25}, {60, 1, 1}});
    check_look(f, ROW(INT16, shorts), /* its own span is 150 to 1500 */
               (snow_look){.preset = "ct-bone", BETWEEN(20, 60)},
               (double[3][3]){{20, 0, 0}, {60, 0.85, 0.85}, {99, 0.85, 0.85}});
    check_look(f, ROW(INT16, shorts), (snow_look){BETWEEN(20, 60)},
               (double[3][3]){{20, 0, 0}, {60, 0.8, 0.8}, {19, 0, 0}});
    check_look(f, ROW(FLOAT32, reals),
               (snow_look){.preset = "linear", .range = SNOW_RANGE_FULL},
               (double[3][3]){{-3, 0, 0}, {1, 0.5, 0.5}, {5, 1, 1}});
    check_look(f, ROW(INT16, ct), (snow_look){.preset = "ct-bone"},
               (double[3][3]){{60, 0, 0}, {700, 0.4, 1}, {40, 0, 0}});
    check_look(f, ROW(INT16, ct), (snow_look){.preset = "ct-soft"},
               (double[3][3]){{-900, 0, 0}, {40, 0.1, 1}, {-1000, 0, 0}});
    check_look(f, ROW(UINT8, ends), /* a map has colours only */
               (snow_look){.preset = "linear", .colormap = "inferno"},
               (double[3][3]){{51, 0.2, 0.2}, {0, 0, 0}, {255, 1, 1}});
    check_look(
        f, ROW(UINT8, ends),
        (snow_look){.preset = "linear", .opacities = given, .opacity_count = 2},
        (double[3][3]){{99, 0, 0}, {100, 0.5, 0.5}, {101, 0.5, 0.5}});
    check_look(f, ROW(UINT8, mask), (snow_look){0},
               (double[3][3]){{0, 0, 0}, {1, 0.3, 1}, {1, 0.3, 1}});
}

static void slope_and_intercept_count(void **state) {
    static const uint8_t steps[] = {0, 1, 2, 3, 4};
    const snow_volume_info info = {.dims = {5, 1, 1},
                                   .type = SNOW_TYPE_UINT8,
                                   .slope = -10,
                                   .intercept = 100};
    snow_transfer *transfer =
        looks_of(*state, looks_volume(*state, info, steps),
                 (snow_look){.preset = "linear"});
    assert_true(looks_opacity(transfer, 60) == 0);
    assert_true(looks_opacity(transfer, 100) == 1);
}

static void zeros_show_nothing_and_sevens_do(void **state) {
    static const char *const presets[] = {NULL, "linear", "mr-default"};
    looks_fixture *f = *state;
    for (int i = 0; i < 3; i++) {
        const snow_look look = {.preset = presets[i]};
        snow_volume *empty = looks_row(f, ROW(UINT8, zeros));
        snow_volume *full = looks_row(f, ROW(UINT8, sevens));
        assert_true(looks_opacity(looks_of(f, empty, look), 0) == 0);
        assert_true(looks_opacity(looks_of(f, full, look), 7) > 0.5);
    }
}

static void linear_on_8_bits_is_the_value_itself(void **state) {
    uint8_t bytes[256];
    for (int i = 0; i < 256; i++)
        bytes[i] = (uint8_t)i;
    snow_volume *volume = looks_row(*state, SNOW_TYPE_UINT8, bytes, 256);
    snow_transfer *transfer =
        looks_of(*state, volume, (snow_look){.preset = "linear"});
    for (int i = 0; i < 256; i++)
        assert_true(looks_opacity(transfer, i) == i / 255.0 &&
                    looks_red(transfer, i) == i / 255.0);
    assert_true(snow_transfer_is_grey(transfer));
}

/* 10 % of 200 values are at most 20. */
static void percentiles_are_of_finite_values(void **state) {
    float values[204];
    for (int i = 0; i < 200; i++)
        values[i] = (float)((i * 37) % 200 + 1); /* 1 to 200, mixed */
    values[200] = NAN, values[201] = INFINITY, values[202] = -INFINITY;
    values[203] = NAN;
    snow_volume *volume = looks_row(*state, SNOW_TYPE_FLOAT32, values, 204);
    snow_transfer *transfer =
        looks_of(*state, volume,
                 (snow_look){.preset = "linear",
                             .range = SNOW_RANGE_PERCENTILES,
                             .low = 10,
                             .high = 90});
    assert_true(looks_opacity(transfer, 20) == 0);
    assert_true(looks_opacity(transfer, 21) > 0);
    assert_true(looks_opacity(transfer, 180) == 1);
    assert_true(looks_opacity(transfer, 179) < 1);
}

static int ascending(const void *a, const void *b) {
    double p = *(const double *)a, q = *(const double *)b;
    return (p > q) - (p < q);
}

static void check_quantiles(void **state, snow_type type, double decades) {
    enum { N = 3001 };
    static double values[N], sorted[N];
    static float floats[N];
    const bool small = type == SNOW_TYPE_FLOAT32;
    static const double shares[4] = {0, 0.01, 0.5, 1};
    /* the 31st: 0.01 * 3001 rounded up */
    static const int places[4] = {0, 30, 1500, N - 1};
    uint64_t random = 7;
    for (int i = 0; i < N; i++) {
        double magnitude =
            pow(10, decades * (2 * support_uniform(&random) - 1));
        values[i] = support_uniform(&random) < 0.4 ? -magnitude : magnitude;
        floats[i] = (float)values[i];
        if (small)
            values[i] = (double)floats[i];
    }
    memcpy(sorted, values, sizeof values);
    qsort(sorted, N, sizeof *sorted, ascending);
    snow_volume *volume =
        looks_row(*state, type, small ? (void *)floats : (void *)values, N);
    double found[4];
    snow_histogram census;
    assert_int_equal(snow_histogram_new(volume, NULL, (snow_scale){0},
                                        SNOW_NEED_COUNTS, &census),
                     SNOW_STATUS_OK);
    assert_int_equal(
        snow_quantiles(&census, SNOW_HISTOGRAM_EXACT, shares, 4, found),
        SNOW_STATUS_OK);
    snow_histogram_free(&census);
    for (int i = 0; i < 4; i++)
        assert_true(found[i] == sorted[places[i]]);
}

static void quantiles_are_those_of_sorted_values(void **state) {
    check_quantiles(state, SNOW_TYPE_FLOAT64, 40);
    check_quantiles(state, SNOW_TYPE_FLOAT32, 30);
}

/* 8 and 16 bit values are counted, others searched for: one answer. */
static void all_types_give_one_look(void **state) {
    enum { N = 5000 };
    static int16_t narrow[N];
    static float wide[N];
    looks_fixture *f = *state;
    uint64_t random = 11;
    for (int i = 0; i < N; i++) {
        double u = support_uniform(&random);
        narrow[i] = (int16_t)(u < 0.7 ? -900 + 100 * u : 3000 * u * u * u);
        wide[i] = narrow[i];
    }
    snow_volume_info info = {.dims = {N, 1, 1}, .slope = -2, .intercept = 50};
    for (int range = SNOW_RANGE_AUTO; range <= SNOW_RANGE_PERCENTILES;
         range++) {
        const snow_look look = {
            .range = (snow_range)range, .low = 3, .high = 97};
        info.type = SNOW_TYPE_INT16;
        snow_transfer *p = looks_of(f, looks_volume(f, info, narrow), look);
        info.type = SNOW_TYPE_FLOAT32;
        snow_transfer *q = looks_of(f, looks_volume(f, info, wide), look);
        assert_string_equal(snow_transfer_description(p),
                            snow_transfer_description(q));
    }
}

static void ct_presets_warn_of_values_with_an_offset(void **state) {
    static const uint16_t values[] = {0, 1040, 1900};
    looks_fixture *f = *state;
    snow_volume *volume = looks_row(f, SNOW_TYPE_UINT16, values, 3);
    looks_of(f, volume, (snow_look){.preset = "ct-soft"});
    assert_int_equal(f->warnings, 1);
    assert_non_null(strstr(f->warning, "Hounsfield"));
    looks_of(f, volume, (snow_look){.preset = "ct-soft", BETWEEN(674, 1524)});
    assert_int_equal(f->warnings, 1);
}

static void presets_and_maps_are_listed_and_all_work(void **state) {
    static const int16_t values[] = {-1000, -50, 40, 300, 1200, 40, 40, -1000};
    static const char *const presets[] = {"linear", "ct-aaa", "ct-aaa2",
                                          "ct-bone"};
    static const char *const maps[] = {"grey", "viridis", "inferno",
                                       "cool-warm", "turbo"};
    looks_fixture *f = *state;
    snow_volume *volume = looks_row(f, SNOW_TYPE_INT16, values, 8);
    size_t count = 0;
    for (size_t i = 0; i < 4; i++)
        assert_string_equal(snow_preset_name(i), presets[i]);
    for (size_t i = 0; i < 5; i++)
        assert_string_equal(snow_colormap_name(i), maps[i]);
    for (; snow_preset_name(count); count++) {
        assert_non_null(snow_preset_description(count));
        looks_of(f, volume, (snow_look){.preset = snow_preset_name(count)});
    }
    assert_null(snow_preset_description(count));
    for (size_t i = 0; snow_colormap_name(i); i++)
        looks_of(f, volume, (snow_look){.colormap = snow_colormap_name(i)});
}

static void unknown_names_are_refused_with_a_list(void **state) {
    looks_fixture *f = *state;
    snow_volume *volume = looks_row(f, SNOW_TYPE_UINT8, ends, 2);
    looks_refused(f, volume, (snow_look){.preset = "ct-foot"}, "ct-foot");
    for (size_t i = 0; snow_preset_name(i); i++)
        looks_refused(f, volume, (snow_look){.preset = "ct-foot"},
                      snow_preset_name(i));
    for (size_t i = 0; snow_colormap_name(i); i++)
        looks_refused(f, volume, (snow_look){.colormap = "jet"},
                      snow_colormap_name(i));
}

static void wrong_ranges_and_points_are_refused(void **state) {
    static const snow_opacity_point falling[] = {{100, 0}, {50, 0.5}};
    static const snow_look wrong[] = {
        {BETWEEN(5, 5)},
        {BETWEEN(6, 5)},
        {BETWEEN(NAN, 5)},
        {BETWEEN(0, INFINITY)},
        {.range = SNOW_RANGE_PERCENTILES, .low = -1, .high = 50},
        {.range = SNOW_RANGE_PERCENTILES, .low = 1, .high = 101},
        {.preset = "linear", .opacities = falling, .opacity_count = 2},
    };
    looks_fixture *f = *state;
    snow_volume *volume = looks_row(f, SNOW_TYPE_UINT8, ends, 2);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        looks_refused(f, volume, wrong[i], "");
}

/* --- colour maps and names ------------------------------------------------ */

/* Entries of the published tables (of 256; cool-warm by its formula), at 0,
 * 64, 128, 192 and 255 of 255. */
static void colour_maps_are_the_published_ones(void **state) {
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
    looks_fixture *f = *state;
    snow_volume *volume = looks_row(f, SNOW_TYPE_UINT8, ends, 2);
    for (size_t n = 0; n < sizeof tables / sizeof *tables; n++) {
        snow_transfer *transfer = looks_of(
            f, volume,
            (snow_look){.preset = "linear", .colormap = tables[n].name});
        for (int i = 0; i < 5; i++) {
            double rgba[4];
            snow_transfer_evaluate(transfer, entries[i], rgba);
            for (int c = 0; c < 3; c++)
                if (fabs(rgba[c] - tables[n].rgb[i][c]) > 1 / 255.0)
                    fail_msg("%s at %d: channel %d is %g", tables[n].name,
                             entries[i], c, rgba[c]);
        }
    }
}

static void names_are_free_in_case_and_dashes(void **state) {
    static const char *const same_maps[][2] = {{"CoolWarm", "cool-warm"},
                                               {"gray", "grey"}};
    static const char *const same_presets[][2] = {{"CT_Bone", "ct-bone"},
                                                  {"ctbone", "ct-bone"}};
    /* As users of other viewers write them. */
    static const char known[] =
        "CT-AAA CT-AAA2 CT-Bone CT-Bones CT-Cardiac CT-Cardiac2 CT-Cardiac3 "
        "CT-Chest-Contrast-Enhanced CT-Chest-Vessels CT-Coronary-Arteries "
        "CT-Coronary-Arteries-2 CT-Coronary-Arteries-3 CT-Cropped-Volume-Bone "
        "CT-Fat CT-Liver-Vasculature CT-Lung CT-MIP CT-Muscle "
        "CT-Pulmonary-Arteries CT-Soft-Tissue MR-Angio MR-Default MR-MIP "
        "MR-T2-Brain DTI-FA-Brain";
    char names[sizeof known];
    (void)state;
    for (size_t i = 0; snow_colormap_name(i); i++)
        assert_int_equal(snow_colormap_from_name(snow_colormap_name(i)), i);
    for (size_t i = 0; snow_preset_name(i); i++)
        assert_int_equal(snow_preset_from_name(snow_preset_name(i)), i);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(snow_colormap_from_name(same_maps[i][0]),
                         snow_colormap_from_name(same_maps[i][1]));
        assert_int_equal(snow_preset_from_name(same_presets[i][0]),
                         snow_preset_from_name(same_presets[i][1]));
    }
    memcpy(names, known, sizeof known);
    for (char *name = strtok(names, " "); name; name = strtok(NULL, " "))
        assert_true(snow_preset_from_name(name) >= 0);
    assert_int_equal(snow_preset_from_name("ct-bon"), -1);
    assert_int_equal(snow_preset_from_name("ct-boness"), -1);
    assert_int_equal(snow_preset_from_name("ct bone"), -1);
    assert_int_equal(snow_colormap_from_name(""), -1);
    assert_int_equal(snow_colormap_from_name("-grey"), -1);
}

static void a_view_keeps_its_sign(void **state) {
    looks_fixture *f = *state;
    snow_view a = {.size = sizeof a}, b = {.size = sizeof b};
    assert_int_equal(snow_view_from_name(f->context, "Anterior", &a),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_view_from_name(f->context, "+y", &b), SNOW_STATUS_OK);
    assert_memory_equal(a.back, b.back, sizeof a.back);
    assert_int_equal(snow_view_from_name(f->context, "-X", &a), SNOW_STATUS_OK);
    assert_true(a.back[0] < 0);
    assert_int_equal(snow_view_from_name(f->context, "x", &a),
                     SNOW_STATUS_BAD_USAGE);
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
    enum { AIR = 6000, TISSUE = 3000, BONE = 500, ALL = AIR + TISSUE + BONE };
    static float values[ALL];
    uint64_t random = 3;
    scatter(values, AIR, 30, 20, &random);
    scatter(values + AIR, TISSUE, 1000, 60, &random);
    scatter(values + AIR + TISSUE, BONE, 2000, 200, &random);
    snow_volume *volume = looks_row(*state, SNOW_TYPE_FLOAT32, values, ALL);
    snow_transfer *transfer = looks_of(*state, volume, (snow_look){0});
    assert_true(looks_opacity(transfer, 50) == 0);
    assert_true(looks_opacity(transfer, 950) >= 0.2);
    assert_true(looks_opacity(transfer, 2000) > looks_opacity(transfer, 1000));
    assert_true(snow_transfer_is_grey(transfer));
    assert_true(looks_say(transfer, "from the histogram"));
    assert_false(looks_say(transfer, "\n"));
}

static void sparse_vessels_are_found_in_an_empty_volume(void **state) {
    enum { ALL = 100000, VESSEL = 1000 };
    static float values[ALL];
    uint64_t random = 5;
    memset(values, 0, sizeof values);
    scatter(values, VESSEL, 150, 100, &random);
    snow_volume *volume = looks_row(*state, SNOW_TYPE_FLOAT32, values, ALL);
    snow_transfer *transfer = looks_of(*state, volume, (snow_look){0});
    assert_true(looks_opacity(transfer, 0) == 0);
    /* Their brightest half is not cut off. */
    assert_true(looks_opacity(transfer, 180) > 0.3);
    assert_true(looks_opacity(transfer, 180) < 0.6);
    assert_true(looks_opacity(transfer, 249) > 0.75);
}

static void a_few_wild_values_do_not_blank_the_picture(void **state) {
    enum { ALL = 10000 };
    static float values[ALL];
    uint64_t random = 9;
    scatter(values, ALL / 2, 10, 5, &random);
    scatter(values + ALL / 2, ALL / 2, 100, 20, &random);
    for (int i = 0; i < 20; i++)
        values[i * 400] = i % 2 ? 3e38F : NAN;
    snow_volume *volume = looks_row(*state, SNOW_TYPE_FLOAT32, values, ALL);
    snow_transfer *transfer = looks_of(*state, volume, (snow_look){0});
    assert_true(looks_opacity(transfer, 12) == 0);
    assert_true(looks_opacity(transfer, 110) > 0.2);
}

/* Every preset, map and range on values that leave nothing to part. */
static void check_all_looks(looks_fixture *f, snow_type type,
                            const void *values, int64_t n) {
    snow_volume *volume = looks_row(f, type, values, n);
    for (int range = SNOW_RANGE_AUTO; range <= SNOW_RANGE_PERCENTILES; range++)
        for (size_t p = 0; p == 0 || snow_preset_name(p - 1); p++) {
            snow_look look = {.preset = p ? snow_preset_name(p - 1) : NULL,
                              .range = (snow_range)range,
                              .low = 1,
                              .high = 99,
                              .colormap = "turbo"};
            if (p && !strcmp(look.preset, "labels")) /* has no range */
                continue;
            snow_transfer *transfer = looks_of(f, volume, look);
            for (int64_t i = 0; i < n; i++) {
                double rgba[4];
                snow_transfer_evaluate(transfer, snow_volume_native(volume, i),
                                       rgba);
                for (int c = 0; c < 4; c++)
                    assert_true(rgba[c] >= 0 && rgba[c] <= 1);
            }
        }
}

static void odd_volumes_have_a_look_too(void **state) {
    const float nans[] = {NAN, NAN}, infinite[] = {INFINITY, -INFINITY};
    const double wide[] = {-DBL_MAX, 0, DBL_MAX}, one[] = {DBL_MAX};
    const double tiny[] = {0, 4.9e-324, 1e-323};
    const int64_t whole[] = {INT64_MIN, -1, INT64_MAX};
    const int64_t close[] = {INT64_MAX - 4096, INT64_MAX - 2048, INT64_MAX};
    const uint64_t large[] = {0, UINT64_MAX};
    const uint8_t zero[] = {0}, constant[] = {7, 7, 7};
    const int8_t negative[] = {-5, -5};
    check_all_looks(*state, ROW(FLOAT32, nans));
    check_all_looks(*state, ROW(FLOAT32, infinite));
    check_all_looks(*state, ROW(FLOAT64, wide));
    check_all_looks(*state, ROW(FLOAT64, one));
    check_all_looks(*state, ROW(FLOAT64, tiny));
    check_all_looks(*state, ROW(INT64, whole));
    check_all_looks(*state, ROW(INT64, close));
    check_all_looks(*state, ROW(UINT64, large));
    check_all_looks(*state, ROW(UINT8, zero));
    check_all_looks(*state, ROW(UINT8, constant));
    check_all_looks(*state, ROW(INT8, negative));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        LOOKS_TEST(values_between_points_are_interpolated),
        LOOKS_TEST(beyond_the_ends_all_is_constant),
        LOOKS_TEST(a_steps_value_belongs_to_the_later_point),
        LOOKS_TEST(nan_is_transparent_and_black),
        LOOKS_TEST(points_as_far_apart_as_doubles_go_do_not_overflow),
        LOOKS_TEST(bad_points_are_refused),
        LOOKS_TEST(a_gradient_opacity_is_a_curve_of_its_own),
        LOOKS_TEST(a_gradient_opacity_is_taken_away_by_none_and_by_ones),
        LOOKS_TEST(a_bad_gradient_opacity_changes_nothing),
        LOOKS_TEST(a_look_has_a_gradient_opacity),
        LOOKS_TEST(table_1_of_the_real_engine_comes_out),
        LOOKS_TEST(looks_lie_where_they_say),
        LOOKS_TEST(slope_and_intercept_count),
        LOOKS_TEST(zeros_show_nothing_and_sevens_do),
        LOOKS_TEST(linear_on_8_bits_is_the_value_itself),
        LOOKS_TEST(percentiles_are_of_finite_values),
        LOOKS_TEST(quantiles_are_those_of_sorted_values),
        LOOKS_TEST(all_types_give_one_look),
        LOOKS_TEST(ct_presets_warn_of_values_with_an_offset),
        LOOKS_TEST(presets_and_maps_are_listed_and_all_work),
        LOOKS_TEST(unknown_names_are_refused_with_a_list),
        LOOKS_TEST(wrong_ranges_and_points_are_refused),
        LOOKS_TEST(colour_maps_are_the_published_ones),
        LOOKS_TEST(names_are_free_in_case_and_dashes),
        LOOKS_TEST(a_view_keeps_its_sign),
        LOOKS_TEST(background_is_transparent_and_the_object_is_not),
        LOOKS_TEST(sparse_vessels_are_found_in_an_empty_volume),
        LOOKS_TEST(a_few_wild_values_do_not_blank_the_picture),
        LOOKS_TEST(odd_volumes_have_a_look_too),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
