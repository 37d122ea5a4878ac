/* test_api.c - what holds for the public interface as a whole: names that lead
 * back to their values. */
#include "support/support.h"

#include <snowglass/snowglass.h>
#include <string.h>

#define EACH_VALUE_HAS_A_NAME(word)                                          \
    for (int i = 0; snow_##word##_name((snow_##word)i); i++)                 \
        assert_int_equal(                                                    \
            snow_##word##_from_name(snow_##word##_name((snow_##word)i)), i); \
    assert_int_equal(snow_##word##_from_name("nothing"), -1)

static void a_name_leads_back_to_its_value(void **state) {
    (void)state;
    EACH_VALUE_HAS_A_NAME(method);
    EACH_VALUE_HAS_A_NAME(encoding);
    EACH_VALUE_HAS_A_NAME(kernel);
    EACH_VALUE_HAS_A_NAME(quality);
    EACH_VALUE_HAS_A_NAME(isa);
    EACH_VALUE_HAS_A_NAME(mode);
}

static void shear_warp_has_an_alias(void **state) {
    (void)state;
    assert_string_equal(snow_method_name(SNOW_METHOD_SHEAR_WARP), "shear-warp");
    assert_int_equal(snow_method_from_name("sheared"), SNOW_METHOD_SHEAR_WARP);
}

/* The picture of one call is that of the objects made one by one. */
static void a_file_is_rendered_in_one_call(void **state) {
    snow_context *context = NULL;
    snow_image *image = NULL, *other = NULL;
    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL;
    snow_frame *frame = NULL;
    snow_look look = {0};
    snow_view view;
    (void)state;
    assert_int_equal(snow_context_new(NULL, &context), SNOW_STATUS_OK);
    assert_int_equal(snow_volume_open(context, "phantom:head", NULL, &volume),
                     SNOW_STATUS_OK);
    snow_view_default(volume, &view);
    view.width = view.height = 64;
    assert_int_equal(
        snow_render_file(context, "phantom:head", &view, NULL, &image),
        SNOW_STATUS_OK);
    assert_int_equal(snow_transfer_new_for_volume(volume, &look, &transfer),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_frame_new(context, &frame), SNOW_STATUS_OK);
    assert_int_equal(
        snow_frame_render(frame, volume, transfer, &view, NULL, &other),
        SNOW_STATUS_OK);
    assert_int_equal(snow_image_width(image), 64);
    assert_memory_equal(snow_image_pixels(image), snow_image_pixels(other),
                        64 * 64 * sizeof(float) *
                            (size_t)snow_image_channels(image));
    snow_image_free(image);
    snow_image_free(other);
    snow_frame_free(frame);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
}

static void a_file_that_is_missing_makes_no_image(void **state) {
    snow_context *context = NULL;
    snow_image *image = NULL;
    (void)state;
    assert_int_equal(snow_context_new(NULL, &context), SNOW_STATUS_OK);
    assert_int_equal(
        snow_render_file(context, "missing.nrrd", NULL, NULL, &image),
        SNOW_STATUS_BAD_INPUT);
    assert_null(image);
    assert_non_null(strstr(snow_context_message(context), "missing.nrrd"));
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_name_leads_back_to_its_value),
        cmocka_unit_test(shear_warp_has_an_alias),
        cmocka_unit_test(a_file_is_rendered_in_one_call),
        cmocka_unit_test(a_file_that_is_missing_makes_no_image),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
