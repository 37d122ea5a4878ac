/* tests/stages/test_codes.c - codes and palettes against plain computations in
 * double: which voxels are interesting, what a code stands for, what it looks
 * like. */
#include "support/volumes.h"

#include "base/exp_log.h"
#include "classify/codes.h"

#include <float.h>
#include <math.h>

static const snow_color_point black[] = {{0, 0, 0, 0}};

typedef struct scene {
    snow_context *context;
    snow_volume *volume;
    snow_transfer *transfer;
} scene;

static scene scene_of(snow_type type, double slope, double intercept,
                      const snow_color_point *colors, size_t color_count,
                      const snow_opacity_point *opacities,
                      size_t opacity_count) {
    static const double voxel[1];
    snow_volume_info info = {.size = sizeof info,
                             .dims = {1, 1, 1},
                             .type = type,
                             .slope = slope,
                             .intercept = intercept};
    scene s = {.context = support_context()};
    assert_int_equal(snow_volume_wrap(s.context, &info, voxel, &s.volume),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_transfer_new(s.context, colors, color_count,
                                       opacities, opacity_count, &s.transfer),
                     SNOW_STATUS_OK);
    return s;
}

static void scene_end(scene *s) {
    snow_transfer_free(s->transfer);
    snow_volume_close(s->volume);
    snow_context_free(s->context);
}

static snow_quantizer coder_of(const scene *s, double threshold) {
    snow_quantizer quantizer = {.keep = NULL};
    assert_int_equal(snow_quantizer_make(s->context, s->volume, s->transfer,
                                         threshold, &quantizer),
                     SNOW_STATUS_OK);
    return quantizer;
}

/* The rule, written once more. */
static bool above(double opacity, double threshold) {
    return opacity > 0 &&
           (threshold <= 0 || 255 * opacity > threshold + 0.0001);
}

static double data_of(const scene *s, double native) {
    return s->volume->info.slope * native + s->volume->info.intercept;
}

/* Opacities with ramps, plateaus, steps and gaps. */
static const snow_opacity_point rough[] = {
    {-100, 0.3}, {-60, 0},     {-60, 0.5}, {-20, 0},   {10, 0},
    {10, 1},     {12, 1},      {12, 0},    {30, 0},    {31, 0.2},
    {40, 0},     {77, 0.0005}, {90, 0.05}, {90, 0.01}, {120, 0.01}};
#define ROUGH (sizeof rough / sizeof *rough)

/* --- 8 and 16 bits -------------------------------------------------------- */

static void check_narrow(snow_type type, double slope, double intercept,
                         double threshold) {
    scene s = scene_of(type, slope, intercept, black, 1, rough, ROUGH);
    snow_quantizer quantizer = coder_of(&s, threshold);
    int32_t lowest = type == SNOW_TYPE_INT8    ? -128
                     : type == SNOW_TYPE_INT16 ? -32768
                                               : 0;
    assert_int_equal(quantizer.bytes, snow_type_size(type));
    assert_int_equal(quantizer.codes, quantizer.bytes == 1 ? 256 : 65536);
    assert_int_equal(quantizer.lowest, lowest);
    int runs = 0, in_runs = 0, kept = 0;
    for (size_t code = 0; code < quantizer.codes; code++) {
        double native = lowest + (double)code, data = data_of(&s, native);
        bool expected =
            above(snow_transfer_opacity(s.transfer, data), threshold);
        uint16_t found;
        assert_int_equal(quantizer.keep[code], expected);
        assert_int_equal(snow_quantizer_code(&quantizer, native, &found),
                         expected);
        assert_int_equal(found, code);
        assert_true(snow_quantizer_value(&quantizer, code) == data);
        runs += expected && !(code && quantizer.keep[code - 1]);
        kept += expected;
    }
    assert_true(kept > 0);
    assert_int_equal(quantizer.run_count, runs <= SNOW_KEPT_RUNS ? runs : -1);
    for (int n = 0; n < quantizer.run_count; n++) {
        in_runs += quantizer.runs[n].last - quantizer.runs[n].first + 1;
        for (int code = quantizer.runs[n].first; code <= quantizer.runs[n].last;
             code++)
            assert_true(quantizer.keep[code]);
    }
    assert_true(quantizer.run_count < 0 || in_runs == kept);
    snow_quantizer_fini(s.context, &quantizer);
    scene_end(&s);
}

