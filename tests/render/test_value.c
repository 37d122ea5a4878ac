/* tests/render/test_value.c - method shear-warp beside the float64 reference of
 * the value model, and what must not change a bit of its pictures. */
#include <math.h>

#include "classify/values/value_range.h"
#include "reference/model.h"
#include "render/picture.h"
#include "simd/isa.h"
#include "values/pictures.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* Less than a unit of the 15 bits of the image on the lattice, and more than
 * what its warp rounds. */
#define WARP_BOUND 2e-6

static const snow_opacity_point above[] = {
    {0, 0}, {35, 0}, {70, 0.6}, {100, 0.9}};

static void pictures_are_the_references(void **state) {
    (void)state;
    model_stage stage = model_open();
    for (int n = 0; n < VALUE_PICTURES; n += (int)support_stride(23)) {
        reference_scene s = value_picture_scene(n);
        float *picture = model_picture(&stage, &s);
        double *expected = value_picture_expected(&(value_scene){.base = s});
        assert_int_equal(snow_frame_stats(stage.frame)->method,
                         SNOW_METHOD_SHEAR_WARP);
        value_picture_compare(n, &s, picture, expected);
        free(picture);
        free(expected);
        value_picture_free(&s);
    }
    model_close(&stage);
}

/* --- bits ----------------------------------------------------------------- */

/* Both pictures are freed but the first. */
static void same_bits(int n, const float *first, float *other, size_t count) {
    if (memcmp(first, other, count * sizeof *first) != 0)
        fail_msg("scene %d: other bits", n);
    free(other);
}

static void threads_and_encodings_give_the_same_bits(void **state) {
    (void)state;
    for (int n = 0; n < VALUE_PICTURES; n += (int)support_stride(23)) {
        model_stage stage = model_open();
        reference_scene s = value_picture_scene(n);
        size_t count = 4 * (size_t)s.view.width * (size_t)s.view.height;
        s.settings.threads = 1;
        s.settings.encoding = SNOW_ENCODING_BITMAP;
        float *first = model_picture(&stage, &s);
        assert_int_equal(snow_frame_stats(stage.frame)->encoding,
                         SNOW_ENCODING_BITMAP);
        for (int threads = 2; threads < 9; threads += 3) {
            s.settings.threads = threads;
            same_bits(n, first, model_picture(&stage, &s), count);
        }
        s.settings.encoding = SNOW_ENCODING_CRS;
        same_bits(n, first, model_picture(&stage, &s), count);
        s.settings.encoding = SNOW_ENCODING_RLE;
        same_bits(n, first, model_picture(&stage, &s), count);
        free(first);
        value_picture_free(&s);
        model_close(&stage);
    }
}

/* The image on the lattice has the same bits; its warp in plain C rounds
 * products and sums apart. */
static void all_vector_levels_give_the_same_image(void **state) {
    (void)state;
    model_stage stage = model_open();
    for (int n = 0; n < VALUE_PICTURES; n += (int)support_stride(13)) {
        reference_scene s = value_picture_scene(n);
        size_t count = 4 * (size_t)s.view.width * (size_t)s.view.height;
        s.settings.isa = SNOW_ISA_SCALAR;
        float *plain = model_picture(&stage, &s), *first = NULL;
        for (snow_isa isa = SNOW_ISA_AVX2; isa <= SNOW_ISA_AVX512; isa++) {
            if (!snow_isa_runs(isa))
                continue;
            s.settings.isa = isa;
            float *other = model_picture(&stage, &s);
            for (size_t i = 0; i < count; i++)
                assert_near(other[i], plain[i], WARP_BOUND);
            if (first)
                same_bits(n, first, other, count);
            else
                first = other;
        }
        free(plain);
        free(first);
        value_picture_free(&s);
    }
    model_close(&stage);
}

/* --- what a frame keeps --------------------------------------------------- */

/* A frozen volume of a scene. */
static snow_volume *frozen(const model_stage *stage, const reference_scene *s) {
    snow_volume *volume = NULL;
    assert_int_equal(
        snow_volume_wrap(stage->context, &s->info, s->voxels, &volume),
        SNOW_STATUS_OK);
    snow_volume_freeze(volume);
    return volume;
}

static snow_status shoot(const model_stage *stage, const snow_volume *volume,
                         const reference_scene *s, snow_image **image) {
    snow_transfer *transfer = model_transfer(stage->context, s);
    *image = NULL;
    snow_status status = snow_frame_render(stage->frame, volume, transfer,
                                           &s->view, &s->settings, image);
    snow_transfer_free(transfer);
    return status;
}

/* A picture of a frame that has a history, and whether it was encoded for it;
 * it has the bits of one that has none. */
static bool encodes(const model_stage *stage, const snow_volume *volume,
                    const reference_scene *s) {
    snow_image *image, *fresh;
    model_stage other = {.context = stage->context};
    assert_int_equal(snow_frame_new(stage->context, &other.frame),
                     SNOW_STATUS_OK);
    assert_int_equal(shoot(stage, volume, s, &image), SNOW_STATUS_OK);
    assert_int_equal(shoot(&other, volume, s, &fresh), SNOW_STATUS_OK);
    assert_memory_equal(snow_image_pixels(image), snow_image_pixels(fresh),
                        (size_t)s->view.width * (size_t)s->view.height *
                            (size_t)snow_image_channels(image) * sizeof(float));
    snow_image_free(image);
    snow_image_free(fresh);
    snow_frame_free(other.frame);
    return snow_frame_stats(stage->frame)->encoded;
}

