/* tests/render/test_model_rules.c - the rules that follow from the model, on
 * pictures of the library. */
#include "reference/model.h"

#include <math.h>

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

/* --- a volume of one constant opacity ------------------------------------- */

#define OPACITY 0.07

static reference_scene constant(const int64_t dims[3]) {
    reference_scene scene = model_blank(dims, OPACITY);
    for (size_t n = 0; n < voxel_count(&scene); n++)
        model_voxels(&scene)[n] = 1;
    return scene;
}

/* Checks the alpha of the middle pixels of a picture, whose rays pass through
 * so many times the length that the opacity is for. */
static void check_middle(const model_stage *stage, const reference_scene *scene,
                         double length) {
    float *picture = model_picture(stage, scene);
    int width = scene->view.width;
    for (int y = scene->view.height / 2 - 2; y < scene->view.height / 2 + 2;
         y++)
        for (int x = width / 2 - 2; x < width / 2 + 2; x++)
            for (int c = 0; c < 4; c++) /* white: colours equal alpha */
                assert_near((double)picture[4 * (y * width + x) + c],
                            1 - pow(1 - OPACITY, length), 2e-5);
    free(picture);
}

static void a_constant_volume_has_the_opacity_of_its_slices(void **state) {
    model_stage *stage = *state;
    reference_scene scene = constant((int64_t[]){15, 12, 18});
    scene.view.width = 34;
    scene.view.height = 31;
    for (size_t k = 0; k < MODEL_KERNELS; k++)
        for (int footprint = 2; footprint <= 9; footprint++)
            for (size_t s = 0; s < 6; s++) {
                scene.settings.kernel = model_kernel(k);
                scene.settings.footprint = footprint;
                model_look(&scene, sides[s].back, sides[s].up);
                check_middle(stage, &scene,
                             (double)scene.info.dims[sides[s].axis]);
            }
    model_free(&scene);
}

static void opacity_does_not_depend_on_how_finely_slices_lie(void **state) {
    static const double spacing[3] = {0.5, 0.8, 1.5};
    model_stage *stage = *state;
    reference_scene scene = constant((int64_t[]){15, 12, 18});
    for (int c = 0; c < 3; c++)
        scene.info.matrix[c][c] = scene.info.spacing[c] = spacing[c];
    for (int own = 0; own < 2; own++)
        for (size_t s = 0; s < 6; s++) {
            int axis = sides[s].axis;
            double depth = (double)scene.info.dims[axis] * spacing[axis];
            scene.settings.opacity_length = own ? 2 : 0;
            model_look(&scene, sides[s].back, sides[s].up);
            check_middle(stage, &scene, depth / (own ? 2 : spacing[0]));
        }
    model_free(&scene);
}

/* A slab so wide that an oblique ray through its middle leaves through its
 * large faces: it is longer by 1 / cosine. */
static void opacity_does_not_depend_on_the_angle_of_view(void **state) {
    model_stage *stage = *state;
    reference_scene scene = constant((int64_t[]){40, 40, 6});
    for (double azimuth = 0; azimuth < 45; azimuth += 11) {
        model_turn(&scene, azimuth, azimuth / 2, 0, 1);
        double cosine =
            cos(azimuth * acos(-1.0) / 180) * cos(azimuth * acos(-1.0) / 360);
        check_middle(stage, &scene, 6 / cosine);
    }
    model_free(&scene);
}

/* In perspective every ray stays 1 / cosine of its own angle in each slice. */
static void a_constant_volume_is_denser_off_the_axis(void **state) {
    model_stage *stage = *state;
    reference_scene scene = constant((int64_t[]){40, 40, 4});
    scene.view.fov = 60;
    scene.view.zoom = 2;
    reference_camera camera;
    reference_camera_of(&scene, &camera);
    float *picture = model_picture(stage, &scene);
    for (int x = 20; x < 44; x++) {
        /* The kernel adds up samples of neighbouring voxels, whose rays differ
         * little from the pixel's. */
        double right = (x + 0.5 - 32) * camera.pitch, down = camera.pitch / 2;
        double step = sqrt(camera.distance * camera.distance + right * right +
                           down * down) /
                      camera.distance;
        assert_near((double)picture[4 * (24 * 64 + x) + 3],
                    1 - pow(1 - OPACITY, 4 * step), 2e-4);
    }
    free(picture);
    model_free(&scene);
}

/* --- what is near hides what is far --------------------------------------- */

static void the_nearest_slice_hides_those_behind(void **state) {
    static const snow_color_point colors[] = {{1, 1, 0, 0}, {2, 0, 1, 0}};
    model_stage *stage = *state;
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
        float *middle = model_picture(stage, &scene);
        assert_near((double)middle[4 * (20 * 10 + 10)], 0, 1e-6);
        assert_near((double)middle[4 * (20 * 10 + 10) + 1], 1, 1e-6);
        free(middle);
    }
    model_free(&scene);
}

