/* tests/transfer/test_looks.c - looks of points as data, and on a logarithmic
 * scale. */
#include "support/looks.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static bool near(double a, double b) {
    return fabs(a - b) < 1e-9;
}

/* 0.001 to 1000, seven decades, and what has no logarithm. */
static const float decades[] = {0.001F, 0.01F, 0.1F, 1,    10,
                                100,    1000,  0,    -500, -0.001F};
#define DECADES (sizeof decades / sizeof *decades)

static bool is_log(const snow_transfer *transfer) {
    snow_look look = {.size = sizeof look};
    assert_int_equal(snow_transfer_get_look(transfer, &look), SNOW_STATUS_OK);
    return look.log;
}

static void linear_over_decades_is_linear_in_decades(void **state) {
    looks_fixture *f = *state;
    snow_volume *volume = looks_row(f, SNOW_TYPE_FLOAT32, decades, DECADES);
    snow_look look = {.preset = "linear", .log = true};
    snow_transfer *transfer = looks_of(f, volume, look);
    assert_true(is_log(transfer));
    for (int i = 0; i < 7; i++) {
        assert_true(
            fabs(looks_opacity(transfer, (double)decades[i]) - i / 6.0) < 1e-7);
        assert_true(fabs(looks_red(transfer, (double)decades[i]) - i / 6.0) <
                    1e-7);
    }
    assert_true(looks_opacity(transfer, 0) == 0);
    assert_true(looks_opacity(transfer, -500) == 0);
    assert_true(looks_opacity(transfer, (double)NAN) == 0);
    assert_true(looks_opacity(transfer, (double)INFINITY) == 1);
    assert_true(looks_say(transfer, "logarithmic"));
}

static void a_range_is_spread_by_decades(void **state) {
    looks_fixture *f = *state;
    snow_volume *volume = looks_row(f, SNOW_TYPE_FLOAT32, decades, DECADES);
    snow_look look = {.preset = "ct-bone",
                      .range = SNOW_RANGE_VALUES,
                      .low = 0.1,
                      .high = 1000,
                      .log = true};
    snow_transfer *transfer = looks_of(f, volume, look);
    /* ct-bone goes from 150 to 1500; 350 is 200 / 1350 of the way. */
    double value = 0.1 * pow(1e4, 200.0 / 1350);
    assert_true(near(looks_opacity(transfer, value), 0.40));
    assert_true(looks_opacity(transfer, 0.1) == 0);
    assert_true(looks_opacity(transfer, 1000) == 0.85);
    look.range = SNOW_RANGE_PERCENTILES;
    look.low = 0;
    look.high = 100; /* of the values above 0 */
    look.colormap = "grey";
    transfer = looks_of(f, volume, look);
    assert_true(fabs(looks_red(transfer, 1) - 0.5) < 1e-7);
}

static void what_has_no_logarithm_is_refused(void **state) {
    static const snow_opacity_point from_0[] = {{0, 0}, {10, 1}};
    looks_fixture *f = *state;
    snow_volume *volume = looks_row(f, SNOW_TYPE_FLOAT32, decades, DECADES);
    const snow_look looks[] = {
        {.preset = "ct-soft", .log = true},
        {.opacities = from_0, .opacity_count = 2, .log = true},
        {.range = SNOW_RANGE_VALUES, .low = 0, .high = 9, .log = true}};
    for (size_t i = 0; i < 3; i++)
        looks_refused(f, volume, looks[i], "logarithm");
}

/* --- symmetric logarithms --------------------------------------------------
 */

/* The place of a value, as docs/looks.md has it. */
static double symlog_of(double value, double linear) {
    double size = fabs(value) / linear;
    return copysign(size > 1 ? 1 + log(size) : size, value);
}

/* Opacity and colour follow the scale, on both sides and in the middle. */
static void a_symmetric_logarithm_is_linear_around_0(void **state) {
    looks_fixture *f = *state;
    const double wide[] = {-1000, 1000, 0, 1, -1};
    snow_volume *volume = looks_row(f, SNOW_TYPE_FLOAT64, wide, 5);
    const double linears[] = {0.01, 0.5, 20, 5000};
    for (size_t n = 0; n < 4; n++) {
        const double linear = linears[n], end = symlog_of(1000, linear);
        snow_look look = {.preset = "linear", .symlog = linear};
        snow_transfer *transfer = looks_of(f, volume, look);
        assert_false(is_log(transfer));
        for (double value = -1000; value <= 1000;
             value += fmax(0.003, fabs(value) / 70)) {
            double share = (symlog_of(value, linear) / end + 1) / 2;
            assert_true(fabs(looks_opacity(transfer, value) - share) < 0.002);
            assert_true(fabs(looks_red(transfer, value) - share) < 0.002);
        }
        assert_true(looks_opacity(transfer, -1000) == 0);
        assert_true(near(looks_opacity(transfer, 0), 0.5));
        assert_true(looks_opacity(transfer, 1000) == 1);
    }
}

