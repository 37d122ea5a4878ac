/* tests/shear_warp/test_fields.c - what a field can have beside values, in
 * pictures by method shear-warp: holes, planes, labels, thin axes, logarithms,
 * gradient opacity, thresholds. */
#include "shear_warp/formulas.h"

#include <math.h>

static const int64_t dims[3] = {8, 8, 9};

static double constant(const double at[3]) {
    (void)at;
    return 7;
}

static double rise(const double at[3]) {
    return 10 + 2 * at[2];
}

static double halves(const double at[3]) {
    return at[0] < 4 ? 1 : 3;
}

static const snow_color_point white[] = {{1e-4, 1, 1, 1}}; /* has a logarithm */

static double middle_alpha(const warp_scene *scene) {
    double rgba[4];
    formula_scene_middle(scene, rgba);
    return rgba[3];
}

/* The middle has the opacity of so many slices. */
static void slabs(const warp_scene *scene, double opacity, double count) {
    assert_near(middle_alpha(scene), 1 - pow(1 - opacity, count), 4e-4);
}

/* Other opacities than the scene's own, which stay to be freed. */
static warp_scene with_opacities(const warp_scene *scene,
                                 const snow_opacity_point *points,
                                 size_t count) {
    warp_scene other = *scene;
    other.base.opacities = points;
    other.base.opacity_count = count;
    return other;
}

/* --- holes and cuts ------------------------------------------------------- */

static void a_slab_beside_a_hole_is_empty(void **state) {
    (void)state;
    warp_scene scene = formula_scene(dims, constant, 0.2);
    for (int n = 8 * 8 * 6; n < 8 * 8 * 9; n++) /* the last three slices */
        model_voxels(&scene.base)[n] = NAN;
    scene.base.settings.quality = SNOW_QUALITY_DRAFT;
    slabs(&scene, 0.2, 5);
    scene.base.settings.quality = SNOW_QUALITY_HIGH;
    slabs(&scene, 0.2, 5.5); /* half of the way to the hole */
    model_free(&scene.base);
}

static void a_hole_in_the_plane_reaches_half_a_voxel(void **state) {
    (void)state;
    warp_scene scene = formula_scene(dims, constant, 0.2);
    for (int n = 0; n < 8 * 8 * 9; n += 8)
        for (int i = 0; i < 4; i++)
            model_voxels(&scene.base)[n + i] = NAN;
    scene.base.settings.quality = SNOW_QUALITY_HIGH;
    for (int side = -1; side <= 1; side += 2) {
        scene.base.view.has_target = true;
        scene.base.view.target[0] = 3.5 + 0.35 * side;
        scene.base.view.target[1] = 3.5;
        scene.base.view.target[2] = 4;
        slabs(&scene, 0.2, side > 0 ? 8 : 0);
    }
    model_free(&scene.base);
}

static double fourth_slice(const double at[3]) {
    return at[2] == 4 ? 10 : 0;
}

/* Of both slabs beside it half is seen, though one of their resampled slices
 * shows nothing. */
static void a_single_slice_that_is_seen_fills_half_of_both_slabs(void **state) {
    (void)state;
    static const snow_opacity_point step[] = {{5, 0}, {5, 0.5}};
    warp_scene made = formula_scene(dims, fourth_slice, 0);
    warp_scene scene = with_opacities(&made, step, 2);
    for (int n = 0; n < QUALITIES; n++) {
        scene.base.settings.quality = qualities[n];
        assert_near(middle_alpha(&scene), 0.5, 0.02);
    }
    model_free(&made.base);
}

static void planes_cut_exactly(void **state) {
    (void)state;
    warp_scene scene = formula_scene(dims, constant, 0.2);
    const double planes[][4] = {{0, 0, 1, 5.3}, {0, 0, -1, -2.1}};
    memcpy(scene.planes, planes, sizeof planes);
    for (int n = 0; n < QUALITIES; n++) {
        scene.base.settings.quality = qualities[n];
        scene.plane_count = 2;
        slabs(&scene, 0.2, 5.3 - 2.1);
        scene.plane_count = 1;
        slabs(&scene, 0.2, 5.3);
    }
    model_free(&scene.base);
}

static void cut_values_are_those_of_the_uncut_field(void **state) {
    (void)state;
    /* A step of the look at 20.5, which is met at z = 5.25. */
    static const snow_opacity_point edge[] = {{20.5, 0}, {20.5, 1}};
    warp_scene made = formula_scene(dims, rise, 0);
    warp_scene scene = with_opacities(&made, edge, 2);
    scene.planes[0][2] = 1;
    scene.plane_count = 1;
    scene.planes[0][3] = 5.1;
    assert_true(middle_alpha(&scene) == 0);
    scene.planes[0][3] = 5.6;
    assert_near(middle_alpha(&scene), 1, 1e-4);
    model_free(&made.base);
}

