/* tests/render/test_model_camera.c - where the camera stands, by pictures of
 * single voxels whose place is known without any renderer. */
#include "reference/model.h"

#include <math.h>
#include <string.h>

/* Where each view stands in the RAS world: right is +x, anterior +y, superior
 * +z.  An axis is its own name. */
static const struct {
    const char *name, *side;
} names[] = {
    {"anterior", "+y"}, {"posterior", "-y"}, {"left", "-x"},  {"right", "+x"},
    {"superior", "+z"}, {"inferior", "-z"},  {"axial", "+z"}, {"coronal", "-y"},
    {"sagittal", "+x"}, {"front", "-y"},     {"back", "+y"},  {"top", "+z"},
    {"bottom", "-z"},   {"iso", "+x+y+z"},   {"+x", "+x"},    {"-x", "-x"},
    {"+y", "+y"},       {"-y", "-y"},        {"+z", "+z"},    {"-z", "-z"},
};

#define NAMES (sizeof names / sizeof *names)

/* A side's direction, from the axes in its name; and the camera's up, which is
 * what of the world's +z is at right angles to it, or of +y where nothing is.
 */
static void frame_of(const char *side, double back[3], double up[3]) {
    double length = 0, along;
    for (int c = 0; c < 3; c++)
        back[c] = up[c] = 0;
    for (size_t n = 0; side[n]; n += 2)
        back[side[n + 1] - 'x'] = side[n] == '+' ? 1 : -1;
    for (int c = 0; c < 3; c++)
        length += back[c] * back[c];
    for (int c = 0; c < 3; c++)
        back[c] /= sqrt(length);
    int up_axis = fabs(back[2]) == 1 ? 1 : 2;
    along = back[up_axis];
    for (int c = 0; c < 3; c++)
        up[c] = ((c == up_axis) - along * back[c]) / sqrt(1 - along * along);
}

static void each_view_stands_where_its_name_says(void **state) {
    const model_stage *stage = *state;
    size_t count = 0, known = 0;
    for (size_t n = 0; n < NAMES; n++) {
        snow_view view = {.size = sizeof view};
        double back[3], up[3];
        frame_of(names[n].side, back, up);
        assert_int_equal(
            snow_view_from_name(stage->context, names[n].name, &view),
            SNOW_STATUS_OK);
        for (int c = 0; c < 3; c++) {
            assert_near(view.back[c], back[c], 1e-15);
            assert_near(view.up[c], up[c], 1e-15);
        }
        assert_true(view.width == 512 && view.height == 512);
        assert_true(view.azimuth == 0 && view.elevation == 0 &&
                    view.roll == 0 && view.zoom == 1 && view.fov == 0);
    }
    for (; snow_view_name(count); count++)
        for (size_t n = 0; n < NAMES; n++)
            known += strcmp(snow_view_name(count), names[n].name) == 0;
    assert_true(count == NAMES + 1 && known == NAMES);
    /* From the front, 30 degrees to the right and 25 up. */
    const double turn = acos(-1) / 6, rise = acos(-1) * 25 / 180;
    const double back[3] = {sin(turn) * cos(rise), -cos(turn) * cos(rise),
                            sin(rise)};
    const double up[3] = {-sin(turn) * sin(rise), cos(turn) * sin(rise),
                          cos(rise)};
    snow_view oblique = {.size = sizeof oblique};
    assert_int_equal(snow_view_from_name(stage->context, "oblique", &oblique),
                     SNOW_STATUS_OK);
    for (int c = 0; c < 3; c++) {
        assert_near(oblique.back[c], back[c], 1e-15);
        assert_near(oblique.up[c], up[c], 1e-15);
    }
}

static void an_unknown_view_is_refused(void **state) {
    const model_stage *stage = *state;
    snow_view view = {.size = sizeof view, .width = 7};
    assert_int_equal(snow_view_from_name(stage->context, "above", &view),
                     SNOW_STATUS_BAD_USAGE);
    assert_int_equal(view.width, 7);
    assert_non_null(strstr(snow_context_message(stage->context), "above"));
}

