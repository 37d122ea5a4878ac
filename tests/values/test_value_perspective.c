/* tests/values/test_value_perspective.c - method shear-warp in perspective
 * beside the float64 reference of the value model, and what must not change a
 * bit of its pictures. */
#include <math.h>

#include "render/picture.h"
#include "values/pictures.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* The world position of an index position, in shares of the volume's sides. */
static void place(const reference_scene *s, const double share[3],
                  double out[3]) {
    for (int r = 0; r < 3; r++) {
        out[r] = s->info.matrix[r][3];
        for (int c = 0; c < 3; c++)
            out[r] +=
                s->info.matrix[r][c] * share[c] * (double)(s->info.dims[c] - 1);
    }
}

/* The scenes of the parallel test from an eye: with fields of view from narrow
 * to wide, with cameras off the volume's middle, and near to it. */
static reference_scene seen_from_an_eye(int n) {
    static const double fovs[] = {45, 20, 3, 75};
    static const double off[3] = {0.3, 0.6, 0.4}, middle[3] = {0.5, 0.5, 0.5};
    reference_scene s = value_picture_scene(n);
    s.view.fov = fovs[(size_t)n / 5 % COUNT(fovs)];
    if (n % 6 == 4) {
        s.view.has_target = true;
        place(&s, off, s.view.target);
    }
    if (n % 4 == 3 && s.info.dims[0] == 23) {
        double eye[3] = {0.48, 0.5, 0.51};
        eye[n / 4 % 3] = n / 4 % 2 ? -0.25 : 1.6;
        s.view.has_target = s.view.has_position = true;
        place(&s, middle, s.view.target);
        place(&s, eye, s.view.position);
        s.view.azimuth = s.view.elevation = 0;
    }
    return s;
}

static void pictures_are_the_references(void **state) {
    (void)state;
    model_stage stage = model_open();
    for (int n = (int)support_sweep(0, 10); n < VALUE_PICTURES;
         n += 5 * (int)support_stride(11)) {
        reference_scene s = seen_from_an_eye(n);
        value_picture_check(&stage, n, &(value_scene){.base = s});
        value_picture_free(&s);
    }
    model_close(&stage);
}

/* Makes holes of the voxels of a half, and of some others. */
static void punch(reference_scene *s, int n) {
    float *voxels = (float *)(uintptr_t)s->voxels;
    int64_t count = s->info.dims[0] * s->info.dims[1] * s->info.dims[2];
    uint64_t random = (uint64_t)n + 1;
    for (int64_t i = 0; i < count; i++)
        if (support_uniform(&random) < (2 * i > count ? 0.8 : 0.05))
            voxels[i] = NAN;
    s->masked = true;
}

static void holes_are_the_references(void **state) {
    (void)state;
    model_stage stage = model_open();
    for (int n = 2; n < VALUE_PICTURES; n += 15 * (int)support_stride(11)) {
        reference_scene s = seen_from_an_eye(n); /* of floats */
        punch(&s, n);
        value_picture_check(&stage, n, &(value_scene){.base = s});
        value_picture_free(&s);
    }
    model_close(&stage);
}

static void clip_planes_are_the_references(void **state) {
    (void)state;
    model_stage stage = model_open();
    for (int n = 0; n < VALUE_PICTURES; n += 9 * (int)support_stride(13)) {
        value_scene scene = {.base = seen_from_an_eye(n)};
        double planes[2][4];
        value_picture_clip(&scene, n % 2 ? 2 : 1, planes);
        value_picture_check(&stage, n, &scene);
        value_picture_free(&scene.base);
    }
    model_close(&stage);
}

static void nothing_changes_a_bit(void **state) {
    (void)state;
    model_stage stage = model_open();
    for (int n = 3; n < VALUE_PICTURES; n += 7 * (int)support_stride(23)) {
        reference_scene s = seen_from_an_eye(n);
        if (s.info.type == SNOW_TYPE_FLOAT32)
            punch(&s, n);
        value_picture_check_bits(&stage, n, &(value_scene){.base = s});
        value_picture_free(&s);
    }
    model_close(&stage);
}

/* --- where the eye is ----------------------------------------------------- */

/* The method that draws a scene. */
static snow_method method_of(const model_stage *stage,
                             const reference_scene *s) {
    free(model_picture(stage, s));
    return snow_frame_stats(stage->frame)->method;
}

/* An eye above the first slice, at such a part of the volume's height. */
static reference_scene near_scene(double height) {
    const double eye[3] = {0.5, 0.5, -height}, middle[3] = {0.5, 0.5, 0.5};
    reference_scene s = value_picture_scene(1);
    s.view.fov = 60;
    s.view.has_target = s.view.has_position = s.view.has_up = true;
    s.view.upward[1] = 1;
    s.view.azimuth = s.view.elevation = s.view.roll = 0;
    place(&s, middle, s.view.target);
    place(&s, eye, s.view.position);
    return s;
}

static void an_eye_is_as_near_as_an_eighth(void **state) {
    (void)state;
    model_stage stage = model_open();
    reference_scene s = near_scene(1 / 6.99);
    value_picture_check(&stage, 1, &(value_scene){.base = s});
    value_picture_free(&s);
    s = near_scene(1 / 7.01);
    assert_int_equal(method_of(&stage, &s), SNOW_METHOD_FOOTPRINT);
    value_picture_free(&s);
    model_close(&stage);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_are_the_references),
        cmocka_unit_test(holes_are_the_references),
        cmocka_unit_test(clip_planes_are_the_references),
        cmocka_unit_test(nothing_changes_a_bit),
        cmocka_unit_test(an_eye_is_as_near_as_an_eighth),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
