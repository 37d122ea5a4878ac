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
    double opacity = stage->opacity / stage->pictures;
    snow_frame_free(stage->frame);
    assert_int_equal(snow_context_bytes(stage->context), 0);
    snow_context_free(stage->context);
    if (!stage->pictures)
        return;
    print_message("             %d pictures differ by up to %.2g; their "
                  "strongest opacity is %.2f in the mean\n",
                  stage->pictures, stage->largest, opacity);
    assert_true(opacity > 0.4 || support_is_sanitized());
}

int model_setup(void **state) {
    model_stage *stage = malloc(sizeof *stage);
    assert_non_null(stage);
    *stage = model_open();
    *state = stage;
    return 0;
}

int model_teardown(void **state) {
    model_close(*state);
    free(*state);
    return 0;
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

snow_volume *model_volume(snow_context *context, const reference_scene *scene) {
    snow_volume *volume = NULL;
    if (snow_volume_wrap(context, &scene->info, scene->voxels, &volume) !=
        SNOW_STATUS_OK)
        fail_msg("%s: %s", model_words(scene), snow_context_message(context));
    return volume;
}

static snow_status render(const model_stage *stage,
                          const reference_scene *scene,
                          const snow_volume *volume, snow_image **image) {
    snow_transfer *transfer = model_transfer(stage->context, scene);
    snow_status status = snow_frame_render(
        stage->frame, volume, transfer, &scene->view, &scene->settings, image);
    snow_transfer_free(transfer);
    return status;
}

snow_image *model_image_of(const model_stage *stage,
                           const reference_scene *scene,
                           const snow_volume *volume) {
    snow_image *image = NULL;
    if (render(stage, scene, volume, &image) != SNOW_STATUS_OK)
        fail_msg("%s: %s", model_words(scene),
                 snow_context_message(stage->context));
    return image;
}

snow_image *model_image(const model_stage *stage,
                        const reference_scene *scene) {
    snow_volume *volume = model_volume(stage->context, scene);
    snow_image *image = model_image_of(stage, scene, volume);
    snow_volume_close(volume);
    return image;
}

void model_refused(const model_stage *stage, const reference_scene *scene,
                   const char *words) {
    snow_volume *volume = model_volume(stage->context, scene);
    snow_image *image = NULL;
    assert_int_equal(render(stage, scene, volume, &image),
                     SNOW_STATUS_BAD_USAGE);
    assert_null(image);
    snow_volume_close(volume);
    const char *message = snow_context_message(stage->context);
    if (!strstr(message, words) || strchr(message, '\n'))
        fail_msg("\"%s\" lacks \"%s\"", message, words);
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

/* The largest difference; NaN where either is not a number. */
static double distance_of(const reference_scene *scene, const float *picture,
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

void model_check(model_stage *stage, const reference_scene *scene,
                 double bound) {
    float *picture = model_picture(stage, scene);
    double *reference = reference_render(scene);
    double distance = distance_of(scene, picture, reference);
    if (!(distance < bound))
        fail_msg("differs by %g: %s", distance, model_words(scene));
    stage->pictures++;
    stage->largest = fmax(stage->largest, distance);
    stage->opacity += strongest_opacity(scene, reference);
    free(picture);
    free(reference);
}
