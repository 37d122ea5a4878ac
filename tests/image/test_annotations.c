/* tests/image/test_annotations.c - times as texts, and the box of a volume. */
#include "image/overlay.h"
#include "support/image.h"

#include <math.h>
#include <snowglass/overlay.h>
#include <stdio.h>
#include <string.h>

/* --- times ---------------------------------------------------------------- */

static snow_volume_info at_time(const char *unit, const char *calendar,
                                double value) {
    snow_volume_info info = {.size = sizeof info, .time_value = value};
    snprintf(info.time_unit, sizeof info.time_unit, "%s", unit);
    snprintf(info.calendar, sizeof info.calendar, "%s", calendar);
    return info;
}

/* The dates are those of cftime 1.6.2. */
static void dates_are_those_of_their_calendar(void **state) {
    (void)state;
    static const struct {
        const char *unit, *calendar;
        double value;
        const char *date;
    } rows[] = {
        {"hours since 1990-01-01", "", 0.0, "1990-01-01 00:00:00"},
        {"hours since 1990-01-01", "standard", 1000000.0,
         "2104-01-30 16:00:00"},
        {"days since 1582-10-04", "gregorian", 1.0, "1582-10-15 00:00:00"},
        {"days since 1582-10-04", "proleptic_gregorian", 11.0,
         "1582-10-15 00:00:00"},
        {"days since 1500-2-28", "julian", 1.0, "1500-02-29 00:00:00"},
        {"days since 1500-2-28", "standard", 1.0, "1500-02-29 00:00:00"},
        {"days since 1500-2-28", "proleptic_gregorian", 1.0,
         "1500-03-01 00:00:00"},
        {"days since 2000-2-28", "noleap", 1.0, "2000-03-01 00:00:00"},
        {"days since 2001-2-28 12:00", "366_day", 1.25, "2001-02-29 18:00:00"},
        {"days since 2000-2-29", "360_day", 31.0, "2000-03-30 00:00:00"},
        {"seconds since 1970-01-01 00:00:00", "standard", 1700000001.0,
         "2023-11-14 22:13:21"},
        {"minutes since 2000-1-1T6:30:00", "365_day", -1441.5,
         "1999-12-31 06:28:30"},
        {"days since 0001-01-01 00:00:00", "gregorian", 738000.0,
         "2021-07-28 00:00:00"},
        {"hours since 1900-01-01", "proleptic_gregorian", -0.25,
         "1899-12-31 23:45:00"},
        {"days since 1-1-1", "360_day", 400000.5, "1112-02-11 12:00:00"},
        {"days since 4-2-29", "julian", 1461.0, "0008-02-29 00:00:00"},
        {"days since 2100-2-28", "standard", 1.0, "2100-03-01 00:00:00"},
        {"days since 2001-2-28", "THIRTY_DAY_MONTHS", 2.0,
         "2001-02-30 00:00:00"},
        {"days since 2001-2-28", "360", 2.0, "2001-02-30 00:00:00"},
        {"hours since 2000-01-01T12:00:00+05:30", "", 1.0,
         "2000-01-01 07:30:00"},
        {"days since 2000-01-01 00:00 +0530", "", 1.0, "2000-01-01 18:30:00"},
        /* CF 4.4 has this one; cftime wants two digits */
        {"seconds since 1992-10-8 15:15:42.5 -6:00", "", 0.5,
         "1992-10-08 21:15:43"}};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        char text[64];
        snow_volume_info info =
            at_time(rows[n].unit, rows[n].calendar, rows[n].value);
        assert_true(
            snow_time_text(&info, "%Y-%m-%d %H:%M:%S", text, sizeof text));
        assert_string_equal(text, rows[n].date);
        /* And back, but for parts of a second. */
        double value = 0, unit = strstr(rows[n].unit, "day")      ? 86400
                                 : strstr(rows[n].unit, "hour")   ? 3600
                                 : strstr(rows[n].unit, "minute") ? 60
                                                                  : 1;
        assert_true(snow_time_value(&info, rows[n].date, &value));
        assert_true(fabs(value - rows[n].value) * unit <= 0.5);
    }
    double value = 7;
    snow_volume_info info = at_time("hours since 2000-01-01", "noleap", 0);
    assert_true(snow_time_value(&info, "2000-03-01", &value));
    assert_true(value == 59 * 24);
    assert_true(snow_time_value(&info, "2000-03-01_06:30", &value));
    assert_true(value == 59 * 24 + 6.5);
    assert_false(snow_time_value(&info, "2000-02-29", &value));
    assert_false(snow_time_value(&info, "2000-13-01", &value));
    assert_false(snow_time_value(&info, "tomorrow", &value));
    assert_false(snow_time_value(&info, "2000-03-01:2000-04-01", &value));
    assert_false(snow_time_value(&info, "2000-03-01.5", &value));
    assert_false(snow_time_value(&info, "2000-03-01 24:30", &value));
    assert_false(snow_time_value(&info, "2000-03-01 06:00 UTC+1", &value));
    assert_true(snow_time_value(&info, "2000-03-01 09:30 +03:00", &value));
    assert_true(snow_time_value(&info, "-0001-12-31T24:00", &value));
    assert_true(value == -2000 * 365 * 24);
    assert_true(snow_time_value(&info, "2000-03-01T06:30:00Z", &value));
    info = at_time("h", "", 0);
    assert_false(snow_time_value(&info, "2000-03-01", &value));
    assert_true(value == 59 * 24 + 6.5);
}