static void every_value_of_8_and_16_bits_has_its_own_code(void **state) {
    (void)state;
    for (snow_type type = SNOW_TYPE_INT8; type <= SNOW_TYPE_UINT16; type++) {
        double step = snow_type_size(type) == 1 ? 1 : 0.00390625;
        for (int t = 0; t < 3; t++) {
            double threshold = (const double[]){0, 2.55, 60}[t];
            check_narrow(type, step, 0.25, threshold);
            check_narrow(type, -step, 70, threshold);
            check_narrow(type, step / 3, -7.1, threshold);
        }
    }
}

static void many_runs_are_told_by_the_table_alone(void **state) {
    (void)state;
    snow_opacity_point comb[400];
    for (int n = 0; n < 400; n++)
        comb[n] = (snow_opacity_point){n / 2, n % 4 == 1 || n % 4 == 2};
    scene s = scene_of(SNOW_TYPE_UINT8, 1, 0, black, 1, comb, 400);
    snow_quantizer quantizer = coder_of(&s, 0);
    assert_int_equal(quantizer.run_count, -1);
    for (size_t code = 0; code < 256; code++)
        assert_int_equal(quantizer.keep[code],
                         snow_transfer_opacity(s.transfer, (double)code) > 0);
    snow_quantizer_fini(s.context, &quantizer);
    scene_end(&s);
}

/* --- wider types ---------------------------------------------------------- */

/* Holds one native value's code against the transfer function. */
static void check_wide_value(const scene *s, const snow_quantizer *quantizer,
                             double threshold, double native, double bound) {
    double data = data_of(s, native), exact[4], coded[4];
    uint16_t code = 7;
    snow_transfer_evaluate(s->transfer, data, exact);
    bool interesting = snow_quantizer_code(quantizer, native, &code);
    assert_int_equal(interesting, above(exact[3], threshold));
    if (!interesting)
        return;
    snow_transfer_evaluate(s->transfer, snow_quantizer_value(quantizer, code),
                           coded);
    for (int i = 0; i < 4; i++)
        if (!(fabs(exact[i] - coded[i]) <= bound))
            fail_msg("channel %d of %.17g (code %d) is %.9g, not %.9g", i, data,
                     code, coded[i], exact[i]);
}

/* Holds what each code stands for against the stretch it is dealt out to. */
static void check_wide_codes(const snow_quantizer *quantizer) {
    size_t inside = (quantizer->stop_count - 1) * quantizer->stretch_codes;
    assert_true(inside + 2 <= quantizer->codes);
    assert_true(snow_quantizer_value(quantizer, 0) < quantizer->stops[0]);
    for (size_t code = 1; code < quantizer->codes; code++) {
        double value = snow_quantizer_value(quantizer, code);
        if (code > inside) {
            assert_true(value == quantizer->stops[quantizer->stop_count - 1]);
            continue;
        }
        size_t stretch = (code - 1) / quantizer->stretch_codes;
        assert_true(value >= quantizer->stops[stretch]);
        assert_true(value < quantizer->stops[stretch + 1]);
    }
}

