/* tests/reference/shear_warp_check.c - pictures of the library held against the
 * sheared model. */
#include "reference/shear_warp.h"

#include <math.h>

#include "frame.h"
#include "volume/downsample.h"

/* The most that footprint splatting may differ from the exact picture. */
#define FOOTPRINT_BOUND 1e-3

/* A cell is given up from this opacity on; a little less for rounding. */
#define OPAQUE (1 - 0.5 / 255 - 1e-4)

float *sheared_picture(const model_stage *stage, const reference_scene *scene,
                       int parts, int part) {
    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL;
    snow_image *image = NULL;
    if (!parts)
        return model_picture(stage, scene);
    assert_int_equal(
        snow_volume_wrap(stage->context, &scene->info, scene->voxels, &volume),
        SNOW_STATUS_OK);
    transfer = model_transfer(stage->context, scene);
    assert_int_equal(snow_frame_render_slab(stage->frame, volume, transfer,
                                            &scene->view, &scene->settings,
                                            parts, part, &image),
                     SNOW_STATUS_OK);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    int channels = snow_image_channels(image);
    size_t count = (size_t)scene->view.width * (size_t)scene->view.height;
    float *picture = calloc(count * 4, sizeof *picture);
    assert_non_null(picture);
    for (size_t n = 0; n < count; n++)
        for (int c = 0; c < 4; c++)
            picture[4 * n + (size_t)c] =
                snow_image_pixels(image)[n * (size_t)channels +
                                         (size_t)(channels == 4 ? c : c == 3)];
    snow_image_free(image);
    return picture;
}

/* --- levels --------------------------------------------------------------- */

int sheared_lean(const reference_scene *scene) {
    double up = 0, down = 0;
    for (size_t n = 1; n < scene->opacity_count; n++) {
        double rise =
            scene->opacities[n].opacity - scene->opacities[n - 1].opacity;
        up += rise > 0 ? rise : 0;
        down -= rise < 0 ? rise : 0;
    }
    int lean = up > 2 * down ? 1 : down > 2 * up ? -1 : 0;
    return scene->info.slope < 0 ? -lean : lean;
}

reference_scene sheared_level(snow_context *context,
                              const reference_scene *scene,
                              const int halvings[3], sheared_options *options,
                              snow_volume *made[SHEARED_LEVELS_MOST]) {
    reference_scene level = *scene;
    snow_downsample_buffers room = {0};
    int most = 0;
    for (int axis = 0; axis < 3; axis++)
        most = halvings[axis] > most ? halvings[axis] : most;
    assert_in_range(most, 1, SHEARED_LEVELS_MOST);
    level.settings.opacity_length = reference_opacity_length(scene);
    for (int n = 0; n < most; n++) {
        bool axes[3];
        snow_volume *from = NULL;
        for (int axis = 0; axis < 3; axis++)
            axes[axis] = halvings[axis] >= most - n;
        assert_int_equal(
            snow_volume_wrap(context, &level.info, level.voxels, &from),
            SNOW_STATUS_OK);
        level.info = snow_downsampled_info(snow_volume_get_info(from), axes);
        assert_int_equal(snow_volume_new(context, &level.info, &made[n]),
                         SNOW_STATUS_OK);
        assert_int_equal(snow_volume_downsample(from, axes, sheared_lean(scene),
                                                1, &room, made[n]),
                         SNOW_STATUS_OK);
        level.voxels = snow_volume_voxels(made[n]);
        snow_volume_close(from);
    }
    snow_release(context, room.block);
    for (int axis = 0; axis < 3; axis++)
        options->fine[axis] =
            (double)level.info.dims[axis] / (double)scene->info.dims[axis];
    return level;
}

/* --- the check ------------------------------------------------------------ */

static double worst_pixel(const reference_scene *scene, const float *picture,
                          const double *reference, int at[2]) {
    double worst = 0;
    int width = scene->view.width;
    for (int n = 0; n < width * scene->view.height; n++)
        for (int c = 0; c < 4; c++) {
            double gap =
                fabs((double)picture[4 * n + c] - reference[4 * n + c]);
            if (!(gap <= worst)) {
                worst = gap;
                at[0] = n % width;
                at[1] = n / width;
            }
        }
    return worst;
}