static void a_symmetric_logarithm_begins_where_it_says(void **state) {
    looks_fixture *f = *state;
    const float wide[] = {-300, 2500, 0, 1, -1};
    snow_volume *volume = looks_row(f, SNOW_TYPE_FLOAT32, wide, 5);
    snow_look look = {.preset = "linear", .symlog = -1};
    snow_transfer *transfer = looks_of(f, volume, look);
    assert_true(looks_say(transfer, " -300..2500 logarithmic beyond -2..2;"));
    look.range = SNOW_RANGE_VALUES;
    look.low = -7;
    look.high = 70;
    transfer = looks_of(f, volume, look);
    assert_true(looks_say(transfer, " -7..70 logarithmic beyond -0.05..0.05;"));
    look.log = true;
    looks_refused(f, volume, look, "");
}

static void logarithms_say_what_they_leave_out(void **state) {
    const int16_t narrow[] = {-3, 0, 0, 1, 2, 30};
    const float nan_too[] = {-3, 0, 0, 1, 2, 30, NAN};
    looks_fixture *f = *state;
    for (int n = 0; n < 2; n++) {
        snow_volume *volume = n ? looks_row(f, SNOW_TYPE_FLOAT32, nan_too, 7)
                                : looks_row(f, SNOW_TYPE_INT16, narrow, 6);
        looks_of(f, volume, (snow_look){.log = true});
        assert_non_null(strstr(f->warning, "leave out 3 of 6 voxels"));
        f->warning[0] = 0;
        looks_of(f, volume, (snow_look){.symlog = -1});
        assert_string_equal(f->warning, "");
    }
}

/* --- fields -----------------------------------------------------------------
 */

#define SIDE 16

typedef double field_fn(double x, double y, double z);

/* A block of a field of floats. */
static snow_volume *field_of(looks_fixture *f, float *values, field_fn *field) {
    const snow_volume_info info = {.dims = {SIDE, SIDE, SIDE},
                                   .type = SNOW_TYPE_FLOAT32};
    for (int n = 0; n < SIDE * SIDE * SIDE; n++)
        values[n] = (float)field((n % SIDE + 0.5) / SIDE,
                                 (n / SIDE % SIDE + 0.5) / SIDE,
                                 (n / SIDE / SIDE + 0.5) / SIDE);
    return looks_volume(f, info, values);
}

static double wave(double x, double y, double z) {
    return 3 * sin(6.28 * x) * sin(6.28 * y) + 0.5 * cos(6.28 * z);
}

static double blob(double x, double y, double z) {
    double r = (x - 0.5) * (x - 0.5) + (y - 0.5) * (y - 0.5);
    return exp(-10 * (r + (z - 0.5) * (z - 0.5)));
}

/* Grey, blue and red, as much on both sides. */
static void check_signed(const snow_transfer *transfer, double low,
                         double high) {
    double at[4], rgba[4];
    assert_true(looks_opacity(transfer, 0) == 0);
    for (int n = 1; n <= 10; n++) {
        snow_transfer_evaluate(transfer, low * n / 10, at);
        snow_transfer_evaluate(transfer, high * n / 10, rgba);
        assert_true(fabs(at[3] - rgba[3]) < 1e-12);
        assert_true(n < 3 || (at[2] > at[0] && rgba[0] > rgba[2]));
        assert_true(n < 6 || rgba[3] > 0.05);
    }
}

static void a_field_of_both_signs_is_diverging_around_0(void **state) {
    static float values[SIDE * SIDE * SIDE];
    looks_fixture *f = *state;
    snow_volume *volume = field_of(f, values, wave);
    snow_look look = {.size = sizeof look};
    double low, high;
    snow_transfer *transfer = looks_of(f, volume, look);
    snow_transfer_domain(transfer, &low, &high);
    assert_true(near(low, -high) && high > 3 && high < 3.5);
    check_signed(transfer, low, high);
    look.range = SNOW_RANGE_VALUES; /* the shape stays, and 0 where it is */
    look.low = -2.5;
    look.high = 5;
    transfer = looks_of(f, volume, look);
    check_signed(transfer, -2.5, 5);
    look.colormap = "RdBu_r";
    transfer = looks_of(f, volume, look);
    check_signed(transfer, -2.5, 5);
    assert_true(fabs(looks_red(transfer, 0) - 0xf7 / 255.0) < 1e-9);
    look.low = 1; /* no sign but one */
    transfer = looks_of(f, volume, look);
    assert_true(looks_opacity(transfer, 1) == 0);
    assert_true(looks_opacity(transfer, 5) > 0);
}

/* Noise of -1 to 1, the same for a place. */
static double noise_at(double x, double y, double z) {
    uint32_t n = (uint32_t)(x * 977 + y * 977 * SIDE + z * 977 * SIDE * SIDE);
    n = (n ^ n >> 15) * 0x2c1b3c6du;
    n = (n ^ n >> 12) * 0x297a2d39u;
    return (double)(n ^ n >> 15) / 0x1p31 - 1;
}

static double noisy_blob(double x, double y, double z) {
    return blob(x, y, z) + 0.2 * noise_at(x, y, z);
}

/* In steps of a scanner, divided by the largest. */
static double stepped_blob(double x, double y, double z) {
    return rint(2047 * blob(x, y, z) + 100 * noise_at(x, y, z)) / 2047;
}

static double smooth_steps(double x, double y, double z) {
    return rint(255 * (x + y + z)) / 255;
}

static double noisy_wave(double x, double y, double z) {
    return wave(x, y, z) + 2 * noise_at(x, y, z);
}

