/* tests/render/test_model_rules.c - the rules that follow from the model, on
 * pictures of the library. */
#include "reference/model.h"

#include "composite/over.h"

#include <math.h>

static const snow_kernel kernels[] = {SNOW_KERNEL_BSPLINE, SNOW_KERNEL_TENT,
                                      SNOW_KERNEL_GAUSS, SNOW_KERNEL_BOX};

static const struct {
    double back[3], up[3];
    int axis;
} sides[] = {
    {{0, 0, 1}, {0, 1, 0}, 2}, {{0, 0, -1}, {0, 1, 0}, 2},
    {{0, 1, 0}, {0, 0, 1}, 1}, {{0, -1, 0}, {0, 0, 1}, 1},
    {{1, 0, 0}, {0, 0, 1}, 0}, {{-1, 0, 0}, {0, 0, 1}, 0},
};

static size_t voxel_count(const reference_scene *scene) {
    const int64_t *dims = scene->info.dims;
    return (size_t)(dims[0] * dims[1] * dims[2]);
}

/* --- a volume of one constant opacity a and n slices ---------------------- */

/* Checks the alpha of the middle pixels of a picture. */
static void check_middle(const model_stage *stage, const reference_scene *scene,
                         double alpha) {
    float *picture = model_picture(stage, scene);
    int width = scene->view.width;
    for (int y = scene->view.height / 2 - 2; y < scene->view.height / 2 + 2;
         y++)
        for (int x = width / 2 - 2; x < width / 2 + 2; x++)
            for (int c = 0; c < 4; c++) /* white: colours equal alpha */
                assert_near((double)picture[4 * (y * width + x) + c], alpha,
                            2e-5);
    free(picture);
}

static void a_constant_volume_has_the_opacity_of_its_slices(void **state) {
    (void)state;
    model_stage stage = model_open();
    reference_scene scene = model_blank((int64_t[]){15, 12, 18}, 0.07);
    for (size_t n = 0; n < voxel_count(&scene); n++)
        model_voxels(&scene)[n] = 1;
    scene.view.width = 34;
    scene.view.height = 31;
    for (size_t k = 0; k < 4; k++)
        for (int footprint = 2; footprint <= 9; footprint++)
            for (size_t s = 0; s < 6; s++) {
                scene.settings.kernel = kernels[k];
                scene.settings.footprint = footprint;
                model_look(&scene, sides[s].back, sides[s].up);
                int64_t slices = scene.info.dims[sides[s].axis];
                check_middle(&stage, &scene, 1 - pow(0.93, (double)slices));
            }
    model_free(&scene);
    model_close(&stage);
}

static void opacity_does_not_depend_on_how_finely_slices_lie(void **state) {
    (void)state;
    model_stage stage = model_open();
    reference_scene scene = model_blank((int64_t[]){15, 12, 18}, 0.07);
    for (size_t n = 0; n < voxel_count(&scene); n++)
        model_voxels(&scene)[n] = 1;
    double spacing[3] = {0.5, 0.8, 1.5};
    for (int c = 0; c < 3; c++)
        scene.info.matrix[c][c] = scene.info.spacing[c] = spacing[c];
    for (int own = 0; own < 2; own++)
        for (size_t s = 0; s < 6; s++) {
            int axis = sides[s].axis;
            double length = own ? 2.0 : 0.5; /* 0.5 is the smallest spacing */
            double depth = (double)scene.info.dims[axis] * spacing[axis];
            scene.settings.opacity_length = own ? length : 0;
            model_look(&scene, sides[s].back, sides[s].up);
            check_middle(&stage, &scene, 1 - pow(0.93, depth / length));
        }
    model_free(&scene);
    model_close(&stage);
}

static void opacity_does_not_depend_on_the_angle_of_view(void **state) {
    (void)state;
    model_stage stage = model_open();
    /* A slab so wide that an oblique ray through its middle leaves through its
     * large faces: it is longer by 1 / cosine. */
    reference_scene scene = model_blank((int64_t[]){40, 40, 6}, 0.07);
    for (size_t n = 0; n < voxel_count(&scene); n++)
        model_voxels(&scene)[n] = 1;
    for (double azimuth = 0; azimuth < 45; azimuth += 11) {
        model_turn(&scene, azimuth, azimuth / 2, 0, 1);
        double cosine =
            cos(azimuth * acos(-1.0) / 180) * cos(azimuth * acos(-1.0) / 360);
        check_middle(&stage, &scene, 1 - pow(0.93, 6 / cosine));
    }
    model_free(&scene);
    model_close(&stage);
}

/* --- what is near hides what is far --------------------------------------- */

