/* tests/render/test_shear_warp.c - what a frame keeps from picture to picture
 * by method shear-warp, and what that leaves to other methods. */
#include "render/picture.h"
#include "shear_warp/scenes.h"

#include <math.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const snow_opacity_point above[] = {
    {0, 0}, {35, 0}, {70, 0.6}, {100, 0.9}};

/* --- what a frame keeps --------------------------------------------------- */

/* A picture of a frame that has a history, and whether it was encoded for it;
 * it has the bits of one that has none. */
static bool encodes(const model_stage *stage, const snow_volume *volume,
                    const reference_scene *s) {
    model_stage other = {.context = stage->context};
    assert_int_equal(snow_frame_new(stage->context, &other.frame),
                     SNOW_STATUS_OK);
    snow_image *image = model_image_of(stage, s, volume);
    snow_image *fresh = model_image_of(&other, s, volume);
    assert_true(snow_image_checksum(image) == snow_image_checksum(fresh));
    snow_image_free(image);
    snow_image_free(fresh);
    snow_frame_free(other.frame);
    return snow_frame_stats(stage->frame)->encoded;
}

static void only_what_shows_more_is_encoded_anew(void **state) {
    static const snow_opacity_point less[] = {
        {0, 0}, {45, 0}, {70, 0.6}, {100, 0.9}};
    static const snow_opacity_point more[] = {
        {0, 0}, {15, 0}, {70, 0.6}, {100, 0.9}};
    model_stage *stage = *state;
    reference_scene s = noisy_scene(0).base;
    snow_volume *volume = model_volume(stage->context, &s);
    snow_volume_freeze(volume);
    s.opacities = above;
    s.opacity_count = COUNT(above);
    assert_true(encodes(stage, volume, &s));
    model_turn(&s, -20, 12, 5, 0.9);
    assert_false(encodes(stage, volume, &s));
    s.settings.light = SNOW_LIGHT_DIRECTION;
    s.settings.light_azimuth = 70;
    assert_false(encodes(stage, volume, &s));
    s.settings.shade = SNOW_SHADE_NONE;
    assert_false(encodes(stage, volume, &s));
    s.opacities = less;
    assert_false(encodes(stage, volume, &s));
    s.view.zoom = 3;
    assert_false(encodes(stage, volume, &s));
    s.opacities = more;
    assert_true(encodes(stage, volume, &s));
    model_turn(&s, 80, 0, 0, 1);
    assert_true(encodes(stage, volume, &s));
    snow_volume_close(volume);
    model_free(&s);
}

/* --- what is left to other methods ---------------------------------------- */

/* Slices so far apart that rays move aside by too many voxels: footprints draw
 * them, and rays their isosurface. */
static void slices_far_apart_are_left_to_others(void **state) {
    model_stage *stage = *state;
    reference_scene s = noisy_scene(10).base;
    for (int n = 0; n < 3; n++)
        s.info.matrix[n][2] *= 500;
    s.info.spacing[2] *= 500;
    model_look(&s, (double[]){0, 0, 1}, (double[]){0, 1, 0});
    model_turn(&s, 0, 0, 0, 1);
    free(model_picture(stage, &s));
    assert_int_equal(snow_frame_stats(stage->frame)->method,
                     SNOW_METHOD_FOOTPRINT);
    s.settings.mode = SNOW_MODE_ISO;
    s.settings.iso = 50;
    free(model_picture(stage, &s));
    assert_int_equal(snow_frame_stats(stage->frame)->method,
                     SNOW_METHOD_RAYCAST);
    model_free(&s);
}

/* Nothing but infinities and one value is a picture too. */
static void odd_volumes_are_drawn(void **state) {
    model_stage *stage = *state;
    reference_scene s = model_blank((int64_t[]){6, 7, 8}, 0.5);
    s.settings.method = SNOW_METHOD_SHEAR_WARP;
    for (int kind = 0; kind < 3; kind++) {
        for (int n = 0; n < 6 * 7 * 8; n++)
            model_voxels(&s)[n] = kind == 0   ? 3
                                  : kind == 1 ? INFINITY
                                  : n % 3     ? -INFINITY
                                              : 2;
        float *picture = model_picture(stage, &s);
        for (int n = 0; n < 4 * s.view.width * s.view.height; n++)
            assert_true(picture[n] >= 0 && picture[n] <= 1);
        assert_true(
            (picture[4 * (s.view.height / 2 * s.view.width + s.view.width / 2) +
                     3] > 0.5F) == (kind != 1));
        free(picture);
    }
    model_free(&s);
}

/* Where the eye is farther above the first slice than an eighth of the volume's
 * height, whose middle it looks at. */
static void an_eye_is_as_near_as_an_eighth(void **state) {
    model_stage *stage = *state;
    for (int near = 0; near < 2; near++) {
        const double height = 1 / (near ? 7.01 : 6.99);
        warp_scene scene = noisy_scene(1);
        reference_scene *s = &scene.base;
        s->view.fov = 60;
        s->view.has_target = s->view.has_position = s->view.has_view_up = true;
        s->view.view_up[1] = 1;
        s->view.azimuth = s->view.elevation = s->view.roll = 0;
        warp_scene_place(s, (double[]){0.5, 0.5, 0.5}, s->view.target);
        warp_scene_place(s, (double[]){0.5, 0.5, -height}, s->view.position);
        free(model_picture(stage, s));
        assert_int_equal(snow_frame_stats(stage->frame)->method,
                         near ? SNOW_METHOD_FOOTPRINT : SNOW_METHOD_SHEAR_WARP);
        warp_scene_free(&scene);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        MODEL_TEST(only_what_shows_more_is_encoded_anew),
        MODEL_TEST(slices_far_apart_are_left_to_others),
        MODEL_TEST(odd_volumes_are_drawn),
        MODEL_TEST(an_eye_is_as_near_as_an_eighth),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
