/* tests/image/test_places.c - letters stand in the middle of their edges, bars
 * in a strip at the right that the frame leaves free; none covers another. */
#include "image/overlay.h"
#include "reference/model.h"
#include "support/image.h"

#include <snowglass/overlay.h>
#include <snowglass/ranks.h>

#include <math.h>

/* All that a tool draws, in its order; `ends` are the shapes after each. */
static snow_overlay *draw_all(snow_context *context, const snow_view *view,
                              const char *unit, double high, size_t ends[4]) {
    const snow_color_point colors[] = {{-high, 0, 0, 0}, {high, 1, 1, 1}};
    const snow_opacity_point opacity = {0, 1};
    snow_volume_info info = support_patient();
    snow_transfer *transfer = NULL;
    snow_overlay *overlay = support_overlay(context, view->width, view->height);
    snprintf(info.unit, sizeof info.unit, "%s", unit);
    assert_int_equal(
        snow_transfer_new(context, colors, 2, &opacity, 1, &transfer),
        SNOW_STATUS_OK);
    snow_overlay_color_bar(overlay, transfer, "HU", NULL, 0, 1);
    ends[0] = overlay->shape_count;
    snow_overlay_scale_bar(overlay, &info, view);
    ends[1] = overlay->shape_count;
    snow_overlay_orientation(overlay, &info, view);
    ends[2] = overlay->shape_count;
    snow_overlay_title(overlay, "step 123456");
    ends[3] = overlay->shape_count;
    snow_transfer_free(transfer);
    return overlay;
}

static bool boxes_meet(const double *a, const double *b) {
    return a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3];
}

/* What belongs together may touch. */
static void expect_apart(const snow_overlay *overlay, const size_t ends[4]) {
    for (size_t a = 0; a < ends[3]; a++)
        for (size_t b = 0; b < a; b++) {
            int group = 0;
            while (a >= ends[group])
                group++;
            bool same = group != 2 && b >= (group ? ends[group - 1] : 0);
            if (!same &&
                boxes_meet(overlay->shapes[a].box, overlay->shapes[b].box))
                fail_msg("%d x %d: shapes %zu and %zu meet", overlay->width,
                         overlay->height, a, b);
        }
}

static void nothing_covers_another(void **state) {
    static const int sides[] = {64, 100, 128, 150, 256, 512, 1000};
    static const char *const units[] = {"mm", "um", "angstrom"};
    image_fixture *f = *state;
    for (int w = 0; w < 7; w++)
        for (int h = 0; h < 7; h++)
            for (int n = 0; n < 12; n++) {
                size_t ends[4];
                snow_view view =
                    support_view(f->context, n % 2 ? "iso" : "left");
                view.width = sides[w];
                view.height = sides[h];
                view.strip = sides[w] < 128 || sides[h] < 128 ? 0 : 0.5;
                snow_overlay *overlay =
                    draw_all(f->context, &view, units[n % 3],
                             n < 6 || sides[w] < 256 ? 1000 : 1.5e9, ends);
                expect_apart(overlay, ends);
                assert_int_equal(ends[2] - ends[1], 4);
                snow_overlay_free(overlay);
            }
}

/* By the rule: 2 % of the shorter side from the middle of each edge of what is
 * not left to the legend.  A box is a letter's and the reach of its border; its
 * strokes begin in whole pixels. */
static void letters_stand_in_the_middle_of_their_edges(void **state) {
    image_fixture *f = *state;
    snow_volume_info info = support_patient();
    for (int n = 0; n < 36; n++) {
        snow_view view = support_view(f->context, n % 2 ? "anterior" : "left");
        view.width = 150 + 61 * n;
        view.height = 2400 - 59 * n;
        view.strip = n % 3 * 0.15;
        snow_overlay *overlay =
            support_overlay(f->context, view.width, view.height);
        assert_int_equal(snow_overlay_orientation(overlay, &info, &view),
                         SNOW_STATUS_OK);
        assert_int_equal(overlay->shape_count, 4);
        const double room = view.width * (1 - view.strip);
        const double margin = 0.02 * fmin(view.width, view.height);
        for (int i = 0; i < 4; i++) {
            const snow_shape *shape = &overlay->shapes[i];
            const double reach = shape->halo + 1, *box = shape->box;
            const double at[2] = {(box[0] + box[2]) / 2, (box[1] + box[3]) / 2};
            const double from[4] = {box[0] + reach, room - box[2] + reach,
                                    box[1] + reach,
                                    view.height - box[3] + reach};
            assert_near(i < 2 ? at[1] : at[0],
                        i < 2 ? view.height / 2.0 : room / 2, 1.5);
            assert_near(from[i], margin, 1.5);
        }
        snow_overlay_free(overlay);
    }
}

/* --- the legend's strip --------------------------------------------------- */

