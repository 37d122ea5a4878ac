/* tests/test_parts.c - parts of a volume: what they need of their neighbours,
 * and that their local images make up the whole picture. */
#include "support_model.h"

#include "ghosts.h"
#include "volume/volume.h"

#include <math.h>

/* --- boxes ----------------------------------------------------------------
 */

static snow_volume *small_volume(snow_context *context) {
    static const unsigned char voxels[4 * 5 * 6];
    const snow_volume_info info = {
        .dims = {4, 5, 6},
        .type = SNOW_UINT8,
        .matrix = {{2, 0, 0, 10}, {0, 3, 0, 20}, {0, 0, 4, 30}, {0, 0, 0, 1}}};
    snow_volume *volume = NULL;
    assert_int_equal(snow_volume_share(context, &info, voxels, &volume),
                     SNOW_OK);
    return volume;
}

static void a_volume_that_is_no_part_is_the_whole(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_volume *volume = small_volume(context);
    snow_part part;
    snow_volume_get_part(volume, &part);
    const snow_part whole = {{4, 5, 6}, {0, 0, 0}, {0, 0, 0}, {4, 5, 6}};
    assert_memory_equal(&part, &whole, sizeof part);
    snow_volume_close(volume);
    snow_context_free(context);
}

static void a_part_knows_its_place_in_the_whole(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_volume *volume = small_volume(context);
    const snow_part part = {{9, 5, 20}, {3, 0, 14}, {4, 0, 15}, {2, 5, 5}};
    snow_part told;
    snow_volume_info whole;
    assert_int_equal(snow_volume_set_part(volume, &part), SNOW_OK);
    snow_volume_get_part(volume, &told);
    assert_memory_equal(&part, &told, sizeof part);
    snow_volume_whole(volume, &whole);
    assert_memory_equal(whole.dims, part.dims, sizeof whole.dims);
    assert_near(whole.matrix[0][3], 10 - 3 * 2, 1e-12);
    assert_near(whole.matrix[1][3], 20, 1e-12);
    assert_near(whole.matrix[2][3], 30 - 14 * 4, 1e-12);
    snow_volume_close(volume);
    snow_context_free(context);
}

static void boxes_that_do_not_lie_in_one_another_are_refused(void **state) {
    (void)state;
    static const snow_part bad[] = {
        {{9, 5, 20}, {6, 0, 14}, {6, 0, 14}, {2, 5, 5}},  /* beyond the grid */
        {{9, 5, 20}, {-1, 0, 14}, {0, 0, 14}, {2, 5, 5}}, /* before it */
        {{9, 5, 20}, {3, 0, 14}, {2, 0, 14}, {2, 5, 5}},  /* not stored */
        {{9, 5, 20}, {3, 0, 14}, {3, 0, 14}, {5, 5, 5}},
        {{9, 5, 20}, {3, 0, 14}, {3, 0, 14}, {-1, 5, 5}},
        {{9, 0, 20}, {3, 0, 14}, {3, 0, 14}, {1, 5, 5}},
        {{9, 5, 20}, {3, 0, 14}, {3, 0, 14}, {INT64_MAX, 5, 5}},
        {{9, 5, 20}, {INT64_MAX, 0, 14}, {INT64_MAX, 0, 14}, {1, 5, 5}},
    };
    snow_context *context = support_context();
    snow_volume *volume = small_volume(context);
    for (size_t n = 0; n < sizeof bad / sizeof *bad; n++) {
        snow_part part;
        assert_int_equal(snow_volume_set_part(volume, &bad[n]), SNOW_BAD_USAGE);
        assert_non_null(strstr(snow_context_message(context), "does not lie"));
        snow_volume_get_part(volume, &part);
        assert_int_equal(part.dims[0], 4);
    }
    /* A part may own nothing. */
    const snow_part none = {{9, 5, 20}, {3, 0, 14}, {0, 0, 0}, {0, 0, 0}};
    assert_int_equal(snow_volume_set_part(volume, &none), SNOW_OK);
    snow_volume_close(volume);
    snow_context_free(context);
}

/* --- ghosts ---------------------------------------------------------------
 */

/* Asks for a whole of 100 x 80 x 60 voxels. */
static void ghosts(const snow_view *view, const snow_settings *settings,
                   bool any_turn, int64_t layers[3]) {
    snow_context *context = support_context();
    snow_volume_info whole = snow_volume_info_default("memory");
    whole.dims[0] = 100;
    whole.dims[1] = 80;
    whole.dims[2] = 60;
    whole.type = SNOW_UINT8;
    if (snow_ghosts_needed(context, &whole, view, settings, any_turn, layers) !=
        SNOW_OK)
        fail_msg("%s", snow_context_message(context));
    snow_context_free(context);
}