/* In units that make values large: floats have no fractions there. */
static double dense_blob(double x, double y, double z) {
    return 1e24 * (0.1 + blob(x, y, z));
}

static double strong_wave(double x, double y, double z) {
    return 1e24 * wave(x, y, z);
}

static double far_blob(double x, double y, double z) {
    return rint(1e6 * blob(x, y, z));
}

static void a_scan_in_floats_is_grey_and_shaded(void **state) {
    static const struct {
        field_fn *field;
        bool scan;
    } cases[] = {{noisy_blob, true},   {stepped_blob, true},
                 {blob, false},        {smooth_steps, false},
                 {noisy_wave, false},  {dense_blob, false},
                 {strong_wave, false}, {far_blob, true}};
    static float values[SIDE * SIDE * SIDE];
    looks_fixture *f = *state;
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        snow_volume *volume = field_of(f, values, cases[n].field);
        snow_transfer *transfer = looks_of(f, volume, (snow_look){0});
        assert_int_equal(snow_transfer_is_grey(transfer), cases[n].scan);
        assert_false(cases[n].scan && snow_transfer_is_unshaded(transfer));
    }
}

static void a_field_is_a_veil_in_colours(void **state) {
    static float values[SIDE * SIDE * SIDE];
    static int16_t whole[SIDE * SIDE * SIDE];
    const snow_volume_info info = {.dims = {SIDE, SIDE, SIDE},
                                   .type = SNOW_TYPE_INT16};
    looks_fixture *f = *state;
    snow_volume *volume = field_of(f, values, blob);
    snow_transfer *transfer = looks_of(f, volume, (snow_look){0});
    assert_false(snow_transfer_is_grey(transfer));
    assert_true(snow_transfer_is_unshaded(transfer));
    assert_true(looks_opacity(transfer, 0) == 0);
    assert_true(looks_opacity(transfer, 0.5) < 0.3);
    assert_true(looks_opacity(transfer, 1) > 0.4);
    for (int n = 0; n < SIDE * SIDE * SIDE; n++)
        whole[n] = (int16_t)(1000 * values[n]);
    transfer = looks_of(f, looks_volume(f, info, whole), (snow_look){0});
    assert_true(snow_transfer_is_grey(transfer));
}

static double hole(double x, double y, double z) {
    return -blob(x, y, z);
}

static double low_hole(double x, double y, double z) {
    return -1e-9 * (1 + 20 * blob(x, y, z)) + 1e-10 * (x > 0.98);
}

/* Charges of electrons, and potentials: what is frequent is clear, and what is
 * lowest is bright. */
static void a_field_below_0_stands_out_downward(void **state) {
    static float values[SIDE * SIDE * SIDE];
    looks_fixture *f = *state;
    double rgba[4], up[4];
    snow_transfer *above =
        looks_of(f, field_of(f, values, blob), (snow_look){0});
    snow_transfer *below =
        looks_of(f, field_of(f, values, hole), (snow_look){0});
    assert_true(snow_transfer_is_unshaded(below));
    for (int n = 0; n <= 20; n++) {
        snow_transfer_evaluate(above, n / 20.0, up);
        snow_transfer_evaluate(below, -n / 20.0, rgba);
        for (int c = 0; c < 4; c++)
            assert_true(fabs(rgba[c] - up[c]) < 0.02);
    }
    below = looks_of(f, field_of(f, values, low_hole), (snow_look){0});
    assert_true(looks_opacity(below, -1e-9) == 0);
    assert_true(looks_opacity(below, -20e-9) > 0.4);
}

/* matplotlib's definitions of three maps, at all 256 entries. */
static void maps_agree_with_their_definitions(void **state) {
    static const double rdbu[11][3] = {
        {103, 0, 31},    {178, 24, 43},   {214, 96, 77},   {244, 165, 130},
        {253, 219, 199}, {247, 247, 247}, {209, 229, 240}, {146, 197, 222},
        {67, 147, 195},  {33, 102, 172},  {5, 48, 97}};
    static const double seismic[5][3] = {
        {0, 0, 76.5}, {0, 0, 255}, {255, 255, 255}, {255, 0, 0}, {127.5, 0, 0}};
    static const double bwr[3][3] = {{0, 0, 255}, {255, 255, 255}, {255, 0, 0}};
    const struct {
        const char *names[2];
        const double (*table)[3];
        int count;
    } maps[] = {{{"RdBu", "rdbu_r"}, rdbu, 11},
                {{"seismic", "seismic_r"}, seismic, 5},
                {{"bwr", "BWR_R"}, bwr, 3}};
    static const snow_opacity_point one = {0, 1};
    looks_fixture *f = *state;
    for (int m = 0; m < 6; m++) {
        snow_color_point points[SNOW_COLORMAP_POINTS_MAX];
        int index = snow_colormap_from_name(maps[m / 2].names[m % 2]);
        assert_true(index >= 0);
        size_t count = snow_colormap_points((size_t)index, points,
                                            SNOW_COLORMAP_POINTS_MAX);
        snow_transfer *transfer = looks_of_points(f, points, count, &one, 1);
        for (int n = 0; n < 256; n++) {
            double rgba[4], at = (m % 2 ? 255 - n : n) / 255.0;
            double place = at * (maps[m / 2].count - 1);
            int below = (int)fmin(floor(place), maps[m / 2].count - 2);
            snow_transfer_evaluate(transfer, n / 255.0, rgba);
            for (int c = 0; c < 3; c++) {
                double a = maps[m / 2].table[below][c];
                double b = maps[m / 2].table[below + 1][c];
                double wanted = a + (b - a) * (place - below);
                assert_true(fabs(255 * rgba[c] - wanted) <= 1);
            }
        }
    }
    assert_int_equal(snow_colormap_from_name("viridis_q"), -1);
}