static void medical_volumes_are_seen_from_the_front(void **state) {
    const model_stage *stage = *state;
    reference_scene scene = model_blank((int64_t[]){1, 1, 1}, 1);
    for (int medical = 0; medical < 2; medical++) {
        snow_view view = {.size = sizeof view};
        scene.info.medical = medical;
        snow_volume *volume = model_volume(stage->context, &scene);
        snow_view_default(volume, &view);
        assert_true(view.back[1] == medical && view.back[2] == 1 - medical);
        assert_true(view.up[2] == medical && view.up[1] == 1 - medical);
        snow_volume_close(volume);
    }
    model_free(&scene);
}

/* Sides and directions of a volume, and its default view. */
static const struct {
    int64_t dims[3];
    double spacing[3];
    int shift; /* index axis i runs along the world's axis (i + shift) % 3 */
    bool medical;
    const char *view;
} faces[] = {
    {{40, 40, 10}, {1, 1, 1}, 0, true, "anterior"}, /* a quarter is not thin */
    {{40, 40, 9}, {1, 1, 1}, 0, true, "inferior"},
    {{40, 40, 9}, {1, 1, 2}, 0, true, "anterior"},
    {{40, 9, 90}, {1, 1, 1}, 0, true, "anterior"},
    {{9, 40, 40}, {1, 1, 1}, 0, true, "left"},
    {{9, 40, 40}, {1, 1, 1}, 2, true, "inferior"},
    {{40, 40, 9}, {1, 1, 1}, 0, false, "+z"},
    {{40, 9, 40}, {1, 1, 1}, 0, false, "-y"},
    {{9, 40, 40}, {1, 1, 1}, 0, false, "+x"},
    {{40, 40, 9}, {1, 1, 1}, 1, false, "+x"},
    {{40, 9, 9}, {1, 1, 1}, 0, false, "+z"},   /* a rod has no face */
    {{1, 40, 40}, {90, 1, 1}, 0, false, "+x"}, /* a slice, however thick */
    {{1, 1, 40}, {1, 1, 1}, 0, false, "+z"},
};

static void a_thin_volume_is_shown_from_its_face(void **state) {
    (void)state;
    for (size_t n = 0; n < sizeof faces / sizeof *faces; n++) {
        snow_volume_info info = {.size = sizeof info,
                                 .medical = faces[n].medical};
        for (int i = 0; i < 3; i++) {
            info.dims[i] = faces[n].dims[i];
            info.spacing[i] = faces[n].spacing[i];
            info.matrix[(i + faces[n].shift) % 3][i] = -info.spacing[i];
        }
        assert_string_equal(snow_view_name_for(&info, NULL), faces[n].view);
    }
}

static void names_of_planes_are_sides_of_the_volumes_world(void **state) {
    (void)state;
    static const char *const patient[][2] = {
        {"axial", "inferior"},  {"CORONAL", "anterior"}, {"sagittal", "left"},
        {"front", "anterior"},  {"Back", "posterior"},   {"top", "top"},
        {"bottom", "bottom"},   {"left", "left"},        {"+z", "+z"},
        {"nothing", "nothing"}, {NULL, "anterior"}};
    snow_volume_info info = {.size = sizeof info, .dims = {4, 4, 4}};
    for (size_t n = 0; n < sizeof patient / sizeof *patient; n++) {
        const char *name = patient[n][0];
        info.medical = true;
        assert_string_equal(snow_view_name_for(&info, name), patient[n][1]);
        info.medical = false;
        assert_string_equal(snow_view_name_for(&info, name),
                            name ? name : "+z");
    }
}

/* The middle of what a picture shows, in pixels; false when it is empty. */
static bool middle_of(const reference_scene *scene, const float *picture,
                      double middle[2]) {
    double sum = 0;
    middle[0] = middle[1] = 0;
    for (int y = 0; y < scene->view.height; y++)
        for (int x = 0; x < scene->view.width; x++) {
            double alpha = (double)picture[4 * (y * scene->view.width + x) + 3];
            sum += alpha;
            middle[0] += alpha * (x + 0.5);
            middle[1] += alpha * (y + 0.5);
        }
    middle[0] /= sum;
    middle[1] /= sum;
    return sum > 0;
}

