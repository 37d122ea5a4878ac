/* tests/render/test_model_picture.c - pictures of the footprint methods equal
 * the reference's.
 *
 * Small volumes through every kernel, footprint, view, zoom, field of view,
 * size, scalar type, matrix, shading and threshold.  Where all combinations
 * would be too many, one factor runs through all its values while the others
 * are drawn. */
#include "reference/model.h"
#include "render/tested.h"
#include "transform/perspective.h"

#include <math.h>

/* The largest difference that a float path may have. */
#define BOUND 1e-3
#define COUNT(array) (sizeof(array) / sizeof *(array))

static const double zooms[] = {0.3, 1, 4};
static const double thresholds[] = {0, 10, 30};
static const int64_t dims[3] = {13, 10, 15};

/* A scene that is drawn but for what the caller sets afterwards. */
static reference_scene drawn_scene(uint64_t *random) {
    reference_scene scene =
        model_scene(dims, model_type(model_draw(random, MODEL_TYPES)),
                    model_draw(random, 2) == 0,
                    (model_matrix)model_draw(random, MODEL_MATRICES),
                    model_draw(random, 99));
    snow_settings *settings = &scene.settings;
    scene.view.width = 24;
    scene.view.height = 18;
    model_stand_at(&scene, model_draw(random, MODEL_STANDS),
                   zooms[model_draw(random, COUNT(zooms))]);
    settings->shade =
        model_draw(random, 2) == 0 ? SNOW_SHADE_NONE : SNOW_SHADE_PHONG;
    settings->threshold = thresholds[model_draw(random, COUNT(thresholds))];
    if (settings->threshold == 0 && model_draw(random, 3) == 0)
        settings->method = SNOW_METHOD_ORIGINAL;
    else if (model_draw(random, 3) == 0)
        settings->method = SNOW_METHOD_TESTED;
    settings->encoding = (snow_encoding)model_draw(random, 4);
    return scene;
}

/* A scene of a type from side `n`. */
static reference_scene scene_from(size_t n, snow_type type, bool grey) {
    reference_scene scene = model_scene(
        dims, type, grey, (model_matrix)(n % MODEL_MATRICES), (uint64_t)n);
    scene.view.width = 24;
    scene.view.height = 18;
    model_stand_at(&scene, n, 1);
    return scene;
}

/* --- sweeps --------------------------------------------------------------- */

static reference_scene kernels_and_footprints(size_t n, uint64_t *random) {
    reference_scene scene = drawn_scene(random);
    scene.settings.kernel = model_kernel(n);
    scene.settings.footprint = 2 + (int)(n / 4 % 8);
    model_stand_at(&scene, n / 32, zooms[n / 32 / MODEL_STANDS]);
    return scene;
}

/* Not by the box, on whose edges rays fall by rounding. */
static reference_scene in_perspective(size_t n, uint64_t *random) {
    static const double fovs[] = {5, 30, 60, 100}, near[] = {0.3, 1, 2, 8};
    reference_scene scene = drawn_scene(random);
    scene.settings.kernel = model_kernel(n % 3);
    scene.settings.footprint = 2 + (int)model_draw(random, 6);
    scene.view.fov = fovs[n / 3 % 4];
    model_stand_at(&scene, n / 12, near[n / 12 / MODEL_STANDS]);
    return scene;
}

/* The zoom at which a pixel is as wide as `length` in the world. */
static double zoom_for(const reference_scene *scene, double length) {
    reference_camera camera;
    reference_scene plain = *scene;
    plain.view.zoom = 1;
    reference_camera_of(&plain, &camera);
    return camera.pitch / length;
}

/* Here every distance of a voxel and a pixel is a round number, and edges of
 * kernels fall on voxels. */
static reference_scene pixels_on_the_grid(size_t n, uint64_t *random) {
    static const double lengths[] = {1, 0.5, 2, 0.25, 4};
    reference_scene scene = drawn_scene(random);
    size_t rest = n / 9;
    /* Odd and even sizes move pixels by half a voxel. */
    scene.view.width = 21 + (int)model_draw(random, 2);
    scene.view.height = 18 + (int)model_draw(random, 2);
    scene.settings.kernel = model_kernel(rest);
    scene.settings.footprint = 2 + (int)(rest / 4 % 8);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++)
            scene.info.matrix[r][c] = r == c;
    scene.info.matrix[2][2] = n % 2 == 0 ? 1 : 2;
    model_stand_at(&scene, n % 9, zoom_for(&scene, lengths[rest / 32]));
    return scene;
}