/* Values all over, at each control value and beside it, and no numbers. */
static void check_wide(snow_type type, double slope, double intercept,
                       const snow_color_point *colors, size_t color_count,
                       const snow_opacity_point *points, size_t count) {
    scene s =
        scene_of(type, slope, intercept, colors, color_count, points, count);
    double bound = 0.5 * (double)(color_count + count) / 65000;
    double low = points[0].value, high = points[count - 1].value;
    for (int t = 0; t < 2; t++) {
        double threshold = t ? 12.75 : 0;
        snow_quantizer quantizer = coder_of(&s, threshold);
        uint64_t seed = 11;
        assert_int_equal(quantizer.bytes, 2);
        assert_null(quantizer.keep);
        check_wide_codes(&quantizer);
        for (int n = 0; n < 20000; n++) {
            double part = 1.2 * support_uniform(&seed) - 0.1;
            double data = low * (1 - part) + high * part;
            check_wide_value(&s, &quantizer, threshold,
                             (data - intercept) / slope, bound);
        }
        for (size_t n = 0; n < count; n++) {
            double native = (points[n].value - intercept) / slope;
            double beside[] = {native, nextafter(native, INFINITY),
                               nextafter(native, -INFINITY)};
            for (int i = 0; i < 3; i++)
                check_wide_value(&s, &quantizer, threshold, beside[i], bound);
        }
        check_wide_value(&s, &quantizer, threshold, INFINITY, bound);
        check_wide_value(&s, &quantizer, threshold, -INFINITY, bound);
        check_wide_value(&s, &quantizer, threshold, NAN, bound);
        check_wide_value(&s, &quantizer, threshold, 0, bound);
        check_wide_value(&s, &quantizer, threshold, -0.0, bound);
        snow_quantizer_fini(s.context, &quantizer);
    }
    scene_end(&s);
}

static const snow_color_point colorful[] = {{-80, 0.9, 0.3, 0.1},
                                            {11, 0.2, 0.8, 0.5},
                                            {11, 0.4, 0.1, 0.9},
                                            {11.000001, 1.0, 0.9, 0.2},
                                            {200, 0.0, 1.0, 0.2}};

static void codes_of_wide_types_keep_to_their_stretch(void **state) {
    (void)state;
    check_wide(SNOW_TYPE_FLOAT32, 1, 0, colorful, 5, rough, ROUGH);
    check_wide(SNOW_TYPE_FLOAT64, -0.37, 12.5, colorful, 5, rough, ROUGH);
    check_wide(SNOW_TYPE_INT32, 0.001, -3, colorful, 5, rough, ROUGH);
}

static void steep_tiny_and_huge_stretches_are_exact_too(void **state) {
    (void)state;
    const snow_opacity_point steep[] = {
        {1, 0}, {1 + 1e-15, 1}, {2, 0.5}, {2, 0}, {3, 1}};
    check_wide(SNOW_TYPE_FLOAT64, 1, 0, black, 1, steep, 5);
    const snow_opacity_point tiny[] = {
        {-4e-323, 0.25}, {0, 1}, {5e-324, 0}, {3e-320, 1}, {2e-310, 0.5}};
    check_wide(SNOW_TYPE_FLOAT64, 1, 0, black, 1, tiny, 5);
    const snow_opacity_point huge[] = {
        {-DBL_MAX, 0}, {-1e300, 1}, {1e300, 0.2}, {1e300, 0}, {DBL_MAX, 1}};
    check_wide(SNOW_TYPE_FLOAT64, 1, 0, black, 1, huge, 5);
    const snow_opacity_point one[] = {{5, 0.5}};
    check_wide(SNOW_TYPE_FLOAT32, 1, 0, black, 1, one, 1);
    const snow_color_point same[] = {{5, 0.1, 0.2, 0.3}};
    check_wide(SNOW_TYPE_FLOAT32, 1, 0, same, 1, one, 1);
    const snow_opacity_point nothing[] = {{5, 0}, {6, 0}};
    check_wide(SNOW_TYPE_FLOAT32, 1, 0, black, 1, nothing, 2);
}

/* Ramps, steps and gaps over many decades. */
static const snow_opacity_point decades[] = {
    {1e-3, 0}, {0.5, 0.4}, {0.5, 0}, {3, 0},      {10, 0.9},
    {1e4, 0},  {1e5, 0},   {1e5, 1}, {1e5, 0.02}, {1e9, 0.06}};
#define DECADES (sizeof decades / sizeof *decades)

