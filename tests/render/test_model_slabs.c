/* tests/render/test_model_slabs.c - a picture split in any slabs and combined
 * equals the whole.
 *
 * Over is associative, but float addition is not: the parts agree with the
 * whole to a few units in the last place, which is the stated bound. */
#include "reference/model.h"

#include "composite/over.h"
#include "decompose/slab.h"

#include <math.h>
#include <snowglass/extend.h>
#include <string.h>

/* Combines the local images of `parts` processors, given from front to back,
 * into the first, by the paper's hierarchical scheme (lines 14 to 20 of figure
 * 8): in round i processor p with p mod 2^(i+1) = 0 receives the image of p +
 * 2^i and composites it behind its own; log2(parts) rounds, rounded up.
 * `pixels` is the number of pixels of each image; the other images are
 * destroyed. */
static void combine_tree(float *const *images, int parts, size_t pixels,
                         int channels) {
    for (int distance = 1; distance < parts; distance *= 2)
        for (int receiver = 0; receiver + distance < parts;
             receiver += 2 * distance)
            snow_over_of(channels)(images[receiver],
                                   images[receiver + distance], pixels);
}

/* Slabs and whole differ by no more than this, for any number of parts. */
#define BOUND 1e-6

/* Makes the volume answer for one of equal slabs of slices. */
static void answer_for(snow_volume *volume, const reference_scene *scene,
                       int parts, int part) {
    reference_camera camera;
    reference_camera_of(scene, &camera);
    const int axis = reference_slice_axis(scene, &camera);
    snow_extent extent;
    snow_extent_init(&extent);
    memcpy(extent.dims, scene->info.dims, sizeof extent.dims);
    memcpy(extent.count, scene->info.dims, sizeof extent.count);
    snow_slab slab = snow_slab_equal(extent.dims[axis], parts, part);
    extent.first[axis] = slab.first;
    extent.count[axis] = slab.count;
    assert_int_equal(snow_volume_set_extent(volume, &extent), SNOW_STATUS_OK);
}

/* The slabs' local images, from front to back. */
static void render_slabs(const model_stage *stage, const reference_scene *scene,
                         int parts, bool rising, snow_image **images) {
    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL;
    assert_int_equal(
        snow_volume_wrap(stage->context, &scene->info, scene->voxels, &volume),
        SNOW_STATUS_OK);
    transfer = model_transfer(stage->context, scene);
    for (int n = 0; n < parts; n++) {
        answer_for(volume, scene, parts, rising ? n : parts - 1 - n);
        assert_int_equal(snow_frame_render(stage->frame, volume, transfer,
                                           &scene->view, &scene->settings,
                                           &images[n]),
                         SNOW_STATUS_OK);
    }
    snow_transfer_free(transfer);
    snow_volume_close(volume);
}

/* Whether slice 0 is the nearest to the camera. */
static bool front_is_first(const reference_scene *scene) {
    reference_camera camera;
    reference_camera_of(scene, &camera);
    reference_ray ray = reference_ray_at(scene, &camera, 0, 0);
    return ray.step[reference_slice_axis(scene, &camera)] > 0;
}

/* How far the combined picture of `parts` slabs is from the whole. */
static double difference(const model_stage *stage, const reference_scene *scene,
                         int parts) {
    snow_image *images[40], *whole = model_image(stage, scene);
    float *pixels[40];
    size_t count = (size_t)(scene->view.width * scene->view.height);
    int channels = snow_image_channels(whole);
    double largest = 0;
    render_slabs(stage, scene, parts, front_is_first(scene), images);
    for (int n = 0; n < parts; n++)
        pixels[n] = snow_image_pixels(images[n]);
    combine_tree(pixels, parts, count, channels);
    for (size_t n = 0; n < count * (size_t)channels; n++)
        largest = fmax(largest, fabs((double)pixels[0][n] -
                                     (double)snow_image_pixels(whole)[n]));
    for (int n = 0; n < parts; n++)
        snow_image_free(images[n]);
    snow_image_free(whole);
    return largest;
}

static void slabs_combine_to_the_whole(void **state) {
    (void)state;
    static const double turns[][3] = {{0, 0, 0},    {180, 0, 0},    {90, 0, 0},
                                      {-90, 0, 30}, {0, 90, 0},     {0, -90, 0},
                                      {30, 20, 10}, {-130, -50, 70}};
    model_stage stage = model_open();
    double largest = 0;
    for (int n = 0; n < 8; n++) {
        reference_scene scene =
            model_scene((int64_t[]){17, 12, 14},
                        n % 2 ? SNOW_TYPE_UINT8 : SNOW_TYPE_FLOAT32, n % 3 == 0,
                        (model_matrix)(n % MODEL_MATRICES), 4);
        model_turn(&scene, turns[n][0], turns[n][1], turns[n][2], 1);
        scene.settings.encoding = (snow_encoding)(n % 4);
        scene.settings.threshold = n % 3 * 10;
        /* 20 and 33 are more than there are slices: some slabs are empty. */
        static const int parts[] = {1, 2, 3, 4, 5, 7, 8, 12, 20, 33};
        for (size_t p = 0; p < sizeof parts / sizeof *parts; p++) {
            double d = difference(&stage, &scene, parts[p]);
            assert_near(d, 0, BOUND);
            largest = fmax(largest, d);
        }
        model_free(&scene);
    }
    print_message("             slabs and whole differ by up to %.2g\n",
                  largest);
    model_close(&stage);
}

static void slabs_in_the_wrong_order_do_not(void **state) {
    (void)state;
    model_stage stage = model_open();
    reference_scene scene = model_scene((int64_t[]){17, 12, 14},
                                        SNOW_TYPE_UINT8, false, MODEL_PLAIN, 4);
    snow_image *images[2], *whole = model_image(&stage, &scene);
    size_t count = (size_t)(scene.view.width * scene.view.height);
    render_slabs(&stage, &scene, 2, !front_is_first(&scene), images);
    float *pixels[2] = {snow_image_pixels(images[0]),
                        snow_image_pixels(images[1])};
    combine_tree(pixels, 2, count, 4);
    double largest = 0;
    for (size_t n = 0; n < 4 * count; n++)
        largest = fmax(largest, fabs((double)pixels[0][n] -
                                     (double)snow_image_pixels(whole)[n]));
    assert_true(largest > 0.05);
    snow_image_free(images[0]);
    snow_image_free(images[1]);
    snow_image_free(whole);
    model_free(&scene);
    model_close(&stage);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slabs_combine_to_the_whole),
        cmocka_unit_test(slabs_in_the_wrong_order_do_not),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
