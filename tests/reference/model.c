/* tests/reference/model.c - pictures of the library held against the reference.
 */
#include "reference/model.h"

#include <math.h>

model_stage model_open(void) {
    model_stage stage = {.context = support_context()};
    if (snow_frame_new(stage.context, &stage.frame) != SNOW_STATUS_OK)
        fail_msg("no frame");
    return stage;
}

void model_close(model_stage *stage) {
    snow_frame_free(stage->frame);
    assert_int_equal(snow_context_bytes(stage->context), 0);
    snow_context_free(stage->context);
}

snow_transfer *model_transfer(snow_context *context,
                              const reference_scene *scene) {
    snow_transfer *transfer = NULL;
    snow_status status =
        snow_transfer_new(context, scene->colors, scene->color_count,
                          scene->opacities, scene->opacity_count, &transfer);
    if (status == SNOW_STATUS_OK)
        status = snow_transfer_set_gradient_opacity(transfer, scene->gradients,
                                                    scene->gradient_count);
    if (status == SNOW_STATUS_OK && scene->log)
        status = snow_transfer_set_log(transfer);
    if (status != SNOW_STATUS_OK)
        fail_msg("%s: %s", model_words(scene), snow_context_message(context));
    return transfer;
}

snow_image *model_image(const model_stage *stage,
                        const reference_scene *scene) {
    snow_volume *volume = NULL;
    snow_context *context = stage->context;
    snow_transfer *transfer = model_transfer(context, scene);
    snow_image *image = NULL;
    snow_status status =
        snow_volume_wrap(context, &scene->info, scene->voxels, &volume);
    if (status == SNOW_STATUS_OK)
        status = snow_frame_render(stage->frame, volume, transfer, &scene->view,
                                   &scene->settings, &image);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    if (status != SNOW_STATUS_OK)
        fail_msg("%s: %s", model_words(scene), snow_context_message(context));
    return image;
}

float *model_spread(snow_image *image) {
    size_t count =
        (size_t)snow_image_width(image) * (size_t)snow_image_height(image);
    int channels = snow_image_channels(image);
    const float *from = snow_image_pixels(image);
    float *to = calloc(count * 4, sizeof *to);
    assert_non_null(to);
    for (size_t n = 0; n < count; n++, from += channels)
        for (int c = 0; c < 4; c++)
            to[4 * n + (size_t)c] =
                channels == 4 ? from[c] : from[c < 3 ? 0 : 1];
    return to;
}

float *model_picture(const model_stage *stage, const reference_scene *scene) {
    snow_image *image = model_image(stage, scene);
    assert_int_equal(snow_image_width(image), scene->view.width);
    assert_int_equal(snow_image_height(image), scene->view.height);
    float *picture = model_spread(image);
    snow_image_free(image);
    return picture;
}

double model_distance(const reference_scene *scene, const float *picture,
                      const double *reference) {
    size_t count = (size_t)scene->view.width * (size_t)scene->view.height * 4;
    double largest = 0;
    for (size_t n = 0; n < count; n++) {
        double difference = fabs((double)picture[n] - reference[n]);
        if (isnan(difference))
            return difference;
        largest = fmax(largest, difference);
    }
    return largest;
}

static double strongest_opacity(const reference_scene *scene,
                                const double *picture) {
    double strongest = 0;
    for (int n = 0; n < scene->view.width * scene->view.height; n++)
        strongest = fmax(strongest, picture[4 * n + 3]);
    return strongest;
}

void model_check(const model_stage *stage, const reference_scene *scene,
                 double bound, model_summary *summary) {
    float *picture = model_picture(stage, scene);
    double *reference = reference_render(scene);
    double distance = model_distance(scene, picture, reference);
    if (!(distance < bound))
        fail_msg("differs by %g: %s", distance, model_words(scene));
    summary->pictures++;
    summary->largest = fmax(summary->largest, distance);
    summary->opacity += strongest_opacity(scene, reference);
    free(picture);
    free(reference);
}

void model_report(const model_summary *summary) {
    double opacity = summary->opacity / summary->pictures;
    print_message("             %d pictures differ by up to %.2g; their "
                  "strongest opacity is %.2f in the mean\n",
                  summary->pictures, summary->largest, opacity);
    assert_true(opacity > 0.4);
}