/* Where one voxel of an otherwise empty volume is seen. */
static void place_of_voxel(const model_stage *stage, reference_scene *scene,
                           const int64_t at[3], double place[2]) {
    const int64_t *dims = scene->info.dims;
    size_t offset = (size_t)((at[2] * dims[1] + at[1]) * dims[0] + at[0]);
    model_voxels(scene)[offset] = 1;
    float *picture = model_picture(stage, scene);
    assert_true(middle_of(scene, picture, place));
    free(picture);
    model_voxels(scene)[offset] = 0;
}

static reference_scene cube_scene(const double back[3], const double up[3]) {
    reference_scene scene = model_blank((int64_t[]){9, 9, 9}, 1);
    model_look(&scene, back, up);
    scene.view.width = scene.view.height = 90;
    return scene;
}

static void what_is_up_is_at_the_top_and_nothing_is_mirrored(void **state) {
    model_stage *stage = *state;
    /* Neighbours of the middle towards +x, +y and +z, and the steps in the
     * picture (right, down) that they must be seen at. */
    static const struct {
        const char *name;
        int right[3], down[3];
    } seen[] = {
        {"anterior", {-1, 0, 0}, {0, 0, -1}},
        {"posterior", {1, 0, 0}, {0, 0, -1}},
        {"left", {0, -1, 0}, {0, 0, -1}},
        {"right", {0, 1, 0}, {0, 0, -1}},
        {"superior", {1, 0, 0}, {0, -1, 0}},
        {"inferior", {-1, 0, 0}, {0, -1, 0}},
    };
    for (size_t n = 0; n < sizeof seen / sizeof *seen; n++)
        for (int axis = 0; axis < 3; axis++) {
            snow_view view = {.size = sizeof view};
            assert_int_equal(
                snow_view_from_name(stage->context, seen[n].name, &view),
                SNOW_STATUS_OK);
            reference_scene scene = cube_scene(view.back, view.up);
            double place[2], pitch = 9 * sqrt(3) / 90;
            int64_t at[3] = {4, 4, 4};
            at[axis] = 6;
            place_of_voxel(stage, &scene, at, place);
            assert_near(place[0], 45 + 2 * seen[n].right[axis] / pitch, 0.01);
            assert_near(place[1], 45 + 2 * seen[n].down[axis] / pitch, 0.01);
            model_free(&scene);
        }
}

/* Where the voxel that is 4 to the right of the middle and 2 before it is seen
 * from +z after turns, in voxels to the right and up.  After an azimuth of 90
 * the camera is at +x, where right is -z; after an elevation of 90 at +y, where
 * up is -z; what was at the right is at the top after a roll of 90; and turns
 * follow each other: at +x, then up to +y, where the camera's up is -x. */
static void turns_are_azimuth_then_elevation_then_roll(void **state) {
    static const double half = 0.5, side = 0.86602540378443865;
    const struct {
        double azimuth, elevation, roll, right, up;
    } turns[] = {
        {90, 0, 0, -2, 0},   {30, 0, 0, 4 * side - 2 * half, 0},
        {0, 90, 0, 4, -2},   {0, 30, 0, 4, -2 * half},
        {0, 0, 90, 0, 4},    {0, 0, 30, 4 * side, 4 * half},
        {90, 90, 0, -2, -4}, {90, 90, 90, 4, -2},
    };
    model_stage *stage = *state;
    reference_scene scene =
        cube_scene((double[]){0, 0, 1}, (double[]){0, 1, 0});
    const double pitch = 9 * sqrt(3) / 90;
    for (size_t n = 0; n < sizeof turns / sizeof *turns; n++) {
        double place[2];
        model_turn(&scene, turns[n].azimuth, turns[n].elevation, turns[n].roll,
                   1);
        place_of_voxel(stage, &scene, (int64_t[]){8, 4, 6}, place);
        assert_near((place[0] - 45) * pitch, turns[n].right, 1e-2);
        assert_near((45 - place[1]) * pitch, turns[n].up, 1e-2);
    }
    model_free(&scene);
}