/* Values of which each decade has as many. */
static void check_wide_log(snow_type type, double slope, double intercept,
                           double threshold) {
    const snow_color_point colors[] = {{0.01, 0, 1, 0.5}, {1e8, 1, 0, 0.5}};
    scene s = scene_of(type, slope, intercept, colors, 2, decades, DECADES);
    assert_int_equal(snow_transfer_set_log(s.transfer), SNOW_STATUS_OK);
    snow_quantizer quantizer = coder_of(&s, threshold);
    double bound = 0.5 * (double)(2 + DECADES) / 65000;
    uint64_t seed = 5;
    check_wide_codes(&quantizer);
    for (int n = 0; n < 40000; n++) {
        double data = pow(10, 14 * support_uniform(&seed) - 4);
        check_wide_value(&s, &quantizer, threshold, (data - intercept) / slope,
                         bound);
        check_wide_value(&s, &quantizer, threshold, (-data - intercept) / slope,
                         bound);
    }
    for (size_t n = 0; n < DECADES; n++) {
        double native = (decades[n].value - intercept) / slope;
        double beside[] = {native, nextafter(native, INFINITY),
                           nextafter(native, -INFINITY), -native};
        for (int i = 0; i < 4; i++)
            check_wide_value(&s, &quantizer, threshold, beside[i], bound);
    }
    const double odd[] = {0, -0.0, INFINITY, -INFINITY, NAN, 0x1p-1074};
    for (size_t i = 0; i < sizeof odd / sizeof *odd; i++)
        check_wide_value(&s, &quantizer, threshold, odd[i], bound);
    snow_quantizer_fini(s.context, &quantizer);
    scene_end(&s);
}

static void
codes_of_logarithmic_scales_are_as_fine_in_each_decade(void **state) {
    (void)state;
    for (int t = 0; t < 2; t++) {
        check_wide_log(SNOW_TYPE_FLOAT64, 1, 0, t * 12.75);
        check_wide_log(SNOW_TYPE_FLOAT64, -0.5, 3, t * 12.75);
        check_wide_log(SNOW_TYPE_FLOAT32, 1, 0, t * 12.75);
    }
}

/* What is not above 0 is no voxel, wherever the first point's opacity lies. */
static void on_a_logarithmic_scale_0_and_below_is_empty(void **state) {
    (void)state;
    const snow_opacity_point points[] = {{1, 0.5}, {100, 0.7}};
    const snow_color_point colors[] = {{1, 1, 1, 1}};
    for (snow_type type = SNOW_TYPE_INT8; type <= SNOW_TYPE_UINT16; type++) {
        scene s = scene_of(type, 1, -3, colors, 1, points, 2);
        assert_int_equal(snow_transfer_set_log(s.transfer), SNOW_STATUS_OK);
        snow_quantizer quantizer = coder_of(&s, 0);
        assert_int_equal(quantizer.run_count, 1);
        assert_int_equal(quantizer.runs[0].first + quantizer.lowest, 4);
        assert_int_equal(quantizer.runs[0].last, quantizer.codes - 1);
        double rgba[4];
        snow_transfer_evaluate(s.transfer, 10, rgba);
        assert_true(fabs(rgba[3] - 0.6) < 1e-15);
        snow_transfer_evaluate(s.transfer, -1, rgba);
        assert_true(rgba[0] == 0 && rgba[3] == 0);
        snow_quantizer_fini(s.context, &quantizer);
        scene_end(&s);
    }
}

static void logarithms_never_fall(void **state) {
    (void)state;
    double last = -INFINITY, x = 0x1p-1074;
    for (int n = 0; n < 200000; n++) {
        double found = snow_log2_rising(x);
        assert_true(found >= last);
        if (isfinite(x))
            assert_true(fabs(found - log2(x)) <= 1e-15 + 3e-16 * fabs(log2(x)));
        last = found;
        /* Neighbours, and now and then a leap: about powers of two too. */
        x = n % 16 ? nextafter(x, INFINITY) : x * 1.09;
        if (n % 997 == 0)
            x = fmax(x, nextafter(exp2(floor(log2(x)) + 1), 0));
        if (!(x < 1e300))
            x = 1e300;
    }
    last = -1;
    for (double m = 1 - 0x1p-40; m < 1 + 0x1p-40; m = nextafter(m, 2)) {
        double found = snow_log2_rising(m);
        assert_true(found >= last);
        last = found;
    }
    assert_true(snow_log2_rising(INFINITY) == 1024);
    for (double e = -1021; e < 1023; e += 0.37)
        assert_true(fabs(snow_exp2(e) / exp2(e) - 1) < 1e-10);
}