static reference_scene types_and_thresholds(size_t n, uint64_t *random) {
    reference_scene drawn = drawn_scene(random);
    size_t rest = n / MODEL_TYPES / MODEL_MATRICES;
    reference_scene scene = model_scene(
        dims, model_type(n), rest % 2 == 0,
        (model_matrix)(n / MODEL_TYPES % MODEL_MATRICES), (uint64_t)n);
    scene.view = drawn.view;
    scene.settings.shade =
        rest / 2 % 2 == 0 ? SNOW_SHADE_NONE : SNOW_SHADE_PHONG;
    scene.settings.threshold = thresholds[rest / 4];
    model_free(&drawn);
    return scene;
}

static reference_scene sizes_of_pictures(size_t n, uint64_t *random) {
    static const int sizes[][2] = {{1, 1},  {7, 5}, {64, 48}, {48, 64}, {1, 30},
                                   {30, 1}, {2, 2}, {17, 33}, {100, 3}, {8, 8}};
    reference_scene scene = drawn_scene(random);
    model_stand_at(&scene, n / 10, zooms[model_draw(random, COUNT(zooms))]);
    scene.view.width = sizes[n % 10][0];
    scene.view.height = sizes[n % 10][1];
    scene.settings.kernel = model_kernel(model_draw(random, MODEL_KERNELS));
    return scene;
}

static reference_scene thin_volumes(size_t n, uint64_t *random) {
    static const int64_t thin[][3] = {
        {1, 1, 1}, {9, 1, 1}, {1, 9, 1},   {1, 1, 9},   {7, 5, 1},  {7, 1, 5},
        {1, 7, 5}, {2, 2, 2}, {300, 2, 3}, {3, 270, 2}, {2, 3, 260}};
    static const snow_opacity_point opacities[] = {{0, 0.01}, {100, 0.9}};
    reference_scene scene = model_scene(
        thin[n % 11], model_type(model_draw(random, MODEL_TYPES)),
        model_draw(random, 2) == 0,
        (model_matrix)model_draw(random, MODEL_MATRICES), (uint64_t)n);
    scene.opacities = opacities;
    scene.opacity_count = 2;
    scene.view.width = 24;
    scene.view.height = 18;
    model_stand_at(&scene, n / 11, zooms[model_draw(random, COUNT(zooms))]);
    scene.settings.kernel = model_kernel(model_draw(random, MODEL_KERNELS));
    return scene;
}

/* A pixel a little wider than a voxel widens a small kernel so that its weight
 * has kinks near its peak; single opaque voxels show the weights bare.  Tables
 * as fine as for wider kernels pass half the bound here, and the bound itself
 * now and then. */
static reference_scene kernels_widened_a_little(size_t n, uint64_t *random) {
    reference_scene scene = model_blank((int64_t[]){40, 40, 1}, 1);
    for (int at = 0; at < 40 * 40; at++)
        model_voxels(&scene)[at] = support_uniform(random) < 0.1;
    scene.view.width = scene.view.height = 40;
    scene.settings.kernel = model_kernel(n % 3); /* not the box, which jumps */
    scene.settings.footprint = n % 10 == 0 ? 3 : 2;
    double length = 1 + 0.03 * support_uniform(random);
    double roll = 45 * support_uniform(random);
    model_turn(&scene, 0, 0, roll, zoom_for(&scene, length));
    return scene;
}

/* Footprints from any direction, without the box's edges. */
static reference_scene voxels_here_and_there(size_t n, uint64_t *random) {
    reference_scene scene = model_blank((int64_t[]){11, 12, 9}, 1);
    for (int at = 0; at < 11 * 12 * 9; at++)
        model_voxels(&scene)[at] = support_uniform(random) < 0.1;
    scene.view.width = 30;
    scene.view.height = 33;
    scene.settings.kernel = model_kernel(n % 3);
    scene.settings.footprint = 2 + (int)(n / 3 % 8);
    model_stand_at(&scene, n / 24, 0.4 + 2 * support_uniform(random));
    scene.view.azimuth += 90 * support_uniform(random);
    return scene;
}

/* Slices of more than 16384 voxels are classified in parts, rows longer than
 * that one by one. */
static reference_scene large_slices_and_rows(size_t n, uint64_t *random) {
    static const int64_t large[][3] = {
        {210, 150, 3}, {4, 190, 170}, {200, 5, 160}, {17000, 3, 2}};
    static const double backs[][3] = {
        {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, -1, 0}};
    const double oblique = n % 2 ? 25 : 0;
    (void)random;
    reference_scene scene = model_scene(large[n / 2], SNOW_TYPE_UINT16, n == 3,
                                        MODEL_PLAIN, (uint64_t)n);
    scene.view.width = scene.view.height = 40;
    model_look(&scene, backs[n / 2], /* along the shortest side */
               n / 2 ? (double[]){0, 0, 1} : (double[]){0, 1, 0});
    model_turn(&scene, oblique, -oblique, 0, 1);
    if (n % 3 == 0)
        scene.settings.method = SNOW_METHOD_TESTED;
    return scene;
}