/* Looks whose numbers have one digit to nine, of one bar or of several. */
static void add_bars(image_fixture *f, const snow_transfer *transfer, int n,
                     snow_overlay *overlay) {
    static const double ranges[][2] = {
        {0, 1}, {-1024, 3071}, {1e-7, 3e-7}, {273.15, 273.35}, {0, 1.5e9}};
    static const char *const names[] = {"HU", "temperature (K)", "",
                                        "sea_water_potential_temperature (K)"};
    const int count = overlay->height < 400 ? 1 : n % 3 + 1;
    (void)f;
    for (int i = 0; i < count; i++)
        assert_int_equal(snow_overlay_color_bar(overlay, transfer, names[n % 4],
                                                ranges[(n + i) % 5], i, count),
                         SNOW_STATUS_OK);
}

/* The most alpha in a box. */
static float alpha_in(const snow_image *image, const double box[4]) {
    const int width = snow_image_width(image),
              last = snow_image_channels(image);
    const float *pixels = snow_image_pixels((snow_image *)image);
    float most = 0;
    for (int y = (int)box[1]; y < (int)ceil(box[3]); y++)
        for (int x = (int)box[0]; x < (int)ceil(box[2]); x++)
            most = fmaxf(most, pixels[(y * width + x + 1) * last - 1]);
    return most;
}

/* 50 pictures of 200 to 4,000 pixels: a bar, its numbers and its name lie in
 * the picture, in at least 12 % of its width, and upon nothing that is drawn.
 */
static void bars_lie_beside_what_the_frame_shows(void **state) {
    static const char *const views[] = {"+z", "iso", "+x"};
    image_fixture *f = *state;
    const int64_t dims[3] = {20, 20, 20};
    const snow_look look = {.size = sizeof look, .preset = "linear"};
    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL;
    snow_frame *frame = NULL;
    assert_int_equal(snow_frame_new(f->context, &frame), SNOW_STATUS_OK);
    assert_int_equal(
        snow_volume_open_phantom(f->context, "shells", dims, 1, &volume),
        SNOW_STATUS_OK);
    assert_int_equal(snow_transfer_new_for_volume(volume, &look, &transfer),
                     SNOW_STATUS_OK);
    for (int n = 0; n < 50; n++) {
        snow_view view = support_view(f->context, views[n % 3]);
        snow_settings settings = {.size = sizeof settings,
                                  .quality = SNOW_QUALITY_DRAFT};
        snow_image *image = NULL;
        const int side = (int)(200 * pow(20, n / 49.0));
        view.width = n % 2 ? side : 200 + 3 * n;
        view.height = n % 2 ? 200 + 3 * n : side;
        view.fov = n % 5 ? 0 : 30;
        for (int drawn = 0; drawn < 2; drawn++) {
            snow_overlay *overlay =
                support_overlay(f->context, view.width, view.height);
            add_bars(f, transfer, n, overlay);
            const size_t bars = overlay->shape_count;
            if (!drawn)
                view.strip = snow_overlay_strip(overlay);
            else
                snow_overlay_scale_bar(overlay, snow_volume_get_info(volume),
                                       &view);
            assert_true(view.strip >= 0.12 && view.strip <= 0.5);
            assert_true(bars > 0);
            for (size_t i = 0; i < overlay->shape_count && drawn; i++) {
                const double *box = overlay->shapes[i].box;
                assert_true(box[0] >= view.width * (1 - view.strip) - 1 &&
                            box[1] >= 0 && box[2] <= view.width &&
                            box[3] <= view.height);
                assert_true(alpha_in(image, box) <= 0.02f);
            }
            if (!drawn) {
                assert_int_equal(snow_view_fit(NULL, volume, transfer,
                                               &settings, NULL, 0, &view),
                                 SNOW_STATUS_OK);
                assert_int_equal(snow_frame_render(frame, volume, transfer,
                                                   &view, &settings, &image),
                                 SNOW_STATUS_OK);
            }
            snow_overlay_free(overlay);
        }
        snow_image_free(image);
    }
    snow_frame_free(frame);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
}

/* A title as wide as the picture stands below the upper letter, and is cut. */
static void a_long_title_keeps_off_the_letter(void **state) {
    image_fixture *f = *state;
    snow_volume_info info = support_patient();
    static const char *const titles[] = {
        "short", "A title that is much too long for such a picture"};
    for (int n = 0; n < 2; n++) {
        size_t ends[4] = {0};
        snow_view view = support_view(f->context, "anterior");
        view.width = view.height = 300;
        snow_overlay *overlay = support_overlay(f->context, 300, 300);
        assert_int_equal(snow_overlay_orientation(overlay, &info, &view),
                         SNOW_STATUS_OK);
        ends[2] = overlay->shape_count;
        assert_int_equal(snow_overlay_title(overlay, titles[n]),
                         SNOW_STATUS_OK);
        ends[3] = overlay->shape_count;
        assert_int_equal(ends[3], 5);
        expect_apart(overlay, ends);
        const double *box = overlay->shapes[4].box;
        assert_true(box[2] <= 300);
        assert_true((box[1] > overlay->shapes[2].box[3] - 1) == (n == 1));
        snow_overlay_free(overlay);
    }
}

#define HERE(test)                                             \
    cmocka_unit_test_setup_teardown(test, support_image_setup, \
                                    support_image_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        HERE(nothing_covers_another),
        HERE(letters_stand_in_the_middle_of_their_edges),
        HERE(bars_lie_beside_what_the_frame_shows),
        HERE(a_long_title_keeps_off_the_letter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