/* The type, and its table of counts, must not matter. */
static void counted_types_give_the_same_look_by_decades(void **state) {
    int16_t narrow[400];
    double wide[400];
    uint64_t seed = 3;
    for (int i = 0; i < 400; i++)
        wide[i] = narrow[i] =
            (int16_t)(pow(10, 4.4 * support_uniform(&seed)) - 5);
    looks_fixture *f = *state;
    snow_volume *a = looks_row(f, SNOW_TYPE_INT16, narrow, 400);
    snow_volume *b = looks_row(f, SNOW_TYPE_FLOAT64, wide, 400);
    snow_look look = {.log = true};
    snow_transfer *first = looks_of(f, a, look), *second = looks_of(f, b, look);
    assert_string_equal(snow_transfer_description(first),
                        snow_transfer_description(second));
    for (int i = 0; i < 400; i++)
        assert_true(looks_opacity(first, wide[i]) ==
                    looks_opacity(second, wide[i]));
}

static void odd_volumes_have_a_logarithmic_look_too(void **state) {
    const float odd[][3] = {{0, 0, 0},      {-1, -2, -3},
                            {5, 5, 5},      {NAN, NAN, NAN},
                            {0, 0, 1e-40F}, {1e-40F, 1, 3e38F}};
    looks_fixture *f = *state;
    for (size_t i = 0; i < sizeof odd / sizeof *odd; i++) {
        snow_volume *volume = looks_row(f, SNOW_TYPE_FLOAT32, odd[i], 3);
        for (size_t p = 0; p < 4; p++) {
            snow_look look = {.log = true,
                              .preset = p == 1   ? "linear"
                                        : p == 2 ? "mr-angio"
                                                 : NULL,
                              .colormap = p == 3 ? "turbo" : NULL};
            looks_of(f, volume, look);
        }
    }
}

/* --- points as data ------------------------------------------------------- */

static const snow_color_point red_blue[] = {{0, 1, 0, 0}, {1, 0, 0, 1}};
static const snow_opacity_point half[] = {{0, 0}, {1, 0.5}};

static void points_in_data_units_stay_where_they_are(void **state) {
    const snow_color_point colors[] = {{20, 1, 0, 0}, {40, 0, 0, 1}};
    const snow_opacity_point opacities[] = {{10, 0}, {50, 0.5}};
    const snow_opacity_point gradients[] = {{0, 0}, {4, 1}};
    const uint8_t bytes[] = {0, 255};
    const snow_look points = {.size = sizeof points,
                              .name = "mine",
                              .colors = colors,
                              .color_count = 2,
                              .opacities = opacities,
                              .opacity_count = 2,
                              .gradient_opacities = gradients,
                              .gradient_opacity_count = 2};
    looks_fixture *f = *state;
    snow_volume *volume = looks_row(f, SNOW_TYPE_UINT8, bytes, 2);
    snow_transfer *transfer = looks_of(f, volume, (snow_look){.base = &points});
    assert_true(near(looks_opacity(transfer, 30), 0.25));
    assert_true(near(looks_red(transfer, 30), 0.5));
    assert_true(near(snow_transfer_evaluate_gradient(transfer, 2), 0.5));
    assert_true(looks_say(transfer, "mine 10..50"));
    /* The same without a base: a look with colours stands for a preset. */
    transfer = looks_of(f, volume, points);
    assert_true(near(looks_opacity(transfer, 30), 0.25));
    assert_true(near(looks_red(transfer, 30), 0.5));
    assert_true(near(snow_transfer_evaluate_gradient(transfer, 2), 0.5));
    assert_true(
        looks_say(transfer, "mine 10..50; opacity 0 at 10, 0.5 at 50 (as "));
    /* Over twice the range gradients are half as steep. */
    transfer = looks_of(f, volume,
                        (snow_look){.base = &points,
                                    .range = SNOW_RANGE_VALUES,
                                    .low = 100,
                                    .high = 180});
    assert_true(near(looks_opacity(transfer, 140), 0.25));
    assert_true(near(looks_red(transfer, 120), 1));
    assert_true(near(snow_transfer_evaluate_gradient(transfer, 2), 0.25));
}

static void two_sources_of_colours_are_refused(void **state) {
    const uint8_t bytes[] = {0, 255};
    const snow_look base = {
        .size = sizeof base, .colors = red_blue, .color_count = 2};
    const snow_look looks[] = {
        {.preset = "linear", .base = &base},
        {.preset = "linear", .colors = red_blue, .color_count = 2},
        {.base = &base, .domain = SNOW_DOMAIN_RANGE}};
    looks_fixture *f = *state;
    snow_volume *volume = looks_row(f, SNOW_TYPE_UINT8, bytes, 2);
    for (int n = 0; n < 3; n++)
        looks_refused(f, volume, looks[n], "only one of");
}