static void hundreds_of_points_share_the_codes(void **state) {
    (void)state;
    snow_opacity_point points[700];
    uint64_t seed = 5;
    double value = -40;
    for (int n = 0; n < 700; n++) {
        points[n] = (snow_opacity_point){value, support_uniform(&seed)};
        value += n % 5 ? support_uniform(&seed) : 0;
    }
    check_wide(SNOW_TYPE_FLOAT64, 1, 0, colorful, 5, points, 700);
}

static void more_points_than_codes_still_have_codes(void **state) {
    (void)state;
    size_t count = 100000;
    snow_opacity_point *points = malloc(count * sizeof *points);
    for (size_t n = 0; n < count; n++)
        points[n] = (snow_opacity_point){(double)n, (double)n / 1e5};
    check_wide(SNOW_TYPE_FLOAT32, 1, 0, black, 1, points, count);
    free(points);
}

/* --- which changes need new codes ----------------------------------------- */

static bool same_after(snow_type type, const snow_color_point *colors,
                       size_t color_count, const snow_opacity_point *opacities,
                       size_t opacity_count, double threshold) {
    const snow_color_point first[] = {{0, 0, 0, 0}, {100, 1, 1, 1}};
    const snow_opacity_point ramp[] = {{20, 0}, {80, 1}};
    scene a = scene_of(type, 1, 0, first, 2, ramp, 2);
    scene b =
        scene_of(type, 1, 0, colors, color_count, opacities, opacity_count);
    snow_quantizer one = coder_of(&a, 10), other = coder_of(&b, threshold);
    bool same = snow_quantizer_same(&one, &other);
    snow_quantizer_fini(a.context, &one);
    snow_quantizer_fini(b.context, &other);
    scene_end(&a);
    scene_end(&b);
    return same;
}

static void new_colours_keep_the_codes(void **state) {
    (void)state;
    const snow_color_point first[] = {{0, 0, 0, 0}, {100, 1, 1, 1}};
    const snow_color_point tinted[] = {{0, 1, 0.5, 0}, {100, 0, 1, 0}};
    const snow_color_point moved[] = {{10, 0, 0, 0}, {100, 1, 1, 1}};
    const snow_opacity_point ramp[] = {{20, 0}, {80, 1}};
    const snow_opacity_point lower[] = {{20, 0}, {80, 0.5}};
    for (snow_type type = SNOW_TYPE_INT8; type <= SNOW_TYPE_FLOAT64; type++) {
        bool narrow = type <= SNOW_TYPE_UINT16;
        assert_true(same_after(type, first, 2, ramp, 2, 10));
        assert_true(same_after(type, tinted, 2, ramp, 2, 10));
        assert_int_equal(same_after(type, moved, 2, ramp, 2, 10), narrow);
        assert_false(same_after(type, first, 2, ramp, 2, 30));
        assert_false(same_after(type, first, 2, lower, 2, 10));
    }
    assert_true(same_after(SNOW_TYPE_UINT8, first, 2, ramp, 2, 10.0001));
}

/* --- palettes ------------------------------------------------------------- */