static void corners_stay_in_the_picture_whatever_the_turn(void **state) {
    model_stage *stage = *state;
    uint64_t random = 11;
    reference_scene scene =
        cube_scene((double[]){0, 0, 1}, (double[]){0, 1, 0});
    double radius = 4 / 4.5 * 45; /* of the corner voxel's middle */
    double farthest = 0;
    for (int n = 0; n < 40; n++) {
        double place[2];
        model_turn(&scene, 360 * support_uniform(&random),
                   180 * support_uniform(&random) - 90,
                   360 * support_uniform(&random), 1);
        place_of_voxel(stage, &scene, (int64_t[]){8, 8, 8}, place);
        double distance = hypot(place[0] - 45, place[1] - 45);
        assert_true(distance < radius + 0.05);
        farthest = fmax(farthest, distance);
    }
    assert_true(farthest > 0.95 * radius);
    model_free(&scene);
}

static void the_matrix_carries_voxels_to_the_world(void **state) {
    model_stage *stage = *state;
    /* i runs along world z, j along -x, k along y, with spacings 1, 2, 3. */
    static const double matrix[4][4] = {
        {0, -2, 0, 10}, {0, 0, 3, 20}, {1, 0, 0, 30}, {0, 0, 0, 1}};
    reference_scene scene =
        cube_scene((double[]){0, 1, 0}, (double[]){0, 0, 1});
    memcpy(scene.info.matrix, matrix, sizeof matrix);
    double place[2], pitch = 9 * sqrt(1 + 4 + 9) / 90;
    /* Seen from +y, where -x is right and +z up. */
    place_of_voxel(stage, &scene, (int64_t[]){4, 6, 4}, place);
    assert_near(place[0], 45 + 2 * 2 / pitch, 0.05);
    assert_near(place[1], 45, 0.05);
    place_of_voxel(stage, &scene, (int64_t[]){7, 4, 8}, place);
    assert_near(place[0], 45, 0.05);
    assert_near(place[1], 45 - 3 / pitch, 0.05);
    model_free(&scene);
}

/* The smallest spacing is not the first one. */
static void one_voxel_per_pixel_is_the_zoom_for_voxels(void **state) {
    const model_stage *stage = *state;
    reference_scene scene = model_scene((int64_t[]){13, 7, 10}, SNOW_TYPE_UINT8,
                                        true, MODEL_ANISOTROPIC, 1);
    scene.info.matrix[0][0] = 1.1;
    scene.info.matrix[1][1] = 0.7;
    snow_volume *volume = model_volume(stage->context, &scene);
    scene.view.zoom =
        snow_view_zoom_for_voxels(volume, scene.view.width, scene.view.height);
    reference_camera camera;
    reference_camera_of(&scene, &camera);
    assert_near(camera.pitch, 0.7, 1e-12);
    snow_volume_close(volume);
    model_free(&scene);
}

/* Checks the slice axis that a picture was made with. */
static void check_axis(const model_stage *stage, reference_scene *scene,
                       int axis) {
    free(model_picture(stage, scene));
    assert_int_equal(snow_frame_stats(stage->frame)->slice_axis, axis);
}

static void slices_are_taken_along_the_most_parallel_normal(void **state) {
    model_stage *stage = *state;
    uint64_t random = 9;
    for (int n = 0; n < 200; n++) {
        reference_scene scene =
            model_scene((int64_t[]){5, 4, 3}, SNOW_TYPE_UINT8, true,
                        (model_matrix)(n % MODEL_MATRICES), 1);
        reference_camera camera;
        scene.view.width = scene.view.height = 4;
        model_turn(&scene, 360 * support_uniform(&random),
                   180 * support_uniform(&random) - 90, 0, 1);
        reference_camera_of(&scene, &camera);
        check_axis(stage, &scene, reference_slice_axis(&scene, &camera));
        model_free(&scene);
    }
}

