/* tests/image/test_places.c - letters, bars and titles do not cover each other,
 * nor the object where the frame has room. */
#include "image/overlay.h"
#include "support/image.h"

#include <snowglass/overlay.h>

/* A patient whose voxels lie as given. */
static snow_volume_info patient(void) {
    return (snow_volume_info){
        .size = sizeof(snow_volume_info),
        .dims = {20, 30, 40},
        .matrix = {{-1, 0, 0, 3}, {0, 2, 0, 4}, {0, 0, 1, 5}, {0, 0, 0, 1}},
        .spacing = {1, 2, 1},
        .medical = true,
        .unit = "mm"};
}

static snow_view view_of(snow_context *context, const char *name) {
    snow_view view = {.size = sizeof view};
    assert_int_equal(snow_view_from_name(context, name, &view), SNOW_STATUS_OK);
    return view;
}

static snow_overlay *overlay_of(snow_context *context, int width, int height) {
    snow_overlay *overlay = NULL;
    assert_int_equal(snow_overlay_new(context, width, height, &overlay),
                     SNOW_STATUS_OK);
    return overlay;
}

/* All that a tool draws, in its order; `ends` are the shapes after each. */
static snow_overlay *draw_all(snow_context *context, const snow_image *image,
                              const snow_view *view, const char *unit,
                              double high, size_t ends[4]) {
    const snow_color_point colors[] = {{-high, 0, 0, 0}, {high, 1, 1, 1}};
    const snow_opacity_point opacity = {0, 1};
    snow_volume_info info = patient();
    snow_transfer *transfer = NULL;
    snow_overlay *overlay = overlay_of(context, view->width, view->height);
    snprintf(info.unit, sizeof info.unit, "%s", unit);
    assert_int_equal(
        snow_transfer_new(context, colors, 2, &opacity, 1, &transfer),
        SNOW_STATUS_OK);
    snow_overlay_keep_off(overlay, image);
    snow_overlay_color_bar(overlay, transfer, "HU", NULL);
    ends[0] = overlay->shape_count;
    snow_overlay_scale_bar(overlay, &info, view);
    ends[1] = overlay->shape_count;
    snow_overlay_title(overlay, "step 123456");
    ends[2] = overlay->shape_count;
    snow_overlay_orientation(overlay, &info, view);
    ends[3] = overlay->shape_count;
    snow_transfer_free(transfer);
    return overlay;
}

static bool boxes_meet(const double *a, const double *b) {
    return a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3];
}

/* Letters are one shape each. */
static void expect_apart(const snow_overlay *overlay, const size_t ends[4]) {
    for (size_t a = 0; a < ends[3]; a++)
        for (size_t b = 0; b < a; b++) {
            int group = 0;
            while (a >= ends[group])
                group++;
            bool same = group < 3 && b >= (group ? ends[group - 1] : 0);
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
                snow_view view = view_of(f->context, n % 2 ? "iso" : "left");
                view.width = sides[w];
                view.height = sides[h];
                snow_overlay *overlay =
                    draw_all(f->context, NULL, &view, units[n % 3],
                             n < 6 ? 1000 : 1.5e9, ends);
                expect_apart(overlay, ends);
                if (ends[3] - ends[2] != 4)
                    fail_msg("%d x %d, %d: %zu letters", view.width,
                             view.height, n, ends[3] - ends[2]);
                for (size_t i = ends[2]; i < ends[3]; i++) {
                    const double *box = overlay->shapes[i].box;
                    assert_true(box[0] >= 0 && box[1] >= 0 &&
                                box[2] <= view.width && box[3] <= view.height);
                }
                snow_overlay_free(overlay);
            }
}

/* An object of a few opaque pixels, where the frame has room for all. */
static void all_keep_off_the_object(void **state) {
    image_fixture *f = *state;
    size_t free[4], ends[4];
    snow_view view = view_of(f->context, "anterior");
    view.width = 400;
    view.height = 300;
    snow_overlay *plain = draw_all(f->context, NULL, &view, "mm", 1000, free);
    for (size_t n = 0; n < free[3]; n++) {
        const double *at = plain->shapes[n].box;
        snow_image *image = support_blank(f->context, 400, 300, 4);
        int x = (int)(at[0] + at[2]) / 2, y = (int)(at[1] + at[3]) / 2;
        snow_image_pixels(image)[4 * (400 * y + x) + 3] = 0.51f;
        snow_overlay *overlay =
            draw_all(f->context, image, &view, "mm", 1000, ends);
        assert_memory_equal(free, ends, sizeof free);
        for (size_t i = 0; i < ends[3]; i++) {
            const double *box = overlay->shapes[i].box;
            assert_false(box[0] < x + 1 && x < box[2] && box[1] < y + 1 &&
                         y < box[3]);
        }
        expect_apart(overlay, ends);
        snow_overlay_free(overlay);
        snow_image_free(image);
    }
    snow_overlay_free(plain);
}

/* A picture that is full leaves all where they are without one. */
static void without_room_they_stay(void **state) {
    image_fixture *f = *state;
    size_t free[4], ends[4];
    snow_view view = view_of(f->context, "anterior");
    snow_image *image = NULL;
    view.width = view.height = 300;
    assert_int_equal(snow_image_new(f->context, 300, 300, 2, &image),
                     SNOW_STATUS_OK);
    for (size_t i = 0; i < 300 * 300; i++)
        snow_image_pixels(image)[2 * i + 1] = 1;
    snow_overlay *plain = draw_all(f->context, NULL, &view, "mm", 1000, free);
    snow_overlay *overlay =
        draw_all(f->context, image, &view, "mm", 1000, ends);
    assert_memory_equal(free, ends, sizeof free);
    assert_memory_equal(plain->numbers, overlay->numbers,
                        plain->number_count * sizeof *plain->numbers);
    snow_overlay_free(overlay);
    snow_overlay_free(plain);
    snow_image_free(image);
}

static void count_note(void *user, const char *text) {
    *(int *)user += strstr(text, "no room for the title") != NULL;
}

/* A title as wide as the picture, with a bar in each corner. */
static void a_long_title_is_shortened_before_it_is_left_out(void **state) {
    image_fixture *f = *state;
    snow_volume_info info = patient();
    snow_view view = view_of(f->context, "anterior");
    const char *title = "A title that is much too long for such a picture";
    int notes = 0;
    snow_context_set_warning(f->context, count_note, &notes);
    view.width = view.height = 300;
    for (int bars = 1; bars <= 4; bars++) {
        snow_overlay *overlay = overlay_of(f->context, 300, 300);
        for (int n = 0; n < bars; n++)
            snow_overlay_scale_bar(overlay, &info, &view);
        size_t before = overlay->shape_count;
        assert_int_equal(snow_overlay_title(overlay, title), SNOW_STATUS_OK);
        assert_true((overlay->shape_count > before) == (bars < 4));
        snow_overlay_free(overlay);
    }
    assert_int_equal(notes, 1);
}

#define HERE(test)                                             \
    cmocka_unit_test_setup_teardown(test, support_image_setup, \
                                    support_image_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        HERE(nothing_covers_another),
        HERE(all_keep_off_the_object),
        HERE(without_room_they_stay),
        HERE(a_long_title_is_shortened_before_it_is_left_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
