/* tests/render/test_camera_points.c - cameras that are placed by points of the
 * world: against the reference, and against views by name. */
#include "shear_warp/truth.h"
#include "transform/transform.h"

#include <math.h>
#include <string.h>

#define BOUND 1e-3
static const int64_t dims[3] = {13, 10, 15};

/* A place in the sphere about the middle of the voxel boxes, whose radius is
 * `reach` of theirs, or on it. */
static void draw_place(const reference_scene *scene, uint64_t *state,
                       double reach, bool on_it, double place[3]) {
    reference_scene plain = *scene;
    reference_camera camera;
    double length = 0;
    plain.view.has_target = plain.view.has_position = false;
    reference_camera_of(&plain, &camera);
    while (!(length > 0.1 && length < 1)) {
        length = 0;
        for (int n = 0; n < 3; n++) {
            place[n] = 2 * support_uniform(state) - 1;
            length += place[n] * place[n];
        }
        length = sqrt(length);
    }
    double scale = camera.radius * reach / (on_it ? length : 1);
    for (int n = 0; n < 3; n++)
        place[n] = camera.target[n] + scale * place[n];
}

static reference_scene drawn_scene(uint64_t *state, int n) {
    reference_scene scene = model_scene(
        dims, n % 2 ? SNOW_TYPE_UINT8 : SNOW_TYPE_FLOAT32, n % 3 == 0,
        (model_matrix)(n % MODEL_MATRICES), (uint64_t)n);
    scene.view.width = 24, scene.view.height = 18;
    scene.settings.shade = n % 5 == 0 ? SNOW_SHADE_NONE : SNOW_SHADE_PHONG;
    scene.view.zoom = 0.5 + 2 * support_uniform(state);
    scene.view.has_target = n % 4 != 1;
    scene.view.has_position = n % 4 != 2;
    scene.view.has_view_up = n % 3 != 1;
    draw_place(&scene, state, 0.6, false, scene.view.target);
    draw_place(&scene, state, 2.5 + 3 * support_uniform(state), true,
               scene.view.position);
    for (int i = 0; i < 3; i++)
        scene.view.view_up[i] = support_uniform(state) - 0.5;
    if (n % 7 == 0)
        model_turn(&scene, 360 * support_uniform(state), 30,
                   45 * support_uniform(state), scene.view.zoom);
    return scene;
}

static void pictures_from_any_place_are_those_of_the_reference(void **state) {
    model_stage *stage = *state;
    for (int n = 0; n < 240; n++) {
        if (!support_takes((size_t)n, 7))
            continue;
        uint64_t random = support_scene_random(1, (size_t)n);
        reference_scene scene = drawn_scene(&random, n);
        scene.settings.method =
            n % 2 ? SNOW_METHOD_ORIGINAL : SNOW_METHOD_FOOTPRINT;
        model_check(stage, &scene, BOUND);
        scene.view.fov = 10 + 60 * support_uniform(&random);
        model_check(stage, &scene, BOUND);
        model_free(&scene);
    }
}

/* Another camera would show next to nothing in the same place.  The data are of
 * noise, so that no two places are alike. */
static void shear_warp_and_rays_see_the_same(void **state) {
    model_stage *stage = *state;
    uint64_t random = 2;
    double least = 99;
    int seen = 0, scenes = 0;
    for (int n = 0; n < 60; n += (int)support_stride(7)) {
        warp_scene scene = {.base = drawn_scene(&random, n)};
        scene.base.view.fov = n % 2 ? 20 + 40 * support_uniform(&random) : 0;
        scene.base.settings.method = SNOW_METHOD_SHEAR_WARP;
        scene.base.settings.quality = SNOW_QUALITY_HIGH;
        scene.base.settings.kernel = SNOW_KERNEL_TENT;
        closeness found = closeness_of(stage, &scene);
        scenes++;
        seen += found.pixels > 20;
        if (found.pixels > 20)
            least = fmin(least, found.decibels);
        if (found.pixels > 20 && !(found.decibels > 25))
            fail_msg("%g dB: %s", found.decibels, model_words(&scene.base));
        warp_scene_free(&scene);
    }
    print_message("             at least %.1f dB\n", least);
    assert_true(2 * seen > scenes);
}

/* Standing where a named view stands, and looking where it looks. */
static void the_usual_place_gives_the_usual_picture(void **state) {
    model_stage *stage = *state;
    for (int n = 0; n < 24; n++) {
        reference_scene scene =
            model_scene(dims, SNOW_TYPE_UINT8, false,
                        (model_matrix)(n % MODEL_MATRICES), (uint64_t)n);
        reference_camera camera;
        const char *names[] = {"+z", "-z", "anterior", "left", "right", "iso"};
        snow_view named = {.size = sizeof named};
        assert_int_equal(
            snow_view_from_name(stage->context, names[n % 6], &named),
            SNOW_STATUS_OK);
        model_look(&scene, named.back, named.up);
        scene.view.fov = n < 12 ? 0 : 35;
        reference_camera_of(&scene, &camera);
        float *usual = model_picture(stage, &scene);
        double distance = camera.distance > 0 ? camera.distance : 1;
        scene.view.has_position = true;
        scene.view.has_target = n % 2 == 0;
        for (int i = 0; i < 3; i++) {
            scene.view.target[i] = camera.target[i];
            scene.view.position[i] =
                camera.target[i] + distance * camera.back[i];
        }
        float *placed = model_picture(stage, &scene);
        for (int i = 0; i < scene.view.width * scene.view.height * 4; i++)
            assert_near((double)placed[i], (double)usual[i], 2e-4);
        free(usual);
        free(placed);
        model_free(&scene);
    }
}