static void a_single_slice_is_one_spacing_thick(void **state) {
    (void)state;
    for (int side = 0; side < 3; side++)
        for (int n = 0; n < QUALITIES; n++) {
            int64_t sizes[3] = {9, 9, 9};
            sizes[side] = 1;
            warp_scene scene = formula_scene(sizes, constant, 0.3);
            formula_scene_look(&scene, side, 0, 0, 0);
            scene.base.settings.quality = qualities[n];
            slabs(&scene, 0.3, 1);
            model_free(&scene.base);
        }
}

/* --- splines -------------------------------------------------------------- */

static int parabola_axis;

static double parabola(const double at[3]) {
    double x = at[parabola_axis] - 4;
    return 10 + x * x;
}

/* The cubic B-spline has the variance 1/3, and so lifts a parabola by it: in
 * the plane everywhere, and along the slices' axis at its vertex, which is a
 * slice. */
static void a_spline_lifts_a_parabola_by_a_third(void **state) {
    (void)state;
    static const snow_color_point grey[] = {{0, 0, 0, 0}, {20, 1, 1, 1}};
    for (int n = 0; n < 7; n++) {
        const double aside = n < 6 ? 0.25 * (n / 2) : 0;
        double rgba[4];
        parabola_axis = n < 6 ? n % 2 : 2;
        warp_scene scene = formula_scene((int64_t[]){9, 9, 9}, parabola, 1);
        snow_view *view = &scene.base.view;
        scene.base.settings.mode = SNOW_MODE_MINIP;
        scene.base.settings.quality = SNOW_QUALITY_HIGH; /* four samples */
        scene.base.settings.kernel = SNOW_KERNEL_BSPLINE;
        scene.base.settings.footprint = 4;
        scene.base.colors = grey;
        scene.base.color_count = 2;
        view->has_target = true;
        for (int c = 0; c < 3; c++)
            view->target[c] = 4;
        view->target[parabola_axis] += aside;
        formula_scene_middle(&scene, rgba);
        assert_near(rgba[0], (10 + aside * aside + 1.0 / 3) / 20, 5e-4);
        model_free(&scene.base);
    }
}

/* --- labels --------------------------------------------------------------- */

static const snow_color_point names[] = {{0, 1, 0, 0},   {1.5, 1, 0, 0},
                                         {1.5, 0, 1, 0}, {2.5, 0, 1, 0},
                                         {2.5, 0, 0, 1}, {4, 0, 0, 1}};

/* Of bytes; floats are no labels. */
static warp_scene labelled(double opacity) {
    warp_scene scene = formula_scene(dims, halves, opacity);
    int8_t *bytes = (int8_t *)(uintptr_t)scene.base.voxels;
    for (int n = 0; n < 8 * 8 * 9; n++)
        bytes[n] = (int8_t)model_voxels(&scene.base)[n];
    scene.base.info.type = SNOW_TYPE_INT8;
    scene.base.colors = names;
    scene.base.color_count = sizeof names / sizeof *names;
    return scene;
}

static void labels_do_not_mix(void **state) {
    model_stage *stage = *state;
    warp_scene scene = labelled(0.2);
    scene.base.view.zoom = 3;
    for (int n = 0; n < QUALITIES; n++) {
        scene.base.settings.quality = qualities[n];
        float *picture = warp_scene_render(stage, &scene), most = 0;
        for (int p = 0; p < 49 * 41; p++)
            most = fmaxf(most, picture[4 * p + 1]);
        assert_true(most == 0); /* no label between the two */
        assert_near((double)picture[4 * (20 * 49 + 10)], 1 - pow(0.8, 8), 1e-3);
        assert_near((double)picture[4 * (20 * 49 + 38) + 2], 1 - pow(0.8, 8),
                    1e-3);
        free(picture);
    }
    model_free(&scene.base);
}

static void labels_are_lit_by_their_membership(void **state) {
    (void)state;
    static const snow_opacity_point second[] = {{2, 0}, {2, 1}};
    warp_scene made = labelled(1);
    warp_scene scene = with_opacities(&made, second, 2);
    double rgba[4];
    scene.base.settings.shade = SNOW_SHADE_PHONG;
    scene.base.settings.quality = SNOW_QUALITY_HIGH;
    formula_scene_look(&scene, 0, 180, 0, 0); /* from -x on to the step */
    formula_scene_middle(&scene, rgba);
    assert_near(rgba[3], 1, 1e-4);
    assert_near(rgba[2], 1, 1e-4);
    model_free(&made.base);
}