static void assert_layers(const int64_t layers[3], int x, int y, int z) {
    assert_int_equal(layers[0], x);
    assert_int_equal(layers[1], y);
    assert_int_equal(layers[2], z);
}

static void kernels_and_gradients_need_ghosts(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_settings settings;
    snow_view view;
    int64_t layers[3];
    snow_settings_init(&settings);
    assert_int_equal(snow_view_named(context, "+z", &view), SNOW_OK);
    /* 142 voxels across 512 pixels: no kernel is widened.  The cubic B-spline
     * reaches 2 voxels from a sample half a voxel outside, a gradient one more,
     * slices none. */
    ghosts(&view, &settings, false, layers);
    assert_layers(layers, 3, 3, 1);
    settings.shade = SNOW_SHADE_NONE;
    ghosts(&view, &settings, false, layers);
    assert_layers(layers, 2, 2, 0);
    settings.quality = SNOW_QUALITY_DRAFT; /* the tent kernel */
    ghosts(&view, &settings, false, layers);
    assert_layers(layers, 1, 1, 0);
    settings.quality = SNOW_QUALITY_HIGH; /* a slice between each two */
    ghosts(&view, &settings, false, layers);
    assert_layers(layers, 2, 2, 1);
    snow_view_named(context, "-x", &view);
    ghosts(&view, &settings, false, layers);
    assert_layers(layers, 1, 2, 2);
    /* Half-way between two axes both count. */
    view.azimuth = 45;
    ghosts(&view, &settings, false, layers);
    assert_layers(layers, 2, 2, 2);
    snow_context_free(context);
}

static void wide_pixels_need_more_ghosts(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_settings settings;
    snow_view view;
    int64_t layers[3];
    snow_settings_init(&settings);
    settings.shade = SNOW_SHADE_NONE;
    snow_view_named(context, "+z", &view);
    /* 141.4 voxels across 10 pixels: w = sqrt(1 + (14.14^2 - 1) / 4) = 7.12, a
     * support of 28.5. */
    view.width = view.height = 10;
    ghosts(&view, &settings, false, layers);
    assert_layers(layers, 14, 14, 0);
    /* As far as the grid goes. */
    view.width = view.height = 1;
    ghosts(&view, &settings, false, layers);
    assert_layers(layers, 99, 79, 0);
    snow_context_free(context);
}

static void every_turn_needs_no_more_than_the_bound(void **state) {
    (void)state;
    snow_context *context = support_context();
    static const double turns[] = {-80, -45, -20, 0, 33, 45, 60, 90, 170};
    static const double fovs[] = {0, 0.5, 30, 60};
    for (int n = 0; n < 24; n++) {
        snow_settings settings;
        snow_view view;
        snow_settings_init(&settings);
        snow_view_named(context, "iso", &view);
        settings.quality = (snow_quality)(n % 3);
        view.fov = fovs[n / 3 % 4];
        view.width = view.height = n < 12 ? 200 : 30;
        int64_t bound[3], layers[3];
        ghosts(&view, &settings, true, bound);
        for (size_t a = 0; a < 9; a++)
            for (size_t e = 0; e < 9; e++) {
                view.azimuth = turns[a];
                view.elevation = turns[e];
                ghosts(&view, &settings, false, layers);
                for (int axis = 0; axis < 3; axis++)
                    assert_true(layers[axis] <= bound[axis]);
            }
    }
    /* And the bound is of use: at about a voxel a pixel no more than without
     * widening. */
    snow_settings settings;
    snow_view view;
    int64_t bound[3];
    snow_settings_init(&settings);
    snow_view_named(context, "iso", &view);
    view.width = view.height = 150;
    ghosts(&view, &settings, true, bound);
    assert_layers(bound, 3, 3, 3);
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_volume_that_is_no_part_is_the_whole),
        cmocka_unit_test(a_part_knows_its_place_in_the_whole),
        cmocka_unit_test(boxes_that_do_not_lie_in_one_another_are_refused),
        cmocka_unit_test(kernels_and_gradients_need_ghosts),
        cmocka_unit_test(wide_pixels_need_more_ghosts),
        cmocka_unit_test(every_turn_needs_no_more_than_the_bound),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