/* A storm on a grid of 12 km, with levels 0.4 km apart, seen from above its
 * side: along y a slice would shift by 14 voxels, along z it does by a quarter.
 */
static void flat_voxels_are_crossed_from_their_face(void **state) {
    model_stage *stage = *state;
    static const struct {
        double height, elevation;
        int axis;
    } rows[] = {{12, 25, 1},  {1.2, 25, 1}, {0.4, 25, 2},
                {0.4, 10, 1}, {0.4, 80, 2}, {30, 60, 2}};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        reference_scene scene = model_blank((int64_t[]){5, 4, 3}, 0.5);
        scene.info.matrix[0][0] = scene.info.matrix[1][1] = 12;
        scene.info.matrix[2][2] = rows[n].height;
        scene.view.elevation = rows[n].elevation - 90;
        check_axis(stage, &scene, rows[n].axis);
        model_free(&scene);
    }
}

static void of_equally_parallel_axes_the_last_is_taken(void **state) {
    model_stage *stage = *state;
    reference_scene scene = model_blank((int64_t[]){5, 4, 3}, 0.5);
    for (int quarter = 0; quarter < 4; quarter++) {
        model_turn(&scene, 45 + 90 * quarter, 0, 0, 1); /* x and z */
        check_axis(stage, &scene, 2);
        model_turn(&scene, 0, 45 + 90 * quarter, 0, 1); /* y and z */
        check_axis(stage, &scene, 2);
        model_turn(&scene, 90, 45 + 90 * quarter, 0, 1); /* x and y */
        check_axis(stage, &scene, 1);
    }
    double back[3], up[3];
    frame_of("+x+y+z", back, up);
    model_look(&scene, back, up);
    model_turn(&scene, 0, 0, 0, 1);
    check_axis(stage, &scene, 2);
    model_free(&scene);
}

static void settings_and_views_out_of_range_are_refused(void **state) {
    static const double nan = (double)NAN, infinity = (double)INFINITY;
    model_stage *stage = *state;
    reference_scene scene = model_blank((int64_t[]){2, 2, 2}, 0.5);
    const snow_settings fine = scene.settings;
    const snow_view view = scene.view;
#define REFUSED(field, value, words)     \
    scene.field = value;                 \
    model_refused(stage, &scene, words); \
    scene.settings = fine, scene.view = view
    REFUSED(settings.threshold, 255.5, "threshold");
    REFUSED(settings.threshold, -1, "threshold");
    REFUSED(settings.threshold, nan, "threshold");
    REFUSED(settings.footprint, 1, "");
    REFUSED(settings.footprint, 10, "");
    REFUSED(settings.ambient, 1.5, "");
    REFUSED(settings.diffuse, -0.1, "");
    REFUSED(settings.specular, infinity, "");
    REFUSED(settings.shininess, -1, "");
    REFUSED(settings.opacity_length, -1, "");
    REFUSED(settings.light_azimuth, nan, "");
    REFUSED(settings.depth_darkening, -0.1, "depth darkening");
    REFUSED(settings.depth_darkening, 1.1, "depth darkening");
    REFUSED(settings.depth_darkening, nan, "depth darkening");
    REFUSED(settings.occlusion, 1.1, "occlusion");
    REFUSED(settings.method, (snow_method)9, "");
    REFUSED(settings.kernel, (snow_kernel)5, "");
    REFUSED(settings.encoding, (snow_encoding)4, "");
    REFUSED(settings.light, (snow_light)4, "");
    REFUSED(view.width, 0, "");
    REFUSED(view.height, 32769, "");
    REFUSED(view.zoom, 0, "zoom");
    REFUSED(view.zoom, nan, "zoom");
    REFUSED(view.roll, infinity, "");
    REFUSED(view.back[0], nan, "");
    REFUSED(view.up[1], 2, "");
    REFUSED(view.up[1], 0, ""); /* no up at all */
    REFUSED(view.fov, -1, "field of view");
    REFUSED(view.fov, 1e-9, "field of view");
    REFUSED(view.fov, 121, "field of view");
    REFUSED(view.fov, nan, "field of view");
    REFUSED(view.fov, infinity, "field of view");
#undef REFUSED
    memcpy(scene.view.up, scene.view.back, sizeof scene.view.up);
    model_refused(stage, &scene, "");
    model_free(&scene);
}