static void times_are_written_as_asked(void **state) {
    (void)state;
    static const struct {
        const char *unit, *format, *text; /* NULL: refused */
    } rows[] = {{"s", NULL, "2.5 s"},
                {"", NULL, "2.5"},
                {"s", "t = %.3f s", "t = 2.500 s"},
                {"s", "%5.1e", "2.5e+00"},
                {"s", "100 %% at %g", "100 % at 2.5"},
                {"hours since 2000-01-01", NULL, "2000-01-01 02:30"},
                {"hours since 2000-01-01", "%d.%m.%Y", "01.01.2000"},
                {"seconds since 2000-01-01", NULL, "2000-01-01 00:00:03"},
                {"hours since 2000-01-01", "%g h", "2.5 h"},
                {"hours since 2000-01-01", "%g min later", "150 min later"},
                {"s", "t = %.0f ms", "t = 2500 ms"},
                {"ps", "%gfs", "2500fs"},
                {"s", "%g cycles", "2.5 cycles"},
                {"s", "%Y", NULL},
                {"s", "%s", NULL},
                {"s", "%n", NULL},
                {"s", "%g %g", NULL},
                {"s", "%*g", NULL},
                {"s", "%lg", NULL},
                {"s", "%", NULL},
                {"s", "none", NULL},
                {"s", "%0000000000000000.9f", NULL}};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        char text[64], tight[4];
        snow_volume_info info = at_time(rows[n].unit, "", 2.5);
        bool can = snow_time_text(&info, rows[n].format, text, sizeof text);
        assert_int_equal(can, rows[n].text != NULL);
        if (can)
            assert_string_equal(text, rows[n].text);
        if (can && strlen(text) >= sizeof tight)
            assert_false(
                snow_time_text(&info, rows[n].format, tight, sizeof tight));
        info.time_value = NAN;
        assert_false(snow_time_text(&info, rows[n].format, text, sizeof text));
    }
}

static void calendars_that_are_not_known_have_numbers(void **state) {
    (void)state;
    static const char *const names[] = {"no_calendar", "utc", "tai", "nolep"};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        char text[64];
        snow_volume_info info =
            at_time("days since 2000-01-01", names[n], 60.0);
        assert_true(snow_time_text(&info, NULL, text, sizeof text));
        assert_string_equal(text, "60 days since 2000-01-01");
    }
}

/* --- the box -------------------------------------------------------------- */

static const snow_volume_info block = {
    .size = sizeof block,
    .dims = {20, 30, 40},
    .matrix = {{1, 0, 0, 3}, {0, 2, 0, 4}, {0, 0, 1, 5}, {0, 0, 0, 1}},
    .spacing = {1, 2, 1},
    .unit = "mm"};

static snow_overlay *overlay_of(const image_fixture *f, int side) {
    snow_overlay *overlay = NULL;
    assert_int_equal(snow_overlay_new(f->context, side, side, &overlay),
                     SNOW_STATUS_OK);
    return overlay;
}

static snow_view view_of(int side) {
    snow_view view;
    snow_view_init(&view);
    view.width = view.height = side;
    return view;
}

static void draw_box(snow_overlay *overlay, const snow_volume_info *info,
                     const snow_view *view, bool axes) {
    assert_int_equal(snow_overlay_box(overlay, info, view, axes),
                     SNOW_STATUS_OK);
}

/* What a face-on box covers: its middle is the picture's, and a pixel is a
 * 400th of the diagonal. */
static void a_box_face_on_is_its_rectangle(void **state) {
    image_fixture *f = *state;
    snow_overlay *overlay = overlay_of(f, 400);
    snow_view view = view_of(400);
    draw_box(overlay, &block, &view, false);
    assert_int_equal(overlay->shape_count, 1);
    const snow_shape *shape = &overlay->shapes[0];
    double pixel = sqrt(20 * 20 + 60 * 60 + 40 * 40) / 400;
    double ends[2] = {10 / pixel, 30 / pixel};
    for (size_t n = 0; n < 4 * shape->count; n += 2) {
        const float *at = overlay->numbers + shape->first + n;
        double off[2] = {fabs((double)at[0] - 200) - ends[0],
                         fabs((double)at[1] - 200) - ends[1]};
        assert_true(fabs(fmax(off[0], off[1])) < 1e-3);
    }
    snow_overlay_free(overlay);
}