static reference_scene no_numbers_and_infinities(size_t n, uint64_t *random) {
    static const double odd[] = {(double)NAN, (double)INFINITY,
                                 -(double)INFINITY};
    bool wide = n % 2;
    reference_scene scene =
        scene_from(n, wide ? SNOW_TYPE_FLOAT64 : SNOW_TYPE_FLOAT32, n % 3 == 0);
    for (int i = 0; i < 13 * 10 * 15 / 6; i++) {
        size_t at = model_draw(random, 13 * 10 * 15);
        double value = odd[model_draw(random, 3)];
        if (wide)
            ((double *)(uintptr_t)scene.voxels)[at] = value;
        else
            model_voxels(&scene)[at] = (float)value;
    }
    scene.settings.method = (snow_method[]){
        SNOW_METHOD_ORIGINAL, SNOW_METHOD_TESTED, SNOW_METHOD_FOOTPRINT}[n % 3];
    return scene;
}

/* Real numbers with noise: no gradient is square to the line of sight, so that
 * rounding does not decide which way it is turned. */
static reference_scene lights(size_t n, uint64_t *random) {
    reference_scene scene = scene_from(n, SNOW_TYPE_FLOAT32, false);
    snow_settings *settings = &scene.settings;
    settings->light = (snow_light)(n % (SNOW_LIGHT_DIRECTION + 1));
    settings->light_azimuth = 360 * support_uniform(random) - 180;
    settings->light_elevation = 180 * support_uniform(random) - 90;
    settings->ambient = support_uniform(random);
    settings->diffuse = support_uniform(random);
    settings->specular = support_uniform(random);
    settings->shininess = n % 5 == 0 ? 0 : 100 * support_uniform(random);
    return scene;
}

static reference_scene lengths_of_opacities(size_t n, uint64_t *random) {
    static const double lengths[] = {0.1, 0.9, 3, 40};
    (void)random;
    reference_scene scene = scene_from(n, SNOW_TYPE_UINT8, true);
    scene.settings.opacity_length = lengths[n % COUNT(lengths)];
    scene.settings.threshold = thresholds[n % COUNT(thresholds)];
    return scene;
}

/* Less shear than a pixel over all slices, yet more than the footprint tables
 * may leave out of account from one slice to the next. */
static reference_scene slices_shifted_a_little(size_t n, uint64_t *random) {
    (void)random;
    reference_scene scene = model_scene((int64_t[]){9, 8, 64}, SNOW_TYPE_UINT8,
                                        true, MODEL_PLAIN, (uint64_t)n);
    scene.info.matrix[0][2] = 0.003;
    scene.settings.kernel = model_kernel(n);
    scene.settings.footprint = 3;
    scene.view.zoom = 3;
    return scene;
}

static reference_scene steps_and_single_points(size_t n, uint64_t *random) {
    static const snow_opacity_point one[] = {{50, 0.4}};
    static const snow_opacity_point teeth[] = {{10, 0}, {20, 1}, {20, 0},
                                               {50, 1}, {50, 0}, {50, 0.3},
                                               {90, 0}, {90, 1}};
    static const snow_color_point red[] = {{1e9, 1, 0, 0}};
    static const snow_color_point steps[] = {
        {30, 1, 0, 0}, {30, 0, 1, 0}, {60, 0, 0, 1}, {60, 1, 1, 1}};
    (void)random;
    reference_scene scene = scene_from(n, model_type(n / 4), false);
    scene.opacities = n % 2 == 0 ? one : teeth;
    scene.opacity_count = n % 2 == 0 ? COUNT(one) : COUNT(teeth);
    scene.colors = n / 2 % 2 == 0 ? red : steps;
    scene.color_count = n / 2 % 2 == 0 ? COUNT(red) : COUNT(steps);
    return scene;
}

/* Values of 0 and below among them; int8 has a negative intercept here. */
static reference_scene logarithms(size_t n, uint64_t *random) {
    static const snow_opacity_point points[] = {
        {0.5, 0.1}, {4, 0}, {40, 0.3}, {40, 0}, {95, 0.8}};
    static const snow_color_point colors[] = {
        {1, 1, 0, 0}, {10, 0, 1, 0.5}, {100, 0, 0.3, 1}};
    (void)random;
    reference_scene scene = scene_from(n, model_type(n / 3), false);
    scene.log = true;
    scene.opacities = points;
    scene.opacity_count = COUNT(points);
    scene.colors = colors;
    scene.color_count = COUNT(colors);
    scene.info.intercept -= n % 3 == 2 ? 30 : 0;
    return scene;
}

