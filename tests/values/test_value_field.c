/* tests/values/test_value_field.c - what a field can have beside values: holes,
 * crops, planes, labels, thin axes, logarithms; and where rays end. */
#include "values/scenes.h"

#include <math.h>

static double constant(const double at[3]) {
    (void)at;
    return 7;
}

static double rise(const double at[3]) {
    return 10 + 2 * at[2];
}

static double wave(const double at[3]) {
    return 50 + 30 * sin(0.35 * at[0] + 0.2 * at[1]) * cos(0.3 * at[2]) + at[1];
}

/* The sample whose ray meets the front sheet at the middle of the field. */
static void middle_sample(const value_plan *plan, double out[4]) {
    value_model *model = value_model_new(plan);
    double front[2], ab[2];
    for (int n = 0; n < 2; n++)
        front[n] = floor((double)plan->dims[n] / 2);
    value_lattice_of(plan, front, ab);
    value_model_sample(model, (int64_t)rint(ab[0]), (int64_t)rint(ab[1]), out);
    value_model_free(model);
}

static double middle_alpha(const value_scene *scene) {
    double sample[4];
    value_plan plan = value_scene_plan(scene);
    middle_sample(&plan, sample);
    return sample[3];
}

static void slabs(double opacity, double count, double actual) {
    double expected = 1 - pow(1 - opacity, count);
    if (fabs(actual - expected) > 3e-4)
        fail_msg("alpha %g, not %g of %g slabs", actual, expected, count);
}

static void a_slab_beside_a_hole_is_empty(void **state) {
    (void)state;
    value_scene scene = value_scene_of((int64_t[]){8, 8, 9}, constant, 0.2);
    for (int n = 0; n < 8 * 8 * 3; n++) /* the last three slices */
        value_scene_voxels(&scene)[n + 8 * 8 * 6] = (double)NAN;
    slabs(0.2, 5, middle_alpha(&scene));
    scene.base.settings.quality = SNOW_QUALITY_HIGH;
    slabs(0.2, 5.5, middle_alpha(&scene)); /* half of the way to the hole */
    value_scene_free(&scene);
}

static void a_hole_in_the_plane_reaches_half_a_voxel(void **state) {
    (void)state;
    value_scene scene = value_scene_of((int64_t[]){8, 8, 4}, constant, 0.2);
    for (int n = 0; n < 8 * 8 * 4; n += 8) /* u = 0 */
        value_scene_voxels(&scene)[n] = (double)NAN;
    scene.base.settings.quality = SNOW_QUALITY_HIGH;
    scene.base.view.zoom = 0.9; /* two samples a voxel, or four */
    value_plan plan = value_scene_plan(&scene);
    value_model *model = value_model_new(&plan);
    assert_int_equal(plan.cells[0], 4);
    for (int64_t a = 0; a <= 28; a++) {
        double sample[4];
        value_model_sample(model, a, 12, sample);
        slabs(0.2, a >= 2 ? 3 : 0, sample[3]);
    }
    value_model_free(model);
    value_scene_free(&scene);
}

static void differences_beside_holes_are_one_sided(void **state) {
    (void)state;
    value_scene scene = value_scene_of((int64_t[]){8, 8, 9}, rise, 0.2);
    for (int n = 0; n < 8 * 8; n++)
        value_scene_voxels(&scene)[n + 8 * 8 * 4] = (double)NAN;
    value_plan plan = value_scene_plan(&scene);
    value_field field;
    value_field_make(&plan, &field);
    value_ray ray = value_ray_of(&plan, 4, 4);
    double unit = (plan.high - plan.low) / VALUE_MOST;
    for (int slab = 0; slab < 8; slab++) {
        double gradient[3];
        bool empty = value_sheet(&field, slab, 4, 4) == VALUE_HOLE ||
                     value_sheet(&field, slab + 1, 4, 4) == VALUE_HOLE;
        value_gradient(&field, &ray, slab, 16384, gradient);
        assert_int_equal(empty, slab == 3 || slab == 4);
        if (!empty)
            assert_true(fabs(gradient[2] / 2 * unit - 2) < 6 * unit);
    }
    value_field_free(&field);
    value_scene_free(&scene);
}

static void crops_and_planes_cut_exactly(void **state) {
    (void)state;
    value_scene scene = value_scene_of((int64_t[]){8, 8, 9}, constant, 0.2);
    const double plane[][4] = {{0, 0, 1, 5.3}, {0, 0, -1, -2.1}};
    scene.clips = plane;
    scene.clip_count = 2;
    for (int n = 0; n < VALUE_QUALITIES; n++) {
        scene.base.settings.quality = value_qualities[n];
        slabs(0.2, 5.3 - 2.1, middle_alpha(&scene));
    }
    scene.clip_count = 1;
    scene.cropped = true;
    for (int n = 0; n < 3; n++) {
        scene.keep[n][0] = 0;
        scene.keep[n][1] = 7;
    }
    scene.keep[2][0] = 4;
    slabs(0.2, 5.3 - 4, middle_alpha(&scene));
    value_scene_free(&scene);
}