static void points_without_values_are_spread(void **state) {
    const uint8_t bytes[] = {50, 150};
    const snow_look points = {.size = sizeof points,
                              .name = "mine",
                              .domain = SNOW_DOMAIN_RANGE,
                              .colors = red_blue,
                              .color_count = 2,
                              .opacities = half,
                              .opacity_count = 2};
    snow_look colors_only = points;
    colors_only.opacity_count = 0;
    looks_fixture *f = *state;
    snow_volume *volume = looks_row(f, SNOW_TYPE_UINT8, bytes, 2);
    snow_transfer *transfer = looks_of(f, volume, (snow_look){.base = &points});
    assert_true(near(looks_opacity(transfer, 100), 0.25));
    assert_true(near(looks_red(transfer, 75), 0.75));
    transfer = looks_of(f, volume, (snow_look){.base = &colors_only});
    snow_transfer *automatic = looks_of(f, volume, (snow_look){.preset = NULL});
    assert_true(
        near(looks_opacity(transfer, 150), looks_opacity(automatic, 150)));
    assert_true(looks_red(transfer, 150) == 0);
}

/* More than drafts of our own have. */
static void hundreds_of_points_are_taken(void **state) {
    snow_color_point colors[700];
    snow_opacity_point opacities[900];
    for (int i = 0; i < 700; i++)
        colors[i] = (snow_color_point){i, i / 700.0, 0, 0};
    for (int i = 0; i < 900; i++)
        opacities[i] = (snow_opacity_point){i, i % 2};
    const float values[] = {0, 1000};
    const snow_look points = {.size = sizeof points,
                              .name = "many",
                              .colors = colors,
                              .color_count = 700,
                              .opacities = opacities,
                              .opacity_count = 900};
    looks_fixture *f = *state;
    snow_volume *volume = looks_row(f, SNOW_TYPE_FLOAT32, values, 2);
    snow_transfer *transfer = looks_of(f, volume, (snow_look){.base = &points});
    assert_true(near(looks_opacity(transfer, 655.25), 0.75));
    assert_true(near(looks_red(transfer, 350), 0.5));
}

static void presets_and_colour_maps_are_data(void **state) {
    snow_color_point points[SNOW_COLORMAP_POINTS_MAX];
    (void)state;
    for (size_t i = 0; snow_preset_name(i); i++) {
        const snow_look *preset = snow_preset_look(i);
        if (!strcmp(snow_preset_name(i), "labels")) /* made of a volume */
            continue;
        assert_true(preset->color_count && preset->opacity_count);
        size_t clear = preset->domain == SNOW_DOMAIN_SYMMETRIC
                           ? preset->opacity_count / 2
                           : 0;
        assert_true(preset->opacities[clear].opacity == 0);
    }
    assert_null(snow_preset_look(1000));
    for (size_t i = 0; snow_colormap_name(i); i++) {
        size_t count =
            snow_colormap_points(i, points, SNOW_COLORMAP_POINTS_MAX);
        assert_in_range(count, 2, SNOW_COLORMAP_POINTS_MAX);
        assert_true(points[0].value == 0 && points[count - 1].value == 1);
    }
    assert_int_equal(snow_colormap_points(1000, points, 1), 0);
}

/* Tableau's ten, in equal steps. */
static void categories_are_not_mixed(void **state) {
    static const unsigned rgb[10] = {0x1f77b4, 0xff7f0e, 0x2ca02c, 0xd62728,
                                     0x9467bd, 0x8c564b, 0xe377c2, 0x7f7f7f,
                                     0xbcbd22, 0x17becf};
    const float values[] = {0, 10};
    looks_fixture *f = *state;
    snow_volume *volume = looks_row(f, SNOW_TYPE_FLOAT32, values, 2);
    snow_transfer *transfer = looks_of(
        f, volume, (snow_look){.preset = "linear", .colormap = "tab10"});
    for (int i = 0; i < 100; i++) {
        double found[4];
        snow_transfer_evaluate(transfer, i / 10.0 + 0.05, found);
        for (int c = 0; c < 3; c++)
            assert_true(
                near(found[c], (rgb[i / 10] >> (16 - 8 * c) & 255) / 255.0));
    }
}

/* --- volumes without surfaces --------------------------------------------- */

/* Of a scan: without the modality they would be a computed field. */
static snow_transfer *look_at_block(looks_fixture *f, const float *values,
                                    int64_t x, int64_t y, int64_t z) {
    const snow_volume_info info = {
        .dims = {x, y, z}, .type = SNOW_TYPE_FLOAT32, .modality = "MR"};
    return looks_of(f, looks_volume(f, info, values), (snow_look){0});
}

/* Twelve dice make one heap. */
static void fill_heap(float *values, int count, double middle, double width) {
    uint64_t seed = 4;
    for (int i = 0; i < count; i++) {
        double sum = 0;
        for (int n = 0; n < 12; n++)
            sum += support_uniform(&seed) - 0.5;
        values[i] = (float)(middle + width * sum);
    }
}