static void the_nearest_slice_hides_those_behind(void **state) {
    (void)state;
    static const snow_color_point colors[] = {{1, 1, 0, 0}, {2, 0, 1, 0}};
    model_stage stage = model_open();
    reference_scene scene = model_blank((int64_t[]){9, 9, 9}, 1);
    scene.colors = colors;
    scene.color_count = 2;
    scene.view.width = scene.view.height = 20;
    for (size_t s = 0; s < 6; s++) {
        /* Green where the camera stands, red elsewhere. */
        double side = sides[s].back[0] + sides[s].back[1] + sides[s].back[2];
        for (int n = 0; n < 9 * 9 * 9; n++) {
            int at[3] = {n % 9, n / 9 % 9, n / 81};
            bool near = at[sides[s].axis] == (side > 0 ? 8 : 0);
            model_voxels(&scene)[n] = near ? 2 : 1;
        }
        model_look(&scene, sides[s].back, sides[s].up);
        float *middle = model_picture(&stage, &scene);
        assert_near((double)middle[4 * (20 * 10 + 10)], 0, 1e-6);
        assert_near((double)middle[4 * (20 * 10 + 10) + 1], 1, 1e-6);
        free(middle);
    }
    model_free(&scene);
    model_close(&stage);
}

/* --- one voxel leaves exactly its footprint ------------------------------- */

/* What a single voxel leaves in a pixel: its weights along both axes of the
 * slice where the ray meets it, or 0 when the slice is met out of reach. */
static double footprint_at(const reference_scene *scene,
                           const reference_camera *camera, const int64_t at[3],
                           double x, double y) {
    int axis = reference_slice_axis(scene, camera);
    reference_ray ray[3] = {reference_ray_at(scene, camera, x, y),
                            reference_ray_at(scene, camera, x + 1, y),
                            reference_ray_at(scene, camera, x, y + 1)};
    double product = 1;
    for (int grid = 0; grid < 3; grid++) {
        double place[3], weights[32] = {0};
        int64_t first, last;
        if (grid == axis)
            continue;
        for (int n = 0; n < 3; n++)
            place[n] =
                ray[n].start[grid] + ((double)at[axis] - ray[n].start[axis]) /
                                         ray[n].step[axis] * ray[n].step[grid];
        double rho = hypot(place[1] - place[0], place[2] - place[0]);
        int support = reference_support(&scene->settings);
        snow_kernel kernel = scene->settings.kernel;
        reference_weights(kernel, support,
                          reference_widening(kernel, support, rho), place[0],
                          scene->info.dims[grid], weights, &first, &last);
        product *= weights[at[grid]];
    }
    return product;
}

static void check_footprint(const model_stage *stage, reference_scene *scene,
                            const int64_t at[3]) {
    reference_camera camera;
    reference_camera_of(scene, &camera);
    const double index[3] = {(double)at[0], (double)at[1], (double)at[2]};
    double step = reference_slice_step(
        scene, &camera, reference_slice_axis(scene, &camera), index);
    double alpha = 1 - pow(1 - 0.6, step);
    const int64_t *dims = scene->info.dims;
    float *voxel =
        model_voxels(scene) + (at[2] * dims[1] + at[1]) * dims[0] + at[0];
    *voxel = 1;
    float *picture = model_picture(stage, scene);
    for (int y = 0; y < scene->view.height; y++)
        for (int x = 0; x < scene->view.width; x++)
            assert_near((double)picture[4 * (y * scene->view.width + x) + 3],
                        alpha *
                            footprint_at(scene, &camera, at, x + 0.5, y + 0.5),
                        2e-4);
    free(picture);
    *voxel = 0;
}

static void one_voxel_leaves_exactly_its_footprint(void **state) {
    (void)state;
    model_stage stage = model_open();
    uint64_t random = 3;
    reference_scene scene = model_blank((int64_t[]){11, 12, 9}, 0.6);
    scene.view.width = 30;
    scene.view.height = 33;
    for (size_t k = 0; k < 4; k++)
        for (int footprint = 2; footprint <= 9; footprint++)
            for (size_t s = 0; s < 6; s++) {
                int64_t at[3];
                for (int n = 0; n < 3; n++)
                    at[n] = (int64_t)(support_random(&random) >> 32) %
                            scene.info.dims[n];
                scene.settings.kernel = kernels[k];
                scene.settings.footprint = footprint;
                model_look(&scene, sides[s].back, sides[s].up);
                model_turn(&scene, 0, 0, 0, 1);
                check_footprint(&stage, &scene, at);
                model_turn(&scene, 90 * support_uniform(&random),
                           90 * support_uniform(&random) - 45,
                           360 * support_uniform(&random),
                           0.4 + 2 * support_uniform(&random));
                check_footprint(&stage, &scene, at);
            }
    model_free(&scene);
    model_close(&stage);
}