static void check_palette(const scene *s, const snow_quantizer *quantizer,
                          double exponent, bool premultiply, int threads,
                          snow_palette *palette) {
    assert_int_equal(snow_palette_make(s->context, quantizer, s->transfer,
                                       exponent, premultiply, threads, palette),
                     SNOW_STATUS_OK);
    assert_int_equal(palette->channels, s->transfer->grey ? 2 : 4);
    int channels = palette->channels;
    for (size_t code = 0; code < quantizer->codes; code++) {
        double rgba[4];
        const float *sample = palette->samples + code * (size_t)channels;
        snow_transfer_evaluate(s->transfer,
                               snow_quantizer_value(quantizer, code), rgba);
        if (snow_type_size(quantizer->type) <= 2 && !quantizer->keep[code])
            memset(rgba, 0, sizeof rgba); /* is not shown */
        double a = 1 - pow(1 - rgba[3], exponent);
        float found = sample[channels - 1];
        if (!(fabs((double)found - a) <= 1e-7))
            fail_msg("opacity %.9g ^ %.9g is %.9g, not %.9g", rgba[3], exponent,
                     (double)found, a);
        assert_true(exponent != 1 || found == (float)rgba[3]);
        assert_true(rgba[3] != 1 || found == 1);
        assert_true(rgba[3] != 0 || found == 0);
        for (int i = 0; i < channels - 1; i++) {
            double color = rgba[i] * (premultiply ? a : 1);
            assert_true(fabs((double)sample[i] - color) <= 2e-7);
        }
    }
}

static void palettes_are_corrected_for_the_path(void **state) {
    (void)state;
    const double exponents[] = {1,   1.7320508, 0.5,   3,    1e-3,
                                250, 1e-300,    1e300, 1e-9, 0.9999999};
    const snow_color_point grey[] = {{0, 0, 0, 0}, {100, 1, 1, 1}};
    const snow_type types[] = {SNOW_TYPE_UINT8, SNOW_TYPE_INT16,
                               SNOW_TYPE_FLOAT32};
    for (int t = 0; t < 3; t++)
        for (int color = 0; color < 2; color++) {
            scene s = scene_of(types[t], 1, 0, color ? colorful : grey,
                               color ? 5 : 2, rough, ROUGH);
            snow_quantizer quantizer = coder_of(&s, 0);
            snow_palette palette = {0};
            for (int e = 0; e < 10; e++)
                check_palette(&s, &quantizer, exponents[e], e % 2 == 0,
                              e % 3 + 1, &palette);
            snow_palette_fini(s.context, &palette);
            snow_quantizer_fini(s.context, &quantizer);
            scene_end(&s);
        }
}

static void a_palette_follows_the_transfer_function(void **state) {
    (void)state;
    const snow_color_point grey[] = {{0, 0, 0, 0}, {100, 1, 1, 1}};
    scene first = scene_of(SNOW_TYPE_UINT8, 1, 0, grey, 2, rough, ROUGH);
    scene second = scene_of(SNOW_TYPE_UINT8, 1, 0, colorful, 5, rough, ROUGH);
    scene third = scene_of(SNOW_TYPE_UINT8, 0.5, 0, colorful, 5, rough, ROUGH);
    scene fourth = scene_of(SNOW_TYPE_FLOAT64, 1, 0, colorful, 5, rough, ROUGH);
    scene fifth =
        scene_of(SNOW_TYPE_FLOAT64, 1, 2, colorful, 4, rough, ROUGH - 1);
    const scene *scenes[] = {&first,  &second, &second, &third,
                             &fourth, &fifth,  &first};
    snow_palette palette = {0};
    for (int n = 0; n < 7; n++) {
        /* One context owns the palette's memory. */
        scene s = *scenes[n];
        s.context = first.context;
        snow_quantizer quantizer = coder_of(&s, 0);
        check_palette(&s, &quantizer, n == 2 ? 2 : 1.5, true, 1, &palette);
        snow_quantizer_fini(s.context, &quantizer);
    }
    snow_palette_fini(first.context, &palette);
    scene_end(&first);
    scene_end(&second);
    scene_end(&third);
    scene_end(&fourth);
    scene_end(&fifth);
}