static void one_heap_of_values_is_a_solid_block(void **state) {
    static float values[20 * 20 * 20], left[20 * 20 * 20];
    looks_fixture *f = *state;
    fill_heap(values, 8000, 100, 10);
    snow_transfer *transfer = look_at_block(f, values, 20, 20, 20);
    assert_true(snow_transfer_is_unshaded(transfer));
    assert_true(looks_opacity(transfer, 100) > 0.3);
    assert_true(looks_red(transfer, 100) > 0.3 &&
                looks_red(transfer, 100) < 0.7);
    /* Densities about a mean of 0 are not. */
    fill_heap(values, 8000, 0, 10);
    transfer = look_at_block(f, values, 20, 20, 20);
    assert_false(snow_transfer_is_unshaded(transfer));
    assert_true(looks_opacity(transfer, -5) == 0);
    /* An object in its background is not. */
    for (int i = 0; i < 8000; i++)
        values[i] = i % 3 ? 0 : 100 + (float)(i % 7);
    transfer = look_at_block(f, values, 20, 20, 20);
    assert_false(snow_transfer_is_unshaded(transfer));
    /* Of two organs that a mask has left, the noise of one is not split. */
    fill_heap(left, 3000, 900, 20);
    fill_heap(left + 3000, 600, 50, 20);
    for (int i = 3600; i < 8000; i++)
        left[i] = NAN;
    transfer = look_at_block(f, left, 20, 20, 20);
    assert_false(snow_transfer_is_unshaded(transfer));
    assert_true(looks_opacity(transfer, 860) > 0.25);
    /* A slice is a picture, whatever its values. */
    transfer = look_at_block(f, values, 80, 100, 1);
    assert_true(snow_transfer_is_unshaded(transfer));
    assert_true(looks_opacity(transfer, 100) == 1);
    /* So are two, and not five of few rows. */
    transfer = look_at_block(f, values, 2, 50, 80);
    assert_true(snow_transfer_is_unshaded(transfer));
    assert_true(looks_opacity(transfer, 100) == 1);
    transfer = look_at_block(f, values, 50, 32, 5);
    assert_false(snow_transfer_is_unshaded(transfer));
}

/* --- what a volume says of itself ----------------------------------------- */

static snow_transfer *look_at_patient(looks_fixture *f, const void *voxels,
                                      snow_volume_info info, snow_look look) {
    info.dims[0] = info.dims[1] = 20;
    info.dims[2] = info.dims[2] ? info.dims[2] : 20;
    return looks_of(f, looks_volume(f, info, voxels), look);
}

/* Tissue, with bone or without, in air. */
static void fill_ct(int16_t voxels[8000], bool bone) {
    for (int i = 0; i < 8000; i++)
        voxels[i] = (int16_t)(i % 2   ? i % 30 - 1000
                              : !bone ? i % 60
                              : i % 3 ? 40
                                      : 700);
}

static void ct_in_hounsfield_units_has_a_look_of_ct(void **state) {
    static int16_t ct[8000], soft[8000], shifted[8000];
    static uint8_t bytes[8000];
    const snow_volume_info patient = {.type = SNOW_TYPE_INT16, .medical = true};
    snow_volume_info named = patient, thing = patient, slab = patient;
    snow_volume_info eight = {.type = SNOW_TYPE_UINT8, .medical = true};
    looks_fixture *f = *state;
    fill_ct(ct, true);
    fill_ct(soft, false);
    for (int i = 0; i < 8000; i++) {
        shifted[i] = (int16_t)(ct[i] + 1024);
        bytes[i] = (uint8_t)(i % 2 ? i % 9 : 200);
    }
    slab.dims[2] = 4;
    thing.medical = false;
    memcpy(named.modality, "MR", 3);
    const struct {
        const void *voxels;
        const snow_volume_info *info;
        const char *words;
    } cases[] = {{ct, &patient, "(ct-bone, for Houn"},
                 {soft, &patient, "(ct-soft, for Houn"},
                 {ct, &slab, "(ct-soft, for Houn"},
                 {shifted, &patient, "from the histogram"},
                 {bytes, &eight, "from the histogram"},
                 {ct, &thing, "from the histogram"},
                 {ct, &named, "from the histogram"}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++)
        assert_true(looks_say(
            look_at_patient(f, cases[n].voxels, *cases[n].info, (snow_look){0}),
            cases[n].words));
    /* Values of 8 bits are none of those units: the object's are used. */
    snow_transfer *transfer =
        look_at_patient(f, bytes, eight, (snow_look){.preset = "ct-bone"});
    assert_true(looks_opacity(transfer, 8) == 0);
    assert_true(near(looks_opacity(transfer, 200), 0.85));
    /* So are those that a mask has left. */
    static float floats[8000];
    for (int i = 0; i < 8000; i++)
        floats[i] = bytes[i];
    eight.type = SNOW_TYPE_FLOAT32;
    eight.eight_bits = true;
    transfer =
        look_at_patient(f, floats, eight, (snow_look){.preset = "ct-bone"});
    assert_true(near(looks_opacity(transfer, 200), 0.85));
}

/* A range that is asked for is that of a grey look, and the look that was found
 * makes the same one. */