/* An edge behind what is seen is left out there alone. */
static void edges_behind_are_hidden_by_the_picture(void **state) {
    image_fixture *f = *state;
    size_t strokes[3];
    for (int n = 0; n < 3; n++) {
        snow_overlay *overlay = overlay_of(f, 400);
        snow_image *image = support_blank(f->context, 400, 400, 4);
        snow_view view = {.size = sizeof view};
        assert_int_equal(snow_view_from_name(f->context, "iso", &view),
                         SNOW_STATUS_OK);
        view.width = view.height = 400;
        for (int y = 0; y < 400 && n; y++)
            for (int x = 0; x < (n == 1 ? 200 : 400); x++)
                snow_image_pixels(image)[(y * 400 + x) * 4 + 3] = 1;
        snow_overlay_set_picture(overlay, image);
        draw_box(overlay, &block, &view, false);
        strokes[n] = overlay->shapes[0].count;
        snow_overlay_free(overlay);
        snow_image_free(image);
    }
    assert_true(strokes[0] > strokes[1] && strokes[1] > strokes[2]);
    assert_int_equal(strokes[2], 9); /* those before it, and the outline */
}

/* Ticks of the axes lie at round coordinates of the world. */
static void axes_have_ticks_at_their_coordinates(void **state) {
    image_fixture *f = *state;
    snow_overlay *overlay = overlay_of(f, 400);
    snow_view view = view_of(400);
    view.zoom = 1.6;
    draw_box(overlay, &block, &view, true);
    double pixel = sqrt(20 * 20 + 60 * 60 + 40 * 40) / 400 / 1.6;
    const snow_shape *x = &overlay->shapes[3]; /* behind edges and two names */
    assert_true(x->count >= 2);
    for (size_t n = 0; n < x->count; n++) {
        const float *stroke = overlay->numbers + x->first + 4 * n;
        double world = ((double)stroke[0] - 200) * pixel + 3 + 9.5;
        assert_true(fabs(world / 10 - round(world / 10)) < 1e-3);
        assert_true(world > 2 && world < 23);
        assert_true(fabs((double)stroke[1] - 200 - 30 / pixel) < 1e-3);
        assert_true(stroke[3] > stroke[1]); /* away from the box */
    }
    snow_overlay_free(overlay);
}

/* --- letters -------------------------------------------------------------- */

static size_t strokes_of(const image_fixture *f, const char *text) {
    snow_overlay *overlay = overlay_of(f, 400);
    assert_int_equal(snow_overlay_text(overlay, 9, 9, 0, 0, 20, text),
                     SNOW_STATUS_OK);
    size_t count = overlay->shapes[0].count;
    snow_overlay_free(overlay);
    return count;
}

/* A letter with a mark is as wide as without, and has more strokes. */
static void letters_of_latin_1_have_their_marks(void **state) {
    image_fixture *f = *state;
    static const char *const pairs[][2] = {
        {"\xc3\xa9", "e"}, {"\xc3\x84", "A"}, {"\xc3\xb1", "n"},
        {"\xc3\x87", "C"}, {"\xc3\xae", "l"}, {"\xc3\xbf", "y"}};
    for (size_t n = 0; n < sizeof pairs / sizeof *pairs; n++) {
        assert_true(fabs(snow_font_width(pairs[n][0]) -
                         snow_font_width(pairs[n][1])) < 1e-12);
        assert_true(strokes_of(f, pairs[n][0]) > strokes_of(f, pairs[n][1]));
    }
    assert_true(snow_font_width("\xc2\xb0") < snow_font_width("o"));
    /* one box for what the font lacks, not one for each byte */
    assert_true(fabs(snow_font_width("\xe6\x97\xa5") -
                     snow_font_width("\x7f")) < 1e-12);
    assert_false(snow_font_has("run \xe6\x97\xa5"));
    assert_true(snow_font_has("\xc3\xa9 7.5 \xc2\xb5m\nbelow"));
}

/* Unicode's own pairs: Greek capitals that look like Latin ones, signs whose
 * decomposition is a letter (Angstrom, ohm, kelvin), and both micro signs. */