static void cut_values_are_those_of_the_uncut_field(void **state) {
    (void)state;
    /* A step of the look at 20.5, which is met at z = 5.25. */
    value_scene scene = value_scene_of((int64_t[]){8, 8, 9}, rise, 0);
    static const snow_opacity_point edge[] = {{20.5, 0}, {20.5, 1}};
    free((void *)(uintptr_t)scene.base.opacities);
    scene.base.opacities = edge;
    scene.base.opacity_count = 2;
    double plane[][4] = {{0, 0, 1, 5.1}};
    scene.clips = (const double(*)[4])plane;
    scene.clip_count = 1;
    assert_true(middle_alpha(&scene) == 0);
    plane[0][3] = 5.6;
    assert_true(middle_alpha(&scene) == 1);
    value_scene_free(&scene);
}

static void a_single_slice_is_one_spacing_thick(void **state) {
    (void)state;
    for (int side = 0; side < 3; side++)
        for (int n = 0; n < VALUE_QUALITIES; n++) {
            int64_t dims[3] = {9, 9, 9};
            dims[side] = 1;
            value_scene scene = value_scene_of(dims, constant, 0.3);
            value_scene_look(&scene, side, 0, 0, 0);
            scene.base.settings.quality = value_qualities[n];
            slabs(0.3, 1, middle_alpha(&scene));
            value_scene_free(&scene);
        }
}

/* --- labels --------------------------------------------------------------- */

static double halves(const double at[3]) {
    return at[0] < 4 ? 1 : 3;
}

static void labels_do_not_mix(void **state) {
    (void)state;
    value_scene scene = value_scene_of((int64_t[]){8, 8, 9}, halves, 0.2);
    static const snow_color_point colors[] = {
        {1, 1, 0, 0}, {2, 0, 1, 0}, {3, 0, 0, 1}};
    scene.base.colors = colors;
    scene.base.color_count = 3;
    scene.labels = true;
    for (int n = 0; n < VALUE_QUALITIES; n++) {
        scene.base.settings.quality = value_qualities[n];
        value_plan plan = value_scene_plan(&scene);
        value_model *model = value_model_new(&plan);
        for (double u = 0; u <= 7; u += 0.25) {
            double sample[4], front[2] = {u, 3}, ab[2];
            value_lattice_of(&plan, front, ab);
            if (ab[0] != rint(ab[0]) || ab[1] != rint(ab[1]))
                continue;
            value_model_sample(model, (int64_t)ab[0], (int64_t)ab[1], sample);
            slabs(0.2, 8, sample[3]);
            assert_true(sample[1] == 0); /* no label between the two */
            assert_true(sample[u < 3.5 ? 0 : 2] == sample[3]);
        }
        value_model_free(model);
    }
    value_scene_free(&scene);
}

static void labels_are_lit_by_their_membership(void **state) {
    (void)state;
    value_scene scene = value_scene_of((int64_t[]){8, 8, 9}, halves, 1);
    static const snow_opacity_point second[] = {{2, 0}, {2, 1}};
    free((void *)(uintptr_t)scene.base.opacities);
    scene.base.opacities = second;
    scene.base.opacity_count = 2;
    scene.labels = true;
    scene.base.settings.shade = SNOW_SHADE_PHONG;
    scene.base.settings.quality = SNOW_QUALITY_HIGH;
    scene.base.settings.light = SNOW_LIGHT_HEAD;
    value_scene_look(&scene, 0, 180, 0, 0); /* from -x on to the step */
    value_plan plan = value_scene_plan(&scene);
    double sample[4];
    middle_sample(&plan, sample);
    assert_true(sample[3] > 0.9999 && sample[0] > 0.9999);
    value_scene_free(&scene);
}

/* --- looks ---------------------------------------------------------------- */

static void gradient_opacity_does_not_depend_on_slabs(void **state) {
    (void)state;
    static const snow_opacity_point factor[] = {{0, 0}, {4, 1}};
    value_scene scene = value_scene_of((int64_t[]){8, 8, 9}, rise, 0.4);
    scene.base.gradients = factor;
    scene.base.gradient_count = 2;
    for (int n = 0; n < VALUE_QUALITIES; n++) {
        scene.base.settings.quality = value_qualities[n];
        slabs(0.4 * 2 / 4, 8, middle_alpha(&scene));
    }
    value_scene_free(&scene);
}

static double growth(const double at[3]) {
    return pow(10, 0.2 * at[2]);
}

static void gradient_opacity_is_of_the_data_under_logarithms(void **state) {
    (void)state;
    /* All of the slopes are above the factor's end, unless logarithms' are. */
    static const snow_opacity_point factor[] = {{0.3, 0}, {0.4, 1}};
    value_scene scene = value_scene_of((int64_t[]){8, 8, 9}, growth, 0.4);
    scene.base.log = true;
    scene.base.gradients = factor;
    scene.base.gradient_count = 2;
    slabs(0.4, 8, middle_alpha(&scene));
    value_scene_free(&scene);
}