static void no_memory_leaves_nothing_behind(void **state) {
    support_place *place = *state;
    const snow_type types[] = {SNOW_TYPE_UINT8, SNOW_TYPE_FLOAT32};
    for (int t = 0; t < 2; t++) {
        scene s = scene_of(types[t], 1, 0, colorful, 5, rough, ROUGH);
        snow_status status = SNOW_STATUS_NO_MEMORY;
        int64_t failures = 0;
        for (; status != SNOW_STATUS_OK; failures++) {
            snow_quantizer quantizer = {.keep = NULL};
            snow_palette palette = {0};
            place->allocations = 0;
            place->fail_at = failures + 1;
            status = snow_quantizer_make(place->context, s.volume, s.transfer,
                                         0, &quantizer);
            if (status == SNOW_STATUS_OK)
                status = snow_palette_make(place->context, &quantizer,
                                           s.transfer, 1.5, true, 1, &palette);
            snow_quantizer_fini(place->context, &quantizer);
            snow_palette_fini(place->context, &palette);
            place->fail_at = 0;
        }
        assert_true(failures > 6);
        scene_end(&s);
    }
}

static void a_palette_survives_a_lack_of_memory(void **state) {
    support_place *place = *state;
    scene small = scene_of(SNOW_TYPE_UINT8, 1, 0, black, 1, rough, ROUGH);
    scene large = scene_of(SNOW_TYPE_INT16, 1, 0, colorful, 5, rough, ROUGH);
    snow_quantizer first = coder_of(&small, 0), second = coder_of(&large, 0);
    snow_palette palette = {0};
    small.context = large.context = place->context;
    for (int64_t n = 1; n < 5; n++) {
        check_palette(&small, &first, 1.5, false, 1, &palette);
        place->allocations = 0;
        place->fail_at = n;
        assert_int_equal(snow_palette_make(place->context, &second,
                                           large.transfer, 2, true, 1,
                                           &palette),
                         SNOW_STATUS_NO_MEMORY);
        place->fail_at = 0;
        check_palette(&large, &second, 2, true, 1, &palette);
        snow_palette_fini(place->context, &palette);
    }
    small.context = small.volume->context;
    large.context = large.volume->context;
    snow_quantizer_fini(small.context, &first);
    snow_quantizer_fini(large.context, &second);
    scene_end(&small);
    scene_end(&large);
}

static void own_powers_agree_with_the_library(void **state) {
    (void)state;
    uint64_t seed = 3;
    for (int n = 0; n < 200000; n++) {
        double x = support_uniform(&seed);
        double exponent = ldexp(support_uniform(&seed), n % 14);
        double expected = pow(x, exponent), found = snow_pow(x, exponent);
        assert_true(fabs(found - expected) <= 1e-11);
        double y = ldexp(x + 0.5, n % 1800 - 900);
        assert_true(fabs(snow_log(y) - log(y)) <= 1e-11 * fabs(log(y)));
        double z = -ldexp(x, n % 90 - 80);
        assert_true(fabs(snow_exp_less_1(z) - expm1(z)) <= 1e-10 * -expm1(z));
    }
    assert_true(snow_pow(0, 0) == 1 && snow_pow(0, 2.5) == 0);
    assert_true(snow_pow(1, 7.25) == 1 && snow_pow(0.3, 0) == 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_value_of_8_and_16_bits_has_its_own_code),
        cmocka_unit_test(many_runs_are_told_by_the_table_alone),
        cmocka_unit_test(codes_of_wide_types_keep_to_their_stretch),
        cmocka_unit_test(steep_tiny_and_huge_stretches_are_exact_too),
        cmocka_unit_test(
            codes_of_logarithmic_scales_are_as_fine_in_each_decade),
        cmocka_unit_test(on_a_logarithmic_scale_0_and_below_is_empty),
        cmocka_unit_test(logarithms_never_fall),
        cmocka_unit_test(hundreds_of_points_share_the_codes),
        cmocka_unit_test(more_points_than_codes_still_have_codes),
        cmocka_unit_test(new_colours_keep_the_codes),
        cmocka_unit_test(palettes_are_corrected_for_the_path),
        cmocka_unit_test(a_palette_follows_the_transfer_function),
        cmocka_unit_test_setup_teardown(no_memory_leaves_nothing_behind,
                                        support_place_begin, support_place_end),
        cmocka_unit_test_setup_teardown(a_palette_survives_a_lack_of_memory,
                                        support_place_begin, support_place_end),
        cmocka_unit_test(own_powers_agree_with_the_library),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