/* A record of an older header ends before the light (newer ones: test_api.c).
 */
static void
settings_of_an_older_version_are_read_as_far_as_they_reach(void **state) {
    snow_settings older;
    memset(&older, 7, sizeof older);
    size_t known = offsetof(snow_settings, light_azimuth);
    snow_settings_init_sized(&older, known);
    const unsigned char *bytes = (const unsigned char *)&older;
    for (size_t i = known; i < sizeof older; i++)
        assert_int_equal(bytes[i], 7);
    model_stage *stage = *state;
    reference_scene scene = model_scene((int64_t[]){9, 8, 7}, SNOW_TYPE_UINT8,
                                        true, MODEL_PLAIN, 1);
    scene.settings.light = SNOW_LIGHT_AUTO; /* the initialiser's */
    float *plain = model_picture(stage, &scene);
    older.method = SNOW_METHOD_FOOTPRINT;
    memcpy(&scene.settings, &older, sizeof scene.settings);
    float *picture = model_picture(stage, &scene);
    assert_memory_equal(picture, plain, 64 * 48 * 4 * sizeof *plain);
    free(picture);
    free(plain);
    model_free(&scene);
}

/* Magnified without end the picture is its middle; diminished without end it
 * has next to nothing, at no cost.  Tables are not read past their ends: the
 * sanitizers see that. */
static void any_zoom_is_safe_and_quick(void **state) {
    model_stage *stage = *state;
    reference_scene scene = model_blank((int64_t[]){16, 16, 16}, 0.5);
    float *voxels = model_voxels(&scene);
    for (int i = 0; i < 16 * 16 * 16; i++)
        voxels[i] = 1;
    scene.view.width = scene.view.height = 16;
    for (int kernel = 0; kernel <= SNOW_KERNEL_BOX; kernel++)
        for (int exponent = -8; exponent <= 150; exponent += 1 + exponent / 9) {
            scene.settings.kernel = (snow_kernel)kernel;
            scene.settings.shade = SNOW_SHADE_NONE;
            model_turn(&scene, 30, 20, 10, pow(10, exponent));
            snow_image *image = model_image(stage, &scene);
            int channels = snow_image_channels(image);
            const float *pixels = snow_image_pixels(image);
            for (int i = 0; i < 16 * 16; i++) {
                double alpha = (double)pixels[(i + 1) * channels - 1];
                if (exponent >= 2)
                    assert_true(alpha > 0.9999 && alpha < 1.0001);
                if (exponent <= -3)
                    assert_true(alpha >= 0 && alpha < 1e-3);
            }
            snow_image_free(image);
        }
    model_free(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        MODEL_TEST(each_view_stands_where_its_name_says),
        MODEL_TEST(an_unknown_view_is_refused),
        MODEL_TEST(medical_volumes_are_seen_from_the_front),
        cmocka_unit_test(a_thin_volume_is_shown_from_its_face),
        cmocka_unit_test(names_of_planes_are_sides_of_the_volumes_world),
        MODEL_TEST(what_is_up_is_at_the_top_and_nothing_is_mirrored),
        MODEL_TEST(turns_are_azimuth_then_elevation_then_roll),
        MODEL_TEST(corners_stay_in_the_picture_whatever_the_turn),
        MODEL_TEST(the_matrix_carries_voxels_to_the_world),
        MODEL_TEST(one_voxel_per_pixel_is_the_zoom_for_voxels),
        MODEL_TEST(slices_are_taken_along_the_most_parallel_normal),
        MODEL_TEST(flat_voxels_are_crossed_from_their_face),
        MODEL_TEST(of_equally_parallel_axes_the_last_is_taken),
        MODEL_TEST(any_zoom_is_safe_and_quick),
        MODEL_TEST(settings_of_an_older_version_are_read_as_far_as_they_reach),
        MODEL_TEST(settings_and_views_out_of_range_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
