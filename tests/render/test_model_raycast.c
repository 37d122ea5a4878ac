/* tests/render/test_model_raycast.c - splatted pictures look like ray-cast ones
 * of the same transfer function.
 *
 * Both interpolate values and colour them after.  Rays take trilinear values at
 * steps of a quarter of a voxel; shear-warp takes values between slices along
 * its own rows, at the density of its lattice.  How near the two are is a
 * structural similarity (SSIM, stated beside each picture; 1 would be equal).
 * Its bound is a little below what was measured and looked at.  With
 * SNOW_PICTURES set to a folder the pairs are written there, splatted left,
 * ray-cast right. */
#include "reference/model.h"

#include <math.h>

/* How a volume is shown. */
typedef struct look {
    const char *name;
    const snow_opacity_point *opacities;
    size_t opacity_count;
    snow_shade shade;
} look;

static const snow_opacity_point signal_ramp[] = {{0.4, 0}, {0.6, 0.5}};
static const snow_opacity_point haze_ramp[] = {{10, 0}, {255, 0.15}};
static const snow_opacity_point surface_ramp[] = {{60, 0}, {180, 0.7}};

static const look signal_plain = {"plain", signal_ramp, 2, SNOW_SHADE_NONE};
static const look signal_lit = {"lit", signal_ramp, 2, SNOW_SHADE_PHONG};
static const look haze = {"haze", haze_ramp, 2, SNOW_SHADE_NONE};
static const look surface = {"surface", surface_ramp, 2, SNOW_SHADE_PHONG};

/* What is rendered: a built-in volume at a size, from where, and how similar
 * its pictures are at least. */
typedef struct subject {
    const char *name;
    int64_t dims[3];
    double azimuth, elevation;
    const look *look;
    double ssim;
} subject;

static const snow_color_point signal_colors[] = {{0.3, 0.9, 0.4, 0.2},
                                                 {1, 0.3, 0.6, 1}};
static const snow_color_point byte_colors[] = {
    {0, 0.3, 0.1, 0.05}, {120, 0.9, 0.6, 0.4}, {255, 1, 1, 0.9}};

/* Turns a float picture of four channels into an image. */
static snow_image *image_of(const model_stage *stage, int width, int height) {
    snow_image *image = NULL;
    assert_int_equal(snow_image_new(stage->context, width, height, 4, &image),
                     SNOW_STATUS_OK);
    return image;
}

static void keep_pair(const model_stage *stage, const subject *what,
                      snow_image *splatted, snow_image *cast) {
    const char *folder = getenv("SNOW_PICTURES");
    if (!folder)
        return;
    int width = snow_image_width(cast), height = snow_image_height(cast);
    snow_image *pair = image_of(stage, 2 * width, height);
    for (int y = 0; y < height; y++)
        for (int side = 0; side < 2; side++)
            memcpy(snow_image_pixels(pair) + 4 * width * (2 * y + side),
                   snow_image_pixels(side ? cast : splatted) + 4 * width * y,
                   (size_t)width * 4 * sizeof(float));
    char path[1024];
    snprintf(path, sizeof path, "%s/%s-%s.png", folder, what->name,
             what->look->name);
    snow_image_options options = {
        .size = sizeof options, .flatten = true, .overwrite = true};
    assert_int_equal(snow_image_save(pair, path, &options), SNOW_STATUS_OK);
    snow_image_free(pair);
}

/* The structural similarity of a subject's splatted and ray-cast pictures. */
static double similarity(const model_stage *stage, const subject *what,
                         const reference_scene *scene) {
    int width = scene->view.width, height = scene->view.height;
    snow_image *splatted = image_of(stage, width, height);
    snow_image *cast = image_of(stage, width, height);
    float *picture = model_picture(stage, scene);
    double *rays = reference_raycast(scene);
    for (int n = 0; n < width * height * 4; n++) {
        snow_image_pixels(splatted)[n] = picture[n];
        snow_image_pixels(cast)[n] = (float)rays[n];
    }
    snow_image_difference difference = {.size = sizeof difference};
    assert_int_equal(snow_image_compare(splatted, cast, &difference),
                     SNOW_STATUS_OK);
    print_message("             %s, %s: SSIM %.4f, PSNR %.1f dB, mean "
                  "difference %.4f\n",
                  what->name, what->look->name, difference.ssim,
                  difference.psnr, difference.mean);
    keep_pair(stage, what, splatted, cast);
    free(picture);
    free(rays);
    snow_image_free(splatted);
    snow_image_free(cast);
    return difference.ssim;
}

static void check_subject(const subject *what) {
    model_stage stage = model_open();
    snow_volume *volume = NULL;
    assert_int_equal(snow_volume_open_phantom(stage.context, what->name,
                                              what->dims, 0, &volume),
                     SNOW_STATUS_OK);
    bool bytes = snow_volume_get_info(volume)->type == SNOW_TYPE_UINT8;
    reference_scene scene = {
        .info = *snow_volume_get_info(volume),
        .voxels = snow_volume_voxels(volume),
        .colors = bytes ? byte_colors : signal_colors,
        .color_count = bytes ? 3 : 2,
        .opacities = what->look->opacities,
        .opacity_count = what->look->opacity_count,
        .view = {.size = sizeof(snow_view),
                 .width = 128,
                 .height = 128,
                 .back = {0, 0, 1},
                 .up = {0, 1, 0}},
    };
    model_turn(&scene, what->azimuth, what->elevation, 0, 1.3);
    snow_settings_init(&scene.settings);
    scene.settings.shade = what->look->shade;
    double ssim = similarity(&stage, what, &scene);
    assert_true(ssim >= what->ssim);
    snow_volume_close(volume);
    model_close(&stage);
}

/* In the short tier each other one from number `first` on. */
static void check_subjects(const subject *subjects, size_t count,
                           size_t first) {
    for (size_t n = 0; n < count; n++)
        if (support_takes(n + first, 2))
            check_subject(&subjects[n]);
}

static void the_marschner_lobb_signal(void **state) {
    (void)state;
    static const subject subjects[] = {
        {"marschner-lobb", {40, 40, 40}, 30, 20, &signal_plain, 0.99},
        /* Its rings are near the finest that the grid holds. */
        {"marschner-lobb", {40, 40, 40}, 10, -15, &signal_lit, 0.96},
    };
    check_subjects(subjects, 2, 1);
}

static void the_engine(void **state) {
    (void)state;
    static const subject subjects[] = {
        {"engine", {96, 96, 42}, 30, 20, &haze, 0.995},
        {"engine", {96, 96, 42}, 30, 20, &surface, 0.96},
    };
    check_subjects(subjects, 2, 0);
}

static void the_head(void **state) {
    (void)state;
    static const subject subjects[] = {
        {"head", {96, 96, 42}, -40, -60, &haze, 0.995},
        {"head", {96, 96, 42}, -40, -60, &surface, 0.98},
    };
    check_subjects(subjects, 2, 1);
}

static void the_shells_and_the_cube(void **state) {
    (void)state;
    static const subject subjects[] = {
        {"shells", {96, 96, 96}, -30, 20, &haze, 0.995},
        {"cube", {96, 96, 42}, 25, 35, &surface, 0.99},
    };
    check_subjects(subjects, 2, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_marschner_lobb_signal),
        cmocka_unit_test(the_engine),
        cmocka_unit_test(the_head),
        cmocka_unit_test(the_shells_and_the_cube),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