/* The sum of alpha over a picture of one opaque voxel of a single slice. */
static double weight_of_voxel(const model_stage *stage, reference_scene *scene,
                              int64_t i, int64_t j) {
    float *voxel = model_voxels(scene) + j * scene->info.dims[0] + i;
    *voxel = 1;
    float *picture = model_picture(stage, scene);
    double sum = 0;
    for (int n = 0; n < scene->view.width * scene->view.height; n++)
        sum += (double)picture[4 * n + 3];
    free(picture);
    *voxel = 0;
    return sum;
}

/* The mean over 8 x 8 voxels, which lie at as many sub-pixel positions, over
 * the projected area of a voxel in pixels. */
static double mean_weight(const model_stage *stage, reference_scene *scene) {
    reference_camera camera;
    reference_camera_of(scene, &camera);
    double area = fabs(camera.back[2]) / (camera.pitch * camera.pitch), sum = 0;
    for (int64_t j = 6; j < 14; j++)
        for (int64_t i = 6; i < 14; i++)
            sum += weight_of_voxel(stage, scene, i, j) / 64;
    return sum / area;
}

/* At 9/8 pixels a voxel eight neighbours take all eighths of a pixel. */
static void weights_add_up_to_the_projected_area_of_a_voxel(void **state) {
    (void)state;
    model_stage stage = model_open();
    reference_scene scene = model_blank((int64_t[]){20, 20, 1}, 1);
    scene.view.width = scene.view.height = 32;
    reference_camera camera;
    reference_camera_of(&scene, &camera);
    scene.view.zoom = camera.pitch * 9 / 8;
    for (size_t k = 0; k < 4; k++)
        for (int footprint = 2; footprint <= 9; footprint++) {
            scene.settings.kernel = kernels[k];
            scene.settings.footprint = footprint;
            assert_near(mean_weight(&stage, &scene), 1, 1e-4);
        }
    model_free(&scene);
    model_close(&stage);
}

/* Oblique positions are a sample of all, so the mean is not exact. */
static void oblique_footprints_keep_their_area(void **state) {
    (void)state;
    model_stage stage = model_open();
    reference_scene scene = model_blank((int64_t[]){20, 20, 1}, 1);
    scene.view.width = scene.view.height = 80;
    model_turn(&scene, 30, 20, 10, 1.3);
    for (size_t k = 0; k < 4; k++)
        for (int footprint = 2; footprint <= 9; footprint++) {
            scene.settings.kernel = kernels[k];
            scene.settings.footprint = footprint;
            double bound = kernels[k] == SNOW_KERNEL_BOX ? 0.01 : 0.003;
            assert_near(mean_weight(&stage, &scene), 1, bound);
        }
    model_free(&scene);
    model_close(&stage);
}

/* --- turning the camera equals turning the data --------------------------- */

/* Cosine and sine of `quarters` right angles. */
static int cosine_of(int quarters) {
    static const int cosine[] = {1, 0, -1, 0};
    return cosine[quarters & 3];
}

static void turn_by_quarters(int a[3], int b[3], int quarters) {
    for (int n = 0; n < 3; n++) {
        int from = a[n], to = b[n];
        a[n] = cosine_of(quarters) * from + cosine_of(quarters + 3) * to;
        b[n] = cosine_of(quarters) * to - cosine_of(quarters + 3) * from;
    }
}

/* The camera's axes (right, up, back) after turns from +z by right angles:
 * rows of the rotation that the data are turned by. */
