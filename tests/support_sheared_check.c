/* tests/support_sheared_check.c - pictures of the library held against the
 * sheared model. */
#include "support_sheared.h"

#include <math.h>

#include "frame.h"

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
        snow_volume_share(stage->context, &scene->info, scene->voxels, &volume),
        SNOW_OK);
    transfer = model_transfer(stage->context, scene);
    assert_int_equal(snow_frame_render_slab(stage->frame, volume, transfer,
                                            &scene->view, &scene->settings,
                                            parts, part, &image),
                     SNOW_OK);
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

void sheared_check(const model_stage *stage, const reference_scene *scene,
                   const sheared_options *options, double bound,
                   sheared_tally *tally) {
    const sheared_options whole = {0};
    options = options ? options : &whole;
    float *picture =
        sheared_picture(stage, scene, options->parts, options->part);
    if (!sheared_fits(scene)) {
        check_fallback(stage, scene, picture, tally);
        free(picture);
        return;
    }
    const snow_stats *stats = snow_frame_stats(stage->frame);
    assert_int_equal(stats->method, SNOW_METHOD_SHEARED);
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