static void the_threshold_is_of_the_look(void **state) {
    (void)state;
    value_scene scene = value_scene_of((int64_t[]){8, 8, 9}, constant, 0.2);
    scene.base.settings.threshold = 51;
    assert_true(middle_alpha(&scene) == 0);
    scene.base.settings.threshold = 50.9;
    slabs(0.2, 8, middle_alpha(&scene));
    value_scene_free(&scene);
}

static double powers(const double at[3]) {
    return pow(10, at[2] - 3);
}

static void logarithms_are_linear_and_need_values_above_zero(void **state) {
    (void)state;
    value_scene scene = value_scene_of((int64_t[]){8, 8, 9}, powers, 0.2);
    scene.base.log = true;
    value_plan plan = value_scene_plan(&scene);
    value_field field;
    value_field_make(&plan, &field);
    for (int n = 0; n < 9; n++)
        assert_int_equal(value_sheet(&field, n, 3.3, 4.1),
                         (int)rint(VALUE_MOST * (8 - n) / 8.0));
    value_field_free(&field);
    for (int n = 0; n < 8 * 8 * 2; n++)
        value_scene_voxels(&scene)[n] = n % 2 ? 0 : -1;
    slabs(0.2, 6, middle_alpha(&scene));
    value_scene_free(&scene);
}

static void infinities_are_the_ends_and_the_range_narrows(void **state) {
    (void)state;
    static const snow_opacity_point small[] = {{9, 0}, {12, 0.5}, {15, 0}};
    value_scene scene = value_scene_of((int64_t[]){8, 8, 9}, rise, 0.2);
    double *voxels = value_scene_voxels(&scene);
    voxels[0] = INFINITY;
    voxels[1] = -INFINITY;
    voxels[2] = 1e6;
    value_plan plan = value_scene_plan(&scene);
    assert_true(plan.low == 10 && plan.high == 1e6);
    value_field field;
    value_field_make(&plan, &field);
    assert_int_equal(field.codes[0], VALUE_MOST);
    assert_int_equal(field.codes[1], 0);
    value_field_free(&field);
    free((void *)(uintptr_t)scene.base.opacities);
    scene.base.opacities = small;
    scene.base.opacity_count = 3;
    plan = value_scene_plan(&scene); /* seen is 10 to 15 */
    assert_true(plan.low == 10 && plan.high == 15 + 4 * 5);
    free((void *)(uintptr_t)scene.base.voxels);
}

/* --- ends of rays --------------------------------------------------------- */

static void rays_that_close_early_change_next_to_nothing(void **state) {
    (void)state;
    value_scene scene = value_scene_of((int64_t[]){20, 22, 21}, wave, 0.5);
    value_scene_look(&scene, 2, 20, 25, 0);
    value_plan plan = value_scene_plan(&scene);
    value_model *all = value_model_new(&plan), *some = value_model_new(&plan);
    some->close_at = 1 - 1.0 / 510;
    double most = 0;
    for (int n = 0; n < 48 * 40; n++) {
        double a[4], b[4];
        value_model_pixel(all, n % 48, n / 48, a);
        value_model_pixel(some, n % 48, n / 48, b);
        for (int c = 0; c < 4; c++)
            most = fmax(most, fabs(a[c] - b[c]));
    }
    assert_true(most > 0 && most < 1.0 / 255);
    value_model_free(all);
    value_model_free(some);
    value_scene_free(&scene);
}

static void the_eye_must_be_outside_the_slices(void **state) {
    (void)state;
    value_plan plan;
    value_scene scene = value_scene_of((int64_t[]){20, 20, 40}, wave, 0.5);
    value_scene_look(&scene, 0, 40, 0, 40);
    scene.base.view.has_position = true;
    scene.base.view.position[0] = 60;
    scene.base.view.position[1] = 9;
    scene.base.view.position[2] = 30;
    scene.base.settings.mode = SNOW_MODE_OVER;
    assert_true(value_plan_of(&scene, &plan));
    /* Beside the volume, before its middle: slices along x still. */
    scene.base.view.position[0] = 18;
    scene.base.view.position[2] = 19.5;
    assert_false(value_plan_of(&scene, &plan));
    value_scene_free(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_slab_beside_a_hole_is_empty),
        cmocka_unit_test(a_hole_in_the_plane_reaches_half_a_voxel),
        cmocka_unit_test(differences_beside_holes_are_one_sided),
        cmocka_unit_test(crops_and_planes_cut_exactly),
        cmocka_unit_test(cut_values_are_those_of_the_uncut_field),
        cmocka_unit_test(a_single_slice_is_one_spacing_thick),
        cmocka_unit_test(labels_do_not_mix),
        cmocka_unit_test(labels_are_lit_by_their_membership),
        cmocka_unit_test(gradient_opacity_does_not_depend_on_slabs),
        cmocka_unit_test(gradient_opacity_is_of_the_data_under_logarithms),
        cmocka_unit_test(the_threshold_is_of_the_look),
        cmocka_unit_test(logarithms_are_linear_and_need_values_above_zero),
        cmocka_unit_test(infinities_are_the_ends_and_the_range_narrows),
        cmocka_unit_test(rays_that_close_early_change_next_to_nothing),
        cmocka_unit_test(the_eye_must_be_outside_the_slices),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