static void only_what_shows_more_is_encoded_anew(void **state) {
    (void)state;
    static const snow_opacity_point less[] = {
        {0, 0}, {45, 0}, {70, 0.6}, {100, 0.9}};
    static const snow_opacity_point more[] = {
        {0, 0}, {15, 0}, {70, 0.6}, {100, 0.9}};
    model_stage stage = model_open();
    reference_scene s = value_picture_scene(0);
    snow_volume *volume = frozen(&stage, &s);
    s.opacities = above;
    s.opacity_count = COUNT(above);
    assert_true(encodes(&stage, volume, &s));
    model_turn(&s, -20, 12, 5, 0.9);
    assert_false(encodes(&stage, volume, &s));
    s.settings.light = SNOW_LIGHT_DIRECTION;
    s.settings.light_azimuth = 70;
    assert_false(encodes(&stage, volume, &s));
    s.settings.shade = SNOW_SHADE_NONE;
    assert_false(encodes(&stage, volume, &s));
    s.opacities = less;
    assert_false(encodes(&stage, volume, &s));
    s.view.zoom = 3;
    assert_false(encodes(&stage, volume, &s));
    s.opacities = more;
    assert_true(encodes(&stage, volume, &s));
    model_turn(&s, 80, 0, 0, 1);
    assert_true(encodes(&stage, volume, &s));
    snow_volume_close(volume);
    value_picture_free(&s);
    model_close(&stage);
}

/* --- what is left to other methods ---------------------------------------- */

/* Slices so far apart that rays move aside by too many voxels: footprints draw
 * them, and rays their isosurface. */
static void slices_far_apart_are_left_to_others(void **state) {
    (void)state;
    model_stage stage = model_open();
    reference_scene s = value_picture_scene(10);
    for (int n = 0; n < 3; n++)
        s.info.matrix[n][2] *= 500;
    s.info.spacing[2] *= 500;
    model_look(&s, (double[]){0, 0, 1}, (double[]){0, 1, 0});
    model_turn(&s, 0, 0, 0, 1);
    free(model_picture(&stage, &s));
    assert_int_equal(snow_frame_stats(stage.frame)->method,
                     SNOW_METHOD_FOOTPRINT);
    s.settings.mode = SNOW_MODE_ISO;
    s.settings.iso = 50;
    free(model_picture(&stage, &s));
    assert_int_equal(snow_frame_stats(stage.frame)->method,
                     SNOW_METHOD_RAYCAST);
    value_picture_free(&s);
    model_close(&stage);
}

/* Nothing but infinities and one value is a picture too. */
static void odd_volumes_are_drawn(void **state) {
    (void)state;
    model_stage stage = model_open();
    reference_scene s = model_blank((int64_t[]){6, 7, 8}, 0.5);
    s.settings.method = SNOW_METHOD_SHEAR_WARP;
    for (int kind = 0; kind < 3; kind++) {
        for (int n = 0; n < 6 * 7 * 8; n++)
            model_voxels(&s)[n] = kind == 0   ? 3
                                  : kind == 1 ? INFINITY
                                  : n % 3     ? -INFINITY
                                              : 2;
        float *picture = model_picture(&stage, &s);
        for (int n = 0; n < 4 * s.view.width * s.view.height; n++)
            assert_true(picture[n] >= 0 && picture[n] <= 1);
        assert_true(
            (picture[4 * (s.view.height / 2 * s.view.width + s.view.width / 2) +
                     3] > 0.5F) == (kind != 1));
        free(picture);
    }
    model_free(&s);
    model_close(&stage);
}

/* One voxel of 3e38, and a look that is visible to its end. */
static void far_values_of_a_constant_look_take_no_numbers(void **state) {
    (void)state;
    const snow_color_point colors[] = {{2, 0, 0, 0}, {110, 1, 1, 1}};
    const snow_opacity_point opacities[] = {{18, 0}, {100, 0.7}};
    const snow_data_range data = {.low = -5, .high = 3e38};
    snow_context *context = NULL;
    snow_transfer *transfer = NULL;
    assert_int_equal(snow_context_new(NULL, &context), SNOW_STATUS_OK);
    assert_int_equal(
        snow_transfer_new(context, colors, 2, opacities, 2, &transfer),
        SNOW_STATUS_OK);
    const snow_volume_info floats = {.type = SNOW_TYPE_FLOAT32, .slope = 1};
    snow_value_scale14 scale = snow_value_scale_of(&data, transfer, &floats);
    assert_near(scale.low, -5, 1e-9);
    assert_near(scale.high, 110 + 4 * (110 - 18), 1e-9);
    snow_transfer_free(transfer);
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_are_the_references),
        cmocka_unit_test(threads_and_encodings_give_the_same_bits),
        cmocka_unit_test(all_vector_levels_give_the_same_image),
        cmocka_unit_test(only_what_shows_more_is_encoded_anew),
        cmocka_unit_test(slices_far_apart_are_left_to_others),
        cmocka_unit_test(odd_volumes_are_drawn),
        cmocka_unit_test(far_values_of_a_constant_look_take_no_numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
