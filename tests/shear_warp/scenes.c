/* tests/shear_warp/scenes.c - volumes, layers and planes of a scene, and its
 * picture. */
#include "shear_warp/scenes.h"

#include "volume/volume.h"

#include <math.h>

void warp_scene_free(warp_scene *scene) {
    free((void *)(uintptr_t)scene->base.voxels);
}

bool warp_scene_has_values(const warp_scene *scene) {
    return scene->base.settings.mode == SNOW_MODE_MEAN ||
           scene->base.settings.mode == SNOW_MODE_SUM;
}

void warp_scene_store(const reference_scene *scene, size_t at, double value) {
    void *voxels = (void *)(uintptr_t)scene->voxels;
    double native = (value - scene->info.intercept) / scene->info.slope;
    if (scene->info.type != SNOW_TYPE_FLOAT32 &&
        scene->info.type != SNOW_TYPE_FLOAT64)
        native = rint(native);
    switch (scene->info.type) {
#define STORE(name, type, text)              \
    case SNOW_TYPE_##name:                   \
        ((type *)voxels)[at] = (type)native; \
        break;
        SNOW_TYPE_MAP(STORE)
#undef STORE
    case SNOW_TYPE_NONE:
        break;
    }
}

void warp_scene_place(const reference_scene *scene, const double share[3],
                      double out[3]) {
    const snow_volume_info *info = &scene->info;
    for (int r = 0; r < 3; r++) {
        out[r] = info->matrix[r][3];
        for (int c = 0; c < 3; c++)
            out[r] +=
                info->matrix[r][c] * share[c] * (double)(info->dims[c] - 1);
    }
}

void warp_scene_cut(warp_scene *scene, size_t planes) {
    static const double normals[][3] = {{0.6, 0.3, -0.5}, {-0.2, 0.9, 0.4}};
    static const double shares[][3] = {{0.6, 0.6, 0.6}, {0.8, 0.8, 0.8}};
    for (size_t n = 0; n < planes; n++) {
        double *plane = scene->planes[n], at[3];
        warp_scene_place(&scene->base, shares[n], at);
        plane[3] = 0;
        for (int r = 0; r < 3; r++) {
            plane[r] = normals[n][r];
            plane[3] += normals[n][r] * at[r];
        }
    }
    scene->plane_count = planes;
}

/* --- the picture ---------------------------------------------------------- */

static snow_volume *open_volume(snow_context *context,
                                const warp_scene *scene) {
    snow_volume *volume = NULL, *cut = NULL;
    assert_int_equal(snow_volume_wrap(context, &scene->base.info,
                                      scene->base.voxels, &volume),
                     SNOW_STATUS_OK);
    volume->masked = scene->base.masked;
    if (!scene->plane_count)
        return volume;
    assert_int_equal(
        snow_volume_clip(volume, scene->planes[0], scene->plane_count, &cut),
        SNOW_STATUS_OK);
    snow_volume_close(volume);
    return cut;
}

static snow_transfer *make_transfer(snow_context *context,
                                    const warp_scene *scene,
                                    const snow_volume *volume) {
    const reference_scene *s = &scene->base;
    if (!(scene->symlog > 0))
        return model_transfer(context, s);
    const snow_look look = {.size = sizeof look,
                            .symlog = scene->symlog,
                            .colors = s->colors,
                            .color_count = s->color_count,
                            .opacities = s->opacities,
                            .opacity_count = s->opacity_count};
    snow_transfer *transfer = NULL;
    if (snow_transfer_new_for_volume(volume, &look, &transfer) !=
        SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(context));
    return transfer;
}

static float *spread_values(snow_image *image) {
    size_t count =
        (size_t)snow_image_width(image) * (size_t)snow_image_height(image);
    const float *from = snow_image_pixels(image);
    float *to = calloc(count * 4, sizeof *to);
    assert_int_equal(snow_image_channels(image), 1);
    assert_non_null(to);
    for (size_t n = 0; n < count; n++) {
        to[4 * n + 3] = isnan(from[n]) ? 0.0F : 1.0F;
        to[4 * n] = isnan(from[n]) ? 0 : from[n];
    }
    return to;
}

float *warp_scene_render(const model_stage *stage, const warp_scene *scene) {
    const reference_scene *s = &scene->base;
    snow_volume *volume = open_volume(stage->context, scene), *front = NULL;
    snow_transfer *transfer = make_transfer(stage->context, scene, volume);
    snow_transfer *look = NULL;
    snow_image *image = NULL;
    if (scene->front) {
        front = open_volume(stage->context, scene->front);
        look = make_transfer(stage->context, scene->front, front);
    }
    const snow_layer layer = {front, look, scene->mixes};
    assert_int_equal(
        snow_frame_set_layers(stage->frame, &layer, scene->front != NULL),
        SNOW_STATUS_OK);
    if (snow_frame_render(stage->frame, volume, transfer, &s->view,
                          &s->settings, &image) != SNOW_STATUS_OK)
        fail_msg("%s: %s", model_words(s),
                 snow_context_message(stage->context));
    assert_int_equal(snow_frame_stats(stage->frame)->method,
                     s->settings.method);
    float *picture = warp_scene_has_values(scene) ? spread_values(image)
                                                  : model_spread(image);
    snow_frame_set_layers(stage->frame, NULL, 0);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_transfer_free(look);
    snow_volume_close(front);
    snow_image_free(image);
    return picture;
}