static void what_is_known_of_an_automatic_look_makes_it_again(void **state) {
    static int16_t ct[8000];
    const snow_volume_info patient = {.type = SNOW_TYPE_INT16, .medical = true};
    looks_fixture *f = *state;
    fill_ct(ct, true);
    assert_true(looks_say(
        look_at_patient(
            f, ct, patient,
            (snow_look){.range = SNOW_RANGE_VALUES, .low = 0, .high = 800}),
        "from the histogram"));
    snow_transfer *found =
        look_at_patient(f, ct, patient, (snow_look){.low = 0});
    snow_look look = {.size = sizeof look};
    assert_int_equal(snow_transfer_get_look(found, &look), SNOW_STATUS_OK);
    assert_string_equal(look.name, "ct-bone");
    snow_transfer *again = look_at_patient(f, ct, patient, look);
    for (double value = -1000; value < 800; value += 50)
        assert_true(looks_opacity(found, value) ==
                        looks_opacity(again, value) &&
                    looks_red(found, value) == looks_red(again, value));
}

static void a_projection_survives_a_hot_voxel(void **state) {
    static uint16_t voxels[8000 * 5];
    looks_fixture *f = *state;
    snow_volume_info info = {.type = SNOW_TYPE_UINT16, .dims = {0, 0, 100}};
    const snow_look look = {.preset = "linear", .range = SNOW_RANGE_ROBUST};
    for (int i = 0; i < 40000; i++)
        voxels[i] = (uint16_t)(i % 301);
    snow_transfer *transfer = look_at_patient(f, voxels, info, look);
    assert_true(near(looks_opacity(transfer, 300), 1)); /* nothing is cut */
    assert_true(looks_say(transfer, "(linear)"));
    voxels[777] = 60000;
    transfer = look_at_patient(f, voxels, info, look);
    assert_true(near(looks_opacity(transfer, 300), 1));
    assert_true(near(looks_opacity(transfer, 150), 0.5));
    assert_true(
        looks_say(transfer, "few values outside, the data are 0..60000"));
    info.window[0] = 100, info.window[1] = 200;
    transfer = look_at_patient(f, voxels, info, look);
    assert_true(near(looks_opacity(transfer, 150), 0.5));
    assert_true(near(looks_opacity(transfer, 200), 1));
    assert_true(looks_say(transfer, "the file's own window"));
    info.dims[2] = 1; /* a slice takes it by itself */
    transfer = look_at_patient(f, voxels, info, (snow_look){.low = 0});
    assert_true(looks_red(transfer, 100) == 0 &&
                looks_red(transfer, 200) > 0.9);
    assert_true(looks_say(transfer, "the file's own window"));
}

/* One of a file without modality (NIfTI) counts if 1 % of the voxels lie in it,
 * and reach over 1 % of it; the look of a body is made of those, unless a range
 * or preset is given. */
static void a_window_of_a_program_bounds_the_look(void **state) {
    static uint16_t voxels[8000];
    static const struct {
        double window[2];
        const char *modality;
        snow_range range;
        bool taken;
    } rows[] = {{{0, 1000}, "", SNOW_RANGE_AUTO, true},
                {{0, 1000}, "MR", SNOW_RANGE_AUTO, false},
                {{0, 1000}, "", SNOW_RANGE_FULL, false},
                {{600, 800}, "", SNOW_RANGE_AUTO, false}, /* 79 voxels */
                {{0, 1e6}, "", SNOW_RANGE_AUTO, false},   /* one grey */
                {{0, 9000}, "", SNOW_RANGE_AUTO, false}}; /* all of them */
    looks_fixture *f = *state;
    for (int i = 0; i < 8000; i++)
        voxels[i] = (uint16_t)(i < 6000   ? i % 100
                               : i < 6079 ? 700
                                          : 900 + (i * 7 % 1600));
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        snow_volume_info info = {.type = SNOW_TYPE_UINT16};
        double low, high;
        memcpy(info.window, rows[n].window, sizeof info.window);
        strcpy(info.modality, rows[n].modality);
        snow_transfer *transfer = look_at_patient(
            f, voxels, info, (snow_look){.range = rows[n].range});
        snow_transfer_domain(transfer, &low, &high);
        assert_true((high <= 1000) == rows[n].taken);
        assert_true(looks_say(transfer, "the file's own window") ==
                    rows[n].taken);
        transfer = look_at_patient(
            f, voxels, info,
            (snow_look){.preset = "linear", .range = SNOW_RANGE_ROBUST});
        assert_true(looks_say(transfer, "the file's own window") ==
                    (rows[n].window[0] == 0 && rows[n].window[1] < 1e6));
    }
}

/* Colours of one's own lie where they are, whatever the range and the scale. */
static void a_list_of_colours_is_a_map(void **state) {
    static const float values[] = {1, 10, 100, 1000};
    looks_fixture *f = *state;
    snow_volume *volume = looks_row(f, SNOW_TYPE_FLOAT32, values, 4);
    for (int kind = 0; kind < 4; kind++) {
        snow_look look = {.preset = kind == 1 ? "ct-bone" : NULL,
                          .range =
                              kind > 1 ? SNOW_RANGE_VALUES : SNOW_RANGE_AUTO,
                          .low = 5,
                          .high = 700,
                          .log = kind == 3,
                          .colormap = "10:#000000,100:#ff3300,1e3:#ff33FF"};
        snow_transfer *transfer = looks_of(f, volume, look);
        double rgba[4], ends[2];
        const double middle = kind == 3 ? sqrt(1e3) : 55;
        snow_transfer_evaluate(transfer, middle, rgba);
        assert_true(near(rgba[0], 0.5) && near(rgba[1], 0.1) && rgba[2] == 0);
        snow_transfer_evaluate(transfer, 5, rgba);
        assert_true(rgba[0] == 0);
        snow_transfer_evaluate(transfer, 1000, rgba);
        assert_true(near(rgba[0], 1) && near(rgba[1], 0.2) && near(rgba[2], 1));
        snow_transfer_domain(transfer, &ends[0], &ends[1]);
        assert_true(near(ends[0], 10) && near(ends[1], 1000));
        assert_true(looks_say(transfer, "own colours 10..1000"));
    }
}