/* --- footprints ------------------------------------------------------------
 */

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

/* At 9/8 pixels a voxel eight neighbours take all eighths of a pixel.  Oblique
 * positions are a sample of all, so there the mean is not exact. */
static void weights_add_up_to_the_projected_area_of_a_voxel(void **state) {
    model_stage *stage = *state;
    for (int oblique = 0; oblique < 2; oblique++)
        for (int n = 0; n < 32; n++) {
            if (!support_takes((size_t)(n + oblique), 3))
                continue;
            reference_scene scene = model_blank((int64_t[]){20, 20, 1}, 1);
            reference_camera camera;
            scene.settings.kernel = model_kernel((size_t)n);
            scene.settings.footprint = 2 + n / 4;
            scene.view.width = scene.view.height = oblique ? 80 : 32;
            reference_camera_of(&scene, &camera);
            if (oblique)
                model_turn(&scene, 30, 20, 10, 1.3);
            else
                scene.view.zoom = camera.pitch * 9 / 8;
            bool jumps = scene.settings.kernel == SNOW_KERNEL_BOX;
            assert_near(mean_weight(stage, &scene), 1,
                        !oblique ? 1e-4
                        : jumps  ? 0.01
                                 : 0.003);
            model_free(&scene);
        }
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

/* Fails unless a scene shows what `picture` does. */
static void check_same(const model_stage *stage, const reference_scene *scene,
                       const float *picture) {
    float *other = model_picture(stage, scene);
    double seen = 0;
    for (int n = 0; n < scene->view.width * scene->view.height * 4; n++) {
        assert_near((double)other[n], (double)picture[n], 1e-5);
        seen = fmax(seen, (double)other[n]);
    }
    assert_true(seen > 0.5);
    free(other);
}

/* The camera, the data or the matrix is turned, to the 24 different places,
 * most of which are reached in more than one way. */
static void turning_the_camera_equals_turning_the_data(void **state) {
    model_stage *stage = *state;
    reference_scene scene = model_scene(
        (int64_t[]){13, 10, 16}, SNOW_TYPE_FLOAT32, false, MODEL_PLAIN, 8);
    for (int n = 0; n < 64; n++) {
        if (!support_takes((size_t)n, 5))
            continue;
        const int turns[3] = {n & 3, n >> 2 & 3, n >> 4};
        int axes[3][3];
        axes_after(turns, axes);
        scene.settings.kernel = model_kernel((size_t)n);
        scene.view.fov = n % 3 == 1 ? 50 : 0;
        reference_scene camera = scene, world = scene;
        reference_scene data = turn_data(&scene, axes);
        model_turn(&camera, 90 * turns[0], 90 * turns[1], 90 * turns[2], 1);
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 3; c++)
                world.info.matrix[r][c] = axes[r][c];
        float *picture = model_picture(stage, &camera);
        check_same(stage, &data, picture);
        check_same(stage, &world, picture);
        free(picture);
        model_free(&data);
    }
    model_free(&scene);
}

static void a_narrow_field_of_view_is_nearly_parallel(void **state) {
    static const double fovs[] = {0, 1, 0.01};
    model_stage *stage = *state;
    for (size_t n = 0; n < MODEL_STANDS; n++) {
        float *pictures[3];
        double apart[3] = {0, 0, 0};
        reference_scene scene =
            model_scene((int64_t[]){13, 10, 15}, SNOW_TYPE_UINT8, false,
                        (model_matrix)(n % MODEL_MATRICES), (uint64_t)n);
        scene.view.width = 24, scene.view.height = 18;
        model_stand_at(&scene, n, 1);
        for (int i = 0; i < 3; i++) {
            scene.view.fov = fovs[i];
            pictures[i] = model_picture(stage, &scene);
            for (int at = 0; at < 24 * 18 * 4; at++)
                apart[i] = fmax(
                    apart[i], (double)fabsf(pictures[i][at] - pictures[0][at]));
        }
        assert_true(apart[2] < 1e-3 && apart[2] < apart[1] / 5);
        for (int i = 0; i < 3; i++)
            free(pictures[i]);
        model_free(&scene);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        MODEL_TEST(a_constant_volume_has_the_opacity_of_its_slices),
        MODEL_TEST(opacity_does_not_depend_on_how_finely_slices_lie),
        MODEL_TEST(opacity_does_not_depend_on_the_angle_of_view),
        MODEL_TEST(a_constant_volume_is_denser_off_the_axis),
        MODEL_TEST(the_nearest_slice_hides_those_behind),
        MODEL_TEST(weights_add_up_to_the_projected_area_of_a_voxel),
        MODEL_TEST(turning_the_camera_equals_turning_the_data),
        MODEL_TEST(a_narrow_field_of_view_is_nearly_parallel),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