static void characters_of_one_shape_are_one(void **state) {
    image_fixture *f = *state;
    static const char *const pairs[][2] = {
        {"Α", "A"},      {"Ρ", "P"}, {"Χ", "X"}, {"ο", "o"}, {"\u212b", "Å"},
        {"\u2126", "Ω"}, {"µ", "μ"}, {"∆", "Δ"}, {"−", "–"}, {"\u212a", "K"}};
    for (size_t n = 0; n < sizeof pairs / sizeof *pairs; n++) {
        assert_true(snow_font_has(pairs[n][0]));
        assert_true(fabs(snow_font_width(pairs[n][0]) -
                         snow_font_width(pairs[n][1])) < 1e-12);
        assert_int_equal(strokes_of(f, pairs[n][0]),
                         strokes_of(f, pairs[n][1]));
    }
    assert_true(snow_font_width("⁸") < 0.6 * snow_font_width("8"));
    assert_int_equal(strokes_of(f, "₈"), strokes_of(f, "8"));
}

/* 1,020 bytes of a line are drawn, or as many as are whole letters, and "..."
 * then.  A Gamma has two strokes. */
static void endless_titles_end_with_dots(void **state) {
    image_fixture *f = *state;
    char title[3002] = "l";
    for (int at = 1; at < 3000; at += 2)
        memcpy(title + at, "\xce\x93", 2);
    for (int first = 0; first < 2; first++) {
        snow_overlay *overlay = support_overlay(f->context, 8000, 64);
        assert_int_equal(snow_overlay_title(overlay, title + first),
                         SNOW_STATUS_OK);
        size_t strokes = first ? 2 * 510 + 3 : 1 + 2 * 509 + 3;
        assert_int_equal(overlay->number_count, 4 * strokes);
        snow_overlay_free(overlay);
    }
}

static void long_texts_are_shortened(void **state) {
    (void)state;
    char text[] = "\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9";
    double width = snow_font_width(text);
    snow_font_shorten(width, text);
    assert_int_equal(strlen(text), 12);
    snow_font_shorten(0.7 * width, text);
    assert_true(snow_font_width(text) <= 0.7 * width);
    assert_true(strlen(text) > 3 && strlen(text) % 2 == 1);
    assert_string_equal(text + strlen(text) - 3, "...");
    snow_font_shorten(0, text);
    assert_true(strlen(text) <= 3);
}

/* Numbers of axes that would lie upon what was there are left out. */
static void axes_keep_off_others(void **state) {
    image_fixture *f = *state;
    size_t shapes[2];
    for (int n = 0; n < 2; n++) {
        snow_overlay *overlay = overlay_of(f, 256);
        snow_view view = view_of(256);
        assert_int_equal(snow_overlay_text(overlay, 20, 128, 0, 0.5, n ? 60 : 9,
                                           n ? "ml" : "."),
                         SNOW_STATUS_OK);
        draw_box(overlay, &block, &view, true);
        shapes[n] = overlay->shape_count;
        snow_overlay_free(overlay);
    }
    assert_true(shapes[0] > 6);
    assert_true(shapes[1] < shapes[0]);
}

/* Whatever the size of numbers, and wherever the box ends. */
static void numbers_and_names_of_axes_stay_in_the_picture(void **state) {
    image_fixture *f = *state;
    snow_volume_info wide = block;
    for (int i = 0; i < 3; i++)
        wide.matrix[i][i] = wide.spacing[i] = 20000. / (double)wide.dims[i];
    for (int turn = 0; turn < 8; turn++) {
        snow_overlay *overlay = overlay_of(f, 256);
        snow_view view = view_of(256);
        view.azimuth = 15 * turn;
        view.elevation = 5 * turn;
        view.zoom = turn ? 1 : 1.5;
        draw_box(overlay, &wide, &view, true);
        assert_true(overlay->shape_count > 6);
        for (size_t n = 1; n < overlay->shape_count; n++) /* 0: the box */
            for (int i = 0; i < 2; i++)
                assert_true(overlay->shapes[n].box[i] >= 0 &&
                            overlay->shapes[n].box[2 + i] <= 256);
        snow_overlay_free(overlay);
    }
}

int main(void) {
#define HERE(test)                                             \
    cmocka_unit_test_setup_teardown(test, support_image_setup, \
                                    support_image_teardown)
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(dates_are_those_of_their_calendar),
        cmocka_unit_test(calendars_that_are_not_known_have_numbers),
        cmocka_unit_test(times_are_written_as_asked),
        HERE(a_box_face_on_is_its_rectangle),
        HERE(edges_behind_are_hidden_by_the_picture),
        HERE(axes_have_ticks_at_their_coordinates),
        HERE(letters_of_latin_1_have_their_marks),
        HERE(characters_of_one_shape_are_one),
        HERE(endless_titles_end_with_dots),
        cmocka_unit_test(long_texts_are_shortened),
        HERE(axes_keep_off_others),
        HERE(numbers_and_names_of_axes_stay_in_the_picture)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