static void axes_after(const int quarters[3], int axes[3][3]) {
    static const int start[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    memcpy(axes, start, sizeof start);
    turn_by_quarters(axes[2], axes[0], quarters[0]);
    turn_by_quarters(axes[2], axes[1], quarters[1]);
    turn_by_quarters(axes[1], axes[0], quarters[2]);
}

/* The scene with its data turned: what lay along row n of `axes` lies along
 * index axis n. */
static reference_scene turn_data(const reference_scene *from, int axes[3][3]) {
    const int64_t *dims = from->info.dims;
    reference_scene to = *from;
    int source[3];
    for (int n = 0; n < 3; n++) {
        source[n] = axes[n][0] != 0 ? 0 : axes[n][1] != 0 ? 1 : 2;
        to.info.dims[n] = dims[source[n]];
    }
    float *voxels = calloc(voxel_count(from), sizeof *voxels), *out = voxels;
    assert_non_null(voxels);
    for (int64_t k = 0; k < to.info.dims[2]; k++)
        for (int64_t j = 0; j < to.info.dims[1]; j++)
            for (int64_t i = 0; i < to.info.dims[0]; i++) {
                int64_t here[3] = {i, j, k}, at[3];
                for (int n = 0; n < 3; n++)
                    at[source[n]] = axes[n][source[n]] > 0
                                        ? here[n]
                                        : to.info.dims[n] - 1 - here[n];
                *out++ = model_voxels(
                    from)[(at[2] * dims[1] + at[1]) * dims[0] + at[0]];
            }
    to.voxels = voxels;
    return to;
}

static void check_turn(const model_stage *stage, const reference_scene *scene,
                       const int quarters[3]) {
    int axes[3][3];
    axes_after(quarters, axes);
    reference_scene camera = *scene, data = turn_data(scene, axes);
    model_turn(&camera, 90 * quarters[0], 90 * quarters[1], 90 * quarters[2],
               1);
    float *a = model_picture(stage, &camera);
    float *b = model_picture(stage, &data);
    double seen = 0;
    for (int n = 0; n < scene->view.width * scene->view.height * 4; n++) {
        assert_near((double)a[n], (double)b[n], 1e-5);
        seen = fmax(seen, (double)a[n]);
    }
    assert_true(seen > 0.5);
    free(a);
    free(b);
    free((void *)(uintptr_t)data.voxels);
}

static void turning_the_camera_equals_turning_the_data(void **state) {
    (void)state;
    model_stage stage = model_open();
    reference_scene scene = model_scene(
        (int64_t[]){13, 10, 16}, SNOW_TYPE_FLOAT32, false, MODEL_PLAIN, 8);
    for (int quarters = 0; quarters < 64; quarters++) {
        /* 24 different turns, most of them reached in more than one way. */
        int turns[3] = {quarters & 3, quarters >> 2 & 3, quarters >> 4};
        scene.settings.kernel = kernels[quarters % 4];
        check_turn(&stage, &scene, turns);
    }
    model_free(&scene);
    model_close(&stage);
}

static void turning_the_matrix_equals_turning_the_camera(void **state) {
    (void)state;
    model_stage stage = model_open();
    reference_scene scene = model_scene(
        (int64_t[]){13, 10, 16}, SNOW_TYPE_FLOAT32, false, MODEL_PLAIN, 8);
    for (int quarters = 0; quarters < 64; quarters++) {
        int turns[3] = {quarters & 3, quarters >> 2 & 3, quarters >> 4};
        int axes[3][3];
        axes_after(turns, axes);
        reference_scene camera = scene, world = scene;
        model_turn(&camera, 90 * turns[0], 90 * turns[1], 90 * turns[2], 1);
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 3; c++)
                world.info.matrix[r][c] = axes[r][c];
        float *a = model_picture(&stage, &camera);
        float *b = model_picture(&stage, &world);
        for (int n = 0; n < 64 * 48 * 4; n++)
            assert_near((double)a[n], (double)b[n], 1e-5);
        free(a);
        free(b);
    }
    model_free(&scene);
    model_close(&stage);
}

/* --- over ----------------------------------------------------------------- */

static void front_to_back_equals_back_to_front(void **state) {
    (void)state;
    enum { ROWS = 300, COUNT = 37 };
    static float sheets[ROWS][COUNT * 4];
    uint64_t random = 4;
    for (int channels = 2; channels <= 4; channels += 2) {
        float front[COUNT * 4] = {0}, back[COUNT * 4] = {0};
        int floats = COUNT * channels;
        for (int r = 0; r < ROWS; r++)
            for (int n = 0; n < floats; n++) {
                int alpha = n / channels * channels + channels - 1;
                double a = 0.02 * support_uniform(&random);
                sheets[r][n] = (float)(n == alpha ? 0.02 : a);
            }
        for (int r = 0; r < ROWS; r++) {
            float copy[COUNT * 4];
            snow_over_of(channels)(front, sheets[r], COUNT);
            memcpy(copy, sheets[ROWS - 1 - r], sizeof copy);
            snow_over_of(channels)(copy, back, COUNT);
            memcpy(back, copy, sizeof back);
        }
        for (int n = 0; n < floats; n++)
            assert_near((double)front[n], (double)back[n], 1e-6);
        assert_near((double)front[channels - 1], 1 - pow(0.98, ROWS), 1e-6);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_constant_volume_has_the_opacity_of_its_slices),
        cmocka_unit_test(opacity_does_not_depend_on_how_finely_slices_lie),
        cmocka_unit_test(opacity_does_not_depend_on_the_angle_of_view),
        cmocka_unit_test(the_nearest_slice_hides_those_behind),
        cmocka_unit_test(one_voxel_leaves_exactly_its_footprint),
        cmocka_unit_test(weights_add_up_to_the_projected_area_of_a_voxel),
        cmocka_unit_test(oblique_footprints_keep_their_area),
        cmocka_unit_test(turning_the_camera_equals_turning_the_data),
        cmocka_unit_test(turning_the_matrix_equals_turning_the_camera),
        cmocka_unit_test(front_to_back_equals_back_to_front),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