static void check_fallback(const model_stage *stage,
                           const reference_scene *scene, const float *picture,
                           sheared_tally *tally) {
    assert_int_equal(snow_frame_stats(stage->frame)->method,
                     SNOW_METHOD_FOOTPRINT);
    double *exact = reference_render(scene);
    double distance = model_distance(scene, picture, exact);
    if (!(distance < FOOTPRINT_BOUND))
        fail_msg("footprints differ by %g: %s", distance, model_words(scene));
    tally->footprints++;
    tally->footprints_most = fmax(tally->footprints_most, distance);
    free(exact);
}

/* The scene that the picture is of: the level that the library took, if any. */
static reference_scene scene_taken(const model_stage *stage,
                                   const reference_scene *scene,
                                   sheared_options *options,
                                   snow_volume *made[SHEARED_LEVELS_MOST]) {
    const int *halvings = snow_frame_stats(stage->frame)->halvings;
    if (!halvings[0] && !halvings[1] && !halvings[2])
        return *scene;
    return sheared_level(stage->context, scene, halvings, options, made);
}

static void check_taken(const model_stage *stage, const reference_scene *scene,
                        const sheared_options *options, const float *picture,
                        double bound, sheared_tally *tally) {
    if (!sheared_fits(scene, options)) {
        check_fallback(stage, scene, picture, tally);
        return;
    }
    const snow_stats *stats = snow_frame_stats(stage->frame);
    assert_int_equal(stats->method, SNOW_METHOD_SHEAR_WARP);
    sheared_facts facts;
    int at[2] = {0, 0};
    double *reference = sheared_render(scene, options, &facts);
    double distance = worst_pixel(scene, picture, reference, at);
    assert_int_equal(stats->slice_axis, facts.axis);
    bool opaque = facts.strongest > OPAQUE;
    if (opaque)
        bound += SHEARED_BOUND_OPAQUE - SHEARED_BOUND;
    if (!(distance <= bound))
        fail_msg("differs by %g (bound %g) at (%d, %d), quality %d, slab %d of "
                 "%d, axis %d, phases %d %d, stride %d %d, opacity %.6f: %s",
                 distance, bound, at[0], at[1], (int)scene->settings.quality,
                 options->part, options->parts, facts.axis, facts.phases[0],
                 facts.phases[1], facts.stride[0], facts.stride[1],
                 facts.strongest, model_words(scene));
    tally->clear += !opaque;
    tally->opaque += opaque;
    double *most = opaque ? &tally->opaque_most : &tally->clear_most;
    *most = fmax(*most, distance);
    tally->strongest += facts.strongest;
    free(reference);
}

void sheared_check(const model_stage *stage, const reference_scene *scene,
                   const sheared_options *options, double bound,
                   sheared_tally *tally) {
    const sheared_options whole = {0};
    sheared_options own = options ? *options : whole;
    snow_volume *made[SHEARED_LEVELS_MOST] = {NULL};
    float *picture = sheared_picture(stage, scene, own.parts, own.part);
    reference_scene taken = scene_taken(stage, scene, &own, made);
    check_taken(stage, &taken, &own, picture, bound, tally);
    for (int n = 0; n < SHEARED_LEVELS_MOST; n++)
        snow_volume_close(made[n]);
    free(picture);
}

void sheared_report(const char *title, const sheared_tally *tally) {
    int sheared = tally->clear + tally->opaque;
    print_message("             %s: %d clear pictures differ by up to %.2g, %d "
                  "with opaque pixels by %.2g, %d by footprints by %.2g; "
                  "strongest opacity %.2f in the mean\n",
                  title, tally->clear, tally->clear_most, tally->opaque,
                  tally->opaque_most, tally->footprints, tally->footprints_most,
                  tally->strongest / sheared);
    assert_true(tally->strongest / sheared > 0.4);
}