static void the_target_falls_on_the_middle(void **state) {
    model_stage *stage = *state;
    reference_scene scene = model_blank((int64_t[]){9, 9, 9}, 1);
    model_voxels(&scene)[(7 * 9 + 6) * 9 + 2] = 1;
    scene.view.width = 33, scene.view.height = 33;
    scene.view.has_target = true;
    memcpy(scene.view.target, (double[]){2, 6, 7}, sizeof scene.view.target);
    for (int n = 0; n < 8; n++) {
        scene.view.fov = n % 2 ? 20 : 0;
        model_turn(&scene, 40 * n, 10 * n, 7 * n, 2);
        float *picture = model_picture(stage, &scene);
        int best = 0;
        for (int i = 0; i < 33 * 33; i++)
            if (picture[4 * i + 3] > picture[4 * best + 3])
                best = i;
        assert_int_equal(best, 16 * 33 + 16);
        free(picture);
    }
    model_free(&scene);
}

/* What of `view_up` is across the line of sight points to the picture's top. */
static void up_is_up(void **state) {
    model_stage *stage = *state;
    reference_scene scene = model_blank((int64_t[]){9, 9, 9}, 1);
    uint64_t random = 4;
    for (int n = 0; n < 50; n++) {
        snow_camera camera;
        double along = 0, up = 0;
        scene.view.has_view_up = true;
        scene.view.has_position = n % 2;
        draw_place(&scene, &random, 5, true, scene.view.position);
        for (int i = 0; i < 3; i++)
            scene.view.view_up[i] = 100 * (support_uniform(&random) - 0.5);
        assert_int_equal(
            snow_camera_make(stage->context, &scene.info, &scene.view, &camera),
            SNOW_STATUS_OK);
        for (int i = 0; i < 3; i++) {
            along += camera.right[i] * scene.view.view_up[i];
            up += camera.up[i] * scene.view.view_up[i];
        }
        assert_near(along, 0, 1e-12);
        assert_true(up > 0);
    }
    model_free(&scene);
}

/* Makes a camera, or is refused with a word. */
static void check_camera(const model_stage *stage, const reference_scene *scene,
                         const char *word) {
    snow_camera camera;
    assert_int_equal(
        snow_camera_make(stage->context, &scene->info, &scene->view, &camera),
        word ? SNOW_STATUS_BAD_USAGE : SNOW_STATUS_OK);
    if (word)
        assert_non_null(strstr(snow_context_message(stage->context), word));
}

static void cameras_that_cannot_be_are_refused(void **state) {
    model_stage *stage = *state;
    reference_scene scene = model_blank((int64_t[]){5, 5, 5}, 1);
    snow_view fine = scene.view, *view = &scene.view;
    view->has_position = true;
    view->position[0] = view->position[1] = view->position[2] = 2;
    check_camera(stage, &scene, "is the middle of the volume");
    view->has_target = true;
    view->target[0] = view->target[1] = view->target[2] = 2;
    check_camera(stage, &scene, "is its target");
    view->target[1] = (double)NAN;
    check_camera(stage, &scene, "must be finite");
    *view = fine;
    view->has_view_up = true;
    check_camera(stage, &scene, "up vector 0,0,0");
    view->view_up[2] = -3; /* the line of sight of +z */
    check_camera(stage, &scene, "parallel to the line of sight");
    view->view_up[2] = (double)INFINITY;
    check_camera(stage, &scene, "invalid up vector");
    *view = fine;
    view->has_position = true; /* 1 before the nearest face */
    view->position[0] = view->position[1] = 2, view->position[2] = 5.5;
    view->fov = 30;
    check_camera(stage, &scene, NULL);
    view->position[2] = 4; /* inside */
    check_camera(stage, &scene, "beside or behind the camera");
    view->fov = 0; /* only the direction counts */
    check_camera(stage, &scene, NULL);
    model_free(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        MODEL_TEST(pictures_from_any_place_are_those_of_the_reference),
        MODEL_TEST(shear_warp_and_rays_see_the_same),
        MODEL_TEST(the_usual_place_gives_the_usual_picture),
        MODEL_TEST(the_target_falls_on_the_middle),
        MODEL_TEST(up_is_up),
        MODEL_TEST(cameras_that_cannot_be_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