/* --- looks ---------------------------------------------------------------- */

static void gradient_opacity_does_not_depend_on_slabs(void **state) {
    (void)state;
    static const snow_opacity_point factor[] = {{0, 0}, {4, 1}};
    warp_scene scene = formula_scene(dims, rise, 0.4);
    scene.base.gradients = factor;
    scene.base.gradient_count = 2;
    for (int n = 0; n < QUALITIES; n++) {
        scene.base.settings.quality = qualities[n];
        slabs(&scene, 0.4 * 2 / 4, 8);
    }
    model_free(&scene.base);
}

static double growth(const double at[3]) {
    return pow(10, 0.2 * at[2]);
}

static void gradient_opacity_is_of_the_data_under_logarithms(void **state) {
    (void)state;
    /* All of the slopes are above the factor's end, unless logarithms' are. */
    static const snow_opacity_point factor[] = {{0.3, 0}, {0.4, 1}};
    warp_scene scene = formula_scene(dims, growth, 0.4);
    scene.base.log = true;
    scene.base.colors = white;
    scene.base.gradients = factor;
    scene.base.gradient_count = 2;
    slabs(&scene, 0.4, 8);
    model_free(&scene.base);
}

static void the_threshold_is_of_the_look(void **state) {
    (void)state;
    warp_scene scene = formula_scene(dims, constant, 0.2);
    scene.base.settings.threshold = 51;
    assert_true(middle_alpha(&scene) == 0);
    scene.base.settings.threshold = 50.9;
    slabs(&scene, 0.2, 8);
    model_free(&scene.base);
}

static double powers(const double at[3]) {
    return pow(10, at[2] - 3);
}

/* A decade a slice: opacities that rise by logarithms are even steps. */
static void logarithms_are_linear_and_need_values_above_zero(void **state) {
    (void)state;
    static const snow_opacity_point decades[] = {
        {1e-3, 0}, {1e5, 0.8}, {1e6, 0.8}};
    warp_scene made = formula_scene(dims, powers, 0.2);
    made.base.log = true;
    made.base.colors = white;
    warp_scene scene = with_opacities(&made, decades, 3);
    double left = 1;
    for (int n = 0; n < 8000; n++)
        left *= pow(1 - 0.8 * (n + 0.5) / 8000, 8.0 / 8000);
    scene.base.settings.quality = SNOW_QUALITY_HIGH;
    assert_near(middle_alpha(&scene), 1 - left, 1e-3);
    for (int n = 0; n < 8 * 8 * 2; n++)
        model_voxels(&made.base)[n] = n % 2 ? 0 : -1;
    made.base.settings.quality = SNOW_QUALITY_DRAFT;
    slabs(&made, 0.2, 6);
    model_free(&made.base);
}

/* One voxel that is far above the others does not make them coarse: where a
 * look shows a small part of the range, its steps are of that part. */
static void a_far_value_does_not_make_others_coarse(void **state) {
    (void)state;
    static const snow_opacity_point ramp[] = {{9, 0}, {27, 0.5}, {28, 0}};
    warp_scene made = formula_scene(dims, rise, 0.2);
    warp_scene scene = with_opacities(&made, ramp, 3);
    double before = middle_alpha(&scene);
    model_voxels(&made.base)[0] = INFINITY;
    model_voxels(&made.base)[1] = 1e7;
    model_voxels(&made.base)[2] = -1e7;
    assert_near(middle_alpha(&scene), before, 2e-3);
    model_free(&made.base);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_slab_beside_a_hole_is_empty),
        cmocka_unit_test(a_hole_in_the_plane_reaches_half_a_voxel),
        cmocka_unit_test(a_single_slice_that_is_seen_fills_half_of_both_slabs),
        cmocka_unit_test(planes_cut_exactly),
        cmocka_unit_test(cut_values_are_those_of_the_uncut_field),
        cmocka_unit_test(a_single_slice_is_one_spacing_thick),
        cmocka_unit_test(a_spline_lifts_a_parabola_by_a_third),
        MODEL_TEST(labels_do_not_mix),
        cmocka_unit_test(labels_are_lit_by_their_membership),
        cmocka_unit_test(gradient_opacity_does_not_depend_on_slabs),
        cmocka_unit_test(gradient_opacity_is_of_the_data_under_logarithms),
        cmocka_unit_test(the_threshold_is_of_the_look),
        cmocka_unit_test(logarithms_are_linear_and_need_values_above_zero),
        cmocka_unit_test(a_far_value_does_not_make_others_coarse),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