/* Maps by their names with _r, presets by the name for any. */
static void reversed_colours_at_t_are_those_of_1_minus_t(void **state) {
    static const double row[] = {-300, 0, 40, 250, 1200};
    static const char *const presets[] = {"ct-bone", "ct-cropped-volume-bone",
                                          "ct-aaa", "mr-default", "signed"};
    looks_fixture *f = *state;
    snow_volume *volume = looks_row(f, SNOW_TYPE_FLOAT64, row, 5);
    size_t maps = 0;
    while (snow_colormap_name(maps))
        maps++;
    for (size_t i = 0; i < maps + 5; i++) {
        const char *name = i < maps ? snow_colormap_name(i) : NULL;
        char other[40];
        snow_look look = {.preset = i < maps ? "linear" : presets[i - maps],
                          .colormap = name};
        const snow_transfer *plain = looks_of(f, volume, look);
        snprintf(other, sizeof other, name ? "%s_r" : "Reversed%s",
                 name ? name : "");
        look.colormap = other;
        const snow_transfer *turned = looks_of(f, volume, look);
        double low, high, a[4], b[4];
        snow_transfer_domain(plain, &low, &high);
        for (int n = 0; n <= 200; n++) {
            const double at = n / 200.0 + (n % 20 ? 0 : 1e-7); /* no step */
            snow_transfer_evaluate(plain, low + at * (high - low), a);
            snow_transfer_evaluate(turned, high - at * (high - low), b);
            for (int c = 0; c < 3; c++)
                assert_true(fabs(a[c] - b[c]) < 1e-6);
            snow_transfer_evaluate(turned, low + at * (high - low), b);
            assert_true(fabs(a[3] - b[3]) < 1e-12); /* opacities stay */
        }
    }
}

static void what_is_no_list_of_colours_is_refused(void **state) {
    static const char *const wrong[] = {
        "",          ":",           "1:",          "1:#",
        "1:#12345",  "1:#1234567",  "1:#12345g",   "1:123456",
        ":#123456",  "a:#123456",   "nan:#123456", "1:#123456,",
        ",1:#12345", "2:#0,1:#0",   "1:# 12345",   "2:#123456,1:#123456",
        "1:#0x1234", "1:#123456 ,", "inf:#123456", "1:#123456;2:#123456"};
    char many[1000] = "", *at = many;
    (void)state;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        assert_int_equal(snow_colormap_from_name(wrong[i]), -1);
    for (int i = 0; i < 33; i++) {
        if (i == SNOW_COLORMAP_POINTS_MAX)
            assert_true(snow_colormap_from_name(many) >= 0);
        at += sprintf(at, "%s%d:#123456", i ? "," : "", i);
    }
    assert_int_equal(snow_colormap_from_name(many), -1);
    assert_true(snow_colormap_from_name("-5:#123456") >= 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        LOOKS_TEST(linear_over_decades_is_linear_in_decades),
        LOOKS_TEST(a_range_is_spread_by_decades),
        LOOKS_TEST(a_field_of_both_signs_is_diverging_around_0),
        LOOKS_TEST(a_scan_in_floats_is_grey_and_shaded),
        LOOKS_TEST(a_field_is_a_veil_in_colours),
        LOOKS_TEST(a_field_below_0_stands_out_downward),
        LOOKS_TEST(maps_agree_with_their_definitions),
        LOOKS_TEST(a_symmetric_logarithm_is_linear_around_0),
        LOOKS_TEST(a_symmetric_logarithm_begins_where_it_says),
        LOOKS_TEST(logarithms_say_what_they_leave_out),
        LOOKS_TEST(what_has_no_logarithm_is_refused),
        LOOKS_TEST(counted_types_give_the_same_look_by_decades),
        LOOKS_TEST(odd_volumes_have_a_logarithmic_look_too),
        LOOKS_TEST(points_in_data_units_stay_where_they_are),
        LOOKS_TEST(points_without_values_are_spread),
        LOOKS_TEST(two_sources_of_colours_are_refused),
        LOOKS_TEST(hundreds_of_points_are_taken),
        cmocka_unit_test(presets_and_colour_maps_are_data),
        LOOKS_TEST(categories_are_not_mixed),
        LOOKS_TEST(ct_in_hounsfield_units_has_a_look_of_ct),
        LOOKS_TEST(what_is_known_of_an_automatic_look_makes_it_again),
        LOOKS_TEST(a_projection_survives_a_hot_voxel),
        LOOKS_TEST(a_window_of_a_program_bounds_the_look),
        LOOKS_TEST(one_heap_of_values_is_a_solid_block),
        LOOKS_TEST(a_list_of_colours_is_a_map),
        LOOKS_TEST(reversed_colours_at_t_are_those_of_1_minus_t),
        cmocka_unit_test(what_is_no_list_of_colours_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