static void pictures_equal_the_references(void **state) {
    static const struct {
        const char *name;
        reference_scene (*make)(size_t n, uint64_t *random);
        size_t count, one_of; /* support_takes */
        double bound;
    } sweeps[] = {
        {"kernels", kernels_and_footprints, 96 * MODEL_STANDS, 19, BOUND},
        {"perspective", in_perspective, 48 * MODEL_STANDS, 17, BOUND},
        {"on the grid", pixels_on_the_grid, 9 * 32 * 5, 19, BOUND},
        {"types", types_and_thresholds, 600, 13, BOUND},
        {"sizes", sizes_of_pictures, 10 * MODEL_STANDS, 7, BOUND},
        {"thin", thin_volumes, 11 * MODEL_STANDS, 7, BOUND},
        {"widened", kernels_widened_a_little, 600, 13, BOUND / 2},
        {"sparse", voxels_here_and_there, 192, 13, BOUND / 2},
        {"large", large_slices_and_rows, 8, 3, BOUND},
        {"no numbers", no_numbers_and_infinities, 30, 7, BOUND},
        {"lights", lights, 60, 7, BOUND},
        {"lengths", lengths_of_opacities, 30, 7, BOUND},
        {"shifted", slices_shifted_a_little, 4, 1, 1e-5},
        {"points", steps_and_single_points, 40, 7, BOUND},
        {"logarithms", logarithms, 30, 7, BOUND},
    };
    (void)state;
    for (size_t s = 0; s < COUNT(sweeps); s++) {
        model_stage stage = model_open();
        for (size_t n = 0; n < sweeps[s].count; n++) {
            if (!support_takes(n, sweeps[s].one_of))
                continue;
            uint64_t random = support_scene_random(s, n);
            reference_scene scene = sweeps[s].make(n, &random);
            model_check(&stage, &scene, sweeps[s].bound);
            model_free(&scene);
        }
        print_message("             %s:\n", sweeps[s].name);
        model_close(&stage);
    }
}

/* --- single cases --------------------------------------------------------- */

/* Only the direction of a gradient counts, however small or large it is. */
static void values_of_any_magnitude_are_shaded_alike(void **state) {
    static const double scales[] = {1, 0x1p-560, 0x1p900};
    model_stage *stage = *state;
    float *first = NULL;
    for (size_t n = 0; n < COUNT(scales); n++) {
        reference_scene scene =
            model_scene(dims, SNOW_TYPE_FLOAT64, true, MODEL_OBLIQUE, 5);
        double *voxels = (double *)(uintptr_t)scene.voxels;
        for (int i = 0; i < 13 * 10 * 15; i++)
            voxels[i] *= scales[n];
        scene.info.slope /= scales[n];
        model_turn(&scene, 30, 20, 0, 1);
        float *picture = model_picture(stage, &scene);
        for (int i = 0; first && i < 64 * 48 * 4; i++)
            assert_near((double)picture[i], (double)first[i], 1e-6);
        if (first)
            free(picture);
        else
            first = picture;
        model_free(&scene);
    }
    free(first);
}

/* A long volume seen at 45 degrees with a wide field of view: slices lie before
 * and behind the plane through the eye. */
static void slices_on_both_sides_of_the_eye(void **state) {
    model_stage *stage = *state;
    for (int n = 0; n < 8; n++) {
        reference_scene scene =
            model_scene((int64_t[]){5, 6, 31}, SNOW_TYPE_UINT8, n % 2 == 0,
                        MODEL_PLAIN, (uint64_t)n);
        scene.view.width = 24;
        scene.view.height = 18;
        model_turn(&scene, n < 4 ? 44 : 136, 2 * n, 10 * n, 1);
        scene.view.fov = 110 + n;
        snow_placement p;
        assert_int_equal(
            snow_placement_make(stage->context, &scene.info, &scene.view, &p),
            SNOW_STATUS_OK);
        assert_true(p.eye.at[2] > 0 && p.eye.at[2] < 30);
        scene.settings.method =
            n % 2 ? SNOW_METHOD_FOOTPRINT : SNOW_METHOD_TESTED;
        model_check(stage, &scene, BOUND);
        model_free(&scene);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_equal_the_references),
        MODEL_TEST(values_of_any_magnitude_are_shaded_alike),
        MODEL_TEST(slices_on_both_sides_of_the_eye),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
